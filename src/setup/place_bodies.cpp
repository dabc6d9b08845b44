#include "setup/place_bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "core/error.hpp"
#include "detonation/charge.hpp"
#include "run/products.hpp"
#include "run/system.hpp"
#include "setup/initial_stress.hpp"
#include "setup/velocity_field.hpp"
#include "shape/placement.hpp"

namespace brisance::setup {

void calculate_as_gas(MpmRegion const& settings, mpm::Body& body) {
  body.transfer = settings.transfer;
  body.order = settings.order;
  body.linear_viscosity = settings.linear_viscosity;
  body.viscosity_onset = settings.viscosity_onset;
  body.quadratic_viscosity = settings.quadratic_viscosity;
  body.courant = settings.courant;
  body.slips = settings.slip;
}

namespace {

/// Gives the particles of a body their velocities.
void set_in_motion(Body const& body, grid::Domain const& domain, mpm::Filling& filling) {
  VelocityField field(body.velocity, body.motion);
  double const step = 0.5 * domain.smallest_cell() / body.particles_per_direction;
  for (Vec3 const& x : filling.positions) {
    filling.velocities.push_back(field(x));
    filling.gradients.push_back(field.gradient(x, step, domain.dimensions()));
  }
}

/// Gives the particles of a body the state under the weight above them.
void compress(Body const& body, Overburden& overburden, mpm::Filling& filling) {
  double most = 0.0;
  GravityState deepest = overburden.state(body, 0.0);
  for (Vec3 const& x : filling.positions) {
    double const vertical = overburden.at(x);
    GravityState const state = overburden.state(body, vertical);
    filling.densities.push_back(state.density);
    filling.specific_energies.push_back(state.specific_energy);
    filling.deviators.push_back(state.deviator);
    if (vertical > most) {
      most = vertical;
      deepest = state;
    }
  }
  if (bears(body.solid, deepest)) return;
  throw InputError(
      fmt::format("body \"{}\" would yield under the weight above it, {:.6g} Pa, with K0 = {:.4g}: choose a K0 nearer "
                  "to 1",
                  body.name, most, *body.lateral_stress));
}

}  // namespace

void place_bodies(run::System& w, grid::Domain const& domain, std::vector<mpm::Body> others) {
  Particles const& p = w.setup.particles;
  std::vector<mpm::Body> bodies;
  for (Body const& b : p.bodies) {
    mpm::Body body;
    body.name = b.name;
    body.solid = b.solid;
    if (b.initiation.empty()) body.solid.detonation_speed = 0.0;
    body.particles_per_direction = b.particles_per_direction;
    if (b.rigid) body.rigid_velocity = b.velocity;
    body.slips = w.setup.mpm_region && w.setup.mpm_region->slip && !b.rigid && !b.solid.has_deviator();
    body.damped = !b.rigid && !b.solid.is_gas();
    body.books_work = w.setup.mpm_region || !p.contacts.empty() || p.options.transfer == mpm::Transfer::apic;
    body.courant = w.setup.courant_of(b);
    if (run::products_of(w.setup, b) > 0) calculate_as_gas(*w.setup.mpm_region, body);
    bodies.push_back(std::move(body));
  }
  bodies.insert(bodies.end(), others.begin(), others.end());
  mpm::Options options = p.options;
  for (int d = 0; d < w.setup.domain.dimensions(); ++d) {
    for (int side = 0; side < 2; ++side) {
      auto const boundary = w.setup.domain.boundary[2 * d + side];
      if (grid::has_images(boundary)) continue;
      options.ends[2 * d + side] = side == 0 ? w.setup.domain.lower[d] : w.setup.domain.upper(d);
    }
  }
  w.particles = std::make_unique<mpm::Mpm>(domain, bodies, options, p.constraints, p.contacts);
  std::optional<Overburden> overburden;
  for (std::size_t n = 0; n < p.bodies.size(); ++n) {
    Body const& b = p.bodies[n];
    int const number = static_cast<int>(n);
    shape::Placement placement = shape::place_particles(b.shape, w.setup.region_domain(), b.particles_per_direction);
    if (placement.positions.empty()) {
      throw InputError(fmt::format(
          "body \"{}\" contains no material point: it lies outside the domain or is much smaller than a cell", b.name));
    }
    mpm::Filling filling;
    filling.positions = std::move(placement.positions);
    filling.volumes = std::move(placement.volumes);
    filling.velocity = b.velocity;
    if (b.motion.any()) set_in_motion(b, w.setup.region_domain(), filling);
    filling.density = b.density;
    filling.specific_energy = b.specific_energy;
    if (b.lateral_stress) {
      if (!overburden) overburden.emplace(w.setup);
      compress(b, *overburden, filling);
    }
    w.particles->fill(number, filling);
    if (!b.initiation.empty()) {
      double const speed = b.solid.detonation_speed;
      mpm::set_lighting(*w.particles, number,
                        [&](Vec3 const& x) { return detonation::lighting_time(x, b.initiation, speed); });
    }
    mpm::BodySums const sums = mpm::sums(*w.particles, number);
    w.bodies.push_back(
        {b.name, b.solid.name, sums.particles, sums.mass,
         filling.densities.empty()
             ? placement.volume * b.density.value_or(b.solid.density)
             : std::inner_product(filling.densities.begin(), filling.densities.end(), filling.volumes.begin(), 0.0)});
  }
  for (mpm::Bar const& bar : p.bars) {
    ++w.bodies[bar.body].bars;
    w.bodies[bar.body].bar_volume += w.particles->reinforce(bar).volume;
  }
  for (mpm::SurfacePressure const& pressure : p.pressures) w.particles->load(pressure);
}

}  // namespace brisance::setup
