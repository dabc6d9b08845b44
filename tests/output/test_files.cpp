#include <sys/wait.h>

#include <csignal>
#include <set>

#include "core/error.hpp"
#include "output/file.hpp"
#include "output/folder.hpp"
#include "output/lock.hpp"
#include "output/manifest.hpp"
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

std::string link_message(fs::path const& path) {
  return "\"" + path.string() +
         "\" is a link, and the program does not write through links: remove it, or choose another folder with "
         "--output";
}

TEST(Files, AreNotWrittenThroughLinks) {
  ScratchFolder scratch;
  auto const& folder = scratch.path();
  write_file(folder / "mine", "mine");
  fs::create_directory(folder / "theirs");
  fs::create_symlink(folder / "mine", folder / "link");
  fs::create_symlink(folder / "mine", folder / "new.part");
  fs::create_symlink(folder / "theirs", folder / "gauges");
  fs::create_symlink(folder / "nowhere", folder / "dangling");
  EXPECT_EQ(io_error([&] { write_file(folder / "link", "x"); }), link_message(folder / "link"));
  EXPECT_EQ(io_error([&] { append_to_file(folder / "link", "x"); }), link_message(folder / "link"));
  EXPECT_EQ(io_error([&] { write_file(folder / "dangling", "x"); }), link_message(folder / "dangling"));
  EXPECT_EQ(io_error([&] { append_to_file(folder / "dangling", "x"); }), link_message(folder / "dangling"));
  EXPECT_EQ(io_error([&] { replace_file(folder / "new", "x"); }), link_message(folder / "new.part"));
  EXPECT_EQ(io_error([&] { write_file(folder / "gauges/g.csv", "x"); }), link_message(folder / "gauges"));
  EXPECT_EQ(io_error([&] { append_to_file(folder / "gauges/g.csv", "x"); }), link_message(folder / "gauges"));
  EXPECT_EQ(io_error([&] { make_folder(folder / "gauges"); }), link_message(folder / "gauges"));
  EXPECT_EQ(read_file(folder / "mine"), "mine");
  EXPECT_TRUE(fs::is_empty(folder / "theirs"));
  EXPECT_FALSE(fs::exists(folder / "nowhere"));
  // In place of a link a whole file may come: the link goes, what it leads to stays.
  replace_file(folder / "link", "x");
  EXPECT_EQ(read_file(folder / "mine"), "mine");
  EXPECT_FALSE(fs::is_symlink(folder / "link"));
}

TEST(Files, AreNotWrittenThroughAnotherNameOfThem) {
  ScratchFolder scratch;
  write_file(scratch.path() / "mine", "mine");
  fs::create_hard_link(scratch.path() / "mine", scratch.path() / "same");
  write_file(scratch.path() / "same", "x");
  EXPECT_EQ(read_file(scratch.path() / "mine"), "mine");
}

TEST(Lock, KeepsASecondRunOut) {
  ScratchFolder scratch;
  fs::path const folder = scratch.path() / "a/b";
  {
    FolderLock const lock(folder);
    auto const message = io_error([&] { FolderLock const second(folder); });
    EXPECT_NE(message.find("another run (process " + std::to_string(getpid())), std::string::npos) << message;
    EXPECT_NE(message.find("is writing to the output folder \"" + folder.string()), std::string::npos) << message;
    EXPECT_EQ(lock.warning(), "");
  }
  EXPECT_FALSE(fs::exists(scratch.path() / "a")) << "the folders that it made stayed behind, empty";
  {
    FolderLock const again(folder);
    write_file(folder / "x", "");
  }
  EXPECT_TRUE(fs::exists(folder / "x"));
  EXPECT_FALSE(fs::exists(folder / ".brisance-lock"));
}

TEST(Lock, GoesWithAKilledProcess) {
  ScratchFolder scratch;
  auto const& folder = scratch.path();
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  pid_t const child = fork();
  if (child == 0) {
    FolderLock const lock(folder);
    [[maybe_unused]] auto const told = write(ends[1], "x", 1);
    pause();
    _exit(0);
  }
  char word = 0;
  ASSERT_EQ(read(ends[0], &word, 1), 1);
  EXPECT_NE(io_error([&] { FolderLock const lock(folder); }), "");
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(fs::exists(folder / ".brisance-lock"));
  EXPECT_EQ(io_error([&] { FolderLock const lock(folder); }), "");
  close(ends[0]);
  close(ends[1]);
}

TEST(Lock, IsNoLink) {
  ScratchFolder scratch;
  write_file(scratch.path() / "mine", "mine");
  fs::create_symlink(scratch.path() / "mine", scratch.path() / ".brisance-lock");
  EXPECT_EQ(io_error([&] { FolderLock const lock(scratch.path()); }), link_message(scratch.path() / ".brisance-lock"));
  EXPECT_EQ(read_file(scratch.path() / "mine"), "mine");
}

