/// Sums and largest values over numbered pieces of work.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "core/error.hpp"
#include "core/reduce.hpp"

namespace brisance {
namespace {

/// Terms of very different sizes and both signs: nearly every order of adding them has another sum. Not inline: a
/// product must not be joined with the addition that follows, which spares a rounding.
[[gnu::noinline]] double term(int n) { return std::sin(1.0 + n) * std::pow(10.0, n % 7); }

class Threads : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { set_threads(GetParam()); }
  void TearDown() override { set_threads(0); }
};

TEST_P(Threads, SumsHaveTheBitsOfAPlainLoop) {
  constexpr int count = 1000;
  double plain = 0.0;
  double backwards = 0.0;
  for (int n = 0; n < count; ++n) plain += term(n);
  for (int n = count - 1; n >= 0; --n) backwards += term(n);
  ASSERT_NE(plain, backwards);  // else the order would not show
  EXPECT_EQ(sum_over(count, term), plain);
  EXPECT_EQ(sum_at_hand(count, term), plain);
}

TEST_P(Threads, PartsAreJoinedInOrder) {
  std::string const joined = reduce(
      12, std::string{">"}, [](int n) { return std::to_string(n); },
      [](std::string& all, std::string const& part) { all += part; });
  EXPECT_EQ(joined, ">01234567891011");
}

TEST_P(Threads, TheLargestPassesOverWhatIsNoNumber) {
  auto const part = [](int n) { return n == 3 ? std::numeric_limits<double>::quiet_NaN() : n == 5 ? 2.0 : -1.0 * n; };
  EXPECT_EQ(largest_over(9, 0.5, part), 2.0);
  EXPECT_EQ(largest_at_hand(9, 0.5, part), 2.0);
  EXPECT_EQ(largest_over(9, 7.0, part), 7.0);
}

TEST_P(Threads, NothingAddsUpToNothing) {
  EXPECT_EQ(sum_over(0, term), 0.0);
  EXPECT_EQ(largest_over(0, 1.5, term), 1.5);
}

TEST_P(Threads, ErrorsOfAPartComeOut) {
  EXPECT_THROW(static_cast<void>(sum_over(8,
                                          [](int n) {
                                            if (n == 5) throw NumericalError("part 5");
                                            return 1.0;
                                          })),
               NumericalError);
}

INSTANTIATE_TEST_SUITE_P(Counts, Threads, testing::Values(1, 2, 5));

}  // namespace
}  // namespace brisance
