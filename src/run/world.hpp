/// The world: the whole state of one calculation.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "gas/gas.hpp"
#include "grid/grid.hpp"
#include "run/panels.hpp"
#include "setup/place_gas_regions.hpp"
#include "setup/solid_cells.hpp"
#include "setup/start.hpp"

namespace brisance {
class Archive;
namespace observe {
class GasView;
}
}  // namespace brisance

namespace brisance::run {

struct Clock {
  double time = 0.0;  ///< [s]
  double dt = 0.0;    ///< length of the last step [s]
  long step = 0;
  long gas_steps = 0;    ///< steps of the gas within these
  long point_steps = 0;  ///< of the points
};

/// Sums over the domain. Planar geometries count per metre of each unresolved direction.
struct Totals {
  std::array<double, 2> mass{0.0, 0.0};  ///< ambient fluid, second fluid [kg]
  Vec3 momentum{0.0, 0.0, 0.0};          ///< [kg m/s]
  double energy = 0.0;                   ///< internal + kinetic, chemical energy of unburnt explosive included [J]
  double kinetic_energy = 0.0;           ///< of it [J]
  /// Energy that all of this would have in the start's ambient state and at rest [J].
  double rest_energy = 0.0;

  Totals& operator+=(Totals const& other) {
    for (int fluid = 0; fluid < 2; ++fluid) mass[fluid] += other.mass[fluid];
    momentum = momentum + other.momentum;
    energy += other.energy;
    kinetic_energy += other.kinetic_energy;
    rest_energy += other.rest_energy;
    return *this;
  }
};

/// What the audit remembers of earlier times: as of the instants of `World::follow_audit`, which neither output nor
/// threads move.
struct AuditMemory {
  double scale = 0.0;    ///< largest energy at work, see `EnergyBalance` [J]
  double all = 0.0;      ///< largest energy of all, that of the ambient state too [J]
  double drift = 0.0;    ///< of the energy, the largest of either sign [J]
  double content = 0.0;  ///< largest sum of the sizes of the masses in the ledger's accounts [kg]
  double surplus = 0.0;  ///< largest mass in the ledger that does not belong there [kg]
  double gas = 0.0;      ///< largest mass of the gas points [kg]
  double work = 0.0;     ///< of loads, until the last look [J]
  double fresh = 0.0;    ///< of it, since the look before, its size [J]
  double unlit = 0.0;    ///< largest compression of explosive before it was lit
};

/// What must stay constant, and what changed it. At any time: current = initial - outflow + guards + afterburn + panels
/// (+ round-off).
struct Audit {
  Totals initial;
  Totals current;           ///< `ledger` included
  Totals ledger;            ///< of it, what is under way between gas cells and points
  Totals outflow;           ///< left through the domain's faces since the start; momentum includes the pressure impulse
  long fallback_faces = 0;  ///< faces whose flux was replaced by, or blended with, a first-order one
  long guarded_cells = 0;   ///< cell updates in which density or internal energy had to be lifted to its floor
  double guard_mass = 0.0;  ///< mass that the guards added [kg]
  double guard_energy = 0.0;      ///< energy that the guards added [J]
  double afterburn_energy = 0.0;  ///< energy that the products released after the detonation [J]
  /// What the cells of panels hold more since they opened: ambient gas was counted there before [kg, J].
  std::array<double, 2> panel_mass{0.0, 0.0};
  double panel_energy = 0.0;
  AuditMemory memory;

