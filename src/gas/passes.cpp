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

template <int N, Sums S>
constexpr Passes::OfFluids table_of() {
  Passes::OfFluids table{};
  table.primitives = [](SweepContext const& s, int begin, int count, BundleArrays& a) {
    return find_primitives<Vector, N, S>(s, begin, count, a);
  };
  table.sensor = [](BundleLayout const& b, BundleArrays& a) { find_shocks<Vector>(b, a); };
  table.faces = [](SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
    return with(s.radial, s.solid,
                [&]<bool Radial, bool Walls>() { return FacePass<Vector, N, S, Radial, Walls>(s, b, a).run(); });
  };
  table.fluxes = [](SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
    // Without constants the energies of the faces stand in arrays, whatever the sums are.
    constexpr Sums kind = S == Sums::none ? S : Sums::all;
    with(s.solid, false, [&]<bool Walls, bool>() { find_fluxes<Vector, N, kind, Walls>(s, b, a); });
  };
  table.update = [](SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
    with(s.radial, s.solid, [&]<bool Radial, bool Walls>() { update_states<Vector, N, Radial, Walls>(s, b, a); });
  };
  table.signals = [](SweepContext const& s, int begin, int count, int dimensions, BundleArrays& a) {
    return find_signals<Vector, N, S>(s, begin, count, dimensions, a);
  };
  return table;
}

/// In the order of `Sums`. One fluid alone is seldom anything between an ideal gas and one with all sums; the sums of
/// several are no constants.
template <int N>
constexpr std::array<Passes::OfFluids, kinds_of_sums> tables_of_fluids() {
  if constexpr (N == 1)
    return {table_of<N, Sums::none>(), table_of<N, Sums::all>(), table_of<N, Sums::all>()};
  else
    return {table_of<N, Sums::all>(), table_of<N, Sums::xi>(), table_of<N, Sums::all>()};
}

template <int... N>
constexpr Passes all_passes(std::integer_sequence<int, N...>) {
  return {ClosureOf<material::Eos>::table, {tables_of_fluids<N + 1>()...}};
}

constexpr Passes table = all_passes(std::make_integer_sequence<int, most_fluids>{});

}  // namespace

Passes const& BRISANCE_PASSES();
Passes const& BRISANCE_PASSES() { return table; }

}  // namespace brisance::gas
