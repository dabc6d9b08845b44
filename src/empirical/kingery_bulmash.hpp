/// Air-blast parameters of TNT charges after Kingery & Bulmash: the standard empirical curves for a sphere in free air
/// and for a hemisphere on rigid ground.
///
/// Sources: [KB84] Kingery & Bulmash, ARBRL-TR-02555 (1984), polynomial fits in their metric form; [Swisdak94]; the
/// same curves are figures 2-7 and 2-15 of [UFC3-340-02]. Other ambient states: Sachs scaling [Sachs44].
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace brisance::empirical {

enum class Burst {
  spherical,      ///< sphere in free air, no ground
  hemispherical,  ///< hemisphere on a rigid surface
};

/// State of the undisturbed air. The default is that of the curves: 101.325 kPa, 15 degrees Celsius.
struct Atmosphere {
  double pressure = 101325.0;    ///< [Pa]
  double sound_speed = 340.294;  ///< [m/s]
};

/// Blast parameters at one place. A quantity is absent where the place lies outside the range of its curve.
struct Blast {
  double scaled_distance = 0.0;  ///< distance / mass^(1/3), Sachs-scaled to the standard atmosphere [m/kg^(1/3)]
  std::optional<double> incident_overpressure;   ///< peak side-on overpressure [Pa]
  std::optional<double> reflected_overpressure;  ///< peak overpressure on a rigid wall facing the charge [Pa]
  std::optional<double> incident_impulse;        ///< of the positive phase, side-on [Pa s]
  std::optional<double> reflected_impulse;       ///< of the positive phase, on the wall [Pa s]
  std::optional<double> arrival;                 ///< of the shock, after the detonation [s]
  std::optional<double> duration;                ///< of the positive phase [s]
  std::optional<double> shock_speed;             ///< [m/s]
  /// Peak of rho u^2 / 2 behind the shock [Pa], not a curve of its own: from the incident overpressure by the
  /// Rankine-Hugoniot relations of air with gamma = 1.4. Absent above `strongest_ideal_shock`, where air is no longer
  /// such a gas.
  std::optional<double> dynamic_pressure;
};

/// How a quantity grows with the charge's mass and the ambient state.
enum class Scaling { pressure, impulse, time, speed };

/// One quantity of `Blast` with its names and units, so that tables, reports and files need not list them again.
struct Field {
  std::string_view key;           ///< in files
  std::string_view label;         ///< for people
  std::string_view unit;          ///< SI
  std::string_view display_unit;  ///< customary
  double display_factor;          ///< SI value times this is the value in `display_unit`
  Scaling scaling;
  std::optional<double> Blast::*value;
};

inline constexpr std::array blast_fields{
    Field{"incident_overpressure", "incident overpressure", "Pa", "kPa", 1e-3, Scaling::pressure,
          &Blast::incident_overpressure},
    Field{"reflected_overpressure", "reflected overpressure", "Pa", "kPa", 1e-3, Scaling::pressure,
          &Blast::reflected_overpressure},
    Field{"incident_impulse", "incident impulse", "Pa s", "kPa ms", 1.0, Scaling::impulse, &Blast::incident_impulse},
    Field{"reflected_impulse", "reflected impulse", "Pa s", "kPa ms", 1.0, Scaling::impulse, &Blast::reflected_impulse},
    Field{"arrival", "arrival time", "s", "ms", 1e3, Scaling::time, &Blast::arrival},
    Field{"duration", "positive duration", "s", "ms", 1e3, Scaling::time, &Blast::duration},
    Field{"shock_speed", "shock speed", "m/s", "m/s", 1.0, Scaling::speed, &Blast::shock_speed},
    Field{"dynamic_pressure", "dynamic pressure", "Pa", "kPa", 1e-3, Scaling::pressure, &Blast::dynamic_pressure},
};

/// Overpressure [ambient pressures] up to which air behind the shock is taken for an ideal gas with gamma = 1.4.
inline constexpr double strongest_ideal_shock = 10.0;

/// Scaled distances [m/kg^(1/3)] between which a curve holds, both included.
struct Range {
  double lowest = 0.0;
  double highest = 0.0;
};

/// Range of a quantity in any atmosphere, for Z is scaled; that of the dynamic pressure begins where the incident
/// overpressure has fallen to `strongest_ideal_shock`.
[[nodiscard]] Range validity(Field const& field, Burst burst);

/// Blast parameters at `distance` [m] from the centre of a charge equivalent to `tnt_mass` [kg] of TNT.
/// Throws InputError unless mass, distance and the atmosphere are positive and finite.
[[nodiscard]] Blast kingery_bulmash(double tnt_mass, double distance, Burst burst, Atmosphere const& atmosphere = {});

/// The hemispherical incident impulse beyond Z = 0.955 circulates with two values of its coefficient of U^2: the metric
/// listings have -0.02608, calculators in imperial units -0.02808, with the other coefficients the same. The first is
/// used here: it joins the curve of smaller Z within 0.5 %, the other within 1.3 %. The ratio of the impulse with the
/// other to that with the first at scaled distance `z`, 0.981 to 1; nothing elsewhere.
[[nodiscard]] std::optional<double> other_incident_impulse(double z, Burst burst);

}  // namespace brisance::empirical
