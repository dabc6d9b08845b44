/// Keeps cells sound by construction: where the flow is violent the flux through a face is blended with a first-order
/// one, as far as needed, the same for both sides of the face.
///
/// An update along one direction is a mean of two half updates, one per face [PerthameShu96], [ZhangShu10]:
///     U_new = w_h V_h + w_l V_l,   w_h + w_l = 1,
///     V_h = U + S - (l_h / w_h) (F_h - f(U)),   V_l = U + S + (l_l / w_l) (F_l - f(U)),
/// l = dt A / volume, f(U) the flux of the cell's own state, S = -(l_h - l_l) (f(U) - p n) the spreading of a radial
/// flow. The weights follow the waves that enter the cell: with the HLL flux V is a mean of U and of the solution of
/// the Riemann problem as long as the waves cross at most one cell. The set of sound states (partial densities not
/// negative, volume fraction within 0 and 1, thermal energy not negative) is convex, so if both V are sound, so is the
/// new state. F = F_first + theta (F_high - F_first) with the largest theta for which both V beside the face are sound
/// [HuAdamsShu13]; the volume fraction and the speed of the face are blended alike. Everything that a face needs lies
/// within two cells of it: blocks agree without asking one another.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/loops.hpp"
#include "gas/kernels.hpp"
#include "gas/primitives.hpp"
#include "gas/riemann/hll.hpp"

namespace brisance::gas {

/// Marks the cells beside which fluxes are checked in `a_risk`. Returns how many there are.
inline long mark_risks(SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
  int const st = b.stride;
  double const most_H = s.most_H;
  double const* const p = a[a_p];
  double const* const E = a[energy];
  double const* const xi = a[a_xi];
  double const* const B = a[a_B];
  double const* const H = a[a_H];
  double const* const expansion = a[a_expansion];
  double* const risk = a[a_risk];
  double const fast = s.radial ? 0.5 * s.dt / s.h : 0.0;
  long risks = 0;
  for (int q = st; q < b.total - st; ++q) {
    double const least = std::min(p[q], std::min(p[q - st], p[q + st]));
    double const most = std::max(p[q], std::max(p[q - st], p[q + st]));
    bool const cold = (E[q] - B[q] - p[q] * xi[q]) * xi[q] > cold_flow * margin(p[q], xi[q], H[q], most_H);
    bool const risky = (most > steep_pressure * least) || cold || (s.radial && std::abs(expansion[q]) > fast);
    risk[q] = risky ? 1.0 : 0.0;
    risks += risky ? 1 : 0;
  }
  return risks;
}

/// A state of a cell, or a flux, in the directions of the sweep.
struct Flow {
  PerFluid partial{};
  PerFluid alpha{};  ///< of the fluids from number 1 on
  double mu, mv, mw, E, speed;
};

/// The limiter of one bundle.
template <int N>
class FluxLimiter {
 public:
  FluxLimiter(SweepContext const& s, BundleLayout const& b, BundleArrays& a) : s_(s), st_(b.stride), a_(a) {}

