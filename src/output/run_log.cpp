#include "output/run_log.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/parallel.hpp"
#include "core/simd.hpp"
#include "grid/forest.hpp"
#include "output/fields.hpp"
#include "output/json.hpp"
#include "output/placed.hpp"
#include "output/zones.hpp"
#include "run/world.hpp"
#include "shape/shape.hpp"

namespace brisance::output {

using nlohmann::json;

namespace {

std::string processor_model() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    auto const colon = line.find(':');
    if (line.starts_with("model name") && colon != std::string::npos && colon + 2 <= line.size())
      return line.substr(colon + 2);
  }
  return "unknown";
}

json masses(material::PerFluid const& of_fluids) {
  json values = json::array();
  for (double const mass : of_fluids) values.push_back(json_or_null(mass));
  return values;
}

/// What is kept of gas: masses, momentum and energy.
json amounts(material::Amounts const& t) {
  return {{"mass", masses(t.mass)},
          {"momentum", {json_or_null(t.momentum[0]), json_or_null(t.momentum[1]), json_or_null(t.momentum[2])}},
          {"energy", json_or_null(t.energy)}};
}

std::string key_of(run::AuditFinding const& finding) {
  using Kind = run::AuditFinding::Kind;
  switch (finding.kind) {
    case Kind::mass: return finding.fluid == 0 ? "mass" : "mass_of_second_fluid";
    case Kind::gas_energy: return "energy";
    case Kind::guard_energy: return "guard_energy";
    case Kind::guard_mass: return "guard_mass";
    case Kind::drift: return "drift";
    case Kind::ledger: return "ledger";
    case Kind::unlit: return "unlit_explosive";
  }
  return "";
}

json audit(run::World const& world) {
  run::Audit const& a = world.audit;
  auto const error = a.relative_error();
  auto const verdict = world.verdict();
  json findings = json::object();
  for (run::AuditFinding const& f : world.audit_findings()) {
    findings[key_of(f)] = {{"amount", json_or_null(f.amount)},
                           {"scale", json_or_null(f.scale)},
                           {"share", json_or_null(f.share())},
                           {"warn", f.warn},
                           {"fail", f.fail},
                           {"reported", f.tells()}};
  }
  return {{"balanced", verdict.balanced},
          {"reasons", verdict.reasons},
          {"drift_judged", verdict.drift_judged},
          {"for_comparison", world.for_comparison()},
          {"findings", std::move(findings)},
          {"initial", amounts(a.initial)},
          {"current", amounts(a.current)},
          {"outflow", amounts(a.outflow)},
          {"ledger",
           {{"mass", masses(a.ledger.mass)},
            {"energy", json_or_null(a.ledger.energy)},
            {"largest_content", json_or_null(a.memory.content)},
            {"largest_surplus", json_or_null(a.memory.surplus)}}},
          {"fallback_faces", a.fallback_faces},
          {"guarded_cells", a.guarded_cells},
          {"guard_mass", json_or_null(a.guard_mass)},
          {"guard_energy", json_or_null(a.guard_energy)},
          {"afterburn_energy", json_or_null(a.afterburn_energy)},
          {"panels", {{"mass", masses(a.panels.mass)}, {"energy", json_or_null(a.panels.energy)}}},
          {"relative_error", {{"mass", masses(error.mass)}, {"energy", json_or_null(error.energy)}}}};
}

json charges(run::World const& world) {
  json out = json::array();
  for (std::size_t c = 0; c < world.charges.size(); ++c) {
    auto const& report = world.charges[c];
    json entry{{"explosive", report.explosive},
               {"specified_mass", json_or_null(report.specified_mass)},
               {"realised_mass", json_or_null(report.realised_mass)},
               {"realised_energy", json_or_null(report.realised_energy)},
               {"cells_per_radius", json_or_null(report.cells_per_radius)}};
    if (c < world.setup.charges.size()) {
      auto const& charge = world.setup.charges[c];
      entry["centre"] = shape::centre(charge.shape);
      entry["source"] = charge.explosive.source;
      entry["density"] = charge.explosive.density();
      entry["specified_volume"] = json_or_null(report.specified_mass / charge.explosive.density());
      entry["realised_volume"] = json_or_null(report.realised_mass / charge.explosive.density());
      entry["specified_energy"] = json_or_null(report.specified_mass * charge.explosive.specific_energy());
      entry["detonation"] = charge.detonation == run::Detonation::programmed ? "programmed" : "instantaneous";
      entry["tnt_equivalent_pressure"] = json_or_null(charge.explosive.tnt_equivalent_pressure);
      entry["tnt_equivalent_impulse"] = json_or_null(charge.explosive.tnt_equivalent_impulse);
    }
    out.push_back(std::move(entry));
  }
  return out;
}

