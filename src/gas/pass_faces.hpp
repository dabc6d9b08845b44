/// Pass of MUSCL-Hancock [VanLeer84]: states at the faces of cells. Piecewise-linear primitive variables, limited,
/// evolved half a step, one Riemann problem per face. Second order in smooth flow, total-variation bounded at jumps.
///
/// Several fluids: besides the volume fractions the closure sum B is reconstructed and evolved, dB/dt = -u dB/dx + (H -
/// B) du/dx, so that the energy at a face follows from p, alpha and B without a new evaluation of the equations of
/// state. A contact with uniform p and u, and uniform density of each fluid, stays uniform: B is then linear in alpha,
/// and the limiter commutes with that.
///
/// Slopes are half the limited difference over a cell: what a face differs by from the cell's centre.
#pragma once

#include <array>
#include <cmath>

#include "core/vector.hpp"
#include "gas/limiters.hpp"
#include "gas/pass_states.hpp"

namespace brisance::gas {

/// The backward and forward differences of a quantity.
template <class V>
struct Differences {
  V backward, forward;
};

/// Where a fluid's own density, or a quantity per mass of it, lies in a cell and those of its neighbours that hold some
/// of that fluid.
template <class V>
struct PhaseRange {
  V least, most;

  template <class Mask>
  PhaseRange(V const& own, V const& below, Mask const& has_below, V const& above, Mask const& has_above) {
    using std::max;
    using std::min;
    V const low = select(has_below, below, own);
    V const high = select(has_above, above, own);
    least = min(own, min(low, high));
    most = max(own, max(low, high));
  }
};

/// A pass over the cells of a bundle that finds the states at their faces.
template <class V, int N, Sums S, bool Radial, bool Walls>
class FacePass {
  static constexpr bool ideal = S == Sums::none;
  static constexpr bool curved = S == Sums::all;
  using Mask = typename Lanes<V>::Mask;

 public:
  FacePass(SweepContext const& s, BundleLayout const& b, BundleArrays& bundle)
      : s_(s), a_(bundle), st_(b.stride), total_(b.total), lambda_(s.dt / s.h), half_beta_(0.5 * s.beta) {}

  /// Returns whether there is a cell beside which a high-order flux may leave an unsound state, see positivity.hpp.
  [[gnu::flatten]] bool run() {
    Mask risks(false);
    int const begin = aligned(st_);
    for (int q = begin; q < total_ - st_; q += Lanes<V>::count) {
      if ((q - begin) % grid::Ahead::line == 0) s_.ahead.fetch((q - begin) / grid::Ahead::line);
      Mask risky = cell(q);
      if (q < st_ || q + Lanes<V>::count > total_ - st_) risky = risky & lanes_within<V>(q, st_, total_ - st_);
      risks = risks | risky;
    }
    return any(risks);
  }

 private:
  [[nodiscard]] V load(int name, int q) const { return Lanes<V>::load(a_[name] + q); }
  void store(int name, int q, V const& x) const { Lanes<V>::store(a_[name] + q, x); }

  /// `Sign` is -1 for the velocity along the sweep: beside an obstacle the neighbour is the cell's own mirror image.
  template <int Sign = 1>
  [[nodiscard]] Differences<V> differences(int name, int q, V const& own) const {
    V back = own - load(name, q - st_);
    V forth = load(name, q + st_) - own;
    if constexpr (Walls) {
      V const mirrored = (1.0 - Sign) * own;
      back += load(a_solid, q - st_) * (mirrored - back);
      forth -= load(a_solid, q + st_) * (mirrored + forth);
    }
    return {back, forth};
  }
  [[nodiscard]] V slope(Differences<V> const& d) const { return limited_half(d.backward, d.forward, half_beta_); }
  [[nodiscard]] V slope(Differences<V> const& d, Mask const& contact, bool any_contact) const {
    V const smooth = limited_half(d.backward, d.forward, half_beta_);
    return any_contact ? select(contact, compressed_half(d.backward, d.forward), smooth) : smooth;
  }

