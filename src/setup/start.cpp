#include "setup/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/timer.hpp"
#include "run/system.hpp"
#include "setup/build.hpp"
#include "setup/burst.hpp"
#include "setup/fluids.hpp"
#include "setup/profile_fit.hpp"
#include "setup/reach.hpp"
#include "setup/start_particles.hpp"

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

/// Follows the outermost cell of a 1D gas that is not ambient.
class Front {
 public:
  explicit Front(run::System const& system)
      : quiet_(gas::conserved_of(system.gas->fluids(), system.setup.ambient.state)) {}
  double find(run::System const& system) {
    // Blocks of a 1D grid follow each other.
    while (block_ < system.grid.block_count()) {
      grid::Block const& block = system.grid.blocks()[block_];
      grid::CellRange cells = block.in_domain();
      int const end = cells.upper[0];
      cells.lower[0] = std::max(cells_, cells.lower[0]);
      cells.upper[0] = std::min(cells.lower[0] + 2 * step_layers, end);
      bool found = false;
      for_each_cell(cells, [&](Index3 const& index) {
        int const at = system.grid.locate(index).offset;
        for (int c = 0; c < system.gas->fields().components(); ++c) {
          if (system.gas->fields().at(block_, c)[at] == quiet_[c]) continue;
          cells_ = index[0] + 1;
          found = true;
        }
      });
      if (cells_ == end) {
        ++block_;
      } else if (!found) {
        break;
      }
    }
    return cells_ * system.grid.smallest_cell();
  }

 private:
  gas::Components quiet_;
  int block_ = 0;
  int cells_ = 0;
};

std::string burst_name(Case const& setup, std::size_t number) {
  return setup.charges.size() == 1 ? "the shock" : fmt::format("the shock of charge {}", number + 1);
}

/// Runs a 1D simulation to the given time, or until its shock has come to where it may run. Nothing where the
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
    refuse(setup, fmt::format("{} already reaches {:.6g} m, near {}, at {:.6g} s, before {:.6g} s: give a shorter time",
                              burst_name(setup, number), plan.radius, plan.reach.by, time, *until));
  };
  auto const too_late = [&] {
    refuse(setup, fmt::format("{} does not reach {:.6g} m, near {}, before the end of the simulation at {:.6g} s: "
                              "simulate longer, or give the radius or the time of the remap",
                              burst_name(setup, number), plan.radius, plan.reach.by, end));
  };

  auto profile = std::make_shared<detonation::Profile>();
  if (setup.start.method == StartMethod::particles) {
    ParticlesBurst particles(one);
    while (!until || particles.time() < *until) {
      double const front = particles.front();
      if (front + particles.step_reach() > plan.radius) {
        if (until) too_far(particles.time());
        break;
      }
      if (!go_on(front, particles.time(), particles.steps())) return nullptr;
      if (particles.time() >= end) too_late();
      particles.advance(until.value_or(end));
    }
    *profile = particles.profile();
    return profile;
  }
  run::World system = build(one);
  system.setup.end.time = until.value_or(end);
  Front front(system);
  while (!system.finished()) {
    run::advance(system, system.setup.end.time);
    double const now = front.find(system);
    // A charge that still burns is surrounded by the faint sound of its surface, see `smallest_burn_fraction`.
    bool const inside = now <= plan.radius && system.gas->burn.burning();
    if (now + step_layers * plan.cell > plan.radius && !inside) {
      if (until && !system.finished()) too_far(system.clock.time);
      break;
    }
    if (!go_on(now, system.clock.time, system.clock.step)) return nullptr;
  }
  if (!until && system.finished()) too_late();
  if (system.gas->burn.burning()) {
    refuse(setup,
           fmt::format(
               "at {:.6g} s, when {} reaches {:.6g} m (near {}), the explosive is still burning: move that obstruction "
               "away from the charge, give a later time or a larger radius if possible, or remove start = \"remap\"",
               system.clock.time, burst_name(setup, number), front.find(system), plan.reach.by));
  }
  *profile = profile_of(system);
  return profile;
}

bool same_charge(Case const& setup, std::size_t a, std::size_t b) {
  StartPlan const first = plan_start(setup, a);
  StartPlan const second = plan_start(setup, b);
  return first.charge_radius == second.charge_radius && first.cell == second.cell &&
         setup.charges[a].detonation == setup.charges[b].detonation &&
         delay_of(setup, a, first.charge_radius) == delay_of(setup, b, second.charge_radius);
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
  one.adaptive = {};
  one.output = {};
  one.output.peak_fields = false;
  one.gauges.clear();
  one.obstacles.clear();
  one.particles = {};
  one.mpm_regions.clear();
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
      throw InputError(fmt::format("a shock at the radius {:.6g} m would reach {}: give at most {:.6g} m",
                                   *start.radius, plan.reach.by, plan.reach.radius));
    }
    plan.radius = *start.radius;
  }
  // The burn must be over, which takes a little way into the air.
  double const least = 1.1 * plan.charge_radius;
  if (plan.radius < least) {
    throw InputError(fmt::format(
        "there is no room for a 1D simulation: {} limits the shock to {:.6g} m around the centre of {}, whose radius "
        "is {:.6g} m; at least {:.6g} m are required: move that obstruction away, give the radius or the time if only "
        "gauges are near, or remove start = \"remap\"",
        plan.reach.by, std::max(plan.radius, 0.0),
        setup.charges.size() == 1 ? "the charge" : fmt::format("charge {}", number + 1), plan.charge_radius, least));
  }
  double const cells = std::ceil(plan.radius / plan.cell) + spare_cells;
  if (cells > most_start_cells) {
    throw InputError(
        fmt::format("the 1D simulation would have {:.4g} cells of {:.4g} m; allowed: at most {:g}: choose a larger "
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

void place_start(run::System& w) {
  PhaseTimer const timer(w.timings["start"]);
  Case& setup = w.setup;
  if (setup.start.profiles.empty()) setup.start.profiles = calculate_start(setup);
  double const time = setup.start.profiles.front()->time;
  for (std::size_t n = 0; n < setup.charges.size(); ++n) {
    Charge const& charge = setup.charges[n];
    detonation::Profile const& profile = *setup.start.profiles[n];
    if (std::abs(profile.time - time) > 1e-12 * time) {
      refuse(setup,
             "the scaled profiles of charges of different mass belong to different times: remove the profile, so that "
             "they are computed");
    }
    std::string const what = setup.charges.size() == 1 ? "the charge" : fmt::format("charge {}", n + 1);
    double const images = detonation::symmetry_images(charge.shape, setup.domain, what);
    run::StartReport report;
    report.method = setup.start.method;
    report.from = setup.start.profile.empty() ? word_of(profile.domain.geometry) : setup.start.profile;
    report.cell = profile.domain.h;
    report.charge_radius = profile.charge.radius;
    if (setup.start.profile.empty()) report.by = plan_start(setup, n).reach.by;
    report.remap = detonation::remap(*w.gas, profile, placing_of(charge));
    w.starts.push_back(report);

    run::ChargeReport realised;
    realised.explosive = charge.explosive.name;
    realised.specified_mass = charge.mass;
    realised.realised_mass = report.remap.after.mass[gas::products_fluid] * images;
    realised.realised_energy = realised.realised_mass * charge.explosive.specific_energy();
    realised.cells_per_radius = profile.charge.radius / profile.domain.h;
    w.charges.push_back(realised);
  }
  w.clock.time = time;
}

}  // namespace brisance::setup
