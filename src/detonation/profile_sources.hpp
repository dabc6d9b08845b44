/// A profile as a source of gas: what of it lies in a cell of another grid, by integrals over lines. Private to this
/// folder.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "detonation/line_weights.hpp"
#include "detonation/remap.hpp"

namespace brisance::detonation {

// Of one translation unit, so that the lines of a cell are inlined into it.
namespace {

inline constexpr int most_components = 32;
inline constexpr double sharp_ratio = 1.05;  // of densities or pressures in a cell, above which it takes more lines
inline constexpr int smooth_pieces = 1;      // with 4 stations each
inline constexpr int sharp_pieces = 8;       // with 2 stations each; in 2D, where one rule is enough, `sharp_pieces_2d`
inline constexpr int sharp_pieces_2d = 32;

/// Integrals of the profile over the part of a cell that the burst fills.
struct CellIntegrals {
  std::array<double, most_components> component{};
  double pressure = 0.0;
  double volume = 0.0;
  bool whole = false;  ///< the burst fills the cell
};

inline bool is_momentum(int c) { return c >= gas::momentum_x && c <= gas::momentum_z; }

/// Distances of the nearest and of the farthest point of a box with edges h from the origin, in the given directions.
inline std::array<double, 2> distances(Vec3 const& low, double h, std::array<bool, 3> const& counts) {
  double near2 = 0.0;
  double far2 = 0.0;
  for (int d = 0; d < 3; ++d) {
    if (!counts[d]) continue;
    double const a = low[d];
    double const b = low[d] + h;
    double const near = a > 0.0 ? a : b < 0.0 ? -b : 0.0;
    double const far = std::max(std::abs(a), std::abs(b));
    near2 += near * near;
    far2 += far * far;
  }
  return {std::sqrt(near2), std::sqrt(far2)};
}

/// A spherical or cylindrical profile.
class RadialSource {
 public:
  RadialSource(Profile const& profile, grid::Geometry target)
      : profile_(&profile),
        target_(target),
        shells_(profile.domain.cells[0]),
        thickness_(profile.domain.smallest_cell()),
        lines_(shells_, thickness_) {}

  [[nodiscard]] bool integrate(Vec3 const& low, double h, CellIntegrals& out) {
    int const dims = grid::dimensions(target_);
    auto const [near, far] = distances(low, h, {true, dims > 1, dims > 2});
    double const reach = profile_->domain.upper(0);
    if (near >= reach) return false;
    int const first = static_cast<int>(near / thickness_);
    lines_.begin(first, static_cast<int>(far / thickness_) + 1);
    bool const sharp = far > reach || is_sharp();
    Vec3 middle{0.0, 0.0, 0.0};
    int along = 0;
    for (int d = 0; d < dims; ++d) {
      middle[d] = low[d] + 0.5 * h;
      if (std::abs(middle[d]) > std::abs(middle[along])) along = d;
    }
    Rule const& rule = !sharp ? smooth_ : dims == 3 ? sharp_ : sharp_2d_;
    int const stations = static_cast<int>(rule.at.size());
    int const e = (along + 1) % dims;
    int const f = (along + 2) % dims;
    bool const ring = target_ == grid::Geometry::axisymmetric2d;
    for (int m = 0; m < stations; ++m) {
      Vec3 foot{0.0, 0.0, 0.0};
      foot[e] = low[e] + rule.at[m] * h;
      double const weight = rule.weight[m] * h;
      if (ring && along == 0) {
        lines_.ring(foot[1], low[0], low[0] + h, weight);
      } else if (dims == 2) {
        double const circle = ring ? 2.0 * std::numbers::pi * foot[0] : 1.0;
        lines_.straight(along, foot, low[along], low[along] + h, weight * circle);
      } else {
        for (int n = 0; n < stations; ++n) {
          foot[f] = low[f] + rule.at[n] * h;
          lines_.straight(along, foot, low[along], low[along] + h, weight * rule.weight[n] * h);
        }
      }
    }
    gather(dims, out);
    out.whole = far <= reach;
    return out.volume > 0.0;
  }

 private:
  [[nodiscard]] bool is_sharp() const {
    // A burst has products in it, whatever the number of its fluids.
    double const* const mass = profile_->component(gas::partial_density(0));
    double const* const products = profile_->component(gas::partial_density(gas::products_fluid));
    std::array<double, 2> least{1e300, 1e300};
    std::array<double, 2> most{0.0, 0.0};
    for (int i = lines_.first(); i < lines_.last(); ++i) {
      std::array<double, 2> const values{mass[i] + products[i], profile_->pressure[i]};
      for (int q = 0; q < 2; ++q) {
        least[q] = std::min(least[q], values[q]);
        most[q] = std::max(most[q], values[q]);
      }
    }
    return most[0] > sharp_ratio * least[0] || most[1] > sharp_ratio * least[1];
  }

