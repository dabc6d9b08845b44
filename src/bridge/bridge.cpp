#include "bridge/bridge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "gas/closure.hpp"

namespace brisance::bridge {

using mpm::Field;

namespace {

constexpr int group = 64;  // faces or cells that a thread takes at a time

/// Cells whose averages the bridge needs: the ghost cells and their neighbours, then the cells of the region at open
/// boundaries and those that stand for lent cells there.
std::vector<Index3> averaged_cells(Region const& region, std::map<Index3, int>& number) {
  std::vector<Index3> cells;
  auto const add = [&](Index3 const& cell) {
    auto const [found, fresh] = number.try_emplace(cell, static_cast<int>(cells.size()));
    if (fresh) cells.push_back(cell);
  };
  for (Index3 const& cell : region.ghosts()) add(cell);
  for (Index3 const& cell : region.ghosts()) {
    for (int d = 0; d < region.domain().dimensions(); ++d) {
      for (int const step : {-1, 1}) {
        Index3 there = cell;
        there[d] += step;
        if (region.inside(there)) add(there);
      }
    }
  }
  for (Face const& face : region.faces()) {
    if (face.open) add(face.inside);
  }
  for (Index3 const& cell : region.lent()) {
    Index3 const inner = region.clamped(cell);
    if (inner != cell && region.inside(inner)) add(inner);
  }
  return cells;
}

/// Gas cells that act as points: of the lent cells those of the domain, and for those beyond an open boundary but not
/// next to the region the gas cell that stands for them.
std::vector<Index3> state_cells(Region const& region, std::map<Index3, int>& number) {
  std::vector<Index3> cells;
  auto const add = [&](Index3 const& cell) {
    auto const [found, fresh] = number.try_emplace(cell, static_cast<int>(cells.size()));
    if (fresh) cells.push_back(cell);
  };
  for (Index3 const& cell : region.lent()) {
    Index3 const inner = region.clamped(cell);
    if (!region.inside(inner)) add(inner);
  }
  // The printed transport takes the mean of both sides of a face.
  for (Face const& face : region.faces()) {
    if (!face.open) add(face.inside);
  }
  return cells;
}

grid::Domain refined(grid::Domain domain, int parts) {
  for (int d = 0; d < domain.dimensions(); ++d) domain.cells[d] *= parts;
  domain.h /= parts;
  return domain;
}

long key_of(grid::Domain const& domain, Index3 const& cell) {
  return cell[0] + static_cast<long>(domain.cells[0]) * (cell[1] + static_cast<long>(domain.cells[1]) * cell[2]);
}

}  // namespace

Bridge::Bridge(gas::Gas& gas, mpm::Mpm& points, int gas_body, Region region, Options const& options,
               gas::MixtureState const& ambient)
    : gas_(&gas),
      points_(&points),
      gas_body_(gas_body),
      region_(std::move(region)),
      options_(options),
      lanes_domain_(refined(region_.domain(), options.points_per_direction)),
      ambient_(ambient),
      awake_(options.awake),
      averages_(gas.grid().domain(), points, region_.shift(),
                [&] {
                  std::map<Index3, int> number;
                  return averaged_cells(region_, number);
                }()),
      states_(gas.grid(), [&] {
        std::map<Index3, int> number;
        return state_cells(region_, number);
      }()) {
  std::map<Index3, int> average_of;
  averaged_cells(region_, average_of);
  std::map<Index3, int> state_of;
  state_cells(region_, state_of);
  grid::Domain const& domain = region_.domain();
  int const dims = domain.dimensions();
  for (Index3 const& cell : region_.ghosts()) {
    std::array<int, 6> neighbours{-1, -1, -1, -1, -1, -1};
    for (int d = 0; d < dims; ++d) {
      for (int side = 0; side < 2; ++side) {
        Index3 there = cell;
        there[d] += side == 0 ? -1 : 1;
        auto const found = average_of.find(there);
        if (found != average_of.end()) neighbours[2 * d + side] = found->second;
      }
    }
    ghost_neighbours_.push_back(neighbours);
    ghost_blocks_.push_back(gas.grid().block_of(cell));
  }
  std::sort(ghost_blocks_.begin(), ghost_blocks_.end());
  ghost_blocks_.erase(std::unique(ghost_blocks_.begin(), ghost_blocks_.end()), ghost_blocks_.end());
  set_roles();
  for (Face& face : region_.faces()) {
    if (!face.open) face.watch = gas.watch(face.side == 0 ? face.outside() : face.inside, face.direction);
  }

  // Lent cells by the blocks of the points that they lie in.
  points.lend_as(gas_body);
  std::map<int, std::vector<LentCell>> by_block;
  for (Index3 const& cell : region_.lent()) {
    Index3 const inner = region_.clamped(cell);
    LentCell lent;
    lent.cell = cell;
    if (region_.inside(inner)) {
      lent.average = average_of.at(inner);
    } else {
      lent.state = state_of.at(inner);
    }
    Index3 at{0, 0, 0};
    for (int d = 0; d < dims; ++d) at[d] = cell[d] + region_.shift()[d];
    by_block[points.grid().block_of(at)].push_back(lent);
  }
  for (auto& [block, cells] : by_block) {
    lent_.push_back({block, std::move(cells)});
    leaving_blocks_.push_back(block);
  }
  for (std::size_t n = 0; n < leaving_blocks_.size(); ++n) leavers_.emplace_back(points.fields(gas_body));

  for (int d = 1; d < dims; ++d) lanes_per_face_ *= options.points_per_direction;
  auto const& faces = region_.faces();
  ledger_.resize(faces.size() * lanes_per_face_);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    Lanes lanes;
    if (faces[f].open) {
      lanes.average = average_of.at(faces[f].inside);
    } else {
      lanes.outside_state = state_of.at(faces[f].outside());
      lanes.inside_state = state_of.at(faces[f].inside);
    }
    lanes_.push_back(lanes);
    auto [found, fresh] = faces_of_.try_emplace(key_of(domain, faces[f].inside));
    if (fresh) found->second.fill(-1);
    found->second[2 * faces[f].direction + faces[f].side] = static_cast<int>(f);
  }

