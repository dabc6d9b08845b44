// What every step keeps: mass, momentum, and the sameness of a problem that is mirrored or cut into other blocks.
#include "mpm/harness.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;

class Conservation : public testing::TestWithParam<ShapeFunction> {};

INSTANTIATE_TEST_SUITE_P(Shapes, Conservation, testing::ValuesIn(all_shapes),
                         [](auto const& one) { return word_of(one.param); });

/// Three bodies that fly into each other, frictionless, rubbing and sticking, far from the faces.
Problem three_bodies(Geometry geometry, ShapeFunction shape, Transfer transfer, StressOrder order, int block_cells) {
  Problem problem;
  problem.box(geometry, 1.0, {16, 14, 10}, Boundary::outflow);
  problem.options.shape = shape;
  problem.options.transfer = transfer;
  problem.options.order = order;
  problem.options.pic_fraction = 0.05;
  problem.options.block_cells = block_cells;
  problem.options.linear_viscosity = 0.06;
  problem.options.quadratic_viscosity = 1.5;
  for (int b = 0; b < 3; ++b) problem.add(unit_solid(0.3));
  problem.contacts.push_back({0, 1, 0.0});
  problem.contacts.push_back({1, 2, 0.4});
  problem.start();
  auto const flat = [&](Vec3 v) {
    for (int d = problem.domain.dimensions(); d < 3; ++d) v[d] = 0.0;
    return v;
  };
  problem.fill_lattice(0, {3.613, 4.317, 3.229}, {6, 6, 6}, 0.5, flat({0.06, 0.02, 0.01}));
  problem.fill_lattice(1, {7.127, 4.911, 3.423}, {4, 6, 6}, 0.5, flat({-0.01, 0.0, -0.02}));
  problem.fill_lattice(2, {9.631, 4.419, 3.737}, {4, 6, 6}, 0.5, flat({-0.07, 0.03, 0.0}));
  return problem;
}

TEST_P(Conservation, MassAndMomentumInFreeFlightWithContact) {
  for (Geometry const geometry : {Geometry::planar1d, Geometry::planar2d, Geometry::cartesian3d}) {
    double worst = 0.0;
    double least_exchange = 1.0;
    for (Transfer const transfer : {Transfer::flip, Transfer::apic, Transfer::xpic}) {
      for (StressOrder const order : all_orders) {
        if (!tents_bear(GetParam(), transfer, order)) continue;
        Problem problem = three_bodies(geometry, GetParam(), transfer, order, 4);
        Vec3 const before = problem.momentum();
        double mass = 0.0;
        for (int b = 0; b < 3; ++b) mass += mpm::sums(*problem.mpm, b).mass;
        double const own = mpm::sums(*problem.mpm, 2).momentum[0];
        problem.run(15.0, 0.25);
        Vec3 const change = problem.momentum() - before;
        worst = std::max(worst, norm(change) / (mass * 0.07));
        least_exchange = std::min(least_exchange, std::abs(1.0 - mpm::sums(*problem.mpm, 2).momentum[0] / own));
        double after = 0.0;
        for (int b = 0; b < 3; ++b) after += mpm::sums(*problem.mpm, b).mass;
        // Not one particle's mass changes, but the sums run in another order.
        EXPECT_NEAR(after / mass, 1.0, 1e-14);
        EXPECT_EQ(problem.mpm->accounts().losses.particles, 0);
      }
    }
    std::printf("%s %s: momentum wrong by %.1e of m v, at least %.0f %% exchanged\n", word_of(geometry),
                word_of(GetParam()), worst, 100.0 * least_exchange);
    EXPECT_LT(worst, 1e-13);          // round-off of 60 steps
    EXPECT_GT(least_exchange, 0.05);  // they did meet
  }
}

