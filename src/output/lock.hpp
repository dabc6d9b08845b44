/// One run at a time writes into a folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace brisance::output {

/// Holds the output folder of a run for as long as it lives: a lock on the file `.brisance-lock` in it. The system
/// drops the lock with the process, so that a run that was killed leaves a file, but no lock.
class FolderLock {
 public:
  /// Creates the folder (with its parents) where it does not exist. Throws IoError where another run holds it, and
  /// where the file cannot be made.
  explicit FolderLock(std::filesystem::path folder);
  /// Removes the file, and the folders that it made if nothing has been written into them.
  ~FolderLock();
  FolderLock(FolderLock const&) = delete;
  FolderLock& operator=(FolderLock const&) = delete;

  /// What is to be told where the file system knows no locks; else empty.
  [[nodiscard]] std::string const& warning() const { return warning_; }

 private:
  void acquire();

  std::filesystem::path folder_;
  std::vector<std::filesystem::path> made_;  ///< the innermost first
  std::string warning_;
  int descriptor_ = -1;
};

}  // namespace brisance::output