  for (LentBlock& block : lent_) {
    for (LentCell& cell : block.cells) cell.face = faces_before(cell.cell);
  }

  find_neighbours();
  outwards_.assign(faces.size(), 0);

  // Blocks of points that touch the bridge or its ghost cells.
  for (int b = 0; b < points.grid().block_count(); ++b) {
    grid::Block const& block = points.grid().blocks()[b];
    bool touches = false;
    for (int k = 0; k < block.n[2] && !touches; ++k) {
      for (int j = 0; j < block.n[1] && !touches; ++j) {
        for (int i = 0; i < block.n[0] && !touches; ++i) {
          Index3 cell{block.origin[0] + i, block.origin[1] + j, block.origin[2] + k};
          for (int d = 0; d < dims; ++d) cell[d] -= region_.shift()[d];
          touches = is_forbidden(cell);
        }
      }
    }
    if (touches) bridge_blocks_.push_back(b);
  }
}

bool Bridge::is_forbidden(Index3 const& cell) const {
  if (region_.clamped(cell) != cell) return false;  // beyond an open boundary: it leaves
  return region_.layer(cell) <= region_.width() + 2;
}

void Bridge::set_roles() {
  grid::Grid const& grid = gas_->grid();
  for (int b = 0; b < grid.block_count(); ++b) {
    grid::Block const& block = grid.blocks()[b];
    std::vector<gas::Role> roles;
    roles.reserve(block.cell_count());
    for (int k = 0; k < block.n[2]; ++k) {
      for (int j = 0; j < block.n[1]; ++j) {
        for (int i = 0; i < block.n[0]; ++i) {
          roles.push_back(region_.role({block.origin[0] + i, block.origin[1] + j, block.origin[2] + k}));
        }
      }
    }
    gas_->set_roles(b, std::move(roles));
  }
}

bool Bridge::wake() {
  if (awake_) return true;
  auto const& cells = region_.lent();
  grid::Grid const& grid = gas_->grid();
  for (Index3 const& cell : cells) {
    if (region_.clamped(cell) != cell) continue;
    int const b = grid.block_of(cell);
    if (!gas_->awake(b)) continue;
    Index3 const& o = grid.blocks()[b].origin;
    double const p = gas_->primitive(b, cell[0] - o[0], cell[1] - o[1], cell[2] - o[2]).pressure;
    if (std::abs(p - ambient_.pressure) > options_.activation) {
      awake_ = true;
      points_->set_time(gas_->time());
      return true;
    }
  }
  return false;
}

double Bridge::specific_energy(GasState const& s) const {
  double const Y = s.mass_fraction;
  return gas::mixture(gas_->fluids(), (1.0 - Y) * s.density, Y * s.density, s.volume_fraction).rho_e(s.pressure) /
         s.density;
}

GasState Bridge::state_of(CellSums const& sums) const {
  gas::Primitive const w = primitive(sums);
  return {w.density, w.velocity, w.pressure, w.mass_fraction, w.volume_fraction};
}

gas::Primitive Bridge::primitive(CellSums const& s) const {
  gas::Primitive w;
  double const mass = s.mass[0] + s.mass[1];
  w.density = mass / s.volume;
  w.velocity = (1.0 / mass) * s.momentum;
  w.mass_fraction = s.mass[1] / mass;
  w.volume_fraction = s.volume_second / s.volume;
  gas::Mixture const m = gas::mixture(gas_->fluids(), s.mass[0] / s.volume, s.mass[1] / s.volume, w.volume_fraction);
  w.pressure = m.pressure(s.energy / s.volume);
  w.sound_speed = std::sqrt(std::max(0.0, m.bulk_modulus(w.pressure)) / w.density);
  return w;
}

namespace {

/// From a mean over points with the weight of a quadratic B-spline (second moment h^2/4) to one over the cell (h^2/12):
/// f - (1/4 - 1/12)/2 h^2 f''. Not across jumps, where there is no f''.
constexpr double sharpening = 1.0 / 12.0;
constexpr double steep = 0.2;  ///< relative difference of pressure or density that counts as a jump

}  // namespace

