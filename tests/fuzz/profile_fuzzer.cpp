/// libFuzzer entry: HDF5 files that are sound as such, with whatever a profile should not hold: parts that are missing,
/// of another type or shape, larger than the file, packed, in other files, numbers that are none. The reader returns a
/// profile whose parts belong together, or throws IoError. (Damaged bytes are the HDF5 library's own matter: they would
/// test that library.)
#include <hdf5.h>

#include <array>
#include <cmath>
#include <cstring>

#include "core/archive.hpp"
#include "core/error.hpp"
#include "memory_file.hpp"
#include "output/dump_file.hpp"
#include "output/profile_file.hpp"

namespace {

using namespace brisance;
using fuzz::Bytes;
using output::Handle;

void require(bool sound) {
  if (!sound) std::abort();
}

/// What an attribute or dataset is made of.
struct Part {
  hid_t type = -1;
  std::vector<hsize_t> shape;  ///< empty: a scalar
  std::string bytes;
};

template <class T>
Part numbers(hid_t type, std::vector<T> const& values, std::vector<hsize_t> shape) {
  Part part{type, std::move(shape), {}};
  part.bytes.assign(reinterpret_cast<char const*>(values.data()), values.size() * sizeof(T));
  return part;
}
Part number(double x) { return numbers<double>(H5T_IEEE_F64LE, {x}, {}); }
Part number(long x) { return numbers<long>(H5T_STD_I64LE, {x}, {}); }

std::size_t count_of(std::vector<hsize_t> const& shape) {
  std::size_t n = 1;
  for (hsize_t const s : shape) n *= s;
  return n;
}

/// A type that the reader does not expect.
hid_t odd_type(Bytes& in) {
  switch (in.byte() % 9) {
    case 0: return H5Tcopy(H5T_STD_I8LE);
    case 1: return H5Tcopy(H5T_IEEE_F32LE);
    case 2: return H5Tcopy(H5T_IEEE_F64BE);
    case 3: return H5Tcopy(H5T_NATIVE_LDOUBLE);
    case 4: {
      hid_t const type = H5Tcopy(H5T_C_S1);
      H5Tset_size(type, 1U + in.byte());
      return type;
    }
    case 5: {
      hid_t const type = H5Tcreate(H5T_COMPOUND, 16);
      H5Tinsert(type, "a", 0, H5T_IEEE_F64LE);
      H5Tinsert(type, "b", 8, H5T_STD_I32LE);
      return type;
    }
    case 6: {
      std::array<hsize_t, 2> const dims{2, 3};
      return H5Tarray_create2(H5T_IEEE_F64LE, 2, dims.data());
    }
    case 7: return H5Tcreate(H5T_OPAQUE, 8);
    default: return H5Tenum_create(H5T_STD_I32LE);
  }
}

/// Small, large, and larger than any file.
hsize_t odd_size(Bytes& in) {
  constexpr std::array<hsize_t, 10> sizes{0, 1, 2, 3, 5, 31, 1000, 1U << 20U, 1U << 28U, 1ULL << 40U};
  std::uint8_t const b = in.byte();
  return b < 200 ? sizes[b % sizes.size()] : b;
}

std::vector<hsize_t> odd_shape(Bytes& in) {
  std::vector<hsize_t> shape(in.byte() % 4);
  for (hsize_t& s : shape) s = odd_size(in);
  return shape;
}

Handle space_of(std::vector<hsize_t> const& shape, bool null) {
  if (null) return {H5Screate(H5S_NULL), H5Sclose};
  if (shape.empty()) return {H5Screate(H5S_SCALAR), H5Sclose};
  return {H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose};
}

/// Changes a number of the part, or all of them.
void spoil(Bytes& in, std::string& bytes) {
  if (bytes.size() < 8) {
    for (char& c : bytes) c = static_cast<char>(in.byte());
    return;
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr std::array<double, 8> values{nan, infinity, -infinity, -1.0, 0.0, 1e308, 5e-324, -0.0};
  std::size_t const at = 8 * (in.value<std::uint16_t>() % (bytes.size() / 8));
  std::uint8_t const what = in.byte();
  double const value = what < 128 ? values[what % values.size()] : in.value<double>();
  std::memcpy(bytes.data() + at, &value, 8);
}

void put_attribute(Bytes& in, hid_t object, char const* name, Part part) {
  std::uint8_t const what = in.byte() % 8;
  bool null = false;
  hid_t own = -1;
  if (what == 1) return;
  if (what == 2) spoil(in, part.bytes);
  if (what == 3) part.shape = odd_shape(in);
  if (what == 4) own = odd_type(in);
  if (what == 5) null = true;
  if (what == 6) {  // a text of its own length
    own = H5Tcopy(H5T_C_S1);
    std::size_t const length = 1U + in.byte() % 40U;
    H5Tset_size(own, length);
    part.bytes.assign(length, '\0');
    for (char& c : part.bytes) c = static_cast<char>(in.byte());
  }
  Handle const type(own >= 0 ? own : H5Tcopy(part.type), H5Tclose);
  if (!null && count_of(part.shape) > 4000) part.shape = {4000};  // the library limits attributes
  Handle const space = space_of(part.shape, null);
  Handle const attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (attribute < 0 || null) return;
  part.bytes.resize(std::max(part.bytes.size(), H5Tget_size(type) * count_of(part.shape)), '\0');
  H5Awrite(attribute, type, part.bytes.data());
}

void put_dataset(Bytes& in, hid_t group, char const* name, Part part, std::string const& names) {
  std::uint8_t const what = in.byte() % 10;
  bool null = false;
  bool empty = false;
  hid_t own = -1;
  if (what == 1) return;
  if (what == 2) spoil(in, part.bytes);
  if (what == 3) {
    part.shape = odd_shape(in);
    empty = true;
  }
  if (what == 4) own = odd_type(in);
  if (what == 5) null = true;
  if (what == 6) empty = true;  // announced, not there
  Handle const creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation, false);
  H5Pset_alloc_time(creation, empty ? H5D_ALLOC_TIME_LATE : H5D_ALLOC_TIME_EARLY);
  bool const whole = !part.shape.empty() && count_of(part.shape) > 0 && count_of(part.shape) < 4000;
  if (what == 7 && whole) {
    H5Pset_chunk(creation, static_cast<int>(part.shape.size()), part.shape.data());
    H5Pset_deflate(creation, 1);
  }
  if (what == 8) H5Pset_external(creation, "/dev/zero", 0, H5F_UNLIMITED);
  if (what == 9 && whole) {
    Handle const from = space_of(part.shape, false);
    H5Pset_virtual(creation, from, ".", "/profile/state", from);
  }
  Handle const type(own >= 0 ? own : H5Tcopy(part.type), H5Tclose);
  Handle const space = space_of(part.shape, null);
  Handle const data(H5Dcreate2(group, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose);
  if (data < 0) return;
  if (!names.empty()) {
    Part text{H5Tcopy(H5T_C_S1), {}, names};
    H5Tset_size(text.type, names.size());
    put_attribute(in, data, "names", text);
    H5Tclose(text.type);
  }
  if (null || empty || what == 8 || what == 9) return;
  part.bytes.resize(std::max(part.bytes.size(), H5Tget_size(type) * count_of(part.shape)), '\0');
  H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, part.bytes.data());
}

Part text(std::string const& value) {
  Part part{H5Tcopy(H5T_C_S1), {}, value};
  H5Tset_size(part.type, std::max<std::size_t>(value.size(), 1));
  return part;
}

/// A profile of its own numbers.
detonation::Profile profile_of(Bytes& in) {
  using grid::Geometry;
  constexpr std::array geometries{Geometry::spherical1d, Geometry::cylindrical1d, Geometry::axisymmetric2d};
  detonation::Profile p;
  p.domain.geometry = geometries[in.byte() % 3];
  p.domain.h = 0.01;
  p.domain.cells = {1 + in.byte() % 5, p.domain.geometry == Geometry::axisymmetric2d ? 1 + in.byte() % 4 : 1, 1};
  p.components = 6 + in.byte() % 4;
  p.domain.boundary.fill(grid::Boundary::symmetry);
  p.time = 1e-4;
  double const step = 0.125 * in.byte();
  for (std::size_t n = 0; n < p.cell_count() * p.components; ++n)
    p.state.push_back(1.0 + step * static_cast<double>(n));
  for (std::size_t n = 0; n < p.cell_count(); ++n) p.pressure.push_back(1e5 + static_cast<double>(n));
  for (int c = 0; c < p.components; ++c) p.ambient.push_back(0.5 * c);
  p.ambient_pressure = 101325.0;
  p.mirrored = in.byte() % 2 != 0;
  p.charge = {"TNT", "sphere", 1.0, 0.05, 0.0, {}};
  for (int n = in.byte() % 3; n > 0; --n) p.charge.initiation.push_back({{0.0, 0.01 * n, 0.0}, 0.0});
  p.constants = {{"explosive energy", 7e9}, {"products jwl.A", 371e9}};
  return p;
}

std::string file_of(Bytes& in) {
  detonation::Profile const p = profile_of(in);
  std::uint32_t sum = 0;
  detonation::Profile copy = p;
  Archive archive([&sum](void const* bytes, std::size_t count) { sum = checksum(bytes, count, sum); });
  copy.archive(archive);

  Handle const access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access, 1U << 16U, false);
  Handle const file(H5Fcreate("fuzz", H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose);
  require(file >= 0);
  auto const put = [&](char const* name, Part const& part) { put_attribute(in, file, name, part); };
  auto const put_text = [&](char const* name, std::string const& value) {
    Part const part = text(value);
    put(name, part);
    H5Tclose(part.type);
  };
  put_text("format", "brisance profile");
  put("version", number(1L));
  put("checksum", number(static_cast<long>(sum)));
  put_text("geometry", word_of(p.domain.geometry));
  put("origin", numbers<double>(H5T_IEEE_F64LE, {0.0, 0.0, 0.0}, {3}));
  put("spacing", number(p.domain.h));
  put("cells", numbers<long>(H5T_STD_I64LE, {p.domain.cells[0], p.domain.cells[1]}, {2}));
  put("components", number(static_cast<long>(p.components)));
  put("time", number(p.time));
  put("ambient_pressure", number(p.ambient_pressure));
  put("mirrored", number(p.mirrored ? 1L : 0L));
  put_text("explosive", p.charge.explosive);
  put_text("charge_shape", p.charge.shape);
  put("charge_mass", number(p.charge.mass));
  put("charge_radius", number(p.charge.radius));
  put("charge_length", number(p.charge.length));

  Handle const group(H5Gcreate2(file, "profile", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  hsize_t const nx = p.domain.cells[0];
  hsize_t const ny = p.domain.cells[1];
  hsize_t const nc = p.components;
  auto const values = [](std::vector<double> const& v, std::vector<hsize_t> shape) {
    return numbers<double>(H5T_IEEE_F64LE, v, std::move(shape));
  };
  put_dataset(in, group, "state", values(p.state, {nc, ny, nx}), "density\nmomentum_x");
  put_dataset(in, group, "pressure", values(p.pressure, {ny, nx}), "");
  put_dataset(in, group, "ambient", values(p.ambient, {nc}), "");
  put_dataset(in, group, "constants", values({7e9, 371e9}, {2}), "explosive energy\nproducts jwl.A");
  std::vector<double> initiation;
  for (auto const& particle : p.charge.initiation)
    initiation.insert(initiation.end(),
                      {particle.position[0], particle.position[1], particle.position[2], particle.delay});
  put_dataset(in, group, "initiation", values(initiation, {p.charge.initiation.size(), 4}), "");

  H5Fflush(file, H5F_SCOPE_GLOBAL);
  ssize_t const size = H5Fget_file_image(file, nullptr, 0);
  require(size > 0);
  std::string image(static_cast<std::size_t>(size), '\0');
  require(H5Fget_file_image(file, image.data(), image.size()) == size);
  return image;
}

void check(detonation::Profile const& p) {
  require(p.cell_count() >= 1 && p.state.size() == p.cell_count() * p.components);
  require(p.pressure.size() == p.cell_count() && p.ambient.size() == static_cast<std::size_t>(p.components));
  require(p.domain.h > 0.0 && std::isfinite(p.domain.h) && p.charge.mass > 0.0 && std::isfinite(p.charge.mass));
  require(p.time >= 0.0 && std::isfinite(p.time));
  require(!std::isnan(p.reach()));
  for (auto const* values : {&p.state, &p.pressure, &p.ambient}) {
    for (double const x : *values) require(std::isfinite(x));
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  if (fuzz::seed_folder() == nullptr) return 0;
  // Nothing but zeros is a good profile; each byte that differs spoils something.
  fuzz::write_seed("good", std::string(64, '\0'));
  for (int at = 0; at < 40; ++at) {
    for (int const what : {1, 2, 3, 4, 6, 8}) {
      std::string bytes(80, '\0');
      bytes[static_cast<std::size_t>(at)] = static_cast<char>(what);
      fuzz::write_seed("spoilt_" + std::to_string(at) + "_" + std::to_string(what), bytes);
    }
  }
  std::exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  static fuzz::MemoryFile file;
  static bool first = true;
  Bytes in(data, size);
  file.set(file_of(in));
  try {
    check(output::read_profile(file.path()));
  } catch (IoError const& error) {
    require(std::strlen(error.what()) > 0);
  }
  if (first) {
    // The fuzzer would test nothing if what it takes for good were not.
    first = false;
    Bytes nothing(nullptr, 0);
    file.set(file_of(nothing));
    check(output::read_profile(file.path()));
  }
  return 0;
}
