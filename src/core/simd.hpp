/// Sets of vector instructions: which the processor has, and which a run uses.
#pragma once

#include <array>
#include <optional>

#include "core/models.hpp"

namespace brisance {

/// From the least to the best. `scalar`: none, the reference.
enum class SimdSet { scalar, sse2, avx2, avx512 };
constexpr auto words(SimdSet) {
  return std::array{Word{SimdSet::scalar, "scalar"}, Word{SimdSet::sse2, "sse2"}, Word{SimdSet::avx2, "avx2"},
                    Word{SimdSet::avx512, "avx512"}};
}

/// Was the program built with it, and has the processor got it?
[[nodiscard]] bool has_simd_set(SimdSet set);
/// The best of those.
[[nodiscard]] SimdSet best_simd_set();

/// The set in use: the best one unless another was asked for.
[[nodiscard]] SimdSet simd_set();
/// Asks for a set, or (none) for the best. Not while anything is being calculated. The set must be there.
void use_simd_set(std::optional<SimdSet> set);
/// Has one been asked for?
[[nodiscard]] bool simd_set_is_specified();

}  // namespace brisance
