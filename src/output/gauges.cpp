#include "output/gauges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "observe/gauge_columns.hpp"
#include "observe/positive_phase.hpp"
#include "output/file.hpp"
#include "output/json.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

std::optional<double> ratio(std::optional<double> value, std::optional<double> reference) {
  if (!value || !reference || *reference == 0.0) return std::nullopt;
  return *value / *reference;
}

/// The incident quantities under the names that the gauges' results have.
nlohmann::json blast_json(empirical::Blast const& blast) {
  return {{"peak_overpressure", json_or_null(blast.incident_overpressure)},
          {"arrival_time", json_or_null(blast.arrival)},
          {"positive_duration", json_or_null(blast.duration)},
          {"positive_impulse", json_or_null(blast.incident_impulse)}};
}

nlohmann::json negative_json(std::optional<observe::NegativePhase> const& phase) {
  if (!phase) return {};
  return {{"peak", json_or_null(phase->peak)},
          {"time", json_or_null(phase->time)},
          {"impulse", json_or_null(phase->impulse)},
          {"duration", json_or_null(phase->duration)},
          {"complete", phase->duration.has_value()}};
}

std::string cell(std::optional<double> value) { return value ? fmt::format("{:.8g}", *value) : ""; }

/// The empirical curve for plots: logarithmically spaced distances over the whole range of the fits. The explosive's
/// TNT equivalent for pressure, by which distances scale, must be known.
nlohmann::json empirical_curve(run::Case const& setup) {
  auto const& charge = setup.charges.front();
  double const unit = std::cbrt(charge.mass * *charge.explosive.tnt_equivalent_pressure);
  constexpr int points = 81;
  constexpr double nearest = 0.05;  // scaled distances [m/kg^(1/3)]
  constexpr double farthest = 40.0;
  nlohmann::json rows = nlohmann::json::array();
  for (int i = 0; i < points; ++i) {
    double const z = nearest * std::pow(farthest / nearest, double(i) / (points - 1));
    auto const blast = observe::empirical_blast(setup, z * unit);
    if (!blast.incident_overpressure) continue;
    nlohmann::json row = blast_json(blast);
    row["scaled_distance"] = z;
    row["distance"] = z * unit;
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string burst_name(run::Burst burst) {
  switch (burst) {
    case run::Burst::none: return "none";
    case run::Burst::spherical: return "spherical";
    case run::Burst::hemispherical: return "hemispherical";
  }
  return "";
}

char const* const summary_header =
    "gauge,x [m],y [m],z [m],distance [m],scaled_distance [m/kg^(1/3)],peak_overpressure [Pa],time_of_peak [s],"
    "front_overpressure [Pa],arrival_time [s],positive_duration [s],positive_impulse [Pa s],positive_phase_complete,"
    "KB_peak_overpressure [Pa],KB_arrival_time [s],KB_positive_duration [s],KB_positive_impulse [Pa s],"
    "ratio_peak_overpressure,ratio_front_overpressure,ratio_arrival_time,ratio_positive_duration,ratio_positive_"
    "impulse,largest_impulse [Pa s],time_of_largest_impulse [s],final_overpressure [Pa],negative_peak [Pa],time_of_"
    "negative_peak [s],negative_impulse [Pa s],negative_duration [s],peak_front_overpressure [Pa],half_width [s],"
    "cells_per_half_width,expected_clipping,reflected\n";

/// A gauge's results over the empirical ones.
struct Ratios {
  std::optional<double> peak;
  std::optional<double> front;
  std::optional<double> arrival;
  std::optional<double> duration;
  std::optional<double> impulse;
};

Ratios ratios_of(observe::GaugeSummary const& s) {
  auto const& w = s.wave;
  auto const& e = s.empirical;
  Ratios r;
  r.peak = ratio(w.arrival_time ? std::optional(w.peak_overpressure) : std::nullopt, e.incident_overpressure);
  r.front = ratio(w.front_overpressure, e.incident_overpressure);
  r.arrival = ratio(w.arrival_time, e.arrival);
  r.duration = ratio(w.positive_duration, e.duration);
  // An impulse that the record cuts off cannot be compared.
  r.impulse = ratio(w.positive_duration ? std::optional(w.positive_impulse) : std::nullopt, e.incident_impulse);
  return r;
}

std::string csv_row(observe::GaugeSummary const& s) {
  auto const& w = s.wave;
  auto const& e = s.empirical;
  bool const complete = w.positive_duration.has_value();
  Ratios const r = ratios_of(s);
  std::string row = fmt::format(
      "{},{:.8g},{:.8g},{:.8g},{},{},{:.8g},{:.8g},{},{},{},{:.8g},{},{},{},{},{},{},{},{},{},{}", csv_field(s.name),
      s.position[0], s.position[1], s.position[2], cell(s.distance), cell(s.scaled_distance), w.peak_overpressure,
      w.peak_time, cell(w.front_overpressure), cell(w.arrival_time), cell(w.positive_duration), w.positive_impulse,
      complete ? "yes" : "no", cell(e.incident_overpressure), cell(e.arrival), cell(e.duration),
      cell(e.incident_impulse), cell(r.peak), cell(r.front), cell(r.arrival), cell(r.duration), cell(r.impulse));
  auto const of_negative = [&](auto value) { return w.negative ? cell((*w.negative).*value) : ""; };
  row += fmt::format(",{:.8g},{:.8g},{:.8g},{},{},{},{},{},{},{},{},{}\n", w.largest_impulse, w.largest_impulse_time,
                     w.final_overpressure, of_negative(&observe::NegativePhase::peak),
                     of_negative(&observe::NegativePhase::time), of_negative(&observe::NegativePhase::impulse),
                     of_negative(&observe::NegativePhase::duration), cell(w.peak_front_overpressure),
                     cell(w.half_width), cell(w.cells_per_half_width), cell(w.expected_clipping),
                     w.half_width ? w.reflected ? "yes" : "no" : "");
  return row;
}

nlohmann::json to_json(observe::GaugeSummary const& s, std::string const& file) {
  auto const& w = s.wave;
  Ratios const r = ratios_of(s);
  return {{"name", s.name},
          {"file", file},
          {"position", s.position},
          {"distance", json_or_null(s.distance)},
          {"scaled_distance", json_or_null(s.scaled_distance)},
          {"peak_overpressure", json_or_null(w.peak_overpressure)},
          {"time_of_peak", json_or_null(w.peak_time)},
          {"front_overpressure", json_or_null(w.front_overpressure)},
          {"arrival_time", json_or_null(w.arrival_time)},
          {"positive_duration", json_or_null(w.positive_duration)},
          {"positive_impulse", json_or_null(w.positive_impulse)},
          {"positive_phase_complete", w.positive_duration.has_value()},
          {"largest_impulse", json_or_null(w.largest_impulse)},
          {"time_of_largest_impulse", json_or_null(w.largest_impulse_time)},
          {"final_overpressure", json_or_null(w.final_overpressure)},
          {"negative_phase", negative_json(w.negative)},
          {"peak_front_overpressure", json_or_null(w.peak_front_overpressure)},
          {"half_width", json_or_null(w.half_width)},
          {"cells_per_half_width", json_or_null(w.cells_per_half_width)},
          {"expected_clipping", json_or_null(w.expected_clipping)},
          {"reflected", w.half_width ? nlohmann::json(w.reflected) : nlohmann::json()},
          {"kingery_bulmash", blast_json(s.empirical)},
          {"ratio",
           {{"peak_overpressure", json_or_null(r.peak)},
            {"front_overpressure", json_or_null(r.front)},
            {"arrival_time", json_or_null(r.arrival)},
            {"positive_duration", json_or_null(r.duration)},
            {"positive_impulse", json_or_null(r.impulse)}}}};
}

}  // namespace

std::string sanitised(std::string const& name) {
  std::string out;
  for (char const c : name) {
    bool const safe = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.';
    out += safe ? c : '_';
  }
  if (out.empty() || out.front() == '.') out.insert(0, 1, '_');
  return out;
}

std::string csv_field(std::string const& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (char const c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::vector<std::string> gauge_files(fs::path const& folder, std::vector<std::string> const& gauges) {
  if (!gauges.empty()) make_folder(folder / "gauges");
  return gauge_file_names(gauges);
}

std::vector<std::string> gauge_file_names(std::vector<std::string> const& gauges) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (auto const& gauge : gauges) {
    std::string const base = sanitised(gauge);
    std::string name = base;
    for (int i = 2; !taken.insert(name).second; ++i) name = fmt::format("{}_{}", base, i);
    names.push_back("gauges/" + name + ".csv");
  }
  return names;
}

GaugeFiles::GaugeFiles(fs::path const& folder, std::vector<observe::GaugeHistory> const& gauges,
                       double ambient_pressure)
    : ambient_pressure_(ambient_pressure) {
  std::vector<std::string> wanted;
  wanted.reserve(gauges.size());
  for (auto const& history : gauges) wanted.push_back(history.gauge.name);
  names_ = gauge_files(folder, wanted);
  for (auto const& name : names_) {
    streams_.push_back({folder / name});
    write_file(streams_.back().path, observe::header_of(observe::gas_columns()));
  }
}

void GaugeFiles::append(std::vector<observe::GaugeHistory> const& gauges) {
  for (std::size_t g = 0; g < streams_.size(); ++g) {
    auto& stream = streams_[g];
    auto const& records = gauges[g].records;
    std::string text;
    std::size_t const sampled = observe::sampled_columns(observe::gas_columns());
    for (std::size_t i = stream.written; i < records.size(); ++i) {
      auto const& r = records[i];
      if (i > 0) {
        auto const& before = records[i - 1];
        stream.impulse +=
            0.5 * (before.pressure - ambient_pressure_ + (r.pressure - ambient_pressure_)) * (r.time - before.time);
      }
      observe::GasMoment const moment{r, ambient_pressure_, stream.impulse, gauges[g].sampled.data() + sampled * i};
      text += observe::row_of(observe::gas_columns(), r.time, moment);
    }
    stream.written = records.size();
    if (!text.empty()) append_to_file(stream.path, text);
  }
}

void write_summary(fs::path const& folder, run::Case const& setup, std::vector<observe::GaugeSummary> const& summaries,
                   std::vector<std::string> const& files, nlohmann::json const& more) {
  std::string csv = summary_header;
  nlohmann::json gauges = nlohmann::json::array();
  for (std::size_t g = 0; g < summaries.size(); ++g) {
    csv += csv_row(summaries[g]);
    gauges.push_back(to_json(summaries[g], g < files.size() ? files[g] : ""));
  }
  replace_file(folder / "summary.csv", csv);

  nlohmann::json summary{{"units", "SI: m, s, Pa, Pa s, m/kg^(1/3)"},
                         {"burst", burst_name(setup.burst)},
                         {"ambient_pressure", setup.ambient.state.pressure},
                         {"arrival_threshold", observe::arrival_threshold * setup.ambient.state.pressure},
                         {"gauges", std::move(gauges)}};
  if (observe::empirical_applies(setup) && setup.charges.front().explosive.tnt_equivalent_pressure)
    summary["kingery_bulmash_curve"] = empirical_curve(setup);
  if (more.is_object()) summary.update(more);
  replace_file(folder / "summary.json", summary.dump(2) + "\n");
}

void write_summary(fs::path const& folder, run::Case const& setup, std::vector<observe::GaugeSummary> const& summaries,
                   std::vector<std::string> const& files) {
  write_summary(folder, setup, summaries, files, {});
}

}  // namespace brisance::output
