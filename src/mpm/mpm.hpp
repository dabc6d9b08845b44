/// The material point method, [Cui14] Sec. 2.2: bodies of particles that move through a background grid on which the
/// momentum equation is solved.
///
/// One step, `advance`, is four passes over the blocks. Within a pass a block writes only what belongs to it:
///     map_to_grid       Eqs. (18)-(21)   mass, momentum and forces of the points to their block's patch
///     integrate         Eqs. (22)-(26)   sum of the patches, new velocity of the nodes, motion of the particles, and
///                                        their velocity mapped back
///     update_stress     Eqs. (27)-(30)   strain, spin, density, stress, energy
///     migrate                            particles that left their block move to the next
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/lanes.hpp"
#include "grid/block_store.hpp"
#include "grid/grid.hpp"
#include "mpm/accounts.hpp"
#include "mpm/model.hpp"
#include "mpm/particles.hpp"
#include "mpm/population.hpp"
#include "mpm/proxy_particles.hpp"

namespace brisance::mpm {

struct Given;
struct Scratch;
struct Meeting;
struct Partner;
struct Hoops;
struct Mapping;
struct OuterForces;
struct FieldScratch;
class WallStops;

class Mpm {
 public:
  /// Throws InputError where bodies, contacts or constraints contradict each other.
  Mpm(grid::Domain const& domain, std::vector<Body> bodies, Options const& options,
      std::vector<Constraint> const& constraints = {}, std::vector<Contact> const& contacts = {});
  ~Mpm();
  Mpm(Mpm const&) = delete;
  Mpm& operator=(Mpm const&) = delete;

  /// Adds points to a body. Particles outside the domain are refused (InputError).
  void fill(int body, Filling const& filling);
  /// Lets a pressure act on the particles that lie within it now.
  void load(SurfacePressure const& pressure);
  /// Smears a bar over the particles around its axis where they are now; particles that have one already keep it.
  /// Throws InputError where the bar does not lie within the body.
  BarReport reinforce(Bar const& bar);
  /// Tells where in time the simulation stands [s]; the burn and the loads depend on it.
  void set_time(double time) { time_ = time; }
  /// See `Body::reference_pressure`.
  void set_reference_pressure(int body, double pressure) { bodies_[body].reference_pressure = pressure; }

  /// Proxy particles, which somebody else owns.
  [[nodiscard]] ProxyParticles& proxies() { return proxies_; }
  /// Adds copies of particles with the fields of the body where they lie, or all to one block; they get new identities.
  /// Their signals do not yet count in `stable_step`: `update_signals` or the next step sees to that.
  void add(int body, ParticleSet const& particles, std::optional<int> block = std::nullopt);
  /// Finds the fastest signal of the particles anew.
  void update_signals();

  /// Largest stable step [s] at the bodies' Courant numbers: the least of courant h / (sound speed + speed).
  [[nodiscard]] double stable_step() const;
  /// One step. Throws NumericalError when a particle's state has lost its meaning.
  void advance(double dt);
  /// Splits and merges the particles of a gas where that is due; to be called between steps: every 4 where the gas runs
  /// into a vacuum, else every 8 will do. The sums of `sums` stay as they are up to round-off, but for the number of
  /// particles and for kinetic energy that becomes internal. Of two merged particles the heavier keeps its identity.
  /// Throws InputError for a body that is no gas.
  PopulationCount control_population(int body, PopulationOptions const& options = {});

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] grid::Grid const& grid() const { return grid_; }
  [[nodiscard]] Options const& options() const { return options_; }
  [[nodiscard]] std::vector<Body> const& bodies() const { return bodies_; }
  [[nodiscard]] ParticleSet const& particles(int block, int body) const { return sets_[block][body]; }
  [[nodiscard]] ParticleSet& particles(int block, int body) { return sets_[block][body]; }
  [[nodiscard]] Accounts const& accounts() const { return accounts_; }  ///< what was booked since the start
  /// Wall-clock seconds per pass.
  [[nodiscard]] std::map<std::string, double> const& timings() const { return timings_; }
  void archive(Archive& a);  ///< in a checkpoint, see state.cpp

