/// Pass of MUSCL-Hancock: fluxes from the states on both sides of every face.
#pragma once

#include <array>
#include <cmath>

#include "core/vector.hpp"
#include "gas/pass_states.hpp"
#include "gas/riemann/hll.hpp"
#include "gas/riemann/hllc.hpp"

namespace brisance::gas {

/// The state beside a face.
template <class V, int N>
struct FaceState {
  std::array<V, N> partial;
  std::array<V, N> alpha;  ///< of the fluids from number 1 on
  V u, v, w, p, rho_e, c;

  [[nodiscard]] FaceSideOf<V> side() const {
    V rho = partial[0];
    for_fluids<1, N>([&](int k) { rho += partial[k]; });
    return {rho, u, p, rho_e + 0.5 * rho * (u * u + v * v + w * w), c};
  }
  /// Takes the mirror image of another state where a mask says so.
  template <class Mask>
  void mirror(Mask const& where, FaceState const& other) {
    auto const take = [&](V& own, V const& from) { own = select(where, from, own); };
    for_fluids<0, N>([&](int k) { take(partial[k], other.partial[k]); });
    for_fluids<1, N>([&](int k) { take(alpha[k], other.alpha[k]); });
    take(u, -other.u);
    take(v, other.v);
    take(w, other.w);
    take(p, other.p);
    take(rho_e, other.rho_e);
    take(c, other.c);
  }
};

/// The state that a cell has at its face: `a_left` at the high one, `a_right` at the low one.
template <class V, int N, Sums S>
[[nodiscard]] inline FaceState<V, N> face_state(SweepContext const& s, Arrays const& a, int first, int q) {
  auto const load = [&](int value) { return Lanes<V>::load(a[first + value] + q); };
  FaceState<V, N> f;
  for_fluids<0, N>([&](int k) { f.partial[k] = load(f_partial(k)); });
  for_fluids<1, N>([&](int k) { f.alpha[k] = load(f_alpha(k)); });
  f.u = load(f_u);
  f.v = load(f_v);
  f.w = load(f_w);
  f.p = load(f_p);
  f.rho_e = S == Sums::none ? f.p * (1.0 / (s.gamma - 1.0)) : load(f_rho_e);
  f.c = load(f_c);
  return f;
}

/// The left state of face q is that of cell q, the right one that of cell q + stride; beside an obstacle the other side
/// is the mirror image of the fluid in front of it. HLLC, and HLL where the sensor has seen a shock.
template <class V, int N, Sums S, bool Walls>
[[gnu::flatten]] void find_fluxes(SweepContext const& s, BundleLayout const& b, BundleArrays& bundle) {
  using std::max;
  Arrays const a(bundle);
  int const st = b.stride;
  int const along = a_flux + s.normal();
  int const across1 = a_flux + s.transverse1();
  int const across2 = a_flux + s.transverse2();
  auto const load = [&](int name, int q) { return Lanes<V>::load(a[name] + q); };
  auto const store = [&](int name, int q, V const& x) { Lanes<V>::store(a[name] + q, x); };
  for (int q = aligned(st); q < b.total - 2 * st; q += Lanes<V>::count) {
    FaceState<V, N> left = face_state<V, N, S>(s, a, a_left, q);
    FaceState<V, N> right = face_state<V, N, S>(s, a, a_right, q + st);
    if constexpr (Walls) {
      auto const left_solid = load(a_solid, q) > 0.5;
      auto const right_solid = load(a_solid, q + st) > 0.5;
      if (any(left_solid | right_solid)) {
        FaceState<V, N> const before = left;
        left.mirror(left_solid & !right_solid, right);
        right.mirror(right_solid & !left_solid, before);
      }
    }
    FaceSideOf<V> const L = left.side();
    FaceSideOf<V> const R = right.side();
    HllcFluxOf<V> const f = hllc(L, R);
    auto const upwind = [&f](V const& l, V const& r) { return select(f.from_left, l, r); };
    V const mass = f.speed * upwind(L.rho, R.rho);
    std::array<V, N> partial;
    std::array<V, N> alpha;
    for_fluids<0, N>([&](int k) { partial[k] = f.speed * upwind(left.partial[k], right.partial[k]); });
    for_fluids<1, N>([&](int k) { alpha[k] = f.speed * upwind(left.alpha[k], right.alpha[k]); });
    V momentum = f.momentum;
    V v = mass * upwind(left.v, right.v);
    V w = mass * upwind(left.w, right.w);
    V total = f.energy;
    V speed = f.speed;
    if (s.shock_sensor) {
      auto const shocked = max(load(shock, q), load(shock, q + st)) > 0.2;
      if (any(shocked)) {
        HllFluxOf<V> const h = hll(L, R);
        auto const carried = [&h](V const& l, V const& r) { return h.from_left * l + h.from_right * r; };
        auto const take = [&shocked](V& own, V const& other) { own = select(shocked, other, own); };
        for_fluids<0, N>([&](int k) { take(partial[k], carried(left.partial[k], right.partial[k])); });
        for_fluids<1, N>([&](int k) { take(alpha[k], carried(left.alpha[k], right.alpha[k])); });
        take(momentum, carried(L.rho * L.u, R.rho * R.u) + h.pressure);
        take(v, carried(L.rho * left.v, R.rho * right.v));
        take(w, carried(L.rho * left.w, R.rho * right.w));
        take(total, carried(L.E, R.E) + h.work);
        take(speed, h.from_left + h.from_right);
      }
    }
    for_fluids<0, N>([&](int k) { store(a_flux + partial_density(k), q, partial[k]); });
    for_fluids<1, N>([&](int k) { store(a_flux + volume_fraction(k), q, alpha[k]); });
    store(along, q, momentum);
    store(across1, q, v);
    store(across2, q, w);
    store(a_flux + energy, q, total);
    store(a_face_speed, q, speed);
  }
}

}  // namespace brisance::gas
