/// Shapes from drawings and files, and how shapes are turned.
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

Table const& rotation_table() {
  static Table const table{
      "A rotation of a shape.",
      {number("angle", "deg", -3600.0, 3600.0)
           .required()
           .like("\"12 deg\"")
           .means("Angle; positive is anticlockwise, seen with the axis pointing at you (in 2D: from x to y)"),
       axis("axis").note("`z`").like("\"z\"").means("Direction of the axis (3D only): a letter or a vector"),
       position("about")
           .note("`position`; of a box with corners, its middle")
           .like("[0, 0, 0]")
           .means("A point on the axis of rotation")},
      {},
      {}};
  return table;
}

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

/// Bounded, so that other shapes can be looked for in it.
shape::Shape half_space(Draft const& draft, Vec3 const& position, Vec3 const& normal) {
  shape::Box room{{-far, -far, -far}, {far, far, far}};
  for (int d = 0; d < draft.dims() && draft.domain_known; ++d) {
    double const size = draft.out.domain.upper(d) - draft.out.domain.lower[d];
    room.lower[d] = draft.out.domain.lower[d] - size;
    room.upper[d] = draft.out.domain.upper(d) + size;
  }
  for (int d = 0; d < 3; ++d) {
    if (normal[d] == 1.0) room.lower[d] = position[d];
    if (normal[d] == -1.0) room.upper[d] = position[d];
  }
  return shape::combine(shape::Operation::intersection, {shape::HalfSpace{position, normal}, room});
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
              "of "
              "mass. `buildings`: GeoJSON with polygons, or CSV with the columns building, x, y, height. `terrain`: "
              "heights on a regular grid: CSV with the columns x, y, z, an ESRI ASCII grid (.asc), or GeoJSON with "
              "points; in 2D a profile: CSV with the columns x, z"),
      number("scale", "1", 1e-9, 1e9)
          .note("1")
          .like("0.001")
          .means("Factor applied to `points` or to the coordinates of the file, for example 0.001 for millimetres"),
      nested(Type::tables, "rotate", rotation_table())
          .note("none")
          .like("[{angle = \"12 deg\"}]")
          .means("Rotations of the shape, one after the other")};
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
    if (word == "half_space") return half_space(draft, position, *direction);
    return mesh(draft, section, position);
  } catch (InputError const& problem) {
    draft.error(section, word == "stl" ? "file" : section.given("points") ? "points" : "shape", problem.what());
    return std::nullopt;
  }
}

std::optional<shape::Shape> rotated(Draft const& draft, Section const& section, shape::Shape shape) {
  auto const* rotations = section.sections("rotate");
  if (section.broken("rotate")) return std::nullopt;
  if (rotations == nullptr) return shape;
  bool const flat = draft.dims() == 2;
  Vec3 about{0.0, 0.0, 0.0};
  if (section.given("position")) {
    auto const p = draft.point(section, "position");
    if (!p) return std::nullopt;
    about = *p;
  } else if (std::holds_alternative<shape::Box>(shape)) {
    about = shape::centre(shape);
  }
  if (flat) about[2] = 0.0;
  for (Section const& rotation : *rotations) {
    auto const angle = rotation.number("angle");
    if (!angle || rotation.doubtful()) return std::nullopt;
    Vec3 axis{0.0, 0.0, 1.0};
    if (rotation.given("axis")) {
      if (rotation.broken("axis")) return std::nullopt;
      auto const& given = *rotation.numbers("axis");
      for (int d = 0; d < 3; ++d) axis[d] = given[static_cast<std::size_t>(d)];
      double const length = norm(axis);
      if (!(length > 0.0) || (flat && (axis[0] != 0.0 || axis[1] != 0.0 || axis[2] < 0.0))) {
        draft.error(rotation, "axis",
                    flat
                        ? fmt::format("{} is not possible in {}; allowed: \"z\"", rotation.shown("axis"),
                                      word_of(draft.geometry()))
                        : fmt::format("{} has no direction; write, for example, axis = \"z\"", rotation.shown("axis")));
        return std::nullopt;
      }
      axis = (1.0 / length) * axis;
    }
    Vec3 point = about;
    if (rotation.given("about")) {
      auto const given = draft.point(rotation, "about");
      if (!given) return std::nullopt;
      point = *given;
    }
    shape::Motion const motion = shape::turn_around(axis, *angle * std::numbers::pi / 180.0, point);
    shape = shape::moved(shape, motion);
    about = motion.point(about);
  }
  if (draft.radial() && shape::bounds(shape).lower[0] < -draft.tiny()) {
    draft.error(
        section, "rotate",
        fmt::format("the shape reaches the radius {:g} m after the rotation; in {}, x is the radius: turn it less "
                    "or move it outwards",
                    shape::bounds(shape).lower[0], word_of(draft.geometry())));
    return std::nullopt;
  }
  return shape;
}

}  // namespace brisance::deck
