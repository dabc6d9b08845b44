/// Particles of a gas that crowd a cell, or are light beside others, merge; see population.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mpm/kernels.hpp"
#include "mpm/population_set.hpp"

namespace brisance::mpm {

namespace {

/// So many numbers in [0, 1] may all be further apart than a tenth; one more may not.
constexpr int compositions = 10;

/// How much the states of two particles must agree to become one.
enum class Likeness {
  composition,  ///< where a cell overflows
  state,        ///< a light particle and any other
  size,         ///< and what would split again at once stays
};

bool may_merge(GasSet const& gas, PopulationOptions const& options, int a, int b, Likeness wanted) {
  if (!gas.burnt(a) || !gas.burnt(b)) return false;
  if (gas.fraction != nullptr && std::abs(gas.fraction[a] - gas.fraction[b]) > options.composition) return false;
  if (wanted == Likeness::composition) return true;
  auto const near = [](double s, double t, double ratio) { return std::max(s, t) <= ratio * std::min(s, t); };
  if (!near(gas.pressure[a], gas.pressure[b], options.pressure_ratio)) return false;
  if (!near(gas.density[a], gas.density[b], options.density_ratio)) return false;
  double square = 0.0;
  for (int i = 0; i < 3; ++i) square += (gas.v[i][a] - gas.v[i][b]) * (gas.v[i][a] - gas.v[i][b]);
  double const reference = (gas.pressure[a] + gas.pressure[b]) / (gas.density[a] + gas.density[b]);
  if (square > options.speed * options.speed * reference) return false;
  return wanted == Likeness::state ||
         gas.volume(a) + gas.volume(b) <= options.split_volume * std::min(gas.standard(a), gas.standard(b));
}

double distance_square(GasSet const& gas, int a, int b) {
  double square = 0.0;
  for (int d = 0; d < gas.metric->dimensions(); ++d) {
    double const way = gas.x[d][a] - gas.x[d][b];
    square += way * way;
  }
  return square;
}

/// The box of a merged particle has the volume of both and is longer along the way between them, if that is not too
/// long.
void merge_halves(GasSet const& gas, int keep, int drop, double share) {
  int const dims = gas.metric->dimensions();
  std::array<double*, 3> half{};
  for (int d = 0; d < 3; ++d) half[d] = gas.set->field(Field::half_x + d);
  if (half[0] == nullptr) return;
  double both = 0.0;
  int along = 0;
  for (int const q : {keep, drop}) {
    double product = 1.0;
    for (int d = 0; d < dims; ++d) product *= half[d][q];
    both += product;
  }
  double product = 1.0;
  for (int d = 0; d < dims; ++d) {
    if (std::abs(gas.x[d][keep] - gas.x[d][drop]) > std::abs(gas.x[along][keep] - gas.x[along][drop])) along = d;
    half[d][keep] = (1.0 - share) * half[d][keep] + share * half[d][drop];
    product *= half[d][keep];
  }
  double const stretch = both / product;
  if (half[along][keep] * stretch <= Gimp::longest_half * gas.h) {
    half[along][keep] *= stretch;
  } else {
    for (int d = 0; d < dims; ++d) half[d][keep] *= std::pow(stretch, 1.0 / dims);
  }
}

/// Particle `drop` becomes a part of `keep`. Returns the heat [J].
double merge(GasSet& gas, int keep, int drop) {
  ParticleSet& set = *gas.set;
  double const mass = gas.mass[keep] + gas.mass[drop];
  double const volume = gas.volume(keep) + gas.volume(drop);
  double const of_mass = gas.mass[drop] / mass;
  double const of_volume = gas.volume(drop) / volume;
  double square = 0.0;
  for (int i = 0; i < 3; ++i) square += (gas.v[i][keep] - gas.v[i][drop]) * (gas.v[i][keep] - gas.v[i][drop]);
  double const heat = 0.5 * gas.mass[keep] * of_mass * square;
  merge_halves(gas, keep, drop, of_volume);
  for (Quantity const& quantity : quantities) {
    for (int c = 0; c < quantity.components; ++c) {
      double* values = set.field(quantity.first + c);
      if (values == nullptr) continue;
      switch (quantity.merge) {
        case Merge::own: break;
        case Merge::by_volume: values[keep] += of_volume * (values[drop] - values[keep]); break;
        case Merge::largest: values[keep] = std::max(values[keep], values[drop]); break;
        case Merge::by_mass: values[keep] += of_mass * (values[drop] - values[keep]); break;
      }
    }
  }
  gas.energy[keep] += heat / mass;
  gas.mass[keep] = mass;
  gas.density[keep] = mass / volume;
  return heat;
}

/// Thins out one cell; the members are its particles.
class Thinning {
 public:
  Thinning(GasSet& gas, PopulationOptions const& options, PopulationScratch& scratch, PopulationCount& count)
      : gas_(&gas), options_(&options), s_(&scratch), count_(&count) {}

