#include "output/run_log.hpp"

#include <hdf5.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/parallel.hpp"
#include "detonation/shape.hpp"
#include "output/fields.hpp"
#include "output/json.hpp"

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

json totals(run::Totals const& t) {
  return {{"mass", {json_or_null(t.mass[0]), json_or_null(t.mass[1])}},
          {"momentum", {json_or_null(t.momentum[0]), json_or_null(t.momentum[1]), json_or_null(t.momentum[2])}},
          {"energy", json_or_null(t.energy)}};
}

json audit(run::Audit const& a) {
  auto const error = a.relative_error();
  return {{"initial", totals(a.initial)},
          {"current", totals(a.current)},
          {"outflow", totals(a.outflow)},
          {"fallback_faces", a.fallback_faces},
          {"guarded_cells", a.guarded_cells},
          {"guard_mass", json_or_null(a.guard_mass)},
          {"guard_energy", json_or_null(a.guard_energy)},
          {"relative_error",
           {{"mass", {json_or_null(error[0]), json_or_null(error[1])}}, {"energy", json_or_null(error[2])}}}};
}

json charges(run::World const& world) {
  json out = json::array();
  for (std::size_t c = 0; c < world.charges.size(); ++c) {
    auto const& report = world.charges[c];
    json entry{{"explosive", report.explosive},
               {"asked_mass", json_or_null(report.asked_mass)},
               {"realised_mass", json_or_null(report.realised_mass)},
               {"realised_energy", json_or_null(report.realised_energy)},
               {"cells_per_radius", json_or_null(report.cells_per_radius)}};
    if (c < world.setup.charges.size()) {
      auto const& charge = world.setup.charges[c];
      entry["centre"] = detonation::centre(charge.shape);
      entry["source"] = charge.explosive.source;
      entry["density"] = charge.explosive.density();
      entry["detonation"] = charge.detonation == run::Detonation::programmed ? "programmed" : "instantaneous";
      entry["tnt_equivalent_pressure"] = json_or_null(charge.explosive.tnt_equivalent_pressure);
      entry["tnt_equivalent_impulse"] = json_or_null(charge.explosive.tnt_equivalent_impulse);
    }
    out.push_back(std::move(entry));
  }
  return out;
}

json domain_of(grid::Domain const& d) {
  json boundary = json::array();
  for (auto const b : d.boundary) boundary.push_back(grid::boundary_name(b));
  return {{"geometry", grid::geometry_name(d.geometry)},
          {"lower", d.lower},
          {"upper", {d.upper(0), d.upper(1), d.upper(2)}},
          {"cell_size", d.h},
          {"cells", d.cells},
          {"cell_count", d.cell_count()},
          {"boundary", std::move(boundary)}};
}

}  // namespace

json versions() {
  unsigned major = 0;
  unsigned minor = 0;
  unsigned release = 0;
  H5get_libversion(&major, &minor, &release);
  return {{"brisance", BRISANCE_VERSION},
          {"compiler", BRISANCE_COMPILER},
          {"compiler_flags", BRISANCE_COMPILER_FLAGS},
          {"hdf5", std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(release)}};
}

json machine() {
  return {{"processor", processor_model()}, {"cores", std::thread::hardware_concurrency()}, {"threads", threads()}};
}

json run_log(run::World const& world, RunStatus const& status) {
  double const updates = static_cast<double>(world.setup.domain.cell_count()) * static_cast<double>(world.clock.step);
  json timings = json::object();
  for (auto const& [phase, seconds] : world.timings) timings[phase] = json_or_null(seconds);
  return {{"title", world.setup.title},
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
          {"blocks", world.grid.block_count()},
          {"scheme", world.setup.numerics.scheme == run::Scheme::muscl_hancock ? "muscl-hancock" : "lax-wendroff"},
          {"courant", world.setup.numerics.courant},
          {"ambient",
           {{"fluid", world.setup.ambient.fluid.name},
            {"pressure", world.setup.ambient.state.pressure},
            {"density", world.setup.ambient.state.density}}},
          {"charges", charges(world)},
          {"obstacles", world.setup.obstacles.size()},
          {"gauges", world.gauges.size()},
          {"dumps", status.dumps},
          {"wall_seconds", status.wall_seconds},
          {"cell_updates_per_second", status.wall_seconds > 0.0 ? updates / status.wall_seconds : 0.0},
          {"timings", std::move(timings)},
          {"audit", audit(world.audit)},
          {"versions", versions()},
          {"machine", machine()}};
}

}  // namespace brisance::output
