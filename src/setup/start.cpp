#include "setup/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/archive.hpp"
#include "core/error.hpp"
#include "core/timer.hpp"
#include "run/world.hpp"
#include "setup/reach.hpp"
#include "setup/start_points.hpp"

namespace brisance::setup {

namespace {

using grid::Geometry;

/// Cells beyond the radius to which the shock may run: the run ends before its foot gets there.
constexpr int spare_cells = 8;
/// Layers of cells that a step may change.
constexpr int step_layers = 2;
constexpr double most_start_cells = 1e6;

[[noreturn]] void refuse(Case const& setup, std::string const& why) {
  std::string const& place = setup.start.place;
  throw InputError(place.empty() ? why : fmt::format("{}: {}", place, why));
}

/// Radius of the ball, or of the disc, of which the charge is the whole or the half that stands on a mirror.
double ball_radius(Case const& setup, std::size_t number) {
  Charge const& charge = setup.charges[number];
  Geometry const geometry = setup.domain.geometry;
  std::string const what = setup.charges.size() == 1 ? "the charge" : fmt::format("charge {}", number + 1);
  if (geometry == Geometry::planar2d) {
    if (auto const* disc = std::get_if<shape::Cylinder>(&charge.shape)) return disc->radius;
    throw InputError(fmt::format("{} is no cylinder: a 1D calculation in planar2d knows cylinders only", what));
  }
  if (geometry != Geometry::cartesian3d && geometry != Geometry::axisymmetric2d) {
    throw InputError(
        fmt::format("{} is calculated in one direction anyway: remove start = \"remap\"", word_of(geometry)));
  }
  if (auto const* ball = std::get_if<shape::Sphere>(&charge.shape)) return ball->radius;
  if (auto const* half = std::get_if<shape::Hemisphere>(&charge.shape)) {
    auto const planes = detonation::planes_through(setup.domain, half->centre);
    for (int d = 0; d < setup.domain.dimensions(); ++d) {
      if (planes[d] != 0 && half->normal[d] * planes[d] > 0.5) return half->radius;
    }
    throw InputError(fmt::format(
        "{} is a hemisphere whose flat side lies on no wall or symmetry plane: it is no half of a 1D burst", what));
  }
  throw InputError(
      fmt::format("{} is neither a sphere nor a hemisphere on a wall; a cylinder may be calculated in a deck of "
                  "axisymmetric2d with "
                  "[output] profile = true, whose profiles/end.h5 then goes into [remap] profile",
                  what));
}

double delay_of(Case const& setup, std::size_t number, double radius) {
  Charge const& charge = setup.charges[number];
  if (charge.detonation == Detonation::instantaneous) return 0.0;
  Vec3 off = charge.initiation.front().position - shape::centre(charge.shape);
  for (int d = setup.domain.dimensions(); d < 3; ++d) off[d] = 0.0;
  if (charge.initiation.size() != 1 || norm(off) > 1e-6 * radius)
    throw InputError("a 1D calculation knows one point of initiation, in the centre of the charge");
  return charge.initiation.front().delay;
}

void check_start(Case const& setup) {
  if (setup.charges.empty()) throw InputError("there is no charge whose burst could be remapped");
  for (double const u : setup.ambient.state.velocity) {
    if (u != 0.0) throw InputError("the ambient gas moves: a burst in it is not symmetric; set ambient.velocity to 0");
  }
  if (!setup.regions.empty())
    throw InputError("a [[region]] would stand still until the remap: remove it, or start = \"remap\"");
  for (int f = 0; f < 2 * setup.domain.dimensions(); ++f) {
    if (setup.domain.boundary[f] == grid::Boundary::inflow)
      throw InputError("an inflow would begin only at the remap: choose another boundary, or remove start = \"remap\"");
  }
  for (Body const& body : setup.points.bodies) {
    if (norm(body.velocity) > 0.0 || !body.initiation.empty()) {
      throw InputError(fmt::format(
          "body \"{}\" would stand still until the remap: bodies that move or burn at the start do not go with start = "
          "\"remap\"",
          body.name));
    }
  }
}

/// Follows the outermost cell of a 1D gas that is not ambient.
class Front {
 public:
  explicit Front(run::World const& world)
      : quiet_(world.gas->conserved(run::ambient_mixture(world.setup.ambient.state))) {}
  double find(run::World const& world) {
    // Blocks of a 1D grid follow each other.
    while (block_ < world.grid.block_count()) {
      grid::Block const& block = world.grid.blocks()[block_];
      int const first = std::max(cells_ - block.origin[0], 0);
      bool found = false;
      for (int n = first; n < std::min(first + 2 * step_layers, block.n[0]); ++n) {
        for (int c = 0; c < world.gas->components(); ++c) {
          if (world.gas->fields().at(block_, c)[n] == quiet_[c]) continue;
          cells_ = block.origin[0] + n + 1;
          found = true;
        }
      }
      if (cells_ == block.origin[0] + block.n[0]) {
        ++block_;
      } else if (!found) {
        break;
      }
    }
    return cells_ * world.setup.domain.h;
  }

