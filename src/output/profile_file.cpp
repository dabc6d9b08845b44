#include "output/profile_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/archive.hpp"
#include "core/error.hpp"
#include "output/dump_file.hpp"
#include "output/file.hpp"
#include "output/manifest.hpp"
#include "run/system.hpp"
#include "setup/profile_fit.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

constexpr char const* format_name = "brisance profile";
constexpr long format_version = 1;
constexpr long most_cells = 1L << 26U;
constexpr long most_components = 32;
constexpr std::size_t most_constants = 1000;
constexpr std::size_t most_particles = 100000;  // of initiation

constexpr std::array<char const*, gas::components_of(gas::most_fluids)> component_names{
    "density", "momentum_x", "momentum_y", "momentum_z", "energy", "shock", "second_density", "volume_fraction"};

std::uint32_t checksum_of(detonation::Profile profile) {
  std::uint32_t sum = 0;
  Archive archive([&sum](void const* bytes, std::size_t count) { sum = checksum(bytes, count, sum); });
  profile.archive(archive);
  return sum;
}

void write_values(DumpFile& file, std::string const& name, std::vector<hsize_t> const& shape,
                  std::vector<double> const& values, std::string const& unit, std::string const& meaning,
                  std::string const& names = "") {
  DumpFile::Layout layout;
  layout.shape = shape;
  layout.edge = shape;
  layout.type = NumberType::float64;
  layout.compression = 0;
  auto const data = file.dataset(name, layout, unit, meaning);
  if (!names.empty()) file.attribute(data.id(), "names", names);
  if (!values.empty()) data.write(std::vector<hsize_t>(shape.size(), 0), shape, values.data());
}

/// An open profile; every failure is told as one of the file.
class Reader {
 public:
  explicit Reader(fs::path const& path) : path_(path), file_(open(path), H5Fclose) {
    std::error_code error;
    size_ = fs::file_size(path, error);
    if (error) throw_io_error("read", path, error.value());
  }

  [[noreturn]] void refuse(std::string const& why) const { refuse(path_, why); }
  [[noreturn]] static void refuse(fs::path const& path, std::string const& why) {
    throw IoError(fmt::format("the profile \"{}\" cannot be used: {}", path.string(), why));
  }

  [[nodiscard]] std::string text(hid_t object, char const* name) const {
    Handle const attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
    if (attribute < 0) missing(name);
    Handle const type(H5Aget_type(attribute), H5Tclose);
    Handle const space(H5Aget_space(attribute), H5Sclose);
    std::size_t const size = H5Tget_size(type);
    constexpr std::size_t longest = 65536;
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 || size > longest ||
        H5Sget_simple_extent_npoints(space) != 1) {
      missing(name);
    }
    std::string value(size, '\0');
    if (H5Aread(attribute, type, value.data()) < 0) missing(name);
    value.resize(value.find('\0') == std::string::npos ? size : value.find('\0'));
    return value;
  }
  template <class T, std::size_t n>
  void numbers(char const* name, std::array<T, n>& values) const {
    Handle const attribute(H5Aopen(file_, name, H5P_DEFAULT), H5Aclose);
    if (attribute < 0) missing(name);
    Handle const space(H5Aget_space(attribute), H5Sclose);
    if (H5Sget_simple_extent_npoints(space) != static_cast<hssize_t>(n)) missing(name);
    hid_t const type = std::is_same_v<T, double> ? H5T_NATIVE_DOUBLE : H5T_NATIVE_LONG;
    if (H5Aread(attribute, type, values.data()) < 0) missing(name);
  }
  template <class T>
  [[nodiscard]] T number(char const* name) const {
    std::array<T, 1> value{};
    numbers(name, value);
    return value[0];
  }
  /// A number that is not negative.
  [[nodiscard]] double amount(char const* name) const {
    auto const value = number<double>(name);
    if (!(value >= 0.0 && std::isfinite(value))) missing(name);
    return value;
  }
  /// The values of a dataset, at least and at most so many, and the attribute `names` where that is asked for. All of
  /// them must be numbers, and lie in the file as they are: what a dataset announces beyond that, what other files hold
  /// and what would have to be unpacked is not read.
  std::vector<double> values(char const* name, std::size_t least, std::size_t most,
                             std::string* names = nullptr) const {
    Handle const data(H5Dopen2(file_, fmt::format("/profile/{}", name).c_str(), H5P_DEFAULT), H5Dclose);
    if (data < 0) missing(name);
    Handle const space(H5Dget_space(data), H5Sclose);
    Handle const type(H5Dget_type(data), H5Tclose);
    Handle const layout(H5Dget_create_plist(data), H5Pclose);
    hssize_t const count = H5Sget_simple_extent_npoints(space);
    if (count < 0 || static_cast<std::size_t>(count) < least || static_cast<std::size_t>(count) > most) missing(name);
    if (H5Tget_class(type) != H5T_FLOAT || H5Tget_size(type) != sizeof(double)) missing(name);
    bool const elsewhere = H5Pget_layout(layout) == H5D_VIRTUAL || H5Pget_external_count(layout) != 0;
    bool const packed = H5Pget_nfilters(layout) != 0;
    std::uint64_t const bytes = sizeof(double) * static_cast<std::uint64_t>(count);
    if (elsewhere || packed || bytes > size_ || H5Dget_storage_size(data) < bytes) missing(name);
    std::vector<double> out(static_cast<std::size_t>(count));
    if (count > 0 && H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()) < 0) missing(name);
    if (!std::all_of(out.begin(), out.end(), [](double x) { return std::isfinite(x); })) missing(name);
    if (names != nullptr) *names = text(data, "names");
    return out;
  }
  [[nodiscard]] hid_t root() const { return file_; }

 private:
  static hid_t open(fs::path const& path) {
    if (!fs::exists(path)) throw IoError(fmt::format("the profile \"{}\" does not exist", path.string()));
    std::error_code error;
    if (!fs::is_regular_file(path, error)) refuse(path, "it is not a regular file");
    hid_t const file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    if (file < 0) refuse(path, "it is damaged or not an HDF5 file");
    return file;
  }
  [[noreturn]] void missing(char const* name) const {
    refuse(fmt::format("it does not contain a valid \"{}\": it is damaged or not a profile", name));
  }

  QuietHdf5 quiet_;
  fs::path path_;
  Handle file_;
  std::uint64_t size_ = 0;  ///< of the file [bytes]
};

}  // namespace

