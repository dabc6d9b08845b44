/// Bodies of a case become material points.
#pragma once

#include <vector>

#include "case/case.hpp"

namespace brisance::run {
class System;
struct Region;
}  // namespace brisance::run

namespace brisance::setup {

/// Builds the particles of the system's last region on the given background grid, with its bodies and, after them,
/// `others` that are left without particles; and the reports of its bodies. Throws InputError where a body holds no
/// particle.
void place_bodies(run::System& system, run::Region& region, grid::Domain const& domain,
                  std::vector<mpm::Body> others = {});

/// Gives a body of particles the settings of the region's gas.
void calculate_as_gas(MpmRegion const& settings, mpm::Body& body);
}  // namespace brisance::setup
