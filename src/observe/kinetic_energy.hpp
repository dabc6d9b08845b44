/// The motion that a calculation still holds.
#pragma once

namespace brisance::run {
class System;
}

namespace brisance::observe {

/// Kinetic energy of gas and points [J]; summed in a fixed order.
[[nodiscard]] double kinetic_energy(run::System const& system);

}  // namespace brisance::observe
