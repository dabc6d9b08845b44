/// Checkpoints: files that hold the whole state of a run, `checkpoints/checkpoint_NNNNNNNN.brz` (number of the step) in
/// the output folder.
///
/// A file has a header of 36 bytes: "BRISANCE STATE" CR LF, version of the format (4 bytes), checksum of the data (4),
/// bytes of data (8), checksum of the header (4); then the data, an archive (core/archive.hpp). It is written beside,
/// flushed to the disk and renamed, and an older one goes only afterwards: whenever the program is killed, at least one
/// complete checkpoint stays.
#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "core/archive.hpp"

namespace brisance::output {

/// What a checkpoint tells about itself before the state.
struct CheckpointInfo {
  std::string program;  ///< version and build of the program that wrote it
  std::string deck;     ///< the deck's text
  long step = 0;
  double time = 0.0;  ///< [s]
};

/// Version and build of this program: what may change the last bits of a result.
[[nodiscard]] std::string program_build();

/// Lists the state in an archive: the same for writing and for reading.
using ArchiveState = std::function<void(Archive&)>;

/// Bytes that the state takes in a checkpoint.
[[nodiscard]] double state_bytes(ArchiveState const& state);

/// Writes one file under its final name, complete or not at all. Throws IoError.
void write_checkpoint(std::filesystem::path const& path, CheckpointInfo info, ArchiveState const& state);

/// A checkpoint that is complete and undamaged.
class CheckpointReader {
 public:
  /// Reads the whole file once and compares its checksum. Throws IoError that names the file and what is wrong with it.
  explicit CheckpointReader(std::filesystem::path path);
  CheckpointReader(CheckpointReader const&) = delete;
  CheckpointReader& operator=(CheckpointReader const&) = delete;

  [[nodiscard]] std::filesystem::path const& path() const { return path_; }
  [[nodiscard]] CheckpointInfo const& info() const { return info_; }
  /// The state, from its beginning; good for one reading.
  [[nodiscard]] Archive& archive() { return *archive_; }

 private:
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  CheckpointInfo info_;
  std::optional<Archive> archive_;
};

/// The newest good checkpoint of an output folder, if any, and why newer ones were refused.
struct FoundCheckpoint {
  std::unique_ptr<CheckpointReader> reader;
  std::vector<std::filesystem::path> refused;
  std::vector<std::string> problems;  ///< one line of each that was refused
};
[[nodiscard]] FoundCheckpoint newest_checkpoint(std::filesystem::path const& folder);

/// Puts a refused checkpoint aside, as NAME.refused, so that it does not pass for the newest any more.
void put_aside(std::filesystem::path const& refused);

/// The checkpoints of an output folder while a run writes them.
class CheckpointFiles {
 public:
  CheckpointFiles(std::filesystem::path const& folder, int keep) : folder_(folder / "checkpoints"), keep_(keep) {}

  /// Writes a checkpoint and removes all but the newest of those that runs have written here. Throws IoError.
  void write(CheckpointInfo const& info, ArchiveState const& state);
  /// Writes the state of a run that cannot go on, as `stopped.brz`: to be looked at, not to be resumed.
  void write_stopped(CheckpointInfo const& info, ArchiveState const& state);

 private:
  void write_listed(std::string const& name, CheckpointInfo const& info, ArchiveState const& state);

  std::filesystem::path folder_;
  int keep_;
  long written_ = 0;
};

}  // namespace brisance::output
