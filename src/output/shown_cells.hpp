/// The cells of a grid that a dump holds, and how their fields come into it.
#pragma once

#include <string>
#include <vector>

#include "observe/subset_cells.hpp"
#include "output/dump.hpp"
#include "output/fields.hpp"

namespace brisance::output {

/// When the state was as a dump shows it.
struct DumpMoment {
  double time = 0.0;  ///< [s]
  long step = 0;
};

/// Writes the attributes that all VTKHDF files have. `type`: "OverlappingAMR", for example.
void describe(DumpFile& file, DumpMoment const& moment, grid::Domain const& domain, std::string const& type);

/// A box of cells of one size.
struct CellBox {
  int level = 0;
  grid::CellRange cells;  ///< by their index in the domain with cells of the level
  int block = -1;         ///< the leaf that holds them; -1: they are means of finer ones
};

/// Cells in the order of a file: box by box, x fastest.
struct ShownCells {
  std::vector<CellBox> boxes;
  std::vector<hsize_t> first{0};  ///< cell of each box, and behind them the number of all

  void add(CellBox const& box);
  [[nodiscard]] hsize_t count() const { return first.back(); }
};

/// The reader of ParaView 5.11 relies on levels within the box around all cells of the next coarser one. Where one
/// reaches beyond, in at most two places a direction, cells are replaced by their mean in one of the coarser level.
void let_levels_enclose_finer_ones(std::vector<ShownCells>& levels, int dimensions);

/// Of each level from the coarsest that has any on, the leaves of a grid.
[[nodiscard]] std::vector<ShownCells> leaves_of(grid::Grid const& grid);
/// What a subset shows of them, each cell once.
[[nodiscard]] std::vector<ShownCells> leaves_of(grid::Grid const& grid, observe::SubsetCells const& subset);

/// Adds the fields of some cells to a dump, as datasets GROUP/NAME of shape (cells) or (cells, components). Means are
/// weighted by volume.
void gather_fields(Dump& dump, std::string const& group, ShownCells const& cells, grid::Grid const& grid,
                   std::vector<FieldSpec> const& fields, FieldOptions const& options, RowValues const& values);

/// Adds a dataset that describes cells, of shape (rows) or (rows, components); `values` row by row.
void gather_table(Dump& dump, FieldSpec const& spec, std::vector<double> const& values, NumberType type);

}  // namespace brisance::output
