#include "session/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/text.hpp"
#include "gas/layout.hpp"
#include "grid/partition.hpp"
#include "observe/particle_fields.hpp"
#include "output/writer.hpp"
#include "session/estimates.hpp"
#include "setup/place_gas.hpp"
#include "setup/place_initial_states.hpp"
#include "setup/place_obstacles.hpp"
#include "setup/place_panels.hpp"
#include "setup/place_region.hpp"
#include "setup/start.hpp"
#include "shape/cut_cells.hpp"
#include "shape/placement.hpp"

namespace brisance::session {

namespace {

constexpr double bytes_per_record = 100.0;  // one line of a gauge file
// Larger things are estimated: a look at a case of a thousand million cells must not take its memory or its time.
constexpr double most_cells_tried = 5e6;  // in the box around a charge
constexpr double most_particles_tried = 5e6;
constexpr double most_blocks_tried = 1e6;
constexpr int longest_row_tried = 100'000'000;  // cells
constexpr double coarse_body = 4.0;             // particles across a body's shortest side below which it hardly bends
constexpr double coarse_charge = 5.0;           // cells per charge radius below which the near field is poorly resolved
constexpr double coarse_burst = 15.0;           // cells per radius of a remapped burst below which its shock is
constexpr long most_cut_cells = 200'000;        // of initial states and obstacles that `check` counts
constexpr double coarse_obstacle = 0.2;     // fraction of its volume that an obstacle may win or lose without a warning
constexpr double few_steps = 5.0;           // that a load must last for its impulse to be right within some per cent
constexpr double alarming_clipping = 0.10;  // of the peak: beyond it there is a warning
constexpr double tolerable_clipping = 0.05;  // for which the warning names the cell

std::string percent(double fraction) { return fmt::format("{:.0f} %", 100.0 * fraction); }

/// Cells around a shape, in the domain.
double boxed_cells(shape::Shape const& shape, grid::Domain const& domain) {
  auto const box = shape::bounds(shape);
  double cells = 1.0;
  for (int d = 0; d < domain.dimensions(); ++d)
    cells *= std::max(0.0, std::min(box.upper[d], domain.upper(d)) - std::max(box.lower[d], domain.lower[d])) /
             domain.smallest_cell();
  return cells;
}

/// May the grid's list of blocks be made for a look at it?
bool is_small_list(grid::Domain const& domain, grid::Partition const& partition) {
  return partition.count() <= most_blocks_tried && *std::ranges::max_element(domain.cells) <= longest_row_tried;
}

/// A charge that fills too many cells to try it out.
run::ChargeReport untried_charge(run::Charge const& charge, grid::Domain const& domain, std::string const& what) {
  (void)detonation::symmetry_images(charge.shape, domain, what);  // refuses what it refuses later
  double const volume = charge.mass / charge.explosive.density();
  run::ChargeReport report;
  report.explosive = charge.explosive.name;
  report.specified_mass = charge.mass;
  report.realised_mass = std::numeric_limits<double>::quiet_NaN();
  report.realised_energy = volume * charge.explosive.energy;
  report.cells_per_radius = shape::equivalent_radius(volume, domain.geometry) / domain.smallest_cell();
  return report;
}

/// A charge that bursts in one direction first.
void plan_start(run::Case const& setup, std::size_t number, std::string const& what, Plan& p) {
  run::Charge const& charge = setup.charges[number];
  double const images = detonation::symmetry_images(charge.shape, setup.domain, what);
  run::ChargeReport report;
  report.explosive = charge.explosive.name;
  report.specified_mass = charge.mass;
  double reach = 0.0;
  double realised = 0.0;  // in the domain
  auto const planes = detonation::planes_through(setup.domain, shape::centre(charge.shape));
  double share = 1.0;
  for (int const plane : planes) share *= plane != 0 ? 0.5 : 1.0;
  if (number < setup.start.profiles.size()) {
    detonation::Profile const& profile = *setup.start.profiles[number];
    bool const half = profile.mirrored && std::abs(profile.domain.lower[1]) < 1e-6 * profile.domain.smallest_cell();
    realised = share * (half ? 2.0 : 1.0) * profile.sum(gas::partial_density(charge.fluid));
    report.cells_per_radius = profile.charge.radius / profile.domain.smallest_cell();
    reach = profile.reach();
    p.starts.push_back(fmt::format("profile \"{}\" from {}, time {}, blast wave radius {}, {:.3g} cells",
                                   setup.start.profile, word_of(profile.domain.geometry), quantity(profile.time, "s"),
                                   quantity(reach, "m"), reach / setup.domain.smallest_cell()));
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
            ? fmt::format("until the shock reaches {}", quantity(plan.radius, "m"))
            : fmt::format("until the shock reaches {}, near {}", quantity(plan.radius, "m"), plan.reach.by);
    p.starts.push_back(fmt::format("{} with {}, {} cells of {}, {}; then remapped, {:.3g} cells per radius",
                                   word_of(plan.geometry),
                                   setup.start.method == run::StartMethod::gas ? "the gas scheme" : "material points",
                                   plan.cells, quantity(plan.cell, "m"), until, reach / setup.domain.smallest_cell()));
  } else {
    return;  // resumed: the file is not needed any more
  }
  report.realised_mass = realised * images;
  report.realised_energy = report.realised_mass * charge.explosive.specific_energy();
  p.charges.push_back(report);
  if (reach < coarse_burst * setup.domain.smallest_cell()) {
    p.warnings.push_back(
        fmt::format("the blast wave of {} is remapped with only {:.2g} cells per radius: its shock will be coarse; a "
                    "cell size of {} would give {:g}",
                    what, reach / setup.domain.smallest_cell(), quantity(reach / coarse_burst, "m", 2), coarse_burst));
  }
}

/// Obstacles thinner than a cell that part its gas.
void warn_of_parted_cells(run::Case const& setup, Plan& p) {
  if (setup.obstacles.empty() || !setup::has_cut_cells(setup)) return;
  setup::SolidCells const solid(setup.domain, setup.obstacles);
  auto const parted = shape::cut_cells(solid.shapes(), setup.domain).parted;
  if (parted.empty()) return;
  Vec3 const x = setup.domain.centre(parted.front());
  p.warnings.push_back(fmt::format(
      "obstacles part the gas of {} cells, the first at ({:.4g}, {:.4g}, {:.4g}) m: there they are thinner than a "
      "cell, "
      "or leave a gap that is narrower; the larger piece of gas stays, the other is closed, and nothing leaks",
      parted.size(), x[0], x[1], x[2]));
}

/// Initial states and obstacles as they will be placed.
void plan_placed(run::Case const& setup, detonation::TakenCells const& taken, Plan& p) {
  double const h = setup.domain.smallest_cell();
  if (setup::InitialStatePlacing initial(setup); initial.measure(most_cut_cells)) {
    initial.give_way(taken);
    p.initial_states = initial.reports();
  }
  for (std::size_t n = 0; n < setup.initial_states.size(); ++n) {
    auto const box = shape::bounds(setup.initial_states[n].shape);
    double across = std::numeric_limits<double>::infinity();
    for (int d = 0; d < setup.domain.dimensions(); ++d) across = std::min(across, (box.upper[d] - box.lower[d]) / h);
    if (across < 1.0) {
      p.warnings.push_back(
          fmt::format("initial state {} is only {:.2g} cells thick: its mass and energy are exact but spread over all "
                      "cells that it touches; a cell size of {} would resolve it with one cell",
                      n + 1, across, quantity(h * across, "m", 2)));
    }
  }
  if (auto obstacles =
          setup::SolidCells(setup.domain, setup.obstacles, setup::has_cut_cells(setup)).reports(most_cut_cells)) {
    p.obstacles = std::move(*obstacles);
    warn_of_parted_cells(setup, p);
    for (run::ObstacleReport const& o : p.obstacles) {
      if (std::abs(o.excess) <= coarse_obstacle * o.specified_volume) continue;
      p.warnings.push_back(
          fmt::format("obstacle \"{}\" is {:.0f} % {} on the grid than specified: use smaller cells, or align its "
                      "faces with cell faces",
                      o.name, 100.0 * std::abs(o.excess) / o.specified_volume, o.excess > 0.0 ? "larger" : "smaller"));
    }
    setup::SolidCells const solid(setup.domain, setup.obstacles);
    p.panels = setup::place_panels(setup.domain, setup.obstacles, solid);
  }
}

void plan_gas(run::Case const& setup, Plan& p) {
  grid::Partition const partition = grid::partition_of(setup.domain, setup.numerics.block_cells);
  p.blocks = static_cast<decltype(p.blocks)>(partition.count());
  add_gas_memory(setup, partition, p);
  p.steps = estimated_steps(setup);
  std::optional<grid::Grid> grid;
  if (is_small_list(setup.domain, partition)) grid.emplace(setup.domain, setup.numerics.block_cells);
  setup::SolidCells const solid(setup.domain, setup.obstacles);
  std::function<double(Index3 const&)> open;
  if (solid.any()) open = [&](Index3 const& cell) { return setup::open_part(setup, solid, cell); };
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
      p.charges.push_back(setup::realised_charge(charge, *grid, what, open, &taken));
    } else {
      p.charges.push_back(untried_charge(charge, setup.domain, what));
      p.warnings.push_back(fmt::format(
          "{} lies in a box of {} cells in a grid of {} blocks, too many to compute its mass on the grid in advance",
          what, large_count(around), large_count(p.blocks)));
    }
    double const resolution = p.charges.back().cells_per_radius;
    if (resolution < coarse_charge) {
      p.warnings.push_back(fmt::format(
          "{} has only {:.2g} cells per radius: the near field will be coarse; a cell size of {} would give {:g}", what,
          resolution, quantity(setup.domain.smallest_cell() * resolution / coarse_charge, "m", 2), coarse_charge));
    }
  }
  plan_placed(setup, taken, p);
  double const values = gas_components(setup) + (setup.output.peak_fields ? peak_components : 0.0);
  p.checkpoint_bytes = static_cast<double>(setup.domain.cell_count()) * values * double_bytes;
  auto const bytes_of_dump = [&setup](output::IsLast last) {
    return output::FieldSeries::bytes_per_dump(setup.domain, output::dumped_fields(setup, last),
                                               setup.output.single_precision);
  };
  p.dump_bytes = bytes_of_dump(output::IsLast::no);
  p.last_dump_bytes = bytes_of_dump(output::IsLast::yes);
  double const records =
      setup.output.gauge_interval > 0.0 ? std::min(p.steps, setup.end.time / setup.output.gauge_interval) : p.steps;
  p.gauge_bytes = records * bytes_per_record * static_cast<double>(setup.gauges.size());
  p.gauges = plan_gauges(setup);
  if (auto const warning = clipping_warning(p.gauges, setup.domain.smallest_cell())) p.warnings.push_back(*warning);
}

