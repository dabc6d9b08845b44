/// HLLC approximate Riemann solver [Toro94], for one fluid and, with the same waves, for the five-equation model.
///
/// Everything that is carried along with the flow (partial densities, volume fraction, transverse momentum) crosses the
/// face with one velocity `speed` from the upwind side; only momentum and energy need more.
#pragma once

#include <algorithm>

namespace brisance::gas {

/// State beside a face. u is the velocity normal to it; E the total energy per volume.
struct FaceSide {
  double rho, u, p, E, c;
};

struct HllcFlux {
  double speed;     ///< face velocity of everything advected from the upwind side [m/s]
  bool from_left;   ///< upwind side
  double momentum;  ///< flux of normal momentum, pressure included [Pa]
  double energy;    ///< flux of total energy [W/m2]
};

/// Wave speeds are the Davis bounds min(uL - cL, uR - cR), max(uL + cL, uR + cR).
[[nodiscard]] inline HllcFlux hllc(FaceSide const& L, FaceSide const& R) {
  double const SL = std::min(L.u - L.c, R.u - R.c);
  double const SR = std::max(L.u + L.c, R.u + R.c);
  double const mL = L.rho * (SL - L.u);
  double const mR = R.rho * (SR - R.u);
  // (pR - pL + mL uL - mR uR) / (mL - mR), written so that mirrored states give exactly 0: nothing leaks through a
  // wall.
  double const SM = 0.5 * (L.u + R.u) + (0.5 * (mL + mR) * (R.u - L.u) + (L.p - R.p)) / (mR - mL);
  bool const left = SM >= 0.0;
  double const S = left ? SL : SR;
  double const rho = left ? L.rho : R.rho;
  double const u = left ? L.u : R.u;
  double const p = left ? L.p : R.p;
  double const E = left ? L.E : R.E;
  double const m = left ? mL : mR;
  bool const supersonic = (left ? S : -S) >= 0.0;
  double const r = 1.0 / (S - SM);
  double const chi = (S - u) * r;
  double const p_star = p + m * (SM - u);
  double const energy_star = SM * (chi * (E + (SM - u) * rho * SM) + (SM - u) * p * r);
  HllcFlux flux;
  flux.from_left = left;
  flux.speed = supersonic ? u : SM * chi;
  flux.momentum = supersonic ? rho * u * u + p : rho * flux.speed * SM + p_star;
  flux.energy = supersonic ? u * (E + p) : energy_star + p_star * SM;
  return flux;
}

}  // namespace brisance::gas
