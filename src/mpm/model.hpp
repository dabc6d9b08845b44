/// What a simulation with material points is made of: options, bodies, contacts, constraints and loads.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/models.hpp"
#include "core/vec.hpp"
#include "material/material.hpp"
#include "mpm/reinforcement.hpp"
#include "shape/shape.hpp"
#include "shape/surface.hpp"

namespace brisance::mpm {

enum class ShapeFunction {
  linear,   ///< tents
  gimp,     ///< particles of constant size (uGIMP)
  cpgimp,   ///< particles that stretch with the material
  bspline,  ///< quadratic
};
constexpr auto words(ShapeFunction) {
  return std::array{Word{ShapeFunction::linear, "linear"}, Word{ShapeFunction::gimp, "gimp"},
                    Word{ShapeFunction::cpgimp, "cpgimp"}, Word{ShapeFunction::bspline, "bspline"}};
}

/// When the stress is updated: before the momentum, or after it with the velocity of the nodes or with the velocity of
/// the particles mapped back to the nodes ([Cui14] Eq. (26)).
enum class StressOrder { usf, usl, musl };
constexpr auto words(StressOrder) {
  return std::array{Word{StressOrder::usf, "usf"}, Word{StressOrder::usl, "usl"}, Word{StressOrder::musl, "musl"}};
}

/// How the velocity of the particles follows that of the nodes.
enum class Transfer {
  flip,  ///< by its increments, [Cui14] Eq. (24), with a fraction of PIC
  apic,  ///< the nodes' velocity and its gradient, [Jiang15]
  xpic,  ///< increments without what the grid cannot see, [Hammerquist17]
};
constexpr auto words(Transfer) {
  return std::array{Word{Transfer::flip, "flip"}, Word{Transfer::apic, "apic"}, Word{Transfer::xpic, "xpic"}};
}

struct Options {
  ShapeFunction shape = ShapeFunction::bspline;
  StressOrder order = StressOrder::musl;
  Transfer transfer = Transfer::flip;
  double pic_fraction = 0.0;     ///< of flip, 0 to 1
  int xpic_order = 2;            ///< of xpic; 1 is PIC
  bool crack_band = true;        ///< tensile damage obeys its fracture energy, see `material::StepData`
  bool locking_control = false;  ///< volumetric strain averaged over the particles of a body in a cell
  double linear_viscosity = 0.06;
  double quadratic_viscosity = 1.5;
  std::optional<double> courant;   ///< Courant number; absent: `usual_courant`
  Vec3 body_force{0.0, 0.0, 0.0};  ///< acceleration of everything [m/s2]
  /// A further acceleration [m/s2] of the particles that varies with their position [m] and the time [s]; null: none.
  std::function<Vec3(Vec3 const& x, double time)> acceleration;
  /// Planes across each direction, low and high [m], behind which bodies go on: open faces of a domain that cuts them.
  /// Fluids that slip do not flow around their ends there.
  std::array<std::optional<double>, 6> ends{};
  /// Coulomb's coefficient between bodies and faces of the domain that are a `wall`.
  double wall_friction = 0.0;
  /// Rate at which bodies with `Body::damped` lose velocity, v' = -damping v [1/s], until `damping_end` [s].
  double damping = 0.0;
  double damping_end = std::numeric_limits<double>::infinity();
  int block_cells = 0;  ///< cells per block and direction; 0: 8 in 3D, 32 in 2D, 256 in 1D

