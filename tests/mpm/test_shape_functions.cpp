// The shape functions themselves: partition of unity, linear fields, and gradients that are derivatives.
#include "mpm/harness.hpp"
#include "mpm/shapes/bspline.hpp"
#include "mpm/shapes/gimp.hpp"
#include "mpm/shapes/linear.hpp"

namespace brisance::test {
namespace {

constexpr int cells = 7;

template <class S>
struct At {
  int first = 0;
  double w[S::support];
  double g[S::support];
  At(double u, double half) { S::weights(u, half, cells, first, w, g); }
  /// Weight of node i.
  [[nodiscard]] double of(int i) const { return i >= first && i < first + S::support ? w[i - first] : 0.0; }
};

template <class S>
class ShapeFunctions : public testing::Test {};

using All = testing::Types<mpm::Linear, mpm::Gimp, mpm::BSpline>;
TYPED_TEST_SUITE(ShapeFunctions, All);

TYPED_TEST(ShapeFunctions, SumToOneAndReproduceLinearFields) {
  double worst = 0.0;
  for (double const half : {0.05, 0.125, 0.25, 0.5}) {
    for (int n = 0; n <= 700; ++n) {
      double const u = n * 0.01;
      At<TypeParam> const at(u, half);
      double one = -1.0;
      double zero = 0.0;
      double place = -u;
      double slope = -1.0;
      for (int s = 0; s < TypeParam::support; ++s) {
        EXPECT_GE(at.w[s], -1e-16);
        one += at.w[s];
        zero += at.g[s];
        place += at.w[s] * (at.first + s);
        slope += at.g[s] * (at.first + s);
      }
      for (double const error : {one, zero, place, slope}) worst = std::max(worst, std::abs(error));
      EXPECT_GE(at.first, -TypeParam::reach);
      EXPECT_LE(at.first + TypeParam::support - 1, cells + TypeParam::reach);
    }
  }
  std::printf("%s: sums wrong by at most %.1e\n", TypeParam::name, worst);
  // Round-off of numbers up to 7.
  EXPECT_LT(worst, 5e-15);
}

TYPED_TEST(ShapeFunctions, GradientIsTheDerivative) {
  double const step = 1e-6;
  double worst = 0.0;
  for (double const half : {0.125, 0.25, 0.5}) {
    for (int n = 1; n < 137; ++n) {
      double const u = n * 0.0512345;  // never on a kink
      At<TypeParam> const at(u, half);
      At<TypeParam> const low(u - step, half);
      At<TypeParam> const high(u + step, half);
      for (int s = 0; s < TypeParam::support; ++s) {
        double const derivative = (high.of(at.first + s) - low.of(at.first + s)) / (2.0 * step);
        worst = std::max(worst, std::abs(derivative - at.g[s]));
      }
    }
  }
  std::printf("%s: gradient off the difference quotient by at most %.1e\n", TypeParam::name, worst);
  EXPECT_LT(worst, 1e-9);  // round-off of the quotient, 1e-16/1e-6; all pieces are at most quadratic
}

// GIMP and B-splines are smooth where tents have a kink: the gradient does not jump when a particle crosses a cell.
TYPED_TEST(ShapeFunctions, GradientJumpsOnlyForTents) {
  double worst = 0.0;
  for (int i = 1; i < 2 * cells; ++i) {
    At<TypeParam> const low(0.5 * i - 1e-9, 0.25);
    At<TypeParam> const high(0.5 * i + 1e-9, 0.25);
    for (int node = 0; node <= cells; ++node) {
      auto const g = [&](At<TypeParam> const& at) {
        int const s = node - at.first;
        return s >= 0 && s < TypeParam::support ? at.g[s] : 0.0;
      };
      worst = std::max(worst, std::abs(g(high) - g(low)));
    }
  }
  std::printf("%s: largest jump of the gradient %.1e\n", TypeParam::name, worst);
  if (TypeParam::support == 2) {
    EXPECT_NEAR(worst, 2.0, 1e-12);
  } else {
    EXPECT_LT(worst, 1e-8);  // slope of the gradient, at most 1/(2 * 0.25), times the distance
  }
}

// A particle of any length averages the tent over itself.
TEST(GimpFunction, IsTheAverageOfTheTent) {
  for (double const half : {0.01, 0.2, 0.35, 0.5}) {
    for (int n = 0; n < 100; ++n) {
      double const u = 2.0 + 0.01 * n;
      At<mpm::Gimp> const at(u, half);
      for (int node = 1; node <= 4; ++node) {
        // Midpoint rule, exact on straight pieces, with error below (1/2000)^2 where the kink falls inside one.
        double sum = 0.0;
        for (int i = 0; i < 1000; ++i) {
          double const x = u + half * ((i + 0.5) / 500.0 - 1.0);
          sum += std::max(0.0, 1.0 - std::abs(x - node)) / 1000.0;
        }
        EXPECT_NEAR(at.of(node), sum, 1e-6) << u << " " << half << " " << node;
      }
    }
  }
}

}  // namespace
}  // namespace brisance::test
