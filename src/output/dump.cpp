#include "output/dump.hpp"

#include <utility>

#include "core/error.hpp"

namespace brisance::output {

Dump::Dump(std::string group, std::size_t expected_bytes, Attributes attributes)
    : group_(std::move(group)), expected_bytes_(expected_bytes), attributes_(std::move(attributes)) {}

int Dump::add_dataset(FieldSpec const& spec, DumpFile::Layout const& layout) {
  datasets_.push_back({spec, layout});
  return static_cast<int>(datasets_.size()) - 1;
}

std::size_t Dump::add_chunks(std::size_t count) {
  std::size_t const first = chunks_.size();
  chunks_.resize(first + count);
  return first;
}

void Dump::set_chunk(std::size_t number, int dataset, std::vector<hsize_t> start, std::vector<char> bytes) {
  chunks_[number] = {dataset, std::move(start), std::move(bytes)};
}

void Dump::compress() {
  while (true) {
    std::size_t const n = begun_++;
    if (n >= chunks_.size()) return;
    Chunk& chunk = chunks_[n];
    try {
      if (!failed_) chunk.bytes = compressed(chunk.bytes, datasets_[chunk.dataset].layout.compression);
    } catch (std::exception const&) {
      failed_ = true;  // `write` says so
    }
    if (++done_ == chunks_.size()) done_.notify_all();
  }
}

void Dump::write(std::filesystem::path const& path) {
  compress();
  for (std::size_t done = done_; done < chunks_.size(); done = done_) done_.wait(done);
  if (failed_) throw IoError("no memory to compress a dump");
  DumpFile file(expected_bytes_, group_.c_str());
  attributes_(file);
  std::vector<DumpFile::Dataset> datasets;
  datasets.reserve(datasets_.size());
  for (Dataset const& d : datasets_)
    datasets.push_back(file.dataset(d.spec.name, d.layout, d.spec.unit, d.spec.meaning));
  for (Chunk& chunk : chunks_) {
    datasets[chunk.dataset].write_chunk(chunk.start, chunk.bytes);
    chunk.bytes = {};  // the file's image in memory holds it now
  }
  file.write(path);
}

}  // namespace brisance::output
