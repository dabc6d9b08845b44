/// Limited slopes, of a number or of vectors: half the difference over a cell, what a face differs by from its centre.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/math.hpp"

namespace brisance::gas {

/// Half the limited difference over a cell from the backward and forward differences: generalised monotonised-central
/// limiter [VanLeer77], minmod for beta = 1, the classical one for beta = 2. Of the two terms one is 0 at least: the
/// first where a difference is negative, the second where one is positive.
template <class V>
[[nodiscard]] inline V limited_half(V const& backward, V const& forward, V const& half_beta) {
  using std::max;
  using std::min;
  V const zero(0.0);
  V const centred = 0.25 * (backward + forward);
  V const rise = min(centred, half_beta * min(backward, forward));
  V const fall = max(centred, half_beta * max(backward, forward));
  return max(zero, rise) + min(zero, fall);
}

/// The compressive counterpart for contacts: Roe's superbee [Sweby84].
template <class V>
[[nodiscard]] inline V compressed_half(V const& backward, V const& forward) {
  using std::abs;
  using std::copysign;
  using std::max;
  using std::min;
  V const a = abs(backward);
  V const b = abs(forward);
  V const size = 0.5 * max(min(2.0 * a, b), min(a, 2.0 * b));
  return select(backward * forward > 0.0, copysign(size, backward), V(0.0));
}

}  // namespace brisance::gas
