/// Gauge histories: one CSV file per gauge while the run lasts, and what an engineer reads off them at its end.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "observe/blast_summary.hpp"

namespace brisance::output {

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
  GaugeFiles(std::filesystem::path const& folder, std::vector<observe::GaugeHistory> const& gauges,
             double ambient_pressure);

  /// Appends the records that came since the last call.
  void append(std::vector<observe::GaugeHistory> const& gauges);

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

/// Writes `summary.csv` and `summary.json`, the latter with `more` keys.
void write_summary(std::filesystem::path const& folder, run::Case const& setup,
                   std::vector<observe::GaugeSummary> const& summaries, std::vector<std::string> const& files,
                   nlohmann::json const& more);
void write_summary(std::filesystem::path const& folder, run::Case const& setup,
                   std::vector<observe::GaugeSummary> const& summaries, std::vector<std::string> const& files);

}  // namespace brisance::output
