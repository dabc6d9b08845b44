/// What the cells of a case will clip of the peaks at its gauges, known before the run.
#pragma once

#include <functional>
#include <optional>

#include "case/case.hpp"

namespace brisance::observe {

/// The peak that a gauge is likely to see, after Kingery and Bulmash.
struct ExpectedPeak {
  double half_width = 0.0;            ///< time in which the overpressure falls to half [s]: of a passing
                                      ///< shock by `decay_time` of the curve of its peak, of a reflected one by its
                                      ///< impulse
  double cell = 0.0;                  ///< size of the cells that the shock meets at the gauge [m]
  double cells_per_half_width = 0.0;  ///< that the incident shock passes in this time
  double clipping = 0.0;              ///< fraction of the peak that such cells cut off, see `clipping`
  double strength = 0.0;              ///< of the incident shock, see `IncidentShock`
  bool reflected = false;             ///< a wall or a body stands behind the gauge, facing the charge
};

/// Size of the cells that a shock meets at x [m]. Where there are several, those that shocks, gauges, parts of the
/// domain and the MPM region ask for by the case; a limit on their number is not known here.
[[nodiscard]] double expected_cell(run::Case const& setup, Vec3 const& x);

/// Time in which a Friedlander wave p = peak (1 - t/T) exp(-b t/T) of this peak [Pa], impulse [Pa s] and duration T [s]
/// falls to half [s].
[[nodiscard]] double friedlander_half_width(double peak, double impulse, double duration);

/// Overpressure at the front of a spherical shock as it passes a radius [m].
using FrontCurve = std::function<double(double)>;

/// Time in which the overpressure behind such a shock begins to fall, p / (-dp/dt) at the front [s]. It follows from
/// the curve alone: the Euler equations and the derivatives along the front of what the Rankine-Hugoniot relations say
/// there are four equations for the four derivatives of pressure and velocity. Infinite where the pressure rises.
[[nodiscard]] double decay_time(material::Eos const& eos, material::Primitive const& air,
                                FrontCurve const& overpressure, double radius);

/// From the charge whose wave is the strongest at x: its mass of TNT (by its energy where its equivalent is not known)
/// in the open, or on the ground where it touches a wall. Nothing where the curves do not tell: no charge, planar and
/// cylindrical waves, an ambient fluid that is no ideal gas, behind obstacles and bodies, or outside
/// of their range.
[[nodiscard]] std::optional<ExpectedPeak> expected_peak(run::Case const& setup, Vec3 const& x);

}  // namespace brisance::observe
