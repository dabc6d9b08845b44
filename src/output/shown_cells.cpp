#include "output/shown_cells.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "core/parallel.hpp"

namespace brisance::output {

namespace {

constexpr hsize_t chunk_cells = 65536;

DumpFile::Layout layout_of(FieldSpec const& field, hsize_t cells, FieldOptions const& options) {
  DumpFile::Layout layout;
  layout.shape = {cells};
  layout.edge = {chunk_cells};
  if (field.components > 1) {
    layout.shape.push_back(hsize_t(field.components));
    layout.edge.push_back(hsize_t(field.components));
  }
  layout.type = options.single_precision ? NumberType::float32 : NumberType::float64;
  layout.compression = options.compression;
  return layout;
}

/// Calls visit(first, count) for the rows of some cells of a block, by their index in the domain, as far as no finer
/// ones cover them.
template <class Visit>
void for_each_uncovered_row(grid::Block const& block, grid::CellRange const& cells, Visit&& visit) {
  for_each_uncovered_box(block, [&](grid::CellRange const& box) {
    grid::CellRange const part = common(box, cells);
    for_each_row(part, [&](Index3 const& first) { visit(first, part.n(0)); });
  });
}

/// What gives the values of rows of shown cells, from several threads.
class Rows {
 public:
  Rows(grid::Grid const& grid, RowValues const& values, std::size_t components)
      : grid_(&grid), values_(&values), components_(components), dimensions_(grid.domain().dimensions()) {}

  /// Values of `count` cells of a box from `first` on along x.
  void put(CellBox const& box, Index3 const& first, int count, std::vector<double>& row) const {
    row.assign(components_ * static_cast<std::size_t>(count), 0.0);
    if (box.block < 0) {
      put_means(box.level, first, count, row);
    } else {
      (*values_)(grid_->blocks()[box.block].cell_with(first), count, row.data());
    }
  }

 private:
  /// Means over finer cells of leaves.
  void put_means(int level, Index3 const& first, int count, std::vector<double>& sums) const {
    grid::CellRange const row{first, {first[0] + count, first[1] + 1, first[2] + 1}};
    std::vector<double> volumes(static_cast<std::size_t>(count), 0.0);
    std::vector<double> fine;
    for (int finer = std::max(level + 1, 0); finer < grid_->levels(); ++finer) {
      grid::CellRange const cells = observe::on_level(row, level, finer, dimensions_);
      grid_->for_each_block_in(finer, cells, [&](grid::Block const& block, grid::CellRange const& part) {
        for_each_uncovered_row(block, part, [&](Index3 const& index, int cells_of_row) {
          grid::Cell const cell = block.cell_with(index);
          fine.resize(components_ * static_cast<std::size_t>(cells_of_row));
          (*values_)(cell, cells_of_row, fine.data());
          for (int n = 0; n < cells_of_row; ++n) {
            auto const to = static_cast<std::size_t>(((index[0] + n) >> (finer - level)) - first[0]);
            double const volume = block.volume(cell.i + n);
            volumes[to] += volume;
            for (std::size_t c = 0; c < components_; ++c)
              sums[to * components_ + c] += volume * fine[n * components_ + c];
          }
        });
      });
    }
    for (std::size_t n = 0; n < volumes.size(); ++n) {
      for (std::size_t c = 0; c < components_; ++c) sums[n * components_ + c] /= volumes[n];
    }
  }

