/// The space around a body in small boxes, and which of them its triangles may touch: most places are far from all of
/// them. Private to this folder.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/vec.hpp"
#include "grid/cell.hpp"

namespace brisance::shape {

class TouchedBoxes {
 public:
  using Bounds = std::array<Vec3, 2>;  ///< low and high corner [m]

  /// `triangles` are the boxes around triangles, all of them between `lower` and `upper`.
  TouchedBoxes(Vec3 const& lower, Vec3 const& upper, std::vector<Bounds> const& triangles) : lower_(lower) {
    Vec3 const extent = upper - lower;
    double const longest = std::max({extent[0], extent[1], extent[2]});
    double const wanted = std::min(8.0 * static_cast<double>(triangles.size()), 16e6);
    double const volume = std::max(extent[0] * extent[1] * extent[2], 1e-6 * longest * longest * longest);
    constexpr double most_marks = 64e6;
    constexpr std::size_t few = 64;
    // Large triangles touch many boxes each: then larger boxes keep the work short.
    for (per_metre_ = std::cbrt(wanted / volume);; per_metre_ *= 0.5) {
      for (int d = 0; d < 3; ++d)
        all_.upper[d] = std::clamp(static_cast<int>(std::ceil(extent[d] * per_metre_)), 1, 4096);
      double marks = 0.0;
      for (Bounds const& box : triangles) marks += static_cast<double>(covered(box).count());
      if (marks <= most_marks || all_.count() <= few) break;
    }
    touched_.assign(all_.count(), 0);
    for (Bounds const& box : triangles)
      for_each_cell(covered(box), [&](Index3 const& at) { touched_[all_.offset(at)] = 1; });
  }

  /// May a triangle touch the box? False is certain.
  [[nodiscard]] bool any_in(Bounds const& box) const {
    return any_cell(covered(box), [&](Index3 const& at) { return touched_[all_.offset(at)] != 0; });
  }

 private:
  [[nodiscard]] grid::CellRange covered(Bounds const& box) const {
    grid::CellRange range;
    for (int d = 0; d < 3; ++d) {
      auto const at = [&](double x) {
        return static_cast<int>(std::clamp((x - lower_[d]) * per_metre_, 0.0, static_cast<double>(all_.upper[d] - 1)));
      };
      range.lower[d] = at(box[0][d]);
      range.upper[d] = at(box[1][d]) + 1;
    }
    return range;
  }

  Vec3 lower_;
  grid::CellRange all_;
  double per_metre_ = 0.0;
  std::vector<std::uint8_t> touched_;
};

}  // namespace brisance::shape
