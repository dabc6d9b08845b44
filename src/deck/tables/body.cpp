/// [[body]]: bodies of material points.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/places.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"
#include "material/compressed.hpp"
#include "setup/initial_stress.hpp"
#include "shape/placement.hpp"

namespace brisance::deck {

namespace {

Settings<run::Body> const& settings() {
  using B = run::Body;
  static Settings<B> const all{
      {&B::particles_per_direction,
       typed(Type::integer, "points_per_cell", "1", 1, 8)
           .like("2")
           .means("Initial number of material points per cell and direction: 2 gives 8 per cell in 3D")},
      {&B::rigid, typed(Type::boolean, "rigid")
                      .like("true")
                      .means("The body keeps its velocity regardless of contacts and loads")},
      density().note("that of the fluid").means("Initial density, for fluids only"),
      pressure().note("that of the fluid").means("Initial pressure, for fluids only"),
      word("initial_stress", {"none", "gravity"})
          .of("none")
          .like("\"gravity\"")
          .means("`gravity`: the body starts in the stress that the weight of everything that stands on it causes, its "
                 "own "
                 "included, compressed accordingly. `[points] body_force` must point along an axis"),
      number("K0", "1", 0.0, 10.0)
          .note("nu/(1 - nu); 1 for fluids")
          .like("0.5")
          .means("For `initial_stress = \"gravity\"`: horizontal stress as a fraction of the vertical one"),
      word<run::Detonation>("detonation")
          .of(word_of(run::Charge{}.detonation))
          .like("\"programmed\"")
          .means("For explosives, as for charges"),
      nested(Type::tables, "initiation", initiation_table())
          .note("one point at the centre of the body, at time 0")
          .like("[{position = [0, 0, 1.5], delay = \"2 us\"}]")
          .means("Points of initiation of a programmed detonation")};
  return all;
}

}  // namespace

Table const& body_table() {
  static Table const table = [] {
    Table t{
        "A body of material points. In a deck with `[mpm_region]`, or with charges, initial states, obstacles, inflow "
        "or gauges in the gas, bodies are surrounded by the gas of `[ambient]`. Otherwise they move in empty space. "
        "Faces of the domain act on bodies as follows: `wall` pushes solids but does not pull them, `symmetry` is a "
        "mirror plane, `outflow` lets them leave, `periodic` joins opposite faces.",
        {typed(Type::name, "name").note("`body-1`, ...").like("\"plate\"").means("Name"),
         typed(Type::text, "material")
             .required()
             .like("\"OFHC-copper\"")
             .means(
                 "Name of a solid, explosive or fluid of the library (searched in this order) or of `[solids.NAME]`, "
                 "`[explosives.NAME]`, `[fluids.NAME]`")},
        {},
        {}};
    t.keys = joined(t.keys, composed_shape_keys());
    t.keys = joined(t.keys, initial_velocity_keys("at rest"));
    t.keys = joined(t.keys, settings().keys());
    return t;
  }();
  return table;
}

namespace {

constexpr std::size_t most_bodies = 100;
constexpr double lightest_metal = 1500.0;  ///< [kg/m3]; a fluid that is heavier was perhaps meant as a solid

/// A body lies in the domain, is no smaller than a cell, and only a symmetry plane through its middle may cut it.
bool body_fits(Draft const& draft, Section const& section, shape::Shape const& shape) {
  auto const b = shape::bounds(shape);
  std::string_view const key = place_key(section);
  double const h = draft.particle_domain().h;
  for (int f = 0; f < 2 * draft.dims(); ++f) {
    int const d = f / 2;
    bool const low = f % 2 == 0;
    double const plane = low ? draft.out.domain.lower[d] : draft.out.domain.upper(d);
    double const beyond = low ? plane - b.lower[d] : b.upper[d] - plane;
    if (beyond <= draft.tiny()) continue;
    if (draft.radial() && f == 0 && plane == 0.0) continue;  // the radius ends there
    double const middle = 0.5 * (b.lower[d] + b.upper[d]);
    // Files hold the coordinates of meshes in single precision.
    double const slack = std::holds_alternative<shape::Mesh>(shape) ? 1e-2 * h : draft.tiny();
    Boundary const boundary = draft.out.domain.boundary[f];
    if (boundary == Boundary::symmetry && std::abs(middle - plane) <= slack) continue;
    std::string const where = fmt::format("the body extends {:.4g} m beyond the face {} ({} = {:.6g} m)", beyond,
                                          grid::face_names[f], directions[d], plane);
    if (b.upper[d] <= draft.out.domain.lower[d] || b.lower[d] >= draft.out.domain.upper(d)) {
      touches_domain(draft, section, shape);
    } else if (boundary == Boundary::symmetry) {
      draft.error(section, key,
                  fmt::format("{}, which is a symmetry plane, but its centre at {} = {:.6g} m is not on the plane: put "
                              "the centre on the plane or the whole body inside the domain",
                              where, directions[d], middle));
    } else {
      draft.error(section, key,
                  fmt::format("{}, which is \"{}\": move the body inside or enlarge the domain; only a symmetry plane "
                              "through its centre may cut a body",
                              where, word_of(boundary)));
    }
    return false;
  }
  for (int d = 0; d < draft.dims(); ++d) {
    double const extent =
        std::min(b.upper[d], draft.out.domain.upper(d)) - std::max(b.lower[d], draft.out.domain.lower[d]);
    if (extent >= h * (1.0 - 1e-6)) continue;
    draft.error(section, key,
                fmt::format("the body is {:.4g} m thick in direction {}, less than one cell of {:.4g} m: make the "
                            "cells smaller or the body thicker",
                            extent, directions[d], h));
    return false;
  }
  return true;
}

bool body_state(Draft const& draft, Section const& section, material::Fluid const& fluid, run::Body& body) {
  auto const s = fluid_state(draft, section, fluid, {fluid.density, fluid.pressure, {0.0, 0.0, 0.0}}, "density");
  if (!s) return false;
  if (section.given("density")) body.density = s->density;
  if (section.given("density") || section.given("pressure")) {
    body.specific_energy = material::internal_energy(fluid.eos, s->density, s->pressure);
  }
  return true;
}

bool body_material(Draft& draft, Section const& section, shape::Shape const* shape, run::Body& body) {
  auto const name = section.text("material");
  if (!name) return false;
  // Own materials of every kind come before those of the library.
  auto const* solid = find_own(draft.materials.solids, *name);
  auto const* explosive = find_own(draft.materials.explosives, *name);
  auto const* fluid = find_own(draft.materials.fluids, *name);
  if (solid == nullptr && explosive == nullptr && fluid == nullptr && !draft.materials.wrong.contains(*name)) {
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
    auto names = draft.materials.solid_names();
    for (auto const& more : {draft.materials.explosive_names(), draft.materials.fluid_names()})
      names.insert(names.end(), more.begin(), more.end());
    unknown_material(draft, section, "material", *name, "material", names);
    return false;
  }
  bool const burns = solid == nullptr && explosive != nullptr;
  char const* const kind = solid != nullptr ? "a solid" : burns ? "an explosive" : "a fluid";
  bool sound = true;
  for (auto const* key : {"detonation", "initiation"}) {
    if (burns || !section.given(key)) continue;
    draft.error(section, key, fmt::format("{} is {}, which does not detonate: remove the key", *name, kind));
    sound = false;
  }
  for (auto const* key : {"density", "pressure"}) {
    if ((!burns && solid == nullptr) || !section.given(key)) continue;
    draft.error(section, key,
                fmt::format("{} is {}, which starts with the density and pressure of its material; only fluids can "
                            "start with others: remove the key",
                            *name, kind));
    sound = false;
  }
  if (burns && section.given("rigid") && body.rigid) {
    draft.error(section, "rigid",
                fmt::format("{} is an explosive, and a rigid explosive could not expand: remove the key", *name));
    sound = false;
  }
  if (!sound) return false;
  if (burns) {
    run::Detonation detonation = run::Charge{}.detonation;
    return shape != nullptr && build_initiation(draft, section, *shape, "body", detonation, body.initiation);
  }
  if (solid != nullptr) return true;
  if (std::holds_alternative<material::MieGruneisen>(fluid->eos) && fluid->density > lightest_metal) {
    draft.warn(section, "material",
               fmt::format("\"{}\" is a fluid without strength; the solids are {}", *name,
                           fmt::join(draft.materials.solid_names(), ", ")));
  }
  return body_state(draft, section, *fluid, body);
}

/// Does the body start under its weight? What the body force and the strength say to it is checked when all is known.
bool initial_stress(Draft const& draft, Section const& section, run::Body& body) {
  if (section.text("initial_stress") != "gravity") {
    if (!section.given("K0") || section.broken("initial_stress")) return true;
    draft.error(section, "K0", "has no effect without initial_stress = \"gravity\": remove the key, or add this one");
    return false;
  }
  if (section.broken("K0")) return false;
  if (body.rigid || body.solid.burns() || body.solid.is_gas()) {
    draft.error(section, "initial_stress",
                fmt::format("{} does not feel its weight at the start: remove the key",
                            body.rigid ? "a rigid body" : "an explosive or a gas"));
    return false;
  }
  if (section.given("K0") && !body.solid.has_deviator()) {
    draft.error(section, "K0", "is 1 in a fluid, which has no shear stress: remove the key");
    return false;
  }
  body.lateral_stress = section.number("K0").value_or(material::lateral_coefficient(body.solid));
  return true;
}

void body(Draft& draft, Section const& section, std::size_t index) {
  run::Body body;
  body.name = draft.body_names[index];
  auto const shape = build_composed_shape(draft, section);
  if (shape) {
    body.shape = *shape;
    if (draft.domain_known && draft.boundaries_known && body_fits(draft, section, *shape))
      draft.body_shapes[index] = shape;
  }
  bool sound = shape.has_value();
  sound = build_initial_velocity(draft, section, shape ? &*shape : nullptr, body.velocity, body.motion) && sound;
  settings().read(section, body);
  if (body.rigid && body.motion.any()) {
    draft.error(section, section.given("spin") ? "spin" : "velocity",
                "a rigid body keeps one velocity in all its points: write a constant velocity, or remove rigid");
    sound = false;
  }
  sound = body_material(draft, section, shape ? &*shape : nullptr, body) && sound;
  sound = sound && initial_stress(draft, section, body);
  if (sound) draft.out.particles.bodies.push_back(std::move(body));
}

void overlaps(Draft const& draft) {
  auto const& sections = *draft.deck.sections("body");
  for (std::size_t i = 0; i < draft.body_shapes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!draft.body_shapes[i] || !draft.body_shapes[j]) continue;
      auto const common = common_point(draft, *draft.body_shapes[i], *draft.body_shapes[j], true);
      if (!common) continue;
      draft.error(sections[i], place_key(sections[i]),
                  fmt::format("{} overlaps {} around {} m: move them apart or cut one out of the other",
                              sections[i].path, sections[j].path, point_text(*common, draft.dims())));
    }
  }
}

}  // namespace

