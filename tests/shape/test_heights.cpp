/// Terrains from height grids: CSV, ESRI ASCII grids and GeoJSON, good ones and every kind of broken one.
#include <fmt/format.h>

#include <cmath>

#include "data_files.hpp"
#include "shape/heights.hpp"
#include "shape/shape.hpp"

namespace brisance::shape {
namespace {

using grid::Geometry;
using test::Bad;

/// A plane z = 2 + x / 4 - y / 8 over the points of a grid, row by row.
std::string plane_csv(int nx, int ny, double step) {
  std::string text = "x,y,z\n";
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i)
      text += fmt::format("{},{},{}\n", step * i, step * j, 2.0 + 0.25 * step * i - 0.125 * step * j);
  }
  return text;
}

class Terrain : public test::DataFiles {
 protected:
  std::string refused(std::string const& name, std::string const& text) {
    return refusal(name, text, [](std::filesystem::path const& path) { (void)read_heights(path, {}); });
  }
};

// Under a plane: the mean height times the area, exactly; and the height everywhere.
TEST_F(Terrain, HasTheVolumeUnderItsSurface) {
  Heights const heights = read_heights(write("plane.csv", plane_csv(9, 5, 2.0)), {});
  ASSERT_EQ(heights.x.size(), 9U);
  ASSERT_EQ(heights.y.size(), 5U);
  EXPECT_DOUBLE_EQ(heights.lowest(), 1.0);
  EXPECT_NEAR(heights.over(3.3, 4.7), 2.0 + 0.25 * 3.3 - 0.125 * 4.7, 1e-12);
  EXPECT_NEAR(heights.over(16.0, 8.0), 2.0 + 4.0 - 1.0, 1e-12);
  EXPECT_TRUE(heights.covers(16.0, 0.0));
  EXPECT_FALSE(heights.covers(16.1, 0.0));
  Mesh const body = ground(heights, -1.0, "it");
  double const expected = 16.0 * 8.0 * (1.0 + 2.0 + 0.25 * 8.0 - 0.125 * 4.0);
  EXPECT_NEAR(body.volume(), expected, 1e-12 * expected);
  EXPECT_FALSE(body.overlaps());
  EXPECT_TRUE(body.contains({3.3, 4.7, 2.2}));
  EXPECT_FALSE(body.contains({3.3, 4.7, 2.3}));
  EXPECT_FALSE(body.contains({3.3, 4.7, -1.1}));
  // Level with the outside: what a line along x sees of a bump is inside once.
  EXPECT_NEAR(volume(moved(body, turn_around({0.0, 0.0, 1.0}, 0.4, {1.0, 2.0, 0.0})), Geometry::cartesian3d), expected,
              1e-9 * expected);
}

// The interpolation is that of the triangles, also where four heights are in no plane.
TEST_F(Terrain, IsOneSurfaceForBodiesAndQuestions) {
  Heights const hill{{0.0, 1.0, 2.0}, {0.0, 1.0, 3.0}, {0.0, 1.0, 0.3, 0.5, 2.0, 0.1, 0.7, 0.2, 0.9}};
  Mesh const body = ground(hill, -1.0, "it");
  for (double const x : {0.05, 0.45, 0.95, 1.3, 1.85}) {
    for (double const y : {0.1, 0.5, 0.9, 1.7, 2.9}) {
      double const z = hill.over(x, y);
      EXPECT_TRUE(body.contains({x, y, z - 1e-9})) << x << " " << y;
      EXPECT_FALSE(body.contains({x, y, z + 1e-9})) << x << " " << y;
    }
  }
  EXPECT_EQ(hill.lowest_between(0.2, 0.3, 0.2, 0.3), 0.0);
  EXPECT_EQ(hill.lowest_between(1.2, 1.3, 1.2, 1.3), 0.1);
  EXPECT_EQ(hill.lowest_between(0.0, 2.0, 0.0, 3.0), 0.0);
}

