/// From checked values to a case: what the values of a deck mean together.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <set>

#include "core/error.hpp"
#include "core/parameter.hpp"
#include "deck/deck.hpp"
#include "deck/library.hpp"
#include "deck/reader.hpp"
#include "material/chapman_jouguet.hpp"

namespace brisance::deck {

namespace {

using grid::Boundary;
using grid::Geometry;

constexpr double most_cells = 2147483648.0;  ///< 2^31
constexpr double fewest_cells = 4.0;         ///< per direction: the stencil of the schemes
constexpr double most_gauges = 1e5;
constexpr std::size_t most_charges = 100;
constexpr std::size_t most_obstacles = 1000;
constexpr double most_dumps = 1e4;
constexpr double most_records = 1e7;        ///< per gauge
constexpr double mass_tolerance = 1e-3;     ///< within which a given mass and a given size agree
constexpr double cell_tolerance = 1e-6;     ///< relative, of an extent to a whole number of cells
constexpr double gas_temperature = 288.15;  ///< at which a gas has the density of its table [K]
constexpr char const* directions = "xyz";

std::string joined(std::vector<std::string> const& words) { return quoted_list(words); }

/// "x", "x and y" or "x, y and z".
std::string direction_list(int count) { return count == 1 ? "x" : count == 2 ? "x and y" : "x, y and z"; }

std::string point_text(Vec3 const& p, int dimensions) {
  std::string out = "[";
  for (int d = 0; d < dimensions; ++d) out += fmt::format("{}{:.6g}", d > 0 ? ", " : "", p[d]);
  return out + "]";
}

class Builder {
 public:
  Builder(Section const& deck, Report& report) : deck_(deck), report_(report) {}

  run::Case build() {
    out_.title = deck_.text("title").value_or("");
    domain();
    own_materials();
    ambient();
    if (geometry_known_) {
      boundaries();
      obstacles();
      charges();
      regions();
      gauges();
    }
    numerics();
    end();
    output();
    compare();
    return std::move(out_);
  }

 private:
  Section const& deck_;
  Report& report_;
  run::Case out_;
  bool geometry_known_ = false;  ///< without it, nothing about positions can be said
  bool domain_known_ = false;    ///< extents are known and sound
  bool boundaries_known_ = false;
  bool ambient_known_ = false;  ///< the fluid is known
  bool products_known_ = true;  ///< false when a charge's explosive was wrong
  bool end_known_ = false;
  std::vector<material::Explosive> own_explosives_;
  std::vector<material::Fluid> own_fluids_;
  std::set<std::string, std::less<>> wrong_materials_;  ///< names of own materials with an error of their own

  [[nodiscard]] Geometry geometry() const { return out_.domain.geometry; }
  [[nodiscard]] int dims() const { return out_.domain.dimensions(); }
  [[nodiscard]] bool radial() const { return grid::radial_exponent(geometry()) > 0; }
  /// Lengths below this are round-off [m].
  [[nodiscard]] double tiny() const { return 1e-6 * out_.domain.h; }

  void error(Section const& section, std::string_view key, std::string const& message) {
    report_.error(section.place_of(key), section.path_of(key), message);
  }

  template <class F>
  void each(std::string_view key, F f) {
    auto const* all = deck_.sections(key);
    if (all == nullptr) return;
    for (auto const& section : *all) f(section);
  }

  // --- domain
  // ------------------------------------------------------------------------------------------------------------------

  /// A point or vector: one element per resolved direction; the others may be written as 0.
  std::optional<Vec3> point(Section const& section, std::string_view key) {
    auto const* values = section.numbers(key);
    if (values == nullptr) return std::nullopt;
    auto const count = static_cast<int>(values->size());
    if (count < dims()) {
      error(section, key,
            fmt::format("{} has {} element{}, but {} resolves {}: give {} elements", section.shown(key), count,
                        count == 1 ? "" : "s", grid::geometry_name(geometry()), direction_list(dims()), dims()));
      return std::nullopt;
    }
    Vec3 out{0.0, 0.0, 0.0};
    for (int d = 0; d < count; ++d) {
      if (d >= dims() && (*values)[d] != 0.0) {
        error(section, key,
              fmt::format("{} has a value in direction {}, but {} resolves only {}: remove it or write 0",
                          section.shown(key), directions[d], grid::geometry_name(geometry()), direction_list(dims())));
        return std::nullopt;
      }
      out[d] = (*values)[d];
    }
    return out;
  }

  void domain() {
    Section const* section = deck_.section("domain");
    if (section == nullptr) return;
    auto const word = section->text("geometry");
    if (!word) return;
    for (Geometry const g : {Geometry::cartesian3d, Geometry::planar2d, Geometry::axisymmetric2d, Geometry::planar1d,
                             Geometry::cylindrical1d, Geometry::spherical1d}) {
      if (*word == grid::geometry_name(g)) out_.domain.geometry = g;
    }
    geometry_known_ = true;
    if (section->doubtful()) return;

    auto const h = section->number("cell");
    if (h) out_.domain.h = *h;
    std::optional<Vec3> lower = Vec3{0.0, 0.0, 0.0};
    if (section->given("lower")) lower = point(*section, "lower");
    auto const upper = point(*section, "upper");
    auto const size = point(*section, "size");
    if (!section->given("upper") && !section->given("size")) {
      report_.error(section->place, "domain.size",
                    "the extent of the domain is missing; write for example size = [4, 4, 3] (or upper = ...), in m");
      return;
    }
    if (lower && radial() && (*lower)[0] < 0.0) {
      error(*section, "lower",
            fmt::format("{} starts at a negative radius; in {} x is the radius: write 0 or more",
                        section->shown("lower"), grid::geometry_name(geometry())));
      return;
    }
    if (!h || !lower || (section->given("upper") && !upper) || (section->given("size") && !size)) return;
    out_.domain.lower = *lower;

    std::string_view const key = upper ? "upper" : "size";
    bool sound = true;
    double count = 1.0;
    for (int d = 0; d < dims(); ++d) {
      double const extent = upper ? (*upper)[d] - (*lower)[d] : (*size)[d];
      if (upper && size && std::abs(extent - (*size)[d]) > cell_tolerance * std::abs(extent)) {
        error(*section, "size",
              fmt::format("{} disagrees with lower and upper in direction {}, which are {:g} m apart: give only "
                          "one of size and upper",
                          section->shown("size"), directions[d], extent));
        return;
      }
      if (extent <= 0.0) {
        error(*section, key,
              fmt::format("{} leaves no extent in direction {} ({:g} m): it must be positive", section->shown(key),
                          directions[d], extent));
        sound = false;
        continue;
      }
      double const cells = extent / *h;
      double const whole = std::max(1.0, std::round(cells));
      count *= whole;
      if (whole > most_cells) continue;
      if (std::abs(cells - whole) > cell_tolerance * cells) {
        double const below = std::floor(cells);
        std::string const nearest_extents = below >= 1.0
                                                ? fmt::format("{:.9g} or {:.9g} m", below * *h, (below + 1.0) * *h)
                                                : fmt::format("{:.9g} m", *h);
        error(*section, key,
              fmt::format("{} is not a whole number of cells: {:.9g} m in direction {} are {:.6g} cells of {:.9g} m; "
                          "make the extent "
                          "{}, or change the cell",
                          section->shown(key), extent, directions[d], cells, *h, nearest_extents));
        sound = false;
        continue;
      }
      if (whole < fewest_cells) {
        error(*section, key,
              fmt::format(
                  "{} gives {:g} cell{} in direction {}; allowed: at least {:g}: make the extent {:.9g} m or more, or "
                  "the cell smaller",
                  section->shown(key), whole, whole > 1.0 ? "s" : "", directions[d], fewest_cells, fewest_cells * *h));
        sound = false;
        continue;
      }
      out_.domain.cells[d] = static_cast<int>(whole);
    }
    if (!sound) return;
    double const coarser = *h * std::pow(count / most_cells, 1.0 / dims());
    if (count >= most_cells) {
      error(*section, "cell",
            fmt::format("{} gives {:.4g} cells; allowed: fewer than 2^31 ({:.4g}); choose a cell above {:.3g} m or a "
                        "smaller domain",
                        section->shown("cell"), count, most_cells, coarser));
      return;
    }
    domain_known_ = true;
  }

