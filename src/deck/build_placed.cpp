/// What a deck asks for and the grid would not hold: obstacles and regions without cells, walls with gaps, constraints
/// without nodes, loads without points, and what begins after the end.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "deck/build.hpp"
#include "mpm/holds.hpp"
#include "setup/place_gas_regions.hpp"
#include "setup/place_panels.hpp"
#include "shape/shares.hpp"

namespace brisance::deck {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double most_nodes = 2e7;      ///< that are looked at to find one
constexpr long most_looks = 1'000'000;  ///< at cells, to find a gap in a wall

shape::Box overlap(shape::Box const& a, shape::Box const& b) {
  shape::Box common;
  for (int d = 0; d < 3; ++d) {
    common.lower[d] = std::max(a.lower[d], b.lower[d]);
    common.upper[d] = std::min(a.upper[d], b.upper[d]);
  }
  return common;
}

}  // namespace

// --- shapes

bool Builder::fills(shape::Shape const& shape) const {
  bool found = false;
  shape::for_each_share({shape}, out_.domain, shape::cells_around(shape, out_.domain),
                        [&](shape::CellRange const&, std::vector<shape::Share> const&) {
                          found = true;
                          return false;
                        });
  return found;
}

bool Builder::check_composition(Section const& section, std::string_view key, std::vector<Section> const& parts,
                                std::vector<shape::Shape> const& shapes, shape::Shape const& before) {
  if (!domain_known_ || key == "add" || !fills(before)) return true;
  bool sound = true;
  for (std::size_t n = 0; n < shapes.size(); ++n) {
    if (fills(shape::combine(shape::Operation::intersection, {before, shapes[n]}))) continue;
    report_.error(parts[n].place_of(place_key(parts[n])), parts[n].path,
                  key == "cut" ? "it cuts nothing away, as it does not meet the shape: move it or remove it"
                               : "it has nothing in common with the shape, of which nothing would be left: move it");
    sound = false;
  }
  if (!sound) return false;
  std::vector<shape::Shape> all = shapes;
  all.insert(all.begin(), before);
  if (fills(shape::combine(key == "cut" ? shape::Operation::difference : shape::Operation::intersection, all))) {
    return true;
  }
  error(section, key, "nothing of the shape is left: make what it lists smaller, or remove it");
  return false;
}

// --- obstacles and regions of the gas

void Builder::check_obstacles() {
  if (!domain_known_ || out_.obstacles.empty()) return;
  auto const& sections = *deck_.sections("obstacle");
  setup::SolidCells const solid(out_.domain, out_.obstacles);
  double const h = out_.domain.h;
  bool sound = true;
  for (std::size_t n = 0; n < out_.obstacles.size(); ++n) {
    shape::Shape const& shape = out_.obstacles[n].shape;
    auto const b = shape::bounds(shape);
    bool outside = false;
    int thin = 0;  // directions in which it is
    for (int d = 0; d < dims(); ++d) {
      outside = outside || !(b.upper[d] > out_.domain.lower[d] && b.lower[d] < out_.domain.upper(d));
      thin += b.upper[d] - b.lower[d] < 2.0 * h ? 1 : 0;
    }
    if (outside || !solid.vanishes(n)) continue;  // outside: reported
    sound = false;
    Section const& section = sections[obstacle_shapes_[n].first];
    double const t = solid.thickness(n);
    double const cell = std::min(std::holds_alternative<shape::Box>(shape) && thin == 1 ? t : 0.5 * t, 0.5 * h);
    error(section, place_key(section),
          fmt::format("the obstacle fills half of no cell, and the gas would not see it: it is {:.4g} m thick and a "
                      "cell is {:.4g} m; make the cells {:.3g} m or smaller (domain.cell), or the obstacle thicker, or "
                      "let its faces lie between cells",
                      t, h, cell));
  }
  if (!sound) return;
  closed_gaps(solid);
  long left = most_looks;
  auto const leak = solid.leak(left);
  if (!leak && left <= 0) {
    report_.warning(sections.front().place, "obstacle",
                    "so many cells lie at the surfaces of obstacles that not all were looked at for walls too thin to "
                    "hold the gas");
  }
  if (!leak) {
    check_panels(solid);
    return;
  }
  Section const& section = sections[obstacle_shapes_[leak->obstacle].first];
  double const t = solid.thickness(leak->obstacle);
  error(
      section, place_key(section),
      fmt::format("gas would flow through the obstacle at {} m, between cells of which it fills less than half: there "
                  "it is too thin for cells of {:.4g} m; make them {:.3g} m or smaller (domain.cell), or the obstacle "
                  "thicker, or let its faces lie between cells",
                  point_text(leak->place, dims()), h, t < 2.0 * h ? std::min(t, 0.5 * h) : 0.5 * h));
}

