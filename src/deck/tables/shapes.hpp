/// What the builders of shapes share.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "deck/draft.hpp"
#include "deck/schema.hpp"

namespace brisance::deck {

/// Keys of shapes from drawings and files.
[[nodiscard]] std::vector<Key> drawn_shape_keys();
/// Is it one of those shapes?
[[nodiscard]] bool is_drawn(std::string_view word);
[[nodiscard]] std::optional<shape::Shape> build_drawn_shape(Draft const& draft, Section const& section,
                                                            std::string_view word, Vec3 const& position);
/// The half-space within a box around the domain, so that other shapes can be looked for in it.
[[nodiscard]] shape::Shape bounded(Draft const& draft, shape::HalfSpace const& half);

/// What moves a shape, in the order in which it does.
inline constexpr std::array motion_words{"scale", "rotate", "translate"};
[[nodiscard]] std::vector<Key> motion_keys();
/// The key that moves a shape with all its parts.
[[nodiscard]] Key whole_key();
/// The motion by that key, none without it.
[[nodiscard]] std::optional<shape::Motion> whole_motion(Draft const& draft, Section const& section);
/// The shape after its own motion, then that of all of the shape that it belongs to. What is round about an axis of the
/// geometry must stay so.
[[nodiscard]] std::optional<shape::Shape> moved(Draft const& draft, Section const& section, std::string_view word,
                                                shape::Shape const& shape, shape::Motion const& whole);
/// Keys of buildings and terrains.
[[nodiscard]] std::vector<Key> site_shape_keys();
[[nodiscard]] bool is_site(std::string_view word);
[[nodiscard]] std::optional<shape::Shape> build_site_shape(Draft const& draft, Section const& section,
                                                           std::string_view word, Vec3 const& position);
/// Reports a terrain that ends within the domain.
[[nodiscard]] bool covers_domain(Draft const& draft, Section const& section, shape::Shape const& terrain);
/// The side that `normal` gives, a unit vector along an axis of the grid: z, or y in 2D, without one.
[[nodiscard]] std::optional<Vec3> grid_normal(Draft const& draft, Section const& section);

}  // namespace brisance::deck
