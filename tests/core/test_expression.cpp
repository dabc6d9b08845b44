// Expressions of x, y, z: their values, and what is none.
#include <gtest/gtest.h>

#include <cmath>
#include <locale>
#include <numbers>

#include "core/error.hpp"
#include "core/expression.hpp"

namespace brisance {
namespace {

TEST(Expressions, HaveTheValuesOfTheirFormulas) {
  Vec3 const x{0.3, -0.7, 2.5};
  auto const value = [&](char const* text) { return Expression(text)(x); };
  EXPECT_EQ(value("-100*x"), -100.0 * x[0]);
  EXPECT_EQ(value("50*y/0.1"), 50.0 * x[1] / 0.1);
  EXPECT_EQ(value("0"), 0.0);
  EXPECT_EQ(value("x < 0.5 ? z : y"), x[2]);
  EXPECT_EQ(value("x == 0.3"), 1.0);
  EXPECT_NEAR(value("sin(pi*x) + x^2 - atan2(y, z)"),
              std::sin(std::numbers::pi * x[0]) + x[0] * x[0] - std::atan2(x[1], x[2]), 1e-15);
}

struct DecimalComma : std::numpunct<char> {
  [[nodiscard]] char do_decimal_point() const override { return ','; }
};

TEST(Expressions, DoNotFollowTheLocale) {
  std::locale const before = std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  double const value = Expression("0.25*x")({2.0, 0.0, 0.0});
  std::locale::global(before);
  EXPECT_EQ(value, 0.5);
}

TEST(Expressions, ThatAreNoneAreRefused) {
  for (char const* text : {"", "x +", "3*q", "10 m", "x = 3", "(x", "x, y", "sin()", "\"x\""}) {
    EXPECT_THROW(Expression{text}, InputError) << text;
  }
  EXPECT_THROW(Expression(std::string(2000, '1')), InputError);
  // Deeper than any formula, and neither a crash nor slow.
  EXPECT_NO_THROW(Expression(std::string(490, '(') + "x" + std::string(490, ')')));
}

}  // namespace
}  // namespace brisance