void build_bodies(Draft& draft) {
  auto const* all = draft.deck.sections("body");
  if (all == nullptr) return;
  if (all->empty()) {
    draft.error(draft.deck, "body", "the list of bodies is empty: remove the key, or write [[body]]");
    return;
  }
  if (all->size() > most_bodies) {
    draft.error(draft.deck, "body", fmt::format("there are {} bodies; allowed: at most {}", all->size(), most_bodies));
    return;
  }
  for (std::size_t i = 0; i < all->size(); ++i) {
    Section const& section = (*all)[i];
    std::string const name = section.text("name").value_or(fmt::format("body-{}", i + 1));
    if (std::find(draft.body_names.begin(), draft.body_names.end(), name) != draft.body_names.end()) {
      draft.report.error(section.place_of("name"), section.path_of("name"),
                         fmt::format("\"{}\" is used by another body: choose another name", name));
    }
    if (draft.has_gas && name == "gas") {
      draft.report.error(section.place_of("name"), section.path_of("name"),
                         "the name \"gas\" is reserved for the gas particles of the MPM region: choose another name");
    }
    draft.body_names.push_back(name);
    draft.body_shapes.emplace_back();
  }
  for (std::size_t i = 0; i < all->size(); ++i) body(draft, (*all)[i], i);
  overlaps(draft);
}

