/// The bridge between gas cells and material points, [Cui14] Sec. 3. `Bridge` sees only the public state of both.
///
/// Ghost cells of the gas inside the region come from the points, Eqs. (31)-(36); nodes at the region's surface take
/// part of their mass, momentum and force from gas cells outside, Eqs. (37)-(39), which act as points for a step; and
/// what flows through the surface is handed over, Sec. 3.4, by a ledger.
///
/// The ledger. The gas moves mass through the surface of the region by its fluxes. Each face, cut into lanes, keeps an
/// account of what the gas gave to the region, less what the region took: it grows by the flux that the gas scheme
/// really used (mass of each fluid, momentum and energy without the pressure's part, which reaches the points through
/// Eq. (39)) and by what points carry out, and falls by what new points carry in. A point is born when half a point's
/// volume has gathered: its centre is then at the face. Gas outside + points + ledger is constant. (Eqs. (40)-(51) as
/// printed count what crosses twice, see docs/theory.)
#pragma once

#include <array>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "bridge/averages.hpp"
#include "bridge/cell_states.hpp"
#include "bridge/region.hpp"
#include "gas/gas.hpp"
#include "mpm/mpm.hpp"

namespace brisance {
class Archive;
}

namespace brisance::bridge {

enum class Transport {
  ledger,  ///< conservative
  paper,   ///< as printed in [Cui14] Eqs. (40)-(51): counts twice what flows out of the region
};

struct Options {
  int width = 5;  ///< w [cells]
  Transport transport = Transport::ledger;
  int points_per_direction = 2;  ///< of the gas, per cell
  /// The region wakes when the pressure of a gas cell next to it differs from the ambient one by this [Pa].
  double activation = 100.0;
  bool awake = false;  ///< from the start: something moves in the region
  /// Taken off the pressure in the forces [Pa]; absent: the lowest pressure of the gas, the ambient one at most.
  std::optional<double> reference_pressure;
};

/// What is under way between gas and points.
struct Ledger {
  std::array<double, 2> mass{0.0, 0.0};  ///< of the two fluids [kg]
  Vec3 momentum{0.0, 0.0, 0.0};          ///< [kg m/s]
  double energy = 0.0;                   ///< [J]
  double volume = 0.0;                   ///< that this gas fills [m3]

  [[nodiscard]] double total() const { return mass[0] + mass[1]; }
  void add(Ledger const& other, double factor = 1.0) {
    for (int f = 0; f < 2; ++f) mass[f] += factor * other.mass[f];
    for (int d = 0; d < 3; ++d) momentum[d] += factor * other.momentum[d];
    energy += factor * other.energy;
    volume += factor * other.volume;
  }
};

/// Counts since the start.
struct Traffic {
  long born = 0;  ///< points
  long left = 0;
  Ledger outflow;              ///< left the region through open boundaries of the domain, less what came in
  double pressure_work = 0.0;  ///< of the pressure at the region's faces, by the gas fluxes, into the region [J]
  Vec3 pressure_impulse{0.0, 0.0, 0.0};  ///< likewise [kg m/s]
};

class Bridge {
 public:
  /// Gives the gas cells of the region their roles and watches its faces. `gas_body` is the body of the gas points.
  /// Keeps references to both.
  Bridge(gas::Gas& gas, mpm::Mpm& points, int gas_body, Region region, Options const& options,
         gas::MixtureState const& ambient);

  [[nodiscard]] Region const& region() const { return region_; }
  [[nodiscard]] Options const& options() const { return options_; }
  [[nodiscard]] int gas_body() const { return gas_body_; }
  /// Has the region woken? Wakes it when the gas outside has been disturbed.
  bool wake();
  [[nodiscard]] bool awake() const { return awake_; }

  /// Fills the ghost cells from the points, [Cui14] Eqs. (31)-(36), at the present level.
  void lend_nodes_to_ghosts();
  /// Remembers the states of the cells that act as points: of the step's start, and, called again, of its end.
  void read_cells() { states_.read(*gas_); }
  /// Largest |u| + c of the cells that act as points [m/s]: what comes in with the next step.
  [[nodiscard]] double incoming_signal() const { return states_.fastest_signal(); }
  /// Makes the cells outside act as points, [Cui14] Eqs. (37)-(39), for a step of the points that begins and ends at
  /// these parts of the gas step, 0 to 1. Each cell becomes as many points as the deck asks for; they stand where the
  /// rows of points in the region would go on: the ledger tells by how much of a point's mass.
  void lend_cells_to_nodes(double begin, double end);
  /// Transport through the region's faces, [Cui14] Sec. 3.4; `share`: part of the gas step that the points have made
  /// since the last call, `dt` its length [s]. Throws NumericalError where a solid has come to the bridge.
  void exchange(double share, double dt);

  /// What is wrong where a solid has come to the bridge; empty: none has.
  [[nodiscard]] std::string intruder() const;

