/// Where shapes lie: in the domain, in each other, in cells.
#pragma once

#include <optional>
#include <string_view>

#include "deck/draft.hpp"

namespace brisance::deck {

/// Where the shape is placed: the key to blame.
[[nodiscard]] std::string_view place_key(Section const& section);

/// Reports a shape that lies outside the domain.
void touches_domain(Draft const& draft, Section const& section, shape::Shape const& shape, char const* what = "body");

/// What two boxes share; it may be empty.
[[nodiscard]] shape::Box overlap(shape::Box const& a, shape::Box const& b);

/// Does the shape fill anything of the domain?
[[nodiscard]] bool fills(Draft const& draft, shape::Shape const& shape);

/// Inside, and not on the surface, where a gauge on a body belongs.
[[nodiscard]] bool well_inside(Draft const& draft, shape::Shape const& body, Vec3 const& p);

/// Do the bodies share points? Two balls (in 2D discs) exactly, others by points in the box that their bounds share;
/// strictly: by more points, of which those on a surface do not count.
[[nodiscard]] std::optional<Vec3> common_point(Draft const& draft, shape::Shape const& a, shape::Shape const& b,
                                               bool strictly = false);

}  // namespace brisance::deck
