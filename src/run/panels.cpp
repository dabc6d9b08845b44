#include "run/panels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/archive.hpp"
#include "core/error.hpp"

namespace brisance::run {

namespace {

using Column = PanelPlace::Column;

Index3 moved(Index3 cell, int direction, int by) {
  cell[direction] += by;
  return cell;
}

Index3 below(Column const& c, int direction) { return moved(c.first, direction, -1); }
Index3 above(Column const& c, int direction) { return moved(c.first, direction, c.count); }

/// Area of a side of a column.
double area_of(grid::Domain const& domain, Column const& c, int direction, bool high) {
  return domain.face_area(direction, c.first[0] + (direction == 0 && high ? c.count : 0));
}

/// The columns of a panel's cells in a direction that lead from gas to gas.
std::vector<Column> columns_in(grid::Domain const& domain, setup::SolidCells const& solid,
                               std::set<Index3> const& cells, int direction) {
  std::map<Index3, std::vector<int>> lines;
  for (Index3 const& cell : cells) {
    Index3 line = cell;
    line[direction] = 0;
    lines[line].push_back(cell[direction]);
  }
  auto const is_gas = [&](Index3 const& cell) {
    return cell[direction] >= 0 && cell[direction] < domain.cells[direction] && !solid(cell);
  };
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
    int const side = outside[direction] < 0 ? 0 : 1;
    grid::Boundary const b = domain.boundary[2 * direction + side];
    bool const axis =
        direction == 0 && side == 0 && grid::radial_exponent(domain.geometry) > 0 && domain.radial_area(0) == 0.0;
    return axis || b == grid::Boundary::symmetry || b == grid::Boundary::periodic;
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
          bool const outside = next[d] < 0 || next[d] >= domain.cells[d];
          if (outside && goes_on(next, d)) next = grid::image_cell(domain, next);
          auto const other = at.find(next);
          if (other != at.end() && other->second->ring < 0) continue;
          edge = true;
          if (ring == 0) {
            int const face = column->first[0] + (d == 0 ? side : 0);
            place.perimeter += domain.face_area(d, face) / domain.h;
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

struct Sides {
  double low = 0.0;  ///< mean pressures [Pa]
  double high = 0.0;
};

double pressure_of(gas::Gas const& gas, Index3 const& cell) {
  int const b = gas.grid().block_of(cell);
  Index3 const& o = gas.grid().blocks()[b].origin;
  return gas.primitive(b, cell[0] - o[0], cell[1] - o[1], cell[2] - o[2]).pressure;
}

/// Difference of the mean pressures on what is closed of a panel; 0 where there is no gas on one of its sides.
double difference_of(gas::Gas const& gas, PanelReport const& panel) {
  grid::Domain const& domain = gas.grid().domain();
  int const direction = panel.place.direction;
  std::array<double, 2> force{0.0, 0.0};
  std::array<double, 2> area{0.0, 0.0};
  for (Column const& c : panel.place.columns) {
    if (c.ring < panel.open_rings) continue;
    for (int side = 0; side < 2; ++side) {
      Index3 const cell = side == 0 ? below(c, direction) : above(c, direction);
      if (gas.is_obstacle(cell)) continue;  // another panel
      double const part = area_of(domain, c, direction, side == 1);
      force[side] += part * pressure_of(gas, cell);
      area[side] += part;
    }
  }
  return area[0] > 0.0 && area[1] > 0.0 ? force[0] / area[0] - force[1] / area[1] : 0.0;
}

void collect(PanelReport const& panel, int from, int to, std::vector<Index3>& cells) {
  for (Column const& c : panel.place.columns) {
    if (c.ring < from || c.ring >= to) continue;
    for (int n = 0; n < c.count; ++n) cells.push_back(moved(c.first, panel.place.direction, n));
  }
  bool const last = to == static_cast<int>(panel.place.rings.size()) && from < to;
  if (last) cells.insert(cells.end(), panel.place.others.begin(), panel.place.others.end());
}

/// Opens the rings up to one. What opens is filled from the side of the lower pressure.
void open_up_to(gas::Gas& gas, PanelReport& panel, int ring) {
  int const direction = panel.place.direction;
  for (Column const& c : panel.place.columns) {
    if (c.ring < panel.open_rings || c.ring >= ring) continue;
    Index3 const low = below(c, direction);
    Index3 const high = above(c, direction);
    bool const gas_below = !gas.is_obstacle(low);
    bool const gas_above = !gas.is_obstacle(high);
    if (!gas_below && !gas_above) continue;
    bool const from_below = gas_below && (!gas_above || pressure_of(gas, low) <= pressure_of(gas, high));
    for (int n = 0; n < c.count; ++n) gas.fill_opened(moved(c.first, direction, n), from_below ? low : high);
  }
  std::vector<Index3> cells;
  collect(panel, panel.open_rings, ring, cells);
  gas.open_obstacles(cells);
  panel.open_rings = ring;
}

/// How many rings are open after a travel.
int rings_due(PanelReport const& panel) {
  double const due = panel.place.perimeter * panel.travel;
  double before = 0.0;
  int ring = 0;
  for (double const area : panel.place.rings) {
    if (due < before + 0.5 * area) break;
    before += area;
    ++ring;
  }
  return std::max(ring, panel.open_rings);
}

}  // namespace

PanelPlace place_panel(grid::Domain const& domain, std::vector<Obstacle> const& obstacles,
                       setup::SolidCells const& solid, std::size_t number) {
  auto const list = solid.cells_of(number);
  std::set<Index3> const cells(list.begin(), list.end());
  if (cells.empty()) {
    throw InputError(
        "obstacles that are written after it take all the cells of the panel: write it after the wall that it is in");
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
        "the panel has no gas on both of its sides, in any direction: let it stand between two volumes of gas, at "
        "least a cell away from the faces of the domain there");
  }
  if (alike) {
    throw InputError(
        "the panel is as thick in one direction as in another and has gas on both sides of either: make it thinner in "
        "the direction in which it is to give way, or put it into a wall");
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
          "with an areal mass a panel opens along its edge, which is known for boxes and for cylinders that give way "
          "along their axis: choose one of them, or leave areal_mass away");
    }
  }
  if (!(place.perimeter > 0.0)) {
    throw InputError(
        "the panel has no edge in the domain along which it could open: leave areal_mass away, then all of it opens "
        "at once");
  }
  return place;
}

