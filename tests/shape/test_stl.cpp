// STL files and the meshes in them: good ones, and every kind of broken one.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <random>

#include "core/error.hpp"
#include "meshes.hpp"
#include "shape/shape.hpp"
#include "shape/stl.hpp"

using namespace brisance;
using namespace brisance::shape;

namespace {

class Stl : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "brisance-stl-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(std::string const& bytes) {
    auto const file = folder_ / "body.stl";
    std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
    return file;
  }

  /// The message with which a file is refused; empty when it is not.
  std::string refusal(std::string const& bytes) {
    auto const file = write(bytes);
    try {
      (void)read_stl(file);
    } catch (InputError const& error) {
      std::string const message = error.what();
      EXPECT_NE(message.find(file.string()), std::string::npos) << message;
      return message;
    }
    return "";
  }

  std::filesystem::path folder_;
};

std::string binary(std::vector<Vec3> const& corners, std::string header = "exported") {
  header.resize(80, ' ');
  std::string bytes = header;
  auto const add = [&](auto value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
  };
  add(static_cast<std::uint32_t>(corners.size() / 3));
  for (std::size_t n = 0; n < corners.size(); n += 3) {
    for (int d = 0; d < 3; ++d) add(0.0F);
    for (std::size_t c = n; c < n + 3; ++c) {
      for (double const x : corners[c]) add(static_cast<float>(x));
    }
    add(std::uint16_t{0});
  }
  return bytes;
}

std::string ascii(std::vector<Vec3> const& corners) {
  std::string text = "solid some name of a part\n";
  for (std::size_t n = 0; n < corners.size(); n += 3) {
    text += "  facet normal 0 0 0\n    outer loop\n";
    for (std::size_t c = n; c < n + 3; ++c) {
      char line[120];
      std::snprintf(line, sizeof line, "      vertex %.9e %.9e %.9e\n", corners[c][0], corners[c][1], corners[c][2]);
      text += line;
    }
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid some name of a part\n";
}

std::vector<Vec3> const unit_cube = test::cube({0.0, 0.0, 0.0}, {1.0, 1.0, 1.0});

bool mentions(std::string const& message, std::string const& words) { return message.find(words) != std::string::npos; }

}  // namespace

TEST_F(Stl, AsciiAndBinaryGiveTheSameBody) {
  std::string shouted = ascii(unit_cube);
  shouted.replace(0, 5, "\r\n SOLID");
  for (std::string const& bytes :
       {binary(unit_cube), ascii(unit_cube), binary(unit_cube, "solid cube, says the writer"), shouted}) {
    Mesh const cube = read_stl(write(bytes));
    EXPECT_EQ(cube.triangle_count(), 12U);
    EXPECT_DOUBLE_EQ(cube.volume(), 1.0);
    EXPECT_EQ(cube.upper(), (Vec3{1.0, 1.0, 1.0}));
    EXPECT_TRUE(cube.contains({0.5, 0.25, 0.25}));
    EXPECT_FALSE(cube.contains({1.1, 0.25, 0.25}));
  }
}

TEST_F(Stl, ScaleAndTranslation) {
  Mesh const cube =
      read_stl(write(binary(test::cube({-500.0, 0.0, 0.0}, {500.0, 200.0, 100.0}))), 0.001, {1.0, 2.0, 3.0});
  EXPECT_NEAR(cube.volume(), 0.02, 1e-15);
  for (int d = 0; d < 3; ++d) EXPECT_NEAR(cube.centre()[d], (Vec3{1.0, 2.1, 3.05})[d], 1e-14);
  // As large as the moments of a volume can be told, and larger.
  Mesh const vast = read_stl(write(binary(unit_cube)), 1e60);
  for (int d = 0; d < 3; ++d) EXPECT_NEAR(vast.centre()[d] / 5e59, 1.0, 1e-14);
  EXPECT_THROW((void)read_stl(write(binary(unit_cube)), 1e61), InputError);
  EXPECT_THROW((void)read_stl(write(binary(unit_cube)), 0.0), InputError);
  EXPECT_THROW((void)read_stl(write(binary(unit_cube)), -1.0), InputError);
  EXPECT_THROW((void)read_stl(write(binary(unit_cube)), std::numeric_limits<double>::quiet_NaN()), InputError);
}

