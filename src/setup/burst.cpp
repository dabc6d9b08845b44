#include "setup/burst.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"
#include "detonation/charge.hpp"

namespace brisance::setup {

using grid::Geometry;

void check_start(Case const& setup) {
  if (setup.charges.empty()) throw InputError("there is no charge whose blast wave could be remapped");
  for (double const u : setup.ambient.state.velocity) {
    if (u != 0.0)
      throw InputError("the ambient gas moves, so a blast wave in it is not symmetric; set ambient.velocity to 0");
  }
  if (!setup.initial_states.empty())
    throw InputError("an [[initial_state]] would be frozen until the remap: remove it, or remove start = \"remap\"");
  for (int f = 0; f < 2 * setup.domain.dimensions(); ++f) {
    if (setup.domain.boundary[f] == grid::Boundary::inflow)
      throw InputError(
          "an inflow would not begin until the remap: choose another boundary, or remove start = \"remap\"");
  }
  for (Body const& body : setup.particles.bodies) {
    if (body.moves() || !body.initiation.empty()) {
      throw InputError(
          fmt::format("body \"{}\" would be frozen until the remap: bodies that move or detonate at the start cannot "
                      "be combined with start = \"remap\"",
                      body.name));
    }
  }
}

double ball_radius(Case const& setup, std::size_t number) {
  Charge const& charge = setup.charges[number];
  Geometry const geometry = setup.domain.geometry;
  std::string const what = setup.charges.size() == 1 ? "the charge" : fmt::format("charge {}", number + 1);
  if (geometry == Geometry::planar2d) {
    if (auto const* disc = std::get_if<shape::Cylinder>(&charge.shape)) return disc->radius;
    throw InputError(fmt::format("{} is not a cylinder: a 1D simulation for planar2d supports cylinders only", what));
  }
  if (geometry != Geometry::cartesian3d && geometry != Geometry::axisymmetric2d) {
    throw InputError(fmt::format("{} is one-dimensional already: remove start = \"remap\"", word_of(geometry)));
  }
  if (auto const* ball = std::get_if<shape::Sphere>(&charge.shape)) return ball->radius;
  if (auto const* half = std::get_if<shape::Hemisphere>(&charge.shape)) {
    auto const planes = detonation::planes_through(setup.domain, half->centre);
    for (int d = 0; d < setup.domain.dimensions(); ++d) {
      if (planes[d] != 0 && half->normal[d] * planes[d] > 1.0 - 1e-9) return half->radius;
    }
    throw InputError(fmt::format(
        "{} is a hemisphere whose flat face is not on a wall or symmetry plane, so it is not half of a 1D blast wave",
        what));
  }
  throw InputError(
      fmt::format("{} is neither a sphere nor a hemisphere on a wall; for a cylinder, run a deck in axisymmetric2d "
                  "with [output] profile = true and use its profiles/end.h5 as [remap] profile",
                  what));
}

double delay_of(Case const& setup, std::size_t number, double radius) {
  Charge const& charge = setup.charges[number];
  if (charge.detonation == Detonation::instantaneous) return 0.0;
  Vec3 off = charge.initiation.front().position - shape::centre(charge.shape);
  for (int d = setup.domain.dimensions(); d < 3; ++d) off[d] = 0.0;
  if (charge.initiation.size() != 1 || norm(off) > 1e-6 * radius)
    throw InputError("a 1D simulation supports one point of initiation only, at the centre of the charge");
  return charge.initiation.front().delay;
}

detonation::Placing placing_of(Charge const& charge) {
  detonation::Placing placing{shape::centre(charge.shape), 2, 1.0};
  if (auto const* cylinder = std::get_if<shape::Cylinder>(&charge.shape)) {
    for (int d = 0; d < 3; ++d) {
      if (std::abs(cylinder->axis[d]) < 0.5) continue;
      placing.axis = d;
      placing.sense = cylinder->axis[d] > 0.0 ? 1.0 : -1.0;
    }
  }
  if (auto const* half = std::get_if<shape::Hemisphere>(&charge.shape)) {
    for (int d = 0; d < 3; ++d) {
      if (std::abs(half->normal[d]) < 0.5) continue;
      placing.axis = d;
      placing.sense = half->normal[d] > 0.0 ? 1.0 : -1.0;
    }
  }
  return placing;
}

}  // namespace brisance::setup
