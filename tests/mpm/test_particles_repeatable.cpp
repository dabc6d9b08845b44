// The same answer, bit for bit, on 1, 2 and 4 threads: every field of every particle, for every choice of the method.
#include <cstring>

#include "core/error.hpp"
#include "mpm/harness.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;

/// Every field of every particle, block by block, in the order in which they are kept.
std::vector<double> everything(ShapeFunction shape, Transfer transfer, double pic, StressOrder order, int threads) {
  Problem problem;
  problem.box(Geometry::cartesian3d, 1.0, {12, 8, 8}, Boundary::outflow);
  problem.domain.boundary[2] = Boundary::symmetry;
  problem.domain.boundary[4] = problem.domain.boundary[5] = Boundary::periodic;
  problem.options.shape = shape;
  problem.options.transfer = transfer;
  problem.options.pic_fraction = pic;
  problem.options.order = order;
  problem.options.block_cells = 4;
  problem.options.linear_viscosity = 0.06;
  problem.options.quadratic_viscosity = 1.5;
  problem.options.locking_control = order == StressOrder::usl;
  problem.add(unit_solid(0.3));
  problem.add(material::von_mises_solid(1.0, 1.0, 0.3, 0.01));
  problem.contacts.push_back({0, 1, 0.3});
  problem.start();
  set_threads(threads);
  problem.fill_lattice(0, {1.613, 0.0, 2.129}, {5, 6, 6}, 0.5, {0.15, 0.02, 0.11});
  problem.fill_lattice(1, {4.317, 0.0, 2.437}, {5, 6, 6}, 0.5, {-0.10, 0.05, 0.13});
  long crossed = 0;
  std::vector<int> counts;
  int ended = 12;
  for (int n = 0; n < 12; ++n) {
    try {
      problem.mpm->advance(0.2);
    } catch (NumericalError const&) {  // tents in contact may fail, but then on any number of threads
      ended = n;
      break;
    }
    std::vector<int> now;
    for (int b = 0; b < problem.mpm->grid().block_count(); ++b) now.push_back(problem.mpm->particles(b, 0).size());
    crossed += !counts.empty() && now != counts ? 1 : 0;
    counts = now;
  }
  if (tents_bear(shape, transfer, order)) {
    EXPECT_EQ(ended, 12);
    EXPECT_GT(crossed, 0);  // particles did change their block
  }
  std::vector<double> all{static_cast<double>(ended)};
  for (int body = 0; body < 2; ++body) {
    problem.for_each_particle(body, [&](mpm::ParticleSet const& set, int q) {
      for (int f = 0; f < mpm::field_count; ++f) {
        if (double const* values = set.field(static_cast<Field>(f))) all.push_back(values[q]);
      }
    });
    all.push_back(mpm::sums(*problem.mpm, body).kinetic_energy);
    all.push_back(mpm::sums(*problem.mpm, body).internal_energy);
  }
  all.push_back(problem.mpm->stable_step());
  set_threads(1);
  return all;
}

class Repeatable : public testing::TestWithParam<std::tuple<ShapeFunction, StressOrder>> {};

INSTANTIATE_TEST_SUITE_P(All, Repeatable,
                         testing::Combine(testing::ValuesIn(all_shapes), testing::ValuesIn(all_orders)),
                         [](auto const& one) {
                           return std::string(word_of(std::get<0>(one.param))) + "_" + word_of(std::get<1>(one.param));
                         });

TEST_P(Repeatable, OnAnyNumberOfThreads) {
  auto const [shape, order] = GetParam();
  struct Way {
    Transfer transfer;
    double pic;
  };
  for (Way const way :
       {Way{Transfer::flip, 0.0}, Way{Transfer::flip, 0.1}, Way{Transfer::apic, 0.0}, Way{Transfer::xpic, 0.0}}) {
    auto const one = everything(shape, way.transfer, way.pic, order, 1);
    for (int const threads : {2, 4}) {
      auto const many = everything(shape, way.transfer, way.pic, order, threads);
      ASSERT_EQ(one.size(), many.size());
      EXPECT_EQ(std::memcmp(one.data(), many.data(), one.size() * sizeof(double)), 0)
          << word_of(way.transfer) << ", " << threads << " threads";
    }
  }
}

}  // namespace
}  // namespace brisance::test