void write_profile(fs::path const& path, detonation::Profile const& p) {
  QuietHdf5 const quiet;
  DumpFile file(p.state.size() * sizeof(double), "profile");
  hid_t const root = file.root();
  file.attribute(root, "format", std::string(format_name));
  file.attribute(root, "version", std::array{format_version});
  file.attribute(root, "checksum", std::array{static_cast<long>(checksum_of(p))});
  file.attribute(root, "geometry", std::string(word_of(p.domain.geometry)));
  file.attribute(root, "origin", p.domain.lower);
  file.attribute(root, "spacing", std::array{p.domain.h});
  file.attribute(root, "cells", std::array<long, 2>{p.domain.cells[0], p.domain.cells[1]});
  file.attribute(root, "components", std::array{static_cast<long>(p.components)});
  file.attribute(root, "time", std::array{p.time});
  file.attribute(root, "ambient_pressure", std::array{p.ambient_pressure});
  file.attribute(root, "mirrored", std::array{p.mirrored ? 1L : 0L});
  file.attribute(root, "explosive", p.charge.explosive);
  file.attribute(root, "charge_shape", p.charge.shape);
  file.attribute(root, "charge_mass", std::array{p.charge.mass});
  file.attribute(root, "charge_radius", std::array{p.charge.radius});
  file.attribute(root, "charge_length", std::array{p.charge.length});

  std::string components;
  for (int c = 0; c < p.components; ++c) {
    auto const known = static_cast<std::size_t>(c) < component_names.size();
    if (c > 0) components += '\n';
    components += known ? std::string(component_names[c]) : fmt::format("component_{}", c);
  }
  hsize_t const nx = p.domain.cells[0];
  hsize_t const ny = p.domain.cells[1];
  hsize_t const nc = p.components;
  write_values(file, "state", {nc, ny, nx}, p.state, "SI", "conserved components per volume", components);
  write_values(file, "pressure", {ny, nx}, p.pressure, "Pa", "absolute pressure");
  write_values(file, "ambient", {nc}, p.ambient, "SI", "components of the surrounding gas");
  std::vector<double> constants;
  std::string names;
  for (auto const& constant : p.constants) {
    constants.push_back(constant.value);
    if (!names.empty()) names += '\n';
    names += constant.name;
  }
  write_values(file, "constants", {constants.size()}, constants, "SI",
               "of the explosive, its products and the ambient gas", names);
  std::vector<double> initiation;
  for (auto const& particle : p.charge.initiation) {
    initiation.insert(initiation.end(), particle.position.begin(), particle.position.end());
    initiation.push_back(particle.delay);
  }
  write_values(file, "initiation", {p.charge.initiation.size(), 4}, initiation, "SI",
               "position relative to the charge's centre, and delay");
  fs::path const part = path.string() + ".part";
  file.write(part);
  rename_file(part, path);
}

