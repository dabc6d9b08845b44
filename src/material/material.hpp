/// What a material point is made of: equation of state, strength and failure compose.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <variant>

#include "core/models.hpp"
#include "core/parameter.hpp"
#include "material/eos/compaction.hpp"
#include "material/eos/eos.hpp"
#include "material/eos/linear.hpp"
#include "material/explosive.hpp"
#include "material/failure/failure.hpp"
#include "material/fluids.hpp"
#include "material/strength/strength.hpp"

namespace brisance::material {

/// The equations of state of material points: those of the gas cells, the linear one, and that of concrete.
using ParticleEos = Joined<std::variant<Linear>, Eos, std::variant<Compaction>>::type;

/// Pressure [Pa] from density [kg/m3] and specific internal energy [J/kg].
[[nodiscard]] inline double pressure(ParticleEos const& eos, double rho, double e) {
  return std::visit([=](auto const& m) { return pressure(m, rho, e); }, eos);
}
/// rho c^2 [Pa], c the bulk sound speed.
[[nodiscard]] inline double bulk_modulus(ParticleEos const& eos, double rho, double p) {
  return std::visit([=](auto const& m) { return bulk_modulus(m, rho, p); }, eos);
}

/// What tension beyond the limit `minimum_pressure` does to a metal.
enum class Spall {
  limit,             ///< the pressure stays at the limit: the particle goes on pulling
  pressure,          ///< the particle fails where the pressure has fallen to the limit
  principal_stress,  ///< it fails where the largest principal stress has risen to the limit, with the other sign
};
constexpr auto words(Spall) {
  return std::array{Word{Spall::limit, "limit"}, Word{Spall::pressure, "pressure"},
                    Word{Spall::principal_stress, "principal_stress"}};
}

/// A material. Gases and detonation products are solids without strength here.
struct Material {
  std::string name;
  std::string source;       ///< literature source of the constants
  double density = 7850.0;  ///< at the start, rho0 [kg/m3]
  ParticleEos eos;
  /// Particles that mix these fluids, each with a composition of its own; stands in for `eos`.
  std::optional<Fluids> mixture;
  Strength strength;
  Failure failure;
  double specific_heat = 0.0;            ///< cp [J/kg/K]; 0: the temperature stays
  double temperature = 293.0;            ///< at the start [K]
  double taylor_quinney = 0.9;           ///< fraction of the plastic work converted to heat
  double minimum_pressure = -unbounded;  ///< tension cut-off (spall): the pressure never falls below [Pa]
  Spall spall = Spall::limit;
  double specific_energy = 0.0;  ///< at the start [J/kg]
  /// Speed of the programmed burn [m/s]: the pressure is multiplied by the burn fraction. 0: nothing burns.
  double detonation_speed = 0.0;

