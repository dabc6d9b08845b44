/// Conservation audit: what is in the domain, what left it, what the guards added, and whether all that is right.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/reduce.hpp"
#include "core/timer.hpp"
#include "run/products.hpp"
#include "run/world.hpp"

namespace brisance::run {

namespace {

/// Error of a balance that is kept by construction, relative to its largest term: round-off of a long run.
constexpr double round_off = 1e-10;
/// What guards add, as a fraction of the charges' energy, or without charges of the energy at work. It is an error of
/// the same kind as a drift, but it stands in few cells, where it ruins the state long before the sum shows it.
constexpr double guards_warn = 1e-4;
constexpr double guards_fail = 1e-2;
/// Gas in the ledger beyond what is on its way through the faces, as a fraction of the region's gas.
constexpr double ledger_warn = 0.01;
constexpr double ledger_fail = 0.05;
/// Unburnt explosive has no strength in programmed burn: a blow compresses it like dust, far beyond any real state, and
/// what it does when it is lit at last means nothing.
constexpr double unlit_warn = 0.05;
/// A drift up to this fraction of all energy, that of the ambient state included, is round-off: water at rest holds
/// megajoules, and a plate under stress holds what it was given.
constexpr double drift_round_off = 1e-9;
/// Bodies at rest without stress have no energy at all; their particles tremble by round-off of the speed of sound,
/// squared.
constexpr double noise = 1e-20;
/// The audit is looked at whenever a fraction of the end time has gone by, and every so many steps: the end time may be
/// far beyond the end.
constexpr double looks = 1000.0;
constexpr long most_steps_between_looks = 64;
constexpr long least_steps_between_looks = 4;  // a look goes over all particles and cells

using Kind = AuditFinding::Kind;

bool burns(Body const& body) { return body.solid.burns() || !body.initiation.empty(); }

/// Specific internal energy of a body's material in the start's ambient state [J/kg]. The ambient state of explosives
/// is that of their products, far apart; bodies without gas around stand in empty space, in which an ideal gas gives
/// away all that it has.
double rest_energy(Case const& setup, Body const& body) {
  bool const expands = !setup.has_regions() && std::holds_alternative<material::IdealGas>(body.solid.eos);
  return burns(body) || expands ? 0.0 : body.solid.specific_energy;
}

/// Energy of the charges, of cells and of bodies, as far as they lie in the domain [J].
double charge_energy(World const& w) {
  double sum = 0.0;
  for (int k = 1; k < material::most_fluids; ++k) {
    if (auto const* explosive = w.setup.explosive_of(k)) sum += w.audit.initial.mass[k] * explosive->specific_energy();
  }
  for (std::size_t b = 0; b < w.setup.particles.bodies.size(); ++b) {
    Body const& body = w.setup.particles.bodies[b];
    if (burns(body)) sum += w.bodies[b].mass * body.specific_energy.value_or(body.solid.specific_energy);
  }
  return sum;
}

/// Sum of m c^2 over the bodies [J].
double stiffness(World const& w) {
  double sum = 0.0;
  for (std::size_t b = 0; b < w.setup.particles.bodies.size(); ++b) {
    material::Material const& solid = w.setup.particles.bodies[b].solid;
    double const c = material::sound_speed(solid, solid.density, material::start_pressure(solid));
    if (std::isfinite(c)) sum += w.bodies[b].mass * c * c;
  }
  return sum;
}

/// Kinetic energy and internal energy above the ambient state [J].
double energy_above(Totals const& t) {
  return t.kinetic_energy + std::abs(t.energy - t.kinetic_energy - t.rest_energy);
}

double larger_size(double a, double b) { return std::abs(b) > std::abs(a) ? b : a; }

}  // namespace

Audit::Error Audit::relative_error() const {
  auto const error = [](double before, double out, double added, double now) {
    double const scale = std::max({std::abs(before), std::abs(out), std::abs(now), 1e-300});
    return std::abs(before - out + added - now) / scale;
  };
  Error relative;
  for (int k = 0; k < material::most_fluids; ++k) {
    double const lifted = k == 0 ? guard_mass : 0.0;  // the guards add ambient fluid
    relative.mass[k] = error(initial.mass[k], outflow.mass[k], lifted + panels.mass[k], current.mass[k]);
  }
  relative.energy =
      error(initial.energy, outflow.energy, guard_energy + afterburn_energy + panels.energy, current.energy);
  return relative;
}

double AuditFinding::share() const {
  if (amount == 0.0) return 0.0;
  return scale > 0.0 ? amount / scale : std::copysign(std::numeric_limits<double>::infinity(), amount);
}

// What is no number is beyond every limit.
bool AuditFinding::tells() const {
  return warn > 0.0 && !(std::abs(amount) <= std::max(warn * scale + fresh, smallest));
}
bool AuditFinding::stops() const {
  return fail > 0.0 && !(std::abs(amount) <= std::max(fail * scale + fresh, smallest));
}

/// Without gas the mass is that of all bodies, with gas that of the fluids in the gas particles.
Totals World::particle_totals() const {
  Totals total;
  for (Region const& region : regions) {
    for (std::size_t n = 0; n < region.bodies.size(); ++n) {
      int const body = region.bodies[n];
      mpm::BodySums const sums = mpm::sums(*region.particles, static_cast<int>(n));
      total.momentum = total.momentum + sums.momentum;
      total.energy += sums.kinetic_energy + sums.internal_energy - sums.provisional_energy;
      total.kinetic_energy += sums.kinetic_energy;
      if (!is_gas(body)) total.rest_energy += sums.mass * rest_energy(setup, setup.particles.bodies[body]);
      if (coupled() && !is_gas(body)) {
        if (int const fluid = products_of(setup, setup.particles.bodies[body])) total.mass[fluid] += sums.mass;
        continue;
      }
      for (int k = 0; k < material::most_fluids; ++k) total.mass[k] += sums.fluid_mass[k];
    }
  }
  return total;
}

Totals World::totals() const {
  if (gas == nullptr) return particle_totals();
  Totals total = gas_totals();
  total.rest_energy = gas_rest_energy_;
  if (coupled()) {
    total += ledger_totals();
    total += particle_totals();
  }
  return total;
}

Totals World::ledger_totals() const {
  if (!coupled()) return {};
  Totals total{regions.front().bridge->ledger()};
  for (std::size_t r = 1; r < regions.size(); ++r) total += {regions[r].bridge->ledger()};
  return total;
}

Totals World::gas_totals() const {
  int const fluids = gas->fluids().count;
  return sum_over(grid.block_count(), [&](int b) {
    grid::Block const& block = grid.blocks()[b];
    Totals sum;
    if (block.covered) return sum;
    grid::add_cells(block, sum, [&](grid::Cell const& cell, Totals& row) {
      if (!gas->coupling.is_own(cell) || block.is_covered(cell)) return;
      int const at = cell.offset;
      double const volume = gas->cut.volume(cell);
      auto const component = [&](int c) { return gas->fields().at(b, c)[at]; };
      double square = 0.0;
      for (int d = 0; d < 3; ++d) {
        double const momentum = component(gas::momentum_x + d);
        row.momentum[d] += volume * momentum;
        square += momentum * momentum;
      }
      for (int k = 0; k < fluids; ++k) row.mass[k] += volume * component(gas::partial_density(k));
      row.energy += volume * component(gas::energy);
      row.kinetic_energy += 0.5 * volume * square / gas::mixture_density(fluids, component);
    });
    return sum;
  });
}

/// Of all that is gas at the start, whatever its state.
double World::gas_rest_energy() const {
  double volume = 0.0;
  for (grid::Block const& block : grid.blocks()) {
    if (block.covered) continue;
    for_each_cell(block, [&](grid::Cell const& cell) {
      if (gas->coupling.is_own(cell) && !block.is_covered(cell)) volume += gas->cut.volume(cell);
    });
  }
  for (Region const& region : regions) {
    for (int b = 0; b < region.particles->grid().block_count(); ++b) {
      mpm::ParticleSet const& set = region.particles->particles(b, region.gas_body());
      for (int q = 0; q < set.size(); ++q) volume += set.field(mpm::Field::mass)[q] / set.field(mpm::Field::density)[q];
    }
  }
  Primitive const& ambient = setup.ambient.state;
  return volume * ambient.density *
         material::internal_energy(gas->fluids().ambient(), ambient.density, ambient.pressure);
}

void World::start_audit() {
  if (gas != nullptr) gas_rest_energy_ = gas_rest_energy();
  audit.initial = totals();
  audit.current = audit.initial;
  audit.memory.scale = energy_at_work();
  audit.memory.all = energy_balance().all;
}

/// What is known without a look at cells and particles.
void World::take_account() {
  audit.outflow = {};
  if (!regions.empty()) {
    mpm::Losses const lost = accounts().losses;
    if (gas == nullptr) audit.outflow.mass[0] = lost.mass;
    audit.outflow.momentum = lost.momentum;
    audit.outflow.energy = lost.energy;
  }
  if (gas == nullptr) return;
  for (Region const& region : regions) audit.outflow += {region.bridge->traffic().outflow};
  gas::Account const account = gas->account();
  audit.outflow += {gas::amounts_of(account.outflow)};
  audit.guarded_cells = account.guarded_cells;
  audit.fallback_faces = account.fallback_faces;
  audit.guard_mass = account.guard_mass;
  audit.guard_energy = account.guard_energy;
  audit.afterburn_energy = account.afterburn_energy;
  audit.panels = gas::amounts_of(account.opened);
}

void World::update_audit() {
  audit.current = totals();
  audit.ledger = ledger_totals();
  take_account();
}

/// At present; see `EnergyBalance::scale`. The energy of gas alone follows from what went through its boundaries.
double World::energy_at_work() const {
  if (!regions.empty()) return energy_above(audit.current) + std::abs(accounts().outer_work);
  return std::abs(audit.initial.energy - audit.initial.rest_energy - audit.outflow.energy + audit.afterburn_energy +
                  audit.panels.energy);
}

EnergyBalance World::energy_balance() const {
  EnergyBalance balance;
  balance.initial = audit.initial.energy;
  balance.current = audit.current.energy;
  balance.lost = audit.outflow.energy;
  balance.released = audit.afterburn_energy;
  balance.opened = audit.panels.energy;
  mpm::Accounts const booked = accounts();
  balance.work = booked.outer_work;
  balance.dissipated = booked.dissipation;
  balance.scale = std::max(audit.memory.scale, energy_at_work());
  balance.all = std::max(audit.memory.all, energy_at_work() + std::abs(audit.current.rest_energy));
  return balance;
}

void World::remember_ledgers() {
  double content = 0.0;
  double surplus = 0.0;
  double gas_mass = 0.0;
  for (Region const& region : regions) {
    content += region.bridge->content();
    surplus += region.bridge->surplus();
    gas_mass += mpm::mass(*region.particles, region.gas_body());
  }
  audit.memory.content = std::max(audit.memory.content, content);
  audit.memory.surplus = std::max(audit.memory.surplus, surplus);
  audit.memory.gas = std::max(audit.memory.gas, gas_mass);
}

bool World::audit_is_due() const {
  if (finished() || clock.step % most_steps_between_looks == 0) return true;
  if (clock.step % least_steps_between_looks != 0) return false;
  double const fraction = setup.end.time / looks;
  auto const number = [fraction](double time) { return std::floor(time / fraction * (1.0 + 1e-12)); };
  return number(clock.time) > number(clock.time - static_cast<double>(least_steps_between_looks) * clock.dt);
}

void World::follow_audit() {
  AuditMemory& memory = audit.memory;
  bool const due = !regions.empty() && audit_is_due();
  if (gas != nullptr && gas->burn.burning() && audit_is_due()) {
    memory.unlit = std::max(memory.unlit, gas::unlit_compression(*gas));
  }
  if (due) {
    PhaseTimer const timer(timings["audit"]);
    update_audit();
    EnergyBalance const energy = energy_balance();
    memory.scale = energy.scale;
    memory.all = energy.all;
    memory.drift = larger_size(memory.drift, energy.error());
    memory.fresh = std::abs(energy.work - memory.work);
    memory.work = energy.work;
    if (coupled()) remember_ledgers();
  } else {
    take_account();
    if (regions.empty()) {
      memory.scale = std::max(memory.scale, energy_at_work());
      memory.all = std::max(memory.all, energy_at_work() + std::abs(audit.initial.rest_energy));
    }
  }
  if (for_comparison()) return;
  for (AuditFinding const& finding : audit_findings()) {
    bool const guards = finding.kind == Kind::guard_energy || finding.kind == Kind::guard_mass;
    if ((!due && !guards) || !finding.stops()) continue;
    throw NumericalError(fmt::format(
        "the audit stopped the run: {}; the limit is {:g} %; {}; `fail = 0` in [audit] lets the run continue",
        in_words(finding), 100.0 * finding.fail,
        guards ? "a smaller numerics.courant or finer cells may help"
               : "smaller cells or a smaller Courant number of the particles may help"));
  }
}

std::vector<AuditFinding> World::audit_findings() const {
  AuditLimits const& limits = setup.audit;
  EnergyBalance const energy = energy_balance();
  std::vector<AuditFinding> found;
  auto const relative = audit.relative_error();
  int const fluids = gas == nullptr ? 1 : gas->fluids().count;
  for (int k = 0; k < fluids; ++k) {
    found.push_back({Kind::mass, relative.mass[k], 1.0, round_off});
    found.back().fluid = k;
  }
  if (regions.empty()) found.push_back({Kind::gas_energy, relative.energy, 1.0, round_off});
  if (gas != nullptr) {
    double const of_charges = charge_energy(*this);
    double const fail = limits.fail > 0.0 ? guards_fail : 0.0;
    double const added = audit.guard_energy + accounts().floored.energy;
    found.push_back({Kind::guard_energy, added, of_charges > 0.0 ? of_charges : energy.scale, guards_warn, fail,
                     of_charges > 0.0 ? 0.0 : drift_round_off * energy.all});
    double const mass = setup.charges.empty() ? audit.initial.mass[0] : audit.initial.mass[gas::products_fluid];
    found.push_back({Kind::guard_mass, audit.guard_mass, mass, guards_warn, fail});
    if (!setup.charges.empty()) found.push_back({Kind::unlit, audit.memory.unlit, 1.0, unlit_warn});
  }
  if (regions.empty()) return found;
  if (gas == nullptr) {
    found.push_back({Kind::guard_energy, accounts().floored.energy, energy.scale, guards_warn,
                     limits.fail > 0.0 ? guards_fail : 0.0, drift_round_off * energy.all});
  }
  // Velocities stand half a step before positions and stress (a leapfrog): while loads set something in motion, the
  // energies of the same time do not add up. The work that they did since the look before bounds that; it is a small
  // fraction of the scale but in the first moments of a load.
  double const work = accounts().outer_work;
  double const fresh = std::max(audit.memory.fresh, std::abs(work - audit.memory.work));
  double const drift = larger_size(audit.memory.drift, energy.error());
  double const smallest = std::max(drift_round_off * energy.all, noise * stiffness(*this));
  found.push_back({Kind::drift, drift, energy.scale, limits.warn, limits.fail, smallest, fresh});
  if (coupled()) {
    found.push_back({Kind::ledger, audit.memory.surplus, audit.memory.gas, limits.warn > 0.0 ? ledger_warn : 0.0,
                     limits.fail > 0.0 ? ledger_fail : 0.0});
  }
  return found;
}

std::string World::in_words(AuditFinding const& f) const {
  double const percent = 100.0 * f.share();
  switch (f.kind) {
    case Kind::mass:
      return fmt::format("the mass of {} has a relative error of {:.2g}",
                         gas == nullptr ? "the particles" : fluid_in_words(setup, f.fluid), f.amount);
    case Kind::gas_energy: return fmt::format("the energy has a relative error of {:.2g}", f.amount);
    case Kind::guard_energy:
      return fmt::format("guards added {:.3g} J, {:.3g} % of {}", f.amount, percent,
                         charge_energy(*this) > 0.0 ? "the energy of the charges" : "the reference energy");
    case Kind::guard_mass:
      return fmt::format("guards added {:.3g} kg, {:.3g} % of {}", f.amount, percent,
                         !setup.charges.empty() ? "the mass of the charges" : "the gas");
    case Kind::drift:
      return fmt::format("the energy has drifted by {:+.3g} J, {:+.3g} % of the reference energy", f.amount, percent);
    case Kind::ledger:
      return fmt::format(
          "the ledger contains {:.3g} kg of gas that belongs neither to cells nor to particles, {:.3g} % of the mass "
          "of the gas particles",
          f.amount, percent);
    case Kind::unlit:
      return fmt::format(
          "explosive was compressed by {:.2g} % before it was initiated, but the model gives no strength to unburnt "
          "explosive; initiate it when the shock of its neighbour arrives, or simulate the charges separately",
          percent);
  }
  return "";
}

bool World::for_comparison() const {
  bool const scheme = gas != nullptr && setup.numerics.scheme == Scheme::lax_wendroff;
  return scheme || std::ranges::any_of(setup.mpm_regions, [](MpmRegion const& region) {
           return region.transport == bridge::Transport::paper;
         });
}

Verdict World::verdict() const {
  Verdict verdict;
  verdict.drift_judged = regions.empty() || setup.audit.warn > 0.0;
  for (AuditFinding const& finding : audit_findings()) {
    if (finding.tells()) verdict.reasons.push_back(in_words(finding));
  }
  verdict.balanced = verdict.reasons.empty();
  return verdict;
}

}  // namespace brisance::run