/// The bodies as they will be filled. One that would have more than `most_points` is not filled but estimated.
run::BodyReport realised(run::Body const& body, grid::Domain const& domain, double most_particles) {
  run::BodyReport report;
  report.name = body.name;
  report.material = body.solid.name;
  double const density = body.density.value_or(body.solid.density);
  double const per_cell = std::pow(body.particles_per_direction, domain.dimensions());
  double const most = boxed_cells(body.shape, domain) * per_cell;
  if (most > most_particles) {
    // The box around the part in the domain holds no more than the body, and the body no more than its volume.
    double cell = domain.smallest_cell();
    for (int d = 1; d < domain.dimensions(); ++d) cell *= domain.smallest_cell();
    double const whole = grid::radial_exponent(domain.geometry) > 0
                             ? most
                             : shape::volume(body.shape, domain.geometry) / cell * per_cell;
    report.particles = static_cast<long>(std::min(most, whole));
    report.mass = report.geometric_mass = std::numeric_limits<double>::quiet_NaN();
    return report;
  }
  auto const placement = shape::place_particles(body.shape, domain, body.particles_per_direction);
  report.particles = static_cast<long>(placement.positions.size());
  for (double const volume : placement.volumes) report.mass += density * volume;
  report.geometric_mass = density * placement.volume;
  return report;
}

