/// The world: the whole state of one calculation.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "gas/gas.hpp"
#include "grid/grid.hpp"
#include "run/audit.hpp"
#include "run/panels.hpp"
#include "run/reports.hpp"

namespace brisance {
class Archive;
}

namespace brisance::run {

struct Clock {
  double time = 0.0;  ///< [s]
  double dt = 0.0;    ///< length of the last step [s]
  long step = 0;
  long gas_steps = 0;    ///< steps of the gas within these
  long point_steps = 0;  ///< of the points
};

/// Wall-clock seconds per phase of the step and of the output.
using Timings = std::map<std::string, double>;

/// Holds what a calculation moves and what is known of it. `setup::build` fills it, `advance` moves it, `observe` looks
/// at it.
class World {
  std::unique_ptr<grid::Grid const> grid_;  ///< keeps its place when the world moves

 public:
  /// A case and its grid, with nothing in it.
  explicit World(Case setup);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) = delete;

  Case setup;
  grid::Grid const& grid;
  std::unique_ptr<gas::Gas> gas;           ///< null where the case has bodies in a vacuum
  std::unique_ptr<mpm::Mpm> points;        ///< null where it has none
  std::unique_ptr<bridge::Bridge> bridge;  ///< joins the two where both are there
  std::unique_ptr<Panels> panels;          ///< null where the case has none
  Clock clock;
  Audit audit;
  std::vector<ChargeReport> charges;
  std::vector<RegionReport> regions;      ///< what became of each region of the gas
  std::vector<ObstacleReport> obstacles;  ///< and of each obstacle
  std::vector<StartReport> starts;        ///< of each charge, where the case starts by a remap
  std::vector<BodyReport> bodies;
  Timings timings;
  std::optional<double> awake_since;  ///< when the MPM region woke [s]

  /// Is the end time or the step limit reached, or have all bodies left the domain?
  [[nodiscard]] bool finished() const;
  /// Of a calculation of bodies alone: none of their points is left.
  [[nodiscard]] bool bodies_have_left() const;
  /// Number of cells of the blocks that are awake.
  [[nodiscard]] long active_cells() const;
  /// Sums over the domain, in a fixed order.
  [[nodiscard]] Totals totals() const;
  /// The body of the gas points, -1 without an MPM region.
  [[nodiscard]] int gas_body() const { return bridge == nullptr ? -1 : bridge->gas_body(); }
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

 private:
  [[nodiscard]] Totals gas_totals() const;
  [[nodiscard]] Totals point_totals() const;
  [[nodiscard]] Totals ledger_totals() const;
  [[nodiscard]] double gas_rest_energy() const;
  void take_account();
  [[nodiscard]] double energy_at_work() const;
  [[nodiscard]] bool audit_is_due() const;
  [[nodiscard]] std::string in_words(AuditFinding const& finding) const;
  double gas_rest_energy_ = 0.0;  ///< of gas cells and gas points in the ambient state [J]
};

/// Largest stable time step of the present state [s].
[[nodiscard]] double stable_step(World const& world);

/// One step n -> n+1, not beyond `latest` [s]. Returns dt. Throws NumericalError.
double advance(World& world, double latest);

}  // namespace brisance::run
