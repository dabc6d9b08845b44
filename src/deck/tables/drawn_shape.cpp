/// Shapes from drawings and files.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "core/error.hpp"
#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/tables/shapes.hpp"
#include "deck/tables/tables.hpp"
#include "shape/drawn.hpp"
#include "shape/stl.hpp"

namespace brisance::deck {

namespace {

/// A rigid motion that takes the axis z to a direction along an axis of the grid.
shape::Motion stand_on(Vec3 const& normal, Vec3 const& position) {
  shape::Motion motion;
  int const d = std::abs(normal[0]) == 1.0 ? 0 : std::abs(normal[1]) == 1.0 ? 1 : 2;
  motion.axes = {};
  motion.axes[0][(d + 1) % 3] = 1.0;
  motion.axes[1][(d + 2) % 3] = normal[d];
  motion.axes[2][d] = normal[d];
  motion.shift = position;
  return motion;
}

/// A profile (r, s) as a body that stands on `position` and extends along `normal`.
shape::Shape from_profile(Draft const& draft, shape::Polygon const& profile, Vec3 const& position, Vec3 const& normal,
                          std::string const& what) {
  if (draft.geometry() == Geometry::cartesian3d)
    return shape::moved(shape::turned_profile(profile, what), stand_on(normal, position));
  shape::Polygon section = profile;
  for (auto& [r, s] : section) s = position[1] + normal[1] * s;
  return shape::prism(section, -0.5, 0.5, what);
}

std::optional<double> needed(Draft const& draft, Section const& section, std::string_view key,
                             std::string const& example) {
  if (auto const value = section.number(key)) return value;
  if (!section.broken(key)) {
    draft.report.error(section.place, section.path_of(key),
                       fmt::format("the key \"{}\" is missing; write, for example, {}", key, example));
  }
  return std::nullopt;
}

std::optional<shape::Polygon> outline(Draft const& draft, Section const& section) {
  auto const* values = section.numbers("points");
  if (values == nullptr) {
    if (!section.given("points")) {
      draft.report.error(section.place, section.path_of("points"),
                         "the key \"points\" is missing; write, for example, points = [[0, 0], [1, 0], [0, 1]]");
    }
    return std::nullopt;
  }
  double const scale = section.number("scale").value_or(1.0);
  shape::Polygon polygon;
  for (std::size_t n = 0; n + 1 < values->size(); n += 2)
    polygon.push_back({scale * (*values)[n], scale * (*values)[n + 1]});
  return polygon;
}

std::optional<shape::Shape> cone(Draft const& draft, Section const& section, Vec3 const& position, Vec3 const& normal) {
  auto const radius = needed(draft, section, "radius", "radius = \"50 mm\"");
  auto const length = needed(draft, section, "length", "length = \"0.1 m\"");
  if (!radius || !length) return std::nullopt;
  double const top = section.number("top_radius").value_or(0.0);
  return from_profile(draft, shape::cone_profile(*radius, top, *length), position, normal, "the cone");
}

std::optional<shape::Shape> ogive(Draft const& draft, Section const& section, Vec3 const& position,
                                  Vec3 const& normal) {
  auto const radius = needed(draft, section, "radius", "radius = \"10 mm\"");
  auto const length = needed(draft, section, "length", "length = \"30 mm\"");
  if (!radius || !length) return std::nullopt;
  if (*length < *radius) {
    draft.error(section, "length",
                fmt::format("{} is shorter than the radius of the base ({:g} m): an ogive is at least as long as its "
                            "base is wide from the axis, where it is half a sphere; make it longer or use a cone",
                            section.shown("length"), *radius));
    return std::nullopt;
  }
  return from_profile(draft, shape::ogive_profile(*radius, *length), position, normal, "the ogive");
}

std::optional<shape::Shape> torus(Draft const& draft, Section const& section, Vec3 const& position, Vec3 const& axis) {
  auto const radius = needed(draft, section, "radius", "radius = \"0.2 m\"");
  auto const tube = needed(draft, section, "tube_radius", "tube_radius = \"20 mm\"");
  if (!radius || !tube) return std::nullopt;
  if (*tube > 0.999 * *radius) {
    draft.error(section, "tube_radius",
                fmt::format("{} leaves no hole in a ring with the radius {:g} m; allowed: less than that",
                            section.shown("tube_radius"), *radius));
    return std::nullopt;
  }
  return from_profile(draft, shape::torus_profile(*radius, *tube), position, axis, "the torus");
}

std::optional<shape::Shape> polygon(Draft const& draft, Section const& section, Vec3 const& position) {
  auto const corners = outline(draft, section);
  if (!corners) return std::nullopt;
  shape::Polygon moved = *corners;
  for (auto& [x, y] : moved) {
    x += position[0];
    y += position[1];
    if (draft.radial() && x < 0.0) {
      draft.error(section, "points",
                  fmt::format("{} reaches the radius {:g} m; in {}, x is the radius: use radii of 0 or more",
                              section.shown("points"), x, word_of(draft.geometry())));
      return std::nullopt;
    }
  }
  return shape::prism(moved, -0.5, 0.5, "the polygon");
}

std::optional<shape::Shape> extrusion(Draft const& draft, Section const& section, Vec3 const& position,
                                      Vec3 const& axis) {
  auto const corners = outline(draft, section);
  auto const length = needed(draft, section, "length", "length = \"2 m\"");
  if (!corners || !length) return std::nullopt;
  return shape::moved(shape::prism(*corners, 0.0, *length, "the extrusion"), stand_on(axis, position));
}

std::optional<shape::Shape> turned(Draft const& draft, Section const& section, Vec3 const& position, Vec3 const& axis) {
  auto const corners = outline(draft, section);
  if (!corners) return std::nullopt;
  return from_profile(draft, *corners, position, axis, "the profile");
}

std::optional<shape::Shape> mesh(Draft const& draft, Section const& section, Vec3 const& position) {
  auto const file = section.text("file");
  if (!file) {
    if (!section.given("file")) {
      draft.report.error(section.place, section.path_of("file"),
                         "the key \"file\" is missing; write, for example, file = \"bracket.stl\"");
    }
    return std::nullopt;
  }
  std::filesystem::path const path = std::filesystem::path(draft.report.file()).parent_path() / *file;
  auto const body = shape::read_stl(path, section.number("scale").value_or(1.0), position);
  double extent = 0.0;
  double room = 0.0;
  for (int d = 0; d < draft.dims(); ++d) {
    extent = std::max(extent, body.upper()[d] - body.lower()[d]);
    if (draft.domain_known) room = std::max(room, draft.out.domain.upper(d) - draft.out.domain.lower[d]);
  }
  constexpr double suspicious = 20.0;
  if (room > 0.0 && extent > suspicious * room && !section.given("scale")) {
    draft.warn(section, "file",
               fmt::format("the body is {:.4g} m long and the domain {:.4g} m; if the coordinates of the file are "
                           "millimetres, write scale = 0.001",
                           extent, room));
  }
  return body;
}

/// The side or axis that the section gives: `normal` or `axis`, along an axis of the grid.
std::optional<Vec3> direction_of(Draft const& draft, Section const& section, std::string_view key) {
  bool const three = draft.geometry() == Geometry::cartesian3d;
  Vec3 direction{0.0, 0.0, 0.0};
  direction[three ? 2 : 1] = 1.0;
  if (!section.given(key)) return direction;
  if (key == "axis") {
    auto const& given = *section.numbers("axis");
    for (int d = 0; d < 3; ++d) direction[d] = given[static_cast<std::size_t>(d)];
    double const length = norm(direction);
    for (int d = 0; d < 3; ++d) {
      if (length > 0.0 && std::abs(direction[d]) == length) {
        direction = (1.0 / length) * direction;
        return direction;
      }
    }
    draft.error(section, key,
                fmt::format("{} is not along x, y or z, as it must be for this shape; write, for example, axis = \"z\" "
                            "and turn the shape: rotate = [{{axis = \"y\", angle = \"30 deg\"}}]",
                            section.shown(key)));
    return std::nullopt;
  }
  return grid_normal(draft, section);
}

}  // namespace

std::optional<Vec3> grid_normal(Draft const& draft, Section const& section) {
  bool const three = draft.geometry() == Geometry::cartesian3d;
  Vec3 normal{0.0, 0.0, 0.0};
  normal[three ? 2 : 1] = 1.0;
  if (!section.given("normal")) return normal;
  std::string const given = *section.text("normal");
  bool const axial = draft.geometry() == Geometry::axisymmetric2d;
  if ((axial && given[1] != 'y') || (!three && given[1] == 'z')) {
    draft.error(section, "normal",
                fmt::format("\"{}\" is not possible in {}; allowed: {}", given, word_of(draft.geometry()),
                            axial ? "\"+y\" or \"-y\", along the axis" : "\"+x\", \"-x\", \"+y\" or \"-y\""));
    return std::nullopt;
  }
  normal = {0.0, 0.0, 0.0};
  normal[given[1] - 'x'] = given[0] == '-' ? -1.0 : 1.0;
  return normal;
}

std::vector<Key> drawn_shape_keys() {
  return {
      typed(Type::pairs, "points", "m", -far, far)
          .like("[[0, 0], [\"2 m\", 0], [0, \"1 m\"]]")
          .means(
              "Corners of a polygon, in order along its outline, which closes itself: [x, y] of a `polygon`, [radius, "
              "place along the axis] of a `turned` profile, the coordinates across the axis of an `extrusion` "
              "([x, y] for `z`, [y, z] for `x`, [z, x] for `y`); relative to `position`"),
      number("top_radius", "m", 0.0, far).note("0").like("\"20 mm\"").means("Radius of a cone at its top"),
      number("tube_radius", "m", smallest, far)
          .like("\"20 mm\"")
          .means("Radius of the tube of a torus; `radius` is that of the circle in its middle"),
      typed(Type::text, "file")
          .like("\"bracket.stl\"")
          .means(
              "File of shape `stl`, `buildings` or `terrain`, with a path relative to the deck; `position` moves it. "
              "`stl`: a closed surface; in 2D the body stands for its section parallel to x and y through its centre "
              "of mass. `buildings`: GeoJSON with polygons, or CSV with the columns building, x, y, height. `terrain`: "
              "heights on a regular grid: CSV with the columns x, y, z, an ESRI ASCII grid (.asc), or GeoJSON with "
              "points; in 2D a profile: CSV with the columns x, z")};
}

bool is_drawn(std::string_view word) {
  constexpr std::array drawn{"cone", "ogive", "torus", "polygon", "extrusion", "turned", "half_space", "stl"};
  return std::find(drawn.begin(), drawn.end(), word) != drawn.end();
}

std::optional<shape::Shape> build_drawn_shape(Draft const& draft, Section const& section, std::string_view word,
                                              Vec3 const& position) {
  bool const by_axis = word == "torus" || word == "extrusion" || word == "turned";
  auto const direction = direction_of(draft, section, by_axis ? "axis" : "normal");
  if (!direction) return std::nullopt;
  try {
    if (word == "cone") return cone(draft, section, position, *direction);
    if (word == "ogive") return ogive(draft, section, position, *direction);
    if (word == "torus") return torus(draft, section, position, *direction);
    if (word == "polygon") return polygon(draft, section, position);
    if (word == "extrusion") return extrusion(draft, section, position, *direction);
    if (word == "turned") return turned(draft, section, position, *direction);
    if (word == "half_space") return shape::HalfSpace{position, *direction};
    return mesh(draft, section, position);
  } catch (InputError const& problem) {
    draft.error(section, word == "stl" ? "file" : section.given("points") ? "points" : "shape", problem.what());
    return std::nullopt;
  }
}

shape::Shape bounded(Draft const& draft, shape::HalfSpace const& half) {
  shape::Box room{{-far, -far, -far}, {far, far, far}};
  for (int d = 0; d < draft.dims() && draft.domain_known; ++d) {
    double const size = draft.out.domain.upper(d) - draft.out.domain.lower[d];
    room.lower[d] = draft.out.domain.lower[d] - size;
    room.upper[d] = draft.out.domain.upper(d) + size;
  }
  for (int d = 0; d < 3; ++d) {
    if (half.normal[d] == 1.0) room.lower[d] = half.point[d];
    if (half.normal[d] == -1.0) room.upper[d] = half.point[d];
  }
  return shape::combine(shape::Operation::intersection, {half, room});
}

}  // namespace brisance::deck