std::optional<int> body_named(Draft const& draft, Section const& section, std::string_view key,
                              std::string const& name) {
  if (draft.body_names.empty()) return std::nullopt;  // the bodies could not be read, which is reported
  auto const found = std::find(draft.body_names.begin(), draft.body_names.end(), name);
  if (found != draft.body_names.end()) return static_cast<int>(found - draft.body_names.begin());
  draft.error(section, key,
              fmt::format("\"{}\" is not a body of this deck; {}", name, suggestion(name, draft.body_names, "bodies")));
  return std::nullopt;
}

bool is_rigid(Draft const& draft, std::size_t body) {
  return (*draft.deck.sections("body"))[body].boolean("rigid").value_or(false);
}

namespace {

/// A body's material in its state at the start.
material::Material as_it_starts(run::Body const& body) {
  material::Material start = body.solid;
  start.density = body.density.value_or(start.density);
  start.specific_energy = body.specific_energy.value_or(start.specific_energy);
  return start;
}

}  // namespace

void check_initial_stress(Draft const& draft) {
  auto const* const sections = draft.deck.sections("body");
  run::Particles const& p = draft.out.particles;
  if (sections == nullptr || sections->size() != p.bodies.size() || !draft.domain_known) return;  // there were errors
  for (std::size_t n = 0; n < p.bodies.size(); ++n) {
    if (!p.bodies[n].lateral_stress) continue;
    try {
      setup::Overburden overburden(draft.out, draft.out.domain_around(static_cast<int>(n)));
      constexpr double most_verticals = 64.0;  // in a direction
      int const cells = std::ranges::max(draft.particle_domain(static_cast<int>(n)).cells);
      double const vertical = overburden.largest(p.bodies[n], static_cast<int>(std::ceil(cells / most_verticals)));
      if (setup::bears(p.bodies[n].solid, overburden.state(p.bodies[n], vertical))) continue;
      draft.error((*sections)[n], (*sections)[n].given("K0") ? "K0" : "initial_stress",
                  fmt::format("under the weight above it, {:.6g} Pa, \"{}\" would yield with K0 = {:.4g}: give a K0 "
                              "nearer to 1",
                              vertical, p.bodies[n].name, *p.bodies[n].lateral_stress));
    } catch (InputError const& problem) {
      draft.error((*sections)[n], "initial_stress",
                  fmt::format("{}; write, for example, body_force = [0, 0, -9.81] in "
                              "[points]",
                              problem.what()));
    }
  }
}

