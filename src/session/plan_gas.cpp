#include "session/plan_gas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/text.hpp"
#include "detonation/charge.hpp"
#include "gas/layout.hpp"
#include "grid/partition.hpp"
#include "output/writer.hpp"
#include "session/estimates.hpp"
#include "session/level_estimates.hpp"
#include "setup/place_gas.hpp"
#include "setup/place_initial_states.hpp"
#include "setup/place_obstacles.hpp"
#include "setup/place_panels.hpp"
#include "setup/start.hpp"
#include "shape/cut_cells.hpp"

namespace brisance::session {

double boxed_cells(shape::Shape const& shape, grid::Domain const& domain) {
  auto const box = shape::bounds(shape);
  double cells = 1.0;
  for (int d = 0; d < domain.dimensions(); ++d)
    cells *= std::max(0.0, std::min(box.upper[d], domain.upper(d)) - std::max(box.lower[d], domain.lower[d])) /
             domain.smallest_cell();
  return cells;
}

namespace {

constexpr double bytes_per_record = 100.0;  // one line of a gauge file
// Larger things are estimated: a look at a case of a thousand million cells must not take its memory or its time.
constexpr double most_cells_tried = 5e6;  // in the box around a charge
constexpr double most_blocks_tried = 1e6;
constexpr int longest_row_tried = 100'000'000;  // cells
constexpr double coarse_charge = 5.0;           // cells per charge radius below which the near field is poorly resolved
constexpr double coarse_burst = 15.0;           // cells per radius of a remapped burst below which its shock is
constexpr long most_cut_cells = 200'000;        // of initial states and obstacles that `check` counts
constexpr double coarse_obstacle = 0.2;  // fraction of its volume that an obstacle may win or lose without a warning

/// May the grid's list of blocks be made for a look at it?
bool is_small_list(grid::Domain const& domain, grid::Partition const& partition) {
  return partition.count() <= most_blocks_tried && *std::ranges::max_element(domain.cells) <= longest_row_tried;
}

/// A charge that fills too many cells to try it out.
run::ChargeReport untried_charge(run::Charge const& charge, grid::Domain const& domain, std::string const& what) {
  (void)detonation::symmetry_images(charge.shape, domain, what);  // refuses what it refuses later
  double const volume = charge.mass / charge.explosive.density();
  run::ChargeReport report;
  report.explosive = charge.explosive.name;
  report.specified_mass = charge.mass;
  report.realised_mass = std::numeric_limits<double>::quiet_NaN();
  report.realised_energy = volume * charge.explosive.energy;
  report.cells_per_radius = shape::equivalent_radius(volume, domain.geometry) / domain.smallest_cell();
  return report;
}

/// A charge that bursts in one direction first.
void plan_start(run::Case const& setup, std::size_t number, std::string const& what, Plan& p) {
  run::Charge const& charge = setup.charges[number];
  double const images = detonation::symmetry_images(charge.shape, setup.domain, what);
  run::ChargeReport report;
  report.explosive = charge.explosive.name;
  report.specified_mass = charge.mass;
  double const cell = setup.domain_of(setup.adaptive.shocks).h;  // what is remapped is a shock
  double reach = 0.0;
  double realised = 0.0;  // in the domain
  auto const planes = detonation::planes_through(setup.domain, shape::centre(charge.shape));
  double share = 1.0;
  for (int const plane : planes) share *= plane != 0 ? 0.5 : 1.0;
  if (number < setup.start.profiles.size()) {
    detonation::Profile const& profile = *setup.start.profiles[number];
    bool const half = profile.mirrored && std::abs(profile.domain.lower[1]) < 1e-6 * profile.domain.smallest_cell();
    realised = share * (half ? 2.0 : 1.0) * profile.sum(gas::partial_density(charge.fluid));
    report.cells_per_radius = profile.charge.radius / profile.domain.smallest_cell();
    reach = profile.reach();
    p.starts.push_back(fmt::format("profile \"{}\" from {}, time {}, blast wave radius {}, {:.3g} cells",
                                   setup.start.profile, word_of(profile.domain.geometry), quantity(profile.time, "s"),
                                   quantity(reach, "m"), reach / cell));
  } else if (setup.start.profile.empty()) {
    setup::StartPlan const plan = setup::plan_start(setup, number);
    run::Case const one = setup::start_case(setup, number, plan);
    grid::Grid const grid(one.domain);
    auto const ball = setup::realised_charge(one.charges.front(), grid, what);
    realised = share * ball.realised_mass;
    report.cells_per_radius = plan.charge_radius / plan.cell;
    reach = plan.radius;
    std::string const until =
        setup.start.time ? fmt::format("until {}", quantity(*setup.start.time, "s"))
        : setup.start.radius
            ? fmt::format("until the shock reaches {}", quantity(plan.radius, "m"))
            : fmt::format("until the shock reaches {}, near {}", quantity(plan.radius, "m"), plan.reach.by);
    p.starts.push_back(fmt::format("{} with {}, {} cells of {}, {}; then remapped, {:.3g} cells per radius",
                                   word_of(plan.geometry),
                                   setup.start.method == run::StartMethod::gas ? "the gas scheme" : "material points",
                                   plan.cells, quantity(plan.cell, "m"), until, reach / cell));
  } else {
    return;  // resumed: the file is not needed any more
  }
  report.realised_mass = realised * images;
  report.realised_energy = report.realised_mass * charge.explosive.specific_energy();
  p.charges.push_back(report);
  if (reach < coarse_burst * cell) {
    p.warnings.push_back(
        fmt::format("the blast wave of {} is remapped with only {:.2g} cells per radius: its shock will be coarse; a "
                    "cell size of {} would give {:g}",
                    what, reach / cell, quantity(reach / coarse_burst, "m", 2), coarse_burst));
  }
}

/// Cells whose gas obstacles part, of those that surfaces have; without a grid those of the whole domain.
std::vector<Index3> parted_cells(run::Case const& setup, setup::SolidCells const& solid, grid::Grid const* grid) {
  if (grid == nullptr || grid->levels() == 1) return shape::cut_cells(solid.shapes(), solid.domain()).parted;
  constexpr int margin = 3;  // what a cut cell is depends on its neighbours
  std::vector<Index3> parted;
  if (setup.adaptive.obstacles >= grid->levels()) return parted;
  for (int const b : grid->blocks_of(setup.adaptive.obstacles)) {
    grid::Block const& block = grid->blocks()[static_cast<std::size_t>(b)];
    if (block.covered) continue;
    grid::CellRange const own = block.in_domain();
    auto const near = grid::common(own.grown(margin, solid.domain().dimensions()), solid.domain().all_cells());
    for (Index3 const& cell : shape::cut_cells(solid.shapes(), solid.domain(), near).parted) {
      if (own.contains(cell)) parted.push_back(cell);
    }
  }
  return parted;
}

/// Obstacles thinner than a cell that part its gas.
void warn_of_parted_cells(run::Case const& setup, setup::SolidCells const& solid, grid::Grid const* grid, Plan& p) {
  if (setup.obstacles.empty() || !setup::has_cut_cells(setup)) return;
  auto const parted = parted_cells(setup, solid, grid);
  if (parted.empty()) return;
  Vec3 const x = solid.domain().centre(parted.front());
  p.warnings.push_back(fmt::format(
      "obstacles part the gas of {} cells, the first at ({:.4g}, {:.4g}, {:.4g}) m: there they are thinner than a "
      "cell, "
      "or leave a gap that is narrower; the larger piece of gas stays, the other is closed, and nothing leaks",
      parted.size(), x[0], x[1], x[2]));
}

/// Initial states and obstacles as they will be placed.
void plan_placed(run::Case const& setup, grid::Grid const* grid, detonation::TakenCells const& taken, Plan& p) {
  if (setup::InitialStatePlacing initial(setup, grid); initial.measure(most_cut_cells)) {
    initial.give_way(taken);
    p.initial_states = initial.reports();
  }
  for (std::size_t n = 0; n < setup.initial_states.size(); ++n) {
    auto const box = shape::bounds(setup.initial_states[n].shape);
    int const level = grid != nullptr ? detonation::level_of(setup.initial_states[n].shape, *grid) : 0;
    double const h = setup.domain_of(level).h;
    double across = std::numeric_limits<double>::infinity();
    for (int d = 0; d < setup.domain.dimensions(); ++d) across = std::min(across, (box.upper[d] - box.lower[d]) / h);
    if (across < 1.0) {
      p.warnings.push_back(
          fmt::format("initial state {} is only {:.2g} cells thick: its mass and energy are exact but spread over all "
                      "cells that it touches; a cell size of {} would resolve it with one cell",
                      n + 1, across, quantity(h * across, "m", 2)));
    }
  }
  grid::Domain const surfaces = setup.domain_of(setup.adaptive.obstacles);
  setup::SolidCells const solid(surfaces, setup.obstacles, setup::has_cut_cells(setup));
  if (auto obstacles = solid.reports(most_cut_cells)) {
    p.obstacles = std::move(*obstacles);
    warn_of_parted_cells(setup, solid, grid, p);
    for (run::ObstacleReport const& o : p.obstacles) {
      if (std::abs(o.excess) <= coarse_obstacle * o.specified_volume) continue;
      p.warnings.push_back(
          fmt::format("obstacle \"{}\" is {:.0f} % {} on the grid than specified: use smaller cells, or align its "
                      "faces with cell faces",
                      o.name, 100.0 * std::abs(o.excess) / o.specified_volume, o.excess > 0.0 ? "larger" : "smaller"));
    }
    p.panels = setup::place_panels(surfaces, setup.obstacles, solid);
  }
}

/// The charges, on the cells that they have at the start; the cells that they take are added to `taken`.
void plan_charges(run::Case const& setup, grid::Grid const* grid, detonation::TakenCells& taken, Plan& p) {
  int number = 0;
  for (run::Charge const& charge : setup.charges) {
    ++number;
    std::string const what = setup.charges.size() == 1 ? "the charge" : fmt::format("charge {}", number);
    if (setup.start.remap) {
      plan_start(setup, number - 1, what, p);
      continue;
    }
    int const level = grid != nullptr ? detonation::level_of(charge.shape, *grid) : setup.adaptive.charges;
    grid::Domain const domain = setup.domain_of(level);
    setup::SolidCells const solid(domain, setup.obstacles);
    std::function<double(Index3 const&)> open;
    if (solid.any()) open = [&](Index3 const& cell) { return setup::open_part(setup, solid, cell); };
    if (double const around = boxed_cells(charge.shape, domain); grid != nullptr && around <= most_cells_tried) {
      p.charges.push_back(setup::realised_charge(charge, *grid, what, open, &taken, level));
    } else {
      p.charges.push_back(untried_charge(charge, domain, what));
      p.warnings.push_back(fmt::format(
          "{} lies in a box of {} cells in a grid of {} blocks, too many to compute its mass on the grid in advance",
          what, large_count(around), large_count(p.blocks)));
    }
    double const resolution = p.charges.back().cells_per_radius;
    if (resolution < coarse_charge) {
      p.warnings.push_back(fmt::format(
          "{} has only {:.2g} cells per radius: the near field will be coarse; a cell size of {} would give {:g}", what,
          resolution, quantity(domain.smallest_cell() * resolution / coarse_charge, "m", 2), coarse_charge));
    }
  }
}

/// Cells, blocks and steps, and the grid if it is small enough for a look.
std::optional<grid::Grid> plan_grid(run::Case const& setup, Plan& p) {
  p.steps = estimated_steps(setup);
  std::optional<grid::Grid> grid;
  if (setup.adaptive.any()) {
    StartLevels start = start_levels(setup);
    p.levels = plan_levels(setup, start);
    grid = std::move(start.grid);
    p.cells = 0.0;
    p.cell_updates = 0.0;
    for (std::size_t l = 0; l < p.levels.size(); ++l) {
      p.cells += p.levels[l].most;
      p.cell_updates += p.levels[l].mean * std::ldexp(p.steps, static_cast<int>(l));
    }
    for (std::size_t b = 0; grid && b < grid->blocks().size(); ++b) p.blocks += grid->blocks()[b].covered ? 0 : 1;
    add_level_memory(setup, grid ? &*grid : nullptr, p);
    return grid;
  }
  grid::Partition const partition = grid::partition_of(setup.domain, setup.numerics.block_cells);
  p.blocks = static_cast<decltype(p.blocks)>(partition.count());
  p.cell_updates = p.cells * p.steps;
  add_gas_memory(setup, partition, p);
  if (is_small_list(setup.domain, partition)) grid.emplace(setup.domain, setup.numerics.block_cells);
  return grid;
}

}  // namespace

void plan_gas(run::Case const& setup, Plan& p) {
  std::optional<grid::Grid> const tried = plan_grid(setup, p);
  grid::Grid const* const grid = tried ? &*tried : nullptr;
  detonation::TakenCells taken;
  plan_charges(setup, grid, taken, p);
  plan_placed(setup, grid, taken, p);
  double const values = gas_components(setup) + (setup.output.peak_fields ? peak_components : 0.0);
  p.checkpoint_bytes = p.cells * values * double_bytes;
  auto const bytes_of_dump = [&](output::IsLast last) {
    double const uniform = output::FieldSeries::bytes_per_dump(setup.domain, output::dumped_fields(setup, last),
                                                               setup.output.single_precision);
    return setup.adaptive.any() ? uniform / static_cast<double>(setup.domain.cell_count()) * p.cells : uniform;
  };
  p.dump_bytes = bytes_of_dump(output::IsLast::no);
  p.last_dump_bytes = bytes_of_dump(output::IsLast::yes);
  double const records =
      setup.output.gauge_interval > 0.0 ? std::min(p.steps, setup.end.time / setup.output.gauge_interval) : p.steps;
  p.gauge_bytes = records * bytes_per_record * static_cast<double>(setup.gauges.size());
  p.gauges = plan_gauges(setup);
  double const front = setup.domain_of(setup.adaptive.shocks).h;
  if (auto const warning = clipping_warning(p.gauges, front)) p.warnings.push_back(*warning);
}

}  // namespace brisance::session
