/// The 1D simulation of a burst by material points, [Cui14] Sec. 4.1: real detonation, products and air as bodies.
#pragma once

#include <memory>

#include "case/case.hpp"
#include "detonation/profile.hpp"
#include "mpm/mpm.hpp"

namespace brisance::setup {

class ParticlesBurst {
 public:
  /// `one`: the case of the 1D simulation, as it would be given to the gas scheme.
  explicit ParticlesBurst(Case const& one);

  [[nodiscard]] double time() const { return particles_->time(); }
  [[nodiscard]] long steps() const { return steps_; }
  /// Radius of the outermost particle of the air whose pressure is not ambient [m].
  [[nodiscard]] double front() const;
  /// By how much the profile may reach beyond the front, and the front may come forward in a step [m].
  [[nodiscard]] double step_reach() const;
  void advance(double latest);
  /// What the particles hold, on the cells of the case. Throws InputError where explosive still burns.
  [[nodiscard]] detonation::Profile profile() const;

 private:
  Case one_;
  std::unique_ptr<mpm::Mpm> particles_;
  long steps_ = 0;
};

}  // namespace brisance::setup