 private:
  gas::Components quiet_;
  int block_ = 0;
  int cells_ = 0;
};

std::string burst_name(Case const& setup, std::size_t number) {
  return setup.charges.size() == 1 ? "the shock" : fmt::format("the shock of charge {}", number + 1);
}

/// Runs a 1D calculation to the given time, or until its shock has come to where it may run. Nothing where the
/// observer gave up.
std::shared_ptr<detonation::Profile const> burst(Case const& setup, std::size_t number, std::optional<double> until,
                                                 StartObserver const& observer) {
  StartPlan const plan = plan_start(setup, number);
  Case const one = start_case(setup, number, plan);
  double const end = setup.end.time;
  StartProgress progress;
  progress.charge = number;
  progress.radius = plan.radius;
  // A strong explosion: r grows as t^(2/5) in a sphere, as t^(1/2) in a cylinder.
  double const power = plan.geometry == Geometry::spherical1d ? 2.5 : 2.0;
  auto const go_on = [&](double front, double time, long step) {
    progress.front = front;
    progress.time = time;
    progress.step = step;
    progress.done = until ? time / *until : std::min(1.0, std::pow(front / plan.radius, power));
    return !observer || observer(progress);
  };
  auto const too_far = [&](double time) {
    refuse(setup,
           fmt::format("{} comes to {:.6g} m, near {}, at {:.6g} s already, before {:.6g} s: give a shorter time",
                       burst_name(setup, number), plan.radius, plan.reach.by, time, *until));
  };
  auto const too_late = [&] {
    refuse(setup, fmt::format("{} does not come to {:.6g} m, near {}, until the end of the calculation at {:.6g} s: "
                              "calculate longer, or give the radius or the time of the remap",
                              burst_name(setup, number), plan.radius, plan.reach.by, end));
  };

  auto profile = std::make_shared<detonation::Profile>();
  if (setup.start.method == StartMethod::points) {
    PointsBurst points(one);
    while (!until || points.time() < *until) {
      double const front = points.front();
      if (front + points.step_reach() > plan.radius) {
        if (until) too_far(points.time());
        break;
      }
      if (!go_on(front, points.time(), points.steps())) return nullptr;
      if (points.time() >= end) too_late();
      points.advance(until.value_or(end));
    }
    *profile = points.profile();
    return profile;
  }
  run::World world(one);
  world.setup.end.time = until.value_or(end);
  Front front(world);
  while (!world.finished()) {
    run::advance(world, world.setup.end.time);
    double const now = front.find(world);
    // A charge that still burns is surrounded by the faint sound of its surface, see `smallest_burn_fraction`.
    bool const inside = now <= plan.radius && world.gas->burning();
    if (now + step_layers * plan.cell > plan.radius && !inside) {
      if (until && !world.finished()) too_far(world.clock.time);
      break;
    }
    if (!go_on(now, world.clock.time, world.clock.step)) return nullptr;
  }
  if (!until && world.finished()) too_late();
  if (world.gas->burning()) {
    refuse(setup,
           fmt::format("at {:.6g} s, when {} has come to {:.6g} m (near {}), the explosive still burns: move that "
                       "away from the charge, give a later time or a larger radius where that is possible, or "
                       "remove start = \"remap\"",
                       world.clock.time, burst_name(setup, number), front.find(world), plan.reach.by));
  }
  *profile = profile_of(world);
  return profile;
}

bool same_charge(Case const& setup, std::size_t a, std::size_t b) {
  StartPlan const first = plan_start(setup, a);
  StartPlan const second = plan_start(setup, b);
  return first.charge_radius == second.charge_radius && first.cell == second.cell &&
         setup.charges[a].detonation == setup.charges[b].detonation &&
         delay_of(setup, a, first.charge_radius) == delay_of(setup, b, second.charge_radius);
}

/// The direction of an axisymmetric profile's axis in the domain.
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

}  // namespace

Case start_case(Case const& setup, std::size_t number, StartPlan const& plan) {
  Case one = setup;
  one.start = {};
  one.domain = {};
  one.domain.geometry = plan.geometry;
  one.domain.h = plan.cell;
  one.domain.cells = {plan.cells, 1, 1};
  one.domain.boundary[0] = grid::Boundary::symmetry;
  one.numerics.block_cells = 0;
  one.output = {};
  one.output.peak_fields = false;
  one.gauges.clear();
  one.obstacles.clear();
  one.points = {};
  one.mpm_region.reset();
  one.burst = Burst::none;
  one.end.steps = 0;
  Charge& charge = one.charges.front();
  charge = setup.charges[number];
  charge.mass = plan.charge_mass;
  if (plan.geometry == Geometry::spherical1d) {
    charge.shape = shape::Sphere{{0.0, 0.0, 0.0}, plan.charge_radius};
  } else {
    charge.shape = shape::Cylinder{{0.0, 0.0, 0.0}, plan.charge_radius, 1.0, {0.0, 0.0, 1.0}};
  }
  if (!charge.initiation.empty()) charge.initiation = {{{0.0, 0.0, 0.0}, delay_of(setup, number, plan.charge_radius)}};
  one.charges.resize(1);
  return one;
}

void archive(Archive& a, StartReport& r) {
  a(r.method, r.from, r.cell, r.charge_radius, r.by);
  a.require(r.method == StartMethod::gas || r.method == StartMethod::points, "the method of the start");
  detonation::archive(a, r.remap);
}

StartPlan plan_start(Case const& setup, std::size_t number) {
  check_start(setup);
  StartPlan plan;
  plan.charge_radius = ball_radius(setup, number);
  (void)delay_of(setup, number, plan.charge_radius);
  plan.geometry = setup.domain.geometry == Geometry::planar2d ? Geometry::cylindrical1d : Geometry::spherical1d;
  shape::Shape const ball =
      plan.geometry == Geometry::spherical1d
          ? shape::Shape(shape::Sphere{{0.0, 0.0, 0.0}, plan.charge_radius})
          : shape::Shape(shape::Cylinder{{0.0, 0.0, 0.0}, plan.charge_radius, 1.0, {0.0, 0.0, 1.0}});
  plan.charge_mass = setup.charges[number].explosive.density() * shape::volume(ball, plan.geometry);
  Start const& start = setup.start;
  plan.cell = start_cell(start.cell, plan.charge_radius);
  plan.reach = reach_of(setup, number, !start.time && !start.radius);
  plan.radius = plan.reach.radius;
  if (start.radius) {
    if (*start.radius > plan.reach.radius) {
      throw InputError(fmt::format("a shock at the radius {:.6g} m would meet {}: give at most {:.6g} m", *start.radius,
                                   plan.reach.by, plan.reach.radius));
    }
    plan.radius = *start.radius;
  }
  // The burn must be over, which takes a little way into the air.
  double const least = 1.1 * plan.charge_radius;
  if (plan.radius < least) {
    throw InputError(fmt::format(
        "there is no room for a 1D calculation: {} leaves the shock {:.6g} m around the centre of {}, whose radius is "
        "{:.6g} m; at least {:.6g} m are needed: move that away, give the radius or the time where only gauges are "
        "near, or remove start = \"remap\"",
        plan.reach.by, std::max(plan.radius, 0.0),
        setup.charges.size() == 1 ? "the charge" : fmt::format("charge {}", number + 1), plan.charge_radius, least));
  }
  double const cells = std::ceil(plan.radius / plan.cell) + spare_cells;
  if (cells > most_start_cells) {
    throw InputError(
        fmt::format("the 1D calculation would have {:.4g} cells of {:.4g} m; at most {:g}: choose a larger "
                    "remap.cell, or a smaller radius",
                    cells, plan.cell, most_start_cells));
  }
  plan.cells = static_cast<int>(cells);
  return plan;
}

std::vector<std::shared_ptr<detonation::Profile const>> calculate_start(Case const& setup,
                                                                        StartObserver const& observer) {
  std::size_t const count = setup.charges.size();
  std::vector<std::shared_ptr<detonation::Profile const>> profiles(count);
  auto const alike = [&](std::size_t number) {
    for (std::size_t other = 0; other < number; ++other) {
      if (profiles[other] != nullptr && same_charge(setup, other, number)) return other;
    }
    return number;
  };
  std::optional<double> common = setup.start.time;
  // The time is that of the first burst that comes near anything; the others are then calculated to the same.
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t n = 0; n < count; ++n) {
      if (profiles[n] != nullptr && profiles[n]->time == common) continue;
      profiles[n] = nullptr;
      std::size_t const other = alike(n);
      bool const shared = other < n && (common ? profiles[other]->time == *common : true) &&
                          plan_start(setup, other).radius <= plan_start(setup, n).radius;
      profiles[n] = shared ? profiles[other] : burst(setup, n, common, observer);
      if (profiles[n] == nullptr) return {};
    }
    if (common) break;
    common = profiles.front()->time;
    for (auto const& profile : profiles) common = std::min(*common, profile->time);
  }
  return profiles;
}

