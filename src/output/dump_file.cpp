#include "output/dump_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstdint>

#include "core/error.hpp"
#include "output/file.hpp"

namespace brisance::output {

namespace {

/// HDF5 marks failure by a negative result. In memory nothing but a lack of it can fail.
template <class Result>
Result check(Result result) {
  if (result < 0) throw IoError("the HDF5 library could not create a dump; is the memory exhausted?");
  return result;
}

/// A file that lives in memory and grows by a fraction of the expected size at a time.
hid_t create(std::size_t expected_bytes) {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  std::size_t const increment = std::clamp(expected_bytes / 8, std::size_t{1} << 16U, std::size_t{1} << 26U);
  check(H5Pset_fapl_core(access, increment, false));
  return H5Fcreate("dump", H5F_ACC_TRUNC, H5P_DEFAULT, access);
}

/// Readers undo the filters in reverse order.
void compress(hid_t creation, DumpFile::Layout const& layout) {
  std::vector<hsize_t> const chunk = layout.chunk();
  check(H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data()));
  check(H5Pset_shuffle(creation));
  check(H5Pset_deflate(creation, unsigned(layout.compression)));
}

hid_t file_type(NumberType type) {
  switch (type) {
    case NumberType::float32: return H5T_IEEE_F32LE;
    case NumberType::float64: return H5T_IEEE_F64LE;
    case NumberType::int32: return H5T_STD_I32LE;
    case NumberType::int64: return H5T_STD_I64LE;
    case NumberType::uint8: return H5T_STD_U8LE;
  }
  return H5T_IEEE_F64LE;
}

static_assert(std::endian::native == std::endian::little, "the numbers of a dump are written as they are in memory");

/// The values as numbers of a type, byte by byte: first the first byte of all, then the second and so on.
template <class Number>
std::vector<char> shuffled(std::vector<double> const& values) {
  std::size_t const n = values.size();
  std::vector<char> bytes(n * sizeof(Number));
  for (std::size_t i = 0; i < n; ++i) {
    auto const number = std::bit_cast<std::array<char, sizeof(Number)>>(static_cast<Number>(values[i]));
    for (std::size_t b = 0; b < sizeof(Number); ++b) bytes[b * n + i] = number[b];
  }
  return bytes;
}

}  // namespace

std::vector<char> shuffled(std::vector<double> const& values, NumberType type) {
  switch (type) {
    case NumberType::float32: return shuffled<float>(values);
    case NumberType::float64: return shuffled<double>(values);
    case NumberType::int32: return shuffled<std::int32_t>(values);
    case NumberType::int64: return shuffled<std::int64_t>(values);
    case NumberType::uint8: return shuffled<std::uint8_t>(values);
  }
  return {};
}

std::vector<char> compressed(std::vector<char> const& bytes, int level) {
  // Shuffled fields have long runs of equal bytes beside noise: matches at other distances cost time and gain little.
  constexpr int window_bits = 15;
  constexpr int memory_level = 9;
  z_stream stream{};
  char const* const failure = "no memory to compress a dump";
  if (deflateInit2(&stream, level, Z_DEFLATED, window_bits, memory_level, Z_RLE) != Z_OK) throw IoError(failure);
  std::vector<char> out(deflateBound(&stream, bytes.size()));
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib reads it only
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  int const result = deflate(&stream, Z_FINISH);
  out.resize(out.size() - stream.avail_out);
  out.shrink_to_fit();  // it waits to be written
  deflateEnd(&stream);
  if (result != Z_STREAM_END) throw IoError(failure);
  return out;
}

std::vector<hsize_t> DumpFile::Layout::chunk() const {
  std::vector<hsize_t> edges(shape.size());
  for (std::size_t d = 0; d < shape.size(); ++d) edges[d] = std::max<hsize_t>(1, std::min(shape[d], edge[d]));
  return edges;
}

DumpFile::DumpFile(std::size_t expected_bytes, char const* group)
    : file_(check(create(expected_bytes)), H5Fclose),
      group_(check(H5Gcreate2(file_, group, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)), H5Gclose) {}

Handle DumpFile::add_group(std::string const& name) {
  return {check(H5Gcreate2(group_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)), H5Gclose};
}

void DumpFile::attribute(hid_t object, char const* name, std::string const& value) {
  Handle type(check(H5Tcopy(H5T_C_S1)), H5Tclose);
  check(H5Tset_size(type, std::max<std::size_t>(1, value.size())));
  Handle space(check(H5Screate(H5S_SCALAR)), H5Sclose);
  Handle attr(check(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT)), H5Aclose);
  check(H5Awrite(attr, type, value.c_str()));
}

void DumpFile::write_attribute(hid_t object, char const* name, std::size_t n, hid_t file_type, hid_t memory_type,
                               void const* values) {
  hsize_t const size = n;
  Handle space(check(n == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &size, nullptr)), H5Sclose);
  Handle attr(check(H5Acreate2(object, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT)), H5Aclose);
  check(H5Awrite(attr, memory_type, values));
}

DumpFile::Dataset DumpFile::dataset(std::string const& name, Layout const& layout, std::string const& unit,
                                    std::string const& meaning) {
  int const rank = static_cast<int>(layout.shape.size());
  Handle creation(check(H5Pcreate(H5P_DATASET_CREATE)), H5Pclose);
  // The wall clock has no place in the bytes.
  check(H5Pset_obj_track_times(creation, false));
  if (layout.compression > 0) compress(creation, layout);
  hid_t const space = check(H5Screate_simple(rank, layout.shape.data(), nullptr));
  Handle link(check(H5Pcreate(H5P_LINK_CREATE)), H5Pclose);
  check(H5Pset_create_intermediate_group(link, 1));
  hid_t const data = H5Dcreate2(group_, name.c_str(), file_type(layout.type), space, link, creation, H5P_DEFAULT);
  if (data < 0) H5Sclose(space);
  check(data);
  Dataset dataset(data, space);
  attribute(data, "unit", unit);
  attribute(data, "meaning", meaning);
  return dataset;
}

void DumpFile::Dataset::write(std::vector<hsize_t> const& start, std::vector<hsize_t> const& count,
                              double const* values) const {
  check(H5Sselect_hyperslab(space_, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr));
  Handle memory(check(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr)), H5Sclose);
  check(H5Dwrite(data_, H5T_NATIVE_DOUBLE, memory, space_, H5P_DEFAULT, values));
}

void DumpFile::Dataset::write_chunk(std::vector<hsize_t> const& start, std::vector<char> const& compressed) const {
  check(H5Dwrite_chunk(data_, H5P_DEFAULT, 0, start.data(), compressed.size(), compressed.data()));
}

void DumpFile::write(std::filesystem::path const& path) const {
  check(H5Fflush(file_, H5F_SCOPE_GLOBAL));
  ssize_t const size = check(H5Fget_file_image(file_, nullptr, 0));
  void* image = nullptr;
  check(H5Fget_vfd_handle(file_, H5P_DEFAULT, &image));
  write_file(path, {*static_cast<char const* const*>(image), std::size_t(size)});
}

}  // namespace brisance::output
