/// Particles of a gas that stretched too far split, see population.hpp.
#include <algorithm>
#include <array>
#include <cmath>

#include "mpm/population_set.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

/// Halvings of one particle in one call: more would mean that it grew by this power of two since the last.
constexpr int most_passes = 16;
/// Neighbours further away than this many cells count as that far.
constexpr int longest_sight = 2;
/// Fraction of the internal energy that may become kinetic energy of the halves with APIC.
constexpr double largest_loan = 0.01;

/// What limits a block on its low and high sides.
struct Wall {
  double position = 0.0;  ///< [m]
  int block = grid::no_neighbour;
  bool mirror = false;
  bool open = false;  ///< particles may pass: another block lies behind, and not around the domain
};

using Walls = std::array<std::array<Wall, 2>, 3>;

Walls walls_of(PopulationPlace const& place) {
  grid::Grid const& grid = *place.grid;
  grid::Domain const& domain = grid.domain();
  grid::CellRange const cells = grid.blocks()[place.block].in_domain();
  Walls walls;
  for (int d = 0; d < domain.dimensions(); ++d) {
    for (int side = 0; side < 2; ++side) {
      Side const next = beyond(grid, place.block, d, side);
      bool const end = side == 0 ? cells.lower[d] == 0 : cells.upper[d] == domain.cells[d];
      walls[d][side] = {place.patch->first[d] + side * place.patch->cells[d] * place.patch->h, next.block, next.mirror,
                        !next.mirror && !end && next.block != grid::no_neighbour};
    }
  }
  return walls;
}

/// Distance to the nearest neighbour on both sides along each direction.
struct Gaps {
  double length[3][2];
  bool seen[3][2];
};

/// Looks at the cells around that of particle q, `sight` to each side. A neighbour belongs to the direction in which it
/// is furthest away.
Gaps gaps_of(GasSet const& gas, Patch const& patch, Walls const& walls, PopulationScratch const& s, int q, int sight) {
  int const dims = patch.dimensions;
  double const far = longest_sight * gas.h;
  Gaps gaps{{{far, far}, {far, far}, {far, far}}, {}};
  grid::CellRange const cells = patch.cell_range();
  grid::CellRange const near = common(grid::around(cells.at(static_cast<std::size_t>(s.cell[q])), sight, dims), cells);
  for_each_row(near, [&](Index3 const& first) {
    std::size_t const row = cells.offset(first);
    for (int n = s.start[row]; n < s.start[row + static_cast<std::size_t>(near.n(0))]; ++n) {
      int const other = s.sorted[n];
      Vec3 way{0.0, 0.0, 0.0};
      double most = 0.0;
      for (int d = 0; d < dims; ++d) {
        way[d] = gas.x[d][other] - gas.x[d][q];
        most = std::max(most, std::abs(way[d]));
      }
      if (most == 0.0 || most >= far) continue;
      for (int d = 0; d < dims; ++d) {
        if (std::abs(way[d]) < most) continue;
        int const side = way[d] > 0.0 ? 1 : 0;
        gaps.seen[d][side] = true;
        gaps.length[d][side] = std::min(gaps.length[d][side], most);
      }
    }
  });
  for (int d = 0; d < dims; ++d) {
    for (int side = 0; side < 2; ++side) {
      // The nearest neighbour behind a mirror may be the particle's own image.
      double const image = 2.0 * std::abs(gas.x[d][q] - walls[d][side].position);
      if (!walls[d][side].mirror || image >= gaps.length[d][side]) continue;
      gaps.length[d][side] = image;
      gaps.seen[d][side] = true;
    }
  }
  return gaps;
}

/// Room that a particle has in each direction: half the way to the neighbours on both sides.
Vec3 room_of(GasSet const& gas, Patch const& patch, Walls const& walls, PopulationScratch const& s, int q) {
  Vec3 room{0.0, 0.0, 0.0};
  for (int sight = 1; sight <= longest_sight; ++sight) {
    Gaps gaps = gaps_of(gas, patch, walls, s, q, sight);
    bool all = true;
    for (int d = 0; d < patch.dimensions; ++d) {
      all = all && (gaps.seen[d][0] || gaps.seen[d][1]);
      // Ahead of a front nobody stands, behind the walls of the block someone unknown: either side is like the other.
      for (int side = 0; side < 2; ++side) {
        if (!gaps.seen[d][side]) gaps.length[d][side] = gaps.length[d][1 - side];
      }
      room[d] = 0.5 * (gaps.length[d][0] + gaps.length[d][1]);
    }
    if (all) break;
  }
  return room;
}