std::shared_ptr<detonation::Profile const> fitted_profile(Case const& setup, std::size_t number,
                                                          detonation::Profile const& given) {
  check_start(setup);
  auto const mismatch = [&](std::string const& why) {
    throw InputError(fmt::format("the profile \"{}\" does not fit: {}", setup.start.profile, why));
  };
  Charge const& charge = setup.charges[number];
  Geometry const from = given.domain.geometry;
  Geometry const to = setup.domain.geometry;
  bool const possible = from == Geometry::spherical1d ? to == Geometry::cartesian3d || to == Geometry::axisymmetric2d
                        : from == Geometry::cylindrical1d ? to == Geometry::planar2d
                                                          : to == Geometry::cartesian3d;
  if (!possible) {
    mismatch(fmt::format("it is of {}, which cannot become {}", word_of(from), word_of(to)));
  }
  if (given.charge.explosive != charge.explosive.name) {
    mismatch(fmt::format("its explosive is {}, that of the deck is {}", given.charge.explosive, charge.explosive.name));
  }
  gas::Fluids const fluids = run::fluids_of(setup);
  auto const own = detonation::constants_of(charge.explosive, fluids, run::ambient_mixture(setup.ambient.state));
  for (std::size_t n = 0; n < std::max(own.size(), given.constants.size()); ++n) {
    if (n < own.size() && n < given.constants.size() && own[n].name == given.constants[n].name) {
      double const a = given.constants[n].value;
      double const b = own[n].value;
      if (std::abs(a - b) <= 1e-12 * std::max(std::abs(a), std::abs(b))) continue;
      mismatch(fmt::format("its {} is {:.10g}, that of the deck is {:.10g}", own[n].name, a, b));
    }
    mismatch(fmt::format("its materials have other equations of state: {} in the deck, {} in the profile",
                         n < own.size() ? own[n].name : "nothing",
                         n < given.constants.size() ? given.constants[n].name : "nothing"));
  }

  double radius = 0.0;
  double length = 0.0;
  auto const* cylinder = std::get_if<shape::Cylinder>(&charge.shape);
  std::string const shape = cylinder != nullptr ? "cylinder" : "sphere";
  if (shape != given.charge.shape) {
    mismatch(fmt::format("its charge is a {}, that of the deck a {}", given.charge.shape, shape));
  }
  if (cylinder != nullptr) {
    radius = cylinder->radius;
    if (to == Geometry::cartesian3d) length = cylinder->length;
    int along = 0;
    for (double const a : cylinder->axis) along += std::abs(a) > 1.0 - 1e-9 ? 1 : 0;
    if (along != 1) mismatch("the axis of the charge must be x, y or z");
  } else {
    radius = ball_radius(setup, number);
  }
  double const mass = cylinder != nullptr
                          ? charge.mass
                          : charge.explosive.density() * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  auto profile = std::make_shared<detonation::Profile>(scaled(given, mass));
  auto const same = [radius](double a, double b) { return std::abs(a - b) <= 1e-6 * radius; };
  if (!same(profile->charge.radius, radius) || !same(profile->charge.length, length)) {
    mismatch(
        fmt::format("scaled to the mass of the deck's charge its charge has radius {:.6g} m and length {:.6g} m, "
                    "that of the deck {:.6g} m and {:.6g} m",
                    profile->charge.radius, profile->charge.length, radius, length));
  }

  detonation::Placing const placing = placing_of(charge);
  bool lit_alike = profile->charge.initiation.size() == charge.initiation.size();
  for (std::size_t n = 0; lit_alike && n < charge.initiation.size(); ++n) {
    Vec3 const off = charge.initiation[n].position - placing.centre;
    double along = placing.sense * off[placing.axis];
    double across = std::sqrt(std::max(0.0, dot(off, off) - along * along));
    if (to != Geometry::cartesian3d) {
      along = to == Geometry::axisymmetric2d ? off[1] : 0.0;
      across = to == Geometry::axisymmetric2d ? off[0] : std::hypot(off[0], off[1]);
    }
    detonation::InitiationPoint const& p = profile->charge.initiation[n];
    lit_alike = same(p.position[1], along) && same(p.position[0], across) &&
                std::abs(p.delay - charge.initiation[n].delay) <= 1e-9 * profile->time;
  }
  if (!lit_alike) mismatch("its charge was lit elsewhere, or at another time, than the deck says");

  int grounded = -1;
  bool const through = std::abs(profile->domain.lower[1]) <= 1e-6 * profile->domain.h;
  if (from == Geometry::axisymmetric2d && profile->mirrored && !through) {
    double const ground = placing.centre[placing.axis] + placing.sense * profile->domain.lower[1];
    grounded = 2 * placing.axis + (placing.sense > 0.0 ? 0 : 1);
    grid::Boundary const b = setup.domain.boundary[grounded];
    double const plane = placing.sense > 0.0 ? setup.domain.lower[placing.axis] : setup.domain.upper(placing.axis);
    if (std::abs(plane - ground) > 1e-6 * setup.domain.h ||
        (b != grid::Boundary::wall && b != grid::Boundary::symmetry)) {
      mismatch(
          fmt::format("its shock has been reflected by a plane that lies at {} = {:.6g} m here: the face {} must be "
                      "a wall or a symmetry plane there",
                      "xyz"[placing.axis], ground, grid::face_names[grounded]));
    }
  }
  Reach const reach = reach_of(setup, number, false, grounded);
  if (profile->reach() > reach.radius) {
    mismatch(fmt::format("its burst reaches {:.6g} m, but {} leaves it {:.6g} m: take an earlier profile",
                         profile->reach(), reach.by, std::max(0.0, reach.radius)));
  }
  if (profile->time >= setup.end.time) {
    mismatch(fmt::format("its time is {:.6g} s, after the end of the calculation at {:.6g} s", profile->time,
                         setup.end.time));
  }
  return profile;
}

