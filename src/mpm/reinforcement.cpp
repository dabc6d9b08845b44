#include "mpm/reinforcement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

Vec3 cross(Vec3 const& a, Vec3 const& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// How far x lies within the domain from a mirror plane; infinite for other faces.
double depth(grid::Domain const& domain, int face, Vec3 const& x) {
  int const d = face / 2;
  if (domain.boundary[face] != grid::Boundary::symmetry) return std::numeric_limits<double>::infinity();
  return face % 2 == 0 ? x[d] - domain.lower[d] : domain.upper(d) - x[d];
}

/// Part of a bar on this side of the mirror planes. What crosses one goes on behind it as the mirror image; a bar in
/// one has its other half beyond it.
double share_of_axis(Bar const& bar, grid::Domain const& domain) {
  double begin = 0.0;
  double end = 1.0;
  double halves = 1.0;
  double const near = 1e-9 * domain.smallest_cell();
  for (int face = 0; face < 2 * domain.dimensions(); ++face) {
    double const from = depth(domain, face, bar.from);
    double const to = depth(domain, face, bar.to);
    if (std::isinf(from)) continue;
    if (std::abs(from) < near && std::abs(to) < near) {
      halves *= 0.5;
    } else if (from < 0.0 && to < 0.0) {
      return 0.0;
    } else if (from < 0.0) {
      begin = std::max(begin, from / (from - to));
    } else if (to < 0.0) {
      end = std::min(end, from / (from - to));
    }
  }
  return halves * std::max(0.0, end - begin);
}

/// The same of the tube of a radius around its axis, by samples of equal volume.
double share_of_tube(Bar const& bar, double radius, grid::Domain const& domain) {
  constexpr int rings = 8;
  constexpr int angles = 16;
  constexpr int slices = 64;
  Vec3 const axis = bar.to - bar.from;
  Vec3 const n = (1.0 / norm(axis)) * axis;
  int least = 0;
  for (int d = 1; d < 3; ++d) least = std::abs(n[d]) < std::abs(n[least]) ? d : least;
  Vec3 e1{0.0, 0.0, 0.0};
  e1[least] = 1.0;
  e1 = e1 - dot(e1, n) * n;
  e1 = (1.0 / norm(e1)) * e1;
  Vec3 const e2 = cross(n, e1);
  int within = 0;
  for (int k = 0; k < slices; ++k) {
    for (int j = 0; j < angles; ++j) {
      double const angle = 2.0 * std::numbers::pi * (j + 0.5) / angles;
      for (int i = 0; i < rings; ++i) {
        double const r = radius * std::sqrt((i + 0.5) / rings);
        Vec3 const x = bar.from + ((k + 0.5) / slices) * axis + (r * std::cos(angle)) * e1 + (r * std::sin(angle)) * e2;
        bool inside = true;
        for (int face = 0; face < 2 * domain.dimensions(); ++face) inside = inside && depth(domain, face, x) >= 0.0;
        within += inside ? 1 : 0;
      }
    }
  }
  return static_cast<double>(within) / (rings * angles * slices);
}

}  // namespace

void Mpm::carry(int body, Field first, int components) {
  carried_[body].add(first, components);
  for (int b = 0; b < grid_.block_count(); ++b) {
    ParticleSet& set = particles(b, body);
    if (set.fields().has(first)) continue;
    ParticleSet grown(carried_[body]);
    for (int q = 0; q < set.size(); ++q) {
      grown.append();
      for (int f = 0; f < field_count; ++f) {
        if (double const* from = set.field(static_cast<Field>(f))) grown.field(static_cast<Field>(f))[q] = from[q];
      }
    }
    set = std::move(grown);
    work_->outbox[set_index(b, body)].particles = ParticleSet(carried_[body]);
  }
}

BarReport Mpm::reinforce(Bar const& bar) {
  grid::Domain const& domain = grid_.domain();
  Body& body = bodies_.at(bar.body);
  if (!body.solid.has_deviator() || body.rigid_velocity) {
    throw InputError(fmt::format("body \"{}\" cannot contain a bar: it has no strength or is rigid", body.name));
  }
  Vec3 const axis = bar.to - bar.from;
  double const length = norm(axis);
  if (!(length > 0.0 && bar.diameter > 0.0)) throw InputError("a bar needs a length and a diameter");
  Vec3 const n = (1.0 / length) * axis;
  double const radius = std::max(0.5 * bar.diameter, domain.smallest_cell());
  double const share = share_of_axis(bar, domain);
  carry(bar.body, Field::bar_number, 7);  // all that are named bar_
  auto const around = [&](ParticleSet const& set, int q) {
    Vec3 x{0.0, 0.0, 0.0};
    for (int d = 0; d < 3; ++d) x[d] = set.field(Field::position_x + d)[q];
    Vec3 const r = x - bar.from;
    double const along = dot(r, n);
    if (along < 0.0 || along > length) return false;
    return norm(r - along * n) <= radius * (1.0 + 1e-9);
  };
  double tube = 0.0;
  double taken = 0.0;
  for (int b = 0; b < grid_.block_count(); ++b) {
    ParticleSet const& set = particles(b, bar.body);
    for (int q = 0; q < set.size(); ++q) {
      if (!around(set, q)) continue;
      double const volume = set.field(Field::mass)[q] / set.field(Field::density)[q];
      (set.field(Field::bar_number)[q] > 0.0 ? taken : tube) += volume;
    }
  }
  double const specified = share * 0.25 * std::numbers::pi * bar.diameter * bar.diameter * length;
  double const steel = share_of_tube(bar, radius, domain) * std::numbers::pi * radius * radius * length;
  if (tube + taken < 0.7 * steel) {
    throw InputError(fmt::format(
        "a bar of body \"{}\" from ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g}) m is not inside the body: within {:g} m of "
        "its axis only {:.0f} % of the expected material points exist; keep a cell away from its surface",
        body.name, bar.from[0], bar.from[1], bar.from[2], bar.to[0], bar.to[1], bar.to[2], radius,
        100.0 * (tube + taken) / steel));
  }
  if (!(tube > specified)) {
    throw InputError(fmt::format(
        "there is no room for a bar of body \"{}\" next to the earlier bars: place them farther apart", body.name));
  }
  body.bars.push_back(bar);
  double const number = static_cast<double>(body.bars.size());
  for (int b = 0; b < grid_.block_count(); ++b) {
    ParticleSet& set = particles(b, bar.body);
    for (int q = 0; q < set.size(); ++q) {
      if (set.field(Field::bar_number)[q] > 0.0 || !around(set, q)) continue;
      set.field(Field::bar_number)[q] = number;
      set.field(Field::bar_fraction)[q] = specified / tube;
      for (int d = 0; d < 3; ++d) set.field(Field::bar_x + d)[q] = n[d];
    }
  }
  return {specified, specified / tube};
}

}  // namespace brisance::mpm
