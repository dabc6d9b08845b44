/// Gauges of the material points: one CSV file per gauge while the run lasts, and what is read off them at its end.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "run/world.hpp"

namespace brisance::output {

/// The largest value of a history and when it was.
struct Peak {
  double value = 0.0;
  double time = 0.0;  ///< [s]
};

/// What a gauge on a point has seen.
struct PointSummary {
  std::string name;
  std::string body;
  Vec3 position{0.0, 0.0, 0.0};            ///< at the start [m]
  Peak displacement;                       ///< magnitude [m]
  int component = 0;                       ///< direction of the largest displacement: 0: x
  Peak component_displacement;             ///< in that direction, with its sign [m]
  Vec3 final_displacement{0.0, 0.0, 0.0};  ///< at the end of the record [m]
  Peak velocity;                           ///< magnitude [m/s]
  Peak mises;                              ///< [Pa]
  double plastic_strain = 0.0;             ///< largest
  double damage = 0.0;                     ///< largest
  bool lost = false;                       ///< the point left the domain, and the record ended
};

/// What became of a body from the start to the end.
struct BodySummary {
  std::string name;  ///< of the gauge; empty: the body has none
  std::string body;
  std::string material;
  mpm::BodySums start;
  mpm::BodySums end;
  Peak displacement;  ///< largest displacement of any of its points [m]
  Peak velocity;      ///< of its centre of mass [m/s]
};

[[nodiscard]] PointSummary summarise_point(run::World const& world, run::PointGaugeHistory const& history);
/// One of each gauge that watches a body, then one of each body without such a gauge.
[[nodiscard]] std::vector<BodySummary> summarise_bodies(run::World const& world);
/// Of the gauges that ride on a point.
[[nodiscard]] std::vector<PointSummary> summarise_points(run::World const& world);

/// The growing CSV files `gauges/NAME.csv`, and `energies.csv`: energies of every body.
class PointGaugeFiles {
 public:
  /// Creates the files with their headers; none without material points.
  PointGaugeFiles(std::filesystem::path const& folder, run::World const& world);

  /// Appends the records that came since the last call.
  void append(run::World const& world);

  /// Path of each gauge's file, relative to the output folder.
  [[nodiscard]] std::vector<std::string> const& names() const { return names_; }

 private:
  std::filesystem::path folder_;
  std::vector<std::string> names_;
  std::vector<std::size_t> written_;  ///< records of each gauge
  std::size_t energies_ = 0;          ///< rows
};

/// Writes the table of the gauges on points and bodies, and returns the same as the lists "point_gauges" and "bodies".
[[nodiscard]] nlohmann::json write_point_table(std::filesystem::path const& path, run::World const& world,
                                               std::vector<std::string> const& files);

/// Writes `summary.csv` and `summary.json` of a run of material points.
void write_point_summary(std::filesystem::path const& folder, run::World const& world,
                         std::vector<std::string> const& files);

}  // namespace brisance::output
