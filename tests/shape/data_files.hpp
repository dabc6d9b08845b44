/// Files for the tests of readers, in a folder that goes with the test.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.hpp"

namespace brisance::shape::test {

class DataFiles : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "brisance-data-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(std::string const& name, std::string const& text) {
    auto const file = folder_ / name;
    std::ofstream(file, std::ios::binary | std::ios::trunc) << text;
    return file;
  }

  /// The message with which `read` refuses a file, which it must name; empty where it does not.
  template <class Read>
  std::string refusal(std::string const& name, std::string const& text, Read read) {
    auto const file = write(name, text);
    try {
      read(file);
    } catch (InputError const& error) {
      std::string const message = error.what();
      EXPECT_NE(message.find(file.string()), std::string::npos) << message;
      return message;
    }
    return "";
  }

  std::filesystem::path folder_;
};

/// What a file must be refused for: its text, and a part of the message.
struct Bad {
  std::string text;
  char const* told;
};

}  // namespace brisance::shape::test
