#include "core/simd.hpp"

namespace brisance {

namespace {

std::optional<SimdSet>& specified() {
  static std::optional<SimdSet> set;
  return set;
}

}  // namespace

bool has_simd_set(SimdSet set) {
#ifdef BRISANCE_SIMD_SETS
  switch (set) {
    case SimdSet::scalar:
    case SimdSet::sse2: return true;
    case SimdSet::avx2: return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case SimdSet::avx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
             __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512cd");
  }
#endif
  return set == SimdSet::scalar;
}

SimdSet best_simd_set() {
  static SimdSet const best = [] {
    SimdSet found = SimdSet::scalar;
    for (Word<SimdSet> const& word : words(SimdSet{})) {
      if (has_simd_set(word.value)) found = word.value;
    }
    return found;
  }();
  return best;
}

SimdSet simd_set() { return specified().value_or(best_simd_set()); }

bool simd_set_is_specified() { return specified().has_value(); }

void use_simd_set(std::optional<SimdSet> set) { specified() = set; }

}  // namespace brisance
