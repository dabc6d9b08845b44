/// The material point method, [Cui14] Sec. 2.2: bodies of points that move through a background grid on which the
/// momentum equation is solved.
///
/// One step, `advance`, is four passes over the blocks. Within a pass a block writes only what belongs to it:
///     map_to_grid       Eqs. (18)-(21)   mass, momentum and forces of the points to their block's patch
///     integrate         Eqs. (22)-(26)   sum of the patches, new velocity of the nodes, motion of the points, and
///     their
///                                        velocity mapped back
///     update_stress     Eqs. (27)-(30)   strain, spin, density, stress, energy
///     migrate                            points that left their block move to the next
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/lanes.hpp"
#include "grid/grid.hpp"
#include "material/solid.hpp"
#include "mpm/points.hpp"
#include "mpm/population.hpp"
#include "mpm/reinforcement.hpp"
#include "shape/shape.hpp"
#include "shape/surface.hpp"

namespace brisance::mpm {

enum class ShapeFunction {
  linear,   ///< tents
  gimp,     ///< points of constant size (uGIMP)
  cpgimp,   ///< points that stretch with the material
  bspline,  ///< quadratic
};
constexpr auto words(ShapeFunction) {
  return std::array{Word{ShapeFunction::linear, "linear"}, Word{ShapeFunction::gimp, "gimp"},
                    Word{ShapeFunction::cpgimp, "cpgimp"}, Word{ShapeFunction::bspline, "bspline"}};
}

/// When the stress is updated: before the momentum, or after it with the velocity of the nodes or with the velocity of
/// the points mapped back to the nodes ([Cui14] Eq. (26)).
enum class StressOrder { usf, usl, musl };
constexpr auto words(StressOrder) {
  return std::array{Word{StressOrder::usf, "usf"}, Word{StressOrder::usl, "usl"}, Word{StressOrder::musl, "musl"}};
}

/// How the velocity of the points follows that of the nodes.
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
  bool locking_control = false;  ///< volumetric strain averaged over the points of a body in a cell
  double linear_viscosity = 0.06;
  double quadratic_viscosity = 1.5;
  double courant = 0.4;
  Vec3 body_force{0.0, 0.0, 0.0};  ///< acceleration of everything [m/s2]
  /// A further acceleration [m/s2] of the points that varies with their position [m] and the time [s]; null: none.
  std::function<Vec3(Vec3 const& x, double time)> acceleration;
  /// Planes across each direction, low and high [m], behind which bodies go on: open faces of a domain that cuts them.
  /// Fluids that slip do not flow around their ends there.
  std::array<std::optional<double>, 6> ends{};
  /// Coulomb's coefficient between bodies and faces of the domain that are a `wall`.
  double wall_friction = 0.0;
  int block_cells = 0;  ///< cells per block and direction; 0: 8 in 3D, 32 in 2D, 256 in 1D
};

struct Body {
  std::string name;
  material::Solid solid;
  int points_per_direction = 2;  ///< per cell: gives GIMP points their size
  /// Set for a rigid body: its velocity, which nothing changes [m/s].
  std::optional<Vec3> rigid_velocity;
  /// How the velocity of this body's points follows the nodes; absent: as `Options` says.
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
  /// Conduction of heat in shocks, [Noh87]: the part of the difference between a fluid point's specific energy and that
  /// around it that is evened out in a step, times q / (p + q). Bulk viscosity alone overheats the first points that a
  /// shock reaches, at walls and at faces of the region, for good. 0: none.
  double shock_conduction = 0.0;
  /// A fluid that slips along all bodies that do not: it shares their velocity across their surfaces only, where the
  /// others stick together. All that slip share one field of the grid.
  bool slips = false;
  /// A gas that fills what other bodies leave of the space, lent points around it included. The volume of a point
  /// follows the velocity along its way and knows nothing of the room between its neighbours: the two drift apart, and
  /// forces, which go with the volumes, are wrong by as much. With this they follow the room that there is, as fast as
  /// the gas is strained, at the same mass; what the reference pressure took for the volume goes back to the energy.
  bool fills_space = false;
  /// The energy of points that follow increments takes the work that the forces on the nodes do, and as heat what the
  /// points do not take up of the nodes' kinetic energy. Without it either is left to what the strains of the points
  /// say: beside a detonation both are wrong by percents of its energy, where bodies meet the second by as much. The
  /// pressure of a solid that is warmed by it rises.
  bool books_work = false;
};