  /// Limits the flux through face q. True if it was changed.
  bool limit(int q) {
    int const r = q + st_;
    bool const left_solid = is_solid(q);
    bool const right_solid = is_solid(r);
    if (left_solid && right_solid) return false;
    Side const L = side(left_solid ? r : q, left_solid);
    Side const R = side(right_solid ? q : r, right_solid);
    Speeds speeds = waves(L.motion, R.motion);
    // The waves that enter each cell through its other face.
    double const from_below = left_solid ? 0.0 : std::max(0.0, face_waves(q - st_).high);
    double const from_above = right_solid ? 0.0 : std::max(0.0, -face_waves(r).low);
    double const lh = s_.radial ? a_[a_area_high][q] : s_.dt / s_.h;
    double const ll = s_.radial ? a_[a_area_low][r] : s_.dt / s_.h;
    // Factors of F - f(U) in the half updates; 0 where there is no cell.
    double const kL =
        left_solid ? 0.0 : lh / weight(lh * std::max(0.0, -speeds.low), lh * from_below, has_area(q, a_area_low));
    double const kR =
        right_solid ? 0.0 : ll / weight(ll * std::max(0.0, speeds.high), ll * from_above, has_area(r, a_area_high));
    auto const left_margins = [&](Flow const& f) { return kL == 0.0 ? Margins::of_wall() : half_update(L, f, -kL); };
    auto const right_margins = [&](Flow const& f) { return kR == 0.0 ? Margins::of_wall() : half_update(R, f, kR); };

    Flow const high = given(q);
    // The usual case: sound whatever the first-order flux would do.
    if (left_margins(high).reach(L.most_wanted(least(L))) && right_margins(high).reach(R.most_wanted(least(R)))) {
      return false;
    }
    Flow first = hll_flux(L, R, speeds);
    // An estimate of the speeds that was too small shows: raise them up to what the grid can follow.
    constexpr int most_raises = 12;
    for (int n = 0; n < most_raises && !(left_margins(first).exceed(least(L)) && right_margins(first).exceed(least(R)));
         ++n) {
      double const grid_low = kL > 0.0 ? -1.0 / kL : -1.0 / kR;
      double const grid_high = kR > 0.0 ? 1.0 / kR : 1.0 / kL;
      if (speeds.low <= grid_low && speeds.high >= grid_high) break;
      speeds.low = std::max(std::min(speeds.low * 1.5, -0.1 * speeds.high), std::min(speeds.low, grid_low));
      speeds.high = std::min(std::max(speeds.high * 1.5, -0.1 * speeds.low), std::max(speeds.high, grid_high));
      first = hll_flux(L, R, speeds);
    }
    Margins const left_bounds = L.bounds(left_margins(first), least(L));
    Margins const right_bounds = R.bounds(right_margins(first), least(R));
    auto const sound = [&](Flow const& f) {
      return left_margins(f).reach(left_bounds) && right_margins(f).reach(right_bounds);
    };
    if (sound(high)) return false;
    double low_theta = 0.0;
    double high_theta = 1.0;
    constexpr int bisections = 6;
    for (int n = 0; n < bisections; ++n) {
      double const theta = 0.5 * (low_theta + high_theta);
      (sound(blend(first, high, theta)) ? low_theta : high_theta) = theta;
    }
    // Nothing of a flux that is no number may remain.
    put(q, low_theta > 0.0 ? blend(first, high, low_theta) : first);
    return true;
  }

 private:
  /// How far a state is from losing its meaning, in two ways [Pa or J/m3].
  struct Margins {
    double pressure;  ///< see `margin`
    double heat;      ///< thermal energy per volume, where no fluid bears tension

    static constexpr double unsound = -1e300;
    static Margins of_nothing() { return {unsound, unsound}; }
    static Margins of_wall() { return {-unsound, -unsound}; }
    [[nodiscard]] bool reach(Margins const& bounds) const { return pressure >= bounds.pressure && heat >= bounds.heat; }
    [[nodiscard]] bool exceed(double least) const { return pressure > least && heat > least; }
  };
  static constexpr double kept = 0.05;  ///< of the margins, by every half update

  /// What of a cell beside a face makes waves.
  struct Motion {
    double u, p, c, density;
  };
  /// A cell beside a face, mirrored or not.
  struct Side {
    Flow U;       ///< its state
    Flow spread;  ///< its state with the spreading of a radial flow
    Motion motion;
    double xi, burn;
    Margins margins;

    /// Margins that every half update should have.
    [[nodiscard]] Margins most_wanted(double least) const {
      return {std::max(least, kept * margins.pressure), std::max(least, kept * margins.heat)};
    }
    /// Margins that a half update may not fall below: a part of the cell's own, or what the first-order flux leaves
    /// where that is less.
    [[nodiscard]] Margins bounds(Margins const& first, double least) const {
      auto const bound = [least](double own, double of_first) {
        return std::max(std::min(of_first, least), kept * std::min(of_first, own));
      };
      return {bound(margins.pressure, first.pressure), bound(margins.heat, first.heat)};
    }
  };
  struct Speeds {
    double low, high;
  };

  [[nodiscard]] bool is_solid(int q) { return s_.solid && a_[a_solid][q] > 0.5; }

  Side side(int q, bool mirrored) {
    double const sign = mirrored ? -1.0 : 1.0;
    Side x;
    for_fluids<0, N>([&](int k) { x.U.partial[k] = a_[partial_density(k)][q]; });
    for_fluids<1, N>([&](int k) { x.U.alpha[k] = a_[volume_fraction(k)][q]; });
    x.U.mu = sign * a_[s_.normal()][q];
    x.U.mv = a_[s_.transverse1()][q];
    x.U.mw = a_[s_.transverse2()][q];
    x.U.E = a_[energy][q];
    x.U.speed = 0.0;
    x.motion = motion(q, mirrored);
    double const p = x.motion.p;
    x.xi = a_[a_xi][q];
    x.burn = s_.burning ? a_[a_burn][q] : 1.0;
    x.margins.pressure = margin(p, x.xi, a_[a_H][q], s_.most_H);
    x.margins.heat = heat(x.U.partial, x.U.alpha, p * x.xi + a_[a_B][q]);
    x.spread = x.U;
    if (s_.radial) {
      double const k = -(a_[a_area_high][q] - a_[a_area_low][q]) * a_[a_u][q];
      for_fluids<0, N>([&](int f) { x.spread.partial[f] += k * x.U.partial[f]; });
      x.spread.mu += k * x.U.mu;
      x.spread.mv += k * x.U.mv;
      x.spread.mw += k * x.U.mw;
      x.spread.E += k * (x.U.E + p);
    }
    return x;
  }

