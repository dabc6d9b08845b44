/// The passes of a sweep over a bundle: closure sums, primitive variables, face states, fluxes, update, wave speeds.
///
/// They are compiled once for every set of vector instructions (passes.cpp), from one source (pass_*.hpp); a table
/// holds those of a set, and a run takes the best set that the processor has, or the one that the user names.
///
/// What is rare (lifting a cell to the floors, limiting fluxes for positivity) stands outside, compiled for any
/// processor, and works on the same arrays: no inline function of a set may be shared with code that runs everywhere.
#pragma once

#include <array>
#include <tuple>
#include <variant>

#include "core/simd.hpp"
#include "gas/kernels.hpp"

namespace brisance::gas {

/// The cells of a fluid whose part in the closure sums is asked for.
struct ClosureRow {
  int begin = 0;  ///< bundle index of the first cell
  int count = 0;
  int fluid = 0;
  int fluids = 1;        ///< present
  bool burning = false;  ///< `a_burn` holds a burn fraction
  double ambient = 0.0;  ///< pressure of unburnt explosive [Pa]
};

/// One function per equation of state.
template <class Eos>
struct ClosureTable;
template <class... E>
struct ClosureTable<std::variant<E...>> {
  /// Do they return a reference curve, B or H other than 0?
  std::tuple<bool (*)(E const&, ClosureRow const&, BundleArrays&)...> add;
};

/// What the wave speeds of some cells are.
struct Signals {
  double fastest = 0.0;  ///< largest |u| + c [m/s]
  bool sound = true;     ///< are all above the floors?
};

struct Passes {
  struct OfFluids {
    /// Velocities, pressure and 1 / density of `count` cells from `begin` on. Are all above the floors?
    bool (*primitives)(SweepContext const&, int begin, int count, BundleArrays&);
    /// The shock sensor's new value; MUSCL-Hancock in 2D and 3D.
    void (*sensor)(BundleLayout const&, BundleArrays&);
    /// MUSCL-Hancock: states at both faces of every cell. May fluxes have to be limited?
    bool (*faces)(SweepContext const&, BundleLayout const&, BundleArrays&);
    /// MUSCL-Hancock: fluxes.
    void (*fluxes)(SweepContext const&, BundleLayout const&, BundleArrays&);
    void (*update)(SweepContext const&, BundleLayout const&, BundleArrays&);
    /// Pressure and |u| + c of `count` cells from `begin` on; of the components of the momentum `dimensions` count.
    Signals (*signals)(SweepContext const&, int begin, int count, int dimensions, BundleArrays&);
  };
  ClosureTable<material::Eos> closure;
  /// By the number of fluids less 1 and the closure sums that stand in arrays.
  std::array<std::array<OfFluids, kinds_of_sums>, most_fluids> of_fluids;
};

/// The passes for the instructions that are in use, see `simd_set`.
[[nodiscard]] Passes const& passes();

}  // namespace brisance::gas
