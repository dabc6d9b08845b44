/// What the audit of a simulation knows and says.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/vec.hpp"
#include "material/amounts.hpp"
#include "mpm/mpm.hpp"

namespace brisance {
class Archive;
}

namespace brisance::run {

/// Sums over the domain, without their volume. The energy is internal + kinetic, chemical energy of unburnt explosive
/// included. Planar geometries count per metre of each unresolved direction.
struct Totals : material::Amounts {
  double kinetic_energy = 0.0;  ///< of the energy [J]
  /// Energy that all of this would have in the start's ambient state and at rest [J].
  double rest_energy = 0.0;

  Totals& operator+=(Totals const& other) {
    for (int k = 0; k < material::most_fluids; ++k) mass[k] += other.mass[k];
    momentum = momentum + other.momentum;
    energy += other.energy;
    kinetic_energy += other.kinetic_energy;
    rest_energy += other.rest_energy;
    return *this;
  }
};

/// What the audit remembers of earlier times: as of the instants of `World::follow_audit`, which neither output nor
/// threads move.
struct AuditMemory {
  double scale = 0.0;    ///< largest energy at work, see `EnergyBalance` [J]
  double all = 0.0;      ///< largest energy of all, that of the ambient state too [J]
  double drift = 0.0;    ///< of the energy, the largest of either sign [J]
  double content = 0.0;  ///< largest sum of the sizes of the masses in the ledger's accounts [kg]
  double surplus = 0.0;  ///< largest mass in the ledger that does not belong there [kg]
  double gas = 0.0;      ///< largest mass of the gas particles [kg]
  double work = 0.0;     ///< of loads, until the last look [J]
  double fresh = 0.0;    ///< of it, since the look before, its size [J]
  double unlit = 0.0;    ///< largest compression of explosive before it was lit
};

/// What must stay constant, and what changed it. At any time: current = initial - outflow + guards + afterburn + panels
/// (+ round-off).
struct Audit {
  Totals initial;
  Totals current;           ///< `ledger` included
  Totals ledger;            ///< of it, what is under way between gas cells and particles
  Totals outflow;           ///< left through the domain's faces since the start; momentum includes the pressure impulse
  long fallback_faces = 0;  ///< faces whose flux was replaced by, or blended with, a first-order one
  long guarded_cells = 0;   ///< cell updates in which density or internal energy had to be lifted to its floor
  double guard_mass = 0.0;  ///< mass that the guards added [kg]
  double guard_energy = 0.0;      ///< energy that the guards added [J]
  double afterburn_energy = 0.0;  ///< energy that the products released after the detonation [J]
  /// What the cells of panels hold more since they opened: ambient gas was counted there before [kg, J].
  material::Amounts panels;
  AuditMemory memory;

  /// |initial - outflow + guards + afterburn + panels - current| relative to the largest of the terms.
  struct Error {
    material::PerFluid mass{};
    double energy = 0.0;
  };
  [[nodiscard]] Error relative_error() const;
};

/// Where the energy stands that is not conserved by construction: of material points, alone or together with gas.
struct EnergyBalance {
  double initial = 0.0;  ///< kinetic and internal [J]
  double current = 0.0;
  double lost = 0.0;            ///< left through the domain's faces [J]
  double work = 0.0;            ///< done by loads, the body force, and constraints and rigid bodies in motion [J]
  double released = 0.0;        ///< by the afterburn [J]
  double opened = 0.0;          ///< came with the cells of panels that opened [J]
  mpm::Dissipation dissipated;  ///< kinetic energy that was lost and is known
  /// What an error of the energy is to be compared with [J]: the largest value so far of the energy at work, that is
  /// kinetic energy + |work| + internal energy above (or below) the start's ambient state. The latter holds what burns
  /// from the start, and what an afterburn has released.
  double scale = 0.0;
  double all = 0.0;  ///< the same, the energy of the ambient state included [J]

  /// current + lost + dissipated - work - released - opened - initial [J]. What guards add is in it.
  [[nodiscard]] double error() const { return current + lost + dissipated.sum() - work - released - opened - initial; }
  /// `error` over `scale`; 0 where there is no energy.
  [[nodiscard]] double drift() const { return scale > 0.0 ? error() / scale : 0.0; }
};

/// Something that the audit has looked at.
struct AuditFinding {
  enum class Kind {
    mass,          ///< of a fluid, or of the particles
    gas_energy,    ///< of gas alone
    guard_energy,  ///< that the guards added
    guard_mass,
    drift,   ///< of the energy of particles, alone or together with gas
    ledger,  ///< gas that lies between cells and particles
    unlit,   ///< compression of explosive before it was lit
  };
  Kind kind = Kind::drift;
  double amount = 0.0;    ///< what is too much [J, kg or of 1], with its sign
  double scale = 0.0;     ///< of what [J, kg or 1]
  double warn = 0.0;      ///< fraction of the scale from which on the run does not balance
  double fail = 0.0;      ///< from which on it stops; 0: never
  double smallest = 0.0;  ///< amounts up to this are none [J or kg]
  double fresh = 0.0;     ///< what the limits leave on top, see `World::audit_findings` [J]
  int fluid = 0;          ///< of a mass

  [[nodiscard]] double share() const;  ///< of the scale; infinite where that is none
  [[nodiscard]] bool tells() const;
  [[nodiscard]] bool stops() const;
};

/// What the audit says.
struct Verdict {
  bool balanced = true;
  bool drift_judged = true;          ///< false: `AuditLimits::warn` is 0
  std::vector<std::string> reasons;  ///< why it does not balance, a line each
};

void archive(Archive& a, Totals& totals);

}  // namespace brisance::run
