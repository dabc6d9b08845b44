#include "run/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/timer.hpp"
#include "observe/gas_view.hpp"
#include "setup/place_bodies.hpp"
#include "setup/place_region.hpp"

namespace brisance::run {

gas::Fluids fluids_of(Case const& c) {
  gas::Fluids fluids;
  fluids.ambient = c.ambient.fluid.eos;
  fluids.ambient_pressure = c.ambient.state.pressure;
  if (!c.charges.empty()) {
    fluids.two = true;
    fluids.second = c.charges.front().explosive.products;
  } else if (c.second_fluid) {
    fluids.two = true;
    fluids.second = c.second_fluid->eos;
  }
  return fluids;
}

gas::MixtureState ambient_mixture(FluidState const& state) {
  gas::MixtureState m;
  m.ambient_density = state.density;
  m.pressure = state.pressure;
  m.velocity = state.velocity;
  return m;
}

namespace {

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
  return o;
}

void place_obstacles(Case const& c, std::vector<std::uint8_t> const& flags, grid::Grid const& grid, gas::Gas& gas,
                     gas::MixtureState const& ambient) {
  grid::Domain const& domain = grid.domain();
  auto const is_solid = [&](Index3 const& cell) {
    return flags[static_cast<std::size_t>(cell[0]) +
                 static_cast<std::size_t>(domain.cells[0]) *
                     (static_cast<std::size_t>(cell[1]) +
                      static_cast<std::size_t>(domain.cells[1]) * static_cast<std::size_t>(cell[2]))] != 0;
  };
  if (c.obstacles.empty()) return;
  for (int b = 0; b < grid.block_count(); ++b) {
    grid::Block const& block = grid.blocks()[b];
    gas::PaddedBox const box(block, domain.dimensions());
    std::vector<std::uint8_t> solid(static_cast<std::size_t>(box.count()), 0);
    bool any = false;
    for (int k = -box.pad[2]; k < block.n[2] + box.pad[2]; ++k) {
      for (int j = -box.pad[1]; j < block.n[1] + box.pad[1]; ++j) {
        for (int i = -box.pad[0]; i < block.n[0] + box.pad[0]; ++i) {
          Index3 const cell{block.origin[0] + i, block.origin[1] + j, block.origin[2] + k};
          if (!is_solid(grid::image_cell(domain, cell))) continue;
          solid[box.offset(i, j, k)] = 1;
          any = true;
          bool const own = i >= 0 && j >= 0 && k >= 0 && i < block.n[0] && j < block.n[1] && k < block.n[2];
          if (own) gas.set(b, block.offset(i, j, k), ambient);
        }
      }
    }
    if (any) gas.set_obstacles(b, std::move(solid));
  }
}

/// Where the waves come from that outflow boundaries are to let out.
std::vector<gas::WaveSource> wave_sources(Case const& c) {
  std::vector<gas::WaveSource> sources;
  auto const add = [&](shape::Shape const& shape) {
    gas::WaveSource source;
    shape::Box const box = shape::bounds(shape);
    source.position = shape::centre(shape);
    for (int d = 0; d < c.domain.dimensions(); ++d) {
      double const slack = 0.5 * c.domain.h;
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
  for (Body const& body : c.points.bodies) {
    if (body.solid.burns()) add(body.shape);
  }
  if (sources.empty()) {
    for (Region const& region : c.regions) add(region.shape);
  }
  // A wind is disturbed by what stands in it.
  if (sources.empty() && norm(c.ambient.state.velocity) > 0.0) {
    for (Obstacle const& obstacle : c.obstacles) add(obstacle.shape);
    for (Body const& body : c.points.bodies) add(body.shape);
  }
  return sources;
}

detonation::TakenCells place_charges(World& w, setup::SolidCells const& solid);

void place_gas(World& w) {
  Case const& setup = w.setup;
  std::array<gas::MixtureState, 6> inflow;
  for (int face = 0; face < 6; ++face) inflow[face] = ambient_mixture(setup.inflow[face]);
  w.gas = std::make_unique<gas::Gas>(w.grid, fluids_of(setup), options_of(setup), ambient_mixture(setup.ambient.state),
                                     inflow);
  gas::Gas& gas = *w.gas;
  gas.set_wave_sources(wave_sources(setup));
  grid::Grid const& grid = w.grid;
  gas::MixtureState const ambient = ambient_mixture(setup.ambient.state);
  setup::RegionPlacing regions(setup);
  regions.fill(gas);
  setup::SolidCells const solid(setup.domain, setup.obstacles);
  if (!setup.start.remap) regions.give_way(place_charges(w, solid));
  w.regions = regions.reports();
  if (solid.any()) {
    place_obstacles(setup, solid.all(), grid, gas, ambient);
    w.obstacles = *solid.reports(std::numeric_limits<long>::max());
    bool const panels =
        std::any_of(setup.obstacles.begin(), setup.obstacles.end(), [](Obstacle const& o) { return o.release; });
    if (panels) w.panels = std::make_unique<Panels>(setup.domain, setup.obstacles, solid);
  }
  for (Gauge const& gauge : setup.gauges) w.gauges.push_back({gauge, {}});
  if (!setup.start.remap || setup.start.from_checkpoint) return;
  // Until the remap the gauges hold ambient gas.
  FluidState const& quiet = setup.ambient.state;
  for (GaugeHistory& history : w.gauges)
    history.records.push_back({0.0, quiet.pressure, quiet.density, quiet.velocity});
  setup::place_start(w);
}

detonation::TakenCells place_charges(World& w, setup::SolidCells const& solid) {
  Case const& setup = w.setup;
  gas::Gas& gas = *w.gas;
  grid::Grid const& grid = w.grid;
  std::vector<detonation::BurningCharge> burning;
  detonation::TakenCells taken;
  std::function<bool(Index3 const&)> is_solid;
  if (solid.any()) is_solid = [&](Index3 const& cell) { return solid(cell); };
  int number = 0;
  for (Charge const& charge : setup.charges) {
    ++number;
    std::string const what = setup.charges.size() == 1 ? "the charge" : fmt::format("charge {}", number);
    double const density = charge.explosive.density();
    detonation::FilledCells const filled =
        detonation::fill_cells(charge.shape, grid, charge.mass / density, what, is_solid);
    // What the cells really hold, not what they were meant to: read before and after.
    auto const products = [&] {
      double mass = 0.0;
      for (Index3 const& cell : filled.cells) {
        int const b = grid.block_of(cell);
        Index3 const& o = grid.blocks()[b].origin;
        int const at = grid.blocks()[b].offset(cell[0] - o[0], cell[1] - o[1], cell[2] - o[2]);
        mass += gas.fields().at(b, gas::second_density)[at] * setup.domain.cell_volume(cell[0]);
      }
      return mass;
    };
    double const before = products();
    detonation::place_charge(gas, filled, charge.explosive, taken);
    if (charge.detonation == Detonation::programmed) {
      burning.push_back({charge.shape, charge.initiation});
    } else {
      detonation::expect_instantaneous_burst(gas, charge.shape, charge.explosive.detonation_speed);
    }

    ChargeReport report;
    report.explosive = charge.explosive.name;
    report.asked_mass = charge.mass;
    report.realised_mass = (products() - before) * filled.images;
    report.realised_energy = report.realised_mass * charge.explosive.specific_energy();
    report.cells_per_radius =
        shape::equivalent_radius(report.realised_mass / density, setup.domain.geometry) / setup.domain.h;
    w.charges.push_back(report);
  }
  if (!burning.empty()) detonation::set_programmed_burn(gas, burning, setup.charges.front().explosive);
  return taken;
}

}  // namespace

World::World(Case c) : setup(std::move(c)), grid(setup.domain, setup.numerics.block_cells) {
  if (setup.points.any() && !setup.mpm_region) {
    setup::place_bodies(*this, setup.domain);
  } else {
    place_gas(*this);
    if (setup.mpm_region) setup::place_region(*this);
    gas->start(clock.time);
    if (points != nullptr) points->set_time(clock.time);
    if (bridge != nullptr && bridge->awake()) awake_since = clock.time;
  }
  start_audit();
}

World::~World() = default;

bool World::finished() const {
  bool const time_over = clock.time >= setup.end.time * (1.0 - 1e-12);
  return time_over || (setup.end.steps > 0 && clock.step >= setup.end.steps) || bodies_have_left();
}

bool World::bodies_have_left() const { return gas == nullptr && points->point_count() == 0; }

long World::active_cells() const {
  if (gas == nullptr) return 0;
  long count = 0;
  for (int b = 0; b < grid.block_count(); ++b) {
    if (gas->awake(b)) count += grid.blocks()[b].cell_count();
  }
  return count;
}

}  // namespace brisance::run