  void boundaries() {
    Section const* section = deck_.section("boundaries");
    auto const kind = [](std::string const& word) {
      for (Boundary const b : {Boundary::wall, Boundary::symmetry, Boundary::inflow, Boundary::periodic}) {
        if (word == grid::boundary_name(b)) return b;
      }
      return Boundary::outflow;
    };
    boundaries_known_ = section == nullptr || !section->broken("all");
    Boundary const all = section == nullptr ? Boundary::outflow : kind(section->text("all").value_or("outflow"));
    bool const axis = radial() && out_.domain.lower[0] == 0.0;
    for (int f = 0; f < 6; ++f) {
      std::string_view const face = grid::face_names[f];
      bool const given = section != nullptr && section->given(face);
      if (f / 2 >= dims()) {
        if (given) {
          error(*section, face,
                fmt::format("{} has no face {}: it resolves only {}; remove the key", grid::geometry_name(geometry()),
                            face, direction_list(dims())));
        }
        continue;
      }
      Boundary& b = out_.domain.boundary[f];
      b = f == 0 && axis ? Boundary::symmetry : all;
      if (!given) continue;
      auto const word = section->text(face);
      if (!word) {
        boundaries_known_ = false;
        continue;
      }
      b = kind(*word);
      if (f == 0 && axis && b != Boundary::symmetry) {
        error(
            *section, face,
            fmt::format("\"{}\" is not possible at radius 0; allowed: \"symmetry\", which is the default there: remove "
                        "the key",
                        *word));
      }
      if (f / 2 == 0 && radial() && b == Boundary::periodic) {
        error(*section, face,
              fmt::format("\"periodic\" is not possible along the radius x of {}; choose another boundary",
                          grid::geometry_name(geometry())));
      }
    }
    if (!boundaries_known_) return;
    for (int d = 0; d < dims(); ++d) {
      bool const low = out_.domain.boundary[2 * d] == Boundary::periodic;
      bool const high = out_.domain.boundary[2 * d + 1] == Boundary::periodic;
      if (low == high || (radial() && d == 0)) continue;
      int const other = low ? 2 * d + 1 : 2 * d;
      error(
          *section,
          section->given(grid::face_names[low ? 2 * d : 2 * d + 1]) ? grid::face_names[low ? 2 * d : 2 * d + 1] : "all",
          fmt::format("\"periodic\" joins both faces of a direction, but {} is \"{}\": make both periodic",
                      grid::face_names[other], grid::boundary_name(out_.domain.boundary[other])));
    }
    inflow(section);
  }

  void inflow(Section const* section) {
    for (auto& state : out_.inflow) state = out_.ambient.state;
    std::array<bool, 6> described{};
    each("inflow", [&](Section const& given) {
      int const f = static_cast<int>(std::find(grid::face_names.begin(), grid::face_names.end(), given.name) -
                                     grid::face_names.begin());
      described[f] = true;
      if (f / 2 >= dims() || out_.domain.boundary[f] != Boundary::inflow) {
        report_.error(
            given.place, given.path,
            fmt::format(
                "the face {} is \"{}\", so that this table is without use: write {} = \"inflow\" in [boundaries] or "
                "remove the table",
                given.name, f / 2 >= dims() ? "not resolved" : grid::boundary_name(out_.domain.boundary[f]),
                given.name));
        return;
      }
      if (auto const s = state(given, out_.ambient.fluid, out_.ambient.state, "density")) out_.inflow[f] = *s;
    });
    for (int f = 0; f < 2 * dims(); ++f) {
      if (out_.domain.boundary[f] != Boundary::inflow || described[f]) continue;
      std::string_view const key = section->given(grid::face_names[f]) ? grid::face_names[f] : "all";
      error(*section, key,
            fmt::format("\"inflow\" needs the entering state: add [inflow.{}] with velocity = [...]",
                        grid::face_names[f]));
    }
  }

  // --- materials
  // ---------------------------------------------------------------------------------------------------------------

  void own_materials() {
    each("explosives", [&](Section const& section) {
      auto explosive = build_explosive(section, section.name);
      if (!explosive) {
        wrong_materials_.insert(section.name);
        return;
      }
      try {
        auto const check = material::check(*explosive);
        if (!check.consistent()) {
          report_.warning(
              section.place, section.path,
              fmt::format(
                  "the constants give a detonation speed of {:.0f} m/s and a Chapman-Jouguet pressure of {:.4g} GPa; "
                  "listed are {:.0f} m/s and {:.4g} GPa",
                  check.state.speed, check.state.pressure / 1e9, explosive->detonation_speed,
                  explosive->cj_pressure / 1e9));
        }
      } catch (InputError const& e) {
        report_.error(section.place, section.path, fmt::format("these constants describe no detonation: {}", e.what()));
        wrong_materials_.insert(section.name);
        return;
      }
      if (library().explosive(section.name) != nullptr) {
        report_.warning(section.place, section.path, "replaces the explosive of the same name in the library");
      }
      own_explosives_.push_back(std::move(*explosive));
    });
    each("fluids", [&](Section const& section) {
      auto fluid = build_fluid(section, section.name);
      if (!fluid) {
        wrong_materials_.insert(section.name);
        return;
      }
      if (library().fluid(section.name) != nullptr) {
        report_.warning(section.place, section.path, "replaces the fluid of the same name in the library");
      }
      own_fluids_.push_back(std::move(*fluid));
    });
  }

  template <class Material>
  static Material const* find_own(std::vector<Material> const& all, std::string_view name) {
    for (auto const& m : all) {
      if (m.name == name) return &m;
    }
    return nullptr;
  }

