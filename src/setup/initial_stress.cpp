#include "setup/initial_stress.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.hpp"
#include "material/compressed.hpp"
#include "material/stress.hpp"

namespace brisance::setup {

namespace {

constexpr int most_samples_per_cell = 96;

/// The start of a body's material.
material::Material start_of(Body const& body) {
  material::Material start = body.solid;
  start.density = body.density.value_or(start.density);
  start.specific_energy = body.specific_energy.value_or(start.specific_energy);
  return start;
}

/// Particles of all bodies lie where samples end.
int samples_per_cell(std::vector<Body> const& bodies) {
  int common = 1;
  int most = 1;
  for (Body const& body : bodies) {
    most = std::max(most, body.particles_per_direction);
    common = std::min(std::lcm(common, body.particles_per_direction), most_samples_per_cell);
  }
  return 2 * (2 * common <= most_samples_per_cell ? common : most);
}

}  // namespace

Overburden::Overburden(Case const& setup, grid::Domain const& cells) : setup_(&setup) {
  Vec3 const& force = setup.particles.options.body_force;
  int axes = 0;
  for (int d = 0; d < setup.domain.dimensions(); ++d) {
    if (force[d] == 0.0) continue;
    ++axes;
    axis_ = d;
  }
  if (axes != 1) throw InputError("an initial stress by gravity needs a body_force along one axis of the grid");
  g_ = std::abs(force[axis_]);
  downwards_ = force[axis_] < 0.0;
  int const per_cell = samples_per_cell(setup.particles.bodies);
  samples_ = cells.cells[axis_] * per_cell;
  spacing_ = (setup.domain.upper(axis_) - setup.domain.lower[axis_]) / samples_;
}

Overburden::Sequence Overburden::sequence(Vec3 const& x) const {
  grid::Domain const& domain = setup_->domain;
  std::vector<Body> const& bodies = setup_->particles.bodies;
  Sequence out(static_cast<std::size_t>(samples_), -1);
  Vec3 at = x;
  for (int n = 0; n < samples_; ++n) {
    double const depth = (n + 0.5) * spacing_;
    at[axis_] = downwards_ ? domain.upper(axis_) - depth : domain.lower[axis_] + depth;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (!shape::contains(bodies[b].shape, domain, at)) continue;
      out[static_cast<std::size_t>(n)] = static_cast<signed char>(b);
      break;
    }
  }
  return out;
}

double Overburden::density(int body, double vertical) const {
  Body const& of = setup_->particles.bodies[static_cast<std::size_t>(body)];
  return of.lateral_stress ? state(of, vertical).density : of.density.value_or(of.solid.density);
}

std::vector<double> const& Overburden::profile(Sequence const& bodies) {
  auto [found, is_new] = profiles_.try_emplace(bodies);
  std::vector<double>& stress = found->second;
  if (!is_new) return stress;
  stress.assign(1, 0.0);
  for (signed char const body : bodies) {
    double s = stress.back();
    // What hangs above a gap, or is carried by a rigid body, weighs on nothing below.
    bool const carries = body >= 0 && !setup_->particles.bodies[static_cast<std::size_t>(body)].rigid;
    if (!carries) s = 0.0;
    // The density of the middle of the sample.
    if (carries) s += g_ * spacing_ * density(body, s + 0.5 * g_ * spacing_ * density(body, s));
    stress.push_back(s);
  }
  return stress;
}

double Overburden::at(Vec3 const& x) {
  auto [vertical, is_new] = verticals_.try_emplace({x[axis_ == 0 ? 1 : 0], x[axis_ == 2 ? 1 : 2]}, nullptr);
  if (is_new) vertical->second = &profile(sequence(x));
  std::vector<double> const& stress = *vertical->second;
  grid::Domain const& domain = setup_->domain;
  double const depth = downwards_ ? domain.upper(axis_) - x[axis_] : x[axis_] - domain.lower[axis_];
  double const place = std::clamp(depth / spacing_, 0.0, static_cast<double>(samples_));
  auto const n = std::min(static_cast<std::size_t>(place), static_cast<std::size_t>(samples_ - 1));
  double const part = place - static_cast<double>(n);
  return (1.0 - part) * stress[n] + part * stress[n + 1];
}