void Builder::check_panels(setup::SolidCells const& solid) {
  auto const& sections = *deck_.sections("obstacle");
  for (std::size_t n = 0; n < out_.obstacles.size(); ++n) {
    if (!out_.obstacles[n].release) continue;
    Section const& section = sections[obstacle_shapes_[n].first];
    try {
      (void)setup::place_panel(out_.domain, out_.obstacles, solid, n);
    } catch (InputError const& problem) {
      error(section, "fails_at", problem.what());
    }
  }
}

void Builder::closed_gaps(setup::SolidCells const& solid) {
  grid::Domain const& domain = out_.domain;
  auto const& sections = *deck_.sections("obstacle");
  auto const look = [&](std::size_t n, int d, double from, double to, shape::Box const& across, int other) {
    if (to - from <= tiny() || to - from >= domain.h) return;
    Vec3 middle{0.0, 0.0, 0.0};
    Index3 cell{0, 0, 0};
    for (int k = 0; k < dims(); ++k) {
      if (k != d && across.upper[k] - across.lower[k] <= tiny()) return;
      middle[k] = k == d ? 0.5 * (from + to) : 0.5 * (across.lower[k] + across.upper[k]);
      double const at = (middle[k] - domain.lower[k]) / domain.h;
      if (at < 0.0 || at >= domain.cells[k]) return;
      cell[k] = static_cast<int>(at);
    }
    if (!solid(cell)) return;
    Section const& section = sections[obstacle_shapes_[n].first];
    std::string const what =
        other < 0 ? fmt::format("the face {}", grid::face_names[static_cast<std::size_t>(-1 - other)])
                  : fmt::format("obstacle[{}]", obstacle_shapes_[static_cast<std::size_t>(other)].first + 1);
    warn(section, place_key(section),
         fmt::format(
             "the gap of {:.4g} m between it and {} at {} m is narrower than a cell and will be closed: cells of "
             "{:.3g} m or less (domain.cell) keep it open",
             to - from, what, point_text(middle, dims()), 0.5 * (to - from)));
  };
  auto const box_of = [&](std::size_t n) { return std::get_if<shape::Box>(&out_.obstacles[n].shape); };
  for (std::size_t n = 0; n < out_.obstacles.size(); ++n) {
    shape::Box const* const a = box_of(n);
    if (a == nullptr) continue;
    for (int d = 0; d < dims(); ++d) {
      look(n, d, domain.lower[d], a->lower[d], *a, -1 - 2 * d);
      look(n, d, a->upper[d], domain.upper(d), *a, -2 - 2 * d);
      for (std::size_t m = 0; m < n; ++m) {
        shape::Box const* const b = box_of(m);
        if (b == nullptr) continue;
        look(n, d, b->upper[d], a->lower[d], overlap(*a, *b), static_cast<int>(m));
        look(n, d, a->upper[d], b->lower[d], overlap(*a, *b), static_cast<int>(m));
      }
    }
  }
}

void Builder::check_regions() {
  if (!domain_known_ || out_.regions.empty()) return;
  setup::RegionPlacing const placing(out_);
  for (std::size_t n = 0; n < out_.regions.size(); ++n) {
    auto const b = shape::bounds(out_.regions[n].shape);
    bool outside = false;
    for (int d = 0; d < dims(); ++d) {
      outside = outside || !(b.upper[d] > out_.domain.lower[d] && b.lower[d] < out_.domain.upper(d));
    }
    if (outside || !placing.vanishes(n)) continue;  // outside: reported
    Section const& section = *region_sections_[n];
    error(section, place_key(section),
          fills(out_.regions[n].shape)
              ? "the region fills nothing: later regions or obstacles take all of its place; remove it, or write it "
                "after the regions that cover it"
              : "the region fills nothing of the domain: move it, or make it larger");
  }
}

void Builder::fits_between_obstacles(Section const& section, shape::Shape const& body) {
  if (out_.obstacles.empty() || deck_.text("start") == "remap") return;
  auto const near = shape::bounds(body);
  bool const beside = std::any_of(out_.obstacles.begin(), out_.obstacles.end(), [&](run::Obstacle const& o) {
    auto const b = overlap(near, shape::bounds(o.shape));
    for (int d = 0; d < dims(); ++d) {
      if (b.upper[d] - b.lower[d] < -out_.domain.h) return false;
    }
    return true;
  });
  if (!beside) return;
  setup::SolidCells const solid(out_.domain, out_.obstacles);
  try {
    (void)detonation::fill_cells(body, grid::Grid(out_.domain), shape::volume(body, geometry()), "the charge",
                                 [&](Index3 const& cell) { return solid(cell); });
  } catch (InputError const& problem) {
    error(section, place_key(section), problem.what());
  }
}

