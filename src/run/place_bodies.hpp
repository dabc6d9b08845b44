/// Bodies of a case become material points.
#pragma once

#include "run/world.hpp"

namespace brisance::run {

/// Builds `world.points`, its body reports and the gauges of the points. Throws InputError where a body holds no point.
void place_bodies(World& world);

}  // namespace brisance::run
