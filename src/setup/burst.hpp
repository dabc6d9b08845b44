/// A charge as the burst of a simulation with fewer directions.
#pragma once

#include "case/case.hpp"
#include "detonation/remap.hpp"

namespace brisance::setup {

/// Throws InputError where the case cannot start with a remap, whatever its profiles are.
void check_start(Case const& setup);
/// Radius of the ball, or of the disc, of which the charge is the whole or the half that stands on a mirror.
[[nodiscard]] double ball_radius(Case const& setup, std::size_t number);
/// When it is lit in its centre [s].
[[nodiscard]] double delay_of(Case const& setup, std::size_t number, double radius);
/// The direction of an axisymmetric profile's axis in the domain.
[[nodiscard]] detonation::Placing placing_of(Charge const& charge);

}  // namespace brisance::setup
