/// The motion that a simulation still holds.
#pragma once

namespace brisance::run {
class System;
}

namespace brisance::observe {

/// Kinetic energy of gas and particles [J]; summed in a fixed order.
[[nodiscard]] double kinetic_energy(run::System const& system);

}  // namespace brisance::observe
