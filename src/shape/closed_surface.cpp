#include "shape/closed_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "core/error.hpp"

namespace brisance::shape {

namespace {

/// Integer cell of a point in a lattice, as a key of a hash table. Two cells may share a key: a welder compares
/// distances anyway.
std::uint64_t lattice_key(std::int64_t i, std::int64_t j, std::int64_t k) {
  return static_cast<std::uint64_t>(i) * 73856093U ^ static_cast<std::uint64_t>(j) * 19349663U ^
         static_cast<std::uint64_t>(k) * 83492791U;
}

/// Equal corners become one vertex; `vertex_of` tells which.
void weld_equal(std::vector<Vec3> const& corners, std::vector<int>& vertex_of, std::vector<Vec3>& vertices) {
  std::vector<int> order(corners.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    if (corners[a] != corners[b]) return corners[a] < corners[b];
    return a < b;
  });
  for (std::size_t n = 0; n < order.size(); ++n) {
    if (n == 0 || corners[order[n]] != corners[order[n - 1]]) vertices.push_back(corners[order[n]]);
    vertex_of[order[n]] = static_cast<int>(vertices.size()) - 1;
  }
}

/// Corners closer than a tolerance become one vertex. Lattice cells of four tolerances: a point looks into the
/// neighbouring cell only where it is near its face.
void weld_near(std::vector<Vec3> const& corners, double tolerance, std::vector<int>& vertex_of,
               std::vector<Vec3>& vertices) {
  double const pitch = 4.0 * tolerance;
  std::unordered_map<std::uint64_t, std::vector<int>> table;
  table.reserve(corners.size());
  for (std::size_t n = 0; n < corners.size(); ++n) {
    Vec3 const& x = corners[n];
    std::array<std::int64_t, 3> low{};
    std::array<std::int64_t, 3> high{};
    for (int d = 0; d < 3; ++d) {
      low[d] = static_cast<std::int64_t>(std::floor((x[d] - tolerance) / pitch));
      high[d] = static_cast<std::int64_t>(std::floor((x[d] + tolerance) / pitch));
    }
    int found = -1;
    for (std::int64_t k = low[2]; k <= high[2] && found < 0; ++k) {
      for (std::int64_t j = low[1]; j <= high[1] && found < 0; ++j) {
        for (std::int64_t i = low[0]; i <= high[0] && found < 0; ++i) {
          auto const entry = table.find(lattice_key(i, j, k));
          if (entry == table.end()) continue;
          for (int const v : entry->second) {
            if (norm(vertices[v] - x) <= tolerance) {
              found = v;
              break;
            }
          }
        }
      }
    }
    if (found < 0) {
      found = static_cast<int>(vertices.size());
      vertices.push_back(x);
      auto const cell = [&](int d) { return static_cast<std::int64_t>(std::floor(x[d] / pitch)); };
      table[lattice_key(cell(0), cell(1), cell(2))].push_back(found);
    }
    vertex_of[n] = found;
  }
}

Surface weld(std::vector<Vec3> const& corners, double tolerance) {
  std::vector<int> vertex_of(corners.size());
  Surface surface;
  if (tolerance <= 0.0) {
    weld_equal(corners, vertex_of, surface.vertices);
  } else {
    weld_near(corners, tolerance, vertex_of, surface.vertices);
  }
  for (std::size_t n = 0; n + 2 < corners.size(); n += 3) {
    Triangle const t{vertex_of[n], vertex_of[n + 1], vertex_of[n + 2]};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) surface.triangles.push_back(t);
  }
  return surface;
}

/// What is wrong with the edges of a surface.
struct EdgeReport {
  long open = 0;      ///< edges of one triangle
  long against = 0;   ///< edges of two triangles that face against each other
  long branched = 0;  ///< edges of three triangles or more
  std::array<int, 2> first_open{};
  std::array<int, 2> first_against{};
  std::array<int, 2> first_branched{};
};

