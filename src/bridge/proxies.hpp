/// Proxies: gas cells outside the region that act as particles for a step, [Cui14] Eqs. (37)-(39). Nodes at the
/// region's surface take part of their mass, momentum and force from them.
#pragma once

#include <array>
#include <vector>

#include "bridge/faces.hpp"
#include "bridge/ledger.hpp"
#include "bridge/shared_gas.hpp"
#include "mpm/mpm.hpp"

namespace brisance::bridge {

class Proxies {
 public:
  /// Announces to the particles that these act for the body of the gas particles. Keeps references.
  Proxies(mpm::Mpm& particles, int gas_body, Faces const& faces, SharedGas const& shared);

  /// Makes the particles for a step that begins and ends at these fractions of the gas step, 0 to 1. Each cell becomes
  /// as many points as the deck asks for; they stand where the rows of particles in the region would go on: the ledger
  /// tells by how much of a particle's mass.
  void make(double begin, double end, Ledger const& ledger);
  /// Blocks of particles that hold such cells.
  [[nodiscard]] std::vector<int> blocks() const;

 private:
  struct ProxyCell {
    int state = -1;    ///< number among the shared states, or, of cells beyond an open boundary,
    int average = -1;  ///< among the averages
    Index3 cell{0, 0, 0};
    /// Faces of the region that the cell lies before, one per direction at most; -1: none.
    std::array<int, 3> face{-1, -1, -1};
  };
  struct ProxyBlock {
    int block = 0;
    std::vector<ProxyCell> cells;
  };
  void make_proxies(ProxyCell const& proxy, double begin, double end, Ledger const& ledger,
                    mpm::ParticleSet& set) const;

  mpm::Mpm* particles_;
  Faces const* faces_;
  SharedGas const* shared_;
  std::vector<ProxyBlock> blocks_;
};

}  // namespace brisance::bridge