/// Splits particle q along direction d, the halves `offset` to both sides. Returns the kinetic energy gained [J].
double split(GasSet& gas, int q, int d, double offset, Walls const& walls, Outbox& out) {
  ParticleSet& set = *gas.set;
  Vec3 kick{0.0, 0.0, 0.0};
  double gain = 0.0;
  if (set.field(Field::affine_xx) != nullptr) {
    double square = 0.0;
    for (int i = 0; i < 3; ++i) {
      kick[i] = offset * set.field(Field::affine_xx + (3 * i + d))[q];
      square += kick[i] * kick[i];
    }
    double const limit = largest_loan * std::max(gas.energy[q], 0.0);
    double const scale = 0.5 * square > limit ? std::sqrt(2.0 * limit / square) : 1.0;
    for (double& k : kick) k *= scale;
    gain = 0.5 * square * scale * scale;
  }
  gas.energy[q] -= gain;
  gain *= gas.mass[q];
  gas.mass[q] *= 0.5;
  if (double* half = set.field(Field::half_x + d)) half[q] *= 0.5;

  // The half that stays in the block keeps the place in the set and the identity.
  int const outer = gas.x[d][q] + offset >= walls[d][1].position ? 1 : 0;
  double const sign = outer == 1 || gas.x[d][q] - offset >= walls[d][0].position ? 1.0 : -1.0;
  Vec3 x{gas.x[0][q], gas.x[1][q], gas.x[2][q]};
  x[d] += sign * offset;
  bool const leaves = x[d] < walls[d][0].position || x[d] >= walls[d][1].position;
  gas.x[d][q] -= sign * offset;
  Vec3 const v{gas.v[0][q], gas.v[1][q], gas.v[2][q]};
  for (int i = 0; i < 3; ++i) gas.v[i][q] = v[i] - sign * kick[i];
  ParticleSet& to = leaves ? out.particles : set;
  to.append(set, q);
  int const injected = to.size() - 1;
  to.field(Field::position_x + d)[injected] = x[d];
  for (int i = 0; i < 3; ++i) to.field(Field::velocity_x + i)[injected] = v[i] + sign * kick[i];
  to.field(Field::identity)[injected] = -1.0;
  if (leaves) {
    out.destination.push_back(walls[d][sign > 0.0 ? 1 : 0].block);
  } else {
    gas.find();
  }
  return gain;
}

/// Along the direction with the most room, half of what the particle has there and not beyond what is closed.
SplitWay way_of(GasSet const& gas, Patch const& patch, Walls const& walls, PopulationScratch const& s, int q) {
  int const dims = patch.dimensions;
  Vec3 room{0.0, 0.0, 0.0};
  if (gas.set->field(Field::half_x) != nullptr) {
    for (int d = 0; d < dims; ++d) {
      room[d] = 2.0 * std::min(gas.set->field(Field::half_x + d)[q], Gimp::longest_half * gas.h);
    }
  } else {
    room = room_of(gas, patch, walls, s, q);
  }
  SplitWay way;
  for (int d = 0; d < dims; ++d) {
    double offset = 0.25 * room[d];
    for (Wall const& wall : walls[d]) {
      if (!wall.open) offset = std::min(offset, 0.5 * std::abs(gas.x[d][q] - wall.position));
    }
    if (offset > way.offset) way = {d, offset};
  }
  return way;
}

}  // namespace

PopulationCount split_particles(ParticleSet& set, PopulationPlace const& place, PopulationOptions const& options,
                                PopulationScratch& scratch, Outbox& out) {
  PopulationCount count;
  GasSet gas(set, place);
  Patch const& patch = *place.patch;
  int const most = crowd_of(place, options);
  Walls walls;
  for (int pass = 0; pass < most_passes; ++pass) {
    scratch.due.clear();
    for (int q = 0; q < set.size(); ++q) {
      if (gas.mass[q] > options.split_volume * gas.standard(q) * gas.density[q] && gas.burnt(q)) {
        scratch.due.push_back(q);
      }
    }
    if (scratch.due.empty()) break;
    if (pass == 0) walls = walls_of(place);
    sort_by_cell(set, patch, scratch);
    // In a crowded cell the halves would merge at once, and split again, and so on.
    std::erase_if(scratch.due, [&](int q) {
      int const c = scratch.cell[q];
      return scratch.start[c + 1] - scratch.start[c] >= most;
    });
    if (scratch.due.empty()) break;
    list_particles(scratch);
    // All choose before any moves.
    scratch.ways.clear();
    for (int const q : scratch.due) scratch.ways.push_back(way_of(gas, patch, walls, scratch, q));
    long const before = count.split;
    for (std::size_t n = 0; n < scratch.due.size(); ++n) {
      // On a face of the domain there is no room yet.
      if (scratch.ways[n].offset <= 1e-9 * gas.h) continue;
      count.heat -= split(gas, scratch.due[n], scratch.ways[n].direction, scratch.ways[n].offset, walls, out);
      ++count.split;
    }
    if (count.split == before) break;
  }
  return count;
}

}  // namespace brisance::mpm