double PanelReport::open_area() const {
  double sum = 0.0;
  for (int ring = 0; ring < open_rings; ++ring) sum += place.rings[static_cast<std::size_t>(ring)];
  return sum;
}

Panels::Panels(grid::Domain const& domain, std::vector<Obstacle> const& obstacles, setup::SolidCells const& solid) {
  for (std::size_t n = 0; n < obstacles.size(); ++n) {
    if (!obstacles[n].release) continue;
    PanelReport panel;
    panel.name = obstacles[n].name;
    panel.release = *obstacles[n].release;
    panel.place = place_panel(domain, obstacles, solid, n);
    panels_.push_back(std::move(panel));
  }
}

void Panels::follow(gas::Gas& gas, double time, double dt, long step) {
  // All of them see the state at the end of the step, whichever of them opens first.
  std::vector<double> differences;
  for (PanelReport const& panel : panels_) differences.push_back(panel.opened ? 0.0 : difference_of(gas, panel));
  for (std::size_t n = 0; n < panels_.size(); ++n) {
    PanelReport& panel = panels_[n];
    if (panel.opened) continue;
    double const difference = differences[n];
    int const all = static_cast<int>(panel.place.rings.size());
    int due = panel.open_rings;
    if (!panel.released) {
      panel.largest = std::max(panel.largest, std::abs(difference));
      if (std::abs(difference) < panel.release.pressure) continue;
      panel.released = time;
      panel.difference = difference;
      if (!(panel.release.areal_mass > 0.0)) due = all;
    } else {
      double const push = std::copysign(1.0, panel.difference) * difference;
      panel.speed += push / panel.release.areal_mass * dt;
      panel.travel += panel.speed * dt;
      if (panel.travel < 0.0) panel.travel = panel.speed = 0.0;  // back in its seat
      due = rings_due(panel);
    }
    if (due == panel.open_rings) continue;
    open_up_to(gas, panel, due);
    last_opening_ = step;
    if (due == all) panel.opened = time;
  }
}

void Panels::archive(Archive& a, gas::Gas& gas) {
  a.same(panels_.size(), "the number of panels");
  a(last_opening_);
  for (PanelReport& panel : panels_) {
    a.same(panel.name, "the name of a panel");
    bool released = panel.released.has_value();
    bool opened = panel.opened.has_value();
    double when_released = panel.released.value_or(0.0);
    double when_opened = panel.opened.value_or(0.0);
    int rings = panel.open_rings;
    a(released, opened, when_released, when_opened, panel.largest, panel.difference, panel.travel, panel.speed, rings);
    if (!a.reading()) continue;
    int const all = static_cast<int>(panel.place.rings.size());
    // What is open is not closed again.
    a.require(rings >= panel.open_rings && rings <= all && opened == (rings == all) && (released || rings == 0) &&
                  std::isfinite(panel.travel) && std::isfinite(panel.speed),
              "the state of panel \"" + panel.name + "\"");
    panel.released = released ? std::optional<double>(when_released) : std::nullopt;
    panel.opened = opened ? std::optional<double>(when_opened) : std::nullopt;
    std::vector<Index3> cells;
    collect(panel, 0, rings, cells);
    gas.open_obstacles(cells);
    panel.open_rings = rings;
  }
}

}  // namespace brisance::run