// The same heights in three formats and in any order.
TEST_F(Terrain, IsTheSameFromEveryFormat) {
  Frame const frame{{100.0, 200.0, 10.0}, 2.0, {1.0, 2.0, 3.0}};
  Heights const csv = read_heights(
      write("a.csv",
            "z;y;x;name\n12;205;105;a\n10;200;100;b\n13;200;110;c\n11;200;105;d\n14;205;100;e\n15;205;110;f\n"),
      frame);
  EXPECT_EQ(csv.x, (std::vector{1.0, 11.0, 21.0}));
  EXPECT_EQ(csv.y, (std::vector{2.0, 12.0}));
  EXPECT_EQ(csv.z, (std::vector{3.0, 5.0, 9.0, 11.0, 7.0, 13.0}));
  Heights const centres = read_heights(
      write("a.asc", "NCOLS 3\nnrows 2\nxllcenter 100\nyllcenter 200\ncellsize 5\n14 12 15\n10 11 13\n"), frame);
  Heights const corners = read_heights(write("b.asc",
                                             "ncols 3\r\nnrows 2\r\nxllcorner 97.5\r\nyllcorner 197.5\r\ncellsize "
                                             "5\r\nNODATA_value -9999\r\n14 12 15\r\n10 11 13"),
                                       frame);
  Heights const json = read_heights(write("a.geojson", R"({"type": "FeatureCollection", "features": [
{"type": "Feature", "geometry": {"type": "MultiPoint", "coordinates": [[105, 205, 12], [100, 200, 10], [110, 200, 13]]}},
{"type": "Feature", "geometry": {"type": "Point", "coordinates": [105, 200, 11]}},
{"type": "Feature", "geometry": {"type": "MultiPoint", "coordinates": [[100, 205, 14], [110, 205, 15]]}}]})"),
                                    frame);
  for (Heights const& other : {centres, corners, json}) {
    EXPECT_EQ(other.x, csv.x);
    EXPECT_EQ(other.y, csv.y);
    EXPECT_EQ(other.z, csv.z);
  }
}

TEST_F(Terrain, GoesOnWithTheHeightsOfItsEdge) {
  Heights const small{{0.0, 1.0}, {0.0, 1.0}, {1.0, 2.0, 3.0, 4.0}};
  Heights const wide = small.reaching(-1.0, 3.0, 0.0, 1.5);
  EXPECT_EQ(wide.x, (std::vector{-1.0, 0.0, 1.0, 3.0}));
  EXPECT_EQ(wide.y, (std::vector{0.0, 1.0, 1.5}));
  EXPECT_EQ(wide.z, (std::vector{1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 3.0, 3.0, 4.0, 4.0}));
  EXPECT_EQ(small.reaching(0.2, 0.8, 0.0, 1.0).z, small.z);
}

TEST_F(Terrain, MayBeAProfile) {
  Heights const profile =
      read_profile(write("p.csv", "x,z\n3,2\n0,1\n1,1\n"), {{0.0, 1.0, 0.0}, 1.0, {5.0, 10.0, 0.0}});
  EXPECT_EQ(profile.x, (std::vector{5.0, 6.0, 8.0}));
  Mesh const body = ground(profile, 9.0, "it").turned({0, 2, 1});
  EXPECT_NEAR(volume(body, Geometry::planar2d), 3.0 + 1.0, 1e-6);
  EXPECT_TRUE(contains(body, {7.9, 10.9, 0.0}));
  EXPECT_FALSE(contains(body, {6.1, 10.9, 0.0}));
  auto const refused_profile = [&](std::string const& name, std::string const& text) {
    return refusal(name, text, [](std::filesystem::path const& path) { (void)read_profile(path, {}); });
  };
  EXPECT_NE(refused_profile("b.csv", "x,z\n0,1\n2,1\n0,3\n").find("line 4: x = 0 is there already in line 2"),
            std::string::npos);
  EXPECT_NE(refused_profile("b.csv", "x,z\n0,1\n").find("1 points are no profile"), std::string::npos);
  EXPECT_NE(refused_profile("b.asc", "").find("a file .csv with the columns x and z"), std::string::npos);
}