void Builder::unused_materials() {
  std::set<std::string> used;
  auto const use = [&](Section const& section, std::string_view key) {
    if (auto const name = section.text(key)) used.insert(*name);
  };
  if (Section const* ambient = deck_.section("ambient")) use(*ambient, "fluid");
  each("charge", [&](Section const& section) { use(section, "explosive"); });
  each("region", [&](Section const& section) { use(section, "fluid"); });
  each("body", [&](Section const& section) { use(section, "material"); });
  for (auto const* key : {"explosives", "fluids", "solids"}) {
    each(key, [&](Section const& section) {
      if (used.contains(section.name)) return;
      report_.warning(section.place, section.path, "nothing in this deck is made of it: name it where it is meant");
    });
  }
}

bool Builder::walled_in(setup::SolidCells const& solid, Vec3 const& p) const {
  // The cells that a gauge at p reads.
  grid::Domain const& domain = out_.domain;
  Index3 low{0, 0, 0};
  Vec3 part{0.0, 0.0, 0.0};
  for (int d = 0; d < dims(); ++d) {
    double const position =
        std::clamp((p[d] - domain.lower[d]) / domain.h - 0.5, 0.0, static_cast<double>(domain.cells[d] - 1));
    low[d] = std::min(static_cast<int>(position), domain.cells[d] - 2);
    part[d] = position - low[d];
  }
  for (int corner = 0; corner < 1 << dims(); ++corner) {
    Index3 cell = low;
    bool counts = true;
    for (int d = 0; d < dims(); ++d) {
      bool const up = (corner >> d & 1) != 0;
      cell[d] += up ? 1 : 0;
      counts = counts && (up ? part[d] : 1.0 - part[d]) > 0.0;
    }
    if (counts && !solid(cell)) return false;
  }
  return true;
}

// --- what holds and loads bodies

bool Builder::is_rigid(std::size_t body) const {
  return (*deck_.sections("body"))[body].boolean("rigid").value_or(false);
}

shape::Box Builder::reach_of_bodies(int body) const {
  shape::Box reach{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (std::size_t n = 0; n < body_shapes_.size(); ++n) {
    if (body >= 0 ? static_cast<int>(n) != body : is_rigid(n)) continue;
    auto const b = shape::bounds(*body_shapes_[n]);
    for (int d = 0; d < 3; ++d) {
      reach.lower[d] = std::min(reach.lower[d], b.lower[d] - out_.domain.h);
      reach.upper[d] = std::max(reach.upper[d], b.upper[d] + out_.domain.h);
    }
  }
  return reach;
}

std::optional<Vec3> Builder::held_node(std::vector<shape::Shape const*> const& regions,
                                       shape::Box const& within) const {
  grid::Domain const& domain = out_.domain;
  shape::Box box = within;
  for (shape::Shape const* region : regions) box = overlap(box, shape::bounds(*region));
  constexpr int beyond = 2;  // nodes behind an open face belong to bodies there
  Index3 first{0, 0, 0};
  Index3 last{0, 0, 0};
  double count = 1.0;
  for (int d = 0; d < dims(); ++d) {
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
        for (int d = 0; d < dims(); ++d) x[d] = domain.lower[d] + node[d] * domain.h;
        bool const held = std::all_of(regions.begin(), regions.end(),
                                      [&](shape::Shape const* region) { return mpm::holds_node(*region, domain, x); });
        if (held) return x;
      }
    }
  }
  return std::nullopt;
}

void Builder::check_constraints() {
  bool const known = std::all_of(body_shapes_.begin(), body_shapes_.end(), [](auto const& s) { return s; });
  if (!domain_known_ || !boundaries_known_ || !known) return;
  shape::Box const everywhere = shape::bounds(shape::Everywhere{});
  for (std::size_t n = 0; n < out_.points.constraints.size(); ++n) {
    mpm::Constraint const& c = out_.points.constraints[n];
    Section const& section = *constraint_sections_[n];
    if (c.body >= 0 && is_rigid(static_cast<std::size_t>(c.body))) {
      error(
          section, "body",
          fmt::format("\"{}\" is rigid and keeps its velocity, whatever holds it: remove the constraint, or write the "
                      "velocity of the body",
                      body_names_[static_cast<std::size_t>(c.body)]));
      continue;
    }
    if (section.given("region")) {
      auto const b = shape::bounds(c.region);
      double nodes = 1.0;
      bool outside = false;
      for (int d = 0; d < dims(); ++d) {
        outside = outside || !(b.upper[d] > out_.domain.lower[d] && b.lower[d] < out_.domain.upper(d));
        nodes *= std::max(1.0, std::min(b.upper[d] - b.lower[d], out_.domain.h * out_.domain.cells[d]) / out_.domain.h);
      }
      if (outside) continue;  // reported
      if (nodes < most_nodes / 4.0 && !held_node({&c.region}, everywhere)) {
        Section const& region = *section.section("region");
        report_.error(
            region.place_of(place_key(region)), region.path,
            fmt::format("it holds no node of the grid, which lie at whole numbers of cells of {:.6g} m from the low "
                        "corner of the domain: make it thicker than a cell, or lay it over a plane of nodes",
                        out_.domain.h));
        continue;
      }
      shape::Box const reach = reach_of_bodies(c.body);
      if (nodes < most_nodes / 4.0 && !held_node({&c.region}, reach)) {
        warn(section, "region", "holds no node of a body at the start: nothing is held until a body comes there");
      }
    }
    check_contradictions(n);
  }
}

