/// What the points of a body come to, and where one of them is; see `mpm.hpp`.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"
#include "core/reduce.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

long Mpm::point_count() const {
  return sum_at_hand(static_cast<int>(sets_.size()), [this](int n) { return static_cast<long>(sets_[n].size()); });
}

BodySums& BodySums::operator+=(BodySums const& other) {
  points += other.points;
  mass += other.mass;
  for (int f = 0; f < 2; ++f) fluid_mass[f] += other.fluid_mass[f];
  momentum = momentum + other.momentum;
  centre = centre + other.centre;
  kinetic_energy += other.kinetic_energy;
  internal_energy += other.internal_energy;
  provisional_energy += other.provisional_energy;
  plastic_work += other.plastic_work;
  damaged_mass += other.damaged_mass;
  largest_displacement = std::max(largest_displacement, other.largest_displacement);
  return *this;
}

BodySums Mpm::sums(int body) const {
  BodySums total = sum_over(grid_.block_count(), [&](int block) {
    PointSet const& set = points(block, body);
    BodySums s;
    s.points = set.size();
    bool const affine = rules_[body].has_gradient_energy;
    bool const books = rules_[body].books_work && !bodies_[body].solid.is_gas();
    for (int q = 0; q < set.size(); ++q) {
      double const m = set.field(Field::mass)[q];
      s.mass += m;
      double const* second = set.field(Field::mass_fraction);
      double const m1 = second == nullptr ? 0.0 : m * second[q];
      s.fluid_mass[0] += m - m1;
      s.fluid_mass[1] += m1;
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
    return s;
  });
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
  auto const lower = [](double& least, double p) { least = p < least ? p : least; };
  constexpr double none = std::numeric_limits<double>::infinity();
  auto const of_block = [&](int n) {
    double least = none;
    auto const see = [&](PointSet const& set) {
      double const* p = set.field(Field::pressure);
      for (int q = 0; q < set.size(); ++q) lower(least, p[q]);
    };
    see(points(active_[n], body));
    if (body == lent_body_) see(lent_[active_[n]]);
    return least;
  };
  return reduce(static_cast<int>(active_.size()), none, of_block, lower);
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
  fastest_ = largest_at_hand(static_cast<int>(active_.size()), 0.0, [this](int n) { return signals_[active_[n]]; });
}

double Mpm::stable_step() const { return options_.courant * grid_.domain().h / fastest_; }

}  // namespace brisance::mpm