TEST_F(Stl, LinesThroughEdgesAndVertices) {
  // Every line of this lattice meets edges or vertices of the ball.
  int const n = 16;
  Mesh const ball = read_stl(write(binary(test::ball({0.0, 0.0, 0.0}, 1.0, n))));
  std::vector<Span> line;
  for (std::size_t c = 0; c < test::ball({}, 1.0, n).size(); ++c) {
    Vec3 const v = test::ball({}, 1.0, n)[c];
    double const y = static_cast<float>(v[1]);
    double const z = static_cast<float>(v[2]);
    if (y * y + z * z > 0.9) continue;
    ball.spans(y, z, line);
    ASSERT_EQ(line.size(), 1U) << y << " " << z;
    // The sagitta of a facet of 2 pi / 32.
    EXPECT_NEAR(line[0].to, std::sqrt(1.0 - y * y - z * z), 0.03);
    EXPECT_NEAR(line[0].from, -line[0].to, 0.03);
    EXPECT_TRUE(ball.contains({0.0, y, z}));
    EXPECT_FALSE(ball.contains({1.1, y, z}));
  }
  EXPECT_TRUE(ball.contains({0.0, 0.0, 0.0}));
}

TEST_F(Stl, ShellsAndCavities) {
  auto with_cavity = unit_cube;
  auto cavity = test::cube({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75});
  auto const outwards = cavity;
  for (std::size_t n = 0; n < cavity.size(); n += 3) std::swap(cavity[n], cavity[n + 1]);
  with_cavity.insert(with_cavity.end(), cavity.begin(), cavity.end());
  Mesh const hollow = read_stl(write(binary(with_cavity)));
  EXPECT_DOUBLE_EQ(hollow.volume(), 1.0 - 0.125);
  EXPECT_FALSE(hollow.contains({0.5, 0.5, 0.5}));
  EXPECT_TRUE(hollow.contains({0.1, 0.5, 0.5}));

  auto doubled = unit_cube;
  doubled.insert(doubled.end(), outwards.begin(), outwards.end());
  EXPECT_TRUE(mentions(refusal(binary(doubled)), "around (0.5, 0.5, 0.5) m lies wholly inside another"));

  auto turned = unit_cube;
  for (std::size_t n = 0; n < turned.size(); n += 3) std::swap(turned[n], turned[n + 1]);
  Mesh const inside_out = read_stl(write(binary(turned)));
  EXPECT_DOUBLE_EQ(inside_out.volume(), 1.0);
  EXPECT_TRUE(inside_out.contains({0.5, 0.3, 0.4}));
}

TEST_F(Stl, ShellsThatOverlapAreOneBody) {
  auto both = unit_cube;
  for (Vec3 const& x : test::cube({0.5, 0.5, 0.5}, {2.0, 0.75, 0.75})) both.push_back(x);
  Mesh const cross = read_stl(write(binary(both)));
  EXPECT_TRUE(cross.overlaps());
  EXPECT_NEAR(volume(cross, grid::Geometry::cartesian3d), 1.0 + 0.0625, 1e-5);
  std::vector<Span> line;
  cross.spans(0.6, 0.6, line);
  ASSERT_EQ(line.size(), 1U);
  EXPECT_EQ(line[0].to, 2.0);
  // A corner that only just reaches in.
  both = unit_cube;
  for (Vec3 const& x : test::cube({0.99, 0.99, 0.99}, {2.0, 2.0, 2.0})) both.push_back(x);
  Mesh const corner = read_stl(write(binary(both)));
  EXPECT_TRUE(corner.overlaps());
  EXPECT_NEAR(volume(corner, grid::Geometry::cartesian3d), 1.0 + 1.01 * 1.01 * 1.01 - 1e-6, 1e-5);
  // One that touches it is another shell, and nothing overlaps.
  both = unit_cube;
  for (Vec3 const& x : test::cube({1.0, 0.25, 0.25}, {2.0, 0.75, 0.75})) both.push_back(x);
  EXPECT_FALSE(read_stl(write(binary(both))).overlaps());
  // An overlapping shell that is inside out takes nothing away: it is refused.
  auto turned = test::cube({0.5, 0.25, 0.25}, {2.0, 0.75, 0.75});
  for (std::size_t n = 0; n < turned.size(); n += 3) std::swap(turned[n], turned[n + 1]);
  both = unit_cube;
  both.insert(both.end(), turned.begin(), turned.end());
  EXPECT_TRUE(mentions(refusal(binary(both)), "inside out"));
}

