#include "run/panels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/archive.hpp"

namespace brisance::run {

namespace {

using Column = PanelPlace::Column;

grid::Cell cell_at(gas::Gas const& gas, PanelReport const& panel, Index3 const& cell) {
  return gas.grid().locate(panel.place.level, cell).value();
}

double pressure_of(gas::Gas const& gas, PanelReport const& panel, Index3 const& cell) {
  return gas.primitive(cell_at(gas, panel, cell)).pressure;
}

/// Difference of the mean pressures on what is closed of a panel; 0 where there is no gas on one of its sides.
double difference_of(gas::Gas const& gas, PanelReport const& panel) {
  grid::Domain const& domain = gas.grid().domain(panel.place.level);
  int const direction = panel.place.direction;
  std::array<double, 2> force{0.0, 0.0};
  std::array<double, 2> area{0.0, 0.0};
  for (Column const& c : panel.place.columns) {
    if (c.ring < panel.open_rings) continue;
    for (int side = 0; side < 2; ++side) {
      Index3 const cell = side == 0 ? below(c, direction) : above(c, direction);
      if (gas.obstacles.contain(panel.place.level, cell)) continue;  // another panel
      double const fraction = area_of(domain, c, direction, side == 1);
      force[side] += fraction * pressure_of(gas, panel, cell);
      area[side] += fraction;
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
    bool const gas_below = !gas.obstacles.contain(panel.place.level, low);
    bool const gas_above = !gas.obstacles.contain(panel.place.level, high);
    if (!gas_below && !gas_above) continue;
    bool const from_below = gas_below && (!gas_above || pressure_of(gas, panel, low) <= pressure_of(gas, panel, high));
    grid::Cell const donor = cell_at(gas, panel, from_below ? low : high);
    for (int n = 0; n < c.count; ++n) gas.fill_opened(cell_at(gas, panel, moved(c.first, direction, n)), donor);
  }
  std::vector<Index3> cells;
  collect(panel, panel.open_rings, ring, cells);
  for (int const block : gas.obstacles.open(panel.place.level, cells)) gas.wake(block);
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

double PanelReport::open_area() const {
  double sum = 0.0;
  for (int ring = 0; ring < open_rings; ++ring) sum += place.rings[static_cast<std::size_t>(ring)];
  return sum;
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
    for (int const block : gas.obstacles.open(panel.place.level, cells)) gas.wake(block);
    panel.open_rings = rings;
  }
}

}  // namespace brisance::run
