/// Profiles of bursts from files, and those that a simulation leaves.
#pragma once

#include <memory>

#include "case/case.hpp"
#include "gas/gas.hpp"

namespace brisance::run {
class System;
}

namespace brisance::setup {

/// The profile of a file for a charge of the case, scaled to its mass. Throws InputError where the two do not match.
[[nodiscard]] std::shared_ptr<detonation::Profile const> fitted_profile(Case const& setup, std::size_t charge,
                                                                        detonation::Profile const& profile);

/// The present state of a simulation with one charge, in 1D or axisymmetric 2D, as a profile. Throws InputError where
/// it cannot be one.
[[nodiscard]] detonation::Profile profile_of(run::System const& system);

/// Tells a profile whose burst it is: that of the case's only charge. Throws InputError where it cannot be one.
void describe_charge(Case const& setup, gas::Fluids const& fluids, detonation::Profile& profile);

}  // namespace brisance::setup
