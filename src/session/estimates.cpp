#include "session/estimates.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/parallel.hpp"
#include "gas/layout.hpp"
#include "mpm/shapes/shapes.hpp"
#include "observe/gauges.hpp"
#include "setup/fluids.hpp"
#include "setup/velocity_field.hpp"

namespace brisance::session {

namespace {

constexpr double program_bytes = 50e6;    // code, libraries, work arrays of the threads
constexpr double bytes_per_node = 160.0;  // mass, momentum, force and velocity of a node on one grid field

// Rates of docs/benchmarks.md: cells of a 3D step, or particles, per second on one thread.
constexpr double one_fluid_rate = 22e6;
constexpr double mixed_rate = 18e6;           // products in a part of the domain
constexpr double afterburn_share = 0.84;      // of the rate, where the afterburn's progress is carried
constexpr double linear_particle_rate = 8e6;  // of linear shape functions
constexpr double particle_rate = 5e6;
constexpr double level_share = 0.8;    // of the rate, where blocks have several levels: estimate
constexpr double least_covered = 0.2;  // blocks below finer ones, per block that is not
constexpr double thread_share = 0.95;  // of a thread's rate, where it is not alone

double cells_of(grid::Domain const& domain) { return static_cast<double>(domain.cell_count()); }

/// Cells in the ghost layers of all blocks. In each direction all blocks but the last have one size.
double ghost_cells(grid::Domain const& domain, grid::Partition const& partition) {
  std::array<std::array<double, 2>, 3> size{};
  std::array<std::array<double, 2>, 3> count{};
  for (int d = 0; d < 3; ++d) {
    size[d] = {static_cast<double>(partition.size[d]), static_cast<double>(partition.rest(d, domain.cells[d]))};
    count[d] = {partition.parts[d] - 1.0, 1.0};
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

double signal(material::Eos const& eos, material::Primitive const& state) {
  double speed = 0.0;
  for (double const u : state.velocity) speed = std::max(speed, std::abs(u));
  return speed + material::sound_speed(eos, state.density, state.pressure);
}

double fastest_signal(run::Body const& body, grid::Domain const& domain) {
  material::Material const& solid = body.solid;
  double const density = body.density.value_or(solid.density);
  double pressure = material::start_pressure(solid);
  if (body.density || body.specific_energy)
    pressure = material::pressure(solid.eos, density, body.specific_energy.value_or(solid.specific_energy));
  double const sound = body.rigid ? 0.0 : material::sound_speed(solid, density, pressure);
  double const burn = body.initiation.empty() ? 0.0 : solid.detonation_speed;
  return std::max(sound, burn) + setup::estimated_speed(body, domain);
}

}  // namespace

double machine_memory() {
  double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  double limit = 0.0;
  // In a container the limit is what counts; the file holds "max" where there is none.
  if (std::ifstream("/sys/fs/cgroup/memory.max") >> limit && limit > 0.0) memory = std::min(memory, limit);
  return memory;
}

int gas_fluids(run::Case const& setup) { return setup::fluids_of(setup).count; }

int gas_components(run::Case const& setup) {
  int const fluids = gas_fluids(setup);
  bool const carried = fluids > 1 && setup.afterburn && setup.afterburn->carried();
  return carried ? gas::most_components : gas::components_of(fluids);
}

void add_gas_memory(run::Case const& setup, grid::Partition const& partition, Plan& p) {
  double const components = gas_components(setup);
  double const cells = cells_of(setup.domain);
  p.memory.push_back(
      {fmt::format("state of the gas, {:g} values per cell", components), components * cells * double_bytes});
  p.memory.push_back({"ghost layers of the blocks", components * ghost_cells(setup.domain, partition) * double_bytes});
  if (setup.output.peak_fields)
    p.memory.push_back({"peak fields (output.peak_fields)", peak_components * cells * double_bytes});
}

void add_level_memory(run::Case const& setup, grid::Grid const* start, Plan& p) {
  double const components = gas_components(setup);
  Index3 const size = grid::refinable_partition_of(setup.domain, setup.numerics.block_cells).size;
  int shortest = size[0];
  for (int d = 1; d < setup.domain.dimensions(); ++d) shortest = std::min(shortest, size[d]);
  double leaves = 0.0;
  double blocks = 0.0;
  for (std::size_t b = 0; start != nullptr && b < start->blocks().size(); ++b) {
    leaves += static_cast<double>(uncovered_count(start->blocks()[b])) / start->blocks()[b].cell_count();
    blocks += 1.0;
  }
  double const covered = std::max(least_covered, leaves > 0.0 ? blocks / leaves - 1.0 : 0.0);
  double const ghosts = (1.0 + covered) * 2.0 * grid::ghost_layers / shortest;
  p.memory.push_back(
      {fmt::format("state of the gas, {:g} values per cell", components), components * p.cells * double_bytes});
  p.memory.push_back({"blocks below finer ones", components * covered * p.cells * double_bytes});
  p.memory.push_back({"ghost layers of the blocks", components * ghosts * p.cells * double_bytes});
  if (setup.output.peak_fields)
    p.memory.push_back(
        {"peak fields (output.peak_fields)", peak_components * (1.0 + covered) * p.cells * double_bytes});
}

void sum_memory(Plan& p) {
  double dumped = p.dumps > 0 ? p.last_dump_bytes : 0.0;
  for (SubsetPlan const& subset : p.subsets) dumped += subset.dump_bytes;
  p.memory.push_back({"the dump that is being written", dumped});
  p.memory.push_back({"the program itself", program_bytes});
  p.memory_bytes = 0.0;
  for (MemoryPart const& part : p.memory) p.memory_bytes += part.bytes;
  std::ranges::stable_sort(p.memory, std::ranges::greater{}, &MemoryPart::bytes);
}

/// Estimate of the number of steps: the time step follows the fastest signal. Behind a detonation it starts at the
/// detonation speed D and falls with the fireball's expansion, s = D / (1 + t / (3 t0))^0.35 with t0 = charge radius /
/// D; where the radius is resolved, the hot core on the axis holds it near 0.35 D. Both numbers were read off
/// simulations of TNT in air, and are good to about a factor of two.
double estimated_steps(run::Case const& setup) {
  double quiet = signal(setup.ambient.fluid.eos, setup.ambient.state);
  for (run::InitialState const& initial : setup.initial_states) {
    material::Fluid const* other = initial.fluid > 0 ? setup.other_fluid(initial.fluid) : nullptr;
    quiet = std::max(quiet, signal(other != nullptr ? other->eos : setup.ambient.fluid.eos, initial.state));
  }
  for (int face = 0; face < 6; ++face) {
    if (grid::is_given(setup.domain.boundary[face]))
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
  double const steps = path / (setup.numerics.courant * setup.domain.smallest_cell()) + 5.0;  // 5 for the gentle start
  return setup.end.steps > 0 ? std::min(steps, static_cast<double>(setup.end.steps)) : steps;
}

void add_particle_memory(run::Particles const& particles, Plan& p, int dimensions) {
  double nodes = 0.0;
  for (std::size_t b = 0; b < p.bodies.size(); ++b)
    nodes +=
        static_cast<double>(p.bodies[b].particles) / std::pow(particles.bodies[b].particles_per_direction, dimensions);
  constexpr double margins = 2.0;  // blocks of 8 cells with two layers around: (12/8)^3 and less
  double const records = std::min(p.steps, p.gauge_bytes / bytes_per_particle_record);
  for (RegionPlan const& region : p.regions) nodes += region.cells;
  p.memory.push_back({"material points", p.particles * bytes_per_particle});
  p.memory.push_back({"nodes around the material points", nodes * margins * bytes_per_node});
  p.memory.push_back({"records of gauges on bodies", records * sizeof(observe::ParticleRecord)});
}

double estimated_particle_step(run::Case const& setup, std::size_t region) {
  grid::Domain const domain = setup.region_domain(region);
  double most = 0.0;  // of signal over Courant number
  for (int const number : setup.bodies_of(region)) {
    run::Body const& body = setup.particles.bodies[number];
    most = std::max(most, fastest_signal(body, domain) / setup.courant_of(body));
  }
  return domain.smallest_cell() / most;
}

double estimated_particle_steps(run::Case const& setup, std::size_t region) {
  double const steps = setup.end.time / estimated_particle_step(setup, region) + 5.0;  // 5 for the gentle start
  return setup.end.steps > 0 ? std::min(steps, static_cast<double>(setup.end.steps)) : steps;
}

namespace {

/// Material points times their steps.
double particle_updates(run::Case const& setup, Plan const& p) {
  if (p.regions.empty()) return p.particles * p.steps;
  double updates = 0.0;
  for (std::size_t region = 0; region < p.regions.size(); ++region) {
    double particles = 0.0;
    for (int const body : setup.bodies_of(region)) particles += static_cast<double>(p.bodies[body].particles);
    updates += (particles + p.regions[region].gas_particles) * p.regions[region].particle_steps;
  }
  return updates;
}

}  // namespace

double estimated_seconds(run::Case const& setup, Plan const& p) {
  double const parts = p.blocks > 0 ? p.blocks : std::max(1.0, p.cells / 512.0);  // particles: blocks of 8^3 cells
  double const workers = std::min<double>(threads(), parts);
  double const rate = workers > 1.0 ? workers * thread_share : 1.0;
  bool const gas = !setup.particles.any() || setup.has_regions();
  double seconds = 0.0;
  if (gas) {
    double per_second = gas_fluids(setup) > 1 ? mixed_rate : one_fluid_rate;
    if (gas_components(setup) == gas::most_components) per_second *= afterburn_share;
    // A step has one sweep per direction, and the rates are those of three.
    double const sweeps = setup.domain.dimensions() / 3.0;
    if (!p.levels.empty()) per_second *= level_share;
    seconds += p.cell_updates * sweeps / per_second;
  }
  if (p.particles > 0.0) {
    bool const linear = mpm::reach_of(setup.particles.options.shape) == 0;
    seconds += particle_updates(setup, p) / (linear ? linear_particle_rate : particle_rate);
  }
  return seconds / rate;
}

}  // namespace brisance::session