TEST(Manifest, LeadsNowhereElse) {
  ScratchFolder scratch;
  list_files(scratch.path(), {"run.json", "gauges/a b.csv", "/etc/passwd", "../x", "gauges/../../x", "gauges/..",
                              "notes.txt", "notes/x", "gauges/", "run.json"});
  EXPECT_EQ(listed_files(scratch.path()), (std::set<std::string>{"gauges/a b.csv", "run.json"}));
  EXPECT_TRUE(listed_files(scratch.path() / "nowhere").empty());
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
  replace_file(folder / "gauges/cut.csv.part", "x");
  list_files(folder, results);
  list_files(folder, {"gauges/cut.csv", "gauges/never.csv"});
  std::vector<std::string> const mine{"notes.txt",          "gauges/mine.csv",       "fields/mine.h5",
                                      "fields/fields_9.h5", "fields/fields_mean.h5", "checkpoints/mine.brz"};
  for (auto const& name : mine) replace_file(folder / name, "x");

  EXPECT_EQ(
      io_error([&] { prepare_folder(folder, Earlier::refuse, 0.0); }),
      "the output folder \"" + folder.string() +
          "\" already contains the results of a run (run.json): continue that run with --resume, choose another folder "
          "with --output, or replace the results with --force");
  EXPECT_TRUE(fs::exists(folder / "gauges/g.csv"));

  EXPECT_NO_THROW(prepare_folder(folder, Earlier::keep, 0.0));
  for (auto const& name : results) EXPECT_TRUE(fs::exists(folder / name)) << name;

  prepare_folder(folder, Earlier::replace, 0.0);
  for (auto const& name : results) EXPECT_FALSE(fs::exists(folder / name)) << name;
  EXPECT_FALSE(fs::exists(folder / "gauges/cut.csv.part"));
  for (auto const& name : mine) EXPECT_TRUE(fs::exists(folder / name)) << name << " is no result and was removed";
  EXPECT_TRUE(listed_files(folder).empty());
}

// A file of somebody else where the run will write: nothing is removed, whatever is asked for.
TEST(Folder, WithStrangersInTheWayIsRefused) {
  Written const written{{"run.json", "deck.toml", "gauges/g.csv"}, {"fields/fields_000000.h5"}};
  for (std::string const name : {"deck.toml", "gauges/g.csv", "fields/fields_000000.h5"}) {
    for (auto const earlier : {Earlier::refuse, Earlier::replace, Earlier::keep}) {
      ScratchFolder scratch;
      auto const& folder = scratch.path();
      fs::create_directory(folder / "gauges");
      fs::create_directory(folder / "fields");
      if (earlier != Earlier::refuse) replace_file(folder / "run.json", "x");
      list_files(folder, {"run.json"});
      replace_file(folder / name, "mine");
      auto const message = io_error([&] { prepare_folder(folder, earlier, 0.0, written); });
      EXPECT_NE(message.find(name + "\" already exists"), std::string::npos) << message;
      EXPECT_EQ(read_file(folder / name), "mine");
      EXPECT_EQ(fs::exists(folder / "run.json"), earlier != Earlier::refuse);
    }
  }
  // Checkpoints of another run would be taken up by --resume.
  ScratchFolder scratch;
  fs::create_directory(scratch.path() / "checkpoints");
  replace_file(scratch.path() / "checkpoints/checkpoint_00000007.brz", "mine");
  EXPECT_NE(io_error([&] { prepare_folder(scratch.path(), Earlier::replace, 0.0, written); }), "");
  EXPECT_EQ(io_error([&] { prepare_folder(scratch.path(), Earlier::keep, 0.0, written); }), "");
}

TEST(Folder, LinksInItAreNotFollowed) {
  Written const written{{"run.json", "gauges/g.csv"}, {}};
  for (auto const earlier : {Earlier::refuse, Earlier::replace, Earlier::keep}) {
    ScratchFolder scratch;
    fs::path const folder = scratch.path() / "out";
    fs::path const theirs = scratch.path() / "theirs";
    fs::create_directory(folder);
    fs::create_directory(theirs);
    write_file(theirs / "g.csv", "mine");
    list_files(folder, {"gauges/g.csv"});
    fs::create_directory_symlink(theirs, folder / "gauges");
    EXPECT_EQ(io_error([&] { prepare_folder(folder, earlier, 0.0, written); }), link_message(folder / "gauges"));
    // Where this run writes none, the one that the list speaks of is not there.
    EXPECT_EQ(io_error([&] { prepare_folder(folder, earlier, 0.0); }), "");
    EXPECT_EQ(read_file(theirs / "g.csv"), "mine");

    fs::remove(folder / "gauges");
    fs::create_directory(folder / "gauges");
    fs::create_symlink(theirs / "g.csv", folder / "gauges/g.csv");
    list_files(folder, {"gauges/g.csv"});
    EXPECT_EQ(io_error([&] { prepare_folder(folder, earlier, 0.0, written); }), link_message(folder / "gauges/g.csv"));
    EXPECT_TRUE(fs::is_symlink(folder / "gauges/g.csv"));
    EXPECT_EQ(read_file(theirs / "g.csv"), "mine");
  }
}

TEST(Folder, OfAnEarlierVersionIsNotForced) {
  ScratchFolder scratch;
  auto const& folder = scratch.path();
  replace_file(folder / "run.json", "x");
  for (auto const earlier : {Earlier::refuse, Earlier::replace}) {
    auto const message = io_error([&] { prepare_folder(folder, earlier, 0.0); });
    EXPECT_NE(message.find("without the list of their files, \"files.txt\""), std::string::npos) << message;
  }
  // A run that goes on keeps the list from then on.
  prepare_folder(folder, Earlier::keep, 0.0, {{"run.json"}, {}});
  EXPECT_EQ(listed_files(folder), std::set<std::string>{"run.json"});
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
