/// Vectors of numbers for kernels that are compiled once for every set of instructions. V is the vector of a set,
/// `xsimd::batch<double, Set>`, or a plain double: the kernels are the same.
#pragma once

#include <cstdint>
#include <xsimd/xsimd.hpp>

#include "core/math.hpp"

namespace brisance {

template <class Set>
struct Bits<xsimd::batch<double, Set>> {
  using Integer = xsimd::batch<std::uint64_t, Set>;
  [[nodiscard]] static Integer of(xsimd::batch<double, Set> const& x) { return xsimd::bitwise_cast<Integer>(x); }
  [[nodiscard]] static xsimd::batch<double, Set> number(Integer const& bits) {
    return xsimd::bitwise_cast<xsimd::batch<double, Set>>(bits);
  }
};

/// How many numbers a vector holds, and how it meets memory.
template <class V>
struct Lanes {
  static constexpr int count = static_cast<int>(V::size);
  using Mask = typename V::batch_bool_type;
  [[nodiscard]] static V load(double const* from) { return V::load_unaligned(from); }
  static void store(double* to, V const& x) { x.store_unaligned(to); }
};
template <>
struct Lanes<double> {
  static constexpr int count = 1;
  using Mask = bool;
  [[nodiscard]] static double load(double const* from) { return *from; }
  static void store(double* to, double x) { *to = x; }
};

}  // namespace brisance
