/// The state of the material points in a checkpoint: the points in their order, for sums follow it, and the sums since
/// the start. Nodes, constraints, contacts and loads follow from the case and the points.
#include <fmt/format.h>

#include "core/archive.hpp"
#include "core/error.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

void archive(Archive& a, BodySums& s) {
  a(s.points, s.mass, s.fluid_mass, s.momentum, s.centre, s.kinetic_energy, s.internal_energy, s.plastic_work,
    s.largest_displacement, s.damaged_mass);
}

void PointSet::archive(Archive& a) {
  for (int f = 0; f < field_count; ++f) a.same(fields_.slot(static_cast<Field>(f)), "what a point carries");
  int count = size_;
  a(count);
  if (a.reading()) {
    // An announced number beyond what is there must not become memory.
    if (count < 0 || static_cast<std::uint64_t>(count) * fields_.size() > a.left() / sizeof(double))
      throw IoError(fmt::format("it announces {} points in a block, more than it can hold", count));
    size_ = 0;
    reserve(static_cast<std::size_t>(count));
    size_ = count;
  }
  for (int slot = 0; slot < fields_.size(); ++slot) {
    a.numbers(data_.data() + static_cast<std::size_t>(slot) * capacity_, static_cast<std::size_t>(count));
  }
}

void Mpm::archive(Archive& a) {
  a.section("material points");
  a.same(grid_.block_count(), "the number of blocks of points");
  a.same(bodies_.size(), "the number of bodies");
  a.same(work_->loads.size(), "the number of surface pressures");
  a(next_identity_, losses_.mass, losses_.momentum, losses_.energy, losses_.points, constraint_impulse_, outer_work_);
  a(dissipation_.held, dissipation_.filtered, dissipation_.friction);
  a(fastest_, time_, step_, signals_, timings_);
  for (Body& body : bodies_) a(body.reference_pressure);  // that of a gas follows its points
  for (PointSet& set : sets_) set.archive(a);
  a.same(lent_.size(), "the number of blocks that points are lent to");
  for (PointSet& set : lent_) set.archive(a);
  if (a.reading()) find_active();
}

}  // namespace brisance::mpm
