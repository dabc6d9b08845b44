/// Shapes: the keys that tell what, how large and where, and the shapes that they make.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/places.hpp"
#include "deck/tables/shapes.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

std::vector<Key> shape_keys() {
  return joined(
      {
          word("shape", {"sphere", "hemisphere", "cylinder", "box", "cone", "ogive", "torus", "polygon", "extrusion",
                         "turned", "half_space", "stl", "buildings", "terrain"})
              .note("`sphere`; in planar2d and cylindrical1d `cylinder`, in planar1d `box`")
              .like("\"sphere\"")
              .means(
                  "Shape. In planar2d a cylinder is a disc and a box is a rectangle. In axisymmetric2d a cylinder is "
                  "centred on the axis, and a box is revolved around the axis to a ring. In cylindrical1d and "
                  "spherical1d cylinders and spheres are concentric, and boxes are tubes and shells. `cone` and "
                  "`ogive` stand "
                  "on their base; an `ogive` is pointed, and its flank leaves the base along the axis; `torus`: a "
                  "ring; "
                  "`polygon` (2D): a drawn section, in axisymmetric2d revolved around the axis; `extrusion` (3D): a "
                  "drawn "
                  "section along an axis; `turned`: a drawn profile revolved around an axis; `half_space`: all on one "
                  "side "
                  "of a plane; `stl`: a body from a file; `buildings` (3D): upright buildings from a file of "
                  "footprints "
                  "with heights; `terrain` (3D, 2D): the ground below the heights of a file"),
          position("position")
              .note("the origin")
              .like("[0, 0, \"1.5 m\"]")
              .means("Centre of a sphere, cylinder, torus or box; for a hemisphere, cone or ogive, centre of its flat "
                     "face; "
                     "a point on the face of a half-space; the origin of a drawing or file"),
          number("radius", "m", smallest, far)
              .like("\"50 mm\"")
              .means("Radius of a sphere, hemisphere or cylinder, or of the base of a cone or ogive; of a torus, "
                     "radius of the "
                     "circle in the middle of its tube"),
          number("length", "m", smallest, far)
              .like("\"0.2 m\"")
              .means("Length of a cylinder, cone, ogive or extrusion along its axis"),
          axis("axis")
              .note("`z`; in axisymmetric2d `y`")
              .like("\"z\"")
              .means("Direction of the axis (in 3D; otherwise the geometry fixes it): a letter or, for a cylinder that "
                     "is no "
                     "charge, a vector of any length such as [1, 0, 1]"),
          face_normal("normal")
              .note("`+z`; in axisymmetric2d `+y`")
              .like("\"+z\"")
              .means("Side of its flat face on which a hemisphere, cone, ogive or half-space extends: with `+z` it "
                     "stands on "
                     "the ground"),
          typed(Type::point, "size", "m", smallest, far)
              .like("[1, 1, \"20 cm\"]")
              .means("Edges of a box around `position`; instead of `lower` and `upper`"),
          position("lower").like("[2, -1, 0]").means("Low corner of a box"),
          position("upper").like("[3, 1, \"2.5 m\"]").means("High corner of a box"),
      },
      joined(joined(drawn_shape_keys(), site_shape_keys()), motion_keys()));
}

