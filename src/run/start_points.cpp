#include "run/start_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "detonation/charge.hpp"
#include "run/world.hpp"
#include "shape/placement.hpp"

namespace brisance::run {

namespace {

using mpm::Field;

constexpr int products = 0;  // bodies
constexpr int air = 1;
constexpr int points_per_cell = 4;
constexpr int population_interval = 4;
/// Part of the ambient pressure by which air must differ to belong to the burst; the noise of points is far below.
constexpr double disturbed = 1e-3;
/// Cells that the profile keeps beyond the outermost disturbed one.
constexpr int foot = 4;

}  // namespace

PointsBurst::PointsBurst(Case const& one) : one_(one) {
  Charge const& charge = one_.charges.front();
  MpmRegion const gas;  // its settings of gas points were chosen by measurement
  std::vector<mpm::Body> bodies(2);
  bodies[products].name = "products";
  bodies[products].solid = material::of(charge.explosive);
  if (charge.detonation == Detonation::instantaneous) bodies[products].solid.detonation_speed = 0.0;
  bodies[air].name = "air";
  bodies[air].solid = material::of(one_.ambient.fluid);
  for (mpm::Body& body : bodies) {
    body.points_per_direction = points_per_cell;
    body.linear_viscosity = gas.linear_viscosity;
    body.viscosity_onset = gas.viscosity_onset;
    body.quadratic_viscosity = gas.quadratic_viscosity;
  }
  mpm::Options options;
  options.transfer = gas.transfer;
  options.order = gas.order;
  grid::Domain domain = one_.domain;
  domain.boundary[1] = grid::Boundary::wall;  // holds the air
  points_ = std::make_unique<mpm::Mpm>(domain, bodies, options);

  auto const fill = [&](int body, shape::Shape const& shape, double density, double specific_energy) {
    auto placement = shape::place_particles(shape, domain, points_per_cell);
    mpm::Filling filling;
    filling.positions = std::move(placement.positions);
    filling.volumes = std::move(placement.volumes);
    filling.density = density;
    filling.specific_energy = specific_energy;
    points_->fill(body, filling);
  };
  fill(products, charge.shape, charge.explosive.density(), charge.explosive.specific_energy());
  FluidState const& ambient = one_.ambient.state;
  double const far = 2.0 * domain.upper(0);
  shape::Shape const all = domain.geometry == grid::Geometry::spherical1d
                               ? shape::Shape(shape::Sphere{{0.0, 0.0, 0.0}, far})
                               : shape::Shape(shape::Cylinder{{0.0, 0.0, 0.0}, far, 1.0, {0.0, 0.0, 1.0}});
  fill(air, shape::combine(shape::Operation::difference, {all, charge.shape}), ambient.density,
       material::internal_energy(one_.ambient.fluid.eos, ambient.density, ambient.pressure));
  points_->set_reference_pressure(air, ambient.pressure);
  points_->set_reference_pressure(products, ambient.pressure);
  if (charge.detonation == Detonation::programmed) {
    points_->set_lighting(products, [&](Vec3 const& x) {
      return detonation::lighting_time(x, charge.initiation, charge.explosive.detonation_speed);
    });
  }
}

double PointsBurst::front() const {
  double const ambient = one_.ambient.state.pressure;
  double front = 0.0;
  for (int b = 0; b < points_->grid().block_count(); ++b) {
    mpm::PointSet const& set = points_->points(b, air);
    for (int q = 0; q < set.size(); ++q) {
      if (std::abs(set.field(Field::pressure)[q] - ambient) > disturbed * ambient)
        front = std::max(front, set.field(Field::position_x)[q]);
    }
  }
  return front;
}

double PointsBurst::step_reach() const { return (foot + 2) * one_.domain.h; }

void PointsBurst::advance(double latest) {
  double const step = points_->stable_step() * std::min(1.0, 0.1 * static_cast<double>(steps_ + 1));
  if (!(step > 0.0)) throw NumericalError("the time step of the 1D calculation by points vanished");
  double const left = latest - points_->time();
  bool const arrives = left <= step;
  points_->advance(arrives ? left : std::min(step, left));
  if (arrives) points_->set_time(latest);
  ++steps_;
  if (steps_ % population_interval == 0) {
    points_->control_population(products);
    points_->control_population(air);
  }
}

detonation::Profile PointsBurst::profile() const {
  grid::Domain const& domain = one_.domain;
  Charge const& charge = one_.charges.front();
  double const burnt = charge.detonation == Detonation::instantaneous
                           ? 0.0
                           : charge.initiation.front().delay +
                                 (charge.mass > 0.0 ? shape::bounds(charge.shape).upper[0] + 1.5 * domain.h : 0.0) /
                                     charge.explosive.detonation_speed;
  if (time() < burnt) throw InputError("the explosive still burns at the time of the remap: choose a later one");

  int const cells = domain.cells[0];
  gas::Fluids const fluids = fluids_of(one_);
  gas::MixtureState const ambient = ambient_mixture(one_.ambient.state);
  constexpr int components = gas::two_fluid_components;
  std::vector<std::array<double, components>> sums(static_cast<std::size_t>(cells));
  std::vector<double> volume(static_cast<std::size_t>(cells), 0.0);
  // Each point is a shell around its radius, of its volume; cells take the parts that lie in them.
  for (int b = 0; b < points_->grid().block_count(); ++b) {
    for (int body : {products, air}) {
      mpm::PointSet const& set = points_->points(b, body);
      for (int q = 0; q < set.size(); ++q) {
        double const r = set.field(Field::position_x)[q];
        double const u = set.field(Field::velocity_x)[q];
        double const mass = set.field(Field::mass)[q];
        double const filled = mass / set.field(Field::density)[q];
        double const middle = shape::radial_integral(domain.geometry, r);
        double const low = std::max(0.0, middle - 0.5 * filled);
        double const high = low + filled;
        double const kinetic = 0.5 * u * u + mpm::affine_energy(set, q, domain.h);
        int i = std::min(static_cast<int>(r / domain.h), cells - 1);
        while (i > 0 && shape::radial_integral(domain.geometry, domain.face_radius(i)) > low) --i;
        for (; i < cells; ++i) {
          double const from = shape::radial_integral(domain.geometry, domain.face_radius(i));
          double const to = shape::radial_integral(domain.geometry, domain.face_radius(i + 1));
          if (from >= high) break;
          // What reaches over the end of the domain stays in the last cell.
          double const part = ((i == cells - 1 ? high : std::min(high, to)) - std::max(low, from)) / filled;
          if (part <= 0.0) continue;
          auto& sum = sums[i];
          sum[body == products ? gas::second_density : gas::density] += part * mass;
          sum[gas::momentum_x] += part * mass * u;
          sum[gas::energy] += part * mass * (set.field(Field::energy)[q] + kinetic);
          if (body == products) sum[gas::volume_fraction] += part * filled;
          volume[i] += part * filled;
        }
      }
    }
  }

  detonation::Profile p;
  p.time = time();
  p.domain = domain;
  p.domain.boundary.fill(grid::Boundary::symmetry);
  p.components = components;
  std::array<double, components> quiet{};
  quiet[gas::density] = ambient.ambient_density;
  quiet[gas::energy] = gas::mixture(fluids, ambient.ambient_density, 0.0, 0.0).rho_e(ambient.pressure);
  p.ambient.assign(quiet.begin(), quiet.end());
  p.ambient_pressure = ambient.pressure;
  std::vector<double> pressure(static_cast<std::size_t>(cells), ambient.pressure);
  int used = 0;
  for (int i = 0; i < cells; ++i) {
    auto& u = sums[i];
    double const cell = domain.cell_volume(i);
    for (int c = 0; c < components; ++c) u[c] /= c == gas::volume_fraction ? std::max(volume[i], 1e-300) : cell;
    double const rho = u[gas::density] + u[gas::second_density];
    if (!(rho > 0.0)) {
      throw NumericalError(fmt::format("the points of the 1D calculation left a gap at the radius {:.6g} m",
                                       domain.centre({i, 0, 0})[0]));
    }
    double const rho_e = u[gas::energy] - 0.5 * u[gas::momentum_x] * u[gas::momentum_x] / rho;
    pressure[i] =
        gas::mixture(fluids, u[gas::density], u[gas::second_density], u[gas::volume_fraction]).pressure(rho_e);
    if (std::abs(pressure[i] - ambient.pressure) > disturbed * ambient.pressure || u[gas::second_density] > 0.0)
      used = i + 1;
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

}  // namespace brisance::run
