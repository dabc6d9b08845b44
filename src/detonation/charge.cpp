#include "detonation/charge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"

namespace brisance::detonation {

double symmetry_images(shape::Shape const& shape, grid::Domain const& domain, std::string const& what) {
  shape::Box const box = bounds(shape);
  Vec3 const middle = centre(shape);
  double const slack = 1e-6 * domain.h;
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
            "{} reaches over the {} boundary of the domain ({} = {:.6g} m); move it, enlarge the domain, use a "
            "symmetry plane through its centre, or shape = \"hemisphere\" for a charge on the ground",
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

FilledCells fill_cells(shape::Shape const& shape, grid::Grid const& grid, double volume, std::string const& what,
                       std::function<bool(Index3 const&)> const& solid) {
  grid::Domain const& domain = grid.domain();
  FilledCells filled;
  filled.images = symmetry_images(shape, domain, what);
  shape::Box const box = bounds(shape);
  Index3 const low = grid.cell_at(box.lower);
  Index3 const high = grid.cell_at(box.upper);
  double full = 0.0;
  double part = 0.0;
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      for (int i = low[0]; i <= high[0]; ++i) {
        double const f = fill_fraction(shape, domain, {i, j, k});
        if (f <= 0.0 || (solid != nullptr && solid({i, j, k}))) continue;
        filled.cells.push_back({i, j, k});
        filled.fractions.push_back(f);
        (f < 1.0 ? part : full) += f * domain.cell_volume(i);
      }
    }
  }
  auto const no_room = [&] {
    return InputError(fmt::format(
        "{} does not fit between solid cells: obstacles take the cells that would hold it; move them apart by a cell "
        "of {:.6g} m, or make the cells smaller",
        what, domain.h));
  };
  double const wanted = volume / filled.images;
  if (filled.cells.empty()) {  // smaller than the sampling: one cell takes it all
    Index3 const cell = grid.cell_at(centre(shape));
    if (solid != nullptr && solid(cell)) throw no_room();
    filled.cells.push_back(cell);
    filled.fractions.push_back(wanted / domain.cell_volume(cell[0]));
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
      double const v = filled.fractions[n] * domain.cell_volume(filled.cells[n][0]);
      (filled.fractions[n] >= 1.0 && !all ? full : part) += v;
    }
    double const missing = wanted - full - part;
    if (std::abs(missing) <= 1e-15 * wanted || part <= 0.0) break;
    double const factor = (wanted - full) / part;
    if (!(factor > 0.0))
      throw InputError(
          fmt::format("{} cannot be resolved: its cells hold {:.3g} times its volume; use a smaller domain.cell", what,
                      (full + part) / wanted));
    for (double& f : filled.fractions) {
      if (f < 1.0 || all) f = std::min(1.0, f * factor);
    }
  }
  if (full + part < wanted * (1.0 - 1e-9)) throw no_room();
  return filled;
}