/// Particles across the shortest side of a body.
double particles_across(run::Body const& body, grid::Domain const& domain) {
  auto const box = shape::bounds(body.shape);
  double across = std::numeric_limits<double>::infinity();
  for (int d = 0; d < domain.dimensions(); ++d) {
    bool const mirrored = domain.boundary[2 * d] == grid::Boundary::symmetry && box.lower[d] <= domain.lower[d];
    double const size = box.upper[d] - box.lower[d];
    // A body that reaches over a symmetry plane goes on behind it.
    across = std::min(across, (mirrored ? 2.0 : 1.0) * size / domain.smallest_cell() * body.particles_per_direction);
  }
  return across;
}

void plan_particles(run::Case const& setup, Plan& p) {
  auto const& particles = setup.particles;
  p.steps = estimated_particle_steps(setup);
  for (run::Body const& body : particles.bodies) {
    // What no machine holds, or is a lot for a look, is not tried out.
    p.bodies.push_back(realised(body, setup.domain, most_particles_tried - p.particles));
    p.particles += static_cast<double>(p.bodies.back().particles);
    if (p.bodies.back().particles == 0) {
      throw InputError(
          fmt::format("body \"{}\" contains no material point: it is much smaller than a cell", body.name));
    }
    if (double const across = particles_across(body, setup.domain);
        body.solid.has_deviator() && !body.rigid && across < coarse_body - 0.01) {
      p.warnings.push_back(fmt::format(
          "body \"{}\" has only {:.2g} material points across its shortest side: bending and yielding will be "
          "inaccurate; a cell size of {} would give {:g}",
          body.name, across, quantity(setup.domain.smallest_cell() * across / coarse_body, "m", 2), coarse_body));
    }
  }
  double const step = estimated_particle_step(setup);
  for (std::size_t n = 0; n < particles.pressures.size(); ++n) {
    auto const& times = particles.pressures[n].times;
    if (times.size() < 2 || !std::isfinite(step) || times.back() - times.front() >= few_steps * step) continue;
    p.warnings.push_back(
        fmt::format("surface pressure {} acts for {}, but a time step is about {}: its impulse will be wrong, or the "
                    "steps will miss it; reduce points.courant or the cell size for shorter steps",
                    n + 1, quantity(times.back() - times.front(), "s", 3), quantity(step, "s", 2)));
  }
  double const records =
      setup.output.gauge_interval > 0.0 ? std::min(p.steps, setup.end.time / setup.output.gauge_interval) : p.steps;
  p.gauge_bytes = records * bytes_per_particle_record * static_cast<double>(particles.gauges.size());
  add_particle_memory(particles, p, setup.domain.dimensions());
  p.checkpoint_bytes = p.particles * bytes_per_particle;
  double const dumped = p.particles - (p.region && !setup.output.gas_particles ? p.region->gas_particles : 0.0);
  p.dump_bytes = output::ParticleSeries::bytes_per_dump(dumped, output::dumped_particle_fields(setup),
                                                        setup.output.single_precision);
  p.last_dump_bytes = p.dump_bytes;
}

