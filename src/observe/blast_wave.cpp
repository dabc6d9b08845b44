#include "observe/blast_wave.hpp"

#include <algorithm>
#include <cmath>

#include "material/hugoniot.hpp"
#include "observe/positive_phase.hpp"

namespace brisance::observe {

namespace {

using History = std::vector<double>;

constexpr double foot_fraction = 0.01;    // of the record's peak: below it nothing has arrived
constexpr double front_end_drop = 0.01;   // of the reached pressure
constexpr double front_end_slope = 0.05;  // of the front's steepest rise
constexpr double arrival_fraction = 0.5;  // of the front's height

// Where the decay behind a front is read, in half widths of the captured front behind its top: beyond what the cells
// have bent, and not farther than that needs.
constexpr double decay_begin = 1.0;
constexpr double decay_end = 4.0;
constexpr double most_fall = 0.5;  // of the logarithm between the two ends: where it is more, they come nearer
constexpr int decay_places = 24;   // at which it is read
constexpr int fewest_samples = 4;  // that the record must have there
// Scatter about the straight line, rms of the logarithm, beyond which there is no simple decay: so much on a slow one,
// and so much of what the pressure falls by between the two ends, for a fast one is curved within these cells.
constexpr double decay_scatter = 0.01;
constexpr double decay_curvature = 0.04;
constexpr double fewest_fall = 5e-4;  // of the logarithm between the two ends: less is a plateau
constexpr double most_added = 0.5;    // of the front's height: beyond it the record does not show the wave
// The record must fall on, by at least this fraction of what the line says, until the line has fallen to 64 %: a
// plateau behind an overshoot does not.
constexpr double least_fall = 0.25;
constexpr double watched_fall = 0.45;
constexpr double later_rise = 0.01;  // of the pressure: another shock has come, which ends the watch

// A captured shock rises from a tenth to nine tenths within about 1 + 3 `captured_length` cells (2 for strong shocks, 4
// for 10 kPa in air); what takes longer than this many times as much, or than the most cells, is no shock.
constexpr double thin_margin = 2.5;
constexpr double most_cells = 10.0;
// What the capture adds to the half width of the record, in cells, where the decay does not tell the front.
constexpr double smeared_cells = 2.5;

/// Time at which the straight line through samples i - 1 and i takes `value`.
double crossing(History const& t, History const& p, std::size_t i, double value) {
  return t[i - 1] + (t[i] - t[i - 1]) * (value - p[i - 1]) / (p[i] - p[i - 1]);
}

/// First time after sample `from`, up to sample `to`, at which the pressure rises through `value`.
double rises_through(History const& t, History const& p, std::size_t from, std::size_t to, double value) {
  for (std::size_t i = from + 1; i <= to; ++i)
    if (p[i] >= value && p[i - 1] < value) return crossing(t, p, i, value);
  return t[from];
}

/// The sample at the top of the front whose foot is sample `foot`.
std::size_t front_top(History const& t, History const& p, std::size_t foot) {
  std::size_t top = foot;
  double steepest = foot > 0 ? (p[foot] - p[foot - 1]) / (t[foot] - t[foot - 1]) : 0.0;
  for (std::size_t i = foot + 1; i < p.size(); ++i) {
    double const slope = (p[i] - p[i - 1]) / (t[i] - t[i - 1]);
    if (p[i] < (1.0 - front_end_drop) * p[top] || slope < front_end_slope * steepest) break;
    if (p[i] > p[top]) top = i;
    steepest = std::max(steepest, slope);
  }
  return top;
}

/// The sample at the foot of the front whose top is sample `top`: where, going back, the steep rise has ended.
std::size_t front_foot(History const& t, History const& p, std::size_t top) {
  constexpr double descended = 0.05;  // of the top: before that the way back has not left it
  double steepest = 0.0;
  std::size_t j = top;
  for (; j > 0; --j) {
    double const slope = (p[j] - p[j - 1]) / (t[j] - t[j - 1]);
    if (p[top] - p[j] > descended * std::abs(p[top]) && slope < front_end_slope * steepest) break;
    steepest = std::max(steepest, slope);
  }
  return j;
}

/// A front that a record shows.
struct Front {
  std::size_t foot = 0;
  std::size_t top = 0;
  double arrival = 0.0;                ///< where the pressure passes half of its height [s]
  bool thin = true;                    ///< rises within the cells that capture a shock
  bool reflected = false;              ///< the fluid is at rest behind it
  double cell_time = 0.0;              ///< in which the incident shock passes a cell [s]; 0: not known
  double strength = 0.0;               ///< of the incident shock, see `IncidentShock`
  double begin = 0.0;                  ///< of the sharp wave [s]; without a reading the arrival
  std::optional<double> overpressure;  ///< of the sharp wave
};

/// Straight line through the logarithm of the overpressure over the time since `from`.
struct Decay {
  double level = 0.0;  ///< logarithm at `from`
  double rate = 0.0;   ///< by which it falls [1/s]
  double rms = 0.0;
};

std::optional<Decay> fitted_decay(History const& t, History const& p, std::size_t top, double from, double begin,
                                  double end) {
  int samples = 0;
  for (std::size_t i = top; i < p.size() && t[i] <= end; ++i) samples += t[i] >= begin ? 1 : 0;
  if (samples < fewest_samples) return std::nullopt;
  // Read at even places between the samples, so that the result does not jump when a sample enters or leaves.
  constexpr double n = decay_places;
  double const unit = end - begin;
  double sx = 0.0;
  double sy = 0.0;
  double sxx = 0.0;
  double sxy = 0.0;
  double syy = 0.0;
  std::size_t i = top + 1;
  for (int k = 0; k < decay_places; ++k) {
    double const time = begin + unit * k / (decay_places - 1);
    while (i + 1 < p.size() && t[i] < time) ++i;
    double const value = p[i - 1] + (p[i] - p[i - 1]) * (time - t[i - 1]) / (t[i] - t[i - 1]);
    if (!(value > 0.0)) return std::nullopt;
    double const x = (time - from) / unit;
    double const y = std::log(value / p[top]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
    syy += y * y;
  }
  double const slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  double const level = (sy - slope * sx) / n;
  double const left = std::max(0.0, syy - level * sy - slope * sxy) / n;
  return Decay{level + std::log(p[top]), -slope / unit, std::sqrt(left)};
}

/// Does the record go on to fall after `end`, as a decay does and a plateau does not?
bool falls_on(History const& t, History const& p, Decay const& decay, double front, double overpressure, double end) {
  double const until = front + watched_fall / decay.rate;
  double lowest = overpressure;
  double time = front;
  for (std::size_t i = 0; i < p.size() && t[i] <= std::max(until, end); ++i) {
    if (t[i] < end) continue;
    if (p[i] > (1.0 + later_rise) * lowest) break;
    lowest = std::min(lowest, p[i]);
    time = t[i];
  }
  double const expected = std::min(decay.rate * (time - front), watched_fall);
  return lowest <= 0.0 || std::log(overpressure / lowest) >= least_fall * expected;
}

/// Reads what stands at `front`, see `analyse_blast`.
void read_decay(History const& t, History const& p, Front& front) {
  double const half_width = t[front.top] - front.arrival;
  double const begin = t[front.top] + decay_begin * half_width;
  double end = t[front.top] + decay_end * half_width;
  if (!(half_width > 0.0) || end > t.back()) return;
  auto decay = fitted_decay(t, p, front.top, begin, begin, end);
  if (!decay || !(decay->rate > 0.0)) return;
  if (double const most = most_fall / decay->rate; end - begin > most) {
    // The logarithm of a blast is straight at first only.
    end = begin + std::max(most, half_width);
    decay = fitted_decay(t, p, front.top, begin, begin, end);
    if (!decay || !(decay->rate > 0.0)) return;
  }
  double const fall = decay->rate * (end - begin);
  // A line that the scatter could have tilted tells nothing.
  if (fall < fewest_fall || decay->rms > std::min(decay_scatter + decay_curvature * fall, 0.5 * fall)) return;

  // The sharp wave: what stood before the front until `at`, then the line. It has the impulse of the record.
  double impulse = 0.0;
  double const base = p[front.foot];
  for (std::size_t i = front.foot + 1; i < p.size() && t[i - 1] < begin; ++i) {
    double const to = std::min(t[i], begin);
    double const value = p[i - 1] + (p[i] - p[i - 1]) * (to - t[i - 1]) / (t[i] - t[i - 1]);
    impulse += 0.5 * (p[i - 1] + value) * (to - t[i - 1]);
  }
  double const at_begin = std::exp(decay->level);
  auto const sharp = [&](double at) {
    return base * (at - t[front.foot]) + at_begin / decay->rate * std::expm1(decay->rate * (begin - at));
  };
  double low = t[front.foot];
  double high = t[front.top];
  if (sharp(low) < impulse || sharp(high) > impulse) return;
  for (int n = 0; n < 60; ++n) {
    double const middle = 0.5 * (low + high);
    (sharp(middle) > impulse ? low : high) = middle;
  }
  double const overpressure = at_begin * std::exp(decay->rate * (begin - high));
  if (overpressure > (1.0 + most_added) * p[front.top]) return;
  if (!falls_on(t, p, *decay, high, overpressure, end)) return;
  front.begin = high;
  front.overpressure = overpressure;
}

/// The front between two samples.
Front read_front(History const& t, History const& p, std::size_t foot, std::size_t top, Surroundings const* around) {
  // A slow rise may end the front before its top, where steps are much shorter than the way through a cell.
  double const height = p[top] - p[foot];
  double const arrival = rises_through(t, p, foot, top, p[foot] + arrival_fraction * height);
  double const look = 2.0 * t[top] - arrival;
  for (std::size_t i = top + 1; i < p.size() && t[i] <= look; ++i) top = p[i] > p[top] ? i : top;
  Front front;
  front.foot = foot;
  front.top = top;
  front.arrival = front.begin = arrival;
  if (around != nullptr && around->cell > 0.0 && p[top] > 0.0) {
    using material::shocked;
    auto const& [eos, density, pressure, cell, velocity] = *around;
    auto incident = shocked(eos, density, pressure, pressure + p[top]);
    double slowest = incident.speed;
    if (top < velocity.size() && norm(velocity[top] - velocity.front()) < 0.5 * incident.jump) {
      front.reflected = true;
      incident = material::incident_of_reflected(eos, density, pressure, pressure + p[top]);
      auto const back = shocked(eos, incident.density, incident.pressure, pressure + p[top]);
      slowest = std::max(back.speed - incident.jump, 0.1 * incident.speed);
    }
    front.cell_time = cell / incident.speed;
    front.strength = 1.4 * (incident.pressure - pressure) / material::bulk_modulus(eos, density, pressure);
    double const cells = std::min(thin_margin * (1.0 + 3.0 * captured_length({front.strength})), most_cells);
    // What lies between two samples is not known.
    double const rise =
        rises_through(t, p, foot, top, p[foot] + 0.9 * height) - rises_through(t, p, foot, top, p[foot] + 0.1 * height);
    double const sampling = (t[top] - t[foot]) / static_cast<double>(top - foot);
    front.thin = rise <= cells * cell / slowest + 2.0 * sampling;
  }
  if (front.thin) read_decay(t, p, front);
  return front;
}

/// Time from the front of the peak to half of it.
void read_half_width(History const& t, History const& p, Front const& front, BlastWave& wave) {
  if (!front.thin) return;
  wave.reflected = front.reflected;
  double const half = 0.5 * front.overpressure.value_or(p[front.top]);
  std::size_t i = front.top + 1;
  while (i < p.size() && p[i] > half) ++i;
  if (i >= p.size()) return;
  double width = crossing(t, p, i, half) - front.begin;
  if (!front.overpressure) width = std::max(width - smeared_cells * front.cell_time, 0.2 * width);
  wave.half_width = width;
  if (front.cell_time > 0.0) {
    wave.cells_per_half_width = width / front.cell_time;
    wave.expected_clipping = clipping(*wave.cells_per_half_width, {front.strength, front.reflected});
  }
}

void read_positive_phase(History const& t, History const& p, std::size_t front, BlastWave& wave) {
  // It holds the whole front, also its foot.
  std::size_t begin = front;
  while (begin > 0 && p[begin - 1] > 0.0) --begin;
  if (begin > 0) wave.positive_impulse += 0.5 * p[begin] * (t[begin] - crossing(t, p, begin, 0.0));
  for (std::size_t i = begin + 1; i < p.size(); ++i) {
    if (p[i] <= 0.0) {
      double const end = crossing(t, p, i, 0.0);
      wave.positive_impulse += 0.5 * p[i - 1] * (end - t[i - 1]);
      wave.positive_duration = end - *wave.arrival_time;
      break;
    }
    wave.positive_impulse += 0.5 * (p[i - 1] + p[i]) * (t[i] - t[i - 1]);
  }
}

/// The phase around the lowest pressure after sample `from`.
void read_negative_phase(History const& t, History const& p, std::size_t from, double threshold, BlastWave& wave) {
  auto const lowest = std::size_t(std::min_element(p.begin() + std::ptrdiff_t(from), p.end()) - p.begin());
  if (!(p[lowest] < -threshold)) return;
  NegativePhase phase{p[lowest], t[lowest], 0.0, std::nullopt};
  std::size_t begin = lowest;
  while (begin > 0 && p[begin - 1] < 0.0) --begin;
  double const start = begin > 0 ? crossing(t, p, begin, 0.0) : t[0];
  phase.impulse = 0.5 * p[begin] * (t[begin] - start);
  for (std::size_t i = begin + 1; i < p.size(); ++i) {
    if (p[i] >= 0.0) {
      double const end = crossing(t, p, i, 0.0);
      phase.impulse += 0.5 * p[i - 1] * (end - t[i - 1]);
      phase.duration = end - start;
      break;
    }
    phase.impulse += 0.5 * (p[i - 1] + p[i]) * (t[i] - t[i - 1]);
  }
  wave.negative = phase;
}

/// Largest running impulse and the mean of the last tenth.
void read_sums(History const& t, History const& p, BlastWave& wave) {
  wave.largest_impulse_time = t[0];
  double sum = 0.0;
  auto const offer = [&](double value, double time) {
    if (value > wave.largest_impulse) {
      wave.largest_impulse = value;
      wave.largest_impulse_time = time;
    }
  };
  for (std::size_t i = 1; i < p.size(); ++i) {
    // Between two samples it is largest where the pressure passes zero.
    if (p[i - 1] > 0.0 && p[i] < 0.0) {
      double const end = crossing(t, p, i, 0.0);
      offer(sum + 0.5 * p[i - 1] * (end - t[i - 1]), end);
    }
    sum += 0.5 * (p[i - 1] + p[i]) * (t[i] - t[i - 1]);
    offer(sum, t[i]);
  }
  double const begin = t.back() - 0.1 * (t.back() - t.front());
  double tail = 0.0;
  for (std::size_t i = p.size() - 1; i > 0 && t[i] > begin; --i) {
    double const from = std::max(t[i - 1], begin);
    double const value = p[i] + (p[i - 1] - p[i]) * (t[i] - from) / (t[i] - t[i - 1]);
    tail += 0.5 * (p[i] + value) * (t[i] - from);
  }
  wave.final_overpressure = t.back() > begin ? tail / (t.back() - begin) : p.back();
}

}  // namespace

BlastWave analyse_blast(History const& time, History const& overpressure, Surroundings const* around) {
  BlastWave wave;
  if (time.size() != overpressure.size()) {
    std::size_t const n = std::min(time.size(), overpressure.size());
    return analyse_blast(History(time.begin(), time.begin() + std::ptrdiff_t(n)),
                         History(overpressure.begin(), overpressure.begin() + std::ptrdiff_t(n)), around);
  }
  History const& t = time;
  History const& p = overpressure;
  if (p.empty()) return wave;
  read_sums(t, p, wave);
  auto const largest = std::size_t(std::max_element(p.begin(), p.end()) - p.begin());
  wave.peak_overpressure = p[largest];
  wave.peak_time = t[largest];
  double const threshold = around == nullptr ? 0.0 : arrival_threshold * around->pressure;
  if (!(wave.peak_overpressure > threshold)) {
    read_negative_phase(t, p, 0, threshold, wave);
    return wave;
  }

  std::size_t foot = 0;
  while (p[foot] < std::max(foot_fraction * wave.peak_overpressure, threshold)) ++foot;
  std::size_t const top = front_top(t, p, foot);
  double const level = arrival_fraction * p[top];
  std::size_t front = foot;
  while (p[front] < level) ++front;
  wave.arrival_time = front == 0 ? t[0] : crossing(t, p, front, level);
  read_positive_phase(t, p, front, wave);
  read_negative_phase(t, p, front, threshold, wave);

  // A record that begins behind the shock does not show a front.
  std::optional<Front> first;
  if (front > 0) {
    first = read_front(t, p, foot > 0 ? foot - 1 : 0, top, around);
    wave.front_overpressure = first->overpressure;
  }
  std::optional<Front> at_peak = first;
  if (!first || first->top != largest) {
    std::size_t const begin = front_foot(t, p, largest);
    at_peak = begin < largest && p[begin] < p[largest] && begin > 0
                  ? std::optional(read_front(t, p, begin, largest, around))
                  : std::nullopt;
  }
  if (at_peak) {
    wave.peak_front_overpressure = at_peak->overpressure;
    read_half_width(t, p, *at_peak, wave);
  }
  return wave;
}

std::vector<double> running_impulse(History const& t, History const& p) {
  std::vector<double> sum(t.size(), 0.0);
  for (std::size_t i = 1; i < t.size(); ++i) sum[i] = sum[i - 1] + 0.5 * (p[i - 1] + p[i]) * (t[i] - t[i - 1]);
  return sum;
}

double captured_length(IncidentShock const& shock) {
  double const x = std::max(shock.strength, 1e-6);
  double const passing = 0.55 * std::pow(x, -0.23);
  // Near walls the scheme is of first order where a shock is strong.
  return passing + (shock.reflected ? 1.15 * x * x / (1.0 + x * x) : 0.0);
}

double clipping(double cells, IncidentShock const& shock) {
  if (!(cells > 0.0)) return 1.0;
  double const a = captured_length(shock) * std::log(2.0) / cells;
  // (1 - exp(-x / w)) exp(-x / l) is largest where exp(-x / w) = a / (1 + a), a = w / l.
  return -std::expm1(a * std::log(a) - (1.0 + a) * std::log1p(a));
}

double cells_for_clipping(double fraction, IncidentShock const& shock) {
  double low = 1e-3;
  double high = 1e9;
  for (int n = 0; n < 100; ++n) {
    double const middle = std::sqrt(low * high);
    (clipping(middle, shock) > fraction ? low : high) = middle;
  }
  return high;
}

}  // namespace brisance::observe
