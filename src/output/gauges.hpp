/// Gauge histories: one CSV file per gauge while the run lasts, and what an engineer reads off them at its end.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "empirical/kingery_bulmash.hpp"
#include "observe/blast_wave.hpp"
#include "run/world.hpp"

namespace brisance::output {

/// Kingery-Bulmash values at `distance` [m] from the case's charge in its ambient air: pressures by the explosive's TNT
/// equivalent for pressure, times and impulses by that for impulse, each absent where it is unknown; arrival counts
/// from the start of the calculation. All absent unless the case names the burst type, has one charge, and the ambient
/// fluid is an ideal gas.
[[nodiscard]] empirical::Blast empirical_blast(run::Case const& setup, double distance);

/// A gauge's results beside the empirical ones.
struct GaugeSummary {
  std::string name;
  Vec3 position{0.0, 0.0, 0.0};
  observe::BlastWave wave;
  std::optional<double> distance;         ///< to the centre of the nearest charge [m]
  std::optional<double> scaled_distance;  ///< distance / cube root of its mass of TNT, if known [m/kg^(1/3)]
  empirical::Blast empirical;
};

/// A name that is safe as a file name: letters, digits, '.', '-' and '_' stay, everything else becomes '_'.
[[nodiscard]] std::string sanitised(std::string const& name);

/// A file of its own for each gauge: paths relative to the output folder.
[[nodiscard]] std::vector<std::string> gauge_file_names(std::vector<std::string> const& gauges);

/// The same, and makes the folder of these files.
[[nodiscard]] std::vector<std::string> gauge_files(std::filesystem::path const& folder,
                                                   std::vector<std::string> const& gauges);

/// Text as one CSV field (RFC 4180).
[[nodiscard]] std::string csv_field(std::string const& text);

/// The growing CSV files `gauges/NAME.csv`.
class GaugeFiles {
 public:
  /// Creates the files of all gauges with their headers. `ambient_pressure` [Pa] is what overpressure counts from.
  GaugeFiles(std::filesystem::path const& folder, std::vector<run::GaugeHistory> const& gauges,
             double ambient_pressure);

  /// Appends the records that came since the last call.
  void append(std::vector<run::GaugeHistory> const& gauges);

  /// Path of each gauge's file, relative to the output folder.
  [[nodiscard]] std::vector<std::string> const& names() const { return names_; }

 private:
  struct Stream {
    std::filesystem::path path;
    std::size_t written = 0;
    double impulse = 0.0;
  };
  double ambient_pressure_;
  std::vector<std::string> names_;
  std::vector<Stream> streams_;
};

/// Summaries of all gauges of a case. The empirical values are given for a single charge whose case names the burst
/// type.
[[nodiscard]] std::vector<GaugeSummary> summarise(run::Case const& setup, std::vector<run::GaugeHistory> const& gauges);

/// Writes `summary.csv` and `summary.json`, the latter with `more` keys.
void write_summary(std::filesystem::path const& folder, run::Case const& setup,
                   std::vector<GaugeSummary> const& summaries, std::vector<std::string> const& files,
                   nlohmann::json const& more);
void write_summary(std::filesystem::path const& folder, run::Case const& setup,
                   std::vector<GaugeSummary> const& summaries, std::vector<std::string> const& files);

}  // namespace brisance::output
