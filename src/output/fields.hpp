/// Field dumps: one HDF5 file per dump and one XDMF index, `fields.xmf2`, that ParaView opens as a time series.
///
/// Layout of a dump `fields/fields_NNNNNN.h5`: attributes of the root (time [s], step, geometry, origin [m], spacing
/// [m], cells, block_size [cells]) and one dataset per field, /cells/NAME, shape (nz, ny, nx) or (nz, ny, nx, 3), with
/// attributes `unit` and `meaning`. Directions that are not resolved have one cell.
///
/// Runs with cells of several sizes write other files, see level_fields.hpp.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/archive.hpp"
#include "grid/grid.hpp"
#include "output/dump_series.hpp"
#include "output/field_spec.hpp"

namespace brisance::output {

struct FieldOptions {
  bool single_precision = true;
  int compression = 1;  ///< gzip level 1 to 9, after byte shuffling
};

/// Writes the values of all fields in `count` cells of a block, from `first` on along x, to `out`: cell by cell, of a
/// cell field by field, component by component. It is called from several threads.
using RowValues = std::function<void(grid::Cell const& first, int count, double* out)>;

class FieldSeries {
 public:
  /// Writes into `folder` (which exists). Nothing is created before the first dump. `form`: `vtkhdf` for grids that may
  /// have several levels.
  FieldSeries(std::filesystem::path const& folder, FieldOptions options, DumpForm form = DumpForm::xdmf);

  /// Gathers one dump; what it returns writes it. With `vtkhdf` the leaves of all levels, else the cells of level 0.
  [[nodiscard]] GatheredDump dump(double time, long step, grid::Grid const& grid, std::vector<FieldSpec> const& fields,
                                  RowValues const& values, DumpPlace place = DumpPlace::next);

  [[nodiscard]] DumpSeries const& series() const { return series_; }
  /// What has been dumped, in a checkpoint. Reading drops the dumps that came later.
  void archive(Archive& a) { series_.archive(a); }

  /// Bytes of one dump without compression.
  [[nodiscard]] static double bytes_per_dump(grid::Domain const& domain, std::vector<FieldSpec> const& fields,
                                             bool single_precision);
  [[nodiscard]] static double bytes_per_dump(double cells, std::vector<FieldSpec> const& fields, bool single_precision);

 private:
  DumpSeries series_;
  FieldOptions options_;
  DumpForm form_;
};

}  // namespace brisance::output
