/// Mixture closure of the five-equation model [Allaire02]: one pressure, explicit. Of gas cells and of material points.
///
/// Each fluid obeys p = f_k(rho_k) + G_k rho_k e_k (material/eos). With xi_k = 1/G_k and one pressure for both,
///     rho e = xi p + B,   xi = sum alpha_k xi_k,   B = -sum alpha_k xi_k f_k(rho_k),
///     rho c^2 = p + (p + H)/xi,   H = sum alpha_k xi_k (rho_k f_k' - f_k),
/// where c follows from xi rho c^2 = sum alpha_k xi_k rho_k c_k^2.
///
/// Programmed burn, [Cui14] Eq. (52): the pressure of the products is p_0 + F (p_E - p_0), F the burn fraction. The
/// offset by the ambient pressure p_0 keeps unburnt explosive at rest in air at rest; it is 1e-5 of the detonation
/// pressure. In the form above:
///     G_1 -> F G_1,   f_1 -> F f_1 + (1 - F) p_0.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "core/loops.hpp"
#include "material/eos/eos.hpp"
#include "material/primitive.hpp"

namespace brisance::material {

/// The fluids of a run. Number 0 is the ambient one, which fills what the others leave; the others carry a partial
/// density and a volume fraction each.
struct Fluids {
  std::array<Eos, most_fluids> eos;
  int count = 1;
  double ambient_pressure = 0.0;  ///< p_0 of unburnt explosive [Pa]

  [[nodiscard]] Eos const& ambient() const { return eos[0]; }
  /// Can a cell hold more than the ambient fluid?
  [[nodiscard]] bool mixed() const { return count > 1; }
  [[nodiscard]] bool any_bears_tension() const {
    return std::any_of(eos.begin(), eos.begin() + count, [](Eos const& of) { return bears_tension(of); });
  }
};

/// Volume fractions below this are treated as zero in the closure; cells stop carrying them through faces, so that the
/// diffuse interface ends somewhere. It must be small enough for alpha * f(rho) to vanish beside the pressure: f is
/// 1e10 Pa at most.
inline constexpr double vanishing_fraction = 1e-14;

/// Smallest burn fraction in the closure: 1/F must stay finite. p - p_0 of unburnt TNT is then about 10 Pa.
inline constexpr double smallest_burn_fraction = 1e-9;

/// The sums xi, B, H of one cell, or of several side by side.
template <class V>
struct MixtureOf {
  V xi = V(0.0);
  V B = V(0.0);
  V H = V(0.0);

