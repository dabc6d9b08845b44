#include "app/check.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/text.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "gas/components.hpp"
#include "grid/partition.hpp"
#include "output/json.hpp"
#include "output/placed.hpp"
#include "output/run_log.hpp"
#include "output/writer.hpp"
#include "setup/place_gas.hpp"
#include "setup/place_gas_regions.hpp"
#include "setup/place_panels.hpp"
#include "setup/place_region.hpp"
#include "setup/start.hpp"
#include "shape/placement.hpp"

namespace brisance::app {

namespace {

constexpr double double_bytes = sizeof(double);
constexpr double peak_components = 3.0;         // peak overpressure, running and largest impulse
constexpr double program_bytes = 50e6;          // code, libraries, work arrays of the threads
constexpr double largest_dump_cache = 268.5e6;  // chunk cache of the field writer
constexpr double bytes_per_record = 100.0;      // one line of a gauge file
constexpr double bytes_per_point = 300.0;       // of a metal: its 27 values, and the room that the arrays keep
constexpr double bytes_per_node = 160.0;        // mass, momentum, force and velocity of a node on one grid field
constexpr double bytes_per_point_record = 200.0;
// Larger things are estimated: a look at a case of a thousand million cells must not take its memory or its time.
constexpr double most_cells_tried = 5e6;  // in the box around a charge
constexpr double most_points_tried = 5e6;
constexpr double most_blocks_tried = 1e6;
constexpr int longest_row_tried = 100'000'000;  // cells

// Rates of docs/benchmarks.md: cells of a 3D step, or points, per second on one thread.
constexpr double one_fluid_rate = 14e6;
constexpr double two_fluid_rate = 12e6;    // products in a part of the domain
constexpr double afterburn_share = 0.84;   // of the rate, where the afterburn's progress is carried
constexpr double linear_point_rate = 8e6;  // of linear shape functions
constexpr double point_rate = 5e6;
constexpr double thread_share = 0.95;     // of a thread's rate, where it is not alone
constexpr double coarse_body = 4.0;       // points across a body's shortest side below which it hardly bends
constexpr double coarse_charge = 5.0;     // cells per charge radius below which the near field is poorly resolved
constexpr double coarse_burst = 15.0;     // cells per radius of a remapped burst below which its shock is
constexpr long most_cut_cells = 200'000;  // of regions and obstacles that `check` counts
constexpr double coarse_obstacle = 0.2;   // part of its volume that an obstacle may win or lose without a warning
constexpr double few_steps = 5.0;         // that a load must last for its impulse to be right within some per cent

double machine_memory() {
  double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  double limit = 0.0;
  // In a container the limit is what counts; the file holds "max" where there is none.
  if (std::ifstream("/sys/fs/cgroup/memory.max") >> limit && limit > 0.0) memory = std::min(memory, limit);
  return memory;
}

bool two_fluids(run::Case const& setup) { return !setup.charges.empty() || setup.second_fluid.has_value(); }

int gas_components(run::Case const& setup) {
  if (!two_fluids(setup)) return gas::single_fluid_components;
  return setup.afterburn && setup.afterburn->carried() ? gas::afterburn_components : gas::two_fluid_components;
}

double cells_of(grid::Domain const& domain) { return static_cast<double>(domain.cell_count()); }

/// Cells in the ghost layers of all blocks. Blocks have at most two sizes in each direction.
double ghost_cells(grid::Domain const& domain, Index3 const& parts) {
  std::array<std::array<double, 2>, 3> size{};
  std::array<std::array<double, 2>, 3> count{};
  for (int d = 0; d < 3; ++d) {
    double const n = domain.cells[d];
    size[d] = {std::floor(n / parts[d]), std::floor(n / parts[d]) + 1.0};
    count[d][1] = n - parts[d] * size[d][0];
    count[d][0] = parts[d] - count[d][1];
  }
  double sum = 0.0;
  for (int kind = 0; kind < 8; ++kind) {
    double blocks = 1.0;
    double cells = 1.0;
    for (int d = 0; d < 3; ++d) {
      blocks *= count[d][kind >> d & 1];
      cells *= size[d][kind >> d & 1];
    }
    double face = 0.0;
    for (int d = 0; d < domain.dimensions(); ++d) face = std::max(face, cells / size[d][kind >> d & 1]);
    sum += blocks * 2.0 * grid::ghost_layers * face;
  }
  return sum;
}

void add_gas_memory(run::Case const& setup, Index3 const& parts, Plan& p) {
  double const components = gas_components(setup);
  double const cells = cells_of(setup.domain);
  p.memory.push_back(
      {fmt::format("state of the gas, {:g} values per cell", components), components * cells * double_bytes});
  p.memory.push_back({"ghost layers of the blocks", components * ghost_cells(setup.domain, parts) * double_bytes});
  if (setup.output.peak_fields)
    p.memory.push_back({"peak fields (output.peak_fields)", peak_components * cells * double_bytes});
  p.memory.push_back({"a field on its way to the disk", std::min(largest_dump_cache, cells * 3.0 * double_bytes)});
}

void sum_memory(Plan& p) {
  p.memory.push_back({"the program itself", program_bytes});
  p.memory_bytes = 0.0;
  for (MemoryPart const& part : p.memory) p.memory_bytes += part.bytes;
  std::ranges::stable_sort(p.memory, std::ranges::greater{}, &MemoryPart::bytes);
}

/// Cells around a shape, in the domain.
double boxed_cells(shape::Shape const& shape, grid::Domain const& domain) {
  auto const box = shape::bounds(shape);
  double cells = 1.0;
  for (int d = 0; d < domain.dimensions(); ++d)
    cells *=
        std::max(0.0, std::min(box.upper[d], domain.upper(d)) - std::max(box.lower[d], domain.lower[d])) / domain.h;
  return cells;
}

/// May the grid's list of blocks be made for a look at it?
bool is_small_list(grid::Domain const& domain, Index3 const& parts) {
  double blocks = 1.0;
  for (int d = 0; d < 3; ++d) blocks *= parts[d];
  return blocks <= most_blocks_tried && *std::ranges::max_element(domain.cells) <= longest_row_tried;
}

/// A charge that fills too many cells to try it out.
run::ChargeReport untried_charge(run::Charge const& charge, grid::Domain const& domain, std::string const& what) {
  (void)detonation::symmetry_images(charge.shape, domain, what);  // refuses what it refuses later
  double const volume = charge.mass / charge.explosive.density();
  run::ChargeReport report;
  report.explosive = charge.explosive.name;
  report.asked_mass = charge.mass;
  report.realised_mass = std::numeric_limits<double>::quiet_NaN();
  report.realised_energy = volume * charge.explosive.energy;
  report.cells_per_radius = shape::equivalent_radius(volume, domain.geometry) / domain.h;
  return report;
}

double signal(material::Eos const& eos, run::FluidState const& state) {
  double speed = 0.0;
  for (double const u : state.velocity) speed = std::max(speed, std::abs(u));
  return speed + material::sound_speed(eos, state.density, state.pressure);
}

/// Estimate of the number of steps: the time step follows the fastest signal. Behind a detonation it starts at the
/// detonation speed D and falls with the fireball's expansion, s = D / (1 + t / (3 t0))^0.35 with t0 = charge radius /
/// D; where the radius is resolved, the hot core on the axis holds it near 0.35 D. Both numbers were read off
/// calculations of TNT in air, and are good to about a factor of two.
double estimated_steps(run::Case const& setup) {
  double quiet = signal(setup.ambient.fluid.eos, setup.ambient.state);
  for (run::Region const& region : setup.regions) {
    bool const second = region.second_fluid && setup.second_fluid;
    quiet = std::max(quiet, signal(second ? setup.second_fluid->eos : setup.ambient.fluid.eos, region.state));
  }
  for (int face = 0; face < 6; ++face) {
    if (setup.domain.boundary[face] == grid::Boundary::inflow)
      quiet = std::max(quiet, signal(setup.ambient.fluid.eos, setup.inflow[face]));
  }
  double const end = setup.end.time;
  double path = quiet * end;  // what the fastest signal travels [m]
  for (run::Charge const& charge : setup.charges) {
    double const D = charge.explosive.detonation_speed;
    double const t0 = shape::equivalent_radius(charge.mass / charge.explosive.density(), setup.domain.geometry) / D;
    double const core = grid::radial_exponent(setup.domain.geometry) > 0 ? 0.35 * D : 0.0;
    constexpr int intervals = 400;
    double sum = 0.0;
    double before = 0.0;
    for (int n = 1; n <= intervals; ++n) {
      double const t = end * std::pow(static_cast<double>(n) / intervals, 4);
      double const s = D / std::pow(1.0 + 0.5 * (t + before) / (3.0 * t0), 0.35);
      sum += std::max({quiet, core, s}) * (t - before);
      before = t;
    }
    path = std::max(path, sum);
  }
  double const steps = path / (setup.numerics.courant * setup.domain.h) + 5.0;  // 5 for the gentle start
  return setup.end.steps > 0 ? std::min(steps, static_cast<double>(setup.end.steps)) : steps;
}

double relative_error(run::ChargeReport const& c) { return (c.realised_mass - c.asked_mass) / c.asked_mass; }

/// A charge that bursts in one direction first.
void plan_start(run::Case const& setup, std::size_t number, std::string const& what, Plan& p) {
  run::Charge const& charge = setup.charges[number];
  double const images = detonation::symmetry_images(charge.shape, setup.domain, what);
  run::ChargeReport report;
  report.explosive = charge.explosive.name;
  report.asked_mass = charge.mass;
  double reach = 0.0;
  double realised = 0.0;  // in the domain
  auto const planes = detonation::planes_through(setup.domain, shape::centre(charge.shape));
  double share = 1.0;
  for (int const plane : planes) share *= plane != 0 ? 0.5 : 1.0;
  if (number < setup.start.profiles.size()) {
    detonation::Profile const& profile = *setup.start.profiles[number];
    bool const half = profile.mirrored && std::abs(profile.domain.lower[1]) < 1e-6 * profile.domain.h;
    realised = share * (half ? 2.0 : 1.0) * profile.sum(gas::second_density);
    report.cells_per_radius = profile.charge.radius / profile.domain.h;
    reach = profile.reach();
    p.starts.push_back(fmt::format("profile \"{}\" of {}, time {}, the burst has a radius of {}, {:.3g} cells",
                                   setup.start.profile, word_of(profile.domain.geometry), quantity(profile.time, "s"),
                                   quantity(reach, "m"), reach / setup.domain.h));
  } else if (setup.start.profile.empty()) {
    setup::StartPlan const plan = setup::plan_start(setup, number);
    run::Case const one = setup::start_case(setup, number, plan);
    grid::Grid const grid(one.domain);
    auto const ball = setup::realised_charge(one.charges.front(), grid, what);
    realised = share * ball.realised_mass;
    report.cells_per_radius = plan.charge_radius / plan.cell;
    reach = plan.radius;
    std::string const until =
        setup.start.time ? fmt::format("until {}", quantity(*setup.start.time, "s"))
        : setup.start.radius
            ? fmt::format("until the shock has come to {}", quantity(plan.radius, "m"))
            : fmt::format("until the shock has come to {}, near {}", quantity(plan.radius, "m"), plan.reach.by);
    p.starts.push_back(fmt::format("{} by {}, {} cells of {}, {}; then remapped, {:.3g} cells per radius",
                                   word_of(plan.geometry),
                                   setup.start.method == run::StartMethod::gas ? "the gas scheme" : "material points",
                                   plan.cells, quantity(plan.cell, "m"), until, reach / setup.domain.h));
  } else {
    return;  // resumed: the file is not needed any more
  }
  report.realised_mass = realised * images;
  report.realised_energy = report.realised_mass * charge.explosive.specific_energy();
  p.charges.push_back(report);
  if (reach < coarse_burst * setup.domain.h) {
    p.warnings.push_back(fmt::format(
        "{} is remapped when its burst has only {:.2g} cells per radius: its shock will be coarse; a cell of {} would "
        "give {:g}",
        what, reach / setup.domain.h, quantity(reach / coarse_burst, "m", 2), coarse_burst));
  }
}

/// Regions and obstacles as they will be placed.
void plan_placed(run::Case const& setup, detonation::TakenCells const& taken, Plan& p) {
  double const h = setup.domain.h;
  if (setup::RegionPlacing regions(setup); regions.measure(most_cut_cells)) {
    regions.give_way(taken);
    p.regions = regions.reports();
  }
  for (std::size_t n = 0; n < setup.regions.size(); ++n) {
    auto const box = shape::bounds(setup.regions[n].shape);
    double across = std::numeric_limits<double>::infinity();
    for (int d = 0; d < setup.domain.dimensions(); ++d) across = std::min(across, (box.upper[d] - box.lower[d]) / h);
    if (across < 1.0) {
      p.warnings.push_back(
          fmt::format("region {} is only {:.2g} cells thick: it has its mass and energy, but they are spread over the "
                      "cells that it touches; a cell of {} would give it one of its own",
                      n + 1, across, quantity(h * across, "m", 2)));
    }
  }
  if (auto obstacles = setup::SolidCells(setup.domain, setup.obstacles).reports(most_cut_cells)) {
    p.obstacles = std::move(*obstacles);
    for (run::ObstacleReport const& o : p.obstacles) {
      if (std::abs(o.excess) <= coarse_obstacle * o.asked_volume) continue;
      p.warnings.push_back(fmt::format(
          "obstacle \"{}\" is {:.0f} % {} on these cells than it is: smaller cells, or faces between cells, would "
          "give it its size",
          o.name, 100.0 * std::abs(o.excess) / o.asked_volume, o.excess > 0.0 ? "larger" : "smaller"));
    }
    setup::SolidCells const solid(setup.domain, setup.obstacles);
    p.panels = setup::place_panels(setup.domain, setup.obstacles, solid);
  }
}

void plan_gas(run::Case const& setup, Plan& p) {
  Index3 const parts = grid::parts_of(setup.domain, setup.numerics.block_cells);
  p.blocks = parts[0] * parts[1] * parts[2];
  add_gas_memory(setup, parts, p);
  p.steps = estimated_steps(setup);
  std::optional<grid::Grid> grid;
  if (is_small_list(setup.domain, parts)) grid.emplace(setup.domain, setup.numerics.block_cells);
  setup::SolidCells const solid(setup.domain, setup.obstacles);
  detonation::TakenCells taken;
  int number = 0;
  for (run::Charge const& charge : setup.charges) {
    ++number;
    std::string const what = setup.charges.size() == 1 ? "the charge" : fmt::format("charge {}", number);
    if (setup.start.remap) {
      plan_start(setup, number - 1, what, p);
      continue;
    }
    if (double const around = boxed_cells(charge.shape, setup.domain); grid && around <= most_cells_tried) {
      p.charges.push_back(setup::realised_charge(charge, *grid, what, &solid, &taken));
    } else {
      p.charges.push_back(untried_charge(charge, setup.domain, what));
      p.warnings.push_back(
          fmt::format("{} lies in a box of {} cells in a grid of {} blocks: it was not tried out "
                      "what mass it has there",
                      what, large_count(around), large_count(p.blocks)));
    }
    double const resolution = p.charges.back().cells_per_radius;
    if (resolution < coarse_charge) {
      p.warnings.push_back(fmt::format(
          "{} has only {:.2g} cells per radius: the near field will be coarse; a cell of {} would give {:g}", what,
          resolution, quantity(setup.domain.h * resolution / coarse_charge, "m", 2), coarse_charge));
    }
  }
  plan_placed(setup, taken, p);
  double const values = gas_components(setup) + (setup.output.peak_fields ? peak_components : 0.0);
  p.checkpoint_bytes = static_cast<double>(setup.domain.cell_count()) * values * double_bytes;
  p.dump_bytes =
      output::FieldSeries::bytes_per_dump(setup.domain, output::dumped_fields(setup), setup.output.single_precision);
  double const records =
      setup.output.gauge_interval > 0.0 ? std::min(p.steps, setup.end.time / setup.output.gauge_interval) : p.steps;
  p.gauge_bytes = records * bytes_per_record * static_cast<double>(setup.gauges.size());
  p.gauges = plan_gauges(setup);
  if (auto const warning = clipping_warning(p.gauges, setup.domain.h)) p.warnings.push_back(*warning);
}

/// Nodes that carry the points: their cells, with the margins of the patches, once for each grid field.
void add_point_memory(run::Points const& points, Plan& p, int dimensions) {
  double nodes = 0.0;
  for (std::size_t b = 0; b < p.bodies.size(); ++b)
    nodes += static_cast<double>(p.bodies[b].points) / std::pow(points.bodies[b].points_per_direction, dimensions);
  constexpr double margins = 2.0;  // blocks of 8 cells with two layers around: (12/8)^3 and less
  double const records = std::min(p.steps, p.gauge_bytes / bytes_per_point_record);
  if (p.region) nodes += p.region->cells;
  p.memory.push_back({"material points", p.points * bytes_per_point});
  p.memory.push_back({"nodes around the material points", nodes * margins * bytes_per_node});
  p.memory.push_back({"records of the gauges on bodies", records * sizeof(observe::PointRecord)});
}

double fastest_signal(run::Body const& body) {
  material::Solid const& solid = body.solid;
  double const density = body.density.value_or(solid.density);
  double pressure = material::start_pressure(solid);
  if (body.density || body.specific_energy)
    pressure = material::pressure(solid.eos, density, body.specific_energy.value_or(solid.specific_energy));
  double const sound = body.rigid ? 0.0 : material::sound_speed(solid, density, pressure);
  double const burn = body.initiation.empty() ? 0.0 : solid.detonation_speed;
  return std::max(sound, burn) + norm(body.velocity);
}

/// Length of a step that the start allows [s].
double estimated_point_step(run::Case const& setup) {
  double fastest = 0.0;
  for (run::Body const& body : setup.points.bodies) fastest = std::max(fastest, fastest_signal(body));
  return setup.points.options.courant * setup.domain.h / fastest;
}

/// Steps at the length that the start allows.
double estimated_point_steps(run::Case const& setup) {
  double const steps = setup.end.time / estimated_point_step(setup) + 5.0;  // 5 for the gentle start
  return setup.end.steps > 0 ? std::min(steps, static_cast<double>(setup.end.steps)) : steps;
}

/// The bodies as they will be filled. One that would have more than `most_points` is not filled but estimated.
run::BodyReport realised(run::Body const& body, grid::Domain const& domain, double most_points) {
  run::BodyReport report;
  report.name = body.name;
  report.material = body.solid.name;
  double const density = body.density.value_or(body.solid.density);
  double const per_cell = std::pow(body.points_per_direction, domain.dimensions());
  double const most = boxed_cells(body.shape, domain) * per_cell;
  if (most > most_points) {
    // The box around the part in the domain holds no more than the body, and the body no more than its volume.
    double cell = domain.h;
    for (int d = 1; d < domain.dimensions(); ++d) cell *= domain.h;
    double const whole = grid::radial_exponent(domain.geometry) > 0
                             ? most
                             : shape::volume(body.shape, domain.geometry) / cell * per_cell;
    report.points = static_cast<long>(std::min(most, whole));
    report.mass = report.geometric_mass = std::numeric_limits<double>::quiet_NaN();
    return report;
  }
  auto const placement = shape::place_particles(body.shape, domain, body.points_per_direction);
  report.points = static_cast<long>(placement.positions.size());
  for (double const volume : placement.volumes) report.mass += density * volume;
  report.geometric_mass = density * placement.volume;
  return report;
}

double relative_error(run::BodyReport const& b) { return (b.mass - b.geometric_mass) / b.geometric_mass; }

/// Points across the shortest side of a body.
double points_across(run::Body const& body, grid::Domain const& domain) {
  auto const box = shape::bounds(body.shape);
  double across = std::numeric_limits<double>::infinity();
  for (int d = 0; d < domain.dimensions(); ++d) {
    bool const mirrored = domain.boundary[2 * d] == grid::Boundary::symmetry && box.lower[d] <= domain.lower[d];
    double const size = box.upper[d] - box.lower[d];
    // A body that reaches over a symmetry plane goes on behind it.
    across = std::min(across, (mirrored ? 2.0 : 1.0) * size / domain.h * body.points_per_direction);
  }
  return across;
}

void plan_points(run::Case const& setup, Plan& p) {
  auto const& points = setup.points;
  p.steps = estimated_point_steps(setup);
  for (run::Body const& body : points.bodies) {
    // What no machine holds, or is a lot for a look, is not tried out.
    p.bodies.push_back(realised(body, setup.domain, most_points_tried - p.points));
    p.points += static_cast<double>(p.bodies.back().points);
    if (p.bodies.back().points == 0) {
      throw InputError(fmt::format("body \"{}\" holds no material point: it is much smaller than a cell", body.name));
    }
    if (double const across = points_across(body, setup.domain);
        body.solid.has_deviator() && !body.rigid && across < coarse_body - 0.01) {
      p.warnings.push_back(
          fmt::format("body \"{}\" has only {:.2g} points across its shortest side: it will bend and yield poorly; a "
                      "cell of {} would give {:g}",
                      body.name, across, quantity(setup.domain.h * across / coarse_body, "m", 2), coarse_body));
    }
  }
  double const step = estimated_point_step(setup);
  for (std::size_t n = 0; n < points.pressures.size(); ++n) {
    auto const& times = points.pressures[n].times;
    if (times.size() < 2 || !std::isfinite(step) || times.back() - times.front() >= few_steps * step) continue;
    p.warnings.push_back(
        fmt::format("surface pressure {} acts for {}, and a step takes about {}: its impulse will not be right, or it "
                    "passes between two steps; a smaller points.courant or cell makes the steps shorter",
                    n + 1, quantity(times.back() - times.front(), "s", 3), quantity(step, "s", 2)));
  }
  double const records =
      setup.output.gauge_interval > 0.0 ? std::min(p.steps, setup.end.time / setup.output.gauge_interval) : p.steps;
  p.gauge_bytes = records * bytes_per_point_record * static_cast<double>(points.gauges.size());
  add_point_memory(points, p, setup.domain.dimensions());
  p.checkpoint_bytes = p.points * bytes_per_point;
  double const dumped = p.points - (p.region && !setup.output.gas_points ? p.region->gas_points : 0.0);
  p.dump_bytes =
      output::PointSeries::bytes_per_dump(dumped, output::dumped_point_fields(setup), setup.output.single_precision);
}

/// Gas and points together. Each takes steps of its own within common ones, see `run::stable_step`.
void plan_region(run::Case const& setup, Plan& p) {
  grid::Domain const& domain = setup.domain;
  bridge::Region const region = setup::region_of(setup);
  RegionPlan r;
  r.cells = static_cast<double>(region.cells().size());
  for (int d = 0; d < domain.dimensions(); ++d) {
    auto const [low, high] = std::minmax_element(region.cells().begin(), region.cells().end(),
                                                 [d](Index3 const& a, Index3 const& b) { return a[d] < b[d]; });
    r.lower[d] = domain.lower[d] + (*low)[d] * domain.h;
    r.upper[d] = domain.lower[d] + ((*high)[d] + 1) * domain.h;
  }
  for (bridge::Face const& face : region.faces()) {
    if (!face.open) ++r.bridge_faces[2 * face.direction + face.side];
  }
  Plan gas = p;
  plan_gas(setup, gas);
  p.memory = gas.memory;
  p.region = r;
  // The gas fills what the bodies leave, with points of its own density.
  double cells = r.cells;
  plan_points(setup, p);
  p.memory = gas.memory;  // that of the points follows when those of the gas are known
  for (std::size_t b = 0; b < p.bodies.size(); ++b) {
    cells -= static_cast<double>(p.bodies[b].points) /
             std::pow(setup.points.bodies[b].points_per_direction, domain.dimensions());
  }
  r.gas_points =
      std::max(0.0, cells) * std::pow(setup.mpm_region->gas_points(domain.dimensions()), domain.dimensions());
  r.gas_steps = gas.steps;
  // Gas points see the signals of the gas, at the Courant number of the points.
  double const gas_point_steps = gas.steps * setup.numerics.courant / setup.points.options.courant;
  r.point_steps = std::max(setup.points.any() ? p.steps : 0.0, gas_point_steps);
  p.region = r;
  p.points += r.gas_points;
  p.blocks = gas.blocks;
  p.charges = gas.charges;
  p.regions = gas.regions;
  p.obstacles = gas.obstacles;
  p.starts = gas.starts;
  p.gauges = gas.gauges;
  double const shorter = std::min(r.gas_steps, r.point_steps);
  p.steps = setup.mpm_region->subcycling ? std::max({shorter, r.gas_steps / 4.0, r.point_steps / 64.0})
                                         : std::max(r.gas_steps, r.point_steps);
  add_point_memory(setup.points, p, domain.dimensions());
  double const dumped = p.points - (setup.output.gas_points ? 0.0 : r.gas_points);
  p.dump_bytes = gas.dump_bytes + output::PointSeries::bytes_per_dump(dumped, output::dumped_point_fields(setup),
                                                                      setup.output.single_precision);
  p.gauge_bytes += gas.gauge_bytes;
  p.checkpoint_bytes = gas.checkpoint_bytes + p.points * bytes_per_point;
  p.warnings.insert(p.warnings.end(), gas.warnings.begin(), gas.warnings.end());
}

/// Time of the steps, were no cell at rest.
double estimated_seconds(run::Case const& setup, Plan const& p) {
  double const parts = p.blocks > 0 ? p.blocks : std::max(1.0, p.cells / 512.0);  // points: blocks of 8^3 cells
  double const workers = std::min<double>(threads(), parts);
  double const rate = workers > 1.0 ? workers * thread_share : 1.0;
  bool const gas = !setup.points.any() || setup.mpm_region;
  double seconds = 0.0;
  if (gas) {
    double per_second = two_fluids(setup) ? two_fluid_rate : one_fluid_rate;
    if (gas_components(setup) == gas::afterburn_components) per_second *= afterburn_share;
    // A step has one sweep per direction, and the rates are those of three.
    double const sweeps = setup.domain.dimensions() / 3.0;
    seconds += p.cells * (p.region ? p.region->gas_steps : p.steps) * sweeps / per_second;
  }
  if (p.points > 0.0) {
    bool const linear = setup.points.options.shape == mpm::ShapeFunction::linear;
    seconds += p.points * (p.region ? p.region->point_steps : p.steps) / (linear ? linear_point_rate : point_rate);
  }
  return seconds / rate;
}

/// Name, role and source of every material of a case.
struct MaterialLine {
  std::string name;
  std::string role;
  std::string source;
};

std::vector<MaterialLine> materials_of(run::Case const& setup) {
  std::vector<MaterialLine> lines;
  if (!setup.points.any() || setup.mpm_region)
    lines.push_back({setup.ambient.fluid.name, "ambient fluid", setup.ambient.fluid.source});
  for (run::Body const& body : setup.points.bodies) {
    bool const known =
        std::any_of(lines.begin(), lines.end(), [&](MaterialLine const& l) { return l.name == body.solid.name; });
    if (!known) lines.push_back({body.solid.name, "body", body.solid.source});
  }
  if (setup.second_fluid && setup.charges.empty())
    lines.push_back({setup.second_fluid->name, "second fluid", setup.second_fluid->source});
  for (run::Charge const& charge : setup.charges) {
    bool const known =
        std::any_of(lines.begin(), lines.end(), [&](MaterialLine const& l) { return l.name == charge.explosive.name; });
    if (!known) lines.push_back({charge.explosive.name, "explosive", charge.explosive.source});
  }
  return lines;
}

}  // namespace

Plan plan(run::Case const& setup) {
  Plan p;
  p.cells = static_cast<double>(setup.domain.cell_count());
  p.machine_memory_bytes = machine_memory();
  p.dumps = static_cast<long>(output::dump_times(setup.output, setup.end.time).size());
  if (setup.mpm_region) {
    plan_region(setup, p);
  } else if (setup.points.any()) {
    plan_points(setup, p);
  } else {
    plan_gas(setup, p);
  }
  sum_memory(p);
  p.disk_bytes =
      static_cast<double>(p.dumps) * p.dump_bytes + p.gauge_bytes + (setup.checkpoint.keep + 1) * p.checkpoint_bytes;
  p.seconds = estimated_seconds(setup, p);
  if (p.memory_bytes > p.machine_memory_bytes) {
    p.warnings.push_back(
        fmt::format("this machine has {} of memory: the case will be refused here", bytes(p.machine_memory_bytes)));
  }
  return p;
}

void refuse_unless_it_fits(Plan const& p) {
  if (p.memory_bytes <= p.machine_memory_bytes) return;
  std::string const most = p.memory.empty() ? ""
                                            : fmt::format(" (most of it, {}, for: {})", bytes(p.memory.front().bytes),
                                                          p.memory.front().what);
  throw InputError(
      p.region
          ? fmt::format(
                "the case needs about {} of memory for its {} cells and {} material points{}, and this machine "
                "has {}: use larger cells (domain.cell), a smaller domain or MPM region, fewer points per cell, or "
                "symmetry planes",
                bytes(p.memory_bytes), large_count(p.cells), large_count(p.points), most, bytes(p.machine_memory_bytes))
      : p.points > 0.0
          ? fmt::format("the case needs about {} of memory for its {} material points{}, and this machine has {}: "
                        "use "
                        "larger cells (domain.cell), fewer points per cell, or symmetry planes",
                        bytes(p.memory_bytes), large_count(p.points), most, bytes(p.machine_memory_bytes))
          : fmt::format("the case needs about {} of memory for its {} cells{}, and this machine has {}: use larger "
                        "cells (domain.cell), a smaller domain, or symmetry planes",
                        bytes(p.memory_bytes), large_count(p.cells), most, bytes(p.machine_memory_bytes)));
}

namespace {

std::string end_text(run::End const& end) {
  std::string text = quantity(end.time, "s");
  if (end.steps > 0) text += fmt::format(", or {} steps", end.steps);
  if (end.gauges) text += ", or when all gauges are past their positive phase";
  if (end.kinetic_energy > 0.0)
    text += fmt::format(", or when the kinetic energy stays below {:g} of its largest value", end.kinetic_energy);
  if (end.wall_clock > 0.0) text += fmt::format("; stops after {} on the clock", clock_time(end.wall_clock));
  return text;
}

/// The parts that count, the largest first.
std::string memory_text(Plan const& p) {
  constexpr double counts = 0.02;
  std::string text;
  double rest = p.memory_bytes;
  for (MemoryPart const& part : p.memory) {
    if (part.bytes < counts * p.memory_bytes) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : "; ", part.what, bytes(part.bytes));
    rest -= part.bytes;
  }
  return rest > 0.5e-3 * p.memory_bytes ? text + fmt::format("; the rest {}", bytes(rest)) : text;
}

std::string afterburn_text(material::Afterburn const& a) {
  std::string const rate =
      a.carried() ? [m = std::get<material::MillerAfterburn>(a.rate)] {
        return fmt::format("d(lambda)/dt = {:g}/s (1 - lambda)^{:g} (p/{})^{:g} above {}", m.rate, m.m,
                           quantity(m.reference_pressure, "Pa"), m.n, quantity(m.minimum_pressure, "Pa"));
      }()
                  : [c = std::get<material::ConstantRateAfterburn>(a.rate)] {
                      return fmt::format("at a constant rate from {} to {}", quantity(c.begin, "s"),
                                         quantity(c.end, "s"));
                    }();
  return fmt::format("{}/kg of products, {}", quantity(a.energy, "J"), rate);
}

std::string region_text(run::Case const& setup, RegionPlan const& r) {
  std::string box;
  for (int d = 0; d < setup.domain.dimensions(); ++d)
    box += fmt::format("{}{:g} to {:g}", d == 0 ? "" : " x ", r.lower[d], r.upper[d]);
  std::string faces;
  for (std::size_t f = 0; f < r.bridge_faces.size(); ++f) {
    if (r.bridge_faces[f] > 0) faces += fmt::format("{}{}", faces.empty() ? "" : ", ", grid::face_names[f]);
  }
  std::string const kind = setup.mpm_region->boxes.empty()      ? "the box around the bodies"
                           : setup.mpm_region->boxes.size() > 1 ? "several boxes"
                                                                : "as given";
  return fmt::format("{:<12} {} m, {} cells ({})\n", "MPM region", box, large_count(r.cells), kind) +
         fmt::format("{:<12} {}\n", "bridge",
                     faces.empty()
                         ? "none: the region fills the domain"
                         : fmt::format("{} cells wide, on the sides {} of the region", setup.mpm_region->width, faces));
}

constexpr std::size_t most_listed = 20;

double density_of(run::Body const& body) { return body.density.value_or(body.solid.density); }

std::string region_line(std::size_t number, run::RegionReport const& r) {
  return fmt::format(
      "{:<12} {}: {}, volume asked {:.6g} m3, placed {:.6g}; mass asked {:.6g} kg, placed {:.6g}; energy asked {}, "
      "placed {}\n",
      "", number + 1, r.fluid, r.asked_volume, r.volume, r.asked_mass, r.mass, quantity(r.asked_energy, "J", 6),
      quantity(r.energy, "J", 6));
}

std::string obstacle_line(run::ObstacleReport const& o) {
  return fmt::format("{:<12} {}: volume asked {:.6g} m3, placed {:.6g} in {} cells\n", "", o.name, o.asked_volume,
                     o.volume, o.cells);
}

std::string panel_line(run::PanelReport const& p) {
  std::string const mass = p.release.areal_mass > 0.0
                               ? fmt::format("{:.4g} kg/m2, open after a travel of {}", p.release.areal_mass,
                                             quantity(p.place.area / p.place.perimeter, "m", 3))
                               : "without mass";
  return fmt::format("{:<12} {}: a panel that gives way along {} at {}, area {:.6g} m2, {}\n", "", p.name,
                     "xyz"[p.place.direction], quantity(p.release.pressure, "Pa"), p.place.area, mass);
}

}  // namespace

