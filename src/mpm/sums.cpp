/// What the particles of a body come to, and where one of them is; see `mpm.hpp`.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/loops.hpp"
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

namespace {

/// Sum of value(q) over [0, n), in lanes: a plain sum waits for every addition.
template <class Value>
inline __attribute__((always_inline)) double sum_in_lanes(int n, Value&& value) {
  constexpr int lanes = 8;
  std::array<double, lanes> part{};
  int q = 0;
  for (; q + lanes <= n; q += lanes) {
    for (int l = 0; l < lanes; ++l) part[l] += value(q + l);
  }
  for (; q < n; ++q) part[q % lanes] += value(q);
  double sum = 0.0;
  for (double const of_lane : part) sum += of_lane;
  return sum;
}

/// Longest way from the places at the start [m]; 0 where the particles do not know them.
double largest_displacement(ParticleSet const& set) {
  std::array<double const*, 3> x{};
  std::array<double const*, 3> origin{};
  for (int d = 0; d < 3; ++d) {
    x[d] = set.field(Field::position_x + d);
    origin[d] = set.field(Field::origin_x + d);
  }
  if (origin[0] == nullptr) return 0.0;
  constexpr int some = 64;
  std::array<double, some> square{};
  double most = 0.0;
  for (int begin = 0; begin < set.size(); begin += some) {
    int const n = std::min(some, set.size() - begin);
    square.fill(0.0);
    for (int d = 0; d < 3; ++d) {
      double const* at = x[d] + begin;
      double const* from = origin[d] + begin;
      for (int q = 0; q < n; ++q) square[q] += (at[q] - from[q]) * (at[q] - from[q]);
    }
    most = std::max(most, largest_of(square.data(), n));
  }
  return std::sqrt(most);
}

/// What n particles of a set come to; `centre` holds the sum of mass times place.
BodySums sums_of(ParticleSet const& set, int begin, int n, BodyRules const& rules, bool books, double h) {
  BodySums s;
  s.particles = n;
  auto const at = [&](Field f) -> double const* {
    double const* values = set.field(f);
    return values == nullptr ? nullptr : values + begin;
  };
  double const* m = at(Field::mass);
  auto const times_mass = [&](double const* x) { return sum_in_lanes(n, [=](int q) { return m[q] * x[q]; }); };
  auto const squares = [&](Field first, int count) {
    double sum = 0.0;
    for (int c = 0; c < count; ++c) {
      double const* x = at(first + c);
      if (x != nullptr) sum += sum_in_lanes(n, [=](int q) { return m[q] * x[q] * x[q]; });
    }
    return sum;
  };
  s.mass = sum_in_lanes(n, [=](int q) { return m[q]; });
  if (double const* fraction = at(Field::mass_fraction)) {
    s.fluid_mass[0] = sum_in_lanes(n, [=](int q) { return m[q] - m[q] * fraction[q]; });
    s.fluid_mass[1] = times_mass(fraction);
  } else {
    s.fluid_mass[0] = s.mass;
  }
  for (int d = 0; d < 3; ++d) {
    s.momentum[d] = times_mass(at(Field::velocity_x + d));
    s.centre[d] = times_mass(at(Field::position_x + d));
  }
  s.kinetic_energy = 0.5 * squares(Field::velocity_x, 3);
  // As in `affine_energy`.
  if (rules.has_gradient_energy) {
    s.kinetic_energy += h * h * (0.125 * squares(Field::affine_xx, 9) + 0.03125 * squares(Field::cross_xy, 9));
  }
  s.internal_energy = times_mass(at(Field::energy));
  if (books) s.provisional_energy = times_mass(at(Field::provisional));
  if (double const* work = at(Field::plastic_work)) s.plastic_work = times_mass(work);
  if (double const* damage = at(Field::damage))
    s.damaged_mass = sum_in_lanes(n, [=](int q) { return damage[q] >= 1.0 ? m[q] : 0.0; });
  return s;
}

/// The same of all particles of a set: of some at a time, whose masses stay in the cache.
BodySums sums_of(ParticleSet const& set, BodyRules const& rules, bool books, double h) {
  constexpr int some = 1024;
  BodySums s;
  for (int begin = 0; begin < set.size(); begin += some) {
    s += sums_of(set, begin, std::min(some, set.size() - begin), rules, books, h);
  }
  s.largest_displacement = largest_displacement(set);
  return s;
}

}  // namespace

BodySums sums(Mpm const& mpm, int body) {
  Body const& of = mpm.bodies()[body];
  BodyRules const rules = rules_of(of, mpm.options());
  bool const books = rules.books_work && !of.solid.is_gas();
  BodySums total = sum_over(mpm.grid().block_count(), [&](int block) {
    return sums_of(mpm.particles(block, body), rules, books, mpm.grid().blocks()[block].h());
  });
  if (total.mass > 0.0) total.centre = (1.0 / total.mass) * total.centre;
  return total;
}

double mass(Mpm const& mpm, int body) {
  double total = 0.0;
  for_blocks(mpm, body, [&](ParticleSet const& set) {
    double const* m = set.field(Field::mass);
    total += sum_in_lanes(set.size(), [=](int q) { return m[q]; });
  });
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

double Mpm::stable_step() const { return options_.courant_number() * grid_.smallest_cell() / fastest_; }

}  // namespace brisance::mpm