  Motion motion(int q, bool mirrored) {
    double const p = a_[a_p][q];
    double const xi = a_[a_xi][q];
    double const rho = sum_of_fluids<N>([&](int k) { return a_[partial_density(k)][q]; });
    double const square = (p * (xi + 1.0) + a_[a_H][q]) / (xi * rho);
    return {(mirrored ? -1.0 : 1.0) * a_[a_u][q], p, std::sqrt(std::max(0.0, square)), rho};
  }

  /// Bounds of the waves between two states: those of [Davis88], and the shock that the pressure drives into the
  /// lighter side, with the velocity of the contact from the acoustic impedances.
  static Speeds waves(Motion const& L, Motion const& R) {
    double const zL = L.density * L.c;
    double const zR = R.density * R.c;
    double const contact = (zL * L.u + zR * R.u + (L.p - R.p)) / (zL + zR);
    constexpr double slope = 0.6;  // (gamma + 1) / 4 of air
    double const forth = slope * std::max(0.0, contact - R.u);
    double const back = slope * std::max(0.0, L.u - contact);
    double const shock_high = R.u + forth + std::sqrt(R.c * R.c + forth * forth);
    double const shock_low = L.u - back - std::sqrt(L.c * L.c + back * back);
    return {std::min(shock_low, R.u - R.c), std::max(shock_high, L.u + L.c)};
  }

  Speeds face_waves(int q) {
    int const r = q + st_;
    bool const left_solid = is_solid(q);
    bool const right_solid = is_solid(r);
    return waves(motion(left_solid ? r : q, left_solid), motion(right_solid ? q : r, right_solid));
  }

  /// Has the cell's face an area? An axis or centre has none.
  [[nodiscard]] bool has_area(int q, int areas) { return !s_.radial || a_[areas][q] != 0.0; }

  /// Share of a face in the update of a cell: what its waves need, and half of what is left.
  static double weight(double own, double other, bool other_has_area) {
    if (!other_has_area) return 1.0;
    double const sum = own + other;
    double const share = sum >= 1.0 ? own / sum : own + 0.5 * (1.0 - sum);
    return std::min(0.8, std::max(0.2, share));
  }

  Flow given(int q) {
    Flow f{};
    for_fluids<0, N>([&](int k) { f.partial[k] = a_[a_flux + partial_density(k)][q]; });
    for_fluids<1, N>([&](int k) { f.alpha[k] = a_[a_flux + volume_fraction(k)][q]; });
    f.mu = a_[a_flux + s_.normal()][q];
    f.mv = a_[a_flux + s_.transverse1()][q];
    f.mw = a_[a_flux + s_.transverse2()][q];
    f.E = a_[a_flux + energy][q];
    f.speed = a_[a_face_speed][q];
    return f;
  }
  void put(int q, Flow const& f) {
    for_fluids<0, N>([&](int k) { a_[a_flux + partial_density(k)][q] = f.partial[k]; });
    for_fluids<1, N>([&](int k) { a_[a_flux + volume_fraction(k)][q] = f.alpha[k]; });
    a_[a_flux + s_.normal()][q] = f.mu;
    a_[a_flux + s_.transverse1()][q] = f.mv;
    a_[a_flux + s_.transverse2()][q] = f.mw;
    a_[a_flux + energy][q] = f.E;
    a_[a_face_speed][q] = f.speed;
  }

  static Flow hll_flux(Side const& L, Side const& R, Speeds const& s) {
    Motion const& l = L.motion;
    Motion const& r = R.motion;
    HllFlux const h = hll({0.0, l.u, l.p, 0.0, l.c}, {0.0, r.u, r.p, 0.0, r.c}, s.low, s.high);
    auto const carried = [&h](double left, double right) { return h.from_left * left + h.from_right * right; };
    Flow f{};
    for_fluids<0, N>([&](int k) { f.partial[k] = carried(L.U.partial[k], R.U.partial[k]); });
    for_fluids<1, N>([&](int k) { f.alpha[k] = carried(L.U.alpha[k], R.U.alpha[k]); });
    f.mu = carried(L.U.mu, R.U.mu) + h.pressure;
    f.mv = carried(L.U.mv, R.U.mv);
    f.mw = carried(L.U.mw, R.U.mw);
    f.E = carried(L.U.E, R.U.E) + h.work;
    f.speed = h.from_left + h.from_right;
    return f;
  }

