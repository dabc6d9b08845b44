/// The faces of the MPM region and their lanes. Geometry alone.
///
/// A face is cut into lanes, one for each row of gas particles that can come through it: as many in each direction
/// along the face as a cell holds particles. The cells of the region are cut likewise into sub-cells; a lane leads to
/// one of those at the face.
#pragma once

#include <array>
#include <cstddef>
#include <unordered_map>
#include <vector>

#include "bridge/region.hpp"

namespace brisance::bridge {

class Faces {
 public:
  /// `parts`: particles of the gas per cell and direction. Keeps a reference to the region.
  Faces(Region const& region, int parts);

  [[nodiscard]] Region const& region() const { return *region_; }
  [[nodiscard]] int count() const { return static_cast<int>(region_->faces().size()); }
  [[nodiscard]] Face const& operator[](int face) const { return region_->faces()[face]; }
  [[nodiscard]] int parts() const { return parts_; }
  /// Of one face.
  [[nodiscard]] int lanes() const { return lanes_; }
  [[nodiscard]] std::size_t lane_count() const { return region_->faces().size() * lanes_; }
  /// Number of a lane among those of all faces: face by face, lane by lane.
  [[nodiscard]] std::size_t number(int face, int lane) const { return static_cast<std::size_t>(face) * lanes_ + lane; }
  [[nodiscard]] int face_of(std::size_t number) const { return static_cast<int>(number / lanes_); }

  /// The face of a cell of the region; -1: it has none there.
  [[nodiscard]] int find(Index3 const& inside, int direction, int side) const;
  /// The faces that a cell outside lies before, one per direction at most; -1: none.
  [[nodiscard]] std::array<int, 3> before(Index3 const& cell) const;
  /// The face through which a particle left the region that is now at `x` [m] and moved by `move` [m] in the last step.
  /// Throws NumericalError where it started more than a cell from the region.
  [[nodiscard]] int crossed(Vec3 const& x, Vec3 const& move) const;
  /// The cell of the domain that a particle lies in.
  [[nodiscard]] Index3 cell_at(Vec3 const& x) const;

  /// The lane of a face that a place [m] lies in.
  [[nodiscard]] int lane_of(int face, Vec3 const& x) const;
  /// The part of the inside cell that a lane of a face leads to.
  [[nodiscard]] Index3 sub_cell(int face, int lane) const;
  [[nodiscard]] double lane_area(int face, int lane) const;  ///< in the units of `Metric::face_area` [m2]
  /// Volume of a part of a cell: what one particle takes [m3].
  [[nodiscard]] double standard_volume(Index3 const& cell, Index3 const& sub) const;
  /// Numbers of the lanes beside a lane along the region's surface, around edges too; -1: none. Open faces have none.
  [[nodiscard]] std::array<int, 4> const& neighbours(std::size_t number) const { return neighbours_[number]; }

 private:
  [[nodiscard]] int lane_at(int face, Index3 const& sub) const;
  void find_neighbours();

  Region const* region_;
  int parts_;
  int lanes_ = 1;
  grid::Metric sub_cells_;                                        ///< of cells as small as the lanes are wide
  std::unordered_map<std::size_t, std::array<int, 6>> faces_of_;  ///< cell of the region -> faces, or -1
  std::vector<std::array<int, 4>> neighbours_;
};

}  // namespace brisance::bridge
