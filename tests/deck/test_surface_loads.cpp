// Pressures on the surfaces of bodies of all shapes: force, moment and balance at the start, whatever the cells cut.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "deck/deck.hpp"
#include "mpm/mpm.hpp"
#include "setup/build.hpp"

namespace brisance::test {
namespace {

using mpm::Field;
using std::numbers::pi;

struct Resultant {
  Vec3 force{0.0, 0.0, 0.0};   ///< of a unit of pressure [m2]
  Vec3 moment{0.0, 0.0, 0.0};  ///< around the origin [m3]
  double gross = 0.0;          ///< sum of the lengths of all forces
};

Vec3 cross(Vec3 const& a, Vec3 const& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

run::World world_of(std::string const& text) {
  auto result = deck::read_text(text, "d");
  if (!result.case_) throw std::runtime_error(deck::format(result.errors.at(0)));
  return setup::build(std::move(*result.case_));
}

Resultant resultant(run::World const& world) {
  Resultant all;
  for (int b = 0; b < world.regions.front().particles->grid().block_count(); ++b) {
    mpm::ParticleSet const& set = world.regions.front().particles->particles(b, 0);
    for (int q = 0; q < set.size(); ++q) {
      if (set.field(Field::load_number)[q] == 0.0) continue;
      double const volume = set.field(Field::mass)[q] / set.field(Field::density)[q];
      Vec3 f{0.0, 0.0, 0.0};
      Vec3 x{0.0, 0.0, 0.0};
      for (int d = 0; d < 3; ++d) {
        f[d] = volume * set.field(Field::load_x + d)[q];
        x[d] = set.field(Field::position_x + d)[q];
      }
      all.force = all.force + f;
      all.moment = all.moment + cross(x, f);
      all.gross += norm(f);
    }
  }
  return all;
}

std::string deck_of(std::string const& geometry, std::string const& domain, std::string const& body,
                    std::string const& load) {
  return "[end]\ntime = 1e-5\n[domain]\ngeometry = \"" + geometry + "\"\n" + domain +
         "\n[[body]]\nmaterial = \"RHA\"\n" + body + "\n[[surface_pressure]]\npressure = 1e6\n" + load + "\n";
}

std::string const space = "size = [1, 1, 1]\ncell = 0.05";
std::string const plane = "size = [1, 1]\ncell = 0.02";

/// A part of a loaded surface: its area as a vector, and a place on the line of action of an even pressure on it.
struct Part {
  Vec3 area;
  Vec3 at;
};

void expect_load(std::string const& text, std::vector<Part> const& parts, double size) {
  run::World const world = world_of(text);
  Resultant const r = resultant(world);
  Vec3 force{0.0, 0.0, 0.0};
  Vec3 moment{0.0, 0.0, 0.0};
  for (Part const& part : parts) {
    force = force - part.area;
    moment = moment - cross(part.at, part.area);
  }
  double const bound = 0.01 * norm(force);
  bool const flat = world.setup.domain.dimensions() == 2;
  for (int d = 0; d < 3; ++d) {
    EXPECT_NEAR(r.force[d], force[d], bound) << text << d;
    if (!flat || d == 2) {
      EXPECT_NEAR(r.moment[d], moment[d], bound * size) << text << d;
    }
  }
}

// Discs, spheres, hemispheres, oblique cylinders and tubes anywhere on the grid: within 1 % in force, and in moment 1 %
// of force times radius.
TEST(SurfaceLoads, PushByTrueNormalAndArea) {
  for (std::string const x : {"0.5", "0.507", "0.4871"}) {
    double const R = 0.2;
    Vec3 const c{std::stod(x), 0.45, 0.52};
    std::string const at2 = "shape = \"cylinder\"\nradius = 0.2\nposition = [" + x + ", 0.45]\n";
    expect_load(deck_of("planar2d", plane, at2, "normal = \"+y\""), {{{0, 2 * R, 0}, c}}, R);
    expect_load(deck_of("planar2d", plane, at2, "normal = \"-x\""), {{{-2 * R, 0, 0}, c}}, R);
    std::string const at3 = "radius = 0.2\nposition = [" + x + ", 0.45, 0.52]\n";
    expect_load(deck_of("cartesian3d", space, "shape = \"sphere\"\n" + at3, "normal = \"+z\""),
                {{{0, 0, pi * R * R}, c}}, R);
    // A quarter of a sphere is pushed down as well.
    expect_load(deck_of("cartesian3d", space, "shape = \"hemisphere\"\n" + at3, "normal = \"+x\""),
                {{{0.5 * pi * R * R, 0, 0.5 * pi * R * R}, c}}, R);
    double const s = std::sqrt(0.5);
    expect_load(
        deck_of("cartesian3d", space, "shape = \"cylinder\"\nlength = 0.4\naxis = [1, 0, 1]\n" + at3,
                "normal = \"+z\""),
        {{{-2 * R * 0.4 * s, 0, 2 * R * 0.4 * s}, c}, {{pi * R * R * s, 0, pi * R * R * s}, c + Vec3{s * R, 0, s * R}}},
        R);
    // The bore of a tube lies in its own shadow.
    expect_load(
        deck_of("cartesian3d", space,
                "shape = \"cylinder\"\nlength = 0.4\n" + at3 +
                    "cut = [{shape = \"cylinder\", radius = 0.12, length = 0.5, position = [" + x + ", 0.45, 0.52]}]\n",
                "normal = \"+y\""),
        {{{0, 2 * R * 0.4, 0}, c}}, R);
  }
}

TEST(SurfaceLoads, OfAxisymmetricBodiesGoAllTheWayRound) {
  for (std::string const y : {"0.5", "0.507", "0.4871"}) {
    double const R = 0.2;
    std::string const ball = "shape = \"sphere\"\nradius = 0.2\nposition = [0, " + y + "]\n";
    Resultant const from_above = resultant(world_of(deck_of("axisymmetric2d", plane, ball, "normal = \"+y\"")));
    EXPECT_NEAR(from_above.force[1] / (-pi * R * R), 1.0, 0.01);
    std::string const rod = "shape = \"cylinder\"\nradius = 0.2\nlength = 0.4\nposition = [0, " + y + "]\n";
    Resultant const around = resultant(world_of(deck_of("axisymmetric2d", plane, rod, "normal = \"+x\"")));
    EXPECT_NEAR(around.force[0] / (-2.0 * pi * R * 0.4), 1.0, 1e-9);
    EXPECT_NEAR(around.force[1], 0.0, 1e-12);
    // From within onto the bore of a tube.
    std::string const tube =
        rod + "cut = [{shape = \"cylinder\", radius = 0.1, length = 0.6, position = [0, " + y + "]}]\n";
    Resultant const bore = resultant(world_of(deck_of("axisymmetric2d", plane, tube, "normal = \"-x\"")));
    EXPECT_NEAR(bore.force[0] / (2.0 * pi * 0.1 * 0.4), 1.0, 1e-9);
  }
}

// An even pressure on all of a closed surface pushes nowhere and turns nothing.
TEST(SurfaceLoads, BalanceOnClosedSurfaces) {
  std::string const bite = "cut = [{shape = \"box\", lower = [0.45, 0.4, 0.5], upper = [0.9, 0.52, 0.9]}]\n";
  for (std::string const& body :
       {std::string("shape = \"sphere\"\nradius = 0.21\nposition = [0.507, 0.45, 0.52]\n"),
        std::string("shape = \"box\"\nlower = [0.21, 0.3, 0.33]\nupper = [0.71, 0.6, 0.7]\n"),
        std::string(
            "shape = \"cylinder\"\nradius = 0.2\nlength = 0.3\naxis = [1, 2, 1]\nposition = [0.5, 0.47, 0.51]\n"),
        "shape = \"sphere\"\nradius = 0.31\nposition = [0.507, 0.45, 0.52]\n" + bite}) {
    Resultant const r = resultant(world_of(deck_of("cartesian3d", space, body, "")));
    ASSERT_GT(r.gross, 0.1);
    // Where surfaces of two shapes meet, pieces of a third of the particles' distance are in or out as a whole.
    double const bound = body.find("cut") == std::string::npos ? 1e-9 : 0.005;
    EXPECT_LT(norm(r.force), bound * r.gross) << body;
    // Weights that would have to be negative are not: at corners.
    EXPECT_LT(norm(r.moment - cross({0.5, 0.45, 0.52}, r.force)), 0.002 * r.gross * 0.2) << body;
  }
  Resultant const disc = resultant(
      world_of(deck_of("planar2d", plane, "shape = \"cylinder\"\nradius = 0.2\nposition = [0.507, 0.45]\n", "")));
  EXPECT_LT(norm(disc.force), 1e-9 * disc.gross);
  EXPECT_NEAR(disc.gross, 2.0 * pi * 0.2, 0.01 * disc.gross);
}

// An oblique box from an STL file, loaded from above, and in a part.
TEST(SurfaceLoads, OfObliqueBodiesFromFiles) {
  auto const folder = std::filesystem::path(testing::TempDir()) / "brisance_surface_loads";
  std::filesystem::create_directories(folder);
  double const turn = 0.4;
  auto const corner = [&](int n) {
    double const x = (n & 1 ? 0.25 : -0.25);
    double const y = (n & 2 ? 0.2 : -0.2);
    double const z = (n & 4 ? 0.15 : -0.15);
    return Vec3{0.5 + x * std::cos(turn) - z * std::sin(turn), 0.5 + y, 0.5 + x * std::sin(turn) + z * std::cos(turn)};
  };
  int const faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  {
    std::ofstream file(folder / "box.stl");
    file << "solid b\n";
    for (auto const& f : faces) {
      for (int const half : {0, 1}) {
        file << "facet normal 0 0 0\nouter loop\n";
        for (int const n : {f[0], f[1 + half], f[2 + half]}) {
          Vec3 const x = corner(n);
          file << "vertex " << x[0] << " " << x[1] << " " << x[2] << "\n";
        }
        file << "endloop\nendfacet\n";
      }
    }
    file << "endsolid b\n";
  }
  auto const read = [&](std::string const& load) {
    std::string const path = (folder / "deck.toml").string();
    std::ofstream(path) << deck_of("cartesian3d", space, "shape = \"stl\"\nfile = \"box.stl\"\nposition = [0, 0, 0]\n",
                                   load);
    auto result = deck::read_file(path);
    if (!result.case_) throw std::runtime_error(deck::format(result.errors.at(0)));
    return resultant(setup::build(std::move(*result.case_)));
  };
  double const shadow = 0.4 * (0.5 * std::cos(turn) + 0.3 * std::sin(turn));
  Resultant const above = read("normal = \"+z\"");
  EXPECT_NEAR(above.force[2] / -shadow, 1.0, 0.01);
  // The faces that look up are two: what they push aside.
  EXPECT_NEAR(above.force[0], -0.4 * (0.3 * std::cos(turn) - 0.5 * std::sin(turn)), 0.01 * shadow);
  EXPECT_NEAR(above.moment[0], 0.5 * above.force[2], 0.01 * shadow * 0.25);
  Resultant const all = read("");
  EXPECT_LT(norm(all.force), 1e-6 * all.gross);  // single precision of the file
}

// What is loaded moves as it should: a ball under a pressure from above.
TEST(SurfaceLoads, DriveABall) {
  run::World world = world_of(deck_of(
      "cartesian3d", space, "shape = \"sphere\"\nradius = 0.2\nposition = [0.5, 0.5, 0.5]\n", "normal = \"+z\""));
  while (!world.finished()) run::advance(world, world.setup.end.time);
  Vec3 const momentum = mpm::sums(*world.regions.front().particles, 0).momentum;
  EXPECT_NEAR(momentum[2] / (-1e6 * pi * 0.04 * 1e-5), 1.0, 0.01);
  EXPECT_NEAR(momentum[0] / momentum[2], 0.0, 1e-6);
}

}  // namespace
}  // namespace brisance::test