  [[nodiscard]] V pressure(V const& rho_e) const { return (rho_e - B) / xi; }
  [[nodiscard]] V rho_e(V const& p) const { return xi * p + B; }
  [[nodiscard]] V bulk_modulus(V const& p) const { return p + (p + H) / xi; }
};
using Mixture = MixtureOf<double>;

/// Density of a fluid from its partial density; a fluid that is as good as absent gets a harmless small one.
/// Lax-Wendroff overshoots the range of the volume fraction: where it is negative so is the partial density, and their
/// ratio is still the fluid's density.
template <class V>
[[nodiscard]] inline V phase_density(V const& partial_density, V const& alpha) {
  using std::abs;
  auto const present = abs(alpha) > vanishing_fraction;
  V const rho = partial_density / select(present, alpha, V(1.0));
  return select(present & (rho > 1e-6), rho, V(1e-6));
}

/// May the density of a fluid, as `phase_density` has it, be above a bound? Without a division; that bound is above
/// 1e-6.
template <class V>
[[nodiscard]] inline auto may_exceed(V const& partial_density, V const& alpha, double bound) {
  using std::abs;
  V const size = abs(alpha);
  return abs(partial_density) > bound * select(size > vanishing_fraction, size, V(1.0));
}

/// Adds one fluid's part.
template <class E, class V>
inline void add_fluid(E const& eos, V const& alpha, V const& rho, MixtureOf<V>& m) {
  double const xi = 1.0 / eos.gruneisen();
  V const f = eos.reference(rho);
  m.xi += alpha * xi;
  m.B -= alpha * xi * f;
  m.H += alpha * xi * (eos.rho_d_reference(rho) - f);
}

/// Adds the part of a fluid with burn fraction F.
template <class E, class V>
inline void add_burning_fluid(E const& eos, V const& alpha, V const& rho, V const& F, double p0, MixtureOf<V>& m) {
  V const xi = 1.0 / (F * eos.gruneisen());
  V const f = F * eos.reference(rho) + (1.0 - F) * p0;
  m.xi += alpha * xi;
  m.B -= alpha * xi * f;
  m.H += alpha * xi * (F * eos.rho_d_reference(rho) - f);
}

/// The same for a single cell. The reference curve of a thin fluid vanishes in double precision, and is not asked for.
template <class E>
inline void add_fluid_of_cell(E const& eos, double alpha, double rho, double F, double p0, Mixture& m) {
  if constexpr (requires { eos.negligible_below(); }) {
    if (F == 1.0 && rho < eos.negligible_below()) {
      m.xi += alpha * (1.0 / eos.gruneisen());
      return;
    }
  }
  add_burning_fluid(eos, alpha, rho, F, p0, m);
}

/// Closure of one cell; `partial` are partial densities, F the burn fraction (1: burnt) of the fluids beside the
/// ambient one. Without such fluids the volume fractions must be 0.
[[nodiscard]] inline Mixture mixture(Fluids const& fluids, PerFluid const& partial, Fractions const& alpha,
                                     double F = 1.0) {
  Mixture m;
  double const alpha0 = alpha[0];
  std::visit([&](auto const& eos) { add_fluid(eos, alpha0, phase_density(partial[0], alpha0), m); }, fluids.eos[0]);
  for (int k = 1; k < fluids.count; ++k) {
    std::visit(
        [&](auto const& eos) {
          add_fluid_of_cell(eos, alpha[k], phase_density(partial[k], alpha[k]), F, fluids.ambient_pressure, m);
        },
        fluids.eos[k]);
  }
  return m;
}

/// Closure of a mixture of density rho with mass fractions Y and volume fractions alpha.
[[nodiscard]] inline Mixture mixture_of(Fluids const& fluids, double rho, Fractions const& Y, Fractions const& alpha) {
  PerFluid partial{};
  for (int k = 0; k < most_fluids; ++k) partial[k] = Y[k] * rho;
  return mixture(fluids, partial, alpha);
}
[[nodiscard]] inline Mixture mixture_of(Fluids const& fluids, Primitive const& s) {
  return mixture_of(fluids, s.density, s.mass_fraction, s.volume_fraction);
}

/// Volume fractions of a fluid along a row of cells or particles: those that stand there, or, of the ambient fluid,
/// what those of the others leave.
struct Own {
  double const* alpha;
  [[nodiscard]] double operator()(int q) const { return alpha[q]; }
};
template <int Others>
struct Rest {
  std::array<double const*, Others> alpha;
  [[nodiscard]] double operator()(int q) const { return after<Others>(q); }

 private:
  template <int Count>
  [[nodiscard]] double after(int q) const {
    if constexpr (Count == 1)
      return 1.0 - alpha[0][q];
    else
      return after<Count - 1>(q) - alpha[Count - 1][q];
  }
};

/// The same for rows of cells or particles: adds one fluid to xi, B, H of n of them. `F` is null where everything is
/// burnt. The model comes by value: its constants then stay in registers, for no store to the rows can change them.
template <class Alpha, class E>
void add_fluid_sums(E const eos, int n, Alpha const alpha, double const* partial, double const* F, double p0,
                    double* xi, double* B, double* H) {
  if (F == nullptr) {
    BRISANCE_VECTOR_LOOP
    for (int q = 0; q < n; ++q) {
      double const a = alpha(q);
      Mixture m{xi[q], B[q], H[q]};
      add_fluid(eos, a, phase_density(partial[q], a), m);
      xi[q] = m.xi;
      B[q] = m.B;
      H[q] = m.H;
    }
  } else {
    BRISANCE_VECTOR_LOOP
    for (int q = 0; q < n; ++q) {
      double const a = alpha(q);
      Mixture m{xi[q], B[q], H[q]};
      add_burning_fluid(eos, a, phase_density(partial[q], a), F[q], p0, m);
      xi[q] = m.xi;
      B[q] = m.B;
      H[q] = m.H;
    }
  }
}

/// The same, quicker where the fluid is thin everywhere.
template <class Alpha, class E>
void add_fluid_row(E const eos, int n, Alpha const alpha, double const* partial, double const* F, double p0, double* xi,
                   double* B, double* H) {
  if constexpr (requires { eos.negligible_below(); }) {
    // The reference curve of a thin fluid vanishes in double precision: it is an ideal gas.
    if (F == nullptr) {
      double const bound = eos.negligible_below();
      long dense = 0;
      BRISANCE_VECTOR_LOOP
      for (int q = 0; q < n; ++q) {
        double const a = alpha(q);
        dense += phase_density(partial[q], a) > bound ? 1 : 0;
      }
      if (dense == 0) {
        double const x = 1.0 / eos.gruneisen();
        BRISANCE_VECTOR_LOOP
        for (int q = 0; q < n; ++q) xi[q] += alpha(q) * x;
        return;
      }
    }
  }
  add_fluid_sums(eos, n, alpha, partial, F, p0, xi, B, H);
}

}  // namespace brisance::material
