/// Buildings from footprints: GeoJSON and CSV, good ones and every kind of broken one.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "data_files.hpp"
#include "shape/buildings.hpp"
#include "shape/outline.hpp"
#include "shape/shape.hpp"

namespace brisance::shape {
namespace {

using grid::Geometry;
using test::Bad;

/// Volumes by lines, where shells overlap or touch: see `volume`.
constexpr double by_lines = 1e-5;

std::string feature(std::string const& coordinates, std::string const& properties, char const* type = "Polygon") {
  return fmt::format(R"({{"type": "Feature", "properties": {}, "geometry": {{"type": "{}", "coordinates": {}}}}})",
                     properties, type, coordinates);
}

std::string collection(std::vector<std::string> const& features) {
  return fmt::format("{{\"type\": \"FeatureCollection\",\n\"features\": [\n{}\n]}}\n", fmt::join(features, ",\n"));
}

std::string rectangle(double x0, double y0, double x1, double y1) {
  return fmt::format("[[{0}, {1}], [{2}, {1}], [{2}, {3}], [{0}, {3}], [{0}, {1}]]", x0, y0, x1, y1);
}

/// The rings of a polygon.
std::string rings(std::vector<std::string> const& all) { return fmt::format("[{}]", fmt::join(all, ", ")); }

class Buildings : public test::DataFiles {
 protected:
  Mesh read(std::string const& name, std::string const& text) {
    given.path = write(name, text);
    return read_buildings(given);
  }

  std::string refused(std::string const& name, std::string const& text) {
    return refusal(name, text, [this](std::filesystem::path const& path) {
      BuildingFile file = given;
      file.path = path;
      (void)read_buildings(file);
    });
  }

