/// What an engineer reads off the gauges of the gas, beside Kingery-Bulmash.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "empirical/kingery_bulmash.hpp"
#include "observe/blast_wave.hpp"
#include "observe/gauges.hpp"

namespace brisance::observe {

/// Kingery-Bulmash values at `distance` [m] from a mass of an explosive [kg] in air: pressures by its TNT equivalent
/// for pressure, times and impulses by that for impulse, each absent where it is unknown. The ambient fluid is an ideal
/// gas.
[[nodiscard]] empirical::Blast empirical_blast(material::Explosive const& explosive, double mass, Ambient const& air,
                                               Burst burst, double distance);

/// Do the fits apply to the case? They describe one charge in the open or on open ground, in air.
[[nodiscard]] bool empirical_applies(Case const& setup);

/// Kingery-Bulmash values at `distance` [m] from the case's charge in its ambient air: pressures by the explosive's TNT
/// equivalent for pressure, times and impulses by that for impulse, each absent where it is unknown; arrival counts
/// from the start of the simulation. All absent unless the case names the burst type, has one charge, and the ambient
/// fluid is an ideal gas.
[[nodiscard]] empirical::Blast empirical_blast(Case const& setup, double distance);

/// A gauge's results beside the empirical ones.
struct GaugeSummary {
  std::string name;
  Vec3 position{0.0, 0.0, 0.0};
  BlastWave wave;
  std::optional<double> distance;         ///< to the centre of the nearest charge [m]
  std::optional<double> scaled_distance;  ///< distance / cube root of its mass of TNT, if known [m/kg^(1/3)]
  empirical::Blast empirical;
};

/// Summaries of all gauges of a case. The empirical values are given for a single charge whose case names the burst
/// type.
[[nodiscard]] std::vector<GaugeSummary> summarise(Case const& setup, std::vector<GaugeHistory> const& gauges);

}  // namespace brisance::observe
