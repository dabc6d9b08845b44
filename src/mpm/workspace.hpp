/// What `Mpm` needs beside its particles: patches, the nodes' records, constraints, and scratch per thread.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "core/buffer.hpp"
#include "mpm/grid_fields.hpp"
#include "mpm/kernels.hpp"
#include "mpm/mpm.hpp"
#include "mpm/patches.hpp"

namespace brisance::mpm {

/// Part of a face of the domain that is a `wall`, within reach of a block's nodes. It is one-sided for bodies: their
/// fields have no images behind it, and the nodes are stopped where they would go through it.
struct WallFace {
  int number = 0;     ///< of the face of the domain: 2 d + side
  int direction = 0;  ///< d, across it
  int inwards = 1;    ///< 1 or -1: into the domain
  int plane = 0;      ///< storage index along d of the nodes on it
};

/// Gap at nodes on a wall that no particle touches [m].
inline constexpr double no_gap = std::numeric_limits<double>::max();

/// Records of nodes, allocated when they are first needed.
template <class Record>
class NodeArray {
 public:
  Record* get(int count) {
    auto const wanted = static_cast<std::size_t>(count) * sizeof(Record) / sizeof(double);
    if (buffer_.size() < wanted) buffer_ = Buffer(wanted);
    return reinterpret_cast<Record*>(buffer_.data());
  }
  [[nodiscard]] Record* data() { return reinterpret_cast<Record*>(buffer_.data()); }
  [[nodiscard]] Record const* data() const { return reinterpret_cast<Record const*>(buffer_.data()); }
  [[nodiscard]] std::size_t bytes() const { return buffer_.size() * sizeof(double); }

 private:
  Buffer buffer_;
};

/// Which of the stresses yy and zz act around the axis: the radial force is -(sum of them)/r.
struct Hoops {
  double yy = 0.0;
  double zz = 0.0;
  [[nodiscard]] bool any() const { return yy + zz > 0.0; }
};

/// One of two bodies at a node where their surfaces touch.
struct Partner {
  int field = 0;
  double mass = 0.0;  ///< at the node [kg]
  /// Change of its velocity per impulse, in the directions of the axes [1/kg]: 1/mass, and 0 where something prescribes
  /// the velocity.
  Vec3 yields{0.0, 0.0, 0.0};
  Vec3 prescribed{0.0, 0.0, 0.0};  ///< the velocity where `yields` is 0 [m/s]
};

/// Two bodies whose surfaces touch at a node and close in on each other.
struct Meeting {
  int node = 0;
  Partner first;
  Partner second;
  double friction = 0.0;
  Vec3 normal{0.0, 0.0, 0.0};  ///< from the first to the second
  double slack = 0.0;          ///< beside what the two yield [1/kg], see `Mpm::find_meetings`

