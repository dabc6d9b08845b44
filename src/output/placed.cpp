#include "output/placed.hpp"

#include <nlohmann/json.hpp>

#include "output/json.hpp"

namespace brisance::output {

using nlohmann::json;

json initial_states_json(std::vector<run::InitialStateReport> const& states) {
  json out = json::array();
  for (run::InitialStateReport const& r : states) {
    out.push_back({{"fluid", r.fluid},
                   {"specified_volume", json_or_null(r.specified_volume)},
                   {"volume", json_or_null(r.volume)},
                   {"specified_mass", json_or_null(r.specified_mass)},
                   {"mass", json_or_null(r.mass)},
                   {"specified_energy", json_or_null(r.specified_energy)},
                   {"energy", json_or_null(r.energy)}});
  }
  return out;
}

json obstacles_json(std::vector<run::ObstacleReport> const& obstacles) {
  json out = json::array();
  for (run::ObstacleReport const& o : obstacles) {
    out.push_back({{"name", o.name},
                   {"specified_volume", json_or_null(o.specified_volume)},
                   {"volume", json_or_null(o.volume)},
                   {"cells", o.cells}});
  }
  return out;
}

json panels_json(std::vector<run::PanelReport> const& panels) {
  json out = json::array();
  auto const when = [](std::optional<double> const& time) { return time ? json_or_null(*time) : json(nullptr); };
  for (run::PanelReport const& p : panels) {
    out.push_back({{"name", p.name},
                   {"direction", std::string(1, "xyz"[p.place.direction])},
                   {"area", json_or_null(p.place.area)},
                   {"perimeter", json_or_null(p.place.perimeter)},
                   {"fails_at", json_or_null(p.release.pressure)},
                   {"areal_mass", json_or_null(p.release.areal_mass)},
                   {"largest_difference", json_or_null(p.largest)},
                   {"failed_at", when(p.released)},
                   {"difference", p.released ? json_or_null(p.difference) : json(nullptr)},
                   {"open_at", when(p.opened)},
                   {"open_area", json_or_null(p.open_area())},
                   {"travel", json_or_null(p.travel)},
                   {"speed", json_or_null(p.speed)}});
  }
  return out;
}

}  // namespace brisance::output
