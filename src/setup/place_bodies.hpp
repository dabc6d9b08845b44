/// Bodies of a case become material points.
#pragma once

#include <vector>

#include "case/case.hpp"

namespace brisance::run {
class System;
}

namespace brisance::setup {

/// Builds `system.points` on the given background grid with the bodies of the case and, after them, `others` that are
/// left without particles; and the body reports. Throws InputError where a body holds no particle.
void place_bodies(run::System& system, grid::Domain const& domain, std::vector<mpm::Body> others = {});

/// Gives a body of particles the settings of the region's gas.
void calculate_as_gas(MpmRegion const& settings, mpm::Body& body);
}  // namespace brisance::setup
