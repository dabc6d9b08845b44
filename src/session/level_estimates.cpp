#include "session/level_estimates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/error.hpp"
#include "core/text.hpp"
#include "gas/refinement.hpp"
#include "grid/partition.hpp"
#include "setup/levels.hpp"
#include "setup/place_gas.hpp"

namespace brisance::session {

namespace {

constexpr double most_leaves = 3e5;  ///< that a look at a case makes
/// Thickness of the layer of blocks of a level that a shock keeps, in edges of its blocks: blocks come and go in
/// families, those that it reaches before the next change are there already, and those behind it stay for two changes.
/// Read off simulations in 2D.
constexpr double layer_in_blocks = 5.0;
/// When the second shock of a charge reaches a place, in times of the first; read off simulations of TNT in air.
constexpr std::array followers{1.0, 2.5};
constexpr int samples = 20000;  ///< places at which the arrival of fronts is looked up
constexpr int intervals = 50;   ///< of the run, for which the fronts' areas are found

int finest_level(run::Case const& setup) {
  int finest = setup.adaptive.finest;
  for (run::MpmRegion const& region : setup.mpm_regions) finest = std::max(finest, region.level);
  return finest;
}

grid::Partition partition_of(run::Case const& setup) {
  return grid::refinable_partition_of(setup.domain, setup.numerics.block_cells);
}

/// Leaves at the start, level by level so that no large forest is made.
struct StartLeaves {
  grid::Forest forest;
  bool complete = true;       ///< else leaves that ask for finer cells have not got them
  std::vector<double> cells;  ///< by level, with those that were not made
};

/// Nothing where already the coarsest blocks are too many.
std::optional<StartLeaves> leaves_of(run::Case const& setup,
                                     std::shared_ptr<setup::LevelObstacles const> const& obstacles) {
  grid::Partition const partition = partition_of(setup);
  int const dims = setup.domain.dimensions();
  if (partition.count() > most_leaves) return std::nullopt;
  gas::RefinementRules const rules = setup::refinement_rules(setup, obstacles);
  auto const bounds = [&rules](int level, grid::CellRange const& cells) {
    gas::LevelBounds all = rules.bounds(level, cells);
    if (rules.while_bursting) all.least = std::max(all.least, rules.while_bursting(level, cells).least);
    return all;
  };
  auto const cells_of = [&](grid::Leaf const& leaf) {
    grid::CellRange cells{leaf.place, leaf.place};
    for (int d = 0; d < 3; ++d) {
      cells.lower[d] *= partition.size[d];
      cells.upper[d] = cells.lower[d] + partition.size[d];
    }
    return grid::common(cells, setup.domain_of(leaf.level).all_cells());
  };
  StartLeaves start{{partition.parts, dims, grid::periodic_directions(setup.domain)}, true, {}};
  for (int level = 0; level < rules.most_level && start.complete; ++level) {  // as `gas::refine_to`
    std::vector<std::int8_t> marks;
    double more = 0.0;
    for (grid::Leaf const& leaf : start.forest.leaves()) {
      auto const cells = leaf.level == level ? cells_of(leaf) : grid::CellRange{leaf.place, leaf.place};
      marks.push_back(!cells.empty() && bounds(level, cells).least > level ? 1 : 0);
      more += marks.back() != 0 ? std::ldexp(1.0, dims) - 1.0 : 0.0;
    }
    start.complete = static_cast<double>(marks.size()) + more <= most_leaves;
    if (start.complete) start.forest.adapt(marks, rules.most_level);
  }
  auto const least = [&](grid::Leaf const& leaf) {
    auto const cells = cells_of(leaf);
    return cells.empty() ? 0 : bounds(leaf.level, cells).least;
  };
  if (start.complete) {
    std::vector<std::uint8_t> may;
    for (grid::Leaf const& leaf : start.forest.leaves())
      may.push_back(leaf.level > 0 && least(leaf) < leaf.level ? 1 : 0);
    start.forest.leave_coarse(may);
  }
  start.cells.assign(static_cast<std::size_t>(rules.most_level) + 1, 0.0);
  for (int n = 0; n < static_cast<int>(start.forest.leaves().size()); ++n) {
    grid::Leaf const& leaf = start.forest.leaves()[n];
    grid::CellRange const cells = cells_of(leaf);
    if (cells.empty()) continue;
    int const level = start.complete ? start.forest.level_of_cells(n) : std::max(leaf.level, least(leaf));
    start.cells[static_cast<std::size_t>(level)] +=
        std::ldexp(static_cast<double>(cells.count()), dims * (level - leaf.level));
  }
  return start;
}

/// Fractions of the domain whose cells are of a level or a finer one, from level 0 on.
std::vector<double> fractions_from(std::vector<double> const& cells, int dims) {
  std::vector<double> fractions(cells.size(), 0.0);
  double whole = 0.0;
  for (std::size_t l = cells.size(); l-- > 0;) {
    whole += cells[l] * std::ldexp(1.0, -dims * static_cast<int>(l));
    fractions[l] = whole;
  }
  for (double& f : fractions) f /= whole;
  return fractions;
}

/// A shock from a source, in free gas.
struct Front {
  shape::Box source;             ///< [m]
  std::array<bool, 3> counts{};  ///< directions in which the front moves
  double strength = 0.0;         ///< 4/(n+2)^2 E/rho of a strong shock, for `speed` [m2/s2 m^n]
  int order = 3;                 ///< n: 3 spherical, 2 cylindrical, 1 planar
  double slowest = 0.0;          ///< [m/s]
  double fastest = 0.0;

