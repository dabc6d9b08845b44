/// What the gas tests share: filling a gas from a function of position, running it, and the error norms.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "gas/gas.hpp"
#include "grid/grid.hpp"

namespace brisance::test {

/// Ambient gas and products in a cell, by the densities that they have themselves.
struct Mixed {
  double ambient_density = 1.225;  ///< [kg/m3]
  double products_density = 0.0;   ///< [kg/m3]
  double volume_fraction = 0.0;    ///< of the products
  Vec3 velocity{0.0, 0.0, 0.0};
  double pressure = 101325.0;

  operator material::Primitive() const {
    double const products = volume_fraction * products_density;
    material::Primitive s;
    s.density = (1.0 - volume_fraction) * ambient_density + products;
    s.pressure = pressure;
    s.velocity = velocity;
    s.mass_fraction.set(material::products_fluid, products / s.density);
    s.volume_fraction.set(material::products_fluid, volume_fraction);
    return s;
  }
};

using StateAt = std::function<Mixed(Vec3 const& x)>;

/// A gas on its own grid.
struct Problem {
  grid::Domain domain;
  gas::Fluids fluids;
  gas::Options options;
  Mixed quiescent;
  double courant = 0.8;
  int block_cells = 0;
  std::array<Mixed, 6> inflow{};

  std::unique_ptr<grid::Grid> grid;
  std::unique_ptr<gas::Gas> gas;
  long steps = 0;

  Problem() {
    fluids.eos[0] = material::IdealGas{1.4};
    options.density_floor = 1e-12;
    options.pressure_floor = 1e-12;
  }

  /// A cube of n cells per resolved direction and edge `length`, all faces alike.
  void box(grid::Geometry geometry, int n, double length, grid::Boundary boundary) {
    domain.geometry = geometry;
    domain.h = length / n;
    for (int d = 0; d < 3; ++d) domain.cells[d] = d < domain.dimensions() ? n : 1;
    domain.boundary.fill(boundary);
  }

  void fill(StateAt const& state) {
    grid = std::make_unique<grid::Grid>(domain, block_cells);
    fill_grid(state);
  }

  /// Makes the gas on the grid that there is.
  void fill_grid(StateAt const& state) {
    std::array<material::Primitive, 6> outside;
    std::copy(inflow.begin(), inflow.end(), outside.begin());
    gas = std::make_unique<gas::Gas>(*grid, fluids, options, quiescent, outside);
    for (grid::Block const& block : grid->blocks()) {
      grid::for_each_cell(block, [&](grid::Cell const& cell) { gas->set(cell, state(block.centre(cell))); });
    }
    gas->start();
  }

  /// Calls visit(block, offset, domain index) for every cell.
  template <class Visit>
  void for_each_cell(Visit&& visit) const {
    for (int b = 0; b < grid->block_count(); ++b) {
      grid::Block const& block = grid->blocks()[b];
      grid::for_each_cell(block, [&](grid::Cell const& cell) { visit(b, cell.offset, block.index(cell)); });
    }
  }

  void run_to(double end) {
    while (gas->time() < end * (1.0 - 1e-13)) {
      double const ramp = std::min(1.0, 0.1 * static_cast<double>(steps + 1));
      double const dt = std::min(ramp * courant * domain.h / gas->fastest_signal(), end - gas->time());
      gas->advance(dt, steps % 2 == 1);
      ++steps;
    }
  }

  [[nodiscard]] gas::Primitive at(Index3 const& cell) const { return gas::gather(*gas, {cell}).front(); }

  /// Cells along x at j = k = 0.
  [[nodiscard]] std::vector<gas::Primitive> line() const {
    std::vector<Index3> cells;
    for (int i = 0; i < domain.cells[0]; ++i) cells.push_back({i, 0, 0});
    return gas::gather(*gas, cells);
  }

  /// Sum of a conserved component over all cells, times their volume; in extended precision, for a sum of many cells
  /// loses digits.
  [[nodiscard]] double total(int component) const {
    long double sum = 0.0;
    for_each_cell([&](int b, int offset, Index3 const& cell) {
      sum += gas->fields().at(b, component)[offset] * domain.cell_volume(cell[0]);
    });
    return static_cast<double>(sum);
  }
};

/// Makes an obstacle of the cells (domain indices) for which `inside(cell)` holds. To be called before `Gas::start`.
template <class Inside>
void place_obstacle(Problem& problem, Inside const& inside) {
  for (int b = 0; b < problem.grid->block_count(); ++b) {
    grid::Block const& block = problem.grid->blocks()[b];
    grid::CellRange const box = block.with_ghosts();
    std::vector<std::uint8_t> solid(box.count(), 0);
    bool any = false;
    for_each_cell(box, [&](Index3 const& within) {
      bool const here = inside(grid::image_cell(problem.domain, block.index(within)));
      solid[box.offset(within)] = here ? 1 : 0;
      any = any || here;
    });
    if (any) problem.gas->obstacles.set(b, std::move(solid));
  }
}

inline Mixed state(double rho, double u, double p) {
  Mixed s;
  s.ambient_density = rho;
  s.velocity = {u, 0.0, 0.0};
  s.pressure = p;
  return s;
}

}  // namespace brisance::test
