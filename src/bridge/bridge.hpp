/// The bridge between gas cells and material points, [Cui14] Sec. 3. `Bridge` sees only the public state of both.
///
/// Ghost cells of the gas inside the region come from the particles, Eqs. (31)-(36), see `Ghosts`; nodes at the
/// region's surface take part of their mass, momentum and force from gas cells outside, Eqs. (37)-(39), which act as
/// particles for a step, see `Proxies`; and what flows through the surface is handed over, Sec. 3.4, by a `Ledger`, or
/// as printed. What both sides make differently of the same flow stays in the ledger, and goes back to the gas outside.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "bridge/faces.hpp"
#include "bridge/forbidden_cells.hpp"
#include "bridge/gas_particles.hpp"
#include "bridge/ghosts.hpp"
#include "bridge/ledger.hpp"
#include "bridge/proxies.hpp"
#include "bridge/region.hpp"
#include "bridge/shared_gas.hpp"
#include "bridge/traffic.hpp"
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
constexpr auto words(Transport) {
  return std::array{Word{Transport::ledger, "ledger"}, Word{Transport::paper, "paper"}};
}

struct Options {
  int width = 5;  ///< w [cells]
  Transport transport = Transport::ledger;
  int particles_per_direction = 2;  ///< of the gas, per cell
  /// The region wakes when the pressure of a gas cell next to it differs from the ambient one by this [Pa].
  double activation = 100.0;
  bool awake = false;  ///< from the start: something moves in the region
  /// Taken off the pressure in the forces [Pa]; absent: the lowest pressure of the gas, the ambient one at most.
  std::optional<double> reference_pressure;
};

class Bridge {
 public:
  /// Gives the gas cells of the region their roles and watches its faces. `gas_body` is the body of the gas particles.
  /// Keeps references to both.
  Bridge(gas::Gas& gas, mpm::Mpm& particles, int gas_body, Region region, Options const& options,
         gas::Primitive const& ambient);
  // Its parts keep references to each other.
  Bridge(Bridge const&) = delete;
  Bridge& operator=(Bridge const&) = delete;

  [[nodiscard]] Region const& region() const { return region_; }
  [[nodiscard]] Options const& options() const { return options_; }
  [[nodiscard]] int gas_body() const { return gas_body_; }
  /// To be called when the blocks of the gas have changed. Those that the region touches must have stayed.
  void follow_blocks();
  /// Has the region woken? Wakes it when the gas outside has been disturbed.
  bool wake();
  [[nodiscard]] bool awake() const { return awake_; }

  /// Fills the ghost cells from the particles, [Cui14] Eqs. (31)-(36), at the present level.
  void lend_nodes_to_ghosts();
  /// Remembers the states of the cells that act as particles: of the step's start, and, called again, of its end.
  void read_cells() { shared_.read_cells(); }
  /// Largest |u| + c of the cells that act as particles [m/s]: what comes in with the next step.
  [[nodiscard]] double incoming_signal() const { return shared_.states().fastest_signal(); }
  /// Makes the cells outside act as particles, [Cui14] Eqs. (37)-(39), for a step of the particles that begins and ends
  /// at these fractions of the gas step, 0 to 1.
  void lend_cells_to_nodes(double begin, double end);
  /// Transport through the region's faces, [Cui14] Sec. 3.4; `share`: fraction of the gas step that the particles have
  /// made since the last call, `dt` its length [s].
  void exchange(double share, double dt);

  /// What is wrong where a solid has come to the bridge; empty: none has.
  [[nodiscard]] std::string intruder() const { return forbidden_cells_.intruder(); }

  /// Sum over all faces, in their order.
  [[nodiscard]] Amounts ledger() const { return ledger_.sum(); }
  /// The accounts, face by face, lane by lane.
  [[nodiscard]] std::vector<Amounts> const& accounts() const { return ledger_.accounts(); }
  [[nodiscard]] Traffic const& traffic() const { return traffic_; }
  /// Sum of the sizes of the masses in the accounts [kg].
  [[nodiscard]] double content() const { return ledger_.content(); }
  /// Gas in the accounts of the faces, of either sign, beyond two particles per lane [kg]. A sound ledger holds none: a
  /// particle is injected from half a particle's volume on.
  [[nodiscard]] double surplus() const { return awake_ ? ledger_.surplus() : 0.0; }

  /// The state that a checkpoint holds.
  void archive(Archive& archive);

  /// The gas at cells of the region (domain indices), from the particles; volume 0 where there is none.
  [[nodiscard]] std::vector<CellSums> gas_in(std::vector<Index3> const& cells) const;
  /// The state that sums stand for.
  [[nodiscard]] gas::Primitive primitive(CellSums const& sums) const;

 private:
  void set_roles();
  void watch_faces();
  void keep_wind_awake();
  void take_reference_off();
  void take_absorbed();
  void count_pressure(double share);

  gas::Gas* gas_;
  mpm::Mpm* particles_;
  int gas_body_;
  Region region_;
  Options options_;
  gas::Primitive ambient_;
  bool awake_ = false;
  double last_step_ = 0.0;  ///< of the particles [s]
  Traffic traffic_;

  Faces faces_;
  SharedGas shared_;
  Ghosts ghosts_;
  Proxies proxies_;
  GasParticles gas_particles_;
  Ledger ledger_;
  ForbiddenCells forbidden_cells_;
};

/// What has gone through the faces of a region since it was last told so has been taken over.
void forget_fluxes(gas::Coupling& coupling, Region const& region);

}  // namespace brisance::bridge
