#include "app/materials_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace brisance::app {

namespace {

std::string unit_of(deck::MaterialNumber const& n) { return n.unit == "1" ? "" : n.unit; }

}  // namespace

std::string materials_text(std::vector<deck::MaterialNumbers> const& materials) {
  std::string out;
  for (auto const& m : materials) {
    out +=
        fmt::format("\n{}, from the {}{}\n", m.name, m.from_library ? "library" : "deck", m.used ? "" : ", not used");
    if (!m.note.empty()) out += fmt::format("  {}\n", m.note);
    for (auto const& n : m.numbers) {
      std::string const value = n.word.empty() ? fmt::format("{:.9g}", n.value) : n.word;
      std::string line = fmt::format("  {:<25} {:>15} {:<7} {}", n.key, value, unit_of(n), n.said);
      line.erase(line.find_last_not_of(' ') + 1);
      out += line + "\n";
    }
  }
  return out;
}

nlohmann::json materials_json(std::vector<deck::MaterialNumbers> const& materials) {
  using nlohmann::json;
  json out = json::object();
  for (auto const& m : materials) {
    json parameters = json::object();
    for (auto const& n : m.numbers) {
      json& entry = parameters[n.key];
      if (n.word.empty()) {
        entry = {{"value", n.value}, {"unit", n.unit}};
      } else {
        entry = {{"value", n.word}};
      }
      if (!m.from_library) entry["deck"] = n.said;
    }
    out[m.name] = {{"library", m.from_library}, {"used", m.used}, {"parameters", parameters}};
    if (!m.note.empty()) out[m.name]["note"] = m.note;
  }
  return out;
}

}  // namespace brisance::app