void place_charge(gas::Gas& gas, FilledCells const& filled, material::Explosive const& explosive, TakenCells& taken) {
  for (std::size_t n = 0; n < filled.cells.size(); ++n) {
    Index3 const& cell = filled.cells[n];
    int const b = gas.grid().block_of(cell);
    grid::Block const& block = gas.grid().blocks()[b];
    int const at = block.offset(cell[0] - block.origin[0], cell[1] - block.origin[1], cell[2] - block.origin[2]);
    double const alpha = filled.fractions[n];
    // Charges may share a cell: each takes its part from what was there before them.
    double& before = taken[cell];
    double const rest = 1.0 - before - alpha;
    if (rest < -1e-12) {
      Vec3 const x = gas.grid().domain().centre(cell);
      throw InputError(
          fmt::format("charges overlap in the cell at ({:.6g}, {:.6g}, {:.6g}) m; move them apart", x[0], x[1], x[2]));
    }
    double const old = std::max(rest, 0.0);
    double const held = before + alpha;  // by charges
    bool const two = gas.components() > gas::single_fluid_components;
    gas::Components u{};
    for (int c = 0; c < gas.components(); ++c) u[c] = gas.fields().at(b, c)[at];
    if (before > 0.0) {
      // Back to what was there before the charges.
      u[gas::second_density] -= before * explosive.density();
      u[gas::volume_fraction] -= before;
      u[gas::energy] -= before * explosive.energy;
      double const scale = before < 1.0 ? 1.0 / (1.0 - before) : 0.0;
      for (int c = 0; c < gas.components(); ++c) u[c] *= scale;
    }
    gas.set_conserved(
        b, at, old * u[gas::density], (two ? old * u[gas::second_density] : 0.0) + held * explosive.density(),
        {old * u[gas::momentum_x], old * u[gas::momentum_y], old * u[gas::momentum_z]},
        held * explosive.energy + old * u[gas::energy], (two ? old * u[gas::volume_fraction] : 0.0) + held);
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

}  // namespace

void expect_instantaneous_burst(gas::Gas& gas, shape::Shape const& shape, double detonation_speed) {
  shape::Box const bounds = shape::bounds(shape);
  double radius = 0.0;
  for (int d = 0; d < gas.grid().domain().dimensions(); ++d) {
    radius = std::max(radius, 0.5 * (bounds.upper[d] - bounds.lower[d]));
  }
  gas.expect_burst(gas.time(), gas.time() + (1.0 + break_out) * radius / detonation_speed);
}

void set_programmed_burn(gas::Gas& gas, std::vector<BurningCharge> const& charges, double detonation_speed) {
  grid::Domain const& domain = gas.grid().domain();
  int const dims = domain.dimensions();
  constexpr double never_unburnt = -std::numeric_limits<double>::infinity();
  constexpr double never = std::numeric_limits<double>::infinity();
  struct BurnTime {
    double begin, end;
  };
  std::vector<BurnTime> burn_times(charges.size(), {never, -never});
  // A charge that is smaller than the sampling fills the one cell at its centre.
  std::vector<Index3> only(charges.size(), Index3{-1, -1, -1});
  for (std::size_t n = 0; n < charges.size(); ++n) {
    shape::Box const box = bounds(charges[n].shape);
    Index3 const low = gas.grid().cell_at(box.lower);
    Index3 const high = gas.grid().cell_at(box.upper);
    bool found = false;
    for (int k = low[2]; k <= high[2] && !found; ++k) {
      for (int j = low[1]; j <= high[1] && !found; ++j) {
        for (int i = low[0]; i <= high[0] && !found; ++i)
          found = fill_fraction(charges[n].shape, domain, {i, j, k}) > 0.0;
      }
    }
    if (!found) only[n] = gas.grid().cell_at(centre(charges[n].shape));
  }
  for (int b = 0; b < gas.grid().block_count(); ++b) {
    grid::Block const& block = gas.grid().blocks()[b];
    gas::PaddedBox const box(block, dims);
    std::vector<double> times(static_cast<std::size_t>(box.count()), never_unburnt);
    bool any = false;
    for (int k = -box.pad[2]; k < block.n[2] + box.pad[2]; ++k) {
      for (int j = -box.pad[1]; j < block.n[1] + box.pad[1]; ++j) {
        for (int i = -box.pad[0]; i < block.n[0] + box.pad[0]; ++i) {
          Index3 const cell = grid::image_cell(domain, {block.origin[0] + i, block.origin[1] + j, block.origin[2] + k});
          for (std::size_t n = 0; n < charges.size(); ++n) {
            BurningCharge const& charge = charges[n];
            if (cell != only[n] && fill_fraction(charge.shape, domain, cell) <= 0.0) continue;
            Vec3 x = domain.centre(cell);
            Vec3 const middle = centre(charge.shape);
            for (int d = dims; d < 3; ++d) x[d] = middle[d];
            double const t = lighting_time(x, charge.initiation, detonation_speed);
            times[box.offset(i, j, k)] = t;
            burn_times[n].begin = std::min(burn_times[n].begin, t);
            burn_times[n].end = std::max(burn_times[n].end, t + 1.5 * domain.h / detonation_speed);
            any = true;
          }
        }
      }
    }
    if (any) gas.set_lighting(b, std::move(times));
  }
  double last = 0.0;
  for (auto const& [begin, end] : burn_times) {
    if (!(begin < end)) continue;  // nothing of the charge lies in the domain
    gas.expect_burst(begin, end + break_out * (end - begin));
    last = std::max(last, end);
  }
  gas.set_burn(detonation_speed, last);
}

}  // namespace brisance::detonation
