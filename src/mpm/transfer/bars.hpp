/// Steel bars that run through particles.
#pragma once

#include "mpm/transfer/set.hpp"

namespace brisance::mpm {

/// Adds the stress of a bar to that of its particle.
inline void add_bar(ParticleSet const& set, int q, std::array<double, 6>& s) {
  double const f = set.field(Field::bar_fraction)[q] * set.field(Field::bar_stress)[q];
  Vec3 const n{set.field(Field::bar_x)[q], set.field(Field::bar_y)[q], set.field(Field::bar_z)[q]};
  for (int d = 0; d < 3; ++d) {
    s[d] += f * n[d] * n[d];
    s[3 + d] += f * n[d] * n[(d + 1) % 3];
  }
}

/// Stress and energy of the bars that run through a chunk; they make sound faster.
inline void strain_bars(SetView const& v, int begin, int n, double const (&e)[10][chunk], double (&sound)[chunk]) {
  ParticleSet& set = *v.set;
  double const* const number = set.field(Field::bar_number);
  for (int q = 0; q < n; ++q) {
    int const at = begin + q;
    if (number[at] == 0.0) continue;
    Bar const& bar = v.body->bars[static_cast<std::size_t>(number[at]) - 1];
    auto const direction = vector_at(set, Field::bar_x, at);
    Vec3 const m{*direction[0], *direction[1], *direction[2]};
    double const strain = m[0] * (m[0] * e[0][q] + 2.0 * (m[1] * e[3][q] + m[2] * e[5][q])) +
                          m[1] * (m[1] * e[1][q] + 2.0 * m[2] * e[4][q]) + m[2] * m[2] * e[2][q];
    double& stress = set.field(Field::bar_stress)[at];
    double& flow = set.field(Field::bar_plastic_strain)[at];
    BarState const end = stretched(bar, {stress, flow}, strain);
    double const per_mass = set.field(Field::bar_fraction)[at] / set.field(Field::density)[at];
    set.field(Field::energy)[at] += 0.5 * (stress + end.stress) * strain * per_mass;
    stress = end.stress;
    flow = end.plastic_strain;
    Vec3 const turned{m[0] + e[7][q] * m[2] - e[8][q] * m[1], m[1] + e[8][q] * m[0] - e[6][q] * m[2],
                      m[2] + e[6][q] * m[1] - e[7][q] * m[0]};
    double const length = norm(turned);
    for (int d = 0; d < 3; ++d) *direction[d] = turned[d] / length;
    sound[q] = std::sqrt(sound[q] * sound[q] + bar.E * per_mass);
  }
}

}  // namespace brisance::mpm