namespace {

/// Keys that tell where a shape lies and how large it is.
constexpr std::array keys_of_place{
    "position",      "radius",         "length",      "axis",      "normal", "size",
    "lower",         "upper",          "points",      "file",      "scale",  "length_to_diameter",
    "rotate",        "top_radius",     "tube_radius", "translate", "origin", "height_property",
    "base_property", "default_height", "terrain",     "bottom",    "extend"};

std::vector<std::string> possible_shapes(Draft const& draft, Use use) {
  std::vector<std::string> shapes;
  switch (draft.geometry()) {
    case Geometry::cartesian3d:
      shapes = {"sphere", "hemisphere", "cylinder", "box", "cone",      "ogive",
                "torus",  "extrusion",  "turned",   "stl", "buildings", "terrain"};
      break;
    case Geometry::axisymmetric2d:
      shapes = {"sphere", "hemisphere", "cylinder", "box", "cone",   "ogive",
                "torus",  "polygon",    "turned",   "stl", "terrain"};
      break;
    case Geometry::planar2d: shapes = {"cylinder", "box", "polygon", "stl", "terrain"}; break;
    case Geometry::planar1d: return {"box"};
    case Geometry::cylindrical1d:
      return use == Use::charge ? std::vector<std::string>{"cylinder"} : std::vector<std::string>{"cylinder", "box"};
    case Geometry::spherical1d:
      return use == Use::charge ? std::vector<std::string>{"sphere"} : std::vector<std::string>{"sphere", "box"};
  }
  if (use != Use::charge) shapes.emplace_back("half_space");
  return shapes;
}

bool cylinder_has_length(Draft const& draft) {
  return draft.geometry() == Geometry::cartesian3d || draft.geometry() == Geometry::axisymmetric2d;
}

void size_missing(Draft const& draft, Section const& section, std::string_view key, bool charge,
                  std::string const& example) {
  draft.report.error(
      section.place, section.path_of(key),
      charge
          ? fmt::format("the charge has neither a mass nor a size; write, for example, mass = \"10 kg\" or {}", example)
          : fmt::format("the key \"{}\" is missing; write, for example, {}", key, example));
}

/// Are only those size keys given that the shape has?
bool only_keys_of(Draft const& draft, Section const& section, std::string const& word) {
  std::vector<std::string> allowed;
  if (word == "sphere") allowed = {"position", "radius"};
  if (word == "hemisphere") allowed = {"position", "radius", "normal"};
  if (word == "cylinder") {
    allowed = {"position", "radius"};
    if (cylinder_has_length(draft)) allowed.insert(allowed.end(), {"length", "length_to_diameter"});
    if (draft.geometry() == Geometry::cartesian3d) allowed.emplace_back("axis");
  }
  if (word == "box") allowed = {"position", "size", "lower", "upper"};
  if (word == "cone") allowed = {"position", "radius", "top_radius", "length", "normal"};
  if (word == "ogive") allowed = {"position", "radius", "length", "normal"};
  if (word == "torus") allowed = {"position", "radius", "tube_radius"};
  if (word == "polygon" || word == "turned") allowed = {"position", "points"};
  if (word == "extrusion") allowed = {"position", "points", "length"};
  if (word == "half_space") allowed = {"position", "normal"};
  if (word == "stl") allowed = {"position", "file"};
  if (word == "terrain") allowed = {"position", "file", "origin", "bottom", "extend"};
  if (word == "buildings")
    allowed = {"position", "file", "origin", "height_property", "base_property", "default_height", "terrain"};
  bool const by_axis = word == "torus" || word == "turned" || word == "extrusion";
  if (by_axis && draft.geometry() == Geometry::cartesian3d) allowed.emplace_back("axis");
  // What is round about the axis stays there.
  bool const in_plane = draft.geometry() == Geometry::axisymmetric2d && (word == "box" || word == "polygon");
  if (draft.geometry() == Geometry::cartesian3d || draft.geometry() == Geometry::planar2d || in_plane)
    allowed.emplace_back("rotate");
  if (word != "half_space") allowed.emplace_back("scale");
  allowed.emplace_back("translate");
  bool sound = true;
  for (std::string const key : keys_of_place) {
    if (!section.given(key) || std::find(allowed.begin(), allowed.end(), key) != allowed.end()) continue;
    auto offered = allowed;
    std::erase_if(offered, [&](std::string const& k) { return section.table->find(k) == nullptr; });
    draft.error(
        section, key,
        fmt::format("{} does not apply to {} in {}; its keys are {}: remove it or change the shape", section.shown(key),
                    word == "stl"         ? "an stl mesh"
                    : word == "buildings" ? word
                                          : "a " + word,
                    word_of(draft.geometry()), fmt::join(offered, ", ")));
    sound = false;
  }
  return sound;
}

/// Direction of a cylinder, a unit vector.
std::optional<Vec3> cylinder_axis(Draft const& draft, Section const& section) {
  Vec3 axis{0.0, 0.0, 0.0};
  auto const& given = *section.numbers("axis");
  for (std::size_t d = 0; d < given.size(); ++d) axis[static_cast<int>(d)] = given[d];
  double const length = norm(axis);
  if (!(length > 0.0)) {
    draft.error(section, "axis",
                fmt::format("{} has no direction; write, for example, axis = [1, 0, 1]", section.shown("axis")));
    return std::nullopt;
  }
  axis = (1.0 / length) * axis;
  // Symmetry planes and the mass of a charge are looked at along the axes only.
  bool const along = std::abs(axis[0]) == 1.0 || std::abs(axis[1]) == 1.0 || std::abs(axis[2]) == 1.0;
  if (!along && section.table->find("mass") != nullptr) {
    draft.error(section, "axis",
                fmt::format("{} is not possible for a charge; allowed: \"x\", \"y\" or \"z\"", section.shown("axis")));
    return std::nullopt;
  }
  return axis;
}

std::optional<shape::Shape> cylinder(Draft const& draft, Section const& section, Vec3 const& position,
                                     std::optional<double> volume_asked) {
  bool const charge = section.table->find("mass") != nullptr;
  Vec3 axis{0.0, 0.0, 1.0};
  if (draft.geometry() == Geometry::axisymmetric2d) axis = {0.0, 1.0, 0.0};
  if (section.given("axis")) {
    auto const given = cylinder_axis(draft, section);
    if (!given) return std::nullopt;
    axis = *given;
  }
  auto const radius = section.number("radius");
  auto const volume_of = [&](double r, double l) {
    return shape::volume(shape::Cylinder{position, r, l, axis}, draft.geometry());
  };
  if (!cylinder_has_length(draft)) {
    if (!radius && !volume_asked) {
      size_missing(draft, section, "radius", charge, "radius = \"50 mm\"");
      return std::nullopt;
    }
    return shape::Cylinder{position, radius ? *radius : std::sqrt(*volume_asked / volume_of(1.0, 1.0)), 1.0, axis};
  }
  auto const length = section.number("length");
  auto const ratio = section.number("length_to_diameter");
  if (length && ratio) {
    draft.error(
        section, "length_to_diameter",
        fmt::format("{} is given together with a length: remove one of the two", section.shown("length_to_diameter")));
    return std::nullopt;
  }
  if (radius && length) return shape::Cylinder{position, *radius, *length, axis};
  if (radius && ratio) return shape::Cylinder{position, *radius, 2.0 * *radius * *ratio, axis};
  if (volume_asked && radius) return shape::Cylinder{position, *radius, *volume_asked / volume_of(*radius, 1.0), axis};
  if (volume_asked && length) {
    return shape::Cylinder{position, std::sqrt(*volume_asked / volume_of(1.0, *length)), *length, axis};
  }
  if (volume_asked && ratio) {
    double const r = std::cbrt(*volume_asked / volume_of(1.0, 2.0 * *ratio));
    return shape::Cylinder{position, r, 2.0 * r * *ratio, axis};
  }
  draft.report.error(
      section.place, section.path_of("length"),
      volume_asked ? "a cylinder of given mass also needs its proportions; write, for example, length_to_diameter = 1 "
                     "(or length, or radius)"
      : charge ? "a cylinder needs its mass and proportions, or its radius and length; write, for example, mass = \"10 "
                 "kg\" and length_to_diameter = 1"
               : "a cylinder needs radius and length; write, for example, radius = \"50 mm\" and length = \"0.2 m\"");
  return std::nullopt;
}

std::optional<shape::Shape> box(Draft const& draft, Section const& section, Vec3 const& position,
                                std::optional<double> volume_asked) {
  bool const charge = section.table->find("mass") != nullptr;
  bool const corners = section.given("lower") || section.given("upper");
  if (corners && (section.given("size") || section.given("position"))) {
    std::string_view const key = section.given("size") ? "size" : "position";
    draft.error(
        section, key,
        fmt::format("{} is given together with lower or upper: give a box either lower and upper or position and size",
                    section.shown(key)));
    return std::nullopt;
  }
  Vec3 low = position;
  Vec3 high = position;
  if (corners) {
    for (auto const* key : {"lower", "upper"}) {
      if (!section.given(key)) {
        draft.report.error(section.place, section.path_of(key),
                           "a box needs both corners; write, for example, lower = [2, -1, 0] and upper = [3, 1, 2]");
        return std::nullopt;
      }
    }
    auto const lower = draft.point(section, "lower");
    auto const upper = draft.point(section, "upper");
    if (!lower || !upper) return std::nullopt;
    low = *lower;
    high = *upper;
  } else {
    Vec3 size{0.0, 0.0, 0.0};
    if (section.given("size")) {
      auto const given = draft.point(section, "size");
      if (!given) return std::nullopt;
      size = *given;
    } else if (volume_asked && !draft.radial()) {
      double const edge = std::pow(*volume_asked, 1.0 / draft.dims());
      for (int d = 0; d < draft.dims(); ++d) size[d] = edge;
    } else {
      size_missing(draft, section, "size", charge,
                   draft.radial() ? "lower = [...] and upper = [...]" : "size = [1, 1, 1]");
      return std::nullopt;
    }
    low = position - 0.5 * size;
    high = position + 0.5 * size;
  }
  for (int d = 0; d < draft.dims(); ++d) {
    if (high[d] - low[d] > 0.0) continue;
    std::string_view const key = corners ? "upper" : "size";
    draft.error(section, key,
                fmt::format("{} gives no positive extent in direction {} ({:g} m): the extent must be positive",
                            section.shown(key), directions[d], high[d] - low[d]));
    return std::nullopt;
  }
  if (draft.radial() && low[0] < 0.0) {
    std::string_view const key = corners ? "lower" : "position";
    draft.error(
        section, key,
        fmt::format(
            "the box starts at the radius {:g} m; in {}, x is the radius: give lower and upper with radii of 0 or more",
            low[0], word_of(draft.geometry())));
    return std::nullopt;
  }
  // One metre thick where a direction is not resolved.
  for (int d = draft.dims(); d < 3; ++d) {
    low[d] = -0.5;
    high[d] = 0.5;
  }
  return shape::Box{low, high};
}

}  // namespace