detonation::Profile profile_of(run::World const& w) {
  Geometry const geometry = w.setup.domain.geometry;
  if (geometry != Geometry::spherical1d && geometry != Geometry::cylindrical1d &&
      geometry != Geometry::axisymmetric2d) {
    throw InputError(
        fmt::format("a state in {} cannot become a profile; possible: spherical1d, cylindrical1d, "
                    "axisymmetric2d",
                    word_of(geometry)));
  }
  if (w.gas == nullptr || w.points != nullptr || w.setup.charges.size() != 1 || !w.setup.obstacles.empty() ||
      !w.setup.regions.empty()) {
    throw InputError("a profile is the burst of one charge, without bodies, obstacles and regions");
  }
  Vec3 const centre = shape::centre(w.setup.charges.front().shape);
  detonation::Profile p =
      detonation::profile_of(*w.gas, run::ambient_mixture(w.setup.ambient.state), centre, w.clock.time);
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
      throw InputError("the hemisphere stands on no wall or symmetry plane: its burst cannot become a profile");
  } else {
    throw InputError("the charge is no sphere, hemisphere or cylinder: its burst cannot become a profile");
  }
  for (InitiationPoint const& point : charge.initiation) {
    Vec3 const off = point.position - centre;
    p.charge.initiation.push_back({{off[0], geometry == Geometry::axisymmetric2d ? off[1] : 0.0, 0.0}, point.delay});
  }
  p.constants = detonation::constants_of(charge.explosive, fluids, run::ambient_mixture(setup.ambient.state));
}

