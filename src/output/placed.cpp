#include "output/placed.hpp"

#include <nlohmann/json.hpp>

#include "output/json.hpp"

namespace brisance::output {

using nlohmann::json;

json regions_json(std::vector<run::RegionReport> const& regions) {
  json out = json::array();
  for (run::RegionReport const& r : regions) {
    out.push_back({{"fluid", r.fluid},
                   {"asked_volume", json_or_null(r.asked_volume)},
                   {"volume", json_or_null(r.volume)},
                   {"asked_mass", json_or_null(r.asked_mass)},
                   {"mass", json_or_null(r.mass)},
                   {"asked_energy", json_or_null(r.asked_energy)},
                   {"energy", json_or_null(r.energy)}});
  }
  return out;
}

json obstacles_json(std::vector<run::ObstacleReport> const& obstacles) {
  json out = json::array();
  for (run::ObstacleReport const& o : obstacles) {
    out.push_back({{"name", o.name},
                   {"asked_volume", json_or_null(o.asked_volume)},
                   {"volume", json_or_null(o.volume)},
                   {"cells", o.cells}});
  }
  return out;
}

}  // namespace brisance::output
