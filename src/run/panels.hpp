/// Panels: obstacles that give way to the difference of the pressures on their two sides, and let the gas pass.
///
/// A panel is taken for flat: it has two sides, one direction apart, and gives way as a whole when the difference
/// between the means of the pressure on them reaches its release pressure, in either sense. Without mass it is gone at
/// once. With an areal mass m it moves away as a whole from then on, m dv/dt = difference, and gas passes through the
/// gap around its edge, perimeter times travel, until that is its whole area: the usual rule for covers that do not
/// turn. On the grid the cells at its edge open first, ring by ring, when half of the ring's area is due.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "gas/gas.hpp"
#include "grid/grid.hpp"

namespace brisance {
class Archive;
}

namespace brisance::run {

/// What is known of a panel from the start.
struct PanelPlace {
  /// Cells that stand behind each other between the gas of the two sides.
  struct Column {
    Index3 first{0, 0, 0};  ///< the one on the low side
    int count = 0;
    int ring = 0;  ///< 0 at the edge
  };
  int level = 0;                ///< of its cells
  int direction = 0;            ///< from one side to the other
  std::vector<Column> columns;  ///< all that lead from gas to gas
  std::vector<Index3> others;   ///< its other cells
  std::vector<double> rings;    ///< area of each [m2]
  double area = 0.0;            ///< of the columns, on the smaller side [m2]
  double perimeter = 0.0;       ///< of them; edges on planes of symmetry, where the panel goes on, do not count [m]
};

/// The cell so many cells on.
[[nodiscard]] inline Index3 moved(Index3 cell, int direction, int by) {
  cell[direction] += by;
  return cell;
}

/// The cells beside a column.
[[nodiscard]] inline Index3 below(PanelPlace::Column const& c, int direction) { return moved(c.first, direction, -1); }
[[nodiscard]] inline Index3 above(PanelPlace::Column const& c, int direction) {
  return moved(c.first, direction, c.count);
}

/// Area of a side of a column [m2].
[[nodiscard]] inline double area_of(grid::Domain const& domain, PanelPlace::Column const& c, int direction, bool high) {
  return domain.face_area(direction, c.first[0] + (direction == 0 && high ? c.count : 0));
}

/// What became of one panel.
struct PanelReport {
  std::string name;
  Release release;
  PanelPlace place;
  double largest = 0.0;            ///< difference of the pressures before its release, its size [Pa]
  std::optional<double> released;  ///< when [s]
  double difference = 0.0;         ///< at its release; positive: towards the high side [Pa]
  std::optional<double> opened;    ///< when all of it was open [s]
  double travel = 0.0;             ///< until then [m]
  double speed = 0.0;              ///< then, or at present [m/s]
  int open_rings = 0;

  [[nodiscard]] double open_area() const;  ///< [m2]
};

class Panels {
 public:
  /// Panels that nothing has happened to, see `setup::place_panels`.
  explicit Panels(std::vector<PanelReport> panels) : panels_(std::move(panels)) {}

  [[nodiscard]] std::vector<PanelReport> const& reports() const { return panels_; }
  /// The step after which something opened last; 0: nothing has.
  [[nodiscard]] long last_opening() const { return last_opening_; }
  /// To be called after a step of length dt that has led to `time` and was the last of `step` steps.
  void follow(gas::Gas& gas, double time, double dt, long step);
  /// In a checkpoint. Reading opens what was open in a gas whose panels are all closed; what its cells hold comes with
  /// the gas.
  void archive(Archive& a, gas::Gas& gas);

 private:
  std::vector<PanelReport> panels_;
  long last_opening_ = 0;
};

}  // namespace brisance::run
