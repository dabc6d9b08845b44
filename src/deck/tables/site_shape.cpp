/// Shapes of sites: buildings from footprints, terrains from height grids.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/error.hpp"
#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/tables/shapes.hpp"
#include "shape/buildings.hpp"
#include "shape/heights.hpp"

namespace brisance::deck {

std::vector<Key> site_shape_keys() {
  constexpr double farthest = 1e8;  // coordinates of national grids
  return {
      typed(Type::numbers, "origin", "m", -farthest, farthest)
          .note("the origin of the file")
          .like("[691000, 5334000]")
          .means("Of `buildings` and `terrain`: coordinates, in the file, of the point that comes to `position`, with "
                 "or without a height"),
      typed(Type::text, "height_property")
          .of("height")
          .like("\"measuredHeight\"")
          .means("Of `buildings`: property or column with the height of a building above its base"),
      typed(Type::text, "base_property")
          .of("base")
          .like("\"ground\"")
          .means("Of `buildings`: property or column with the height of the base of a building. A building without one "
                 "stands on `terrain`, or at the height of `position`"),
      number("default_height", "m", 1e-3, far)
          .note("a building without a height is an error")
          .like("\"10 m\"")
          .means("Of `buildings`: height of those that have none"),
      typed(Type::text, "terrain")
          .note("none")
          .like("\"ground.csv\"")
          .means(
              "Of `buildings`: height grid on which they stand, a file as of shape `terrain` with the same `origin`, "
              "`scale` and `position`. They reach into it; their heights count from the lowest ground under their "
              "corners"),
      number("bottom", "m", -far, far)
          .note("the lower face of the domain; where the ground is not higher, a cell below it")
          .like("\"-5 m\"")
          .means("Of `terrain`: height of its lower face"),
      typed(Type::boolean, "extend")
          .of(false)
          .like("true")
          .means("Of `terrain`: where its grid ends within the domain, go on with the heights of its edge")};
}

bool is_site(std::string_view word) { return word == "buildings" || word == "terrain"; }

namespace {

std::filesystem::path beside_deck(Draft const& draft, std::string const& file) {
  return std::filesystem::path(draft.report.file()).parent_path() / file;
}

std::optional<shape::Frame> frame_of(Draft const& draft, Section const& section, Vec3 const& position) {
  shape::Frame frame;
  frame.position = position;
  frame.scale = section.number("scale").value_or(1.0);
  if (!section.given("origin")) return frame;
  auto const& origin = *section.numbers("origin");
  if (origin.size() != 2 && origin.size() != static_cast<std::size_t>(draft.dims())) {
    draft.error(section, "origin",
                fmt::format("{} is no point of the file; write {}", section.shown("origin"),
                            draft.dims() == 3 ? "x and y, or x, y and z" : "x and z"));
    return std::nullopt;
  }
  for (std::size_t d = 0; d < origin.size(); ++d) frame.origin[static_cast<int>(d)] = origin[d];
  return frame;
}

/// Of what is far away the origin is often missing.
bool near_domain(Draft const& draft, Section const& section, Vec3 const& low, Vec3 const& high,
                 std::string const& what) {
  if (!draft.domain_known || section.given("rotate")) return true;
  for (int d = 0; d < std::min(2, draft.dims()); ++d) {
    if (d == 1 && draft.dims() == 2) continue;  // a height
    if (high[d] > draft.out.domain.lower[d] && low[d] < draft.out.domain.upper(d)) continue;
    draft.error(
        section, "file",
        fmt::format("{} of the file lie between {:.10g} and {:.10g} m in direction {}, outside the domain "
                    "({:.6g} to {:.6g} m): give origin, the point of the file that comes to position",
                    what, low[d], high[d], directions[d], draft.out.domain.lower[d], draft.out.domain.upper(d)));
    return false;
  }
  return true;
}

/// A terrain stays upright.
bool upright(Draft const& draft, Section const& section) {
  auto const* rotations = section.sections("rotate");
  for (std::size_t n = 0; rotations != nullptr && n < rotations->size(); ++n) {
    Section const& one = (*rotations)[n];
    auto const* axis = one.numbers("axis");
    bool const flat = draft.dims() == 2;
    if (!flat && (axis == nullptr || axis->size() < 3 || ((*axis)[0] == 0.0 && (*axis)[1] == 0.0))) continue;
    draft.error(one, flat ? "angle" : "axis",
                "a terrain stays upright: it turns around z in 3D only; remove this rotation");
    return false;
  }
  return true;
}

std::optional<shape::Shape> buildings(Draft const& draft, Section const& section, shape::Frame const& frame) {
  shape::BuildingFile file;
  file.path = beside_deck(draft, *section.text("file"));
  file.height = *section.text("height_property");
  file.base = *section.text("base_property");
  file.default_height = section.number("default_height");
  file.frame = frame;
  std::optional<shape::Heights> ground;
  if (section.given("terrain")) {
    try {
      ground = shape::read_heights(beside_deck(draft, *section.text("terrain")), frame);
    } catch (InputError const& problem) {
      draft.error(section, "terrain", problem.what());
      return std::nullopt;
    }
  }
  auto const body = shape::read_buildings(file, ground ? &*ground : nullptr);
  if (!near_domain(draft, section, body.lower(), body.upper(), "the buildings")) return std::nullopt;
  return body;
}

/// The heights with those of their edges as far as the domain reaches, however it is turned.
shape::Heights extended(Draft const& draft, shape::Heights const& heights) {
  grid::Domain const& domain = draft.out.domain;
  if (draft.dims() == 2) return heights.reaching(domain.lower[0], domain.upper(0), heights.y.front(), heights.y.back());
  // No point of a domain that the grid meets is farther from it.
  double const room = domain.upper(0) - domain.lower[0] + domain.upper(1) - domain.lower[1];
  return heights.reaching(heights.x.front() - room, heights.x.back() + room, heights.y.front() - room,
                          heights.y.back() + room);
}

std::optional<shape::Shape> terrain(Draft const& draft, Section const& section, shape::Frame const& frame) {
  if (!upright(draft, section)) return std::nullopt;
  auto const path = beside_deck(draft, *section.text("file"));
  bool const flat = draft.dims() == 2;
  auto heights = flat ? shape::read_profile(path, frame) : shape::read_heights(path, frame);
  if (!near_domain(draft, section, {heights.x.front(), heights.y.front(), 0.0},
                   {heights.x.back(), heights.y.back(), 0.0}, "the heights"))
    return std::nullopt;
  if (draft.radial() && heights.x.front() < 0.0) {
    draft.error(section, "file",
                fmt::format("its profile reaches the radius {:g} m; in {}, x is the radius: use radii of 0 or more",
                            heights.x.front(), word_of(draft.geometry())));
    return std::nullopt;
  }
  double const lowest = heights.lowest();
  double bottom = lowest - 1.0;
  if (draft.domain_known) {
    grid::Domain const& domain = draft.out.domain;
    double const floor = domain.lower[draft.dims() - 1];
    bottom = lowest > floor ? floor : lowest - domain.h;
    if (section.boolean("extend").value_or(false)) heights = extended(draft, heights);
  }
  bottom = section.number("bottom").value_or(bottom);
  if (!(bottom < lowest)) {
    draft.error(section, "bottom",
                fmt::format("{} is not below the lowest height of the file, {:g} m; lower it", section.shown("bottom"),
                            lowest));
    return std::nullopt;
  }
  auto const body = shape::ground(heights, bottom, fmt::format("file \"{}\"", path.string()));
  return flat ? body.turned({0, 2, 1}) : body;
}

}  // namespace

std::optional<shape::Shape> build_site_shape(Draft const& draft, Section const& section, std::string_view word,
                                             Vec3 const& position) {
  if (!section.given("file")) {
    draft.report.error(section.place, section.path_of("file"),
                       fmt::format("the key \"file\" is missing; write, for example, file = \"{}\"",
                                   word == "terrain" ? "ground.csv" : "street.geojson"));
    return std::nullopt;
  }
  auto const frame = frame_of(draft, section, position);
  if (!frame) return std::nullopt;
  try {
    return word == "terrain" ? terrain(draft, section, *frame) : buildings(draft, section, *frame);
  } catch (InputError const& problem) {
    draft.error(section, "file", problem.what());
    return std::nullopt;
  }
}

bool covers_domain(Draft const& draft, Section const& section, shape::Shape const& terrain) {
  if (!draft.domain_known) return true;
  grid::Domain const& domain = draft.out.domain;
  shape::Box const box = shape::bounds(terrain);
  int const up = draft.dims() - 1;
  // A terrain is convex in plan: where it reaches the corners of the domain it covers all of it.
  for (int corner = 0; corner < (up == 2 ? 4 : 2); ++corner) {
    Vec3 at{0.0, 0.0, 0.0};
    Vec3 inside{0.0, 0.0, 0.0};
    for (int d = 0; d < up; ++d) {
      bool const high = ((corner >> d) & 1) != 0;
      at[d] = high ? domain.upper(d) : domain.lower[d];
      inside[d] = at[d] + (high ? -draft.tiny() : draft.tiny());
    }
    inside[up] = box.lower[up] + 1e-6 * (box.upper[up] - box.lower[up]);
    if (shape::contains(terrain, inside)) continue;
    draft.error(
        section, "file",
        fmt::format("the terrain does not reach the corner {} m of the domain: it extends from {} to {} m; move "
                    "it, make the domain smaller, or write extend = true, which goes on with the heights of "
                    "its edge",
                    point_text(at, up), point_text(box.lower, up), point_text(box.upper, up)));
    return false;
  }
  return true;
}

}  // namespace brisance::deck