/// What fills (a part of) a body.
struct Filling {
  std::vector<Vec3> positions;  ///< [m]
  std::vector<double> volumes;  ///< [m3], in the convention of `Domain::cell_volume`
  Vec3 velocity{0.0, 0.0, 0.0};
  /// State that differs from the solid's own.
  std::optional<double> density;          ///< [kg/m3]
  std::optional<double> specific_energy;  ///< [J/kg]
  /// Composition, of bodies that mix two fluids.
  double mass_fraction = 0.0;    ///< of the second fluid
  double volume_fraction = 0.0;  ///< of the second fluid
};

/// Velocity components of the nodes in a part of space are prescribed.
struct Constraint {
  shape::Shape region;
  std::array<bool, 3> held{true, true, true};
  Vec3 velocity{0.0, 0.0, 0.0};  ///< [m/s] of the held components
  int body = -1;                 ///< only on the grid field of this body; -1: on all
};

/// What happens where two bodies touch. Bodies without a contact of their own share the velocity of the grid: they
/// stick together (no slip, no separation).
struct Contact {
  int first = 0;  ///< bodies
  int second = 1;
  double friction = 0.0;  ///< Coulomb coefficient
};

/// A pressure on the surface of a body. On a flat face it pushes on the points of the body in a part of space, along
/// -`normal`: the outer layer of points of the given thickness takes it, [Cui14] Eq. (20). Any other surface is given
/// in pieces, and the points around each, below it, take what it bears.
struct SurfacePressure {
  int body = 0;
  shape::Shape region;                ///< of the points at the start that carry it
  Vec3 normal{0.0, 0.0, 1.0};         ///< outer normal of the loaded face
  std::vector<shape::Facet> surface;  ///< in the place of region and normal, where there are any
  double thickness = 0.0;             ///< of the loaded layer [m]
  std::vector<double> times;          ///< [s], rising
  std::vector<double> pressures;      ///< [Pa] at these times; linear between, 0 outside
};

/// What became of a bar.
struct BarReport {
  double volume = 0.0;  ///< of steel in the domain [m3]
  double part = 0.0;    ///< of steel at the points around the axis
};

/// Sums over the points of one body.
struct BodySums {
  long points = 0;
  double mass = 0.0;  ///< [kg]
  /// Of it, of the ambient and of the second fluid: gas. Each is summed by itself: of products and a little air the
  /// difference of two sums would lose three digits of the air.
  std::array<double, 2> fluid_mass{0.0, 0.0};
  Vec3 momentum{0.0, 0.0, 0.0};  ///< [kg m/s]
  Vec3 centre{0.0, 0.0, 0.0};    ///< of mass [m]
  double kinetic_energy = 0.0;   ///< [J]
  double internal_energy = 0.0;  ///< [J]
  /// Part of it that the next step puts the real work in the place of, of bodies that book the work of the nodes [J].
  /// Without it the energies are those of one time: velocities stand half a step before positions and stress.
  double provisional_energy = 0.0;
  double plastic_work = 0.0;          ///< [J]
  double largest_displacement = 0.0;  ///< [m]; of bodies that know their origin
  double damaged_mass = 0.0;          ///< mass with damage 1 [kg]
};

/// What left through free faces of the domain.
struct Losses {
  double mass = 0.0;
  Vec3 momentum{0.0, 0.0, 0.0};
  double energy = 0.0;
  long points = 0;
};

/// Kinetic energy that points lost, known where and why [J].
struct Dissipation {
  /// At nodes that constraints hold: what arrives there with another velocity takes theirs, a plastic impact.
  double held = 0.0;
  double filtered = 0.0;  ///< by the fraction of PIC, and by XPIC
  double apic = 0.0;      ///< by APIC in bodies whose heat it is not: solids, and fluids without B-splines
  double friction = 0.0;  ///< to the friction of contacts; it heats nothing

  [[nodiscard]] double sum() const { return held + filtered + apic + friction; }
  Dissipation& operator+=(Dissipation const& more) {
    held += more.held;
    filtered += more.filtered;
    apic += more.apic;
    friction += more.friction;
    return *this;
  }
};

