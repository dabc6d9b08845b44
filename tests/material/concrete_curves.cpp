/// Prints what validation/concrete.py draws of single particles of the library's concretes, as CSV: the tensile
/// strength under constant strain rates, and stress paths.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "material_files.hpp"
#include "stress_paths.hpp"

namespace {

using namespace brisance::material;

/// Largest stress [Pa] of uniaxial tension at a constant strain rate [1/s], in steps of 2e-6 of strain.
double tensile_strength(Material const& solid, double rate) {
  double const strain = 2e-6;
  Particles particle(solid);
  particle.data = {strain / rate, 0.005};
  double most = 0.0;
  for (int k = 0; k < 10000; ++k) {
    step_with_lateral_stress(particle, strain, 0.0);
    double const stress = axial_stress(particle);
    if (stress < 0.7 * most) break;
    most = std::max(most, stress);
  }
  return most;
}

void print_rates(Material const& solid) {
  for (int k = -24; k <= 9; ++k) {
    double const rate = std::pow(10.0, 0.25 * k);
    std::printf("tension,%s,%.6g,%.6g\n", solid.name.c_str(), rate, tensile_strength(solid, rate));
  }
}

void print_uniaxial(Material const& solid) {
  for (double const rate : {1.0, 1e2, 1e4}) {
    Particles particle(solid);
    double const step = 2e-5;
    particle.data = {step / rate, 0.0};
    for (int k = 1; k <= 400; ++k) {
      step_with_lateral_stress(particle, -step, 0.0);
      std::printf("uniaxial %g /s,%s,%.6g,%.6g\n", rate, solid.name.c_str(), k * step, -axial_stress(particle));
    }
  }
}

void print_triaxial(Material const& solid) {
  auto const curves = std::get<Compaction>(solid.eos).curves();
  for (double const confinement : {10e6, 50e6, 200e6, 1500e6}) {
    Particles particle(solid);
    particle.data = {1.0, 0.0};
    double low = 0.0;
    double high = 0.5;
    for (int k = 0; k < 200; ++k) (curves.loading(0.5 * (low + high)) > confinement ? high : low) = 0.5 * (low + high);
    for (int k = 0; k < 400; ++k) particle.step(swell(std::pow(1.0 / (1.0 + low), 1.0 / 400)));
    double const step = 1e-3;
    for (int k = 1; k <= 150 && particle.damage[0] < 1.0; ++k) {
      step_with_lateral_stress(particle, -step, -confinement);
      std::printf("triaxial %g MPa,%s,%.6g,%.6g\n", confinement * 1e-6, solid.name.c_str(), k * step, particle.mises());
    }
  }
}

void print_hydrostat(Material const& solid) {
  Particles particle(solid);
  particle.data = {1.0, 0.0};
  double mu = 0.0;
  auto const to = [&](double target) {
    for (int k = 0; k < 50; ++k) {
      double const next = mu + (target - mu) / (50 - k);
      particle.step(swell((1.0 + mu) / (1.0 + next)));
      mu = next;
      std::printf("hydrostat,%s,%.6g,%.6g\n", solid.name.c_str(), mu, particle.pressure[0]);
    }
  };
  auto const curves = std::get<Compaction>(solid.eos).curves();
  for (double const most : {0.03, 0.07, 0.13}) {
    to(most);
    to(curves.residual(most));
    to(most);
  }
}

}  // namespace

int main() {
  std::puts("path,material,x,y");
  for (auto const& solid : brisance::test::read_material_files().solids) {
    if (!solid.crushes()) continue;
    print_rates(solid);
    print_uniaxial(solid);
    print_triaxial(solid);
    print_hydrostat(solid);
  }
}
