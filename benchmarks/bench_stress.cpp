/// The stress of material points alone: time per particle, by material, on one thread. Called with 64 particles at a
/// time, as a step does.
#include <benchmark/benchmark.h>

#include <vector>

#include "material/stress.hpp"

namespace {

using namespace brisance::material;

constexpr int particles = 6400;
constexpr int at_a_time = 64;
constexpr double p = 1e7;

/// What the particles are: each array has one value per particle.
struct Cloud {
  Material solid;
  std::vector<double> density, energy, mass_fraction, volume_fraction;
};

Cloud plain(Fluid const& fluid) {
  Cloud cloud;
  cloud.solid = of(fluid);
  cloud.density.assign(particles, cloud.solid.density);
  cloud.energy.assign(particles, cloud.solid.specific_energy);
  return cloud;
}

/// Air with products; every `every`-th particle mixes with volume fraction alpha, the others are air.
Cloud mixed(double alpha, int every) {
  Fluids const fluids{{IdealGas{1.4}, Jwl{}}, 2, 101325.0};
  Cloud cloud;
  cloud.solid = gas_of(fluids, 10.0, p);
  for (int i = 0; i < particles; ++i) {
    double const own = i % every == 0 ? alpha : 0.0;
    double const first = (1.0 - own) * 10.0;
    double const second = own * 500.0;
    double const rho = first + second;
    cloud.density.push_back(rho);
    cloud.energy.push_back(mixture(fluids, {first, second}, Fractions::of(1, own)).rho_e(p) / rho);
    cloud.mass_fraction.push_back(second / rho);
    cloud.volume_fraction.push_back(own);
  }
  return cloud;
}

void run(benchmark::State& state, Cloud cloud) {
  std::vector<double> pressure(particles, p);
  std::vector<double> viscosity(particles, 0.0);
  std::vector<double> sound_speed(particles, 0.0);
  std::vector<double> volumetric(particles);
  double sign = 1.0;
  for ([[maybe_unused]] auto _ : state) {
    // Back and forth: the state stays where it is.
    for (int i = 0; i < particles; ++i) volumetric[i] = sign * (i % 2 == 0 ? 1e-5 : -1e-5);
    sign = -sign;
    for (int begin = 0; begin < particles; begin += at_a_time) {
      ParticleArrays a;
      a.n = at_a_time;
      a.volumetric = volumetric.data() + begin;
      a.pressure = pressure.data() + begin;
      a.viscosity = viscosity.data() + begin;
      a.density = cloud.density.data() + begin;
      a.energy = cloud.energy.data() + begin;
      a.sound_speed = sound_speed.data() + begin;
      if (!cloud.mass_fraction.empty()) {
        a.mass_fraction = cloud.mass_fraction.data() + begin;
        a.volume_fraction = cloud.volume_fraction.data() + begin;
      }
      update_stress(cloud.solid, a, {1e-7, 1e-3});
    }
    benchmark::DoNotOptimize(sound_speed.data());
  }
  double const updates = static_cast<double>(particles) * static_cast<double>(state.iterations());
  state.counters["time/point"] = benchmark::Counter(updates, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

bool register_all() {
  auto const add = [](char const* name, Cloud const& cloud) {
    benchmark::RegisterBenchmark(name, [cloud](benchmark::State& state) { run(state, cloud); });
  };
  add("air", plain(Fluid{"air", "", IdealGas{1.4}, 10.0, p}));
  add("products", plain(Fluid{"products", "", Jwl{}, 500.0, p}));
  add("mixture/air only", mixed(0.0, 1));
  add("mixture/one in 64", mixed(0.3, 64));
  add("mixture/all", mixed(0.3, 1));
  add("mixture/products only", mixed(1.0, 1));
  return true;
}

bool const registered = register_all();

}  // namespace
