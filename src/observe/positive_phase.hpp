/// Where a gauge's blast stands while the simulation goes on.
#pragma once

#include <cstddef>
#include <vector>

#include "observe/gauges.hpp"

namespace brisance::observe {

/// Overpressure, as a fraction of the ambient pressure, below which nothing has reached a gauge: round-off and the
/// unrest of blocks that have just been woken stay below it, and no blast that anybody asks for does.
inline constexpr double arrival_threshold = 1e-4;

/// Follows a history that grows. The positive phase begins with the first overpressure above the threshold and is over
/// with the first return to the ambient pressure that comes after it.
class PositivePhase {
 public:
  explicit PositivePhase(double ambient_pressure) : ambient_(ambient_pressure) {}

  /// Reads the records that came since the last call.
  void update(std::vector<GaugeRecord> const& records) {
    for (; read_ < records.size(); ++read_) {
      double const overpressure = records[read_].pressure - ambient_;
      over_ = over_ || (arrived_ && overpressure <= 0.0);
      arrived_ = arrived_ || overpressure > arrival_threshold * ambient_;
    }
  }
  [[nodiscard]] bool arrived() const { return arrived_; }
  [[nodiscard]] bool over() const { return over_; }

 private:
  double ambient_;
  std::size_t read_ = 0;
  bool arrived_ = false;
  bool over_ = false;
};

/// The same of a whole history: has the wave arrived, and has the overpressure been back at zero since?
[[nodiscard]] inline bool past_positive_phase(GaugeHistory const& history, double ambient_pressure) {
  PositivePhase phase(ambient_pressure);
  phase.update(history.records);
  return phase.over();
}

}  // namespace brisance::observe
