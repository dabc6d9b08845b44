/// What a case will compute and what it costs, known before anything large is allocated.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "observe/expected_peak.hpp"
#include "run/panels.hpp"
#include "run/reports.hpp"

namespace brisance::session {

/// An MPM region as it will be.
struct RegionPlan {
  Vec3 lower{0.0, 0.0, 0.0};  ///< of the smallest box around it [m]
  Vec3 upper{0.0, 0.0, 0.0};
  double cells = 0.0;
  std::array<long, 6> bridge_faces{};  ///< faces of cells on each of its sides that have a bridge
  double gas_particles = 0.0;
  double gas_steps = 0.0;  ///< estimates
  double particle_steps = 0.0;
};

/// What takes memory.
struct MemoryPart {
  std::string what;
  double bytes = 0.0;
};

/// What `check` expects at a gauge of the gas.
struct GaugePlan {
  std::string name;
  std::optional<observe::ExpectedPeak> peak;  ///< nothing where the curves do not tell
};

/// Cells of one size, where there are several.
struct LevelPlan {
  double cell = 0.0;   ///< their size [m]
  double start = 0.0;  ///< how many there are at the start
  double mean = 0.0;   ///< on average over the run, estimate
  double most = 0.0;   ///< when there are the most of all levels, estimate
};

/// A subset of the field output.
struct SubsetPlan {
  std::string name;
  long dumps = 0;
  double dump_bytes = 0.0;  ///< of one, uncompressed; estimate where cells have several sizes
};

struct Plan {
  double cells = 0.0;                 ///< of the gas; with several levels the most that there will be
  int blocks = 0;                     ///< with several levels those of the start
  std::vector<LevelPlan> levels;      ///< from the coarsest on; empty where all cells have one size
  double cell_updates = 0.0;          ///< of the gas, estimate: cells times their steps
  double memory_bytes = 0.0;          ///< estimate for the whole program
  std::vector<MemoryPart> memory;     ///< its parts, the largest first
  double machine_memory_bytes = 0.0;  ///< what this machine, or the limit set on this process, has
  double steps = 0.0;                 ///< estimate; with several levels those of the coarsest cells
  std::vector<run::ChargeReport> charges;
  std::vector<std::string> starts;  ///< how each charge starts, where it is remapped
  /// What initial states and obstacles become; empty where that would take long to count.
  std::vector<run::InitialStateReport> initial_states;
  std::vector<run::ObstacleReport> obstacles;
  std::vector<run::PanelReport> panels;
  std::vector<run::BodyReport> bodies;
  double particles = 0.0;  ///< material points; 0: a simulation of the gas alone
  std::vector<RegionPlan> regions;
  long dumps = 0;  ///< of the whole domain; 0: subsets alone are written
  std::vector<SubsetPlan> subsets;
  double dump_bytes = 0.0;        ///< of one dump, of fields and particles, uncompressed
  double last_dump_bytes = 0.0;   ///< of the last dump, which holds the peak fields too
  std::vector<GaugePlan> gauges;  ///< of the gas
  double gauge_bytes = 0.0;       ///< of all gauge files, estimate
  double checkpoint_bytes = 0.0;  ///< of one checkpoint without gauge histories, estimate for particles
  double disk_bytes = 0.0;        ///< of all that the run leaves, dumps uncompressed, and one checkpoint more
  double seconds = 0.0;           ///< estimate of the time that the run takes on all threads
  std::vector<std::string> warnings;
};

/// Works the plan out, by arithmetic where the case is large: what this machine cannot hold is not tried out. Throws
/// InputError where the case cannot be realised.
[[nodiscard]] Plan plan(run::Case const& setup);

[[nodiscard]] std::vector<GaugePlan> plan_gauges(run::Case const& setup);

/// A warning where a peak will be clipped by much, with the cell that would do.
[[nodiscard]] std::optional<std::string> clipping_warning(std::vector<GaugePlan> const& gauges, double cell);

/// Throws InputError when the case needs more memory than the machine has.
void refuse_unless_it_fits(Plan const& plan);

}  // namespace brisance::session
