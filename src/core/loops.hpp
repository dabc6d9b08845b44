/// How a loop over contiguous arrays is marked for the vectoriser: iterations are independent.
#pragma once

#include <algorithm>
#include <array>

#if defined(__clang__)
#define BRISANCE_VECTOR_LOOP _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define BRISANCE_VECTOR_LOOP _Pragma("GCC ivdep")
#else
#define BRISANCE_VECTOR_LOOP
#endif

namespace brisance {

/// How many of n values exceed a bound.
[[nodiscard]] inline long count_above(double const* x, int n, double bound) {
  long count = 0;
  BRISANCE_VECTOR_LOOP
  for (int q = 0; q < n; ++q) count += x[q] > bound ? 1 : 0;
  return count;
}

/// How many of n magnitudes exceed a bound.
[[nodiscard]] inline long count_beyond(double const* x, int n, double bound) {
  long count = 0;
  BRISANCE_VECTOR_LOOP
  for (int q = 0; q < n; ++q) count += (x[q] > bound) | (x[q] < -bound) ? 1 : 0;
  return count;
}

/// Do all of n values equal one?
[[nodiscard]] inline bool all_equal(double const* x, int n, double value) {
  long others = 0;
  BRISANCE_VECTOR_LOOP
  for (int q = 0; q < n; ++q) others += x[q] != value ? 1 : 0;
  return others == 0;
}

/// Largest of n values, at least 0; NaN is passed over. In lanes, because a plain maximum keeps the loop from being
/// vectorised.
[[nodiscard]] inline double largest_of(double const* x, int n) {
  constexpr int lanes = 8;
  std::array<double, lanes> most{};
  int q = 0;
  for (; q + lanes <= n; q += lanes) {
    for (int l = 0; l < lanes; ++l) most[l] = x[q + l] > most[l] ? x[q + l] : most[l];
  }
  for (; q < n; ++q) most[0] = x[q] > most[0] ? x[q] : most[0];
  return *std::max_element(most.begin(), most.end());
}

}  // namespace brisance