  BuildingFile given;
};

// A courtyard, two parts of one feature, a height as text, a base: closed forms.
TEST_F(Buildings, HaveTheVolumesOfTheirFootprints) {
  std::string const court =
      fmt::format("[{}, {}, {}]", rectangle(0, 0, 20, 10), rectangle(2, 2, 8, 8), rectangle(12, 3, 18, 7));
  std::string const two = fmt::format("[[{}], [{}]]", rectangle(30, 0, 34, 5), rectangle(40, 0, 42, 5));
  Mesh const body =
      read("street.geojson", collection({feature(court, R"({"height": 6, "name": "court"})"),
                                         feature(two, R"({"height": "10 ft", "base": "1.5"})", "MultiPolygon")}));
  double const expected = (200.0 - 36.0 - 24.0) * 6.0 + 30.0 * 3.048;
  EXPECT_NEAR(body.volume(), expected, 1e-9 * expected);
  EXPECT_FALSE(body.overlaps());
  EXPECT_TRUE(body.contains({1.0, 5.0, 5.9}));
  EXPECT_FALSE(body.contains({5.0, 5.0, 3.0})) << "in the first courtyard";
  EXPECT_FALSE(body.contains({15.0, 5.0, 3.0})) << "in the second";
  EXPECT_TRUE(body.contains({10.0, 5.0, 3.0})) << "between them";
  EXPECT_TRUE(body.contains({41.0, 2.0, 4.5}));
  EXPECT_FALSE(body.contains({41.0, 2.0, 1.4})) << "below its base";
}

// Terraced houses share walls, corners and edges; a passage is overlapped, and a shed stands wholly inside a hall.
TEST_F(Buildings, MayTouchAndOverlap) {
  std::vector<std::string> houses;
  for (int n = 0; n < 5; ++n)
    houses.push_back(feature(rings({rectangle(6 * n, 0, 6 * n + 6, 10)}), R"({"height": 8})"));
  Mesh const terrace = read("terrace.json", collection(houses));
  EXPECT_NEAR(volume(terrace, Geometry::cartesian3d) / 2400.0, 1.0, by_lines);
  for (double const y : {0.0, 3.0, 10.0})
    EXPECT_EQ(terrace.contains({6.0, y, 4.0}), terrace.contains({7.0, y, 4.0})) << y;
  houses.push_back(feature(rings({rectangle(5, 8, 25, 12)}), R"({"height": 8})"));
  houses.push_back(feature(rings({rectangle(1, 1, 3, 3)}), R"({"height": 2})"));
  houses.push_back(houses.front());
  Mesh const all = read("all.json", collection(houses));
  EXPECT_TRUE(all.overlaps());
  EXPECT_NEAR(volume(all, Geometry::cartesian3d) / (2400.0 + 20.0 * 2.0 * 8.0), 1.0, by_lines);
  Shape const there = moved(all, turn_around({0.0, 0.0, 1.0}, 0.3, {1.0, 2.0, 0.0}));
  EXPECT_NEAR(volume(there, Geometry::cartesian3d) / (2400.0 + 20.0 * 2.0 * 8.0), 1.0, 10.0 * by_lines);
}

// The same street in both formats, with what a table program adds: a mark, comments, quotes, semicolons, empty cells.
TEST_F(Buildings, AreTheSameFromACsvFile) {
  Mesh const json = read(
      "a.geojson",
      collection({feature(rings({rectangle(0, 0, 4, 5)}), R"({"height": 3})"),
                  feature(rings({rectangle(9, 0, 20, 9), rectangle(10, 1, 12, 8)}), R"({"height": 7, "base": 1})")}));
  Mesh const csv = read("a.CSV",
                        "\xef\xbb\xbf"
                        R"("building";x;y;"height";note;base;ring
# two houses
north;0;0;3;"a ""good"" house
on two lines";;
north;4;0;3;;;
north;4;5;;;;
north;+0.0e0;5;;;;
south;9;0;7;;1;0
south;20;0;7;;;0

south;20;9;7;;;0
south;9;9;7;;;0
south;9;0;7;;;0
south;10;1;7;;;1
south;12;1;7;;;1
south;12;8;7;;;1
south;10;8;7;;;1)");
  EXPECT_EQ(csv.triangles(), json.triangles());
  EXPECT_NEAR(csv.volume(), 60.0 + 7.0 * (99.0 - 14.0), 1e-9);
}

TEST_F(Buildings, ComeToTheirPlace) {
  given.frame.origin = {690000.0, 5334000.0, 500.0};
  given.frame.scale = 0.3048;
  given.frame.position = {10.0, 20.0, 0.5};
  given.base = "ground";
  given.height = "h";
  std::string const square = rings({rectangle(690010, 5334010, 690020, 5334030)});
  Mesh const body = read("feet.geojson", collection({feature(square, R"({"h": 10, "ground": 501})")}));
  EXPECT_NEAR(body.lower()[0], 10.0 + 3.048, 1e-9);
  EXPECT_NEAR(body.upper()[1], 20.0 + 30.0 * 0.3048, 1e-9);
  EXPECT_NEAR(body.lower()[2], 0.5 + 0.3048, 1e-9);
  EXPECT_NEAR(body.upper()[2], 0.5 + 11.0 * 0.3048, 1e-9);
  given.default_height = 4.0;
  Mesh const plain = read("plain.geojson", collection({feature(square, R"({"h": null})")}));
  EXPECT_NEAR(plain.lower()[2], 0.5, 1e-12);
  EXPECT_NEAR(plain.upper()[2], 4.5, 1e-12);
}

// On a slope z = 0.1 x a house reaches into the ground, and its height counts from the lowest corner.
TEST_F(Buildings, StandOnTheTerrain) {
  Heights const slope{{0.0, 10.0, 20.0}, {0.0, 20.0}, {0.0, 1.0, 2.0, 0.0, 1.0, 2.0}};
  given.path = write("h.geojson", collection({feature(rings({rectangle(12, 2, 18, 8)}), R"({"height": 5})")}));
  Mesh const body = read_buildings(given, &slope);
  EXPECT_NEAR(body.upper()[2], 6.2, 1e-12);
  EXPECT_NEAR(body.lower()[2], 1.0, 1e-12) << "the lowest point of its cells of the grid";
  given.path = write("h.geojson", collection({feature(rings({rectangle(12, 2, 21, 8)}), R"({"height": 5})")}));
  try {
    (void)read_buildings(given, &slope);
    ADD_FAILURE();
  } catch (InputError const& problem) {
    EXPECT_NE(std::string(problem.what()).find("feature 1: its corner at (21, 2) m lies beyond the terrain"),
              std::string::npos)
        << problem.what();
  }
}

TEST_F(Buildings, AreRefusedWithFileAndFeature) {
  std::string const square = rings({rectangle(0, 0, 5, 5)});
  std::string const good = feature(square, R"({"height": 3})");
  std::string const deep = fmt::format("[[[0, 0], {}{}]]", std::string(200000, '['), std::string(200000, ']'));
  for (
      auto const& [text, told] : std::vector<Bad>{
          {"", "this is not valid JSON: parse error at line 1, column 1"},
          {"{\"type\": \"FeatureCollection\",\n\"features\": [", "parse error at line 2, column 14"},
          {"[1, 2]", "this is no GeoJSON"},
          {"{\"type\": \"Topology\"}", "its type is \"Topology\""},
          {"{\"type\": \"FeatureCollection\", \"features\": 7}", "no list \"features\""},
          {collection({}), "it contains no features"},
          {collection({good, "7"}), "feature 2: it is no Feature"},
          {collection({good, R"({"type": "Feature", "id": 12, "geometry": null})"}),
           "feature 2 (\"12\"): it has no geometry"},
          {collection({good, feature("[1, 2]", R"({"height": 3, "name": "tree"})", "Point")}),
           "feature 2 (\"tree\"): its geometry is \"Point\"; a footprint is a \"Polygon\""},
          {collection({feature("[]", R"({"height": 3})")}), "feature 1: its geometry has no coordinates"},
          {collection({feature("[[]]", R"({"height": 3})")}), "feature 1: a polygon of 0 points bounds nothing"},
          {collection({feature("[[[0, 0], [1, 0], [1]]]", R"({"height": 3})")}),
           "\"[1]\" is no position of 2 coordinates"},
          {collection({feature("[[[0, 0], [1, \"x\"], [1, 1]]]", R"({"height": 3})")}), "the coordinate"},
          {collection({feature(deep, R"({"height": 3})")}), "feature 1: array is no position of 2 coordinates"},
          {collection({feature("[[[0, 0], [1e300, 0], [1, 1]]]", R"({"height": 3})")}), "far too large"},
          {collection({feature("[[[0, 0], [1e999, 0], [1, 1]]]", R"({"height": 3})")}), "this is not valid JSON"},
          {collection({feature("[[[0, 0], [9, 9], [9, 0], [0, 9], [0, 0]]]", R"({"height": 3})")}),
           "feature 1: the edge from point 1 to point 2 meets the one from 3 to 4"},
          {collection({feature(rings({rectangle(0, 0, 5, 5), rectangle(1, 1, 6, 4)}), R"({"height": 3})")}),
           "meets the one from 1 to 2 of hole 1"},
          {collection({feature(rings({rectangle(0, 0, 5, 5), rectangle(6, 1, 7, 4)}), R"({"height": 3})")}),
           "hole 1 lies outside the outline"},
          {collection({feature(rings({rectangle(0, 0, 9, 9), rectangle(1, 1, 8, 8), rectangle(2, 2, 3, 3)}),
                               R"({"height": 3})")}),
           "hole 2 lies within hole 1"},
          {collection({good, feature(square, "{}")}),
           "feature 2: it has no height; give it the property or column \"height\", or the deck a default_height"},
          {collection({feature(square, R"({"height": -3})")}), "its height is -3 m; it must be positive"},
          {collection({feature(square, R"({"height": "tall"})")}), "the property \"height\" is"},
          {collection({feature(square, R"({"height": "3 kg"})")}), "must be a number in metres"},
          {collection({feature(square, R"({"height": [3]})")}), "must be a number in metres"},
          {collection({feature(rings({rectangle(11.5761, 48.1371, 11.5763, 48.1373)}), R"({"height": 3})")}),
           "these seem to be longitude and latitude in degrees"},
          {R"({"type": "FeatureCollection", "crs": {"properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}, "features": []})",
           "longitude and latitude in degrees (crs"}}) {
    std::string const message = refused("bad.geojson", text);
    EXPECT_NE(message.find(told), std::string::npos) << told << "\n" << message;
  }
  EXPECT_NE(refused("bad.shp", good).find("footprints are a file .geojson or .csv"), std::string::npos);
}

