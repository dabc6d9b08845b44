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

/// From the numbers of bodies in the case to those in their region.
class OwnNumbers {
 public:
  explicit OwnNumbers(std::vector<int> const& bodies) : bodies_(&bodies) {}

  /// Nothing of a body in another region.
  std::optional<int> operator()(int body) const {
    auto const found = std::ranges::find(*bodies_, body);
    if (found == bodies_->end()) return std::nullopt;
    return static_cast<int>(found - bodies_->begin());
  }
  /// Those of bodies in the region, and those of all bodies.
  [[nodiscard]] std::vector<mpm::Constraint> constraints(std::vector<mpm::Constraint> const& all) const {
    std::vector<mpm::Constraint> kept;
    for (mpm::Constraint c : all) {
      auto const body = c.body < 0 ? -1 : (*this)(c.body);
      if (!body) continue;
      c.body = *body;
      kept.push_back(std::move(c));
    }
    return kept;
  }
  [[nodiscard]] std::vector<mpm::Contact> contacts(std::vector<mpm::Contact> const& all) const {
    std::vector<mpm::Contact> kept;
    for (mpm::Contact c : all) {
      auto const first = (*this)(c.first);
      auto const second = (*this)(c.second);
      if (!first || !second) continue;
      c.first = *first;
      c.second = *second;
      kept.push_back(c);
    }
    return kept;
  }

 private:
  std::vector<int> const* bodies_;
};

/// The bodies of a region, still empty.
std::vector<mpm::Body> bodies_in(Case const& setup, std::size_t region) {
  Particles const& p = setup.particles;
  MpmRegion const* settings = setup.has_regions() ? &setup.mpm_regions[region] : nullptr;
  std::vector<mpm::Body> bodies;
  for (int const number : setup.bodies_of(region)) {
    Body const& b = p.bodies[number];
    mpm::Body body;
    body.name = b.name;
    body.solid = b.solid;
    if (b.initiation.empty()) body.solid.detonation_speed = 0.0;
    body.particles_per_direction = b.particles_per_direction;
    if (b.rigid) body.rigid_velocity = b.velocity;
    body.slips = settings != nullptr && settings->slip && !b.rigid && !b.solid.has_deviator();
    body.damped = !b.rigid && !b.solid.is_gas();
    body.books_work = settings != nullptr || !p.contacts.empty() || p.options.transfer == mpm::Transfer::apic;
    body.courant = setup.courant_of(b);
    if (run::products_of(setup, b) > 0) calculate_as_gas(*settings, body);
    bodies.push_back(std::move(body));
  }
  return bodies;
}

mpm::Options options_of(Case const& setup) {
  mpm::Options options = setup.particles.options;
  for (int d = 0; d < setup.domain.dimensions(); ++d) {
    for (int side = 0; side < 2; ++side) {
      auto const boundary = setup.domain.boundary[2 * d + side];
      if (grid::has_images(boundary)) continue;
      options.ends[2 * d + side] = side == 0 ? setup.domain.lower[d] : setup.domain.upper(d);
    }
  }
  return options;
}

/// Fills a body with particles; `domain`: whose cells they see.
run::BodyReport place_body(Body const& b, grid::Domain const& domain, Overburden* overburden, mpm::Mpm& particles,
                           std::size_t n) {
  int const number = static_cast<int>(n);
  shape::Placement placement = shape::place_particles(b.shape, domain, b.particles_per_direction);
  if (placement.positions.empty()) {
    throw InputError(fmt::format(
        "body \"{}\" contains no material point: it lies outside the domain or is much smaller than a cell", b.name));
  }
  mpm::Filling filling;
  filling.positions = std::move(placement.positions);
  filling.volumes = std::move(placement.volumes);
  filling.velocity = b.velocity;
  if (b.motion.any()) set_in_motion(b, domain, filling);
  filling.density = b.density;
  filling.specific_energy = b.specific_energy;
  if (b.lateral_stress) compress(b, *overburden, filling);
  particles.fill(number, filling);
  if (!b.initiation.empty()) {
    double const speed = b.solid.detonation_speed;
    mpm::set_lighting(particles, number,
                      [&](Vec3 const& x) { return detonation::lighting_time(x, b.initiation, speed); });
  }
  mpm::BodySums const sums = mpm::sums(particles, number);
  return {b.name, b.solid.name, sums.particles, sums.mass,
          filling.densities.empty()
              ? placement.volume * b.density.value_or(b.solid.density)
              : std::inner_product(filling.densities.begin(), filling.densities.end(), filling.volumes.begin(), 0.0)};
}

}  // namespace

void place_bodies(run::System& w, run::Region& region, grid::Domain const& domain, std::vector<mpm::Body> others) {
  Particles const& p = w.setup.particles;
  std::size_t const number = w.regions.size() - 1;
  region.bodies = w.setup.bodies_of(number);
  OwnNumbers const own(region.bodies);
  std::vector<mpm::Body> bodies = bodies_in(w.setup, number);
  bodies.insert(bodies.end(), others.begin(), others.end());
  region.particles = std::make_unique<mpm::Mpm>(domain, bodies, options_of(w.setup), own.constraints(p.constraints),
                                                own.contacts(p.contacts));
  w.bodies.resize(std::max(w.bodies.size(), p.bodies.size()));  // the gas of earlier regions stands behind
  std::optional<Overburden> overburden;
  for (std::size_t n = 0; n < region.bodies.size(); ++n) {
    Body const& b = p.bodies[region.bodies[n]];
    if (b.lateral_stress && !overburden) overburden.emplace(w.setup, w.setup.region_domain(number));
    w.bodies[region.bodies[n]] =
        place_body(b, w.setup.region_domain(number), overburden ? &*overburden : nullptr, *region.particles, n);
  }
  for (mpm::Bar bar : p.bars) {
    auto const body = own(bar.body);
    if (!body) continue;
    run::BodyReport& report = w.bodies[bar.body];
    bar.body = *body;
    ++report.bars;
    report.bar_volume += region.particles->reinforce(bar).volume;
  }
  for (mpm::SurfacePressure pressure : p.pressures) {
    auto const body = own(pressure.body);
    if (!body) continue;
    pressure.body = *body;
    region.particles->load(pressure);
  }
}

}  // namespace brisance::setup