  /// Of a strong point explosion [Sedov59], U = 2/(n+2) (E / (rho r^n))^(1/2), and not below the speed of sound.
  [[nodiscard]] double speed(double r) const {
    return std::min(fastest, std::sqrt(slowest * slowest + strength * std::pow(std::max(r, 1e-9), -order)));
  }
  /// Distance from the source.
  [[nodiscard]] double distance(Vec3 const& x) const {
    double sum = 0.0;
    for (int d = 0; d < 3; ++d) {
      double const away = std::max({source.lower[d] - x[d], x[d] - source.upper[d], 0.0});
      if (counts[d]) sum += away * away;
    }
    return std::sqrt(sum);
  }
};

/// When a front reaches a distance, in steps of equal length.
class Arrivals {
 public:
  Arrivals(Front const& front, double farthest) : step_(farthest / count) {
    double t = 0.0;
    for (int n = 0; n < count; ++n) {
      times_.push_back(t);
      t += step_ / front.speed((n + 0.5) * step_);
    }
    times_.push_back(t);
  }
  [[nodiscard]] double at(double r) const {
    auto const n = std::min(static_cast<std::size_t>(r / step_), times_.size() - 2);
    double const part = r / step_ - static_cast<double>(n);
    return times_[n] + part * (times_[n + 1] - times_[n]);
  }

