/// The gas after a change of its blocks: what stays is moved, what was refined or merged is made from the cells before.
#include <algorithm>
#include <utility>

#include "core/loops.hpp"
#include "core/parallel.hpp"
#include "gas/gas.hpp"
#include "gas/prolongation.hpp"
#include "grid/fine_cells.hpp"
#include "grid/forest.hpp"
#include "grid/means.hpp"

namespace brisance::gas {

namespace {

/// For each block the one that had its place and level; `no_neighbour`: there was none.
std::vector<int> numbers_before(grid::Grid const& before, grid::Grid const& now) {
  std::vector<int> numbers;
  numbers.reserve(now.blocks().size());
  for (grid::Block const& block : now.blocks())
    numbers.push_back(block.level < before.levels() ? before.block_of(block.level, block.in_domain().lower)
                                                    : grid::no_neighbour);
  return numbers;
}

}  // namespace

Gas::Contents Gas::contents_of(grid::Block const& block) const {
  auto const cells = static_cast<std::size_t>(block.cell_count());
  Contents contents{Buffer(components() * cells), Buffer(peaks_.values() * cells)};
  int const finer = block.level + 1;
  Index3 const corner = grid::fine_cells(block.in_domain().lower, grid_->domain().dimensions()).lower;
  if (finer < grid_->levels() && grid_->block_of(finer, corner) != grid::no_neighbour)
    merge_into(block, contents);
  else
    refine_into(block, contents);
  return contents;
}

void Gas::merge_into(grid::Block const& block, Contents& contents) const {
  auto const cells = static_cast<std::size_t>(block.cell_count());
  grid::CellRange const box = block.in_domain();
  grid_->for_each_block_in(
      block.level + 1, grid::fine_cells(box, grid_->domain().dimensions()),
      [&](grid::Block const& fine, grid::CellRange const&) {
        for (int c = 0; c < components(); ++c)
          grid::take_means(fine, fields_.at(fine.number, c), box, contents.fields.data() + c * cells);
        for (int p = 0; p < peaks_.values(); ++p)
          grid::take_means(fine, peaks_.values_of(fine.number, p), box, contents.peaks.data() + p * cells);
      });
}

void Gas::refine_into(grid::Block const& block, Contents& contents) const {
  auto const cells = static_cast<std::size_t>(block.cell_count());
  int const dims = grid_->domain().dimensions();
  int const level = block.level - 1;
  grid::CellRange const core = grid::coarse_cells(block.in_domain(), dims);
  CoarsePatch patch(fluids_, components(), grid_->domain(level), core);
  auto const take = [&](Index3 const& index, grid::Cell const& found) {
    Components u{};
    for (int c = 0; c < components(); ++c) u[c] = fields_.at(found.block, c)[found.offset];
    if (obstacles.contain(found))
      patch.set_solid(patch.box().offset(index), u);
    else
      patch.set(patch.box().offset(index), u);
  };
  grid::Domain const& domain = grid_->domain(level);
  if (grid::common(patch.box(), domain.all_cells()).count() == patch.box().count()) {
    grid_->for_each_block_in(level, patch.box(), [&](grid::Block const& from, grid::CellRange const& part) {
      for_each_cell(part, [&](Index3 const& index) { take(index, from.cell_with(index)); });
    });
  } else {
    for_each_cell(patch.box(), [&](Index3 const& index) {
      Index3 image = index;
      if (!CoarsePatch::find_image(domain, image)) return;
      if (auto const found = grid_->locate(level, image)) take(index, *found);
    });
  }
  Prolongation::Parts parts;
  for_each_cell(core, [&](Index3 const& index) {
    patch.split(index, block.metric, parts);
    grid::Cell const from = *grid_->locate(level, index);
    int part = 0;
    for_each_cell(grid::fine_cells(index, dims), [&](Index3 const& fine) {
      std::size_t const at = block.in_domain().offset(fine);
      for (int c = 0; c < components(); ++c) contents.fields[c * cells + at] = parts[part][c];
      for (int p = 0; p < peaks_.values(); ++p)
        contents.peaks[p * cells + at] = peaks_.values_of(from.block, p)[from.offset];
      ++part;
    });
  });
}

void Gas::keep_peaks_of_uncovered(grid::Grid const& next, std::vector<int> const& before) {
  if (peaks_.values() == 0) return;
  int const dims = grid_->domain().dimensions();
  for (grid::Block const& block : next.blocks()) {
    if (before[block.number] == grid::no_neighbour) continue;
    grid::Block const& old = grid_->blocks()[before[block.number]];
    for (int part = 0; part < grid::part_count(old); ++part) {
      if (!grid::is_part_covered(old, part) || grid::is_part_covered(block, part)) continue;
      Index3 const corner = old.index(grid::part(old, part).lower);
      int const finer = grid_->block_of(old.level + 1, grid::fine_cells(corner, dims).lower);
      if (finer == grid::no_neighbour) continue;
      for (int p = 0; p < peaks_.values(); ++p) {
        grid::take_means(grid_->blocks()[finer], peaks_.values_of(finer, p), old.in_domain(),
                         peaks_.values_of(old.number, p));
      }
    }
  }
}

void Gas::regrid(grid::Grid& grid, grid::Forest const& forest, Furnish const& furnish) {
  grid::Grid next(grid.domain(), grid.block_size(), forest);
  std::vector<int> const before = numbers_before(grid, next);
  std::vector<Contents> contents(before.size());
  parallel_for(static_cast<int>(before.size()), [&](int b, int) {
    if (before[b] == grid::no_neighbour && !next.blocks()[b].covered) contents[b] = contents_of(next.blocks()[b]);
  });
  keep_peaks_of_uncovered(next, before);
  std::vector<std::uint8_t> kept(grid.blocks().size(), 0);
  for (int const b : before) {
    if (b != grid::no_neighbour) kept[b] = 1;
  }
  for (int b = 0; b < grid.block_count(); ++b) {
    if (kept[b] == 0) carried_ += blocks_[b].account;
  }

  grid::Grid const old = std::exchange(grid, std::move(next));
  std::vector<grid::Block> const& blocks = grid.blocks();
  fields_.rearrange(blocks, before);
  peaks_.rearrange(blocks, before);
  blocks_.rearrange(blocks, before);
  shells_.rearrange(blocks, before);
  awake_.rearrange(blocks, before);
  disturbance_.rearrange(blocks, before);
  open_faces_.follow(old, before);
  exchange_.follow_blocks(before);
  obstacles.rearrange(old, blocks, before);
  cut = CutCells(grid, options_.bundle_cells);
  burn.rearrange(blocks, before);
  coupling.rearrange(blocks, before);
  parallel_for(grid.block_count(), [&](int b, int) {
    if (contents[b].fields.size() == 0) return;
    auto const cells = static_cast<std::size_t>(blocks[b].cell_count());
    for (int c = 0; c < components(); ++c) std::copy_n(contents[b].fields.data() + c * cells, cells, fields_.at(b, c));
    peaks_.put(b, std::move(contents[b].peaks));
  });
  std::vector<int> new_blocks;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (before[b] == grid::no_neighbour) new_blocks.push_back(static_cast<int>(b));
  }
  if (furnish) furnish(new_blocks);
  obstacles.find_near_walls(new_blocks);
  find_levels(new_blocks);
  parallel_for(static_cast<int>(new_blocks.size()), [&](int n, int) {
    int const b = new_blocks[n];
    disturbance_.find(fields_, quiet_.state, b);
    awake_[b] = options_.sleep && is_quiescent_block(b) ? 0 : 1;
  });
  load_nodes();
}

