/// What became of the parts of a case on its grid.
#pragma once

#include <string>

#include "case/case.hpp"
#include "detonation/remap.hpp"

namespace brisance {
class Archive;
}

namespace brisance::run {

/// What became of one charge on the grid.
struct ChargeReport {
  std::string explosive;
  double specified_mass = 0.0;    ///< whole body [kg]
  double realised_mass = 0.0;     ///< whole body, symmetry images counted [kg]
  double realised_energy = 0.0;   ///< E0 of the realised volume [J]
  double cells_per_radius = 0.0;  ///< (volume of the part in the domain as an equivalent radius) / h
};

/// What became of one initial state on the grid. Its own volume in the domain is asked for; what later ones, obstacles
/// and charges take of it is not placed.
struct InitialStateReport {
  std::string fluid;
  double specified_volume = 0.0;  ///< [m3]
  double volume = 0.0;            ///< placed [m3]
  double specified_mass = 0.0;    ///< [kg]
  double mass = 0.0;              ///< placed [kg]
  double specified_energy = 0.0;  ///< internal and kinetic [J]
  double energy = 0.0;            ///< placed [J]
};

/// What became of one obstacle on the grid.
struct ObstacleReport {
  std::string name;
  double specified_volume = 0.0;  ///< of the part in the domain [m3]
  double volume = 0.0;            ///< of the solid cells that it has the largest part of [m3]
  long cells = 0;                 ///< their number
  /// What its cells hold beyond the obstacles, less what of it lies in cells that are not solid [m3].
  double excess = 0.0;
};

/// What became of one body on the grid.
struct BodyReport {
  std::string name;
  std::string material;
  long particles = 0;
  double mass = 0.0;            ///< of the particles [kg]
  double geometric_mass = 0.0;  ///< of the shape's part in the domain [kg]
  int bars = 0;                 ///< of reinforcement
  double bar_volume = 0.0;      ///< of them in the domain [m3]
};

/// What a remap did to one charge.
struct StartReport {
  StartMethod method = StartMethod::gas;
  std::string from;            ///< the geometry, or the file, of the profile
  double cell = 0.0;           ///< of the profile [m]
  double charge_radius = 0.0;  ///< [m]
  std::string by;              ///< what the shock was about to meet
  detonation::RemapReport remap;
};

void archive(Archive& a, ChargeReport& report);
void archive(Archive& a, StartReport& report);

}  // namespace brisance::run