/// The velocity of points stands half a step of theirs behind their stress (Eqs. (22)-(25) are a leapfrog): the ghost
/// cells take it forward with the gradient of the pressure. Without that, gas and points would see each other's waves
/// out of step by half a step, and reflect them.
void Bridge::fill_ghost(int n) {
  auto const& sums = averages_.sums();
  Index3 const& cell = region_.ghosts()[n];
  double const enough = 0.1 * region_.domain().cell_volume(cell[0]);
  // Next to solids a ghost cell of the ghost cells may hold hardly any gas: it keeps what it has.
  if (sums[n].volume < enough) return;
  GasState const own = state_of(sums[n]);
  GasState s = own;
  for (int d = 0; d < region_.domain().dimensions(); ++d) {
    int const low = ghost_neighbours_[n][2 * d];
    int const high = ghost_neighbours_[n][2 * d + 1];
    if (low < 0 || high < 0 || sums[low].volume < enough || sums[high].volume < enough) continue;
    GasState const below = state_of(sums[low]);
    GasState const above = state_of(sums[high]);
    if (is_jump(own, below, steep) || is_jump(own, above, steep)) continue;
    auto const second = [](double a, double b, double c) { return a - 2.0 * b + c; };
    s.density -= sharpening * second(below.density, own.density, above.density);
    s.pressure -= sharpening * second(below.pressure, own.pressure, above.pressure);
    for (int c = 0; c < 3; ++c) {
      s.velocity[c] -= sharpening * second(below.velocity[c], own.velocity[c], above.velocity[c]);
    }
    s.velocity[d] -= 0.5 * last_step_ * (above.pressure - below.pressure) / (2.0 * region_.domain().h * own.density);
  }
  grid::Grid const& grid = gas_->grid();
  int const b = grid.block_of(cell);
  grid::Block const& block = grid.blocks()[b];
  double const second_density = s.density * s.mass_fraction;
  gas_->set_conserved(b, block.offset(cell[0] - block.origin[0], cell[1] - block.origin[1], cell[2] - block.origin[2]),
                      s.density - second_density, second_density, s.density * s.velocity,
                      s.density * (specific_energy(s) + 0.5 * dot(s.velocity, s.velocity)), s.volume_fraction);
}

void Bridge::lend_nodes_to_ghosts() {
  averages_.compute(*points_, gas_body_);
  grid::Grid const& grid = gas_->grid();
  int const count = static_cast<int>(region_.ghosts().size());
  parallel_for((count + group - 1) / group, [&](int g, int) {
    for (int n = g * group; n < std::min(count, (g + 1) * group); ++n) fill_ghost(n);
  });
  for (int const block : ghost_blocks_) gas_->wake(block);
  if (dot(ambient_.velocity, ambient_.velocity) > 0.0) {
    // Blocks that sleep in a uniform wind would not tell what flows through their faces.
    for (Face const& face : region_.faces()) {
      if (!face.open) gas_->wake(grid.block_of(face.outside()));
    }
  }
}

std::array<int, 3> Bridge::faces_before(Index3 const& cell) const {
  int const dims = region_.domain().dimensions();
  // The nearest cell of the region, with as few directions to go as can be.
  Index3 reach{0, 0, 0};
  for (int d = 0; d < dims; ++d) reach[d] = 3;
  int best = 1000;
  Index3 offset{0, 0, 0};
  for (int k = -reach[2]; k <= reach[2]; ++k) {
    for (int j = -reach[1]; j <= reach[1]; ++j) {
      for (int i = -reach[0]; i <= reach[0]; ++i) {
        int const distance = i * i + j * j + k * k;
        if (distance >= best || !region_.inside({cell[0] + i, cell[1] + j, cell[2] + k})) continue;
        best = distance;
        offset = {i, j, k};
      }
    }
  }
  std::array<int, 3> faces{-1, -1, -1};
  Index3 const inside{cell[0] + offset[0], cell[1] + offset[1], cell[2] + offset[2]};
  for (int d = 0; d < dims; ++d) {
    if (offset[d] != 0) faces[d] = find_face(inside, d, offset[d] > 0 ? 0 : 1);
  }
  return faces;
}

namespace {

/// The velocity gradient that APIC's points carry.
void set_gradient(mpm::PointSet& set, int q, GasSlopes const& slopes, int dimensions, double h) {
  if (set.field(Field::affine_xx) == nullptr) return;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < dimensions; ++c) set.field(Field::affine_xx + (3 * r + c))[q] = slopes.velocity[c][r] / h;
  }
}

}  // namespace

