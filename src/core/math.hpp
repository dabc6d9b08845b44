/// Elementary functions that the compiler can vectorise inside a loop.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace brisance {

/// exp(x) for x <= 0, without branches or calls, so that loops over it vectorise.
/// Relative error below 4e-16 for -700 <= x <= 0; below -700 the value at -700 (about 1e-304) is returned.
/// Cody-Waite reduction x = n ln2 + r, |r| <= ln2/2, Taylor polynomial of degree 12 for exp(r).
[[nodiscard]] inline double exp_nonpositive(double x) {
  constexpr double log2e = 1.4426950408889634074;
  constexpr double ln2_high = 6.93147180369123816490e-01;
  constexpr double ln2_low = 1.90821492927058770002e-10;
  constexpr double shifter = 0x1.8p52;  // adding it leaves round(x log2 e) in the low mantissa bits
  double const y = x > -700.0 ? x : -700.0;
  double const shifted = y * log2e + shifter;
  double const n = shifted - shifter;
  double const r = (y - n * ln2_high) - n * ln2_low;
  double p = 1.0 / 479001600.0;
  p = p * r + 1.0 / 39916800.0;
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
  auto const scale = (std::bit_cast<std::uint64_t>(shifted) + 1023U) << 52U;
  return p * std::bit_cast<double>(scale);
}

/// exp(x), vectorisable. Relative error below 4e-16 for |x| <= 700; beyond, the value at the nearer end is returned.
/// As exp_nonpositive, but with the polynomial summed in pairs [Estrin60]: a shorter chain of dependent operations,
/// half the time where nothing else is there to fill it.
[[nodiscard]] inline double exp_bounded(double x) {
  constexpr double log2e = 1.4426950408889634074;
  constexpr double ln2_high = 6.93147180369123816490e-01;
  constexpr double ln2_low = 1.90821492927058770002e-10;
  constexpr double shifter = 0x1.8p52;
  double const above = x > -700.0 ? x : -700.0;
  double const y = above < 700.0 ? above : 700.0;
  double const shifted = y * log2e + shifter;
  double const n = shifted - shifter;
  double const r = (y - n * ln2_high) - n * ln2_low;
  double const r2 = r * r;
  double const r4 = r2 * r2;
  double const c2 = 0.5 + r * (1.0 / 6.0);
  double const c4 = 1.0 / 24.0 + r * (1.0 / 120.0);
  double const c6 = 1.0 / 720.0 + r * (1.0 / 5040.0);
  double const c8 = 1.0 / 40320.0 + r * (1.0 / 362880.0);
  double const c10 = 1.0 / 3628800.0 + r * (1.0 / 39916800.0);
  double const low = c2 + r2 * c4;
  double const high = (c6 + r2 * c8) + r4 * (c10 + r2 * (1.0 / 479001600.0));
  double const p = 1.0 + (r + r2 * (low + r4 * high));
  auto const scale = (std::bit_cast<std::uint64_t>(shifted) + 1023U) << 52U;
  return p * std::bit_cast<double>(scale);
}

/// ln(x) for x > 0, vectorisable. Error below 1 ulp of the result (2.3e-16 relative) for normal x; numbers below the
/// smallest normal one, zero and negative ones give the value there, about -708.
/// x = 2^k m, sqrt(1/2) <= m < sqrt(2); with f = m - 1, s = f / (2 + f): ln m = f - f^2/2 + s (f^2/2 + R(s^2)), R the
/// minimax polynomial of fdlibm [Fdlibm93].
[[nodiscard]] inline double log_positive(double x) {
  constexpr double smallest = 0x1p-1022;
  constexpr double ln2_high = 6.93147180369123816490e-01;
  constexpr double ln2_low = 1.90821492927058770002e-10;
  constexpr std::uint64_t one = 0x3ff0000000000000U;
  constexpr std::uint64_t root_half = 0x3fe6a09e667f3bcdU;
  constexpr std::uint64_t two52 = 0x4330000000000000U;  // bits of 2^52: an integer put below them becomes a double
  auto const bits = std::bit_cast<std::uint64_t>(x > smallest ? x : smallest);
  std::uint64_t const exponent = (bits + (one - root_half)) >> 52U;
  double const k = std::bit_cast<double>(exponent | two52) - (0x1p52 + 1023.0);
  double const f = std::bit_cast<double>(bits - ((exponent - 1023U) << 52U)) - 1.0;
  double const s = f / (2.0 + f);
  double const z = s * s;
  double const z2 = z * z;
  double const odd = 6.666666666666735130e-01 +
                     z2 * (2.857142874366239149e-01 + z2 * (1.818357216161805012e-01 + z2 * 1.479819860511658591e-01));
  double const even = 3.999999999940941908e-01 + z2 * (2.222219843214978396e-01 + z2 * 1.531383769920937332e-01);
  double const R = z * odd + z2 * even;
  double const half = 0.5 * f * f;
  return k * ln2_high - ((half - (s * (half + R) + k * ln2_low)) - f);
}

/// x^y for x >= 0 and y > 0, vectorisable; 0 at x = 0. Relative error below 3e-16 (1 + |y ln x|), from the rounding of
/// y ln x.
[[nodiscard]] inline double pow_nonnegative(double x, double y) {
  double const value = exp_bounded(y * log_positive(x));
  return x > 0.0 ? value : 0.0;
}

}  // namespace brisance