EdgeReport check_edges(Surface const& surface) {
  struct Edge {
    int a, b;
    int direction;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * surface.triangles.size());
  for (Triangle const& t : surface.triangles) {
    for (int s = 0; s < 3; ++s) {
      int const a = t[s];
      int const b = t[(s + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
    }
  }
  std::sort(edges.begin(), edges.end(), [](Edge const& p, Edge const& q) {
    if (p.a != q.a) return p.a < q.a;
    if (p.b != q.b) return p.b < q.b;
    return p.direction < q.direction;
  });
  EdgeReport report;
  for (std::size_t n = 0; n < edges.size();) {
    std::size_t end = n;
    int sum = 0;
    while (end < edges.size() && edges[end].a == edges[n].a && edges[end].b == edges[n].b)
      sum += edges[end++].direction;
    std::array<int, 2> const edge{edges[n].a, edges[n].b};
    if (end - n == 1) {
      if (report.open++ == 0) report.first_open = edge;
    } else if (end - n > 2) {
      if (report.branched++ == 0) report.first_branched = edge;
    } else if (sum != 0) {
      if (report.against++ == 0) report.first_against = edge;
    }
    n = end;
  }
  return report;
}

std::string place(Vec3 const& x) { return fmt::format("({:.6g}, {:.6g}, {:.6g}) m", x[0], x[1], x[2]); }

[[noreturn]] void refuse(std::string const& what, std::string const& message) {
  throw InputError(what + ": " + message);
}

/// The largest coordinate; throws where one means nothing.
double largest_of(std::vector<Vec3> const& corners, std::string const& what) {
  double largest = 0.0;
  for (std::size_t n = 0; n < corners.size(); ++n) {
    for (double const c : corners[n]) {
      // The moments of the volume take the fourth power.
      if (!(std::abs(c) <= 1e60)) {
        refuse(what, fmt::format(
                         "triangle {} has a coordinate that is not a number or is far too large; export the body again",
                         n / 3 + 1));
      }
      largest = std::max(largest, std::abs(c));
    }
  }
  return largest;
}

/// Longest edge of the box around the corners.
double size_of(std::vector<Vec3> const& corners) {
  Vec3 low = corners.front();
  Vec3 high = low;
  for (Vec3 const& x : corners) {
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], x[d]);
      high[d] = std::max(high[d], x[d]);
    }
  }
  return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
}

/// Of the size of a body: so far apart may corners be that were meant to be one.
constexpr double sloppy = 1e-6;

}  // namespace

Surface closed_surface(std::vector<Vec3> const& corners, std::string const& what) {
  if (corners.size() < 3) refuse(what, "it contains no triangles; export the body as a closed surface of triangles");
  if (corners.size() > 1'000'000'000) refuse(what, "too many triangles; export the body with a coarser tolerance");
  double const largest = largest_of(corners, what);
  Surface surface = weld(corners, 0.0);
  EdgeReport edges = check_edges(surface);
  if (edges.open > 0 && largest > 0.0) {
    // Writers round each corner by itself: weld within a few units of single precision.
    surface = weld(corners, 4.0 * std::numeric_limits<float>::epsilon() * largest);
    edges = check_edges(surface);
  }
  if (edges.open > 0) {
    double const size = size_of(corners);
    if (size > 0.0) surface = weld(corners, sloppy * size);
    edges = check_edges(surface);
  }
  if (surface.triangles.empty()) refuse(what, "all triangles are degenerate (points or lines); export the body again");
  auto const middle = [&](std::array<int, 2> const& edge) {
    return place(0.5 * (surface.vertices[edge[0]] + surface.vertices[edge[1]]));
  };
  if (edges.open > 0) {
    refuse(what,
           fmt::format("the surface is not closed: {} open edge{}, the first at {}; repair the mesh or export the body "
                       "as a solid",
                       edges.open, edges.open == 1 ? "" : "s", middle(edges.first_open)));
  }
  if (edges.branched > 0) {
    refuse(what, fmt::format("{} edge{} shared by more than two triangles, the first at {}; separate the touching "
                             "shells or remove duplicate triangles",
                             edges.branched, edges.branched == 1 ? " is" : "s are", middle(edges.first_branched)));
  }
  if (edges.against > 0) {
    refuse(what, fmt::format("neighbouring triangles have opposite orientations at {} edge{}, the first at {}; make "
                             "all normals point outwards",
                             edges.against, edges.against == 1 ? "" : "s", middle(edges.first_against)));
  }
  return surface;
}

}  // namespace brisance::shape