  static Flow blend(Flow const& first, Flow const& high, double theta) {
    auto const mean = [theta](double x, double y) { return x + theta * (y - x); };
    Flow f{};
    for_fluids<0, N>([&](int k) { f.partial[k] = mean(first.partial[k], high.partial[k]); });
    for_fluids<1, N>([&](int k) { f.alpha[k] = mean(first.alpha[k], high.alpha[k]); });
    f.mu = mean(first.mu, high.mu);
    f.mv = mean(first.mv, high.mv);
    f.mw = mean(first.mw, high.mw);
    f.E = mean(first.E, high.E);
    f.speed = mean(first.speed, high.speed);
    return f;
  }

  /// The margins of U + S + k (F - f(U)).
  [[nodiscard]] Margins half_update(Side const& x, Flow const& F, double k) const {
    Flow const& U = x.U;
    Flow const& base = x.spread;
    double const u = x.motion.u;
    double const p = x.motion.p;
    PerFluid partial{};
    PerFluid alpha{};
    for_fluids<0, N>([&](int f) { partial[f] = base.partial[f] + k * (F.partial[f] - U.partial[f] * u); });
    for_fluids<1, N>([&](int f) { alpha[f] = U.alpha[f] + k * (F.alpha[f] - U.alpha[f] * F.speed); });
    double const mu = base.mu + k * (F.mu - (U.mu * u + p));
    double const mv = base.mv + k * (F.mv - U.mv * u);
    double const mw = base.mw + k * (F.mw - U.mw * u);
    double const E = base.E + k * (F.E - (U.E + p) * u);
    double const rho = density(partial);
    constexpr double round_off = 1e-13;
    bool possible = rho > 0.0;
    for_fluids<0, N>([&](int f) { possible = possible && !(partial[f] < -round_off * rho); });
    for_fluids<1, N>([&](int f) { possible = possible && !(alpha[f] < -round_off || alpha[f] > 1.0 + round_off); });
    if (!possible) return Margins::of_nothing();
    double const rho_e = E - 0.5 * (mu * mu + mv * mv + mw * mw) / rho;
    Mixture const m = closure_of<N>(*s_.fluids, partial, alpha, x.burn);
    Margins const result{margin(m.pressure(rho_e), m.xi, m.H, s_.most_H), heat(partial, alpha, rho_e)};
    return result.pressure == result.pressure ? result : Margins::of_nothing();
  }

  /// Energy above that of the cold fluids: unlike the pressure a concave function of the state, for in the mean of two
  /// states of products with little thermal energy the pressure may be negative. Without limit where tension is borne.
  [[nodiscard]] double heat(PerFluid const& partial, PerFluid const& alpha, double rho_e) const {
    if (s_.most_H > 0.0) return -Margins::unsound;
    double left = rho_e;
    auto const take_off = [&](int k, double fraction) {
      left -= partial[k] * material::cold_energy(s_.fluids->eos[k], phase_density(partial[k], fraction));
    };
    double rest = 1.0;
    for_fluids<1, N>([&](int k) { rest -= alpha[k]; });
    take_off(0, rest);
    for_fluids<1, N>([&](int k) { take_off(k, alpha[k]); });
    return left;
  }

  [[nodiscard]] static double density(PerFluid const& partial) {
    return sum_of_fluids<N>([&](int k) { return partial[k]; });
  }

  [[nodiscard]] double least(Side const& x) const { return s_.floors.pressure * (x.xi + 1.0); }

  SweepContext const& s_;
  int st_;
  BundleArrays& a_;
};

/// Limits the fluxes beside the cells that `mark_risks` marked.
template <int N>
void limit_fluxes(SweepContext const& s, BundleLayout const& b, BundleArrays& a, GuardCount& guards) {
  int const st = b.stride;
  double const* const risk = a[a_risk];
  FluxLimiter<N> limiter(s, b, a);
  for (int q = st; q < b.total - 2 * st; ++q) {
    if (std::max(risk[q], risk[q + st]) < 0.5) continue;
    if (limiter.limit(q) && is_own(b, q)) ++guards.fallback_faces;
  }
}

}  // namespace brisance::gas