std::string plan_text(run::Case const& setup, Plan const& p) {
  grid::Domain const& d = setup.domain;
  int const dims = d.dimensions();
  std::string out;
  auto const line = [&out](char const* label, std::string const& text) {
    out += fmt::format("{:<12} {}\n", label, text);
  };

  if (!setup.title.empty()) line("title", setup.title);
  std::string box;
  std::string cells;
  for (int k = 0; k < dims; ++k) {
    box += fmt::format("{}{:g} to {:g}", k == 0 ? "" : " x ", d.lower[k], d.upper(k));
    cells += fmt::format("{}{}", k == 0 ? "" : " x ", d.cells[k]);
  }
  line("domain", fmt::format("{}, {} m", word_of(d.geometry), box));
  bool const points = p.points > 0.0;
  bool const gas = !points || p.region;
  line("cells", fmt::format("{} = {} of {}{}", cells, large_count(p.cells), quantity(d.h, "m"),
                            !gas ? "" : fmt::format(", in {} blocks", p.blocks)));
  std::string boundaries;
  for (int f = 0; f < 2 * dims; ++f)
    boundaries += fmt::format("{}{} {}", f == 0 ? "" : ", ", grid::face_names[f], word_of(d.boundary[f]));
  line("boundaries", boundaries);
  if (p.region) out += region_text(setup, *p.region);
  if (points) {
    auto const& o = setup.points.options;
    line("points",
         fmt::format("{} in {} bod{}{}", large_count(p.points), p.bodies.size(), p.bodies.size() == 1 ? "y" : "ies",
                     p.region ? fmt::format(" and {} of the gas", large_count(p.region->gas_points)) : ""));
    line("scheme", fmt::format("material points, {}, {}, {}, Courant number {:g}", word_of(o.shape), word_of(o.order),
                               word_of(o.transfer), o.courant));
  }
  if (gas) {
    line(points ? "" : "scheme", fmt::format("{}, Courant number {:g}, {}", word_of(setup.numerics.scheme),
                                             setup.numerics.courant, two_fluids(setup) ? "two fluids" : "one fluid"));
  }
  line("end", end_text(setup.end));
  if (p.region) {
    line("steps",
         fmt::format("about {}, in them {} of the gas and {} of the points (estimates; fewer while the region "
                     "and blocks of the gas sleep)",
                     large_count(p.steps), large_count(p.region->gas_steps), large_count(p.region->point_steps)));
  } else if (points) {
    line("steps", fmt::format("about {} (as long as at the start; {} point updates)", large_count(p.steps),
                              large_count(p.steps * p.points)));
  } else {
    line("steps", fmt::format("about {} (estimate; up to {} cell updates, fewer while blocks sleep)",
                              large_count(p.steps), large_count(p.steps * p.cells)));
  }
  line("memory",
       fmt::format("about {} of {}: {}", bytes(p.memory_bytes), bytes(p.machine_memory_bytes), memory_text(p)));
  line("time", fmt::format("up to about {} on {} thread{} (estimate, from the rates of docs/benchmarks.md; less while "
                           "the gas is quiet)",
                           wall_time(p.seconds), threads(), threads() == 1 ? "" : "s"));
  line("disk", fmt::format("up to about {} (estimate): {} dumps of {} before compression, gauges {}, {} checkpoints of "
                           "{} at a time",
                           bytes(p.disk_bytes), p.dumps, bytes(p.dump_bytes), bytes(p.gauge_bytes),
                           setup.checkpoint.keep + 1, bytes(p.checkpoint_bytes)));

  out += "\n";
  if (gas) {
    line("ambient", fmt::format("{}, {}, {:.4g} kg/m3", setup.ambient.fluid.name,
                                quantity(setup.ambient.state.pressure, "Pa", 6), setup.ambient.state.density));
  }
  for (std::size_t n = 0; n < p.bodies.size(); ++n) {
    auto const& b = p.bodies[n];
    auto const& body = setup.points.bodies[n];
    auto const& v = body.velocity;
    line("body", fmt::format("{}: {}, {} points, {} per cell and direction{}{}", b.name, b.material,
                             large_count(static_cast<double>(b.points)), body.points_per_direction,
                             norm(v) > 0.0 ? fmt::format(", ({:g}, {:g}, {:g}) m/s", v[0], v[1], v[2]) : "",
                             body.rigid ? ", rigid" : ""));
    if (std::isfinite(b.mass))
      line("", fmt::format("mass of the points {:.8g} kg, of the shape {:.8g} kg, relative error {:.1e}; volume {:.6g} "
                           "and {:.6g} m3",
                           b.mass, b.geometric_mass, relative_error(b), b.mass / density_of(body),
                           b.geometric_mass / density_of(body)));
  }
  for (std::size_t n = 0; n < p.charges.size(); ++n) {
    auto const& c = p.charges[n];
    auto const& charge = setup.charges[n];
    auto const x = shape::centre(charge.shape);
    line(p.charges.size() == 1 ? "charge" : fmt::format("charge {}", n + 1).c_str(),
         fmt::format("{} at ({:g}, {:g}, {:g}) m, {} detonation", c.explosive, x[0], x[1], x[2],
                     charge.detonation == run::Detonation::programmed ? "programmed" : "instantaneous"));
    line("", std::isfinite(c.realised_mass)
                 ? fmt::format("mass asked {:.8g} kg, realised {:.8g} kg, relative error {:.1e}", c.asked_mass,
                               c.realised_mass, relative_error(c))
                 : fmt::format("mass asked {:.8g} kg, realised: not tried out", c.asked_mass));
    double const density = charge.explosive.density();
    line("", fmt::format("volume asked {:.6g} m3, realised {}; energy asked {}, realised {}; {:.3g} cells per radius",
                         c.asked_mass / density,
                         std::isfinite(c.realised_mass) ? fmt::format("{:.6g} m3", c.realised_mass / density)
                                                        : std::string("not tried out"),
                         quantity(c.asked_mass * charge.explosive.specific_energy(), "J", 6),
                         quantity(c.realised_energy, "J", 6), c.cells_per_radius));
    if (n < p.starts.size()) line("start", p.starts[n]);
  }
  if (setup.afterburn) line("afterburn", afterburn_text(*setup.afterburn));
  if (!setup.regions.empty()) line("regions", fmt::format("{}", setup.regions.size()));
  for (std::size_t n = 0; n < p.regions.size(); ++n) out += region_line(n, p.regions[n]);
  if (!setup.obstacles.empty()) line("obstacles", fmt::format("{}", setup.obstacles.size()));
  for (std::size_t n = 0; n < p.obstacles.size() && n < most_listed; ++n) out += obstacle_line(p.obstacles[n]);
  if (p.obstacles.size() > most_listed) line("", fmt::format("and {} more", p.obstacles.size() - most_listed));
  for (std::size_t n = 0; n < p.panels.size() && n < most_listed; ++n) out += panel_line(p.panels[n]);
  if (p.panels.size() > most_listed) line("", fmt::format("and {} more panels", p.panels.size() - most_listed));
  for (MaterialLine const& m : materials_of(setup))
    line("material", fmt::format("{} ({}): {}", m.name, m.role, m.source));

  out += "\n";
  std::size_t const gauges = setup.points.gauges.size() + setup.gauges.size();
  line("gauges", gauges == 0 ? "none" : fmt::format("{}, about {}", gauges, bytes(p.gauge_bytes)));
  out += gauge_plan_text(p.gauges);
  std::string fields;
  for (auto const& f : output::dumped_fields(setup)) fields += (fields.empty() ? "" : ", ") + f.name;
  auto const point_fields = output::dumped_point_fields(setup);
  if (p.region && !point_fields.empty()) fields += "; of points:";
  for (std::size_t n = 0; n < point_fields.size(); ++n)
    fields += (fields.empty() ? "" : n == 0 ? " " : ", ") + point_fields[n].name;
  line("fields", fmt::format("{} dumps of {} before compression: {}", p.dumps, bytes(p.dump_bytes), fields));
  line("checkpoints", fmt::format("{} of about {} stay", setup.checkpoint.keep, bytes(p.checkpoint_bytes)));
  std::vector<std::string> warnings;
  for (auto const& w : p.warnings) warnings.push_back(fmt::format("\nwarning: {}", w));
  return out + listed(warnings);
}

