#include "output/point_gauges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "output/file.hpp"
#include "output/gauges.hpp"
#include "output/json.hpp"
#include "output/zones.hpp"
#include "run/system.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

char const* point_header =
    "time [s],x [m],y [m],z [m],displacement_x [m],displacement_y [m],displacement_z [m],velocity_x [m/s],"
    "velocity_y [m/s],velocity_z [m/s],pressure [Pa],mises [Pa],density [kg/m3],plastic_strain [1],temperature [K],"
    "damage [1]\n";
char const* body_header =
    "time [s],mass [kg],momentum_x [kg m/s],momentum_y [kg m/s],momentum_z [kg m/s],centre_x [m],centre_y [m],"
    "centre_z [m],velocity_x [m/s],velocity_y [m/s],velocity_z [m/s],kinetic_energy [J],internal_energy [J],"
    "plastic_work [J],largest_displacement [m],damaged_mass [kg]\n";

std::string row(std::initializer_list<double> values) {
  std::string text;
  for (double const v : values) fmt::format_to(std::back_inserter(text), "{}{:.10g}", text.empty() ? "" : ",", v);
  return text + "\n";
}

std::string row_of(observe::PointRecord const& r) {
  auto const& [x, u, v] = std::tie(r.position, r.displacement, r.velocity);
  return row({r.time, x[0], x[1], x[2], u[0], u[1], u[2], v[0], v[1], v[2], r.pressure, r.mises, r.density,
              r.plastic_strain, r.temperature, r.damage});
}

std::string row_of(observe::BodyRecord const& r) {
  auto const& s = r.sums;
  Vec3 const v = observe::mean_velocity(s);
  return row({r.time, s.mass, s.momentum[0], s.momentum[1], s.momentum[2], s.centre[0], s.centre[1], s.centre[2], v[0],
              v[1], v[2], s.kinetic_energy, s.internal_energy, s.plastic_work, s.largest_displacement, s.damaged_mass});
}

/// A comma, a quote or a line break would end a column's name.
std::string column_name(std::string name) {
  for (char& c : name)
    if (c == ',' || c == '"' || c == '\n' || c == '\r') c = '_';
  return name;
}

nlohmann::json to_json(observe::Peak const& peak) {
  return {{"value", json_or_null(peak.value)}, {"time", json_or_null(peak.time)}};
}

nlohmann::json to_json(mpm::BodySums const& s) {
  return {{"points", s.points},
          {"mass", json_or_null(s.mass)},
          {"momentum", s.momentum},
          {"centre", s.centre},
          {"velocity", observe::mean_velocity(s)},
          {"kinetic_energy", json_or_null(s.kinetic_energy)},
          {"internal_energy", json_or_null(s.internal_energy)},
          {"plastic_work", json_or_null(s.plastic_work)},
          {"largest_displacement", json_or_null(s.largest_displacement)},
          {"damaged_mass", json_or_null(s.damaged_mass)}};
}

nlohmann::json to_json(observe::PointSummary const& s) {
  return {{"name", s.name},
          {"body", s.body},
          {"position", s.position},
          {"peak_displacement", to_json(s.displacement)},
          {"component", std::string(1, "xyz"[s.component])},
          {"component_displacement", to_json(s.component_displacement)},
          {"final_displacement", s.final_displacement},
          {"peak_velocity", to_json(s.velocity)},
          {"peak_mises", to_json(s.mises)},
          {"plastic_strain", json_or_null(s.plastic_strain)},
          {"damage", json_or_null(s.damage)},
          {"left_the_domain", s.lost}};
}

nlohmann::json to_json(observe::BodySummary const& s) {
  return {{"name", s.name},
          {"body", s.body},
          {"material", s.material},
          {"start", to_json(s.start)},
          {"end", to_json(s.end)},
          {"peak_displacement", to_json(s.displacement)},
          {"peak_velocity", to_json(s.velocity)}};
}

std::string csv_row(observe::PointSummary const& s) {
  auto const& x = s.position;
  auto const& u = s.final_displacement;
  return fmt::format(
      "{},point,{},{:.8g},{:.8g},{:.8g},{:.8g},{:.8g},{},{:.8g},{:.8g},{:.8g},{:.8g},{:.8g},{:.8g},{:.8g},{:.8g},"
      ",,,,,\n",
      csv_field(s.name), csv_field(s.body), x[0], x[1], x[2], s.displacement.value, s.displacement.time,
      "xyz"[s.component], s.component_displacement.value, u[0], u[1], u[2], s.velocity.value, s.velocity.time,
      s.mises.value, s.plastic_strain);
}

std::string csv_row(observe::BodySummary const& s) {
  auto const& x = s.start.centre;
  Vec3 const u = s.end.centre - x;
  return fmt::format(
      "{},body,{},{:.8g},{:.8g},{:.8g},{:.8g},{:.8g},,,{:.8g},{:.8g},{:.8g},{:.8g},{:.8g},,,{:.8g},{:.8g},{:.8g},"
      "{:.8g},{:.8g},{:.8g}\n",
      csv_field(s.name), csv_field(s.body), x[0], x[1], x[2], s.displacement.value, s.displacement.time, u[0], u[1],
      u[2], s.velocity.value, s.velocity.time, s.start.kinetic_energy, s.end.kinetic_energy, s.start.internal_energy,
      s.end.internal_energy, s.end.plastic_work, s.end.damaged_mass);
}

}  // namespace