void warn_of_fluids_in_empty_space(Draft const& draft) {
  // A closed box that bodies fill holds its fluids together.
  bool closed = true;
  for (int f = 0; f < 2 * draft.dims(); ++f) {
    closed = closed && grid::has_images(draft.out.domain.boundary[f]);
  }
  double empty = closed ? shape::volume_inside(shape::Everywhere{}, draft.out.domain) : 0.0;
  double const whole = empty;
  for (auto const& shape : draft.body_shapes) {
    if (closed && shape) empty -= shape::volume_inside(*shape, draft.out.domain);
  }
  constexpr double round_off = 1e-6;
  if (closed && empty <= round_off * whole) return;
  auto const* const sections = draft.deck.sections("body");
  if (sections == nullptr || sections->size() != draft.out.particles.bodies.size()) return;  // there were errors
  for (std::size_t n = 0; n < sections->size(); ++n) {
    run::Body const& body = draft.out.particles.bodies[n];
    if (body.solid.has_deviator() || body.solid.burns() || !body.initiation.empty()) continue;
    material::Material const start = as_it_starts(body);
    double const pressure = material::start_pressure(start);
    double const c = material::sound_speed(start, start.density, pressure);
    double const fraction = pressure / (start.density * c * c);
    constexpr double little = 1e-7;
    constexpr double much = 0.1;                                                           // a gas
    if (body.rigid || !(fraction > little) || (*sections)[n].given("pressure")) continue;  // what is asked for is meant
    if (fraction > much) {
      draft.warn((*sections)[n], "material",
                 fmt::format("\"{}\" starts at {:.6g} Pa in empty space and will expand freely: surround it with gas, "
                             "with [ambient] and [mpm_region], or let it fill a box of walls",
                             body.name, pressure));
    } else {
      draft.warn((*sections)[n], "material",
                 fmt::format("\"{}\" starts at {:.6g} Pa in empty space, so waves of this pressure will travel through "
                             "it: write pressure = 0.001, or surround it with gas, with [ambient] and [mpm_region]",
                             body.name, pressure));
    }
  }
}

bool particles_move(Draft const& draft) {
  run::Particles const& p = draft.out.particles;
  auto const moves = [](Vec3 const& v) { return norm(v) > 0.0; };
  bool moving = moves(p.options.body_force) || draft.deck.given("surface_pressure");
  for (auto const& c : p.constraints) moving = moving || moves(c.velocity);
  for (run::Body const& b : p.bodies) {
    material::Material const start = as_it_starts(b);
    moving = moving || b.moves() || start.burns() || material::start_pressure(start) != 0.0;
    if (start.burns() && p.options.order == mpm::StressOrder::usf) {
      draft.report.warning(
          draft.deck.place_of("points"), "points.stress_order",
          fmt::format("\"usf\" is unstable when an explosive such as \"{}\" detonates; use \"musl\"", b.name));
    }
  }
  return moving;
}

}  // namespace brisance::deck
