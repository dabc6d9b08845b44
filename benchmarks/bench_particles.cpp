/// Material points: particle updates per second of a full step (MUSL, 8 particles per cell, 3D, double), by material,
/// shape function, number of particles and threads; and the sums that the audit takes. `--benchmark_filter=...` picks;
/// docs/benchmarks.md has figures.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <string>

#include "core/parallel.hpp"
#include "mpm/mpm.hpp"

namespace {

using namespace brisance;

enum Matter { gas, elastic, johnson_cook };

material::Material solid_of(Matter matter) {
  if (matter == gas) {
    material::Material air;
    air.density = 1.225;
    air.eos = material::IdealGas{};
    air.specific_energy = 2.0685e5;
    return air;
  }
  material::Material solid = material::elastic_solid(8960.0, 124e9, 0.34);
  if (matter == johnson_cook) {
    solid.strength = material::JohnsonCook{};
    solid.specific_heat = 383.0;
  }
  return solid;
}

/// A cube of particles with mirror planes all around, stirred: every particle strains, spins and (Johnson-Cook) yields.
std::unique_ptr<mpm::Mpm> stirred_cube(Matter matter, mpm::ShapeFunction shape, int per_edge) {
  double const h = 1e-3;
  int const cells = per_edge / 2;
  grid::Domain domain;
  domain.h = h;
  domain.cells = {cells, cells, cells};
  domain.boundary.fill(grid::Boundary::symmetry);
  mpm::Options options;
  options.shape = shape;
  mpm::Body body;
  body.name = "cube";
  body.solid = solid_of(matter);
  auto cube = std::make_unique<mpm::Mpm>(domain, std::vector<mpm::Body>{body}, options);
  mpm::Mpm& particles = *cube;
  mpm::Filling filling;
  for (int k = 0; k < per_edge; ++k) {
    for (int j = 0; j < per_edge; ++j) {
      for (int i = 0; i < per_edge; ++i) {
        filling.positions.push_back({(i + 0.5) * 0.5 * h, (j + 0.5) * 0.5 * h, (k + 0.5) * 0.5 * h});
        filling.volumes.push_back(h * h * h / 8.0);
      }
    }
  }
  particles.fill(0, filling);
  double const speed = matter == gas ? 100.0 : matter == elastic ? 1.0 : 200.0;
  double const wave = 2.0 * 3.14159265358979 / (cells * h);
  for (int block = 0; block < particles.grid().block_count(); ++block) {
    mpm::ParticleSet& set = particles.particles(block, 0);
    for (int q = 0; q < set.size(); ++q) {
      double const x = set.field(mpm::Field::position_x)[q];
      double const y = set.field(mpm::Field::position_y)[q];
      set.field(mpm::Field::velocity_x)[q] = speed * std::sin(wave * x) * std::cos(wave * y);
      set.field(mpm::Field::velocity_y)[q] = -speed * std::cos(wave * x) * std::sin(wave * y);
    }
  }
  for (int n = 0; n < 3; ++n) particles.advance(particles.stable_step());
  return cube;
}

void run(benchmark::State& state, Matter matter, mpm::ShapeFunction shape, int per_edge, int threads) {
  set_threads(threads);
  auto const cube = stirred_cube(matter, shape, per_edge);
  mpm::Mpm& particles = *cube;
  auto const before = particles.timings();
  long steps = 0;
  for ([[maybe_unused]] auto _ : state) {
    particles.advance(particles.stable_step());
    ++steps;
  }
  auto const updates = static_cast<double>(mpm::particle_count(particles)) * static_cast<double>(steps);
  state.counters["points/s"] = benchmark::Counter(updates, benchmark::Counter::kIsRate);
  state.counters["bytes/point"] =
      static_cast<double>(mpm::bytes(particles)) / static_cast<double>(mpm::particle_count(particles));
  for (auto const& [phase, seconds] : particles.timings()) {
    auto const earlier = before.find(phase);
    double const spent = seconds - (earlier == before.end() ? 0.0 : earlier->second);
    state.counters["ns " + phase] = 1e9 * spent / updates;
  }
}

void run_sums(benchmark::State& state, int per_edge, int threads) {
  set_threads(threads);
  auto const cube = stirred_cube(johnson_cook, mpm::ShapeFunction::linear, per_edge);
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(mpm::sums(*cube, 0));
  state.counters["points/s"] = benchmark::Counter(static_cast<double>(mpm::particle_count(*cube)),
                                                  benchmark::Counter::kIsIterationInvariantRate);
}

struct Choice {
  char const* name;
  mpm::ShapeFunction shape;
};
constexpr Choice shapes[] = {{"linear", mpm::ShapeFunction::linear},
                             {"gimp", mpm::ShapeFunction::gimp},
                             {"bspline", mpm::ShapeFunction::bspline}};
struct Material {
  char const* name;
  Matter matter;
};
constexpr Material materials[] = {{"gas", gas}, {"elastic", elastic}, {"johnson_cook", johnson_cook}};

bool register_all() {
  for (int const per_edge : {30, 100}) {
    for (int const threads : {1, 2}) {
      std::string const name =
          "sums/" + std::to_string(per_edge * per_edge * per_edge) + "/threads:" + std::to_string(threads);
      benchmark::RegisterBenchmark(name.c_str(), run_sums, per_edge, threads)
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime();
    }
    for (Material const& material : materials) {
      for (Choice const& choice : shapes) {
        for (int const threads : {1, 2}) {
          std::string const name = std::string(material.name) + "/" + choice.name + "/" +
                                   std::to_string(per_edge * per_edge * per_edge) +
                                   "/threads:" + std::to_string(threads);
          benchmark::RegisterBenchmark(name.c_str(), run, material.matter, choice.shape, per_edge, threads)
              ->Unit(benchmark::kMillisecond)
              ->UseRealTime()
              ->MinTime(0.5);
        }
      }
    }
  }
  return true;
}

bool const registered = register_all();

}  // namespace
