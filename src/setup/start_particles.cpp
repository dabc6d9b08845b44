#include "setup/start_particles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "detonation/charge.hpp"
#include "setup/fluids.hpp"
#include "setup/profile_fit.hpp"
#include "shape/placement.hpp"

namespace brisance::setup {

namespace {

using mpm::Field;

constexpr int products = 0;  // bodies
constexpr int air = 1;
/// With fewer, the noise that the detonation leaves in the particles' densities stands out in the thin products: L1 of
/// their mass 2.1 % with 4, 0.6 % with 8, at 200 cells per radius.
constexpr int particles_per_cell = 8;
/// The pressure rises within some steps when the explosive burns, and the work of a step is that of its middle: the
/// energy of the burst is 0.5 % too high at a Courant number of 0.4, 0.1 % at 0.2.
constexpr double courant = 0.2;
constexpr int population_interval = 4;
/// Fraction of the ambient pressure by which air must differ to belong to the burst; the noise of particles is far
/// below.
constexpr double disturbed = 1e-3;
/// Cells that the profile keeps beyond the outermost disturbed one.
constexpr int foot = 4;
/// Cells to each side over which the places of particles are averaged in `edges_of`.
constexpr int window = 8;

/// What a particle holds.
struct Shell {
  double radius = 0.0;
  double volume = 0.0;
  int body = 0;
  double mass = 0.0;
  double momentum = 0.0;
  double energy = 0.0;
};

/// All particles from the centre outwards.
std::vector<Shell> shells_of(mpm::Mpm const& particles) {
  std::vector<Shell> shells;
  for (int b = 0; b < particles.grid().block_count(); ++b) {
    for (int body : {products, air}) {
      mpm::ParticleSet const& set = particles.particles(b, body);
      for (int q = 0; q < set.size(); ++q) {
        double const mass = set.field(Field::mass)[q];
        double const u = set.field(Field::velocity_x)[q];
        double const kinetic = 0.5 * u * u + mpm::affine_energy(set, q, particles.grid().smallest_cell());
        shells.push_back({set.field(Field::position_x)[q], mass / set.field(Field::density)[q], body, mass, mass * u,
                          mass * (set.field(Field::energy)[q] + kinetic)});
      }
    }
  }
  std::stable_sort(shells.begin(), shells.end(), [](Shell const& a, Shell const& b) { return a.radius < b.radius; });
  return shells;
}

/// Volumes within the edges of the shells. The density of particles, which follows the flow, is far smoother than their
/// distances: the shells are stacked with their own volumes, and what their places then differ from those of the
/// particles is taken off in the mean over a few cells.
std::vector<double> edges_of(std::vector<Shell> const& shells, grid::Domain const& domain) {
  std::size_t const n = shells.size();
  std::vector<double> stacked(n + 1, 0.0);
  std::vector<double> sum(n + 1, 0.0);  // of the differences of the shells before
  for (std::size_t i = 0; i < n; ++i) {
    stacked[i + 1] = stacked[i] + shells[i].volume;
    double const place = shape::radial_integral(domain.geometry, shells[i].radius);
    sum[i + 1] = sum[i] + 0.5 * (stacked[i] + stacked[i + 1]) - place;
  }
  std::vector<double> edges(n + 1, 0.0);
  std::size_t low = 0;
  std::size_t high = 0;
  for (std::size_t i = 1; i <= n; ++i) {
    double const r = shells[i - 1].radius;
    double const reach = std::min(window * domain.smallest_cell(), r);
    while (low + 1 < n && shells[low].radius < r - reach) ++low;
    while (high < n && shells[high].radius <= r + reach) ++high;
    double const mean = (sum[high] - sum[low]) / static_cast<double>(high - low);
    edges[i] = std::max(edges[i - 1], stacked[i] - mean);
  }
  return edges;
}

constexpr int components = gas::components_of(gas::products_fluid + 1);

/// What the cells get of the shells.
struct CellContents {
  std::vector<std::array<double, components>> state;  ///< mass, momentum, energy; volume of the products
  std::vector<double> volume;
};

CellContents spread(std::vector<Shell> const& shells, grid::Domain const& domain) {
  int const cells = domain.cells[0];
  CellContents sums;
  sums.state.resize(static_cast<std::size_t>(cells));
  sums.volume.assign(static_cast<std::size_t>(cells), 0.0);
  std::vector<double> const edges = edges_of(shells, domain);
  int first = 0;
  for (std::size_t n = 0; n < shells.size(); ++n) {
    Shell const& shell = shells[n];
    double const low = edges[n];
    double const high = edges[n + 1];
    while (first + 1 < cells && shape::radial_integral(domain.geometry, domain.face_radius(first + 1)) <= low) ++first;
    for (int i = first; i < cells; ++i) {
      double const from = shape::radial_integral(domain.geometry, domain.face_radius(i));
      double const to = shape::radial_integral(domain.geometry, domain.face_radius(i + 1));
      if (from >= high && i > first) break;
      // What reaches over the end of the domain stays in the last cell.
      double const inside = (i == cells - 1 ? high : std::min(high, to)) - std::max(low, from);
      double const fraction = high > low ? inside / (high - low) : 1.0;
      if (fraction <= 0.0) continue;
      auto& sum = sums.state[i];
      sum[gas::partial_density(shell.body == products ? gas::products_fluid : 0)] += fraction * shell.mass;
      sum[gas::momentum_x] += fraction * shell.momentum;
      sum[gas::energy] += fraction * shell.energy;
      if (shell.body == products) sum[gas::volume_fraction(gas::products_fluid)] += fraction * (high - low);
      sums.volume[i] += fraction * (high - low);
    }
  }
  return sums;
}

}  // namespace

ParticlesBurst::ParticlesBurst(Case const& one) : one_(one) {
  Charge const& charge = one_.charges.front();
  MpmRegion const gas;  // its settings of gas particles were chosen by measurement
  std::vector<mpm::Body> bodies(2);
  bodies[products].name = "products";
  bodies[products].solid = material::of(charge.explosive);
  if (charge.detonation == Detonation::instantaneous) bodies[products].solid.detonation_speed = 0.0;
  bodies[air].name = "air";
  bodies[air].solid = material::of(one_.ambient.fluid);
  for (mpm::Body& body : bodies) {
    body.particles_per_direction = particles_per_cell;
    body.linear_viscosity = gas.linear_viscosity;
    body.viscosity_onset = gas.viscosity_onset;
    body.quadratic_viscosity = gas.quadratic_viscosity;
  }
  mpm::Options options;
  options.transfer = gas.transfer;
  options.order = gas.order;
  options.courant = courant;
  grid::Domain domain = one_.domain;
  domain.boundary[1] = grid::Boundary::wall;  // holds the air
  particles_ = std::make_unique<mpm::Mpm>(domain, bodies, options);

  auto const fill = [&](int body, shape::Shape const& shape, double density, double specific_energy) {
    auto placement = shape::place_particles(shape, domain, particles_per_cell);
    mpm::Filling filling;
    filling.positions = std::move(placement.positions);
    filling.volumes = std::move(placement.volumes);
    filling.density = density;
    filling.specific_energy = specific_energy;
    particles_->fill(body, filling);
  };
  fill(products, charge.shape, charge.explosive.density(), charge.explosive.specific_energy());
  Primitive const& ambient = one_.ambient.state;
  double const far = 2.0 * domain.upper(0);
  shape::Shape const all = domain.geometry == grid::Geometry::spherical1d
                               ? shape::Shape(shape::Sphere{{0.0, 0.0, 0.0}, far})
                               : shape::Shape(shape::Cylinder{{0.0, 0.0, 0.0}, far, 1.0, {0.0, 0.0, 1.0}});
  fill(air, shape::combine(shape::Operation::difference, {all, charge.shape}), ambient.density,
       material::internal_energy(one_.ambient.fluid.eos, ambient.density, ambient.pressure));
  particles_->set_reference_pressure(air, ambient.pressure);
  particles_->set_reference_pressure(products, ambient.pressure);
  if (charge.detonation == Detonation::programmed) {
    mpm::set_lighting(*particles_, products, [&](Vec3 const& x) {
      return detonation::lighting_time(x, charge.initiation, charge.explosive.detonation_speed);
    });
  }
}

double ParticlesBurst::front() const {
  double const ambient = one_.ambient.state.pressure;
  double front = 0.0;
  for (int b = 0; b < particles_->grid().block_count(); ++b) {
    mpm::ParticleSet const& set = particles_->particles(b, air);
    for (int q = 0; q < set.size(); ++q) {
      if (std::abs(set.field(Field::pressure)[q] - ambient) > disturbed * ambient)
        front = std::max(front, set.field(Field::position_x)[q]);
    }
  }
  return front;
}

double ParticlesBurst::step_reach() const { return (foot + 2) * one_.domain.smallest_cell(); }

void ParticlesBurst::advance(double latest) {
  double const step = particles_->stable_step() * std::min(1.0, 0.1 * static_cast<double>(steps_ + 1));
  if (!(step > 0.0))
    throw NumericalError("the time step of the 1D simulation with material points has become too small");
  double const left = latest - particles_->time();
  bool const arrives = left <= step;
  particles_->advance(arrives ? left : std::min(step, left));
  if (arrives) particles_->set_time(latest);
  ++steps_;
  if (steps_ % population_interval == 0) {
    particles_->control_population(products);
    particles_->control_population(air);
  }
}

detonation::Profile ParticlesBurst::profile() const {
  grid::Domain const& domain = one_.domain;
  Charge const& charge = one_.charges.front();
  double const burnt =
      charge.detonation == Detonation::instantaneous
          ? 0.0
          : charge.initiation.front().delay +
                (charge.mass > 0.0 ? shape::bounds(charge.shape).upper[0] + 1.5 * domain.smallest_cell() : 0.0) /
                    charge.explosive.detonation_speed;
  if (time() < burnt) throw InputError("the explosive is still burning at the time of the remap: choose a later time");

  int const cells = domain.cells[0];
  gas::Fluids const fluids = fluids_of(one_);
  Primitive const& ambient = one_.ambient.state;
  auto [sums, volume] = spread(shells_of(*particles_), domain);

  detonation::Profile p;
  p.time = time();
  p.domain = domain;
  p.domain.boundary.fill(grid::Boundary::symmetry);
  p.components = components;
  gas::Components quiet{};
  quiet[gas::partial_density(0)] = ambient.density;
  quiet[gas::energy] = gas::mixture(fluids, {ambient.density}, {}).rho_e(ambient.pressure);
  p.ambient.assign(quiet.begin(), quiet.begin() + components);
  p.ambient_pressure = ambient.pressure;
  std::vector<double> pressure(static_cast<std::size_t>(cells), ambient.pressure);
  int used = 0;
  for (int i = 0; i < cells; ++i) {
    auto& u = sums[i];
    double const cell = domain.cell_volume(i);
    for (int c = 0; c < components; ++c) u[c] /= gas::is_volume_fraction(c) ? std::max(volume[i], 1e-300) : cell;
    double const rho = gas::mixture_density(fluids.count, [&](int c) { return u[c]; });
    if (!(rho > 0.0)) {
      throw NumericalError(fmt::format("the material points of the 1D simulation left a gap at the radius {:.6g} m",
                                       domain.centre({i, 0, 0})[0]));
    }
    double const rho_e = u[gas::energy] - 0.5 * u[gas::momentum_x] * u[gas::momentum_x] / rho;
    pressure[i] = gas::mixture(fluids, gas::partial_densities(fluids.count, u.data()),
                               gas::volume_fractions(fluids.count, u.data()))
                      .pressure(rho_e);
    bool const holds_products = u[gas::partial_density(gas::products_fluid)] > 0.0;
    if (std::abs(pressure[i] - ambient.pressure) > disturbed * ambient.pressure || holds_products) used = i + 1;
  }
  p.domain.cells[0] = std::min(cells, used + foot);
  p.state.resize(p.cell_count() * components);
  p.pressure.assign(pressure.begin(), pressure.begin() + p.domain.cells[0]);
  for (int i = 0; i < p.domain.cells[0]; ++i) {
    for (int c = 0; c < components; ++c) p.state[c * p.cell_count() + i] = sums[i][c];
  }
  describe_charge(one_, fluids, p);
  return p;
}

}  // namespace brisance::setup
