/// HLLC approximate Riemann solver [Toro94], for one fluid and, with the same waves, for the five-equation model.
///
/// Everything that is carried along with the flow (partial densities, volume fraction, transverse momentum) crosses the
/// face with one velocity `speed` from the upwind side; only momentum and energy need more.
#pragma once

#include <algorithm>
#include <utility>

#include "core/math.hpp"

namespace brisance::gas {

/// State beside a face. u is the velocity normal to it; E the total energy per volume.
template <class V>
struct FaceSideOf {
  V rho, u, p, E, c;
};
using FaceSide = FaceSideOf<double>;

template <class V>
struct HllcFluxOf {
  V speed;                                                    ///< of the face, for what is carried from upwind [m/s]
  decltype(std::declval<V>() > std::declval<V>()) from_left;  ///< upwind side
  V momentum;                                                 ///< flux of normal momentum, pressure included [Pa]
  V energy;                                                   ///< flux of total energy [W/m2]
};
using HllcFlux = HllcFluxOf<double>;

/// Wave speeds are the Davis bounds min(uL - cL, uR - cR), max(uL + cL, uR + cR).
template <class V>
[[nodiscard]] inline HllcFluxOf<V> hllc(FaceSideOf<V> const& L, FaceSideOf<V> const& R) {
  using std::max;
  using std::min;
  V const SL = min(L.u - L.c, R.u - R.c);
  V const SR = max(L.u + L.c, R.u + R.c);
  V const mL = L.rho * (SL - L.u);
  V const mR = R.rho * (SR - R.u);
  // (pR - pL + mL uL - mR uR) / (mL - mR), written so that mirrored states give exactly 0: nothing leaks through a
  // wall.
  V const SM = 0.5 * (L.u + R.u) + (0.5 * (mL + mR) * (R.u - L.u) + (L.p - R.p)) / (mR - mL);
  auto const left = SM >= 0.0;
  V const S = select(left, SL, SR);
  V const rho = select(left, L.rho, R.rho);
  V const u = select(left, L.u, R.u);
  V const p = select(left, L.p, R.p);
  V const E = select(left, L.E, R.E);
  V const m = select(left, mL, mR);
  auto const supersonic = S * SM > 0.0;
  V const r = 1.0 / (S - SM);
  V const chi = (S - u) * r;
  V const p_star = p + m * (SM - u);
  HllcFluxOf<V> flux;
  flux.from_left = left;
  flux.speed = SM * chi;
  flux.momentum = rho * flux.speed * SM + p_star;
  flux.energy = SM * (chi * (E + (SM - u) * rho * SM) + (SM - u) * p * r + p_star);
  if (any(supersonic)) {
    flux.speed = select(supersonic, u, flux.speed);
    flux.momentum = select(supersonic, rho * u * u + p, flux.momentum);
    flux.energy = select(supersonic, u * (E + p), flux.energy);
  }
  return flux;
}

}  // namespace brisance::gas
