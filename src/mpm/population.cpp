#include "mpm/population.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "mpm/patches.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

/// Halvings of one point in one call: more would mean that it grew by this power of two since the last.
constexpr int most_passes = 16;
/// Neighbours further away than this many cells count as that far.
constexpr int longest_sight = 2;
/// Part of the internal energy that may become kinetic energy of the halves with APIC.
constexpr double largest_loan = 0.01;
/// So many numbers in [0, 1] may all be further apart than a tenth; one more may not.
constexpr int compositions = 10;

/// The points of a set by cell.
void sort_by_cell(PointSet const& gas, Patch const& patch, double h, PopulationScratch& s) {
  int const cells = patch.cells[0] * patch.cells[1] * patch.cells[2];
  double const inverse_h = 1.0 / h;
  s.cell.assign(gas.size(), 0);
  int stride = 1;
  for (int d = 0; d < patch.dimensions; ++d) {
    double const* x = gas.field(Field::position_x + d);
    for (int q = 0; q < gas.size(); ++q) {
      int const i = static_cast<int>((x[q] - patch.first[d]) * inverse_h);
      s.cell[q] += stride * std::clamp(i, 0, patch.cells[d] - 1);
    }
    stride *= patch.cells[d];
  }
  s.start.assign(static_cast<std::size_t>(cells) + 1, 0);
  for (int const c : s.cell) ++s.start[c + 1];
  for (int c = 0; c < cells; ++c) s.start[c + 1] += s.start[c];
}

/// Points of a cell beyond which it is crowded.
int crowd_of(PopulationPlace const& place, PopulationOptions const& options) {
  int standard = 1;
  for (int d = 0; d < place.patch->dimensions; ++d) standard *= place.points_per_direction;
  return static_cast<int>(options.crowd * standard);
}

/// Needs `sort_by_cell`; leaves `start` as it was.
void list_points(PopulationScratch& s) {
  s.sorted.resize(s.cell.size());
  for (std::size_t q = s.cell.size(); q-- > 0;) {
    s.sorted[--s.start[s.cell[q] + 1]] = static_cast<int>(q);
  }
  // Every entry now holds the start of the cell before it.
  std::copy(s.start.begin() + 1, s.start.end(), s.start.begin());
  s.start.back() = static_cast<int>(s.cell.size());
}

/// A set with the names that splitting and merging need.
struct Gas {
  Gas(PointSet& set_, PopulationPlace const& place)
      : set(&set_),
        domain(&place.grid->domain()),
        points_per_direction(place.points_per_direction),
        lit_before(place.lit_before) {
    find();
  }
  /// Anew after points were appended.
  void find() {
    for (int d = 0; d < 3; ++d) {
      x[d] = set->field(Field::position_x + d);
      v[d] = set->field(Field::velocity_x + d);
    }
    mass = set->field(Field::mass);
    density = set->field(Field::density);
    pressure = set->field(Field::pressure);
    energy = set->field(Field::energy);
    lighting = set->field(Field::lighting_time);
    fraction = set->field(Field::volume_fraction);
  }
  [[nodiscard]] double volume(int q) const { return mass[q] / density[q]; }
  [[nodiscard]] double standard(int q) const { return standard_volume(*domain, points_per_direction, x[0][q]); }
  [[nodiscard]] bool burnt(int q) const { return lighting == nullptr || lighting[q] <= lit_before; }

  PointSet* set;
  grid::Domain const* domain;
  int points_per_direction;
  double lit_before;
  std::array<double*, 3> x{};
  std::array<double*, 3> v{};
  double* mass = nullptr;
  double* density = nullptr;
  double* pressure = nullptr;
  double* energy = nullptr;
  double* lighting = nullptr;
  double* fraction = nullptr;
};

/// What limits a block on its low and high sides.
struct Wall {
  double position = 0.0;  ///< [m]
  int block = grid::no_neighbour;
  bool mirror = false;
  bool open = false;  ///< points may pass: another block lies behind, and not around the domain
};

using Walls = std::array<std::array<Wall, 2>, 3>;

