/// Shapes of bodies and of places among material points: put together, cut and kept in parts.
#include <algorithm>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/places.hpp"
#include "deck/tables/shapes.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

namespace {

Table const& part_table() {
  static Table const table{"A shape that is combined with others.", shape_keys(), {}, {}};
  return table;
}

}  // namespace

std::vector<Key> composed_shape_keys() {
  return joined(shape_keys(), {nested(Type::tables, "add", part_table())
                                   .note("none")
                                   .like("[{shape = \"sphere\", radius = \"5 mm\"}]")
                                   .means("Shapes that are added to it"),
                               nested(Type::tables, "cut", part_table())
                                   .note("none")
                                   .like("[{shape = \"cylinder\", radius = \"5 mm\", length = \"1 m\"}]")
                                   .means("Shapes that are then cut out (holes)"),
                               nested(Type::tables, "common", part_table())
                                   .note("none")
                                   .like("[{lower = [0, 0, 0], upper = [1, 1, 1], shape = \"box\"}]")
                                   .means("Shapes that are intersected with the result, as the last operation"),
                               whole_key()});
}

Table const& within_table() {
  static Table const table{"A volume in space.", composed_shape_keys(), {}, {}};
  return table;
}

namespace {

/// Parts that are cut out of a shape, or all of it, must be there.
bool check_composition(Draft const& draft, Section const& section, std::string_view key,
                       std::vector<Section> const& parts, std::vector<shape::Shape> const& shapes,
                       shape::Shape const& before) {
  if (!draft.domain_known || key == "add" || !fills(draft, before)) return true;
  bool sound = true;
  for (std::size_t n = 0; n < shapes.size(); ++n) {
    if (fills(draft, shape::combine(shape::Operation::intersection, {before, shapes[n]}))) continue;
    draft.report.error(parts[n].place_of(place_key(parts[n])), parts[n].path,
                       key == "cut" ? "it does not meet the shape and cuts nothing away: move it or remove it"
                                    : "it does not meet the shape, so nothing would be left: move it");
    sound = false;
  }
  if (!sound) return false;
  std::vector<shape::Shape> all = shapes;
  all.insert(all.begin(), before);
  if (fills(draft, shape::combine(key == "cut" ? shape::Operation::difference : shape::Operation::intersection, all))) {
    return true;
  }
  draft.error(section, key, "nothing of the shape is left: make the listed shapes smaller, or remove them");
  return false;
}

}  // namespace

std::optional<shape::Shape> build_composed_shape(Draft const& draft, Section const& section) {
  auto const motion = whole_motion(draft, section);
  if (!motion) return std::nullopt;
  auto whole = build_shape(draft, section, Use::particles, std::nullopt, *motion);
  for (auto const& [key, operation] :
       {std::pair{"add", shape::Operation::united}, std::pair{"cut", shape::Operation::difference},
        std::pair{"common", shape::Operation::intersection}}) {
    if (section.broken(key)) whole.reset();
    auto const* parts = section.sections(key);
    if (parts == nullptr || parts->empty()) continue;
    std::vector<shape::Shape> all;
    for (Section const& part : *parts) {
      auto const one = build_shape(draft, part, Use::particles, std::nullopt, *motion);
      if (one) all.push_back(*one);
    }
    if (all.size() < parts->size()) whole.reset();
    if (!whole) continue;
    if (!check_composition(draft, section, key, *parts, all, *whole)) {
      whole.reset();
      continue;
    }
    all.insert(all.begin(), *whole);
    whole = shape::combine(operation, std::move(all));
  }
  return whole;
}

}  // namespace brisance::deck