  /// |initial - outflow + guards + afterburn + panels - current| relative to the largest of the terms; index 0, 1:
  /// fluids, 2: energy.
  [[nodiscard]] std::array<double, 3> relative_error() const;
};

/// What became of one charge on the grid.
struct ChargeReport {
  std::string explosive;
  double asked_mass = 0.0;        ///< whole body [kg]
  double realised_mass = 0.0;     ///< whole body, symmetry images counted [kg]
  double realised_energy = 0.0;   ///< E0 of the realised volume [J]
  double cells_per_radius = 0.0;  ///< (volume of the part in the domain as an equivalent radius) / h
};

struct GaugeRecord {
  double time = 0.0;
  double pressure = 0.0;  ///< [Pa]
  double density = 0.0;   ///< [kg/m3]
  Vec3 velocity{0.0, 0.0, 0.0};
};

struct GaugeHistory {
  Gauge gauge;
  std::vector<GaugeRecord> records;
};

/// What a gauge that rides on a point records.
struct PointRecord {
  double time = 0.0;
  Vec3 position{0.0, 0.0, 0.0};      ///< [m]
  Vec3 displacement{0.0, 0.0, 0.0};  ///< since the start [m]
  Vec3 velocity{0.0, 0.0, 0.0};      ///< [m/s]
  double pressure = 0.0;             ///< mean stress, tension negative [Pa]
  double mises = 0.0;                ///< equivalent stress [Pa]
  double density = 0.0;              ///< [kg/m3]
  double plastic_strain = 0.0;
  double temperature = 0.0;  ///< [K]
  double damage = 0.0;
};

/// What a gauge that watches a body records.
struct BodyRecord {
  double time = 0.0;
  mpm::BodySums sums;
};

struct PointGaugeHistory {
  PointGauge gauge;
  long identity = -1;  ///< of the point that the gauge rides on; -1: it watches the body
  mpm::Place place;    ///< where that point was last
  bool lost = false;   ///< the point has left the domain: the record has ended
  std::vector<PointRecord> points;
  std::vector<BodyRecord> bodies;
};

/// What became of one body on the grid.
struct BodyReport {
  std::string name;
  std::string material;
  long points = 0;
  double mass = 0.0;            ///< of the points [kg]
  double geometric_mass = 0.0;  ///< of the shape's part in the domain [kg]
  int bars = 0;                 ///< of reinforcement
  double bar_volume = 0.0;      ///< of them in the domain [m3]
};

/// Where the energy stands that is not conserved by construction: of material points, alone or together with gas.
struct EnergyBalance {
  double initial = 0.0;  ///< kinetic and internal [J]
  double current = 0.0;
  double lost = 0.0;            ///< left through the domain's faces [J]
  double work = 0.0;            ///< done by loads, the body force, and constraints and rigid bodies in motion [J]
  double released = 0.0;        ///< by the afterburn [J]
  double opened = 0.0;          ///< came with the cells of panels that opened [J]
  mpm::Dissipation dissipated;  ///< kinetic energy that was lost and is known
  /// What an error of the energy is to be compared with [J]: the largest value so far of the energy at work, that is
  /// kinetic energy + |work| + internal energy above (or below) the start's ambient state. The latter holds what burns
  /// from the start, and what an afterburn has released.
  double scale = 0.0;
  double all = 0.0;  ///< the same, the energy of the ambient state included [J]

  /// current + lost + dissipated - work - released - opened - initial [J]. What guards add is in it.
  [[nodiscard]] double error() const { return current + lost + dissipated.sum() - work - released - opened - initial; }
  /// `error` over `scale`; 0 where there is no energy.
  [[nodiscard]] double drift() const { return scale > 0.0 ? error() / scale : 0.0; }
};

/// Something that the audit has looked at.
struct AuditFinding {
  enum class Kind {
    first_mass,
    second_mass,
    gas_energy,    ///< of gas alone
    guard_energy,  ///< that the guards added
    guard_mass,
    drift,   ///< of the energy of points, alone or together with gas
    ledger,  ///< gas that lies between cells and points
    unlit,   ///< compression of explosive before it was lit
  };
  Kind kind = Kind::drift;
  double amount = 0.0;    ///< what is too much [J, kg or of 1], with its sign
  double scale = 0.0;     ///< of what [J, kg or 1]
  double warn = 0.0;      ///< part of the scale from which on the run does not balance
  double fail = 0.0;      ///< from which on it stops; 0: never
  double smallest = 0.0;  ///< amounts up to this are none [J or kg]
  double fresh = 0.0;     ///< what the limits leave on top, see `World::audit_findings` [J]

  [[nodiscard]] double share() const;  ///< of the scale; infinite where that is none
  [[nodiscard]] bool tells() const;
  [[nodiscard]] bool stops() const;
};

/// What the audit says.
struct Verdict {
  bool balanced = true;
  bool drift_judged = true;          ///< false: `AuditLimits::warn` is 0
  std::vector<std::string> reasons;  ///< why it does not balance, a line each
};

void archive(Archive& a, Totals& totals);
void archive(Archive& a, ChargeReport& report);
void archive(Archive& a, GaugeRecord& record);
void archive(Archive& a, PointRecord& record);
void archive(Archive& a, BodyRecord& record);

/// Wall-clock seconds per phase of the step and of the output.
using Timings = std::map<std::string, double>;

/// The fluids of the gas of a case.
[[nodiscard]] gas::Fluids fluids_of(Case const& setup);
/// The ambient fluid in a state.
[[nodiscard]] gas::MixtureState ambient_mixture(FluidState const& state);

class World {
 public:
  /// Builds the initial state. Throws InputError where the case cannot be realised (charge over a symmetry plane, ...).
  explicit World(Case setup);
  ~World();
  World(World const&) = delete;
  World& operator=(World const&) = delete;

