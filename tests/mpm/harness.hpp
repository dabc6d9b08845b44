/// What the tests of material points share: domains, bodies and fillings in 1D, 2D and 3D, and how to look at
/// particles.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <vector>

#include "core/parallel.hpp"
#include "mpm/mpm.hpp"
#include "shape/placement.hpp"

namespace brisance::test {

using mpm::Field;
using mpm::ShapeFunction;
using mpm::StressOrder;
using mpm::Transfer;

inline constexpr std::array all_shapes{ShapeFunction::linear, ShapeFunction::gimp, ShapeFunction::cpgimp,
                                       ShapeFunction::bspline};
inline constexpr std::array all_orders{StressOrder::usf, StressOrder::usl, StressOrder::musl};

/// Unit density and unit Young's modulus: speeds are then those of the bar.
inline material::Material unit_solid(double nu) { return material::elastic_solid(1.0, 1.0, nu); }

/// Speed of pressure waves [m/s].
inline double pressure_wave_speed(material::Material const& solid) {
  return material::sound_speed(solid, solid.density, 0.0);
}

/// Speed of shear waves [m/s].
inline double shear_wave_speed(material::Material const& solid) {
  return std::sqrt(material::shear_modulus(solid.strength) / solid.density);
}

/// Tents give a node that a particle just reaches next to no mass, but the full force: its velocity means nothing. Only
/// the order that maps the velocity back for the strain, and transfers without its gradient, bear that.
inline bool tents_bear(ShapeFunction shape, Transfer transfer, StressOrder order) {
  return shape != ShapeFunction::linear || (order == StressOrder::musl && transfer != Transfer::apic);
}

using VelocityAt = std::function<Vec3(Vec3 const& x)>;

/// Bodies on a grid. Fill in the parts, call `start`, then `fill`.
struct Problem {
  grid::Domain domain;
  mpm::Options options;
  std::vector<mpm::Body> bodies;
  std::vector<mpm::Constraint> constraints;
  std::vector<mpm::Contact> contacts;
  std::unique_ptr<mpm::Mpm> mpm;

  /// Elastic tests are free of losses: no viscosity unless a test asks for it. One thread: the problems are small.
  Problem() {
    set_threads(1);
    options.linear_viscosity = 0.0;
    options.quadratic_viscosity = 0.0;
  }

  void box(grid::Geometry geometry, double h, Index3 const& cells, grid::Boundary boundary,
           Vec3 const& lower = {0.0, 0.0, 0.0}) {
    domain.geometry = geometry;
    domain.h = h;
    domain.lower = lower;
    for (int d = 0; d < 3; ++d) domain.cells[d] = d < domain.dimensions() ? cells[d] : 1;
    domain.boundary.fill(boundary);
  }

  int add(material::Material const& solid, int particles_per_direction = 2) {
    mpm::Body body;
    body.name = "body " + std::to_string(bodies.size());
    body.solid = solid;
    body.particles_per_direction = particles_per_direction;
    bodies.push_back(body);
    return static_cast<int>(bodies.size()) - 1;
  }

  void start() { mpm = std::make_unique<mpm::Mpm>(domain, bodies, options, constraints, contacts); }

  /// Fills a shape with particles at the centres of sub-cells.
  void fill(int body, shape::Shape const& shape, VelocityAt const& velocity = nullptr) {
    auto const placed = shape::place_particles(shape, domain, bodies[body].particles_per_direction);
    mpm::Filling filling;
    filling.positions = placed.positions;
    filling.volumes = placed.volumes;
    mpm->fill(body, filling);
    if (velocity) set_velocity(body, velocity);
  }

  /// Fills a box whose corner need not lie on the grid: n particles per direction, `spacing` apart.
  void fill_lattice(int body, Vec3 const& corner, Index3 const& n, double spacing, Vec3 const& velocity) {
    mpm::Filling filling;
    filling.velocity = velocity;
    int const dims = domain.dimensions();
    for (int k = 0; k < (dims > 2 ? n[2] : 1); ++k) {
      for (int j = 0; j < (dims > 1 ? n[1] : 1); ++j) {
        for (int i = 0; i < n[0]; ++i) {
          Vec3 x = domain.centre({0, 0, 0});
          Index3 const at{i, j, k};
          for (int d = 0; d < dims; ++d) x[d] = corner[d] + (at[d] + 0.5) * spacing;
          filling.positions.push_back(x);
          filling.volumes.push_back(std::pow(spacing, dims));
        }
      }
    }
    mpm->fill(body, filling);
  }

  /// Calls visit(set, index) for every particle of a body, block by block.
  template <class Visit>
  void for_each_particle(int body, Visit&& visit) {
    for (int b = 0; b < mpm->grid().block_count(); ++b) {
      mpm::ParticleSet& set = mpm->particles(b, body);
      for (int q = 0; q < set.size(); ++q) visit(set, q);
    }
  }

  void set_velocity(int body, VelocityAt const& velocity) {
    for_each_particle(
        body, [&](mpm::ParticleSet& set, int q) { put(set, q, Field::velocity_x, velocity(position(set, q))); });
  }