void Builder::check_contradictions(std::size_t number) {
  mpm::Constraint const& c = out_.points.constraints[number];
  Section const& section = *constraint_sections_[number];
  shape::Box const reach = reach_of_bodies(c.body);
  std::string_view const key = section.given("velocity") ? "velocity" : section.given("kind") ? "kind" : "region";
  for (std::size_t m = 0; m < number; ++m) {
    mpm::Constraint const& other = out_.points.constraints[m];
    if (c.body >= 0 && other.body >= 0 && c.body != other.body) continue;
    for (int d = 0; d < dims(); ++d) {
      if (!c.held[static_cast<std::size_t>(d)] || !other.held[static_cast<std::size_t>(d)]) continue;
      if (c.velocity[d] == other.velocity[d]) continue;
      auto const node = held_node({&c.region, &other.region}, overlap(reach, reach_of_bodies(other.body)));
      if (!node) continue;
      error(section, key,
            fmt::format("{} m/s in direction {} contradicts {}, which prescribes {} m/s for the same node at {} m: let "
                        "their regions have no node in common, or hold the direction in one of them",
                        c.velocity[d], directions[d], constraint_sections_[m]->path, other.velocity[d],
                        point_text(*node, dims())));
      return;
    }
  }
  for (int f = 0; f < 2 * dims(); ++f) {
    int const d = f / 2;
    Boundary const boundary = out_.domain.boundary[f];
    double const outwards = (f % 2 == 0 ? -1.0 : 1.0) * c.velocity[d];
    if (!c.held[static_cast<std::size_t>(d)] || outwards == 0.0) continue;
    // Behind a symmetry plane is the image, which moves the other way; a wall stops what moves into it.
    if (boundary != Boundary::symmetry && (boundary != Boundary::wall || outwards < 0.0)) continue;
    double const plane = f % 2 == 0 ? out_.domain.lower[d] : out_.domain.upper(d);
    shape::Box at_plane = reach;
    // Not the nodes that a body beside the plane only reaches.
    if (reach.lower[d] + out_.domain.h > plane + tiny() || reach.upper[d] - out_.domain.h < plane - tiny()) continue;
    at_plane.lower[d] = plane - tiny();
    at_plane.upper[d] = plane + tiny();
    auto const node = held_node({&c.region}, at_plane);
    if (!node) continue;
    warn(section, "velocity",
         fmt::format("{:g} m/s in direction {} contradicts the face {}, a {} that holds the node at {} m in this "
                     "direction: keep the region a cell away from it, or hold the other directions only",
                     c.velocity[d], directions[d], grid::face_names[f],
                     boundary == Boundary::symmetry ? "symmetry plane" : "rigid wall", point_text(*node, dims())));
    return;
  }
}

bool Builder::has_points_in(shape::Shape const& body, shape::Shape const& layer, long points_per_cell) const {
  grid::Domain fine = out_.domain;
  fine.h /= static_cast<double>(points_per_cell);
  for (int d = 0; d < dims(); ++d) fine.cells[d] *= static_cast<int>(points_per_cell);
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

// --- time

void Builder::check_onsets() {
  if (!end_known_) return;
  for (Onset const& onset : onsets_) {
    if (onset.time < out_.end.time) continue;
    std::string_view const key = onset.section->given(onset.key) ? onset.key : "";
    report_.warning(key.empty() ? onset.section->place : onset.section->place_of(key),
                    key.empty() ? onset.section->path : onset.section->path_of(key),
                    fmt::format("{} within this calculation: its time {:g} s lies after the end at {:g} s", onset.never,
                                onset.time, out_.end.time));
  }
}

}  // namespace brisance::deck
