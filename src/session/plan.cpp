#include "session/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/text.hpp"
#include "observe/particle_fields.hpp"
#include "output/writer.hpp"
#include "session/estimates.hpp"
#include "session/plan_gas.hpp"
#include "setup/place_region.hpp"
#include "shape/placement.hpp"

namespace brisance::session {

namespace {

constexpr double most_particles_tried = 5e6;
constexpr double coarse_body = 4.0;          // particles across a body's shortest side below which it hardly bends
constexpr double few_steps = 5.0;            // that a load must last for its impulse to be right within some per cent
constexpr double alarming_clipping = 0.10;   // of the peak: beyond it there is a warning
constexpr double tolerable_clipping = 0.05;  // for which the warning names the cell

std::string percent(double fraction) { return fmt::format("{:.0f} %", 100.0 * fraction); }

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
  std::size_t const regions = std::max<std::size_t>(setup.mpm_regions.size(), 1);
  for (std::size_t region = 0; region < regions; ++region)
    p.steps = std::max(p.steps, estimated_particle_steps(setup, region));
  for (std::size_t n = 0; n < particles.bodies.size(); ++n) {
    run::Body const& body = particles.bodies[n];
    grid::Domain const domain = setup.domain_around(static_cast<int>(n));
    // What no machine holds, or is a lot for a look, is not tried out.
    p.bodies.push_back(realised(body, domain, most_particles_tried - p.particles));
    p.particles += static_cast<double>(p.bodies.back().particles);
    if (p.bodies.back().particles == 0) {
      throw InputError(
          fmt::format("body \"{}\" contains no material point: it is much smaller than a cell", body.name));
    }
    if (double const across = particles_across(body, domain);
        body.solid.has_deviator() && !body.rigid && across < coarse_body - 0.01) {
      p.warnings.push_back(fmt::format(
          "body \"{}\" has only {:.2g} material points across its shortest side: bending and yielding will be "
          "inaccurate; a cell size of {} would give {:g}",
          body.name, across, quantity(domain.smallest_cell() * across / coarse_body, "m", 2), coarse_body));
    }
  }
  for (std::size_t n = 0; n < particles.pressures.size(); ++n) {
    double const step = estimated_particle_step(setup, setup.region_with(particles.pressures[n].body));
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
  p.dump_bytes = output::ParticleSeries::bytes_per_dump(p.particles, output::dumped_particle_fields(setup),
                                                        setup.output.single_precision);
  p.last_dump_bytes = p.dump_bytes;
}

/// Where a region lies.
RegionPlan extent_of(run::Case const& setup, std::size_t number) {
  grid::Domain const domain = setup.region_domain(number);
  bridge::Region const region = setup::region_of(setup, number);
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
  return r;
}

/// How many steps of the level of a region are in one of the coarsest.
double steps_of_level(run::Case const& setup, std::size_t region) {
  return std::ldexp(1.0, setup.mpm_regions[region].level);
}

/// The gas of a region, once its bodies are known. It fills what they leave, with particles of its own density.
void plan_gas_particles(run::Case const& setup, std::size_t number, double gas_steps, Plan& p) {
  RegionPlan& r = p.regions[number];
  run::MpmRegion const& settings = setup.mpm_regions[number];
  int const dims = setup.domain.dimensions();
  std::vector<int> const bodies = setup.bodies_of(number);
  double cells = r.cells;
  for (int const b : bodies) {
    cells -=
        static_cast<double>(p.bodies[b].particles) / std::pow(setup.particles.bodies[b].particles_per_direction, dims);
  }
  r.gas_particles = std::max(0.0, cells) * std::pow(settings.gas_particles(dims), dims);
  r.gas_steps = gas_steps * steps_of_level(setup, number);
  // Gas particles see the signals of the gas, at the Courant number of the particles.
  double const gas_particle_steps = r.gas_steps * setup.numerics.courant / settings.courant;
  r.particle_steps = std::max(bodies.empty() ? 0.0 : estimated_particle_steps(setup, number), gas_particle_steps);
  p.particles += r.gas_particles;
}

/// The common steps.
void plan_steps(run::Case const& setup, Plan const& gas, Plan& p) {
  bool const subcycling = setup.mpm_regions.front().subcycling;
  if (setup.adaptive.any()) {
    double const parts = subcycling ? 64.0 : 1.0;
    p.steps = gas.steps;
    for (std::size_t n = 0; n < p.regions.size(); ++n)
      p.steps = std::max(p.steps, p.regions[n].particle_steps / (parts * steps_of_level(setup, n)));
    for (std::size_t n = 0; n < p.regions.size(); ++n) p.regions[n].gas_steps = p.steps * steps_of_level(setup, n);
    p.cell_updates *= p.steps / gas.steps;
    return;
  }
  double const gas_steps = p.regions.front().gas_steps;
  double most = 0.0;
  for (RegionPlan const& r : p.regions) most = std::max(most, r.particle_steps);
  p.steps =
      subcycling ? std::max({std::min(gas_steps, most), gas_steps / 4.0, most / 64.0}) : std::max(gas_steps, most);
}

/// Gas and particles together. Each takes steps of its own within common ones, see `run::stable_step`.
void plan_regions(run::Case const& setup, Plan& p) {
  Plan gas = p;
  plan_gas(setup, gas);
  p.memory = gas.memory;
  for (std::size_t n = 0; n < setup.mpm_regions.size(); ++n) p.regions.push_back(extent_of(setup, n));
  plan_particles(setup, p);
  p.memory = gas.memory;  // that of the particles follows when those of the gas are known
  double const of_bodies = p.particles;
  for (std::size_t n = 0; n < p.regions.size(); ++n) plan_gas_particles(setup, n, gas.steps, p);
  p.cells = gas.cells;
  p.blocks = gas.blocks;
  p.levels = gas.levels;
  p.cell_updates = gas.cell_updates;
  p.charges = gas.charges;
  p.initial_states = gas.initial_states;
  p.obstacles = gas.obstacles;
  p.starts = gas.starts;
  p.gauges = gas.gauges;
  plan_steps(setup, gas, p);
  add_particle_memory(setup.particles, p, setup.domain.dimensions());
  double const dumped = setup.output.gas_particles ? p.particles : of_bodies;
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
  run::Case at_shocks = setup;
  at_shocks.domain = setup.domain_of(setup.adaptive.shocks);
  for (run::Gauge const& gauge : setup.gauges)
    plans.push_back({gauge.name, observe::expected_peak(at_shocks, gauge.position)});
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

namespace {

void plan_subsets(run::Case const& setup, Plan& p) {
  std::vector<double> cells;
  for (LevelPlan const& level : p.levels) cells.push_back(level.most);
  if (cells.empty()) cells.push_back(static_cast<double>(setup.domain.cell_count()));
  auto const bytes = output::subset_bytes(setup, cells);
  auto const times = output::subset_times(setup);
  for (std::size_t n = 0; n < bytes.size(); ++n)
    p.subsets.push_back({setup.output.subsets[n].name, static_cast<long>(times[n].size()), bytes[n]});
}

/// Of all dumps, uncompressed.
double dumped_bytes(Plan const& p) {
  double sum = p.dumps > 0 ? static_cast<double>(p.dumps - 1) * p.dump_bytes + p.last_dump_bytes : 0.0;
  for (SubsetPlan const& subset : p.subsets) sum += static_cast<double>(subset.dumps) * subset.dump_bytes;
  return sum;
}

}  // namespace

Plan plan(run::Case const& setup) {
  Plan p;
  p.cells = static_cast<double>(setup.domain.cell_count());
  p.machine_memory_bytes = machine_memory();
  p.dumps = static_cast<long>(output::dump_times(setup.output, setup.end.time).size());
  if (setup.has_regions()) {
    plan_regions(setup, p);
  } else if (setup.particles.any()) {
    plan_particles(setup, p);
  } else {
    plan_gas(setup, p);
  }
  plan_subsets(setup, p);
  sum_memory(p);
  p.disk_bytes = dumped_bytes(p) + p.gauge_bytes + (setup.checkpoint.keep + 1) * p.checkpoint_bytes;
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
      !p.regions.empty()
          ? fmt::format("the case needs about {} of memory for its {} cells and {} material points{}, but this "
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
