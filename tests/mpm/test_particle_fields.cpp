// The table of what particles carry: which components turn in a mirror.
#include <gtest/gtest.h>

#include <cmath>

#include "mpm/particles.hpp"

namespace brisance::mpm {
namespace {

/// Sign of component i under the reflection across a plane normal to d.
double reflected(int i, int d) { return i == d ? -1.0 : 1.0; }

double sign_of(Mirror mirror, int c, int d) { return turns(mirror, c, d) ? -1.0 : 1.0; }

// With R the reflection, v' = R v, s' = R s R and G' = R G R; of v = b x_i x_j the image is v'(x) = R v(R x).
TEST(Quantities, TurnAsReflectionsDo) {
  constexpr std::array<std::array<int, 2>, 6> shears{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}}};
  constexpr std::array<std::array<int, 2>, 3> pairs{{{0, 1}, {1, 2}, {2, 0}}};
  for (int d = 0; d < 3; ++d) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(sign_of(Mirror::vector, c, d), reflected(c, d));
      for (int j = 0; j < 3; ++j) {
        EXPECT_EQ(sign_of(Mirror::gradient, 3 * c + j, d), reflected(c, d) * reflected(j, d));
        auto const [a, b] = pairs[c];
        EXPECT_EQ(sign_of(Mirror::cross, 3 * c + j, d), reflected(j, d) * reflected(a, d) * reflected(b, d));
      }
    }
    for (int c = 0; c < 6; ++c) {
      auto const [i, j] = shears[c];
      EXPECT_EQ(sign_of(Mirror::tensor, c, d), reflected(i, d) * reflected(j, d)) << c << " across " << d;
    }
  }
}

TEST(Quantities, KnowWhatTheirComponentsAre) {
  EXPECT_EQ(quantity_of(Field::deviator_xx).components, 6);
  EXPECT_STREQ(quantity_of(Field::deviator_xx).unit, "Pa");
  EXPECT_EQ(quantity_of(Field::bar_x).mirror, Mirror::vector);
  EXPECT_THROW((void)quantity_of(Field::deviator_yy), std::invalid_argument);
  for (Quantity const& q : quantities) {
    int const needed = q.mirror == Mirror::vector ? 3 : q.mirror == Mirror::tensor ? 6 : 9;
    if (q.mirror != Mirror::none) {
      EXPECT_EQ(q.components, needed) << q.name;
    }
  }
}

}  // namespace
}  // namespace brisance::mpm
