#include "output/fields.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "core/error.hpp"
#include "output/file.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

/// An HDF5 identifier that closes itself.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  ~Handle() {
    if (id_ >= 0) closer_(id_);
  }
  Handle(Handle const&) = delete;
  Handle& operator=(Handle const&) = delete;
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): passed to the C library

 private:
  hid_t id_;
  Closer closer_;
};

/// Keeps the HDF5 library from printing its error stack: errors become exceptions here.
class QuietHdf5 {
 public:
  QuietHdf5() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  QuietHdf5(QuietHdf5 const&) = delete;
  QuietHdf5& operator=(QuietHdf5 const&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// A dump that is being put together in memory, and then written in one go: the HDF5 library cannot be used any more
/// once a write of its own has failed, so that it must never meet a full disk.
class DumpFile {
 public:
  explicit DumpFile(std::size_t expected_bytes)
      : file_(check(create(expected_bytes)), H5Fclose),
        cells_(check(H5Gcreate2(file_, "cells", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)), H5Gclose) {}

  void attribute(hid_t object, char const* name, std::string const& value) {
    Handle type(check(H5Tcopy(H5T_C_S1)), H5Tclose);
    check(H5Tset_size(type, std::max<std::size_t>(1, value.size())));
    Handle space(check(H5Screate(H5S_SCALAR)), H5Sclose);
    Handle attr(check(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT)), H5Aclose);
    check(H5Awrite(attr, type, value.c_str()));
  }

  template <std::size_t N>
  void attribute(hid_t object, char const* name, std::array<double, N> const& values) {
    write_attribute(object, name, N, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data());
  }

  template <std::size_t N>
  void attribute(hid_t object, char const* name, std::array<long, N> const& values) {
    write_attribute(object, name, N, H5T_STD_I64LE, H5T_NATIVE_LONG, values.data());
  }

  [[nodiscard]] hid_t root() const { return file_; }

  void field(FieldSpec const& spec, grid::Grid const& grid, FieldOptions const& options, BlockValues const& values) {
    auto const& cells = grid.domain().cells;
    int const rank = spec.components == 1 ? 3 : 4;
    std::array<hsize_t, 4> const shape{hsize_t(cells[2]), hsize_t(cells[1]), hsize_t(cells[0]),
                                       hsize_t(spec.components)};
    Handle space(check(H5Screate_simple(rank, shape.data(), nullptr)), H5Sclose);
    Handle creation(check(H5Pcreate(H5P_DATASET_CREATE)), H5Pclose);
    Handle access(check(H5Pcreate(H5P_DATASET_ACCESS)), H5Pclose);
    std::size_t const value_bytes = options.single_precision ? sizeof(float) : sizeof(double);
    if (options.compression > 0) compress(creation, access, rank, shape, value_bytes, options.compression);
    hid_t const type = options.single_precision ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
    Handle data(check(H5Dcreate2(cells_, spec.name.c_str(), type, space, H5P_DEFAULT, creation, access)), H5Dclose);
    attribute(data, "unit", spec.unit);
    attribute(data, "meaning", spec.meaning);

    std::vector<double> buffer;
    for (int b = 0; b < grid.block_count(); ++b) {
      auto const& block = grid.blocks()[b];
      buffer.clear();
      values(b, spec.name, buffer);
      if (buffer.size() != std::size_t(block.cell_count()) * spec.components)
        throw std::logic_error("field \"" + spec.name + "\": wrong number of values in a block");
      auto const& o = block.origin;
      auto const& n = block.n;
      std::array<hsize_t, 4> const start{hsize_t(o[2]), hsize_t(o[1]), hsize_t(o[0]), 0};
      std::array<hsize_t, 4> const count{hsize_t(n[2]), hsize_t(n[1]), hsize_t(n[0]), hsize_t(spec.components)};
      check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr));
      Handle memory(check(H5Screate_simple(rank, count.data(), nullptr)), H5Sclose);
      check(H5Dwrite(data, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, buffer.data()));
    }
  }

  /// Throws IoError.
  void write(fs::path const& path) const {
    check(H5Fflush(file_, H5F_SCOPE_GLOBAL));
    ssize_t const size = check(H5Fget_file_image(file_, nullptr, 0));
    void* image = nullptr;
    check(H5Fget_vfd_handle(file_, H5P_DEFAULT, &image));
    write_file(path, {*static_cast<char const* const*>(image), std::size_t(size)});
  }

 private:
  /// A file that lives in memory and grows by a fraction of the expected size at a time.
  static hid_t create(std::size_t expected_bytes) {
    Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    std::size_t const increment = std::clamp(expected_bytes / 8, std::size_t{1} << 16U, std::size_t{1} << 26U);
    check(H5Pset_fapl_core(access, increment, false));
    return H5Fcreate("dump", H5F_ACC_TRUNC, H5P_DEFAULT, access);
  }

  /// Chunks of at most 64^3 cells; the cache holds a whole field up to 256 MiB, so that each chunk is compressed once
  /// although the blocks that fill it come along a space-filling curve.
  void compress(hid_t creation, hid_t access, int rank, std::array<hsize_t, 4> const& shape, std::size_t value_bytes,
                int level) {
    hsize_t const edge = shape[0] > 1 ? 64 : (shape[1] > 1 ? 256 : 65536);
    std::array<hsize_t, 4> chunk{};
    std::size_t chunks = 1;
    std::size_t bytes = value_bytes;
    for (int d = 0; d < rank; ++d) {
      chunk[d] = d < 3 ? std::min(shape[d], edge) : shape[d];
      std::size_t const along = (shape[d] + chunk[d] - 1) / chunk[d];
      chunks *= along;
      bytes *= along * chunk[d];
    }
    check(H5Pset_chunk(creation, rank, chunk.data()));
    check(H5Pset_shuffle(creation));
    check(H5Pset_deflate(creation, unsigned(level)));
    constexpr std::size_t largest_cache = std::size_t{256} << 20U;
    check(H5Pset_chunk_cache(access, 10 * chunks + 1, std::clamp(bytes, std::size_t{1} << 20U, largest_cache), 1.0));
  }

  void write_attribute(hid_t object, char const* name, std::size_t n, hid_t file_type, hid_t memory_type,
                       void const* values) {
    hsize_t const size = n;
    Handle space(check(n == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &size, nullptr)), H5Sclose);
    Handle attr(check(H5Acreate2(object, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT)), H5Aclose);
    check(H5Awrite(attr, memory_type, values));
  }

  /// HDF5 marks failure by a negative result. In memory nothing but a lack of it can fail.
  template <class Result>
  static Result check(Result result) {
    if (result < 0) throw IoError("the HDF5 library could not build a field dump; is the memory exhausted?");
    return result;
  }

  Handle file_;
  Handle cells_;
};