  material::Explosive const* explosive(std::string_view name) const {
    auto const* own = find_own(own_explosives_, name);
    return own != nullptr ? own : library().explosive(name);
  }
  material::Fluid const* fluid(std::string_view name) const {
    auto const* own = find_own(own_fluids_, name);
    return own != nullptr ? own : library().fluid(name);
  }

  void unknown_material(Section const& section, std::string_view key, std::string const& name, char const* kind,
                        std::vector<std::string> const& names) {
    if (wrong_materials_.contains(name)) return;  // reported where it is defined
    error(section, key,
          fmt::format("{} is not a known {}; {}", section.given(key) ? section.shown(key) : fmt::format("\"{}\"", name),
                      kind, suggestion(name, names, fmt::format("known {}s", kind))));
  }

  std::vector<std::string> fluid_names() const {
    auto names = library().fluid_names();
    for (auto const& f : own_fluids_) names.push_back(f.name);
    return names;
  }
  std::vector<std::string> explosive_names() const {
    auto names = library().explosive_names();
    for (auto const& e : own_explosives_) names.push_back(e.name);
    return names;
  }

  /// The products of an explosive as a fluid; density and pressure are those of an instantaneous detonation.
  static material::Fluid products(material::Explosive const& e) {
    return {e.name, e.source, e.products, e.density(),
            material::pressure(e.products, e.density(), e.specific_energy())};
  }

  /// Density, pressure and velocity of a table, with defaults.
  std::optional<run::FluidState> state(Section const& section, material::Fluid const& of, run::FluidState defaults,
                                       std::string_view blamed) {
    if (geometry_known_ && section.given("velocity")) {
      auto const velocity = point(section, "velocity");
      if (!velocity) return std::nullopt;
      defaults.velocity = *velocity;
    }
    if (section.broken("density") || section.broken("pressure")) return std::nullopt;
    defaults.density = section.number("density").value_or(defaults.density);
    defaults.pressure = section.number("pressure").value_or(defaults.pressure);
    if (!(material::bulk_modulus(of.eos, defaults.density, defaults.pressure) > 0.0)) {
      std::string_view const key = section.given(blamed) ? blamed : "pressure";
      report_.error(
          section.place_of(key), section.path_of(key),
          fmt::format(
              "{} at {:g} kg/m3 and {:g} Pa has no real sound speed: this state is outside its equation of state; "
              "its own density is {:g} kg/m3",
              of.name, defaults.density, defaults.pressure, of.density));
      return std::nullopt;
    }
    return defaults;
  }

  void ambient() {
    static Section const nothing = [] {
      Section s;
      s.table = deck_schema().find("ambient")->table;
      s.path = "ambient";
      return s;
    }();
    if (deck_.broken("ambient")) return;
    Section const* given = deck_.section("ambient");
    Section const& section = given == nullptr ? nothing : *given;
    auto const name = section.text("fluid");
    if (!name) return;
    auto const* found = fluid(*name);
    if (found == nullptr) {
      unknown_material(section, "fluid", *name, "fluid", fluid_names());
      return;
    }
    out_.ambient.fluid = *found;
    out_.ambient.state = {found->density, found->pressure, {0.0, 0.0, 0.0}};
    ambient_known_ = true;
    run::FluidState defaults{found->density, found->pressure, {0.0, 0.0, 0.0}};
    if (section.given("temperature")) {
      auto const temperature = section.number("temperature");
      if (section.given("density")) {
        error(section, "temperature",
              fmt::format("{} is given beside a density: remove one of the two", section.shown("temperature")));
      } else if (!std::holds_alternative<material::IdealGas>(found->eos)) {
        error(section, "temperature",
              fmt::format("{} cannot be used: {} is no ideal gas; give its density instead",
                          section.shown("temperature"), found->name));
      } else if (temperature) {
        double const p = section.number("pressure").value_or(found->pressure);
        defaults.density = found->density * (p / found->pressure) * (gas_temperature / *temperature);
      }
    }
    auto const s = state(section, *found, defaults, "density");
    if (s) out_.ambient.state = *s;
  }

  // --- shapes
  // ------------------------------------------------------------------------------------------------------------------

  [[nodiscard]] std::vector<std::string> possible_shapes(bool charge) const {
    switch (geometry()) {
      case Geometry::cartesian3d:
      case Geometry::axisymmetric2d: return {"sphere", "hemisphere", "cylinder", "box"};
      case Geometry::planar2d: return {"cylinder", "box"};
      case Geometry::planar1d: return {"box"};
      case Geometry::cylindrical1d:
        return charge ? std::vector<std::string>{"cylinder"} : std::vector<std::string>{"cylinder", "box"};
      case Geometry::spherical1d:
        return charge ? std::vector<std::string>{"sphere"} : std::vector<std::string>{"sphere", "box"};
    }
    return {};
  }

  [[nodiscard]] bool cylinder_has_length() const {
    return geometry() == Geometry::cartesian3d || geometry() == Geometry::axisymmetric2d;
  }

  /// The shape of a charge, obstacle or region. A charge may leave its size to `volume_asked` [m3].
  std::optional<detonation::Shape> shape(Section const& section, bool charge, std::optional<double> volume_asked) {
    if (section.broken("shape") || section.doubtful()) return std::nullopt;
    auto const possible = possible_shapes(charge);
    std::string const word = section.text("shape").value_or(possible.front());
    if (std::find(possible.begin(), possible.end(), word) == possible.end()) {
      std::string const disc =
          word == "sphere" && geometry() == Geometry::planar2d ? " (a \"cylinder\" is a disc here)" : "";
      error(section, "shape",
            fmt::format("\"{}\" is not possible in {}; allowed: {}{}", word, grid::geometry_name(geometry()),
                        joined(possible), disc));
      return std::nullopt;
    }
    if (!only_keys_of(section, word)) return std::nullopt;
    for (auto const* key :
         {"position", "radius", "length", "axis", "normal", "size", "lower", "upper", "length_to_diameter"}) {
      if (section.broken(key)) return std::nullopt;
    }
    Vec3 position{0.0, 0.0, 0.0};
    if (section.given("position")) {
      auto const p = point(section, "position");
      if (!p) return std::nullopt;
      position = *p;
      if (word != "box" && radial() && position[0] != 0.0) {
        error(section, "position",
              fmt::format("{} does not lie on the axis; a {} in {} is centred at radius 0: write 0 as its first "
                          "element, or use a box, which is a ring or shell",
                          section.shown("position"), word, grid::geometry_name(geometry())));
        return std::nullopt;
      }
    }
    if (word == "box") return box(section, position, volume_asked);
    if (word == "cylinder") return cylinder(section, position, volume_asked);

    detonation::Sphere const unit_sphere{position, 1.0};
    Vec3 normal{0.0, 0.0, 1.0};
    if (geometry() == Geometry::axisymmetric2d) normal = {0.0, 1.0, 0.0};
    if (section.given("normal")) {
      std::string const given = *section.text("normal");
      normal = {0.0, 0.0, 0.0};
      normal[given[1] - 'x'] = given[0] == '-' ? -1.0 : 1.0;
      if (geometry() == Geometry::axisymmetric2d && given[1] != 'y') {
        error(
            section, "normal",
            fmt::format("\"{}\" is not possible in axisymmetric2d; allowed: \"+y\" or \"-y\", along the axis", given));
        return std::nullopt;
      }
    }
    bool const half = word == "hemisphere";
    detonation::Shape const unit =
        half ? detonation::Shape(detonation::Hemisphere{position, 1.0, normal}) : unit_sphere;
    double radius = 0.0;
    if (auto const given = section.number("radius")) {
      radius = *given;
    } else if (volume_asked) {
      radius = std::cbrt(*volume_asked / detonation::volume(unit, geometry()));
    } else {
      size_missing(section, "radius", charge, "radius = \"50 mm\"");
      return std::nullopt;
    }
    if (half) return detonation::Hemisphere{position, radius, normal};
    return detonation::Sphere{position, radius};
  }

