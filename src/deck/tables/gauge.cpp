/// [[gauge]]: what records in time, in the gas and on bodies.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/places.hpp"
#include "deck/tables/gauge_places.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

namespace {

Table const& line_table() {
  static Table const table{"Gauges at equal spacing on a line.",
                           {position("from").required().like("[1, 0, 0]").means("First gauge"),
                            position("to").required().like("[5, 0, 0]").means("Last gauge"),
                            typed(Type::integer, "count", "1", 2, 1e5).required().like("5").means("Number of gauges")},
                           {},
                           {}};
  return table;
}

Table const& plane_table() {
  static Table const table{
      "Gauges on a parallelogram, from `origin` to `origin + edge1 + edge2`.",
      {position("origin").required().like("[0, 0, 0]").means("Corner with the first gauge"),
       position("edge1").required().like("[4, 0, 0]").means("First edge, as a vector"),
       position("edge2").required().like("[0, 4, 0]").means("Second edge, as a vector"),
       typed(Type::integers, "counts", "1", 2, 1e5).required().like("[5, 5]").means("Gauges along the two edges")},
      {},
      {}};
  return table;
}

}  // namespace

Table const& gauge_table() {
  static Table const table{
      "Gauges record time histories. In the gas: pressure, density and velocity at a `point`, on a `line` or on a "
      "`plane`, or on the face of an `obstacle`. In bodies: `body` alone records a body as a whole; `body` with "
      "`point` follows the material point of "
      "the body that is initially nearest. At most 100000 in total.",
      {typed(Type::name, "name")
           .note("`g1`, `g2`, ...; lines and planes append `-1`, `-2`, ...")
           .like("\"roof\"")
           .means("Name"),
       typed(Type::text, "body").like("\"plate\"").means("Name of a body that is recorded"),
       position("point").like("[2, 0, 1]").means("One gauge"),
       nested(Type::table, "line", line_table())
           .like("{from = [1, 0, 0], to = [5, 0, 0], count = 5}")
           .means("Gauges on a line"),
       nested(Type::table, "plane", plane_table())
           .like("{origin = [0, 0, 0], edge1 = [4, 0, 0], edge2 = [0, 4, 0], counts = [5, 5]}")
           .means("Gauges on a plane"),
       typed(Type::text, "obstacle")
           .like("\"wall\"")
           .means(
               "Name of an obstacle: one gauge in the middle of the `face` of it, which records what the wall feels"),
       word("face", {grid::face_names.begin(), grid::face_names.end()})
           .like("\"x_low\"")
           .means("Side of the obstacle: `x_low` is the one that gas flowing along +x meets"),
       typed(Type::boolean, "snap")
           .of(false)
           .like("true")
           .means("Gauges of a `point`, `line` or `plane` that lie in an obstacle, or between its cells, move to the "
                  "middle "
                  "of the nearest face of a solid cell with gas before it, instead of being refused")},
      {},
      {}};
  return table;
}

