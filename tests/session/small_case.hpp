/// Small cases for tests of the program's parts.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "deck/deck.hpp"

namespace brisance::session {

/// 1 kg of TNT in 1 m of air, 200 cells; `more` goes to the deck's end.
inline run::Case small_case(std::string const& more) {
  auto const result = deck::read_text(
      "[domain]\ngeometry = \"spherical1d\"\nsize = 1\ncell = \"5 mm\"\n[[charge]]\nmass = \"1 kg\"\n"
      "[[gauge]]\nname = \"g\"\npoint = 0.8\n" +
          more,
      "small.toml");
  for (auto const& error : result.errors) ADD_FAILURE() << deck::format(error);
  return result.case_.value();
}

/// An empty folder of the running test, removed with it.
class Scratch {
 public:
  Scratch()
      : path_(std::filesystem::path(testing::TempDir()) /
              ("brisance-app-" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()))) {
    std::filesystem::remove_all(path_);
  }
  ~Scratch() { std::filesystem::remove_all(path_); }
  Scratch(Scratch const&) = delete;
  Scratch& operator=(Scratch const&) = delete;
  [[nodiscard]] std::filesystem::path const& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace brisance::session