run::ChargeReport realised_charge(Charge const& charge, grid::Grid const& grid, std::string const& what,
                                  SolidCells const* solid, detonation::TakenCells* taken) {
  double const density = charge.explosive.density();
  std::function<bool(Index3 const&)> is_solid;
  if (solid != nullptr && solid->any()) is_solid = [&](Index3 const& cell) { return (*solid)(cell); };
  auto const filled = detonation::fill_cells(charge.shape, grid, charge.mass / density, what, is_solid);
  double volume = 0.0;
  for (std::size_t n = 0; n < filled.cells.size(); ++n) {
    volume += filled.fractions[n] * grid.domain().cell_volume(filled.cells[n][0]);
    if (taken != nullptr) (*taken)[filled.cells[n]] += filled.fractions[n];
  }
  run::ChargeReport report;
  report.explosive = charge.explosive.name;
  report.asked_mass = charge.mass;
  report.realised_mass = volume * filled.images * density;
  report.realised_energy = volume * filled.images * charge.explosive.energy;
  report.cells_per_radius = shape::equivalent_radius(volume * filled.images, grid.domain().geometry) / grid.domain().h;
  return report;
}

void place_start(run::World& w) {
  PhaseTimer const timer(w.timings["start"]);
  Case& setup = w.setup;
  if (setup.start.profiles.empty()) setup.start.profiles = calculate_start(setup);
  double const time = setup.start.profiles.front()->time;
  for (std::size_t n = 0; n < setup.charges.size(); ++n) {
    Charge const& charge = setup.charges[n];
    detonation::Profile const& profile = *setup.start.profiles[n];
    if (std::abs(profile.time - time) > 1e-12 * time) {
      refuse(setup,
             "the scaled profiles of charges of different mass belong to different times: let them be calculated");
    }
    std::string const what = setup.charges.size() == 1 ? "the charge" : fmt::format("charge {}", n + 1);
    double const images = detonation::symmetry_images(charge.shape, setup.domain, what);
    StartReport report;
    report.method = setup.start.method;
    report.from = setup.start.profile.empty() ? word_of(profile.domain.geometry) : setup.start.profile;
    report.cell = profile.domain.h;
    report.charge_radius = profile.charge.radius;
    if (setup.start.profile.empty()) report.by = plan_start(setup, n).reach.by;
    report.remap = detonation::remap(*w.gas, profile, placing_of(charge));
    w.starts.push_back(report);

    run::ChargeReport realised;
    realised.explosive = charge.explosive.name;
    realised.asked_mass = charge.mass;
    realised.realised_mass = report.remap.after.mass[1] * images;
    realised.realised_energy = realised.realised_mass * charge.explosive.specific_energy();
    realised.cells_per_radius = profile.charge.radius / profile.domain.h;
    w.charges.push_back(realised);
  }
  w.clock.time = time;
}

}  // namespace brisance::setup