  /// Does the density jump and the pressure not, neither between the neighbours nor from them to the cell itself
  /// (explosive that has just been lit stands between two cells of low pressure)? A contact is smeared for good, for
  /// nothing in the flow steepens it again; what jumps with it is kept together by the compressive limiter.
  /// Thresholds: contact steepening of [ColellaWoodward84].
  [[nodiscard]] Mask is_contact(int q, V const& least, V const& most) const {
    using std::abs;
    using std::min;
    V const below = density_at<V, N>(a_, q - st_);
    V const above = density_at<V, N>(a_, q + st_);
    return (abs(above - below) > 0.1 * min(below, above)) & (most - least < 0.05 * least);
  }

  /// Beside which cells may fluxes have to be limited? Where the pressure is steep, and where the kinetic energy times
  /// xi is `cold_flow` margins; at an axis or centre, where a wave empties a cell two or three times as fast.
  [[nodiscard]] Mask is_risky(int q, V const& least, V const& most, V const& p, ClosureAt<V, S> const& c) const {
    using std::abs;
    V const E = load(energy, q);
    Mask risky = most > steep_pressure * least;
    if constexpr (ideal) {
      double const x = 1.0 / (s_.gamma - 1.0);
      risky = risky | (E > (x + cold_flow * (x + 1.0) / x) * p);
    } else {
      risky = risky | ((c.minus_B(E) - p * c.xi) * c.xi > cold_flow * c.margin_of(p, c.xi, s_.most_H));
    }
    if constexpr (Radial) risky = risky | (abs(load(a_expansion, q)) > 0.5 * lambda_);
    return risky;
  }

  /// Where the own density of a fluid is to be bounded: where that fluid is the lesser part and its density differs
  /// from that of the neighbours that hold some of it, in all by more than 1 %.
  struct Uneven {
    Mask found, has_below, has_above;
  };
  [[nodiscard]] Uneven find_uneven(int q, int fluid) const {
    using std::abs;
    constexpr double lesser_part = 0.5;
    constexpr double even = 0.01;
    int const rows = partial_density(fluid);
    int const fractions = volume_fraction(fluid);
    V const own = load(fractions, q);
    V const partial = load(rows, q);
    Mask const lesser = (own > vanishing_fraction) & (own <= lesser_part) & (partial > 0.0);
    if (!any(lesser)) return {Mask(false), Mask(false), Mask(false)};
    Mask const below = load(fractions, q - st_) > vanishing_fraction;
    Mask const above = load(fractions, q + st_) > vanishing_fraction;
    // Multiplied by the three volume fractions, for a division is dear.
    V const alpha_below = select(below, load(fractions, q - st_), own);
    V const alpha_above = select(above, load(fractions, q + st_), own);
    V const partial_below = select(below, load(rows, q - st_), partial);
    V const partial_above = select(above, load(rows, q + st_), partial);
    V const step_below = abs(partial_below * own - partial * alpha_below) * alpha_above;
    V const step_above = abs(partial_above * own - partial * alpha_above) * alpha_below;
    Mask const found = lesser & (step_below + step_above > even * partial * alpha_below * alpha_above);
    return {found, Mask(below & (load(rows, q - st_) > 0.0)), Mask(above & (load(rows, q + st_) > 0.0))};
  }

  /// What is reconstructed in a cell: its values, their slopes, or their changes over half a step. B only where there
  /// are reference curves.
  struct Values {
    std::array<V, N> partial;
    std::array<V, N> alpha;  ///< of the fluids from number 1 on
    V u, v, w, p, B;

    /// Calls use(value) for all of them.
    template <class Use>
    void each(Use const& use) {
      for_fluids<0, N>([&](int k) { use(partial[k]); });
      for_fluids<1, N>([&](int k) { use(alpha[k]); });
      for (V* const x : {&u, &v, &w, &p, &B}) use(*x);
    }
    [[nodiscard]] V density() const {
      V rho = partial[0];
      for_fluids<1, N>([&](int k) { rho += partial[k]; });
      return rho;
    }
  };

