#include "app/run_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/gauge_text.hpp"
#include "app/print.hpp"
#include "app/text.hpp"
#include "core/parallel.hpp"
#include "core/simd.hpp"
#include "observe/particle_summary.hpp"
#include "observe/zones.hpp"
#include "output/run_log.hpp"

namespace brisance::app {

namespace {

constexpr std::size_t most_rows = 30;  // gauges that the terminal's table shows

void print_guards(run::Audit const& a) {
  if (a.guarded_cells == 0) return;
  print(stdout, "guards: {} cell updates were raised to the floors, which added {:.3g} kg and {:.3g} J\n",
        a.guarded_cells, a.guard_mass, a.guard_energy);
}

void print_panels(run::World const& world) {
  if (world.panels == nullptr) return;
  print(stdout, "\n");
  std::size_t shown = 0;
  auto const& panels = world.panels->reports();
  for (run::PanelReport const& p : panels) {
    if (++shown > most_rows) break;
    print(stdout, "panel {}: {}\n", p.name, panel_in_words(p, world.setup.domain));
  }
  if (panels.size() > most_rows) print(stdout, "... and {} more panels in summary.json\n", panels.size() - most_rows);
  auto const& a = world.audit;
  double const mass = a.panels.total();
  if (mass == 0.0 && a.panels.energy == 0.0) return;
  print(stdout, "panels: the cells that opened added {:+.3g} kg and {} relative to ambient gas\n", mass,
        quantity(a.panels.energy, "J", 3));
}

/// Errors of the masses of the fluids beside the ambient one.
std::string other_errors(run::World const& world) {
  auto const error = world.audit.relative_error();
  std::string text;
  for (int k = 1; k < world.gas->fluids().count; ++k) text += fmt::format(", second fluid {:.1e}", error.mass[k]);
  return text;
}

void print_audit(run::World const& world) {
  auto const error = world.audit.relative_error();
  print(stdout, "\naudit: {} (relative error of the mass: {} {:.1e}{}; of the energy {:.1e})\n{}",
        verdict_word(world.verdict()), world.setup.ambient.fluid.name, error.mass[0], other_errors(world), error.energy,
        verdict_reasons(world.verdict(), world.for_comparison()));
  auto const& a = world.audit;
  print_guards(a);
  if (world.setup.afterburn) {
    print(stdout, "afterburn: the products released {} of {}\n", quantity(a.afterburn_energy, "J"),
          quantity(world.setup.afterburn->energy * a.initial.mass[gas::products_fluid], "J"));
  }
  if (a.fallback_faces > 0)
    print(stdout, "fluxes: {} were blended with first-order fluxes to keep density and pressure positive\n",
          a.fallback_faces);
}

std::string vector_text(Vec3 const& v, char const* unit, int dimensions) {
  std::string text;
  for (int d = 0; d < dimensions; ++d) text += (d == 0 ? "" : ", ") + quantity(v[d], unit);
  return dimensions == 1 ? text : "(" + text + ")";
}

void print_particles(run::World const& world, observe::Gauges const& histories) {
  auto const gauges = observe::summarise_particles(world, histories);
  auto const bodies = observe::summarise_bodies(world, histories);
  int const dims = world.setup.domain.dimensions();
  if (!gauges.empty()) {
    std::size_t width = 5;
    for (auto const& g : gauges) width = std::max(width, g.name.size());
    print(stdout, "\n{:<{}}  {:>14} {:>11} {:>15} {:>13} {:>12} {:>10}   {}\n", "gauge", width, "peak displ.", "at",
          "component", "peak speed", "peak Mises", "pl. strain", "final displacement");
    for (std::size_t n = 0; n < std::min(gauges.size(), most_rows); ++n) {
      auto const& g = gauges[n];
      print(stdout, "{:<{}}  {:>14} {:>11} {:>15} {:>13} {:>12} {:>10.3g}   {}{}\n", g.name, width,
            quantity(g.displacement.value, "m"), quantity(g.displacement.time, "s"),
            fmt::format("{} {}", "xyz"[g.component], quantity(g.component_displacement.value, "m")),
            quantity(g.velocity.value, "m/s"), quantity(g.mises.value, "Pa"), g.plastic_strain,
            vector_text(g.final_displacement, "m", dims), g.lost ? " (left the domain)" : "");
    }
    if (gauges.size() > most_rows) print(stdout, "... and {} more in summary.csv\n", gauges.size() - most_rows);
  }
  std::size_t width = 4;
  for (auto const& b : bodies) width = std::max(width, b.body.size());
  print(stdout, "\n{:<{}}  {:>12} {:>12} {:>12} {:>12} {:>12}   {}\n", "body", width, "mass", "deflection", "kinetic",
        "internal", "plastic", "mean velocity");
  std::vector<std::string> shown;
  for (auto const& b : bodies) {
    // A body that several gauges watch has one row.
    if (std::find(shown.begin(), shown.end(), b.body) != shown.end()) continue;
    shown.push_back(b.body);
    if (shown.size() > most_rows) continue;
    Vec3 const v = b.end.mass > 0.0 ? (1.0 / b.end.mass) * b.end.momentum : Vec3{0.0, 0.0, 0.0};
    print(stdout, "{:<{}}  {:>12} {:>12} {:>12} {:>12} {:>12}   {}\n", b.body, width, quantity(b.end.mass, "kg"),
          quantity(b.displacement.value, "m"), quantity(b.end.kinetic_energy, "J"),
          quantity(b.end.internal_energy, "J"), quantity(b.end.plastic_work, "J"), vector_text(v, "m/s", dims));
  }
  if (shown.size() > most_rows) print(stdout, "... and {} more in summary.csv\n", shown.size() - most_rows);
}

/// What is broken of the bodies of concrete, and how it looks from their faces.
void print_broken_zones(run::World const& world) {
  for (auto const& zones : observe::broken_zones(world)) {
    print(stdout, "\n{}: crushed {}, cracked {}, more than half damaged {}\n", world.bodies[zones.body].name,
          quantity(zones.crushed.mass, "kg"), quantity(zones.cracked.mass, "kg"), quantity(zones.damaged.mass, "kg"));
    for (auto const& face : zones.faces) {
      if (face.crushed_depth == 0.0 && face.cracked_depth == 0.0 && !face.spall_depth) continue;
      print(stdout, "  face {:<7} crushed: diameter {}, depth {}; cracked: diameter {}, depth {}{}\n",
            grid::face_names[static_cast<int>(face.face)], quantity(face.crushed_diameter, "m"),
            quantity(face.crushed_depth, "m"), quantity(face.cracked_diameter, "m"), quantity(face.cracked_depth, "m"),
            face.spall_depth ? fmt::format("; spall at {}", quantity(*face.spall_depth, "m")) : "");
    }
  }
}

/// Kinetic energy that the particles lost, where it is known.
void print_dissipation(run::EnergyBalance const& energy) {
  auto const& [constraints, filtered, apic, friction, damping] = energy.dissipated;
  if (constraints == 0.0 && filtered == 0.0 && apic == 0.0 && friction == 0.0 && damping == 0.0) return;
  print(stdout,
        "kinetic energy dissipated and accounted for: {} at constrained nodes, {} by PIC and XPIC, {} by APIC, {} by "
        "contact friction{}; {:.2g} % of the reference energy\n",
        quantity(constraints, "J"), quantity(filtered, "J"), quantity(apic, "J"), quantity(friction, "J"),
        damping != 0.0 ? fmt::format(", {} by damping", quantity(damping, "J")) : "",
        energy.scale > 0.0 ? 100.0 * energy.dissipated.sum() / energy.scale : 0.0);
}

/// Energy that gas particles were given because they had less than none.
void print_lifted(run::World const& world) {
  mpm::FloorCount const floored = world.accounts().floored;
  if (floored.particles == 0) return;
  print(stdout, "guards: {} updates of gas particles were raised to zero pressure, which added {:.3g} J\n",
        floored.particles, floored.energy);
}

void print_particle_audit(run::World const& world) {
  auto const& a = world.audit;
  auto const energy = world.energy_balance();
  print(stdout,
        "\naudit: {} (relative error of the mass {:.1e}; energy {} to {}{}, drift {:+.3g} % of the reference energy "
        "{})\n{}",
        verdict_word(world.verdict()), a.relative_error().mass[0], quantity(energy.initial, "J"),
        quantity(energy.current + energy.lost, "J"),
        energy.work != 0.0 ? fmt::format(" through the work {} of external forces", quantity(energy.work, "J")) : "",
        100.0 * energy.drift(), quantity(energy.scale, "J"), verdict_reasons(world.verdict(), world.for_comparison()));
  print_dissipation(energy);
  print_lifted(world);
  mpm::Losses const lost = world.accounts().losses;
  if (lost.particles > 0) {
    print(stdout, "{} particles left the domain with {:.4g} kg and {}\n", lost.particles, lost.mass,
          quantity(lost.energy, "J"));
  }
}

/// Of the time that the run took.
double bridge_percent(run::World const& world) {
  double total = 0.0;
  for (auto const& [phase, seconds] : world.timings) total += seconds;
  auto const bridge = world.timings.find("bridge");
  return total > 0.0 && bridge != world.timings.end() ? 100.0 * bridge->second / total : 0.0;
}

/// What happened in one of the regions. What is measured of all together stands with one that is alone.
void print_region(run::World const& world, std::size_t number) {
  run::Region const& region = world.regions[number];
  bool const alone = world.regions.size() == 1;
  std::string const name = alone ? "MPM region" : fmt::format("MPM region {}", number + 1);
  if (!region.awake_since) {
    print(stdout, "{}: no wave reached it; its particles stayed asleep\n", name);
    return;
  }
  bridge::Traffic const& traffic = region.bridge->traffic();
  print(
      stdout,
      "{}: awake since {}; {} gas steps, {} MPM sub-steps; {} gas particles injected, {} absorbed; {} in the ledger at "
      "the end{}\n",
      name, quantity(*region.awake_since, "s"), world.clock.gas_steps, region.steps, traffic.injected, traffic.absorbed,
      quantity(region.bridge->ledger().total(), "kg", 3),
      alone ? fmt::format(" (at most {} during the run); the bridge took {:.0f} % of the time",
                          quantity(world.audit.memory.content, "kg", 3), bridge_percent(world))
            : "");
}

void print_region_audit(run::World const& world) {
  auto const error = world.audit.relative_error();
  auto const energy = world.energy_balance();
  print(stdout,
        "\naudit: {} (relative error of the mass: {} {:.1e}{}; energy {} to {}, drift {:+.3g} % of the reference "
        "energy {})\n{}",
        verdict_word(world.verdict()), world.setup.ambient.fluid.name, error.mass[0], other_errors(world),
        quantity(energy.initial, "J"), quantity(energy.current + energy.lost, "J"), 100.0 * energy.drift(),
        quantity(energy.scale, "J"), verdict_reasons(world.verdict(), world.for_comparison()));
  print_dissipation(energy);
  print_lifted(world);
  print_guards(world.audit);
  for (std::size_t number = 0; number < world.regions.size(); ++number) print_region(world, number);
  if (world.regions.size() > 1 && std::ranges::any_of(world.regions, &run::Region::moves)) {
    print(stdout, "MPM regions: at most {} in all ledgers during the run; the bridges took {:.0f} % of the time\n",
          quantity(world.audit.memory.content, "kg", 3), bridge_percent(world));
  }
}

}  // namespace

void print_head(session::Session const& session, std::string const& title) {
  session::Plan const& expected = session.plan();
  auto const* const checkpoint = session.checkpoint();
  if (!title.empty()) print(stdout, "{}\n", title);
  std::string const particles = fmt::format("{} material points", large_count(expected.particles));
  std::string const cells = fmt::format("{} cells", large_count(expected.cells));
  std::string const what = !expected.regions.empty()  ? cells + " and " + particles
                           : expected.particles > 0.0 ? particles
                                                      : cells;
  print(stdout, "{}, about {} steps, {} thread{}{}; output folder: {}\n", what, large_count(expected.steps), threads(),
        threads() == 1 ? "" : "s", checkpoint == nullptr ? fmt::format(", {}", word_of(simd_set())) : "",
        session.folder().string());
  for (auto const& body : expected.bodies) {
    print(stdout, "{}: {}, {} particles, {:.8g} kg, mass of the shape {:.8g} kg\n", body.name, body.material,
          body.particles, body.mass, body.geometric_mass);
  }
  for (auto const& charge : expected.charges) {
    bool const tried = std::isfinite(charge.realised_mass);
    print(stdout, "{}: specified {:.8g} kg, {}{}\n", charge.explosive, charge.specified_mass,
          tried ? fmt::format("realised {:.8g} kg and ", charge.realised_mass) : "",
          quantity(charge.realised_energy, "J"));
  }
  std::vector<std::string> warnings;
  for (auto const& warning : expected.warnings) warnings.push_back("warning: " + warning);
  print(stderr, "{}", listed(warnings));
  if (checkpoint != nullptr) {
    print(stdout, "resuming from {}: t = {}, step {}\n", checkpoint->path().string(),
          quantity(checkpoint->info().time, "s"), checkpoint->info().step);
  }
  std::fflush(stdout);
}

void print_starts(run::World const& world) {
  for (std::size_t n = 0; n < world.starts.size(); ++n) {
    auto const& report = world.starts[n];
    auto const& r = report.remap;
    print(stdout, "{}: {}, remapped at {}; blast wave radius {}, {:.1f} cells{}\n",
          world.starts.size() == 1 ? "start" : fmt::format("start {}", n + 1),
          output::start_in_words(world.setup, report), quantity(r.time, "s"), quantity(r.radius, "m"),
          r.cells_per_radius, report.by.empty() ? "" : ", near " + report.by);
    print(stdout,
          "remap: {} {:.8g} kg, products {:.8g} kg and {} became {:.8g} kg, {:.8g} kg and {}; relative error {:.1e}\n",
          world.setup.ambient.fluid.name, r.before.mass[0], r.before.mass[gas::products_fluid],
          quantity(r.before.energy, "J", 6), r.after.mass[0], r.after.mass[gas::products_fluid],
          quantity(r.after.energy, "J", 6), r.error());
  }
}

void print_results(run::World const& world, observe::Gauges const& gauges) {
  if (world.coupled()) {
    print(stdout, "{}", gauge_tables(world.setup, gauges.gas));
    print_particles(world, gauges);
    print_broken_zones(world);
    print_panels(world);
    print_region_audit(world);
  } else if (!world.regions.empty()) {
    print_particles(world, gauges);
    print_broken_zones(world);
    print_particle_audit(world);
  } else {
    print(stdout, "{}", gauge_tables(world.setup, gauges.gas));
    print_panels(world);
    print_audit(world);
  }
  if (world.adaptation != nullptr && world.adaptation->held_back()) {
    print(stdout,
          "warning: the limit adaptive.cells = {:g} was reached: weak shocks stayed on cells larger than "
          "adaptive.shocks\n",
          world.setup.adaptive.most_cells);
  }
}

}  // namespace brisance::app
