/// Field dumps: one HDF5 file per dump and one XDMF index, `fields.xmf2`, that ParaView opens as a time series.
///
/// Layout of a dump `fields/fields_NNNNNN.h5`: attributes of the root (time [s], step, geometry, origin [m], spacing
/// [m], cells) and one dataset per field, /cells/NAME, shape (nz, ny, nx) or (nz, ny, nx, 3), with attributes `unit`
/// and `meaning`. Directions that are not resolved have one cell.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/archive.hpp"
#include "grid/grid.hpp"

namespace brisance::output {

/// A field as it is written.
struct FieldSpec {
  std::string name;
  std::string unit;
  int components = 1;  ///< 1 or 3, of particles 6 too: symmetric tensors, xx yy zz xy yz zx
  std::string meaning;
};

struct FieldOptions {
  bool single_precision = true;
  int compression = 1;  ///< gzip level 0 (none) to 9, after byte shuffling
};

/// Writes the values of all fields in a cell to `out`, field by field, component by component. It is called from
/// several threads.
using CellValues = std::function<void(grid::Cell const& cell, double* out)>;

/// Writes dump `number` of a kind ("fields" or "points"): `write` puts it together and writes it under the path that it
/// is given; the dump gets its name when it is complete. Returns that name, relative to the folder. Throws IoError.
std::string add_dump(std::filesystem::path const& folder, std::string const& kind, int number,
                     std::function<void(std::filesystem::path const& temporary)> const& write);

/// Makes a series of dumps ("fields" or "points") end with its first `count`: removes the later ones and writes the
/// index anew.
void drop_later_dumps(std::filesystem::path const& folder, std::string const& kind, int count,
                      std::string const& entries);

/// An XDMF index that lists the dumps' <Grid> elements as a time series.
[[nodiscard]] std::string time_series_index(std::string const& entries);

class FieldSeries {
 public:
  /// Writes into `folder` (which exists). Nothing is created before the first dump.
  FieldSeries(std::filesystem::path folder, FieldOptions options);

  /// Writes one dump and brings the index up to date. Both appear under their final names only when they are complete.
  /// Throws IoError.
  void dump(double time, long step, grid::Grid const& grid, std::vector<FieldSpec> const& fields,
            CellValues const& values);

  [[nodiscard]] int count() const { return count_; }
  /// What has been dumped, in a checkpoint. Reading drops the dumps that came later.
  void archive(Archive& a);

  /// Bytes of one dump without compression.
  [[nodiscard]] static double bytes_per_dump(grid::Domain const& domain, std::vector<FieldSpec> const& fields,
                                             bool single_precision);

 private:
  std::filesystem::path folder_;
  FieldOptions options_;
  int count_ = 0;
  std::string entries_;  ///< the index's <Grid> elements so far
};

}  // namespace brisance::output
