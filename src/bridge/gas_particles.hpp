/// The material points of the gas where they come into the region and leave it: their making, their taking out, and
/// what each carries.
#pragma once

#include <vector>

#include "bridge/cell_states.hpp"
#include "bridge/faces.hpp"
#include "bridge/traffic.hpp"
#include "mpm/mpm.hpp"

namespace brisance::bridge {

/// Writes the velocity gradient that APIC's particles carry; `h`: size of a cell [m].
void set_gradient(mpm::ParticleSet& set, int q, GasSlopes const& slopes, int dimensions, double h);

class GasParticles {
 public:
  /// `body`: of the gas particles; `outer_blocks`: blocks of particles that hold cells outside the region. Keeps
  /// references.
  GasParticles(mpm::Mpm& particles, int body, material::Fluids const& fluids, Faces const& faces,
               std::vector<int> const& outer_blocks);

  [[nodiscard]] mpm::ParticleSet empty_set() const { return mpm::ParticleSet(mpm::fields(*particles_, body_)); }
  /// Appends a particle that comes in through a lane at a depth [m] from its face; `mass` [kg].
  void append(int face, int lane, double depth, double mass, Primitive const& state, GasSlopes const& slopes,
              mpm::ParticleSet& to) const;
  /// Puts new particles among those of the gas.
  void add(mpm::ParticleSet const& set) { particles_->add(body_, set); }
  /// What a particle carries, its own velocity gradient's energy included.
  [[nodiscard]] Amounts carried(mpm::ParticleSet const& set, int q) const;
  /// The same with the work that the reference pressure does when a particle comes or goes: the particles in the region
  /// feel nothing of it, but as they stretch to fill the space left they give it away. Through open faces nothing of
  /// that is booked.
  [[nodiscard]] Amounts handed_over(mpm::ParticleSet const& set, int q) const;

  /// Takes out the particles that have left the region; they stay in the sets, one per outer block, until the next
  /// call.
  std::vector<mpm::ParticleSet> const& take_absorbed();

 private:
  mpm::Mpm* particles_;
  int body_;
  bool has_gradient_energy_;  ///< see `mpm::BodyRules`
  material::Fluids const* fluids_;
  Faces const* faces_;
  /// A block with cells outside the region.
  struct OuterBlock {
    int block = 0;
    grid::CellRange cells;     ///< of the particles' grid
    std::vector<char> inside;  ///< which of them are in the region
  };
  [[nodiscard]] bool is_inside(OuterBlock const& outer, Vec3 const& x) const;

  std::vector<OuterBlock> outer_blocks_;
  std::vector<mpm::ParticleSet> absorbed_;
};

}  // namespace brisance::bridge
