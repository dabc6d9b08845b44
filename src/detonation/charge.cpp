#include "detonation/charge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "core/error.hpp"

namespace brisance::detonation {

double symmetry_images(shape::Shape const& shape, grid::Domain const& domain, std::string const& what) {
  shape::Box const box = bounds(shape);
  Vec3 const middle = centre(shape);
  double const slack = 1e-6 * domain.smallest_cell();
  double images = 1.0;
  for (int d = 0; d < domain.dimensions(); ++d) {
    for (int side = 0; side < 2; ++side) {
      double const plane = side == 0 ? domain.lower[d] : domain.upper(d);
      bool const crosses = side == 0 ? box.lower[d] < plane - slack : box.upper[d] > plane + slack;
      if (!crosses) continue;
      bool const axis = d == 0 && side == 0 && grid::radial_exponent(domain.geometry) > 0;
      if (axis && std::abs(plane) < slack && std::abs(middle[0]) < slack) continue;  // the volumes count the whole body
      if (domain.boundary[2 * d + side] != grid::Boundary::symmetry) {
        throw InputError(fmt::format(
            "{} extends beyond the {} boundary of the domain ({} = {:.6g} m); move it, enlarge the domain, use a "
            "symmetry plane through its centre, or use shape = \"hemisphere\" for a charge on the ground",
            what, side == 0 ? "low" : "high", "xyz"[d], plane));
      }
      if (std::abs(middle[d] - plane) > slack) {
        throw InputError(fmt::format(
            "{} is cut by the symmetry plane {} = {:.6g} m but its centre is at {} = {:.6g} m: it would overlap its "
            "own mirror image; put the centre on the plane or the whole charge inside the domain",
            what, "xyz"[d], plane, "xyz"[d], middle[d]));
      }
      images *= 2.0;
    }
  }
  return images;
}

namespace {

/// The cells that the shape's bounds reach into.
grid::CellRange cells_of(shape::Shape const& shape, grid::Grid const& grid, int level) {
  shape::Box const box = bounds(shape);
  Index3 const last = grid.cell_at(level, box.upper);
  return {grid.cell_at(level, box.lower), {last[0] + 1, last[1] + 1, last[2] + 1}};
}

/// Is there a leaf's cell at an index in the domain of a level?
void require_cell(grid::Grid const& grid, int level, Index3 const& cell, std::string const& what) {
  auto const found = grid.locate(level, cell);
  if (found && !grid.block(*found).is_covered(*found)) return;
  throw InputError(
      fmt::format("{} lies in cells of different sizes; refine all of it alike, with some cells around it", what));
}

}  // namespace

int level_of(shape::Shape const& shape, grid::Grid const& grid) { return grid.block(grid.locate(centre(shape))).level; }

FilledCells fill_cells(shape::Shape const& shape, grid::Grid const& grid, double volume, std::string const& what,
                       std::function<double(Index3 const&)> const& open, int level) {
  grid::Domain const& domain = grid.domain(level);
  FilledCells filled;
  filled.level = level;
  std::vector<double> volumes;  // open, of the cells
  auto const open_volume = [&](Index3 const& cell) {
    return domain.cell_volume(cell[0]) * (open != nullptr ? open(cell) : 1.0);
  };
  filled.images = symmetry_images(shape, domain, what);
  double full = 0.0;
  double part = 0.0;
  for_each_cell(cells_of(shape, grid, level), [&](Index3 const& cell) {
    double f = fill_fraction(shape, domain, cell);
    if (f <= 0.0) return;
    require_cell(grid, level, cell, what);
    double const room = open_volume(cell);
    if (room <= 0.0) return;
    // What the charge fills it fills of the open part.
    f = std::min(1.0, f * domain.cell_volume(cell[0]) / room);
    filled.cells.push_back(cell);
    filled.fractions.push_back(f);
    volumes.push_back(room);
    (f < 1.0 ? part : full) += f * room;
  });
  auto const no_room = [&] {
    return InputError(
        fmt::format("{} does not fit between solid cells: obstacles occupy the cells that would contain it; move them "
                    "apart by one cell of {:.6g} m, or make the cells smaller",
                    what, domain.smallest_cell()));
  };
  double const wanted = volume / filled.images;
  if (filled.cells.empty()) {  // smaller than the sampling: one cell takes it all
    Index3 const cell = grid.cell_at(level, centre(shape));
    double const room = open_volume(cell);
    if (room <= 0.0) throw no_room();
    filled.cells.push_back(cell);
    filled.fractions.push_back(wanted / room);
    if (filled.fractions[0] > 1.0) throw InputError(fmt::format("{} does not fit into the domain", what));
    return filled;
  }
  // Scale the partly filled cells; those that become full leave the others to carry on. A body of full cells only is
  // scaled as a whole.
  bool const all = part <= 0.0;
  for (int pass = 0; pass < 50; ++pass) {
    full = 0.0;
    part = 0.0;
    for (std::size_t n = 0; n < filled.cells.size(); ++n) {
      double const v = filled.fractions[n] * volumes[n];
      (filled.fractions[n] >= 1.0 && !all ? full : part) += v;
    }
    double const missing = wanted - full - part;
    if (std::abs(missing) <= 1e-15 * wanted || part <= 0.0) break;
    double const factor = (wanted - full) / part;
    if (!(factor > 0.0))
      throw InputError(fmt::format(
          "{} cannot be resolved: the volume of its cells is {:.3g} times its own volume; use a smaller domain.cell",
          what, (full + part) / wanted));
    for (double& f : filled.fractions) {
      if (f < 1.0 || all) f = std::min(1.0, f * factor);
    }
  }
  if (full + part < wanted * (1.0 - 1e-9)) throw no_room();
  return filled;
}

void place_charge(gas::Gas& gas, FilledCells const& filled, material::Explosive const& explosive, TakenCells& taken) {
  for (std::size_t n = 0; n < filled.cells.size(); ++n) {
    Index3 const& index = filled.cells[n];
    grid::Cell const cell = gas.grid().locate(filled.level, index).value();
    double const alpha = filled.fractions[n];
    // Charges may share a cell: each takes its part from what was there before them.
    double& before = taken[{filled.level, index}];
    double const rest = 1.0 - before - alpha;
    if (rest < -1e-12) {
      Vec3 const x = gas.grid().block(cell).centre(cell);
      throw InputError(
          fmt::format("charges overlap in the cell at ({:.6g}, {:.6g}, {:.6g}) m; move them apart", x[0], x[1], x[2]));
    }
    double const old = std::max(rest, 0.0);
    double const held = before + alpha;  // by charges
    constexpr int products = gas::products_fluid;
    gas::Components u{};
    for (int c = 0; c < gas.fields().components(); ++c) u[c] = gas.fields().at(cell.block, c)[cell.offset];
    if (before > 0.0) {
      // Back to what was there before the charges.
      u[gas::partial_density(products)] -= before * explosive.density();
      u[gas::volume_fraction(products)] -= before;
      u[gas::energy] -= before * explosive.energy;
      double const scale = before < 1.0 ? 1.0 / (1.0 - before) : 0.0;
      for (int c = 0; c < gas.fields().components(); ++c) u[c] *= scale;
    }
    gas::Amounts per_volume;
    gas::Fractions fractions;
    for (int k = 0; k < gas.fluids().count; ++k) {
      per_volume.mass[k] = old * u[gas::partial_density(k)];
      if (k > 0) fractions.set(k, old * u[gas::volume_fraction(k)]);
    }
    for (int d = 0; d < 3; ++d) per_volume.momentum[d] = old * u[gas::momentum_x + d];
    per_volume.mass[products] += held * explosive.density();
    per_volume.energy = held * explosive.energy + old * u[gas::energy];
    fractions.set(products, fractions[products] + held);
    gas.set(cell, per_volume, fractions);
    before = held;
  }
}

double lighting_time(Vec3 const& x, std::vector<InitiationPoint> const& points, double detonation_speed) {
  double earliest = std::numeric_limits<double>::infinity();
  for (InitiationPoint const& point : points)
    earliest = std::min(earliest, point.delay + norm(x - point.position) / detonation_speed);
  return earliest;
}

namespace {

constexpr double break_out = 3.0;  // how long products break out, of the time of the burn

constexpr int far_away = std::numeric_limits<int>::max();

/// How a cell burns.
struct Burn {
  int distance = far_away;  ///< squared, to the nearest cell that holds explosive [cells]
  gas::BurnTime times;

