/// The material points of a deck: bodies, what holds and loads them, and their gauges.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "deck/build.hpp"
#include "shape/placement.hpp"

namespace brisance::deck {

namespace {

constexpr std::size_t most_bodies = 100;
constexpr double lightest_metal = 1500.0;  ///< [kg/m3]; a fluid that is heavier was perhaps meant as a solid
constexpr double endless = 1e5;            ///< longer than any calculation [s]

/// A body's material in its state at the start.
material::Solid as_it_starts(run::Body const& body) {
  material::Solid start = body.solid;
  start.density = body.density.value_or(start.density);
  start.specific_energy = body.specific_energy.value_or(start.specific_energy);
  return start;
}

/// Unit vector of "+x", "-x", ...
Vec3 signed_normal(std::string const& word) {
  Vec3 normal{0.0, 0.0, 0.0};
  normal[word[1] - 'x'] = word[0] == '-' ? -1.0 : 1.0;
  return normal;
}

}  // namespace

// --- what does not go together

void Builder::warn_of_unused_gas() {
  for (auto const* key : {"ambient", "numerics"}) {
    if (!deck_.given(key)) continue;
    report_.warning(deck_.place_of(key), key,
                    "has no effect: nothing in this deck is of gas, and its bodies move in empty space; with "
                    "[mpm_region] they stand in the ambient gas");
  }
}

void Builder::refuse_inflow(Section const* boundaries) {
  for (int f = 0; f < 2 * dims(); ++f) {
    if (out_.domain.boundary[f] != Boundary::inflow) continue;
    error(
        *boundaries, boundaries->given(grid::face_names[f]) ? grid::face_names[f] : "all",
        "\"inflow\" is not possible here: the bodies of this deck move in empty space; allowed: \"outflow\", \"wall\", "
        "\"symmetry\" or \"periodic\"; with [mpm_region] there is gas");
    return;
  }
}

void Builder::refuse_points() {
  for (auto const* key : {"constraint", "contact", "surface_pressure", "reinforcement"}) {
    auto const* all = deck_.sections(key);
    if (all == nullptr || all->empty()) continue;
    report_.error(all->front().place, all->front().path,
                  "there is no body that this could act on: add a [[body]] or remove it");
  }
  if (deck_.given("points") && !deck_.given("mpm_region")) {
    report_.warning(deck_.place_of("points"), "points", "has no effect in a deck without bodies");
  }
}

// --- bodies

void Builder::bodies() {
  auto const* all = deck_.sections("body");
  if (all == nullptr) return;
  if (all->empty()) {
    error(deck_, "body", "the list of bodies is empty: remove the key, or write [[body]]");
    return;
  }
  if (all->size() > most_bodies) {
    error(deck_, "body", fmt::format("there are {} bodies; allowed: at most {}", all->size(), most_bodies));
    return;
  }
  for (std::size_t i = 0; i < all->size(); ++i) {
    Section const& section = (*all)[i];
    std::string const name = section.text("name").value_or(fmt::format("body-{}", i + 1));
    if (std::find(body_names_.begin(), body_names_.end(), name) != body_names_.end()) {
      report_.error(section.place_of("name"), section.path_of("name"),
                    fmt::format("\"{}\" is used by another body: choose another name", name));
    }
    if (has_gas_ && name == "gas") {
      report_.error(section.place_of("name"), section.path_of("name"),
                    "\"gas\" is the name of the gas points of the MPM region: choose another name");
    }
    body_names_.push_back(name);
    body_shapes_.emplace_back();
  }
  for (std::size_t i = 0; i < all->size(); ++i) body((*all)[i], i);
  overlaps();
}

void Builder::body(Section const& section, std::size_t index) {
  run::Body body;
  body.name = body_names_[index];
  auto const shape = composed_shape(section);
  if (shape) {
    body.shape = *shape;
    if (domain_known_ && boundaries_known_ && body_fits(section, *shape)) body_shapes_[index] = shape;
  }
  bool sound = shape.has_value();
  if (section.given("velocity")) {
    auto const velocity = point(section, "velocity");
    sound = sound && velocity;
    if (velocity) body.velocity = *velocity;
  }
  if (auto const points = section.integer("points_per_cell")) body.points_per_direction = static_cast<int>(*points);
  body.rigid = section.boolean("rigid").value_or(false);
  sound = body_material(section, shape ? &*shape : nullptr, body) && sound;
  if (sound) out_.points.bodies.push_back(std::move(body));
}

bool Builder::body_material(Section const& section, shape::Shape const* shape, run::Body& body) {
  auto const name = section.text("material");
  if (!name) return false;
  // Own materials of every kind come before those of the library.
  auto const* solid = find_own(own_solids_, *name);
  auto const* explosive = find_own(own_explosives_, *name);
  auto const* fluid = find_own(own_fluids_, *name);
  if (solid == nullptr && explosive == nullptr && fluid == nullptr && !wrong_materials_.contains(*name)) {
    solid = library().solid(*name);
    explosive = library().explosive(*name);
    fluid = library().fluid(*name);
  }
  if (solid != nullptr) {
    body.solid = *solid;
  } else if (explosive != nullptr) {
    body.solid = material::of(*explosive);
  } else if (fluid != nullptr) {
    body.solid = material::of(*fluid);
  } else {
    auto names = solid_names();
    for (auto const& more : {explosive_names(), fluid_names()}) names.insert(names.end(), more.begin(), more.end());
    unknown_material(section, "material", *name, "material", names);
    return false;
  }
  bool const burns = solid == nullptr && explosive != nullptr;
  char const* const kind = solid != nullptr ? "a solid" : burns ? "an explosive" : "a fluid";
  bool sound = true;
  for (auto const* key : {"detonation", "initiation"}) {
    if (burns || !section.given(key)) continue;
    error(section, key, fmt::format("{} is {}, which does not detonate: remove the key", *name, kind));
    sound = false;
  }
  for (auto const* key : {"density", "pressure"}) {
    if ((!burns && solid == nullptr) || !section.given(key)) continue;
    error(section, key,
          fmt::format("{} is {}, which starts with its own density and pressure; only fluids can be given others: "
                      "remove the key",
                      *name, kind));
    sound = false;
  }
  if (burns && section.given("rigid") && body.rigid) {
    error(section, "rigid", fmt::format("{} is an explosive, and a rigid one could not expand: remove the key", *name));
    sound = false;
  }
  if (!sound) return false;
  if (burns) {
    run::Detonation detonation = run::Detonation::programmed;
    return shape != nullptr && initiation(section, *shape, "body", detonation, body.initiation);
  }
  if (solid != nullptr) return true;
  if (std::holds_alternative<material::MieGruneisen>(fluid->eos) && fluid->density > lightest_metal) {
    warn(section, "material",
         fmt::format("\"{}\" is a fluid without strength; solids are {}", *name, fmt::join(solid_names(), ", ")));
  }
  return body_state(section, *fluid, body);
}

bool Builder::body_state(Section const& section, material::Fluid const& fluid, run::Body& body) {
  auto const s = state(section, fluid, {fluid.density, fluid.pressure, {0.0, 0.0, 0.0}}, "density");
  if (!s) return false;
  if (section.given("density")) body.density = s->density;
  if (section.given("density") || section.given("pressure")) {
    body.specific_energy = material::internal_energy(fluid.eos, s->density, s->pressure);
  }
  return true;
}

bool Builder::body_fits(Section const& section, shape::Shape const& shape) {
  auto const b = shape::bounds(shape);
  std::string_view const key = place_key(section);
  double const h = out_.domain.h;
  for (int f = 0; f < 2 * dims(); ++f) {
    int const d = f / 2;
    bool const low = f % 2 == 0;
    double const plane = low ? out_.domain.lower[d] : out_.domain.upper(d);
    double const beyond = low ? plane - b.lower[d] : b.upper[d] - plane;
    if (beyond <= tiny()) continue;
    if (radial() && f == 0 && plane == 0.0) continue;  // the radius ends there
    double const middle = 0.5 * (b.lower[d] + b.upper[d]);
    // Files hold the coordinates of meshes in single precision.
    double const slack = std::holds_alternative<shape::Mesh>(shape) ? 1e-2 * h : tiny();
    Boundary const boundary = out_.domain.boundary[f];
    if (boundary == Boundary::symmetry && std::abs(middle - plane) <= slack) continue;
    std::string const where = fmt::format("the body reaches {:.4g} m over the face {} ({} = {:.6g} m)", beyond,
                                          grid::face_names[f], directions[d], plane);
    if (b.upper[d] <= out_.domain.lower[d] || b.lower[d] >= out_.domain.upper(d)) {
      touches_domain(section, shape);
    } else if (boundary == Boundary::symmetry) {
      error(section, key,
            fmt::format(
                "{}, which is a symmetry plane, but its middle at {} = {:.6g} m does not lie on it: put the middle "
                "on the plane or the whole body inside",
                where, directions[d], middle));
    } else {
      error(
          section, key,
          fmt::format("{}, which is \"{}\": move the body inside or enlarge the domain; only a symmetry plane through "
                      "its middle may cut a body",
                      where, word_of(boundary)));
    }
    return false;
  }
  for (int d = 0; d < dims(); ++d) {
    double const extent = std::min(b.upper[d], out_.domain.upper(d)) - std::max(b.lower[d], out_.domain.lower[d]);
    if (extent >= h * (1.0 - 1e-6)) continue;
    error(
        section, key,
        fmt::format("the body is {:.4g} m thick in direction {}, less than a cell of {:.4g} m: make the cells smaller "
                    "or the body thicker",
                    extent, directions[d], h));
    return false;
  }
  return true;
}

void Builder::overlaps() {
  auto const& sections = *deck_.sections("body");
  for (std::size_t i = 0; i < body_shapes_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!body_shapes_[i] || !body_shapes_[j]) continue;
      auto const common = common_point(*body_shapes_[i], *body_shapes_[j], true);
      if (!common) continue;
      error(
          sections[i], place_key(sections[i]),
          fmt::format("{} overlaps {} around {} m, where two bodies cannot both be: move them apart or cut one out of "
                      "the other",
                      sections[i].path, sections[j].path, point_text(*common, dims())));
    }
  }
}