/// Gas and particles together. Each takes steps of its own within common ones, see `run::stable_step`.
void plan_region(run::Case const& setup, Plan& p) {
  grid::Domain const& domain = setup.domain;
  bridge::Region const region = setup::region_of(setup);
  RegionPlan r;
  r.cells = static_cast<double>(region.cells().size());
  for (int d = 0; d < domain.dimensions(); ++d) {
    auto const [low, high] = std::minmax_element(region.cells().begin(), region.cells().end(),
                                                 [d](Index3 const& a, Index3 const& b) { return a[d] < b[d]; });
    r.lower[d] = domain.face(d, (*low)[d]);
    r.upper[d] = domain.face(d, (*high)[d] + 1);
  }
  for (bridge::Face const& face : region.faces()) {
    if (!face.open) ++r.bridge_faces[2 * face.direction + face.side];
  }
  Plan gas = p;
  plan_gas(setup, gas);
  p.memory = gas.memory;
  p.region = r;
  // The gas fills what the bodies leave, with particles of its own density.
  double cells = r.cells;
  plan_particles(setup, p);
  p.memory = gas.memory;  // that of the particles follows when those of the gas are known
  for (std::size_t b = 0; b < p.bodies.size(); ++b) {
    cells -= static_cast<double>(p.bodies[b].particles) /
             std::pow(setup.particles.bodies[b].particles_per_direction, domain.dimensions());
  }
  r.gas_particles =
      std::max(0.0, cells) * std::pow(setup.mpm_region->gas_particles(domain.dimensions()), domain.dimensions());
  r.gas_steps = gas.steps;
  // Gas particles see the signals of the gas, at the Courant number of the particles.
  double const gas_particle_steps = gas.steps * setup.numerics.courant / setup.mpm_region->courant;
  r.particle_steps = std::max(setup.particles.any() ? p.steps : 0.0, gas_particle_steps);
  p.region = r;
  p.particles += r.gas_particles;
  p.blocks = gas.blocks;
  p.charges = gas.charges;
  p.initial_states = gas.initial_states;
  p.obstacles = gas.obstacles;
  p.starts = gas.starts;
  p.gauges = gas.gauges;
  double const shorter = std::min(r.gas_steps, r.particle_steps);
  p.steps = setup.mpm_region->subcycling ? std::max({shorter, r.gas_steps / 4.0, r.particle_steps / 64.0})
                                         : std::max(r.gas_steps, r.particle_steps);
  add_particle_memory(setup.particles, p, domain.dimensions());
  double const dumped = p.particles - (setup.output.gas_particles ? 0.0 : r.gas_particles);
  double const particle_bytes = output::ParticleSeries::bytes_per_dump(dumped, output::dumped_particle_fields(setup),
                                                                       setup.output.single_precision);
  p.dump_bytes = gas.dump_bytes + particle_bytes;
  p.last_dump_bytes = gas.last_dump_bytes + particle_bytes;
  p.gauge_bytes += gas.gauge_bytes;
  p.checkpoint_bytes = gas.checkpoint_bytes + p.particles * bytes_per_particle;
  p.warnings.insert(p.warnings.end(), gas.warnings.begin(), gas.warnings.end());
}

}  // namespace