 private:
  static constexpr int count = 500;
  double step_;
  std::vector<double> times_;
};

double sound(material::Fluid const& fluid, material::Primitive const& state) {
  return material::sound_speed(fluid.eos, state.density, state.pressure) + norm(state.velocity);
}

/// What sends shocks out: charges and bodies that burn, else initial states at another pressure.
std::vector<Front> fronts_of(run::Case const& setup) {
  grid::Domain const& domain = setup.domain;
  double const quiet = sound(setup.ambient.fluid, setup.ambient.state);
  std::vector<Front> fronts;
  auto const add = [&](shape::Shape const& shape, double energy, double fastest) {
    Front front;
    front.source = shape::bounds(shape);
    front.order = domain.geometry == grid::Geometry::axisymmetric2d ? 1 : 0;
    for (int d = 0; d < domain.dimensions(); ++d) {
      double const slack = 0.5 * domain.smallest_cell();
      front.counts[d] =
          front.source.lower[d] > domain.lower[d] + slack || front.source.upper[d] < domain.upper(d) - slack;
      front.order += front.counts[d] ? 1 : 0;
      // On a wall all of the energy goes to one side.
      for (int f = 2 * d; f < 2 * d + 2; ++f) {
        double const plane = f % 2 == 0 ? domain.lower[d] : domain.upper(d);
        bool const touches = front.source.lower[d] <= plane + slack && front.source.upper[d] >= plane - slack;
        if (front.counts[d] && touches && domain.boundary[f] == grid::Boundary::wall) energy *= 2.0;
      }
    }
    front.strength = 4.0 / ((front.order + 2) * (front.order + 2)) * energy / setup.ambient.state.density;
    front.slowest = quiet;
    front.fastest = std::max(fastest, quiet);
    fronts.push_back(front);
  };
  for (run::Charge const& charge : setup.charges)
    add(charge.shape, charge.mass * charge.explosive.specific_energy(), charge.explosive.detonation_speed);
  for (run::Body const& body : setup.particles.bodies) {
    if (!body.solid.burns()) continue;
    double const mass = body.solid.density * shape::volume(body.shape, domain.geometry);
    add(body.shape, mass * body.solid.specific_energy, body.solid.detonation_speed);
  }
  if (!fronts.empty()) return fronts;
  for (run::InitialState const& initial : setup.initial_states) {
    if (initial.state.pressure == setup.ambient.state.pressure &&
        norm(initial.state.velocity - setup.ambient.state.velocity) == 0.0)
      continue;
    material::Fluid const* other = initial.fluid > 0 ? setup.other_fluid(initial.fluid) : nullptr;
    add(initial.shape, 0.0, sound(other != nullptr ? *other : setup.ambient.fluid, initial.state));
    fronts.back().slowest = fronts.back().fastest;
  }
  return fronts;
}

/// The front and its images in walls that it meets.
std::vector<Front> with_images(Front const& front, grid::Domain const& domain) {
  std::vector<Front> all{front};
  for (int f = 0; f < 2 * domain.dimensions(); ++f) {
    int const d = f / 2;
    double const plane = f % 2 == 0 ? domain.lower[d] : domain.upper(d);
    double const slack = 0.5 * domain.smallest_cell();
    bool const touches = front.source.lower[d] <= plane + slack && front.source.upper[d] >= plane - slack;
    if (!front.counts[d] || touches || !domain.is_mirror(f) || domain.is_axis(f)) continue;
    Front image = front;
    image.source.lower[d] = 2.0 * plane - front.source.upper[d];
    image.source.upper[d] = 2.0 * plane - front.source.lower[d];
    all.push_back(image);
  }
  return all;
}

/// Areas of all fronts inside the domain, in intervals of the run: lengths in 2D. The volume that a front crosses in a
/// time is its area times the way that it makes.
std::array<double, intervals> areas_of_fronts(run::Case const& setup) {
  grid::Domain const& domain = setup.domain;
  int const dims = domain.dimensions();
  double volume = 1.0;
  double diagonal = 0.0;
  for (int d = 0; d < dims; ++d) {
    double const extent = domain.upper(d) - domain.lower[d];
    volume *= extent;
    diagonal += extent * extent;
  }
  std::array<double, intervals> areas{};
  double const share = volume / samples;
  double const interval = setup.end.time / intervals;
  for (Front const& source : fronts_of(setup)) {
    Arrivals const arrivals(source, 3.0 * std::sqrt(diagonal));
    for (Front const& front : with_images(source, domain)) {
      for (int n = 0; n < samples; ++n) {
        // Places that fill the domain evenly: multiples of powers of the root of x^(d+1) = x + 1, d = 2 or 3.
        double const root = dims == 3 ? 1.2207440846057596 : 1.3247179572447460;
        Vec3 x{0.0, 0.0, 0.0};
        double step = 1.0;
        for (int d = 0; d < dims; ++d) {
          step /= root;
          double const at = 0.5 + step * (n + 1);
          x[d] = domain.lower[d] + (at - std::floor(at)) * (domain.upper(d) - domain.lower[d]);
        }
        double const r = front.distance(x);
        for (double const later : followers) {
          double const t = later * arrivals.at(r);
          if (r <= 0.0 || t >= setup.end.time) continue;
          areas[static_cast<std::size_t>(t / interval)] += later * share / (front.speed(r) * interval);
        }
      }
    }
  }
  return areas;
}

/// Cells by level where fronts take fractions of the domain beside what is fine anyway.
std::vector<double> cells_with_fronts(run::Case const& setup, std::vector<double> const& lasting, double area) {
  grid::Domain const& domain = setup.domain;
  int const dims = domain.dimensions();
  grid::Partition const partition = partition_of(setup);
  double volume = 1.0;
  for (int d = 0; d < dims; ++d) volume *= domain.upper(d) - domain.lower[d];
  std::vector<double> from(lasting.size());
  for (std::size_t l = 0; l < from.size(); ++l) {
    double const edge = partition.size[0] * setup.domain_of(static_cast<int>(l)).h;
    bool const followed = l > 0 && static_cast<int>(l) <= setup.adaptive.shocks;
    double const free = followed ? std::exp(-area * layer_in_blocks * edge / volume) : 1.0;
    from[l] = l == 0 ? 1.0 : 1.0 - free * (1.0 - lasting[l]);
  }
  std::vector<double> cells(from.size());
  for (std::size_t l = 0; l < cells.size(); ++l) {
    double const finer = l + 1 < from.size() ? std::min(from[l + 1], from[l]) : 0.0;
    cells[l] =
        (from[l] - finer) * static_cast<double>(domain.cell_count()) * std::ldexp(1.0, dims * static_cast<int>(l));
  }
  return cells;
}

double sum(std::vector<double> const& values) {
  double all = 0.0;
  for (double const v : values) all += v;
  return all;
}

/// What the limit on the cells leaves.
void keep_within_limit(run::Case const& setup, std::vector<double>& cells) {
  double const limit = setup.adaptive.most_cells;
  double const all = sum(cells);
  if (limit <= 0.0 || all <= limit) return;
  for (double& c : cells) c *= limit / all;
}

/// Cells that are finer than those of obstacles keep off their surfaces.
void require_fitting_obstacles(run::Case const& setup, grid::Grid const& grid, setup::LevelObstacles const& obstacles) {
  for (grid::Block const& block : grid.blocks()) {
    if (block.covered || block.level <= setup.adaptive.obstacles || obstacles.fit(block.level, block.in_domain()))
      continue;
    Vec3 const x = block.metric.low_corner(block.in_domain().lower);
    throw InputError(fmt::format(
        "near ({:.6g}, {:.6g}, {:.6g}) m cells of {} are specified, finer than those at surfaces of obstacles, {}: "
        "make "
        "adaptive.obstacles as fine, or keep charges, [[refine]] and the MPM region away from the obstacle",
        x[0], x[1], x[2], quantity(block.h(), "m"), quantity(setup.domain_of(setup.adaptive.obstacles).h, "m")));
  }
}

}  // namespace

StartLevels start_levels(run::Case const& setup) {
  auto const obstacles = std::make_shared<setup::LevelObstacles const>(setup);
  auto leaves = leaves_of(setup, obstacles);
  StartLevels start;
  start.cells.assign(static_cast<std::size_t>(finest_level(setup)) + 1, 0.0);
  if (!leaves) {
    start.cells[0] = static_cast<double>(setup.domain.cell_count());
    return start;
  }
  start.cells = leaves->cells;
  if (!leaves->complete) return start;
  if (setup.adaptive.most_cells > 0.0) (void)setup::start_forest(setup, obstacles);  // says if they do not suffice
  start.grid.emplace(setup.domain, partition_of(setup).size, leaves->forest);
  require_fitting_obstacles(setup, *start.grid, *obstacles);
  return start;
}

std::vector<LevelPlan> plan_levels(run::Case const& setup, StartLevels const& start) {
  int const dims = setup.domain.dimensions();
  std::vector<double> const& at_start = start.cells;
  // The cells of charges go when they have burst.
  run::Case quiet = setup;
  quiet.adaptive.charges = 0;
  auto const lasting_leaves = leaves_of(quiet, std::make_shared<setup::LevelObstacles const>(quiet));
  std::vector<double> const lasting = lasting_leaves ? lasting_leaves->cells : at_start;
  std::vector<double> const fractions = fractions_from(lasting, dims);
  std::vector<double> mean(at_start.size(), 0.0);
  std::vector<double> most = at_start;
  for (double const area : areas_of_fronts(setup)) {
    std::vector<double> cells = cells_with_fronts(setup, fractions, area);
    keep_within_limit(setup, cells);
    for (std::size_t l = 0; l < cells.size(); ++l) mean[l] += cells[l] / intervals;
    if (sum(cells) > sum(most)) most = cells;
  }
  std::vector<LevelPlan> levels;
  for (std::size_t l = 0; l < mean.size(); ++l)
    levels.push_back({setup.domain_of(static_cast<int>(l)).h, at_start[l], mean[l], most[l]});
  return levels;
}

}  // namespace brisance::session
