#include "exact_riemann.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace brisance::exact {

using material::bulk_modulus;
using material::Eos;
using material::gruneisen;
using material::internal_energy;

namespace {

/// Step in ln(rho) along isentropes. The fourth-order scheme then errs by about 1e-13 for gases, below 1e-10 for JWL
/// products.
constexpr double step = 5e-4;
/// A rarefaction is followed down to e^-60 of the initial density.
constexpr std::size_t most_nodes = 120000;

State mirrored(State const& s) { return {s.rho, -s.u, s.p}; }

double reference(Eos const& eos, double rho) {
  return std::visit([rho](auto const& e) { return e.reference(rho); }, eos);
}

}  // namespace

Side::Side(Eos const& eos, State const& ahead)
    : eos_(eos), ahead_(ahead), energy_(internal_energy(eos, ahead.rho, ahead.p)), isentrope_{Node{ahead.p, 0.0}} {
  if (!(ahead.rho > 0.0) || !valid(ahead.rho, ahead.p)) {
    throw std::domain_error("exact Riemann solution: the initial state has no real sound speed");
  }
}

bool Side::valid(double rho, double p) const { return bulk_modulus(eos_, rho, p) > 0.0; }

/// Classical Runge-Kutta step of dp/dx = rho c^2, dphi/dx = c with x = ln(rho / rho_ahead).
/// Returns not-a-number pressure where the sound speed vanishes.
Side::Node Side::advance(Node const& from, double x, double dx) const {
  auto const slope = [this](double at, double p) {
    double const rho = ahead_.rho * std::exp(at);
    double const k = bulk_modulus(eos_, rho, p);
    return Node{k, std::sqrt(k / rho)};
  };
  Node const k1 = slope(x, from.p);
  Node const k2 = slope(x + 0.5 * dx, from.p + 0.5 * dx * k1.p);
  Node const k3 = slope(x + 0.5 * dx, from.p + 0.5 * dx * k2.p);
  Node const k4 = slope(x + dx, from.p + dx * k3.p);
  return {from.p + dx / 6.0 * (k1.p + 2.0 * k2.p + 2.0 * k3.p + k4.p),
          from.phi + dx / 6.0 * (k1.phi + 2.0 * k2.phi + 2.0 * k3.phi + k4.phi)};
}

State Side::state(Node const& node, double x) const { return {ahead_.rho * std::exp(x), ahead_.u - node.phi, node.p}; }

bool Side::reach(double p) {
  while (isentrope_.back().p > p && !ended_) {
    double const x = -step * static_cast<double>(isentrope_.size() - 1);
    Node const next = advance(isentrope_.back(), x, -step);
    bool const usable = std::isfinite(next.p) && std::isfinite(next.phi) && next.p < isentrope_.back().p &&
                        valid(ahead_.rho * std::exp(x - step), next.p);
    if (usable) isentrope_.push_back(next);
    ended_ = !usable || isentrope_.size() >= most_nodes;
  }
  return isentrope_.back().p <= p;
}

double Side::lowest_pressure() {
  reach(-std::numeric_limits<double>::infinity());
  return isentrope_.back().p;
}

/// Hugoniot relation e - e0 = (p + p0) (1/rho0 - 1/rho) / 2, put into p = f(rho) + G rho e. Negative at rho0 when p >
/// p0.
double Side::hugoniot_residual(double rho, double p) const {
  double const g = gruneisen(eos_);
  return reference(eos_, rho) + g * rho * energy_ + 0.5 * g * (p + ahead_.p) * (rho / ahead_.rho - 1.0) - p;
}

/// Density behind a shock to pressure p: the first solution above the initial density. Infinite where there is none.
double Side::shock_density(double p) const {
  constexpr double growth = 1.02;
  double low = ahead_.rho;
  if (hugoniot_residual(low, p) >= 0.0) return low;
  while (low < 1e4 * ahead_.rho) {
    double const high = growth * low;
    if (hugoniot_residual(high, p) >= 0.0) {
      return bracketed_root([&](double rho) { return hugoniot_residual(rho, p); }, low, high);
    }
    low = high;
  }
  return std::numeric_limits<double>::infinity();
}

