/// The gas of a deck: ambient, inflow, charges, regions, obstacles and gauges.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "deck/build.hpp"
#include "empirical/standard_atmosphere.hpp"

namespace brisance::deck {

namespace {

constexpr std::size_t most_charges = 100;
constexpr std::size_t most_obstacles = 1000;
constexpr double mass_tolerance = 1e-3;     ///< within which a given mass and a given size agree
constexpr double gas_temperature = 288.15;  ///< at which a gas has the density of its table [K]

}  // namespace

void Builder::inflow(Section const* section) {
  for (auto& state : out_.inflow) state = out_.ambient.state;
  if (!has_gas_) {
    refuse_inflow(section);
    return;
  }
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
              given.name, f / 2 >= dims() ? "not resolved" : word_of(out_.domain.boundary[f]), given.name));
      return;
    }
    if (auto const s = state(given, out_.ambient.fluid, out_.ambient.state, "density")) out_.inflow[f] = *s;
  });
  for (int f = 0; f < 2 * dims(); ++f) {
    if (out_.domain.boundary[f] != Boundary::inflow || described[f]) continue;
    std::string_view const key = section->given(grid::face_names[f]) ? grid::face_names[f] : "all";
    error(
        *section, key,
        fmt::format("\"inflow\" needs the entering state: add [inflow.{}] with velocity = [...]", grid::face_names[f]));
  }
}

std::optional<run::FluidState> Builder::state(Section const& section, material::Fluid const& of,
                                              run::FluidState defaults, std::string_view blamed) {
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

void Builder::ambient() {
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
            fmt::format("{} cannot be used: {} is no ideal gas; give its density instead", section.shown("temperature"),
                        found->name));
    } else if (temperature) {
      double const p = section.number("pressure").value_or(found->pressure);
      defaults.density = found->density * (p / found->pressure) * (gas_temperature / *temperature);
    }
  }
  if (section.given("altitude") && !altitude(section, *found, defaults)) return;
  auto const s = state(section, *found, defaults, "density");
  if (s) out_.ambient.state = *s;
}

bool Builder::altitude(Section const& section, material::Fluid const& fluid, run::FluidState& state) {
  auto const height = section.number("altitude");
  if (!height) return false;
  for (auto const* key : {"pressure", "density", "temperature"}) {
    if (!section.given(key)) continue;
    error(section, "altitude",
          fmt::format("{} is given beside a {}: remove one of the two", section.shown("altitude"), key));
    return false;
  }
  if (!std::holds_alternative<material::IdealGas>(fluid.eos)) {
    error(section, "altitude",
          fmt::format("{} cannot be used: {} is no ideal gas; give its pressure and density instead",
                      section.shown("altitude"), fluid.name));
    return false;
  }
  auto const air = empirical::standard_atmosphere(*height);
  state.pressure = air.pressure;
  state.density = fluid.density * (air.pressure / fluid.pressure) * (gas_temperature / air.temperature);
  return true;
}

void Builder::charges() {
  auto const* all = deck_.sections("charge");
  if (all == nullptr) return;
  if (all->size() > most_charges) {
    error(deck_, "charge", fmt::format("there are {} charges; allowed: at most {}", all->size(), most_charges));
    return;
  }
  std::string first_explosive;
  std::vector<std::pair<Section const*, shape::Shape>> placed;
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
    bool apart = domain_known_ && boundaries_known_;
    for (auto const& [index, obstacle] : obstacle_shapes_) {
      auto const common = common_point(placed[i].second, obstacle);
      if (!common) continue;
      apart = false;
      error(*placed[i].first, place_key(*placed[i].first),
            fmt::format("{} reaches into {} around {} m: move one of them", placed[i].first->path,
                        (*bodies)[index].path, point_text(*common, dims())));
    }
    if (apart) fits_between_obstacles(*placed[i].first, placed[i].second);
  }
}