  void size_missing(Section const& section, std::string_view key, bool charge, std::string const& example) {
    report_.error(
        section.place, section.path_of(key),
        charge
            ? fmt::format("the charge has neither a mass nor a size; write for example mass = \"10 kg\" or {}", example)
            : fmt::format("the key \"{}\" is missing; write for example {}", key, example));
  }

  /// Are only those size keys given that the shape has?
  bool only_keys_of(Section const& section, std::string const& word) {
    std::vector<std::string> allowed;
    if (word == "sphere") allowed = {"position", "radius"};
    if (word == "hemisphere") allowed = {"position", "radius", "normal"};
    if (word == "cylinder") {
      allowed = {"position", "radius"};
      if (cylinder_has_length()) allowed.insert(allowed.end(), {"length", "length_to_diameter"});
      if (geometry() == Geometry::cartesian3d) allowed.emplace_back("axis");
    }
    if (word == "box") allowed = {"position", "size", "lower", "upper"};
    bool sound = true;
    for (std::string const key :
         {"position", "radius", "length", "axis", "normal", "size", "lower", "upper", "length_to_diameter"}) {
      if (!section.given(key) || std::find(allowed.begin(), allowed.end(), key) != allowed.end()) continue;
      auto offered = allowed;
      std::erase_if(offered, [&](std::string const& k) { return section.table->find(k) == nullptr; });
      error(section, key,
            fmt::format("{} does not apply to a {} in {}; its keys are {}: remove it or change the shape",
                        section.shown(key), word, grid::geometry_name(geometry()), fmt::join(offered, ", ")));
      sound = false;
    }
    return sound;
  }

  std::optional<detonation::Shape> cylinder(Section const& section, Vec3 const& position,
                                            std::optional<double> volume_asked) {
    bool const charge = section.table->find("mass") != nullptr;
    Vec3 axis{0.0, 0.0, 1.0};
    if (geometry() == Geometry::axisymmetric2d) axis = {0.0, 1.0, 0.0};
    if (section.given("axis")) {
      axis = {0.0, 0.0, 0.0};
      axis[(*section.text("axis"))[0] - 'x'] = 1.0;
    }
    auto const radius = section.number("radius");
    auto const volume_of = [&](double r, double l) {
      return detonation::volume(detonation::Cylinder{position, r, l, axis}, geometry());
    };
    if (!cylinder_has_length()) {
      if (!radius && !volume_asked) {
        size_missing(section, "radius", charge, "radius = \"50 mm\"");
        return std::nullopt;
      }
      return detonation::Cylinder{position, radius ? *radius : std::sqrt(*volume_asked / volume_of(1.0, 1.0)), 1.0,
                                  axis};
    }
    auto const length = section.number("length");
    auto const ratio = section.number("length_to_diameter");
    if (length && ratio) {
      error(section, "length_to_diameter",
            fmt::format("{} is given beside a length: remove one of the two", section.shown("length_to_diameter")));
      return std::nullopt;
    }
    if (radius && length) return detonation::Cylinder{position, *radius, *length, axis};
    if (radius && ratio) return detonation::Cylinder{position, *radius, 2.0 * *radius * *ratio, axis};
    if (volume_asked && radius)
      return detonation::Cylinder{position, *radius, *volume_asked / volume_of(*radius, 1.0), axis};
    if (volume_asked && length) {
      return detonation::Cylinder{position, std::sqrt(*volume_asked / volume_of(1.0, *length)), *length, axis};
    }
    if (volume_asked && ratio) {
      double const r = std::cbrt(*volume_asked / volume_of(1.0, 2.0 * *ratio));
      return detonation::Cylinder{position, r, 2.0 * r * *ratio, axis};
    }
    report_.error(
        section.place, section.path_of("length"),
        volume_asked ? "a cylinder of given mass needs its proportions too; write for example length_to_diameter = 1 "
                       "(or length, or radius)"
        : charge ? "a cylinder needs its mass and proportions or its radius and length; write for example mass = \"10 "
                   "kg\" and "
                   "length_to_diameter = 1"
                 : "a cylinder needs radius and length; write for example radius = \"50 mm\" and length = \"0.2 m\"");
    return std::nullopt;
  }

  std::optional<detonation::Shape> box(Section const& section, Vec3 const& position,
                                       std::optional<double> volume_asked) {
    bool const charge = section.table->find("mass") != nullptr;
    bool const corners = section.given("lower") || section.given("upper");
    if (corners && (section.given("size") || section.given("position"))) {
      std::string_view const key = section.given("size") ? "size" : "position";
      error(section, key,
            fmt::format("{} is given beside lower or upper: a box has either lower and upper or position and size",
                        section.shown(key)));
      return std::nullopt;
    }
    Vec3 low = position;
    Vec3 high = position;
    if (corners) {
      for (auto const* key : {"lower", "upper"}) {
        if (!section.given(key)) {
          report_.error(section.place, section.path_of(key),
                        "a box has both corners; write for example lower = [2, -1, 0] and "
                        "upper = [3, 1, 2]");
          return std::nullopt;
        }
      }
      auto const lower = point(section, "lower");
      auto const upper = point(section, "upper");
      if (!lower || !upper) return std::nullopt;
      low = *lower;
      high = *upper;
    } else {
      Vec3 size{0.0, 0.0, 0.0};
      if (section.given("size")) {
        auto const given = point(section, "size");
        if (!given) return std::nullopt;
        size = *given;
      } else if (volume_asked && !radial()) {
        double const edge = std::pow(*volume_asked, 1.0 / dims());
        for (int d = 0; d < dims(); ++d) size[d] = edge;
      } else {
        size_missing(section, "size", charge, radial() ? "lower = [...] and upper = [...]" : "size = [1, 1, 1]");
        return std::nullopt;
      }
      low = position - 0.5 * size;
      high = position + 0.5 * size;
    }
    for (int d = 0; d < dims(); ++d) {
      if (high[d] - low[d] > 0.0) continue;
      std::string_view const key = corners ? "upper" : "size";
      error(section, key,
            fmt::format("{} leaves no extent in direction {} ({:g} m): it must be positive", section.shown(key),
                        directions[d], high[d] - low[d]));
      return std::nullopt;
    }
    if (radial() && low[0] < 0.0) {
      std::string_view const key = corners ? "lower" : "position";
      error(section, key,
            fmt::format(
                "the box starts at the radius {:g} m; in {} x is the radius: give lower and upper with radii of 0 "
                "or more",
                low[0], grid::geometry_name(geometry())));
      return std::nullopt;
    }
    // One metre thick where a direction is not resolved.
    for (int d = dims(); d < 3; ++d) {
      low[d] = -0.5;
      high[d] = 0.5;
    }
    return detonation::Box{low, high};
  }

