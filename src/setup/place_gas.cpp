#include "setup/place_gas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "detonation/charge.hpp"
#include "gas/place_obstacles.hpp"
#include "run/system.hpp"
#include "setup/fluids.hpp"
#include "setup/levels.hpp"
#include "setup/place_initial_states.hpp"
#include "setup/place_obstacles.hpp"
#include "setup/place_panels.hpp"
#include "setup/solid_cells.hpp"
#include "setup/start.hpp"

namespace brisance::setup {

namespace {

/// Where the waves come from that outflow boundaries are to let out.
std::vector<gas::WaveSource> wave_sources(Case const& c) {
  std::vector<gas::WaveSource> sources;
  auto const add = [&](shape::Shape const& shape) {
    gas::WaveSource source;
    shape::Box const box = shape::bounds(shape);
    source.position = shape::centre(shape);
    for (int d = 0; d < c.domain.dimensions(); ++d) {
      double const slack = 0.5 * c.domain.smallest_cell();
      source.spans[d] = box.lower[d] <= c.domain.lower[d] + slack && box.upper[d] >= c.domain.upper(d) - slack;
      // Of a shape that reaches out of the domain only the part inside is there.
      if (box.lower[d] < c.domain.lower[d] || box.upper[d] > c.domain.upper(d)) {
        double const inside =
            0.5 * (std::max(box.lower[d], c.domain.lower[d]) + std::min(box.upper[d], c.domain.upper(d)));
        bool const cut_at_middle = std::abs(source.position[d] - c.domain.lower[d]) < slack ||
                                   std::abs(source.position[d] - c.domain.upper(d)) < slack;
        if (!cut_at_middle) source.position[d] = inside;
      }
    }
    sources.push_back(source);
  };
  for (Charge const& charge : c.charges) add(charge.shape);
  for (Body const& body : c.particles.bodies) {
    if (body.solid.burns()) add(body.shape);
  }
  if (sources.empty()) {
    for (InitialState const& initial : c.initial_states) add(initial.shape);
  }
  // A wind is disturbed by what stands in it.
  if (sources.empty() && norm(c.ambient.state.velocity) > 0.0) {
    for (Obstacle const& obstacle : c.obstacles) add(obstacle.shape);
    for (Body const& body : c.particles.bodies) add(body.shape);
  }
  return sources;
}

gas::Options options_of(Case const& c) {
  gas::Options o;
  o.scheme = c.numerics.scheme;
  o.beta = c.numerics.limiter_beta;
  o.carbuncle_cure = c.numerics.carbuncle_cure;
  o.density_floor = c.numerics.density_floor;
  o.pressure_floor = c.numerics.pressure_floor;
  o.viscosity = c.numerics.viscosity;
  o.sleep = c.numerics.sleep;
  o.peak_fields = c.output.peak_fields;
  o.afterburn = c.afterburn;
  o.wave_sources = wave_sources(c);
  return o;
}

/// Puts the charges into their cells. What burns in them goes into `plan`.
detonation::TakenCells place_charges(run::System& w, std::shared_ptr<detonation::BurnPlan>& plan) {
  Case const& setup = w.setup;
  gas::Gas& gas = *w.gas;
  grid::Grid const& grid = w.grid;
  std::vector<detonation::BurningCharge> burning;
  detonation::TakenCells taken;
  std::function<double(Index3 const&)> open;
  int number = 0;
  for (Charge const& charge : setup.charges) {
    ++number;
    int const level = detonation::level_of(charge.shape, grid);
    if (!setup.obstacles.empty())
      open = [&gas, level](Index3 const& cell) {
        auto const found = gas.grid().locate(level, cell);
        return found ? gas::open_part(gas, *found) : 1.0;
      };
    std::string const what = setup.charges.size() == 1 ? "the charge" : fmt::format("charge {}", number);
    double const density = charge.explosive.density();
    detonation::FilledCells const filled =
        detonation::fill_cells(charge.shape, grid, charge.mass / density, what, open, level);
    // What the cells really hold, not what they were meant to: read before and after.
    auto const products = [&] {
      double mass = 0.0;
      for (Index3 const& index : filled.cells) {
        grid::Cell const cell = grid.locate(level, index).value();
        mass += gas.fields().at(cell.block, gas::partial_density(charge.fluid))[cell.offset] * gas.cut.volume(cell);
      }
      return mass;
    };
    double const before = products();
    detonation::place_charge(gas, filled, charge.explosive, taken);
    if (charge.detonation == Detonation::programmed) {
      burning.push_back({charge.shape, charge.initiation, charge.explosive});
    } else {
      detonation::expect_instantaneous_burst(gas, charge.shape, charge.explosive.detonation_speed);
    }

    run::ChargeReport report;
    report.explosive = charge.explosive.name;
    report.specified_mass = charge.mass;
    report.realised_mass = (products() - before) * filled.images;
    report.realised_energy = report.realised_mass * charge.explosive.specific_energy();
    report.cells_per_radius = shape::equivalent_radius(report.realised_mass / density, setup.domain.geometry) /
                              grid.domain(level).smallest_cell();
    w.charges.push_back(report);
  }
  if (!burning.empty()) plan = std::make_shared<detonation::BurnPlan>(gas, std::move(burning));
  return taken;
}

}  // namespace

void place_gas(run::System& w) {
  Case const& setup = w.setup;
  w.gas = std::make_unique<gas::Gas>(w.grid, fluids_of(setup), options_of(setup), setup.ambient.state, setup.inflow);
  gas::Gas& gas = *w.gas;
  InitialStatePlacing initial(setup, &w.grid);
  initial.fill(gas);
  int const obstacle_level = setup.adaptive.obstacles;
  SolidCells const solid(setup.domain_of(obstacle_level), setup.obstacles, has_cut_cells(setup));
  std::shared_ptr<LevelObstacles const> obstacles;
  if (setup.adaptive.any()) {
    obstacles = std::make_shared<LevelObstacles const>(setup);
    if (obstacles->any())
      gas.obstacles.set_elsewhere([obstacles](int level, Index3 const& cell) { return obstacles->solid(level, cell); });
    place_obstacles(setup, *obstacles, gas);
  } else {
    place_obstacles(setup, solid, gas);
  }
  std::shared_ptr<detonation::BurnPlan> burn;
  if (!setup.start.remap) initial.give_way(place_charges(w, burn));
  w.initial_states = initial.reports();
  if (solid.any()) {
    w.obstacles = *solid.reports(std::numeric_limits<long>::max());
    auto panels = place_panels(setup.domain_of(obstacle_level), setup.obstacles, solid);
    for (run::PanelReport& panel : panels) panel.place.level = obstacle_level;
    if (!panels.empty()) w.panels = std::make_unique<run::Panels>(std::move(panels));
  }
  if (setup.start.remap && !setup.start.from_checkpoint) place_start(w);
  if (!setup.adaptive.any()) return;
  w.adaptation =
      std::make_unique<run::Adaptation>(refinement_rules(setup, obstacles), steps_between_changes(setup),
                                        [obstacles, burn](gas::Gas& changed, std::vector<int> const& new_blocks) {
                                          obstacles->furnish(changed, new_blocks);
                                          if (burn != nullptr && changed.burn.burning())
                                            burn->set_times(changed, new_blocks);
                                        });
}

run::ChargeReport realised_charge(Charge const& charge, grid::Grid const& grid, std::string const& what,
                                  std::function<double(Index3 const&)> const& open, detonation::TakenCells* taken,
                                  int level) {
  double const density = charge.explosive.density();
  auto const filled = detonation::fill_cells(charge.shape, grid, charge.mass / density, what, open, level);
  grid::Domain const& domain = grid.domain(level);
  double volume = 0.0;
  for (std::size_t n = 0; n < filled.cells.size(); ++n) {
    double const part = open ? open(filled.cells[n]) : 1.0;
    volume += filled.fractions[n] * part * domain.cell_volume(filled.cells[n][0]);
    if (taken != nullptr) (*taken)[{level, filled.cells[n]}] += filled.fractions[n];
  }
  run::ChargeReport report;
  report.explosive = charge.explosive.name;
  report.specified_mass = charge.mass;
  report.realised_mass = volume * filled.images * density;
  report.realised_energy = volume * filled.images * charge.explosive.energy;
  report.cells_per_radius = shape::equivalent_radius(volume * filled.images, domain.geometry) / domain.smallest_cell();
  return report;
}

}  // namespace brisance::setup