detonation::Profile read_profile(fs::path const& path) {
  Reader const file(path);
  if (H5Aexists(file.root(), "format") <= 0 || file.text(file.root(), "format") != format_name)
    file.refuse("it is not a profile of a blast wave");
  if (auto const version = file.number<long>("version"); version != format_version) {
    file.refuse(
        fmt::format("it has format {}, but this program reads format {}: compute it again", version, format_version));
  }
  detonation::Profile p;
  std::string const geometry = file.text(file.root(), "geometry");
  bool known = false;
  for (auto const g : {grid::Geometry::spherical1d, grid::Geometry::cylindrical1d, grid::Geometry::axisymmetric2d}) {
    if (geometry != word_of(g)) continue;
    p.domain.geometry = g;
    known = true;
  }
  std::array<long, 2> cells{};
  file.numbers("cells", cells);
  long const components = file.number<long>("components");
  if (!known || cells[0] < 1 || cells[1] < 1 || cells[0] > most_cells || cells[1] > most_cells / cells[0] ||
      (p.domain.geometry != grid::Geometry::axisymmetric2d && cells[1] != 1) || components < 1 ||
      components > most_components) {
    file.refuse("its description of the cells is damaged");
  }
  p.domain.cells = {static_cast<int>(cells[0]), static_cast<int>(cells[1]), 1};
  p.domain.boundary.fill(grid::Boundary::symmetry);
  p.components = static_cast<int>(components);
  file.numbers("origin", p.domain.lower);
  if (!std::all_of(p.domain.lower.begin(), p.domain.lower.end(), [](double x) { return std::isfinite(x); }))
    file.refuse("its description of the cells is damaged");
  p.domain.h = file.amount("spacing");
  p.time = file.amount("time");
  p.ambient_pressure = file.amount("ambient_pressure");
  p.mirrored = file.number<long>("mirrored") != 0;
  p.charge.explosive = file.text(file.root(), "explosive");
  p.charge.shape = file.text(file.root(), "charge_shape");
  p.charge.mass = file.amount("charge_mass");
  p.charge.radius = file.amount("charge_radius");
  p.charge.length = file.amount("charge_length");
  std::size_t const count = p.cell_count();
  p.state = file.values("state", count * p.components, count * p.components);
  p.pressure = file.values("pressure", count, count);
  p.ambient = file.values("ambient", p.components, p.components);
  std::string names;
  std::vector<double> const constants = file.values("constants", 0, most_constants, &names);
  std::vector<double> const initiation = file.values("initiation", 0, 4 * most_particles);
  std::size_t at = 0;
  for (double const value : constants) {
    std::size_t const end = std::min(names.find('\n', at), names.size());
    p.constants.push_back({names.substr(at, end - at), value});
    at = std::min(end + 1, names.size());
  }
  for (std::size_t n = 0; n + 4 <= initiation.size(); n += 4)
    p.charge.initiation.push_back({{initiation[n], initiation[n + 1], initiation[n + 2]}, initiation[n + 3]});
  std::uint32_t const sum = checksum_of(p);
  if (auto const said = file.number<long>("checksum"); said != static_cast<long>(sum))
    file.refuse(fmt::format("its data are damaged: checksum {:08x}, stored checksum {:08x}", sum, said));
  if (p.state.size() != p.cell_count() * p.components || p.pressure.size() != p.cell_count() ||
      p.ambient.size() != static_cast<std::size_t>(p.components) || !(p.domain.h > 0.0) || !(p.charge.mass > 0.0)) {
    file.refuse("its parts are inconsistent");
  }
  return p;
}

namespace {

void write_listed(fs::path const& folder, std::string const& name, detonation::Profile const& profile) {
  make_folder(folder / "profiles");
  list_files(folder, {name});
  write_profile(folder / name, profile);
}

}  // namespace

void write_start_profiles(run::System const& system, fs::path const& folder) {
  auto const& profiles = system.setup.start.profiles;
  for (std::size_t n = 0; n < profiles.size(); ++n) {
    bool known = false;
    for (std::size_t other = 0; other < n; ++other) known = known || profiles[other] == profiles[n];
    if (known) continue;
    write_listed(folder, fmt::format("profiles/start_{}.h5", n + 1), *profiles[n]);
  }
}

void write_end_profile(run::System const& system, fs::path const& folder) {
  write_listed(folder, "profiles/end.h5", setup::profile_of(system));
}

}  // namespace brisance::output
