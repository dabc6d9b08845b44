/// The schemes by their words: the one place that calls their kernels.
#pragma once

#include "gas/gas.hpp"
#include "gas/schemes/lax_wendroff.hpp"
#include "gas/schemes/muscl_hancock.hpp"

namespace brisance::gas {

/// The face fluxes of a bundle of which the primitive variables are known. Returns whether cold products must be
/// expanded after the update.
inline bool face_fluxes(Scheme scheme, SweepContext const& s, BundleLayout const& layout, BundleArrays& a,
                        GuardCount& guards) {
  switch (scheme) {
    case Scheme::muscl_hancock: return muscl_hancock(s, layout, a, guards);
    case Scheme::lax_wendroff:
      with_fluids(s.present, [&]<int N>() { lax_wendroff<N>(s, layout, a, guards); });
      return false;
  }
  return false;
}

}  // namespace brisance::gas
