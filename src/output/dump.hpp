/// A dump on its way from the state to its file.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "output/dump_file.hpp"
#include "output/field_spec.hpp"

namespace brisance::output {

/// The numbers of a dump, chunk by chunk. They are gathered while the state stands still; then the chunks are
/// compressed and written while the calculation goes on.
class Dump {
 public:
  using Attributes = std::function<void(DumpFile& file)>;

  /// `group` holds the datasets, `attributes` writes those of the root; `expected_bytes`: without compression.
  Dump(std::string group, std::size_t expected_bytes, Attributes attributes);

  /// Adds a dataset without chunks yet, and returns its number.
  int add_dataset(FieldSpec const& spec, DumpFile::Layout const& layout);
  /// Adds chunks that have no numbers yet, and returns the number of the first.
  std::size_t add_chunks(std::size_t count);
  /// Gives a chunk its numbers, see `shuffled`. Several threads may set different chunks.
  void set_chunk(std::size_t number, int dataset, std::vector<hsize_t> start, std::vector<char> bytes);

  /// Compresses chunks that nobody has begun until none is left. Any number of threads may do so at a time.
  void compress();
  /// Compresses what is left, waits for others who do so, and writes the file. Throws IoError.
  void write(std::filesystem::path const& path);

 private:
  struct Dataset {
    FieldSpec spec;
    DumpFile::Layout layout;
  };
  struct Chunk {
    int dataset = 0;
    std::vector<hsize_t> start;
    std::vector<char> bytes;
  };

  std::string group_;
  std::size_t expected_bytes_;
  Attributes attributes_;
  std::vector<Dataset> datasets_;
  std::vector<Chunk> chunks_;
  std::atomic<std::size_t> begun_ = 0;
  std::atomic<std::size_t> done_ = 0;
  std::atomic<bool> failed_ = false;
};

}  // namespace brisance::output
