#include "app/gauge_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text.hpp"
#include "observe/blast_summary.hpp"

namespace brisance::app {

namespace {

constexpr std::size_t most_rows = 30;     // gauges that a table at the end shows
constexpr std::size_t most_lines = 8;     // gauges that `check` shows
constexpr double marked_clipping = 0.05;  // of the peak: beyond it the table is followed by a note

std::string cell(std::optional<double> value, char const* unit) { return value ? quantity(*value, unit) : "-"; }

std::string ratio(bool known, double value, std::optional<double> const& reference) {
  return known && reference ? fmt::format("{:.3f}", value / *reference) : "-";
}

std::string percent(double fraction) { return fmt::format("{:.0f} %", 100.0 * fraction); }

std::string cell_count(double cells) { return fmt::format("{:.{}f}", cells, cells < 9.95 ? 1 : 0); }

std::size_t name_width(std::vector<observe::GaugeSummary> const& gauges) {
  std::size_t width = 5;
  for (auto const& g : gauges) width = std::max(width, g.name.size());
  return width;
}

/// Peak, arrival and impulse, beside Kingery-Bulmash.
void blast_table(std::vector<observe::GaugeSummary> const& gauges, bool compared, std::string& out) {
  auto const width = name_width(gauges);
  out += fmt::format("\n{:<{}}  {:>10} {:>14} {:>8} {:>11} {:>13}", "gauge", width, "distance", "peak overpr.",
                     "clipped", "arrival", "impulse");
  out += compared ? "   ratio to Kingery-Bulmash: peak  arrival  impulse\n" : "\n";
  for (std::size_t n = 0; n < std::min(gauges.size(), most_rows); ++n) {
    auto const& g = gauges[n];
    bool const arrived = g.wave.arrival_time.has_value();
    bool const complete = g.wave.positive_duration.has_value();
    out +=
        fmt::format("{:<{}}  {:>10} {:>14} {:>8} {:>11} {:>12}{}", g.name, width, cell(g.distance, "m"),
                    arrived ? quantity(g.wave.peak_overpressure, "Pa") : "-",
                    g.wave.expected_clipping ? percent(*g.wave.expected_clipping) : "-", cell(g.wave.arrival_time, "s"),
                    arrived ? quantity(g.wave.positive_impulse, "Pa s") : "-", arrived && !complete ? "+" : " ");
    if (compared) {
      out += fmt::format("  {:>30} {:>8} {:>8}",
                         ratio(arrived, g.wave.peak_overpressure, g.empirical.incident_overpressure),
                         ratio(arrived, g.wave.arrival_time.value_or(0.0), g.empirical.arrival),
                         ratio(complete, g.wave.positive_impulse, g.empirical.incident_impulse));
    }
    out += "\n";
  }
  if (gauges.size() > most_rows) out += fmt::format("... and {} more in summary.csv\n", gauges.size() - most_rows);
  if (std::ranges::any_of(gauges, [](auto const& g) { return g.wave.arrival_time && !g.wave.positive_duration; }))
    out += "+: the simulation ended within the positive phase\n";
}

/// The whole record: rooms, negative phases, and the peak without what the cells clip.
void record_table(std::vector<observe::GaugeSummary> const& gauges, std::string& out) {
  auto const width = name_width(gauges);
  out += fmt::format("\n{:<{}}  {:>14} {:>14} {:>11} {:>14} {:>14} {:>14} {:>11}\n", "gauge", width, "peak at front",
                     "max. impulse", "at", "mean at end", "negative peak", "impulse", "duration");
  for (std::size_t n = 0; n < std::min(gauges.size(), most_rows); ++n) {
    auto const& w = gauges[n].wave;
    bool const arrived = w.arrival_time.has_value();
    bool const negative = w.negative.has_value();
    out += fmt::format("{:<{}}  {:>14} {:>14} {:>11} {:>14} {:>14} {:>14} {:>11}\n", gauges[n].name, width,
                       cell(w.peak_front_overpressure, "Pa"), arrived ? quantity(w.largest_impulse, "Pa s") : "-",
                       arrived ? quantity(w.largest_impulse_time, "s") : "-",
                       arrived || negative ? quantity(w.final_overpressure, "Pa") : "-",
                       negative ? quantity(w.negative->peak, "Pa") : "-",
                       negative ? quantity(w.negative->impulse, "Pa s") : "-",
                       negative ? cell(w.negative->duration, "s") : "-");
  }
}

void clipping_note(std::vector<observe::GaugeSummary> const& gauges, std::string& out) {
  observe::GaugeSummary const* worst = nullptr;
  for (auto const& g : gauges) {
    if (g.wave.expected_clipping && (worst == nullptr || *g.wave.expected_clipping > *worst->wave.expected_clipping))
      worst = &g;
  }
  if (worst == nullptr || *worst->wave.expected_clipping < marked_clipping) return;
  out += fmt::format(
      "clipped: expected loss of the recorded peak because of the cell size; at gauge {} it is {}, with {} cells in "
      "the half width of the peak.{}\n",
      worst->name, percent(*worst->wave.expected_clipping), cell_count(*worst->wave.cells_per_half_width),
      worst->wave.peak_front_overpressure ? " \"Peak at front\" is extrapolated from the decay behind the front." : "");
}

}  // namespace

std::string gauge_plan_text(std::vector<session::GaugePlan> const& gauges) {
  std::vector<session::GaugePlan const*> known;
  for (session::GaugePlan const& g : gauges) {
    if (g.peak) known.push_back(&g);
  }
  std::size_t const count = known.size();
  if (count > most_lines) {
    std::ranges::stable_sort(known, [](auto* a, auto* b) { return a->peak->clipping > b->peak->clipping; });
    known.resize(most_lines);
  }
  std::string out;
  for (session::GaugePlan const* g : known) {
    out += fmt::format("{:<12} {}: {} cells in the half width of the {}peak; the recorded peak will be about {} low\n",
                       g == known.front() ? "peaks" : "", g->name, cell_count(g->peak->cells_per_half_width),
                       g->peak->reflected ? "reflected " : "", percent(g->peak->clipping));
  }
  if (count > known.size()) out += fmt::format("{:<12} the other {} will be clipped less\n", "", count - known.size());
  return out;
}

nlohmann::json gauge_plan_json(std::vector<session::GaugePlan> const& gauges) {
  nlohmann::json rows = nlohmann::json::array();
  for (session::GaugePlan const& g : gauges) {
    nlohmann::json row{{"name", g.name},
                       {"half_width", nullptr},
                       {"cells_per_half_width", nullptr},
                       {"expected_clipping", nullptr},
                       {"reflected", nullptr}};
    if (g.peak) {
      row["half_width"] = g.peak->half_width;
      row["cells_per_half_width"] = g.peak->cells_per_half_width;
      row["expected_clipping"] = g.peak->clipping;
      row["reflected"] = g.peak->reflected;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string gauge_tables(run::Case const& setup, std::vector<observe::GaugeHistory> const& histories) {
  auto const gauges = observe::summarise(setup, histories);
  std::string out;
  if (gauges.empty()) return out;
  blast_table(gauges, setup.burst != run::Burst::none, out);
  record_table(gauges, out);
  clipping_note(gauges, out);
  return out;
}

}  // namespace brisance::app