GravityState Overburden::state(Body const& body, double vertical) const {
  material::Material const start = start_of(body);
  double const K0 = *body.lateral_stress;
  double const mean = (1.0 + 2.0 * K0) / 3.0 * vertical;
  double const mises = std::abs(1.0 - K0) * vertical;
  material::Compressed const under = material::compressed_to(start, material::start_pressure(start) + mean, mises);
  GravityState state{under.density, under.specific_energy, {}};
  for (int d = 0; d < 3; ++d) state.deviator[static_cast<std::size_t>(d)] = mean - (d == axis_ ? 1.0 : K0) * vertical;
  return state;
}

double Overburden::largest(Body const& body, int stride) {
  grid::Domain const& domain = setup_->domain;
  shape::Box const box = shape::bounds(body.shape);
  Index3 low{0, 0, 0};
  Index3 high{1, 1, 1};
  for (int d = 0; d < domain.dimensions(); ++d) {
    auto const cell = [&](double x) {
      return static_cast<int>(std::clamp(std::floor(domain.in_cells(d, x)), 0.0, domain.cells[d] - 1.0));
    };
    low[d] = cell(box.lower[d]);
    high[d] = cell(box.upper[d]) + 1;
  }
  high[axis_] = low[axis_] + 1;
  auto const number = static_cast<signed char>(&body - setup_->particles.bodies.data());
  double most = 0.0;
  for_each_cell(grid::CellRange{low, high}, [&](Index3 const& cell) {
    for (int d = 0; d < 3; ++d) {
      if ((cell[d] - low[d]) % stride != 0) return;
    }
    Sequence const column = sequence(domain.centre(cell));
    std::vector<double> const& stress = profile(column);
    for (std::size_t n = 0; n < column.size(); ++n) {
      if (column[n] == number) most = std::max(most, stress[n + 1]);
    }
  });
  return most;
}

bool bears(material::Material const& solid, GravityState const& state) {
  if (!solid.plastic()) return true;
  double const none = 0.0;
  double pressure = material::pressure(solid, state.density, state.specific_energy);
  double density = state.density;
  double energy = state.specific_energy;
  double viscosity = 0.0;
  double sound_speed = 0.0;
  double temperature = solid.temperature;
  std::array<double, 6> deviator = state.deviator;
  std::array<double, 5> others{};  // plastic strain, plastic work, damage, crushing, cracking
  auto const* porous = std::get_if<material::Compaction>(&solid.eos);
  double compression = porous == nullptr ? 0.0 : std::max(0.0, density / porous->rho0 - 1.0);
  material::ParticleArrays a;
  a.n = 1;
  for (auto& strain : a.strain) strain = &none;
  for (auto& spin : a.spin) spin = &none;
  a.volumetric = &none;
  for (std::size_t c = 0; c < 6; ++c) a.deviator[c] = &deviator[c];
  a.pressure = &pressure;
  a.viscosity = &viscosity;
  a.density = &density;
  a.energy = &energy;
  a.plastic_strain = &others[0];
  a.plastic_work = &others[1];
  if (solid.heats()) a.temperature = &temperature;
  if (solid.damages()) a.damage = &others[2];
  if (solid.crushes()) {
    a.crushing = &others[3];
    a.cracking = &others[4];
    a.compression = &compression;
  }
  a.sound_speed = &sound_speed;
  material::update_stress(solid, a, {1e-6, 1.0});
  constexpr double round_off = 1e-9;
  for (std::size_t c = 0; c < 3; ++c) {
    if (std::abs(deviator[c] - state.deviator[c]) > round_off * (std::abs(state.deviator[0]) + std::abs(pressure)))
      return false;
  }
  return true;
}

}  // namespace brisance::setup
