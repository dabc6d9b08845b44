/// Shapes of a deck and where they lie.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "core/error.hpp"
#include "deck/build.hpp"
#include "shape/stl.hpp"

namespace brisance::deck {

namespace {

/// Keys that tell where a shape lies and how large it is.
constexpr std::array shape_keys{
    "position", "radius", "length", "axis", "normal", "size", "lower", "upper", "file", "length_to_diameter", "scale"};

}  // namespace

std::vector<std::string> Builder::possible_shapes(Use use) const {
  switch (geometry()) {
    case Geometry::cartesian3d:
      if (use == Use::points) return {"sphere", "hemisphere", "cylinder", "box", "stl"};
      return {"sphere", "hemisphere", "cylinder", "box"};
    case Geometry::axisymmetric2d: return {"sphere", "hemisphere", "cylinder", "box"};
    case Geometry::planar2d: return {"cylinder", "box"};
    case Geometry::planar1d: return {"box"};
    case Geometry::cylindrical1d:
      return use == Use::charge ? std::vector<std::string>{"cylinder"} : std::vector<std::string>{"cylinder", "box"};
    case Geometry::spherical1d:
      return use == Use::charge ? std::vector<std::string>{"sphere"} : std::vector<std::string>{"sphere", "box"};
  }
  return {};
}

bool Builder::cylinder_has_length() const {
  return geometry() == Geometry::cartesian3d || geometry() == Geometry::axisymmetric2d;
}

std::optional<shape::Shape> Builder::shape(Section const& section, Use use, std::optional<double> volume_asked) {
  if (section.broken("shape") || section.doubtful()) return std::nullopt;
  auto const possible = possible_shapes(use);
  std::string const word = section.text("shape").value_or(possible.front());
  if (std::find(possible.begin(), possible.end(), word) == possible.end()) {
    std::string const disc =
        word == "sphere" && geometry() == Geometry::planar2d ? " (a \"cylinder\" is a disc here)" : "";
    error(section, "shape",
          fmt::format("\"{}\" is not possible in {}; allowed: {}{}", word, word_of(geometry()), quoted_list(possible),
                      disc));
    return std::nullopt;
  }
  if (!only_keys_of(section, word)) return std::nullopt;
  for (auto const* key : shape_keys) {
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
                        section.shown("position"), word, word_of(geometry())));
      return std::nullopt;
    }
  }
  if (word == "stl") return mesh(section, position);
  if (word == "box") return box(section, position, volume_asked);
  if (word == "cylinder") return cylinder(section, position, volume_asked);

  shape::Sphere const unit_sphere{position, 1.0};
  Vec3 normal{0.0, 0.0, 1.0};
  if (geometry() == Geometry::axisymmetric2d) normal = {0.0, 1.0, 0.0};
  if (section.given("normal")) {
    std::string const given = *section.text("normal");
    normal = {0.0, 0.0, 0.0};
    normal[given[1] - 'x'] = given[0] == '-' ? -1.0 : 1.0;
    if (geometry() == Geometry::axisymmetric2d && given[1] != 'y') {
      error(section, "normal",
            fmt::format("\"{}\" is not possible in axisymmetric2d; allowed: \"+y\" or \"-y\", along the axis", given));
      return std::nullopt;
    }
  }
  bool const half = word == "hemisphere";
  shape::Shape const unit = half ? shape::Shape(shape::Hemisphere{position, 1.0, normal}) : unit_sphere;
  double radius = 0.0;
  if (auto const given = section.number("radius")) {
    radius = *given;
  } else if (volume_asked) {
    radius = std::cbrt(*volume_asked / shape::volume(unit, geometry()));
  } else {
    size_missing(section, "radius", use == Use::charge, "radius = \"50 mm\"");
    return std::nullopt;
  }
  if (half) return shape::Hemisphere{position, radius, normal};
  return shape::Sphere{position, radius};
}

void Builder::size_missing(Section const& section, std::string_view key, bool charge, std::string const& example) {
  report_.error(
      section.place, section.path_of(key),
      charge
          ? fmt::format("the charge has neither a mass nor a size; write for example mass = \"10 kg\" or {}", example)
          : fmt::format("the key \"{}\" is missing; write for example {}", key, example));
}