  /// Where the shape is placed: the key to blame.
  static std::string_view place_key(Section const& section) {
    return section.given("position") ? "position" : section.given("lower") ? "lower" : "position";
  }

  void touches_domain(Section const& section, detonation::Shape const& shape) {
    if (!domain_known_) return;
    auto const b = detonation::bounds(shape);
    for (int d = 0; d < dims(); ++d) {
      if (b.upper[d] > out_.domain.lower[d] && b.lower[d] < out_.domain.upper(d)) continue;
      error(section, place_key(section),
            fmt::format("the body reaches from {:.6g} to {:.6g} m in direction {} and lies outside the domain ({:.6g} "
                        "to {:.6g} m): move "
                        "it or remove it",
                        b.lower[d], b.upper[d], directions[d], out_.domain.lower[d], out_.domain.upper(d)));
      return;
    }
  }

  /// Do the bodies share points? Two balls (in 2D discs) exactly, others by points in the box that their bounds share.
  [[nodiscard]] std::optional<Vec3> common_point(detonation::Shape const& a, detonation::Shape const& b) const {
    auto const x = detonation::bounds(a);
    auto const y = detonation::bounds(b);
    Vec3 low{0.0, 0.0, 0.0};
    Vec3 high{0.0, 0.0, 0.0};
    for (int d = 0; d < dims(); ++d) {
      low[d] = std::max(x.lower[d], y.lower[d]);
      high[d] = std::min(x.upper[d], y.upper[d]);
      if (high[d] - low[d] <= tiny()) return std::nullopt;
    }
    auto const* s = std::get_if<detonation::Sphere>(&a);
    auto const* t = std::get_if<detonation::Sphere>(&b);
    if (s != nullptr && t != nullptr) {
      double const distance = norm(s->centre - t->centre);
      if (distance >= s->radius + t->radius - tiny()) return std::nullopt;
      return 0.5 * (low + high);
    }
    constexpr int samples = 12;
    Index3 count{1, 1, 1};
    for (int d = 0; d < dims(); ++d) count[d] = samples;
    for (int k = 0; k < count[2]; ++k) {
      for (int j = 0; j < count[1]; ++j) {
        for (int i = 0; i < count[0]; ++i) {
          Index3 const n{i, j, k};
          Vec3 p{0.0, 0.0, 0.0};
          for (int d = 0; d < dims(); ++d) p[d] = low[d] + (n[d] + 0.5) / samples * (high[d] - low[d]);
          if (detonation::contains(a, out_.domain, p) && detonation::contains(b, out_.domain, p)) return p;
        }
      }
    }
    return std::nullopt;
  }

  // --- charges
  // -----------------------------------------------------------------------------------------------------------------

  void charges() {
    auto const* all = deck_.sections("charge");
    if (all == nullptr) return;
    if (all->size() > most_charges) {
      error(deck_, "charge", fmt::format("there are {} charges; allowed: at most {}", all->size(), most_charges));
      return;
    }
    std::string first_explosive;
    std::vector<std::pair<Section const*, detonation::Shape>> placed;
    for (auto const& section : *all) charge(section, first_explosive, placed);
    for (std::size_t i = 0; i < placed.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        auto const common = common_point(placed[i].second, placed[j].second);
        if (!common) continue;
        error(*placed[i].first, place_key(*placed[i].first),
              fmt::format("{} overlaps {} around {} m: move them apart or make them smaller", placed[i].first->path,
                          placed[j].first->path, point_text(*common, dims())));
      }
      auto const* bodies = deck_.sections("obstacle");
      for (auto const& [index, obstacle] : obstacle_shapes_) {
        auto const common = common_point(placed[i].second, obstacle);
        if (!common) continue;
        error(*placed[i].first, place_key(*placed[i].first),
              fmt::format("{} reaches into {} around {} m: move one of them", placed[i].first->path,
                          (*bodies)[index].path, point_text(*common, dims())));
      }
    }
  }

  void charge(Section const& section, std::string& first_explosive,
              std::vector<std::pair<Section const*, detonation::Shape>>& placed) {
    run::Charge charge;
    auto const name = section.text("explosive");
    auto const* found = name ? explosive(*name) : nullptr;
    if (name && found == nullptr) unknown_material(section, "explosive", *name, "explosive", explosive_names());
    if (found == nullptr) {
      products_known_ = false;
    } else if (first_explosive.empty()) {
      first_explosive = found->name;
      out_.second_fluid = products(*found);
    } else if (first_explosive != found->name) {
      error(section, "explosive",
            fmt::format("\"{}\" differs from the first charge's \"{}\": the two-fluid model has one product fluid for "
                        "all charges; use one "
                        "explosive, or convert the mass by its TNT equivalent",
                        found->name, first_explosive));
      products_known_ = false;
    }

    auto const mass = section.number("mass");
    bool const by_mass = section.given("mass");
    // Where the mass or the explosive is wrong the size is not known; any size shows the errors of the other keys.
    bool const size_known = !by_mass || (mass && found != nullptr && mass_unit_fits(section));
    std::optional<double> volume_asked;
    if (by_mass) volume_asked = size_known ? *mass / found->density() : 1.0;
    auto const body = shape(section, true, volume_asked);
    if (!body || !size_known) return;
    double const volume = detonation::volume(*body, geometry());
    if (found != nullptr) {
      charge.explosive = *found;
      charge.mass = mass.value_or(volume * found->density());
      if (mass && std::abs(volume * found->density() - *mass) > mass_tolerance * *mass) {
        error(
            section, "mass",
            fmt::format(
                "{} disagrees with the size, which holds {:.6g} kg of {} ({:g} kg/m3): give only one of mass and size",
                section.shown("mass"), volume * found->density(), found->name, found->density()));
        return;
      }
    }
    charge.shape = *body;
    if (domain_known_ && boundaries_known_ && !inside_domain(section, *body)) return;
    placed.emplace_back(&section, *body);
    if (!initiation(section, *body, charge)) return;
    out_.charges.push_back(std::move(charge));
  }

