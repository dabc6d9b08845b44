/// HLL approximate Riemann solver [HLL83]: two waves, no contact. It smears contacts and shear layers, which is what
/// cures the carbuncle along a shock [Quirk94].
#pragma once

#include <algorithm>

#include "gas/riemann/hllc.hpp"

namespace brisance::gas {

template <class V>
struct HllFluxOf {
  V from_left;  ///< the flux of an advected density q is from_left * q_L + from_right * q_R [m/s]
  V from_right;
  V pressure;  ///< pressure part of the normal momentum flux [Pa]
  V work;      ///< pressure part of the energy flux [W/m2]
};
using HllFlux = HllFluxOf<double>;

/// With bounds of the waves that are known: `low` and `high` [m/s].
template <class V>
[[nodiscard]] inline HllFluxOf<V> hll(FaceSideOf<V> const& L, FaceSideOf<V> const& R, V const& low, V const& high) {
  using std::max;
  using std::min;
  V const SL = min(V(0.0), low);
  V const SR = max(V(0.0), high);
  V const r = 1.0 / (SR - SL);
  HllFluxOf<V> flux;
  flux.from_left = SR * (L.u - SL) * r;
  flux.from_right = SL * (SR - R.u) * r;
  flux.pressure = L.p - SL * (R.p - L.p) * r;
  flux.work = (SR * L.p * L.u - SL * R.p * R.u) * r;
  return flux;
}

/// With the bounds of [Davis88].
template <class V>
[[nodiscard]] inline HllFluxOf<V> hll(FaceSideOf<V> const& L, FaceSideOf<V> const& R) {
  using std::max;
  using std::min;
  return hll(L, R, min(L.u - L.c, R.u - R.c), max(L.u + L.c, R.u + R.c));
}

}  // namespace brisance::gas
