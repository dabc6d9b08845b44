/// Between steps: gases get more or fewer particles, block by block; see `mpm.hpp` and population.hpp.
#include <fmt/format.h>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "mpm/burn.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

PopulationCount Mpm::control_population(int body, PopulationOptions const& options) {
  PhaseTimer const timer(timings_["population"]);
  check(options);
  Body const& b = bodies_.at(body);
  material::Material const& solid = b.solid;
  if (solid.has_deviator() || solid.plastic() || b.rigid_velocity) {
    throw InputError(fmt::format("the material points of body \"{}\" cannot split and merge: it is not a gas", b.name));
  }
  for (ActiveLoad const& load : work_->loads) {
    if (load.body != body) continue;
    throw InputError(
        fmt::format("the material points of body \"{}\" cannot split and merge: some carry a surface pressure; load a "
                    "solid instead",
                    b.name));
  }
  Workspace& w = *work_;
  if (static_cast<int>(w.population.size()) < threads()) w.population.resize(threads());
  w.population_of_block.assign(grid_.block_count(), {});
  auto const place_of = [&](int block) {
    PopulationPlace place{&grid_, block, &w.patches[block], b.particles_per_direction};
    if (solid.burns()) place.lit_before = time_ - 1.0 / burn_rate(solid.detonation_speed, grid_.blocks()[block].h());
    return place;
  };

  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    w.population_of_block[block] = split_particles(particles(block, body), place_of(block), options,
                                                   w.population[thread], w.outbox[set_index(block, body)]);
  });
  long split = 0;
  bool moved = false;
  for (int const block : active_) {
    split += w.population_of_block[block].split;
    Outbox& out = w.outbox[set_index(block, body)];
    if (out.destination.empty()) continue;
    moved = true;
    for (std::size_t q = 0; q < out.destination.size(); ++q) {
      particles(out.destination[q], body).append(out.particles, static_cast<int>(q));
    }
    out.destination.clear();
    out.particles.reorder({});
  }
  if (moved) find_active();
  for (int n = 0; split > 0 && n < static_cast<int>(active_.size()); ++n) {
    ParticleSet& set = particles(active_[n], body);
    double* identity = set.field(Field::identity);
    for (int q = 0; q < set.size(); ++q) {
      if (identity[q] < 0.0) identity[q] = static_cast<double>(next_identity_[body]++);
    }
  }

  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    PopulationCount& count = w.population_of_block[block];
    PopulationCount const merged =
        merge_particles(particles(block, body), place_of(block), options, w.population[thread]);
    count.merged = merged.merged;
    count.heat += merged.heat;
  });
  PopulationCount total;
  for (PopulationCount const& count : w.population_of_block) {
    total.split += count.split;
    total.merged += count.merged;
    total.heat += count.heat;
  }
  return total;
}

}  // namespace brisance::mpm
