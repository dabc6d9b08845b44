/// HLL approximate Riemann solver [HLL83]: two waves, no contact. It smears contacts and shear layers, which is what
/// cures the carbuncle along a shock [Quirk94].
#pragma once

#include <algorithm>

#include "gas/riemann/hllc.hpp"

namespace brisance::gas {

struct HllFlux {
  double from_left;  ///< the flux of an advected density q is from_left * q_L + from_right * q_R [m/s]
  double from_right;
  double pressure;  ///< pressure part of the normal momentum flux [Pa]
  double work;      ///< pressure part of the energy flux [W/m2]
};

/// With bounds of the waves that are known: `low` and `high` [m/s].
[[nodiscard]] inline HllFlux hll(FaceSide const& L, FaceSide const& R, double low, double high) {
  double const SL = std::min(0.0, low);
  double const SR = std::max(0.0, high);
  double const r = 1.0 / (SR - SL);
  HllFlux flux;
  flux.from_left = SR * (L.u - SL) * r;
  flux.from_right = SL * (SR - R.u) * r;
  flux.pressure = L.p - SL * (R.p - L.p) * r;
  flux.work = (SR * L.p * L.u - SL * R.p * R.u) * r;
  return flux;
}

/// With the bounds of [Davis88].
[[nodiscard]] inline HllFlux hll(FaceSide const& L, FaceSide const& R) {
  return hll(L, R, std::min(L.u - L.c, R.u - R.c), std::max(L.u + L.c, R.u + R.c));
}

}  // namespace brisance::gas
