/// Elementary functions that the compiler can vectorise inside a loop. Those with a type V take a number or a vector of
/// numbers, see core/vector.hpp.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace brisance {

/// `a` where the condition holds, else `b`; of vectors lane by lane.
[[nodiscard]] inline double select(bool condition, double a, double b) { return condition ? a : b; }
/// Does it hold anywhere?
[[nodiscard]] inline bool any(bool condition) { return condition; }
/// Does it hold everywhere?
[[nodiscard]] inline bool all(bool condition) { return condition; }

/// What is done with the bits of a number.
template <class V>
struct Bits;
template <>
struct Bits<double> {
  using Integer = std::uint64_t;
  [[nodiscard]] static Integer of(double x) { return std::bit_cast<Integer>(x); }
  [[nodiscard]] static double number(Integer bits) { return std::bit_cast<double>(bits); }
};
/// 2^n, n the integer in the low mantissa bits of `shifted`.
template <class V>
[[nodiscard]] inline V power_of_two(V const& shifted) {
  using Integer = typename Bits<V>::Integer;
  return Bits<V>::number((Bits<V>::of(shifted) + Integer(1023U)) << 52);
}

/// exp(x) for x <= 0, without branches or calls, so that loops over it vectorise.
/// Relative error below 4e-16 for -700 <= x <= 0; below -700 the value at -700 (about 1e-304) is returned.
/// Cody-Waite reduction x = n ln2 + r, |r| <= ln2/2, Taylor polynomial of degree 12 for exp(r).
template <class V>
[[nodiscard]] inline V exp_nonpositive(V const& x) {
  using std::max;
  constexpr double log2e = 1.4426950408889634074;
  constexpr double ln2_high = 6.93147180369123816490e-01;
  constexpr double ln2_low = 1.90821492927058770002e-10;
  constexpr double shifter = 0x1.8p52;  // adding it leaves round(x log2 e) in the low mantissa bits
  V const y = max(x, V(-700.0));
  V const shifted = y * log2e + shifter;
  V const n = shifted - shifter;
  V const r = (y - n * ln2_high) - n * ln2_low;
  V p = r * (1.0 / 479001600.0) + 1.0 / 39916800.0;
  p = p * r + 1.0 / 3628800.0;
  p = p * r + 1.0 / 362880.0;
  p = p * r + 1.0 / 40320.0;
  p = p * r + 1.0 / 5040.0;
  p = p * r + 1.0 / 720.0;
  p = p * r + 1.0 / 120.0;
  p = p * r + 1.0 / 24.0;
  p = p * r + 1.0 / 6.0;
  p = p * r + 0.5;
  p = p * r + 1.0;
  p = p * r + 1.0;
  return p * power_of_two(shifted);
}

/// exp(x), vectorisable. Relative error below 4e-16 for |x| <= 700; beyond, the value at the nearer end is returned.
/// As exp_nonpositive, but with the polynomial summed in pairs [Estrin60]: a shorter chain of dependent operations,
/// half the time where nothing else is there to fill it.
template <class V>
[[nodiscard]] inline V exp_bounded(V const& x) {
  using std::max;
  using std::min;
  constexpr double log2e = 1.4426950408889634074;
  constexpr double ln2_high = 6.93147180369123816490e-01;
  constexpr double ln2_low = 1.90821492927058770002e-10;
  constexpr double shifter = 0x1.8p52;
  V const y = min(max(x, V(-700.0)), V(700.0));
  V const shifted = y * log2e + shifter;
  V const n = shifted - shifter;
  V const r = (y - n * ln2_high) - n * ln2_low;
  V const r2 = r * r;
  V const r4 = r2 * r2;
  V const c2 = 0.5 + r * (1.0 / 6.0);
  V const c4 = 1.0 / 24.0 + r * (1.0 / 120.0);
  V const c6 = 1.0 / 720.0 + r * (1.0 / 5040.0);
  V const c8 = 1.0 / 40320.0 + r * (1.0 / 362880.0);
  V const c10 = 1.0 / 3628800.0 + r * (1.0 / 39916800.0);
  V const low = c2 + r2 * c4;
  V const high = (c6 + r2 * c8) + r4 * (c10 + r2 * (1.0 / 479001600.0));
  V const p = 1.0 + (r + r2 * (low + r4 * high));
  return p * power_of_two(shifted);
}

/// ln(x) for x > 0, vectorisable. Error below 1 ulp of the result (2.3e-16 relative) for normal x; numbers below the
/// smallest normal one, zero and negative ones give the value there, about -708.
/// x = 2^k m, sqrt(1/2) <= m < sqrt(2); with f = m - 1, s = f / (2 + f): ln m = f - f^2/2 + s (f^2/2 + R(s^2)), R the
/// minimax polynomial of fdlibm [Fdlibm93].
template <class V>
[[nodiscard]] inline V log_positive(V const& x) {
  using std::max;
  using Integer = typename Bits<V>::Integer;
  constexpr double smallest = 0x1p-1022;
  constexpr double ln2_high = 6.93147180369123816490e-01;
  constexpr double ln2_low = 1.90821492927058770002e-10;
  constexpr std::uint64_t one = 0x3ff0000000000000U;
  constexpr std::uint64_t root_half = 0x3fe6a09e667f3bcdU;
  constexpr std::uint64_t two52 = 0x4330000000000000U;  // bits of 2^52: an integer put below them becomes a double
  Integer const bits = Bits<V>::of(max(x, V(smallest)));
  Integer const exponent = (bits + Integer(one - root_half)) >> 52;
  V const k = Bits<V>::number(exponent | Integer(two52)) - (0x1p52 + 1023.0);
  V const f = Bits<V>::number(bits - ((exponent - Integer(1023U)) << 52)) - 1.0;
  V const s = f / (2.0 + f);
  V const z = s * s;
  V const z2 = z * z;
  V const odd = 6.666666666666735130e-01 +
                z2 * (2.857142874366239149e-01 + z2 * (1.818357216161805012e-01 + z2 * 1.479819860511658591e-01));
  V const even = 3.999999999940941908e-01 + z2 * (2.222219843214978396e-01 + z2 * 1.531383769920937332e-01);
  V const R = z * odd + z2 * even;
  V const half = 0.5 * f * f;
  return k * ln2_high - ((half - (s * (half + R) + k * ln2_low)) - f);
}

/// x^y for x >= 0 and y > 0, vectorisable; 0 at x = 0. Relative error below 3e-16 (1 + |y ln x|), from the rounding of
/// y ln x.
template <class V>
[[nodiscard]] inline V pow_nonnegative(V const& x, double y) {
  V const value = exp_bounded(V(y * log_positive(x)));
  return select(x > 0.0, value, V(0.0));
}

}  // namespace brisance
