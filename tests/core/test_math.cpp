/// Elementary functions against the standard library.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/math.hpp"

namespace {

using namespace brisance;

// Stated error plus one rounding of the standard library's result and one of the quotient.
constexpr double rounding = 2.5e-16;

TEST(Math, ExponentialIsTheStandardOne) {
  double worst = 0.0;
  for (double x = -700.0; x <= 700.0; x += 0.00737) {
    worst = std::max(worst, std::abs(exp_bounded(x) / std::exp(x) - 1.0));
  }
  for (double x = -1.0; x <= 1.0; x += 1.1e-5) {
    worst = std::max(worst, std::abs(exp_bounded(x) / std::exp(x) - 1.0));
  }
  EXPECT_LE(worst, 4e-16 + rounding);
  EXPECT_EQ(exp_bounded(0.0), 1.0);
  EXPECT_EQ(exp_bounded(-1e6), exp_bounded(-700.0));
  EXPECT_EQ(exp_bounded(1e6), exp_bounded(700.0));
}

TEST(Math, LogarithmIsTheStandardOne) {
  double worst = 0.0;
  for (double exponent = -307.5; exponent <= 307.5; exponent += 0.00313) {
    double const x = std::pow(10.0, exponent);
    worst = std::max(worst, std::abs(log_positive(x) / std::log(x) - 1.0));
  }
  // Around 1 the result is small, and its relative error must be small all the same.
  for (double d = 1e-15; d < 0.9; d *= 1.003) {
    worst = std::max(worst, std::abs(log_positive(1.0 + d) / std::log(1.0 + d) - 1.0));
    worst = std::max(worst, std::abs(log_positive(1.0 - d) / std::log(1.0 - d) - 1.0));
  }
  EXPECT_LE(worst, 2.3e-16 + rounding);
  EXPECT_EQ(log_positive(1.0), 0.0);
  EXPECT_EQ(log_positive(0.0), log_positive(0x1p-1022));
  EXPECT_EQ(log_positive(-3.0), log_positive(0x1p-1022));
}

TEST(Math, PowerIsTheStandardOne) {
  for (double y : {0.01, 0.26, 0.5, 1.0, 1.03, 4.0}) {
    double worst = 0.0;
    for (double exponent = -60.0; exponent <= 60.0; exponent += 0.0137) {
      double const x = std::pow(10.0, exponent);
      double const stated = 3e-16 * (1.0 + std::abs(y * std::log(x))) + rounding;
      worst = std::max(worst, std::abs(pow_nonnegative(x, y) / std::pow(x, y) - 1.0) / stated);
    }
    EXPECT_LE(worst, 1.0) << y;
    EXPECT_EQ(pow_nonnegative(0.0, y), 0.0);
    EXPECT_EQ(pow_nonnegative(1.0, y), 1.0);
  }
}

}  // namespace
