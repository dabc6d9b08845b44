/// [[charge]]: explosive charges in the gas.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/places.hpp"
#include "deck/tables/tables.hpp"
#include "setup/place_obstacles.hpp"
#include "setup/solid_cells.hpp"

namespace brisance::deck {

Table const& charge_table() {
  static Table const table = [] {
    Table t{
        "An explosive charge. Give its `mass` or its size, or both if they agree within 0.1 %. The mass is that of the "
        "whole charge, even if symmetry planes pass through its centre. In planar2d and cylindrical1d it is per metre, "
        "in planar1d per square metre.",
        {typed(Type::text, "explosive")
             .of("TNT")
             .like("\"TNT\"")
             .means("An explosive of the library or of `[explosives.NAME]`; the same for all charges of a deck"),
         number("mass", "kg", 1e-12, 1e12)
             .or_unit("kg/m")
             .or_unit("kg/m2")
             .note("from the size")
             .like("\"10 kg\"")
             .means("Mass of the whole charge")},
        {},
        {}};
    t.keys = joined(t.keys, shape_keys());
    t.keys = joined(
        t.keys,
        {number("length_to_diameter", "1", 1e-3, 1e3)
             .note("from `length`")
             .like("1.0")
             .means("Length over diameter of a cylinder that is given by its mass; instead of `length` or `radius`"),
         word<run::Detonation>("detonation")
             .of(word_of(run::Charge{}.detonation))
             .like("\"programmed\"")
             .means("`programmed`: a detonation front travels from the points of initiation at the detonation speed of "
                    "the explosive; `instantaneous`: the simulation starts with products at the density and energy of "
                    "the charge"),
         nested(Type::tables, "initiation", initiation_table())
             .note("one point at `position`, at time 0")
             .like("[{position = [0, 0, 1.5], delay = \"2 us\"}]")
             .means("Points of initiation of a programmed detonation")});
    return t;
  }();
  return table;
}

namespace {

constexpr std::size_t most_charges = 100;
constexpr double mass_tolerance = 1e-3;  ///< within which a given mass and a given size agree

/// "10 kg/m" belongs to planar2d and cylindrical1d, "10 kg/m2" to planar1d; a plain mass goes everywhere.
bool mass_unit_fits(Draft const& draft, Section const& section) {
  std::string const& unit = section.entries.find("mass")->second.unit;
  if (unit.empty() || unit == "kg") return true;
  std::string const own = draft.geometry() == Geometry::planar2d || draft.geometry() == Geometry::cylindrical1d ? "kg/m"
                          : draft.geometry() == Geometry::planar1d ? "kg/m2"
                                                                   : "kg";
  if (unit == own) return true;
  draft.error(section, "mass",
              fmt::format("{} is given in {}, but in {} the mass of a charge is in {}", section.shown("mass"), unit,
                          word_of(draft.geometry()), own));
  return false;
}

/// A charge lies in the domain; only a symmetry plane through its centre may cut it.
bool inside_domain(Draft const& draft, Section const& section, shape::Shape const& body) {
  auto const b = shape::bounds(body);
  Vec3 const c = shape::centre(body);
  std::string_view const key = place_key(section);
  auto const* half = std::get_if<shape::Hemisphere>(&body);
  for (int f = 0; f < 2 * draft.dims(); ++f) {
    int const d = f / 2;
    bool const low = f % 2 == 0;
    double const plane = low ? draft.out.domain.lower[d] : draft.out.domain.upper(d);
    double const beyond = low ? plane - b.lower[d] : b.upper[d] - plane;
    if (beyond <= draft.tiny()) continue;
    if (draft.radial() && f == 0 && plane == 0.0) continue;  // the radius ends there
    Boundary const boundary = draft.out.domain.boundary[f];
    bool const centred = std::abs(c[d] - plane) <= draft.tiny();
    bool const outwards = half != nullptr && half->normal[d] * (low ? -1.0 : 1.0) > 0.0;
    std::string const where = fmt::format("the charge extends {:.4g} m beyond the face {} ({} = {:.6g} m)", beyond,
                                          grid::face_names[f], directions[d], plane);
    if (boundary == Boundary::symmetry) {
      if (centred && !outwards) continue;
      if (outwards) {
        draft.error(section, section.given("normal") ? "normal" : key,
                    fmt::format("{}, to which its normal points: change its normal to \"{}{}\"", where, low ? '+' : '-',
                                directions[d]));
      } else {
        draft.error(section, key,
                    fmt::format("{}, which is a symmetry plane, but its centre at {} = {:.6g} m is not on the plane: "
                                "put the centre on the plane or the whole charge inside the domain",
                                where, directions[d], c[d]));
      }
      return false;
    }
    bool const ball = std::holds_alternative<shape::Sphere>(body);
    bool const third =
        draft.geometry() == Geometry::cartesian3d || (draft.geometry() == Geometry::axisymmetric2d && d == 1);
    if (boundary == Boundary::wall && ball && third) {
      draft.error(section, key,
                  fmt::format("{}, which is a rigid wall: for a charge on the wall write shape = \"hemisphere\", "
                              "normal = \"{}{}\" and {} = {:.6g}, or move it inside the domain",
                              where, low ? '+' : '-', directions[d], directions[d], plane));
    } else {
      draft.error(
          section, key,
          fmt::format(
              "{}, which is \"{}\": move the charge inside or enlarge the domain; only a symmetry plane through "
              "its centre may cut a charge",
              where, word_of(boundary)));
    }
    return false;
  }
  // Wholly outside, without crossing: a body beyond the far side was caught above, so nothing is left to check.
  return true;
}

/// What a symmetry plane cuts must be its own mirror image, or the simulated charge is another one.
bool mirrors_itself(Draft const& draft, Section const& section, shape::Shape const& body) {
  grid::Domain const& domain = draft.out.domain;
  auto const box = shape::bounds(body);
  constexpr int samples = 32;
  constexpr double allowed = 0.01;  // of the samples inside: those beside faces count as they may
  for (int f = 0; f < 2 * draft.dims(); ++f) {
    int const d = f / 2;
    double const plane = f % 2 == 0 ? domain.lower[d] : domain.upper(d);
    bool const cut = box.lower[d] < plane - draft.tiny() && box.upper[d] > plane + draft.tiny();
    if (!cut || domain.boundary[f] != Boundary::symmetry || (draft.radial() && f == 0 && plane == 0.0)) continue;
    int inside = 0;
    int alone = 0;
    grid::CellRange all{{0, 0, 0}, {samples, 1, 1}};
    for (int e = 1; e < draft.dims(); ++e) all.upper[e] = samples;
    for_each_cell(all, [&](Index3 const& n) {
      Vec3 x{0.0, 0.0, 0.0};
      for (int e = 0; e < draft.dims(); ++e)
        x[e] = box.lower[e] + (n[e] + 0.5) / samples * (box.upper[e] - box.lower[e]);
      if (!shape::contains(body, domain, x)) return;
      ++inside;
      x[d] = 2.0 * plane - x[d];
      alone += shape::contains(body, domain, x) ? 0 : 1;
    });
    if (alone <= allowed * inside) continue;
    draft.error(
        section, section.given("rotate") ? "rotate" : place_key(section),
        fmt::format("the symmetry plane {} = {:.6g} m cuts the charge, but the charge is not its own mirror image "
                    "there, so a differently shaped charge would be simulated: turn or move the charge, or make "
                    "the domain hold all of it",
                    directions[d], plane));
    return false;
  }
  return true;
}

/// The domain; with cells of several sizes the part of it around a charge, on the cells of charges.
grid::Domain room_around(Draft const& draft, shape::Shape const& body) {
  int const level = draft.out.adaptive.charges;
  if (level == 0) return draft.out.domain;
  constexpr int room = 4;  // cells, as many as a grid has at least
  grid::Domain const whole = draft.out.domain_of(level);
  shape::CellRange const cells =
      grid::common(shape::cells_around(body, whole).grown(room, draft.dims()), whole.all_cells());
  grid::Domain part = whole;
  for (int d = 0; d < draft.dims(); ++d) {
    part.lower[d] = whole.face(d, cells.lower[d]);
    part.cells[d] = cells.upper[d] - cells.lower[d];
    if (cells.lower[d] > 0) part.boundary[2 * d] = Boundary::outflow;
    if (cells.upper[d] < whole.cells[d]) part.boundary[2 * d + 1] = Boundary::outflow;
  }
  return part;
}

/// A charge beside obstacles finds room between solid cells.
void fits_between_obstacles(Draft const& draft, Section const& section, shape::Shape const& body) {
  if (draft.out.obstacles.empty() || draft.deck.text("start") == "remap") return;
  auto const near = shape::bounds(body);
  bool const beside = std::any_of(draft.out.obstacles.begin(), draft.out.obstacles.end(), [&](run::Obstacle const& o) {
    auto const b = overlap(near, shape::bounds(o.shape));
    for (int d = 0; d < draft.dims(); ++d) {
      if (b.upper[d] - b.lower[d] < -draft.out.domain.h) return false;
    }
    return true;
  });
  if (!beside) return;
  grid::Domain const domain = room_around(draft, body);
  setup::SolidCells const solid(domain, draft.out.obstacles);
  try {
    (void)detonation::fill_cells(body, grid::Grid(domain), shape::volume(body, draft.geometry()), "the charge",
                                 [&](Index3 const& cell) { return setup::open_part(draft.out, solid, cell); });
  } catch (InputError const& problem) {
    draft.error(section, place_key(section), problem.what());
  }
}

void charge(Draft& draft, Section const& section, std::string& first_explosive,
            std::vector<std::pair<Section const*, shape::Shape>>& placed) {
  run::Charge charge;
  auto const name = section.text("explosive");
  auto const* found = name ? draft.materials.explosive(*name) : nullptr;
  if (name && found == nullptr)
    unknown_material(draft, section, "explosive", *name, "explosive", draft.materials.explosive_names());
  if (found == nullptr) {
    draft.products_known = false;
  } else if (first_explosive.empty()) {
    first_explosive = found->name;
    draft.out.other_fluids = {products(*found)};
  } else if (first_explosive != found->name) {
    draft.error(section, "explosive",
                fmt::format("\"{}\" differs from \"{}\" of the first charge: the two-fluid model has one product fluid "
                            "for all charges; use one explosive, or convert the mass with its TNT equivalent",
                            found->name, first_explosive));
    draft.products_known = false;
  }

  auto const mass = section.number("mass");
  bool const by_mass = section.given("mass");
  // Where the mass or the explosive is wrong the size is not known; any size shows the errors of the other keys.
  bool const size_known = !by_mass || (mass && found != nullptr && mass_unit_fits(draft, section));
  std::optional<double> volume_asked;
  if (by_mass) volume_asked = size_known ? *mass / found->density() : 1.0;
  auto const body = build_shape(draft, section, Use::charge, volume_asked);
  if (!body || !size_known) return;
  double const volume = shape::volume(*body, draft.geometry());
  if (found != nullptr) {
    charge.explosive = *found;
    charge.mass = mass.value_or(volume * found->density());
    if (mass && std::abs(volume * found->density() - *mass) > mass_tolerance * *mass) {
      draft.error(section, "mass",
                  fmt::format("{} disagrees with the size, which corresponds to {:.6g} kg of {} ({:g} kg/m3): give "
                              "only one of mass and size",
                              section.shown("mass"), volume * found->density(), found->name, found->density()));
      return;
    }
  }
  charge.shape = *body;
  if (draft.domain_known && draft.boundaries_known && !inside_domain(draft, section, *body)) return;
  if (draft.domain_known && draft.boundaries_known && !mirrors_itself(draft, section, *body)) return;
  placed.emplace_back(&section, *body);
  if (!build_initiation(draft, section, *body, "charge", charge.detonation, charge.initiation)) return;
  draft.charge_shapes.emplace_back(&section, charge.shape);
  draft.out.charges.push_back(std::move(charge));
}

}  // namespace

void build_charges(Draft& draft) {
  auto const* all = draft.deck.sections("charge");
  if (all == nullptr) return;
  if (all->size() > most_charges) {
    draft.error(draft.deck, "charge",
                fmt::format("there are {} charges; allowed: at most {}", all->size(), most_charges));
    return;
  }
  std::string first_explosive;
  std::vector<std::pair<Section const*, shape::Shape>> placed;
  for (auto const& section : *all) charge(draft, section, first_explosive, placed);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      auto const common = common_point(draft, placed[i].second, placed[j].second);
      if (!common) continue;
      draft.error(*placed[i].first, place_key(*placed[i].first),
                  fmt::format("{} overlaps {} around {} m: move them apart or make them smaller", placed[i].first->path,
                              placed[j].first->path, point_text(*common, draft.dims())));
    }
    auto const* bodies = draft.deck.sections("obstacle");
    bool apart = draft.domain_known && draft.boundaries_known;
    for (auto const& [index, obstacle] : draft.obstacle_shapes) {
      auto const common = common_point(draft, placed[i].second, obstacle);
      if (!common) continue;
      apart = false;
      draft.error(*placed[i].first, place_key(*placed[i].first),
                  fmt::format("{} overlaps {} around {} m: move one of them", placed[i].first->path,
                              (*bodies)[index].path, point_text(*common, draft.dims())));
    }
    if (apart) fits_between_obstacles(draft, *placed[i].first, placed[i].second);
  }
}

}  // namespace brisance::deck