  [[nodiscard]] Values values(int q) const {
    Values x;
    for_fluids<0, N>([&](int k) { x.partial[k] = load(partial_density(k), q); });
    for_fluids<1, N>([&](int k) { x.alpha[k] = load(volume_fraction(k), q); });
    x.u = load(a_u, q);
    x.v = load(a_v, q);
    x.w = load(a_w, q);
    x.p = load(a_p, q);
    x.B = curved ? load(a_B, q) : V(0.0);
    return x;
  }

  [[nodiscard]] Values slopes(int q, Values const& x, Mask const& contact) const {
    bool const any_contact = any(contact);
    Values d;
    for_fluids<0, N>(
        [&](int k) { d.partial[k] = slope(differences(partial_density(k), q, x.partial[k]), contact, any_contact); });
    for_fluids<1, N>(
        [&](int k) { d.alpha[k] = slope(differences(volume_fraction(k), q, x.alpha[k]), contact, any_contact); });
    d.u = slope(differences<-1>(a_u, q, x.u));
    d.v = slope(differences(a_v, q, x.v));
    d.w = slope(differences(a_w, q, x.w));
    d.p = slope(differences(a_p, q, x.p));
    d.B = curved ? slope(differences(a_B, q, x.B), contact, any_contact) : V(0.0);
    if (s_.flattened) {
      V const share = load(a_share, q);
      V const own = d.B;
      d.each([&share](V& slope) { slope *= share; });
      if constexpr (N == 1) d.B = own;
    }
    return d;
  }

  /// The changes over half a step; `div`: dt/2 div u.
  [[nodiscard]] Values half_step(int q, Values const& x, Values const& d, ClosureAt<V, S> const& c,
                                 V const& div) const {
    V const advance = lambda_ * x.u;
    V modulus;
    if constexpr (ideal)
      modulus = s_.gamma * x.p;
    else
      modulus = x.p + c.plus_H(x.p) * load(a_inverse_xi, q);
    Values t;
    for_fluids<0, N>([&](int k) { t.partial[k] = -(advance * d.partial[k] + x.partial[k] * div); });
    for_fluids<1, N>([&](int k) { t.alpha[k] = -(advance * d.alpha[k]); });
    t.p = -(advance * d.p + modulus * div);
    t.u = -(advance * d.u + lambda_ * d.p * load(a_inverse, q));
    t.v = -(advance * d.v);
    t.w = -(advance * d.w);
    t.B = curved ? (c.H - x.B) * div - advance * d.B : V(0.0);
    return t;
  }

  /// Where a face would be left without density or stiffness a cell falls back to its own state at its faces; and where
  /// explosive burns, for there the pressure is no function of the neighbours' energy.
  [[nodiscard]] Mask has_sound_faces(int q, Values const& x, Values const& d, Values const& t,
                                     ClosureAt<V, S> const& c) const {
    using std::abs;
    V const lowest_p = x.p + t.p - abs(d.p);
    double const lowest_pressure = 0.5 * s_.floors.pressure;
    Mask good = x.density() + t.density() - abs(d.density()) > 0.5 * s_.floors.density;
    if constexpr (ideal) {
      good = good & (lowest_p > lowest_pressure);
    } else {
      good = good & (c.margin_of(lowest_p, c.xi, s_.most_H) > lowest_pressure * (c.xi + 1.0));
      if constexpr (N > 1) {
        // xi changes with the volume fractions.
        V const advance = lambda_ * x.u;
        V most_xi = c.xi;
        for_fluids<1, N>([&](int k) { most_xi += std::abs(s_.xi_slope[k]) * (1.0 + abs(advance)) * abs(d.alpha[k]); });
        good = good & (c.margin_of(lowest_p, most_xi, s_.most_H) > lowest_pressure * (most_xi + 1.0));
        V const round_off = -1e-13 * x.density();
        for_fluids<0, N>([&](int k) { good = good & (x.partial[k] + t.partial[k] - abs(d.partial[k]) >= round_off); });
        if (s_.burning) good = good & (load(a_burn, q) >= 1.0);
      }
    }
    return good;
  }

