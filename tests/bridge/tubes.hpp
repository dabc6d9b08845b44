/// Tubes with an MPM region on one side, run and compared with the exact solution and with the gas scheme alone. Shared
/// by the tests and by the validation.
#pragma once

#include <string>

#include "bridge/harness.hpp"
#include "exact/exact_riemann.hpp"

namespace brisance::test {

struct Tube {
  char const* name;
  exact::State left;
  exact::State right;
  double end;  ///< [s]
  double diaphragm = 0.5;
};

/// Sod's, a strong shock and two rarefactions that run apart.
inline Tube const sod{"Sod", {1.0, 0.0, 1.0}, {0.125, 0.0, 0.1}, 0.143};
inline Tube const strong{"strong shock", {1.0, 0.0, 1000.0}, {1.0, 0.0, 1.0}, 0.010};
inline Tube const rarefaction{"rarefaction", {1.0, -0.8, 0.4}, {1.0, 0.8, 0.4}, 0.12};

inline Tube mirrored(Tube t) {
  std::swap(t.left, t.right);
  t.left.u = -t.left.u;
  t.right.u = -t.right.u;
  return t;
}

/// Where the MPM region lies: from `face` to the right end, or from the left end to `face`.
struct Where {
  int face;
  bool right;
};

/// L1 errors of density, velocity and pressure, relative to the exact solution's own norm.
using Norms = std::array<double, 3>;

struct TubeResult {
  Norms cells{};            ///< gas cells outside the region
  Norms alone{};            ///< the same cells in the gas scheme alone
  Norms particles{};        ///< gas particles
  Norms particles_alone{};  ///< cells of the gas scheme alone in the region
  double peak = 0.0;        ///< largest excess of the pressure over the exact one near the bridge / the tube's largest
  double peak_alone = 0.0;
  double peak_at = 0.0;     ///< [cells]
  double mass_drift = 0.0;  ///< relative, signed
  double energy_drift = 0.0;
  long injected = 0;
  long absorbed = 0;
};

inline run::Case tube_case(Tube const& t, Where const& where, int cells = 400) {
  auto c = coupled_case(grid::Geometry::planar1d, {cells, 1, 1}, grid::Boundary::outflow);
  set_region(c, {where.right ? where.face : 0, 0, 0}, {where.right ? cells : where.face, 1, 1});
  c.ambient.state = {t.right.rho, t.right.p, {t.right.u, 0.0, 0.0}};
  run::InitialState left;
  left.shape = shape::Box{{-1.0, -1.0, -1.0}, {t.diaphragm, 1.0, 1.0}};
  left.state = {t.left.rho, t.left.p, {t.left.u, 0.0, 0.0}};
  c.initial_states = {left};
  c.mpm_regions.front().activation = -1.0;
  return c;
}

/// How far around the face a peak counts [cells]: the bridge, its ghosts and as many cells outside.
inline constexpr int near_bridge = 12;

/// Where an exact wave is smeared over a few cells a difference to it is no peak: the largest and the smallest exact
/// value within this many cells bound what counts.
inline constexpr int smeared = 6;

inline TubeResult run_tube(Tube const& t, run::Case const& c) {
  run::World w = setup::build(c);
  int const n = c.domain.cells[0];
  material::Eos const left_eos = !c.other_fluids.empty() ? c.other_fluids[0].eos : c.ambient.fluid.eos;
  exact::Riemann const exact(left_eos, t.left, c.ambient.fluid.eos, t.right);
  auto const at = [&](double x) { return exact.at((x - t.diaphragm) / t.end).s; };
  auto const excess = [&](double x, double p) {
    double low = at(x).p;
    double high = low;
    for (int i = -smeared; i <= smeared; ++i) {
      low = std::min(low, at(x + i * c.domain.h).p);
      high = std::max(high, at(x + i * c.domain.h).p);
    }
    return std::max({0.0, p - high, low - p});
  };
  run::Totals const before = w.totals();
  run_to(w, t.end);
  w.update_audit();
  run::Case c_alone = c;
  c_alone.mpm_regions.clear();
  run::World alone = setup::build(c_alone);
  run_to(alone, t.end);

  TubeResult r;
  double const scale = std::max({t.left.p, t.right.p, at(t.diaphragm).p});
  int face = 0;
  for (bridge::Face const& f : w.regions.front().bridge->region().faces()) {
    if (!f.open) face = f.inside[0] + f.side;
  }
  Norms scale_cells{};
  Norms scale_particles{};
  Norms scale_inside{};
  auto const add = [](Norms& sum, double weight, double rho, double u, double p) {
    sum[0] += weight * std::abs(rho);
    sum[1] += weight * std::abs(u);
    sum[2] += weight * std::abs(p);
  };
  for_each_own_cell(w, [&](gas::Primitive const& s, Index3 const& cell) {
    double const x = (cell[0] + 0.5) / n;
    exact::State const e = at(x);
    add(r.cells, 1.0, s.density - e.rho, s.velocity[0] - e.u, s.pressure - e.p);
    add(scale_cells, 1.0, e.rho, e.u, e.p);
    if (std::abs(cell[0] + 0.5 - face) < near_bridge && excess(x, s.pressure) / scale > r.peak) {
      r.peak = excess(x, s.pressure) / scale;
      r.peak_at = x * n;
    }
  });
  for_each_particle(w, w.regions.front().gas_body(), [&](mpm::ParticleSet const& set, int q) {
    double const x = set.field(Field::position_x)[q];
    double const volume = set.field(Field::mass)[q] / set.field(Field::density)[q];
    exact::State const e = at(x);
    double const p = set.field(Field::pressure)[q];
    add(r.particles, volume, set.field(Field::density)[q] - e.rho, set.field(Field::velocity_x)[q] - e.u, p - e.p);
    add(scale_particles, volume, e.rho, e.u, e.p);
    if (std::abs(x * n - face) < near_bridge && excess(x, p) / scale > r.peak) {
      r.peak = excess(x, p) / scale;
      r.peak_at = x * n;
    }
  });
  for (int i = 0; i < n; ++i) {
    double const x = (i + 0.5) / n;
    exact::State const e = at(x);
    gas::Primitive const s = gas::gather(*alone.gas, {{i, 0, 0}})[0];
    bool const inside = w.regions.front().bridge->region().inside({i, 0, 0});
    add(inside ? r.particles_alone : r.alone, 1.0, s.density - e.rho, s.velocity[0] - e.u, s.pressure - e.p);
    if (inside) add(scale_inside, 1.0, e.rho, e.u, e.p);
    if (std::abs(i + 0.5 - face) < near_bridge) r.peak_alone = std::max(r.peak_alone, excess(x, s.pressure) / scale);
  }
  for (int k = 0; k < 3; ++k) {
    r.cells[k] /= scale_cells[k];
    r.alone[k] /= scale_cells[k];
    r.particles[k] /= scale_particles[k];
    r.particles_alone[k] /= scale_inside[k];
  }
  run::Totals const& now = w.audit.current;
  run::Totals const& out = w.audit.outflow;
  for (int f = 0; f < 2; ++f) {
    if (before.mass[f] <= 0.0) continue;
    double const drift = (now.mass[f] + out.mass[f] - before.mass[f]) / before.mass[f];
    if (std::abs(drift) > std::abs(r.mass_drift)) r.mass_drift = drift;
  }
  r.energy_drift = (now.energy + out.energy - before.energy) / before.energy;
  r.injected = w.regions.front().bridge->traffic().injected;
  r.absorbed = w.regions.front().bridge->traffic().absorbed;
  return r;
}

/// The four tubes of the table: what, and on which side the region lies. The face at cell 240 (160) is met after the
/// waves have formed, that at 200 is the diaphragm itself.
struct TubeSetting {
  Tube tube;
  Where where;
};

inline std::vector<TubeSetting> all_tubes() {
  std::vector<TubeSetting> all;
  for (Tube const& t : {sod, mirrored(sod), strong, mirrored(strong), rarefaction}) {
    for (Where const where : {Where{240, true}, Where{160, false}}) all.push_back({t, where});
  }
  return all;
}

inline std::string name_of(TubeSetting const& s) {
  return std::string(s.tube.name) + (s.tube.left.p >= s.tube.right.p ? "" : ", mirrored") +
         (s.where.right ? ", region right of " : ", region left of ") + std::to_string(s.where.face);
}

/// Expanded products of TNT on the left, air on the right.
inline Tube const products_and_air{"products and air", {200.0, 0.0, 5e7}, {1.225, 0.0, 101325.0}, 1.1e-4};

inline run::Case two_fluid_case(Where const& where) {
  run::Case c = tube_case(products_and_air, where);
  c.other_fluids.emplace_back();
  c.other_fluids[0].name = "products";
  c.other_fluids[0].eos = material::Jwl{};
  c.initial_states[0].fluid = 1;
  c.numerics.density_floor = 1e-6;
  c.numerics.pressure_floor = 1.0;
  return c;
}

}  // namespace brisance::test
