/// Particles that come, go, change their body or belong to somebody else; see `mpm.hpp`.
#include <algorithm>

#include "mpm/burn.hpp"
#include "mpm/mpm.hpp"
#include "mpm/proxy_particles.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

void ProxyParticles::belong_to(int body, FieldList fields) {
  body_ = body;
  fields.add(Field::next_x, 3);
  sets_ = grid::BlockStore<ParticleSet>(*grid_, [fields](grid::Block const&) { return ParticleSet(fields); });
  gifts_ = grid::BlockStore<std::vector<NodeGift>>(*grid_);
}

/// What follows from the proxy particles of a step.
void Mpm::take_proxies() {
  if (proxies_.body() < 0) return;
  // Gas fills the space up to walls, and its pressure may fall below that of reference: it keeps its images.
  work_->one_sided[work_->field_of[proxies_.body()]] = 0;
  work_->by_proxies.resize(proxies_.size());
  find_active();
}

void Mpm::add(int body, ParticleSet const& added, std::optional<int> block) {
  for (int q = 0; q < added.size(); ++q) {
    Vec3 const x{added.field(Field::position_x)[q], added.field(Field::position_y)[q],
                 added.field(Field::position_z)[q]};
    ParticleSet& set = particles(block ? *block : grid_.block_of(grid_.cell_at(x)), body);
    set.append(added, q);
    set.field(Field::identity)[set.size() - 1] = static_cast<double>(next_identity_[body]++);
  }
  if (!added.empty() && !(block && std::binary_search(active_.begin(), active_.end(), *block))) find_active();
}

void take_out(ParticleSet& set, std::function<bool(ParticleSet const& set, int q)> const& outside, ParticleSet& to) {
  std::vector<int> stay;
  stay.reserve(set.size());
  for (int q = 0; q < set.size(); ++q) {
    if (outside(set, q)) {
      to.append(set, q);
    } else {
      stay.push_back(q);
    }
  }
  if (static_cast<int>(stay.size()) < set.size()) set.reorder(stay);
}

long hand_over_burnt(Mpm& mpm, int explosive, int gas) {
  double const speed = mpm.bodies()[explosive].solid.detonation_speed;
  FieldList const& carried = fields(mpm, gas);
  long count = 0;
  for (grid::Block const& block : mpm.grid().blocks()) {
    ParticleSet& set = mpm.particles(block.number, explosive);
    double const rate = burn_rate(speed, block.h());
    ParticleSet burnt(set.fields());
    take_out(
        set,
        [&](ParticleSet const& particles, int q) {
          double const* lighting = particles.field(Field::lighting_time);
          return lighting == nullptr || burn_fraction(mpm.time(), lighting[q], rate) >= 1.0;
        },
        burnt);
    ParticleSet products(carried);
    for (int q = 0; q < burnt.size(); ++q) {
      products.append();
      for (int n = 0; n < field_count; ++n) {
        auto const f = static_cast<Field>(n);
        if (carried.has(f) && burnt.fields().has(f)) products.field(f)[q] = burnt.field(f)[q];
      }
      products.field(Field::mass_fraction)[q] = 1.0;
      products.field(Field::volume_fraction)[q] = 1.0;
    }
    mpm.add(gas, products, block.number);
    count += products.size();
  }
  return count;
}

}  // namespace brisance::mpm
