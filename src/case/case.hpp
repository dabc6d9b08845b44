/// A case: everything that defines one simulation, as plain data in SI units. The deck reader builds it, `World` runs
/// it.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "bridge/bridge.hpp"
#include "core/vec.hpp"
#include "detonation/charge.hpp"
#include "detonation/profile.hpp"
#include "grid/geometry.hpp"
#include "material/afterburn.hpp"
#include "material/explosive.hpp"
#include "material/material.hpp"
#include "mpm/mpm.hpp"
#include "shape/shape.hpp"

namespace brisance::cases {

using material::Primitive;

struct Ambient {
  material::Fluid fluid;
  Primitive state;
};

/// Velocity at the start that varies with the place, beside a constant one.
struct InitialMotion {
  Vec3 spin{0.0, 0.0, 0.0};    ///< angular velocity [rad/s]
  Vec3 centre{0.0, 0.0, 0.0};  ///< that it turns about [m]
  /// Components of the velocity [m/s] as functions of x, y, z [m], one for each resolved direction, in the place of the
  /// constant one; empty: none.
  std::vector<std::string> expressions;

  [[nodiscard]] bool any() const { return !expressions.empty() || dot(spin, spin) > 0.0; }
};

/// A part of the domain with another state, and optionally another fluid, at the start. Later ones overwrite
/// earlier ones.
struct InitialState {
  shape::Shape shape;
  Primitive state;
  int fluid = 0;  ///< number of the fluid that fills it, see `Case::other_fluids`
  /// Set when it is filled with an explosive's products or another named fluid.
  std::string fluid_name;
  InitialMotion motion{};
};

enum class Detonation { programmed, instantaneous };
constexpr auto words(Detonation) {
  return std::array{Word{Detonation::programmed, "programmed"}, Word{Detonation::instantaneous, "instantaneous"}};
}

using detonation::InitiationPoint;

/// A charge. `mass` is that of the whole body; where symmetry planes pass through its centre only a part lies in the
/// domain.
struct Charge {
  material::Explosive explosive;
  int fluid = material::products_fluid;  ///< that its products are
  shape::Shape shape;
  double mass = 0.0;  ///< [kg]
  Detonation detonation = Detonation::programmed;
  std::vector<InitiationPoint> initiation;  ///< at least one for programmed burn
};

/// One gauge particle. Lines and planes of the deck arrive here as their particles.
struct Gauge {
  std::string name;
  Vec3 position{0.0, 0.0, 0.0};
};

/// When and how an obstacle gives way.
struct Release {
  double pressure = 0.0;    ///< difference between the means of its two sides, of either sign, at which it does [Pa]
  double areal_mass = 0.0;  ///< the heavier, the longer it takes to open [kg/m2]; 0: at once
};

struct Obstacle {
  std::string name;
  shape::Shape shape;
  std::optional<Release> release{};  ///< of a panel
};

/// A body of material points. A case with bodies and without an MPM region is calculated by the material point method
/// alone.
struct Body {
  std::string name;
  material::Material solid;
  shape::Shape shape;
  Vec3 velocity{0.0, 0.0, 0.0};     ///< at the start [m/s]
  InitialMotion motion;             ///< beside it
  int particles_per_direction = 2;  ///< per cell
  bool rigid = false;               ///< keeps its velocity, whatever it meets
  /// Stands at the start under the weight of what is above it, and presses sideways with this fraction of it; absent:
  /// without stress.
  std::optional<double> lateral_stress;
  /// Does it move at the start?
  [[nodiscard]] bool moves() const { return dot(velocity, velocity) > 0.0 || motion.any(); }
  /// State at the start where it is not the solid's own: gases.
  std::optional<double> density;            ///< [kg/m3]
  std::optional<double> specific_energy;    ///< [J/kg]
  std::vector<InitiationPoint> initiation;  ///< of explosives; empty: burnt from the start
};

/// A gauge of the material points: it rides on the particle that is nearest to `point` at the start, or, without one,
/// watches the body as a whole.
struct ParticleGauge {
  std::string name;
  int body = 0;
  std::optional<Vec3> point;
};

/// The structure half of a case.
struct Particles {
  mpm::Options options;
  std::vector<Body> bodies;
  std::vector<mpm::Constraint> constraints;
  std::vector<mpm::Contact> contacts;
  std::vector<mpm::SurfacePressure> pressures;
  std::vector<mpm::Bar> bars;
  std::vector<ParticleGauge> gauges;

