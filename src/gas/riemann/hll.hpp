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

[[nodiscard]] inline HllFlux hll(FaceSide const& L, FaceSide const& R) {
  double const SL = std::min(0.0, std::min(L.u - L.c, R.u - R.c));
  double const SR = std::max(0.0, std::max(L.u + L.c, R.u + R.c));
  double const r = 1.0 / (SR - SL);
  HllFlux flux;
  flux.from_left = SR * (L.u - SL) * r;
  flux.from_right = SL * (SR - R.u) * r;
  flux.pressure = L.p - SL * (R.p - L.p) * r;
  flux.work = (SR * L.p * L.u - SL * R.p * R.u) * r;
  return flux;
}

}  // namespace brisance::gas