  /// Does a particle carry deviatoric stress?
  [[nodiscard]] bool has_deviator() const {
    return std::visit([](auto const& model) { return model.deviatoric; }, strength);
  }
  /// Does a particle have plastic strain and plastic work?
  [[nodiscard]] bool plastic() const {
    return std::visit([](auto const& model) { return model.plastic; }, strength);
  }
  /// Does it yield like a metal, whatever its pressure?
  [[nodiscard]] bool is_metal() const {
    return std::visit(
        []<class Model>(Model const& /*model*/) {
          return Model::plastic && !requires { Model::pressure_dependent; };
        },
        strength);
  }
  /// Does its temperature change?
  [[nodiscard]] bool heats() const { return plastic() && specific_heat > 0.0; }
  /// Is it concrete: damage of two kinds, compression that stays?
  [[nodiscard]] bool crushes() const { return std::holds_alternative<Hjc>(strength); }
  /// Does it have damage?
  [[nodiscard]] bool damages() const {
    return crushes() ||
           (plastic() && (tears() || std::visit([](auto const& model) { return model.damages; }, failure)));
  }
  /// Does tension beyond a limit make it fail?
  [[nodiscard]] bool tears() const { return spall != Spall::limit && minimum_pressure > -unbounded; }
  /// Does it have a burn fraction?
  [[nodiscard]] bool burns() const { return detonation_speed > 0.0; }
  /// Is it a gas: nothing in it that could be under tension, whatever its density?
  [[nodiscard]] bool is_gas() const {
    auto const gas = [](auto const& models) {
      return std::visit([](auto const& model) { return !model.bears_tension; }, models);
    };
    if (has_deviator()) return false;
    if (!mixes()) return gas(eos);
    return std::all_of(mixture->eos.begin(), mixture->eos.begin() + mixture->count, gas);
  }
  /// Does it mix fluids?
  [[nodiscard]] bool mixes() const { return mixture.has_value(); }
};

/// Closure of particles that mix: they hold one fluid beside the ambient one, with these fractions of mass and volume.
[[nodiscard]] inline Mixture mixture_of(Material const& solid, double rho, double Y, double alpha) {
  return mixture_of(*solid.mixture, rho, Fractions::of(1, Y), Fractions::of(1, alpha));
}

/// Pressure [Pa] of a solid from density [kg/m3] and specific internal energy [J/kg]. Where it mixes, Y and alpha are
/// the fractions of mass and volume of the fluid beside the ambient one.
[[nodiscard]] inline double pressure(Material const& solid, double rho, double e, double Y = 0.0, double alpha = 0.0) {
  if (!solid.mixes()) return pressure(solid.eos, rho, e);
  if (std::abs(alpha) <= vanishing_fraction) return pressure(solid.mixture->ambient(), rho, e);
  return mixture_of(solid, rho, Y, alpha).pressure(rho * e);
}
/// rho c^2 [Pa], c the bulk sound speed.
[[nodiscard]] inline double bulk_modulus(Material const& solid, double rho, double p, double Y = 0.0,
                                         double alpha = 0.0) {
  if (!solid.mixes()) return bulk_modulus(solid.eos, rho, p);
  if (std::abs(alpha) <= vanishing_fraction) return bulk_modulus(solid.mixture->ambient(), rho, p);
  return mixture_of(solid, rho, Y, alpha).bulk_modulus(p);
}

/// Pressure [Pa] at the start: nothing is burnt, the tension cut-off holds.
[[nodiscard]] inline double start_pressure(Material const& solid, double Y = 0.0, double alpha = 0.0) {
  double const p = solid.burns() ? 0.0 : pressure(solid, solid.density, solid.specific_energy, Y, alpha);
  return std::max(p, solid.minimum_pressure);
}

/// Longitudinal sound speed [m/s], rho c^2 = rho c_bulk^2 + 4 G / 3.
[[nodiscard]] inline double sound_speed(Material const& solid, double rho, double p, double Y = 0.0,
                                        double alpha = 0.0) {
  double const bulk = std::max(bulk_modulus(solid, rho, p, Y, alpha), 0.0);
  return std::sqrt((bulk + 4.0 / 3.0 * shear_modulus(solid.strength)) / rho);
}

/// Bulk modulus [Pa] of Young's modulus E [Pa] and Poisson's ratio nu.
[[nodiscard]] inline double bulk_modulus_of(double E, double nu) { return E / (3.0 * (1.0 - 2.0 * nu)); }
/// Shear modulus [Pa] of Young's modulus E [Pa] and Poisson's ratio nu.
[[nodiscard]] inline double shear_modulus_of(double E, double nu) { return E / (2.0 * (1.0 + nu)); }

/// A linear elastic solid of density rho [kg/m3], Young's modulus E [Pa] and Poisson's ratio nu.
[[nodiscard]] inline Material elastic_solid(double rho, double E, double nu) {
  Material solid;
  solid.name = "elastic";
  solid.density = rho;
  solid.eos = Linear{rho, bulk_modulus_of(E, nu)};
  solid.strength = Elastic{shear_modulus_of(E, nu)};
  return solid;
}

/// A linear elastic solid that yields at `yield` [Pa], with plastic modulus `hardening` [Pa] (0: perfectly plastic).
[[nodiscard]] inline Material von_mises_solid(double rho, double E, double nu, double yield, double hardening = 0.0) {
  Material solid = elastic_solid(rho, E, nu);
  solid.name = "von_mises";
  solid.strength = VonMises{shear_modulus_of(E, nu), yield, hardening};
  return solid;
}

/// The particles of a charge, unburnt at the start. Products carry no tension.
[[nodiscard]] inline Material of(Explosive const& explosive) {
  Material solid;
  solid.name = explosive.name;
  solid.source = explosive.source;
  solid.density = explosive.density();
  solid.eos = explosive.products;
  solid.minimum_pressure = 0.0;
  solid.specific_energy = explosive.specific_energy();
  solid.detonation_speed = explosive.detonation_speed;
  return solid;
}

/// The particles of a fluid at its default state. A fluid carries no tension.
[[nodiscard]] inline Material of(Fluid const& fluid) {
  Material solid;
  solid.name = fluid.name;
  solid.source = fluid.source;
  solid.density = fluid.density;
  solid.eos = std::visit([](auto const& model) { return ParticleEos{model}; }, fluid.eos);
  solid.minimum_pressure = 0.0;
  solid.specific_energy = internal_energy(fluid.eos, fluid.density, fluid.pressure);
  return solid;
}

/// The particles of a gas that may mix fluids; the solid's own state is the ambient fluid alone with this density
/// [kg/m3] and pressure [Pa]. A gas carries no tension.
[[nodiscard]] inline Material gas_of(Fluids const& fluids, double density, double pressure) {
  Material solid;
  solid.name = "gas";
  solid.density = density;
  solid.eos = std::visit([](auto const& model) { return ParticleEos{model}; }, fluids.ambient());
  solid.mixture = fluids;
  solid.minimum_pressure = 0.0;
  solid.specific_energy = internal_energy(fluids.ambient(), density, pressure);
  return solid;
}

}  // namespace brisance::material