State Side::behind(double p) const {
  if (p >= ahead_.p) {
    double const rho = shock_density(p);
    if (!std::isfinite(rho)) return {rho, -std::numeric_limits<double>::infinity(), p};
    return {rho, ahead_.u - std::sqrt((p - ahead_.p) * std::max(0.0, 1.0 / ahead_.rho - 1.0 / rho)), p};
  }
  auto const below = std::partition_point(isentrope_.begin(), isentrope_.end(), [p](Node const& n) { return n.p > p; });
  if (below == isentrope_.end()) throw std::logic_error("Side::behind: the isentrope was not integrated this far");
  auto const index = below - isentrope_.begin();
  Node const& from = isentrope_[index - 1];
  double const x = -step * static_cast<double>(index - 1);
  double const dx = bracketed_root([&](double d) { return advance(from, x, d).p - p; }, 0.0, -step);
  Node node = advance(from, x, dx);
  node.p = p;
  return state(node, x + dx);
}

State Side::fan(double speed) const {
  auto const characteristic = [this](Node const& node, double x) {
    State const s = state(node, x);
    return s.u - sound_speed(s);
  };
  std::size_t low = 0;
  std::size_t high = isentrope_.size() - 1;
  while (high - low > 1) {
    std::size_t const middle = (low + high) / 2;
    (characteristic(isentrope_[middle], -step * static_cast<double>(middle)) <= speed ? low : high) = middle;
  }
  Node const& from = isentrope_[low];
  double const x = -step * static_cast<double>(low);
  double const dx =
      bracketed_root([&](double d) { return characteristic(advance(from, x, d), x + d) - speed; }, 0.0, -step);
  return state(advance(from, x, dx), x + dx);
}

Riemann::Riemann(Eos const& left_eos, State const& left, Eos const& right_eos, State const& right)
    : left_(left),
      right_mirrored_(mirrored(right)),
      left_side_(left_eos, left),
      right_side_(right_eos, mirrored(right)) {
  // Velocity difference across the contact if both sides came to pressure p; falls monotonically with p.
  auto const closing_speed = [this](double p) { return left_side_.behind(p).u + right_side_.behind(p).u; };

  double low = std::min(left.p, right.p);
  double high = std::max(left.p, right.p);
  left_side_.reach(low);
  right_side_.reach(low);
  if (low < high && closing_speed(low) < 0.0) {
    high = low;
  } else if (low < high && closing_speed(high) >= 0.0) {
    low = high;
  }
  if (high == low && closing_speed(low) > 0.0) {  // two shocks
    double raise =
        0.01 * std::max(bulk_modulus(left_eos, left.rho, left.p), bulk_modulus(right_eos, right.rho, right.p));
    high = low + raise;
    while (closing_speed(high) > 0.0) {
      low = high;
      raise *= 2.0;
      high = low + raise;
    }
  } else if (high == low && closing_speed(low) < 0.0) {  // two rarefactions
    low = std::max(left_side_.lowest_pressure(), right_side_.lowest_pressure());
    if (closing_speed(low) < 0.0) {
      throw std::domain_error("exact Riemann solution: the two materials separate and leave a vacuum between them");
    }
  }
  p_star = low < high ? bracketed_root(closing_speed, low, high) : low;

  left_star_ = left_side_.behind(p_star);
  right_star_mirrored_ = right_side_.behind(p_star);
  u_star = 0.5 * (left_star_.u - right_star_mirrored_.u);
  rho_star_l = left_star_.rho;
  rho_star_r = right_star_mirrored_.rho;

  auto const wave = [](Side const& side, State const& ahead, State const& star) {
    Wave w;
    w.shock = star.p > ahead.p && star.rho > ahead.rho;
    if (w.shock) {
      double const mass_flux = std::sqrt((star.p - ahead.p) / (1.0 / ahead.rho - 1.0 / star.rho));
      w.head = w.tail = ahead.u - mass_flux / ahead.rho;
    } else {
      w.head = ahead.u - side.sound_speed(ahead);
      w.tail = star.u - side.sound_speed(star);
    }
    return w;
  };
  left_wave = wave(left_side_, left_, left_star_);
  right_wave = wave(right_side_, right_mirrored_, right_star_mirrored_);
  right_wave.head = -right_wave.head;
  right_wave.tail = -right_wave.tail;
}

Riemann::Sample Riemann::at(double x_over_t) const {
  auto const sample = [](Side const& side, State const& ahead, State const& star, double head, double tail,
                         double speed) {
    if (speed <= head) return ahead;
    if (speed >= tail) return star;
    return side.fan(speed);
  };
  if (x_over_t < u_star) {
    return {sample(left_side_, left_, left_star_, left_wave.head, left_wave.tail, x_over_t), true};
  }
  return {mirrored(sample(right_side_, right_mirrored_, right_star_mirrored_, -right_wave.head, -right_wave.tail,
                          -x_over_t)),
          false};
}

}  // namespace brisance::exact