  grid::Grid const* grid_;
  RowValues const* values_;
  std::size_t components_;
  int dimensions_;
};

/// What the fields have in some of the cells, field by field.
std::vector<std::vector<double>> values_of(ShownCells const& cells, hsize_t begin, hsize_t end, Rows const& rows,
                                           std::vector<FieldSpec> const& fields) {
  std::vector<std::vector<double>> of_field;
  std::size_t components = 0;
  for (FieldSpec const& field : fields) {
    // All chunks of a dataset have one size.
    of_field.emplace_back(std::min(chunk_cells, cells.count()) * field.components, 0.0);
    components += field.components;
  }
  std::vector<double> row;
  auto n = static_cast<std::size_t>(std::ranges::upper_bound(cells.first, begin) - cells.first.begin() - 1);
  for (; n < cells.boxes.size() && cells.first[n] < end; ++n) {
    CellBox const& box = cells.boxes[n];
    for_each_row(box.cells, [&](Index3 const& first) {
      hsize_t const at = cells.first[n] + box.cells.offset(first);
      hsize_t const low = std::max(at, begin);
      hsize_t const high = std::min(at + static_cast<hsize_t>(box.cells.n(0)), end);
      if (low >= high) return;
      auto const count = static_cast<int>(high - low);
      rows.put(box, {first[0] + static_cast<int>(low - at), first[1], first[2]}, count, row);
      double const* from = row.data();
      for (std::size_t f = 0; f < fields.size(); ++f) {
        int const own = fields[f].components;
        double* const to = of_field[f].data() + (low - begin) * own;
        for (int cell = 0; cell < count; ++cell) {
          for (int c = 0; c < own; ++c) to[cell * own + c] = from[cell * components + c];
        }
        from += own;
      }
    });
  }
  return of_field;
}

/// The cells of the part that a cell lies in, where the domain is cut into parts of a size.
grid::CellRange part_around(Index3 const& cell, Index3 const& size) {
  grid::CellRange part;
  for (int d = 0; d < 3; ++d) {
    part.lower[d] = cell[d] - cell[d] % size[d];
    part.upper[d] = part.lower[d] + size[d];
  }
  return part;
}

/// The leaves of a level that lie in a box.
ShownCells leaves_in(grid::Grid const& grid, int level, grid::CellRange const& shown) {
  ShownCells cells;
  for (int const b : grid.blocks_of(level)) {
    grid::Block const& block = grid.blocks()[b];
    for_each_uncovered_box(block, [&](grid::CellRange const& box) {
      grid::CellRange const part = common(box, shown);
      if (!part.empty()) cells.add({level, part, b});
    });
  }
  return cells;
}

/// Boxes of the finest level that is shown where finer leaves lie, in parts as large as blocks, or as parts of blocks
/// that finer ones may cover: they hold whole leaves of finer levels.
void add_means(ShownCells& cells, grid::Grid const& grid, int level, grid::CellRange const& shown) {
  int const dimensions = grid.domain().dimensions();
  Index3 size = grid.block_size();
  for (int d = 0; d < dimensions && grid.levels() > 1; ++d) size[d] /= 2;
  std::set<Index3> corners;
  for (int finer = std::max(level + 1, 0); finer < grid.levels(); ++finer) {
    for (int const b : grid.blocks_of(finer)) {
      grid::Block const& block = grid.blocks()[b];
      if (block.covered) continue;
      Index3 const first = observe::on_level(block.in_domain(), finer, level, dimensions).lower;
      Index3 const low = part_around(first, size).lower;
      corners.insert({low[2], low[1], low[0]});  // x fastest
    }
  }
  for (Index3 const& corner : corners) {
    grid::CellRange const part = common(part_around({corner[2], corner[1], corner[0]}, size), shown);
    if (!part.empty()) cells.add({level, part, -1});
  }
}

/// The box around some cells, on a level that is as coarse as theirs or coarser.
grid::CellRange around_all(ShownCells const& cells, int level, int dimensions) {
  grid::CellRange all = observe::on_level(cells.boxes.front().cells, cells.boxes.front().level, level, dimensions);
  for (CellBox const& box : cells.boxes) {
    grid::CellRange const own = observe::on_level(box.cells, box.level, level, dimensions);
    for (int d = 0; d < 3; ++d) {
      all.lower[d] = std::min(all.lower[d], own.lower[d]);
      all.upper[d] = std::max(all.upper[d], own.upper[d]);
    }
  }
  return all;
}

/// The cells without those in a box that begins and ends with whole ones of them.
ShownCells without(ShownCells const& cells, grid::CellRange const& taken, int level, int dimensions) {
  ShownCells rest;
  for (CellBox box : cells.boxes) {
    grid::CellRange const hole = common(box.cells, observe::on_level(taken, level, box.level, dimensions));
    if (hole.empty()) {
      rest.add(box);
      continue;
    }
    // Slabs beside the hole, direction by direction; what is left is the hole.
    for (int d = 0; d < dimensions; ++d) {
      CellBox below = box;
      CellBox above = box;
      below.cells.upper[d] = hole.lower[d];
      above.cells.lower[d] = hole.upper[d];
      if (!below.cells.empty()) rest.add(below);
      if (!above.cells.empty()) rest.add(above);
      box.cells.lower[d] = hole.lower[d];
      box.cells.upper[d] = hole.upper[d];
    }
  }
  return rest;
}

/// A cell of a coarser level in which the outermost of some cells on one side lie.
grid::CellRange outermost(ShownCells const& cells, int level, int direction, int side, int dimensions) {
  CellBox const* farthest = cells.boxes.data();
  for (CellBox const& box : cells.boxes) {
    bool const farther = side == 0 ? box.cells.lower[direction] < farthest->cells.lower[direction]
                                   : box.cells.upper[direction] > farthest->cells.upper[direction];
    if (farther) farthest = &box;
  }
  grid::CellRange cell = farthest->cells;
  for (int d = 0; d < dimensions; ++d) {
    if (side == 0)
      cell.upper[d] = cell.lower[d] + 1;
    else
      cell.lower[d] = cell.upper[d] - 1;
  }
  return observe::on_level(cell, farthest->level, level, dimensions);
}

}  // namespace

void let_levels_enclose_finer_ones(std::vector<ShownCells>& levels, int dimensions) {
  for (std::size_t n = 0; n + 1 < levels.size(); ++n) {
    int const level = levels[n].boxes.front().level;
    for (std::size_t finer = n + 1; finer < levels.size(); ++finer) {
      for (int face = 0; face < 2 * dimensions; ++face) {
        int const d = face / 2;
        int const side = face % 2;
        grid::CellRange const own = around_all(levels[n], level, dimensions);
        grid::CellRange const beyond = around_all(levels[finer], level, dimensions);
        if (side == 0 ? beyond.lower[d] >= own.lower[d] : beyond.upper[d] <= own.upper[d]) continue;
        grid::CellRange const cell = outermost(levels[finer], level, d, side, dimensions);
        for (std::size_t other = n + 1; other < levels.size(); ++other)
          levels[other] = without(levels[other], cell, level, dimensions);
        levels[n].add({level, cell, -1});
        std::erase_if(levels, [](ShownCells const& cells) { return cells.count() == 0; });
        if (finer >= levels.size()) return;
      }
    }
  }
}

void describe(DumpFile& file, DumpMoment const& moment, grid::Domain const& domain, std::string const& type) {
  file.attribute(file.root(), "time", std::array{moment.time});
  file.attribute(file.root(), "step", std::array{moment.step});
  file.attribute(file.root(), "geometry", word_of(domain.geometry));
  file.attribute(file.group(), "Version", std::array<long, 2>{1, 0});
  file.attribute(file.group(), "Type", type);
}

void ShownCells::add(CellBox const& box) {
  boxes.push_back(box);
  first.push_back(first.back() + box.cells.count());
}

std::vector<ShownCells> leaves_of(grid::Grid const& grid) {
  std::vector<ShownCells> levels;
  for (int level = 0; level < grid.levels(); ++level) {
    ShownCells cells = leaves_in(grid, level, grid.domain(level).all_cells());
    if (cells.count() > 0) levels.push_back(std::move(cells));
  }
  return levels;
}

std::vector<ShownCells> leaves_of(grid::Grid const& grid, observe::SubsetCells const& subset) {
  std::vector<ShownCells> levels;
  for (int level = subset.coarsest(); level <= subset.finest(); ++level) {
    grid::CellRange const shown = subset.cells(level);
    ShownCells cells = level < 0 || level >= grid.levels() ? ShownCells{} : leaves_in(grid, level, shown);
    if (level == subset.finest()) add_means(cells, grid, level, shown);
    if (cells.count() > 0) levels.push_back(std::move(cells));
  }
  return levels;
}

void gather_fields(Dump& dump, std::string const& group, ShownCells const& cells, grid::Grid const& grid,
                   std::vector<FieldSpec> const& fields, FieldOptions const& options, RowValues const& values) {
  if (fields.empty()) return;
  std::vector<int> datasets;
  std::size_t components = 0;
  for (FieldSpec const& field : fields) {
    FieldSpec in_group = field;
    in_group.name = group + "/" + field.name;
    datasets.push_back(dump.add_dataset(in_group, layout_of(field, cells.count(), options)));
    components += field.components;
  }
  Rows const rows(grid, values, components);
  NumberType const type = options.single_precision ? NumberType::float32 : NumberType::float64;
  auto const chunks = static_cast<int>((cells.count() + chunk_cells - 1) / chunk_cells);
  std::size_t const first = dump.add_chunks(chunks * fields.size());
  parallel_for(chunks, [&](int n, int) {
    hsize_t const begin = chunk_cells * static_cast<hsize_t>(n);
    auto const of_field = values_of(cells, begin, std::min(begin + chunk_cells, cells.count()), rows, fields);
    for (std::size_t f = 0; f < fields.size(); ++f) {
      std::vector<hsize_t> start{begin};
      if (fields[f].components > 1) start.push_back(0);
      dump.set_chunk(first + n * fields.size() + f, datasets[f], std::move(start), shuffled(of_field[f], type));
    }
  });
}

void gather_table(Dump& dump, FieldSpec const& spec, std::vector<double> const& values, NumberType type) {
  auto const columns = static_cast<hsize_t>(spec.components);
  hsize_t const count = values.size() / columns;
  DumpFile::Layout layout = layout_of(spec, count, {});
  layout.type = type;
  int const dataset = dump.add_dataset(spec, layout);
  auto const chunks = static_cast<int>((count + chunk_cells - 1) / chunk_cells);
  std::size_t const first = dump.add_chunks(static_cast<std::size_t>(chunks));
  parallel_for(chunks, [&](int n, int) {
    hsize_t const begin = chunk_cells * static_cast<hsize_t>(n);
    std::vector<double> rows(std::min(chunk_cells, count) * columns, 0.0);
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(begin * columns),
                std::min(chunk_cells, count - begin) * columns, rows.begin());
    std::vector<hsize_t> start{begin};
    if (columns > 1) start.push_back(0);
    dump.set_chunk(first + n, dataset, std::move(start), shuffled(rows, type));
  });
}

}  // namespace brisance::output
