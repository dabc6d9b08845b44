/// Bodies of a case become material points.
#pragma once

#include "run/world.hpp"

namespace brisance::setup {

/// Builds `world.points` on the given background grid with the bodies of the case and, after them, `others` that are
/// left without points; the body reports and the gauges of the points. Throws InputError where a body holds no point.
void place_bodies(run::World& world, grid::Domain const& domain, std::vector<mpm::Body> others = {});

/// Do the products of a body become gas as it burns? Those of an explosive in an MPM region whose gas knows them.
[[nodiscard]] bool becomes_gas(Case const& setup, Body const& body);
/// Gives a body of points the settings of the region's gas.
void calculate_as_gas(MpmRegion const& settings, mpm::Body& body);
/// What has burnt of the explosives in the MPM region becomes gas.
void hand_over_products(run::World& world);

}  // namespace brisance::setup
