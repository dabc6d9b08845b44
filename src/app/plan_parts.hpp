/// What the text of a plan and its JSON share.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "run/reports.hpp"

namespace brisance::app {

inline double relative_error(run::ChargeReport const& c) {
  return (c.realised_mass - c.specified_mass) / c.specified_mass;
}

inline double relative_error(run::BodyReport const& b) { return (b.mass - b.geometric_mass) / b.geometric_mass; }

/// Name, role and source of every material of a case.
struct MaterialLine {
  std::string name;
  std::string role;
  std::string source;
};

inline std::vector<MaterialLine> materials_of(run::Case const& setup) {
  std::vector<MaterialLine> lines;
  if (!setup.particles.any() || setup.has_regions())
    lines.push_back({setup.ambient.fluid.name, "ambient fluid", setup.ambient.fluid.source});
  for (run::Body const& body : setup.particles.bodies) {
    bool const known =
        std::any_of(lines.begin(), lines.end(), [&](MaterialLine const& l) { return l.name == body.solid.name; });
    if (!known) lines.push_back({body.solid.name, "body", body.solid.source});
  }
  for (int k = 1; setup.charges.empty() && setup.other_fluid(k) != nullptr; ++k)
    lines.push_back({setup.other_fluid(k)->name, "second fluid", setup.other_fluid(k)->source});
  for (run::Charge const& charge : setup.charges) {
    bool const known =
        std::any_of(lines.begin(), lines.end(), [&](MaterialLine const& l) { return l.name == charge.explosive.name; });
    if (!known) lines.push_back({charge.explosive.name, "explosive", charge.explosive.source});
  }
  return lines;
}

inline double density_of(run::Body const& body) { return body.density.value_or(body.solid.density); }

}  // namespace brisance::app