Walls walls_of(PopulationPlace const& place) {
  grid::Grid const& grid = *place.grid;
  grid::Domain const& domain = grid.domain();
  grid::Block const& block = grid.blocks()[place.block];
  Walls walls;
  for (int d = 0; d < domain.dimensions(); ++d) {
    for (int side = 0; side < 2; ++side) {
      Side const next = beyond(grid, place.block, d, side);
      bool const end = side == 0 ? block.origin[d] == 0 : block.origin[d] + block.n[d] == domain.cells[d];
      walls[d][side] = {place.patch->first[d] + side * place.patch->cells[d] * domain.h, next.block, next.mirror,
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

/// Looks at the cells around that of point q, `sight` to each side. A neighbour belongs to the direction in which it is
/// furthest away.
Gaps gaps_of(Gas const& gas, Patch const& patch, Walls const& walls, PopulationScratch const& s, int q, int sight) {
  int const dims = patch.dimensions;
  double const far = longest_sight * gas.domain->h;
  Gaps gaps{{{far, far}, {far, far}, {far, far}}, {}};
  Index3 low{0, 0, 0};
  Index3 high{0, 0, 0};
  int rest = s.cell[q];
  for (int d = 0; d < dims; ++d) {
    int const i = rest % patch.cells[d];
    rest /= patch.cells[d];
    low[d] = std::max(i - sight, 0);
    high[d] = std::min(i + sight, patch.cells[d] - 1);
  }
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      int const row = patch.cells[0] * (j + patch.cells[1] * k);
      for (int n = s.start[row + low[0]]; n < s.start[row + high[0] + 1]; ++n) {
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
    }
  }
  for (int d = 0; d < dims; ++d) {
    for (int side = 0; side < 2; ++side) {
      // The nearest neighbour behind a mirror may be the point's own image.
      double const image = 2.0 * std::abs(gas.x[d][q] - walls[d][side].position);
      if (!walls[d][side].mirror || image >= gaps.length[d][side]) continue;
      gaps.length[d][side] = image;
      gaps.seen[d][side] = true;
    }
  }
  return gaps;
}

/// Room that a point has in each direction: half the way to the neighbours on both sides.
Vec3 room_of(Gas const& gas, Patch const& patch, Walls const& walls, PopulationScratch const& s, int q) {
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

/// Splits point q along direction d, the halves `offset` to both sides. Returns the kinetic energy gained [J].
double split(Gas& gas, int q, int d, double offset, Walls const& walls, Outbox& out) {
  PointSet& set = *gas.set;
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
  PointSet& to = leaves ? out.points : set;
  to.append(set, q);
  int const born = to.size() - 1;
  to.field(Field::position_x + d)[born] = x[d];
  for (int i = 0; i < 3; ++i) to.field(Field::velocity_x + i)[born] = v[i] + sign * kick[i];
  to.field(Field::identity)[born] = -1.0;
  if (leaves) {
    out.destination.push_back(walls[d][sign > 0.0 ? 1 : 0].block);
  } else {
    gas.find();
  }
  return gain;
}

/// How much the states of two points must agree to become one.
enum class Likeness {
  composition,  ///< where a cell overflows
  state,        ///< a light point and any other
  size,         ///< and what would split again at once stays
};

bool may_merge(Gas const& gas, PopulationOptions const& options, int a, int b, Likeness wanted) {
  if (!gas.burnt(a) || !gas.burnt(b)) return false;
  if (gas.fraction != nullptr && std::abs(gas.fraction[a] - gas.fraction[b]) > options.composition) return false;
  if (wanted == Likeness::composition) return true;
  auto const near = [](double s, double t, double ratio) { return std::max(s, t) <= ratio * std::min(s, t); };
  if (!near(gas.pressure[a], gas.pressure[b], options.pressure_ratio)) return false;
  if (!near(gas.density[a], gas.density[b], options.density_ratio)) return false;
  double square = 0.0;
  for (int i = 0; i < 3; ++i) square += (gas.v[i][a] - gas.v[i][b]) * (gas.v[i][a] - gas.v[i][b]);
  double const reference = (gas.pressure[a] + gas.pressure[b]) / (gas.density[a] + gas.density[b]);
  if (square > options.speed * options.speed * reference) return false;
  return wanted == Likeness::state ||
         gas.volume(a) + gas.volume(b) <= options.split_volume * std::min(gas.standard(a), gas.standard(b));
}

double distance_square(Gas const& gas, int a, int b) {
  double square = 0.0;
  for (int d = 0; d < gas.domain->dimensions(); ++d) {
    double const way = gas.x[d][a] - gas.x[d][b];
    square += way * way;
  }
  return square;
}

/// The box of a merged point has the volume of both and is longer along the way between them, if that is not too long.
void merge_halves(Gas const& gas, int keep, int drop, double share) {
  int const dims = gas.domain->dimensions();
  std::array<double*, 3> half{};
  for (int d = 0; d < 3; ++d) half[d] = gas.set->field(Field::half_x + d);
  if (half[0] == nullptr) return;
  double both = 0.0;
  int along = 0;
  for (int const q : {keep, drop}) {
    double product = 1.0;
    for (int d = 0; d < dims; ++d) product *= half[d][q];
    both += product;
  }
  double product = 1.0;
  for (int d = 0; d < dims; ++d) {
    if (std::abs(gas.x[d][keep] - gas.x[d][drop]) > std::abs(gas.x[along][keep] - gas.x[along][drop])) along = d;
    half[d][keep] = (1.0 - share) * half[d][keep] + share * half[d][drop];
    product *= half[d][keep];
  }
  double const stretch = both / product;
  if (half[along][keep] * stretch <= Gimp::longest_half * gas.domain->h) {
    half[along][keep] *= stretch;
  } else {
    for (int d = 0; d < dims; ++d) half[d][keep] *= std::pow(stretch, 1.0 / dims);
  }
}

/// Point `drop` becomes a part of `keep`. Returns the heat [J].
double merge(Gas& gas, int keep, int drop) {
  PointSet& set = *gas.set;
  double const mass = gas.mass[keep] + gas.mass[drop];
  double const volume = gas.volume(keep) + gas.volume(drop);
  double const of_mass = gas.mass[drop] / mass;
  double const of_volume = gas.volume(drop) / volume;
  double square = 0.0;
  for (int i = 0; i < 3; ++i) square += (gas.v[i][keep] - gas.v[i][drop]) * (gas.v[i][keep] - gas.v[i][drop]);
  double const heat = 0.5 * gas.mass[keep] * of_mass * square;
  merge_halves(gas, keep, drop, of_volume);
  for (Quantity const& quantity : quantities) {
    for (int c = 0; c < quantity.components; ++c) {
      double* values = set.field(quantity.first + c);
      if (values == nullptr) continue;
      switch (quantity.merge) {
        case Merge::own: break;
        case Merge::by_volume: values[keep] += of_volume * (values[drop] - values[keep]); break;
        case Merge::largest: values[keep] = std::max(values[keep], values[drop]); break;
        case Merge::by_mass: values[keep] += of_mass * (values[drop] - values[keep]); break;
      }
    }
  }
  gas.energy[keep] += heat / mass;
  gas.mass[keep] = mass;
  gas.density[keep] = mass / volume;
  return heat;
}

/// Thins out one cell; the members are its points.
class Thinning {
 public:
  Thinning(Gas& gas, PopulationOptions const& options, PopulationScratch& scratch, PopulationCount& count)
      : gas_(&gas), options_(&options), s_(&scratch), count_(&count) {}

  /// Light points, the lightest first, go into the nearest that takes them.
  void absorb_light() {
    s_->stuck.clear();
    for (;;) {
      double heaviest = 0.0;
      for (int const q : s_->members) heaviest = std::max(heaviest, gas_->mass[q]);
      int lightest = -1;
      for (int const q : s_->members) {
        if (gas_->mass[q] * options_->mass_ratio >= heaviest || !gas_->burnt(q)) continue;
        if (gas_->volume(q) >= options_->small_volume * gas_->standard(q)) continue;
        if (std::find(s_->stuck.begin(), s_->stuck.end(), q) != s_->stuck.end()) continue;
        if (lightest < 0 || gas_->mass[q] < gas_->mass[lightest]) lightest = q;
      }
      if (lightest < 0) return;
      int partner = -1;
      double best = std::numeric_limits<double>::infinity();
      for (int const q : s_->members) {
        if (q == lightest || !may_merge(*gas_, *options_, lightest, q, Likeness::state)) continue;
        double const square = distance_square(*gas_, lightest, q);
        if (square >= best) continue;
        best = square;
        partner = q;
      }
      if (partner < 0) {
        s_->stuck.push_back(lightest);
      } else {
        join(lightest, partner);
        s_->stuck.clear();
      }
    }
  }

  /// Down to `most` points, or at least to `limit`.
  void thin_out(int most, int limit) {
    while (static_cast<int>(s_->members.size()) > most) {
      if (join_best(Likeness::size)) continue;
      if (static_cast<int>(s_->members.size()) <= limit || !join_best(Likeness::composition)) return;
    }
  }

 private:
  bool join_best(Likeness wanted) {
    int first = -1;
    int second = -1;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < s_->members.size(); ++i) {
      for (std::size_t j = i + 1; j < s_->members.size(); ++j) {
        int const a = s_->members[i];
        int const b = s_->members[j];
        // The second moment of the mass that merging takes away.
        double const moment =
            gas_->mass[a] * gas_->mass[b] / (gas_->mass[a] + gas_->mass[b]) * distance_square(*gas_, a, b);
        if (moment >= best || !may_merge(*gas_, *options_, a, b, wanted)) continue;
        best = moment;
        first = a;
        second = b;
      }
    }
    if (first >= 0) join(first, second);
    return first >= 0;
  }

  void join(int a, int b) {
    int const keep = gas_->mass[b] > gas_->mass[a] ? b : a;
    int const drop = keep == a ? b : a;
    count_->heat += merge(*gas_, keep, drop);
    ++count_->merged;
    s_->gone[drop] = 1;
    s_->members.erase(std::find(s_->members.begin(), s_->members.end(), drop));
  }

  Gas* gas_;
  PopulationOptions const* options_;
  PopulationScratch* s_;
  PopulationCount* count_;
};

}  // namespace

double standard_volume(grid::Domain const& domain, int points_per_direction, double r) {
  double const side = domain.h / points_per_direction;
  // Nearer to the axis than half its size a ring would vanish.
  double const radius = std::max(std::abs(r), 0.5 * side);
  switch (domain.geometry) {
    case grid::Geometry::cartesian3d: return side * side * side;
    case grid::Geometry::planar2d: return side * side;
    case grid::Geometry::planar1d: return side;
    case grid::Geometry::axisymmetric2d: return 2.0 * std::numbers::pi * radius * side * side;
    case grid::Geometry::cylindrical1d: return 2.0 * std::numbers::pi * radius * side;
    case grid::Geometry::spherical1d: return 4.0 * std::numbers::pi * (radius * radius + side * side / 12.0) * side;
  }
  return 0.0;
}

void check(PopulationOptions const& options) {
  auto const at_least = [](char const* name, double value, double bound, char const* why) {
    if (value >= bound) return;
    throw InputError(fmt::format("population of points: {} = {:.6g} is below {:.6g}, {}", name, value, bound, why));
  };
  at_least("split_volume", options.split_volume, 1.25, "standard points would split at once; 2 is usual");
  at_least("crowd", options.crowd, 1.5, "a cell of standard points would be crowded; 4 is usual");
  at_least("mass_ratio", options.mass_ratio, 2.0, "the halves of a point would merge again; 8 is usual");
  at_least("small_volume", options.small_volume, 0.0, "0 switches the merging of light points off; 0.5 is usual");
  at_least("composition", options.composition, 0.1, "the number of points in a mixed cell would have no bound");
  at_least("pressure_ratio", options.pressure_ratio, 1.0, "a ratio of the larger to the smaller; 1.2 is usual");
  at_least("density_ratio", options.density_ratio, 1.0, "a ratio of the larger to the smaller; 2 is usual");
  at_least("speed", options.speed, 0.0, "a magnitude; 0.35 is usual");
}

PopulationCount split_points(PointSet& set, PopulationPlace const& place, PopulationOptions const& options,
                             PopulationScratch& scratch, Outbox& out) {
  PopulationCount count;
  Gas gas(set, place);
  Patch const& patch = *place.patch;
  double const h = gas.domain->h;
  int const dims = patch.dimensions;
  bool const sized = set.field(Field::half_x) != nullptr;
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
    sort_by_cell(set, patch, h, scratch);
    // In a crowded cell the halves would merge at once, and split again, and so on.
    std::erase_if(scratch.due, [&](int q) {
      int const c = scratch.cell[q];
      return scratch.start[c + 1] - scratch.start[c] >= most;
    });
    if (scratch.due.empty()) break;
    list_points(scratch);
    // All choose before any moves.
    scratch.ways.clear();
    for (int const q : scratch.due) {
      Vec3 room{0.0, 0.0, 0.0};
      if (sized) {
        for (int d = 0; d < dims; ++d) {
          room[d] = 2.0 * std::min(set.field(Field::half_x + d)[q], Gimp::longest_half * h);
        }
      } else {
        room = room_of(gas, patch, walls, scratch, q);
      }
      SplitWay way;
      for (int d = 0; d < dims; ++d) {
        double offset = 0.25 * room[d];
        for (Wall const& wall : walls[d]) {
          if (!wall.open) offset = std::min(offset, 0.5 * std::abs(gas.x[d][q] - wall.position));
        }
        if (offset > way.offset) way = {d, offset};
      }
      scratch.ways.push_back(way);
    }
    long const before = count.split;
    for (std::size_t n = 0; n < scratch.due.size(); ++n) {
      // On a face of the domain there is no room yet.
      if (scratch.ways[n].offset <= 1e-9 * h) continue;
      count.heat -= split(gas, scratch.due[n], scratch.ways[n].direction, scratch.ways[n].offset, walls, out);
      ++count.split;
    }
    if (count.split == before) break;
  }
  return count;
}

PopulationCount merge_points(PointSet& set, PopulationPlace const& place, PopulationOptions const& options,
                             PopulationScratch& scratch) {
  PopulationCount count;
  if (set.empty()) return count;
  Gas gas(set, place);
  Patch const& patch = *place.patch;
  int const cells = patch.cells[0] * patch.cells[1] * patch.cells[2];
  int const most = crowd_of(place, options);
  int const limit = std::max(2 * most, compositions);

  sort_by_cell(set, patch, gas.domain->h, scratch);
  scratch.light.assign(cells, 0.0);
  for (int q = 0; q < set.size(); ++q) {
    double& light = scratch.light[scratch.cell[q]];
    light = std::max(light, gas.mass[q]);
  }
  for (double& light : scratch.light) light /= options.mass_ratio;
  // Nearly always there is nothing to do.
  scratch.busy.assign(cells, 0);
  bool any = false;
  for (int q = 0; q < set.size(); ++q) {
    int const c = scratch.cell[q];
    bool const light = gas.mass[q] < scratch.light[c] && gas.volume(q) < options.small_volume * gas.standard(q);
    if (!light && scratch.start[c + 1] - scratch.start[c] <= most) continue;
    scratch.busy[c] = 1;
    any = true;
  }
  if (!any) return count;
  scratch.due.clear();
  for (int c = 0; c < cells; ++c) {
    if (scratch.busy[c] != 0) scratch.due.push_back(c);
  }
  list_points(scratch);
  scratch.gone.assign(set.size(), 0);
  Thinning thinning(gas, options, scratch, count);
  for (int const c : scratch.due) {
    scratch.members.assign(scratch.sorted.begin() + scratch.start[c], scratch.sorted.begin() + scratch.start[c + 1]);
    thinning.absorb_light();
    thinning.thin_out(most, limit);
    thinning.absorb_light();  // what is light beside the points that just merged
  }
  if (count.merged == 0) return count;
  scratch.due.clear();
  for (int q = 0; q < set.size(); ++q) {
    if (scratch.gone[q] == 0) scratch.due.push_back(q);
  }
  set.reorder(scratch.due);
  return count;
}

}  // namespace brisance::mpm
