// Flow so violent that a second-order scheme leaves states without meaning: what keeps the cells sound is a flux, not a
// guard that adds energy. Near-vacuum tubes, products that break out into thin air, cold flow at Mach 100.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "gas/harness.hpp"
#include "gas/schemes/cold_products.hpp"

namespace brisance::test {
namespace {

struct Surroundings {
  char const* name;
  double gamma, rho, p;
};

/// Products at the density and energy of a charge that has burnt at once, as a ball, disc or layer in a gas.
Problem burst(material::Jwl const& products, double pressure, grid::Geometry geometry, int cells_per_radius,
              Surroundings const& gas, int block_cells) {
  constexpr double radius = 0.05;
  Problem problem;
  problem.options.density_floor = 1e-6;
  problem.options.pressure_floor = 1e-3;
  problem.fluids.eos[0] = material::IdealGas{gas.gamma};
  problem.fluids.eos[1] = products;
  problem.fluids.count = 2;
  problem.block_cells = block_cells;
  problem.box(geometry, 4 * cells_per_radius, 4.0 * radius, grid::Boundary::wall);
  problem.quiescent = state(gas.rho, 0.0, gas.p);
  int const dims = problem.domain.dimensions();
  problem.fill([&](Vec3 const& x) {
    Mixed s = problem.quiescent;
    double r = 0.0;
    for (int d = 0; d < dims; ++d) r += x[d] * x[d];
    s.volume_fraction = r < radius * radius ? 1.0 : 0.0;
    s.products_density = products.rho0;
    if (s.volume_fraction > 0.0) s.pressure = pressure;
    return s;
  });
  return problem;
}

// [Dobratz85]: TNT and PETN at 1770 kg/m3, and their pressures at constant volume, omega E0 and the curve at V = 1.
material::Jwl const tnt{1630.0, 371.2e9, 3.21e9, 4.15, 0.95, 0.30};
constexpr double tnt_pressure = 8.4e9;
material::Jwl const petn{1770.0, 617e9, 16.926e9, 4.4, 1.2, 0.25};
constexpr double petn_pressure = 14e9;

TEST(ProductsThatBreakOut, NeedNoGuardWhateverSurroundsThem) {
  for (Surroundings const& gas :
       {Surroundings{"air at sea level", 1.4, 1.225, 101325.0}, Surroundings{"air at 10 km", 1.4, 0.4127, 26436.0},
        Surroundings{"air at 20 km", 1.4, 0.088, 5475.0}, Surroundings{"air at 32 km", 1.4, 0.0132, 868.0},
        Surroundings{"helium", 5.0 / 3.0, 0.1693, 101325.0}, Surroundings{"vacuum chamber", 1.4, 1e-4, 10.0}}) {
    for (auto const geometry : {grid::Geometry::planar1d, grid::Geometry::spherical1d, grid::Geometry::planar2d,
                                grid::Geometry::axisymmetric2d}) {
      for (int const cells : {4, 9}) {
        for (bool const strong : {false, true}) {
          Problem problem = burst(strong ? petn : tnt, strong ? petn_pressure : tnt_pressure, geometry, cells, gas, 0);
          double const energy = problem.total(gas::energy);
          double const products = problem.total(gas::partial_density(1));
          // While products break out steps are short, as run/advance.cpp takes them.
          problem.courant = 0.2;
          problem.run_to(14e-6);
          problem.courant = 0.8;
          problem.run_to(30e-6);
          std::string const where = std::string(gas.name) + ", " + word_of(geometry) + ", " + std::to_string(cells) +
                                    (strong ? " PETN" : " TNT");
          EXPECT_EQ(problem.gas->account().guarded_cells, 0) << where;
          EXPECT_EQ(problem.gas->account().guard_energy, 0.0) << where;
          EXPECT_NEAR(problem.total(gas::energy) / energy, 1.0, 1e-12) << where;
          EXPECT_NEAR(problem.total(gas::partial_density(1)) / products, 1.0, 1e-12) << where;
          // Steps that shrink to nothing would be the other way of failing. Products leave with 8 to 12 km/s, and air
          // that they drive has sound half as fast on top.
          EXPECT_LT(problem.gas->fastest_signal(), 6e4) << where;
        }
      }
    }
  }
}

// What is blended on one side of a face between two blocks is blended on the other: while fluxes are limited nothing is
// lost at the faces of small blocks. Steps of full length, so that many are.
TEST(LimitedFluxes, LoseNothingBetweenBlocks) {
  Surroundings const helium{"helium", 5.0 / 3.0, 0.1693, 101325.0};
  for (auto const geometry : {grid::Geometry::planar2d, grid::Geometry::axisymmetric2d, grid::Geometry::cartesian3d}) {
    Problem problem = burst(petn, petn_pressure, geometry, 6, helium, 4);
    double const energy = problem.total(gas::energy);
    double const products = problem.total(gas::partial_density(1));
    problem.run_to(15e-6);
    gas::Account const account = problem.gas->account();
    ASSERT_GT(account.fallback_faces, 0) << "nothing was limited: the test proves nothing";
    EXPECT_NEAR((problem.total(gas::energy) - account.guard_energy) / energy, 1.0, 1e-12);
    EXPECT_NEAR(problem.total(gas::partial_density(1)) / products, 1.0, 1e-12);
  }
}

// Two streams that part at 20 times the speed of sound: between them there is next to nothing, exactly a vacuum.
TEST(PartingStreams, LeaveAVacuumWithoutGuards) {
  for (double const mach : {2.0, 5.0, 20.0, 100.0}) {
    Problem problem;
    problem.box(grid::Geometry::planar1d, 200, 1.0, grid::Boundary::outflow);
    double const speed = mach * std::sqrt(1.4);
    problem.quiescent = state(1.0, 0.0, 1.0);
    problem.fill([&](Vec3 const& x) { return state(1.0, x[0] < 0.5 ? -speed : speed, 1.0); });
    double const energy = problem.total(gas::energy);
    problem.run_to(0.3 / speed);
    EXPECT_EQ(problem.gas->account().guarded_cells, 0) << mach;
    double const out = problem.gas->account().outflow[gas::energy];
    EXPECT_NEAR((problem.total(gas::energy) + out) / energy, 1.0, 1e-12) << mach;
    problem.for_each_cell([&](int, int, Index3 const& cell) { EXPECT_GT(problem.at(cell).pressure, 0.0) << mach; });
  }
}

// A cold stream at Mach 100 past a change of its density: its thermal energy is 4e-4 of the kinetic one.
TEST(ColdStream, KeepsItsPressureWithoutGuards) {
  for (double const ratio : {10.0, 1000.0}) {
    Problem problem;
    problem.box(grid::Geometry::planar2d, 64, 1.0, grid::Boundary::periodic);
    double const speed = 100.0 * std::sqrt(1.4);
    problem.quiescent = state(1.0, 0.0, 1.0);
    problem.fill([&](Vec3 const& x) {
      bool const dense = std::abs(x[0] - 0.5) < 0.2 && std::abs(x[1] - 0.5) < 0.2;
      Mixed s = state(dense ? ratio : 1.0, speed, 1.0);
      s.velocity[1] = 0.37 * speed;
      return s;
    });
    double const energy = problem.total(gas::energy);
    problem.run_to(0.3 / speed);
    EXPECT_EQ(problem.gas->account().guarded_cells, 0) << ratio;
    EXPECT_NEAR(problem.total(gas::energy) / energy, 1.0, 1e-12) << ratio;
  }
}

// Explosive that has just been lit stands as a spike of pressure between two cells of low pressure whose densities
// differ: no contact. Taken for one, its face would show the density of the thin air at its own pressure.
TEST(SpikeOfPressure, IsNoContact) {
  Problem problem;
  problem.box(grid::Geometry::planar1d, 40, 1.0, grid::Boundary::outflow);
  problem.quiescent = state(0.04, 0.0, 2558.0);
  problem.fill([](Vec3 const& x) {
    int const cell = static_cast<int>(x[0] * 40.0);
    return state(cell < 20 ? 1600.0 : cell == 20 ? 32.5 : 0.04, 0.0, cell == 20 ? 1.236e8 : 2558.0);
  });
  // The fastest wave into air at rest follows from the exact solution of the tube on the right: the contact at most at
  // 2 c / (gamma - 1) of the lit cell, 11.5 km/s, and the sound of the air behind its shock, 5.2 km/s.
  double const courant = 0.8;
  problem.gas->advance(courant * problem.domain.h / problem.gas->fastest_signal(), false);
  EXPECT_LT(problem.gas->fastest_signal(), 17e3);
  EXPECT_EQ(problem.gas->account().guarded_cells, 0);
}

// A trace of products that a shock has compressed like the gas around it is colder than its cold curve. Room for it is
// found where the energy of both just suffices, whatever the trace.
TEST(ColdProducts, GetTheRoomThatTheirDensityAsksFor) {
  constexpr double xi0 = 2.5;
  for (double const own : {150.0, 300.0, 700.0, 1500.0}) {
    for (double const alpha : {1e-6, 1e-3, 0.05}) {
      double const rho1 = own * alpha;
      double const cold = xi0 * (1.0 - alpha) * petn.cold_pressure(own) + rho1 * petn.cold_energy(own);
      double const rho_e = 0.01 * cold;
      EXPECT_NEAR(gas::missing_heat(petn, xi0, rho1, alpha, rho_e) / cold, 0.99, 1e-12);
      double const room = gas::room_for_products(petn, xi0, rho1, alpha, rho_e);
      EXPECT_GT(room, alpha);
      EXPECT_LT(room, 1.0);
      EXPECT_NEAR(gas::missing_heat(petn, xi0, rho1, room, rho_e) / rho_e, 0.0, 1e-6) << own << " " << alpha;
    }
  }
  // The cold curve is an isentrope: de/drho = p / rho^2.
  for (double const rho : {100.0, 500.0, 1500.0}) {
    double const d = 1e-4 * rho;
    double const slope = (petn.cold_energy(rho + d) - petn.cold_energy(rho - d)) / (2.0 * d);
    EXPECT_NEAR(slope * rho * rho / petn.cold_pressure(rho), 1.0, 1e-6);
  }
}

}  // namespace
}  // namespace brisance::test
