/// Zones of broken concrete, measured where the particles stood at the start.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "grid/geometry.hpp"

namespace brisance::run {
class System;
}

namespace brisance::observe {

/// A part of a body that the domain holds.
struct BrokenPart {
  double mass = 0.0;    ///< [kg]
  double volume = 0.0;  ///< at the start [m3], in the convention of `grid::Domain::cell_volume`
};

/// Broken concrete as seen from one face of the body: the part that hangs together with broken particles on the face.
struct FaceZone {
  grid::Face face = grid::Face::x_low;
  /// Of the crushed zone on the face: diameter of a circle of the same area, symmetry images counted; in planar 2D its
  /// width [m]; 0 in 1D.
  double crushed_diameter = 0.0;
  double crushed_depth = 0.0;     ///< largest, below the face [m]
  double cracked_diameter = 0.0;  ///< of the cracked zone on the face, crushed particles left out [m]
  double cracked_depth = 0.0;     ///< [m]
  /// Distance from the face to the nearest cracked particle that is not part of what hangs together with the face [m]:
  /// where a scab comes off.
  std::optional<double> spall_depth;
};

struct BrokenZones {
  int body = 0;
  BrokenPart crushed;  ///< compression damage 1
  BrokenPart cracked;  ///< tensile damage 1, not crushed
  BrokenPart damaged;  ///< damage at least 1/2, the two included
  std::vector<FaceZone> faces;
};

/// The zones of every body of concrete; none for others. A face is a side of the smallest box around the particles at
/// the start; those on mirror planes of the domain are left out.
[[nodiscard]] std::vector<BrokenZones> broken_zones(run::System const& system);

}  // namespace brisance::observe
