/// The world in a checkpoint. The world that reads it has been built from the same case: the grid and the realised
/// masses are those already, and only what time has changed is taken over.
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/archive.hpp"
#include "core/error.hpp"
#include "core/simd.hpp"
#include "run/world.hpp"

namespace brisance::run {

void archive(Archive& a, Totals& t) { a(t.mass, t.momentum, t.energy, t.kinetic_energy, t.rest_energy); }

void archive(Archive& a, ChargeReport& r) {
  a(r.explosive, r.specified_mass, r.realised_mass, r.realised_energy, r.cells_per_radius);
}

void archive(Archive& a, StartReport& r) {
  a(r.method, r.from, r.cell, r.charge_radius, r.by);
  a.require(r.method == StartMethod::gas || r.method == StartMethod::particles, "the method of the start");
  detonation::archive(a, r.remap);
}

/// A world that is read takes the blocks of the one that was written before it takes what they hold.
void World::archive_forest(Archive& a) {
  std::vector<int> levels;
  std::vector<Index3> places;
  for (grid::Leaf const& leaf : forest().leaves()) {
    levels.push_back(leaf.level);
    places.push_back(leaf.place);
  }
  std::vector<std::uint8_t> left_coarse = forest().left_coarse();
  a(levels, places, left_coarse);
  adaptation->archive(a);
  if (!a.reading()) return;
  a.require(levels.size() == places.size() && levels.size() == left_coarse.size(), "the number of blocks");
  std::vector<grid::Leaf> leaves;
  for (std::size_t n = 0; n < levels.size(); ++n) leaves.push_back({levels[n], places[n]});
  try {
    regrid({forest().parts(), forest().dimensions(), forest().periodic(), std::move(leaves), left_coarse});
  } catch (InputError const&) {
    a.require(false, "the blocks");
  }
}

/// When the regions woke, and how many steps each has made. Without any there is one that never wakes.
void World::archive_awakening(Archive& a) {
  std::size_t const count = std::max<std::size_t>(regions.size(), 1);
  if (count > 1) a.same(count, "the number of MPM regions");
  for (std::size_t r = 0; r < count; ++r) {
    bool woken = r < regions.size() && regions[r].awake_since.has_value();
    double since = woken ? *regions[r].awake_since : 0.0;
    a(woken, since);
    if (r == regions.size()) return;
    Region& region = regions[r];
    region.awake_since = woken ? std::optional<double>(since) : std::nullopt;
    // The steps of one are those of the clock.
    if (count > 1) a(region.steps);
    if (count == 1) region.steps = clock.particle_steps;
    a.require(region.steps >= 0 && region.steps <= clock.particle_steps, "the steps of an MPM region");
  }
}

void World::archive(Archive& a) {
  a.section("world");
  a.same(gas != nullptr, "whether there is gas");
  a.same(!regions.empty(), "whether there are material points");
  a.same(setup.domain.cells, "the number of cells");
  a.same(grid.smallest_cell(), "the size of the cells");
  auto set = static_cast<int>(simd_set());
  a(set);
  a.require(set >= 0 && set < static_cast<int>(words(SimdSet{}).size()), "the vector instructions");
  written_with = static_cast<SimdSet>(set);
  a(clock.time, clock.dt, clock.step, clock.gas_steps, clock.particle_steps, timings);
  a.require(std::isfinite(clock.time) && std::isfinite(clock.dt) && clock.step >= 0 && clock.gas_steps >= 0 &&
                clock.particle_steps >= 0,
            "the time");
  archive_awakening(a);
  // What the audit knows beside its start and its memory follows from the state.
  run::archive(a, audit.initial);
  a(audit.memory.scale, audit.memory.all, audit.memory.drift, audit.memory.content, audit.memory.surplus,
    audit.memory.gas, audit.memory.work, audit.memory.fresh, audit.memory.unlit, gas_rest_energy_);
  a.same(setup.start.remap, "whether it started with a remap");
  if (setup.start.remap) {
    // The remap is not repeated.
    a(charges, starts);
    a.require(charges.size() == setup.charges.size() && starts.size() == setup.charges.size(), "the number of charges");
  }
  a.same(adaptation != nullptr, "whether cells have several sizes");
  if (adaptation != nullptr) archive_forest(a);
  a.same(panels != nullptr, "whether there are panels");
  if (panels != nullptr) panels->archive(a, *gas);
  if (gas != nullptr) gas->archive(a);
  for (Region& region : regions) region.particles->archive(a);
  a.same(coupled(), "whether gas and particles are coupled");
  for (Region& region : regions) {
    if (region.bridge != nullptr) region.bridge->archive(a);
  }

  if (a.reading()) update_audit();
}

}  // namespace brisance::run
