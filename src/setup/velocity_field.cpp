#include "setup/velocity_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace brisance::setup {

VelocityField::VelocityField(Vec3 const& velocity, InitialMotion const& motion)
    : velocity_(velocity), spin_(motion.spin), centre_(motion.centre) {
  for (std::string const& text : motion.expressions) expressions_.emplace_back(text);
}

Vec3 VelocityField::unchecked(Vec3 const& x) {
  Vec3 v = velocity_;
  for (std::size_t d = 0; d < expressions_.size(); ++d) v[d] = expressions_[d](x);
  Vec3 const r = x - centre_;
  v[0] += spin_[1] * r[2] - spin_[2] * r[1];
  v[1] += spin_[2] * r[0] - spin_[0] * r[2];
  v[2] += spin_[0] * r[1] - spin_[1] * r[0];
  return v;
}

Vec3 VelocityField::operator()(Vec3 const& x) {
  Vec3 const v = unchecked(x);
  if (std::isfinite(dot(v, v))) return v;
  throw InputError(
      fmt::format("the velocity at the start is not finite at ({:.6g}, {:.6g}, {:.6g}) m", x[0], x[1], x[2]));
}

std::array<double, 9> VelocityField::gradient(Vec3 const& x, double step, int dimensions) {
  std::array<double, 9> gradient{};
  for (int j = 0; j < dimensions; ++j) {
    Vec3 low = x;
    Vec3 high = x;
    low[j] -= step;
    high[j] += step;
    Vec3 const difference = (*this)(high) - (*this)(low);
    for (int i = 0; i < 3; ++i) gradient[3 * i + j] = difference[i] / (high[j] - low[j]);
  }
  return gradient;
}

double estimated_speed(Body const& body, grid::Domain const& domain) {
  if (!body.motion.any()) return norm(body.velocity);
  VelocityField field(body.velocity, body.motion);
  shape::Box const box = shape::bounds(body.shape);
  double largest = 0.0;
  for (int corner = 0; corner <= 8; ++corner) {
    Vec3 x{0.0, 0.0, 0.0};
    for (int d = 0; d < domain.dimensions(); ++d) {
      double const at =
          corner == 8 ? 0.5 * (box.lower[d] + box.upper[d]) : (((corner >> d) & 1) != 0 ? box.upper[d] : box.lower[d]);
      x[d] = std::clamp(at, domain.lower[d], domain.upper(d));
    }
    try {
      largest = std::max(largest, norm(field(x)));
    } catch (InputError const&) {  // the corner lies outside the body
    }
  }
  return largest;
}

}  // namespace brisance::setup
