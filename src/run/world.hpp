/// The world: the system that is simulated, and the audit that follows it.
#pragma once

#include <string>
#include <vector>

#include "core/simd.hpp"
#include "run/audit.hpp"
#include "run/system.hpp"

namespace brisance {
class Archive;
}

namespace brisance::run {

class World : public System {
 public:
  using System::System;

  Audit audit;

  /// Sums over the domain, in a fixed order.
  [[nodiscard]] Totals totals() const;
  /// To be called once when all is in place: from here on the audit counts.
  void start_audit();
  /// Brings `audit.current`, `audit.outflow` and the guard counts up to date.
  void update_audit();
  /// To be called after every step: looks at the guards, and some thousand times in a run at all the rest. Throws
  /// NumericalError where what it finds is beyond the limits of the case.
  void follow_audit();
  /// The energy as of the last `update_audit`.
  [[nodiscard]] EnergyBalance energy_balance() const;
  /// All that the audit looks at, as of the last `update_audit`.
  [[nodiscard]] std::vector<AuditFinding> audit_findings() const;
  [[nodiscard]] Verdict verdict() const;
  /// Schemes that are there for comparison only run on whatever the audit finds.
  [[nodiscard]] bool for_comparison() const;
  /// Writes the whole state into a checkpoint or takes it from one: the world is then the one that was written, to the
  /// last bit. Throws IoError where the checkpoint is not of this case; the state is worthless afterwards.
  void archive(Archive& a);
  /// The vector instructions of the run that wrote the checkpoint: others round sums of products differently.
  SimdSet written_with = simd_set();

 private:
  void archive_forest(Archive& a);
  void archive_awakening(Archive& a);
  [[nodiscard]] Totals gas_totals() const;
  [[nodiscard]] Totals particle_totals() const;
  [[nodiscard]] Totals ledger_totals() const;
  [[nodiscard]] double gas_rest_energy() const;
  void take_account();
  void remember_ledgers();
  [[nodiscard]] double energy_at_work() const;
  [[nodiscard]] bool audit_is_due() const;
  [[nodiscard]] std::string in_words(AuditFinding const& finding) const;
  double gas_rest_energy_ = 0.0;  ///< of gas cells and gas particles in the ambient state [J]
};

}  // namespace brisance::run
