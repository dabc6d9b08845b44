/// The triangles of a mesh by where lines along x meet them. Private to this folder.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "core/vec.hpp"
#include "grid/cell.hpp"

namespace brisance::shape {

/// Bins of the plane (y, z), each with the triangles whose boxes cover it, in the order in which they begin along x.
class LineBins {
 public:
  using Bounds = std::array<Vec3, 2>;  ///< low and high corner [m]

  LineBins() = default;
  /// `boxes` are those around the triangles, all of them between `lower` and `upper`; `shells` those around the shells
  /// that `shell_of` tells.
  LineBins(Vec3 const& lower, Vec3 const& upper, std::vector<Bounds> const& boxes, std::vector<int> const& shell_of,
           std::vector<Bounds> const& shells)
      : lower_(lower) {
    fill(upper - lower, boxes);
    reach_.resize(items_.size());
    bool const several = shells.size() > 1;
    if (several) {
      shell_begin_.resize(items_.size());
      shell_end_.resize(items_.size());
    }
    for (std::size_t b = 0; b + 1 < start_.size(); ++b) {
      std::size_t const first = start_[b];
      std::size_t const last = start_[b + 1];
      auto const at = [this](std::size_t n) { return items_.begin() + static_cast<std::ptrdiff_t>(n); };
      std::sort(at(first), at(last),
                [&](int m, int n) { return std::pair(boxes[m][0][0], m) < std::pair(boxes[n][0][0], n); });
      for (std::size_t n = first; n < last; ++n) {
        reach_[n] = std::max(n == first ? -infinity : reach_[n - 1], boxes[items_[n]][1][0]);
        if (several)
          shell_end_[n] = std::max(n == first ? -infinity : shell_end_[n - 1], shells[shell_of[items_[n]]][1][0]);
      }
      for (std::size_t n = last; several && n-- > first;)
        shell_begin_[n] = std::min(n + 1 == last ? infinity : shell_begin_[n + 1], shells[shell_of[items_[n]]][0][0]);
    }
  }

  /// Triangles that the line through (y, z) may meet, at least those of the shells that lie between `from` and `to`.
  template <class Use>
  void on_line(double y, double z, double from, double to, Use use) const {
    std::size_t const b = all_.offset({bin(0, y), bin(1, z), 0});
    std::size_t const last = start_[b + 1];
    std::size_t const first = shell_end_.empty() ? start_[b] : first_of(shell_end_, b, from);
    for (std::size_t n = first; n < last; ++n) {
      if (!shell_begin_.empty() && shell_begin_[n] > to) break;
      use(items_[n]);
    }
  }

  /// Does `test` hold for one of the triangles near a box? `box_of` gives the box around a triangle.
  template <class BoxOf, class Test>
  [[nodiscard]] bool any_in(Bounds const& box, BoxOf box_of, Test test) const {
    return any_cell(between(box), [&](Index3 const& at) {
      std::size_t const b = all_.offset(at);
      for (std::size_t n = first_of(reach_, b, box[0][0]); n < start_[b + 1]; ++n) {
        auto const [from, to] = box_of(items_[n]);
        if (from[0] > box[1][0]) break;
        bool reaches = true;
        for (int d = 0; d < 3; ++d) reaches = reaches && from[d] <= box[1][d] && to[d] >= box[0][d];
        if (reaches && test(items_[n])) return true;
      }
      return false;
    });
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  void fill(Vec3 const& extent, std::vector<Bounds> const& boxes) {
    auto const count = static_cast<double>(boxes.size());
    int per_side = std::clamp(static_cast<int>(std::sqrt(count)), 1, 2048);
    // Long thin triangles cover many bins each: then coarser bins keep the table short.
    for (;; per_side = std::max(1, per_side / 2)) {
      for (int axis = 0; axis < 2; ++axis) {
        all_.upper[axis] = extent[1 + axis] > 0.0 ? per_side : 1;
        per_metre_[axis] = extent[1 + axis] > 0.0 ? per_side / extent[1 + axis] : 0.0;
      }
      double entries = 0.0;
      for (Bounds const& box : boxes) entries += static_cast<double>(between(box).count());
      if (entries <= 16.0 * count + 1000.0 || per_side == 1) break;
    }
    start_.assign(all_.count() + 1, 0);
    auto const each = [&](auto const& use) {
      for (std::size_t n = 0; n < boxes.size(); ++n)
        for_each_cell(between(boxes[n]), [&](Index3 const& b) { use(all_.offset(b), static_cast<int>(n)); });
    };
    each([&](std::size_t b, int) { ++start_[b + 1]; });
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    items_.resize(start_.back());
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    each([&](std::size_t b, int n) { items_[next[b]++] = n; });
  }

  [[nodiscard]] int bin(int axis, double at) const {
    double const b = (at - lower_[1 + axis]) * per_metre_[axis];
    return std::clamp(static_cast<int>(std::clamp(b, -1.0, 1e9)), 0, all_.upper[axis] - 1);
  }
  [[nodiscard]] grid::CellRange between(Bounds const& box) const {
    return {{bin(0, box[0][1]), bin(1, box[0][2]), 0}, {bin(0, box[1][1]) + 1, bin(1, box[1][2]) + 1, 1}};
  }
  /// The first item of a bin from which on one reaches as far as x; `ends` rise within a bin.
  [[nodiscard]] std::size_t first_of(std::vector<double> const& ends, std::size_t b, double x) const {
    auto const at = [&](std::size_t n) { return ends.begin() + static_cast<std::ptrdiff_t>(n); };
    return static_cast<std::size_t>(std::lower_bound(at(start_[b]), at(start_[b + 1]), x) - ends.begin());
  }

  Vec3 lower_{};
  grid::CellRange all_;
  std::array<double, 2> per_metre_{};
  std::vector<std::size_t> start_;
  std::vector<int> items_;
  std::vector<double> reach_;        ///< how far along x an item and those before it in its bin reach
  std::vector<double> shell_end_;    ///< the same of their shells; empty where there is one only
  std::vector<double> shell_begin_;  ///< where the shells of an item and those behind it begin
};

}  // namespace brisance::shape