  void gather(int dims, CellIntegrals& out) const {
    out = {};
    double const* const radial = profile_->component(gas::momentum_x);
    for (int i = lines_.first(); i < lines_.last(); ++i) {
      double const v = lines_.volume(i);
      out.volume += v;
      out.pressure += v * profile_->pressure[i];
      for (int d = 0; d < dims; ++d) out.component[gas::momentum_x + d] += radial[i] * lines_.direction(d, i);
    }
    for (int c = 0; c < profile_->components; ++c) {
      if (is_momentum(c)) continue;
      double const* const values = profile_->component(c);
      for (int i = lines_.first(); i < lines_.last(); ++i) out.component[c] += lines_.volume(i) * values[i];
    }
  }

  Profile const* profile_;
  grid::Geometry target_;
  int shells_;
  double thickness_;
  LineWeights lines_;
  Rule smooth_{smooth_pieces, 4};
  Rule sharp_{sharp_pieces, 2};
  Rule sharp_2d_{sharp_pieces_2d, 2};
};

/// An axisymmetric profile. Lines parallel to its axis cross columns of its cells.
class AxialSource {
 public:
  AxialSource(Profile const& profile, Placing const& placing)
      : profile_(&profile), axis_(placing.axis), sense_(placing.sense), cells_(profile.domain.all_cells()) {
    Index3 const& n = profile.domain.cells;
    first_.assign(n[0], n[1]);
    last_.assign(n[0], 0);
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        bool quiet = true;
        for (int c = 0; c < profile.components && quiet; ++c)
          quiet = profile.component(c)[cells_.offset({i, j, 0})] == profile.ambient[c];
        if (quiet) continue;
        first_[i] = std::min(first_[i], j);
        last_[i] = j + 1;
      }
    }
  }

  [[nodiscard]] bool integrate(Vec3 const& low, double h, CellIntegrals& out) const {
    grid::Domain const& domain = profile_->domain;
    std::array<bool, 3> across{true, true, true};
    across[axis_] = false;
    auto const [near, far] = distances(low, h, across);
    if (near >= domain.upper(0)) return false;
    double a = sense_ > 0.0 ? low[axis_] : -low[axis_] - h;
    double const b = a + h;
    double const bottom = domain.lower[1];
    if (a >= domain.upper(1) || (!profile_->mirrored && b <= bottom) ||
        (profile_->mirrored && b <= 2.0 * bottom - domain.upper(1))) {
      return false;
    }
    out = {};
    out.whole = true;
    int const e = (axis_ + 1) % 3;
    int const f = (axis_ + 2) % 3;
    for (std::size_t m = 0; m < rule_.at.size(); ++m) {
      for (std::size_t n = 0; n < rule_.at.size(); ++n) {
        double const x = low[e] + rule_.at[m] * h;
        double const y = low[f] + rule_.at[n] * h;
        double const r = std::sqrt(x * x + y * y);
        double const weight = rule_.weight[m] * rule_.weight[n] * h * h;
        Vec3 radial{0.0, 0.0, 0.0};
        radial[e] = x / r;
        radial[f] = y / r;
        double const filled =
            line(r, a, b, 1.0, weight, radial, out) +
            (profile_->mirrored ? line(r, 2.0 * bottom - b, 2.0 * bottom - a, -1.0, weight, radial, out) : 0.0);
        out.whole = out.whole && filled >= h * (1.0 - 1e-12);
      }
    }
    return out.volume > 0.0;
  }

 private:
  /// Adds what lies between the heights a and b on a line at the radius r, above the profile's low face; returns the
  /// length.
  double line(double r, double a, double b, double sign, double weight, Vec3 const& radial, CellIntegrals& out) const {
    grid::Metric const& metric = profile_->domain;
    int const i = static_cast<int>(r / metric.h);
    if (i >= cells_.upper[0]) return 0.0;
    double const low = std::max(a, metric.face(1, first_[i]));
    double const high = std::min(b, metric.face(1, last_[i]));
    if (!(high > low)) return 0.0;
    int const from = std::max(first_[i], static_cast<int>(metric.in_cells(1, low)));
    for (int j = from; j < last_[i]; ++j) {
      double const bottom = metric.face(1, j);
      double const length = std::min(high, bottom + metric.h) - std::max(low, bottom);
      if (length <= 0.0) {
        if (bottom >= high) break;
        continue;
      }
      double const v = weight * length;
      std::size_t const n = cells_.offset({i, j, 0});
      out.volume += v;
      out.pressure += v * profile_->pressure[n];
      for (int c = 0; c < profile_->components; ++c) {
        if (!is_momentum(c)) out.component[c] += v * profile_->component(c)[n];
      }
      double const outwards = profile_->component(gas::momentum_x)[n];
      for (int d = 0; d < 3; ++d) out.component[gas::momentum_x + d] += v * outwards * radial[d];
      out.component[gas::momentum_x + axis_] += v * sign * sense_ * profile_->component(gas::momentum_y)[n];
    }
    return high - low;
  }

  Profile const* profile_;
  int axis_;
  double sense_;
  grid::CellRange cells_;   ///< of the profile
  std::vector<int> first_;  ///< rows of each column that the burst has reached
  std::vector<int> last_;
  Rule rule_{sharp_pieces, 2};
};

}  // namespace

}  // namespace brisance::detonation