bool Builder::only_keys_of(Section const& section, std::string const& word) {
  std::vector<std::string> allowed;
  if (word == "sphere") allowed = {"position", "radius"};
  if (word == "hemisphere") allowed = {"position", "radius", "normal"};
  if (word == "cylinder") {
    allowed = {"position", "radius"};
    if (cylinder_has_length()) allowed.insert(allowed.end(), {"length", "length_to_diameter"});
    if (geometry() == Geometry::cartesian3d) allowed.emplace_back("axis");
  }
  if (word == "box") allowed = {"position", "size", "lower", "upper"};
  if (word == "stl") allowed = {"position", "file", "scale"};
  bool sound = true;
  for (std::string const key : shape_keys) {
    if (!section.given(key) || std::find(allowed.begin(), allowed.end(), key) != allowed.end()) continue;
    auto offered = allowed;
    std::erase_if(offered, [&](std::string const& k) { return section.table->find(k) == nullptr; });
    error(
        section, key,
        fmt::format("{} does not apply to {} in {}; its keys are {}: remove it or change the shape", section.shown(key),
                    word == "stl" ? "an stl mesh" : "a " + word, word_of(geometry()), fmt::join(offered, ", ")));
    sound = false;
  }
  return sound;
}

std::optional<shape::Shape> Builder::cylinder(Section const& section, Vec3 const& position,
                                              std::optional<double> volume_asked) {
  bool const charge = section.table->find("mass") != nullptr;
  Vec3 axis{0.0, 0.0, 1.0};
  if (geometry() == Geometry::axisymmetric2d) axis = {0.0, 1.0, 0.0};
  if (section.given("axis")) {
    auto const given = cylinder_axis(section);
    if (!given) return std::nullopt;
    axis = *given;
  }
  auto const radius = section.number("radius");
  auto const volume_of = [&](double r, double l) {
    return shape::volume(shape::Cylinder{position, r, l, axis}, geometry());
  };
  if (!cylinder_has_length()) {
    if (!radius && !volume_asked) {
      size_missing(section, "radius", charge, "radius = \"50 mm\"");
      return std::nullopt;
    }
    return shape::Cylinder{position, radius ? *radius : std::sqrt(*volume_asked / volume_of(1.0, 1.0)), 1.0, axis};
  }
  auto const length = section.number("length");
  auto const ratio = section.number("length_to_diameter");
  if (length && ratio) {
    error(section, "length_to_diameter",
          fmt::format("{} is given beside a length: remove one of the two", section.shown("length_to_diameter")));
    return std::nullopt;
  }
  if (radius && length) return shape::Cylinder{position, *radius, *length, axis};
  if (radius && ratio) return shape::Cylinder{position, *radius, 2.0 * *radius * *ratio, axis};
  if (volume_asked && radius) return shape::Cylinder{position, *radius, *volume_asked / volume_of(*radius, 1.0), axis};
  if (volume_asked && length) {
    return shape::Cylinder{position, std::sqrt(*volume_asked / volume_of(1.0, *length)), *length, axis};
  }
  if (volume_asked && ratio) {
    double const r = std::cbrt(*volume_asked / volume_of(1.0, 2.0 * *ratio));
    return shape::Cylinder{position, r, 2.0 * r * *ratio, axis};
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

std::optional<shape::Shape> Builder::box(Section const& section, Vec3 const& position,
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
    error(
        section, key,
        fmt::format("the box starts at the radius {:g} m; in {} x is the radius: give lower and upper with radii of 0 "
                    "or more",
                    low[0], word_of(geometry())));
    return std::nullopt;
  }
  // One metre thick where a direction is not resolved.
  for (int d = dims(); d < 3; ++d) {
    low[d] = -0.5;
    high[d] = 0.5;
  }
  return shape::Box{low, high};
}

std::optional<Vec3> Builder::cylinder_axis(Section const& section) {
  Vec3 axis{0.0, 0.0, 0.0};
  auto const& given = *section.numbers("axis");
  for (std::size_t d = 0; d < given.size(); ++d) axis[static_cast<int>(d)] = given[d];
  double const length = norm(axis);
  if (!(length > 0.0)) {
    error(section, "axis",
          fmt::format("{} has no direction; write for example axis = [1, 0, 1]", section.shown("axis")));
    return std::nullopt;
  }
  axis = (1.0 / length) * axis;
  // Symmetry planes and the mass of a charge are looked at along the axes only.
  bool const along = std::abs(axis[0]) == 1.0 || std::abs(axis[1]) == 1.0 || std::abs(axis[2]) == 1.0;
  if (!along && section.table->find("mass") != nullptr) {
    error(section, "axis",
          fmt::format("{} is not possible for a charge; allowed: \"x\", \"y\" or \"z\"", section.shown("axis")));
    return std::nullopt;
  }
  return axis;
}

std::optional<shape::Shape> Builder::mesh(Section const& section, Vec3 const& position) {
  auto const file = section.text("file");
  if (!file) {
    if (!section.given("file")) size_missing(section, "file", false, "file = \"bracket.stl\"");
    return std::nullopt;
  }
  std::filesystem::path const path = std::filesystem::path(report_.file()).parent_path() / *file;
  try {
    return shape::read_stl(path, section.number("scale").value_or(1.0), position);
  } catch (std::exception const& problem) {
    error(section, "file", problem.what());
    return std::nullopt;
  }
}

std::optional<shape::Shape> Builder::composed_shape(Section const& section) {
  auto whole = shape(section, Use::points, std::nullopt);
  for (auto const& [key, operation] :
       {std::pair{"add", shape::Operation::united}, std::pair{"cut", shape::Operation::difference},
        std::pair{"common", shape::Operation::intersection}}) {
    if (section.broken(key)) whole.reset();
    auto const* parts = section.sections(key);
    if (parts == nullptr || parts->empty()) continue;
    std::vector<shape::Shape> all;
    for (Section const& part : *parts) {
      auto const one = shape(part, Use::points, std::nullopt);
      if (one) all.push_back(*one);
    }
    if (all.size() < parts->size()) whole.reset();
    if (!whole) continue;
    if (!check_composition(section, key, *parts, all, *whole)) {
      whole.reset();
      continue;
    }
    all.insert(all.begin(), *whole);
    whole = shape::combine(operation, std::move(all));
  }
  return whole;
}

std::string_view Builder::place_key(Section const& section) {
  return section.given("position") ? "position"
         : section.given("lower")  ? "lower"
         : section.given("file")   ? "file"
                                   : "position";
}

void Builder::touches_domain(Section const& section, shape::Shape const& shape, char const* what) {
  if (!domain_known_) return;
  auto const b = shape::bounds(shape);
  for (int d = 0; d < dims(); ++d) {
    if (b.upper[d] > out_.domain.lower[d] && b.lower[d] < out_.domain.upper(d)) continue;
    error(section, place_key(section),
          fmt::format("the {} reaches from {:.6g} to {:.6g} m in direction {} and lies outside the domain ({:.6g} "
                      "to {:.6g} m): move "
                      "it or remove it",
                      what, b.lower[d], b.upper[d], directions[d], out_.domain.lower[d], out_.domain.upper(d)));
    return;
  }
}

std::optional<Vec3> Builder::common_point(shape::Shape const& a, shape::Shape const& b, bool strictly) const {
  auto const x = shape::bounds(a);
  auto const y = shape::bounds(b);
  Vec3 low{0.0, 0.0, 0.0};
  Vec3 high{0.0, 0.0, 0.0};
  for (int d = 0; d < dims(); ++d) {
    low[d] = std::max(x.lower[d], y.lower[d]);
    high[d] = std::min(x.upper[d], y.upper[d]);
    if (high[d] - low[d] <= tiny()) return std::nullopt;
  }
  auto const* s = std::get_if<shape::Sphere>(&a);
  auto const* t = std::get_if<shape::Sphere>(&b);
  if (s != nullptr && t != nullptr) {
    double const distance = norm(s->centre - t->centre);
    if (distance >= s->radius + t->radius - tiny()) return std::nullopt;
    return 0.5 * (low + high);
  }
  Index3 count{1, 1, 1};
  int const samples = !strictly ? 12 : dims() == 3 ? 32 : dims() == 2 ? 200 : 1000;
  for (int d = 0; d < dims(); ++d) count[d] = samples;
  for (int k = 0; k < count[2]; ++k) {
    for (int j = 0; j < count[1]; ++j) {
      for (int i = 0; i < count[0]; ++i) {
        Index3 const n{i, j, k};
        Vec3 p{0.0, 0.0, 0.0};
        for (int d = 0; d < dims(); ++d) p[d] = low[d] + (n[d] + 0.5) / samples * (high[d] - low[d]);
        if (!shape::contains(a, out_.domain, p) || !shape::contains(b, out_.domain, p)) continue;
        if (!strictly || (well_inside(a, p) && well_inside(b, p))) return p;
      }
    }
  }
  return std::nullopt;
}

bool Builder::well_inside(shape::Shape const& body, Vec3 const& p) const {
  if (!shape::contains(body, out_.domain, p)) return false;
  for (int d = 0; d < dims(); ++d) {
    for (double const side : {-1e-3, 1e-3}) {
      Vec3 q = p;
      q[d] += side * out_.domain.h;
      if (q[d] < out_.domain.lower[d] || q[d] > out_.domain.upper(d)) continue;
      if (!shape::contains(body, out_.domain, q)) return false;
    }
  }
  return true;
}

}  // namespace brisance::deck
