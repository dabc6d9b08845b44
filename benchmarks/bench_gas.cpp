/// Cell updates per second of full 3D steps, beside the memory bandwidth of the machine in the same run.
///
///   bench_gas [--benchmark_filter=...]
///
/// `cells/s` counts whole steps (three sweeps) of 128^3 cells in wall-clock time, all threads together. Cases: one
/// fluid; two fluids with JWL products and air mixed everywhere (the dearest cells there are); the same with products
/// so thin that their exponentials vanish; two fluids of which the products fill a sphere in one corner, 5 % of the
/// domain, expanded so far that their exponentials matter in the middle only (a blast after some time); the mixture
/// again with afterburn, at a constant rate and by Miller's law. The products in the corner also with what a run may
/// have besides: peak fields, cells whose number is no multiple of 8, obstacles, cells that burn, cells held by
/// particles; and in blocks of other sizes. `levels`: cells of 1/96, and half of them in a shell around a corner, as a
/// shock has them; a fine cell counts for each of its two steps. Beside it the same gas in such blocks of one level.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/parallel.hpp"
#include "gas/gas.hpp"
#include "grid/forest.hpp"

namespace {

using namespace brisance;

constexpr int usual_cells = 128;

enum Content { one_fluid, mixed_everywhere, mixed_thin, products_in_a_corner };

material::Primitive content_at(Content content, Vec3 const& x) {
  material::Primitive s;
  s.pressure = 101325.0 * (1.0 + 0.1 * (std::sin(10.0 * x[0]) + std::sin(7.0 * x[1]) + std::sin(8.0 * x[2])));
  s.velocity = {30.0 * std::sin(9.0 * x[1]), 20.0 * std::cos(5.0 * x[2]), 10.0};
  double const r = norm(x);
  double const air = s.density;
  auto const add_products = [&](double fraction, double density) {
    s.density = (1.0 - fraction) * air + fraction * density;
    s.mass_fraction.set(material::products_fluid, fraction * density / s.density);
    s.volume_fraction.set(material::products_fluid, fraction);
  };
  if (content == mixed_everywhere) {
    add_products(0.5 + 0.4 * std::sin(20.0 * r), 100.0);
  } else if (content == mixed_thin) {
    add_products(0.5 + 0.4 * std::sin(20.0 * r), 20.0);
  } else if (content == products_in_a_corner && r < 0.46) {
    add_products(0.999, r < 0.1 ? 200.0 : 2.0);
    s.pressure *= r < 0.1 ? 10.0 : 1.0;
  }
  return s;
}

enum Burning { no_afterburn, constant_rate, miller };

/// What a run has besides the gas.
enum Besides { nothing, peak_fields, odd_cells, obstacles, burning_charge, held_cells, everything };

bool has(Besides besides, Besides what) { return besides == what || besides == everything; }

/// Box buildings, 6 % of the domain.
bool in_building(Vec3 const& x) {
  auto const of_street = [](double y) { return std::fmod(y, 0.5) > 0.3 && std::fmod(y, 0.5) < 0.45; };
  return of_street(x[0]) && of_street(x[1]) && x[2] < 0.6;
}

/// What stands between particles and gas cells: a cube in the middle, 3 % of the domain.
bool in_held_cube(Vec3 const& x) {
  return std::abs(x[0] - 0.5) < 0.15 && std::abs(x[1] - 0.5) < 0.15 && std::abs(x[2] - 0.8) < 0.15;
}

void add_besides(Besides besides, gas::Gas& gas) {
  grid::Grid const& grid = gas.grid();
  for (grid::Block const& block : grid.blocks()) {
    grid::CellRange const box = block.with_ghosts();
    auto const centre = [&](Index3 const& within) {
      Vec3 x = block.centre(block.cell(0, 0, 0));
      for (int d = 0; d < 3; ++d) x[d] += within[d] * block.h();
      return x;
    };
    if (has(besides, obstacles)) {
      std::vector<std::uint8_t> solid(box.count(), 0);
      for_each_cell(box,
                    [&](Index3 const& within) { solid[box.offset(within)] = in_building(centre(within)) ? 1 : 0; });
      if (std::any_of(solid.begin(), solid.end(), [](std::uint8_t x) { return x != 0; }))
        gas.obstacles.set(block.number, std::move(solid));
    }
    if (has(besides, held_cells)) {
      std::vector<gas::Role> roles(block.cell_count(), gas::Role::own);
      bool any = false;
      for_each_cell(block, [&](grid::Cell const& cell) {
        if (!in_held_cube(block.centre(cell))) return;
        roles[cell.offset] = gas::Role::frozen;
        any = true;
      });
      if (any) gas.coupling.set_roles(block.number, std::move(roles));
    }
    if (has(besides, burning_charge) && norm(block.centre(block.cell(0, 0, 0))) < 0.4) {
      gas.burn.set_times(block.number, std::vector<gas::BurnTime>(box.count(), {-2.0, -1.0}),
                         std::vector<std::uint16_t>(box.count(), 0));
    }
  }
  if (has(besides, burning_charge)) {
    gas.burn.set_charges({{7000.0, 1630.0}});
    gas.burn.set_end(1e9, 1e-6);
  }
}

void gas_step(benchmark::State& state, gas::Scheme scheme, Content content, int block_cells,
              Burning burning = no_afterburn, Besides besides = nothing) {
  set_threads(static_cast<int>(state.range(0)));
  int const n = has(besides, odd_cells) ? usual_cells - 1 : usual_cells;
  grid::Domain domain;
  domain.cells = {n, n, n};
  domain.h = 1.0 / n;
  domain.boundary.fill(grid::Boundary::symmetry);
  grid::Grid const grid(domain, block_cells);
  gas::Fluids fluids;
  fluids.eos[0] = material::IdealGas{1.4};
  fluids.eos[1] = material::Jwl{};
  fluids.count = content == one_fluid ? 1 : 2;
  fluids.ambient_pressure = 101325.0;
  gas::Options options;
  options.scheme = scheme;
  // So slow that the gas stays what it is.
  if (burning == constant_rate) options.afterburn = material::Afterburn{1e3, material::ConstantRateAfterburn{0.0, 1e4}};
  if (burning == miller)
    options.afterburn = material::Afterburn{1e3, material::MillerAfterburn{1e-3, 1e5, 0.5, 0.1667, 0.0}};
  options.peak_fields = has(besides, peak_fields);
  gas::Gas gas(grid, fluids, options, {});
  for (grid::Block const& block : grid.blocks()) {
    for_each_cell(block, [&](grid::Cell const& cell) { gas.set(cell, content_at(content, block.centre(cell))); });
  }
  add_besides(besides, gas);
  gas.start();
  long step = 0;
  for (auto _ : state) gas.advance(0.5 * domain.h / gas.fastest_signal(), step++ % 2 == 1);
  double const updates = static_cast<double>(state.iterations()) * n * n * n;
  state.counters["cells/s"] = benchmark::Counter(updates, benchmark::Counter::kIsRate);
  state.counters["cells/s/core"] =
      benchmark::Counter(updates / static_cast<double>(state.range(0)), benchmark::Counter::kIsRate);
}

/// Blocks of 16^3 cells of two levels, or of one.
void level_step(benchmark::State& state, Content content, bool refined) {
  set_threads(static_cast<int>(state.range(0)));
  constexpr int n = 96;
  constexpr int size = 16;
  if (!grid::Forest::can_refine(3)) {
    state.SkipWithError("built without p4est");
    return;
  }
  grid::Domain domain;
  domain.cells = {n, n, n};
  domain.h = 1.0 / n;
  domain.boundary.fill(grid::Boundary::symmetry);
  grid::Forest forest({n / size, n / size, n / size}, 3, {false, false, false});
  std::vector<std::int8_t> marks;
  for (grid::Leaf const& leaf : forest.leaves()) {
    Vec3 const centre{leaf.place[0] + 0.5, leaf.place[1] + 0.5, leaf.place[2] + 0.5};
    double const r = norm(centre) * size / n;
    marks.push_back(refined && std::abs(r - 0.75) < 0.12 ? 1 : 0);
  }
  forest.adapt(marks, 1);
  grid::Grid const grid(domain, {size, size, size}, forest);
  gas::Fluids fluids;
  fluids.eos[0] = material::IdealGas{1.4};
  fluids.eos[1] = material::Jwl{};
  fluids.count = content == one_fluid ? 1 : 2;
  fluids.ambient_pressure = 101325.0;
  gas::Gas gas(grid, fluids, {}, {});
  double updates = 0.0;
  for (grid::Block const& block : grid.blocks()) {
    for_each_cell(block, [&](grid::Cell const& cell) { gas.set(cell, content_at(content, block.centre(cell))); });
    if (!block.covered) updates += std::ldexp(block.cell_count(), block.level);
  }
  gas.start();
  long step = 0;
  for (auto _ : state) gas.advance(0.5 * domain.h / gas.fastest_signal(), step++ % 2 == 1);
  state.counters["cells/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * updates, benchmark::Counter::kIsRate);
}

/// a = b + s c on arrays far larger than any cache: what the machine's memory gives.
void memory_bandwidth(benchmark::State& state) {
  set_threads(static_cast<int>(state.range(0)));
  constexpr int parts = 64;
  constexpr long count = 1L << 25;
  std::vector<double> a(count, 0.0);
  std::vector<double> b(count, 1.0);
  std::vector<double> c(count, 2.0);
  for (auto _ : state) {
    parallel_for(parts, [&](int part, int) {
      long const from = count / parts * part;
      for (long q = from; q < from + count / parts; ++q) a[q] = b[q] + 3.0 * c[q];
    });
    benchmark::DoNotOptimize(a.data());
  }
  state.counters["bytes/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * count * 24.0, benchmark::Counter::kIsRate);
}

void threads_of_interest(benchmark::internal::Benchmark* b) {
  b->Arg(1)->Arg(2)->ArgName("threads")->UseRealTime()->Unit(benchmark::kMillisecond);
}

BENCHMARK(memory_bandwidth)->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / one_fluid, gas::Scheme::muscl_hancock, one_fluid, 0)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / two_fluids_mixed, gas::Scheme::muscl_hancock, mixed_everywhere, 0)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / two_fluids_mixed_thin, gas::Scheme::muscl_hancock, mixed_thin, 0)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / two_fluids_corner, gas::Scheme::muscl_hancock, products_in_a_corner, 0)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / two_fluids_mixed / constant_rate_afterburn, gas::Scheme::muscl_hancock,
                  mixed_everywhere, 0, constant_rate)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / two_fluids_mixed / miller_afterburn, gas::Scheme::muscl_hancock,
                  mixed_everywhere, 0, miller)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / two_fluids_corner / peak_fields, gas::Scheme::muscl_hancock,
                  products_in_a_corner, 0, no_afterburn, peak_fields)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / two_fluids_corner / odd_cells, gas::Scheme::muscl_hancock,
                  products_in_a_corner, 0, no_afterburn, odd_cells)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / two_fluids_corner / obstacles, gas::Scheme::muscl_hancock,
                  products_in_a_corner, 0, no_afterburn, obstacles)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / two_fluids_corner / burning, gas::Scheme::muscl_hancock,
                  products_in_a_corner, 0, no_afterburn, burning_charge)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / two_fluids_corner / held_cells, gas::Scheme::muscl_hancock,
                  products_in_a_corner, 0, no_afterburn, held_cells)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / two_fluids_corner / everything, gas::Scheme::muscl_hancock,
                  products_in_a_corner, 0, no_afterburn, everything)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / one_fluid / blocks_of_16, gas::Scheme::muscl_hancock, one_fluid, 16)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / one_fluid / blocks_of_32, gas::Scheme::muscl_hancock, one_fluid, 32)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / two_fluids_mixed_thin / blocks_of_16, gas::Scheme::muscl_hancock,
                  mixed_thin, 16)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, muscl_hancock / two_fluids_corner / peak_fields / blocks_of_16, gas::Scheme::muscl_hancock,
                  products_in_a_corner, 16, no_afterburn, peak_fields)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, lax_wendroff / one_fluid, gas::Scheme::lax_wendroff, one_fluid, 0)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(gas_step, lax_wendroff / two_fluids_mixed, gas::Scheme::lax_wendroff, mixed_everywhere, 0)
    ->Apply(threads_of_interest);
BENCHMARK_CAPTURE(level_step, one_fluid / one_level, one_fluid, false)->Apply(threads_of_interest);
BENCHMARK_CAPTURE(level_step, one_fluid / levels, one_fluid, true)->Apply(threads_of_interest);
BENCHMARK_CAPTURE(level_step, two_fluids_corner / one_level, products_in_a_corner, false)->Apply(threads_of_interest);
BENCHMARK_CAPTURE(level_step, two_fluids_corner / levels, products_in_a_corner, true)->Apply(threads_of_interest);

}  // namespace

BENCHMARK_MAIN();