  [[nodiscard]] bool any() const { return !bodies.empty(); }
};

/// A part of a simulation with gas that material points calculate: bodies and the gas around them.
struct MpmRegion {
  /// Numbers of the bodies in it, rising. A region that is alone holds all of them, whatever stands here.
  std::vector<int> bodies;
  /// Boxes [m] whose faces lie on the grid; none: the smallest box around its bodies with the margin.
  std::vector<shape::Box> boxes;
  int margin =
      0;          ///< cells between the bodies and the faces of that box; 0: as few as the bridge allows, and some more
  int level = 0;  ///< of its cells, and of those beside it, see `Adaptive`
  int width = 5;  ///< of the bridge, w [cells]
  bridge::Transport transport = bridge::Transport::ledger;
  /// Of the gas, per cell; 0: 4 in 1D, 3 in 2D, 2 in 3D. Rows of particles that the flow stretches to a spacing between
  /// half a cell and a cell disturb the pressure most: the more particles at the start, the farther the gas may expand
  /// first.
  int particles_per_direction = 0;
  /// Overpressure next to the region that wakes it [Pa]; absent: a thousandth of the ambient pressure.
  std::optional<double> activation;
  bool subcycling = true;                          ///< gas and particles take steps of their own within a common one
  mpm::Transfer transfer = mpm::Transfer::apic;    ///< of the gas
  mpm::StressOrder order = mpm::StressOrder::usl;  ///< of the gas; usl or musl
  double courant = 0.5;                            ///< of the gas particles; `points.options.courant` is that of bodies
  int population_interval = 4;                     ///< steps of the particles between splits and merges; 0: none
  double linear_viscosity = 0.75;                  ///< of the gas: as much as damps the overshoot of strong shocks
  double viscosity_onset = 0.1;                    ///< of the linear term: sound waves pass undamped, see `mpm::Body`
  double quadratic_viscosity = 1.5;
  double shock_conduction = 1.0;  ///< of the gas, see `mpm::Body`
  bool slip = true;               ///< gas and other fluids slip along solids, see `mpm::Body`
  /// Taken off the pressure in the forces [Pa]; absent: the lowest pressure of the gas, the ambient one at most.
  std::optional<double> reference_pressure;

  [[nodiscard]] int gas_particles(int dimensions) const {
    return particles_per_direction > 0 ? particles_per_direction : 5 - dimensions;
  }
};

/// How a charge is calculated until the shock comes near anything.
enum class StartMethod { gas, particles };
constexpr auto words(StartMethod) {
  return std::array{Word{StartMethod::gas, "gas"}, Word{StartMethod::particles, "points"}};
}

/// The start of a simulation by a remap: each charge bursts in a simulation of its own with fewer directions.
struct Start {
  bool remap = false;  ///< else the charges are on the grid from time 0
  StartMethod method = StartMethod::gas;
  double cell = 0.0;           ///< of the 1D simulation [m]; 0: a fraction of the charge's radius, see setup/start.hpp
  std::optional<double> time;  ///< of the remap [s]
  std::optional<double> radius;  ///< of the shock at the remap [m]; without both: where it is about to meet something
  std::string profile;           ///< file that stands in for the simulation
  /// What messages about it begin with: place in the deck and key.
  std::string place;
  /// One for each charge. Filled from the file or by `calculate_start`; while empty, `World` calculates them.
  std::vector<std::shared_ptr<detonation::Profile const>> profiles;
  bool from_checkpoint = false;  ///< the state is about to be read: nothing is remapped
};

using gas::Scheme;

/// How the gas sees obstacles.
enum class ObstacleCells { automatic, cut, stairs };
constexpr auto words(ObstacleCells) {
  return std::array{
      Word{ObstacleCells::automatic, "auto", "`cut`; with `lax-wendroff` or an obstacle that fails `stairs`"},
      Word{ObstacleCells::cut, "cut", "by the parts of cells and faces that they leave open"},
      Word{ObstacleCells::stairs, "stairs", "a cell is solid if they fill at least half of it"}};
}

struct Numerics {
  Scheme scheme = Scheme::muscl_hancock;
  double courant = 0.8;
  int block_cells = 0;           ///< cells per block and direction; 0: chosen by dimension
  bool sleep = true;             ///< quiescent blocks are skipped
  double limiter_beta = 1.5;     ///< generalised monotonised-central limiter, 1 (minmod) to 2
  bool carbuncle_cure = true;    ///< blend to HLL along detected shocks
  double density_floor = 1e-6;   ///< guard [kg/m3]
  double pressure_floor = 1e-3;  ///< guard [Pa]
  double viscosity = 0.0;        ///< lax-wendroff: constant eta; 0: eta of [Cui14] Eq. (5) with |u| + c
  ObstacleCells obstacles = ObstacleCells::automatic;
};

/// A part of the domain whose cells are of a level at least.
struct Refine {
  shape::Shape shape;
  int level = 0;
};

/// Cells of several sizes. Those of level l are 1/2^l as large as `domain.h`, which is the size of level 0.
struct Adaptive {
  int finest = 0;               ///< finest level of the gas; 0: all cells are of one size
  int shocks = 0;               ///< to which shocks are followed
  int charges = 0;              ///< of charges, until they have burst
  int obstacles = 0;            ///< of the surfaces of obstacles that do not fit larger cells
  std::optional<int> gauges;    ///< around gauges; absent: they ask for nothing
  std::optional<int> products;  ///< of the surface of the products; absent: it asks for nothing
  std::vector<Refine> parts;    ///< [[refine]]
  double threshold = 0.3;       ///< of the norm of [Lohner87] from which on a shock asks, 0 to 1
  double most_cells = 0.0;      ///< of the whole domain; 0: no limit

