/// HDF5 files that are put together in memory.
#pragma once

#include <hdf5.h>

#include <array>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace brisance::output {

/// An HDF5 identifier that closes itself.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  ~Handle() {
    if (id_ >= 0) closer_(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), closer_(other.closer_) {}
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

/// How numbers are kept in a file, little-endian.
enum class NumberType { float32, float64, int32, int64, uint8 };

/// The numbers of a chunk as bytes of the type, the bytes of equal rank side by side. `values`: all of the chunk's, in
/// the order of the file.
[[nodiscard]] std::vector<char> shuffled(std::vector<double> const& values, NumberType type);

/// A shuffled chunk as HDF5 keeps it, compressed with gzip's `level`. May be called from several threads, which the
/// HDF5 library may not. The same bytes give the same bytes. Throws IoError where the memory is exhausted.
[[nodiscard]] std::vector<char> compressed(std::vector<char> const& bytes, int level);

/// A dump that is being put together in memory, and then written in one go: the HDF5 library cannot be used any more
/// once a write of its own has failed, so that it must never meet a full disk. The same content gives the same bytes.
class DumpFile {
 public:
  /// `group` holds the datasets, in groups within it where their names say so: "level/pressure".
  DumpFile(std::size_t expected_bytes, char const* group);

  void attribute(hid_t object, char const* name, std::string const& value);

  template <std::size_t N>
  void attribute(hid_t object, char const* name, std::array<double, N> const& values) {
    write_attribute(object, name, N, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data());
  }

  template <std::size_t N>
  void attribute(hid_t object, char const* name, std::array<long, N> const& values) {
    write_attribute(object, name, N, H5T_STD_I64LE, H5T_NATIVE_LONG, values.data());
  }

  [[nodiscard]] hid_t root() const { return file_; }
  [[nodiscard]] hid_t group() const { return group_; }
  /// A new group within `group`.
  [[nodiscard]] Handle add_group(std::string const& name);

  /// A dataset: `shape` with the slowest direction first, chunks of at most `edge` in each direction.
  struct Layout {
    std::vector<hsize_t> shape;
    std::vector<hsize_t> edge;
    NumberType type = NumberType::float32;
    int compression = 1;  ///< gzip level, 0: none, and no chunks

    /// Edges of a chunk; at the ends of the dataset they reach beyond it.
    [[nodiscard]] std::vector<hsize_t> chunk() const;
  };
  class Dataset {
   public:
    Dataset(hid_t data, hid_t space) : data_(data, H5Dclose), space_(space, H5Sclose) {}
    /// Writes a part of it; values in the order of the file.
    void write(std::vector<hsize_t> const& start, std::vector<hsize_t> const& count, double const* values) const;
    /// Writes the chunk that begins at `start`, see `compressed`.
    void write_chunk(std::vector<hsize_t> const& start, std::vector<char> const& compressed) const;
    [[nodiscard]] hid_t id() const { return data_; }

   private:
    Handle data_;
    Handle space_;
  };
  /// With its attributes `unit` and `meaning`.
  [[nodiscard]] Dataset dataset(std::string const& name, Layout const& layout, std::string const& unit,
                                std::string const& meaning);

  /// Throws IoError.
  void write(std::filesystem::path const& path) const;

 private:
  void write_attribute(hid_t object, char const* name, std::size_t n, hid_t file_type, hid_t memory_type,
                       void const* values);

  Handle file_;
  Handle group_;
};

}  // namespace brisance::output
