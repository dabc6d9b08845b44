#include "setup/place_panels.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/error.hpp"

namespace brisance::setup {

namespace {

using run::moved;
using run::PanelPlace;
using Column = PanelPlace::Column;

/// The columns of a panel's cells in a direction that lead from gas to gas.
std::vector<Column> columns_in(grid::Domain const& domain, SolidCells const& solid, std::set<Index3> const& cells,
                               int direction) {
  std::map<Index3, std::vector<int>> lines;
  for (Index3 const& cell : cells) {
    Index3 line = cell;
    line[direction] = 0;
    lines[line].push_back(cell[direction]);
  }
  auto const is_gas = [&](Index3 const& cell) { return domain.contains(cell) && !solid(cell); };
  std::vector<Column> columns;
  for (auto& [line, places] : lines) {
    std::sort(places.begin(), places.end());
    Column column;
    column.first = line;
    column.first[direction] = places.front();
    column.count = static_cast<int>(places.size());
    bool const whole = places.back() - places.front() + 1 == column.count;
    if (whole && is_gas(below(column, direction)) && is_gas(above(column, direction))) columns.push_back(column);
  }
  return columns;
}

/// Numbers the rings, from the edge inwards, and measures the edge.
void find_rings(grid::Domain const& domain, PanelPlace& place) {
  std::map<Index3, Column*> at;  // by their place across the direction
  for (Column& c : place.columns) {
    Index3 line = c.first;
    line[place.direction] = 0;
    at[line] = &c;
    c.ring = -1;
  }
  // Is what lies beyond a face of the domain an image of what lies before it, or across?
  auto const goes_on = [&](Index3 const& outside, int direction) {
    int const face = 2 * direction + (outside[direction] < 0 ? 0 : 1);
    grid::Boundary const b = domain.boundary[face];
    return domain.is_axis(face) || b == grid::Boundary::symmetry || b == grid::Boundary::periodic;
  };
  for (int ring = 0;; ++ring) {
    std::vector<Column*> found;
    for (auto const& [line, column] : at) {
      if (column->ring >= 0) continue;
      bool edge = false;
      for (int d = 0; d < domain.dimensions(); ++d) {
        if (d == place.direction) continue;
        for (int side = 0; side < 2; ++side) {
          Index3 next = moved(line, d, 2 * side - 1);
          if (!domain.contains(next) && goes_on(next, d)) next = grid::image_cell(domain, next);
          auto const other = at.find(next);
          if (other != at.end() && other->second->ring < 0) continue;
          edge = true;
          if (ring == 0) {
            int const face = column->first[0] + (d == 0 ? side : 0);
            place.perimeter += domain.face_area(d, face) / domain.smallest_cell();
          }
        }
      }
      if (edge) found.push_back(column);
    }
    if (found.empty()) {  // no edge anywhere: all of it is one ring
      for (auto const& [line, column] : at) {
        if (column->ring < 0) found.push_back(column);
      }
    }
    double area = 0.0;
    for (Column* column : found) {
      column->ring = ring;
      area +=
          std::min(area_of(domain, *column, place.direction, false), area_of(domain, *column, place.direction, true));
    }
    place.rings.push_back(area);
    place.area += area;
    if (std::all_of(place.columns.begin(), place.columns.end(), [](Column const& c) { return c.ring >= 0; })) return;
  }
}

}  // namespace

PanelPlace place_panel(grid::Domain const& domain, std::vector<Obstacle> const& obstacles, SolidCells const& solid,
                       std::size_t number) {
  auto const list = solid.cells_of(number);
  std::set<Index3> const cells(list.begin(), list.end());
  if (cells.empty()) {
    throw InputError("later obstacles occupy all cells of the panel: write the panel after the wall that contains it");
  }
  auto const box = shape::bounds(obstacles[number].shape);
  PanelPlace place;
  double thinnest = 0.0;
  bool alike = false;
  for (int d = 0; d < domain.dimensions(); ++d) {
    auto columns = columns_in(domain, solid, cells, d);
    if (columns.empty()) continue;
    double const thickness = box.upper[d] - box.lower[d];
    bool const first = place.columns.empty();
    if (!first && thickness > thinnest * (1.0 + 1e-9)) continue;
    alike = !first && thickness >= thinnest * (1.0 - 1e-9);
    if (alike) continue;
    thinnest = thickness;
    place.direction = d;
    place.columns = std::move(columns);
  }
  if (place.columns.empty()) {
    throw InputError(
        "the panel does not have gas on both sides in any direction: place it between two volumes of gas, at least one "
        "cell away from the faces of the domain");
  }
  if (alike) {
    throw InputError(
        "the panel has the same thickness in two directions and gas on both sides in both: make it thinner in the "
        "direction in which it should fail, or place it in a wall");
  }
  std::set<Index3> others = cells;
  for (Column const& c : place.columns) {
    for (int n = 0; n < c.count; ++n) others.erase(moved(c.first, place.direction, n));
  }
  place.others.assign(others.begin(), others.end());
  find_rings(domain, place);

  if (!(obstacles[number].release->areal_mass > 0.0)) return place;
  // Steps of cells round a disc are longer than its edge.
  if (domain.geometry == grid::Geometry::cartesian3d) {
    auto const* disc = std::get_if<shape::Cylinder>(&obstacles[number].shape);
    if (disc != nullptr && std::abs(disc->axis[place.direction]) > 0.5) {
      place.perimeter = 2.0 * place.area / disc->radius;
    } else if (!std::holds_alternative<shape::Box>(obstacles[number].shape)) {
      throw InputError(
          "a panel with areal_mass opens along its edge, which is known only for boxes and for cylinders that fail "
          "along their axis: use one of them, or remove areal_mass");
    }
  }
  if (!(place.perimeter > 0.0)) {
    throw InputError(
        "the panel has no edge in the domain along which it could open: remove areal_mass, so that the whole panel "
        "opens at once");
  }
  return place;
}

std::vector<run::PanelReport> place_panels(grid::Domain const& domain, std::vector<Obstacle> const& obstacles,
                                           SolidCells const& solid) {
  std::vector<run::PanelReport> panels;
  for (std::size_t n = 0; n < obstacles.size(); ++n) {
    if (!obstacles[n].release) continue;
    run::PanelReport panel;
    panel.name = obstacles[n].name;
    panel.release = *obstacles[n].release;
    panel.place = place_panel(domain, obstacles, solid, n);
    panels.push_back(std::move(panel));
  }
  return panels;
}

}  // namespace brisance::setup
