#include "setup/place_bodies.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"
#include "detonation/charge.hpp"
#include "run/products.hpp"
#include "run/system.hpp"
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
  for (std::size_t n = 0; n < p.bodies.size(); ++n) {
    Body const& b = p.bodies[n];
    int const number = static_cast<int>(n);
    shape::Placement placement = shape::place_particles(b.shape, w.setup.domain, b.particles_per_direction);
    if (placement.positions.empty()) {
      throw InputError(fmt::format(
          "body \"{}\" contains no material point: it lies outside the domain or is much smaller than a cell", b.name));
    }
    mpm::Filling filling;
    filling.positions = std::move(placement.positions);
    filling.volumes = std::move(placement.volumes);
    filling.velocity = b.velocity;
    if (b.motion.any()) {
      VelocityField field(b.velocity, b.motion);
      double const step = 0.5 * w.setup.domain.smallest_cell() / b.particles_per_direction;
      for (Vec3 const& x : filling.positions) {
        filling.velocities.push_back(field(x));
        filling.gradients.push_back(field.gradient(x, step, w.setup.domain.dimensions()));
      }
    }
    filling.density = b.density;
    filling.specific_energy = b.specific_energy;
    w.particles->fill(number, filling);
    if (!b.initiation.empty()) {
      double const speed = b.solid.detonation_speed;
      mpm::set_lighting(*w.particles, number,
                        [&](Vec3 const& x) { return detonation::lighting_time(x, b.initiation, speed); });
    }
    mpm::BodySums const sums = mpm::sums(*w.particles, number);
    w.bodies.push_back(
        {b.name, b.solid.name, sums.particles, sums.mass, placement.volume * b.density.value_or(b.solid.density)});
  }
  for (mpm::Bar const& bar : p.bars) {
    ++w.bodies[bar.body].bars;
    w.bodies[bar.body].bar_volume += w.particles->reinforce(bar).volume;
  }
  for (mpm::SurfacePressure const& pressure : p.pressures) w.particles->load(pressure);
}

}  // namespace brisance::setup
