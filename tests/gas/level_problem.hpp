/// Gas on several levels, for tests: its forest, blocks that come and go, obstacles, totals.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "gas/harness.hpp"
#include "grid/forest.hpp"

namespace brisance::test {

using grid::Boundary;
using grid::Geometry;
using grid::Leaf;

/// Which blocks are refined, by their centre.
using Refined = std::function<bool(Leaf const&, Vec3 const& centre)>;

/// The forest in which every block is refined for which `refined` holds.
inline grid::Forest forest_of(grid::Domain const& domain, Index3 const& size, Refined const& refined) {
  int const dims = domain.dimensions();
  Index3 parts{1, 1, 1};
  for (int d = 0; d < dims; ++d) parts[d] = (domain.cells[d] + size[d] - 1) / size[d];
  grid::Forest forest(parts, dims, grid::periodic_directions(domain));
  for (int level = 0;; ++level) {
    std::vector<std::int8_t> marks;
    for (Leaf const& leaf : forest.leaves()) {
      Vec3 centre{0.0, 0.0, 0.0};
      double const edge = std::ldexp(domain.h, -leaf.level);
      for (int d = 0; d < dims; ++d) centre[d] = domain.lower[d] + (leaf.place[d] + 0.5) * size[d] * edge;
      marks.push_back(leaf.level == level && refined(leaf, centre) ? 1 : 0);
    }
    if (std::find(marks.begin(), marks.end(), 1) == marks.end()) return forest;
    forest.adapt(marks, level + 1);
  }
}

/// A gas on several levels.
struct LevelProblem : Problem {
  Index3 size{1, 1, 1};
  Refined refined;
  bool left_coarse = false;  ///< are every third of the leaves that may be, at the start?

  std::unique_ptr<grid::Forest> forest;

  void fill(StateAt const& state) {
    for (int d = 0; d < domain.dimensions(); ++d) size[d] = block_cells;
    forest = std::make_unique<grid::Forest>(forest_of(domain, size, refined));
    if (left_coarse) {
      std::vector<std::uint8_t> may;
      for (std::size_t n = 0; n < forest->leaves().size(); ++n) may.push_back(n % 3 == 1 ? 1 : 0);
      forest->leave_coarse(may);
    }
    grid = std::make_unique<grid::Grid>(domain, size, *forest);
    fill_grid(state);
  }

  [[nodiscard]] long leaves_left_coarse() const {
    return std::count(forest->left_coarse().begin(), forest->left_coarse().end(), 1);
  }
  /// Is a cell of a level a part of one of the coarsest ones?
  [[nodiscard]] bool lies_in(grid::CellRange const& coarsest, int level, Index3 cell) const {
    for (int d = 0; d < domain.dimensions(); ++d) cell[d] = static_cast<int>(std::floor(std::ldexp(cell[d], -level)));
    return coarsest.contains(cell);
  }
  /// Makes an obstacle of some of the coarsest cells, in blocks.
  void place_obstacle(gas::Gas& of, std::vector<int> const& blocks, grid::CellRange const& obstacle) const {
    for (int const b : blocks) {
      grid::Block const& block = grid->blocks()[b];
      grid::CellRange const box = block.with_ghosts();
      std::vector<std::uint8_t> solid(box.count(), 0);
      grid::for_each_cell(box, [&](Index3 const& within) {
        solid[box.offset(within)] = lies_in(obstacle, block.level, block.index(within)) ? 1 : 0;
      });
      if (std::count(solid.begin(), solid.end(), 1) > 0) of.obstacles.set(b, std::move(solid));
    }
  }

  using Furnish = gas::Gas::Furnish;
  /// Refines and merges blocks at random, and leaves some coarse.
  void regrid(std::minstd_rand& random, int most_level) {
    std::vector<std::int8_t> marks(forest->leaves().size());
    for (std::int8_t& mark : marks) mark = static_cast<std::int8_t>(random() % 3 == 0 ? 1 : -1);
    forest->adapt(marks, most_level, [&](Leaf const&) { return random() % 2 == 0; });
    gas->regrid(*grid, *forest);
  }
  /// Refines blocks around a place, merges others, and leaves some coarse.
  void regrid_around(Vec3 const& place, double radius, int most_level, Furnish const& furnish) {
    std::vector<std::int8_t> marks;
    for (Leaf const& leaf : forest->leaves()) {
      Vec3 way{0.0, 0.0, 0.0};
      for (int d = 0; d < domain.dimensions(); ++d)
        way[d] = domain.lower[d] + (leaf.place[d] + 0.5) * size[d] * std::ldexp(domain.h, -leaf.level) - place[d];
      marks.push_back(static_cast<std::int8_t>(norm(way) < radius ? 1 : -1));
    }
    forest->adapt(marks, most_level, [](Leaf const& leaf) { return (leaf.place[0] + leaf.place[1]) % 2 == 0; });
    gas->regrid(*grid, *forest, furnish);
  }
  void step(double courant_number) {
    gas->advance(courant_number * domain.h / gas->fastest_signal(), steps % 2 == 1);
    ++steps;
  }