void Bridge::lend_cell(LentCell const& lent, double begin, double end, mpm::PointSet& set) const {
  GasState centre;
  GasSlopes slopes;
  GasState next;
  GasSlopes next_slopes;
  if (lent.state >= 0) {
    // Pressure and density at the beginning; the velocity, as that of the points, half a step behind it.
    double const half_step = 0.5 * (end - begin);
    states_.at(lent.state, begin, centre, slopes);
    GasState before;
    GasSlopes slopes_before;
    states_.at(lent.state, begin - half_step, before, slopes_before);
    centre.velocity = before.velocity;
    slopes.velocity = slopes_before.velocity;
    states_.at(lent.state, end - half_step, next, next_slopes);
  } else {
    CellSums const& s = averages_.sums()[lent.average];
    if (s.volume < 0.1 * region_.domain().cell_volume(region_.clamped(lent.cell)[0])) return;  // a solid lies there
    centre = state_of(s);
    next = centre;
  }
  grid::Domain const& domain = region_.domain();
  int const parts = options_.points_per_direction;
  int const dims = domain.dimensions();
  Index3 n{1, 1, 1};
  for (int d = 0; d < dims; ++d) n[d] = parts;
  double const half = 0.5 * domain.h / parts;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        Index3 const sub{i, j, k};
        Vec3 offset{0.0, 0.0, 0.0};
        Vec3 x = domain.centre({0, 0, 0});
        for (int d = 0; d < dims; ++d) {
          offset[d] = (sub[d] + 0.5) / parts - 0.5;
          x[d] = domain.lower[d] + (lent.cell[d] + (sub[d] + 0.5) / parts) * domain.h;
        }
        for (int d = 0; d < dims; ++d) {
          if (lent.face[d] < 0) continue;
          // The gas that the ledger holds fills this length before the face, or lacks there.
          int const lane = lane_of(lent.face[d], x);
          double const held = ledger_[static_cast<std::size_t>(lent.face[d]) * lanes_per_face_ + lane].volume;
          double const length = held / lane_area(lent.face[d], lane);
          double const inwards = region_.faces()[lent.face[d]].side == 0 ? 1.0 : -1.0;
          double const shift = inwards * std::clamp(length, -2.0 * half, 2.0 * half);
          x[d] += shift;
          offset[d] += shift / domain.h;
        }
        GasState const s = at_offset(centre, slopes, offset);
        GasState const later = at_offset(next, next_slopes, offset);
        int const q = set.append();
        for (int d = 0; d < 3; ++d) {
          set.field(Field::position_x + d)[q] = x[d];
          set.field(Field::velocity_x + d)[q] = s.velocity[d];
          set.field(Field::next_x + d)[q] = later.velocity[d];
          if (double* h = set.field(Field::half_x + d)) h[q] = half;
          if (double* filtered = set.field(Field::filtered_x + d)) filtered[q] = 0.0;
        }
        set_gradient(set, q, slopes, dims, domain.h);
        set.field(Field::density)[q] = s.density;
        set.field(Field::pressure)[q] = s.pressure;
        set.field(Field::mass)[q] = s.density * standard_volume(lent.cell, sub);
      }
    }
  }
}

double Bridge::standard_volume(Index3 const& cell, Index3 const& sub) const {
  // Beyond an open boundary at a negative radius there is nothing.
  return std::abs(lanes_domain_.cell_volume(cell[0] * options_.points_per_direction + sub[0]));
}

void Bridge::lend_cells_to_nodes(double begin, double end) {
  parallel_for(static_cast<int>(lent_.size()), [&](int n, int) {
    mpm::PointSet& set = points_->lent(lent_[n].block);
    set.reorder({});
    for (LentCell const& cell : lent_[n].cells) lend_cell(cell, begin, end, set);
  });
  points_->lending_done();
  take_reference_off();
}

/// Forces come from differences of pressure: the same pressure taken off everywhere changes nothing but the error of
/// the sums over points, which is proportional to what is left. It must not exceed the lowest pressure of the gas:
/// points under negative pressure attract each other and gather in clumps.
void Bridge::take_reference_off() {
  double reference =
      options_.reference_pressure.value_or(std::clamp(points_->lowest_pressure(gas_body_), 0.0, ambient_.pressure));
  for (int body = 0; body < static_cast<int>(points_->bodies().size()); ++body) {
    // The stress of solids counts from the ambient pressure.
    bool const is_gas = body == gas_body_;
    points_->set_reference_pressure(body, is_gas ? reference : reference - ambient_.pressure);
  }
}

int Bridge::find_face(Index3 const& inside, int direction, int side) const {
  auto const found = faces_of_.find(key_of(region_.domain(), inside));
  return found == faces_of_.end() ? -1 : found->second[2 * direction + side];
}

int Bridge::lane_of(int face, Vec3 const& x) const {
  Face const& f = region_.faces()[face];
  grid::Domain const& domain = region_.domain();
  int const parts = options_.points_per_direction;
  int lane = 0;
  int stride = 1;
  for (int d = 0; d < domain.dimensions(); ++d) {
    if (d == f.direction) continue;
    double const u = (x[d] - domain.lower[d]) / domain.h - f.inside[d];
    lane += stride * std::clamp(static_cast<int>(std::floor(u * parts)), 0, parts - 1);
    stride *= parts;
  }
  return lane;
}

Index3 Bridge::sub_cell(int face, int lane) const {
  Face const& f = region_.faces()[face];
  int const parts = options_.points_per_direction;
  Index3 sub{0, 0, 0};
  for (int d = 0; d < region_.domain().dimensions(); ++d) {
    if (d == f.direction) {
      sub[d] = f.side == 0 ? 0 : parts - 1;
    } else {
      sub[d] = lane % parts;
      lane /= parts;
    }
  }
  return sub;
}

int Bridge::lane_at(int face, Index3 const& sub) const {
  int lane = 0;
  int stride = 1;
  for (int d = 0; d < region_.domain().dimensions(); ++d) {
    if (d == region_.faces()[face].direction) continue;
    lane += stride * sub[d];
    stride *= options_.points_per_direction;
  }
  return lane;
}

