/// [[surface_pressure]]: pressures on the surfaces of bodies.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/places.hpp"
#include "deck/tables/history.hpp"
#include "deck/tables/tables.hpp"
#include "shape/shares.hpp"

namespace brisance::deck {

namespace {

Table const& history_table() {
  static Table const table{
      "Pressure over time: linear between the given times, zero before the first and after the last.",
      joined({typed(Type::numbers, "times", "s", 0.0, longest)
                  .note("from `file`")
                  .like("[0, \"0.1 ms\"]")
                  .means("Times, in increasing order"),
              typed(Type::numbers, "pressures", "Pa", -1e13, 1e13)
                  .note("from `file`")
                  .like("[\"2 MPa\", 0]")
                  .means("Pressures at these times")},
             history_file_keys("pressures")),
      {},
      {}};
  return table;
}

}  // namespace

Table const& surface_pressure_table() {
  static Table const table{
      "A pressure on the surface of a body, applied with the true normal and area of the surface. With `normal` it "
      "acts on the part that is visible from that side, so that the force is the pressure times the projected area of "
      "the body. Without `normal` it acts on the whole surface, or on all of it inside `within`. The layer of material "
      "points below the surface carries the pressure. Areas and normals are those of the initial geometry.",
      {typed(Type::text, "body").note("the only body").like("\"plate\"").means("Name of the body"),
       face_normal("normal")
           .note("all sides")
           .like("\"+z\"")
           .means(
               "Side from which the pressure acts: `+z` loads what is visible from above and pushes a flat top down"),
       nested(Type::table, "within", within_table())
           .note("everywhere")
           .like("{shape = \"cylinder\", radius = \"50 mm\", length = 1}")
           .means("Volume that contains the loaded part of the surface"),
       number("thickness", "m", smallest, far)
           .note("one layer of particles")
           .like("\"1 mm\"")
           .means("Depth of the layer that carries the pressure, rounded to whole layers of particles"),
       nested(Type::table, "history", history_table())
           .note("from `pressure`")
           .like("{times = [0, \"0.1 ms\"], pressures = [\"2 MPa\", 0]}")
           .means("Pressure over time; instead of `pressure`"),
       number("pressure", "Pa", -1e13, 1e13)
           .note("from `history`")
           .like("\"2 MPa\"")
           .means("A constant pressure; instead of `history`"),
       number("duration", "s", 1e-12, longest)
           .note("until the end")
           .like("\"0.1 ms\"")
           .means("Duration of a constant pressure, from the start")},
      {},
      {}};
  return table;
}

namespace {

constexpr double endless = 1e5;  ///< longer than any simulation [s]

/// Length of the pieces of a loaded surface in layers of particles.
constexpr double facets_per_layer = 1.0 / 3.0;

/// Unit vector of "+x", "-x", ...
Vec3 signed_normal(std::string const& word) {
  Vec3 normal{0.0, 0.0, 0.0};
  normal[word[1] - 'x'] = word[0] == '-' ? -1.0 : 1.0;
  return normal;
}

bool pressure_history(Draft& draft, Section const& section, mpm::SurfacePressure& pressure) {
  bool const constant = section.given("pressure");
  if (constant == section.given("history")) {
    draft.report.error(section.place, section.path,
                       fmt::format("a surface pressure has either pressure or history, but this one has {}; write, for "
                                   "example, pressure = \"2 MPa\" and duration = \"0.1 ms\"",
                                   constant ? "both" : "none"));
    return false;
  }
  if (constant) {
    auto const value = section.number("pressure");
    if (!value || section.broken("duration")) return false;
    pressure.times = {0.0, section.number("duration").value_or(endless)};
    pressure.pressures = {*value, *value};
    return true;
  }
  if (section.given("duration")) {
    draft.error(section, "duration",
                "applies to a constant pressure only; a history ends at its last time: remove the key");
    return false;
  }
  Section const* history = section.section("history");
  if (history == nullptr) return false;
  auto read = build_history(draft, *history, "pressures");
  if (!read) return false;
  pressure.times = std::move(read->times);
  pressure.pressures = std::move(read->values);
  std::vector<double> const& times = pressure.times;
  std::vector<double> const& pressures = pressure.pressures;
  std::size_t acts = 0;
  while (acts < pressures.size() && pressures[acts] == 0.0) ++acts;
  if (acts == pressures.size()) {
    draft.warn(*history, history->given("file") ? "file" : "pressures", "all pressures are 0: the load has no effect");
  } else {
    draft.onsets.push_back({&section, times[acts > 0 ? acts - 1 : 0], "history", "never acts"});
  }
  return true;
}

/// Does a box look to one side with all of a flat face? What else it may be, the surface itself tells.
bool is_flat_face(Draft const& draft, shape::Shape const& body, int direction, double face) {
  auto const* box = std::get_if<shape::Box>(&body);
  if (box == nullptr || (direction == 0 && grid::radial_exponent(draft.geometry()) > 0)) return false;
  return std::abs(face - box->lower[direction]) < draft.tiny() || std::abs(face - box->upper[direction]) < draft.tiny();
}

bool curved_layer(Draft const& draft, Section const& section, double specified, double layer,
                  mpm::SurfacePressure& pressure) {
  pressure.thickness = std::max(1.0, std::round(specified / layer)) * layer;
  if (!section.given("thickness") || specified < 8.0 * layer + draft.tiny()) return true;
  draft.error(section, "thickness",
              fmt::format("{} is more than eight layers of particles of {:.4g} m each: make it smaller",
                          section.shown("thickness"), layer));
  return false;
}

/// Has the body particles in the loaded layer of a surface pressure?
bool has_particles_in(Draft const& draft, grid::Domain fine, shape::Shape const& body, shape::Shape const& layer,
                      long particles_per_cell) {
  fine.h /= static_cast<double>(particles_per_cell);
  for (int d = 0; d < draft.dims(); ++d) fine.cells[d] *= static_cast<int>(particles_per_cell);
  shape::CellRange range = shape::cells_around(body, fine);
  shape::CellRange const near = shape::cells_around(layer, fine);
  for (int d = 0; d < 3; ++d) {
    range.lower[d] = std::max(range.lower[d], near.lower[d]);
    range.upper[d] = std::min(range.upper[d], near.upper[d]);
  }
  for (int k = range.lower[2]; k < range.upper[2]; ++k) {
    for (int j = range.lower[1]; j < range.upper[1]; ++j) {
      for (int i = range.lower[0]; i < range.upper[0]; ++i) {
        if (!shape::contains(layer, fine, fine.centre({i, j, k}))) continue;
        if (!shape::shares_of_cell({body}, fine, {i, j, k}, 8).empty()) return true;
      }
    }
  }
  return false;
}

/// The part of a body that a pressure loads.
struct Loaded {
  shape::Shape const& body;
  shape::Shape within;  ///< of space
  shape::Box reach;     ///< of the body in it
  grid::Domain cells;   ///< that its particles see
  long per_cell;        ///< particles of the body, per direction
  double layer;         ///< thickness of a layer of particles [m]
  double specified;     ///< thickness of what takes the pressure [m]
  int direction = 0;    ///< that the pressure comes from, where it has one
  bool high = true;     ///< from its high side
  double face = 0.0;    ///< where the body ends there [m]
};

/// Does the place meet the body? Narrows `reach` to what they share.
bool meets(Draft const& draft, Section const& section, shape::Shape const& region, shape::Box& reach) {
  auto const b = reach;
  auto const r = shape::bounds(region);
  for (int d = 0; d < draft.dims(); ++d) {
    reach.lower[d] = std::max(b.lower[d], r.lower[d]);
    reach.upper[d] = std::min(b.upper[d], r.upper[d]);
    if (reach.upper[d] - reach.lower[d] > draft.tiny()) continue;
    draft.error(section, "within",
                fmt::format("it extends from {:.6g} to {:.6g} m in direction {} and does not meet the body, which "
                            "extends from {:.6g} to {:.6g} m: move it",
                            r.lower[d], r.upper[d], directions[d], b.lower[d], b.upper[d]));
    return false;
  }
  return true;
}

/// What is loaded; none after an error, or where the body has one.
std::optional<Loaded> loaded_part(Draft const& draft, Section const& section, std::size_t number) {
  shape::Shape region = shape::Everywhere{};
  if (section.given("within")) {
    Section const* given = section.section("within");
    auto const shape = given == nullptr ? std::nullopt : build_composed_shape(draft, *given);
    if (!shape) return std::nullopt;
    region = *shape;
  }
  if (section.broken("thickness")) return std::nullopt;
  if (is_rigid(draft, number)) {
    draft.report.error(section.place_of("body"), section.path_of("body"),
                       fmt::format("\"{}\" is rigid and keeps its velocity regardless of loads: remove the pressure",
                                   draft.body_names[number]));
    return std::nullopt;
  }
  auto const& body = draft.body_shapes[number];
  if (!body || !draft.domain_known) return std::nullopt;  // reported where the body is defined
  auto const per_cell = (*draft.deck.sections("body"))[number].integer("points_per_cell");
  if (!per_cell) return std::nullopt;
  auto const b = shape::bounds(*body);
  shape::Box reach{b.lower, b.upper};
  if (section.given("within") && !meets(draft, section, region, reach)) return std::nullopt;
  grid::Domain const cells = draft.particle_domain(static_cast<int>(number));
  double const layer = cells.h / static_cast<double>(*per_cell);
  return Loaded{*body, std::move(region), reach, cells, *per_cell, layer, section.number("thickness").value_or(layer)};
}

/// Is there so much of the body below the loaded face?
bool deep_enough(Draft const& draft, Section const& section, Loaded const& part) {
  double const depth = part.reach.upper[part.direction] - part.reach.lower[part.direction];
  if (part.specified <= depth + draft.tiny()) return true;
  bool const given = section.given("thickness");
  draft.error(
      section,
      given                     ? "thickness"
      : section.given("within") ? "within"
                                : "normal",
      given ? fmt::format("{} is more than the thickness of the body below the loaded face, {:.6g} m: make it smaller",
                          section.shown("thickness"), depth)
            : fmt::format("a layer of particles is {:.6g} m thick, more than the body below the loaded face, {:.6g} m: "
                          "make the body thicker",
                          part.specified, depth));
  return false;
}

/// The pieces of the surface that are seen from the side of the pressure; `flat` tells whether they are all in the
/// face.
std::vector<shape::Facet> seen_surface(Draft const& draft, Loaded const& part, Vec3 const& normal, bool& flat) {
  std::vector<shape::Facet> facets;
  flat = true;
  for (shape::Facet const& f : shape::surface(part.body, part.within, part.cells, facets_per_layer * part.layer)) {
    double const along = dot(f.area, normal) / norm(f.area);
    if (along < 1e-9 || !shape::is_clear(part.body, part.cells, f.x, normal, 0.05 * part.layer)) continue;
    flat = flat && along > 1.0 - 1e-9 && std::abs(f.x[part.direction] - part.face) < draft.tiny();
    facets.push_back(f);
  }
  return facets;
}

/// The layer below a flat face.
bool flat_layer(Draft const& draft, Section const& section, Loaded const& part, mpm::SurfacePressure& pressure) {
  // The inner side of the layer lies where sub-cells end, so that their particles hold just its volume. A sub-cell that
  // the body fills by less than a half does not count as a layer.
  int const d = part.direction;
  double const inner = part.high ? part.face - part.specified : part.face + part.specified;
  double const origin = draft.out.domain.lower[d];
  double side = origin + std::round((inner - origin) / part.layer) * part.layer;
  if (std::abs(part.face - side) < 0.5 * part.layer) side += part.high ? -part.layer : part.layer;
  pressure.thickness = std::abs(part.face - side);
  shape::Box slab;
  for (int k = 0; k < 3; ++k) {
    slab.lower[k] = k < draft.dims() ? draft.out.domain.lower[k] - draft.out.domain.h : -1.0;
    slab.upper[k] = k < draft.dims() ? draft.out.domain.upper(k) + draft.out.domain.h : 1.0;
  }
  // Outwards it reaches over the centres of sub-cells that the face cuts.
  slab.lower[d] = part.high ? side : part.face - part.layer;
  slab.upper[d] = part.high ? part.face + part.layer : side;
  pressure.within =
      section.given("within") ? shape::combine(shape::Operation::intersection, {part.within, slab}) : slab;
  if (has_particles_in(draft, part.cells, part.body, pressure.within, part.per_cell)) return true;
  draft.report.error(section.place_of("within"), section.path_of(section.given("within") ? "within" : "normal"),
                     fmt::format("no material point of the body lies in the loaded layer, {:.4g} m below the face at "
                                 "{} = {:.6g} m: move it, or make it larger than the particle spacing, {:.4g} m",
                                 pressure.thickness, directions[d], part.face, part.layer));
  return false;
}

/// The layer below the loaded face in whole layers of particles; false when the body has none there (reported).
bool loaded_layer(Draft const& draft, Section const& section, mpm::SurfacePressure& pressure) {
  auto part = loaded_part(draft, section, static_cast<std::size_t>(pressure.body));
  if (!part) return false;
  if (!section.given("normal")) {
    pressure.surface = shape::surface(part->body, part->within, part->cells, facets_per_layer * part->layer);
    if (pressure.surface.empty()) {
      draft.report.error(section.place_of("within"), section.path_of("within"),
                         "it contains no part of the surface of the body: move it, or make it larger");
      return false;
    }
    return curved_layer(draft, section, part->specified, part->layer, pressure);
  }
  part->direction = pressure.normal[0] != 0.0 ? 0 : pressure.normal[1] != 0.0 ? 1 : 2;
  part->high = pressure.normal[part->direction] > 0.0;
  part->face = part->high ? part->reach.upper[part->direction] : part->reach.lower[part->direction];
  if (!deep_enough(draft, section, *part)) return false;
  if (!is_flat_face(draft, part->body, part->direction, part->face)) {
    bool flat = true;
    auto facets = seen_surface(draft, *part, pressure.normal, flat);
    if (facets.empty()) {
      std::string_view const key = section.given("within") ? "within" : "normal";
      draft.report.error(
          section.place_of(key), section.path_of(key),
          fmt::format("no part of the surface of the body{} is visible from side {}: {}",
                      section.given("within") ? " inside it" : "", *section.text("normal"),
                      section.given("within") ? "move it, or make it larger"
                                              : "give another normal, or omit it to load the whole surface"));
      return false;
    }
    if (!flat || (part->direction == 0 && draft.radial())) {
      pressure.surface = std::move(facets);
      return curved_layer(draft, section, part->specified, part->layer, pressure);
    }
  }
  return flat_layer(draft, section, *part, pressure);
}

void surface_pressure(Draft& draft, Section const& section) {
  if (section.doubtful()) return;
  mpm::SurfacePressure out;
  bool sound = pressure_history(draft, section, out);
  if (section.given("body")) {
    auto const name = section.text("body");
    auto const body = name ? body_named(draft, section, "body", *name) : std::nullopt;
    if (!body) return;
    out.body = *body;
  } else if (draft.body_names.size() > 1) {
    draft.report.error(
        section.place, section.path_of("body"),
        fmt::format("there are several bodies: name the one that is loaded; write, for example, body = \"{}\"",
                    draft.body_names.front()));
    return;
  }
  if (section.broken("normal") || draft.body_names.empty()) return;
  if (section.given("normal")) {
    std::string const normal = *section.text("normal");
    out.normal = signed_normal(normal);
    if (normal[1] - 'x' >= draft.dims()) {
      draft.error(section, "normal",
                  fmt::format("\"{}\" is not resolved in {}, which resolves {} direction{}", normal,
                              word_of(draft.geometry()), draft.dims(), draft.dims() > 1 ? "s" : ""));
      return;
    }
  }
  sound = loaded_layer(draft, section, out) && sound;
  if (sound) draft.out.particles.pressures.push_back(std::move(out));
}

}  // namespace

void build_surface_pressures(Draft& draft) {
  draft.each("surface_pressure", [&](Section const& section) { surface_pressure(draft, section); });
}

}  // namespace brisance::deck
