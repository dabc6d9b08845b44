#include "output/zones.hpp"

#include <nlohmann/json.hpp>

#include "output/json.hpp"
#include "run/system.hpp"

namespace brisance::output {

nlohmann::json broken_zones_json(run::System const& system) {
  auto const part = [](observe::BrokenPart const& p) {
    return nlohmann::json{{"mass", json_or_null(p.mass)}, {"volume", json_or_null(p.volume)}};
  };
  nlohmann::json out = nlohmann::json::array();
  for (auto const& zones : observe::broken_zones(system)) {
    nlohmann::json faces = nlohmann::json::array();
    for (auto const& face : zones.faces) {
      faces.push_back({{"face", grid::face_names[static_cast<int>(face.face)]},
                       {"crushed_diameter", json_or_null(face.crushed_diameter)},
                       {"crushed_depth", json_or_null(face.crushed_depth)},
                       {"cracked_diameter", json_or_null(face.cracked_diameter)},
                       {"cracked_depth", json_or_null(face.cracked_depth)},
                       {"spall_depth", json_or_null(face.spall_depth)}});
    }
    out.push_back({{"body", system.bodies[zones.body].name},
                   {"crushed", part(zones.crushed)},
                   {"cracked", part(zones.cracked)},
                   {"damaged", part(zones.damaged)},
                   {"faces", std::move(faces)}});
  }
  return out;
}

}  // namespace brisance::output
