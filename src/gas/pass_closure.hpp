/// Pass: closure sums of a fluid, see material/fluids.hpp.
#pragma once

#include <type_traits>

#include "core/vector.hpp"
#include "gas/kernels.hpp"
#include "gas/passes.hpp"
#include "material/fluids.hpp"

namespace brisance::gas {

/// Volume fractions of a fluid along a row: those that stand there, or, of the ambient fluid, what the others leave.
template <class V>
[[nodiscard]] V fraction_at(ClosureRow const& row, Arrays const& a, int q) {
  if (row.fluid > 0) return Lanes<V>::load(a[volume_fraction(row.fluid)] + q);
  V rest(1.0);
  for (int k = 1; k < row.fluids; ++k) rest -= Lanes<V>::load(a[volume_fraction(k)] + q);
  return rest;
}

/// Adds one fluid to the sums of a row; the ambient one, number 0, begins them. Returns whether it has a reference
/// curve that counts.
template <class V, class Eos>
[[gnu::flatten]] bool add_to_closure(Eos const& model, ClosureRow const& row, BundleArrays& bundle) {
  Arrays const a(bundle);
  Eos const eos = model;
  double const* const partial = a[partial_density(row.fluid)];
  int const end = row.begin + row.count;
  auto const sums_at = [&](int q) {
    material::MixtureOf<V> m;
    if (row.fluid > 0) m = {Lanes<V>::load(a[a_xi] + q), Lanes<V>::load(a[a_B] + q), Lanes<V>::load(a[a_H] + q)};
    return m;
  };
  auto const put = [&](int q, material::MixtureOf<V> const& m) {
    Lanes<V>::store(a[a_xi] + q, m.xi);
    Lanes<V>::store(a[a_B] + q, m.B);
    Lanes<V>::store(a[a_H] + q, m.H);
  };
  if constexpr (requires { eos.negligible_below(); }) {
    // The reference curve of a thin fluid vanishes in double precision: it is an ideal gas.
    if (!(row.burning && row.fluid > 0)) {
      double const bound = eos.negligible_below();
      typename Lanes<V>::Mask dense(false);
      for (int q = row.begin; q < end; q += Lanes<V>::count) {
        dense = dense | material::may_exceed(Lanes<V>::load(partial + q), fraction_at<V>(row, a, q), bound);
      }
      if (!any(dense)) {
        double const xi = 1.0 / eos.gruneisen();
        for (int q = row.begin; q < end; q += Lanes<V>::count) {
          material::MixtureOf<V> m = sums_at(q);
          m.xi += fraction_at<V>(row, a, q) * xi;
          if (row.fluid > 0)
            Lanes<V>::store(a[a_xi] + q, m.xi);
          else
            put(q, m);
        }
        return false;
      }
    }
  }
  bool const burning = row.burning && row.fluid > 0;
  for (int q = row.begin; q < end; q += Lanes<V>::count) {
    material::MixtureOf<V> m = sums_at(q);
    V const alpha = fraction_at<V>(row, a, q);
    V const rho = material::phase_density(Lanes<V>::load(partial + q), alpha);
    if (burning)
      material::add_burning_fluid(eos, alpha, rho, Lanes<V>::load(a[a_burn] + q), row.ambient, m);
    else
      material::add_fluid(eos, alpha, rho, m);
    put(q, m);
  }
  return !std::is_same_v<Eos, material::IdealGas>;
}

}  // namespace brisance::gas