  [[nodiscard]] bool any() const { return finest > 0; }
};

/// A plane across one direction.
struct Plane {
  int normal = 0;   ///< direction
  double at = 0.0;  ///< along it [m]
};

/// A part of the gas whose fields are written as a series of their own, at times of their own: the cells that a plane
/// cuts, or those in a box.
struct FieldSubset {
  std::string name;
  std::variant<Plane, shape::Box> place;
  /// Finer cells are shown as their means over cells of this level; below 0: cells larger than `domain.h`. Absent: all
  /// cells as they are.
  std::optional<int> level;
  double interval = 0.0;  ///< [s]; 0: at the start and the end only
  /// Names; empty: those of the whole domain.
  std::vector<std::string> fields;
};

struct Output {
  bool whole = true;  ///< dumps of the whole domain are written, not subsets alone
  std::vector<FieldSubset> subsets;
  double field_interval = 0.0;      ///< [s]; 0: none but the last
  std::vector<double> field_times;  ///< extra times [s]
  double gauge_interval = 0.0;      ///< [s]; 0: every step
  bool peak_fields = true;          ///< peak overpressure and impulse per cell
  bool single_precision = true;     ///< fields in float
  std::vector<std::string> fields{"pressure", "density", "velocity", "products"};
  /// Fields of the material points beside position, body and material.
  std::vector<std::string> particle_fields{"velocity", "displacement", "pressure", "mises", "plastic_strain", "damage"};
  bool gas_particles = false;  ///< dump the gas particles of an MPM region too
  bool profile = false;        ///< write the state at the end as a profile for other decks
};

/// What comes first ends the simulation.
struct End {
  double time = 0.0;            ///< [s]
  long steps = 0;               ///< 0: no limit
  bool gauges = false;          ///< when all gauges of the gas are past their positive phase
  double kinetic_energy = 0.0;  ///< when it stays below this fraction of its largest value; 0: not by it
  double wall_clock = 0.0;      ///< of the program, after which it stops with a checkpoint [s]; 0: no limit
};

/// When the whole state is written, from which a run can go on. Whatever is chosen here does not change the results.
struct Checkpoint {
  double interval = 0.0;      ///< simulated time between two [s]; 0: not by it
  long steps = 0;             ///< steps between two; 0: not by them
  double wall_clock = 600.0;  ///< wall-clock time between two [s]; 0: not by it
  int keep = 2;               ///< the newest ones stay on the disk
  bool at_end = true;
  bool on_signal = true;  ///< when the user stops the run
};

/// How far the energy of material points may drift, alone and together with gas: fractions of `EnergyBalance::scale`;
/// 0: as far as it will. Nothing here changes the results.
struct AuditLimits {
  double warn = 0.005;  ///< beyond it the run is told to be NOT BALANCED
  double fail = 0.05;   ///< beyond it the run stops; 0: nothing that the audit finds stops it
};

/// How the Kingery-Bulmash values beside the gauges are to be taken.
enum class Burst { none, spherical, hemispherical };

struct Case {
  std::string title;
  std::string deck_path;  ///< as given
  std::string deck_text;  ///< as read
  grid::Domain domain;
  std::array<Primitive, 6> inflow;  ///< beyond the faces where it is given (`grid::is_given`)
  Ambient ambient;
  /// Fluids beside the ambient one, in the order of their numbers from 1 on: products of the charges' explosive, or the
  /// fluid of an initial state.
  std::vector<material::Fluid> other_fluids;
  std::optional<material::Afterburn> afterburn;  ///< of the products
  std::vector<InitialState> initial_states;
  std::vector<Charge> charges;
  std::vector<Gauge> gauges;
  std::vector<Obstacle> obstacles;
  Particles particles;
  std::vector<MpmRegion> mpm_regions;  ///< where gas and bodies meet
  Start start;
  Numerics numerics;
  Adaptive adaptive;
  Output output;
  End end;
  Checkpoint checkpoint;
  AuditLimits audit;
  Burst burst = Burst::none;

