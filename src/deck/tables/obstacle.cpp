/// [[obstacle]]: rigid bodies in the gas; each makes cells solid, and no gas flows through it.
#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"
#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/places.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"
#include "setup/place_obstacles.hpp"
#include "setup/place_panels.hpp"

namespace brisance::deck {

namespace {

Settings<run::Release> const& settings() {
  using R = run::Release;
  static Settings<R> const all{
      {&R::pressure, number("fails_at", "Pa", 1e-3, 1e13)
                         .note("never")
                         .like("\"10 kPa\"")
                         .means("The obstacle fails as a whole when the difference between the mean pressures on its "
                                "two sides reaches this value, in either direction. The sides are those in the "
                                "direction in which the obstacle is thinnest and has gas on both sides")},
      {&R::areal_mass,
       number("areal_mass", "kg/m2", 1e-6, 1e6)
           .note("none: the whole panel opens at once")
           .like("\"10 kg/m2\"")
           .means("Mass of the panel per area. After failure the panel moves as a rigid body, accelerated by the "
                  "pressure difference; the open area is its perimeter times its travel, up to its own area")}};
  return all;
}

}  // namespace

Table const& obstacle_table() {
  static Table const table{
      "A rigid body in the gas. The gas sees the part of every cell, and of every face between cells, that obstacles "
      "leave open. With numerics.obstacles = \"stairs\", with Lax-Wendroff and in decks with panels a cell is solid if "
      "obstacles fill at least half of its volume; then an obstacle that makes no cell solid is rejected, as is a wall "
      "so thin that gas would pass between its solid cells. With "
      "`fails_at` it is a panel that fails: a vent, a door or a window. An obstacle replaces earlier obstacles where "
      "they overlap: a panel written after a wall makes an opening in the wall.",
      joined(joined({typed(Type::name, "name").note("`obstacle-1`, ...").like("\"wall\"").means("Name")}, shape_keys()),
             settings().keys()),
      {},
      {}};
  return table;
}

namespace {

constexpr std::size_t most_obstacles = 1000;
constexpr long most_looks = 1'000'000;  ///< at cells, to find a gap in a wall

/// An obstacle that gives way has gas on both its sides, and an edge where it needs one.
void check_panels(Draft const& draft, setup::SolidCells const& solid) {
  auto const& sections = *draft.deck.sections("obstacle");
  for (std::size_t n = 0; n < draft.out.obstacles.size(); ++n) {
    if (!draft.out.obstacles[n].release) continue;
    Section const& section = sections[draft.obstacle_shapes[n].first];
    try {
      (void)setup::place_panel(draft.obstacle_domain(), draft.out.obstacles, solid, n);
    } catch (InputError const& problem) {
      draft.error(section, "fails_at", problem.what());
    }
  }
}

/// Warns of gaps beside boxes that are narrower than a cell and would be closed.
void closed_gaps(Draft const& draft, setup::SolidCells const& solid) {
  grid::Domain const domain = draft.obstacle_domain();
  auto const& sections = *draft.deck.sections("obstacle");
  auto const look = [&](std::size_t n, int d, double from, double to, shape::Box const& across, int other) {
    if (to - from <= draft.tiny() || to - from >= domain.h) return;
    Vec3 middle{0.0, 0.0, 0.0};
    Index3 cell{0, 0, 0};
    for (int k = 0; k < draft.dims(); ++k) {
      if (k != d && across.upper[k] - across.lower[k] <= draft.tiny()) return;
      middle[k] = k == d ? 0.5 * (from + to) : 0.5 * (across.lower[k] + across.upper[k]);
      double const at = (middle[k] - domain.lower[k]) / domain.h;
      if (at < 0.0 || at >= domain.cells[k]) return;
      cell[k] = static_cast<int>(at);
    }
    if (!solid(cell)) return;
    Section const& section = sections[draft.obstacle_shapes[n].first];
    std::string const what =
        other < 0 ? fmt::format("the face {}", grid::face_names[static_cast<std::size_t>(-1 - other)])
                  : fmt::format("obstacle[{}]", draft.obstacle_shapes[static_cast<std::size_t>(other)].first + 1);
    draft.warn(
        section, place_key(section),
        fmt::format("the gap of {:.4g} m between it and {} at {} m is narrower than a cell and will be closed: "
                    "use cells of {:.3g} m or less ({}) to keep it open",
                    to - from, what, point_text(middle, draft.dims()), 0.5 * (to - from), draft.obstacle_cell_key()));
  };
  auto const box_of = [&](std::size_t n) { return std::get_if<shape::Box>(&draft.out.obstacles[n].shape); };
  for (std::size_t n = 0; n < draft.out.obstacles.size(); ++n) {
    shape::Box const* const a = box_of(n);
    if (a == nullptr) continue;
    for (int d = 0; d < draft.dims(); ++d) {
      look(n, d, domain.lower[d], a->lower[d], *a, -1 - 2 * d);
      look(n, d, a->upper[d], domain.upper(d), *a, -2 - 2 * d);
      for (std::size_t m = 0; m < n; ++m) {
        shape::Box const* const b = box_of(m);
        if (b == nullptr) continue;
        look(n, d, b->upper[d], a->lower[d], overlap(*a, *b), static_cast<int>(m));
        look(n, d, a->upper[d], b->lower[d], overlap(*a, *b), static_cast<int>(m));
      }
    }
  }
}

/// An obstacle makes cells solid, and no gas flows through it.
void check_obstacles(Draft const& draft) {
  if (!draft.domain_known || draft.out.obstacles.empty()) return;
  auto const& sections = *draft.deck.sections("obstacle");
  setup::SolidCells const solid(draft.obstacle_domain(), draft.out.obstacles);
  double const h = draft.obstacle_domain().h;
  bool sound = true;
  for (std::size_t n = 0; n < draft.out.obstacles.size(); ++n) {
    shape::Shape const& shape = draft.out.obstacles[n].shape;
    auto const b = shape::bounds(shape);
    bool outside = false;
    int thin = 0;  // directions in which it is
    for (int d = 0; d < draft.dims(); ++d) {
      outside = outside || !(b.upper[d] > draft.out.domain.lower[d] && b.lower[d] < draft.out.domain.upper(d));
      thin += b.upper[d] - b.lower[d] < 2.0 * h ? 1 : 0;
    }
    if (outside || setup::has_cut_cells(draft.out) || !solid.vanishes(n)) continue;  // outside: reported
    sound = false;
    Section const& section = sections[draft.obstacle_shapes[n].first];
    double const t = solid.thickness(n);
    double const cell = std::min(std::holds_alternative<shape::Box>(shape) && thin == 1 ? t : 0.5 * t, 0.5 * h);
    draft.error(section, place_key(section),
                fmt::format("the obstacle fills less than half of every cell, so it would not affect the gas: it is "
                            "{:.4g} m thick and a cell is {:.4g} m; make the cells {:.3g} m or smaller ({}), "
                            "make the obstacle thicker, or align its faces with cell faces",
                            t, h, cell, draft.obstacle_cell_key()));
  }
  if (!sound || setup::has_cut_cells(draft.out)) return;
  closed_gaps(draft, solid);
  long left = most_looks;
  auto const leak = solid.leak(left);
  if (!leak && left <= 0) {
    draft.report.warning(
        sections.front().place, "obstacle",
        "obstacles have too many surface cells to check all of them for walls that are too thin to hold the gas");
  }
  if (!leak) {
    check_panels(draft, solid);
    return;
  }
  Section const& section = sections[draft.obstacle_shapes[leak->obstacle].first];
  double const t = solid.thickness(leak->obstacle);
  draft.error(section, place_key(section),
              fmt::format("gas would flow through the obstacle at {} m, where it fills less than half of the cells: it "
                          "is too thin there for cells of {:.4g} m; make the cells {:.3g} m or smaller ({}), "
                          "make the obstacle thicker, or align its faces with cell faces",
                          point_text(leak->place, draft.dims()), h, t < 2.0 * h ? std::min(t, 0.5 * h) : 0.5 * h,
                          draft.obstacle_cell_key()));
}

}  // namespace

void build_obstacles(Draft& draft) {
  auto const* all = draft.deck.sections("obstacle");
  if (all == nullptr) return;
  if (all->size() > most_obstacles) {
    draft.error(draft.deck, "obstacle",
                fmt::format("there are {} obstacles; allowed: at most {}", all->size(), most_obstacles));
    return;
  }
  for (std::size_t i = 0; i < all->size(); ++i) {
    Section const& section = (*all)[i];
    auto const body = build_shape(draft, section, Use::gas, std::nullopt);
    if (!body) continue;
    touches_domain(draft, section, *body, "obstacle");
    draft.obstacle_shapes.emplace_back(i, *body);
    draft.out.obstacles.push_back({section.text("name").value_or(fmt::format("obstacle-{}", i + 1)), *body});
    run::Release release;
    settings().read(section, release);
    if (section.number("fails_at")) draft.out.obstacles.back().release = release;
    if (section.number("areal_mass") && !section.given("fails_at")) {
      draft.error(section, "areal_mass",
                  "this key is the mass of a panel that fails, but this obstacle does not fail: add fails_at, the "
                  "pressure difference at failure, or remove the key");
    }
  }
  auto const fails = std::find_if(draft.out.obstacles.begin(), draft.out.obstacles.end(),
                                  [](run::Obstacle const& o) { return o.release.has_value(); });
  if (draft.out.numerics.obstacles == run::ObstacleCells::cut && fails != draft.out.obstacles.end()) {
    auto const n = static_cast<std::size_t>(fails - draft.out.obstacles.begin());
    draft.error((*all)[draft.obstacle_shapes[n].first], "fails_at",
                "an obstacle that fails makes whole cells solid and opens them: with it numerics.obstacles must be "
                "\"stairs\" or \"auto\"");
    return;
  }
  check_obstacles(draft);
}

}  // namespace brisance::deck