std::optional<int> Builder::body_named(Section const& section, std::string_view key, std::string const& name) {
  if (body_names_.empty()) return std::nullopt;  // the bodies could not be read, which is reported
  auto const found = std::find(body_names_.begin(), body_names_.end(), name);
  if (found != body_names_.end()) return static_cast<int>(found - body_names_.begin());
  error(section, key,
        fmt::format("\"{}\" is not a body of this deck; {}", name, suggestion(name, body_names_, "bodies")));
  return std::nullopt;
}

// --- method

void Builder::points_options() {
  Section const* section = deck_.section("points");
  if (section == nullptr) return;
  auto& o = out_.points.options;
  choose(*section, "shape_function", o.shape);
  choose(*section, "stress_order", o.order);
  choose(*section, "transfer", o.transfer);
  o.pic_fraction = section->number("pic_fraction").value_or(o.pic_fraction);
  o.xpic_order = static_cast<int>(section->integer("xpic_order").value_or(o.xpic_order));
  o.crack_band = section->text("regularisation").value_or("crack_band") == "crack_band";
  o.locking_control = section->boolean("locking_control").value_or(o.locking_control);
  o.linear_viscosity = section->number("linear_viscosity").value_or(o.linear_viscosity);
  o.quadratic_viscosity = section->number("quadratic_viscosity").value_or(o.quadratic_viscosity);
  o.courant = section->number("courant").value_or(o.courant);
  o.block_cells = static_cast<int>(section->integer("block_cells").value_or(o.block_cells));
  o.wall_friction = section->number("wall_friction").value_or(o.wall_friction);
  if (geometry_known_ && section->given("body_force")) {
    o.body_force = point(*section, "body_force").value_or(o.body_force);
    if (radial() && o.body_force[0] != 0.0) {
      error(
          *section, "body_force",
          fmt::format("{} points along x, the radius of {}, and would not be the same on both sides of the axis: write "
                      "0 as its first element",
                      section->shown("body_force"), word_of(geometry())));
    }
  }
  if (o.block_cells != 0 && o.block_cells < 4) {
    error(*section, "block_cells",
          fmt::format("{} is too small; allowed: 0 (chosen by the program) or 4 to 4096", o.block_cells));
  }
  if (section->given("pic_fraction") && o.transfer != mpm::Transfer::flip) {
    warn(*section, "pic_fraction", "has an effect only with transfer = \"flip\"");
  }
  if (section->given("xpic_order") && o.transfer != mpm::Transfer::xpic) {
    warn(*section, "xpic_order", "has an effect only with transfer = \"xpic\"");
  }
  auto const& faces = out_.domain.boundary;
  bool const walls = std::find(faces.begin(), faces.end(), grid::Boundary::wall) != faces.end();
  if (o.wall_friction > 0.0 && boundaries_known_ && !walls) {
    warn(*section, "wall_friction",
         "has no effect: no face of the domain is a wall; write for example z_low = \"wall\" in [boundaries]");
  }
}

