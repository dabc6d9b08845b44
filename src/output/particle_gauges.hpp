/// Gauges of the material points: one CSV file per gauge while the run lasts, and what is read off them at its end.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "observe/particle_summary.hpp"

namespace brisance::output {

/// The growing CSV files `gauges/NAME.csv`, and `energies.csv`: energies of every body.
class ParticleGaugeFiles {
 public:
  /// Creates the files with their headers; none without material points.
  ParticleGaugeFiles(std::filesystem::path const& folder, run::System const& system, observe::Gauges const& gauges);

  /// Appends the records that came since the last call.
  void append(observe::Gauges const& gauges);

  /// Path of each gauge's file, relative to the output folder.
  [[nodiscard]] std::vector<std::string> const& names() const { return names_; }

 private:
  std::filesystem::path folder_;
  std::vector<std::string> names_;
  std::vector<std::size_t> written_;  ///< records of each gauge
  std::size_t energies_ = 0;          ///< rows
};

/// Writes the table of the gauges on particles and bodies, and returns the same as the lists "point_gauges" and
/// "bodies".
[[nodiscard]] nlohmann::json write_particle_table(std::filesystem::path const& path, run::System const& system,
                                                  observe::Gauges const& gauges, std::vector<std::string> const& files);

/// Writes `summary.csv` and `summary.json` of a run of material points.
void write_particle_summary(std::filesystem::path const& folder, run::System const& system,
                            observe::Gauges const& gauges, std::vector<std::string> const& files);

}  // namespace brisance::output
