/// The state of the material points in a checkpoint: the particles in their order, for sums follow it, and the sums
/// since the start. Nodes, constraints, contacts and loads follow from the case and the particles.
#include <fmt/format.h>

#include <cmath>

#include "core/archive.hpp"
#include "core/error.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

void archive(Archive& a, BodySums& s) {
  a(s.particles, s.mass, s.fluid_mass, s.momentum, s.centre, s.kinetic_energy, s.internal_energy, s.provisional_energy,
    s.plastic_work, s.largest_displacement, s.damaged_mass);
}

void ParticleSet::archive(Archive& a) {
  for (int f = 0; f < field_count; ++f) a.same(fields_.slot(static_cast<Field>(f)), "the set of particle fields");
  int count = size_;
  a(count);
  if (a.reading()) {
    // An announced number beyond what is there must not become memory.
    if (count < 0 || static_cast<std::uint64_t>(count) * fields_.size() > a.left() / sizeof(double))
      throw IoError(fmt::format("it declares {} particles in a block, more than it can contain", count));
    size_ = 0;
    reserve(static_cast<std::size_t>(count));
    size_ = count;
  }
  for (int slot = 0; slot < fields_.size(); ++slot) {
    a.numbers(data_.data() + static_cast<std::size_t>(slot) * capacity_, static_cast<std::size_t>(count));
  }
}

namespace {

/// Nodes, loads and bars are looked up by what a particle carries: it must lie in its block, or within a cell of it
/// where it has just crossed a face of the region, and name what is there.
void check_particles(Archive& a, ParticleSet const& set, grid::Grid const& grid, int block, Body const& body,
                     std::size_t loads) {
  if (!a.reading()) return;
  grid::Metric const& metric = grid.blocks()[block].metric;
  grid::CellRange const near = grid.blocks()[block].in_domain().grown(1, metric.dimensions());
  auto const named = [&](Field field, int q, std::size_t count) {
    double const* values = set.field(field);
    return values == nullptr || (values[q] >= 0.0 && values[q] <= static_cast<double>(count));
  };
  for (int q = 0; q < set.size(); ++q) {
    bool inside = true;
    for (int d = 0; d < metric.dimensions(); ++d) {
      double const x = set.field(Field::position_x + d)[q];
      inside = inside && x >= metric.face(d, near.lower[d]) && x <= metric.face(d, near.upper[d]);
    }
    a.require(inside, fmt::format("the position of a particle of body \"{}\"", body.name));
    constexpr double most_particles = 9e15;  // whole numbers of a double
    double const identity = set.field(Field::identity)[q];
    a.require(identity >= 0.0 && identity <= most_particles && named(Field::load_number, q, loads) &&
                  named(Field::bar_number, q, body.bars.size()),
              fmt::format("the fields of a particle of body \"{}\"", body.name));
  }
}

}  // namespace

void Mpm::archive(Archive& a) {
  a.section("material points");
  a.same(grid_.block_count(), "the number of blocks of particles");
  a.same(bodies_.size(), "the number of bodies");
  a.same(work_->loads.size(), "the number of surface pressures");
  a.sized(next_identity_, "the number of bodies");
  Losses& lost = accounts_.losses;
  Dissipation& dissipated = accounts_.dissipation;
  a(lost.mass, lost.momentum, lost.energy, lost.particles, accounts_.constraint_impulse, accounts_.outer_work);
  a(dissipated.constraints, dissipated.filtered, dissipated.apic, dissipated.friction, dissipated.damping);
  a(accounts_.floored.energy, accounts_.floored.particles, accounts_.conducted.moved, accounts_.conducted.made);
  a(fastest_, time_, step_);
  a.require(fastest_ >= 0.0 && std::isfinite(time_) && step_ >= 0, "the time of the particles");
  a.sized(signals_, "the number of blocks of particles");
  a(timings_);
  for (Body& body : bodies_) a(body.reference_pressure);  // that of a gas follows its particles
  for (int b = 0; b < grid_.block_count(); ++b) {
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
      sets_[b][body].archive(a);
      check_particles(a, sets_[b][body], grid_, b, bodies_[body], work_->loads.size());
    }
  }
  a.same(proxies_.size(), "the number of blocks with proxy particles");
  for (std::size_t n = 0; n < proxies_.size(); ++n) {
    int const block = static_cast<int>(n);
    proxies_.particles(block).archive(a);
    check_particles(a, proxies_.particles(block), grid_, block, bodies_[proxies_.body()], work_->loads.size());
  }
  if (a.reading()) find_active();
}

}  // namespace brisance::mpm
