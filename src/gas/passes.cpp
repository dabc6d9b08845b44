/// The passes of one set of instructions. This file is compiled once for every set, with the names of its vector in
/// BRISANCE_VECTOR and of the function in BRISANCE_PASSES; nothing of it may be an inline function that other files
/// have too.
#include "gas/passes.hpp"

#include "core/vector.hpp"
#include "gas/pass_closure.hpp"
#include "gas/pass_faces.hpp"
#include "gas/pass_fluxes.hpp"
#include "gas/pass_states.hpp"

namespace brisance::gas {

namespace {

using Vector = BRISANCE_VECTOR;

template <class Variant>
struct ClosureOf;
template <class... E>
struct ClosureOf<std::variant<E...>> {
  static constexpr ClosureTable<std::variant<E...>> table{{&add_to_closure<Vector, E>...}};
};

/// Calls use.operator()<X, Y>() with two conditions that are known when it is compiled.
template <class Use>
auto with(bool x, bool y, Use const& use) {
  if (x) return y ? use.template operator()<true, true>() : use.template operator()<true, false>();
  return y ? use.template operator()<false, true>() : use.template operator()<false, false>();
}

template <int N>
constexpr Passes::OfFluids table_of_fluids() {
  Passes::OfFluids table{};
  table.primitives = [](SweepContext const& s, int begin, int count, BundleArrays& a) {
    if constexpr (N == 1) {
      if (s.ideal()) return find_primitives<Vector, 1, true>(s, begin, count, a);
    }
    return find_primitives<Vector, N, false>(s, begin, count, a);
  };
  table.sensor = [](BundleLayout const& b, BundleArrays& a) { find_shocks<Vector>(b, a); };
  table.faces = [](SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
    return with(s.radial, s.solid, [&]<bool Radial, bool Walls>() {
      if constexpr (N == 1) {
        if (s.ideal()) return FacePass<Vector, 1, true, Radial, Walls>(s, b, a).run();
      }
      return FacePass<Vector, N, false, Radial, Walls>(s, b, a).run();
    });
  };
  table.fluxes = [](SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
    with(s.solid, false, [&]<bool Walls, bool>() {
      if constexpr (N == 1) {
        if (s.ideal()) return find_fluxes<Vector, 1, true, Walls>(s, b, a);
      }
      return find_fluxes<Vector, N, false, Walls>(s, b, a);
    });
  };
  table.update = [](SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
    with(s.radial, s.solid, [&]<bool Radial, bool Walls>() { update_states<Vector, N, Radial, Walls>(s, b, a); });
  };
  table.signals = [](SweepContext const& s, int begin, int count, int dimensions, BundleArrays& a) {
    if constexpr (N == 1) {
      if (s.ideal()) return find_signals<Vector, 1, true>(s, begin, count, dimensions, a);
    }
    return find_signals<Vector, N, false>(s, begin, count, dimensions, a);
  };
  return table;
}

template <int... N>
constexpr Passes all_passes(std::integer_sequence<int, N...>) {
  return {ClosureOf<material::Eos>::table, {table_of_fluids<N + 1>()...}};
}

constexpr Passes table = all_passes(std::make_integer_sequence<int, most_fluids>{});

}  // namespace

Passes const& BRISANCE_PASSES();
Passes const& BRISANCE_PASSES() { return table; }

}  // namespace brisance::gas
