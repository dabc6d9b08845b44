/// What `Mpm` needs beside its points: patches, the nodes' records, constraints, and scratch per thread.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "core/buffer.hpp"
#include "mpm/kernels.hpp"
#include "mpm/mpm.hpp"
#include "mpm/patches.hpp"

namespace brisance::mpm {

/// A node whose velocity is prescribed.
struct Hold {
  int node = 0;
  int field = -1;  ///< grid field; -1: all
  std::array<bool, 3> held{true, true, true};
  Vec3 velocity{0.0, 0.0, 0.0};
};

/// Part of a face of the domain that is a `wall`, within reach of a block's nodes. It is one-sided for bodies: their
/// fields have no images behind it, and the nodes are stopped where they would go through it.
struct WallFace {
  int number = 0;     ///< of the face of the domain: 2 d + side
  int direction = 0;  ///< d, across it
  int inwards = 1;    ///< 1 or -1: into the domain
  int plane = 0;      ///< storage index along d of the nodes on it
};

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

/// Law between two grid fields.
struct Law {
  enum class Kind {
    glued,    ///< one velocity
    contact,  ///< they part and slide
    slips,    ///< one velocity across the surface of that which does not slip
  };
  Kind kind = Kind::glued;
  double friction = 0.0;
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
  double friction = 0.0;  ///< what it lost by work of those who rub, where the points do not lose it
};

/// What a fluid that slips took from a body at a node in a step, by its pressure or where it meets the body.
struct Push {
  int fluid = 0;  ///< fields
  int body = 0;
  int node = 0;
  Vec3 impulse{0.0, 0.0, 0.0};  ///< [kg m/s]
  bool shared = false;          ///< contact shares it among the bodies
};

/// What one thread needs while it works on one block: the summed nodes of each grid field.
struct Scratch {
  std::vector<NodeArray<NodeState>> state;
  std::vector<NodeArray<NodeVelocity>> velocity;
  std::vector<NodeArray<NodeVelocity>> before;  ///< the same at the start of the step
  /// Part of the cells around a node that a field fills, and h times its gradient: contact.
  std::vector<NodeArray<NodeVelocity>> gradient;
  std::vector<NodeArray<NodeVelocity>> area;      ///< see `Mpm::share_pressure`
  Given pressed;                                  ///< what rigid bodies gave to the fluids that press on them
  std::vector<Push> pushes;                       ///< see `Mpm::settle_pushes`
  std::vector<NodeArray<NodeVelocity>> exchange;  ///< velocity that bodies without APIC take over at shared nodes
  std::vector<char> exchanges;
  std::vector<NodeArray<NodeVelocity>> halt;  ///< change of velocity from the start of the step by constraints
  std::vector<char> halts;
  std::vector<NodeArray<NodeVelocity>> meet;  ///< change of velocity by contact, across the surfaces
  std::vector<char> meets;
  std::vector<NodeArray<NodeVelocity>> rub;  ///< and along them, by friction, that on walls as well
  std::vector<char> rubs;                    ///< where `meets`, and where walls rub
  /// By what the velocity that the points take over differs from that with which the nodes move, see contact.cpp.
  std::vector<NodeArray<NodeVelocity>> keep;
  std::vector<Vec3> trial;  ///< contact: velocities of all fields at a node
  /// Contact: of the meetings at a node, see `Mpm::meet`.
  std::vector<double> stopping;
  std::vector<double> pushing;
  std::vector<double> matrix;
  std::vector<NodeArray<NodeVelocity>> stop;  ///< change of velocity by walls, across them
  std::vector<char> stops;
  /// See `Mpm::note_changes`.
  std::vector<NodeArray<NodeVelocity>> middle;
  std::vector<NodeArray<NodeVelocity>> forced;
  std::vector<NodeArray<NodeVelocity>> changed;
  std::vector<NodeArray<double>> gap;    ///< see `Workspace::gap`
  std::vector<NodeArray<double>> whole;  ///< mass of the nodes with the images behind walls, where fluids slip along it
  std::vector<char> wholes;
  std::vector<NodeArray<double>> extent;  ///< contact
  NodeArray<NodeVelocity> filled;         ///< what all points fill of the cells around the nodes
  NodeArray<NodeVelocity> even;           ///< of a body, see `Mpm::gather_even`
  NodeArray<NodeVelocity> even_again;
  std::vector<Vec3> normals;  ///< contact, of one field
  std::vector<char> present;
  std::vector<double> strain;     ///< locking control: strain and spin of a whole set
  std::vector<double> cell_sums;  ///< locking control: volume and volume change per cell
  std::vector<int> order;
};

struct Outbox {
  PointSet points;
  std::vector<int> destination;  ///< block of each point
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

struct Mpm::Workspace {
  std::vector<Patch> patches;
  int fields = 1;
  std::vector<int> field_of;                   ///< body -> grid field
  std::vector<std::optional<Vec3>> rigid;      ///< velocity of rigid grid fields
  std::vector<Law> laws;                       ///< field x field
  std::vector<char> slips;                     ///< per field: of the bodies that slip
  bool contact = false;                        ///< more than one field
  bool slides = false;                         ///< some fields slip along others
  bool touches = false;                        ///< some fields part and slide
  bool pushes = false;                         ///< some bodies are rigid: somebody wants to know what they give
  std::vector<char> parts;                     ///< per field: parts from some other
  std::vector<std::vector<Meeting>> meetings;  ///< per block, those at a node one after another
  bool filters = false;                        ///< some body uses XPIC
  bool maps_back = false;                      ///< some body is updated by MUSL
  bool strains_early = false;                  ///< some body is updated by USL
  bool conducts = false;                       ///< some body conducts heat in shocks
  std::vector<char> shocked;                   ///< per block: there is a shock in it
  bool books_work = false;                     ///< some body does, see `Mpm::books_work`
  bool keeps_energy = false;                   ///< some body's transfer loses no energy
  bool counts_energy = false;                  ///< some body has APIC
  std::vector<std::vector<Hold>> holds;        ///< per block
  std::vector<std::vector<char>> has_hold;     ///< per block and node, where bodies part and slide
  std::vector<NodeArray<NodeState>> state;     ///< block x field, as the points wrote them
  std::vector<NodeArray<NodeVelocity>> velocity;
  std::vector<NodeArray<NodeVelocity>> gradient;
  std::vector<NodeArray<NodeVelocity>> area;  ///< of bodies their area, of fluids that slip along them their pressure
  std::vector<char> area_present;
  std::vector<NodeArray<double>> extent;
  /// What all points fill of the cells around the nodes: block x field, of the field of a body that fills space only.
  std::vector<NodeArray<NodeVelocity>> filled;
  std::vector<char> filled_present;
  /// What the points beside the axis have in common with their neighbours: block x body, see `BesideAxis::even_out`.
  std::vector<NodeArray<NodeVelocity>> even;
  std::vector<NodeArray<NodeVelocity>> even_again;
  std::vector<char> even_present;
  int filling = -1;                        ///< that field; -1: none
  std::vector<NodeArray<NodeState>> lent;  ///< per block: what its lent points alone wrote
  std::vector<char> present;               ///< block x field: were written in this step
  /// Fields that bodies with APIC share with others, and what those others alone gave the nodes: see `share_momentum`.
  std::vector<char> shared;                       ///< per field
  std::vector<char> affine;                       ///< per field: some body has APIC
  std::vector<char> heats;                        ///< per field: what APIC loses is heat, see `Mpm::keeps_energy`
  std::vector<NodeArray<NodeVelocity>> momentum;  ///< block x field
  std::vector<char> momentum_present;
  std::vector<Scratch> scratch;              ///< per thread
  std::vector<Outbox> outbox;                ///< block x body
  std::vector<std::array<int, 27>> around;   ///< blocks around each block
  std::vector<std::vector<WallFace>> walls;  ///< per block
  std::vector<char> one_sided;               ///< per field: its bodies are free to leave walls
  bool stops = false;                        ///< there are walls and such fields
  /// Distance of the surface of a field's points from each of the block's walls, at the nodes on it: block x field.
  std::vector<NodeArray<double>> gap;
  std::vector<char> gap_present;
  std::vector<std::vector<char>> stopped;  ///< block x field, wall by wall: bit k of a node on it: those k cells off
  std::vector<double> work;                ///< per block: of outer forces in this step
  std::vector<Dissipation> dissipation;    ///< per block: in this step
  std::vector<FloorCount> floored;         ///< likewise
  std::vector<ConductionCount> conducted;  ///< likewise
  std::vector<Vec3> impulse;               ///< per block: of holds in this step
  std::vector<Losses> lost;                ///< per block
  std::vector<std::string> trouble;        ///< per block: what went wrong
  std::vector<ActiveLoad> loads;
  std::vector<PopulationScratch> population;               ///< per thread
  std::vector<PopulationCount> population_of_block;        ///< in this call
  double mass_floor = std::numeric_limits<double>::min();  ///< nodes below it are empty [kg]

  [[nodiscard]] int slot(int block, int field) const { return block * fields + field; }
  /// Mass that the points of a block gave to a node [kg]. What happens to nodes is booked with it, block by block: so
  /// copies of a node in several blocks, and behind mirrors, count once, for the points that feel it.
  [[nodiscard]] double own_mass(int block, int field, int node) const {
    int const at = slot(block, field);
    return present[at] != 0 ? state[at].data()[node].momentum[3] : 0.0;
  }

  /// Do all points of a field take over the nodes' velocity, and is what they lose by that counted, and no heat?
  [[nodiscard]] bool taken_over(int field) const {
    return affine[field] != 0 && shared[field] == 0 && heats[field] == 0;
  }

  [[nodiscard]] bool slips_along(int fluid, int body) const {
    return laws[fluid * fields + body].kind == Law::Kind::slips && slips[fluid] != 0;
  }
  /// Constraints hold bodies; what slips along these need not be held.
  [[nodiscard]] bool held(int field, Hold const& hold) const {
    return hold.field < 0 ? slips[field] == 0 : hold.field == field;
  }

  /// Sums what the points of all blocks around wrote for the nodes of a block. False, and nothing done, where the field
  /// has no points there.
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
