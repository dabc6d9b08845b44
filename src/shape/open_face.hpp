/// The part of a cell's face that bodies leave open, and how the openings hang together. Private to this folder.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shape/shape.hpp"

namespace brisance::shape {

/// Points of a cell's surface: three along every direction.
inline constexpr int surface_points = 27;

/// Which points of a cell's surface are free, and which of them hang together along its faces.
class SurfaceLinks {
 public:
  SurfaceLinks() { free_.fill(0); }
  [[nodiscard]] static int point(Index3 const& at) { return at[0] + 3 * (at[1] + 3 * at[2]); }
  void set_free(int point) { free_[point] = 1; }
  void link(int a, int b) { links_.push_back({a, b}); }
  /// An opening that reaches no point has been seen.
  void set_apart() { apart_ = true; }
  /// Is all that is free seen to hang together?
  [[nodiscard]] bool connected() const;

 private:
  std::array<std::uint8_t, surface_points> free_;
  std::vector<std::array<int, 2>> links_;
  bool apart_ = false;
};

/// Bodies near some cells, seen along each axis.
class BodiesAlongAxes {
 public:
  BodiesAlongAxes(std::vector<Shape> const& shapes, grid::Domain const& domain);

  /// The fraction of the low face of a cell in a direction that is open. The cell may lie one beyond the domain's last.
  [[nodiscard]] double open_face(Index3 const& cell, int direction) const;
  /// How the openings in the faces of a cell hang together.
  [[nodiscard]] SurfaceLinks links(Index3 const& cell) const;

 private:
  /// The bodies that reach into the cells beside a face or around a cell.
  [[nodiscard]] std::vector<int> near(Index3 const& low, Index3 const& high) const;
  /// What bodies leave open of the line along a direction through x, between two coordinates.
  void open_spans(std::vector<int> const& bodies, int direction, Vec3 x, double from, double to,
                  std::vector<Span>& open) const;
  [[nodiscard]] double open_part(std::vector<int> const& bodies, Index3 const& cell, int direction, double at) const;
  /// Halves of a cell along a direction, divided where bodies have flat faces; a little inside their ends.
  [[nodiscard]] std::vector<Span> pieces(std::vector<int> const& bodies, Index3 const& cell, int direction) const;
  [[nodiscard]] double open_square(std::vector<int> const& bodies, Index3 const& cell, int direction, double at) const;
  [[nodiscard]] double measure(int direction, double from, double to) const;
  [[nodiscard]] bool lies_on_flat_face(std::vector<int> const& bodies, int direction, double at) const;

  grid::Domain domain_;
  std::array<std::vector<Shape>, 3> along_;  ///< the shapes with a direction turned to x
  std::vector<grid::CellRange> around_;      ///< cells that each may reach into
};

}  // namespace brisance::shape