  /// Does that of a nearer charge, or as near of an earlier one, count before the other? Where charges share a cell,
  /// the last of them lights it.
  [[nodiscard]] bool goes_before(Burn const& other) const {
    if (distance == 0 && other.distance == 0) return false;
    return distance < other.distance || (distance == other.distance && times.end <= other.times.end);
  }
};

/// The cells of one charge and those beside it. The front that comes moves explosive ahead of it, also into the cells
/// beside, where it must not burn before its time: a trace of it that burns at once blows up the charge's surface
/// before the detonation arrives there. All burns in such a cell when the detonation has run a cell further than the
/// nearest of the charge's; later on nothing but products comes.
struct BurningCells {
  static constexpr int beside = 1;  // cells

  grid::CellRange range;
  std::vector<Burn> cells;
  double begin = std::numeric_limits<double>::infinity();  ///< of the charge's burn [s]
  double end = -std::numeric_limits<double>::infinity();

  [[nodiscard]] Burn at(Index3 const& cell) const { return range.contains(cell) ? cells[range.offset(cell)] : Burn{}; }
  void offer(Index3 const& cell, Burn const& burn) {
    if (range.contains(cell) && burn.goes_before(cells[range.offset(cell)])) cells[range.offset(cell)] = burn;
  }
};

/// Middle of the shape's part of a cell; of the cell where the shape fills it or passes between the samples.
Vec3 middle_of_part(shape::Shape const& shape, grid::Domain const& domain, Index3 const& cell, double filled) {
  double const h = domain.smallest_cell();
  Vec3 const centre = domain.centre(cell);
  if (filled >= 1.0) return centre;
  constexpr int samples = 8;
  grid::CellRange all;
  for (int d = 0; d < domain.dimensions(); ++d) all.upper[d] = samples;
  Vec3 sum{0.0, 0.0, 0.0};
  int inside = 0;
  for_each_cell(all, [&](Index3 const& n) {
    Vec3 x = centre;
    for (int d = 0; d < domain.dimensions(); ++d) x[d] += ((n[d] + 0.5) / samples - 0.5) * h;
    if (!shape::contains(shape, domain, x)) return;
    sum = sum + x;
    ++inside;
  });
  return inside > 0 ? (1.0 / inside) * sum : centre;
}

BurningCells burning_cells(BurningCharge const& charge, grid::Grid const& grid, int level) {
  double const detonation_speed = charge.explosive.detonation_speed;
  grid::Domain const& domain = grid.domain(level);
  int const dims = domain.dimensions();
  grid::CellRange const own = cells_of(charge.shape, grid, level);
  BurningCells burning;
  burning.range = own.grown(BurningCells::beside, dims);
  burning.cells.resize(burning.range.count());
  Vec3 const middle = centre(charge.shape);
  bool found = false;
  auto const add = [&](Index3 const& index, Vec3 x) {
    found = true;
    double const cell_time = domain.smallest_cell() / detonation_speed;
    double const duration = 1.5 * cell_time;  // [Cui14] Eq. (53)
    for (int d = dims; d < 3; ++d) x[d] = middle[d];
    double const time = lighting_time(x, charge.initiation, detonation_speed);
    burning.begin = std::min(burning.begin, time);
    burning.end = std::max(burning.end, time + duration);
    for_each_cell(grid::around(index, BurningCells::beside, dims), [&](Index3 const& there) {
      int distance = 0;
      for (int d = 0; d < dims; ++d) distance += (there[d] - index[d]) * (there[d] - index[d]);
      double const a_cell_further = time + cell_time;
      burning.offer(
          there, distance == 0 ? Burn{0, {time, time + duration}} : Burn{distance, {a_cell_further, a_cell_further}});
    });
  };
  for_each_cell(own, [&](Index3 const& index) {
    double const f = fill_fraction(charge.shape, domain, index);
    if (f <= 0.0) return;
    add(index, middle_of_part(charge.shape, domain, index, f));
  });
  // A charge that is smaller than the sampling fills the one cell at its centre.
  if (Index3 const only = grid.cell_at(level, middle); !found) add(only, domain.centre(only));
  return burning;
}

}  // namespace

void expect_instantaneous_burst(gas::Gas& gas, shape::Shape const& shape, double detonation_speed) {
  shape::Box const bounds = shape::bounds(shape);
  double radius = 0.0;
  for (int d = 0; d < gas.grid().domain().dimensions(); ++d) {
    radius = std::max(radius, 0.5 * (bounds.upper[d] - bounds.lower[d]));
  }
  gas.burn.expect_burst(gas.time(), gas.time() + (1.0 + break_out) * radius / detonation_speed);
}

/// The cells of the charges at one level.
struct BurnPlan::OfLevel {
  std::vector<BurningCells> charges;
};

BurnPlan::~BurnPlan() = default;

BurnPlan::OfLevel const& BurnPlan::of_level(grid::Grid const& grid, int level) {
  if (static_cast<int>(levels_.size()) <= level) levels_.resize(static_cast<std::size_t>(level) + 1);
  auto& found = levels_[static_cast<std::size_t>(level)];
  if (found == nullptr) {
    found = std::make_unique<OfLevel>();
    for (BurningCharge const& charge : charges_) found->charges.push_back(burning_cells(charge, grid, level));
  }
  return *found;
}

BurnPlan::BurnPlan(gas::Gas& gas, std::vector<BurningCharge> charges) : charges_(std::move(charges)) {
  std::vector<gas::LitCharge> lit;
  double last = 0.0;
  for (std::size_t n = 0; n < charges_.size(); ++n) {
    BurningCharge const& charge = charges_[n];
    BurningCells const& cells = of_level(gas.grid(), level_of(charge.shape, gas.grid())).charges[n];
    lit.push_back({charge.explosive.detonation_speed, charge.explosive.density()});
    gas.burn.expect_burst(cells.begin, cells.end + break_out * (cells.end - cells.begin));
    last = std::max(last, cells.end);
  }
  std::vector<int> all(gas.grid().blocks().size());
  std::iota(all.begin(), all.end(), 0);
  set_times(gas, all);
  for (grid::Block const& block : gas.grid().blocks()) {
    for (gas::BurnTime const& times : gas.burn.times(block.number)) last = std::max(last, times.end);
  }
  // The energy of a trace is a few times what the air beside it has at the ambient pressure.
  constexpr double few = 3.0;
  material::Fluids const& fluids = gas.fluids();
  double trace = 0.0;
  for (BurningCharge const& charge : charges_) {
    double const cold = material::gruneisen(fluids.ambient()) * charge.explosive.energy;
    trace = std::max(trace, few * fluids.ambient_pressure / cold);
  }
  gas.burn.set_charges(std::move(lit));
  gas.burn.set_end(last, trace);
}

void BurnPlan::set_times(gas::Gas& gas, std::vector<int> const& blocks) {
  for (int const b : blocks) {
    grid::Block const& block = gas.grid().blocks()[b];
    std::vector<BurningCells> const& of_charges = of_level(gas.grid(), block.level).charges;
    grid::Domain const& domain = gas.grid().domain(block.level);
    grid::CellRange const box = block.with_ghosts();
    std::vector<gas::BurnTime> times(box.count());
    std::vector<std::uint16_t> charge_of(box.count(), 0);
    bool any = false;
    for_each_cell(box, [&](Index3 const& within) {
      Index3 const cell = grid::image_cell(domain, block.index(within));
      Burn burn;
      std::size_t number = 0;
      for (std::size_t n = 0; n < of_charges.size(); ++n) {
        Burn const here = of_charges[n].at(cell);
        if (burn.goes_before(here)) continue;
        burn = here;
        number = n;
      }
      if (burn.distance == far_away) return;
      times[box.offset(within)] = burn.times;
      charge_of[box.offset(within)] = static_cast<std::uint16_t>(number);
      any = true;
    });
    if (any) gas.burn.set_times(b, std::move(times), std::move(charge_of));
  }
}

}  // namespace brisance::detonation
