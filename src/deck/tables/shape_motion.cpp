/// How shapes are scaled, turned and moved, alone and with all their parts.
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/places.hpp"
#include "deck/tables/shapes.hpp"
#include "deck/tables/tables.hpp"

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

/// Is a shape that is round about the axis, or about the origin, still so after the motion?
bool keeps_axis(shape::Motion const& motion) { return motion.axes[0][0] == 1.0 && motion.shift[0] == 0.0; }

/// Adds the rotations that the section gives; `about` is where the shape's reference point is by then.
bool add_rotations(Draft const& draft, Section const& section, Vec3 about, shape::Motion& motion) {
  auto const* rotations = section.sections("rotate");
  if (section.broken("rotate")) return false;
  if (rotations == nullptr) return true;
  bool const flat = draft.dims() == 2;
  if (draft.dims() < 2) {
    draft.error(section, "rotate",
                fmt::format("nothing can be turned in {}: remove the key", word_of(draft.geometry())));
    return false;
  }
  for (Section const& rotation : *rotations) {
    auto const angle = rotation.number("angle");
    if (!angle || rotation.doubtful()) return false;
    Vec3 axis{0.0, 0.0, 1.0};
    if (rotation.given("axis")) {
      if (rotation.broken("axis")) return false;
      auto const& given = *rotation.numbers("axis");
      for (int d = 0; d < 3; ++d) axis[d] = given[static_cast<std::size_t>(d)];
      double const length = norm(axis);
      if (!(length > 0.0) || (flat && (axis[0] != 0.0 || axis[1] != 0.0 || axis[2] < 0.0))) {
        draft.error(rotation, "axis",
                    flat
                        ? fmt::format("{} is not possible in {}; allowed: \"z\"", rotation.shown("axis"),
                                      word_of(draft.geometry()))
                        : fmt::format("{} has no direction; write, for example, axis = \"z\"", rotation.shown("axis")));
        return false;
      }
      axis = (1.0 / length) * axis;
    }
    Vec3 point = about;
    if (rotation.given("about")) {
      auto const given = draft.point(rotation, "about");
      if (!given) return false;
      point = *given;
    }
    shape::Motion const turn = shape::turn_around(axis, *angle * std::numbers::pi / 180.0, point);
    motion = shape::then(motion, turn);
    about = turn.point(about);
  }
  return true;
}

/// The motion by `scale`, `rotate` and `translate`, in this order, of a shape with this reference point.
std::optional<shape::Motion> motion_of(Draft const& draft, Section const& section, Vec3 const& about, double scale) {
  shape::Motion motion;
  motion.scale = scale;
  motion.shift = (1.0 - scale) * about;
  if (!add_rotations(draft, section, about, motion)) return std::nullopt;
  if (section.broken("translate")) return std::nullopt;
  if (section.given("translate")) {
    auto const by = draft.point(section, "translate");
    if (!by) return std::nullopt;
    motion.shift = motion.shift + *by;
  }
  return motion;
}

/// The point that scaling leaves alone: `position`, or the middle of a box with corners.
std::optional<Vec3> reference_point(Draft const& draft, Section const& section) {
  if (section.given("position")) return draft.point(section, "position");
  if (!section.given("lower") || !section.given("upper")) return Vec3{0.0, 0.0, 0.0};
  auto const lower = draft.point(section, "lower");
  auto const upper = draft.point(section, "upper");
  if (!lower || !upper) return std::nullopt;
  return 0.5 * (*lower + *upper);
}

/// The motion of a shape by its own keys. `points` and files have been scaled when they were read.
std::optional<shape::Motion> own_motion(Draft const& draft, Section const& section) {
  auto const about = reference_point(draft, section);
  if (!about || section.broken("scale")) return std::nullopt;
  bool const scaled_before = section.given("points") || section.given("file");
  return motion_of(draft, section, *about, scaled_before ? 1.0 : section.number("scale").value_or(1.0));
}

Key scale_key(char const* meaning) { return number("scale", "1", 1e-9, 1e9).note("1").like("0.001").means(meaning); }

Key rotate_key(char const* meaning) {
  return nested(Type::tables, "rotate", rotation_table()).note("none").like("[{angle = \"12 deg\"}]").means(meaning);
}

Key translate_key(char const* meaning) {
  return position("translate").note("none").like("[0, 0, \"1 m\"]").means(meaning);
}

Table const& whole_table() {
  static Table const table{
      "The motion of a shape with all its parts.",
      {scale_key("Factor by which all of it is enlarged about the `position` of the first shape, where that is after "
                 "its own motion (of a box with corners about its middle)"),
       rotate_key("Rotations of all of it, one after the other, by default about the same point"),
       translate_key("Displacement of all of it, after the rotations")},
      {},
      {}};
  return table;
}

}  // namespace

std::vector<Key> motion_keys() {
  return {scale_key("Factor by which the shape is enlarged about `position` (a box with corners: about its middle), "
                    "before it is turned; for example 0.001 where `points` or an STL file are in millimetres. Of an "
                    "`extrusion`, `points` are enlarged and `length` is not; a `half_space` has no size"),
          rotate_key("Rotations of the shape, one after the other"),
          translate_key("Displacement of the shape, after it has been enlarged and turned")};
}

Key whole_key() {
  return nested(Type::table, "whole", whole_table())
      .note("none")
      .like("{rotate = [{angle = \"12 deg\"}], translate = [0, 0, \"1 m\"]}")
      .means("Motion of the shape with what is added, cut and intersected: enlarged, then turned, then displaced");
}

std::optional<shape::Motion> whole_motion(Draft const& draft, Section const& section) {
  if (section.broken("whole")) return std::nullopt;
  Section const* whole = section.section("whole");
  if (whole == nullptr) return shape::Motion{};
  if (whole->doubtful()) return std::nullopt;
  auto const own = own_motion(draft, section);
  auto const about = reference_point(draft, section);
  if (!own || !about || whole->broken("scale")) return std::nullopt;
  return motion_of(draft, *whole, own->point(*about), whole->number("scale").value_or(1.0));
}

std::optional<shape::Shape> moved(Draft const& draft, Section const& section, std::string_view word,
                                  shape::Shape const& shape, shape::Motion const& whole) {
  auto const own = own_motion(draft, section);
  if (!own) return std::nullopt;
  bool const still =
      std::none_of(motion_words.begin(), motion_words.end(), [&](char const* key) { return section.given(key); });
  std::string_view const key = section.given("translate") ? "translate" : section.given("rotate") ? "rotate" : "scale";
  bool const section_of_ring = word == "box" || word == "polygon";
  if (draft.radial() && !section_of_ring && !(keeps_axis(*own) && keeps_axis(whole))) {
    draft.error(section, keeps_axis(*own) ? "shape" : key,
                fmt::format("a {} in {} is centred at radius 0 and stays there: move it along the axis only, or use a "
                            "box or a polygon, which are rings",
                            word, word_of(draft.geometry())));
    return std::nullopt;
  }
  shape::Shape there = shape::moved(shape, shape::then(*own, whole));
  double const inmost = shape::bounds(there).lower[0];
  if (draft.radial() && section_of_ring && inmost < -draft.tiny()) {
    draft.error(section, still ? place_key(section) : key,
                fmt::format("the shape reaches the radius {:g} m after its motion; in {}, x is the radius: move or "
                            "turn it less, or move it outwards",
                            inmost, word_of(draft.geometry())));
    return std::nullopt;
  }
  return there;
}

}  // namespace brisance::deck
