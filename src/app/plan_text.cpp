#include "app/plan_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/gauge_text.hpp"
#include "app/plan_parts.hpp"
#include "core/parallel.hpp"
#include "core/text.hpp"
#include "observe/subset_cells.hpp"
#include "output/json.hpp"
#include "output/placed.hpp"
#include "output/run_log.hpp"
#include "output/writer.hpp"
#include "session/estimates.hpp"

namespace brisance::app {

namespace {

std::string end_text(run::End const& end) {
  std::string text = quantity(end.time, "s");
  if (end.steps > 0) text += fmt::format(", or {} steps", end.steps);
  if (end.gauges) text += ", or when the positive phase has ended at all gauges";
  if (end.kinetic_energy > 0.0)
    text += fmt::format(", or when the kinetic energy stays below {:g} of its maximum", end.kinetic_energy);
  if (end.wall_clock > 0.0) text += fmt::format("; stops after {} of wall-clock time", clock_time(end.wall_clock));
  return text;
}

/// The parts that count, the largest first.
std::string memory_text(session::Plan const& p) {
  constexpr double counts = 0.02;
  std::string text;
  double rest = p.memory_bytes;
  for (session::MemoryPart const& part : p.memory) {
    if (part.bytes < counts * p.memory_bytes) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : "; ", part.what, bytes(part.bytes));
    rest -= part.bytes;
  }
  return rest > 0.5e-3 * p.memory_bytes ? text + fmt::format("; other {}", bytes(rest)) : text;
}

template <class Law>
std::string rate_text(Law const& law) {
  std::string text = law.name;
  for (auto const& p : Law::parameters()) text += fmt::format(", {} = {}", p.key, quantity(law.*p.member, p.unit));
  return text;
}
std::string rate_text(material::MillerAfterburn const& m) {
  return fmt::format("d(lambda)/dt = {:g}/s (1 - lambda)^{:g} (p/{})^{:g} above {}", m.rate, m.m,
                     quantity(m.reference_pressure, "Pa"), m.n, quantity(m.minimum_pressure, "Pa"));
}
std::string rate_text(material::ConstantRateAfterburn const& c) {
  return fmt::format("at a constant rate from {} to {}", quantity(c.begin, "s"), quantity(c.end, "s"));
}

std::string afterburn_text(material::Afterburn const& a) {
  std::string const rate = std::visit([](auto const& law) { return rate_text(law); }, a.rate);
  return fmt::format("{}/kg of products, {}", quantity(a.energy, "J"), rate);
}

std::string region_text(run::Case const& setup, session::Plan const& p, std::size_t number) {
  session::RegionPlan const& r = p.regions[number];
  run::MpmRegion const& settings = setup.mpm_regions[number];
  bool const alone = p.regions.size() == 1;
  std::string box;
  for (int d = 0; d < setup.domain.dimensions(); ++d)
    box += fmt::format("{}{:g} to {:g}", d == 0 ? "" : " x ", r.lower[d], r.upper[d]);
  std::string faces;
  for (std::size_t f = 0; f < r.bridge_faces.size(); ++f) {
    if (r.bridge_faces[f] > 0) faces += fmt::format("{}{}", faces.empty() ? "" : ", ", grid::face_names[f]);
  }
  std::string const kind = settings.boxes.empty()      ? (alone ? "smallest box around the bodies plus margin"
                                                                : "smallest box around its bodies plus margin")
                           : settings.boxes.size() > 1 ? "several boxes"
                                                       : "as specified";
  std::string const label = alone ? "MPM region" : fmt::format("MPM region {}", number + 1);
  std::string const size =
      alone ? "" : fmt::format(" of {}", quantity(setup.region_domain(number).smallest_cell(), "m"));
  return fmt::format("{:<12} {} m, {} cells{} ({})\n", label, box, large_count(r.cells), size, kind) +
         fmt::format("{:<12} {}\n", "bridge",
                     faces.empty()
                         ? "none: the MPM region fills the domain"
                         : fmt::format("{} cells wide, on sides {} of the MPM region", settings.width, faces));
}

constexpr std::size_t most_listed = 20;

std::string initial_state_line(std::size_t number, run::InitialStateReport const& r) {
  return fmt::format(
      "{:<12} {}: {}, volume specified {:.6g} m3, placed {:.6g}; mass specified {:.6g} kg, placed {:.6g}; energy "
      "specified {}, placed {}\n",
      "", number + 1, r.fluid, r.specified_volume, r.volume, r.specified_mass, r.mass,
      quantity(r.specified_energy, "J", 6), quantity(r.energy, "J", 6));
}

std::string obstacle_line(run::ObstacleReport const& o) {
  return fmt::format("{:<12} {}: volume specified {:.6g} m3, placed {:.6g} in {} cells\n", "", o.name,
                     o.specified_volume, o.volume, o.cells);
}

std::string panel_line(run::PanelReport const& p) {
  std::string const mass = p.release.areal_mass > 0.0
                               ? fmt::format("{:.4g} kg/m2, fully open after {} of travel", p.release.areal_mass,
                                             quantity(p.place.area / p.place.perimeter, "m", 3))
                               : "massless";
  return fmt::format("{:<12} {}: panel that fails in direction {} at {}, area {:.6g} m2, {}\n", "", p.name,
                     "xyz"[p.place.direction], quantity(p.release.pressure, "Pa"), p.place.area, mass);
}

/// A line behind a label; without one, of the label above.
std::string line(std::string const& label, std::string const& text) { return fmt::format("{:<12} {}\n", label, text); }

bool has_particles(session::Plan const& p) { return p.particles > 0.0; }
bool has_gas(session::Plan const& p) { return !has_particles(p) || !p.regions.empty(); }

/// Cells of all levels: "level 0: 480 of 64 mm, level 1: 300 of 32 mm".
std::string level_counts(session::Plan const& p, double session::LevelPlan::*count, bool sizes) {
  std::string out;
  for (std::size_t l = 0; l < p.levels.size(); ++l) {
    out += fmt::format("{}level {}: {}{}", l == 0 ? "" : ", ", l, large_count(p.levels[l].*count),
                       sizes ? " of " + quantity(p.levels[l].cell, "m") : "");
  }
  return out;
}

std::string levels_text(session::Plan const& p) {
  using session::LevelPlan;
  std::string const start =
      p.blocks > 0 ? fmt::format("at the start, in {} blocks", p.blocks) : std::string("at the start, estimate");
  return line("cells", fmt::format("{} ({})", level_counts(p, &LevelPlan::start, true), start)) +
         line("", fmt::format("later, on average, about {}; at most about {} in total",
                              level_counts(p, &LevelPlan::mean, false), large_count(p.cells))) +
         line("",
              "(estimate: each charge sends two shocks through the domain, each wall reflects them once, and they keep "
              "a "
              "layer of cells 5 blocks thick)");
}

std::string domain_text(run::Case const& setup, session::Plan const& p) {
  grid::Domain const& d = setup.domain;
  int const dims = d.dimensions();
  std::string out;
  std::string box;
  std::string cells;
  for (int k = 0; k < dims; ++k) {
    box += fmt::format("{}{:g} to {:g}", k == 0 ? "" : " x ", d.lower[k], d.upper(k));
    cells += fmt::format("{}{}", k == 0 ? "" : " x ", d.cells[k]);
  }
  out += line("domain", fmt::format("{}, {} m", word_of(d.geometry), box));
  if (p.levels.empty()) {
    out += line("cells", fmt::format("{} = {} of {}{}", cells, large_count(p.cells), quantity(d.smallest_cell(), "m"),
                                     !has_gas(p) ? "" : fmt::format(", in {} blocks", p.blocks)));
  } else {
    out += levels_text(p);
  }
  std::string boundaries;
  for (int f = 0; f < 2 * dims; ++f)
    boundaries += fmt::format("{}{} {}", f == 0 ? "" : ", ", grid::face_names[f], word_of(d.boundary[f]));
  out += line("boundaries", boundaries);
  for (std::size_t n = 0; n < p.regions.size(); ++n) out += region_text(setup, p, n);
  return out;
}

/// Of what all MPM regions have.
double sum_over(session::Plan const& p, double session::RegionPlan::*of) {
  double sum = 0.0;
  for (session::RegionPlan const& region : p.regions) sum += region.*of;
  return sum;
}

double largest_courant(run::Case const& setup) {
  double largest = 0.0;
  for (run::Body const& body : setup.particles.bodies) largest = std::max(largest, setup.courant_of(body));
  return largest;
}

std::string scheme_text(run::Case const& setup, session::Plan const& p) {
  std::string out;
  if (has_particles(p)) {
    auto const& o = setup.particles.options;
    double const of_gas = sum_over(p, &session::RegionPlan::gas_particles);
    out +=
        line("particles", fmt::format("{} material points in {} bod{}{}", large_count(p.particles - of_gas),
                                      p.bodies.size(), p.bodies.size() == 1 ? "y" : "ies",
                                      p.regions.empty() ? "" : fmt::format(", {} gas particles", large_count(of_gas))));
    out += line("scheme", fmt::format("material points, {}, {}, {}, Courant number {:g}", word_of(o.shape),
                                      word_of(o.order), word_of(o.transfer), largest_courant(setup)));
  }
  if (has_gas(p)) {
    out += line(has_particles(p) ? "" : "scheme",
                fmt::format("{}, Courant number {:g}, {}", word_of(setup.numerics.scheme), setup.numerics.courant,
                            session::gas_fluids(setup) > 1 ? "two fluids" : "one fluid"));
  }
  return out;
}

std::string steps_text(session::Plan const& p) {
  double const sub_steps = sum_over(p, &session::RegionPlan::particle_steps);
  if (!p.levels.empty()) {
    std::string const region = p.regions.empty() ? ""
                               : p.regions.size() == 1
                                   ? fmt::format("{} of the MPM region's level, {} MPM sub-steps; ",
                                                 large_count(p.regions.front().gas_steps), large_count(sub_steps))
                                   : fmt::format("{} MPM sub-steps in all regions; ", large_count(sub_steps));
    return line("steps",
                fmt::format("about {} of the coarsest cells, each finer level twice as many ({}estimates; up to "
                            "{} cell updates, fewer while blocks sleep)",
                            large_count(p.steps), region, large_count(p.cell_updates)));
  }
  if (!p.regions.empty()) {
    return line("steps", fmt::format("about {} coupled steps ({} gas, {} MPM sub-steps{}; estimates, fewer while {} or "
                                     "gas blocks sleep)",
                                     large_count(p.steps), large_count(p.regions.front().gas_steps),
                                     large_count(sub_steps), p.regions.size() > 1 ? " in all regions" : "",
                                     p.regions.size() > 1 ? "MPM regions" : "the MPM region"));
  }
  if (has_particles(p)) {
    return line("steps", fmt::format("about {} (if the time step stays at its initial value; {} particle updates)",
                                     large_count(p.steps), large_count(p.steps * p.particles)));
  }
  return line("steps", fmt::format("about {} (estimate; up to {} cell updates, fewer while blocks sleep)",
                                   large_count(p.steps), large_count(p.cell_updates)));
}

/// Of the dumps of all subsets.
std::string subsets_size(session::Plan const& p) {
  double sum = 0.0;
  for (session::SubsetPlan const& subset : p.subsets) sum += static_cast<double>(subset.dumps) * subset.dump_bytes;
  return p.subsets.empty() ? "" : fmt::format("subsets {}, ", bytes(sum));
}

std::string costs_text(run::Case const& setup, session::Plan const& p) {
  std::string out;
  out += line("memory",
              fmt::format("about {} of {}: {}", bytes(p.memory_bytes), bytes(p.machine_memory_bytes), memory_text(p)));
  out += line("time", fmt::format("up to about {} on {} thread{} (estimate from the rates in docs/benchmarks.md; less "
                                  "while the gas is at rest)",
                                  wall_time(p.seconds), threads(), threads() == 1 ? "" : "s"));
  out += line(
      "disk",
      fmt::format(
          "up to about {} (estimate): {} dumps of {} each before compression, {}gauges {}, {} checkpoints of {} each",
          bytes(p.disk_bytes), p.dumps, bytes(p.dump_bytes), subsets_size(p), bytes(p.gauge_bytes),
          setup.checkpoint.keep + 1, bytes(p.checkpoint_bytes)));
  return out;
}

/// How a body moves at the start.
std::string motion_text(run::Body const& body) {
  auto const& [spin, centre, expressions] = body.motion;
  Vec3 const& v = body.velocity;
  std::string out;
  if (!expressions.empty()) {
    out += fmt::format(", ({}) m/s", fmt::join(expressions, ", "));
  } else if (norm(v) > 0.0) {
    out += fmt::format(", ({:g}, {:g}, {:g}) m/s", v[0], v[1], v[2]);
  }
  if (norm(spin) > 0.0) out += fmt::format(", spin ({:g}, {:g}, {:g}) rad/s", spin[0], spin[1], spin[2]);
  return out;
}

std::string bodies_text(run::Case const& setup, session::Plan const& p) {
  std::string out;
  for (std::size_t n = 0; n < p.bodies.size(); ++n) {
    auto const& b = p.bodies[n];
    auto const& body = setup.particles.bodies[n];
    out += line("body", fmt::format("{}: {}, {} particles, {} per cell and direction{}{}", b.name, b.material,
                                    large_count(static_cast<double>(b.particles)), body.particles_per_direction,
                                    motion_text(body), body.rigid ? ", rigid" : ""));
    if (body.lateral_stress)
      out += line("", fmt::format("in the stress of the weight on it, K0 = {:.4g}", *body.lateral_stress));
    if (std::isfinite(b.mass))
      out += line("", fmt::format("mass of the particles {:.8g} kg, of the shape {:.8g} kg, relative error {:.1e}; "
                                  "volume {:.6g} and {:.6g} m3",
                                  b.mass, b.geometric_mass, relative_error(b), b.mass / density_of(body),
                                  b.geometric_mass / density_of(body)));
  }
  return out;
}

std::string charges_text(run::Case const& setup, session::Plan const& p) {
  std::string out;
  for (std::size_t n = 0; n < p.charges.size(); ++n) {
    auto const& c = p.charges[n];
    auto const& charge = setup.charges[n];
    auto const x = shape::centre(charge.shape);
    out += line(p.charges.size() == 1 ? std::string("charge") : fmt::format("charge {}", n + 1),
                fmt::format("{} at ({:g}, {:g}, {:g}) m, {} detonation", c.explosive, x[0], x[1], x[2],
                            charge.detonation == run::Detonation::programmed ? "programmed" : "instantaneous"));
    out += line("", std::isfinite(c.realised_mass)
                        ? fmt::format("mass specified {:.8g} kg, realised {:.8g} kg, relative error {:.1e}",
                                      c.specified_mass, c.realised_mass, relative_error(c))
                        : fmt::format("mass specified {:.8g} kg, realised: not computed", c.specified_mass));
    double const density = charge.explosive.density();
    out += line(
        "", fmt::format(
                "volume specified {:.6g} m3, realised {}; energy specified {}, realised {}; {:.3g} cells per radius",
                c.specified_mass / density,
                std::isfinite(c.realised_mass) ? fmt::format("{:.6g} m3", c.realised_mass / density)
                                               : std::string("not computed"),
                quantity(c.specified_mass * charge.explosive.specific_energy(), "J", 6),
                quantity(c.realised_energy, "J", 6), c.cells_per_radius));
    if (n < p.starts.size()) out += line("start", p.starts[n]);
  }
  return out;
}

std::string placed_text(run::Case const& setup, session::Plan const& p) {
  std::string out;
  if (setup.afterburn) out += line("afterburn", afterburn_text(*setup.afterburn));
  if (!setup.initial_states.empty()) out += line("initial states", fmt::format("{}", setup.initial_states.size()));
  for (std::size_t n = 0; n < p.initial_states.size(); ++n) out += initial_state_line(n, p.initial_states[n]);
  if (!setup.obstacles.empty()) out += line("obstacles", fmt::format("{}", setup.obstacles.size()));
  for (std::size_t n = 0; n < p.obstacles.size() && n < most_listed; ++n) out += obstacle_line(p.obstacles[n]);
  if (p.obstacles.size() > most_listed) out += line("", fmt::format("and {} more", p.obstacles.size() - most_listed));
  for (std::size_t n = 0; n < p.panels.size() && n < most_listed; ++n) out += panel_line(p.panels[n]);
  if (p.panels.size() > most_listed) out += line("", fmt::format("and {} more panels", p.panels.size() - most_listed));
  return out;
}

/// The fields of the gas that the dumps hold, and those of the last one alone.
std::string field_names(run::Case const& setup) {
  std::vector<std::string> in_all;
  std::vector<std::string> in_last;
  for (auto const& f : output::dumped_fields(setup, output::IsLast::no)) in_all.push_back(f.name);
  for (auto const& f : output::dumped_fields(setup, output::IsLast::yes)) {
    if (std::ranges::find(in_all, f.name) == in_all.end()) in_last.push_back(f.name);
  }
  std::string names = fmt::format("{}", fmt::join(in_all, ", "));
  if (!in_last.empty()) names += fmt::format("; only in the last dump: {}", fmt::join(in_last, ", "));
  return names;
}

/// A subset and what its dumps hold.
std::string subset_line(run::Case const& setup, std::size_t number, session::SubsetPlan const& plan) {
  run::FieldSubset const& subset = setup.output.subsets[number];
  observe::SubsetCells const shown(subset, setup.domain, setup.adaptive.finest);
  std::string place;
  if (auto const* cut = std::get_if<run::Plane>(&subset.place)) {
    run::Plane const& plane = *cut;
    place = fmt::format("plane {} = {:g} m", "xyz"[plane.normal], plane.at);
  } else {
    grid::Domain const box = shown.shown();
    std::vector<std::string> sides;
    sides.reserve(static_cast<std::size_t>(box.dimensions()));
    for (int d = 0; d < box.dimensions(); ++d) sides.push_back(fmt::format("{:g} to {:g}", box.lower[d], box.upper(d)));
    place = fmt::format("box {} m", fmt::join(sides, ", "));
  }
  std::vector<std::string> names;
  for (auto const& field : output::dumped_fields(setup, subset)) names.push_back(field.name);
  return line(number == 0 ? "subsets" : "",
              fmt::format("{}: {}, {} dumps of {} each before compression: {}", plan.name, place, plan.dumps,
                          bytes(plan.dump_bytes), fmt::join(names, ", ")));
}

std::string output_text(run::Case const& setup, session::Plan const& p) {
  std::string out;
  std::size_t const gauges = setup.particles.gauges.size() + setup.gauges.size();
  out += line("gauges", gauges == 0 ? "none" : fmt::format("{}, about {}", gauges, bytes(p.gauge_bytes)));
  out += gauge_plan_text(p.gauges);
  std::string fields = field_names(setup);
  auto const particle_fields = output::dumped_particle_fields(setup);
  if (!p.regions.empty() && !particle_fields.empty()) fields += "; of particles:";
  for (std::size_t n = 0; n < particle_fields.size(); ++n)
    fields += (fields.empty() ? "" : n == 0 ? " " : ", ") + particle_fields[n].name;
  out += line("fields", p.dumps == 0 ? std::string("none of the whole domain")
                                     : fmt::format("{} dumps of {} each before compression: {}", p.dumps,
                                                   bytes(p.dump_bytes), fields));
  for (std::size_t n = 0; n < p.subsets.size(); ++n) out += subset_line(setup, n, p.subsets[n]);
  out += line("checkpoints", fmt::format("{} kept, about {} each", setup.checkpoint.keep, bytes(p.checkpoint_bytes)));
  return out;
}

}  // namespace

std::string plan_text(run::Case const& setup, session::Plan const& p) {
  std::string out;
  if (!setup.title.empty()) out += line("title", setup.title);
  out += domain_text(setup, p) + scheme_text(setup, p) + line("end", end_text(setup.end)) + steps_text(p) +
         costs_text(setup, p) + "\n";
  if (has_gas(p)) {
    out += line("ambient", fmt::format("{}, {}, {:.4g} kg/m3", setup.ambient.fluid.name,
                                       quantity(setup.ambient.state.pressure, "Pa", 6), setup.ambient.state.density));
  }
  out += bodies_text(setup, p) + charges_text(setup, p) + placed_text(setup, p);
  for (MaterialLine const& m : materials_of(setup))
    out += line("material", fmt::format("{} ({}): {}", m.name, m.role, m.source));
  out += '\n';
  out += output_text(setup, p);
  std::vector<std::string> warnings;
  for (auto const& w : p.warnings) warnings.push_back(fmt::format("\nwarning: {}", w));
  return out + listed(warnings);
}

}  // namespace brisance::app
