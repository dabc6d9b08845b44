#include "output/level_fields.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "output/dump.hpp"
#include "output/shown_cells.hpp"

namespace brisance::output {

namespace {

std::string group_of(std::size_t number) { return fmt::format("Level{}", number); }

/// `first`: index in the domain of the first cell along each direction that the file counts from.
void gather_boxes(Dump& dump, std::string const& group, ShownCells const& cells, Index3 const& first) {
  std::vector<double> bounds;
  for (CellBox const& box : cells.boxes) {
    for (int d = 0; d < 3; ++d) {
      bounds.push_back(box.cells.lower[d] - first[d]);
      bounds.push_back(box.cells.upper[d] - 1 - first[d]);
    }
  }
  gather_table(dump, {group + "/AMRBox", "1", 6, "first and last index of the cells of each block along x, y, z"},
               bounds, NumberType::int32);
}

/// What a file describes as if it were a domain.
struct Shown {
  std::vector<ShownCells> levels;  ///< from the coarsest on that has cells
  grid::Domain domain;
  int level = 0;         ///< of the domain's cells
  grid::CellRange part;  ///< that these are of the whole domain
};

std::shared_ptr<Dump> dump_of(Shown shown, DumpMoment const& moment, grid::Grid const& grid,
                              std::vector<FieldSpec> const& fields, FieldOptions const& options,
                              RowValues const& values) {
  grid::Domain const domain = shown.domain;
  let_levels_enclose_finer_ones(shown.levels, domain.dimensions());
  double cells = 0.0;
  std::vector<Vec3> spacings;
  for (ShownCells const& level : shown.levels) {
    cells += static_cast<double>(level.count());
    // Blocks of all levels are equally thick along a direction that is not resolved.
    double const thickness = grid.domain().smallest_cell();
    Vec3 spacing{thickness, thickness, thickness};
    for (int d = 0; d < domain.dimensions(); ++d)
      spacing[d] = observe::with_level(grid.domain(), level.boxes.front().level).smallest_cell();
    spacings.push_back(spacing);
  }
  double const bytes = FieldSeries::bytes_per_dump(cells, fields, options.single_precision);
  auto dump = std::make_shared<Dump>("VTKHDF", std::size_t(bytes), [moment, domain, spacings](DumpFile& file) {
    describe(file, moment, domain, "OverlappingAMR");
    file.attribute(file.root(), "origin", domain.lower);
    file.attribute(file.root(), "spacing", std::array{domain.smallest_cell()});
    file.attribute(file.root(), "cells", std::array<long, 3>{domain.cells[0], domain.cells[1], domain.cells[2]});
    file.attribute(file.group(), "GridDescription", std::string("XYZ"));
    file.attribute(file.group(), "Origin", domain.lower);
    for (std::size_t n = 0; n < spacings.size(); ++n) {
      Handle const level = file.add_group(group_of(n));
      file.attribute(level, "Spacing", spacings[n]);
      // The reader wants all three.
      for (char const* data : {"CellData", "PointData", "FieldData"}) (void)file.add_group(group_of(n) + "/" + data);
    }
  });
  for (std::size_t n = 0; n < shown.levels.size(); ++n) {
    ShownCells const& level = shown.levels[n];
    grid::CellRange const part =
        observe::on_level(shown.part, shown.level, level.boxes.front().level, domain.dimensions());
    gather_boxes(*dump, group_of(n), level, part.lower);
    gather_fields(*dump, group_of(n) + "/CellData", level, grid, fields, options, values);
  }
  return dump;
}

}  // namespace

std::shared_ptr<Dump> level_dump(DumpMoment const& moment, grid::Grid const& grid, std::vector<FieldSpec> const& fields,
                                 FieldOptions const& options, RowValues const& values) {
  Shown all{leaves_of(grid), grid.domain(), 0, grid.domain().all_cells()};
  return dump_of(std::move(all), moment, grid, fields, options, values);
}

std::shared_ptr<Dump> box_dump(DumpMoment const& moment, grid::Grid const& grid, observe::SubsetCells const& box,
                               std::vector<FieldSpec> const& fields, FieldOptions const& options,
                               RowValues const& values) {
  Shown part{leaves_of(grid, box), box.shown(), box.coarsest(), box.cells(box.coarsest())};
  return dump_of(std::move(part), moment, grid, fields, options, values);
}

std::string level_index_entry(std::string const& file, double time) {
  return fmt::format("    {{\"name\": \"{}\", \"time\": {}}}", file, time);
}

}  // namespace brisance::output
