/// Points that come, go, change their body or belong to somebody else; see `mpm.hpp`.
#include "mpm/burn.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

void Mpm::lend_as(int body) {
  lent_body_ = body;
  // Gas fills the space up to walls, and its pressure may fall below that of reference: it keeps its images.
  work_->one_sided[work_->field_of[body]] = 0;
  lent_.clear();
  FieldList fields = this->fields(body);
  fields.add(Field::next_x, 3);
  for (int b = 0; b < grid_.block_count(); ++b) lent_.emplace_back(fields);
  gifts_.resize(lent_.size());
  work_->lent.resize(lent_.size());
}

void Mpm::add(int body, PointSet const& added) {
  for (int q = 0; q < added.size(); ++q) {
    Vec3 const x{added.field(Field::position_x)[q], added.field(Field::position_y)[q],
                 added.field(Field::position_z)[q]};
    PointSet& set = sets_[set_index(grid_.block_of(grid_.cell_at(x)), body)];
    set.append(added, q);
    set.field(Field::identity)[set.size() - 1] = static_cast<double>(next_identity_[body]++);
  }
  if (!added.empty()) find_active();
}

void Mpm::take_out(int block, int body, std::function<bool(PointSet const& set, int q)> const& outside, PointSet& to) {
  PointSet& set = points(block, body);
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

long Mpm::hand_over_burnt(int explosive, int gas) {
  double const rate = burn_rate(bodies_[explosive].solid.detonation_speed, grid_.domain().h);
  long count = 0;
  std::vector<int> stay;
  for (int block = 0; block < grid_.block_count(); ++block) {
    PointSet& from = points(block, explosive);
    double const* lighting = from.field(Field::lighting_time);
    PointSet& to = points(block, gas);
    stay.clear();
    for (int q = 0; q < from.size(); ++q) {
      if (lighting != nullptr && burn_fraction(time_, lighting[q], rate) < 1.0) {
        stay.push_back(q);
        continue;
      }
      int const at = to.append();
      for (int n = 0; n < field_count; ++n) {
        auto const f = static_cast<Field>(n);
        if (double* value = to.field(f); value != nullptr && from.fields().has(f)) value[at] = from.field(f)[q];
      }
      to.field(Field::mass_fraction)[at] = 1.0;
      to.field(Field::volume_fraction)[at] = 1.0;
      to.field(Field::identity)[at] = static_cast<double>(next_identity_[gas]++);
      ++count;
    }
    if (static_cast<int>(stay.size()) < from.size()) from.reorder(stay);
  }
  return count;
}

}  // namespace brisance::mpm
