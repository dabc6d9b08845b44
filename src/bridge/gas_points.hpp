/// The material points of the gas where they come into the region and leave it: their making, their taking out, and
/// what each carries.
#pragma once

#include <vector>

#include "bridge/cell_states.hpp"
#include "bridge/faces.hpp"
#include "bridge/traffic.hpp"
#include "mpm/mpm.hpp"

namespace brisance::bridge {

/// Writes the velocity gradient that APIC's points carry; `h`: size of a cell [m].
void set_gradient(mpm::PointSet& set, int q, GasSlopes const& slopes, int dimensions, double h);

class GasPoints {
 public:
  /// `body`: of the gas points; `outer_blocks`: blocks of points that hold cells outside the region. Keeps references.
  GasPoints(mpm::Mpm& points, int body, material::Fluids const& fluids, Faces const& faces,
            std::vector<int> outer_blocks);

  [[nodiscard]] mpm::PointSet empty_set() const { return mpm::PointSet(mpm::fields(*points_, body_)); }
  /// Appends a point that comes in through a lane at a depth [m] from its face; `mass` [kg].
  void append(int face, int lane, double depth, double mass, Primitive const& state, GasSlopes const& slopes,
              mpm::PointSet& to) const;
  /// Puts new points among those of the gas.
  void add(mpm::PointSet const& set) { points_->add(body_, set); }
  /// What a point carries, its own velocity gradient's energy included.
  [[nodiscard]] Amounts carried(mpm::PointSet const& set, int q) const;
  /// The same with the work that the reference pressure does when a point comes or goes: the points in the region feel
  /// nothing of it, but as they stretch to fill the space left they give it away. Through open faces
  /// nothing of that is booked.
  [[nodiscard]] Amounts handed_over(mpm::PointSet const& set, int q) const;

  /// Takes out the points that have left the region; they stay in the sets, one per outer block, until the next call.
  std::vector<mpm::PointSet> const& take_leavers();

 private:
  mpm::Mpm* points_;
  int body_;
  bool has_gradient_energy_;  ///< see `mpm::BodyRules`
  material::Fluids const* fluids_;
  Faces const* faces_;
  std::vector<int> outer_blocks_;
  std::vector<mpm::PointSet> leavers_;
};

}  // namespace brisance::bridge
