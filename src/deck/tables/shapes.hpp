/// What the builders of shapes share.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "deck/draft.hpp"
#include "deck/schema.hpp"

namespace brisance::deck {

/// Keys of shapes from drawings and files, and that of rotations.
[[nodiscard]] std::vector<Key> drawn_shape_keys();
/// Is it one of those shapes?
[[nodiscard]] bool is_drawn(std::string_view word);
[[nodiscard]] std::optional<shape::Shape> build_drawn_shape(Draft const& draft, Section const& section,
                                                            std::string_view word, Vec3 const& position);
/// Keys of buildings and terrains.
[[nodiscard]] std::vector<Key> site_shape_keys();
[[nodiscard]] bool is_site(std::string_view word);
[[nodiscard]] std::optional<shape::Shape> build_site_shape(Draft const& draft, Section const& section,
                                                           std::string_view word, Vec3 const& position);
/// Reports a terrain that ends within the domain.
[[nodiscard]] bool covers_domain(Draft const& draft, Section const& section, shape::Shape const& terrain);
/// The shape after the rotations that the section gives.
[[nodiscard]] std::optional<shape::Shape> rotated(Draft const& draft, Section const& section, shape::Shape shape);
/// The side that `normal` gives, a unit vector along an axis of the grid: z, or y in 2D, without one.
[[nodiscard]] std::optional<Vec3> grid_normal(Draft const& draft, Section const& section);

}  // namespace brisance::deck