  /// Sum over all faces, in their order.
  [[nodiscard]] Ledger ledger() const;
  /// The accounts, face by face, lane by lane.
  [[nodiscard]] std::vector<Ledger> const& accounts() const { return ledger_; }
  [[nodiscard]] Traffic const& traffic() const { return traffic_; }
  /// Gas in the accounts of the faces, of either sign, beyond two points per lane [kg]. A sound ledger holds none: a
  /// point is born from half a point's volume on.
  [[nodiscard]] double surplus() const;

  /// The state that a checkpoint holds.
  void archive(Archive& archive);

  /// The gas at cells of the region (domain indices), from the points; volume 0 where there is none.
  [[nodiscard]] std::vector<CellSums> gas_in(std::vector<Index3> const& cells) const;
  /// The state that sums stand for.
  [[nodiscard]] gas::Primitive primitive(CellSums const& sums) const;

 private:
  struct LentCell {
    int state = -1;    ///< number in `states_`, or, of cells beyond an open boundary,
    int average = -1;  ///< in `averages_`
    Index3 cell{0, 0, 0};
    /// Faces of the region that the cell lies before, one per direction at most; -1: none.
    std::array<int, 3> face{-1, -1, -1};
  };
  struct LentBlock {
    int block = 0;
    std::vector<LentCell> cells;
  };
  struct Lanes {
    int outside_state = -1;  ///< of the outside cell in `states_`
    int inside_state = -1;
    int average = -1;  ///< open faces: of the inside cell in `averages_`
  };

  void set_roles();
  void fill_ghost(int n);
  /// May no solid be in this cell?
  [[nodiscard]] bool is_forbidden(Index3 const& cell) const;
  void lend_cell(LentCell const& lent, double begin, double end, mpm::PointSet& set) const;
  /// The faces that a lent cell lies before.
  [[nodiscard]] std::array<int, 3> faces_before(Index3 const& cell) const;
  [[nodiscard]] GasState state_of(CellSums const& sums) const;
  void take_reference_off();
  void take_leavers();
  void add_to_cell(Index3 const& cell, Ledger const& load);
  void add_fluxes(double share, double dt);
  void find_neighbours();
  void level_ledger();
  void give_birth();
  void give_birth_as_printed(double dt);
  [[nodiscard]] Index3 cell_at(Vec3 const& x) const;
  [[nodiscard]] int crossed_face(Vec3 const& x, Vec3 const& move) const;
  [[nodiscard]] int find_face(Index3 const& inside, int direction, int side) const;
  [[nodiscard]] int lane_of(int face, Vec3 const& x) const;
  /// The part of the inside cell that a lane of a face leads to.
  [[nodiscard]] Index3 sub_cell(int face, int lane) const;
  [[nodiscard]] int lane_at(int face, Index3 const& sub) const;
  [[nodiscard]] double lane_area(int face, int lane) const;
  [[nodiscard]] double standard_volume(Index3 const& cell, Index3 const& sub) const;
  void follow_volumes(double dt);
  [[nodiscard]] Ledger carried(mpm::PointSet const& set, int q) const;
  /// The gas outside at a lane of a face.
  [[nodiscard]] GasState donor_state(int face, int lane, GasSlopes& slopes) const;
  /// Appends a point at a depth [m] from the face.
  void append_point(int face, int lane, double depth, double mass, GasState const& state, GasSlopes const& slopes,
                    mpm::PointSet& to) const;
  [[nodiscard]] double specific_energy(GasState const& s) const;

  gas::Gas* gas_;
  mpm::Mpm* points_;
  int gas_body_;
  Region region_;
  Options options_;
  grid::Domain lanes_domain_;  ///< cells as small as the lanes are wide
  gas::MixtureState ambient_;
  bool awake_ = false;

  Averages averages_;                                 ///< of the ghost cells, then of the cells at open boundaries
  std::vector<std::array<int, 6>> ghost_neighbours_;  ///< in `averages_`, -1: none
  std::vector<int> ghost_blocks_;                     ///< of the gas
  double last_step_ = 0.0;                            ///< of the points [s]
  CellStates states_;
  std::vector<LentBlock> lent_;
  std::unordered_map<long, std::array<int, 6>> faces_of_;  ///< cell of the region -> faces, or -1
  std::vector<Lanes> lanes_;
  int lanes_per_face_ = 1;
  std::vector<Ledger> ledger_;                       ///< face by face, lane by lane
  std::vector<Ledger> levelled_;                     ///< scratch: the ledger before
  std::vector<char> outwards_;                       ///< per face: the gas flowed out of the region in the last step
  std::vector<std::array<int, 4>> lane_neighbours_;  ///< along the region's surface; -1: none
  std::vector<int> leaving_blocks_;                  ///< blocks of points that hold cells outside the region
  std::vector<int> bridge_blocks_;                   ///< blocks of points that hold cells which solids may not enter
  std::vector<mpm::PointSet> leavers_;
  Traffic traffic_;
};

}  // namespace brisance::bridge