// --- what holds and loads the bodies

void Builder::constraints() {
  each("constraint", [&](Section const& section) { constraint(section); });
  check_constraints();
}

void Builder::constraint(Section const& section) {
  auto const kind = section.text("kind");
  if (!kind || section.doubtful()) return;
  mpm::Constraint out;
  out.region = shape::Everywhere{};
  bool sound = true;
  if (!section.given("region") && !section.given("body")) {
    report_.error(
        section.place, section.path,
        "a constraint needs the region or the body that it holds; write for example region = {shape = \"box\", "
        "lower = [0, 0, 0], upper = [0.1, 1, 1]}");
    return;
  }
  if (section.given("region")) {
    Section const* region = section.section("region");
    auto const shape = region == nullptr ? std::nullopt : composed_shape(*region);
    sound = shape.has_value();
    if (shape) {
      touches_domain(*region, *shape, "region");
      out.region = *shape;
    }
  }
  if (section.given("body")) {
    auto const name = section.text("body");
    auto const body = name ? body_named(section, "body", *name) : std::nullopt;
    sound = sound && body;
    if (body) out.body = *body;
  }
  auto const only_for = [&](std::string_view key, std::string_view word) {
    if (!section.given(key) || *kind == word) return;
    error(section, key,
          fmt::format("{} belongs to kind = \"{}\", and this is \"{}\": remove it or change the kind",
                      section.shown(key), word, *kind));
    sound = false;
  };
  only_for("normal", "roller");
  only_for("velocity", "velocity");
  for (auto const& [key, word, example] : {std::tuple{"normal", "roller", "normal = \"x\""},
                                           std::tuple{"velocity", "velocity", "velocity = [10, 0, 0]"}}) {
    if (*kind != word || section.given(key)) continue;
    report_.error(
        section.place, section.path_of(key),
        fmt::format("the key \"{}\" is missing, which kind = \"{}\" needs; write for example {}", key, word, example));
    sound = false;
  }
  std::vector<std::string> held;
  held.reserve(3);
  for (int d = 0; d < dims(); ++d) held.emplace_back(1, directions[d]);
  std::string_view key = "held";
  if (*kind == "roller") {
    if (section.given("held")) {
      error(section, "held", "a roller holds along its normal only: remove the key, or write kind = \"fixed\"");
      return;
    }
    key = "normal";
    auto const normal = section.text("normal");
    if (!normal) return;
    held = {*normal};
  } else if (section.given("held")) {
    auto const* given = section.strings("held");
    if (given == nullptr) return;
    held = *given;
  }
  out.held = {false, false, false};
  for (std::string const& letter : held) {
    int const d = letter[0] - 'x';
    if (d >= dims()) {
      error(section, key, fmt::format("\"{}\" is not resolved in {}: remove it", letter, word_of(geometry())));
      return;
    }
    out.held[static_cast<std::size_t>(d)] = true;
  }
  if (held.empty()) {
    error(section, key, "the list is empty, and nothing would be held; write for example held = [\"x\"]");
    return;
  }
  if (*kind == "velocity" && section.given("velocity")) {
    auto const velocity = point(section, "velocity");
    if (!velocity) return;
    out.velocity = *velocity;
    for (int d = 0; d < dims(); ++d) {
      if (out.held[static_cast<std::size_t>(d)] || out.velocity[d] == 0.0) continue;
      error(section, "velocity",
            fmt::format("{} has a value in direction {}, which is not held: add \"{}\" to held or write 0",
                        section.shown("velocity"), directions[d], directions[d]));
      return;
    }
  }
  if (!sound) return;
  out_.points.constraints.push_back(std::move(out));
  constraint_sections_.push_back(&section);
}