 private:
  struct Workspace;
  friend std::size_t bytes(Mpm const& mpm);

  /// Forces of a unit of a pressure [m2] on the particles of its body: per block and particle.
  [[nodiscard]] std::vector<std::vector<Vec3>> pushes(SurfacePressure const& pressure) const;

  /// Has the block particles of the body beside the axis, see `BesideAxis::even_out`?
  [[nodiscard]] bool evens_out(int block, int body) const;
  void map_even_again();
  /// What is even beside the axis, at the nodes of a block: the particles' means, or (`again`) those made sharper.
  Lanes4* gather_even(int block, int body, Scratch& scratch, bool again) const;
  /// Calls work(set, body) for the sets of a block that hold particles, proxies included.
  template <class Work>
  void for_sets(int block, Work&& work) {
    for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
      ParticleSet& set = particles(block, body);
      if (!set.empty()) work(set, body);
    }
    if (proxies_.any(block)) work(proxies_.particles(block), proxies_.body());
  }
  [[nodiscard]] int set_index(int block, int body) const { return block * static_cast<int>(bodies_.size()) + body; }
  void find_active();
  void take_proxies();
  void carry(int body, Field first, int components);  ///< further fields, 0 at the start
  void collect_signals();
  void damp(double dt);
  void prescribe(double dt);
  void map_to_grid(bool with_mass, bool with_forces);
  void map_set(int block, ParticleSet& set, int body, Mapping const& mapping, Scratch& scratch);
  void map_surroundings(int block, ParticleSet& set, int body, Mapping const& mapping);
  [[nodiscard]] OuterForces outer_forces() const;
  void map_extents();
  void filter();
  void integrate(double dt);
  void prepare_scratch();
  void update_stress(double dt);
  void conduct();
  void share_momentum(int block, Scratch& scratch) const;
  void migrate();
  void send_off(int block, int body, std::vector<int>& stay);
  void book_block(int block);
  bool take_in();
  void sort(ParticleSet& set, int block, std::vector<int>& order) const;

  // One block at a time, in a thread's scratch.
  void clear_velocity(int block);
  void continue_behind_ends(int block);
  Lanes4* area_nodes(int block, int body);
  Lanes4* filled_nodes(int block);
  void share_pressure(int block, double dt, Scratch& scratch) const;
  static void settle_pushes(Scratch& scratch);
  void gather_sums(int block, Scratch& scratch) const;
  void find_velocity(int block, double dt, Scratch& scratch) const;
  void find_taken(int block, double dt, Scratch& scratch) const;
  void find_reached(int block, Scratch& scratch) const;
  void note_changes(int block, Scratch& scratch) const;
  void move_particles(int block, double dt, Hoops const& hoops, OuterForces const& outer, Scratch& scratch);
  void strain_with_motion(int block, Hoops const& hoops, double dt, Scratch& scratch);
  void gather_gradients(int block, Scratch& scratch) const;
  void gather_extents(int block, Scratch& scratch) const;
  void gather_velocity(int block, Scratch& scratch, bool scalars = false) const;
  void find_old_velocity(int block, Scratch& scratch) const;
  void constrain_velocity(int block, double dt, Scratch& scratch) const;
  void constrain_motion(int block, double dt, Scratch& scratch);
  void share_velocity(int block, Scratch& scratch, Given& given);
  void constrain_nodes(int block, Scratch& scratch, Given& given);
  void note_rubbing(int count, Scratch& scratch) const;
  // Walls, see wall_gaps.cpp, walls.cpp and wall_images.cpp.
  void map_gaps(int block);
  void gather_gaps(int block, int field, Scratch& scratch) const;
  void gather_gaps(int block, Scratch& scratch) const;
  void stop_at_walls(int block, double dt, Scratch& scratch, Given& given);
  void stop_at_wall(int block, int field, std::size_t number, double dt, FieldScratch const& s, WallStops& stops);
  void stop_velocity_at_walls(int block, double dt, Scratch& scratch) const;
  void weigh_images(int block, Scratch& scratch, bool of_state) const;
  void mirror_fluids(int block, Scratch& scratch, bool of_state) const;
  void collect_gifts(int block, double dt, Scratch const& scratch);
  // Contact, see meetings.cpp and contact.cpp.
  void find_meetings(int block, double dt, Scratch& scratch, bool from_sums) const;
  template <class Trial>
  void find_meetings(int block, double dt, Scratch& scratch, Trial&& trial) const;
  void find_meeting(int block, double dt, int node, int a, int b, std::size_t first_here, Scratch& scratch) const;
  [[nodiscard]] Partner partner(int block, int field, int node, double dt, Scratch const& scratch) const;
  void clear_contacts(int block, Scratch& scratch) const;
  void weigh_meetings(int block, Scratch const& scratch) const;
  void meet(int block, Scratch& scratch, Given& given) const;
  void book(int block, Meeting const& meeting, double impulse, Vec3 const& rubbed, Given& given) const;
  void meet_velocity(int block, Scratch& scratch) const;
  void update_set(int block, int body, Hoops const& hoops, double dt, Scratch& scratch);
  /// What a body's signals count in the step: 1 at the Courant number of the options.
  [[nodiscard]] double signal_weight(int body) const {
    return options_.courant_number() / bodies_[body].courant.value_or(options_.courant_number());
  }
  [[nodiscard]] double work_on(int block, int body, OuterForces const& outer) const;

  grid::Grid grid_;
  Options options_;
  std::vector<Body> bodies_;
  std::vector<BodyRules> rules_;                     ///< body by body
  std::vector<FieldList> carried_;                   ///< per body
  grid::BlockStore<std::vector<ParticleSet>> sets_;  ///< body by body
  ProxyParticles proxies_;
  std::vector<long> next_identity_;
  Accounts accounts_;
  double fastest_ = 0.0;  ///< fastest signal of all particles, weighted [m/s]
  double time_ = 0.0;
  long step_ = 0;
  std::map<std::string, double> timings_;
  std::vector<int> active_;      ///< blocks that hold particles
  std::vector<double> signals_;  ///< fastest signal per block, weighted [m/s]
  std::unique_ptr<Workspace> work_;
};