std::vector<GaugePlan> plan_gauges(run::Case const& setup) {
  std::vector<GaugePlan> plans;
  plans.reserve(setup.gauges.size());
  for (run::Gauge const& gauge : setup.gauges)
    plans.push_back({gauge.name, observe::expected_peak(setup, gauge.position)});
  return plans;
}

std::optional<std::string> clipping_warning(std::vector<GaugePlan> const& gauges, double size) {
  GaugePlan const* worst = nullptr;
  std::size_t clipped = 0;
  for (GaugePlan const& g : gauges) {
    if (!g.peak || g.peak->clipping < alarming_clipping) continue;
    ++clipped;
    if (worst == nullptr || g.peak->clipping > worst->peak->clipping) worst = &g;
  }
  if (worst == nullptr) return std::nullopt;
  auto const& peak = *worst->peak;
  double const wanted = size * peak.cells_per_half_width /
                        observe::cells_for_clipping(tolerable_clipping, {peak.strength, peak.reflected});
  return fmt::format(
      "the cells will clip the peak at {} gauge{} by more than {}, at \"{}\" by about {}: a cell size of {} would clip "
      "it by {}; impulses and arrival times need fewer cells, and the summary reports the peak at the front",
      clipped, clipped == 1 ? "" : "s", percent(alarming_clipping), worst->name, percent(peak.clipping),
      quantity(wanted, "m", 3), percent(tolerable_clipping));
}

Plan plan(run::Case const& setup) {
  Plan p;
  p.cells = static_cast<double>(setup.domain.cell_count());
  p.machine_memory_bytes = machine_memory();
  p.dumps = static_cast<long>(output::dump_times(setup.output, setup.end.time).size());
  if (setup.mpm_region) {
    plan_region(setup, p);
  } else if (setup.particles.any()) {
    plan_particles(setup, p);
  } else {
    plan_gas(setup, p);
  }
  sum_memory(p);
  p.disk_bytes = static_cast<double>(p.dumps - 1) * p.dump_bytes + p.last_dump_bytes + p.gauge_bytes +
                 (setup.checkpoint.keep + 1) * p.checkpoint_bytes;
  p.seconds = estimated_seconds(setup, p);
  if (p.memory_bytes > p.machine_memory_bytes) {
    p.warnings.push_back(
        fmt::format("this machine has {} of memory: it will refuse to run the case", bytes(p.machine_memory_bytes)));
  }
  return p;
}

void refuse_unless_it_fits(Plan const& p) {
  if (p.memory_bytes <= p.machine_memory_bytes) return;
  std::string const most = p.memory.empty() ? ""
                                            : fmt::format(" (the largest part, {}, for: {})",
                                                          bytes(p.memory.front().bytes), p.memory.front().what);
  throw InputError(
      p.region ? fmt::format("the case needs about {} of memory for its {} cells and {} material points{}, but this "
                             "machine has {}: use larger cells (domain.cell), a smaller domain or MPM region, fewer "
                             "particles per cell, or symmetry planes",
                             bytes(p.memory_bytes), large_count(p.cells), large_count(p.particles), most,
                             bytes(p.machine_memory_bytes))
      : p.particles > 0.0
          ? fmt::format("the case needs about {} of memory for its {} material points{}, but this machine has {}: use "
                        "larger cells (domain.cell), fewer particles per cell, or symmetry planes",
                        bytes(p.memory_bytes), large_count(p.particles), most, bytes(p.machine_memory_bytes))
          : fmt::format("the case needs about {} of memory for its {} cells{}, but this machine has {}: use larger "
                        "cells (domain.cell), a smaller domain, or symmetry planes",
                        bytes(p.memory_bytes), large_count(p.cells), most, bytes(p.machine_memory_bytes)));
}

}  // namespace brisance::session