/// What gave gas points their least energy back. A gas that has less than that of no pressure pushes nothing any more
/// and never comes back: its energy is lifted to it, which adds energy, as the guards of the gas cells do.
struct FloorCount {
  double energy = 0.0;  ///< added [J]
  long points = 0;      ///< lifted, each as often as it was

  FloorCount& operator+=(FloorCount const& more) {
    energy += more.energy;
    points += more.points;
    return *this;
  }
};

/// What `Body::shock_conduction` did: what some points give others take.
struct ConductionCount {
  double moved = 0.0;  ///< heat that changed its point [J]
  double made = 0.0;   ///< what was taken less what was given [J]: round-off

  ConductionCount& operator+=(ConductionCount const& more) {
    moved += more.moved;
    made += more.made;
    return *this;
  }
};

/// What lent points gave to a node in a step, in the directions of the axes: what they lost of it themselves, forces
/// included. Summed over all nodes it is what the other points gained. The part of the reference pressure is left out.
struct NodeGift {
  Index3 node{0, 0, 0};          ///< of the grid
  Vec3 impulse{0.0, 0.0, 0.0};   ///< by their forces [kg m/s]
  Vec3 work{0.0, 0.0, 0.0};      ///< of these [J]
  Vec3 momentum{0.0, 0.0, 0.0};  ///< that the others took from theirs at the node's new velocity [kg m/s]
  double energy = 0.0;           ///< kinetic, likewise [J]
};

/// Where a point is kept.
struct Place {
  int block = -1;
  int index = -1;
};

void archive(Archive& a, BodySums& sums);

struct Given;
struct Scratch;
struct Meeting;
struct Partner;
struct Hoops;
struct OuterForces;

class Mpm {
 public:
  /// Throws InputError where bodies, contacts or constraints contradict each other.
  Mpm(grid::Domain const& domain, std::vector<Body> bodies, Options const& options,
      std::vector<Constraint> const& constraints = {}, std::vector<Contact> const& contacts = {});
  ~Mpm();
  Mpm(Mpm const&) = delete;
  Mpm& operator=(Mpm const&) = delete;

  /// Adds points to a body. Points outside the domain are refused (InputError).
  void fill(int body, Filling const& filling);
  /// Lets a pressure act on the points that lie in its region now.
  void load(SurfacePressure const& pressure);
  /// Smears a bar over the points around its axis where they are now; points that have one already keep it. Throws
  /// InputError where the bar does not lie within the body.
  BarReport reinforce(Bar const& bar);
  /// Gives the points of a burning body their lighting times [s].
  void set_lighting(int body, std::function<double(Vec3 const&)> const& lighting_time);
  /// Tells where in time the calculation stands [s]; the burn and the loads depend on it.
  void set_time(double time);

  /// See `Body::reference_pressure`.
  void set_reference_pressure(int body, double pressure) { bodies_[body].reference_pressure = pressure; }
  /// Lowest pressure of the points of a body, lent ones included [Pa]; infinite where it has none.
  [[nodiscard]] double lowest_pressure(int body) const;

  /// Points that are lent to a block for the next step: they give the nodes mass, momentum and force as all others do,
  /// but their state belongs to somebody else, who also tells their velocity at the end of the step (field `next_x`).
  [[nodiscard]] PointSet& lent(int block) { return lent_[block]; }
  /// Which body the lent points belong to. To be called before `lent`.
  void lend_as(int body);
  /// To be called after the lent points have been changed, before the step.
  void lending_done() { find_active(); }
  /// What the points lent to a block gave at its nodes in the last step.
  [[nodiscard]] std::vector<NodeGift> const& gifts(int block) const { return gifts_[block]; }
  /// Adds copies of points with the fields of the body; they get new identities. Their signals do not yet count in
  /// `stable_step`: `update_signals` or the next step sees to that.
  void add(int body, PointSet const& points);
  /// Finds the fastest signal of the points anew.
  void update_signals();
  /// Takes out the points of a block for which `outside(x)` holds, in their order, and appends them to `to`.
  void take_out(int block, int body, std::function<bool(PointSet const& set, int q)> const& outside, PointSet& to);
  /// Makes the points of an explosive that have burnt points of a gas, whose second fluid their products are. They get
  /// new identities. Returns how many there were.
  long hand_over_burnt(int explosive, int gas);
  /// Does the kinetic energy of a body include that of the velocity gradients of its points? That of APIC with
  /// B-splines, to which the second moment of the weights is the same everywhere.
  [[nodiscard]] bool has_gradient_energy(int body) const;
  /// Does the kinetic energy that a body's transfer loses become heat? That of fluids with APIC and B-splines.
  [[nodiscard]] bool keeps_energy(int body) const;
  /// Does its energy take the work that the forces on the nodes really do? Where the points are updated by the nodes'
  /// new velocity itself.
  [[nodiscard]] bool settles_work(int body) const { return keeps_energy(body) && order_of(body) == StressOrder::usl; }
  /// Does it book the work of the nodes, see `Body::books_work`?
  [[nodiscard]] bool books_work(int body) const;
  [[nodiscard]] FieldList const& fields(int body) const { return sets_[body].fields(); }