  /// Of all blocks, in order.
  [[nodiscard]] std::vector<std::array<int, 7>> near_walls() const {
    std::vector<std::array<int, 7>> runs;
    for (grid::Block const& block : grid->blocks()) {
      for (int d = 0; d < domain.dimensions(); ++d) {
        int const bundles = grid::Bundles(block, d, options.bundle_cells).count();
        for (int n = 0; n < bundles; ++n) {
          auto const* const found = gas->obstacles.near_walls(block.number, d, n);
          if (found == nullptr) continue;
          for (gas::WallRun const& run : *found)
            runs.push_back({block.number, d, run.q, run.count, run.distance, run.change, run.above ? 1 : 0});
        }
      }
    }
    return runs;
  }

  /// Calls visit(block, cell) for the cells of all leaves.
  template <class Visit>
  void for_each_leaf_cell(Visit&& visit) const {
    for (grid::Block const& block : grid->blocks()) {
      grid::for_each_cell(block, [&](grid::Cell const& cell) {
        if (!block.is_covered(cell)) visit(block, cell);
      });
    }
  }
  [[nodiscard]] double total(int component) const {
    long double sum = 0.0;
    for_each_leaf_cell([&](grid::Block const& block, grid::Cell const& cell) {
      sum += gas->fields().at(block.number, component)[cell.offset] * block.volume(cell);
    });
    return static_cast<double>(sum);
  }
};

/// Finer around a place, twice as fine nearer to it: level l where blocks of level l - 1 lie nearer than radius / 2^l.
inline Refined around(Vec3 const& place, double radius, int levels) {
  return [=](Leaf const& leaf, Vec3 const& centre) {
    return leaf.level < levels && norm(centre - place) < std::ldexp(radius, -leaf.level);
  };
}

inline LevelProblem problem_with(Geometry geometry, Boundary boundary, int levels, int cells = 32) {
  LevelProblem problem;
  problem.box(geometry, cells, 1.0, boundary);
  problem.block_cells = 8;
  Vec3 const middle{0.5, problem.domain.dimensions() > 1 ? 0.5 : 0.0, problem.domain.dimensions() > 2 ? 0.5 : 0.0};
  problem.refined = around(middle, 0.4, levels);
  problem.left_coarse = true;
  return problem;
}

/// The same where everything is periodic; around an axis along it, with the axis and a mirror across.
inline LevelProblem periodic_problem(Geometry geometry, gas::Scheme scheme, int levels, int cells = 32) {
  bool const radial = geometry == Geometry::axisymmetric2d;
  LevelProblem problem = problem_with(geometry, radial ? Boundary::symmetry : Boundary::periodic, levels, cells);
  if (radial) problem.domain.boundary[2] = problem.domain.boundary[3] = Boundary::periodic;
  problem.options.scheme = scheme;
  return problem;
}

/// A build without p4est has no levels.
class OnLevels : public testing::Test {
 protected:
  void SetUp() override {
    if (!grid::Forest::can_refine(2)) GTEST_SKIP() << "built without p4est";
  }
};

/// Air and products of about the density of a burst, with a diffuse interface around a place.
inline Mixed bubble(Vec3 const& x, Vec3 const& place, double radius, int dims) {
  Vec3 way = x - place;
  for (int d = dims; d < 3; ++d) way[d] = 0.0;
  Mixed s;
  s.ambient_density = 1.2;
  s.products_density = 40.0;
  s.volume_fraction = 0.5 - 0.5 * std::tanh((norm(way) - radius) / 0.03);
  s.pressure = 1e6;
  return s;
}

}  // namespace brisance::test
