/// The gas at the faces of the MPM region as the parts of the bridge share it: averages over the particles inside, and
/// the states of the gas cells outside.
#pragma once

#include <map>
#include <vector>

#include "bridge/averages.hpp"
#include "bridge/cell_states.hpp"
#include "bridge/conversion.hpp"
#include "bridge/faces.hpp"
#include "gas/gas.hpp"
#include "mpm/mpm.hpp"

namespace brisance::bridge {

class SharedGas {
 public:
  /// Keeps references to all.
  SharedGas(gas::Gas const& gas, mpm::Mpm const& particles, int gas_body, Faces const& faces);

  /// Takes the averages over the particles as they are now.
  void average();
  /// Reads the states of the cells that act as particles.
  void follow_blocks() { states_.follow_blocks(gas_->grid()); }  ///< when those of the gas have changed
  void read_cells() { states_.read(*gas_); }

  [[nodiscard]] material::Fluids const& fluids() const { return gas_->fluids(); }
  /// Number of a cell among the averages; -1: it has none. First come the ghost cells, in their order.
  [[nodiscard]] int average_of(Index3 const& cell) const { return find(averaged_, cell); }
  [[nodiscard]] std::vector<CellSums> const& sums() const { return averages_.sums(); }
  /// Number of a cell among the states; -1: it has none.
  [[nodiscard]] int state_of(Index3 const& cell) const { return find(read_, cell); }
  [[nodiscard]] CellStates const& states() const { return states_; }
  [[nodiscard]] CellStates& states() { return states_; }

  /// Open faces: the sums of the inside cell; the gas beyond is what it is on this side.
  [[nodiscard]] CellSums const& sums_at(int face) const { return averages_.sums()[beside_[face].average]; }
  /// Do solids fill most of the inside cell? What gas there is among them is none to take the gas beyond for.
  [[nodiscard]] bool solid_at(int face) const;
  /// Other faces: the states on both sides at the later time.
  [[nodiscard]] Primitive const& outside(int face) const { return states_.later(beside_[face].outside); }
  [[nodiscard]] Primitive const& inside(int face) const { return states_.later(beside_[face].inside); }
  /// Changes over the outside cell at the later time.
  [[nodiscard]] GasSlopes slopes_outside(int face) const;
  /// The gas outside at a lane of a face.
  [[nodiscard]] Primitive donor(int face, int lane, GasSlopes& slopes) const;

 private:
  void find_solids();

  /// What lies on both sides of a face.
  struct Beside {
    int outside = -1;  ///< in `states_`
    int inside = -1;
    int average = -1;  ///< open faces: of the inside cell in `averages_`
  };
  [[nodiscard]] static int find(std::map<Index3, int> const& numbers, Index3 const& cell) {
    auto const found = numbers.find(cell);
    return found == numbers.end() ? -1 : found->second;
  }

  gas::Gas const* gas_;
  mpm::Mpm const* particles_;
  int gas_body_;
  Faces const* faces_;
  std::map<Index3, int> averaged_;  ///< numbers of the cells
  std::map<Index3, int> read_;
  Averages averages_;  ///< of the ghost cells and their neighbours, then of the cells at open boundaries
  CellStates states_;
  std::vector<Beside> beside_;      ///< per face
  std::map<Index3, double> solid_;  ///< cells at open faces: volume of the matter of solids in them [m3]
  std::vector<int> open_blocks_;    ///< blocks of particles that hold such cells
};

}  // namespace brisance::bridge