/// Which fields the particles of a body carry.
[[nodiscard]] inline FieldList const& fields(Mpm const& mpm, int body) { return mpm.particles(0, body).fields(); }

/// What the particles of a body come to: sums in a fixed order.
[[nodiscard]] BodySums sums(Mpm const& mpm, int body);
/// Its mass alone [kg].
[[nodiscard]] double mass(Mpm const& mpm, int body);
[[nodiscard]] long particle_count(Mpm const& mpm);
/// Bytes of particles and nodes.
[[nodiscard]] std::size_t bytes(Mpm const& mpm);
/// Lowest pressure of the particles of a body, proxies included [Pa]; infinite where it has none.
[[nodiscard]] double lowest_pressure(Mpm& mpm, int body);
/// The particle of a body with the given identity; `hint` is where it was last.
[[nodiscard]] Place find(Mpm const& mpm, int body, long identity, Place hint = {});
/// The particle of a body nearest to x [m]: its identity, or -1 for an empty body.
[[nodiscard]] long nearest(Mpm const& mpm, int body, Vec3 const& x);

/// Gives the particles of a burning body their lighting times [s].
void set_lighting(Mpm& mpm, int body, std::function<double(Vec3 const&)> const& lighting_time);
/// Takes the particles for which `outside(set, q)` holds out of a set, in their order, and appends them to `to`.
void take_out(ParticleSet& set, std::function<bool(ParticleSet const& set, int q)> const& outside, ParticleSet& to);
/// Makes the particles of an explosive that have burnt particles of a gas, whose second fluid their products are. They
/// get new identities. Returns how many there were.
long hand_over_burnt(Mpm& mpm, int explosive, int gas);

}  // namespace brisance::mpm
