#include "grid/exchange.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/loops.hpp"
#include "core/parallel.hpp"

namespace brisance::grid {

namespace {

/// How the cells of a box within an array are visited: neighbours along direction d lie `step[d]` values apart. A
/// negative step visits the layers backwards; with the step 0 every layer is the first one.
template <class Value>
struct Walk {
  Value* first = nullptr;
  std::array<std::ptrdiff_t, 3> step{};

  /// The cells of `box`, which is a part of an array over `all`.
  Walk(Value* data, CellRange const& all, CellRange const& box)
      : first(data + all.offset(box.lower)), step{all.stride(0), all.stride(1), all.stride(2)} {}

  void reverse(int direction, int layers) {
    first += step[direction] * (layers - 1);
    step[direction] = -step[direction];
  }
  /// Do rows of so many cells along `d` follow each other without a gap?
  [[nodiscard]] bool continues(int d, int cells) const { return step[d + 1] == step[d] * cells; }
};

/// Calls copy_row(from, to) for the rows along x of two boxes of n[0] x n[1] x n[2] cells.
template <class CopyRow>
void for_each_row(Walk<double const> const& from, Walk<double> const& to, Index3 const& n, CopyRow const& copy_row) {
  for (int k = 0; k < n[2]; ++k) {
    double const* source = from.first + k * from.step[2];
    double* target = to.first + k * to.step[2];
    for (int j = 0; j < n[1]; ++j, source += from.step[1], target += to.step[1]) copy_row(source, target);
  }
}

/// Copies n[0] x n[1] x n[2] cells, multiplied by `sign`.
void copy(Walk<double const> const& from, Walk<double> const& to, Index3 n, double sign) {
  for (int d : {1, 0}) {
    if (!from.continues(d, n[d]) || !to.continues(d, n[d])) continue;
    n[d] *= n[d + 1];
    n[d + 1] = 1;
  }
  std::ptrdiff_t const step = from.step[0];
  if (n[0] == ghost_layers) {
    for_each_row(from, to, n, [=](double const* source, double* target) {
      for (int i = 0; i < ghost_layers; ++i) target[i] = sign * source[i * step];
    });
  } else if (step == 1) {
    for_each_row(from, to, n, [=, count = n[0]](double const* source, double* target) {
      BRISANCE_VECTOR_LOOP
      for (int i = 0; i < count; ++i) target[i] = sign * source[i];
    });
  } else {
    for_each_row(from, to, n, [=, count = n[0]](double const* source, double* target) {
      for (int i = 0; i < count; ++i) target[i] = sign * source[i * step];
    });
  }
}

void fill_with(double value, Walk<double> const& to, Index3 const& n) {
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) std::fill_n(to.first + j * to.step[1] + k * to.step[2], n[0], value);
  }
}

}  // namespace

Exchange::Exchange(Grid const& grid, int components, ExchangeRules rules, int bundle_cells)
    : grid_(&grid),
      components_(components),
      bundle_cells_(bundle_cells),
      rules_(std::move(rules)),
      plan_(grid, bundle_cells),
      slabs_(grid, [](Block const&) { return Slabs{}; }) {
  fit_slabs();
}

void Exchange::fit_slabs() {
  for (Block const& block : grid_->blocks()) {
    std::array<std::size_t, 2> cells{0, 0};
    for (int face = 0; face < 2 * grid_->domain().dimensions(); ++face) {
      std::size_t& most = cells[face % 2];
      if (!plan_.links(block.number, face)) most = std::max(most, ghost_box(block, face / 2).count());
    }
    for (int side = 0; side < 2; ++side) {
      Buffer& slab = slabs_[block.number][side];
      if (slab.size() != cells[side] * components_) slab = Buffer(cells[side] * components_);
    }
  }
}

void Exchange::execute(Transfer const& t, Fields const& fields, Block const& block,
                       std::function<void(int, int, double*)> const& finer) {
  if (t.kind == TransferKind::none) return;
  int const direction = t.face / 2;
  CellRange const slab = ghost_box(block, direction);
  Index3 const n{t.to.n(0), t.to.n(1), t.to.n(2)};
  double* const ghosts = this->ghosts(block.number, t.face % 2);
  if (t.kind == TransferKind::finer) {
    finer(block.number, t.face, ghosts);
    return;
  }
  for (int c = 0; c < components_; ++c) {
    Walk<double> const to(ghosts + slab.count() * static_cast<std::size_t>(c), slab, t.to);
    if (t.kind == TransferKind::fill) {
      double const value = rules_.inflow[t.face][c];
      fill_with(value, to, n);
      continue;
    }
    Walk<double const> from(fields.at(t.source, c), grid_->blocks()[t.source].interior(), t.from);
    double sign = 1.0;
    if (t.kind == TransferKind::repeat) from.step[direction] = 0;
    if (t.kind == TransferKind::mirror) {
      from.reverse(direction, n[direction]);
      if (c == rules_.mirrored_component[direction]) sign = -1.0;
    }
    copy(from, to, n, sign);
  }
}

void Exchange::follow_blocks(std::vector<int> const& before) {
  plan_ = ExchangePlan(*grid_, bundle_cells_);
  slabs_.rearrange(grid_->blocks(), before);
  fit_slabs();
}

bool Exchange::sees_quiescence(Transfer const& t, Fields const& fields, int b) const {
  bool const filled = t.kind != TransferKind::none;
  CellRange const all = filled ? ghost_box(grid_->blocks()[b], t.face / 2) : grid_->blocks()[t.source].interior();
  CellRange const seen = filled ? t.to : t.from;
  for (int c = 0; c < components_; ++c) {
    double const* const data = filled ? ghosts(b, t.face % 2) + all.count() * c : fields.at(t.source, c);
    for (int k = seen.lower[2]; k < seen.upper[2]; ++k) {
      for (int j = seen.lower[1]; j < seen.upper[1]; ++j) {
        double const* const row = data + all.offset({seen.lower[0], j, k});
        if (!all_equal(row, seen.n(0), rules_.quiescent[c])) return false;
      }
    }
  }
  return true;
}

bool Exchange::disturbs(Transfer const& t) const {
  switch (t.kind) {
    case TransferKind::copy:
    case TransferKind::finer:
    case TransferKind::none: return was_awake_[t.source] != 0;
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

void Exchange::fill(Fields const& fields, int level, int direction, AwakeBlocks& awake,
                    std::function<void(int)> const& then, std::function<void(int, int, double*)> const& finer) {
  was_awake_ = awake;
  std::vector<int> const& blocks = grid_->blocks_of(level);
  parallel_for(static_cast<int>(blocks.size()), [&](int n, int) {
    int const b = blocks[n];
    if (!was_awake_[b] && !anything_to_see(b, direction)) return;
    auto const transfers = plan_.into(b, direction);
    for (Transfer const& transfer : transfers) execute(transfer, fields, grid_->blocks()[b], finer);
    auto const is_quiet = [&](Transfer const& t) { return sees_quiescence(t, fields, b); };
    if (!was_awake_[b] && !std::all_of(transfers.begin(), transfers.end(), is_quiet)) awake[b] = 1;
    if (then) then(b);
  });
}

}  // namespace brisance::grid
