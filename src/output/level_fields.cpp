#include "output/level_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/parallel.hpp"
#include "output/dump.hpp"

namespace brisance::output {

namespace {

constexpr hsize_t chunk_cells = 65536;

/// The leaves of a level in the order of the file.
struct LevelCells {
  int level = 0;
  std::vector<int> blocks;
  std::vector<hsize_t> first;  ///< cell of each block, and behind them the number of all
  [[nodiscard]] hsize_t count() const { return first.back(); }
};

/// The levels that have leaves. They follow each other, for leaves that touch differ by one level at most.
std::vector<LevelCells> levels_of(grid::Grid const& grid) {
  std::vector<LevelCells> levels;
  for (int level = 0; level < grid.levels(); ++level) {
    LevelCells cells{level, {}, {0}};
    for (int const b : grid.blocks_of(level)) {
      if (grid.blocks()[b].covered) continue;
      cells.blocks.push_back(b);
      cells.first.push_back(cells.first.back() + static_cast<hsize_t>(grid.blocks()[b].cell_count()));
    }
    if (!cells.blocks.empty()) levels.push_back(std::move(cells));
  }
  return levels;
}

std::string group_of(std::size_t number) { return fmt::format("Level{}", number); }

/// What the fields have in some cells of a level, field by field.
std::vector<std::vector<double>> values_of(LevelCells const& level, hsize_t begin, hsize_t end, grid::Grid const& grid,
                                           std::vector<FieldSpec> const& fields, RowValues const& values) {
  std::vector<std::vector<double>> of_field;
  std::size_t components = 0;
  for (FieldSpec const& field : fields) {
    // All chunks of a dataset have one size.
    of_field.emplace_back(std::min(chunk_cells, level.count()) * field.components, 0.0);
    components += field.components;
  }
  std::vector<double> row;
  auto n = static_cast<std::size_t>(std::ranges::upper_bound(level.first, begin) - level.first.begin() - 1);
  for (; n < level.blocks.size() && level.first[n] < end; ++n) {
    grid::Block const& block = grid.blocks()[level.blocks[n]];
    row.resize(components * static_cast<std::size_t>(block.n[0]));
    for_each_row(block, [&](grid::Cell const& first) {
      hsize_t const at = level.first[n] + static_cast<hsize_t>(first.offset);
      hsize_t const low = std::max(at, begin);
      hsize_t const high = std::min(at + static_cast<hsize_t>(block.n[0]), end);
      if (low >= high) return;
      auto const count = static_cast<int>(high - low);
      values(block.cell(static_cast<int>(low - at), first.j, first.k), count, row.data());
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

void gather_boxes(Dump& dump, std::string const& group, LevelCells const& level, grid::Grid const& grid) {
  std::vector<double> bounds;
  for (int const b : level.blocks) {
    grid::CellRange const cells = grid.blocks()[b].in_domain();
    for (int d = 0; d < 3; ++d) {
      bounds.push_back(cells.lower[d]);
      bounds.push_back(cells.upper[d] - 1);
    }
  }
  DumpFile::Layout layout;
  layout.shape = layout.edge = {level.blocks.size(), 6};
  layout.type = NumberType::int32;
  int const dataset = dump.add_dataset(
      {group + "/AMRBox", "1", 6, "first and last index of the cells of each block along x, y, z"}, layout);
  dump.set_chunk(dump.add_chunks(1), dataset, {0, 0}, shuffled(bounds, layout.type));
}

void gather_level(Dump& dump, std::string const& group, LevelCells const& level, grid::Grid const& grid,
                  std::vector<FieldSpec> const& fields, FieldOptions const& options, RowValues const& values) {
  gather_boxes(dump, group, level, grid);
  if (fields.empty()) return;
  std::vector<int> datasets;
  for (FieldSpec const& field : fields) {
    FieldSpec in_group = field;
    in_group.name = group + "/CellData/" + field.name;
    datasets.push_back(dump.add_dataset(in_group, layout_of(field, level.count(), options)));
  }
  NumberType const type = options.single_precision ? NumberType::float32 : NumberType::float64;
  auto const chunks = static_cast<int>((level.count() + chunk_cells - 1) / chunk_cells);
  std::size_t const first = dump.add_chunks(chunks * fields.size());
  parallel_for(chunks, [&](int n, int) {
    hsize_t const begin = chunk_cells * static_cast<hsize_t>(n);
    auto const of_field = values_of(level, begin, std::min(begin + chunk_cells, level.count()), grid, fields, values);
    for (std::size_t f = 0; f < fields.size(); ++f) {
      std::vector<hsize_t> start{begin};
      if (fields[f].components > 1) start.push_back(0);
      dump.set_chunk(first + n * fields.size() + f, datasets[f], std::move(start), shuffled(of_field[f], type));
    }
  });
}

}  // namespace

std::shared_ptr<Dump> level_dump(double time, long step, grid::Grid const& grid, std::vector<FieldSpec> const& fields,
                                 FieldOptions const& options, RowValues const& values) {
  std::vector<LevelCells> const levels = levels_of(grid);
  grid::Domain const domain = grid.domain();
  double cells = 0.0;
  std::vector<Vec3> spacings;
  for (LevelCells const& level : levels) {
    cells += static_cast<double>(level.count());
    // Blocks of all levels are equally thick along a direction that is not resolved.
    Vec3 spacing{domain.smallest_cell(), domain.smallest_cell(), domain.smallest_cell()};
    for (int d = 0; d < domain.dimensions(); ++d) spacing[d] = grid.domain(level.level).smallest_cell();
    spacings.push_back(spacing);
  }
  double const bytes = FieldSeries::bytes_per_dump(cells, fields, options.single_precision);
  auto dump = std::make_shared<Dump>("VTKHDF", std::size_t(bytes), [time, step, domain, spacings](DumpFile& file) {
    file.attribute(file.root(), "time", std::array{time});
    file.attribute(file.root(), "step", std::array{step});
    file.attribute(file.root(), "geometry", word_of(domain.geometry));
    file.attribute(file.root(), "origin", domain.lower);
    file.attribute(file.root(), "spacing", std::array{domain.smallest_cell()});
    file.attribute(file.root(), "cells", std::array<long, 3>{domain.cells[0], domain.cells[1], domain.cells[2]});
    file.attribute(file.group(), "Version", std::array<long, 2>{1, 0});
    file.attribute(file.group(), "Type", std::string("OverlappingAMR"));
    file.attribute(file.group(), "GridDescription", std::string("XYZ"));
    file.attribute(file.group(), "Origin", domain.lower);
    for (std::size_t n = 0; n < spacings.size(); ++n) {
      Handle const level = file.add_group(group_of(n));
      file.attribute(level, "Spacing", spacings[n]);
      // The reader wants all three.
      for (char const* data : {"CellData", "PointData", "FieldData"}) (void)file.add_group(group_of(n) + "/" + data);
    }
  });
  for (std::size_t n = 0; n < levels.size(); ++n)
    gather_level(*dump, group_of(n), levels[n], grid, fields, options, values);
  return dump;
}

std::string level_index_entry(std::string const& file, double time) {
  return fmt::format("    {{\"name\": \"{}\", \"time\": {}}}", file, time);
}

}  // namespace brisance::output