namespace {

constexpr double most_gauges = 1e5;

bool room_for_gauges(Draft const& draft, Section const& section, std::string_view key, double count) {
  if (static_cast<double>(draft.out.gauges.size()) + count <= most_gauges) return true;
  draft.error(
      section, key,
      fmt::format("{:.0f} further gauges give {:.0f} in total; allowed: at most {:.0f}; use field dumps for dense data",
                  count, static_cast<double>(draft.out.gauges.size()) + count, most_gauges));
  return false;
}

void line(Draft& draft, Section const& section, std::string const& name) {
  Section const* given = section.section("line");
  if (given == nullptr) return;
  auto const from = draft.point(*given, "from");
  auto const to = draft.point(*given, "to");
  auto const count = given->integer("count");
  if (!from || !to || !count) return;
  if (norm(*to - *from) <= draft.tiny()) {
    draft.error(*given, "to", "is the same point as `from`, so the line has no length: write one gauge with `point`");
    return;
  }
  if (!room_for_gauges(draft, *given, "count", static_cast<double>(*count))) return;
  for (long i = 0; i < *count; ++i) {
    double const s = static_cast<double>(i) / static_cast<double>(*count - 1);
    draft.out.gauges.push_back({fmt::format("{}-{}", name, i + 1), (1.0 - s) * *from + s * *to});
  }
}

void plane(Draft& draft, Section const& section, std::string const& name) {
  Section const* given = section.section("plane");
  if (given == nullptr) return;
  auto const origin = draft.point(*given, "origin");
  auto const edge1 = draft.point(*given, "edge1");
  auto const edge2 = draft.point(*given, "edge2");
  auto const* counts = given->numbers("counts");
  if (draft.dims() < 2) {
    draft.error(section, "plane", fmt::format("{} resolves x only: use a line", word_of(draft.geometry())));
    return;
  }
  if (counts != nullptr && counts->size() != 2) {
    draft.error(*given, "counts",
                fmt::format("{} has {} elements, expected two integers; write, for example, counts = [5, 5]",
                            given->shown("counts"), counts->size()));
    return;
  }
  if (!origin || !edge1 || !edge2 || counts == nullptr) return;
  double const along = dot(*edge1, *edge2);
  if (dot(*edge1, *edge1) * dot(*edge2, *edge2) - along * along <= std::pow(draft.tiny(), 4)) {
    draft.error(*given, "edge2",
                "it does not span a plane with edge1: the edges are parallel, or one of them has no length");
    return;
  }
  if (!room_for_gauges(draft, *given, "counts", (*counts)[0] * (*counts)[1])) return;
  auto const n1 = static_cast<int>((*counts)[0]);
  auto const n2 = static_cast<int>((*counts)[1]);
  for (int j = 0; j < n2; ++j) {
    for (int i = 0; i < n1; ++i) {
      Vec3 const p = *origin + (i / (n1 - 1.0)) * *edge1 + (j / (n2 - 1.0)) * *edge2;
      draft.out.gauges.push_back({fmt::format("{}-{}", name, j * n1 + i + 1), p});
    }
  }
}

/// Is a gauge between solid cells only?
bool walled_in(Draft const& draft, setup::SolidCells const& solid, Vec3 const& p) {
  // The cells that a gauge at p reads.
  grid::Domain const& domain = solid.domain();
  Index3 low{0, 0, 0};
  Vec3 part{0.0, 0.0, 0.0};
  for (int d = 0; d < draft.dims(); ++d) {
    double const position =
        std::clamp((p[d] - domain.lower[d]) / domain.h - 0.5, 0.0, static_cast<double>(domain.cells[d] - 1));
    low[d] = std::min(static_cast<int>(position), domain.cells[d] - 2);
    part[d] = position - low[d];
  }
  for (int corner = 0; corner < 1 << draft.dims(); ++corner) {
    Index3 cell = low;
    bool counts = true;
    for (int d = 0; d < draft.dims(); ++d) {
      bool const up = (corner >> d & 1) != 0;
      cell[d] += up ? 1 : 0;
      counts = counts && (up ? part[d] : 1.0 - part[d]) > 0.0;
    }
    if (counts && !solid(cell)) return false;
  }
  return true;
}

/// The nearest face of a solid cell: on the coarsest cells first, so that few fine ones are looked at.
std::optional<Vec3> nearest_face_on_levels(Draft const& draft, setup::SolidCells const& solid, Vec3 const& p) {
  if (draft.out.adaptive.obstacles == 0) return nearest_face(solid.domain(), solid, p);
  setup::SolidCells const coarse(draft.out.domain, draft.out.obstacles);
  return nearest_face(solid.domain(), solid, nearest_face(coarse.domain(), coarse, p).value_or(p));
}

/// Cells of a level in the box around an obstacle.
double cells_around(Draft const& draft, std::size_t obstacle, int level) {
  shape::CellRange const box = shape::cells_around(draft.out.obstacles[obstacle].shape, draft.out.domain_of(level));
  double cells = 1.0;
  for (int d = 0; d < draft.dims(); ++d) cells *= std::max(0, box.upper[d] - box.lower[d]);
  return cells;
}

/// The middle of a side of an obstacle: on the cells that its surface has, unless they are very many.
std::optional<Vec3> middle_on_levels(Draft const& draft, std::size_t obstacle, int side) {
  constexpr double most_cells = 2e7;
  int const wanted = draft.out.adaptive.obstacles;
  int level = wanted;
  while (level > 0 && cells_around(draft, obstacle, level) > most_cells) --level;
  setup::SolidCells const solid(draft.out.domain_of(level), draft.out.obstacles);
  auto const place = middle_of_obstacle(solid.domain(), solid, obstacle, side);
  if (!place || level == wanted) return place;
  setup::SolidCells const fine(draft.obstacle_domain(), draft.out.obstacles);
  return nearest_face(fine.domain(), fine, *place);
}

/// Moves the gauges from `first` on that lie in obstacles to their faces.
void snap(Draft& draft, setup::SolidCells const& solid, std::size_t first) {
  for (std::size_t i = first; i < draft.out.gauges.size(); ++i) {
    Vec3& p = draft.out.gauges[i].position;
    bool const inside = std::any_of(draft.obstacle_shapes.begin(), draft.obstacle_shapes.end(),
                                    [&](auto const& obstacle) { return well_inside(draft, obstacle.second, p); });
    if (!inside && !walled_in(draft, solid, p)) continue;
    if (auto const face = nearest_face_on_levels(draft, solid, p)) p = *face;
  }
}

void obstacle_gauge(Draft& draft, Section const& section, std::string const& name) {
  auto const wanted = section.text("obstacle");
  auto const face = section.text("face");
  if (!wanted || section.broken("face")) return;
  if (!face) {
    draft.error(section, "obstacle",
                "a gauge on an obstacle needs its side; write, for example, face = \"x_low\" for the side that gas "
                "flowing along +x meets");
    return;
  }
  std::vector<std::string> names;
  for (auto const& obstacle : draft.out.obstacles) names.push_back(obstacle.name);
  auto const found = std::find(names.begin(), names.end(), *wanted);
  if (found == names.end()) {
    draft.error(section, "obstacle",
                fmt::format("\"{}\" is the name of no obstacle; {}", *wanted, suggestion(*wanted, names, "obstacles")));
    return;
  }
  auto const side =
      static_cast<int>(std::find(grid::face_names.begin(), grid::face_names.end(), *face) - grid::face_names.begin());
  if (side >= 2 * draft.dims()) {
    draft.error(section, "face",
                fmt::format("\"{}\" is not possible in {}, which resolves {}", *face, word_of(draft.geometry()),
                            direction_list(draft.dims())));
    return;
  }
  if (!draft.domain_known || !room_for_gauges(draft, section, "obstacle", 1.0)) return;
  auto const place = middle_on_levels(draft, static_cast<std::size_t>(found - names.begin()), side);
  if (!place) {
    draft.error(section, "face",
                fmt::format("\"{}\" of obstacle \"{}\" has no gas before it: choose another side", *face, *wanted));
    return;
  }
  draft.out.gauges.push_back({name, *place});
}

/// Gauges from `first` on: unique names, in the domain, not in an obstacle unless they stand `on_faces` of its cells.
/// One error per table.
void check_gauges(Draft const& draft, Section const& section, std::string_view key, std::size_t first, bool on_faces,
                  std::set<std::string>& names) {
  bool place_reported = false;
  bool name_reported = false;
  setup::SolidCells const solid(draft.obstacle_domain(),
                                draft.domain_known ? draft.out.obstacles : std::vector<run::Obstacle>{});
  for (std::size_t i = first; i < draft.out.gauges.size(); ++i) {
    auto const& gauge = draft.out.gauges[i];
    if (!names.insert(gauge.name).second && !name_reported) {
      draft.report.error(section.place_of("name"), section.path_of("name"),
                         fmt::format("\"{}\" is used by another gauge: choose another name", gauge.name));
      name_reported = true;
    }
    if (!draft.domain_known || place_reported) continue;
    for (int d = 0; d < draft.dims() && !place_reported; ++d) {
      double const low = draft.out.domain.lower[d];
      double const high = draft.out.domain.upper(d);
      if (gauge.position[d] >= low - draft.tiny() && gauge.position[d] <= high + draft.tiny()) continue;
      draft.error(section, key,
                  fmt::format("gauge {} at {} m lies outside the domain: {} = {:.6g} m, allowed: {:.6g} to {:.6g} m",
                              gauge.name, point_text(gauge.position, draft.dims()), directions[d], gauge.position[d],
                              low, high));
      place_reported = true;
    }
    for (std::size_t k = 0; k < draft.obstacle_shapes.size() && !place_reported && !on_faces; ++k) {
      if (!well_inside(draft, draft.obstacle_shapes[k].second, gauge.position)) continue;
      draft.error(
          section, key,
          fmt::format("gauge {} at {} m lies inside obstacle[{}]: move it into the gas, or write snap = true to "
                      "move it to the nearest face",
                      gauge.name, point_text(gauge.position, draft.dims()), draft.obstacle_shapes[k].first + 1));
      place_reported = true;
    }
    if (!place_reported && solid.any() && walled_in(draft, solid, gauge.position)) {
      draft.error(section, key,
                  fmt::format("gauge {} at {} m is surrounded by solid cells of obstacles and would record nothing: "
                              "move it at least half a cell ({:.4g} m) away from the obstacle, or write snap = true to "
                              "move it to the nearest face",
                              gauge.name, point_text(gauge.position, draft.dims()), 0.5 * solid.domain().h));
      place_reported = true;
    }
    for (std::size_t k = 0; k < draft.body_shapes.size() && !place_reported; ++k) {
      if (!draft.body_shapes[k] || !well_inside(draft, *draft.body_shapes[k], gauge.position)) continue;
      draft.error(
          section, key,
          fmt::format("gauge {} at {} m lies inside {}: move it into the gas, or write body = \"{}\"", gauge.name,
                      point_text(gauge.position, draft.dims()), draft.body_names[k], draft.body_names[k]));
      place_reported = true;
    }
  }
}

/// Inside, or on the surface.
bool near_body(Draft const& draft, shape::Shape const& body, Vec3 const& p) {
  if (shape::contains(body, draft.out.domain, p)) return true;
  // On the surface round-off decides.
  for (int d = 0; d < draft.dims(); ++d) {
    for (double const side : {-1e-3, 1e-3}) {
      Vec3 q = p;
      q[d] += side * draft.out.domain.h;
      if (shape::contains(body, draft.out.domain, q)) return true;
    }
  }
  return false;
}

void body_gauge(Draft& draft, Section const& section, std::string const& name, std::set<std::string>& names) {
  if (!draft.has_bodies()) {
    draft.error(section, "body", "there is no body in this deck: remove the key, or add a [[body]]");
    return;
  }
  for (auto const* key : {"line", "plane"}) {
    if (!section.given(key)) continue;
    draft.error(section, key, "cannot be combined with body: write one gauge with a point for each place");
    return;
  }
  if (!room_for_gauges(draft, section, "body", 1.0)) return;
  auto const body_name = section.text("body");
  if (!body_name) return;
  auto const body = body_named(draft, section, "body", *body_name);
  if (!names.insert(name).second) {
    draft.report.error(section.place_of("name"), section.path_of("name"),
                       fmt::format("\"{}\" is used by another gauge: choose another name", name));
  }
  if (!body) return;
  run::ParticleGauge gauge;
  gauge.name = name;
  gauge.body = *body;
  if (section.given("point")) {
    auto const p = draft.point(section, "point");
    if (!p) return;
    gauge.point = *p;
    auto const& shape = draft.body_shapes[static_cast<std::size_t>(*body)];
    if (shape && !near_body(draft, *shape, *p)) {
      auto const b = shape::bounds(*shape);
      draft.error(section, "point",
                  fmt::format("{} lies outside {}, which extends from {} to {} m: move the gauge into it",
                              section.shown("point"), *body_name, point_text(b.lower, draft.dims()),
                              point_text(b.upper, draft.dims())));
      return;
    }
  }
  draft.out.particles.gauges.push_back(std::move(gauge));
}

}  // namespace