  /// Change of the relative velocity along a direction per impulse along it [1/kg].
  [[nodiscard]] double yields(Vec3 const& along) const {
    double sum = slack;
    for (int d = 0; d < 3; ++d) sum += along[d] * along[d] * (first.yields[d] + second.yields[d]);
    return sum;
  }
};

/// Momentum that was given to nodes, and the work that it did.
struct Given {
  Vec3 impulse{0.0, 0.0, 0.0};
  double work = 0.0;
  double drive = 0.0;  ///< work of the constraints if they had stopped the nodes alone, without the forces of the step
  double friction = 0.0;  ///< what it lost by work of those who rub, where the particles do not lose it
};

/// What a fluid that slips took from a body at a node in a step, by its pressure or where it meets the body.
struct Push {
  int fluid = 0;  ///< fields
  int body = 0;
  int node = 0;
  Vec3 impulse{0.0, 0.0, 0.0};  ///< [kg m/s]
  bool shared = false;          ///< contact shares it among the bodies
};

/// The nodes of one block and one grid field, in the scratch of a thread. What a flag stands for is there where it is
/// set.
struct FieldScratch {
  bool present = false;           ///< some particles around the block belong to the field
  NodeArray<NodeSums> sums;       ///< of what the particles of all blocks around wrote
  NodeArray<NodeMotion> motion;   ///< what follows from it
  NodeArray<NodeVelocity> taken;  ///< see `Mpm::find_taken`: velocity with kinetic energy per mass
  NodeArray<NodeVelocity> velocity;
  NodeArray<NodeVelocity> before;  ///< the same at the start of the step
  NodeArray<NodeVelocity>
      gradient;                  ///< fraction of the cells around a node that a field fills, and h times its gradient
  NodeArray<NodeVelocity> area;  ///< see `Mpm::share_pressure`
  NodeArray<double> gap;         ///< see `Workspace::gap`
  NodeArray<double> extent;      ///< contact
  /// Mass of the nodes with the images behind walls, where fluids slip along it.
  bool wholes = false;
  NodeArray<double> whole;
  /// Velocity that bodies without APIC take over at shared nodes.
  bool exchanges = false;
  NodeArray<NodeVelocity> exchange;
  /// Change of velocity by constraints, and by walls across them, each from the start of the step.
  bool halts = false;
  NodeArray<NodeVelocity> halt;
  bool stops = false;
  NodeArray<NodeVelocity> stop;
  /// Change of velocity by contact across the surfaces, and by what the velocity that particles keep differs from that
  /// with which the nodes move, see contact.cpp.
  bool meets = false;
  NodeArray<NodeVelocity> meet;
  NodeArray<NodeVelocity> keep;
  /// Change of velocity by friction, of contacts and walls.
  bool rubs = false;
  NodeArray<NodeVelocity> rub;
  /// See `Mpm::note_changes`.
  NodeArray<NodeVelocity> middle;
  NodeArray<NodeVelocity> forced;
  NodeArray<NodeVelocity> changed;
};

/// What one thread needs while it works on one block.
struct Scratch {
  std::vector<FieldScratch> of;    ///< grid fields
  Given pressed;                   ///< what rigid bodies gave to the fluids that press on them
  std::vector<Push> pushes;        ///< see `Mpm::settle_pushes`
  std::vector<char> reached;       ///< see `Mpm::find_reached`
  NodeArray<NodeVelocity> filled;  ///< what all particles fill of the cells around the nodes
  NodeArray<NodeVelocity> even;    ///< of a body, see `Mpm::gather_even`
  NodeArray<NodeVelocity> even_again;
  std::vector<Vec3> normals;  ///< contact, of one field
  std::vector<Vec3> trial;    ///< contact: velocities of all fields at a node
  /// Contact: of the meetings at a node, see `Mpm::meet`.
  std::vector<double> stopping;
  std::vector<double> pushing;
  std::vector<double> matrix;
  std::vector<double> strain;     ///< locking control: strain and spin of a whole set
  std::vector<double> cell_sums;  ///< locking control: volume and volume change per cell
  std::vector<int> order;
};

struct Outbox {
  ParticleSet particles;
  std::vector<int> destination;  ///< block of each particle
};

/// A constraint that moves by a history.
struct Driver {
  MotionHistory history;
  Vec3 direction{0.0, 0.0, 0.0};
  bool released = false;
};

/// A surface pressure that acts, or several on the same points, at an edge of a body for one.
struct ActiveLoad {
  /// One of several: its index, and the force per volume of a unit of its pressure [1/m].
  struct Part {
    int load = 0;
    Vec3 direction{0.0, 0.0, 0.0};
    bool operator==(Part const&) const = default;
  };
  int body = 0;
  std::vector<double> times;
  std::vector<double> pressures;
  std::vector<Part> parts;  ///< empty: a pressure with times of its own
};

struct Mpm::Workspace : GridFields {
  std::vector<Patch> patches;
  std::vector<std::vector<Meeting>> meetings;                   ///< per block, those at a node one after another
  std::vector<char> shocked;                                    ///< per block: there is a shock in it
  std::vector<std::vector<ConstrainedNode>> constrained_nodes;  ///< per block
  std::vector<std::vector<char>> is_constrained;                ///< per block and node, where bodies part and slide
  std::vector<NodeArray<NodeSums>> state;                       ///< block x field, as the particles wrote them
  std::vector<NodeArray<NodeVelocity>> velocity;
  std::vector<NodeArray<NodeVelocity>> gradient;
  std::vector<NodeArray<NodeVelocity>> area;  ///< of bodies their area, of fluids that slip along them their pressure
  std::vector<char> area_present;
  std::vector<NodeArray<double>> extent;
  /// What all particles fill of the cells around the nodes: block x field, of the field of a body that fills space
  /// only.
  std::vector<NodeArray<NodeVelocity>> filled;
  std::vector<char> filled_present;
  /// What the particles beside the axis have in common with their neighbours: block x body, see `BesideAxis::even_out`.
  std::vector<NodeArray<NodeVelocity>> even;
  std::vector<NodeArray<NodeVelocity>> even_again;
  std::vector<char> even_present;
  std::vector<NodeArray<NodeSums>> by_proxies;  ///< per block: what its proxy particles alone wrote
  std::vector<char> present;                    ///< block x field: were written in this step
  /// What bodies without APIC alone gave the nodes of fields that they share with others: see `share_momentum`.
  std::vector<NodeArray<NodeVelocity>> momentum;  ///< block x field
  std::vector<char> momentum_present;
  std::vector<Scratch> scratch;              ///< per thread
  std::vector<Outbox> outbox;                ///< block x body
  std::vector<std::array<int, 27>> around;   ///< blocks around each block
  std::vector<std::vector<WallFace>> walls;  ///< per block
  /// Distance of the surface of a field's particles from each of the block's walls, at the nodes on it: block x field.
  std::vector<NodeArray<double>> gap;
  std::vector<char> gap_present;
  std::vector<std::vector<char>> stopped;  ///< block x field, wall by wall: bit k of a node on it: those k cells off
  std::vector<double> work;                ///< per block: of outer forces in this step
  std::vector<Dissipation> dissipation;    ///< per block: in this step
  std::vector<double> damped;              ///< per block: kinetic energy that damping takes in this step [J]
  std::vector<FloorCount> floored;         ///< likewise
  std::vector<ConductionCount> conducted;  ///< likewise
  std::vector<Vec3> impulse;               ///< per block: of constraints in this step
  std::vector<Losses> lost;                ///< per block
  std::vector<std::string> trouble;        ///< per block: what went wrong
  std::vector<ActiveLoad> loads;
  std::vector<Driver> drivers;
  std::vector<PopulationScratch> population;               ///< per thread
  std::vector<PopulationCount> population_of_block;        ///< in this call
  double mass_floor = std::numeric_limits<double>::min();  ///< nodes below it are empty [kg]

