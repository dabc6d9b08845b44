#include "grid/exchange.hpp"

#include <algorithm>

#include "core/parallel.hpp"

namespace brisance::grid {

namespace {

/// A box that is a part of an array over `all`.
template <class Value>
struct Part {
  Value* data = nullptr;
  CellRange all;
  CellRange box;

  /// The row with the number (j, k) within the box.
  [[nodiscard]] Value* row(int j, int k) const {
    return data + all.offset({box.lower[0], box.lower[1] + j, box.lower[2] + k});
  }
};

/// Calls visit(from, to) for the rows of two boxes that belong together. Along `reverse`, where it is 1 or 2, the first
/// box is gone through backwards; along `fixed` only its first layer is taken.
template <class Visit>
void for_each_row_pair(Part<double const> const& from, Part<double> const& to, int reverse, int fixed, Visit&& visit) {
  for (int k = 0; k < to.box.n(2); ++k) {
    for (int j = 0; j < to.box.n(1); ++j) {
      int const kk = fixed == 2 ? 0 : reverse == 2 ? from.box.n(2) - 1 - k : k;
      int const jj = fixed == 1 ? 0 : reverse == 1 ? from.box.n(1) - 1 - j : j;
      visit(from.row(jj, kk), to.row(j, k));
    }
  }
}

void copy(Part<double const> const& from, Part<double> const& to) {
  int const n = to.box.n(0);
  for_each_row_pair(from, to, -1, -1, [n](double const* row, double* ghost) {
    for (int i = 0; i < n; ++i) ghost[i] = row[i];
  });
}

void mirror(Part<double const> const& from, Part<double> const& to, int direction, double sign) {
  int const n = to.box.n(0);
  for_each_row_pair(from, to, direction, -1, [n, direction, sign](double const* row, double* ghost) {
    if (direction == 0) {
      for (int i = 0; i < n; ++i) ghost[i] = sign * row[n - 1 - i];
    } else {
      for (int i = 0; i < n; ++i) ghost[i] = sign * row[i];
    }
  });
}

void repeat(Part<double const> const& from, Part<double> const& to, int direction) {
  int const n = to.box.n(0);
  for_each_row_pair(from, to, -1, direction, [n, direction](double const* row, double* ghost) {
    if (direction == 0) {
      for (int i = 0; i < n; ++i) ghost[i] = row[0];
    } else {
      for (int i = 0; i < n; ++i) ghost[i] = row[i];
    }
  });
}

void fill_with(double value, Part<double> const& to) {
  for (int k = 0; k < to.box.n(2); ++k) {
    for (int j = 0; j < to.box.n(1); ++j) std::fill_n(to.row(j, k), to.box.n(0), value);
  }
}

}  // namespace

Exchange::Exchange(Grid const& grid, int components, ExchangeRules rules)
    : grid_(&grid),
      components_(components),
      rules_(std::move(rules)),
      plan_(grid),
      slabs_(grid, [components, dims = grid.domain().dimensions()](Block const& block) {
        std::size_t cells = 0;
        for (int d = 0; d < dims; ++d) cells = std::max(cells, ghost_box(block, d).count());
        return Slabs{Buffer(cells * components), Buffer(cells * components)};
      }) {}

void Exchange::execute(Transfer const& t, Fields const& fields, Block const& block) {
  int const direction = t.face / 2;
  CellRange const slab = ghost_box(block, direction);
  double* const ghosts = this->ghosts(block.number, t.face % 2);
  for (int c = 0; c < components_; ++c) {
    Part<double> const to{ghosts + slab.count() * static_cast<std::size_t>(c), slab, t.to};
    if (t.kind == TransferKind::fill) {
      fill_with(rules_.inflow[t.face][c], to);
      continue;
    }
    Part<double const> const from{fields.at(t.source, c), grid_->blocks()[t.source].interior(), t.from};
    switch (t.kind) {
      case TransferKind::copy: copy(from, to); break;
      case TransferKind::mirror:
        mirror(from, to, direction, c == rules_.mirrored_component[direction] ? -1.0 : 1.0);
        break;
      case TransferKind::repeat: repeat(from, to, direction); break;
      case TransferKind::fill: break;
    }
  }
}

void Exchange::follow_blocks(std::vector<int> const& before) {
  plan_ = ExchangePlan(*grid_);
  slabs_.rearrange(grid_->blocks(), before);
}

bool Exchange::slab_is_quiescent(int b, int direction, int side) const {
  auto const count = static_cast<std::ptrdiff_t>(ghost_box(grid_->blocks()[b], direction).count());
  double const* slab = ghosts(b, side);
  for (int c = 0; c < components_; ++c) {
    double const value = rules_.quiescent[c];
    if (std::any_of(slab + c * count, slab + (c + 1) * count, [value](double x) { return x != value; })) return false;
  }
  return true;
}

bool Exchange::disturbs(Transfer const& t) const {
  switch (t.kind) {
    case TransferKind::copy: return was_awake_[t.source] != 0;
    case TransferKind::mirror: {
      int const mirrored = rules_.mirrored_component[t.face / 2];
      return mirrored >= 0 && rules_.quiescent[mirrored] != 0.0;
    }
    case TransferKind::fill: return rules_.inflow[t.face] != rules_.quiescent;
    case TransferKind::repeat: return false;
  }
  return true;
}

bool Exchange::anything_to_see(int b, int direction) const {
  auto const transfers = plan_.into(b, direction);
  return std::any_of(transfers.begin(), transfers.end(), [this](Transfer const& t) { return disturbs(t); });
}

void Exchange::fill(Fields const& fields, int direction, AwakeBlocks& awake) {
  was_awake_ = awake;
  parallel_for(grid_->block_count(), [&](int b, int) {
    if (!was_awake_[b] && !anything_to_see(b, direction)) return;
    for (Transfer const& transfer : plan_.into(b, direction)) execute(transfer, fields, grid_->blocks()[b]);
    if (!was_awake_[b] && !(slab_is_quiescent(b, direction, 0) && slab_is_quiescent(b, direction, 1))) awake[b] = 1;
  });
}

std::vector<double> Exchange::gather(Fields const& fields, std::vector<Index3> const& cells) const {
  std::vector<double> values;
  values.reserve(cells.size() * components_);
  for (Index3 const& cell : cells) {
    Cell const at = grid_->locate(cell);
    for (int c = 0; c < components_; ++c) values.push_back(fields.at(at.block, c)[at.offset]);
  }
  return values;
}

}  // namespace brisance::grid
