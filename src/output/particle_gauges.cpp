#include "output/particle_gauges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "observe/gauge_columns.hpp"
#include "output/file.hpp"
#include "output/gauges.hpp"
#include "output/json.hpp"
#include "output/zones.hpp"
#include "run/system.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

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
  return {{"points", s.particles},
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

nlohmann::json to_json(observe::ParticleSummary const& s) {
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

std::string csv_row(observe::ParticleSummary const& s) {
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

ParticleGaugeFiles::ParticleGaugeFiles(fs::path const& folder, run::System const& system,
                                       observe::Gauges const& histories)
    : folder_(folder) {
  if (system.regions.empty()) return;
  // After those of the gas, whose files they shall not share.
  std::vector<std::string> gauges;
  for (auto const& history : histories.gas) gauges.push_back(history.gauge.name);
  for (auto const& history : histories.particles) gauges.push_back(history.gauge.name);
  names_ = gauge_files(folder, gauges);
  names_.erase(names_.begin(), names_.begin() + static_cast<std::ptrdiff_t>(histories.gas.size()));
  written_.assign(names_.size(), 0);
  for (std::size_t g = 0; g < names_.size(); ++g) {
    bool const rides = histories.particles[g].gauge.point.has_value();
    write_file(folder / names_[g],
               rides ? observe::header_of(observe::particle_columns()) : observe::header_of(observe::body_columns()));
  }
  std::string header = "time [s]";
  for (auto const& body : system.bodies) {
    std::string const name = column_name(body.name);
    header += fmt::format(",{0}: kinetic_energy [J],{0}: internal_energy [J],{0}: plastic_work [J]", name);
  }
  write_file(folder / "energies.csv", header + "\n");
}

void ParticleGaugeFiles::append(observe::Gauges const& histories) {
  for (std::size_t g = 0; g < names_.size(); ++g) {
    auto const& history = histories.particles[g];
    std::string text;
    std::size_t const count = history.gauge.point ? history.particles.size() : history.bodies.size();
    std::size_t const sampled = observe::sampled_columns(observe::particle_columns());
    for (std::size_t i = written_[g]; i < count; ++i) {
      if (history.gauge.point) {
        auto const& r = history.particles[i];
        text += observe::row_of(observe::particle_columns(), r.time,
                                observe::ParticleMoment{r, history.sampled.data() + sampled * i});
      } else {
        auto const& r = history.bodies[i];
        text += observe::row_of(observe::body_columns(), r.time, observe::BodyMoment{r.sums});
      }
    }
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

nlohmann::json write_particle_table(fs::path const& path, run::System const& system, observe::Gauges const& gauges,
                                    std::vector<std::string> const& files) {
  auto const particles = observe::summarise_particles(system, gauges);
  auto const bodies = observe::summarise_bodies(system, gauges);
  std::string csv =
      "gauge,watches,body,x [m],y [m],z [m],peak_displacement [m],time_of_peak [s],component,"
      "peak_component_displacement [m],final_displacement_x [m],final_displacement_y [m],final_displacement_z [m],"
      "peak_velocity [m/s],time_of_peak_velocity [s],peak_mises [Pa],plastic_strain,kinetic_energy_start [J],"
      "kinetic_energy_end [J],internal_energy_start [J],internal_energy_end [J],plastic_work [J],damaged_mass [kg]\n";
  for (auto const& s : particles) csv += csv_row(s);
  for (auto const& s : bodies) csv += csv_row(s);
  replace_file(path, csv);

  // The files are in the order of the deck's gauges; particles and bodies have lists of their own.
  nlohmann::json particle_gauges = nlohmann::json::array();
  nlohmann::json body_list = nlohmann::json::array();
  for (auto const& s : particles) particle_gauges.push_back(to_json(s));
  for (auto const& s : bodies) body_list.push_back(to_json(s));
  std::size_t particle = 0;
  std::size_t body = 0;
  for (std::size_t g = 0; g < files.size(); ++g) {
    bool const rides = gauges.particles[g].gauge.point.has_value();
    (rides ? particle_gauges[particle++] : body_list[body++])["file"] = files[g];
  }
  nlohmann::json out{{"point_gauges", std::move(particle_gauges)}, {"bodies", std::move(body_list)}};
  if (auto zones = broken_zones_json(system); !zones.empty()) out["broken_zones"] = std::move(zones);
  return out;
}

void write_particle_summary(fs::path const& folder, run::System const& system, observe::Gauges const& gauges,
                            std::vector<std::string> const& files) {
  nlohmann::json summary{{"units", "SI: m, s, kg, m/s, J, Pa"}, {"gauges", nlohmann::json::array()}, {"burst", "none"}};
  summary.update(write_particle_table(folder / "summary.csv", system, gauges, files));
  replace_file(folder / "summary.json", summary.dump(2) + "\n");
}

}  // namespace brisance::output