  static Vec3 get(mpm::ParticleSet const& set, int q, Field first) {
    return {set.field(first)[q], set.field(first + 1)[q], set.field(first + 2)[q]};
  }
  static void put(mpm::ParticleSet& set, int q, Field first, Vec3 const& value) {
    for (int d = 0; d < 3; ++d) set.field(first + d)[q] = value[d];
  }
  static Vec3 position(mpm::ParticleSet const& set, int q) { return get(set, q, Field::position_x); }
  static Vec3 origin(mpm::ParticleSet const& set, int q) { return get(set, q, Field::origin_x); }
  static double volume(mpm::ParticleSet const& set, int q) {
    return set.field(Field::mass)[q] / set.field(Field::density)[q];
  }

  /// Cauchy stress: xx yy zz xy yz zx.
  static std::array<double, 6> stress(mpm::ParticleSet const& set, int q) {
    std::array<double, 6> s{};
    for (int c = 0; c < 6; ++c) s[c] = set.field(Field::deviator_xx + c)[q];
    for (int d = 0; d < 3; ++d) s[d] -= set.field(Field::pressure)[q];
    return s;
  }

  /// Gives a particle a stress; the density follows from the linear equation of state, the volume stays.
  void put_stress(int body, mpm::ParticleSet& set, int q, std::array<double, 6> const& s) const {
    double const p = -(s[0] + s[1] + s[2]) / 3.0;
    for (int c = 0; c < 6; ++c) set.field(Field::deviator_xx + c)[q] = s[c] + (c < 3 ? p : 0.0);
    auto const& eos = std::get<material::Linear>(bodies[body].solid.eos);
    double const v = volume(set, q);
    set.field(Field::pressure)[q] = p;
    set.field(Field::density)[q] = eos.rho0 * (1.0 + p / eos.K);
    set.field(Field::mass)[q] = v * set.field(Field::density)[q];
  }

  /// Values of a field in the order of the particles' identities.
  std::vector<double> values(int body, Field field) {
    std::vector<double> out(static_cast<std::size_t>(mpm::sums(*mpm, body).particles));
    for_each_particle(body, [&](mpm::ParticleSet const& set, int q) {
      out.at(static_cast<std::size_t>(set.field(Field::identity)[q])) = set.field(field)[q];
    });
    return out;
  }

  /// Sum over the particles of a body of a function of the particle.
  template <class Of>
  double sum(int body, Of&& of) {
    double total = 0.0;
    for_each_particle(body, [&](mpm::ParticleSet const& set, int q) { total += of(set, q); });
    return total;
  }

  /// Largest value over the particles of a body.
  template <class Of>
  double largest(int body, Of&& of) {
    double most = 0.0;
    for_each_particle(body, [&](mpm::ParticleSet const& set, int q) { most = std::max(most, of(set, q)); });
    return most;
  }

  [[nodiscard]] double kinetic_energy() const {
    double total = 0.0;
    for (std::size_t b = 0; b < bodies.size(); ++b) total += mpm::sums(*mpm, static_cast<int>(b)).kinetic_energy;
    return total;
  }
  [[nodiscard]] double energy() const {
    double total = kinetic_energy();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      auto const sums = mpm::sums(*mpm, static_cast<int>(b));
      total += sums.internal_energy - sums.provisional_energy;
    }
    return total;
  }
  /// All bodies book the work of the nodes, as in a simulation with contacts: to be called before `start`.
  void book_work() {
    for (mpm::Body& body : bodies) body.books_work = true;
  }
  /// Energy with all that left or is lost and counted, less the work of outer forces.
  [[nodiscard]] double accounted() const {
    return energy() + mpm->accounts().losses.energy + mpm->accounts().dissipation.sum() - mpm->accounts().outer_work;
  }
  [[nodiscard]] Vec3 momentum() const {
    Vec3 total{0.0, 0.0, 0.0};
    for (std::size_t b = 0; b < bodies.size(); ++b) total = total + mpm::sums(*mpm, static_cast<int>(b)).momentum;
    return total;
  }

  /// The length of the steps that divide `span` evenly, none longer than `longest`.
  [[nodiscard]] static double even_step(double span, double longest) { return span / std::ceil(span / longest); }

  /// Equal steps.
  void run(double span, double longest) {
    double const dt = even_step(span, longest);
    long const steps = std::lround(span / dt);
    for (long n = 0; n < steps; ++n) mpm->advance(dt);
  }
};

/// Half the period of an oscillation: the time between the first two zeros of signal(), found between steps by linear
/// interpolation. Gives up after `longest` [s].
template <class Signal>
double half_period(Problem& problem, double dt, double longest, Signal&& signal) {
  std::array<double, 2> zeros{0.0, 0.0};
  int found = 0;
  double before = signal();
  double const start = problem.mpm->time();
  while (found < 2 && problem.mpm->time() - start < longest) {
    problem.mpm->advance(dt);
    double const now = signal();
    if ((before > 0.0) != (now > 0.0)) zeros[found++] = problem.mpm->time() - dt * now / (now - before);
    before = now;
  }
  return zeros[1] - zeros[0];
}

}  // namespace brisance::test