  /// "10 kg/m" belongs to planar2d and cylindrical1d, "10 kg/m2" to planar1d; a plain mass goes everywhere.
  bool mass_unit_fits(Section const& section) {
    std::string const& unit = section.entries.find("mass")->second.unit;
    if (unit.empty() || unit == "kg") return true;
    std::string const own = geometry() == Geometry::planar2d || geometry() == Geometry::cylindrical1d ? "kg/m"
                            : geometry() == Geometry::planar1d                                        ? "kg/m2"
                                                                                                      : "kg";
    if (unit == own) return true;
    error(section, "mass",
          fmt::format("{} is given in {}, but a charge in {} has its mass in {}", section.shown("mass"), unit,
                      grid::geometry_name(geometry()), own));
    return false;
  }

  /// A charge lies in the domain; only a symmetry plane through its centre may cut it.
  bool inside_domain(Section const& section, detonation::Shape const& body) {
    auto const b = detonation::bounds(body);
    Vec3 const c = detonation::centre(body);
    std::string_view const key = place_key(section);
    auto const* half = std::get_if<detonation::Hemisphere>(&body);
    for (int f = 0; f < 2 * dims(); ++f) {
      int const d = f / 2;
      bool const low = f % 2 == 0;
      double const plane = low ? out_.domain.lower[d] : out_.domain.upper(d);
      double const beyond = low ? plane - b.lower[d] : b.upper[d] - plane;
      if (beyond <= tiny()) continue;
      if (radial() && f == 0 && plane == 0.0) continue;  // the radius ends there
      Boundary const boundary = out_.domain.boundary[f];
      bool const centred = std::abs(c[d] - plane) <= tiny();
      bool const outwards = half != nullptr && half->normal[d] * (low ? -1.0 : 1.0) > 0.0;
      std::string const where = fmt::format("the charge reaches {:.4g} m over the face {} ({} = {:.6g} m)", beyond,
                                            grid::face_names[f], directions[d], plane);
      if (boundary == Boundary::symmetry) {
        if (centred && !outwards) continue;
        if (outwards) {
          error(section, section.given("normal") ? "normal" : key,
                fmt::format("{}, to which its flat side looks: turn its normal to \"{}{}\"", where, low ? '+' : '-',
                            directions[d]));
        } else {
          error(section, key,
                fmt::format(
                    "{}, which is a symmetry plane, but its centre at {} = {:.6g} m does not lie on it: put the centre "
                    "on the plane or the whole charge inside",
                    where, directions[d], c[d]));
        }
        return false;
      }
      bool const ball = std::holds_alternative<detonation::Sphere>(body);
      bool const third = geometry() == Geometry::cartesian3d || (geometry() == Geometry::axisymmetric2d && d == 1);
      if (boundary == Boundary::wall && ball && third) {
        error(section, key,
              fmt::format("{}, which is a rigid wall: for a charge on the wall write shape = \"hemisphere\", normal = "
                          "\"{}{}\" and {} = {:.6g}, or move it inside",
                          where, low ? '+' : '-', directions[d], directions[d], plane));
      } else {
        error(section, key,
              fmt::format(
                  "{}, which is \"{}\": move the charge inside or enlarge the domain; only a symmetry plane through "
                  "its centre may cut a charge",
                  where, grid::boundary_name(boundary)));
      }
      return false;
    }
    // Wholly outside, without crossing: a body beyond the far side was caught above, so nothing is left to check.
    return true;
  }

  bool initiation(Section const& section, detonation::Shape const& body, run::Charge& charge) {
    auto const word = section.text("detonation");
    if (!word || section.broken("initiation")) return false;
    charge.detonation = *word == "instantaneous" ? run::Detonation::instantaneous : run::Detonation::programmed;
    auto const* points = section.sections("initiation");
    if (charge.detonation == run::Detonation::instantaneous) {
      if (points == nullptr) return true;
      error(section, "initiation",
            "an instantaneous detonation has no points of initiation: remove them, or write detonation = "
            "\"programmed\"");
      return false;
    }
    if (points == nullptr || points->empty()) {
      charge.initiation.push_back({detonation::centre(body), 0.0});
      return true;
    }
    bool sound = true;
    for (auto const& given : *points) {
      run::InitiationPoint p{detonation::centre(body), 0.0};
      auto const delay = given.number("delay");
      if (given.broken("position") || !delay) {
        sound = false;
        continue;
      }
      p.delay = *delay;
      if (given.given("position")) {
        auto const position = point(given, "position");
        if (!position) {
          sound = false;
          continue;
        }
        p.position = *position;
        // A point on the surface counts as inside: it is moved towards the middle by a round-off length.
        Vec3 const inward = detonation::centre(body) - p.position;
        double const distance = norm(inward);
        Vec3 const moved =
            distance > 0.0 ? p.position + std::min(1.0, 1e-3 * out_.domain.h / distance) * inward : p.position;
        if (!detonation::contains(body, out_.domain, p.position) && !detonation::contains(body, out_.domain, moved)) {
          auto const b = detonation::bounds(body);
          error(given, "position",
                fmt::format("{} lies outside the charge, which reaches from {} to {} m: move the point inside",
                            given.shown("position"), point_text(b.lower, dims()), point_text(b.upper, dims())));
          sound = false;
          continue;
        }
      }
      charge.initiation.push_back(p);
    }
    return sound;
  }

  // --- regions, obstacles, gauges
  // ----------------------------------------------------------------------------------------------

  void regions() {
    each("region", [&](Section const& section) {
      run::Region region;
      auto const body = shape(section, false, std::nullopt);
      if (body) {
        region.shape = *body;
        touches_domain(section, *body);
      }
      if (section.broken("fluid")) return;
      auto const name = section.text("fluid");
      material::Fluid own = out_.ambient.fluid;
      run::FluidState defaults = out_.ambient.state;
      if (name) {
        auto const* found = fluid(*name);
        auto const* charged = found == nullptr ? explosive(*name) : nullptr;
        if (found == nullptr && charged == nullptr) {
          unknown_material(section, "fluid", *name, "fluid", fluid_names());
          return;
        }
        own = found != nullptr ? *found : products(*charged);
        if (!ambient_known_ || own.name != out_.ambient.fluid.name) {
          if (ambient_known_ && products_known_ && out_.second_fluid && out_.second_fluid->name != own.name) {
            error(section, "fluid",
                  fmt::format(
                      "\"{}\" would be a third fluid beside \"{}\" and \"{}\"; a calculation has at most two: use "
                      "one of these",
                      *name, out_.ambient.fluid.name, out_.second_fluid->name));
            return;
          }
          if (products_known_) out_.second_fluid = own;
          region.second_fluid = true;
          region.fluid_name = own.name;
          defaults.density = own.density;
        }
      }
      if (!ambient_known_ && !name) return;
      auto const s = state(section, own, defaults, "density");
      if (!s || !body) return;
      region.state = *s;
      out_.regions.push_back(std::move(region));
    });
  }

