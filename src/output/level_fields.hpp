/// Field dumps of runs with cells of several sizes: VTKHDF files of type OverlappingAMR, version 1.0 of the layout
/// (https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format), and one list of them with their times,
/// `fields.hdf.series`, that ParaView opens as a time series.
///
/// They hold the cells of leaves only. ParaView 5.11 would count covered cells beside the finer ones in Slice and Clip,
/// and in 2D everywhere. Its reader relies on levels that enclose the finer ones: a few cells may be means, see
/// `let_levels_enclose_finer_ones`.
///
/// Layout of a dump `fields/fields_NNNNNN.hdf`: attributes of the root (time [s], step, geometry, origin [m], spacing
/// [m] and cells of level 0), and for each level from the coarsest that has leaves on, /VTKHDF/LevelN with the
/// attribute Spacing [m], the dataset AMRBox (first and last index in the domain of each block's cells along x, y and
/// z) and one dataset per field, CellData/NAME, shape (cells) or (cells, 3), with attributes `unit` and `meaning`:
/// block by block, x fastest. N counts the levels of the file from 0 on. Directions that are not resolved have one
/// cell.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "output/fields.hpp"
#include "output/shown_cells.hpp"

namespace brisance::output {

/// Gathers one dump of the whole domain.
[[nodiscard]] std::shared_ptr<Dump> level_dump(DumpMoment const& moment, grid::Grid const& grid,
                                               std::vector<FieldSpec> const& fields, FieldOptions const& options,
                                               RowValues const& values);

/// Gathers one dump of a box: laid out as if the box were the domain, with its coarsest cells as those of level 0.
[[nodiscard]] std::shared_ptr<Dump> box_dump(DumpMoment const& moment, grid::Grid const& grid,
                                             observe::SubsetCells const& box, std::vector<FieldSpec> const& fields,
                                             FieldOptions const& options, RowValues const& values);

/// The item of the list of files.
[[nodiscard]] std::string level_index_entry(std::string const& file, double time);

}  // namespace brisance::output
