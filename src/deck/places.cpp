/// Where shapes lie: in the domain, in each other, in cells.
#include "deck/places.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "deck/draft.hpp"
#include "shape/shares.hpp"

namespace brisance::deck {

std::string_view place_key(Section const& section) {
  return section.given("position")    ? "position"
         : section.given("lower")     ? "lower"
         : section.given("file")      ? "file"
         : section.given("points")    ? "points"
         : section.given("translate") ? "translate"
                                      : "position";
}

void touches_domain(Draft const& draft, Section const& section, shape::Shape const& shape, char const* what) {
  if (!draft.domain_known) return;
  auto const b = shape::bounds(shape);
  for (int d = 0; d < draft.dims(); ++d) {
    if (b.upper[d] > draft.out.domain.lower[d] && b.lower[d] < draft.out.domain.upper(d)) continue;
    draft.error(
        section, place_key(section),
        fmt::format("the {} extends from {:.6g} to {:.6g} m in direction {} and lies outside the domain ({:.6g} to "
                    "{:.6g} m): move it or remove it",
                    what, b.lower[d], b.upper[d], directions[d], draft.out.domain.lower[d], draft.out.domain.upper(d)));
    return;
  }
}

shape::Box overlap(shape::Box const& a, shape::Box const& b) {
  shape::Box common;
  for (int d = 0; d < 3; ++d) {
    common.lower[d] = std::max(a.lower[d], b.lower[d]);
    common.upper[d] = std::min(a.upper[d], b.upper[d]);
  }
  return common;
}

bool fills(Draft const& draft, shape::Shape const& shape) {
  bool found = false;
  grid::Domain const domain =
      draft.out.domain_of(std::max(std::ranges::max(draft.region_levels), draft.out.adaptive.finest));
  shape::for_each_share({shape}, domain, shape::cells_around(shape, domain),
                        [&](shape::CellRange const&, std::vector<shape::Share> const&) {
                          found = true;
                          return false;
                        });
  return found;
}

bool well_inside(Draft const& draft, shape::Shape const& body, Vec3 const& p) {
  if (!shape::contains(body, draft.out.domain, p)) return false;
  for (int d = 0; d < draft.dims(); ++d) {
    for (double const side : {-1e-3, 1e-3}) {
      Vec3 q = p;
      q[d] += side * draft.out.domain.h;
      if (q[d] < draft.out.domain.lower[d] || q[d] > draft.out.domain.upper(d)) continue;
      if (!shape::contains(body, draft.out.domain, q)) return false;
    }
  }
  return true;
}

std::optional<Vec3> common_point(Draft const& draft, shape::Shape const& a, shape::Shape const& b, bool strictly) {
  auto const x = shape::bounds(a);
  auto const y = shape::bounds(b);
  Vec3 low{0.0, 0.0, 0.0};
  Vec3 high{0.0, 0.0, 0.0};
  for (int d = 0; d < draft.dims(); ++d) {
    low[d] = std::max(x.lower[d], y.lower[d]);
    high[d] = std::min(x.upper[d], y.upper[d]);
    if (high[d] - low[d] <= draft.tiny()) return std::nullopt;
  }
  auto const* s = std::get_if<shape::Sphere>(&a);
  auto const* t = std::get_if<shape::Sphere>(&b);
  if (s != nullptr && t != nullptr) {
    double const distance = norm(s->centre - t->centre);
    if (distance >= s->radius + t->radius - draft.tiny()) return std::nullopt;
    return 0.5 * (low + high);
  }
  Index3 count{1, 1, 1};
  int const samples = !strictly ? 12 : draft.dims() == 3 ? 32 : draft.dims() == 2 ? 200 : 1000;
  for (int d = 0; d < draft.dims(); ++d) count[d] = samples;
  for (int k = 0; k < count[2]; ++k) {
    for (int j = 0; j < count[1]; ++j) {
      for (int i = 0; i < count[0]; ++i) {
        Index3 const n{i, j, k};
        Vec3 p{0.0, 0.0, 0.0};
        for (int d = 0; d < draft.dims(); ++d) p[d] = low[d] + (n[d] + 0.5) / samples * (high[d] - low[d]);
        if (!shape::contains(a, draft.out.domain, p) || !shape::contains(b, draft.out.domain, p)) continue;
        if (!strictly || (well_inside(draft, a, p) && well_inside(draft, b, p))) return p;
      }
    }
  }
  return std::nullopt;
}

}  // namespace brisance::deck
