/// What the particles of a body come to, and where one of them is; see `mpm.hpp`.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"
#include "core/reduce.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

/// Calls visit(set) for the sets of a body, block by block.
template <class Visit>
void for_blocks(Mpm const& mpm, int body, Visit&& visit) {
  for (int block = 0; block < mpm.grid().block_count(); ++block) visit(mpm.particles(block, body));
}

}  // namespace

long particle_count(Mpm const& mpm) {
  long count = 0;
  for (std::size_t body = 0; body < mpm.bodies().size(); ++body) {
    for_blocks(mpm, static_cast<int>(body), [&](ParticleSet const& set) { count += set.size(); });
  }
  return count;
}

BodySums& BodySums::operator+=(BodySums const& other) {
  particles += other.particles;
  mass += other.mass;
  for (std::size_t k = 0; k < fluid_mass.size(); ++k) fluid_mass[k] += other.fluid_mass[k];
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

BodySums sums(Mpm const& mpm, int body) {
  Body const& of = mpm.bodies()[body];
  BodyRules const rules = rules_of(of, mpm.options());
  BodySums total = sum_over(mpm.grid().block_count(), [&](int block) {
    ParticleSet const& set = mpm.particles(block, body);
    double const h = mpm.grid().blocks()[block].h();
    BodySums s;
    s.particles = set.size();
    bool const affine = rules.has_gradient_energy;
    bool const books = rules.books_work && !of.solid.is_gas();
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
      if (affine) s.kinetic_energy += m * affine_energy(set, q, h);
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

Place find(Mpm const& mpm, int body, long identity, Place hint) {
  auto const wanted = static_cast<double>(identity);
  auto const look = [&](int block) -> Place {
    ParticleSet const& set = mpm.particles(block, body);
    double const* identities = set.field(Field::identity);
    for (int q = 0; q < set.size(); ++q) {
      if (identities[q] == wanted) return {block, q};
    }
    return {};
  };
  if (hint.block >= 0) {
    ParticleSet const& set = mpm.particles(hint.block, body);
    if (hint.index < set.size() && set.field(Field::identity)[hint.index] == wanted) return hint;
    for (int const block : blocks_around(mpm.grid(), hint.block)) {
      if (block == grid::no_neighbour) continue;
      Place const place = look(block);
      if (place.block >= 0) return place;
    }
  }
  for (int block = 0; block < mpm.grid().block_count(); ++block) {
    Place const place = look(block);
    if (place.block >= 0) return place;
  }
  return {};
}

long nearest(Mpm const& mpm, int body, Vec3 const& x) {
  double best = std::numeric_limits<double>::infinity();
  long identity = -1;
  int const dims = mpm.grid().domain().dimensions();
  for (int block = 0; block < mpm.grid().block_count(); ++block) {
    ParticleSet const& set = mpm.particles(block, body);
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

double lowest_pressure(Mpm& mpm, int body) {
  ProxyParticles const& proxies = mpm.proxies();
  auto const lower = [](double& least, double p) { least = p < least ? p : least; };
  constexpr double none = std::numeric_limits<double>::infinity();
  auto const of_block = [&](int block) {
    double least = none;
    auto const see = [&](ParticleSet const& set) {
      double const* p = set.field(Field::pressure);
      for (int q = 0; q < set.size(); ++q) lower(least, p[q]);
    };
    see(mpm.particles(block, body));
    if (body == proxies.body()) see(proxies.particles(block));
    return least;
  };
  return reduce(mpm.grid().block_count(), none, of_block, lower);
}

void set_lighting(Mpm& mpm, int body, std::function<double(Vec3 const&)> const& lighting_time) {
  for (int b = 0; b < mpm.grid().block_count(); ++b) {
    ParticleSet& set = mpm.particles(b, body);
    double* lighting = set.field(Field::lighting_time);
    if (lighting == nullptr) continue;
    for (int q = 0; q < set.size(); ++q) {
      lighting[q] = lighting_time(
          {set.field(Field::position_x)[q], set.field(Field::position_y)[q], set.field(Field::position_z)[q]});
    }
  }
}

std::size_t bytes(Mpm const& mpm) {
  Mpm::Workspace const& w = *mpm.work_;
  std::size_t total = 0;
  for (auto const& sets : mpm.sets_) {
    for (ParticleSet const& set : sets) total += set.bytes();
  }
  for (auto const& nodes : w.state) total += nodes.bytes();
  for (auto const* all : {&w.velocity, &w.gradient, &w.area, &w.even, &w.even_again}) {
    for (auto const& nodes : *all) total += nodes.bytes();
  }
  for (auto const& nodes : w.extent) total += nodes.bytes();
  return total;
}

void Mpm::find_active() {
  active_.clear();
  for (int b = 0; b < grid_.block_count(); ++b) {
    bool any = false;
    for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) any = any || !particles(b, body).empty();
    any = any || proxies_.any(b);
    if (any) active_.push_back(b);
  }
}

void Mpm::update_signals() {
  parallel_for(grid_.block_count(), [&](int block, int) {
    double fastest = 0.0;
    for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
      ParticleSet const& set = particles(block, body);
      material::Material const& solid = bodies_[body].solid;
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

double Mpm::stable_step() const { return options_.courant * grid_.smallest_cell() / fastest_; }

}  // namespace brisance::mpm