namespace {

std::optional<shape::Shape> build_upright_shape(Draft const& draft, Section const& section, Use use,
                                                std::optional<double> volume_asked) {
  if (section.broken("shape") || section.doubtful()) return std::nullopt;
  auto const possible = possible_shapes(draft, use);
  std::string const word = section.text("shape").value_or(possible.front());
  if (std::find(possible.begin(), possible.end(), word) == possible.end()) {
    std::string const disc = word == "sphere" && draft.geometry() == Geometry::planar2d
                                 ? " (a \"cylinder\" is a disc here)"
                             : word == "polygon" && draft.dims() == 3 ? " (an \"extrusion\" has a polygon and a length)"
                             : word == "extrusion" && draft.dims() == 2 ? " (a \"polygon\" is a section here)"
                             : word == "buildings" && draft.dims() == 2 ? " (draw their section as a \"polygon\")"
                                                                        : "";
    draft.error(section, "shape",
                fmt::format("\"{}\" is not possible in {}; allowed: {}{}", word, word_of(draft.geometry()),
                            quoted_list(possible), disc));
    return std::nullopt;
  }
  if (!only_keys_of(draft, section, word)) return std::nullopt;
  for (auto const* key : keys_of_place) {
    if (section.broken(key)) return std::nullopt;
  }
  Vec3 position{0.0, 0.0, 0.0};
  if (section.given("position")) {
    auto const p = draft.point(section, "position");
    if (!p) return std::nullopt;
    position = *p;
    if (word != "box" && word != "polygon" && word != "stl" && word != "terrain" && draft.radial() &&
        position[0] != 0.0) {
      draft.error(section, "position",
                  fmt::format("{} is not on the axis; a {} in {} is centred at radius 0: write 0 as its first element, "
                              "or use a box, which is a ring or shell",
                              section.shown("position"), word, word_of(draft.geometry())));
      return std::nullopt;
    }
  }
  if (is_site(word)) return build_site_shape(draft, section, word, position);
  if (is_drawn(word)) return build_drawn_shape(draft, section, word, position);
  if (word == "box") return box(draft, section, position, volume_asked);
  if (word == "cylinder") return cylinder(draft, section, position, volume_asked);

  shape::Sphere const unit_sphere{position, 1.0};
  auto const normal = grid_normal(draft, section);
  if (!normal) return std::nullopt;
  bool const half = word == "hemisphere";
  shape::Shape const unit = half ? shape::Shape(shape::Hemisphere{position, 1.0, *normal}) : unit_sphere;
  double radius = 0.0;
  if (auto const given = section.number("radius")) {
    radius = *given;
  } else if (volume_asked) {
    radius = std::cbrt(*volume_asked / shape::volume(unit, draft.geometry()));
  } else {
    size_missing(draft, section, "radius", use == Use::charge, "radius = \"50 mm\"");
    return std::nullopt;
  }
  if (half) return shape::Hemisphere{position, radius, *normal};
  return shape::Sphere{position, radius};
}

}  // namespace

std::optional<shape::Shape> build_shape(Draft const& draft, Section const& section, Use use,
                                        std::optional<double> volume_asked, shape::Motion const& whole) {
  auto const upright = build_upright_shape(draft, section, use, volume_asked);
  if (!upright) return std::nullopt;
  std::string const word = section.text("shape").value_or(possible_shapes(draft, use).front());
  if (volume_asked && section.given("scale") && !is_drawn(word)) {
    draft.error(section, "scale",
                fmt::format("{} is given together with a mass, which gives the size: remove one of the two",
                            section.shown("scale")));
    return std::nullopt;
  }
  auto const there = moved(draft, section, word, *upright, whole);
  if (!there) return std::nullopt;
  if (use == Use::gas && word == "terrain" && !covers_domain(draft, section, *there)) return std::nullopt;
  auto const* half = std::get_if<shape::HalfSpace>(&*there);
  return half != nullptr ? bounded(draft, *half) : *there;
}

}  // namespace brisance::deck
