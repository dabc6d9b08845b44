#include "bridge/printed.hpp"

#include <algorithm>
#include <cmath>

namespace brisance::bridge {

long give_birth_as_printed(Faces const& faces, SharedGas const& shared, GasPoints& points, double dt) {
  mpm::PointSet born = points.empty_set();
  for (int f = 0; f < faces.count(); ++f) {
    if (faces[f].open) continue;
    GasState const& outside = shared.outside(f);
    GasState const& inside = shared.inside(f);
    double const density = 0.5 * (outside.density + inside.density);                   // (40)
    double const speed = faces[f].inward(0.5 * (outside.velocity + inside.velocity));  // (41)
    if (speed <= 0.0) continue;
    double area = 0.0;
    for (int lane = 0; lane < faces.lanes(); ++lane) area += faces.lane_area(f, lane);
    double const flux = density * speed * area * dt;  // (43)
    double const existing = density * faces.standard_volume(faces[f].inside, faces.sub_cell(f, 0));
    int const rows = std::max(1, static_cast<int>(std::ceil(flux / existing / faces.lanes())));  // (45)
    double const mass = flux / (rows * faces.lanes());                                           // (46)
    for (int row = 0; row < rows; ++row) {
      double const depth = speed * dt * (row + 1.0) / rows;                                                     // (47)
      for (int lane = 0; lane < faces.lanes(); ++lane) points.append(f, lane, depth, mass, outside, {}, born);  // (48)
    }
  }
  points.add(born);
  return born.size();
}

void add_to_cell(gas::Gas& gas, Index3 const& cell, Account const& load) {
  grid::Grid const& grid = gas.grid();
  int const b = grid.block_of(cell);
  grid::Block const& block = grid.blocks()[b];
  int const at = block.offset(cell[0] - block.origin[0], cell[1] - block.origin[1], cell[2] - block.origin[2]);
  double const inverse = 1.0 / grid.domain().cell_volume(cell[0]);
  grid::Fields& u = gas.fields();
  u.at(b, gas::density)[at] += inverse * load.mass[0];
  for (int d = 0; d < 3; ++d) u.at(b, gas::momentum_x + d)[at] += inverse * load.momentum[d];
  u.at(b, gas::energy)[at] += inverse * load.energy;
  if (gas.fluids().two) u.at(b, gas::second_density)[at] += inverse * load.mass[1];
  gas.wake(b);
}

}  // namespace brisance::bridge
