/// The motion that a calculation still holds.
#pragma once

namespace brisance::run {
class World;
}

namespace brisance::observe {

/// Kinetic energy of gas and points [J]; summed in a fixed order.
[[nodiscard]] double kinetic_energy(run::World const& world);

}  // namespace brisance::observe
