#include "output/dump_file.hpp"

#include <algorithm>

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

/// The cache holds a whole dataset up to 256 MiB, so that each chunk is compressed once although the parts that fill it
/// come in any order.
void compress(hid_t creation, hid_t access, DumpFile::Layout const& layout) {
  std::vector<hsize_t> chunk;
  std::size_t chunks = 1;
  std::size_t bytes = H5Tget_size(layout.type);
  for (std::size_t d = 0; d < layout.shape.size(); ++d) {
    chunk.push_back(std::max<hsize_t>(1, std::min(layout.shape[d], layout.edge[d])));
    std::size_t const along = (layout.shape[d] + chunk[d] - 1) / chunk[d];
    chunks *= along;
    bytes *= along * chunk[d];
  }
  check(H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data()));
  check(H5Pset_shuffle(creation));
  check(H5Pset_deflate(creation, unsigned(layout.compression)));
  constexpr std::size_t largest_cache = std::size_t{256} << 20U;
  check(H5Pset_chunk_cache(access, 10 * chunks + 1, std::clamp(bytes, std::size_t{1} << 20U, largest_cache), 1.0));
}

}  // namespace

DumpFile::DumpFile(std::size_t expected_bytes, char const* group)
    : file_(check(create(expected_bytes)), H5Fclose),
      group_(check(H5Gcreate2(file_, group, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)), H5Gclose) {}

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
  Handle access(check(H5Pcreate(H5P_DATASET_ACCESS)), H5Pclose);
  // The wall clock has no place in the bytes.
  check(H5Pset_obj_track_times(creation, false));
  if (layout.compression > 0) compress(creation, access, layout);
  hid_t const space = check(H5Screate_simple(rank, layout.shape.data(), nullptr));
  hid_t const data = H5Dcreate2(group_, name.c_str(), layout.type, space, H5P_DEFAULT, creation, access);
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

void DumpFile::write(std::filesystem::path const& path) const {
  check(H5Fflush(file_, H5F_SCOPE_GLOBAL));
  ssize_t const size = check(H5Fget_file_image(file_, nullptr, 0));
  void* image = nullptr;
  check(H5Fget_vfd_handle(file_, H5P_DEFAULT, &image));
  write_file(path, {*static_cast<char const* const*>(image), std::size_t(size)});
}

}  // namespace brisance::output
