/// Passes: primitive variables, shock sensor, update, pressure and wave speeds.
#pragma once

#include <cmath>

#include "core/vector.hpp"
#include "gas/kernels.hpp"
#include "gas/passes.hpp"

namespace brisance::gas {

/// The closure sums of a cell: those that stand in arrays, and constants.
template <class V, Sums S>
struct ClosureAt {
  V xi;
  V B = V(0.0);
  V H = V(0.0);

  ClosureAt(SweepContext const& s, Arrays const& a, int q) {
    xi = S == Sums::none ? V(1.0 / (s.gamma - 1.0)) : Lanes<V>::load(a[a_xi] + q);
    if constexpr (S == Sums::all) {
      B = Lanes<V>::load(a[a_B] + q);
      H = Lanes<V>::load(a[a_H] + q);
    }
  }
  /// Terms that are 0 are left out: the compiler may not.
  [[nodiscard]] V minus_B(V const& x) const {
    if constexpr (S == Sums::all)
      return x - B;
    else
      return x;
  }
  [[nodiscard]] V plus_H(V const& x) const {
    if constexpr (S == Sums::all)
      return x + H;
    else
      return x;
  }
  /// `margin` of a state with this H.
  [[nodiscard]] V margin_of(V const& p, V const& with_xi, double most_H) const {
    if constexpr (S == Sums::all)
      return margin(p, with_xi, H, V(most_H));
    else
      return p * (with_xi + 1.0);
  }
};

/// Where a loop from cell q on begins for its vectors to lie on lines of the cache: up to a vector earlier. What is
/// calculated there is never used.
[[nodiscard]] constexpr int aligned(int q) { return q / 8 * 8; }

/// The lanes of a vector from cell q on that lie in [begin, end).
template <class V>
[[nodiscard]] auto lanes_within(int q, int begin, int end) {
  if constexpr (Lanes<V>::count == 1) {
    return q >= begin && q < end;
  } else {
    alignas(64) static constexpr std::array<double, 8> numbers{0, 1, 2, 3, 4, 5, 6, 7};
    V const lane = Lanes<V>::load(numbers.data());
    return (lane >= V(static_cast<double>(begin - q))) & (lane < V(static_cast<double>(end - q)));
  }
}

/// Density of the mixture.
template <class V, int N>
[[nodiscard]] V density_at(Arrays const& a, int q) {
  V rho = Lanes<V>::load(a[partial_density(0)] + q);
  for_fluids<1, N>([&](int k) { rho += Lanes<V>::load(a[partial_density(k)] + q); });
  return rho;
}

/// Are states above the floors of density and of `margin`? False for anything that is no number.
template <class V>
struct SoundStates {
  V density, pressure;
  double most_H;

  explicit SoundStates(SweepContext const& s)
      : density(0.999999 * s.floors.density), pressure(0.999999 * s.floors.pressure), most_H(s.most_H) {}

