/// MUSCL-Hancock with HLLC: the passes of a bundle (gas/pass_faces.hpp), and what is rare beside them.
#pragma once

#include <cmath>

#include "core/loops.hpp"
#include "gas/kernels.hpp"
#include "gas/primitives.hpp"
#include "gas/schemes/near_walls.hpp"
#include "gas/schemes/positivity.hpp"

namespace brisance::gas {

/// The face fluxes of a bundle. Returns whether fluxes were checked for positivity.
inline bool muscl_hancock(SweepContext const& sweep, BundleLayout const& b, BundleArrays& a, GuardCount& guards) {
  SweepContext s = sweep;
  if (s.near_walls != nullptr) {
    s.flattened = s.solid ? find_shocks_near_walls<true>(s, b, a) : find_shocks_near_walls<false>(s, b, a);
  }
  s.bounded_phase = s.bounded_phase && s.present > 1;
  bool const maybe = passes_of(s).faces(s, b, a);
  passes_of(s).fluxes(s, b, a);
  if (!maybe) return false;
  write_closure(s, 0, b.total, a);
  if (mark_risks(s, b, a) == 0) return false;
  with_fluids(s.present, [&]<int N>() { limit_fluxes<N>(s, b, a, guards); });
  return true;
}

}  // namespace brisance::gas
