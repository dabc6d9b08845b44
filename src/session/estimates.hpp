/// Estimates of memory, steps and time of a case.
#pragma once

#include "case/case.hpp"
#include "grid/grid.hpp"
#include "grid/partition.hpp"
#include "session/plan.hpp"

namespace brisance::session {

inline constexpr double double_bytes = sizeof(double);
inline constexpr double peak_components = 3.0;       // peak overpressure, running and largest impulse
inline constexpr double bytes_per_particle = 300.0;  // of a metal: its 27 values, and the room that the arrays keep
inline constexpr double bytes_per_particle_record = 200.0;

/// What this machine has, or the limit set on this process [byte].
[[nodiscard]] double machine_memory();
[[nodiscard]] int gas_fluids(run::Case const& setup);
/// Values per cell.
[[nodiscard]] int gas_components(run::Case const& setup);

/// The gas of a case whose grid is cut into blocks so.
void add_gas_memory(run::Case const& setup, grid::Partition const& partition, Plan& plan);
/// The same with several levels, of the most cells that there will be; `start`: null where it is too large for a look.
void add_level_memory(run::Case const& setup, grid::Grid const* start, Plan& plan);
/// Nodes that carry the particles: their cells, with the margins of the patches, once for each grid field.
void add_particle_memory(run::Particles const& particles, Plan& plan, int dimensions);
/// Adds the program itself, and sorts.
void sum_memory(Plan& plan);

/// Steps of the gas, good to about a factor of two.
[[nodiscard]] double estimated_steps(run::Case const& setup);
/// Length of a step of the bodies of a region that the start allows [s]; bodies in a vacuum are the region 0.
[[nodiscard]] double estimated_particle_step(run::Case const& setup, std::size_t region);
/// Steps of these bodies at the length that the start allows.
[[nodiscard]] double estimated_particle_steps(run::Case const& setup, std::size_t region);
/// Time of the steps, were no cell at rest [s].
[[nodiscard]] double estimated_seconds(run::Case const& setup, Plan const& plan);

}  // namespace brisance::session