json afterburn(material::Afterburn const& a) {
  json out{{"energy", a.energy}};
  std::visit(
      [&out](auto const& model) {
        out["model"] = model.name;
        for (auto const& p : model.parameters()) out[std::string(p.key)] = model.*p.member;
      },
      a.rate);
  return out;
}

json domain_of(grid::Domain const& d) {
  json boundary = json::array();
  for (auto const b : d.boundary) boundary.push_back(word_of(b));
  return {{"geometry", word_of(d.geometry)}, {"lower", d.lower}, {"upper", {d.upper(0), d.upper(1), d.upper(2)}},
          {"cell_size", d.smallest_cell()},  {"cells", d.cells}, {"cell_count", d.cell_count()},
          {"boundary", std::move(boundary)}};
}

/// The cells of leaves as they are now, level by level, and how often blocks have changed.
json levels(run::World const& world) {
  json cells = json::array();
  for (int level = 0; level < world.grid.levels(); ++level) {
    long count = 0;
    long blocks = 0;
    for (int const b : world.grid.blocks_of(level)) {
      grid::Block const& block = world.grid.blocks()[b];
      if (block.covered) continue;
      count += uncovered_count(block);
      ++blocks;
    }
    double const size = world.grid.domain(level).smallest_cell();
    cells.push_back({{"level", level}, {"cell_size", size}, {"blocks", blocks}, {"cells", count}});
  }
  return {{"cells", std::move(cells)},
          {"changes", world.adaptation->changes()},
          {"held_back", world.adaptation->held_back()}};
}

/// Updates of gas cells so far; of several levels as if the blocks had always been what they are now.
double cell_updates(run::World const& world) {
  double per_step = static_cast<double>(world.setup.domain.cell_count());
  if (world.adaptation != nullptr) {
    per_step = 0.0;
    for (grid::Block const& block : world.grid.blocks()) {
      per_step += std::ldexp(uncovered_count(block), block.level);
    }
  }
  return per_step * static_cast<double>(world.clock.gas_steps);
}

/// The largest drift so far, of the energy at work.
json largest_drift(run::World const& world) {
  for (run::AuditFinding const& f : world.audit_findings()) {
    if (f.kind == run::AuditFinding::Kind::drift) return json_or_null(f.share());
  }
  return nullptr;
}

/// The accounts of the energy of particles, alone or with gas; `left`: the key of what left the domain.
json energy_of_particles(run::World const& world, char const* left) {
  run::EnergyBalance const energy = world.energy_balance();
  mpm::Accounts const booked = world.accounts();
  return {{"initial", json_or_null(energy.initial)},
          {"current", json_or_null(energy.current)},
          {left, json_or_null(energy.lost)},
          {"work", json_or_null(energy.work)},
          {"lost_at_constrained_nodes", json_or_null(energy.dissipated.constraints)},
          {"filtered", json_or_null(energy.dissipated.filtered)},
          {"apic", json_or_null(energy.dissipated.apic)},
          {"friction", json_or_null(energy.dissipated.friction)},
          {"damping", json_or_null(energy.dissipated.damping)},
          {"lifted", json_or_null(booked.floored.energy)},
          {"lifted_points", booked.floored.particles},
          {"conducted", json_or_null(booked.conducted.moved)},
          {"scale", json_or_null(energy.scale)},
          {"drift", json_or_null(energy.drift())},
          {"largest_drift", largest_drift(world)}};
}