TEST_F(Stl, CornersMeantToBeOneCloseTheSurface) {
  for (double const apart : {0.4e-6, 1e-4}) {
    auto corners = test::ball({0.0, 0.0, 0.0}, 0.5, 12);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> jitter(-0.5 * apart, 0.5 * apart);
    for (Vec3& x : corners) x = x + Vec3{jitter(random), jitter(random), jitter(random)};
    if (apart < 1e-6) {
      EXPECT_EQ(Mesh(corners, "ball").triangle_count(), 2U * 24U * 11U);
    } else {
      EXPECT_THROW(Mesh(corners, "ball"), InputError);
    }
  }
}

TEST_F(Stl, CornersRoundedEachByItself) {
  auto corners = test::ball({10.0, 20.0, 30.0}, 1.0, 12);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jitter(-1e-6, 1e-6);  // half a unit of single precision at 30
  for (Vec3& x : corners) x = x + Vec3{jitter(random), jitter(random), jitter(random)};
  Mesh const ball(corners, "ball");
  EXPECT_EQ(ball.triangle_count(), 2U * 24U * 11U);
  EXPECT_NEAR(ball.volume() / Mesh(test::ball({}, 1.0, 12), "ball").volume(), 1.0, 1e-5);
}

TEST_F(Stl, BrokenFilesAreRefusedWithTheReason) {
  EXPECT_THROW((void)read_stl(folder_ / "missing.stl"), InputError);
  EXPECT_THROW((void)read_stl(folder_), InputError);
  EXPECT_TRUE(mentions(refusal(""), "too few"));
  EXPECT_TRUE(mentions(refusal("<html>not found</html>"), "too few"));
  EXPECT_TRUE(mentions(refusal(binary({})), "no triangles"));
  EXPECT_TRUE(mentions(refusal("solid nothing\nendsolid nothing\n"), "no triangles"));

  std::string const whole = binary(unit_cube);
  EXPECT_TRUE(mentions(refusal(whole.substr(0, whole.size() - 60)), "declares 12 triangles but contains 10"));
  std::string huge = whole;
  for (int n = 80; n < 84; ++n) huge[n] = static_cast<char>(0xff);
  EXPECT_TRUE(mentions(refusal(huge), "declares 4294967295 triangles"));

  std::string const text = ascii(unit_cube);
  std::size_t const seventh = text.rfind("  facet", text.size() / 2);
  EXPECT_TRUE(mentions(refusal(text.substr(0, seventh + 60)), "it is truncated"));
  EXPECT_TRUE(mentions(refusal(text.substr(0, seventh)), "not closed"));  // between two facets
  std::string wrong = text;
  wrong.replace(wrong.find("vertex"), 6, "vertix");
  EXPECT_TRUE(mentions(refusal(wrong), "line 4: found \"vertix\", expected \"vertex\""));
  wrong = text;
  wrong.replace(wrong.find("0.000000000e+00"), 15, "zero           ");
  EXPECT_TRUE(mentions(refusal(wrong), "expected a number"));

  auto corners = unit_cube;
  corners.resize(corners.size() - 3);
  EXPECT_TRUE(mentions(refusal(binary(corners)), "not closed: 3 open edges, the first at ("));
  EXPECT_TRUE(mentions(refusal(ascii(corners)), "not closed: 3 open edges"));
  corners = unit_cube;
  std::swap(corners[0], corners[1]);
  EXPECT_TRUE(mentions(refusal(binary(corners)), "opposite orientations at 3 edges"));
  corners = unit_cube;
  corners.insert(corners.end(), unit_cube.begin(), unit_cube.begin() + 3);
  EXPECT_TRUE(mentions(refusal(binary(corners)), "shared by more than two"));
  corners = unit_cube;
  for (double const bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    corners[4][1] = bad;
    EXPECT_TRUE(mentions(refusal(binary(corners)), "triangle 2 has a coordinate that is not a number"));
  }
  EXPECT_TRUE(mentions(refusal(binary(test::cube({0.0, 0.0, 0.0}, {1.0, 1.0, 0.0}))), "no volume") ||
              mentions(refusal(binary(test::cube({0.0, 0.0, 0.0}, {1.0, 1.0, 0.0}))), "more than two"));
  // A triangle and its back: closed, consistent, flat.
  std::vector<Vec3> const flat{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0},
                               {0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}};
  EXPECT_TRUE(mentions(refusal(binary(flat)), "no volume"));
  EXPECT_TRUE(mentions(refusal(binary({{1.0, 1.0, 1.0}, {1.0, 1.0, 1.0}, {1.0, 1.0, 1.0}})), "points or lines"));
}

