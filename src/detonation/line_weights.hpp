/// Exact integrals along straight lines through a field of concentric shells. Each line adds, for every shell that it
/// crosses, its weight in a cell's integrals of a scalar and of a radial vector.
///
/// With rho the distance of the line from the centre and s the distance along it from the foot of the perpendicular,
/// r^2 = rho^2 + s^2 gives r dr = s ds, so that within one shell
///     int ds = [s],   int (s/r) ds = [r],   int (rho/r) ds = rho [asinh(s/rho)] = rho [ln(s + r)].
/// In a plane through an axis, on lines across it (s is then the distance from the axis, rho the height):
///     int s ds = [s^2]/2,   int (rho/r) s ds = rho [r],   int (s/r) s ds = [s r - rho^2 ln(s + r)]/2.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/vec.hpp"

namespace brisance::detonation {

class LineWeights {
 public:
  /// `shells` of equal thickness [m] around the centre.
  LineWeights(int shells, double thickness) : count_(shells), thickness_(thickness) {
    for (auto* values : {&volume_, &direction_[0], &direction_[1], &direction_[2]}) values->assign(shells, 0.0);
  }

  /// Begins a cell that touches the shells first <= i < last.
  void begin(int first, int last) {
    first_ = std::clamp(first, 0, count_);
    last_ = std::clamp(last, first_, count_);
    for (auto* values : {&volume_, &direction_[0], &direction_[1], &direction_[2]})
      std::fill(values->begin() + first_, values->begin() + last_, 0.0);
  }

  /// A line along direction d through `foot` (relative to the centre; its component along d does not count) from s0 to
  /// s1, s0 < s1.
  void straight(int d, Vec3 foot, double s0, double s1, double weight) {
    foot[d] = 0.0;
    double const rho2 = dot(foot, foot);
    auto const part = [&](double a, double b, double sign) {
      cross(rho2, a, b, [&](int i, double low, double high, double r_low, double r_high) {
        volume_[i] += weight * (high - low);
        direction_[d][i] += sign * weight * (r_high - r_low);
        if (rho2 <= 0.0) return;
        double const across = weight * std::log((high + r_high) / (low + r_low));
        for (int e = 0; e < 3; ++e) direction_[e][i] += across * foot[e];
      });
    };
    if (s0 < 0.0) part(std::max(-s1, 0.0), -s0, -1.0);
    if (s1 > 0.0) part(std::max(s0, 0.0), s1, 1.0);
  }

  /// A line across the axis y of a body of revolution at the height y (relative to the centre), from the radius s0 to
  /// s1; the weight counts the whole circle.
  void ring(double y, double s0, double s1, double weight) {
    double const rho2 = y * y;
    double const circle = 2.0 * std::numbers::pi * weight;
    cross(rho2, s0, s1, [&](int i, double low, double high, double r_low, double r_high) {
      volume_[i] += circle * 0.5 * (high * high - low * low);
      direction_[1][i] += circle * y * (r_high - r_low);
      double const logarithm = rho2 > 0.0 ? rho2 * std::log((high + r_high) / (low + r_low)) : 0.0;
      direction_[0][i] += circle * 0.5 * (high * r_high - low * r_low - logarithm);
    });
  }

  [[nodiscard]] int first() const { return first_; }
  [[nodiscard]] int last() const { return last_; }
  /// Integral of 1 over the part of the cell in shell i.
  [[nodiscard]] double volume(int i) const { return volume_[i]; }
  /// Integral of the unit vector away from the centre over it.
  [[nodiscard]] double direction(int d, int i) const { return direction_[d][i]; }

 private:
  /// Visits the stretches of the line between 0 <= a and b, shell by shell; what lies beyond the last shell is left
  /// out.
  template <class Visit>
  void cross(double rho2, double a, double b, Visit&& visit) const {
    if (!(b > a)) return;
    double r = std::sqrt(rho2 + a * a);
    // Rounding may put the ends of a cell a hair outside of the shells that its corners touch.
    int i = std::max(static_cast<int>(r / thickness_), first_);
    while (i < last_) {
      double const edge = (i + 1) * thickness_;
      double const at2 = edge * edge - rho2;
      bool const ends = at2 >= b * b || (i + 1 == last_ && last_ < count_);
      double const next = ends ? b : std::max(a, std::sqrt(std::max(at2, 0.0)));
      double const r_next = ends ? std::sqrt(rho2 + b * b) : edge;
      visit(i, a, next, r, r_next);
      if (ends) return;
      a = next;
      r = r_next;
      ++i;
    }
  }

  int count_;
  double thickness_;
  int first_ = 0;
  int last_ = 0;
  std::vector<double> volume_;
  std::array<std::vector<double>, 3> direction_;
};

/// Stations and weights on the interval 0 to 1: `pieces` equal pieces with Gauss's rule of 2 or 4 stations in each.
struct Rule {
  std::vector<double> at;
  std::vector<double> weight;

  Rule(int pieces, int stations) {
    constexpr std::array<double, 2> two{0.5773502691896257, 1.0};
    constexpr std::array<double, 4> four{0.3399810435848563, 0.6521451548625461, 0.8611363115940526,
                                         0.3478548451374538};
    for (int n = 0; n < pieces; ++n) {
      auto const add = [&](double x, double w) {
        for (double const sign : {-1.0, 1.0}) {
          at.push_back((n + 0.5 + 0.5 * sign * x) / pieces);
          weight.push_back(0.5 * w / pieces);
        }
      };
      add(stations == 2 ? two[0] : four[0], stations == 2 ? two[1] : four[1]);
      if (stations == 4) add(four[2], four[3]);
    }
  }
};

}  // namespace brisance::detonation