void Builder::charge(Section const& section, std::string& first_explosive,
                     std::vector<std::pair<Section const*, shape::Shape>>& placed) {
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
  auto const body = shape(section, Use::charge, volume_asked);
  if (!body || !size_known) return;
  double const volume = shape::volume(*body, geometry());
  if (found != nullptr) {
    charge.explosive = *found;
    charge.mass = mass.value_or(volume * found->density());
    if (mass && std::abs(volume * found->density() - *mass) > mass_tolerance * *mass) {
      error(section, "mass",
            fmt::format(
                "{} disagrees with the size, which holds {:.6g} kg of {} ({:g} kg/m3): give only one of mass and size",
                section.shown("mass"), volume * found->density(), found->name, found->density()));
      return;
    }
  }
  charge.shape = *body;
  if (domain_known_ && boundaries_known_ && !inside_domain(section, *body)) return;
  placed.emplace_back(&section, *body);
  if (!initiation(section, *body, "charge", charge.detonation, charge.initiation)) return;
  charge_shapes_.emplace_back(&section, charge.shape);
  out_.charges.push_back(std::move(charge));
}

bool Builder::mass_unit_fits(Section const& section) {
  std::string const& unit = section.entries.find("mass")->second.unit;
  if (unit.empty() || unit == "kg") return true;
  std::string const own = geometry() == Geometry::planar2d || geometry() == Geometry::cylindrical1d ? "kg/m"
                          : geometry() == Geometry::planar1d                                        ? "kg/m2"
                                                                                                    : "kg";
  if (unit == own) return true;
  error(section, "mass",
        fmt::format("{} is given in {}, but a charge in {} has its mass in {}", section.shown("mass"), unit,
                    word_of(geometry()), own));
  return false;
}

bool Builder::inside_domain(Section const& section, shape::Shape const& body) {
  auto const b = shape::bounds(body);
  Vec3 const c = shape::centre(body);
  std::string_view const key = place_key(section);
  auto const* half = std::get_if<shape::Hemisphere>(&body);
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
    bool const ball = std::holds_alternative<shape::Sphere>(body);
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
                where, word_of(boundary)));
    }
    return false;
  }
  // Wholly outside, without crossing: a body beyond the far side was caught above, so nothing is left to check.
  return true;
}

bool Builder::initiation(Section const& section, shape::Shape const& body, char const* what,
                         run::Detonation& detonation, std::vector<run::InitiationPoint>& points) {
  auto const word = section.text("detonation");
  if (!word || section.broken("initiation")) return false;
  choose(section, "detonation", detonation);
  auto const* all = section.sections("initiation");
  // A body may be hollow.
  auto const middle_is_explosive = [&](Section const& blamed, std::string_view key) {
    if (!domain_known_ || shape::contains(body, out_.domain, shape::centre(body))) return true;
    report_.error(blamed.place_of(key), blamed.path_of(key),
                  fmt::format("the middle of the {}, {} m, holds no explosive that could be lit there: give a position "
                              "within the explosive, initiation = [{{position = [...]}}]",
                              what, point_text(shape::centre(body), dims())));
    return false;
  };
  if (detonation == run::Detonation::instantaneous) {
    if (all == nullptr) return true;
    error(section, "initiation",
          "an instantaneous detonation has no points of initiation: remove them, or write detonation = "
          "\"programmed\"");
    return false;
  }
  if (all == nullptr || all->empty()) {
    if (!middle_is_explosive(section, "initiation")) return false;
    points.push_back({shape::centre(body), 0.0});
    return true;
  }
  bool sound = true;
  for (auto const& given : *all) {
    run::InitiationPoint p{shape::centre(body), 0.0};
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
      Vec3 const inward = shape::centre(body) - p.position;
      double const distance = norm(inward);
      Vec3 const moved =
          distance > 0.0 ? p.position + std::min(1.0, 1e-3 * out_.domain.h / distance) * inward : p.position;
      if (!shape::contains(body, out_.domain, p.position) && !shape::contains(body, out_.domain, moved)) {
        auto const b = shape::bounds(body);
        error(given, "position",
              fmt::format("{} lies outside the {}, which reaches from {} to {} m: move the point inside",
                          given.shown("position"), what, point_text(b.lower, dims()), point_text(b.upper, dims())));
        sound = false;
        continue;
      }
    } else if (!middle_is_explosive(given, "position")) {
      sound = false;
      continue;
    }
    points.push_back(p);
  }
  if (!points.empty()) {
    auto const first =
        std::min_element(points.begin(), points.end(), [](auto const& a, auto const& b) { return a.delay < b.delay; });
    onsets_.push_back({&section, first->delay, "initiation", "never detonates"});
  }
  return sound;
}