void Builder::contacts() {
  each("contact", [&](Section const& section) {
    auto const* names = section.strings("bodies");
    auto const friction = section.number("friction");
    if (names == nullptr || !friction) return;
    if (names->size() != 2 || (*names)[0] == (*names)[1]) {
      error(section, "bodies",
            fmt::format("{} does not name two bodies; write for example bodies = [\"rod\", \"plate\"]",
                        section.shown("bodies")));
      return;
    }
    auto const first = body_named(section, "bodies", (*names)[0]);
    auto const second = body_named(section, "bodies", (*names)[1]);
    if (!first || !second) return;
    if (is_rigid(static_cast<std::size_t>(*first)) && is_rigid(static_cast<std::size_t>(*second))) {
      error(
          section, "bodies",
          fmt::format("{} and {} are both rigid and keep their velocities, so that their contact does nothing: remove "
                      "it, or let one of them deform",
                      (*names)[0], (*names)[1]));
      return;
    }
    for (mpm::Contact const& other : out_.points.contacts) {
      if (std::minmax(other.first, other.second) != std::minmax(*first, *second)) continue;
      error(section, "bodies",
            fmt::format("{} and {} have a contact already: remove one of the two", (*names)[0], (*names)[1]));
      return;
    }
    out_.points.contacts.push_back({*first, *second, *friction});
  });
}