bool Gas::is_quiescent_block(int b) const {
  for (int c = 0; c < components(); ++c) {
    if (!all_equal(fields_.at(b, c), grid_->blocks()[b].cell_count(), quiet_.state[c])) return false;
  }
  return true;
}

void Gas::find_levels(std::vector<int> const& new_blocks) {
  auto const is_solid = [this](grid::Cell const& cell) { return obstacles.contain(cell); };
  levels_ = Levels(*grid_, fluids_, components(), obstacles.any() ? Levels::IsSolid(is_solid) : Levels::IsSolid());
  levels_.set_quiescent(quiet_.state, quiet_.flux, quiescent_.velocity);
  parts_.assign(grid_->levels(), {});
  tallies_.clear();
  for (int level = 0; level < grid_->levels(); ++level) {
    for (int direction = 0; direction < grid_->domain().dimensions(); ++direction) {
      parts_[level][direction] = make_parts(level, direction);
      if (parts_[level][direction].empty()) continue;
      Part const& last = parts_[level][direction].back();
      tallies_.resize(std::max(tallies_.size(), last.tally + last.chain->size()));
    }
  }
  // Those of finer levels first.
  grid::AwakeBlocks const all(*grid_, 1);
  for (int level = grid_->levels() - 2; level >= 0; --level) {
    std::vector<int> covered;
    for (int const b : new_blocks) {
      if (grid_->blocks()[b].covered_parts != 0 && grid_->blocks()[b].level == level) covered.push_back(b);
    }
    levels_.restrict(fields_, all, covered, [](int) {});
  }
}

}  // namespace brisance::gas
