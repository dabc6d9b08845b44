// Checkpoint files: complete or refused, the newest good one is found, and no moment is without one.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "core/error.hpp"
#include "output/checkpoint.hpp"
#include "output/file.hpp"
#include "output/manifest.hpp"
#include "scratch.hpp"

namespace brisance::output::test {
namespace {

namespace fs = std::filesystem;

/// A state of a few kilobytes.
struct State {
  std::vector<double> values = std::vector<double>(500);
  void archive(Archive& a) {
    a.section("state");
    a(values);
  }
};

ArchiveState of(State& state) {
  return [&state](Archive& a) { a(state); };
}

CheckpointInfo at_step(long step) { return {"", "the deck\n", step, 1e-6 * static_cast<double>(step)}; }

std::vector<std::string> names_in(fs::path const& folder) {
  std::vector<std::string> names;
  for (auto const& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::ranges::sort(names);
  return names;
}

std::string problem_of(fs::path const& path) {
  try {
    CheckpointReader reader(path);
  } catch (IoError const& error) {
    return error.what();
  }
  return "";
}

TEST(Checkpoint, GivesBackStateAndWhatItTells) {
  ScratchFolder const scratch;
  State state;
  for (std::size_t n = 0; n < state.values.size(); ++n) state.values[n] = 1.0 / static_cast<double>(n + 1);
  CheckpointFiles files(scratch.path(), 2);
  files.write(at_step(7), of(state));
  auto found = newest_checkpoint(scratch.path());
  ASSERT_NE(found.reader, nullptr);
  EXPECT_TRUE(found.problems.empty());
  EXPECT_EQ(found.reader->info().step, 7);
  EXPECT_EQ(found.reader->info().time, 7e-6);
  EXPECT_EQ(found.reader->info().deck, "the deck\n");
  EXPECT_EQ(found.reader->info().program, program_build());
  State read;
  found.reader->archive()(read);
  found.reader->archive().end();
  EXPECT_EQ(read.values, state.values);
  // The state alone: the rest of the file are header and info.
  EXPECT_LT(state_bytes(of(state)), static_cast<double>(fs::file_size(found.reader->path())));
  EXPECT_GT(state_bytes(of(state)), 500.0 * sizeof(double));
}

TEST(Checkpoint, TheNewestOnesStay) {
  ScratchFolder const scratch;
  State state;
  CheckpointFiles files(scratch.path(), 2);
  for (long const step : {5L, 90L, 100L, 123456789L}) files.write(at_step(step), of(state));
  EXPECT_EQ(names_in(scratch.path() / "checkpoints"),
            (std::vector<std::string>{"checkpoint_00000100.brz", "checkpoint_123456789.brz"}));
  files.write_stopped(at_step(200000000), of(state));
  EXPECT_EQ(newest_checkpoint(scratch.path()).reader->info().step, 123456789) << "a failed state is no checkpoint";
  EXPECT_EQ(problem_of(scratch.path() / "checkpoints/stopped.brz"), "");
}

TEST(Checkpoint, EveryTruncationIsRefused) {
  ScratchFolder const scratch;
  State state;
  CheckpointFiles files(scratch.path(), 2);
  files.write(at_step(1), of(state));
  fs::path const path = scratch.path() / "checkpoints/checkpoint_00000001.brz";
  std::string const good = read_file(path);
  std::vector<std::size_t> sizes{0, 1, 35, 36, 37, good.size() - 1};
  for (std::size_t n = 1; n < 16; ++n) sizes.push_back(n * good.size() / 16);
  for (std::size_t const size : sizes) {
    write_file(path, good.substr(0, size));
    std::string const problem = problem_of(path);
    EXPECT_NE(problem.find("checkpoint_00000001.brz\" cannot be used: it is truncated: it has " + std::to_string(size) +
                           " bytes"),
              std::string::npos)
        << size << ": " << problem;
  }
  write_file(path, good + "x");
  EXPECT_NE(problem_of(path).find("it is too long"), std::string::npos);
  write_file(path, good);
  EXPECT_EQ(problem_of(path), "");
}

TEST(Checkpoint, EveryFlippedBitIsNoticed) {
  ScratchFolder const scratch;
  State state;
  CheckpointFiles files(scratch.path(), 2);
  files.write(at_step(1), of(state));
  fs::path const path = scratch.path() / "checkpoints/checkpoint_00000001.brz";
  std::string const good = read_file(path);
  std::size_t const bits = good.size() * 8;
  std::vector<std::size_t> flipped;
  for (std::size_t bit = 0; bit < 36UL * 8; ++bit) flipped.push_back(bit);  // the whole header
  std::mt19937_64 draw(1);
  for (int n = 0; n < 1000; ++n) flipped.push_back(draw() % bits);
  for (std::size_t const bit : flipped) {
    std::string bad = good;
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
    write_file(path, bad);
    EXPECT_NE(problem_of(path).find("damaged"), std::string::npos) << "bit " << bit << ": " << problem_of(path);
  }
}

TEST(Checkpoint, OfAnotherFormatIsRefusedAsSuch) {
  ScratchFolder const scratch;
  State state;
  CheckpointFiles files(scratch.path(), 2);
  files.write(at_step(1), of(state));
  fs::path const path = scratch.path() / "checkpoints/checkpoint_00000001.brz";
  std::string content = read_file(path);
  content[16] = 99;
  std::uint32_t const sum = checksum(content.data(), 32);
  std::copy_n(reinterpret_cast<char const*>(&sum), sizeof sum, content.begin() + 32);
  write_file(path, content);
  EXPECT_NE(problem_of(path).find("it has format 99"), std::string::npos) << problem_of(path);
}

TEST(Checkpoint, ThePreviousOneStandsInForADamagedOne) {
  ScratchFolder const scratch;
  State state;
  CheckpointFiles files(scratch.path(), 3);
  for (long const step : {10L, 20L, 30L}) files.write(at_step(step), of(state));
  fs::path const folder = scratch.path() / "checkpoints";
  write_file(folder / "checkpoint_00000030.brz", "");
  write_file(folder / "checkpoint_00000020.brz", read_file(folder / "checkpoint_00000020.brz") + "!");
  auto found = newest_checkpoint(scratch.path());
  ASSERT_NE(found.reader, nullptr);
  EXPECT_EQ(found.reader->info().step, 10);
  ASSERT_EQ(found.refused.size(), 2U);
  EXPECT_NE(found.problems[0].find("checkpoint_00000030.brz"), std::string::npos);
  EXPECT_NE(found.problems[1].find("too long"), std::string::npos);
  for (auto const& refused : found.refused) put_aside(refused);
  EXPECT_TRUE(newest_checkpoint(scratch.path()).problems.empty());
  // The next one would lie before those that were refused, and must not push the good one out.
  files.write(at_step(15), of(state));
  EXPECT_EQ(newest_checkpoint(scratch.path()).reader->info().step, 15);
  EXPECT_TRUE(fs::exists(folder / "checkpoint_00000010.brz"));
}

TEST(Checkpoint, NoneIsFoundWhereThereIsNone) {
  ScratchFolder const scratch;
  EXPECT_EQ(newest_checkpoint(scratch.path()).reader, nullptr);
  fs::create_directories(scratch.path() / "checkpoints");
  for (char const* name : {"checkpoint.part", "stopped.brz", "checkpoint_.brz", "checkpoint_1x.brz", "notes.txt"}) {
    write_file(scratch.path() / "checkpoints" / name, "something");
  }
  auto const found = newest_checkpoint(scratch.path());
  EXPECT_EQ(found.reader, nullptr);
  EXPECT_TRUE(found.problems.empty());
}

// What is there when the program is killed at any point of a write: the earlier ones, whole.
TEST(Checkpoint, APipeIsNoFile) {
  ScratchFolder const folder;
  fs::path const path = folder.path() / "checkpoint_00000001.brz";
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_NE(problem_of(path).find("it is not a regular file"), std::string::npos) << problem_of(path);
}

TEST(Checkpoint, WhileOneIsWrittenTheOthersStand) {
  ScratchFolder const scratch;
  State state;
  CheckpointFiles files(scratch.path(), 1);
  files.write(at_step(1), of(state));
  int looked = 0;
  files.write(at_step(2), [&](Archive& a) {
    a(state);
    EXPECT_EQ(newest_checkpoint(scratch.path()).reader->info().step, 1);
    ++looked;
  });
  EXPECT_EQ(looked, 1);
  EXPECT_EQ(newest_checkpoint(scratch.path()).reader->info().step, 2);
}

TEST(Checkpoint, AWriteThatFailsLeavesTheEarlierOnes) {
  ScratchFolder const scratch;
  State state;
  CheckpointFiles files(scratch.path(), 1);
  files.write(at_step(1), of(state));
  EXPECT_THROW(files.write(at_step(2), [](Archive& /*a*/) { throw IoError("no space"); }), IoError);
  EXPECT_EQ(names_in(scratch.path() / "checkpoints"), (std::vector<std::string>{"checkpoint_00000001.brz"}));
  // The device that is always full says so when the last byte goes out.
  fs::create_symlink("/dev/full", scratch.path() / "checkpoints/checkpoint.part");
  EXPECT_THROW(files.write(at_step(2), of(state)), IoError);
  EXPECT_EQ(newest_checkpoint(scratch.path()).reader->info().step, 1);
}

// A checkpoint of somebody else beside those of the run stays, and the list of what the run wrote stays short.
TEST(Checkpoint, OnlyThoseOfTheRunMakeRoom) {
  ScratchFolder const scratch;
  State state;
  fs::create_directory(scratch.path() / "checkpoints");
  fs::path const mine = scratch.path() / "checkpoints/checkpoint_00000000.brz";
  write_file(mine, "mine");
  list_files(scratch.path(), {"summary.csv"});
  CheckpointFiles files(scratch.path(), 1);
  for (long step = 1; step <= 150; ++step) files.write(at_step(step), of(state));
  EXPECT_EQ(read_file(mine), "mine");
  EXPECT_EQ(std::ranges::distance(fs::directory_iterator(mine.parent_path())), 2);
  std::string const list = read_file(scratch.path() / "files.txt");
  EXPECT_LT(std::ranges::count(list, '\n'), 150);
  EXPECT_TRUE(listed_files(scratch.path()).contains("summary.csv")) << "what is yet to come has been taken off";
}

}  // namespace
}  // namespace brisance::output::test