TEST_F(Buildings, AreRefusedWithFileAndLine) {
  std::string const head = "building,x,y,height\n";
  for (auto const& [text, told] : std::vector<Bad>{
           {"", "it is empty; its first line must name the columns building, x, y"},
           {"# nothing\n", "it is empty"},
           {head, "it contains no buildings"},
           {"x,y,height\n1,2,3\n", "line 1: there is no column \"building\""},
           {"building,x,x,y\n1,2,3,4\n", "line 1: there are two columns \"x\""},
           {head + "a,0,0,3\na,1,0\n", "line 3: 3 columns, but the first line names 4"},
           {head + "a,0,zero,3\n", "line 2: y is \"zero\"; write a number"},
           {head + "a,0,nan,3\n", "line 2: y is \"nan\""},
           {head + "a,0,1e13,3\n", "line 2: y is \"1e13\""},
           {"building;x;y;height\na;0;1,5;3\n", "line 2: y is \"1,5\"; write a number with a decimal point"},
           {head + ",0,0,3\n", "line 2: the building has no name"},
           {head + "a,0,0,3\na,1,0,4\n", "line 3: height is 4, but it was 3"},
           {head + "a,0,0,3\na,1,0,3\na,0,1,3\nb,5,5,3\nb,6,5,3\nb,5,6,3\na,9,9,3\n",
            "line 8: the building \"a\" is there already"},
           {head + "a,0,0,3\na,1,0,3\n", "building \"a\" (line 2): a polygon of 2 points bounds nothing"},
           {head + "a,0,0,\na,1,0,\na,0,1,\n", "building \"a\" (line 2): it has no height"},
           {head + "a,0,0,3\na,1,0,3\n\"a,0,1,3\n", "line 4"},
           {head + "a\"b,0,0,3\n", "line 2: a double quote"},
           {"building,x,y,height,ring\na,0,0,3,2\n", "line 2: ring is \"2\""},
           {head + "\"" + std::string(100000, 'x'),
            "line 2: the text in double quotes that begins here does not end"}}) {
    std::string const message = refused("bad.csv", text);
    EXPECT_NE(message.find(told), std::string::npos) << told << "\n" << message;
  }
}

