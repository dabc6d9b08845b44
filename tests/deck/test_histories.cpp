// Histories of pressures and motions in CSV files: what is read, and what is refused with file, line and remedy.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "deck/deck.hpp"

namespace brisance {
namespace {

class HistoryFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              fmt::format("brisance-history-{}", testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// A plate whose foot moves by a history, and on which a pressure acts.
  [[nodiscard]] deck::Result read(std::string const& csv, std::string const& motion,
                                  std::string const& pressure) const {
    std::ofstream(folder_ / "record.csv") << csv;
    return deck::read_text(fmt::format(R"(
[domain]
geometry = "planar2d"
size = [1, 1]
cell = "20 mm"
[[body]]
material = "RHA"
shape = "box"
lower = [0.1, 0.1]
upper = [0.9, 0.3]
[[constraint]]
kind = "displacement"
components = ["y"]
within = {{shape = "box", lower = [0, 0], upper = [1, 0.1]}}
history = {}
[[surface_pressure]]
normal = "+y"
history = {}
[end]
time = "1 ms"
)",
                                       motion, pressure),
                           (folder_ / "deck.toml").string());
  }
  [[nodiscard]] std::string problem(std::string const& csv) const {
    auto const result = read(csv, R"({times = [0, 1], displacements = [0, 0.01]})", R"({file = "record.csv"})");
    return result.errors.empty() ? "" : deck::format(result.errors.front());
  }

  std::filesystem::path folder_;
};

TEST_F(HistoryFile, IsReadWithItsUnits) {
  auto const result = read("# a shaker\ntime; value\n0;0\n 0.5 ; 2.5\r\n\n+1e0;-1\n",
                           R"({file = "record.csv", units = ["ms", "mm"], after = "release"})",
                           R"({file = "record.csv", units = ["s", "kPa"]})");
  ASSERT_TRUE(result.case_) << deck::format(result.errors.front());
  auto const& history = result.case_->particles.constraints.at(0).history;
  ASSERT_TRUE(history);
  EXPECT_TRUE(history->displacement);
  EXPECT_TRUE(history->release);
  ASSERT_EQ(history->times.size(), 3U);
  EXPECT_DOUBLE_EQ(history->times[1], 0.5e-3);
  EXPECT_DOUBLE_EQ(history->values[1], 2.5e-3);
  EXPECT_EQ(result.case_->particles.constraints[0].velocity, (Vec3{0.0, 1.0, 0.0}));
  auto const& load = result.case_->particles.pressures.at(0);
  EXPECT_EQ(load.times, (std::vector{0.0, 0.5, 1.0}));
  EXPECT_EQ(load.pressures, (std::vector{0.0, 2500.0, -1000.0}));
}

TEST_F(HistoryFile, InTheDeckMeansTheSame) {
  auto const file = read("0 0\n0.001 0.02\n", R"({file = "record.csv"})", R"({file = "record.csv"})");
  auto const deck = read("", R"({times = [0, "1 ms"], displacements = [0, "20 mm"]})",
                         R"({times = [0, "1 ms"], pressures = [0, 0.02]})");
  ASSERT_TRUE(file.case_ && deck.case_);
  EXPECT_EQ(file.case_->particles.constraints[0].history->values, deck.case_->particles.constraints[0].history->values);
  EXPECT_EQ(file.case_->particles.pressures[0].pressures, deck.case_->particles.pressures[0].pressures);
}

TEST_F(HistoryFile, IsRefusedWithLineAndRemedy) {
  auto const says = [&](std::string const& csv, std::string const& words) {
    std::string const text = problem(csv);
    EXPECT_NE(text.find(words), std::string::npos) << csv << ": " << text;
    EXPECT_NE(text.find("surface_pressure[1].history.file"), std::string::npos) << text;
  };
  says("0,1\n", "1 rows of numbers; expected at least two");
  says("time,p\nmore,titles\n0,1\n", "line 2 of");
  says("0,1\n1,x\n", "line 2 of");
  says("0,1\n1\n", "expected two numbers, a time and a value, separated by a comma");
  says("0,1\n0,2\n", "the times must increase");
  says("-1,1\n1,2\n", "allowed: 0 to");
  says("0,1\n1,1e300\n", "allowed: -1e+13 to 1e+13 Pa");
  says("0,1\n1,nan\n", "line 2 of");
  says("0,1\n1,1e999\n", "line 2 of");
}

}  // namespace
}  // namespace brisance
