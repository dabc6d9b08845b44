/// Dumps of the material points: one HDF5 file per dump and one XDMF index, `points.xmf2`, that ParaView opens as a
/// time series of particles.
///
/// Layout of a dump `points/points_NNNNNN.h5`: attributes of the root (time [s], step, geometry, count) and one dataset
/// per field, /points/NAME, shape (n), (n, 3) or (n, 6: xx yy zz xy yz zx), with attributes `unit` and `meaning`. All
/// datasets have the particles in the same order, which changes from dump to dump; `body` and `identity` tell who is
/// who.
#pragma once

#include <functional>

#include "output/fields.hpp"

namespace brisance::output {

/// Values of a field at all particles, components interleaved.
using ParticleValues = std::function<void(std::string const& field, std::vector<double>& out)>;

class ParticleSeries {
 public:
  /// Writes into `folder` (which exists). Nothing is created before the first dump.
  ParticleSeries(std::filesystem::path const& folder, FieldOptions options);

  /// Gathers one dump of `count` particles, whose fields hold "position"; what it returns writes it.
  [[nodiscard]] GatheredDump dump(double time, long step, grid::Geometry geometry, long count,
                                  std::vector<FieldSpec> const& fields, ParticleValues const& values);

  [[nodiscard]] DumpSeries const& series() const { return series_; }
  /// What has been dumped, in a checkpoint. Reading drops the dumps that came later.
  void archive(Archive& a) { series_.archive(a); }

  /// Bytes of one dump without compression.
  [[nodiscard]] static double bytes_per_dump(double particles, std::vector<FieldSpec> const& fields,
                                             bool single_precision);

 private:
  DumpSeries series_;
  FieldOptions options_;
};

}  // namespace brisance::output