  Mask cell(int q) const {
    using std::max;
    using std::min;
    Values const x = values(q);
    ClosureAt<V, S> const closure(s_, a_, q);
    V const least = min(x.p, min(load(a_p, q - st_), load(a_p, q + st_)));
    V const most = max(x.p, max(load(a_p, q - st_), load(a_p, q + st_)));
    Mask const risky = is_risky(q, least, most, x.p, closure);
    Values d = slopes(q, x, is_contact(q, least, most));
    V div = lambda_ * d.u;
    if constexpr (Radial) div += load(a_expansion, q) * x.u;
    Values t = half_step(q, x, d, closure, div);
    Mask const good = has_sound_faces(q, x, d, t, closure);
    if (!all(good)) {
      auto const keep = [&good](V& value) { value = select(good, value, V(0.0)); };
      d.each(keep);
      t.each(keep);
      keep(div);
    }
    auto const put = [&](int value, V const& middle, V const& half) {
      store(a_left + value, q, middle + half);
      store(a_right + value, q, middle - half);
    };
    put(f_u, x.u + t.u, d.u);
    put(f_v, x.v + t.v, d.v);
    put(f_w, x.w + t.w, d.w);
    put(f_p, x.p + t.p, d.p);
    if constexpr (Radial) store(a_p_half, q, x.p + t.p);
    put_thermal_state(q, x, d, t, closure, div);
    return risky;
  }

  /// Densities, volume fractions, internal energy and speed of sound at the faces.
  void put_thermal_state(int q, Values const& x, Values const& d, Values const& t, ClosureAt<V, S> const& c,
                         V const& div) const {
    V const L_p = x.p + t.p + d.p;
    V const R_p = x.p + t.p - d.p;
    std::array<V, N> L_partial;
    std::array<V, N> R_partial;
    for_fluids<0, N>([&](int k) {
      L_partial[k] = x.partial[k] + t.partial[k] + d.partial[k];
      R_partial[k] = x.partial[k] + t.partial[k] - d.partial[k];
    });
    V L_rho = L_partial[0];
    V R_rho = R_partial[0];
    if constexpr (ideal) {
      put_sound(q, s_.gamma * L_p, L_rho, s_.gamma * R_p, R_rho);
    } else {
      V L_B(0.0);
      V R_B(0.0);
      if constexpr (curved) {
        L_B = x.B + t.B + d.B;
        R_B = x.B + t.B - d.B;
      }
      V L_xi = c.xi;
      V R_xi = c.xi;
      for_fluids<1, N>([&](int k) {
        V L_alpha = x.alpha[k] + t.alpha[k] + d.alpha[k];
        V R_alpha = x.alpha[k] + t.alpha[k] - d.alpha[k];
        L_xi += (L_alpha - x.alpha[k]) * s_.xi_slope[k];
        R_xi += (R_alpha - x.alpha[k]) * s_.xi_slope[k];
        Uneven uneven{Mask(false), Mask(false), Mask(false)};
        if (s_.bounded_phase) uneven = find_uneven(q, k);
        bool const bounded = any(uneven.found);
        if (bounded) bound_density(q, k, uneven, div, L_alpha, R_alpha, L_partial[k], R_partial[k]);
        // A fluid that all but vanished is not carried on: the diffuse interface ends here.
        drop_vanished(L_alpha, L_partial[k]);
        drop_vanished(R_alpha, R_partial[k]);
        if (curved && bounded) {
          Mask const held = uneven.found & (x.partial[k] + t.partial[k] > 0.0);
          bound_energy(q, k, uneven, held, c.H / x.partial[k] * div, L_partial[k], R_partial[k], L_B, R_B);
        }
        store(a_left + f_alpha(k), q, L_alpha);
        store(a_right + f_alpha(k), q, R_alpha);
        L_rho += L_partial[k];
        R_rho += R_partial[k];
      });
      store(a_left + f_rho_e, q, curved ? L_p * L_xi + L_B : L_p * L_xi);
      store(a_right + f_rho_e, q, curved ? R_p * R_xi + R_B : R_p * R_xi);
      put_sound(q, c.plus_H(L_p * (L_xi + 1.0)), L_xi * L_rho, c.plus_H(R_p * (R_xi + 1.0)), R_xi * R_rho);
    }
    for_fluids<0, N>([&](int k) {
      store(a_left + f_partial(k), q, L_partial[k]);
      store(a_right + f_partial(k), q, R_partial[k]);
    });
  }

