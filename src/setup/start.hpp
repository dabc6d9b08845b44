/// The start of a simulation by a remap, [Cui14] Sec. 4.1: each charge bursts in a simulation with one direction, on
/// far smaller cells, until its shock comes near anything; its profile is then the initial state of the case.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "detonation/profile.hpp"

namespace brisance::run {
class System;
}

namespace brisance::setup {

/// Cells of the 1D simulation per charge radius, unless the case says otherwise. With 200 the profiles are 2 to 3 %
/// (L1) away from their limit, with 400 below 1 %.
inline constexpr double start_cells_per_radius = 400.0;

/// Cell of the 1D simulation of a charge of this radius [m]: the specified one, where it is not 0.
[[nodiscard]] inline double start_cell(double specified, double charge_radius) {
  return specified > 0.0 ? specified : charge_radius / start_cells_per_radius;
}

/// How far a burst may spread until it meets something, and what that is.
struct Reach {
  double radius = 0.0;  ///< around the charge's centre [m]
  std::string by;       ///< e.g. `gauge "g1"`
};

/// The 1D simulation of one charge.
struct StartPlan {
  grid::Geometry geometry = grid::Geometry::spherical1d;
  double charge_radius = 0.0;  ///< [m]
  double charge_mass = 0.0;    ///< with its mirror images: of the whole ball [kg]
  double cell = 0.0;           ///< [m]
  int cells = 0;
  double radius = 0.0;  ///< to which its shock may run [m]
  Reach reach;          ///< gauges count only where neither time nor radius are given
};

/// Throws InputError where the charge cannot start by a 1D simulation, or has no room for one.
[[nodiscard]] StartPlan plan_start(Case const& setup, std::size_t charge);

/// The case of the 1D simulation: the settings of the whole one, its charge, nothing else.
[[nodiscard]] Case start_case(Case const& setup, std::size_t charge, StartPlan const& plan);

/// Where a 1D simulation stands.
struct StartProgress {
  std::size_t charge = 0;  ///< its number
  double front = 0.0;      ///< radius of the outermost cell that is not ambient [m]
  double radius = 0.0;     ///< where it ends [m]
  double done = 0.0;       ///< 0 to 1, of the time by a strong explosion's law or of the specified time
  double time = 0.0;       ///< [s]
  long step = 0;
};

/// Called after every step; false gives the simulation up.
using StartObserver = std::function<bool(StartProgress const&)>;

/// The profiles of all charges at one common time, the first at which a shock comes near anything. None where the
/// observer gave up. Throws InputError where that time comes too early or too late.
[[nodiscard]] std::vector<std::shared_ptr<detonation::Profile const>> calculate_start(
    Case const& setup, StartObserver const& observer = {});

/// Puts the bursts into the gas of a system and sets its clock. Throws InputError.
void place_start(run::System& system);

}  // namespace brisance::setup
