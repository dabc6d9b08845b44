/// The conserved state of a gas cell and its names.
///
/// One fluid: [Cui14] Eqs. (1)-(2). Two fluids: the five-equation model of [Allaire02]; `density` is then the partial
/// density of the ambient fluid, alpha_0 rho_0, and the second fluid adds its own partial density and its volume
/// fraction.
#pragma once

#include <array>

namespace brisance::gas {

/// Order of the components in a cell.
inline constexpr int density = 0;     ///< alpha_0 rho_0 [kg/m3]
inline constexpr int momentum_x = 1;  ///< [kg/(m2 s)]; y and z follow
inline constexpr int momentum_y = 2;
inline constexpr int momentum_z = 3;
inline constexpr int energy = 4;           ///< total energy per volume [J/m3]
inline constexpr int shock = 5;            ///< memory of the shock sensor, 0 to 1; no physical quantity
inline constexpr int second_density = 6;   ///< alpha_1 rho_1 [kg/m3]; two fluids only
inline constexpr int volume_fraction = 7;  ///< alpha_1; two fluids only
inline constexpr int progress = 8;         ///< alpha_1 rho_1 lambda [kg/m3]; two fluids with a carried afterburn only

inline constexpr int single_fluid_components = 6;
inline constexpr int two_fluid_components = 8;
inline constexpr int afterburn_components = 9;

/// One value per component; those that a gas does not have are 0.
using Components = std::array<double, afterburn_components>;

}  // namespace brisance::gas