  /// Light particles, the lightest first, go into the nearest that takes them.
  void absorb_light() {
    s_->stuck.clear();
    for (;;) {
      double heaviest = 0.0;
      for (int const q : s_->members) heaviest = std::max(heaviest, gas_->mass[q]);
      int lightest = -1;
      for (int const q : s_->members) {
        if (gas_->mass[q] * options_->mass_ratio >= heaviest || !gas_->burnt(q)) continue;
        if (gas_->volume(q) >= options_->small_volume * gas_->standard(q)) continue;
        if (std::find(s_->stuck.begin(), s_->stuck.end(), q) != s_->stuck.end()) continue;
        if (lightest < 0 || gas_->mass[q] < gas_->mass[lightest]) lightest = q;
      }
      if (lightest < 0) return;
      int partner = -1;
      double best = std::numeric_limits<double>::infinity();
      for (int const q : s_->members) {
        if (q == lightest || !may_merge(*gas_, *options_, lightest, q, Likeness::state)) continue;
        double const square = distance_square(*gas_, lightest, q);
        if (square >= best) continue;
        best = square;
        partner = q;
      }
      if (partner < 0) {
        s_->stuck.push_back(lightest);
      } else {
        join(lightest, partner);
        s_->stuck.clear();
      }
    }
  }

  /// Down to `most` particles, or at least to `limit`.
  void thin_out(int most, int limit) {
    while (static_cast<int>(s_->members.size()) > most) {
      if (join_best(Likeness::size)) continue;
      if (static_cast<int>(s_->members.size()) <= limit || !join_best(Likeness::composition)) return;
    }
  }

 private:
  bool join_best(Likeness wanted) {
    int first = -1;
    int second = -1;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < s_->members.size(); ++i) {
      for (std::size_t j = i + 1; j < s_->members.size(); ++j) {
        int const a = s_->members[i];
        int const b = s_->members[j];
        // The second moment of the mass that merging takes away.
        double const moment =
            gas_->mass[a] * gas_->mass[b] / (gas_->mass[a] + gas_->mass[b]) * distance_square(*gas_, a, b);
        if (moment >= best || !may_merge(*gas_, *options_, a, b, wanted)) continue;
        best = moment;
        first = a;
        second = b;
      }
    }
    if (first >= 0) join(first, second);
    return first >= 0;
  }

  void join(int a, int b) {
    int const keep = gas_->mass[b] > gas_->mass[a] ? b : a;
    int const drop = keep == a ? b : a;
    count_->heat += merge(*gas_, keep, drop);
    ++count_->merged;
    s_->gone[drop] = 1;
    s_->members.erase(std::find(s_->members.begin(), s_->members.end(), drop));
  }

  GasSet* gas_;
  PopulationOptions const* options_;
  PopulationScratch* s_;
  PopulationCount* count_;
};

}  // namespace

PopulationCount merge_particles(ParticleSet& set, PopulationPlace const& place, PopulationOptions const& options,
                                PopulationScratch& scratch) {
  PopulationCount count;
  if (set.empty()) return count;
  GasSet gas(set, place);
  Patch const& patch = *place.patch;
  int const cells = static_cast<int>(patch.cell_range().count());
  int const most = crowd_of(place, options);
  int const limit = std::max(2 * most, compositions);

  sort_by_cell(set, patch, scratch);
  scratch.light.assign(cells, 0.0);
  for (int q = 0; q < set.size(); ++q) {
    double& light = scratch.light[scratch.cell[q]];
    light = std::max(light, gas.mass[q]);
  }
  for (double& light : scratch.light) light /= options.mass_ratio;
  // Nearly always there is nothing to do.
  scratch.busy.assign(cells, 0);
  bool any = false;
  for (int q = 0; q < set.size(); ++q) {
    int const c = scratch.cell[q];
    bool const light = gas.mass[q] < scratch.light[c] && gas.volume(q) < options.small_volume * gas.standard(q);
    if (!light && scratch.start[c + 1] - scratch.start[c] <= most) continue;
    scratch.busy[c] = 1;
    any = true;
  }
  if (!any) return count;
  scratch.due.clear();
  for (int c = 0; c < cells; ++c) {
    if (scratch.busy[c] != 0) scratch.due.push_back(c);
  }
  list_particles(scratch);
  scratch.gone.assign(set.size(), 0);
  Thinning thinning(gas, options, scratch, count);
  for (int const c : scratch.due) {
    scratch.members.assign(scratch.sorted.begin() + scratch.start[c], scratch.sorted.begin() + scratch.start[c + 1]);
    thinning.absorb_light();
    thinning.thin_out(most, limit);
    thinning.absorb_light();  // what is light beside the particles that just merged
  }
  if (count.merged == 0) return count;
  scratch.due.clear();
  for (int q = 0; q < set.size(); ++q) {
    if (scratch.gone[q] == 0) scratch.due.push_back(q);
  }
  set.reorder(scratch.due);
  return count;
}

}  // namespace brisance::mpm
