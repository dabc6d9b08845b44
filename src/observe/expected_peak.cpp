#include "observe/expected_peak.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "empirical/kingery_bulmash.hpp"
#include "material/hugoniot.hpp"
#include "observe/blast_wave.hpp"
#include "shape/shape.hpp"

namespace brisance::observe {

namespace {

using grid::Boundary;

constexpr double tnt_energy = 4.29e6;     // of the detonation [J/kg], materials/tnt.toml
constexpr double cells_to_wall = 3.0;     // nearer than these, shock and reflection are one rise
constexpr double steepest_cosine = 0.71;  // beyond 45 degrees a Mach stem runs along the wall: no reflected front

bool is_solid(run::Case const& setup, Vec3 const& x) {
  auto const holds = [&](auto const& thing) { return shape::contains(thing.shape, setup.domain, x); };
  return std::ranges::any_of(setup.obstacles, holds) || std::ranges::any_of(setup.particles.bodies, holds);
}

/// Is x in an MPM region, as far as that is known before it is built?
bool in_region(run::Case const& setup, std::size_t number, Vec3 const& x) {
  auto const holds = [&](shape::Box const& box) { return shape::contains(shape::Shape{box}, setup.domain, x); };
  run::MpmRegion const& region = setup.mpm_regions[number];
  if (!region.boxes.empty()) return std::ranges::any_of(region.boxes, holds);
  // The bridge lies between the bodies and the faces of the box around them.
  double const margin = region.width * setup.region_domain(number).smallest_cell();
  return std::ranges::any_of(setup.bodies_of(number), [&](int body) {
    shape::Box box = shape::bounds(setup.particles.bodies[body].shape);
    for (int d = 0; d < setup.domain.dimensions(); ++d) {
      box.lower[d] -= margin;
      box.upper[d] += margin;
    }
    return holds(box);
  });
}

/// Does something rigid stand within a few cells behind x, seen from the charge, and face it?
bool reflects(run::Case const& setup, Vec3 const& charge, double radius, Vec3 const& x, double cell) {
  grid::Domain const& domain = setup.domain;
  double const reach = cells_to_wall * cell;
  double const distance = norm(x - charge);
  for (int d = 0; d < domain.dimensions(); ++d) {
    double const away = x[d] - charge[d];
    if (std::abs(away) < steepest_cosine * distance) continue;
    int const face = 2 * d + (away > 0.0 ? 1 : 0);
    double const plane = away > 0.0 ? domain.upper(d) : domain.lower[d];
    // What touches the charge is the ground under it.
    if (domain.is_mirror(face) && !domain.is_axis(face) && std::abs(plane - x[d]) <= reach &&
        std::abs(plane - charge[d]) > 1.5 * radius)
      return true;
    for (double step = 0.5; step <= cells_to_wall; step += 0.5) {
      Vec3 behind = x;
      behind[d] += std::copysign(step * cell, away);
      if (is_solid(setup, behind)) return true;
    }
  }
  return false;
}

/// Does something solid stand between the charge and x?
bool in_shadow(run::Case const& setup, Vec3 const& charge, Vec3 const& x, double cell) {
  double const distance = norm(x - charge);
  double const last = distance - cell;  // a gauge on a surface touches what it stands on
  constexpr int most_steps = 400;
  double const step = std::max(0.5 * cell, distance / most_steps);
  for (double way = 0.0; way < last; way += step) {
    if (is_solid(setup, charge + (way / distance) * (x - charge))) return true;
  }
  return false;
}

bool touches_a_wall(grid::Domain const& domain, Vec3 const& centre, double radius) {
  for (int face = 0; face < 2 * domain.dimensions(); ++face) {
    int const d = face / 2;
    double const plane = face % 2 == 0 ? domain.lower[d] : domain.upper(d);
    if (domain.boundary[face] == Boundary::wall && !domain.is_axis(face) &&
        std::abs(plane - centre[d]) <= 1.05 * radius)
      return true;
  }
  return false;
}

/// Where (1 - s) exp(-b s), b > -1, is a half.
double half_of_friedlander(double b) {
  double from = 0.0;
  double to = 1.0;
  for (int n = 0; n < 60; ++n) {
    double const middle = 0.5 * (from + to);
    ((1.0 - middle) * std::exp(-b * middle) > 0.5 ? from : to) = middle;
  }
  return to;
}

}  // namespace

double expected_cell(run::Case const& setup, Vec3 const& x) {
  run::Adaptive const& adaptive = setup.adaptive;
  if (!adaptive.any()) return setup.domain.smallest_cell();
  for (std::size_t number = 0; number < setup.mpm_regions.size(); ++number) {
    if (in_region(setup, number, x)) return setup.region_domain(number).smallest_cell();
  }
  int level = std::max(adaptive.shocks, adaptive.gauges.value_or(0));
  for (run::Refine const& part : adaptive.parts) {
    if (shape::contains(part.shape, setup.domain, x)) level = std::max(level, part.level);
  }
  return setup.domain_of(std::min(level, adaptive.finest)).smallest_cell();
}

double friedlander_half_width(double peak, double impulse, double duration) {
  // impulse / (peak T) = 1/b - (1 - exp(-b)) / b^2, 1/2 for b = 0 and falling with b.
  double const share = impulse / (peak * duration);
  auto const integral = [](double b) { return b < 1e-4 ? 0.5 - b / 6.0 : (b + std::expm1(-b)) / (b * b); };
  double low = 0.0;
  double high = 1e4;
  for (int n = 0; n < 80; ++n) {
    double const middle = 0.5 * (low + high);
    (integral(middle) > share ? low : high) = middle;
  }
  return half_of_friedlander(low) * duration;
}

double decay_time(material::Eos const& eos, material::Primitive const& air, FrontCurve const& overpressure,
                  double radius) {
  auto const at = [&](double r) {
    return material::shocked(eos, air.density, air.pressure, air.pressure + overpressure(r));
  };
  constexpr double fraction = 0.02;  // of the radius, for the derivatives along the front
  auto const behind = at(radius);
  auto const before = at(radius * (1.0 - fraction));
  auto const after = at(radius * (1.0 + fraction));
  double const width = 2.0 * fraction * radius;
  double const p_along = (after.pressure - before.pressure) / width;
  double const u_along = (after.jump - before.jump) / width;
  double const modulus = material::bulk_modulus(eos, behind.density, behind.pressure);  // rho c^2
  double const w = behind.speed - behind.jump;                                          // the front sees the gas leave
  // Mass with energy: -w p_r + rho c^2 u_r = -a; momentum: -w u_r + p_r / rho = -b.
  double const a = behind.speed * p_along + 2.0 * modulus * behind.jump / radius;
  double const b = behind.speed * u_along;
  double const p_r = -(a * w + modulus * b) / (modulus / behind.density - w * w);
  double const p_t = behind.speed * (p_along - p_r);
  return p_t < 0.0 ? (behind.pressure - air.pressure) / -p_t : std::numeric_limits<double>::infinity();
}

std::optional<ExpectedPeak> expected_peak(run::Case const& setup, Vec3 const& x) {
  using grid::Geometry;
  grid::Domain const& domain = setup.domain;
  bool const bodies_of_revolution = domain.geometry == Geometry::cartesian3d ||
                                    domain.geometry == Geometry::axisymmetric2d ||
                                    domain.geometry == Geometry::spherical1d;
  auto const& air = setup.ambient;
  if (!bodies_of_revolution || !std::holds_alternative<material::IdealGas>(air.fluid.eos)) return std::nullopt;
  double const sound = material::sound_speed(air.fluid.eos, air.state.density, air.state.pressure);
  empirical::Atmosphere const atmosphere{air.state.pressure, sound};

  double const cell = expected_cell(setup, x);
  std::optional<ExpectedPeak> strongest;
  for (run::Charge const& charge : setup.charges) {
    Vec3 const centre = shape::centre(charge.shape);
    double const distance = norm(x - centre);
    double const mass = charge.mass * charge.explosive.tnt_equivalent_pressure.value_or(
                                          charge.explosive.specific_energy() / tnt_energy);
    if (!(distance > 0.0) || !(mass > 0.0) || in_shadow(setup, centre, x, cell)) continue;
    double const radius = shape::equivalent_radius(charge.mass / charge.explosive.density(), domain.geometry);
    auto const burst = setup.burst == run::Burst::hemispherical || touches_a_wall(domain, centre, radius)
                           ? empirical::Burst::hemispherical
                           : empirical::Burst::spherical;
    auto const curves = [&](double r) { return empirical::kingery_bulmash(mass, r, burst, atmosphere); };
    auto const wave = curves(distance);
    ExpectedPeak expected;
    expected.cell = cell;
    expected.reflected = reflects(setup, centre, radius, x, cell);
    if (!wave.incident_overpressure || !wave.shock_speed) continue;
    if (expected.reflected) {
      if (!wave.reflected_overpressure || !wave.reflected_impulse || !wave.duration) continue;
      expected.half_width =
          friedlander_half_width(*wave.reflected_overpressure, *wave.reflected_impulse, *wave.duration);
    } else {
      // The impulse of the curves tells the mean of a pulse that is much steeper at first, near the charge.
      auto const overpressure = [&](double r) {
        return curves(r).incident_overpressure.value_or(*wave.incident_overpressure);
      };
      double const decay = decay_time(air.fluid.eos, air.state, overpressure, distance);
      if (!std::isfinite(decay)) continue;
      expected.half_width =
          wave.duration ? half_of_friedlander(*wave.duration / decay - 1.0) * *wave.duration : std::log(2.0) * decay;
    }
    expected.strength = 1.4 * *wave.incident_overpressure / (air.state.density * sound * sound);
    expected.cells_per_half_width = expected.half_width * *wave.shock_speed / cell;
    expected.clipping = clipping(expected.cells_per_half_width, {expected.strength, expected.reflected});
    if (!strongest || expected.strength > strongest->strength) strongest = expected;
  }
  return strongest;
}

}  // namespace brisance::observe
