/// What the points of a body come to, and where one of them is; see `mpm.hpp`.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

long Mpm::point_count() const {
  long count = 0;
  for (PointSet const& set : sets_) count += set.size();
  return count;
}

BodySums Mpm::sums(int body) const {
  int const blocks = grid_.block_count();
  std::vector<BodySums> parts(blocks);
  parallel_for(blocks, [&](int block, int) {
    PointSet const& set = points(block, body);
    BodySums& s = parts[block];
    s.points = set.size();
    bool const affine = rules_[body].has_gradient_energy;
    bool const books = rules_[body].books_work && !bodies_[body].solid.is_gas();
    for (int q = 0; q < set.size(); ++q) {
      double const m = set.field(Field::mass)[q];
      s.mass += m;
      double const* fraction = set.field(Field::mass_fraction);
      double const other = fraction == nullptr ? 0.0 : m * fraction[q];
      s.fluid_mass[0] += m - other;
      s.fluid_mass[1] += other;
      double square = 0.0;
      double moved = 0.0;
      for (int d = 0; d < 3; ++d) {
        double const v = set.field(Field::velocity_x + d)[q];
        double const x = set.field(Field::position_x + d)[q];
        s.momentum[d] += m * v;
        s.centre[d] += m * x;
        square += v * v;
        if (double const* origin = set.field(Field::origin_x + d)) moved += (x - origin[q]) * (x - origin[q]);
      }
      s.kinetic_energy += 0.5 * m * square;
      if (affine) s.kinetic_energy += m * affine_energy(set, q, grid_.domain().h);
      s.internal_energy += m * set.field(Field::energy)[q];
      if (books) s.provisional_energy += m * set.field(Field::provisional)[q];
      if (double const* work = set.field(Field::plastic_work)) s.plastic_work += m * work[q];
      if (double const* damage = set.field(Field::damage)) s.damaged_mass += damage[q] >= 1.0 ? m : 0.0;
      s.largest_displacement = std::max(s.largest_displacement, std::sqrt(moved));
    }
  });
  BodySums total;
  for (BodySums const& s : parts) {
    total.points += s.points;
    total.mass += s.mass;
    for (int f = 0; f < 2; ++f) total.fluid_mass[f] += s.fluid_mass[f];
    total.momentum = total.momentum + s.momentum;
    total.centre = total.centre + s.centre;
    total.kinetic_energy += s.kinetic_energy;
    total.internal_energy += s.internal_energy;
    total.provisional_energy += s.provisional_energy;
    total.plastic_work += s.plastic_work;
    total.damaged_mass += s.damaged_mass;
    total.largest_displacement = std::max(total.largest_displacement, s.largest_displacement);
  }
  if (total.mass > 0.0) total.centre = (1.0 / total.mass) * total.centre;
  return total;
}

Place Mpm::find(int body, long identity, Place hint) const {
  auto const wanted = static_cast<double>(identity);
  auto const look = [&](int block) -> Place {
    PointSet const& set = points(block, body);
    double const* identities = set.field(Field::identity);
    for (int q = 0; q < set.size(); ++q) {
      if (identities[q] == wanted) return {block, q};
    }
    return {};
  };
  if (hint.block >= 0) {
    PointSet const& set = points(hint.block, body);
    if (hint.index < set.size() && set.field(Field::identity)[hint.index] == wanted) return hint;
    for (int const block : work_->around[hint.block]) {
      if (block == grid::no_neighbour) continue;
      Place const place = look(block);
      if (place.block >= 0) return place;
    }
  }
  for (int block = 0; block < grid_.block_count(); ++block) {
    Place const place = look(block);
    if (place.block >= 0) return place;
  }
  return {};
}

long Mpm::nearest(int body, Vec3 const& x) const {
  double best = std::numeric_limits<double>::infinity();
  long identity = -1;
  int const dims = grid_.domain().dimensions();
  for (int block = 0; block < grid_.block_count(); ++block) {
    PointSet const& set = points(block, body);
    for (int q = 0; q < set.size(); ++q) {
      double square = 0.0;
      for (int d = 0; d < dims; ++d) {
        double const distance = set.field(Field::position_x + d)[q] - x[d];
        square += distance * distance;
      }
      auto const candidate = static_cast<long>(set.field(Field::identity)[q]);
      if (square < best || (square == best && candidate < identity)) {
        best = square;
        identity = candidate;
      }
    }
  }
  return identity;
}

double Mpm::lowest_pressure(int body) const {
  std::vector<double> lowest(active_.size(), std::numeric_limits<double>::infinity());
  parallel_for(static_cast<int>(active_.size()), [&](int n, int) {
    auto const see = [&](PointSet const& set) {
      double const* p = set.field(Field::pressure);
      double least = lowest[n];
      for (int q = 0; q < set.size(); ++q) least = p[q] < least ? p[q] : least;
      lowest[n] = least;
    };
    see(points(active_[n], body));
    if (body == lent_body_) see(lent_[active_[n]]);
  });
  double least = std::numeric_limits<double>::infinity();
  for (double const p : lowest) least = std::min(least, p);
  return least;
}

std::size_t Mpm::bytes() const {
  std::size_t total = 0;
  for (PointSet const& set : sets_) total += set.bytes();
  for (auto const& nodes : work_->state) total += nodes.bytes();
  for (auto const& nodes : work_->velocity) total += nodes.bytes();
  for (auto const& nodes : work_->gradient) total += nodes.bytes();
  for (auto const& nodes : work_->area) total += nodes.bytes();
  for (auto const* all : {&work_->even, &work_->even_again}) {
    for (auto const& nodes : *all) total += nodes.bytes();
  }
  for (auto const& nodes : work_->extent) total += nodes.bytes();
  return total;
}

void Mpm::find_active() {
  active_.clear();
  for (int b = 0; b < grid_.block_count(); ++b) {
    bool any = false;
    for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) any = any || !points(b, body).empty();
    any = any || (lent_body_ >= 0 && !lent_[b].empty());
    if (any) active_.push_back(b);
  }
}

void Mpm::update_signals() {
  parallel_for(grid_.block_count(), [&](int block, int) {
    double fastest = 0.0;
    for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
      PointSet const& set = points(block, body);
      material::Solid const& solid = bodies_[body].solid;
      double const* mass_fraction = set.field(Field::mass_fraction);
      double const* volume_fraction = set.field(Field::volume_fraction);
      for (int q = 0; q < set.size(); ++q) {
        double const Y = mass_fraction == nullptr ? 0.0 : mass_fraction[q];
        double const alpha = volume_fraction == nullptr ? 0.0 : volume_fraction[q];
        double const speed = norm(
            Vec3{set.field(Field::velocity_x)[q], set.field(Field::velocity_y)[q], set.field(Field::velocity_z)[q]});
        double const sound = bodies_[body].rigid_velocity
                                 ? 0.0
                                 : std::max(material::sound_speed(solid, set.field(Field::density)[q],
                                                                  set.field(Field::pressure)[q], Y, alpha),
                                            solid.detonation_speed);
        fastest = std::max(fastest, signal_weight(body) * (speed + sound));
      }
    }
    signals_[block] = fastest;
  });
  collect_signals();
}

void Mpm::collect_signals() {
  fastest_ = 0.0;
  for (int const block : active_) fastest_ = std::max(fastest_, signals_[block]);
}

double Mpm::stable_step() const { return options_.courant * grid_.domain().h / fastest_; }

}  // namespace brisance::mpm