/// What a run of material points has beside the rest.
json particles(run::World const& world, double wall_seconds) {
  mpm::Options const& o = world.regions.front().particles->options();
  json bodies = json::array();
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    auto const& report = world.bodies[b];
    bool const gas = world.is_gas(static_cast<int>(b));
    run::BodyPlace const at = world.place_of(static_cast<int>(b));
    auto const* body = gas ? nullptr : &world.setup.particles.bodies[b];
    // Gas has no density of its own.
    double const density = gas ? std::nan("") : body->density.value_or(body->solid.density);
    bodies.push_back(
        {{"name", report.name},
         {"material", report.material},
         {"source", gas ? world.setup.ambient.fluid.source : body->solid.source},
         {"points", report.particles},
         {"points_per_direction", world.regions[at.region].particles->bodies()[at.body].particles_per_direction},
         {"mass", json_or_null(report.mass)},
         {"geometric_mass", json_or_null(report.geometric_mass)},
         {"volume", json_or_null(report.mass / density)},
         {"geometric_volume", json_or_null(report.geometric_mass / density)},
         {"velocity", gas                                ? json(world.setup.ambient.state.velocity)
                      : body->motion.expressions.empty() ? json(body->velocity)
                                                         : json(body->motion.expressions)},
         {"spin", gas ? Vec3{0.0, 0.0, 0.0} : body->motion.spin},
         {"rigid", !gas && body->rigid},
         {"bars", report.bars},
         {"bar_volume", json_or_null(report.bar_volume)}});
  }
  auto const& a = world.audit;
  mpm::Accounts const booked = world.accounts();
  std::size_t bytes = 0;
  double updates = 0.0;
  for (run::Region const& region : world.regions) {
    bytes += mpm::bytes(*region.particles);
    updates += static_cast<double>(mpm::particle_count(*region.particles)) * static_cast<double>(region.steps);
  }
  return {{"count", world.particle_count()},
          {"bytes", bytes},
          {"shape_function", word_of(o.shape)},
          {"order", word_of(o.order)},
          {"transfer", word_of(o.transfer)},
          {"pic_fraction", o.pic_fraction},
          {"xpic_order", o.xpic_order},
          {"regularisation", o.crack_band ? "crack_band" : "none"},
          {"locking_control", o.locking_control},
          {"linear_viscosity", o.linear_viscosity},
          {"quadratic_viscosity", o.quadratic_viscosity},
          {"body_force", o.body_force},
          {"wall_friction", o.wall_friction},
          {"constraints", world.setup.particles.constraints.size()},
          {"contacts", world.setup.particles.contacts.size()},
          {"surface_pressures", world.setup.particles.pressures.size()},
          {"gauges", world.setup.particles.gauges.size()},
          {"bodies", std::move(bodies)},
          {"point_updates_per_second", wall_seconds > 0.0 ? updates / wall_seconds : 0.0},
          {"audit",
           {{"mass",
             {{"initial", json_or_null(a.initial.mass[0])},
              {"current", json_or_null(a.current.mass[0])},
              {"lost", json_or_null(a.outflow.mass[0])},
              {"relative_error", json_or_null(a.relative_error().mass[0])}}},
            {"momentum",
             {{"initial", a.initial.momentum},
              {"current", a.current.momentum},
              {"lost", a.outflow.momentum},
              {"constraint_impulse", booked.constraint_impulse}}},
            {"energy", energy_of_particles(world, "lost")},
            {"lost_points", booked.losses.particles}}}};
}

/// What a run of gas and particles together has beside both, of one of its regions.
json mpm_region(run::World const& world, std::size_t number, double wall_seconds) {
  run::Region const& of_world = world.regions[number];
  bridge::Bridge const& bridge = *of_world.bridge;
  bridge::Region const& region = bridge.region();
  run::MpmRegion const& settings = world.setup.mpm_regions[number];
  json boxes = json::array();
  for (auto const& box : settings.boxes) boxes.push_back({{"lower", box.lower}, {"upper", box.upper}});
  auto const bridges =
      std::count_if(region.faces().begin(), region.faces().end(), [](auto const& f) { return !f.open; });
  auto const time = world.timings.find("bridge");
  double const seconds = time == world.timings.end() ? 0.0 : time->second;
  return {{"boxes", std::move(boxes)},
          {"cells", region.cells().size()},
          {"bridge_faces", bridges},
          {"width", region.width()},
          {"transport", word_of(bridge.options().transport)},
          {"points_per_direction", bridge.options().particles_per_direction},
          {"transfer", word_of(settings.transfer)},
          {"order", word_of(settings.order)},
          {"awake_since", of_world.awake_since ? json(*of_world.awake_since) : json(nullptr)},
          {"gas_steps", world.clock.gas_steps},
          {"point_steps", of_world.steps},
          {"points_injected", bridge.traffic().injected},
          {"points_absorbed", bridge.traffic().absorbed},
          {"ledger", amounts(bridge.ledger())},
          {"bridge_seconds", seconds},
          {"bridge_share", wall_seconds > 0.0 ? seconds / wall_seconds : 0.0},
          {"energy", energy_of_particles(world, "outflow")}};
}

/// One is `mpm_region`, several are the list `mpm_regions`. What is measured of all together is told of one alone: for
/// several it is among the timings and in the audit of the particles.
void add_regions(run::World const& world, double wall_seconds, json& log) {
  if (world.regions.size() == 1) {
    log["mpm_region"] = mpm_region(world, 0, wall_seconds);
    return;
  }
  json regions = json::array();
  for (std::size_t number = 0; number < world.regions.size(); ++number) {
    json region = mpm_region(world, number, wall_seconds);
    for (char const* of_all : {"bridge_seconds", "bridge_share", "energy"}) region.erase(of_all);
    regions.push_back(std::move(region));
  }
  log["mpm_regions"] = std::move(regions);
}

}  // namespace

