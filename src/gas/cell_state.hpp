/// Between the conserved state of a cell and the primitive one.
#pragma once

#include "gas/closure.hpp"

namespace brisance::gas {

/// Conserved components of a state, in component order; what they cannot hold (shock, progress) is 0. Of a gas of one
/// fluid the composition counts for nothing.
[[nodiscard]] Components conserved_of(Fluids const& fluids, Primitive const& state);

/// The state that conserved components stand for; F: burn fraction.
[[nodiscard]] Primitive primitive_of(Fluids const& fluids, double const* components, double F);

}  // namespace brisance::gas