void Builder::surface_pressures() {
  each("surface_pressure", [&](Section const& section) { surface_pressure(section); });
}

void Builder::surface_pressure(Section const& section) {
  if (section.doubtful()) return;
  mpm::SurfacePressure out;
  bool sound = pressure_history(section, out);
  if (section.given("body")) {
    auto const name = section.text("body");
    auto const body = name ? body_named(section, "body", *name) : std::nullopt;
    if (!body) return;
    out.body = *body;
  } else if (body_names_.size() > 1) {
    report_.error(section.place, section.path_of("body"),
                  fmt::format("there are several bodies: name the one that is loaded; write for example body = \"{}\"",
                              body_names_.front()));
    return;
  }
  if (section.broken("normal") || body_names_.empty()) return;
  if (section.given("normal")) {
    std::string const normal = *section.text("normal");
    out.normal = signed_normal(normal);
    if (normal[1] - 'x' >= dims()) {
      error(section, "normal",
            fmt::format("\"{}\" is not resolved in {}, which resolves {} direction{}", normal, word_of(geometry()),
                        dims(), dims() > 1 ? "s" : ""));
      return;
    }
  }
  sound = loaded_layer(section, out) && sound;
  if (sound) out_.points.pressures.push_back(std::move(out));
}

bool Builder::pressure_history(Section const& section, mpm::SurfacePressure& pressure) {
  bool const constant = section.given("pressure");
  if (constant == section.given("history")) {
    report_.error(section.place, section.path,
                  fmt::format("a surface pressure has either pressure or history, this one has {}; write for example "
                              "pressure = \"2 MPa\" and duration = \"0.1 ms\"",
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
    error(section, "duration", "belongs to a constant pressure; a history ends with its last time: remove the key");
    return false;
  }
  Section const* history = section.section("history");
  if (history == nullptr) return false;
  auto const* times = history->numbers("times");
  auto const* pressures = history->numbers("pressures");
  if (times == nullptr || pressures == nullptr) return false;
  if (times->size() != pressures->size() || times->size() < 2) {
    error(*history, "pressures",
          fmt::format("there are {} times and {} pressures; expected as many of each, at least two", times->size(),
                      pressures->size()));
    return false;
  }
  for (std::size_t i = 1; i < times->size(); ++i) {
    if ((*times)[i] > (*times)[i - 1]) continue;
    error(*history, "times", fmt::format("{:g} s follows {:g} s: the times must rise", (*times)[i], (*times)[i - 1]));
    return false;
  }
  pressure.times = *times;
  pressure.pressures = *pressures;
  std::size_t acts = 0;
  while (acts < pressures->size() && (*pressures)[acts] == 0.0) ++acts;
  if (acts == pressures->size()) {
    warn(*history, "pressures", "they are all 0: the load has no effect");
  } else {
    onsets_.push_back({&section, (*times)[acts > 0 ? acts - 1 : 0], "history", "never acts"});
  }
  return true;
}

namespace {

/// Length of the pieces of a loaded surface in layers of points.
constexpr double facets_per_layer = 1.0 / 3.0;

}  // namespace

/// Does a box look to one side with all of a flat face? What else it may be, the surface itself tells.
bool Builder::is_flat_face(shape::Shape const& body, int direction, double face) const {
  auto const* box = std::get_if<shape::Box>(&body);
  if (box == nullptr || (direction == 0 && grid::radial_exponent(geometry()) > 0)) return false;
  return std::abs(face - box->lower[direction]) < tiny() || std::abs(face - box->upper[direction]) < tiny();
}

bool Builder::curved_layer(Section const& section, double asked, double layer, mpm::SurfacePressure& pressure) {
  pressure.thickness = std::max(1.0, std::round(asked / layer)) * layer;
  if (!section.given("thickness") || asked < 8.0 * layer + tiny()) return true;
  error(section, "thickness",
        fmt::format("{} is more than eight layers of points, {:.4g} m each: make it smaller",
                    section.shown("thickness"), layer));
  return false;
}

bool Builder::loaded_layer(Section const& section, mpm::SurfacePressure& pressure) {
  shape::Shape region = shape::Everywhere{};
  if (section.given("region")) {
    Section const* given = section.section("region");
    auto const shape = given == nullptr ? std::nullopt : composed_shape(*given);
    if (!shape) return false;
    region = *shape;
  }
  if (section.broken("thickness")) return false;
  if (is_rigid(static_cast<std::size_t>(pressure.body))) {
    report_.error(section.place_of("body"), section.path_of("body"),
                  fmt::format("\"{}\" is rigid and keeps its velocity, whatever pushes: remove the pressure",
                              body_names_[static_cast<std::size_t>(pressure.body)]));
    return false;
  }
  auto const& body = body_shapes_[static_cast<std::size_t>(pressure.body)];
  if (!body || !domain_known_) return false;  // reported where the body is defined
  Section const& owner = (*deck_.sections("body"))[static_cast<std::size_t>(pressure.body)];
  auto const per_cell = owner.integer("points_per_cell");
  if (!per_cell) return false;

  auto const b = shape::bounds(*body);
  shape::Box reach = b;
  if (section.given("region")) {
    auto const r = shape::bounds(region);
    for (int d = 0; d < dims(); ++d) {
      reach.lower[d] = std::max(b.lower[d], r.lower[d]);
      reach.upper[d] = std::min(b.upper[d], r.upper[d]);
      if (reach.upper[d] - reach.lower[d] > tiny()) continue;
      error(section, "region",
            fmt::format(
                "it reaches from {:.6g} to {:.6g} m in direction {} and does not meet the body, which reaches from "
                "{:.6g} to {:.6g} m: move it",
                r.lower[d], r.upper[d], directions[d], b.lower[d], b.upper[d]));
      return false;
    }
  }
  double const layer = out_.domain.h / static_cast<double>(*per_cell);  // of points
  double const asked = section.number("thickness").value_or(layer);
  if (!section.given("normal")) {
    pressure.surface = shape::surface(*body, region, out_.domain, facets_per_layer * layer);
    if (pressure.surface.empty()) {
      report_.error(section.place_of("region"), section.path_of("region"),
                    "no part of the body's surface lies in it: move the region, or make it larger");
      return false;
    }
    return curved_layer(section, asked, layer, pressure);
  }
  int const d = pressure.normal[0] != 0.0 ? 0 : pressure.normal[1] != 0.0 ? 1 : 2;
  bool const high = pressure.normal[d] > 0.0;
  double const face = high ? reach.upper[d] : reach.lower[d];
  double const depth = reach.upper[d] - reach.lower[d];
  if (asked > depth + tiny()) {
    bool const given = section.given("thickness");
    error(section,
          given                     ? "thickness"
          : section.given("region") ? "region"
                                    : "normal",
          given ? fmt::format("{} is more than the body has below the loaded face, {:.6g} m: make it smaller",
                              section.shown("thickness"), depth)
                : fmt::format(
                      "a layer of points is {:.6g} m thick, more than there is of the body below the loaded face, "
                      "{:.6g} m: make the region thicker",
                      asked, depth));
    return false;
  }
  if (!is_flat_face(*body, d, face)) {
    std::vector<shape::Facet> facets;
    bool flat = true;
    for (shape::Facet const& f : shape::surface(*body, region, out_.domain, facets_per_layer * layer)) {
      double const along = dot(f.area, pressure.normal) / norm(f.area);
      if (along < 1e-9 || !shape::is_clear(*body, out_.domain, f.x, pressure.normal, 0.05 * layer)) continue;
      flat = flat && along > 1.0 - 1e-9 && std::abs(f.x[d] - face) < tiny();
      facets.push_back(f);
    }
    if (facets.empty()) {
      report_.error(section.place_of(section.given("region") ? "region" : "normal"),
                    section.path_of(section.given("region") ? "region" : "normal"),
                    fmt::format("no part of the body's surface{} is seen from the side of {}: {}",
                                section.given("region") ? " that lies in it" : "", *section.text("normal"),
                                section.given("region") ? "move the region, or make it larger"
                                                        : "give another normal, or none to load the whole surface"));
      return false;
    }
    if (!flat || (d == 0 && grid::radial_exponent(geometry()) > 0)) {
      pressure.surface = std::move(facets);
      return curved_layer(section, asked, layer, pressure);
    }
  }
  // The inner side of the layer lies where sub-cells end, so that their points hold just its volume. A sub-cell that
  // the body fills by less than a half does not count as a layer.
  double const inner = high ? face - asked : face + asked;
  double const origin = out_.domain.lower[d];
  double side = origin + std::round((inner - origin) / layer) * layer;
  if (std::abs(face - side) < 0.5 * layer) side += high ? -layer : layer;
  pressure.thickness = std::abs(face - side);
  shape::Box slab;
  for (int k = 0; k < 3; ++k) {
    slab.lower[k] = k < dims() ? out_.domain.lower[k] - out_.domain.h : -1.0;
    slab.upper[k] = k < dims() ? out_.domain.upper(k) + out_.domain.h : 1.0;
  }
  // Outwards it reaches over the centres of sub-cells that the face cuts.
  slab.lower[d] = high ? side : face - layer;
  slab.upper[d] = high ? face + layer : side;
  pressure.region = section.given("region") ? shape::combine(shape::Operation::intersection, {region, slab}) : slab;
  if (!has_points_in(*body, pressure.region, *per_cell)) {
    report_.error(
        section.place_of("region"), section.path_of(section.given("region") ? "region" : "normal"),
        fmt::format("no point of the body lies in the loaded layer, {:.4g} m below the face at {} = {:.6g} m: "
                    "move the region, or make it larger than the points are apart, {:.4g} m",
                    pressure.thickness, directions[d], face, layer));
    return false;
  }
  return true;
}

// --- gauges

void Builder::body_gauge(Section const& section, std::string const& name, std::set<std::string>& names) {
  if (!has_bodies()) {
    error(section, "body", "there is no body in this deck: remove the key, or add a [[body]]");
    return;
  }
  for (auto const* key : {"line", "plane"}) {
    if (!section.given(key)) continue;
    error(section, key, "does not go with body: write one gauge with a point for each place");
    return;
  }
  if (!room_for_gauges(section, "body", 1.0)) return;
  auto const body_name = section.text("body");
  if (!body_name) return;
  auto const body = body_named(section, "body", *body_name);
  if (!names.insert(name).second) {
    report_.error(section.place_of("name"), section.path_of("name"),
                  fmt::format("\"{}\" is used by another gauge: choose another name", name));
  }
  if (!body) return;
  run::PointGauge gauge;
  gauge.name = name;
  gauge.body = *body;
  if (section.given("point")) {
    auto const p = point(section, "point");
    if (!p) return;
    gauge.point = *p;
    auto const& shape = body_shapes_[static_cast<std::size_t>(*body)];
    if (shape && !near_body(*shape, *p)) {
      auto const b = shape::bounds(*shape);
      error(section, "point",
            fmt::format("{} lies outside {}, which reaches from {} to {} m: move the gauge into it",
                        section.shown("point"), *body_name, point_text(b.lower, dims()), point_text(b.upper, dims())));
      return;
    }
  }
  out_.points.gauges.push_back(std::move(gauge));
}

bool Builder::near_body(shape::Shape const& body, Vec3 const& p) const {
  if (shape::contains(body, out_.domain, p)) return true;
  // On the surface round-off decides.
  for (int d = 0; d < dims(); ++d) {
    for (double const side : {-1e-3, 1e-3}) {
      Vec3 q = p;
      q[d] += side * out_.domain.h;
      if (shape::contains(body, out_.domain, q)) return true;
    }
  }
  return false;
}

void Builder::warn_of_fluids_in_empty_space() {
  // A closed box that bodies fill holds its fluids together.
  bool closed = true;
  for (int f = 0; f < 2 * dims(); ++f) {
    grid::Boundary const boundary = out_.domain.boundary[f];
    closed = closed && (boundary == grid::Boundary::wall || boundary == grid::Boundary::symmetry ||
                        boundary == grid::Boundary::periodic);
  }
  double empty = closed ? shape::volume_inside(shape::Everywhere{}, out_.domain) : 0.0;
  double const whole = empty;
  for (auto const& shape : body_shapes_) {
    if (closed && shape) empty -= shape::volume_inside(*shape, out_.domain);
  }
  constexpr double round_off = 1e-6;
  if (closed && empty <= round_off * whole) return;
  auto const* const sections = deck_.sections("body");
  if (sections == nullptr || sections->size() != out_.points.bodies.size()) return;  // there were errors
  for (std::size_t n = 0; n < sections->size(); ++n) {
    run::Body const& body = out_.points.bodies[n];
    if (body.solid.has_deviator() || body.solid.burns() || !body.initiation.empty()) continue;
    material::Solid const start = as_it_starts(body);
    double const pressure = material::start_pressure(start);
    double const c = material::sound_speed(start, start.density, pressure);
    double const part = pressure / (start.density * c * c);
    constexpr double little = 1e-7;
    constexpr double much = 0.1;                                                       // a gas
    if (body.rigid || !(part > little) || (*sections)[n].given("pressure")) continue;  // what is asked for is meant
    if (part > much) {
      warn((*sections)[n], "material",
           fmt::format("\"{}\" starts at {:.6g} Pa in empty space and will blow apart: put a gas around it, with "
                       "[ambient] and [mpm_region], or let it fill a box of walls",
                       body.name, pressure));
    } else {
      warn((*sections)[n], "material",
           fmt::format("\"{}\" starts at {:.6g} Pa in empty space, so that waves of this pressure will run through it: "
                       "write pressure = 0.001, or put a gas around it, with [ambient] and [mpm_region]",
                       body.name, pressure));
    }
  }
}

bool Builder::points_move() {
  run::Points const& p = out_.points;
  auto const moves = [](Vec3 const& v) { return norm(v) > 0.0; };
  bool moving = moves(p.options.body_force) || deck_.given("surface_pressure");
  for (auto const& c : p.constraints) moving = moving || moves(c.velocity);
  for (run::Body const& b : p.bodies) {
    material::Solid const start = as_it_starts(b);
    moving = moving || moves(b.velocity) || start.burns() || material::start_pressure(start) != 0.0;
    if (start.burns() && p.options.order == mpm::StressOrder::usf) {
      report_.warning(
          deck_.place_of("points"), "points.stress_order",
          fmt::format("\"usf\" is unstable where an explosive such as \"{}\" detonates; use \"musl\"", b.name));
    }
  }
  return moving;
}

}  // namespace brisance::deck
