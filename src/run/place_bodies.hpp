/// Bodies of a case become material points.
#pragma once

#include "run/world.hpp"

namespace brisance::run {

/// Builds `world.points` on the given background grid with the bodies of the case and, after them, `others` that are
/// left without points; the body reports and the gauges of the points. Throws InputError where a body holds no point.
void place_bodies(World& world, grid::Domain const& domain, std::vector<mpm::Body> others = {});

}  // namespace brisance::run