  /// Speeds of sound at the two faces, whose squares are L_p / L_rho and R_p / R_rho: one division does for both.
  void put_sound(int q, V const& L_p, V const& L_rho, V const& R_p, V const& R_rho) const {
    using std::sqrt;
    V const both = 1.0 / (L_rho * R_rho);
    store(a_left + f_c, q, sqrt(L_p * R_rho * both));
    store(a_right + f_c, q, sqrt(R_p * L_rho * both));
  }

  static void drop_vanished(V& alpha, V& partial) {
    auto const present = alpha > vanishing_fraction;
    alpha = select(present, alpha, V(0.0));
    partial = select(present, partial, V(0.0));
  }

  /// Keeps a fluid's own density, partial density over volume fraction, at the faces of a cell between those of the
  /// cell and its neighbours, compressed by the half step. The two are limited independently, and where both fade out
  /// their ratio would drift away: a thousandth of the products then stands in the air at more than the density of the
  /// explosive, where its reference curve has no meaning, and the air beside it gets hot enough to run ahead of the
  /// shock. With fine cells and short steps it drifts farthest.
  void bound_density(int q, int fluid, Uneven const& uneven, V const& squeeze, V const& L_alpha, V const& R_alpha,
                     V& L_partial, V& R_partial) const {
    auto const own = [&](int n) { return load(partial_density(fluid), n) / load(volume_fraction(fluid), n); };
    PhaseRange<V> const range(own(q), own(q - st_), uneven.has_below, own(q + st_), uneven.has_above);
    V const compressed = 1.0 - squeeze;
    V const least = range.least * compressed;
    V const most = range.most * compressed;
    L_partial = select(uneven.found, clamp(L_partial, L_alpha * least, L_alpha * most), L_partial);
    R_partial = select(uneven.found, clamp(R_partial, R_alpha * least, R_alpha * most), R_partial);
  }

  /// The closure sum B, the energy of that fluid's reference curve, goes with its density: bounded alone the two would
  /// not fit each other and leave a thin hot layer with every step. Per mass of the fluid B stays between that of the
  /// cell and its neighbours, compressed by the half step. No other fluid may have a reference curve.
  void bound_energy(int q, int fluid, Uneven const& uneven, Mask const& held, V const& shift, V const& L_partial,
                    V const& R_partial, V& L_B, V& R_B) const {
    static_assert(most_fluids == 2, "what B is of each of several fluids would have to be known");
    auto const own = [&](int n) { return load(a_B, n) / load(partial_density(fluid), n); };
    PhaseRange<V> const range(own(q), own(q - st_), uneven.has_below, own(q + st_), uneven.has_above);
    V const least = range.least + shift;
    V const most = range.most + shift;
    L_B = select(held, clamp(L_B, L_partial * least, L_partial * most), L_B);
    R_B = select(held, clamp(R_B, R_partial * least, R_partial * most), R_B);
  }
  [[nodiscard]] static V clamp(V const& x, V const& least, V const& most) {
    using std::max;
    using std::min;
    return min(max(x, least), most);
  }

  SweepContext const s_;
  Arrays const a_;
  int st_;
  int total_;
  V lambda_;
  V half_beta_;
};

}  // namespace brisance::gas
