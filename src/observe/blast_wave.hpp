/// What an engineer reads off the history of a gauge in the gas.
#pragma once

#include <optional>
#include <vector>

#include "core/vec.hpp"
#include "material/eos/eos.hpp"

namespace brisance::observe {

/// What is known of a gauge's place beside the history of its pressure: the undisturbed fluid, the cells, and how the
/// fluid moved. It tells a captured shock, which rises within some cells, from a wave that is no shock.
struct Surroundings {
  material::Eos eos;
  double density = 0.0;        ///< [kg/m3]
  double pressure = 0.0;       ///< [Pa]
  double cell = 0.0;           ///< [m]
  std::vector<Vec3> velocity;  ///< sample by sample [m/s]; empty: every front is taken for one that passes
};

/// The phase below ambient pressure that holds the lowest overpressure after the arrival.
struct NegativePhase {
  double peak = 0.0;               ///< lowest overpressure, negative [Pa]
  double time = 0.0;               ///< when [s]
  double impulse = 0.0;            ///< integral of the overpressure over the phase, or over what the record holds of it
                                   ///< [Pa s]; negative
  std::optional<double> duration;  ///< [s]; absent when the record ends before
};

/// The blast parameters of one overpressure history.
struct BlastWave {
  double peak_overpressure = 0.0;  ///< largest overpressure of the whole record [Pa]
  double peak_time = 0.0;          ///< when [s]
  /// Overpressure behind the first shock at its arrival, from the decay that follows it [Pa]; absent where the record
  /// shows no shock with a steady decay.
  std::optional<double> front_overpressure;
  /// The same of the shock that brings the record's peak: the peak freed from what the cells clip of it [Pa].
  std::optional<double> peak_front_overpressure;
  /// Arrival of the first shock [s]; absent when nothing arrived.
  std::optional<double> arrival_time;
  /// From the arrival to the first return to ambient pressure [s]; absent when the record ends before.
  std::optional<double> positive_duration;
  /// Integral of the overpressure over the positive phase, or over what the record holds of it [Pa s].
  double positive_impulse = 0.0;
  double largest_impulse = 0.0;       ///< of the running integral of the overpressure over the whole record [Pa s]
  double largest_impulse_time = 0.0;  ///< when [s]
  double final_overpressure = 0.0;    ///< mean of the last tenth of the record [Pa]
  std::optional<NegativePhase> negative;
  /// Of the shock that brings the record's peak: from its arrival until the overpressure has fallen to half [s]; absent
  /// where that peak has no front, or the record ends before.
  std::optional<double> half_width;
  /// Cells that the incident shock passes in that time; absent too where the cell is not known.
  std::optional<double> cells_per_half_width;
  /// Fraction of the peak that cells of that number cut off, see `clipping`.
  std::optional<double> expected_clipping;
  bool reflected = false;  ///< the fluid is at rest behind that shock: it has met a wall
};

/// Reads the blast parameters off a history (times [s] rising, overpressures [Pa]); linear between the samples.
///
/// Arrival. A captured shock is a steep ramp over a few cells whose middle is the best estimate of where the front is,
/// while its foot runs ahead by an amount that depends on the cell size. The first rise above 1 % of the record's peak
/// starts the first front; the front ends where the pressure falls by 1 % of what it has reached, or rises at less than
/// 5 % of the front's steepest rate. The arrival is where the pressure passes half of the front's height. Later,
/// stronger shocks (reflections) do not move it. A record that never exceeds `arrival_threshold` of the ambient
/// pressure has no arrival.
///
/// Overpressure at the front. Where the pressure falls steeply behind a shock, the cells that capture the shock clip
/// its peak, by some per cent even on fine grids. As with records of experiments, the decay is therefore continued back
/// to the front: the logarithm of the overpressure, as a straight line fitted between one and four times the captured
/// front's half width behind its top. The front stands where the sharp wave has the impulse that the record has: the
/// scheme conserves momentum, so that this is the impulse of the true wave, at a rigid wall too. It is given where the
/// front is as thin as a captured shock, the line fits, and the record goes on to fall as the line says.
[[nodiscard]] BlastWave analyse_blast(std::vector<double> const& time, std::vector<double> const& overpressure,
                                      Surroundings const* around = nullptr);

/// Running integral of a history by the trapezoidal rule [Pa s].
[[nodiscard]] std::vector<double> running_impulse(std::vector<double> const& time,
                                                  std::vector<double> const& overpressure);

/// The incident shock of a peak, as far as its capture by the cells depends on it.
struct IncidentShock {
  double strength = 0.0;   ///< overpressure as a multiple of rho c^2 / 1.4, which for air is the ambient pressure
  bool reflected = false;  ///< the peak is that of its reflection from a wall
};

/// Length over which the default gas scheme captures a shock, in cells: behind the front the pressure comes up to that
/// of the wave as 1 - exp(-x / length). From runs on converging grids, see docs/theory.md.
[[nodiscard]] double captured_length(IncidentShock const& shock);

/// Fraction of a shock's peak that the cells cut off, where the incident shock passes `cells` cells until the
/// overpressure has fallen to half: the largest value of (1 - exp(-x / captured_length)) 2^(-x / cells) falls short of
/// 1 by it.
[[nodiscard]] double clipping(double cells, IncidentShock const& shock);

/// The number of cells that clips a peak by `part`.
[[nodiscard]] double cells_for_clipping(double fraction, IncidentShock const& shock);

}  // namespace brisance::observe