  /// The domain as if all its cells were of a level.
  [[nodiscard]] grid::Domain domain_of(int level) const { return domain.refined(level); }
  [[nodiscard]] bool has_regions() const { return !mpm_regions.empty(); }
  /// Numbers of the bodies of an MPM region, rising; without one bodies in a vacuum are that of number 0.
  [[nodiscard]] std::vector<int> bodies_of(std::size_t region) const {
    if (mpm_regions.size() > 1) return mpm_regions[region].bodies;
    std::vector<int> all(particles.bodies.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  /// Number of the region that holds a body.
  [[nodiscard]] std::size_t region_with(int body) const {
    std::size_t region = 0;
    while (region + 1 < mpm_regions.size() && !std::ranges::binary_search(mpm_regions[region].bodies, body)) ++region;
    return region;
  }
  /// The cells that material points see: those of their region.
  [[nodiscard]] grid::Domain region_domain(std::size_t region) const {
    return domain_of(has_regions() ? mpm_regions[region].level : 0);
  }
  [[nodiscard]] grid::Domain domain_around(int body) const { return region_domain(region_with(body)); }
  /// Fluid `number`, from 1 on; null where there is none.
  [[nodiscard]] material::Fluid const* other_fluid(int number) const {
    return number <= static_cast<int>(other_fluids.size()) ? &other_fluids[number - 1] : nullptr;
  }
  /// Courant number of a body: that of the deck, or else the usual one. Beside the particles of the gas, which need far
  /// fewer steps, elastic bodies and metals go nearer to the limit of stability, which B-splines guarantee wherever the
  /// particles stand: docs/theory.md, "Steps". Others, in which damage would follow the length of the step, do not.
  [[nodiscard]] double courant_of(Body const& body) const {
    mpm::Options const& o = particles.options;
    bool const alike = body.solid.is_metal() || (body.solid.has_deviator() && !body.solid.plastic());
    if (o.courant || !has_regions() || o.shape != mpm::ShapeFunction::bspline || !alike) return o.courant_number();
    return domain.dimensions() == 3 ? 0.5 : 0.6;
  }
  /// The explosive whose products fluid `number` is; null where no charge makes it.
  [[nodiscard]] material::Explosive const* explosive_of(int number) const {
    auto const found = std::find_if(charges.begin(), charges.end(), [&](Charge const& c) { return c.fluid == number; });
    return found == charges.end() ? nullptr : &found->explosive;
  }
};

}  // namespace brisance::cases

// The layers that work on a case name its parts as their own: `run::Body`.
namespace brisance::setup {
using namespace cases;
}
namespace brisance::run {
using namespace cases;
}
namespace brisance::observe {
using namespace cases;
}