  template <Sums S>
  [[nodiscard]] auto check(V const& rho, V const& p, ClosureAt<V, S> const& c) const {
    if constexpr (S == Sums::none) {
      return (rho >= density) & (p >= pressure);
    } else {
      return (rho >= density) & (c.margin_of(p, c.xi, most_H) >= pressure * (c.xi + 1.0));
    }
  }
};

/// 1/rho and, of one that is no constant, 1/xi: a division costs as much as ten products, and one will do for both.
template <Sums S, class V>
inline void inverses(V const& rho, V const& xi, V& inverse_rho, V& inverse_xi) {
  if constexpr (S == Sums::none) {
    inverse_rho = 1.0 / rho;
  } else {
    V const both = 1.0 / (rho * xi);
    inverse_rho = xi * both;
    inverse_xi = rho * both;
  }
}

template <class V, int N, Sums S>
[[gnu::flatten]] bool find_primitives(SweepContext const& s, int begin, int count, BundleArrays& bundle) {
  Arrays const a(bundle);
  auto const load = [](double const* from) { return Lanes<V>::load(from); };
  auto const store = [](double* to, V const& x) { Lanes<V>::store(to, x); };
  double const* const E = a[energy];
  double const* const mu = a[s.normal()];
  double const* const mv = a[s.transverse1()];
  double const* const mw = a[s.transverse2()];
  V const gruneisen(s.gamma - 1.0);
  SoundStates<V> const floors(s);
  typename Lanes<V>::Mask sound(true);
  for (int q = begin; q < begin + count; q += Lanes<V>::count) {
    V const rho = density_at<V, N>(a, q);
    ClosureAt<V, S> const c(s, a, q);
    V r;
    V inverse_xi;
    inverses<S>(rho, c.xi, r, inverse_xi);
    V const m = load(mu + q);
    V const n = load(mv + q);
    V const o = load(mw + q);
    V const u = m * r;
    V const v = n * r;
    V const w = o * r;
    V const rho_e = load(E + q) - 0.5 * (m * u + n * v + o * w);
    V p;
    if constexpr (S == Sums::none)
      p = gruneisen * rho_e;
    else
      p = c.minus_B(rho_e) * inverse_xi;
    store(a[a_inverse] + q, r);
    if constexpr (S != Sums::none) store(a[a_inverse_xi] + q, inverse_xi);
    store(a[a_u] + q, u);
    store(a[a_v] + q, v);
    store(a[a_w] + q, w);
    store(a[a_p] + q, p);
    sound = sound & floors.check(rho, p, c);
  }
  return all(sound);
}

/// A cell remembers a shock for the next sweeps, whatever their direction, because the carbuncle grows along the shock.
template <class V>
[[gnu::flatten]] void find_shocks(BundleLayout const& b, BundleArrays& bundle) {
  using std::abs;
  using std::min;
  Arrays const a(bundle);
  int const st = b.stride;
  auto const load = [&](int name, int q) { return Lanes<V>::load(a[name] + q); };
  for (int q = aligned(st); q < b.total - st; q += Lanes<V>::count) {
    V const below = load(a_p, q - st);
    V const above = load(a_p, q + st);
    V const least = min(below, min(load(a_p, q), above));
    auto const shocked = (abs(above - below) > 0.5 * abs(least)) & (load(a_u, q - st) > load(a_u, q + st));
    V const before = load(shock, q);
    V const kept = select(before > 0.3, 0.5 * before, V(0.0));
    Lanes<V>::store(a[a_sensor] + q, select(shocked, V(1.0), kept));
  }
}

template <class V, int N, bool Radial, bool Walls>
[[gnu::flatten]] void update_states(SweepContext const& s, BundleLayout const& b, BundleArrays& bundle) {
  Arrays const a(bundle);
  int const st = b.stride;
  auto const load = [&](int name, int q) { return Lanes<V>::load(a[name] + q); };
  V const lambda(s.dt / s.h);
  for (int r = 0; r < b.rows; ++r) {
    int const end = b.begin(r) + b.count();
    for (int q = b.begin(r); q < end; q += Lanes<V>::count) {
      bool const whole = q + Lanes<V>::count <= end;
      V const high = Radial ? load(a_area_high, q) : lambda;
      V const low = Radial ? load(a_area_low, q) : lambda;
      auto const put = [&](int name, V const& before, V change) {
        if constexpr (Walls) change = select(load(a_solid, q) > 0.5, V(0.0), change);
        V after = before - change;
        if (!whole) after = select(lanes_within<V>(q, q, end), after, before);
        Lanes<V>::store(a[name] + q, after);
      };
      auto const difference = [&](int flux) {
        V const above = load(flux, q);
        V const below = load(flux, q - st);
        return Radial ? high * above - low * below : lambda * (above - below);
      };
      for_fluids<1, N>([&](int k) {
        // d(alpha)/dt + u d(alpha)/dx = 0, as a flux minus alpha times the divergence of the face velocities
        // [JohnsenColonius06].
        V const alpha = load(volume_fraction(k), q);
        V const above = load(a_flux + volume_fraction(k), q) - alpha * load(a_face_speed, q);
        V const below = load(a_flux + volume_fraction(k), q - st) - alpha * load(a_face_speed, q - st);
        put(volume_fraction(k), alpha, high * above - low * below);
        put(partial_density(k), load(partial_density(k), q), difference(a_flux + partial_density(k)));
      });
      if (N > 1 && s.progress) put(a_progress, load(a_progress, q), difference(a_progress_flux));
      for (int const c : {partial_density(0), s.transverse1(), s.transverse2(), energy}) {
        put(c, load(c, q), difference(a_flux + c));
      }
      // The pressure in the flux acts on the difference to the cell's own: uniform pressure then leaves a ring or shell
      // exactly at rest.
      int const n = s.normal();
      if constexpr (Radial) {
        V const own = load(a_p_half, q);
        put(n, load(n, q), high * (load(a_flux + n, q) - own) - low * (load(a_flux + n, q - st) - own));
      } else {
        put(n, load(n, q), difference(a_flux + n));
      }
    }
  }
}

template <class V, int N, Sums S>
[[gnu::flatten]] Signals find_signals(SweepContext const& s, int begin, int count, int dimensions,
                                      BundleArrays& bundle) {
  using std::abs;
  using std::max;
  using std::sqrt;
  Arrays const a(bundle);
  auto const load = [&](int name, int q) { return Lanes<V>::load(a[name] + q); };
  V const use_y(dimensions > 1 ? 1.0 : 0.0);
  V const use_z(dimensions > 2 ? 1.0 : 0.0);
  SoundStates<V> const floors(s);
  V fastest(0.0);
  typename Lanes<V>::Mask sound(true);
  for (int q = begin; q < begin + count; q += Lanes<V>::count) {
    V const rho = density_at<V, N>(a, q);
    ClosureAt<V, S> const closure(s, a, q);
    V inverse;
    V inverse_xi;
    inverses<S>(rho, closure.xi, inverse, inverse_xi);
    V const mx = load(momentum_x, q);
    V const my = load(momentum_y, q);
    V const mz = load(momentum_z, q);
    V const rho_e = load(energy, q) - 0.5 * (mx * mx + my * my + mz * mz) * inverse;
    V p;
    V modulus;
    if constexpr (S == Sums::none) {
      p = (s.gamma - 1.0) * rho_e;
      modulus = s.gamma * p;
    } else {
      p = closure.minus_B(rho_e) * inverse_xi;
      modulus = p + closure.plus_H(p) * inverse_xi;
    }
    V const c = sqrt(max(V(0.0), modulus) * inverse);
    V const flow = max(abs(mx), max(use_y * abs(my), use_z * abs(mz)));
    V signal = flow * inverse + c;
    auto good = floors.check(rho, p, closure);
    if (q + Lanes<V>::count > begin + count) {
      auto const own = lanes_within<V>(q, q, begin + count);
      signal = select(own, signal, V(0.0));
      good = good | !own;
    }
    Lanes<V>::store(a[a_p] + q, p);
    // A signal that is no number is passed over: the state is unsound.
    fastest = select(signal > fastest, signal, fastest);
    sound = sound & good;
  }
  std::array<double, 8> each{};
  Lanes<V>::store(each.data(), fastest);
  Signals found;
  for (double const x : each) found.fastest = x > found.fastest ? x : found.fastest;
  found.sound = all(sound);
  return found;
}

}  // namespace brisance::gas