void Bridge::find_neighbours() {
  auto const& faces = region_.faces();
  int const dims = region_.domain().dimensions();
  int const parts = options_.points_per_direction;
  lane_neighbours_.assign(ledger_.size(), {-1, -1, -1, -1});
  for (int f = 0; f < static_cast<int>(faces.size()); ++f) {
    Face const& face = faces[f];
    if (face.open) continue;
    for (int lane = 0; lane < lanes_per_face_; ++lane) {
      Index3 const sub = sub_cell(f, lane);
      auto& neighbours = lane_neighbours_[static_cast<std::size_t>(f) * lanes_per_face_ + lane];
      int n = 0;
      for (int d = 0; d < dims; ++d) {
        if (d == face.direction) continue;
        for (int side = 0; side < 2; ++side, ++n) {
          int other = f;
          Index3 there = sub;
          there[d] += side == 0 ? -1 : 1;
          if (there[d] < 0 || there[d] >= parts) {
            // The next face of the same direction, or the one around the edge.
            Index3 next = face.inside;
            next[d] += side == 0 ? -1 : 1;
            there[d] = side == 0 ? parts - 1 : 0;
            other = region_.inside(next) ? find_face(next, face.direction, face.side) : -1;
            if (other < 0) {
              other = find_face(face.inside, d, side);
              there = sub;
            }
          }
          if (other < 0 || faces[other].open) continue;
          neighbours[n] = other * lanes_per_face_ + lane_at(other, there);
        }
      }
    }
  }
}

/// Where gas flows out at an angle, points leave through other lanes than the fluxes say: rows of points cross a face
/// in few places, the flux does so evenly. Without an exchange along the surface the accounts would drift apart without
/// bound. Half of the difference to the neighbours is evened out in every step; not where gas flows in, for points are
/// born there when their lane is ripe, and lanes in step make regular rows.
void Bridge::level_ledger() {
  if (region_.domain().dimensions() == 1) return;
  double const rate = 0.5 / (2.0 * (region_.domain().dimensions() - 1));
  levelled_ = ledger_;
  auto const flows_out = [&](std::size_t lane) { return outwards_[lane / lanes_per_face_] != 0; };
  for (std::size_t n = 0; n < ledger_.size(); ++n) {
    if (!flows_out(n)) continue;
    for (int const other : lane_neighbours_[n]) {
      if (other < 0 || !flows_out(other)) continue;
      ledger_[n].add(levelled_[other], rate);
      ledger_[n].add(levelled_[n], -rate);
    }
  }
}

double Bridge::lane_area(int face, int lane) const {
  Face const& f = region_.faces()[face];
  int const parts = options_.points_per_direction;
  Index3 const sub = sub_cell(face, lane);
  int i = f.inside[0] * parts + sub[0];
  if (f.direction == 0 && f.side == 1) ++i;
  return lanes_domain_.face_area(f.direction, i);
}

Ledger Bridge::carried(mpm::PointSet const& set, int q) const {
  double const m = set.field(Field::mass)[q];
  double const* second = set.field(Field::mass_fraction);
  double const m1 = second == nullptr ? 0.0 : m * second[q];
  Ledger l;
  l.mass = {m - m1, m1};
  double square = 0.0;
  for (int d = 0; d < 3; ++d) {
    double const v = set.field(Field::velocity_x + d)[q];
    l.momentum[d] = m * v;
    square += v * v;
  }
  l.energy = m * (set.field(Field::energy)[q] + 0.5 * square);
  l.volume = m / set.field(Field::density)[q];
  if (points_->keeps_energy(gas_body_)) l.energy += m * mpm::affine_energy(set, q, region_.domain().h);
  return l;
}

Index3 Bridge::cell_at(Vec3 const& x) const {
  grid::Domain const& domain = region_.domain();
  Index3 cell{0, 0, 0};
  for (int d = 0; d < domain.dimensions(); ++d) {
    // By the grid of the points, as they are sorted into it.
    grid::Domain const& own = region_.points_domain();
    cell[d] = static_cast<int>(std::floor((x[d] - own.lower[d]) / own.h)) - region_.shift()[d];
  }
  return cell;
}

int Bridge::crossed_face(Vec3 const& x, Vec3 const& move) const {
  int const dims = region_.domain().dimensions();
  Index3 const to = cell_at(x);
  Index3 cell = cell_at(x - move);
  for (int d = 0; d < dims; ++d) {
    if (std::abs(cell[d] - to[d]) > 1) cell[d] = to[d];  // came around a periodic direction
  }
  if (!region_.inside(cell)) {
    // By round-off it did not start inside: the nearest cell of the region next to where it is.
    Index3 const reach{dims > 0 ? 1 : 0, dims > 1 ? 1 : 0, dims > 2 ? 1 : 0};
    int nearest = 4;
    for (int k = -reach[2]; k <= reach[2]; ++k) {
      for (int j = -reach[1]; j <= reach[1]; ++j) {
        for (int i = -reach[0]; i <= reach[0]; ++i) {
          Index3 const there{to[0] + i, to[1] + j, to[2] + k};
          int const distance = std::abs(i) + std::abs(j) + std::abs(k);
          if (distance >= nearest || !region_.inside(there)) continue;
          nearest = distance;
          cell = there;
        }
      }
    }
    if (nearest == 4) throw NumericalError("a gas point left the MPM region by more than a cell in one step");
  }
  for (int d = 0; d < dims; ++d) {
    while (cell[d] != to[d]) {
      int const side = to[d] > cell[d] ? 1 : 0;
      Index3 next = cell;
      next[d] += side == 0 ? -1 : 1;
      if (!region_.inside(next)) return find_face(cell, d, side);
      cell = next;
    }
  }
  return -1;
}

