/// Field dumps of planes: VTKHDF files of type UnstructuredGrid, version 1.0 of the layout
/// (https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format). They hold what the plane cuts out of each
/// cell, a square, or in 2D a line, with the cell's values.
///
/// Layout of a dump: attributes of the root (time [s], step, geometry, normal (0: x, 1: y, 2: z), position [m]), and in
/// /VTKHDF the datasets Points (corners, [m]), Connectivity (numbers of the corners of each cell), Offsets (where they
/// begin), Types, NumberOfPoints, NumberOfCells, NumberOfConnectivityIds, and one dataset per field, CellData/NAME,
/// shape (cells) or (cells, 3), with attributes `unit` and `meaning`. Cells of coarser levels come first; squares share
/// corners.
#pragma once

#include <memory>
#include <vector>

#include "output/shown_cells.hpp"

namespace brisance::output {

/// Gathers one dump. `position`: of the plane along its normal [m].
[[nodiscard]] std::shared_ptr<Dump> plane_dump(DumpMoment const& moment, grid::Grid const& grid,
                                               observe::SubsetCells const& plane, double position,
                                               std::vector<FieldSpec> const& fields, FieldOptions const& options,
                                               RowValues const& values);

/// Bytes that tell where the cells of a plane lie, per cell, without compression.
[[nodiscard]] double plane_bytes_per_cell(int dimensions);

}  // namespace brisance::output
