// Profiles on the disk come back bit for bit, or not at all.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/stat.h>

#include <array>
#include <cmath>
#include <fstream>

#include "core/error.hpp"
#include "output/dump_file.hpp"
#include "output/file.hpp"
#include "output/profile_file.hpp"
#include "scratch.hpp"

namespace brisance::output {
namespace {

namespace fs = std::filesystem;

detonation::Profile made_up() {
  detonation::Profile p;
  p.domain.geometry = grid::Geometry::axisymmetric2d;
  p.domain.lower = {0.0, -0.125, 0.0};
  p.domain.h = 0.1 / 3.0;
  p.domain.cells = {3, 4, 1};
  p.domain.boundary.fill(grid::Boundary::symmetry);
  p.time = 1.0 / 7.0;
  p.components = gas::components_of(2);
  for (std::size_t n = 0; n < p.cell_count() * p.components; ++n)
    p.state.push_back(1.0 / (1.0 + static_cast<double>(n)));
  for (std::size_t n = 0; n < p.cell_count(); ++n) p.pressure.push_back(1e5 / 3.0 * static_cast<double>(n));
  for (int c = 0; c < p.components; ++c) p.ambient.push_back(0.1 * c);
  p.ambient_pressure = 101325.0;
  p.mirrored = true;
  p.charge = {"TNT", "cylinder", 2.0 / 3.0, 0.05, 0.1, {{{0.0, 0.05, 0.0}, 1e-6}, {{0.01, -0.05, 0.0}, 0.0}}};
  p.constants = {{"explosive energy", 6.993e9}, {"products jwl.A", 371.2e9}};
  return p;
}

std::string problem_of(fs::path const& path) {
  try {
    (void)read_profile(path);
  } catch (IoError const& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ProfileFile, ComesBackBitForBit) {
  test::ScratchFolder const folder;
  fs::path const path = folder.path() / "p.h5";
  detonation::Profile const p = made_up();
  write_profile(path, p);
  detonation::Profile const q = read_profile(path);
  EXPECT_EQ(q.domain.geometry, p.domain.geometry);
  EXPECT_EQ(q.domain.lower, p.domain.lower);
  EXPECT_EQ(q.domain.h, p.domain.h);
  EXPECT_EQ(q.domain.cells, p.domain.cells);
  EXPECT_EQ(q.time, p.time);
  EXPECT_EQ(q.components, p.components);
  EXPECT_EQ(q.state, p.state);
  EXPECT_EQ(q.pressure, p.pressure);
  EXPECT_EQ(q.ambient, p.ambient);
  EXPECT_EQ(q.ambient_pressure, p.ambient_pressure);
  EXPECT_EQ(q.mirrored, p.mirrored);
  EXPECT_EQ(q.charge.explosive, p.charge.explosive);
  EXPECT_EQ(q.charge.shape, p.charge.shape);
  EXPECT_EQ(q.charge.mass, p.charge.mass);
  EXPECT_EQ(q.charge.radius, p.charge.radius);
  EXPECT_EQ(q.charge.length, p.charge.length);
  ASSERT_EQ(q.charge.initiation.size(), 2U);
  EXPECT_EQ(q.charge.initiation[1].position, p.charge.initiation[1].position);
  EXPECT_EQ(q.charge.initiation[0].delay, 1e-6);
  ASSERT_EQ(q.constants.size(), 2U);
  EXPECT_EQ(q.constants[1].name, "products jwl.A");
  EXPECT_EQ(q.constants[1].value, 371.2e9);
  detonation::Profile burnt_at_once = p;
  burnt_at_once.charge.initiation.clear();
  write_profile(path, burnt_at_once);
  EXPECT_TRUE(read_profile(path).charge.initiation.empty());
}

TEST(ProfileFile, DamageIsRefused) {
  test::ScratchFolder const folder;
  fs::path const path = folder.path() / "p.h5";
  EXPECT_NE(problem_of(path).find("does not exist"), std::string::npos);
  write_profile(path, made_up());
  std::string const good = read_file(path);
  write_file(path, good.substr(0, good.size() / 2));
  EXPECT_NE(problem_of(path).find("cannot be used: it"), std::string::npos) << problem_of(path);
  write_file(path, "no profile at all");
  EXPECT_NE(problem_of(path).find("it is damaged or not an HDF5 file"), std::string::npos) << problem_of(path);
  // One bit of a number: 1/3 of the pressures.
  double const number = 1e5 / 3.0;
  std::size_t const at = good.find(std::string(reinterpret_cast<char const*>(&number), sizeof number));
  ASSERT_NE(at, std::string::npos);
  std::string damaged = good;
  damaged[at] ^= 1;
  write_file(path, damaged);
  EXPECT_NE(problem_of(path).find("its data are damaged: checksum"), std::string::npos) << problem_of(path);
}

/// Puts an attribute in the place of one of the file's own.
void replace_attribute(fs::path const& path, char const* name, hid_t type, std::vector<hsize_t> const& shape,
                       void const* values) {
  Handle const file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  H5Adelete(file, name);
  Handle const space(
      shape.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
      H5Sclose);
  Handle const attribute(H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  ASSERT_GE(H5Awrite(attribute, type, values), 0);
}

/// A dataset of doubles in the place of one of the file's own; `prepare` sets its properties. Nothing is written to it.
template <class Prepare>
void replace_dataset(fs::path const& path, char const* name, std::vector<hsize_t> const& shape, Prepare&& prepare) {
  Handle const file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  H5Ldelete(file, name, H5P_DEFAULT);
  Handle const creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  prepare(creation);
  Handle const space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  Handle const data(H5Dcreate2(file, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose);
  ASSERT_GE(data, 0);
}

// A file that is sound as HDF5 and is no profile: refused before it becomes memory.
TEST(ProfileFile, WhatIsNoProfileIsRefused) {
  QuietHdf5 const quiet;
  test::ScratchFolder const folder;
  fs::path const path = folder.path() / "p.h5";
  auto const expect = [&](char const* words) {
    std::string const why = problem_of(path);
    EXPECT_NE(why.find(words), std::string::npos) << "\"" << why << "\" does not say " << words;
    write_profile(path, made_up());
  };
  write_profile(path, made_up());
  // Three texts where one stands.
  Handle const text(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(text, 16);
  std::string const three("brisance profilebrisance profilebrisance profile");
  replace_attribute(path, "format", text, {3}, three.data());
  expect("a valid \"format\"");
  for (char const* name : {"spacing", "time", "charge_mass", "ambient_pressure", "charge_radius"}) {
    for (double const value : {-1.0, std::nan(""), HUGE_VAL}) {
      replace_attribute(path, name, H5T_IEEE_F64LE, {}, &value);
      expect(name);
    }
  }
  std::array<double, 3> const nowhere{0.0, std::nan(""), 0.0};
  replace_attribute(path, "origin", H5T_IEEE_F64LE, {3}, nowhere.data());
  expect("description of the cells");
  // Two gigabytes that a file of some kilobytes announces; numbers of other files; packed ones.
  std::array<long, 2> const many{1L << 13U, 1L << 13U};
  replace_attribute(path, "cells", H5T_STD_I64LE, {2}, many.data());
  replace_dataset(path, "/profile/state", {8, 1U << 13U, 1U << 13U}, [](hid_t) {});
  expect("a valid \"state\"");
  replace_dataset(path, "/profile/state", {8, 4, 3}, [](hid_t) {});
  expect("a valid \"state\"");
  replace_dataset(path, "/profile/pressure", {4, 3},
                  [](hid_t creation) { H5Pset_external(creation, "/dev/zero", 0, H5F_UNLIMITED); });
  expect("a valid \"pressure\"");
  replace_dataset(path, "/profile/pressure", {4, 3}, [](hid_t creation) {
    std::array<hsize_t, 2> const chunk{4, 3};
    H5Pset_chunk(creation, 2, chunk.data());
    H5Pset_deflate(creation, 1);
  });
  expect("a valid \"pressure\"");
  replace_dataset(path, "/profile/constants", {100000}, [](hid_t) {});
  expect("a valid \"constants\"");
  // Numbers that are none, with a checksum that fits.
  detonation::Profile p = made_up();
  p.state[5] = std::nan("");
  write_profile(path, p);
  expect("a valid \"state\"");
  // A radial profile has one row; here it says four.
  p = made_up();
  p.domain.geometry = grid::Geometry::spherical1d;
  write_profile(path, p);
  expect("description of the cells");
  fs::remove(path);
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_NE(problem_of(path).find("it is not a regular file"), std::string::npos);
  fs::remove(path);
}

}  // namespace
}  // namespace brisance::output
