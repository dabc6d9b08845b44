/// [[constraint]]: material points whose velocity is prescribed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/places.hpp"
#include "deck/tables/history.hpp"
#include "deck/tables/tables.hpp"
#include "mpm/constrained_nodes.hpp"

namespace brisance::deck {

namespace {

Table const& motion_table() {
  static Table const table{
      "Motion over time in one direction, linear between the given times. Before the first time a velocity holds, and "
      "a "
      "displacement rests.",
      joined({typed(Type::numbers, "times", "s", 0.0, longest)
                  .note("from `file`")
                  .like("[0, \"1 ms\"]")
                  .means("Times, in increasing order"),
              typed(Type::numbers, "velocities", "m/s", -1e5, 1e5)
                  .note("from `file`")
                  .like("[0, \"10 m/s\"]")
                  .means("For `velocity`: velocities at these times"),
              typed(Type::numbers, "displacements", "m", -far, far)
                  .note("from `file`")
                  .like("[0, \"5 mm\"]")
                  .means("For `displacement`: displacements at these times; what counts is their change"),
              word("after", {"hold", "release"})
                  .of("hold")
                  .like("\"release\"")
                  .means("What follows the last time: `hold`: the last velocity or place is kept; `release`: the "
                         "constraint ends")},
             history_file_keys("velocities` or `displacements")),
      {},
      {}};
  return table;
}

}  // namespace

Table const& constraint_table() {
  static Table const table = [] {
    Key components = typed(Type::words, "components")
                         .note("all resolved directions")
                         .like("[\"x\", \"y\"]")
                         .means(
                             "For all kinds but `roller`: components of the velocity that are prescribed; with "
                             "`history` one");
    components.choices = {"x", "y", "z"};
    return Table{
        "Prescribes the velocity of material points in a volume, through the grid nodes there. Gas that slips along "
        "bodies (`mpm_region.slip`) is not constrained itself but follows the surface of constrained bodies; gas that "
        "sticks to bodies is constrained with them.",
        {word("kind", {"fixed", "roller", "velocity", "displacement"})
             .of("fixed")
             .like("\"roller\"")
             .means("`fixed`: at rest; `roller`: no motion along `normal`; `velocity`: moves with `velocity`, or with "
                    "the velocities of `history`; `displacement`: moves by the displacements of `history`"),
         nested(Type::table, "within", within_table())
             .note("everywhere, for `body`")
             .like("{shape = \"box\", lower = [0, 0, 0], upper = [0.1, 1, 1]}")
             .means("Constrained volume; `within` or `body` is required"),
         word("normal", {"x", "y", "z"})
             .note("required for a roller")
             .like("\"z\"")
             .means("For `roller`: the direction without motion"),
         velocity()
             .note("required for kind `velocity` without `history`")
             .means("For `velocity`: values of the prescribed components"),
         nested(Type::table, "history", motion_table())
             .note("required for kind `displacement`")
             .like("{times = [0, \"1 ms\"], velocities = [0, \"10 m/s\"]}")
             .means("For `velocity` and `displacement`: motion over time of the one direction of `components`"),
         std::move(components),
         typed(Type::text, "body").note("all bodies").like("\"plate\"").means("Name of the body that is constrained")},
        {},
        {}};
  }();
  return table;
}

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double most_nodes = 2e7;  ///< that are looked at to find one

/// The box whose nodes a body gives mass to in a region; -1: all bodies there that are not rigid.
shape::Box reach_of_bodies(Draft const& draft, int region, int body) {
  shape::Box reach{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (std::size_t n = 0; n < draft.body_shapes.size(); ++n) {
    if (body >= 0 ? static_cast<int>(n) != body : is_rigid(draft, n)) continue;
    if (draft.body_regions[n] != region) continue;
    auto const b = shape::bounds(*draft.body_shapes[n]);
    double const h = draft.particle_domain(static_cast<int>(n)).h;
    for (int d = 0; d < 3; ++d) {
      reach.lower[d] = std::min(reach.lower[d], b.lower[d] - h);
      reach.upper[d] = std::max(reach.upper[d], b.upper[d] + h);
    }
  }
  return reach;
}

/// A node of the grid of an MPM region within a box that all the places hold.
std::optional<Vec3> constrained_node(Draft const& draft, int number, std::vector<shape::Shape const*> const& regions,
                                     shape::Box const& within) {
  grid::Domain const domain = draft.out.domain_of(draft.region_levels[static_cast<std::size_t>(number)]);
  shape::Box box = within;
  for (shape::Shape const* region : regions) box = overlap(box, shape::bounds(*region));
  constexpr int beyond = 2;  // nodes behind an open face belong to bodies there
  Index3 first{0, 0, 0};
  Index3 last{0, 0, 0};
  double count = 1.0;
  for (int d = 0; d < draft.dims(); ++d) {
    auto const at = [&](double x) {
      return std::clamp((x - domain.lower[d]) / domain.h, -1.0 * beyond, domain.cells[d] + 1.0 * beyond);
    };
    first[d] = static_cast<int>(std::ceil(at(box.lower[d]) - 1e-5));
    last[d] = static_cast<int>(std::floor(at(box.upper[d]) + 1e-5));
    count *= std::max(0, last[d] - first[d] + 1);
  }
  if (count > most_nodes) return std::nullopt;
  for (int k = first[2]; k <= last[2]; ++k) {
    for (int j = first[1]; j <= last[1]; ++j) {
      for (int i = first[0]; i <= last[0]; ++i) {
        Index3 const node{i, j, k};
        Vec3 x{0.0, 0.0, 0.0};
        for (int d = 0; d < draft.dims(); ++d) x[d] = domain.lower[d] + node[d] * domain.h;
        bool const inside = std::all_of(regions.begin(), regions.end(), [&](shape::Shape const* region) {
          return mpm::contains_node(*region, domain, x);
        });
        if (inside) return x;
      }
    }
  }
  return std::nullopt;
}

std::string prescribed_text(mpm::Constraint const& c, int d) {
  return c.history ? std::string("a motion over time") : fmt::format("{} m/s", c.velocity[d]);
}

/// The constraint of that number against the others, at the nodes of a region.
void check_contradictions(Draft const& draft, int region, std::size_t number) {
  mpm::Constraint const& c = draft.out.particles.constraints[number];
  Section const& section = *draft.constraint_sections[number];
  shape::Box const reach = reach_of_bodies(draft, region, c.body);
  std::string_view const key = section.given("velocity")  ? "velocity"
                               : section.given("history") ? "history"
                               : section.given("kind")    ? "kind"
                                                          : "within";
  for (std::size_t m = 0; m < number; ++m) {
    mpm::Constraint const& other = draft.out.particles.constraints[m];
    if (c.body >= 0 && other.body >= 0 && c.body != other.body) continue;
    for (int d = 0; d < draft.dims(); ++d) {
      if (!c.components[static_cast<std::size_t>(d)] || !other.components[static_cast<std::size_t>(d)]) continue;
      if (!c.history && !other.history && c.velocity[d] == other.velocity[d]) continue;
      auto const node = constrained_node(draft, region, {&c.within, &other.within},
                                         overlap(reach, reach_of_bodies(draft, region, other.body)));
      if (!node) continue;
      draft.error(
          section, key,
          fmt::format("{} in direction {} contradicts {}, which prescribes {} for the same node at {} m: "
                      "separate them so that they share no node, or constrain this direction in only one of them",
                      prescribed_text(c, d), directions[d], draft.constraint_sections[m]->path,
                      prescribed_text(other, d), point_text(*node, draft.dims())));
      return;
    }
  }
  for (int f = 0; f < 2 * draft.dims(); ++f) {
    int const d = f / 2;
    Boundary const boundary = draft.out.domain.boundary[f];
    double const outwards = (f % 2 == 0 ? -1.0 : 1.0) * c.velocity[d];
    if (c.history && boundary == Boundary::wall) continue;  // it may move away from it
    if (!c.components[static_cast<std::size_t>(d)] || outwards == 0.0) continue;
    // Behind a symmetry plane is the image, which moves the other way; a wall stops what moves into it.
    if (boundary != Boundary::symmetry && (boundary != Boundary::wall || outwards < 0.0)) continue;
    double const plane = f % 2 == 0 ? draft.out.domain.lower[d] : draft.out.domain.upper(d);
    shape::Box at_plane = reach;
    // Not the nodes that a body beside the plane only reaches.
    double const h = draft.out.domain_of(draft.region_levels[static_cast<std::size_t>(region)]).h;
    if (reach.lower[d] + h > plane + draft.tiny() || reach.upper[d] - h < plane - draft.tiny()) continue;
    at_plane.lower[d] = plane - draft.tiny();
    at_plane.upper[d] = plane + draft.tiny();
    auto const node = constrained_node(draft, region, {&c.within}, at_plane);
    if (!node) continue;
    draft.warn(
        section, c.history ? "history" : "velocity",
        fmt::format("{} in direction {} contradicts the face {}, a {} that constrains the node at {} m in this "
                    "direction: keep the constraint a cell away from the face, or constrain the other directions only",
                    c.history ? prescribed_text(c, d) : fmt::format("{:g} m/s", c.velocity[d]), directions[d],
                    grid::face_names[f], boundary == Boundary::symmetry ? "symmetry plane" : "rigid wall",
                    point_text(*node, draft.dims())));
    return;
  }
}

/// A constraint holds nodes, bodies are there, and no other says something else.
void check_constraints(Draft const& draft) {
  bool const known = std::all_of(draft.body_shapes.begin(), draft.body_shapes.end(), [](auto const& s) { return s; });
  if (!draft.domain_known || !draft.boundaries_known || !known) return;
  shape::Box const everywhere = shape::bounds(shape::Everywhere{});
  std::vector<int> regions(draft.region_levels.size());
  std::iota(regions.begin(), regions.end(), 0);
  for (std::size_t n = 0; n < draft.out.particles.constraints.size(); ++n) {
    mpm::Constraint const& c = draft.out.particles.constraints[n];
    Section const& section = *draft.constraint_sections[n];
    if (c.body >= 0 && is_rigid(draft, static_cast<std::size_t>(c.body))) {
      draft.error(section, "body",
                  fmt::format("\"{}\" is rigid and keeps its velocity regardless of constraints: remove the "
                              "constraint, or set the velocity of the body",
                              draft.body_names[static_cast<std::size_t>(c.body)]));
      continue;
    }
    if (section.given("within")) {
      auto const b = shape::bounds(c.within);
      // A finer grid has all nodes of a coarser one.
      auto const finest = std::ranges::max_element(draft.region_levels);
      int const finest_region = c.body >= 0 ? draft.body_regions[static_cast<std::size_t>(c.body)]
                                            : static_cast<int>(finest - draft.region_levels.begin());
      grid::Domain const domain = draft.out.domain_of(draft.region_levels[static_cast<std::size_t>(finest_region)]);
      double const h = domain.h;
      double nodes = 1.0;
      bool outside = false;
      for (int d = 0; d < draft.dims(); ++d) {
        outside = outside || !(b.upper[d] > draft.out.domain.lower[d] && b.lower[d] < draft.out.domain.upper(d));
        nodes *= std::max(1.0, std::min((b.upper[d] - b.lower[d]) / h, 1.0 * domain.cells[d]));
      }
      if (outside) continue;  // reported
      if (nodes < most_nodes / 4.0 && !constrained_node(draft, finest_region, {&c.within}, everywhere)) {
        Section const& region = *section.section("within");
        draft.report.error(
            region.place_of(place_key(region)), region.path,
            fmt::format("it contains no grid node; nodes are at multiples of the cell size {:.6g} m from the low "
                        "corner of the domain: make it thicker than a cell, or place it over a plane of nodes",
                        h));
        continue;
      }
      auto const holds_some = [&](int of) {
        return constrained_node(draft, of, {&c.within}, reach_of_bodies(draft, of, c.body)).has_value();
      };
      if (nodes < most_nodes / 4.0 && std::ranges::none_of(regions, holds_some)) {
        draft.warn(section, "within",
                   "contains no node of a body at the start: it has no effect until a body arrives there");
      }
    }
    for (int const region : regions) check_contradictions(draft, region, n);
  }
}

/// The place and the body that a constraint holds; false after an error.
bool what_is_constrained(Draft const& draft, Section const& section, mpm::Constraint& out) {
  bool sound = true;
  if (section.given("within")) {
    Section const* region = section.section("within");
    auto const shape = region == nullptr ? std::nullopt : build_composed_shape(draft, *region);
    sound = shape.has_value();
    if (shape) {
      touches_domain(draft, *region, *shape, "shape");
      out.within = *shape;
    }
  }
  if (section.given("body")) {
    auto const name = section.text("body");
    auto const body = name ? body_named(draft, section, "body", *name) : std::nullopt;
    sound = sound && body;
    if (body) out.body = *body;
  }
  return sound;
}

/// Has the constraint the keys of its kind, and no others?
bool has_keys_of(Draft const& draft, Section const& section, std::string const& kind) {
  bool sound = true;
  auto const only_for = [&](std::string_view key, std::string_view word) {
    if (!section.given(key) || kind == word) return;
    draft.error(section, key,
                fmt::format("{} belongs to kind = \"{}\", but this kind is \"{}\": remove it or change the kind",
                            section.shown(key), word, kind));
    sound = false;
  };
  only_for("normal", "roller");
  only_for("velocity", "velocity");
  if (kind != "displacement") only_for("history", "velocity");
  auto const needs = [&](std::string_view key, std::string_view word, std::string_view example) {
    if (kind != word || section.given(key)) return;
    draft.report.error(section.place, section.path_of(key),
                       fmt::format("the key \"{}\" is missing; kind = \"{}\" requires it; write, for example, {}", key,
                                   word, example));
    sound = false;
  };
  needs("normal", "roller", "normal = \"x\"");
  if (!section.given("history")) needs("velocity", "velocity", "velocity = [10, 0, 0]");
  needs("history", "displacement", "history = {times = [0, 1], displacements = [0, \"5 mm\"]}");
  if (section.given("history") && section.given("velocity")) {
    draft.error(section, "velocity", "is given together with history: remove one of the two");
    sound = false;
  }
  return sound;
}

/// The directions in which a constraint holds; false after an error.
bool constrained_components(Draft const& draft, Section const& section, std::string const& kind, mpm::Constraint& out) {
  std::vector<std::string> components;
  components.reserve(3);
  for (int d = 0; d < draft.dims(); ++d) components.emplace_back(1, directions[d]);
  std::string_view key = "components";
  if (kind == "roller") {
    if (section.given("components")) {
      draft.error(section, "components",
                  "a roller constrains the direction of its normal only: remove the key, or write kind = \"fixed\"");
      return false;
    }
    key = "normal";
    auto const normal = section.text("normal");
    if (!normal) return false;
    components = {*normal};
  } else if (section.given("components")) {
    auto const* given = section.strings("components");
    if (given == nullptr) return false;
    components = *given;
  }
  out.components = {false, false, false};
  for (std::string const& letter : components) {
    int const d = letter[0] - 'x';
    if (d >= draft.dims()) {
      draft.error(section, key,
                  fmt::format("\"{}\" is not resolved in {}: remove it", letter, word_of(draft.geometry())));
      return false;
    }
    out.components[static_cast<std::size_t>(d)] = true;
  }
  if (components.empty()) {
    draft.error(section, key,
                "the list is empty, so nothing would be constrained; write, for example, components = [\"x\"]");
    return false;
  }
  return true;
}

/// The velocity that a constraint prescribes; false after an error.
bool prescribed_velocity(Draft const& draft, Section const& section, mpm::Constraint& out) {
  auto const velocity = draft.point(section, "velocity");
  if (!velocity) return false;
  out.velocity = *velocity;
  for (int d = 0; d < draft.dims(); ++d) {
    if (out.components[static_cast<std::size_t>(d)] || out.velocity[d] == 0.0) continue;
    draft.error(
        section, "velocity",
        fmt::format("{} has a value in direction {}, which is not constrained: add \"{}\" to components or write 0",
                    section.shown("velocity"), directions[d], directions[d]));
    return false;
  }
  return true;
}

/// The motion over time that a constraint prescribes in one direction; false after an error.
bool prescribed_history(Draft& draft, Section const& section, bool displacement, mpm::Constraint& out) {
  Section const* history = section.section("history");
  if (history == nullptr || history->doubtful()) return false;
  auto const& held = out.components;
  if (std::count(held.begin(), held.end(), true) != 1) {
    draft.error(section, section.given("components") ? "components" : "history",
                "a history moves one direction: name it; write, for example, components = [\"x\"]");
    return false;
  }
  std::string_view const values = displacement ? "displacements" : "velocities";
  std::string_view const other = displacement ? "velocities" : "displacements";
  if (history->given(other)) {
    draft.error(*history, other,
                fmt::format("belongs to kind = \"{}\": change the kind, or give {}",
                            displacement ? "velocity" : "displacement", values));
    return false;
  }
  auto read = build_history(draft, *history, values);
  if (!read || history->broken("after")) return false;
  for (std::size_t n = 1; displacement && n < read->times.size(); ++n) {
    double const speed = (read->values[n] - read->values[n - 1]) / (read->times[n] - read->times[n - 1]);
    if (std::abs(speed) <= 1e5) continue;
    draft.error(*history, history->given("file") ? "file" : "displacements",
                fmt::format("between {:g} and {:g} s it moves at {:g} m/s; allowed: -100000 to 100000 m/s",
                            read->times[n - 1], read->times[n], speed));
    return false;
  }
  for (std::size_t d = 0; d < 3; ++d) out.velocity[d] = held[d] ? 1.0 : 0.0;
  bool const release = history->text("after") == "release";
  out.history = mpm::MotionHistory{std::move(read->times), std::move(read->values), displacement, release};
  return true;
}

void constraint(Draft& draft, Section const& section) {
  auto const kind = section.text("kind");
  if (!kind || section.doubtful()) return;
  mpm::Constraint out;
  out.within = shape::Everywhere{};
  if (!section.given("within") && !section.given("body")) {
    draft.report.error(section.place, section.path,
                       "a constraint needs the volume or the body on which it acts; write, for example, within = "
                       "{shape = \"box\", lower = [0, 0, 0], upper = [0.1, 1, 1]}");
    return;
  }
  bool sound = what_is_constrained(draft, section, out);
  sound = has_keys_of(draft, section, *kind) && sound;
  if (!constrained_components(draft, section, *kind, out)) return;
  if (*kind == "velocity" && section.given("velocity") && !prescribed_velocity(draft, section, out)) return;
  if (sound && section.given("history") && !prescribed_history(draft, section, *kind == "displacement", out)) return;
  if (!sound) return;
  draft.out.particles.constraints.push_back(std::move(out));
  draft.constraint_sections.push_back(&section);
}

}  // namespace

void build_constraints(Draft& draft) {
  draft.each("constraint", [&](Section const& section) { constraint(draft, section); });
  check_constraints(draft);
}

}  // namespace brisance::deck