  static constexpr double usual_courant = 0.4;
  [[nodiscard]] double courant_number() const { return courant.value_or(usual_courant); }
};

struct Body {
  std::string name;
  material::Material solid;
  int particles_per_direction = 2;  ///< per cell: gives GIMP particles their size
  /// Set for a rigid body: its velocity, which nothing changes [m/s].
  std::optional<Vec3> rigid_velocity;
  bool damped = false;  ///< see `Options::damping`
  /// How the velocity of this body's particles follows the nodes; absent: as `Options` says.
  std::optional<Transfer> transfer;
  /// When this body's stress is updated, if not as `Options` says: musl or usl, where that is one of the two.
  std::optional<StressOrder> order;
  /// Taken off the pressure in the forces [Pa]. A region that bodies fill without a gap feels differences of the
  /// pressure only.
  double reference_pressure = 0.0;
  /// Coefficients of the bulk viscosity that differ from those of the options.
  std::optional<double> linear_viscosity;
  std::optional<double> quadratic_viscosity;
  std::vector<Bar> bars;          ///< filled by `Mpm::reinforce`
  double viscosity_onset = 0.0;   ///< see `material::StepData::linear_onset`
  std::optional<double> courant;  ///< Courant number that differs from that of the options
  /// Conduction of heat in shocks, [Noh87]: the fraction of the difference between a fluid particle's specific energy
  /// and that around it that is evened out in a step, times q / (p + q). Bulk viscosity alone overheats the first
  /// particles that a shock reaches, at walls and at faces of the region, for good. 0: none.
  double shock_conduction = 0.0;
  /// A fluid that slips along all bodies that do not: it shares their velocity across their surfaces only, where the
  /// others stick together. All that slip share one field of the grid.
  bool slips = false;
  /// A gas that fills what other bodies leave of the space, proxy particles around it included. The volume of a
  /// particle follows the velocity along its way and knows nothing of the room between its neighbours: the two drift
  /// apart, and forces, which go with the volumes, are wrong by as much. With this they follow the room that there is,
  /// as fast as the gas is strained, at the same mass; what the reference pressure took for the volume goes back to the
  /// energy.
  bool fills_space = false;
  /// The energy of particles that follow increments takes the work that the forces on the nodes do, and as heat what
  /// the particles do not take up of the nodes' kinetic energy. Without it either is left to what the strains of the
  /// particles say: beside a detonation both are wrong by percents of its energy, where bodies meet the second by as
  /// much. The pressure of a solid that is warmed by it rises.
  bool books_work = false;
};

/// What fills (a part of) a body.
struct Filling {
  std::vector<Vec3> positions;  ///< [m]
  std::vector<double> volumes;  ///< [m3], in the convention of `Domain::cell_volume`
  Vec3 velocity{0.0, 0.0, 0.0};
  std::vector<Vec3> velocities;  ///< of each position, in its place; empty: all have the same
  /// Velocity gradient at each position, row by row, which particles of APIC take [1/s]; empty: none.
  std::vector<std::array<double, 9>> gradients;
  /// State that differs from the solid's own.
  std::optional<double> density;          ///< [kg/m3]
  std::optional<double> specific_energy;  ///< [J/kg]
  /// State of each position, in their place: density [kg/m3], specific energy [J/kg], deviator of the stress [Pa];
  /// empty: all have the same, and no deviator.
  std::vector<double> densities;
  std::vector<double> specific_energies;
  std::vector<std::array<double, 6>> deviators;
  /// Composition, of bodies that mix two fluids.
  double mass_fraction = 0.0;    ///< of the second fluid
  double volume_fraction = 0.0;  ///< of the second fluid
};

/// Motion over time: linear between the given times. Before the first a velocity holds and a displacement rests, after
/// the last too, or nothing is prescribed any more.
struct MotionHistory {
  std::vector<double> times;   ///< [s], rising
  std::vector<double> values;  ///< [m/s], or [m]
  bool displacement = false;   ///< values are displacements, otherwise velocities
  bool release = false;        ///< after the last time

  /// Way [m] between two times, exactly that of the history.
  [[nodiscard]] double way(double from, double to) const;
  [[nodiscard]] bool over(double time) const { return release && time >= times.back(); }
};

/// Velocity components of the nodes in a part of space are prescribed.
struct Constraint {
  shape::Shape within;
  std::array<bool, 3> components{true, true, true};
  Vec3 velocity{0.0, 0.0, 0.0};  ///< [m/s] of the constrained components; with a history its direction, a unit vector
  int body = -1;                 ///< only on the grid field of this body; -1: on all
  std::optional<MotionHistory> history{};
};

/// What happens where two bodies touch. Bodies without a contact of their own share the velocity of the grid: they
/// stick together (no slip, no separation).
struct Contact {
  int first = 0;  ///< bodies
  int second = 1;
  double friction = 0.0;  ///< Coulomb coefficient
};

/// A pressure on the surface of a body. On a flat face it pushes on the particles of the body in a part of space, along
/// -`normal`: the outer layer of particles of the given thickness takes it, [Cui14] Eq. (20). Any other surface is
/// given in pieces, and the particles around each, below it, take what it bears.
struct SurfacePressure {
  int body = 0;
  shape::Shape within;                ///< of the particles at the start that carry it
  Vec3 normal{0.0, 0.0, 1.0};         ///< outer normal of the loaded face
  std::vector<shape::Facet> surface;  ///< in the place of `within` and normal, where there are any
  double thickness = 0.0;             ///< of the loaded layer [m]
  std::vector<double> times;          ///< [s], rising
  std::vector<double> pressures;      ///< [Pa] at these times; linear between, 0 outside
};

/// What became of a bar.
struct BarReport {
  double volume = 0.0;    ///< of steel in the domain [m3]
  double fraction = 0.0;  ///< of steel at the particles around the axis
};

/// How the particles of a body follow the nodes, and what becomes of their energy: from its material and the options.
struct BodyRules {
  StressOrder order = StressOrder::musl;
  bool affine = false;  ///< APIC
  /// Does the kinetic energy include that of the velocity gradients of the particles? That of APIC with B-splines, to
  /// which the second moment of the weights is the same everywhere.
  bool has_gradient_energy = false;
  /// Does the kinetic energy that the transfer loses become heat? That of fluids with APIC and B-splines.
  bool keeps_energy = false;
  /// Does the energy take the work that the forces on the nodes really do? Where the particles are updated by the
  /// nodes' new velocity itself.
  bool settles_work = false;
  bool books_work = false;  ///< see `Body::books_work`
};
[[nodiscard]] BodyRules rules_of(Body const& body, Options const& options);

}  // namespace brisance::mpm
