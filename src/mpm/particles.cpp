#include "mpm/particles.hpp"

#include <algorithm>

namespace brisance::mpm {

namespace {

constexpr std::size_t granule = 8;  ///< doubles of a cache line: every field starts on one

}  // namespace

void ParticleSet::reserve(std::size_t wanted) {
  if (wanted <= capacity_) return;
  std::size_t const grown = std::max(wanted, capacity_ + capacity_ / 8 + 2 * granule);
  std::size_t const capacity = (grown + granule - 1) / granule * granule;
  Buffer fresh(capacity * static_cast<std::size_t>(fields_.size()));
  for (int slot = 0; slot < fields_.size(); ++slot) {
    double const* from = data_.data() + static_cast<std::size_t>(slot) * capacity_;
    std::copy(from, from + size_, fresh.data() + static_cast<std::size_t>(slot) * capacity);
  }
  data_ = std::move(fresh);
  capacity_ = capacity;
}

int ParticleSet::append() {
  reserve(static_cast<std::size_t>(size_) + 1);
  for (int slot = 0; slot < fields_.size(); ++slot) data_[static_cast<std::size_t>(slot) * capacity_ + size_] = 0.0;
  return size_++;
}

void ParticleSet::append(ParticleSet const& from, int index) {
  reserve(static_cast<std::size_t>(size_) + 1);
  for (int slot = 0; slot < fields_.size(); ++slot) {
    data_[static_cast<std::size_t>(slot) * capacity_ + size_] =
        from.data_[static_cast<std::size_t>(slot) * from.capacity_ + index];
  }
  ++size_;
}

void ParticleSet::reorder(std::vector<int> const& order) {
  std::size_t first = 0;  // that changes its place
  while (first < order.size() && order[first] == static_cast<int>(first)) ++first;
  // Where some only leave and the others move up, nothing is overwritten that is still wanted.
  bool const moves_up = std::is_sorted(order.begin(), order.end());
  std::vector<double> scratch(moves_up ? 0 : order.size());
  for (int slot = 0; slot < fields_.size(); ++slot) {
    double* values = data_.data() + static_cast<std::size_t>(slot) * capacity_;
    if (moves_up) {
      for (std::size_t n = first; n < order.size(); ++n) values[n] = values[order[n]];
    } else {
      for (std::size_t n = first; n < order.size(); ++n) scratch[n] = values[order[n]];
      std::copy(scratch.begin() + static_cast<std::ptrdiff_t>(first), scratch.end(),
                values + static_cast<std::ptrdiff_t>(first));
    }
  }
  size_ = static_cast<int>(order.size());
}

double affine_energy(ParticleSet const& set, int particle, double h) {
  double sum = 0.0;
  for (int c = 0; c < 9; ++c) {
    double const g = set.field(Field::affine_xx + c)[particle];
    sum += g * g;
  }
  double mixed = 0.0;
  for (int c = 0; c < 9; ++c) {
    double const* values = set.field(Field::cross_xy + c);
    if (values != nullptr) mixed += values[particle] * values[particle];
  }
  return h * h * (0.125 * sum + 0.03125 * mixed);
}

}  // namespace brisance::mpm