void Bridge::take_leavers() {
  parallel_for(static_cast<int>(leaving_blocks_.size()), [&](int n, int) {
    leavers_[n].reorder({});
    points_->take_out(
        leaving_blocks_[n], gas_body_,
        [&](mpm::PointSet const& set, int q) {
          Vec3 const x{set.field(Field::position_x)[q], set.field(Field::position_y)[q],
                       set.field(Field::position_z)[q]};
          return !region_.inside(cell_at(x));
        },
        leavers_[n]);
  });
  for (mpm::PointSet const& set : leavers_) {
    for (int q = 0; q < set.size(); ++q) {
      Vec3 x{0.0, 0.0, 0.0};
      Vec3 move{0.0, 0.0, 0.0};
      for (int d = 0; d < 3; ++d) {
        x[d] = set.field(Field::position_x + d)[q];
        move[d] = set.field(Field::move_x + d)[q];
      }
      int const face = crossed_face(x, move);
      Ledger const load = carried(set, q);
      ++traffic_.left;
      Face const& f = region_.faces()[face];
      if (f.open) {
        traffic_.outflow.add(load);
      } else if (options_.transport == Transport::ledger) {
        ledger_[static_cast<std::size_t>(face) * lanes_per_face_ + lane_of(face, x)].add(load);
      } else {
        add_to_cell(f.outside(), load);
      }
    }
  }
}

/// [Cui14] Eqs. (49)-(51).
void Bridge::add_to_cell(Index3 const& cell, Ledger const& load) {
  grid::Grid const& grid = gas_->grid();
  int const b = grid.block_of(cell);
  grid::Block const& block = grid.blocks()[b];
  int const at = block.offset(cell[0] - block.origin[0], cell[1] - block.origin[1], cell[2] - block.origin[2]);
  double const inverse = 1.0 / grid.domain().cell_volume(cell[0]);
  grid::Fields& u = gas_->fields();
  u.at(b, gas::density)[at] += inverse * load.mass[0];
  for (int d = 0; d < 3; ++d) u.at(b, gas::momentum_x + d)[at] += inverse * load.momentum[d];
  u.at(b, gas::energy)[at] += inverse * load.energy;
  if (gas_->fluids().two) u.at(b, gas::second_density)[at] += inverse * load.mass[1];
  gas_->wake(b);
}

void Bridge::add_fluxes(double share, double dt) {
  auto const& faces = region_.faces();
  auto const& watched = gas_->watched();
  Traffic& t = traffic_;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    Face const& face = faces[f];
    double const sign = face.side == 0 ? share : -share;
    if (!face.open) {
      gas::FaceFlux const& flux = watched[face.watch];
      if (flux.impulse == 0.0) continue;  // both sides sleep
      outwards_[f] = sign * (flux.mass[0] + flux.mass[1]) < 0.0 ? 1 : 0;
      Ledger const per_area{flux.mass, flux.momentum, flux.energy, flux.volume};
      double area = 0.0;
      for (int lane = 0; lane < lanes_per_face_; ++lane) {
        double const a = lane_area(static_cast<int>(f), lane);
        area += a;
        if (options_.transport == Transport::ledger) ledger_[f * lanes_per_face_ + lane].add(per_area, sign * a);
      }
      t.pressure_work += sign * area * flux.work;
      t.pressure_impulse[face.direction] += sign * area * flux.impulse;
      continue;
    }
    // An open boundary: the gas beyond is what it is on this side.
    CellSums const& sums = averages_.sums()[lanes_[f].average];
    if (sums.volume < 0.1 * region_.domain().cell_volume(face.inside[0])) continue;
    GasState const s = state_of(sums);
    double const inward = face.inward(s.velocity);
    double const e = specific_energy(s) + 0.5 * dot(s.velocity, s.velocity);
    for (int lane = 0; lane < lanes_per_face_; ++lane) {
      double const a = lane_area(static_cast<int>(f), lane) * dt;
      t.outflow.energy -= a * inward * s.pressure;
      if (inward <= 0.0) continue;
      double const mass = a * inward * s.density;
      Ledger const in{
          {mass * (1.0 - s.mass_fraction), mass * s.mass_fraction}, mass * s.velocity, mass * e, a * inward};
      ledger_[f * lanes_per_face_ + lane].add(in);
      t.outflow.add(in, -1.0);
    }
  }
}

GasState Bridge::donor_state(int face, int lane, GasSlopes& slopes) const {
  slopes = {};
  if (lanes_[face].average >= 0) return state_of(averages_.sums()[lanes_[face].average]);
  Face const& f = region_.faces()[face];
  GasState centre;
  states_.at(lanes_[face].outside_state, 1.0, centre, slopes);
  Index3 const sub = sub_cell(face, lane);
  Vec3 offset{0.0, 0.0, 0.0};
  for (int d = 0; d < region_.domain().dimensions(); ++d) {
    offset[d] = d == f.direction ? (f.side == 0 ? 0.5 : -0.5) : (sub[d] + 0.5) / options_.points_per_direction - 0.5;
  }
  return at_offset(centre, slopes, offset);
}

