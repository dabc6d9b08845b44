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

}  // namespace brisance
