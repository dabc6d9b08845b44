#include <cmath>
#include <nlohmann/json.hpp>

#include "app/gauge_text.hpp"
#include "app/plan_parts.hpp"
#include "app/plan_text.hpp"
#include "core/parallel.hpp"
#include "output/json.hpp"
#include "output/placed.hpp"
#include "output/writer.hpp"

namespace brisance::app {

namespace {

nlohmann::json charges_json(run::Case const& setup, session::Plan const& p) {
  nlohmann::json charges = nlohmann::json::array();
  for (std::size_t n = 0; n < p.charges.size(); ++n) {
    auto const& c = p.charges[n];
    auto const& explosive = setup.charges[n].explosive;
    charges.push_back({{"explosive", c.explosive},
                       {"specified_mass", c.specified_mass},
                       {"realised_mass", output::json_or_null(c.realised_mass)},
                       {"relative_error", output::json_or_null(relative_error(c))},
                       {"specified_volume", c.specified_mass / explosive.density()},
                       {"realised_volume", output::json_or_null(c.realised_mass / explosive.density())},
                       {"specified_energy", c.specified_mass * explosive.specific_energy()},
                       {"realised_energy", c.realised_energy},
                       {"cells_per_radius", c.cells_per_radius}});
  }
  return charges;
}

nlohmann::json bodies_json(run::Case const& setup, session::Plan const& p) {
  nlohmann::json bodies = nlohmann::json::array();
  for (std::size_t n = 0; n < p.bodies.size(); ++n) {
    auto const& b = p.bodies[n];
    double const density = density_of(setup.particles.bodies[n]);
    bodies.push_back({{"name", b.name},
                      {"material", b.material},
                      {"points", b.particles},
                      {"mass", output::json_or_null(b.mass)},
                      {"geometric_mass", output::json_or_null(b.geometric_mass)},
                      {"volume", output::json_or_null(b.mass / density)},
                      {"geometric_volume", output::json_or_null(b.geometric_mass / density)},
                      {"relative_error", output::json_or_null(relative_error(b))}});
  }
  return bodies;
}

nlohmann::json levels_json(session::Plan const& p) {
  nlohmann::json levels = nlohmann::json::array();
  for (session::LevelPlan const& level : p.levels) {
    levels.push_back({{"cell_size", level.cell},
                      {"cells_at_start", level.start},
                      {"mean_cells", std::round(level.mean)},
                      {"most_cells", std::round(level.most)}});
  }
  return levels;
}

nlohmann::json region_json(run::Case const& setup, session::Plan const& p, std::size_t number) {
  session::RegionPlan const& r = p.regions[number];
  return {{"lower", r.lower},
          {"upper", r.upper},
          {"cells", r.cells},
          {"width", setup.mpm_regions[number].width},
          {"bridge_faces", r.bridge_faces},
          {"gas_points", r.gas_particles},
          {"gas_steps", std::round(r.gas_steps)},
          {"point_steps", std::round(r.particle_steps)}};
}

}  // namespace

nlohmann::json plan_json(run::Case const& setup, session::Plan const& p) {
  using nlohmann::json;
  json memory = json::array();
  for (session::MemoryPart const& part : p.memory) memory.push_back({{"what", part.what}, {"bytes", part.bytes}});
  json materials = json::array();
  for (MaterialLine const& m : materials_of(setup))
    materials.push_back({{"name", m.name}, {"role", m.role}, {"source", m.source}});
  json boundaries = json::object();
  for (int f = 0; f < 2 * setup.domain.dimensions(); ++f)
    boundaries[grid::face_names[f]] = word_of(setup.domain.boundary[f]);
  json subsets = json::array();
  for (session::SubsetPlan const& subset : p.subsets)
    subsets.push_back({{"name", subset.name}, {"dumps", subset.dumps}, {"dump_bytes", subset.dump_bytes}});
  json fields = json::array();
  for (auto const& f : output::dumped_fields(setup, output::IsLast::yes)) fields.push_back(f.name);
  for (auto const& f : output::dumped_particle_fields(setup)) fields.push_back(f.name);
  json plan{{"title", setup.title},
            {"geometry", word_of(setup.domain.geometry)},
            {"cells", setup.domain.cells},
            {"cell_count", setup.domain.cell_count()},
            {"cell_size", setup.domain.smallest_cell()},
            {"blocks", p.blocks},
            {"levels", levels_json(p)},
            {"estimated_cell_updates", std::round(p.cell_updates)},
            {"boundaries", boundaries},
            {"memory_bytes", p.memory_bytes},
            {"memory", memory},
            {"estimated_seconds", p.seconds},
            {"threads", threads()},
            {"disk_bytes", p.disk_bytes},
            {"machine_memory_bytes", p.machine_memory_bytes},
            {"end_time", setup.end.time},
            {"estimated_steps", std::round(p.steps)},
            {"charges", charges_json(setup, p)},
            {"starts", p.starts},
            {"points", p.particles},
            {"bodies", bodies_json(setup, p)},
            {"materials", materials},
            {"mpm_region", p.regions.size() == 1 ? region_json(setup, p, 0) : json()},
            {"gauges", setup.particles.gauges.size() + setup.gauges.size()},
            {"gauge_bytes", p.gauge_bytes},
            {"gauge_peaks", gauge_plan_json(p.gauges)},
            {"obstacles", setup.obstacles.size()},
            {"initial_states", output::initial_states_json(p.initial_states)},
            {"placed_obstacles", output::obstacles_json(p.obstacles)},
            {"panels", output::panels_json(p.panels)},
            {"fields", fields},
            {"dumps", p.dumps},
            {"dump_bytes", p.dump_bytes},
            {"subsets", subsets},
            {"checkpoint_bytes", p.checkpoint_bytes},
            {"warnings", p.warnings}};
  if (p.regions.size() > 1) {
    json regions = json::array();
    for (std::size_t n = 0; n < p.regions.size(); ++n) regions.push_back(region_json(setup, p, n));
    plan["mpm_regions"] = std::move(regions);
  }
  return plan;
}

}  // namespace brisance::app