void Builder::regions() {
  each("region", [&](Section const& section) {
    run::Region region;
    auto const body = shape(section, Use::gas, std::nullopt);
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
          error(
              section, "fluid",
              fmt::format("\"{}\" would be a third fluid beside \"{}\" and \"{}\"; a calculation has at most two: use "
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
    region_sections_.push_back(&section);
  });
  check_regions();
}

void Builder::obstacles() {
  auto const* all = deck_.sections("obstacle");
  if (all == nullptr) return;
  if (all->size() > most_obstacles) {
    error(deck_, "obstacle", fmt::format("there are {} obstacles; allowed: at most {}", all->size(), most_obstacles));
    return;
  }
  for (std::size_t i = 0; i < all->size(); ++i) {
    Section const& section = (*all)[i];
    auto const body = shape(section, Use::gas, std::nullopt);
    if (!body) continue;
    touches_domain(section, *body);
    obstacle_shapes_.emplace_back(i, *body);
    out_.obstacles.push_back({section.text("name").value_or(fmt::format("obstacle-{}", i + 1)), *body});
    auto const fails_at = section.number("fails_at");
    auto const areal_mass = section.number("areal_mass");
    if (fails_at) out_.obstacles.back().release = run::Release{*fails_at, areal_mass.value_or(0.0)};
    if (areal_mass && !section.given("fails_at")) {
      error(section, "areal_mass",
            "it is the mass of a panel that gives way, and this obstacle does not: give it fails_at, the difference of "
            "the pressures at which it does, or remove the key");
    }
  }
  check_obstacles();
}

void Builder::gauges() {
  auto const* all = deck_.sections("gauge");
  if (all == nullptr) return;
  std::set<std::string> names;
  for (std::size_t i = 0; i < all->size(); ++i) {
    Section const& section = (*all)[i];
    if (section.doubtful()) continue;
    if (section.given("body")) {
      if (!section.broken("name")) body_gauge(section, section.text("name").value_or(fmt::format("g{}", i + 1)), names);
      continue;
    }
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

bool Builder::room_for_gauges(Section const& section, std::string_view key, double count) {
  if (static_cast<double>(out_.gauges.size()) + count <= most_gauges) return true;
  error(section, key,
        fmt::format("{:.0f} gauges more make {:.0f} in all; allowed: at most {:.0f}; write field dumps for dense data",
                    count, static_cast<double>(out_.gauges.size()) + count, most_gauges));
  return false;
}

void Builder::line(Section const& section, std::string const& name) {
  Section const* given = section.section("line");
  if (given == nullptr) return;
  auto const from = point(*given, "from");
  auto const to = point(*given, "to");
  auto const count = given->integer("count");
  if (!from || !to || !count) return;
  if (norm(*to - *from) <= tiny()) {
    error(*given, "to", "is the same point as `from`: a line has a length; write one gauge with a point");
    return;
  }
  if (!room_for_gauges(*given, "count", static_cast<double>(*count))) return;
  for (long i = 0; i < *count; ++i) {
    double const s = static_cast<double>(i) / static_cast<double>(*count - 1);
    out_.gauges.push_back({fmt::format("{}-{}", name, i + 1), (1.0 - s) * *from + s * *to});
  }
}

void Builder::plane(Section const& section, std::string const& name) {
  Section const* given = section.section("plane");
  if (given == nullptr) return;
  auto const origin = point(*given, "origin");
  auto const edge1 = point(*given, "edge1");
  auto const edge2 = point(*given, "edge2");
  auto const* counts = given->numbers("counts");
  if (dims() < 2) {
    error(section, "plane", fmt::format("{} resolves only x: use a line", word_of(geometry())));
    return;
  }
  if (counts != nullptr && counts->size() != 2) {
    error(*given, "counts",
          fmt::format("{} has {} elements, expected two whole numbers; write for example counts = [5, 5]",
                      given->shown("counts"), counts->size()));
    return;
  }
  if (!origin || !edge1 || !edge2 || counts == nullptr) return;
  double const along = dot(*edge1, *edge2);
  if (dot(*edge1, *edge1) * dot(*edge2, *edge2) - along * along <= std::pow(tiny(), 4)) {
    error(*given, "edge2", "it spans no plane with edge1: the edges are parallel, or one of them has no length");
    return;
  }
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

void Builder::check_gauges(Section const& section, std::string_view key, std::size_t first,
                           std::set<std::string>& names) {
  bool place_reported = false;
  bool name_reported = false;
  setup::SolidCells const solid(out_.domain, domain_known_ ? out_.obstacles : std::vector<run::Obstacle>{});
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
    if (!place_reported && solid.any() && walled_in(solid, gauge.position)) {
      error(
          section, key,
          fmt::format("gauge {} at {} m has only solid cells of obstacles around it and would record nothing: move it "
                      "half a cell ({:.4g} m) or more away from the obstacle",
                      gauge.name, point_text(gauge.position, dims()), 0.5 * out_.domain.h));
      place_reported = true;
    }
    for (std::size_t k = 0; k < body_shapes_.size() && !place_reported; ++k) {
      if (!body_shapes_[k] || !well_inside(*body_shapes_[k], gauge.position)) continue;
      error(section, key,
            fmt::format("gauge {} at {} m lies inside {}: move it into the gas, or write body = \"{}\"", gauge.name,
                        point_text(gauge.position, dims()), body_names_[k], body_names_[k]));
      place_reported = true;
    }
  }
}

run::Burst Builder::automatic_burst() const {
  bool const body_of_revolution = geometry() == Geometry::cartesian3d || geometry() == Geometry::axisymmetric2d ||
                                  geometry() == Geometry::spherical1d;
  if (out_.charges.size() != 1 || !out_.regions.empty() || !out_.obstacles.empty() || has_bodies() ||
      !body_of_revolution || out_.ambient.fluid.name != "air") {
    return run::Burst::none;
  }
  auto const& body = out_.charges.front().shape;
  auto const* half = std::get_if<shape::Hemisphere>(&body);
  if (half == nullptr && !std::holds_alternative<shape::Sphere>(body)) return run::Burst::none;
  Vec3 const c = shape::centre(body);
  bool on_ground = false;
  for (int f = 0; f < 2 * dims(); ++f) {
    int const d = f / 2;
    Boundary const b = out_.domain.boundary[f];
    if (grid::is_open(b) || (radial() && f == 0)) continue;
    double const plane = f % 2 == 0 ? out_.domain.lower[d] : out_.domain.upper(d);
    bool const through_centre = std::abs(c[d] - plane) <= tiny();
    bool const flat_side = half != nullptr && half->normal[d] * (f % 2 == 0 ? 1.0 : -1.0) > 0.0;
    if (!through_centre || (b != Boundary::symmetry && !(b == Boundary::wall && flat_side))) return run::Burst::none;
    on_ground = on_ground || flat_side;
  }
  if (half != nullptr) return on_ground ? run::Burst::hemispherical : run::Burst::none;
  return run::Burst::spherical;
}

}  // namespace brisance::deck