PointGaugeFiles::PointGaugeFiles(fs::path const& folder, run::System const& system, observe::Gauges const& histories)
    : folder_(folder) {
  if (system.points == nullptr) return;
  // After those of the gas, whose files they shall not share.
  std::vector<std::string> gauges;
  for (auto const& history : histories.gas) gauges.push_back(history.gauge.name);
  for (auto const& history : histories.points) gauges.push_back(history.gauge.name);
  names_ = gauge_files(folder, gauges);
  names_.erase(names_.begin(), names_.begin() + static_cast<std::ptrdiff_t>(histories.gas.size()));
  written_.assign(names_.size(), 0);
  for (std::size_t g = 0; g < names_.size(); ++g)
    write_file(folder / names_[g], histories.points[g].gauge.point ? point_header : body_header);
  std::string header = "time [s]";
  for (auto const& body : system.bodies) {
    std::string const name = column_name(body.name);
    header += fmt::format(",{0}: kinetic_energy [J],{0}: internal_energy [J],{0}: plastic_work [J]", name);
  }
  write_file(folder / "energies.csv", header + "\n");
}

void PointGaugeFiles::append(observe::Gauges const& histories) {
  for (std::size_t g = 0; g < names_.size(); ++g) {
    auto const& history = histories.points[g];
    std::string text;
    std::size_t const count = history.gauge.point ? history.points.size() : history.bodies.size();
    for (std::size_t i = written_[g]; i < count; ++i)
      text += history.gauge.point ? row_of(history.points[i]) : row_of(history.bodies[i]);
    written_[g] = count;
    if (!text.empty()) append_to_file(folder_ / names_[g], text);
  }
  if (histories.bodies.empty()) return;
  std::string text;
  for (std::size_t const count = histories.bodies[0].size(); energies_ < count; ++energies_) {
    fmt::format_to(std::back_inserter(text), "{:.10g}", histories.bodies[0][energies_].time);
    for (auto const& history : histories.bodies) {
      auto const& s = history[energies_].sums;
      fmt::format_to(std::back_inserter(text), ",{:.10g},{:.10g},{:.10g}", s.kinetic_energy, s.internal_energy,
                     s.plastic_work);
    }
    text += "\n";
  }
  if (!text.empty()) append_to_file(folder_ / "energies.csv", text);
}

nlohmann::json write_point_table(fs::path const& path, run::System const& system, observe::Gauges const& gauges,
                                 std::vector<std::string> const& files) {
  auto const points = observe::summarise_points(system, gauges);
  auto const bodies = observe::summarise_bodies(system, gauges);
  std::string csv =
      "gauge,watches,body,x [m],y [m],z [m],peak_displacement [m],time_of_peak [s],component,"
      "peak_component_displacement [m],final_displacement_x [m],final_displacement_y [m],final_displacement_z [m],"
      "peak_velocity [m/s],time_of_peak_velocity [s],peak_mises [Pa],plastic_strain,kinetic_energy_start [J],"
      "kinetic_energy_end [J],internal_energy_start [J],internal_energy_end [J],plastic_work [J],damaged_mass [kg]\n";
  for (auto const& s : points) csv += csv_row(s);
  for (auto const& s : bodies) csv += csv_row(s);
  replace_file(path, csv);

  // The files are in the order of the deck's gauges; points and bodies have lists of their own.
  nlohmann::json point_gauges = nlohmann::json::array();
  nlohmann::json body_list = nlohmann::json::array();
  for (auto const& s : points) point_gauges.push_back(to_json(s));
  for (auto const& s : bodies) body_list.push_back(to_json(s));
  std::size_t point = 0;
  std::size_t body = 0;
  for (std::size_t g = 0; g < files.size(); ++g) {
    bool const rides = gauges.points[g].gauge.point.has_value();
    (rides ? point_gauges[point++] : body_list[body++])["file"] = files[g];
  }
  nlohmann::json out{{"point_gauges", std::move(point_gauges)}, {"bodies", std::move(body_list)}};
  if (auto zones = broken_zones_json(system); !zones.empty()) out["broken_zones"] = std::move(zones);
  return out;
}

void write_point_summary(fs::path const& folder, run::System const& system, observe::Gauges const& gauges,
                         std::vector<std::string> const& files) {
  nlohmann::json summary{{"units", "SI: m, s, kg, m/s, J, Pa"}, {"gauges", nlohmann::json::array()}, {"burst", "none"}};
  summary.update(write_point_table(folder / "summary.csv", system, gauges, files));
  replace_file(folder / "summary.json", summary.dump(2) + "\n");
}

}  // namespace brisance::output
