#include "bridge/printed.hpp"

#include <algorithm>
#include <cmath>

namespace brisance::bridge {

long inject_as_printed(Faces const& faces, SharedGas const& shared, GasParticles& particles, double dt) {
  mpm::ParticleSet injected = particles.empty_set();
  for (int f = 0; f < faces.count(); ++f) {
    if (faces[f].open) continue;
    Primitive const& outside = shared.outside(f);
    Primitive const& inside = shared.inside(f);
    double const density = 0.5 * (outside.density + inside.density);                   // (40)
    double const speed = faces[f].inward(0.5 * (outside.velocity + inside.velocity));  // (41)
    if (speed <= 0.0) continue;
    double area = 0.0;
    for (int lane = 0; lane < faces.lanes(); ++lane) area += faces.lane_area(f, lane);
    double const flux = density * speed * area * dt;  // (43)
    double const existing = density * faces.standard_volume(faces[f].inside, faces.sub_cell(f, 0));
    int const rows = std::max(1, static_cast<int>(std::ceil(flux / existing / faces.lanes())));  // (45)
    double const mass = flux / (rows * faces.lanes());                                           // (46)
    for (int row = 0; row < rows; ++row) {
      double const depth = speed * dt * (row + 1.0) / rows;  // (47)
      for (int lane = 0; lane < faces.lanes(); ++lane)
        particles.append(f, lane, depth, mass, outside, {}, injected);  // (48)
    }
  }
  particles.add(injected);
  return injected.size();
}

}  // namespace brisance::bridge