  [[nodiscard]] int slot(int block, int field) const { return block * fields + field; }
  /// Mass that the particles of a block gave to a node [kg]. What happens to nodes is booked with it, block by block:
  /// so copies of a node in several blocks, and behind mirrors, count once, for the particles that feel it.
  [[nodiscard]] double own_mass(int block, int field, int node) const {
    int const at = slot(block, field);
    return present[at] != 0 ? state[at].data()[node].momentum[3] : 0.0;
  }

  /// Sums what the particles of all blocks around wrote for the nodes of a block. False, and nothing done, where the
  /// field has no particles there.
  template <class Record>
  bool gather(std::vector<NodeArray<Record>> const& raw, int block, int field, NodeArray<Record>& sum,
              bool scalars = false) const {
    return gather(raw, present, block, field, sum, scalars);
  }
  template <class Record>
  bool gather(std::vector<NodeArray<Record>> const& raw, std::vector<char> const& written, int block, int field,
              NodeArray<Record>& sum, bool scalars = false, bool behind_walls = true) const {
    Patch const& patch = patches[block];
    auto const is_present = [&](Link const& link) {
      return (behind_walls || !link.wall) && written[slot(link.source, field)] != 0;
    };
    if (!std::any_of(patch.links.begin(), patch.links.end(), is_present)) return false;
    sum_links(
        patch, sum.get(patch.count()),
        [&](int source) {
          int const from = slot(source, field);
          return written[from] == 0 ? nullptr : raw[from].data();
        },
        scalars, behind_walls);
    return true;
  }
  /// The same for what moves: masses, momenta, velocities, forces. Bodies have no images behind walls.
  template <class Record>
  bool gather_moving(std::vector<NodeArray<Record>> const& raw, std::vector<char> const& written, int block, int field,
                     NodeArray<Record>& sum, bool scalars = false) const {
    return gather(raw, written, block, field, sum, scalars, one_sided[field] == 0);
  }
};

}  // namespace brisance::mpm
