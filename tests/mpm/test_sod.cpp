// Sod's tube [Sod78] of material points against the exact solution.
#include "exact/exact_riemann.hpp"
#include "mpm/explosives.hpp"

namespace brisance::test {
namespace {

struct Errors {
  double rho = 0.0;
  double u = 0.0;
  double p = 0.0;
};

/// Two gases at rest, the left one of eight times the density and ten times the pressure.
struct Sod : Problem {
  static constexpr double end = 0.143;
  static constexpr double gamma = 1.4;

  /// With the same number of particles per cell on both sides, `ppc`.
  Sod(int cells, ShapeFunction shape, std::function<void(mpm::Options&)> const& change = nullptr, int ppc = 2) {
    box(grid::Geometry::planar1d, 1.0 / cells, {cells, 1, 1}, grid::Boundary::wall);
    options = mpm::Options{};
    options.shape = shape;
    if (change) change(options);
    add(gas(1.0, 1.0), ppc);
    add(gas(0.125, 0.1), ppc);
    start();
    fill(0, shape::Box{{0.0, -1.0, -1.0}, {0.5, 1.0, 1.0}});
    fill(1, shape::Box{{0.5, -1.0, -1.0}, {1.0, 1.0, 1.0}});
    start_energy = energy();
    while (mpm->time() < end - 1e-12) mpm->advance(std::min(mpm->stable_step(), end - mpm->time()));
  }
  double start_energy = 0.0;

  static material::Material gas(double rho, double p) {
    material::Fluid fluid;
    fluid.name = "gas";
    fluid.eos = material::IdealGas{gamma};
    fluid.density = rho;
    fluid.pressure = p;
    return material::of(fluid);
  }

  /// Mean deviation from the exact solution over the length of the tube, every particle counting with its volume.
  Errors errors() {
    material::Eos const eos = material::IdealGas{gamma};
    exact::Riemann const riemann(eos, {1.0, 0.0, 1.0}, eos, {0.125, 0.0, 0.1});
    Errors e;
    for (int body = 0; body < 2; ++body) {
      for_each_particle(body, [&](mpm::ParticleSet const& set, int q) {
        auto const s = riemann.at((set.field(Field::position_x)[q] - 0.5) / end).s;
        double const v = volume(set, q);
        e.rho += v * std::abs(set.field(Field::density)[q] - s.rho);
        e.u += v * std::abs(set.field(Field::velocity_x)[q] - s.u);
        e.p += v * std::abs(set.field(Field::pressure)[q] - s.p);
      });
    }
    return e;
  }
};

/// Halving the cells must divide the error by the factor: for discontinuities spread over a fixed number of cells it
/// would be 2; the measured ones are 1.33 (splines, p) to 1.9.
void converges(ShapeFunction shape, double factor, Errors const& bound) {
  Errors last{1.0, 1.0, 1.0};
  for (int cells : {125, 250, 500, 1000}) {
    Sod tube(cells, shape);
    Errors const e = tube.errors();
    EXPECT_LT(e.rho * factor, last.rho) << cells;
    EXPECT_LT(e.u * factor, last.u) << cells;
    EXPECT_LT(e.p * factor, last.p) << cells;
    // Walls at rest keep the energy; measured 0.0007.
    EXPECT_NEAR(tube.energy() / tube.start_energy, 1.0, 1e-3) << cells;
    last = e;
  }
  EXPECT_LT(last.rho, bound.rho);
  EXPECT_LT(last.u, bound.u);
  EXPECT_LT(last.p, bound.p);
}

// The bounds are the measured errors and a tenth.
TEST(SodOfParticles, ConvergesWithSplines) { converges(ShapeFunction::bspline, 1.25, {0.0028, 0.0068, 0.0034}); }

TEST(SodOfParticles, ConvergesWithParticlesThatStretch) {
  converges(ShapeFunction::cpgimp, 1.25, {0.0026, 0.0043, 0.0035});
}

TEST(SodOfParticles, TentsNeedMoreParticlesPerCell) {
  // The rarefaction draws two particles per cell further apart than a cell is long: cells between them are empty.
  Sod two(250, ShapeFunction::linear);
  Sod four(250, ShapeFunction::linear, nullptr, 4);
  EXPECT_LT(four.errors().p, 0.5 * two.errors().p);
  EXPECT_LT(four.errors().p, 0.021);
}

TEST(SodOfParticles, ViscosityDampsTheRinging) {
  // Without viscosity the particles ring behind the shock: measured 2.5 times the error.
  Sod usual(500, ShapeFunction::bspline);
  Sod without(500, ShapeFunction::bspline, [](mpm::Options& o) { o.linear_viscosity = o.quadratic_viscosity = 0.0; });
  EXPECT_LT(1.5 * usual.errors().p, without.errors().p);
}

}  // namespace
}  // namespace brisance::test
