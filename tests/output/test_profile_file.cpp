// Profiles on the disk come back bit for bit, or not at all.
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.hpp"
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
  p.components = gas::two_fluid_components;
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
  EXPECT_NE(problem_of(path).find("it is damaged or no HDF5 file"), std::string::npos) << problem_of(path);
  // One bit of a number: 1/3 of the pressures.
  double const number = 1e5 / 3.0;
  std::size_t const at = good.find(std::string(reinterpret_cast<char const*>(&number), sizeof number));
  ASSERT_NE(at, std::string::npos);
  std::string damaged = good;
  damaged[at] ^= 1;
  write_file(path, damaged);
  EXPECT_NE(problem_of(path).find("its data are damaged: checksum"), std::string::npos) << problem_of(path);
}

}  // namespace
}  // namespace brisance::output