char const* collection_head =
    "<?xml version=\"1.0\"?>\n"
    "<Xdmf Version=\"2.0\">\n"
    "  <Domain>\n"
    "    <Grid Name=\"series\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
char const* collection_tail = "    </Grid>\n  </Domain>\n</Xdmf>\n";

/// The index's entry of one dump. XDMF lists the slowest direction first.
std::string index_entry(std::string const& file, double time, grid::Domain const& domain,
                        std::vector<FieldSpec> const& fields, bool single_precision) {
  auto const& n = domain.cells;
  std::string out =
      fmt::format("      <Grid Name=\"cells\" GridType=\"Uniform\">\n        <Time Value=\"{}\"/>\n", time);
  out += fmt::format("        <Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"{} {} {}\"/>\n", n[2] + 1, n[1] + 1,
                     n[0] + 1);
  out += fmt::format(
      "        <Geometry GeometryType=\"ORIGIN_DXDYDZ\">\n"
      "          <DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" Format=\"XML\">{2} {1} "
      "{0}</DataItem>\n"
      "          <DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" Format=\"XML\">{3} {3} "
      "{3}</DataItem>\n"
      "        </Geometry>\n",
      domain.lower[0], domain.lower[1], domain.lower[2], domain.h);
  for (auto const& field : fields) {
    bool const vector = field.components == 3;
    out += fmt::format(
        "        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Cell\">\n"
        "          <DataItem Dimensions=\"{} {} {}{}\" NumberType=\"Float\" Precision=\"{}\" Format=\"HDF\">"
        "{}:/cells/{}</DataItem>\n"
        "        </Attribute>\n",
        field.name, vector ? "Vector" : "Scalar", n[2], n[1], n[0], vector ? " 3" : "", single_precision ? 4 : 8, file,
        field.name);
  }
  return out + "      </Grid>\n";
}

}  // namespace

FieldSeries::FieldSeries(fs::path folder, FieldOptions options) : folder_(std::move(folder)), options_(options) {}

void FieldSeries::dump(double time, long step, grid::Grid const& grid, std::vector<FieldSpec> const& fields,
                       BlockValues const& values) {
  std::error_code error;
  fs::create_directories(folder_ / "fields", error);
  if (error) throw_io_error("create", folder_ / "fields", error.value());

  std::string const name = fmt::format("fields/fields_{:06d}.h5", count_);
  fs::path const temporary = folder_ / (name + ".part");
  auto const& domain = grid.domain();
  QuietHdf5 const quiet;
  try {
    DumpFile file(std::size_t(bytes_per_dump(domain, fields, options_.single_precision)));
    file.attribute(file.root(), "time", std::array{time});
    file.attribute(file.root(), "step", std::array{step});
    file.attribute(file.root(), "geometry", grid::geometry_name(domain.geometry));
    file.attribute(file.root(), "origin", domain.lower);
    file.attribute(file.root(), "spacing", std::array{domain.h});
    file.attribute(file.root(), "cells", std::array<long, 3>{domain.cells[0], domain.cells[1], domain.cells[2]});
    for (auto const& field : fields) file.field(field, grid, options_, values);
    file.write(temporary);
  } catch (...) {
    fs::remove(temporary, error);
    throw;
  }
  rename_file(temporary, folder_ / name);
  entries_ += index_entry(name, time, domain, fields, options_.single_precision);
  replace_file(folder_ / "fields.xmf2", collection_head + entries_ + collection_tail);
  ++count_;
}

double FieldSeries::bytes_per_dump(grid::Domain const& domain, std::vector<FieldSpec> const& fields,
                                   bool single_precision) {
  double components = 0.0;
  for (auto const& field : fields) components += field.components;
  return static_cast<double>(domain.cell_count()) * components * (single_precision ? 4.0 : 8.0);
}

}  // namespace brisance::output
