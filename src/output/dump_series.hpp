/// Numbered dumps of one kind and the index that ParaView opens as a time series.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "core/archive.hpp"
#include "output/folder.hpp"

namespace brisance::output {

class Dump;

/// Where a dump stands in its series.
enum class DumpPlace {
  next,   ///< behind the others
  again,  ///< in place of the last one
};

/// A dump that has been gathered.
struct GatheredDump {
  std::shared_ptr<Dump> dump;
  /// Compresses and writes it and brings the index up to date; both appear under their final names only when they are
  /// complete. To be called once, from any thread, in the order of the dumps, before the series ends. Throws IoError.
  std::function<void()> write;
};

class DumpSeries {
 public:
  /// `kind`: "fields", "points" or "subsets/NAME". Writes into `folder` (which exists). Nothing is created before the
  /// first dump.
  DumpSeries(std::filesystem::path folder, std::string kind, DumpForm form = DumpForm::xdmf);

  /// `entry` makes what the index says of the dump, given its file's path from the index: a <Grid> element of XDMF, or
  /// the item of a list of files.
  [[nodiscard]] GatheredDump add(std::shared_ptr<Dump> dump, DumpPlace place,
                                 std::function<std::string(std::string const& file)> const& entry);

  /// Dumps so far, of which the last may still have to be written.
  [[nodiscard]] int count() const { return count_; }
  /// Dumps on the disk.
  [[nodiscard]] int written() const { return written_; }
  /// What has been dumped, in a checkpoint; all of it must have been written. Reading drops the dumps that came later.
  void archive(Archive& a);

 private:
  std::filesystem::path folder_;
  std::string kind_;
  DumpForm form_;
  int count_ = 0;
  std::string entries_;          ///< of the index so far
  std::size_t before_last_ = 0;  ///< length of those before the last dump's
  std::atomic<int> written_ = 0;
};

}  // namespace brisance::output
