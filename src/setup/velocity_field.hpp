/// The velocity at the start as a function of the place.
#pragma once

#include <array>
#include <vector>

#include "case/case.hpp"
#include "core/expression.hpp"

namespace brisance::setup {

/// A constant velocity, or expressions in its place, and a rotation. One thread at a time evaluates it.
class VelocityField {
 public:
  /// Throws InputError where an expression is none.
  VelocityField(Vec3 const& velocity, InitialMotion const& motion);

  /// [m/s] at x [m]. Throws InputError where it is not finite.
  [[nodiscard]] Vec3 operator()(Vec3 const& x);
  /// The same without that.
  [[nodiscard]] Vec3 unchecked(Vec3 const& x);
  /// Its gradient dv_i/dx_j [1/s], row by row, by central differences over `step` [m] in the resolved directions:
  /// exact where the velocity is linear.
  [[nodiscard]] std::array<double, 9> gradient(Vec3 const& x, double step, int dimensions);

 private:
  Vec3 velocity_;
  Vec3 spin_;
  Vec3 centre_;
  std::vector<Expression> expressions_;
};

/// Largest speed [m/s] at the corners and the centre of a body's box, as far as it is finite there: an estimate.
[[nodiscard]] double estimated_speed(Body const& body, grid::Domain const& domain);

}  // namespace brisance::setup