void Bridge::append_point(int face, int lane, double depth, double mass, GasState const& s, GasSlopes const& slopes,
                          mpm::PointSet& to) const {
  Face const& f = region_.faces()[face];
  grid::Domain const& domain = region_.domain();
  int const parts = options_.points_per_direction;
  Index3 const sub = sub_cell(face, lane);
  int const q = to.append();
  for (int d = 0; d < 3; ++d) {
    double x = domain.centre({0, 0, 0})[d];
    if (d < domain.dimensions()) {
      x = domain.lower[d] + (f.inside[d] + (sub[d] + 0.5) / parts) * domain.h;
      if (d == f.direction) {
        double const least = 1e-9 * domain.h;  // inside, whatever the round-off
        double const at = std::clamp(depth, least, domain.h - least);
        x = domain.lower[d] + (f.inside[d] + f.side) * domain.h + (f.side == 0 ? at : -at);
      }
    }
    to.field(Field::position_x + d)[q] = x;
    to.field(Field::velocity_x + d)[q] = s.velocity[d];
    if (double* half = to.field(Field::half_x + d)) half[q] = 0.5 * domain.h / parts;
  }
  set_gradient(to, q, slopes, domain.dimensions(), domain.h);
  to.field(Field::mass)[q] = mass;
  to.field(Field::density)[q] = s.density;
  to.field(Field::pressure)[q] = s.pressure;
  to.field(Field::energy)[q] = specific_energy(s);
  if (double* Y = to.field(Field::mass_fraction)) Y[q] = s.mass_fraction;
  if (double* alpha = to.field(Field::volume_fraction)) alpha[q] = s.volume_fraction;
}

/// The volumes of the accounts are what has crossed by the velocity of the face, less what points took along; they
/// shrink and grow with the gas there. Where gas flows out, away from contacts, the masses tell better what is missing
/// in space than the volumes that points carry; and no more than one point's volume can be missing.
void Bridge::follow_volumes(double dt) {
  int const dims = region_.domain().dimensions();
  double const h = region_.domain().h;
  auto const& faces = region_.faces();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    Lanes const& lanes = lanes_[f];
    if (lanes.average >= 0) continue;
    Ledger* const accounts = ledger_.data() + f * lanes_per_face_;
    GasState const& outside = states_.later(lanes.outside_state);
    GasState centre;
    GasSlopes slopes;
    states_.at(lanes.outside_state, 1.0, centre, slopes);
    double divergence = faces[f].inward(states_.later(lanes.inside_state).velocity - outside.velocity) / h;
    for (int d = 0; d < dims; ++d) {
      if (d != faces[f].direction) divergence += slopes.velocity[d][d] / h;
    }
    double const stretch = std::exp(dt * divergence);
    bool const contact = differ(states_.later(lanes.inside_state).density, outside.density, 0.1);
    for (int lane = 0; lane < lanes_per_face_; ++lane) {
      Ledger& account = accounts[lane];
      if (outwards_[f] != 0 && !contact) {
        Ledger const& before = levelled_[f * lanes_per_face_ + lane];
        account.volume = before.volume + (account.total() - before.total()) / outside.density;
      }
      account.volume *= stretch;
      if (outwards_[f] == 0) continue;
      double const most = standard_volume(faces[f].inside, sub_cell(static_cast<int>(f), lane));
      account.volume = std::clamp(account.volume, -most, most);
    }
  }
}

namespace {

/// A mass near to `wanted` that differs from the usual one by the factor 1.25 at most.
double near_mass(double usual, double wanted) {
  constexpr double most = 1.25;
  return std::clamp(wanted, usual / most, usual * most);
}

constexpr int most_births = 16;  // of one lane in one step: more is not met within the Courant limit

}  // namespace

void Bridge::give_birth() {
  auto const& faces = region_.faces();
  int const count = static_cast<int>(faces.size());
  int const groups = (count + group - 1) / group;
  std::vector<mpm::PointSet> born(groups);
  double const spacing = region_.domain().h / options_.points_per_direction;
  parallel_for(groups, [&](int g, int) {
    for (int f = g * group; f < std::min(count, (g + 1) * group); ++f) {
      for (int lane = 0; lane < lanes_per_face_; ++lane) {
        Ledger& account = ledger_[static_cast<std::size_t>(f) * lanes_per_face_ + lane];
        if (account.volume <= 0.0) continue;
        if (lanes_[f].average >= 0 && averages_.sums()[lanes_[f].average].volume <= 0.0) continue;
        GasSlopes slopes;
        GasState const donor = donor_state(f, lane, slopes);
        if (faces[f].inward(donor.velocity) <= 0.0) continue;
        double const volume = standard_volume(faces[f].inside, sub_cell(f, lane));
        std::array<double, 2> const usual{(1.0 - donor.mass_fraction) * donor.density * volume,
                                          donor.mass_fraction * donor.density * volume};
        for (int n = 0; n < most_births && account.volume >= 0.5 * volume; ++n) {
          // What is left of the ledger after the birth is to have the donor's partial densities.
          double const left = account.volume / volume - 1.0;
          std::array<double, 2> mass{};
          for (int k = 0; k < 2; ++k) mass[k] = near_mass(usual[k], account.mass[k] - left * usual[k]);
          GasState state = donor;
          state.density = (mass[0] + mass[1]) / volume;
          state.mass_fraction = mass[1] / (mass[0] + mass[1]);
          double const depth = (account.volume / volume - 0.5) * spacing;
          if (born[g].fields().size() == 0) born[g] = mpm::PointSet(points_->fields(gas_body_));
          append_point(f, lane, depth, mass[0] + mass[1], state, slopes, born[g]);
          account.add(carried(born[g], born[g].size() - 1), -1.0);
        }
      }
    }
  });
  for (mpm::PointSet const& set : born) {
    if (set.empty()) continue;
    points_->add(gas_body_, set);
    traffic_.born += set.size();
  }
}