nlohmann::json plan_json(run::Case const& setup, Plan const& p) {
  using nlohmann::json;
  json charges = json::array();
  for (std::size_t n = 0; n < p.charges.size(); ++n) {
    auto const& c = p.charges[n];
    auto const& explosive = setup.charges[n].explosive;
    charges.push_back({{"explosive", c.explosive},
                       {"asked_mass", c.asked_mass},
                       {"realised_mass", output::json_or_null(c.realised_mass)},
                       {"relative_error", output::json_or_null(relative_error(c))},
                       {"asked_volume", c.asked_mass / explosive.density()},
                       {"realised_volume", output::json_or_null(c.realised_mass / explosive.density())},
                       {"asked_energy", c.asked_mass * explosive.specific_energy()},
                       {"realised_energy", c.realised_energy},
                       {"cells_per_radius", c.cells_per_radius}});
  }
  json bodies = json::array();
  for (std::size_t n = 0; n < p.bodies.size(); ++n) {
    auto const& b = p.bodies[n];
    double const density = density_of(setup.points.bodies[n]);
    bodies.push_back({{"name", b.name},
                      {"material", b.material},
                      {"points", b.points},
                      {"mass", output::json_or_null(b.mass)},
                      {"geometric_mass", output::json_or_null(b.geometric_mass)},
                      {"volume", output::json_or_null(b.mass / density)},
                      {"geometric_volume", output::json_or_null(b.geometric_mass / density)},
                      {"relative_error", output::json_or_null(relative_error(b))}});
  }
  json memory = json::array();
  for (MemoryPart const& part : p.memory) memory.push_back({{"what", part.what}, {"bytes", part.bytes}});
  json materials = json::array();
  for (MaterialLine const& m : materials_of(setup))
    materials.push_back({{"name", m.name}, {"role", m.role}, {"source", m.source}});
  json boundaries = json::object();
  for (int f = 0; f < 2 * setup.domain.dimensions(); ++f)
    boundaries[grid::face_names[f]] = word_of(setup.domain.boundary[f]);
  json fields = json::array();
  for (auto const& f : output::dumped_fields(setup)) fields.push_back(f.name);
  for (auto const& f : output::dumped_point_fields(setup)) fields.push_back(f.name);
  json region;
  if (p.region) {
    region = {{"lower", p.region->lower},
              {"upper", p.region->upper},
              {"cells", p.region->cells},
              {"width", setup.mpm_region->width},
              {"bridge_faces", p.region->bridge_faces},
              {"gas_points", p.region->gas_points},
              {"gas_steps", std::round(p.region->gas_steps)},
              {"point_steps", std::round(p.region->point_steps)}};
  }
  return {{"title", setup.title},
          {"geometry", word_of(setup.domain.geometry)},
          {"cells", setup.domain.cells},
          {"cell_count", setup.domain.cell_count()},
          {"cell_size", setup.domain.h},
          {"blocks", p.blocks},
          {"boundaries", boundaries},
          {"memory_bytes", p.memory_bytes},
          {"memory", memory},
          {"estimated_seconds", p.seconds},
          {"threads", threads()},
          {"disk_bytes", p.disk_bytes},
          {"machine_memory_bytes", p.machine_memory_bytes},
          {"end_time", setup.end.time},
          {"estimated_steps", std::round(p.steps)},
          {"charges", charges},
          {"starts", p.starts},
          {"points", p.points},
          {"bodies", bodies},
          {"materials", materials},
          {"mpm_region", region},
          {"gauges", setup.points.gauges.size() + setup.gauges.size()},
          {"gauge_bytes", p.gauge_bytes},
          {"gauge_peaks", gauge_plan_json(p.gauges)},
          {"obstacles", setup.obstacles.size()},
          {"placed_regions", output::regions_json(p.regions)},
          {"placed_obstacles", output::obstacles_json(p.obstacles)},
          {"panels", output::panels_json(p.panels)},
          {"fields", fields},
          {"dumps", p.dumps},
          {"dump_bytes", p.dump_bytes},
          {"checkpoint_bytes", p.checkpoint_bytes},
          {"warnings", p.warnings}};
}

}  // namespace brisance::app
