#include "output/lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include "core/error.hpp"
#include "output/file.hpp"
#include "output/folder.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

/// Who holds the lock, as far as its file tells.
std::string holder(int descriptor) {
  std::array<char, 200> text{};
  ssize_t const got = ::pread(descriptor, text.data(), text.size(), 0);
  std::string who(text.data(), static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  std::erase_if(who, [](char c) { return static_cast<unsigned char>(c) < 0x20U; });
  return who.empty() ? "" : fmt::format(" ({})", who);
}

std::string host() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "an unknown machine";
}

}  // namespace

FolderLock::FolderLock(fs::path folder) : folder_(std::move(folder)) {
  std::error_code ignored;
  fs::path const whole = folder_.has_filename() ? folder_ : folder_.parent_path();
  for (fs::path p = whole; !p.empty() && !fs::exists(fs::symlink_status(p, ignored)); p = p.parent_path())
    made_.push_back(p);
  create_folder(folder_);
  acquire();
}

void FolderLock::acquire() {
  fs::path const path = folder_ / ".brisance-lock";
  // The run before may remove its file between our opening and locking it: then the next try meets a new one.
  for (;;) {
    descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK, 0666);
    if (descriptor_ < 0) {
      if (errno == ELOOP) refuse_link(path);
      throw_io_error("create", path, errno);
    }
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      int const reason = errno;
      if (reason == EINTR) continue;
      if (reason != EWOULDBLOCK) {
        warning_ = fmt::format("\"{}\" is on a file system without locks: make sure that no second run writes there",
                               folder_.string());
        return;
      }
      std::string const who = holder(descriptor_);
      ::close(descriptor_);
      throw IoError(
          fmt::format("another run{} is writing to the output folder \"{}\": wait until it ends, stop it, or choose "
                      "another folder with --output",
                      who, folder_.string()));
    }
    struct stat ours {};
    struct stat there {};
    if (::fstat(descriptor_, &ours) == 0 && ::lstat(path.c_str(), &there) == 0 && ours.st_ino == there.st_ino &&
        ours.st_dev == there.st_dev)
      break;
    ::close(descriptor_);
  }
  std::string const who = fmt::format("process {} on {}\n", ::getpid(), host());
  // Only for the message of another run: nothing is lost where it cannot be written.
  if (::ftruncate(descriptor_, 0) == 0) {
    [[maybe_unused]] auto const written = ::pwrite(descriptor_, who.data(), who.size(), 0);
  }
}

FolderLock::~FolderLock() {
  // While the lock is held, so that no other run can hold a file that is about to go.
  ::unlink((folder_ / ".brisance-lock").c_str());
  ::close(descriptor_);
  std::error_code ignored;
  for (auto const& folder : made_) fs::remove(folder, ignored);  // fails where something is in it
}

}  // namespace brisance::output