/// [Cui14] Eqs. (40)-(48).
void Bridge::give_birth_as_printed(double dt) {
  auto const& faces = region_.faces();
  mpm::PointSet born(points_->fields(gas_body_));
  for (int f = 0; f < static_cast<int>(faces.size()); ++f) {
    if (faces[f].open) continue;
    GasState const& outside = states_.later(lanes_[f].outside_state);
    GasState const& inside = states_.later(lanes_[f].inside_state);
    double const density = 0.5 * (outside.density + inside.density);                   // (40)
    double const speed = faces[f].inward(0.5 * (outside.velocity + inside.velocity));  // (41)
    if (speed <= 0.0) continue;
    double area = 0.0;
    for (int lane = 0; lane < lanes_per_face_; ++lane) area += lane_area(f, lane);
    double const flux = density * speed * area * dt;  // (43)
    double const existing = density * standard_volume(faces[f].inside, sub_cell(f, 0));
    int const rows = std::max(1, static_cast<int>(std::ceil(flux / existing / lanes_per_face_)));  // (45)
    double const mass = flux / (rows * lanes_per_face_);                                           // (46)
    for (int row = 0; row < rows; ++row) {
      double const depth = speed * dt * (row + 1.0) / rows;                                                      // (47)
      for (int lane = 0; lane < lanes_per_face_; ++lane) append_point(f, lane, depth, mass, outside, {}, born);  // (48)
    }
  }
  points_->add(gas_body_, born);
  traffic_.born += born.size();
}

double Bridge::surplus() const {
  auto const& faces = region_.faces();
  double sum = 0.0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    Lanes const& lanes = lanes_[f];
    if (!awake_ || lanes.average >= 0) continue;  // through open faces gas leaves at once
    double const density =
        std::max(states_.later(lanes.outside_state).density, states_.later(lanes.inside_state).density);
    for (int lane = 0; lane < lanes_per_face_; ++lane) {
      Ledger const& account = ledger_[f * lanes_per_face_ + lane];
      double const point = density * standard_volume(faces[f].inside, sub_cell(static_cast<int>(f), lane));
      sum += std::max(0.0, std::abs(account.mass[0]) + std::abs(account.mass[1]) - 2.0 * point);
    }
  }
  return sum;
}

std::string Bridge::intruder() const {
  std::vector<std::string> trouble(bridge_blocks_.size());
  parallel_for(static_cast<int>(bridge_blocks_.size()), [&](int n, int) {
    for (int body = 0; body < static_cast<int>(points_->bodies().size()); ++body) {
      if (body == gas_body_) continue;
      mpm::PointSet const& set = points_->points(bridge_blocks_[n], body);
      for (int q = 0; q < set.size(); ++q) {
        Vec3 const x{set.field(Field::position_x)[q], set.field(Field::position_y)[q], set.field(Field::position_z)[q]};
        if (!is_forbidden(cell_at(x))) continue;
        trouble[n] = fmt::format(
            "body \"{}\" has come to the bridge at ({:.6g}, {:.6g}, {:.6g}) m; the MPM region must reach further: "
            "solids keep "
            "{} cells away from its faces",
            points_->bodies()[body].name, x[0], x[1], x[2], region_.width() + 2);
        return;
      }
    }
  });
  auto const first =
      std::find_if(trouble.begin(), trouble.end(), [](std::string const& text) { return !text.empty(); });
  return first == trouble.end() ? std::string{} : *first;
}

void Bridge::exchange(double share, double dt) {
  last_step_ = dt;
  levelled_ = ledger_;  // as it was before
  take_leavers();
  add_fluxes(share, dt);
  if (options_.transport == Transport::ledger) {
    follow_volumes(dt);
    level_ledger();
    give_birth();
  } else {
    give_birth_as_printed(dt);
  }
  std::string const solid = intruder();
  if (!solid.empty()) throw NumericalError(solid);
}

Ledger Bridge::ledger() const {
  Ledger sum;
  for (Ledger const& account : ledger_) sum.add(account);
  return sum;
}

std::vector<CellSums> Bridge::gas_in(std::vector<Index3> const& cells) const {
  Averages averages(region_.domain(), *points_, region_.shift(), cells);
  averages.compute(*points_, gas_body_);
  return averages.sums();
}

}  // namespace brisance::bridge
