/// The ledger: what is under way between gas and particles, face by face, lane by lane.
///
/// The gas moves mass through the surface of the region by its fluxes and pushes on it by its pressure. Each face, cut
/// into lanes, keeps an account of what the gas gave to the region, less what the region took. It grows by the flux
/// that the gas scheme really used (mass of each fluid, momentum, energy; impulse and work of the pressure included)
/// and by what particles carry out; it falls by what new particles carry in and by what the nodes really took of the
/// cells outside, Eq. (39), which act as particles. A particle is injected when half a particle's volume has gathered:
/// its centre is then at the face. Gas outside + particles + ledger is constant. (Eqs. (40)-(51) as printed count what
/// crosses twice, see docs/theory.)
///
/// Gas and particles make a little of the same flow differently, and the difference would gather without bound where
/// waves come and go. What an account holds beyond the gas in its volume therefore goes back to the gas cell outside.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "bridge/faces.hpp"
#include "bridge/gas_particles.hpp"
#include "bridge/node_shares.hpp"
#include "bridge/shared_gas.hpp"
#include "bridge/traffic.hpp"
#include "gas/gas.hpp"

namespace brisance {
class Archive;
}

namespace brisance::bridge {

class Ledger {
 public:
  using Fluxes = std::vector<gas::FaceFlux>;  ///< of the watched faces, see `Gas::watched`

  /// Keeps references to both.
  Ledger(Faces const& faces, SharedGas const& shared);

  [[nodiscard]] std::vector<Amounts> const& accounts() const { return accounts_; }
  /// Sum over all faces, in their order.
  [[nodiscard]] Amounts sum() const;
  /// How far the gas in an account reaches along its lane, as a step along the axis from the face into the region [m];
  /// out of it where gas lacks. The lane is that of the face that a place [m] lies in.
  [[nodiscard]] double reach(int face, Vec3 const& x) const;
  /// Sum of the sizes of the masses in the accounts [kg].
  [[nodiscard]] double content() const;
  /// Gas of either sign beyond two particles per lane [kg].
  [[nodiscard]] double surplus() const;

  // One step, in this order; `share`: fraction of the gas step that the particles have made, `dt`: its length [s].

  /// Remembers the accounts as they are before the step.
  void begin_step() { before_ = accounts_; }
  /// Adds what a particle carried out through a lane.
  void absorb(int face, int lane, Amounts const& load) { at(face, lane).add(load); }
  /// Finds the faces through which the gas flows out of the region.
  void find_directions(Fluxes const& watched, double share);
  /// Lets gas in through open faces, at the state of the region's gas there; it is taken off `outflow`. Absent
  /// `reference`, the reference pressure: so is the work of the gas's pressure, which `take_gifts` does not tell then.
  void add_inflow(double dt, std::optional<double> reference, Amounts& outflow);
  /// Adds what the gas carried through the faces.
  void add_fluxes(Fluxes const& watched, double share);
  /// Adds what the pressure of the gas did there, less the part of the reference pressure, which the particles do not
  /// feel; `resting`: the pressure where both sides of a face sleep [Pa].
  void add_pressure(Fluxes const& watched, double share, double dt, double reference, double resting);
  /// Takes off what the cells outside gave at the nodes, block by block; at open faces the energy of it off `outflow`.
  void take_gifts(mpm::ProxyParticles& proxies, std::vector<int> const& blocks, Amounts& outflow);
  /// Lets the volumes of the accounts follow the gas.
  void follow_volumes(double dt);
  /// Evens out neighbouring accounts where gas flows out.
  void level();
  /// Makes the particles that have gathered. Returns how many.
  long inject(GasParticles& particles);
  /// Gives back to the gas cells outside what has no place in the accounts.
  void give_back(gas::Gas& gas, double dt, double reference);

  void archive(Archive& a);  ///< in a checkpoint

 private:
  [[nodiscard]] Amounts& at(int face, int lane) { return accounts_[faces_->number(face, lane)]; }

  Faces const* faces_;
  SharedGas const* shared_;
  std::vector<Amounts> accounts_;  ///< by `Faces::number`
  NodeShares shares_;
  std::vector<Amounts> gifts_;   ///< scratch, per face
  std::vector<Amounts> given_;   ///< scratch, per lane of a face
  std::vector<Amounts> before_;  ///< scratch: the accounts before the step, or before they are levelled
  std::vector<char> outwards_;   ///< per face: the gas flowed out of the region in the last step
};

}  // namespace brisance::bridge
