#include "shape/buildings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "shape/closed_surface.hpp"
#include "shape/data_file.hpp"

namespace brisance::shape {

namespace {

constexpr std::size_t most_buildings = 100'000;
constexpr std::size_t most_corners = 5000;  ///< of one building
constexpr std::size_t most_corners_of_all = 2'000'000;

/// Footprints of a CSV file, one row per corner.
class CsvFootprints {
 public:
  CsvFootprints(DataFile const& file, BuildingFile const& names) : file_(file) {
    read_csv(file, {"building", "x", "y", names.height, names.base, "ring"}, 3,
             [this](CsvRow const& row) { add(row); });
    close();
  }

  std::vector<Footprint> found;

 private:
  void add(CsvRow const& row) {
    if (row.texts[0].empty()) file_.refuse(row.line, "the building has no name; write a name or number");
    if (found.empty() || row.texts[0] != name_) {
      close();
      name_ = row.texts[0];
      if (!names_.insert(name_).second) {
        file_.refuse(row.line,
                     fmt::format("the building {} is there already, further up; the rows of a building follow "
                                 "each other: rename it or move the rows",
                                 shown(name_)));
      }
      found.push_back({fmt::format("building {} (line {})", shown(name_), row.line), {}, {}, {}});
      ring_ = 0.0;
    }
    Footprint& last = found.back();
    take(last.height, row, 3);
    take(last.base, row, 4);
    double const ring = row.number_if_given(5).value_or(0.0);
    if (ring != ring_ && ring != ring_ + 1.0) {
      file_.refuse(row.line,
                   fmt::format("ring is {}; it is 0 for the outline, then 1, 2, ... for holes", shown(row.texts[5])));
    }
    if (ring != ring_) last.region.holes.emplace_back();
    ring_ = ring;
    Corner const corner{row.number(1), row.number(2)};
    Polygon& polygon = last.region.holes.empty() ? last.region.outline : last.region.holes.back();
    if (polygon.empty() || polygon.back() != corner) polygon.push_back(corner);
  }

  /// All rows of a building agree, or leave the value out.
  void take(std::optional<Length>& value, CsvRow const& row, std::size_t column) const {
    auto const given = row.number_if_given(column);
    if (!given) return;
    if (value && value->value != *given) {
      file_.refuse(row.line, fmt::format("{} is {:g}, but it was {:g} in a row of the same building before; write the "
                                         "same or leave it out",
                                         row.columns[column], *given, value->value));
    }
    value = Length{*given, false};
  }