  std::vector<std::pair<std::size_t, detonation::Shape>> obstacle_shapes_;  ///< index of the section, shape

  void obstacles() {
    auto const* all = deck_.sections("obstacle");
    if (all == nullptr) return;
    if (all->size() > most_obstacles) {
      error(deck_, "obstacle", fmt::format("there are {} obstacles; allowed: at most {}", all->size(), most_obstacles));
      return;
    }
    for (std::size_t i = 0; i < all->size(); ++i) {
      Section const& section = (*all)[i];
      auto const body = shape(section, false, std::nullopt);
      if (!body) continue;
      touches_domain(section, *body);
      obstacle_shapes_.emplace_back(i, *body);
      out_.obstacles.push_back({section.text("name").value_or(fmt::format("obstacle-{}", i + 1)), *body});
    }
  }

  void gauges() {
    auto const* all = deck_.sections("gauge");
    if (all == nullptr) return;
    std::set<std::string> names;
    for (std::size_t i = 0; i < all->size(); ++i) {
      Section const& section = (*all)[i];
      if (section.doubtful()) continue;
      int const forms = static_cast<int>(section.given("point")) + static_cast<int>(section.given("line")) +
                        static_cast<int>(section.given("plane"));
      if (forms != 1) {
        report_.error(section.place, section.path,
                      fmt::format("a gauge has exactly one of point, line and plane, this one has {}; write for "
                                  "example point = [2, 0, 1]",
                                  forms == 0 ? "none" : std::to_string(forms)));
        continue;
      }
      if (section.broken("name")) continue;
      std::string const name = section.text("name").value_or(fmt::format("g{}", i + 1));
      std::size_t const before = out_.gauges.size();
      std::string_view key = "point";
      if (section.given("point")) {
        if (auto const p = point(section, "point")) out_.gauges.push_back({name, *p});
      } else if (section.given("line")) {
        key = "line";
        line(section, name);
      } else {
        key = "plane";
        plane(section, name);
      }
      check_gauges(section, key, before, names);
    }
  }

  bool room_for_gauges(Section const& section, std::string_view key, double count) {
    if (static_cast<double>(out_.gauges.size()) + count <= most_gauges) return true;
    error(
        section, key,
        fmt::format("{:.0f} gauges more make {:.0f} in all; allowed: at most {:.0f}; write field dumps for dense data",
                    count, static_cast<double>(out_.gauges.size()) + count, most_gauges));
    return false;
  }

  void line(Section const& section, std::string const& name) {
    Section const* given = section.section("line");
    if (given == nullptr) return;
    auto const from = point(*given, "from");
    auto const to = point(*given, "to");
    auto const count = given->integer("count");
    if (!from || !to || !count) return;
    if (!room_for_gauges(*given, "count", static_cast<double>(*count))) return;
    for (long i = 0; i < *count; ++i) {
      double const s = static_cast<double>(i) / static_cast<double>(*count - 1);
      out_.gauges.push_back({fmt::format("{}-{}", name, i + 1), (1.0 - s) * *from + s * *to});
    }
  }

  void plane(Section const& section, std::string const& name) {
    Section const* given = section.section("plane");
    if (given == nullptr) return;
    auto const origin = point(*given, "origin");
    auto const edge1 = point(*given, "edge1");
    auto const edge2 = point(*given, "edge2");
    auto const* counts = given->numbers("counts");
    if (dims() < 2) {
      error(section, "plane", fmt::format("{} resolves only x: use a line", grid::geometry_name(geometry())));
      return;
    }
    if (counts != nullptr && counts->size() != 2) {
      error(*given, "counts",
            fmt::format("{} has {} elements, expected two whole numbers; write for example counts = [5, 5]",
                        given->shown("counts"), counts->size()));
      return;
    }
    if (!origin || !edge1 || !edge2 || counts == nullptr) return;
    if (!room_for_gauges(*given, "counts", (*counts)[0] * (*counts)[1])) return;
    auto const n1 = static_cast<int>((*counts)[0]);
    auto const n2 = static_cast<int>((*counts)[1]);
    for (int j = 0; j < n2; ++j) {
      for (int i = 0; i < n1; ++i) {
        Vec3 const p = *origin + (i / (n1 - 1.0)) * *edge1 + (j / (n2 - 1.0)) * *edge2;
        out_.gauges.push_back({fmt::format("{}-{}", name, j * n1 + i + 1), p});
      }
    }
  }

  /// Gauges from `first` on: unique names, in the domain, not in an obstacle. One error per table.
  void check_gauges(Section const& section, std::string_view key, std::size_t first, std::set<std::string>& names) {
    bool place_reported = false;
    bool name_reported = false;
    for (std::size_t i = first; i < out_.gauges.size(); ++i) {
      auto const& gauge = out_.gauges[i];
      if (!names.insert(gauge.name).second && !name_reported) {
        report_.error(section.place_of("name"), section.path_of("name"),
                      fmt::format("\"{}\" is used by another gauge: choose another name", gauge.name));
        name_reported = true;
      }
      if (!domain_known_ || place_reported) continue;
      for (int d = 0; d < dims() && !place_reported; ++d) {
        double const low = out_.domain.lower[d];
        double const high = out_.domain.upper(d);
        if (gauge.position[d] >= low - tiny() && gauge.position[d] <= high + tiny()) continue;
        error(section, key,
              fmt::format("gauge {} at {} m lies outside the domain: {} = {:.6g} m, allowed: {:.6g} to {:.6g} m",
                          gauge.name, point_text(gauge.position, dims()), directions[d], gauge.position[d], low, high));
        place_reported = true;
      }
      for (std::size_t k = 0; k < obstacle_shapes_.size() && !place_reported; ++k) {
        if (!well_inside(obstacle_shapes_[k].second, gauge.position)) continue;
        error(section, key,
              fmt::format("gauge {} at {} m lies inside obstacle[{}]: move it into the gas", gauge.name,
                          point_text(gauge.position, dims()), obstacle_shapes_[k].first + 1));
        place_reported = true;
      }
    }
  }

  /// Inside, and not on the surface, where a gauge on a body belongs.
  [[nodiscard]] bool well_inside(detonation::Shape const& body, Vec3 const& p) const {
    if (!detonation::contains(body, out_.domain, p)) return false;
    for (int d = 0; d < dims(); ++d) {
      for (double const side : {-1e-3, 1e-3}) {
        Vec3 q = p;
        q[d] += side * out_.domain.h;
        if (q[d] < out_.domain.lower[d] || q[d] > out_.domain.upper(d)) continue;
        if (!detonation::contains(body, out_.domain, q)) return false;
      }
    }
    return true;
  }

  // --- the rest
  // ----------------------------------------------------------------------------------------------------------------