  Case setup;
  grid::Grid grid;
  std::unique_ptr<gas::Gas> gas;           ///< null where the case has bodies in a vacuum
  std::unique_ptr<mpm::Mpm> points;        ///< null where it has none
  std::unique_ptr<bridge::Bridge> bridge;  ///< joins the two where both are there
  std::unique_ptr<Panels> panels;          ///< null where the case has none
  Clock clock;
  Audit audit;
  std::vector<ChargeReport> charges;
  std::vector<setup::RegionReport> regions;      ///< what became of each region of the gas
  std::vector<setup::ObstacleReport> obstacles;  ///< and of each obstacle
  std::vector<setup::StartReport> starts;        ///< of each charge, where the case starts by a remap
  std::vector<BodyReport> bodies;
  std::vector<GaugeHistory> gauges;
  std::vector<PointGaugeHistory> point_gauges;
  /// Sums over each body, about a thousand times in a run: at the start, then whenever the gauges are sampled and the
  /// next thousandth of the end time or the end itself is reached.
  std::vector<std::vector<BodyRecord>> body_histories;
  Timings timings;
  std::optional<double> awake_since;  ///< when the MPM region woke [s]

  /// Is the end time or the step limit reached, or have all bodies left the domain?
  [[nodiscard]] bool finished() const;
  /// Of a calculation of bodies alone: none of their points is left.
  [[nodiscard]] bool bodies_have_left() const;
  /// Kinetic energy of gas and points [J]; summed in a fixed order.
  [[nodiscard]] double kinetic_energy() const;
  /// Number of cells of the blocks that are awake.
  [[nodiscard]] long active_cells() const;
  /// Sums over the domain, in a fixed order.
  [[nodiscard]] Totals totals() const;
  /// Records every gauge at the present time.
  void sample_gauges();
  /// Records the sums over each body at the present time, where that has not been done: for the end of a run.
  void record_bodies();
  /// The body of the gas points, -1 without an MPM region.
  [[nodiscard]] int gas_body() const { return bridge == nullptr ? -1 : bridge->gas_body(); }
  /// Brings `audit.current`, `audit.outflow` and the guard counts up to date.
  void update_audit();
  /// To be called after every step: looks at the guards, and some thousand times in a run at all the rest. Throws
  /// NumericalError where what it finds is beyond the limits of the case.
  void follow_audit();
  /// The energy as of the last `update_audit`.
  [[nodiscard]] EnergyBalance energy_balance() const;
  /// All that the audit looks at, as of the last `update_audit`.
  [[nodiscard]] std::vector<AuditFinding> audit_findings() const;
  [[nodiscard]] Verdict verdict() const;
  /// Schemes that are there for comparison only run on whatever the audit finds.
  [[nodiscard]] bool for_comparison() const;
  /// Writes the whole state into a checkpoint or takes it from one: the world is then the one that was written, to the
  /// last bit. Throws IoError where the checkpoint is not of this case; the state is worthless afterwards.
  void archive(Archive& a);

 private:
  [[nodiscard]] Totals gas_totals() const;
  [[nodiscard]] Totals point_totals() const;
  [[nodiscard]] Totals ledger_totals() const;
  [[nodiscard]] double gas_rest_energy() const;
  void start_audit();
  void take_account();
  [[nodiscard]] double energy_at_work() const;
  [[nodiscard]] bool audit_is_due() const;
  [[nodiscard]] std::string in_words(AuditFinding const& finding) const;
  void sample_points();
  std::unique_ptr<observe::GasView> gauge_view_;  ///< made with the first sample
  double gas_rest_energy_ = 0.0;                  ///< of gas cells and gas points in the ambient state [J]
};

/// Largest stable time step of the present state [s].
[[nodiscard]] double stable_step(World const& world);

/// One step n -> n+1, not beyond `latest` [s]. Returns dt. Throws NumericalError.
double advance(World& world, double latest);

}  // namespace brisance::run
