#include "detonation/remap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "core/archive.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "detonation/profile_sources.hpp"

namespace brisance::detonation {

namespace {

using grid::Geometry;

/// Shells of a radial profile per cell of the grid, at least.
constexpr double shells_per_cell = 20.0;

/// A cell that the burst touches.
struct Touched {
  int block = 0;
  int offset = 0;
  double volume = 0.0;
  double part = 0.0;  ///< of the volume, in the burst
  double pressure = 0.0;
};

/// A sum that keeps its digits, [Neumaier74].
class Sum {
 public:
  void add(double x) {
    double const t = sum_ + x;
    rest_ += std::abs(sum_) >= std::abs(x) ? (sum_ - t) + x : (x - t) + sum_;
    sum_ = t;
  }
  [[nodiscard]] double value() const { return sum_ + rest_; }

 private:
  double sum_ = 0.0;
  double rest_ = 0.0;
};

/// Components that are no densities of anything conserved.
bool is_free(int c) { return c == gas::shock || gas::is_volume_fraction(c); }

/// Low corner of a cell relative to the centre.
Vec3 corner(grid::Metric const& metric, Index3 const& cell, Vec3 const& centre) {
  Vec3 x{0.0, 0.0, 0.0};
  for (int d = 0; d < metric.dimensions(); ++d) x[d] = metric.face(d, cell[d]) - centre[d];
  return x;
}

/// Fills the cells, without the corrections.
template <class Make>
std::vector<Touched> fill(gas::Gas& gas, Profile const& profile, Vec3 const& centre, Make&& make_source) {
  grid::Grid const& grid = gas.grid();
  using Source = decltype(make_source());
  std::vector<Source> sources;
  sources.reserve(static_cast<std::size_t>(threads()));
  for (int t = 0; t < threads(); ++t) sources.push_back(make_source());
  // A burst may lie in one block: threads share the cells of a block.
  struct Part {
    int block;
    int begin, end;  ///< offsets
    bool taken = false;
    std::vector<Touched> found{};
  };
  constexpr int part_cells = 512;
  std::vector<Part> parts;
  for (grid::Block const& block : grid.blocks()) {
    if (block.covered) continue;
    for (int begin = 0; begin < block.cell_count(); begin += part_cells)
      parts.push_back({block.number, begin, std::min(begin + part_cells, block.cell_count())});
  }
  double const reach = profile.reach();
  parallel_for(static_cast<int>(parts.size()), [&](int p, int thread) {
    Part& part = parts[p];
    int const b = part.block;
    grid::Block const& block = grid.blocks()[b];
    CellIntegrals sums;
    double const h = block.h();
    int const dims = block.metric.dimensions();
    for (int n = part.begin; n < part.end; ++n) {
      grid::Cell const cell = block.cell_at(n);
      if (block.is_covered(cell)) continue;
      Vec3 const low = corner(block.metric, block.index(cell), centre);
      if (distances(low, h, {true, dims > 1, dims > 2})[0] >= reach) continue;
      if (!sources[thread].integrate(low, h, sums)) continue;
      double const volume = block.volume(cell);
      Touched const t{
          b, n, gas.cut.volume(cell), sums.whole ? 1.0 : std::min(1.0, sums.volume / volume),
          sums.pressure / volume + (sums.whole ? 0.0 : 1.0 - sums.volume / volume) * profile.ambient_pressure};
      for (int c = 0; c < gas.fields().components(); ++c) {
        double& value = gas.fields().at(b, c)[n];
        if (value != profile.ambient[c]) part.taken = true;
        value = (1.0 - t.part) * profile.ambient[c] + sums.component[c] / volume;
      }
      part.found.push_back(t);
    }
  });
  if (std::any_of(parts.begin(), parts.end(), [](Part const& part) { return part.taken; })) {
    throw InputError(
        "the blast wave reaches gas that is not ambient (another blast wave or an initial state); stop the 1D "
        "simulation earlier");
  }
  std::vector<Touched> cells;
  for (Part const& part : parts) cells.insert(cells.end(), part.found.begin(), part.found.end());
  return cells;
}

/// Integral of a component over the touched cells, or over their parts in the burst.
double sum_over(gas::Gas const& gas, std::vector<Touched> const& cells, int c, bool parts) {
  Sum sum;
  for (Touched const& t : cells) sum.add(gas.fields().at(t.block, c)[t.offset] * t.volume * (parts ? t.part : 1.0));
  return sum.value();
}

/// What the sums over the touched cells must be.
struct Target {
  std::array<double, most_components> sum{};
  /// Does a mirror leave a half along a direction, so that the momentum has a sum of its own?
  std::array<bool, 3> halved{};
  double radial_momentum = 0.0;
  double share = 1.0;
};

Target target_of(gas::Gas const& gas, Profile const& profile, Placing const& placing,
                 std::vector<Touched> const& cells) {
  grid::Domain const& domain = gas.grid().domain();
  bool const axial = profile.domain.geometry == Geometry::axisymmetric2d;
  bool const both =
      axial && profile.mirrored && std::abs(profile.domain.lower[1]) < 1e-9 * profile.domain.smallest_cell();
  Target t;
  std::array<int, 3> const planes = planes_through(domain, placing.centre);
  for (int d = 0; d < 3; ++d) {
    t.halved[d] = planes[d] != 0;
    t.share *= t.halved[d] ? 0.5 : 1.0;
  }
  if (both) t.share *= 2.0;  // the profile holds a half
  Sum touched;
  for (Touched const& cell : cells) touched.add(cell.volume);
  Sum filled;
  grid::CellRange const of_profile = profile.domain.all_cells();
  for_each_cell(of_profile, [&](Index3 const& cell) { filled.add(profile.domain.cell_volume(cell[0])); });
  double const rest = touched.value() - t.share * filled.value();
  for (int c = 0; c < gas.fields().components(); ++c) {
    if (!is_momentum(c)) t.sum[c] = t.share * profile.sum(c) + profile.ambient[c] * rest;
  }
  // Means of the components of a unit vector over the part of the sphere or circle that the mirrors leave.
  double const radial = t.share * profile.sum(gas::momentum_x);
  t.radial_momentum = std::abs(radial);
  double const mean = profile.domain.geometry == Geometry::spherical1d ? 0.5 : 2.0 * std::numbers::inv_pi;
  for (int d = 0; d < domain.dimensions(); ++d) t.sum[gas::momentum_x + d] = mean * radial * planes[d];
  if (domain.geometry == Geometry::axisymmetric2d) {
    t.sum[gas::momentum_x] = 0.25 * std::numbers::pi * radial;
    t.halved[0] = true;
  }
  if (axial) {
    int const a = placing.axis;
    // Without a plane across the axis both halves count; of a profile of one half the other is its image.
    double along = 0.0;
    for (int j = 0; j < profile.domain.cells[1]; ++j) {
      double row = 0.0;
      for (int i = 0; i < profile.domain.cells[0]; ++i) {
        row += profile.component(gas::momentum_y)[of_profile.offset({i, j, 0})] * profile.domain.cell_volume(i);
      }
      bool const above = profile.domain.place(1, j + 0.5) > 0.0;
      if (planes[a] == 0) {
        along += both ? 0.0 : t.share * placing.sense * row;
      } else if (both) {
        along += t.share * planes[a] * row;
      } else if (above == (planes[a] * placing.sense > 0.0)) {
        along += 2.0 * t.share * placing.sense * row;
      }
    }
    t.sum[gas::momentum_x + a] = along;
  }
  return t;
}

/// Makes the sums those of the target; the cells take their parts of a difference by what they hold of the burst.
/// Returns the largest relative difference that there was.
double correct(gas::Gas& gas, Target const& target, std::vector<Touched> const& cells) {
  double worst = 0.0;
  for (int pass = 0; pass < 3; ++pass) {  // the later ones take the round-off of the first
    for (int c = 0; c < gas.fields().components(); ++c) {
      if (is_free(c) || (is_momentum(c) && c - gas::momentum_x >= gas.grid().domain().dimensions())) continue;
      double const difference = target.sum[c] - sum_over(gas, cells, c, false);
      double const scale = is_momentum(c) ? target.radial_momentum : std::abs(target.sum[c]);
      if (pass == 0 && scale > 0.0) worst = std::max(worst, std::abs(difference) / scale);
      if (is_momentum(c) && !target.halved[c - gas::momentum_x]) {
        // A velocity for all.
        int const fluids = gas.fluids().count;
        double const mass =
            gas::mixture_density(fluids, [&](int component) { return sum_over(gas, cells, component, true); });
        for (Touched const& t : cells) {
          double const rho = gas::mixture_density(
              fluids, [&](int component) { return gas.fields().at(t.block, component)[t.offset]; });
          gas.fields().at(t.block, c)[t.offset] += t.part * rho * (difference / mass);
        }
        continue;
      }
      double const whole = sum_over(gas, cells, c, true);
      if (whole == 0.0) continue;
      for (Touched const& t : cells) gas.fields().at(t.block, c)[t.offset] *= 1.0 + t.part * (difference / whole);
    }
  }
  return worst;
}

/// Volume fractions of products and ambient gas.
gas::Fractions products_fill(double alpha) { return gas::Fractions::of(gas::products_fluid, alpha); }

/// The volume fraction of the products in a cell that gives it the wanted pressure, between half and one and a half of
/// the way to the nearer of 0 and 1; where none does, the one there that comes nearest.
double fitted_fraction(gas::Fluids const& fluids, gas::PerFluid const& partial, double rho_e, double averaged,
                       double wanted) {
  auto const excess = [&](double alpha) {
    return gas::mixture(fluids, partial, products_fill(alpha)).pressure(rho_e) - wanted;
  };
  double const room = 0.5 * std::min(averaged, 1.0 - averaged);
  double const here = excess(averaged);
  double best = averaged;
  double best_excess = std::abs(here);
  // Steps away from the averaged value on both sides until the sign changes: the nearest solution is the right one.
  constexpr int steps = 16;
  for (int n = 1; n <= steps; ++n) {
    for (double const side : {-1.0, 1.0}) {
      double low = averaged + side * room * (n - 1) / steps;
      double high = averaged + side * room * n / steps;
      double const at_high = excess(high);
      if (std::abs(at_high) < best_excess) {
        best = high;
        best_excess = std::abs(at_high);
      }
      double const at_low = excess(low);
      if ((at_low < 0.0) == (at_high < 0.0)) continue;
      for (int half = 0; half < 50; ++half) {
        double const middle = 0.5 * (low + high);
        ((excess(middle) < 0.0) == (at_low < 0.0) ? low : high) = middle;
      }
      return 0.5 * (low + high);
    }
  }
  return best;
}

void fit_pressures(gas::Gas& gas, std::vector<Touched> const& cells, RemapReport& report) {
  if (!gas.fluids().mixed()) return;
  constexpr double trace = 1e-6;  // volume fractions that no pressure depends on
  Sum averaged;
  Sum fitted;
  long mixed = 0;
  for (Touched const& t : cells) {
    double& alpha = gas.fields().at(t.block, gas::volume_fraction(gas::products_fluid))[t.offset];
    if (alpha < trace || alpha > 1.0 - trace) continue;
    gas::PerFluid partial{};
    for (int k = 0; k < gas.fluids().count; ++k)
      partial[k] = gas.fields().at(t.block, gas::partial_density(k))[t.offset];
    double const rho = std::accumulate(partial.begin(), partial.end(), 0.0);
    double momentum2 = 0.0;
    for (int d = 0; d < 3; ++d) {
      double const m = gas.fields().at(t.block, gas::momentum_x + d)[t.offset];
      momentum2 += m * m;
    }
    double const rho_e = gas.fields().at(t.block, gas::energy)[t.offset] - 0.5 * momentum2 / rho;
    auto const error = [&](double a) {
      double const p = gas::mixture(gas.fluids(), partial, products_fill(a)).pressure(rho_e);
      return (p / t.pressure - 1.0) * (p / t.pressure - 1.0);
    };
    averaged.add(error(alpha));
    alpha = fitted_fraction(gas.fluids(), partial, rho_e, alpha, t.pressure);
    fitted.add(error(alpha));
    ++mixed;
  }
  if (mixed == 0) return;
  report.pressure_error_averaged = std::sqrt(averaged.value() / static_cast<double>(mixed));
  report.pressure_error = std::sqrt(fitted.value() / static_cast<double>(mixed));
}

void check_fit(gas::Gas const& gas, Profile const& profile) {
  Geometry const to = gas.grid().domain().geometry;
  Geometry const from = profile.domain.geometry;
  bool const fits = from == Geometry::spherical1d      ? to == Geometry::cartesian3d || to == Geometry::axisymmetric2d
                    : from == Geometry::cylindrical1d  ? to == Geometry::planar2d
                    : from == Geometry::axisymmetric2d ? to == Geometry::cartesian3d
                                                       : false;
  if (!fits) {
    throw InputError(fmt::format("a profile from {} cannot be used in {}", word_of(from), word_of(to)));
  }
  if (profile.components != gas.fields().components() || profile.components > most_components) {
    throw InputError(
        fmt::format("the profile has {} components, but the gas has {}: was it computed with another afterburn model, "
                    "or written by another program?",
                    profile.components, gas.fields().components()));
  }
}

}  // namespace

double RemapReport::error() const {
  auto const relative = [](double a, double b, double scale) { return scale > 0.0 ? std::abs(a - b) / scale : 0.0; };
  double worst = relative(after.energy, before.energy, std::abs(before.energy));
  for (int f = 0; f < gas::most_fluids; ++f)
    worst = std::max(worst, relative(after.mass[f], before.mass[f], before.mass[f]));
  for (int d = 0; d < 3; ++d) worst = std::max(worst, relative(after.momentum[d], before.momentum[d], radial_momentum));
  return worst;
}

void archive(Archive& a, RemapReport& r) {
  a(r.time, r.radius, r.cells_per_radius, r.share);
  for (gas::Amounts* sums : {&r.before, &r.after}) a(sums->mass, sums->energy, sums->momentum);
  a(r.radial_momentum, r.quadrature_error, r.pressure_error_averaged, r.pressure_error);
}

std::array<int, 3> planes_through(grid::Domain const& domain, Vec3 const& centre) {
  std::array<int, 3> through{0, 0, 0};
  for (int f = 0; f < 2 * domain.dimensions(); ++f) {
    int const d = f / 2;
    if (d == 0 && grid::radial_exponent(domain.geometry) > 0) continue;
    double const plane = f % 2 == 0 ? domain.lower[d] : domain.upper(d);
    if (domain.is_mirror(f) && std::abs(centre[d] - plane) <= 1e-6 * domain.smallest_cell())
      through[d] = f % 2 == 0 ? 1 : -1;
  }
  return through;
}

RemapReport remap(gas::Gas& gas, Profile const& profile, Placing const& placing) {
  check_fit(gas, profile);
  grid::Domain const& domain = gas.grid().domain();
  bool const axial = profile.domain.geometry == Geometry::axisymmetric2d;
  auto const fill_radial = [&] {
    // Shells far thinner than a cell cost time and move nothing.
    int const together =
        static_cast<int>(gas.grid().smallest_cell() / (shells_per_cell * profile.domain.smallest_cell()));
    Profile const shells = merged(profile, std::max(1, together));
    return fill(gas, shells, placing.centre, [&] { return RadialSource(shells, domain.geometry); });
  };
  std::vector<Touched> const cells =
      axial ? fill(gas, profile, placing.centre, [&] { return AxialSource(profile, placing); }) : fill_radial();
  if (cells.empty()) throw InputError("the blast wave lies outside the domain");
  Target const target = target_of(gas, profile, placing, cells);

  RemapReport report;
  report.time = profile.time;
  report.radius = profile.reach();
  report.cells_per_radius = report.radius / gas.grid().smallest_cell();
  report.share = target.share;
  report.radial_momentum = target.radial_momentum;
  report.quadrature_error = correct(gas, target, cells);
  fit_pressures(gas, cells, report);

  // What the cells hold beyond the burst is ambient gas.
  auto const set = [&](gas::Amounts& sums, auto&& sum) {
    for (int k = 0; k < gas.fluids().count; ++k) sums.mass[k] = sum(gas::partial_density(k));
    sums.energy = sum(gas::energy);
    for (int d = 0; d < domain.dimensions(); ++d) sums.momentum[d] = sum(gas::momentum_x + d);
  };
  set(report.before, [&](int c) { return is_momentum(c) ? target.sum[c] : target.share * profile.sum(c); });
  set(report.after, [&](int c) {
    double const held = sum_over(gas, cells, c, false);
    return is_momentum(c) ? held : held - (target.sum[c] - target.share * profile.sum(c));
  });
  return report;
}

}  // namespace brisance::detonation