std::string start_in_words(run::Case const& setup, run::StartReport const& report) {
  if (!setup.start.profile.empty()) return fmt::format("profile \"{}\"", report.from);
  return fmt::format("{} with {}, {:.4g} cells per charge radius", report.from,
                     report.method == run::StartMethod::gas ? "the gas scheme" : "material points",
                     report.charge_radius / report.cell);
}

json starts(run::World const& world) {
  json out = json::array();
  for (run::StartReport const& s : world.starts) {
    auto const& r = s.remap;
    out.push_back({{"start", start_in_words(world.setup, s)},
                   {"cell_size", json_or_null(s.cell)},
                   {"charge_radius", json_or_null(s.charge_radius)},
                   {"near", s.by},
                   {"time", json_or_null(r.time)},
                   {"radius", json_or_null(r.radius)},
                   {"cells_per_radius", json_or_null(r.cells_per_radius)},
                   {"share", json_or_null(r.share)},
                   {"before", amounts(r.before)},
                   {"after", amounts(r.after)},
                   {"radial_momentum", json_or_null(r.radial_momentum)},
                   {"relative_error", json_or_null(r.error())},
                   {"quadrature_error", json_or_null(r.quadrature_error)},
                   {"mixed_pressure_error", json_or_null(r.pressure_error)},
                   {"mixed_pressure_error_averaged", json_or_null(r.pressure_error_averaged)}});
  }
  return out;
}

/// Of run.json: grows when a key changes its name or meaning; readers check it.
constexpr int log_format = 2;

json versions() {
  unsigned major = 0;
  unsigned minor = 0;
  unsigned release = 0;
  H5get_libversion(&major, &minor, &release);
  std::string const forest = grid::Forest::library();
  return {{"brisance", BRISANCE_VERSION},
          {"forest", forest.empty() ? json(nullptr) : json(forest)},
          {"compiler", BRISANCE_COMPILER},
          {"compiler_flags", BRISANCE_COMPILER_FLAGS},
          {"hdf5", std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(release)}};
}

json machine() {
  return {{"processor", processor_model()},
          {"cores", std::thread::hardware_concurrency()},
          {"threads", threads()},
          {"simd", word_of(simd_set())}};
}

json run_log(run::World const& world, RunStatus const& status) {
  double const updates = cell_updates(world);
  json timings = json::object();
  for (auto const& [phase, seconds] : world.timings) timings[phase] = json_or_null(seconds);
  bool const gas = world.gas != nullptr;
  json log{{"title", world.setup.title},
           {"deck_path", world.setup.deck_path},
           {"deck", world.setup.deck_text},
           {"status", status.status},
           {"end_reason", status.end_reason},
           {"exit_code", status.exit_code},
           {"started_at", status.started_at},
           {"time", world.clock.time},
           {"end_time", world.setup.end.time},
           {"step", world.clock.step},
           {"last_dt", world.clock.dt},
           {"domain", domain_of(world.setup.domain)},
           {"blocks", gas ? world.grid.block_count() : world.regions.front().particles->grid().block_count()},
           {"scheme", gas ? word_of(world.setup.numerics.scheme) : "material points"},
           {"courant", gas ? world.setup.numerics.courant : world.setup.particles.options.courant_number()},
           {"ambient",
            {{"fluid", world.setup.ambient.fluid.name},
             {"pressure", world.setup.ambient.state.pressure},
             {"density", world.setup.ambient.state.density}}},
           {"charges", charges(world)},
           {"starts", starts(world)},
           {"obstacles", world.setup.obstacles.size()},
           {"initial_states", initial_states_json(world.initial_states)},
           {"placed_obstacles", obstacles_json(world.obstacles)},
           {"gauges", gas ? world.setup.gauges.size() : 0},
           {"dumps", status.dumps},
           {"resumed_at_steps", status.resumed_at},
           {"wall_seconds", status.wall_seconds},
           {"cell_updates_per_second", gas && status.wall_seconds > 0.0 ? updates / status.wall_seconds : 0.0},
           {"timings", std::move(timings)},
           {"audit", audit(world)},
           {"format", log_format},
           {"versions", versions()},
           {"machine", machine()}};
  if (world.adaptation != nullptr) log["levels"] = levels(world);
  if (world.panels != nullptr) log["panels"] = panels_json(world.panels->reports());
  if (world.setup.afterburn) log["afterburn"] = afterburn(*world.setup.afterburn);
  if (!world.regions.empty()) log["points"] = particles(world, status.wall_seconds);
  if (auto zones = broken_zones_json(world); !zones.empty()) log["points"]["broken_zones"] = std::move(zones);
  if (world.coupled()) add_regions(world, status.wall_seconds, log);
  return log;
}

}  // namespace brisance::output
