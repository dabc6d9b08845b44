/// States of rest under pressure.
#pragma once

#include "material/material.hpp"

namespace brisance::material {

struct Compressed {
  double density = 0.0;          ///< [kg/m3]
  double specific_energy = 0.0;  ///< [J/kg]
};

/// The state that a material reaches from its start by slow compression to a pressure [Pa] with a shear stress
/// `mises` [Pa]: p(rho, e) is that pressure, and e holds the work of the compression, the mean pressure times the
/// change of volume, and the elastic energy of shear mises^2/(6 G rho). At the start's own pressure or below it is the
/// start. Throws InputError where no state up to ten times as dense has the pressure.
[[nodiscard]] Compressed compressed_to(Material const& start, double pressure, double mises = 0.0);

/// Fraction of the vertical stress that acts sideways where an elastic material is compressed without widening,
/// K0 = nu/(1 - nu); 1 in fluids.
[[nodiscard]] double lateral_coefficient(Material const& start);

}  // namespace brisance::material