void build_gauges(Draft& draft) {
  auto const* all = draft.deck.sections("gauge");
  if (all == nullptr) return;
  std::set<std::string> names;
  for (std::size_t i = 0; i < all->size(); ++i) {
    Section const& section = (*all)[i];
    if (section.doubtful()) continue;
    if (section.given("body")) {
      if (!section.broken("name"))
        body_gauge(draft, section, section.text("name").value_or(fmt::format("g{}", i + 1)), names);
      continue;
    }
    int const forms = static_cast<int>(section.given("point")) + static_cast<int>(section.given("line")) +
                      static_cast<int>(section.given("plane")) + static_cast<int>(section.given("obstacle"));
    if (forms != 1) {
      draft.report.error(section.place, section.path,
                         fmt::format("a gauge has exactly one of point, line, plane and obstacle, but this one has {}; "
                                     "write, for example, point = [2, 0, 1]",
                                     forms == 0 ? "none" : std::to_string(forms)));
      continue;
    }
    if (section.given("face") && !section.given("obstacle")) {
      draft.error(section, "face", "this key is the side of an obstacle: add obstacle = \"NAME\", or remove it");
      continue;
    }
    if (section.broken("name")) continue;
    std::string const name = section.text("name").value_or(fmt::format("g{}", i + 1));
    std::size_t const before = draft.out.gauges.size();
    std::string_view key = "point";
    if (section.given("point")) {
      if (auto const p = draft.point(section, "point")) draft.out.gauges.push_back({name, *p});
    } else if (section.given("line")) {
      key = "line";
      line(draft, section, name);
    } else if (section.given("obstacle")) {
      key = "obstacle";
      obstacle_gauge(draft, section, name);
    } else {
      key = "plane";
      plane(draft, section, name);
    }
    bool const snaps = section.boolean("snap").value_or(false) && draft.domain_known && !draft.out.obstacles.empty();
    if (snaps) snap(draft, setup::SolidCells(draft.obstacle_domain(), draft.out.obstacles), before);
    check_gauges(draft, section, key, before, snaps || section.given("obstacle"), names);
  }
}

}  // namespace brisance::deck