TEST_F(Stl, RandomDamageNeverDoesMoreThanThrow) {
  std::mt19937 random(11);
  std::vector<std::string> const seeds{binary(test::ball({}, 1.0, 4)), ascii(test::ball({}, 1.0, 4)),
                                       binary(unit_cube, "solid"), ascii(unit_cube)};
  int refused = 0;
  for (int n = 0; n < 1200; ++n) {
    std::string bytes = seeds[n % seeds.size()];
    int const damage = 1 + static_cast<int>(random() % 6);
    for (int d = 0; d < damage; ++d) {
      std::size_t const at = random() % bytes.size();
      switch (random() % 4) {
        case 0: bytes[at] = static_cast<char>(random()); break;
        case 1: bytes.resize(at + 1); break;
        case 2: bytes.insert(at, bytes, random() % bytes.size(), 60); break;
        default: bytes.erase(at, 1 + random() % 60); break;
      }
      if (bytes.empty()) bytes.resize(1);
    }
    if (n % 10 == 0) {
      bytes.resize(random() % 3000);
      for (char& c : bytes) c = static_cast<char>(random());
    }
    refused += refusal(bytes).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, 900);
}

TEST_F(Stl, MeshesMeasureTheirVolumeExactly) {
  auto const corners = test::ball({3.0, -2.0, 7.0}, 0.5, 20);
  Mesh const ball(corners, "ball");
  // The polyhedron of parallels and meridians, ring by ring (prismatoid formula).
  int const n = 20;
  double const area = n * std::sin(std::numbers::pi / n);  // of the unit polygon with 2 n corners
  double exact = 0.0;
  for (int i = 0; i < n; ++i) {
    double const z0 = std::cos(std::numbers::pi * i / n);
    double const z1 = std::cos(std::numbers::pi * (i + 1) / n);
    double const r0 = std::sin(std::numbers::pi * i / n);
    double const r1 = std::sin(std::numbers::pi * (i + 1) / n);
    exact += (z0 - z1) / 3.0 * area * (r0 * r0 + r0 * r1 + r1 * r1);
  }
  EXPECT_NEAR(ball.volume() / (0.125 * exact), 1.0, 1e-12);
  for (int d = 0; d < 3; ++d) EXPECT_NEAR(ball.centre()[d], (Vec3{3.0, -2.0, 7.0})[d], 1e-12);
  Shape const same = combine(Operation::intersection, {ball, Box{{2.0, -3.0, 6.0}, {4.0, -1.0, 8.0}}});
  EXPECT_NEAR(volume(same, grid::Geometry::cartesian3d) / ball.volume(), 1.0, 5e-5);
}
