/// Gauges of the gas, of the material points and of bodies, and what they have recorded.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "core/vec.hpp"
#include "mpm/mpm.hpp"

namespace brisance {
class Archive;
namespace run {
class System;
}
}  // namespace brisance

namespace brisance::observe {

class GasView;
struct Stencil;

/// What a gauge in the gas records.
struct GaugeRecord {
  double time = 0.0;
  double pressure = 0.0;  ///< [Pa]
  double density = 0.0;   ///< [kg/m3]
  Vec3 velocity{0.0, 0.0, 0.0};
};

struct GaugeHistory {
  Gauge gauge;
  std::vector<GaugeRecord> records;
  std::vector<double> sampled;  ///< record by record, of the columns that are sampled: see gauge_columns.hpp
};

/// What a gauge that rides on a particle records.
struct ParticleRecord {
  double time = 0.0;
  Vec3 position{0.0, 0.0, 0.0};      ///< [m]
  Vec3 displacement{0.0, 0.0, 0.0};  ///< since the start [m]
  Vec3 velocity{0.0, 0.0, 0.0};      ///< [m/s]
  double pressure = 0.0;             ///< mean stress, tension negative [Pa]
  double mises = 0.0;                ///< equivalent stress [Pa]
  double density = 0.0;              ///< [kg/m3]
  double plastic_strain = 0.0;
  double temperature = 0.0;  ///< [K]
  double damage = 0.0;
};

/// What a gauge that watches a body records.
struct BodyRecord {
  double time = 0.0;
  mpm::BodySums sums;
};

struct ParticleGaugeHistory {
  ParticleGauge gauge;
  long identity = -1;  ///< of the particle that the gauge rides on; -1: it watches the body
  mpm::Place place;    ///< where that particle was last
  bool lost = false;   ///< the particle has left the domain: the record has ended
  std::vector<ParticleRecord> particles;
  std::vector<BodyRecord> bodies;
  std::vector<double> sampled;  ///< of `particles`, as in `GaugeHistory`
};

void archive(Archive& a, GaugeRecord& record);
void archive(Archive& a, ParticleRecord& record);
void archive(Archive& a, BodyRecord& record);

/// The histories of all gauges of a system.
class Gauges {
 public:
  /// To be made of the system that `setup::build` has built, before its first step. Nothing is recorded yet; only where
  /// the system begins with a remap, the gauges hold the ambient gas until then.
  explicit Gauges(run::System const& system);
  ~Gauges();

  std::vector<GaugeHistory> gas;
  std::vector<ParticleGaugeHistory> particles;
  /// Sums over each body, about a thousand times in a run: at the start, then whenever the gauges are sampled and the
  /// next thousandth of the end time or the end itself is reached.
  std::vector<std::vector<BodyRecord>> bodies;

  /// Records every gauge at the present time of the system, among whose timings is how long that takes.
  void sample(run::System& system);
  /// Records the gauges in leaves of a level at a time within a step [s], the end of one of the level's own steps, see
  /// `run::System::look`. Those that see cells of other levels too are left out: their times differ.
  void sample_level(run::System& system, int level, double time);
  /// Records the sums over each body at the present time, where that has not been done: for the end of a run.
  void record_bodies(run::System const& system);
  /// The histories in a checkpoint, after the system itself. Throws IoError where they are of other gauges.
  void archive(Archive& a, run::System const& system);

 private:
  void sample_gas(run::System const& system);
  void sample_gauge(run::System const& system, std::size_t number, double time);
  void sample_particles(run::System const& system);

  void find_stencils(run::System const& system);

  std::vector<Stencil> stencils_;  ///< of the gas gauges, made with `view_`
  std::unique_ptr<GasView> view_;  ///< made with the first sample, and again when blocks have changed
  long changes_ = 0;               ///< of the blocks that it knows of
};

}  // namespace brisance::observe