TEST_F(Terrain, IsRefusedWithFileAndLine) {
  for (auto const& [text, told] : std::vector<Bad>{
           {"x,y\n1,2\n", "line 1: there is no column \"z\""},
           {"x,y,z\n", "it contains no points"},
           {"x,y,z\n0,0,1\n0,1,1\n", "all points have x = 0"},
           {"x,y,z\n0,0,high\n", "line 2: z is \"high\""},
           {"x,y,z\n0,0,1\n1,0,1\n0,1,1\n1,1,1\n1,0,2\n", "line 6: the point (1, 0) is there already in line 3"},
           {"x,y,z\n0,0,1\n1,0,1\n0,1,1\n", "there is no height at (1, 1); 1 of 4 points are missing"},
           {"x,y,z\n0,0,1\n1,0,1\n2,0,1\n4,0,1\n0,1,1\n1,1,1\n2,1,1\n4,1,1\n",
            "line 5: x = 4 lies 2 from the value before, but others are 1 apart"},
           {"x,y,z\n0,0,1\n1.1,0.2,1\n2,1,1\n3.3,1.7,1\n4.1,2.4,1\n5,3.3,1\n", "evenly spaced"},
           {"x,y,z\n0,0,1\n1,1,1\n2,2,1\n3,3,1\n4,4,1\n5,5,1\n", "they are no grid"}}) {
    std::string const message = refused("bad.csv", text);
    EXPECT_NE(message.find(told), std::string::npos) << told << "\n" << message;
  }
  std::string const head = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
  for (auto const& [text, told] :
       std::vector<Bad>{{"", "its header lacks ncols"},
                        {"ncols 2\nnrows 2\ncellsize 1\n1 1 1 1", "its header lacks xllcorner"},
                        {"ncols two\n", "line 1: \"two\" is no number"},
                        {"columns 2\n", "line 1: \"columns\" is no name of the header"},
                        {"ncols 1e9\nnrows 1e9\nxllcorner 0\nyllcorner 0\ncellsize 1\n", "ncols is 1e+09"},
                        {"ncols 2000\nnrows 2000\nxllcorner 0\nyllcorner 0\ncellsize 1\n", "more than 2000000 heights"},
                        {"ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize -1\n", "cellsize is -1"},
                        {head + "1 2\n3", "line 7: it ends before the last height"},
                        {head + "1 2\n3 4 5", "line 7: \"5\" follows the last of 2 x 2 heights"},
                        {head + "1 2\n3 x", "line 7: \"x\" is no number"},
                        {"nodata_value -9\n" + head + "1 2\n3 -9", "line 8: there is no height at (1.5, 0.5)"}}) {
    std::string const message = refused("bad.asc", text);
    EXPECT_NE(message.find(told), std::string::npos) << told << "\n" << message;
  }
  EXPECT_NE(refused("bad.tif", "").find("a height grid is a file .csv"), std::string::npos);
  EXPECT_NE(refused("bad.geojson", R"({"type": "Feature", "geometry": {"type": "Point", "coordinates": [1, 2]}})")
                .find("feature 1: \"[1,2]\" is no position of 3 coordinates"),
            std::string::npos);
  EXPECT_THROW((void)ground({{0.0, 1.0}, {0.0, 1.0}, {1.0, 1.0, 1.0, 1.0}}, 1.0, "it"), InputError);
}

// Coordinates with few digits, and a spacing that differs between x and y.
TEST_F(Terrain, ToleratesRoundedCoordinates) {
  std::string text = "x,y,z\n";
  for (int j = 0; j < 40; ++j) {
    for (int i = 0; i < 60; ++i) text += fmt::format("{:.3f},{:.2f},{}\n", i / 3.0, j * 0.7, i);
  }
  Heights const heights = read_heights(write("rounded.csv", text), {});
  EXPECT_EQ(heights.x.size(), 60U);
  EXPECT_EQ(heights.y.size(), 40U);
  EXPECT_NEAR(heights.x[31], 31.0 / 3.0, 1e-3);
}

}  // namespace
}  // namespace brisance::shape