  /// A polygon may repeat its first corner.
  void close() {
    if (found.empty()) return;
    auto const open = [](Polygon& polygon) {
      if (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();
    };
    open(found.back().region.outline);
    for (Polygon& hole : found.back().region.holes) open(hole);
  }

  DataFile const& file_;
  std::string name_;
  std::unordered_set<std::string> names_;
  double ring_ = 0.0;
};

std::size_t corners_of(Region const& region) {
  std::size_t count = region.outline.size();
  for (Polygon const& hole : region.holes) count += hole.size();
  return count;
}

void check_sizes(DataFile const& file, std::vector<Footprint> const& all) {
  if (all.empty()) file.refuse("it contains no buildings");
  if (all.size() > most_buildings) {
    file.refuse(fmt::format("it contains {} buildings; allowed: at most {}: cut out what lies in the domain",
                            all.size(), most_buildings));
  }
  std::size_t sum = 0;
  for (Footprint const& one : all) {
    std::size_t const corners = corners_of(one.region);
    sum += corners;
    if (corners > most_corners) {
      file.refuse(
          fmt::format("{}: it has {} corners; allowed: at most {}: simplify it", one.where, corners, most_corners));
    }
  }
  if (sum > most_corners_of_all) {
    file.refuse(fmt::format("its buildings have {} corners; allowed: at most {}: cut out what lies in the domain", sum,
                            most_corners_of_all));
  }
}

/// Longitudes and latitudes would make a town a few millimetres wide.
void refuse_degrees(DataFile const& file, std::vector<Footprint> const& all, double scale) {
  constexpr double too_small = 0.05;  // [m], of the largest building
  double widest = 0.0;
  for (Footprint const& one : all) {
    if (one.region.outline.empty()) return;  // refused with its place later
    std::array<double, 2> low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    std::array<double, 2> high{-low[0], -low[1]};
    for (Corner const& x : one.region.outline) {
      if (std::abs(x[0]) > 180.0 || std::abs(x[1]) > 90.0) return;
      for (int d = 0; d < 2; ++d) {
        low[d] = std::min(low[d], x[d]);
        high[d] = std::max(high[d], x[d]);
      }
    }
    widest = std::max({widest, scale * (high[0] - low[0]), scale * (high[1] - low[1])});
  }
  if (widest >= too_small) return;
  Corner const& x = all.front().region.outline.front();
  file.refuse(fmt::format(
      "its largest building is {:.3g} m wide, at ({:.6g}, {:.6g}): these seem to be longitude and latitude in degrees; "
      "project them to metres, for example to a zone of UTM",
      widest, x[0], x[1]));
}

/// From where to where a building reaches [m].
struct Storey {
  double bottom = 0.0;
  double top = 0.0;
};

Storey storey_of(DataFile const& file, BuildingFile const& given, Footprint const& one, Region const& placed,
                 Heights const* terrain) {
  auto const refuse = [&](std::string const& message) { file.refuse(one.where + ": " + message); };
  if (!one.height && !given.default_height) {
    refuse(fmt::format("it has no height; give it the property or column {}, or the deck a default_height",
                       shown(given.height)));
  }
  double const scale = given.frame.scale;
  double const height = one.height ? scale * one.height->in_file(scale) : *given.default_height;
  if (!(height > 0.0)) refuse(fmt::format("its height is {:g} m; it must be positive", height));
  if (one.base) {
    double const base = given.frame.point({0.0, 0.0, one.base->in_file(scale)})[2];
    return {base, base + height};
  }
  if (terrain == nullptr) return {given.frame.position[2], given.frame.position[2] + height};
  double lowest = std::numeric_limits<double>::infinity();
  Corner low = placed.outline.front();
  Corner high = low;
  for (Corner const& x : placed.outline) {
    if (!terrain->covers(x[0], x[1]))
      refuse(fmt::format("its corner at ({:.6g}, {:.6g}) m lies beyond the terrain; remove it or give it a base", x[0],
                         x[1]));
    lowest = std::min(lowest, terrain->over(x[0], x[1]));
    for (int d = 0; d < 2; ++d) {
      low[d] = std::min(low[d], x[d]);
      high[d] = std::max(high[d], x[d]);
    }
  }
  double const bottom = terrain->lowest_between(low[0], high[0], low[1], high[1]);
  return {std::min(bottom, lowest), lowest + height};
}

/// Adds the prism over a region as a shell of its own.
void add_prism(Surface& surface, Cut const& cut, Storey const& storey) {
  int const first = static_cast<int>(surface.vertices.size());
  int const count = static_cast<int>(cut.corners.size());
  for (double const z : {storey.bottom, storey.top}) {
    for (Corner const& x : cut.corners) surface.vertices.push_back({x[0], x[1], z});
  }
  auto const below = [&](std::size_t n) { return first + static_cast<int>(n); };
  auto const above = [&](std::size_t n) { return first + count + static_cast<int>(n); };
  for (auto const& [a, b, c] : cut.triangles) {
    if (a == b || b == c || c == a) continue;
    surface.triangles.push_back({above(a), above(b), above(c)});
    surface.triangles.push_back({below(a), below(c), below(b)});
  }
  for (auto const& [a, b] : cut.edges) {
    surface.triangles.push_back({below(a), below(b), above(b)});
    surface.triangles.push_back({below(a), above(b), above(a)});
  }
}

}  // namespace

Mesh read_buildings(BuildingFile const& given, Heights const* terrain) {
  DataFile const file(given.path);
  std::vector<Footprint> all;
  if (file.kind() == ".csv") {
    all = CsvFootprints(file, given).found;
  } else if (file.kind() == ".geojson" || file.kind() == ".json") {
    all = geojson_footprints(file, given.height, given.base);
  } else {
    file.refuse("footprints are a file .geojson or .csv (columns building, x, y, height)");
  }
  check_sizes(file, all);
  refuse_degrees(file, all, given.frame.scale);
  Surface surface;
  for (Footprint const& one : all) {
    Region placed = one.region;
    auto const place = [&](Polygon& polygon) {
      for (Corner& x : polygon) {
        Vec3 const at = given.frame.point({x[0], x[1], 0.0});
        x = {at[0], at[1]};
      }
    };
    place(placed.outline);
    for (Polygon& hole : placed.holes) place(hole);
    std::string const what = fmt::format("file \"{}\": {}", file.path.string(), one.where);
    Cut const cut = cut_into_triangles(placed, what);  // refuses an outline without corners
    add_prism(surface, cut, storey_of(file, given, one, placed, terrain));
  }
  return Mesh::of_shells(std::move(surface), fmt::format("file \"{}\"", file.path.string()));
}

}  // namespace brisance::shape