// Half of a problem behind a mirror is the half of the whole.
TEST_P(Conservation, MirroredHalfEqualsTheWhole) {
  for (Geometry const geometry : {Geometry::planar1d, Geometry::planar2d, Geometry::cartesian3d}) {
    for (Transfer const transfer : {Transfer::flip, Transfer::apic, Transfer::xpic}) {
      std::array<std::unique_ptr<Problem>, 2> problems;
      for (int half = 0; half < 2; ++half) {
        problems[half] = std::make_unique<Problem>();
        Problem& p = *problems[half];
        int const n = 6;
        int const across = half == 1 ? n : 2 * n;
        Index3 const cells{across, across, 2 * n};  // mirrored in x and y, not in z
        double const low = half == 1 ? 0.0 : -n;
        p.box(geometry, 1.0, cells, Boundary::outflow, {low, low, -n});
        if (half == 1) p.domain.boundary[0] = p.domain.boundary[2] = Boundary::symmetry;
        p.options.shape = GetParam();
        p.options.transfer = transfer;
        p.options.block_cells = 4;
        p.add(unit_solid(0.3));
        p.add(unit_solid(0.2));
        // On a line the bodies stick: flush bodies that meet squarely make contact or not by the last digit.
        if (p.domain.dimensions() > 1) p.contacts.push_back({0, 1, 0.2});
        p.start();
        // A cross of two bodies, the second pressed on the first from both sides.
        double const start = half == 1 ? 0.0 : -2.0;
        auto const even = [&](Vec3 const& x) {
          double const y = p.domain.dimensions() > 1 ? x[1] : 0.0;
          return Vec3{-0.02 * std::sin(x[0]) * (1.0 + 0.3 * y * y), 0.01 * std::sin(y), 0.0};
        };
        p.fill(0, shape::Box{{start, start, -2.0}, {2.0, 2.0, 2.0}}, even);
        p.fill(1, shape::Box{{2.0, start, -2.0}, {4.0, 2.0, 2.0}}, [](Vec3 const&) { return Vec3{-0.03, 0.0, 0.0}; });
        if (half == 0) {
          p.fill(1, shape::Box{{-4.0, start, -2.0}, {-2.0, 2.0, 2.0}});
          p.for_each_particle(1, [&](mpm::ParticleSet& set, int q) {
            set.field(Field::velocity_x)[q] = Problem::position(set, q)[0] > 0.0 ? -0.03 : 0.03;
          });
        }
        p.run(8.0, 0.2);
      }
      // Particles of the half by their origin among those of the whole.
      double worst = 0.0;
      int const dims = problems[0]->domain.dimensions();
      for (int body = 0; body < 2; ++body) {
        std::vector<std::array<Vec3, 3>> whole;
        problems[0]->for_each_particle(body, [&](mpm::ParticleSet const& set, int q) {
          whole.push_back(
              {Problem::origin(set, q), Problem::position(set, q), Problem::get(set, q, Field::velocity_x)});
        });
        problems[1]->for_each_particle(body, [&](mpm::ParticleSet const& set, int q) {
          Vec3 const from = Problem::origin(set, q);
          double error = 1.0;
          for (auto const& twin : whole) {
            double distance = 0.0;
            for (int d = 0; d < dims; ++d) distance += std::abs(twin[0][d] - from[d]);
            if (distance > 1e-9) continue;
            error = 0.0;
            for (int d = 0; d < dims; ++d) {
              error = std::max(error, std::abs(twin[1][d] - Problem::position(set, q)[d]));
              error = std::max(error, std::abs(twin[2][d] - set.field(Field::velocity_x + d)[q]));
            }
          }
          worst = std::max(worst, error);
        });
      }
      std::printf("%s %s %s: half and whole differ by %.1e\n", word_of(geometry), word_of(GetParam()),
                  word_of(transfer), worst);
      // Sums in another order, 40 steps; particles that rub and stick turn round-off into little more.
      EXPECT_LT(worst, 1e-12);
    }
  }
}

// The same problem cut into blocks of another size.
TEST_P(Conservation, BlocksDoNotShow) {
  for (Transfer const transfer : {Transfer::flip, Transfer::apic, Transfer::xpic}) {
    if (!tents_bear(GetParam(), transfer, StressOrder::musl)) continue;
    Problem coarse = three_bodies(Geometry::cartesian3d, GetParam(), transfer, StressOrder::musl, 16);
    Problem fine = three_bodies(Geometry::cartesian3d, GetParam(), transfer, StressOrder::musl, 3);
    ASSERT_GT(fine.mpm->grid().block_count(), 8 * coarse.mpm->grid().block_count());
    coarse.run(8.0, 0.25);
    fine.run(8.0, 0.25);
    double worst = 0.0;
    for (int body = 0; body < 3; ++body) {
      for (Field const field : {Field::position_x, Field::position_y, Field::velocity_x, Field::velocity_z,
                                Field::pressure, Field::deviator_xy, Field::energy}) {
        auto const a = coarse.values(body, field);
        auto const b = fine.values(body, field);
        for (std::size_t n = 0; n < a.size(); ++n) worst = std::max(worst, std::abs(a[n] - b[n]));
      }
    }
    std::printf("%s %s: blocks of 16 and of 3 cells differ by %.1e\n", word_of(GetParam()), word_of(transfer), worst);
    EXPECT_LT(worst, 1e-12);  // sums over nodes in another order, 32 steps
  }
}

}  // namespace
}  // namespace brisance::test
