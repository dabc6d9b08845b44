#include "setup/profile_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "detonation/remap.hpp"
#include "run/system.hpp"
#include "setup/burst.hpp"
#include "setup/fluids.hpp"
#include "setup/reach.hpp"

namespace brisance::setup {

using grid::Geometry;

namespace {

[[noreturn]] void mismatch(Case const& setup, std::string const& why) {
  throw InputError(fmt::format("the profile \"{}\" does not fit: {}", setup.start.profile, why));
}

/// The geometry and the explosive.
void check_kind(Case const& setup, Charge const& charge, detonation::Profile const& given) {
  Geometry const from = given.domain.geometry;
  Geometry const to = setup.domain.geometry;
  bool const possible = from == Geometry::spherical1d ? to == Geometry::cartesian3d || to == Geometry::axisymmetric2d
                        : from == Geometry::cylindrical1d ? to == Geometry::planar2d
                                                          : to == Geometry::cartesian3d;
  if (!possible) {
    mismatch(setup, fmt::format("it is in {}, which cannot be mapped to {}", word_of(from), word_of(to)));
  }
  if (given.charge.explosive != charge.explosive.name) {
    mismatch(setup, fmt::format("its explosive is {}, but that of the deck is {}", given.charge.explosive,
                                charge.explosive.name));
  }
}

/// The equations of state.
void check_constants(Case const& setup, Charge const& charge, detonation::Profile const& given) {
  gas::Fluids const fluids = fluids_of(setup);
  auto const own = detonation::constants_of(charge.explosive, fluids, setup.ambient.state);
  for (std::size_t n = 0; n < std::max(own.size(), given.constants.size()); ++n) {
    if (n < own.size() && n < given.constants.size() && own[n].name == given.constants[n].name) {
      double const a = given.constants[n].value;
      double const b = own[n].value;
      if (std::abs(a - b) <= 1e-12 * std::max(std::abs(a), std::abs(b))) continue;
      mismatch(setup, fmt::format("its {} is {:.10g}, but that of the deck is {:.10g}", own[n].name, a, b));
    }
    mismatch(setup, fmt::format("its materials have different equations of state: {} in the deck, {} in the profile",
                                n < own.size() ? own[n].name : "nothing",
                                n < given.constants.size() ? given.constants[n].name : "nothing"));
  }
}

bool same_length(double a, double b, double radius) { return std::abs(a - b) <= 1e-6 * radius; }

/// The profile with the mass of the case's charge, which must have its shape and size.
std::shared_ptr<detonation::Profile> scaled_profile(Case const& setup, std::size_t number,
                                                    detonation::Profile const& given, double& radius) {
  double length = 0.0;
  Charge const& charge = setup.charges[number];
  auto const* cylinder = std::get_if<shape::Cylinder>(&charge.shape);
  std::string const shape = cylinder != nullptr ? "cylinder" : "sphere";
  if (shape != given.charge.shape) {
    mismatch(setup, fmt::format("its charge is a {}, but that of the deck is a {}", given.charge.shape, shape));
  }
  if (cylinder != nullptr) {
    radius = cylinder->radius;
    if (setup.domain.geometry == Geometry::cartesian3d) length = cylinder->length;
    int along = 0;
    for (double const a : cylinder->axis) along += std::abs(a) > 1.0 - 1e-9 ? 1 : 0;
    if (along != 1) mismatch(setup, "the axis of the charge must be x, y or z");
  } else {
    radius = ball_radius(setup, number);
  }
  double const mass = cylinder != nullptr
                          ? charge.mass
                          : charge.explosive.density() * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  auto profile = std::make_shared<detonation::Profile>(scaled(given, mass));
  if (!same_length(profile->charge.radius, radius, radius) || !same_length(profile->charge.length, length, radius)) {
    mismatch(setup, fmt::format("scaled to the mass of the charge in the deck, its charge has radius {:.6g} m and "
                                "length {:.6g} m, but that of the deck has {:.6g} m and {:.6g} m",
                                profile->charge.radius, profile->charge.length, radius, length));
  }
  return profile;
}

void check_initiation(Case const& setup, Charge const& charge, detonation::Profile const& profile, double radius) {
  Geometry const to = setup.domain.geometry;
  detonation::Placing const placing = placing_of(charge);
  bool lit_alike = profile.charge.initiation.size() == charge.initiation.size();
  for (std::size_t n = 0; lit_alike && n < charge.initiation.size(); ++n) {
    Vec3 const off = charge.initiation[n].position - placing.centre;
    double along = placing.sense * off[placing.axis];
    double across = std::sqrt(std::max(0.0, dot(off, off) - along * along));
    if (to != Geometry::cartesian3d) {
      along = to == Geometry::axisymmetric2d ? off[1] : 0.0;
      across = to == Geometry::axisymmetric2d ? off[0] : std::hypot(off[0], off[1]);
    }
    detonation::InitiationPoint const& p = profile.charge.initiation[n];
    lit_alike = same_length(p.position[1], along, radius) && same_length(p.position[0], across, radius) &&
                std::abs(p.delay - charge.initiation[n].delay) <= 1e-9 * profile.time;
  }
  if (!lit_alike) mismatch(setup, "its charge was initiated at another point or time than the deck specifies");
}

/// The face of the domain that has reflected the profile's shock, where there must be a mirror too; -1: none.
int grounded_face(Case const& setup, detonation::Placing const& placing, detonation::Profile const& profile) {
  bool const through = std::abs(profile.domain.lower[1]) <= 1e-6 * profile.domain.h;
  if (profile.domain.geometry != Geometry::axisymmetric2d || !profile.mirrored || through) return -1;
  double const ground = placing.centre[placing.axis] + placing.sense * profile.domain.lower[1];
  int const grounded = 2 * placing.axis + (placing.sense > 0.0 ? 0 : 1);
  double const plane = placing.sense > 0.0 ? setup.domain.lower[placing.axis] : setup.domain.upper(placing.axis);
  if (std::abs(plane - ground) > 1e-6 * setup.domain.smallest_cell() || !setup.domain.is_mirror(grounded)) {
    mismatch(setup, fmt::format("its shock has been reflected by a plane at {} = {:.6g} m: the face {} must be a wall "
                                "or a symmetry plane there",
                                "xyz"[placing.axis], ground, grid::face_names[grounded]));
  }
  return grounded;
}

}  // namespace

std::shared_ptr<detonation::Profile const> fitted_profile(Case const& setup, std::size_t number,
                                                          detonation::Profile const& given) {
  check_start(setup);
  Charge const& charge = setup.charges[number];
  check_kind(setup, charge, given);
  check_constants(setup, charge, given);
  double radius = 0.0;
  auto profile = scaled_profile(setup, number, given, radius);
  check_initiation(setup, charge, *profile, radius);
  int const grounded = grounded_face(setup, placing_of(charge), *profile);
  Reach const reach = reach_of(setup, number, false, grounded);
  if (profile->reach() > reach.radius) {
    mismatch(setup,
             fmt::format("its blast wave extends to {:.6g} m, but {} allows only {:.6g} m: use an earlier profile",
                         profile->reach(), reach.by, std::max(0.0, reach.radius)));
  }
  if (profile->time >= setup.end.time) {
    mismatch(setup, fmt::format("its time is {:.6g} s, after the end of the simulation at {:.6g} s", profile->time,
                                setup.end.time));
  }
  return profile;
}

detonation::Profile profile_of(run::System const& w) {
  Geometry const geometry = w.setup.domain.geometry;
  if (geometry != Geometry::spherical1d && geometry != Geometry::cylindrical1d &&
      geometry != Geometry::axisymmetric2d) {
    throw InputError(
        fmt::format("a state in {} cannot become a profile; allowed: spherical1d, cylindrical1d, axisymmetric2d",
                    word_of(geometry)));
  }
  if (w.gas == nullptr || !w.regions.empty() || w.setup.charges.size() != 1 || !w.setup.obstacles.empty() ||
      !w.setup.initial_states.empty()) {
    throw InputError("a profile describes the blast wave of one charge, without bodies, obstacles and initial states");
  }
  Vec3 const centre = shape::centre(w.setup.charges.front().shape);
  detonation::Profile p = detonation::profile_of(*w.gas, w.setup.ambient.state, centre, w.clock.time);
  describe_charge(w.setup, w.gas->fluids(), p);
  return p;
}

void describe_charge(Case const& setup, gas::Fluids const& fluids, detonation::Profile& p) {
  Geometry const geometry = setup.domain.geometry;
  Charge const& charge = setup.charges.front();
  Vec3 const centre = shape::centre(charge.shape);
  p.charge.explosive = charge.explosive.name;
  p.charge.mass = charge.mass;
  if (auto const* cylinder = std::get_if<shape::Cylinder>(&charge.shape)) {
    p.charge.shape = "cylinder";
    p.charge.radius = cylinder->radius;
    if (geometry == Geometry::axisymmetric2d) p.charge.length = cylinder->length;
  } else if (auto const* ball = std::get_if<shape::Sphere>(&charge.shape)) {
    p.charge.shape = "sphere";
    p.charge.radius = ball->radius;
  } else if (auto const* half = std::get_if<shape::Hemisphere>(&charge.shape)) {
    // The half of a ball that stands on a mirror is counted with its image.
    p.charge.shape = "sphere";
    p.charge.radius = half->radius;
    p.charge.mass *= 2.0;
    if (!p.mirrored || std::abs(p.domain.lower[1]) > 1e-6 * p.domain.h)
      throw InputError("the hemisphere is not on a wall or symmetry plane, so its blast wave cannot become a profile");
  } else {
    throw InputError("the charge is not a sphere, hemisphere or cylinder, so its blast wave cannot become a profile");
  }
  for (InitiationPoint const& particle : charge.initiation) {
    Vec3 const off = particle.position - centre;
    p.charge.initiation.push_back({{off[0], geometry == Geometry::axisymmetric2d ? off[1] : 0.0, 0.0}, particle.delay});
  }
  p.constants = detonation::constants_of(charge.explosive, fluids, setup.ambient.state);
}

}  // namespace brisance::setup