TEST_F(Buildings, FilesThatAreNone) {
  given.path = folder_;
  EXPECT_THROW((void)read_buildings(given), InputError);
  given.path = folder_ / "nowhere.csv";
  EXPECT_THROW((void)read_buildings(given), InputError);
}

// Stars with courtyards, so that bridges are many and ears deep; areas by the shoelace formula.
TEST(Cut, CoversRegionsWithHoles) {
  std::uint32_t seed = 7;
  auto const random = [&seed] {
    seed = seed * 1664525U + 1013904223U;
    return (seed >> 8) / 16777216.0;
  };
  auto const star = [&](double x, double y, double small, double large, int corners) {
    Polygon polygon;
    for (int n = 0; n < corners; ++n) {
      double const phi = 2.0 * std::numbers::pi * (n + 0.5 * random()) / corners;
      double const r = small + random() * (large - small);
      polygon.push_back({x + r * std::cos(phi), y + r * std::sin(phi)});
    }
    return polygon;
  };
  for (int trial = 0; trial < 40; ++trial) {
    Region region{star(0.0, 0.0, 10.0, 20.0, 60), {}};
    double expected = area(region.outline);
    for (int j = -2; j <= 2; ++j) {
      for (int i = -2; i <= 2; ++i) {
        // On a lattice, so that corners of holes lie at the same heights.
        bool const square = trial % 2 == 0;
        double const r = 0.5 + random();
        region.holes.push_back(square ? Polygon{{2.8 * i - 1, 2.8 * j - 1},
                                                {2.8 * i + 1, 2.8 * j - 1},
                                                {2.8 * i + 1, 2.8 * j + 1},
                                                {2.8 * i - 1, 2.8 * j + 1}}
                                      : star(2.8 * i, 2.8 * j, 0.2, 0.9 * r, 9));
        expected -= area(region.holes.back());
      }
    }
    Cut const cut = cut_into_triangles(region, "it");
    double sum = 0.0;
    for (auto const& [a, b, c] : cut.triangles) {
      double const signed_area = area({cut.corners[a], cut.corners[b], cut.corners[c]});
      EXPECT_GE(signed_area, -1e-12) << trial;
      sum += signed_area;
    }
    EXPECT_NEAR(sum, expected, 1e-9 * expected) << trial;
    EXPECT_EQ(cut.corners.size(), cut.edges.size());
  }
}

// 2500 terraced houses in one body.
TEST_F(Buildings, MayBeThousands) {
  std::vector<std::string> houses;
  for (int j = 0; j < 50; ++j) {
    for (int i = 0; i < 50; ++i)
      houses.push_back(feature(rings({rectangle(10 * i, 20 * j, 10 * i + 10, 20 * j + 12)}), R"({"height": 8})"));
  }
  Mesh const town = read("town.geojson", collection(houses));
  EXPECT_EQ(town.triangle_count(), 2500U * 12U);
  EXPECT_NEAR(town.volume(), 2500.0 * 960.0, 1e-6 * 2500.0 * 960.0);
  EXPECT_TRUE(town.contains({333.0, 205.0, 4.0}));
  EXPECT_FALSE(town.contains({333.0, 215.0, 4.0}));
}

// Roofs at 900 heights and houses that overlap by 2 m: the volume of a part of the town, house by house.
TEST_F(Buildings, HaveTheirVolumeInPartsOfATown) {
  std::vector<std::string> houses;
  auto const height = [](int i, int j) { return 5.0 + std::fmod(0.618 * (30 * j + i), 1.0) * 4.0; };
  double expected = 0.0;
  for (int j = 0; j < 30; ++j) {
    for (int i = 0; i < 30; ++i) {
      houses.push_back(feature(rings({rectangle(10 * i, 20 * j, 10 * i + 12, 20 * j + 12)}),
                               fmt::format("{{\"height\": {}}}", height(i, j))));
      if (j < 15) continue;
      bool const end = i == 0 || i == 29;
      expected += 12.0 * (end ? 10.0 : 8.0) * height(i, j);
      if (i < 29) expected += 12.0 * 2.0 * std::max(height(i, j), height(i + 1, j));
    }
  }
  Mesh const town = read("town.geojson", collection(houses));
  EXPECT_TRUE(town.overlaps());
  double const part = volume_within(town, Geometry::cartesian3d, {{-10.0, 299.0, 0.0}, {400.0, 700.0, 20.0}});
  EXPECT_NEAR(part / expected, 1.0, by_lines);
}

}  // namespace
}  // namespace brisance::shape