  void numerics() {
    Section const* section = deck_.section("numerics");
    if (section == nullptr) return;
    auto& n = out_.numerics;
    if (section->text("scheme") == "lax-wendroff") n.scheme = run::Scheme::lax_wendroff;
    n.courant = section->number("courant").value_or(n.courant);
    n.block_cells = static_cast<int>(section->integer("block_cells").value_or(n.block_cells));
    n.sleep = section->boolean("sleep").value_or(n.sleep);
    n.limiter_beta = section->number("limiter_beta").value_or(n.limiter_beta);
    n.carbuncle_cure = section->boolean("carbuncle_cure").value_or(n.carbuncle_cure);
    n.density_floor = section->number("density_floor").value_or(n.density_floor);
    n.pressure_floor = section->number("pressure_floor").value_or(n.pressure_floor);
    n.viscosity = section->number("viscosity").value_or(n.viscosity);
    if (n.block_cells != 0 && n.block_cells < 4) {
      error(*section, "block_cells",
            fmt::format("{} is too small; allowed: 0 (chosen by the program) or 4 to 4096", n.block_cells));
    }
    if (n.scheme == run::Scheme::lax_wendroff) {
      for (auto const* key : {"limiter_beta", "carbuncle_cure"}) {
        if (section->given(key))
          report_.warning(section->place_of(key), section->path_of(key), "has no effect with lax-wendroff");
      }
    } else if (section->given("viscosity")) {
      report_.warning(section->place_of("viscosity"), section->path_of("viscosity"),
                      "has no effect with muscl-hancock");
    }
  }

  void end() {
    Section const* section = deck_.section("end");
    if (section == nullptr) return;
    out_.end.steps = section->integer("steps").value_or(0);
    auto const time = section->number("time");
    if (!time) return;
    out_.end.time = *time;
    end_known_ = true;
  }

  void output() {
    Section const* section = deck_.section("output");
    if (section == nullptr) return;
    auto& o = out_.output;
    o.field_interval = section->number("field_interval").value_or(o.field_interval);
    o.gauge_interval = section->number("gauge_interval").value_or(o.gauge_interval);
    o.peak_fields = section->boolean("peak_fields").value_or(o.peak_fields);
    o.single_precision = section->text("precision").value_or("single") == "single";
    if (auto const* times = section->numbers("field_times")) o.field_times = *times;
    if (auto const* fields = section->strings("fields")) {
      o.fields.clear();
      for (auto const& field : *fields) {
        if (std::find(o.fields.begin(), o.fields.end(), field) == o.fields.end()) o.fields.push_back(field);
      }
    }
    std::sort(o.field_times.begin(), o.field_times.end());
    if (!end_known_) return;
    double const time = out_.end.time;
    if (!o.field_times.empty() && o.field_times.back() > time) {
      error(*section, "field_times",
            fmt::format("{:g} s lies after the end of the calculation at {:g} s: remove it or calculate longer",
                        o.field_times.back(), time));
    }
    too_many(*section, "field_interval", o.field_interval, most_dumps, "field dumps");
    too_many(*section, "gauge_interval", o.gauge_interval, most_records, "records per gauge");
  }

  void too_many(Section const& section, std::string_view key, double interval, double most, char const* things) {
    if (interval <= 0.0 || out_.end.time / interval <= most) return;
    error(section, key,
          fmt::format("{} until {:g} s makes {:.4g} {}; allowed: at most {:g}; write at least {:.3g} s",
                      section.shown(key), out_.end.time, out_.end.time / interval, things, most, out_.end.time / most));
  }

  void compare() {
    Section const* section = deck_.section("compare");
    auto const word = section == nullptr ? std::optional<std::string>("auto") : section->text("burst");
    if (!word) return;
    if (*word == "spherical") out_.burst = run::Burst::spherical;
    if (*word == "hemispherical") out_.burst = run::Burst::hemispherical;
    if (*word == "auto") out_.burst = automatic_burst();
    auto const* charges = deck_.sections("charge");
    bool const one = charges != nullptr && charges->size() == 1;
    if (*word != "auto" && *word != "none" && !one && !deck_.broken("charge")) {
      error(*section, "burst",
            fmt::format("\"{}\" needs exactly one charge, there are {}: write \"none\"", *word,
                        charges == nullptr ? 0 : charges->size()));
    }
    bool const moving = deck_.given("charge") || deck_.given("region") || deck_.given("inflow");
    if (!moving)
      report_.warning(deck_.place, "charge", "nothing will happen: there is no charge, no region and no inflow");
  }

  [[nodiscard]] run::Burst automatic_burst() const {
    bool const body_of_revolution = geometry() == Geometry::cartesian3d || geometry() == Geometry::axisymmetric2d ||
                                    geometry() == Geometry::spherical1d;
    if (out_.charges.size() != 1 || !out_.regions.empty() || !out_.obstacles.empty() || !body_of_revolution ||
        out_.ambient.fluid.name != "air") {
      return run::Burst::none;
    }
    auto const& body = out_.charges.front().shape;
    auto const* half = std::get_if<detonation::Hemisphere>(&body);
    if (half == nullptr && !std::holds_alternative<detonation::Sphere>(body)) return run::Burst::none;
    Vec3 const c = detonation::centre(body);
    bool on_ground = false;
    for (int f = 0; f < 2 * dims(); ++f) {
      int const d = f / 2;
      Boundary const b = out_.domain.boundary[f];
      if (b == Boundary::outflow || (radial() && f == 0)) continue;
      double const plane = f % 2 == 0 ? out_.domain.lower[d] : out_.domain.upper(d);
      bool const through_centre = std::abs(c[d] - plane) <= tiny();
      bool const flat_side = half != nullptr && half->normal[d] * (f % 2 == 0 ? 1.0 : -1.0) > 0.0;
      if (!through_centre || (b != Boundary::symmetry && !(b == Boundary::wall && flat_side))) return run::Burst::none;
      on_ground = on_ground || flat_side;
    }
    if (half != nullptr) return on_ground ? run::Burst::hemispherical : run::Burst::none;
    return run::Burst::spherical;
  }
};

}  // namespace

Result read_text(std::string_view text, std::string_view name) {
  Result result;
  Report report{std::string(name)};
  auto const deck = read(text, deck_schema(), report);
  if (deck) {
    run::Case built = Builder(*deck, report).build();
    if (!report.failed()) {
      built.deck_path = name;
      built.deck_text = text;
      result.case_ = std::move(built);
    }
  }
  result.errors = report.errors();
  if (!report.failed()) result.warnings = report.warnings();
  return result;
}

Result read_file(std::string const& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text;
  std::array<char, 65536> part{};
  while (file.read(part.data(), part.size()), file.gcount() > 0) {
    text.append(part.data(), static_cast<std::size_t>(file.gcount()));
  }
  // A folder opens, but does not read.
  if (!file.is_open() || file.bad()) throw IoError(fmt::format("the deck \"{}\" cannot be read", path));
  return read_text(text, path);
}

}  // namespace brisance::deck
