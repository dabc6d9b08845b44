/// From conserved to primitive variables in a bundle, with the guards that keep density and internal energy positive.
#pragma once

#include <algorithm>
#include <cmath>
#include <variant>

#include "gas/kernels.hpp"
#include "gas/passes.hpp"

namespace brisance::gas {

/// Closure of one state of N fluids; F: burn fraction.
template <int N>
[[nodiscard]] Mixture closure_of(Fluids const& fluids, PerFluid const& partial, PerFluid const& alpha, double F) {
  Mixture m;
  double rest = 1.0;
  for_fluids<1, N>([&](int k) { rest -= alpha[k]; });
  std::visit([&](auto const& eos) { add_fluid(eos, rest, phase_density(partial[0], rest), m); }, fluids.ambient());
  for_fluids<1, N>([&](int k) {
    std::visit(
        [&](auto const& eos) {
          add_fluid_of_cell(eos, alpha[k], phase_density(partial[k], alpha[k]), F, fluids.ambient_pressure, m);
        },
        fluids.eos[k]);
  });
  return m;
}

/// Is cell q of the bundle one of the block's own (and not a ghost cell)?
inline bool is_own(BundleLayout const& b, int q) {
  constexpr int g = grid::ghost_layers;
  int const layer = b.direction == 0 ? q % (b.length + 2 * g) : q / b.stride;
  return layer >= g && layer < g + b.length;
}

/// Is the cell above the floors of density and of `margin`? False for anything that is no number.
[[nodiscard]] inline bool is_sound(Floors const floors, double most_H, double rho, double p, double xi, double H) {
  return (rho >= 0.999999 * floors.density) & (margin(p, xi, H, most_H) >= 0.999999 * floors.pressure * (xi + 1.0));
}

/// Lifts one cell to the floors.
inline Lift lift_cell(SweepContext const& s, BundleArrays& a, int q) {
  Floors const floors = s.floors;
  Lift lift{q};
  double rho = mixture_density(s, a, q);
  double const E = a[energy][q];
  double const mx = a[momentum_x][q];
  double const my = a[momentum_y][q];
  double const mz = a[momentum_z][q];
  lift.finite = std::isfinite(rho + E + mx + my + mz);
  if (!lift.finite) return lift;
  if (rho < floors.density) {
    lift.mass = floors.density - rho;
    a[partial_density(0)][q] += lift.mass;
    rho = floors.density;
  }
  double const xi = a[a_xi][q];
  double const B = a[a_B][q];
  double const H = a[a_H][q];
  double const kinetic = 0.5 * (mx * mx + my * my + mz * mz) / rho;
  double const p = (E - kinetic - B) / xi;
  lift.finite = std::isfinite(p);
  if (lift.finite && !is_sound(floors, s.most_H, rho, p, xi, H)) {
    double const lifted = (floors.pressure - std::min(H, s.most_H) / (xi + 1.0)) * xi + B + kinetic;
    lift.energy = lifted - E;
    a[energy][q] = lifted;
  }
  return lift;
}

/// Lifts every unsound cell in [begin, begin + n) whose closure sums are known, and remembers the block's own. Seldom
/// called.
inline void lift_cells(SweepContext const& s, BundleLayout const& b, BundleArrays& a, int begin, int n,
                       GuardCount& guards) {
  Floors const floors = s.floors;
  for (int q = begin; q < begin + n; ++q) {
    double const rho = mixture_density(s, a, q);
    if (is_sound(floors, s.most_H, rho, a[a_p][q], a[a_xi][q], a[a_H][q])) continue;
    Lift const lift = lift_cell(s, a, q);
    if (is_own(b, q)) guards.lifts.push_back(lift);
  }
}

/// Closure sums of the cells [begin, begin + count) where they are no constants. Returns which ones count.
[[nodiscard]] inline Sums find_closure(SweepContext const& s, int begin, int count, BundleArrays& a) {
  if (s.sums == Sums::none) return s.sums;
  ClosureRow row;
  row.begin = begin;
  row.count = count;
  row.fluids = s.present;
  row.burning = s.burning;
  row.ambient = s.fluids->ambient_pressure;
  bool curved = false;
  for (int k = 0; k < s.present; ++k) {
    row.fluid = k;
    std::visit(
        [&]<class E>(E const& eos) {
          using Add = bool (*)(E const&, ClosureRow const&, BundleArrays&);
          curved |= std::get<Add>(passes().closure.add)(eos, row, a);
        },
        s.fluids->eos[k]);
  }
  return curved ? Sums::all : Sums::xi;
}

/// Puts the constants of one ideal gas into the arrays, for what is rare and reads them there.
inline void write_closure(SweepContext const& s, int begin, int count, BundleArrays& a) {
  if (s.sums != Sums::none) return;
  std::fill_n(a[a_xi] + begin, count, 1.0 / (s.gamma - 1.0));
  std::fill_n(a[a_B] + begin, count, 0.0);
  std::fill_n(a[a_H] + begin, count, 0.0);
}

inline Passes::OfFluids const& passes_of(int fluids, Sums sums) {
  return passes().of_fluids[fluids - 1][static_cast<int>(sums)];
}
inline Passes::OfFluids const& passes_of(SweepContext const& s) { return passes_of(s.present, s.sums); }

/// Primitive variables of a bundle; notes which closure sums the row has.
inline void primitives(SweepContext& s, BundleLayout const& b, BundleArrays& a, GuardCount& guards) {
  s.sums = find_closure(s, 0, b.total, a);
  if (!passes_of(s).primitives(s, 0, b.total, a)) {
    write_closure(s, 0, b.total, a);
    lift_cells(s, b, a, 0, b.total, guards);
    passes_of(s).primitives(s, 0, b.total, a);
  }
  if (s.shock_sensor) passes_of(s).sensor(b, a);
}

/// Pressure and |u| + c of the cells [begin, begin + n) after an update, with the guards: the step may not end with a
/// cell below the floors either, for gauges and dumps would show it. Returns the largest signal [m/s].
inline double signals(SweepContext const& s, BundleLayout const& b, BundleArrays& a, int begin, int n, int dimensions,
                      GuardCount& guards) {
  Passes::OfFluids const& passes = passes_of(s.present, find_closure(s, begin, n, a));
  Signals found = passes.signals(s, begin, n, dimensions, a);
  if (!found.sound) {
    write_closure(s, begin, n, a);
    lift_cells(s, b, a, begin, n, guards);
    found = passes.signals(s, begin, n, dimensions, a);
  }
  return found.fastest;
}

}  // namespace brisance::gas
