/// The start of a calculation by a remap, [Cui14] Sec. 4.1: each charge bursts in a calculation with one direction, on
/// far smaller cells, until its shock comes near anything; its profile is then the initial state of the case.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "detonation/remap.hpp"
#include "setup/solid_cells.hpp"

namespace brisance::run {
class World;
struct ChargeReport;
}  // namespace brisance::run

namespace brisance::setup {

/// Cells of the 1D calculation per charge radius, unless the case says otherwise. With 200 the profiles are 2 to 3 %
/// (L1) away from their limit, with 400 below 1 %.
inline constexpr double start_cells_per_radius = 400.0;

/// Cell of the 1D calculation of a charge of this radius [m]: the one asked for, where it is not 0.
[[nodiscard]] inline double start_cell(double asked, double charge_radius) {
  return asked > 0.0 ? asked : charge_radius / start_cells_per_radius;
}

/// How far a burst may spread until it meets something, and what that is.
struct Reach {
  double radius = 0.0;  ///< around the charge's centre [m]
  std::string by;       ///< e.g. `gauge "g1"`
};

/// The 1D calculation of one charge.
struct StartPlan {
  grid::Geometry geometry = grid::Geometry::spherical1d;
  double charge_radius = 0.0;  ///< [m]
  double charge_mass = 0.0;    ///< with its mirror images: of the whole ball [kg]
  double cell = 0.0;           ///< [m]
  int cells = 0;
  double radius = 0.0;  ///< to which its shock may run [m]
  Reach reach;          ///< gauges count only where neither time nor radius are given
};

/// What a remap did to one charge.
struct StartReport {
  StartMethod method = StartMethod::gas;
  std::string from;            ///< the geometry, or the file, of the profile
  double cell = 0.0;           ///< of the profile [m]
  double charge_radius = 0.0;  ///< [m]
  std::string by;              ///< what the shock was about to meet
  detonation::RemapReport remap;
};

void archive(Archive& a, StartReport& report);

/// What a charge would become on a grid, beside the solid cells of obstacles; the cells that it takes are added to
/// `taken`. Throws InputError where it does not fit.
[[nodiscard]] run::ChargeReport realised_charge(Charge const& charge, grid::Grid const& grid, std::string const& what,
                                                SolidCells const* solid = nullptr,
                                                detonation::TakenCells* taken = nullptr);

/// Throws InputError where the charge cannot start by a 1D calculation, or has no room for one.
[[nodiscard]] StartPlan plan_start(Case const& setup, std::size_t charge);

/// The case of the 1D calculation: the settings of the whole one, its charge, nothing else.
[[nodiscard]] Case start_case(Case const& setup, std::size_t charge, StartPlan const& plan);

/// Where a 1D calculation stands.
struct StartProgress {
  std::size_t charge = 0;  ///< its number
  double front = 0.0;      ///< radius of the outermost cell that is not ambient [m]
  double radius = 0.0;     ///< where it ends [m]
  double done = 0.0;       ///< 0 to 1, of the time by a strong explosion's law or of the time asked for
  double time = 0.0;       ///< [s]
  long step = 0;
};

/// Called after every step; false gives the calculation up.
using StartObserver = std::function<bool(StartProgress const&)>;

/// The profiles of all charges at one common time, the first at which a shock comes near anything. None where the
/// observer gave up. Throws InputError where that time comes too early or too late.
[[nodiscard]] std::vector<std::shared_ptr<detonation::Profile const>> calculate_start(
    Case const& setup, StartObserver const& observer = {});

/// The profile of a file for a charge of the case, scaled to its mass. Throws InputError where the two do not match.
[[nodiscard]] std::shared_ptr<detonation::Profile const> fitted_profile(Case const& setup, std::size_t charge,
                                                                        detonation::Profile const& profile);

/// The present state of a calculation with one charge, in 1D or axisymmetric 2D, as a profile. Throws InputError where
/// it cannot be one.
[[nodiscard]] detonation::Profile profile_of(run::World const& world);

/// Tells a profile whose burst it is: that of the case's only charge. Throws InputError where it cannot be one.
void describe_charge(Case const& setup, gas::Fluids const& fluids, detonation::Profile& profile);

/// Puts the bursts into the gas of a world and sets its clock. Throws InputError.
void place_start(run::World& world);

}  // namespace brisance::setup
