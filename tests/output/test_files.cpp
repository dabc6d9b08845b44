#include "core/error.hpp"
#include "output/file.hpp"
#include "output/folder.hpp"
#include "scratch.hpp"

namespace brisance::output::test {
namespace {

namespace fs = std::filesystem;

/// Message of the IoError that the action throws; empty when it throws none.
template <class Action>
std::string io_error(Action action) {
  try {
    action();
  } catch (IoError const& error) {
    return error.what();
  }
  return "";
}

TEST(Files, ReplacedFileHoldsTheNewContentOnly) {
  ScratchFolder folder;
  auto const path = folder.path() / "a.txt";
  replace_file(path, "a long first content");
  replace_file(path, "short");
  EXPECT_EQ(read_file(path), "short");
  EXPECT_FALSE(fs::exists(folder.path() / "a.txt.part"));
}

TEST(Files, AppendedTextIsInTheFileAtOnce) {
  ScratchFolder folder;
  auto const path = folder.path() / "a.txt";
  write_file(path, "one\n");
  EXPECT_EQ(read_file(path), "one\n");
  append_to_file(path, "two\n");
  EXPECT_EQ(read_file(path), "one\ntwo\n");
}

TEST(Files, FullDeviceIsAnErrorNamingFileAndReason) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  EXPECT_EQ(io_error([] { append_to_file("/dev/full", "x"); }), "cannot write \"/dev/full\": No space left on device");
}

TEST(Files, MissingFileIsAnError) {
  EXPECT_EQ(io_error([] { (void)read_file("/nowhere/x"); }), "cannot open \"/nowhere/x\": No such file or directory");
}

TEST(Folder, IsCreatedWithItsParents) {
  ScratchFolder scratch;
  prepare_folder(scratch.path() / "a/b", Earlier::refuse, 0.0);
  EXPECT_TRUE(fs::is_directory(scratch.path() / "a/b"));
  EXPECT_TRUE(fs::is_empty(scratch.path() / "a/b"));
}

TEST(Folder, WithResultsIsRefusedUntilForced) {
  ScratchFolder scratch;
  auto const& folder = scratch.path();
  fs::create_directories(folder / "fields");
  fs::create_directories(folder / "gauges");
  fs::create_directories(folder / "checkpoints");
  std::vector<std::string> const results{"run.json",
                                         "fields.xmf2",
                                         "fields/fields_000000.h5",
                                         "gauges/g.csv",
                                         "checkpoints/checkpoint_00000010.brz",
                                         "checkpoints/checkpoint_00000020.brz.refused",
                                         "checkpoints/checkpoint.part",
                                         "checkpoints/stopped.brz"};
  for (auto const& name : results) replace_file(folder / name, "x");
  replace_file(folder / "notes.txt", "x");

  EXPECT_EQ(
      io_error([&] { prepare_folder(folder, Earlier::refuse, 0.0); }),
      "the output folder \"" + folder.string() +
          "\" already holds the results of a run (run.json): go on with that run with --resume, name another folder "
          "with --output, or replace them with --force");
  EXPECT_TRUE(fs::exists(folder / "gauges/g.csv"));

  EXPECT_NO_THROW(prepare_folder(folder, Earlier::keep, 0.0));
  for (auto const& name : results) EXPECT_TRUE(fs::exists(folder / name)) << name;

  prepare_folder(folder, Earlier::replace, 0.0);
  for (auto const& name : results) EXPECT_FALSE(fs::exists(folder / name)) << name;
  EXPECT_TRUE(fs::exists(folder / "notes.txt")) << "a file that is no result was removed";
}

TEST(Folder, WithOtherFilesIsAccepted) {
  ScratchFolder scratch;
  replace_file(scratch.path() / "notes.txt", "x");
  EXPECT_NO_THROW(prepare_folder(scratch.path(), Earlier::refuse, 0.0));
}

TEST(Folder, ThatIsAFileIsRefused) {
  ScratchFolder scratch;
  auto const path = scratch.path() / "file";
  replace_file(path, "x");
  EXPECT_EQ(io_error([&] { prepare_folder(path, Earlier::refuse, 0.0); }),
            "cannot use as output folder \"" + path.string() + "\": Not a directory");
  EXPECT_NE(io_error([&] { prepare_folder(path / "below", Earlier::refuse, 0.0); }), "");
}

TEST(Folder, ThatCannotBeWrittenIsRefused) {
  // /proc refuses new entries to everybody, also to root.
  EXPECT_EQ(io_error([] { prepare_folder("/proc/brisance", Earlier::refuse, 0.0); }),
            "cannot create the output folder \"/proc/brisance\": No such file or directory");
  EXPECT_NE(io_error([] { prepare_folder("/proc/self", Earlier::refuse, 0.0); }), "");
}

TEST(Folder, WithoutEnoughSpaceIsRefused) {
  ScratchFolder scratch;
  auto const message = io_error([&] { prepare_folder(scratch.path(), Earlier::refuse, 1e18); });
  EXPECT_NE(message.find("not enough space for the results"), std::string::npos) << message;
  EXPECT_NE(message.find("1e+06 TB"), std::string::npos) << message;
}

}  // namespace
}  // namespace brisance::output::test
