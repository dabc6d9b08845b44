#include "gas/passes.hpp"

namespace brisance::gas {

Passes const& passes_scalar();
#ifdef BRISANCE_SIMD_SETS
Passes const& passes_sse2();
Passes const& passes_avx2();
Passes const& passes_avx512();
#endif

Passes const& passes() {
#ifdef BRISANCE_SIMD_SETS
  switch (simd_set()) {
    case SimdSet::scalar: break;
    case SimdSet::sse2: return passes_sse2();
    case SimdSet::avx2: return passes_avx2();
    case SimdSet::avx512: return passes_avx512();
  }
#endif
  return passes_scalar();
}

}  // namespace brisance::gas