  /// Largest stable step [s] at the bodies' Courant numbers: the least of courant h / (sound speed + speed).
  [[nodiscard]] double stable_step() const;
  /// One step. Throws NumericalError when a point's state has lost its meaning.
  void advance(double dt);
  /// Splits and merges the points of a gas where that is due; to be called between steps: every 4 where the gas runs
  /// into a vacuum, else every 8 will do. The sums of `sums` stay as they are up to round-off, but for the number of
  /// points and for kinetic energy that becomes internal. Of two merged points the heavier keeps its identity. Throws
  /// InputError for a body that is no gas.
  PopulationCount control_population(int body, PopulationOptions const& options = {});

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] grid::Grid const& grid() const { return grid_; }
  [[nodiscard]] Options const& options() const { return options_; }
  [[nodiscard]] std::vector<Body> const& bodies() const { return bodies_; }
  [[nodiscard]] long point_count() const;
  [[nodiscard]] PointSet const& points(int block, int body) const { return sets_[set_index(block, body)]; }
  [[nodiscard]] PointSet& points(int block, int body) { return sets_[set_index(block, body)]; }
  /// Sums in a fixed order.
  [[nodiscard]] BodySums sums(int body) const;
  [[nodiscard]] Losses const& losses() const { return losses_; }
  /// Momentum that constraints and rigid bodies gave to the points since the start [kg m/s].
  [[nodiscard]] Vec3 const& constraint_impulse() const { return constraint_impulse_; }
  /// Work that constraints, rigid bodies, surface pressures and the body force did on the points since the start [J].
  [[nodiscard]] double outer_work() const { return outer_work_; }
  /// Since the start; what held nodes and filters take, of bodies with FLIP and XPIC.
  [[nodiscard]] Dissipation const& dissipation() const { return dissipation_; }
  /// Since the start: energy that gas was given because it had less than none, see `FloorCount`.
  [[nodiscard]] FloorCount const& floored() const { return floored_; }
  /// Since the start: heat that went from points to others in shocks.
  [[nodiscard]] ConductionCount const& conducted() const { return conducted_; }
  /// The point of a body with the given identity; `hint` is where it was last.
  [[nodiscard]] Place find(int body, long identity, Place hint = {}) const;
  /// The point of a body nearest to x [m]: its identity, or -1 for an empty body.
  [[nodiscard]] long nearest(int body, Vec3 const& x) const;
  /// Bytes of points and nodes.
  [[nodiscard]] std::size_t bytes() const;
  /// Wall-clock seconds per pass.
  [[nodiscard]] std::map<std::string, double> const& timings() const { return timings_; }
  void archive(Archive& a);  ///< in a checkpoint, see state.cpp

 private:
  struct Workspace;

  /// Forces of a unit of a pressure [m2] on the points of its body: per block and point.
  [[nodiscard]] std::vector<std::vector<Vec3>> pushes(SurfacePressure const& pressure) const;

  /// Has the block points of the body beside the axis, see `BesideAxis::even_out`?
  [[nodiscard]] bool evens_out(int block, int body) const;
  void map_even_again();
  /// What is even beside the axis, at the nodes of a block: the points' means, or (`again`) those made sharper.
  Lanes4* gather_even(int block, int body, Scratch& scratch, bool again) const;
  /// Calls work(set, body) for the sets of a block that hold points, those lent to it included.
  template <class Work>
  void for_sets(int block, Work&& work) {
    for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
      PointSet& set = points(block, body);
      if (!set.empty()) work(set, body);
    }
    if (lent_body_ >= 0 && !lent_[block].empty()) work(lent_[block], lent_body_);
  }
  [[nodiscard]] int set_index(int block, int body) const { return block * static_cast<int>(bodies_.size()) + body; }
  void find_active();
  void carry(int body, Field first, int components);  ///< further fields, 0 at the start
  void collect_signals();
  void map_to_grid(bool with_mass, bool with_forces);
  [[nodiscard]] OuterForces outer_forces() const;
  void map_extents();
  void filter();
  void integrate(double dt);
  void update_stress(double dt);
  void conduct();
  void share_momentum(int block, Scratch& scratch) const;
  [[nodiscard]] bool affine(int body) const;
  void migrate();
  void sort(PointSet& set, int block, std::vector<int>& order) const;

  // One block at a time, in a thread's scratch.
  void clear_velocity(int block);
  void continue_behind_ends(int block);
  Lanes4* area_nodes(int block, int body);
  Lanes4* filled_nodes(int block);
  void share_pressure(int block, double dt, Scratch& scratch) const;
  static void settle_pushes(Scratch& scratch);
  void note_changes(Scratch& scratch, int count) const;
  void gather_gradients(int block, Scratch& scratch) const;
  void gather_extents(int block, Scratch& scratch) const;
  void gather_velocity(int block, Scratch& scratch, bool scalars = false) const;
  void velocity_from_state(int block, Scratch& scratch) const;
  void constrain_velocity(int block, double dt, Scratch& scratch) const;
  void constrain_state(int block, double dt, Scratch& scratch);
  // Walls, see walls.cpp.
  void map_gaps(int block);
  void gather_gaps(int block, int field, Scratch& scratch) const;
  void stop_at_walls(int block, double dt, Scratch& scratch, Given& given);
  void stop_velocity_at_walls(int block, double dt, Scratch& scratch) const;
  void weigh_images(int block, Scratch& scratch, bool of_state) const;
  void mirror_fluids(int block, Scratch& scratch, bool of_state) const;
  void collect_gifts(int block, double dt, Scratch const& scratch);
  void release(int count, Scratch& scratch) const;
  // Contact, see contact.cpp.
  void find_meetings(int block, double dt, Scratch& scratch, bool with_forces) const;
  template <class Trial>
  void find_meetings(int block, double dt, Scratch& scratch, Trial&& trial) const;
  [[nodiscard]] Partner partner(int block, int field, int node, double dt, Scratch const& scratch) const;
  void clear_contacts(int block, Scratch& scratch) const;
  void weigh_meetings(int block, Scratch const& scratch) const;
  void meet(int block, Scratch& scratch, Given& given) const;
  void book(int block, Meeting const& meeting, double impulse, Vec3 const& rubbed, Given& given) const;
  void meet_velocity(int block, Scratch& scratch) const;
  void update_set(int block, int body, Hoops const& hoops, double dt, Scratch& scratch);
  [[nodiscard]] StressOrder order_of(int body) const;
  /// What a body's signals count in the step: 1 at the Courant number of the options.
  [[nodiscard]] double signal_weight(int body) const {
    return options_.courant / bodies_[body].courant.value_or(options_.courant);
  }
  [[nodiscard]] double work_on(int block, int body, OuterForces const& outer) const;

  grid::Grid grid_;
  Options options_;
  std::vector<Body> bodies_;
  std::vector<PointSet> sets_;  ///< block by block, body by body
  std::vector<PointSet> lent_;  ///< per block
  int lent_body_ = -1;
  std::vector<std::vector<NodeGift>> gifts_;  ///< per block
  std::vector<long> next_identity_;
  Losses losses_;
  Vec3 constraint_impulse_{0.0, 0.0, 0.0};
  double outer_work_ = 0.0;
  Dissipation dissipation_;
  FloorCount floored_;
  ConductionCount conducted_;
  double fastest_ = 0.0;  ///< fastest signal of all points, weighted [m/s]
  double time_ = 0.0;
  long step_ = 0;
  std::map<std::string, double> timings_;
  std::vector<int> active_;      ///< blocks that hold points
  std::vector<double> signals_;  ///< fastest signal per block, weighted [m/s]
  std::unique_ptr<Workspace> work_;
};

}  // namespace brisance::mpm
