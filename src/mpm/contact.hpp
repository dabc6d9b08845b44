/// What grid fields that meet in a node do to each other. Those of bodies that part and slide meet where their surfaces
/// touch, see contact.cpp. Fluids that slip along bodies share the velocity along the normal at all times, and fields
/// that are glued all of it.
#pragma once

#include <algorithm>
#include <vector>

#include "mpm/workspace.hpp"

namespace brisance::mpm {

/// Unit normal from one field to another at a node, from their sums of volume times gradient of the shape function,
/// which point out of each. A rigid body alone knows its surface; otherwise the field with the larger sum does, the
/// other's being cut short at its corners [Lemiale10]; equal ones share. Zero where these know no direction.
[[nodiscard]] inline Vec3 contact_normal(NodeVelocity const& from, bool rigid_from, NodeVelocity const& to,
                                         bool rigid_to) {
  constexpr double alike = 1.0 - 1e-6;  // beyond round-off, so that mirror images choose alike
  double const a = from[0] * from[0] + from[1] * from[1] + from[2] * from[2];
  double const b = to[0] * to[0] + to[1] * to[1] + to[2] * to[2];
  double const take_from = rigid_from || (!rigid_to && a >= alike * b) ? 1.0 : 0.0;
  double const take_to = rigid_to || (!rigid_from && b >= alike * a) ? 1.0 : 0.0;
  Vec3 n{0.0, 0.0, 0.0};
  for (int d = 0; d < 3; ++d) n[d] = take_from * from[d] - take_to * to[d];
  double const length = norm(n);
  // Within a body the gradients of its particles cancel but for round-off, which has any direction.
  constexpr double round_off = 1e-9;  // of the part that is filled; a surface shows some tenths of it
  if (!(length > round_off * (from[3] + to[3]))) return {0.0, 0.0, 0.0};
  return (1.0 / length) * n;
}

/// The nodes of one block.
struct ContactNodes {
  int nodes = 0;
  int fields = 0;
  double mass_floor = 0.0;
  std::vector<Law> const* laws = nullptr;
  std::vector<std::optional<Vec3>> const* rigid = nullptr;
  std::vector<char> const* slips = nullptr;  ///< which of the two that slip is the fluid
};

/// What a fluid that slips feels of a body at a node.
struct Surface {
  bool felt = false;           ///< the body is near enough
  Vec3 normal{0.0, 0.0, 0.0};  ///< unit normal; zero inside the body, where nothing slips

  /// What of a relative velocity the surface does not let pass.
  [[nodiscard]] Vec3 stopped(Vec3 const& relative) const {
    return dot(normal, normal) > 0.0 ? dot(relative, normal) * normal : relative;
  }
};

/// The surface of a body at a node, from the fraction of the cells around the node that the body fills and h times its
/// gradient.
[[nodiscard]] inline Surface surface_at(NodeVelocity const& filled) {
  // B-splines reach one and a half cells: a node a cell before the face sees two hundredths of the body, and its
  // velocity is that of the gas. Sharing it there would move the outermost particles of the body with the gas; not
  // sharing it nearer, at 0.2, lets gas in. `HeldPlate.FeelsTheBurstAsAWallDoes` measures it.
  constexpr double least = 0.05;
  // Within the body the gradient is nothing but the noise of its particles. Any value from 0.01 to 0.1 gives the same.
  constexpr double steep = 0.1;
  Surface surface;
  Vec3 const gradient{filled[0], filled[1], filled[2]};
  double const size = norm(gradient);
  surface.felt = filled[3] >= least;
  if (size > steep * filled[3]) surface.normal = (1.0 / size) * gradient;
  return surface;
}

/// Makes the velocities of the fields that are glued or slip along others compatible. `at` gives access to them:
/// present(f), mass(f, node), whole(f, node): the mass with the images behind walls, which fluids have and bodies have
/// not, get(f, node), set(f, node, velocity), and gradient(f, node) of what it fills. It is told by give(fluid, body,
/// node, impulse) what a fluid gets from a body that it slips along [kg m/s].
template <class Access>
void make_compatible(ContactNodes const& c, Access&& at) {
  for (int node = 0; node < c.nodes; ++node) {
    int met = 0;
    for (int f = 0; f < c.fields; ++f) met += at.present(f) && at.mass(f, node) > c.mass_floor ? 1 : 0;
    if (met < 2) continue;
    for (int a = 0; a < c.fields; ++a) {
      if (!at.present(a) || !(at.mass(a, node) > c.mass_floor)) continue;
      for (int b = a + 1; b < c.fields; ++b) {
        if (!at.present(b) || !(at.mass(b, node) > c.mass_floor)) continue;
        Law const law = (*c.laws)[a * c.fields + b];
        if (law.kind == Law::Kind::contact) continue;
        bool const rigid_a = (*c.rigid)[a].has_value();
        bool const rigid_b = (*c.rigid)[b].has_value();
        if (rigid_a && rigid_b) continue;
        bool const slips = law.kind == Law::Kind::slips;
        double const ma = slips ? at.whole(a, node) : at.mass(a, node);
        double const mb = slips ? at.whole(b, node) : at.mass(b, node);
        // Shares of the change of the relative velocity.
        double const share_a = rigid_a ? 0.0 : rigid_b ? 1.0 : mb / (ma + mb);
        double const share_b = rigid_b ? 0.0 : rigid_a ? 1.0 : ma / (ma + mb);
        double const both = rigid_a ? mb : rigid_b ? ma : ma * share_a;
        Vec3 const va = at.get(a, node);
        Vec3 const vb = at.get(b, node);
        Vec3 const relative = va - vb;
        Vec3 change = relative;  // glued: all of it goes
        if (slips) {
          Surface const surface = surface_at(at.gradient((*c.slips)[a] != 0 ? b : a, node));
          if (!surface.felt) continue;
          change = surface.stopped(relative);
          if ((*c.slips)[a] != 0) {
            at.give(a, b, node, -both * change);
          } else {
            at.give(b, a, node, both * change);
          }
        }
        at.set(a, node, va - share_a * change);
        at.set(b, node, vb + share_b * change);
      }
    }
  }
}

}  // namespace brisance::mpm
