#include "shape/mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "core/error.hpp"

namespace brisance::shape {

namespace {

using Triangle = std::array<int, 3>;

/// Where a line along x passes through the surface; `sign` is +1 where it enters.
struct Crossing {
  double x = 0.0;
  int sign = 0;
};

/// Integer cell of a point in a lattice, as a key of a hash table. Two cells may share a key: a welder compares
/// distances anyway.
std::uint64_t lattice_key(std::int64_t i, std::int64_t j, std::int64_t k) {
  return static_cast<std::uint64_t>(i) * 73856093U ^ static_cast<std::uint64_t>(j) * 19349663U ^
         static_cast<std::uint64_t>(k) * 83492791U;
}

struct Surface {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
};

/// Corners closer than `tolerance` become one vertex; triangles that lose a side vanish.
Surface weld(std::vector<Vec3> const& corners, double tolerance) {
  // An exact weld needs no lattice of a certain size, only equal keys of equal points.
  std::vector<int> vertex_of(corners.size());
  Surface surface;
  if (tolerance <= 0.0) {
    std::vector<int> order(corners.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      if (corners[a] != corners[b]) return corners[a] < corners[b];
      return a < b;
    });
    for (std::size_t n = 0; n < order.size(); ++n) {
      if (n == 0 || corners[order[n]] != corners[order[n - 1]]) surface.vertices.push_back(corners[order[n]]);
      vertex_of[order[n]] = static_cast<int>(surface.vertices.size()) - 1;
    }
  } else {
    // Lattice cells of four tolerances: a point looks into the neighbouring cell only where it is near its face.
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
              if (norm(surface.vertices[v] - x) <= tolerance) {
                found = v;
                break;
              }
            }
          }
        }
      }
      if (found < 0) {
        found = static_cast<int>(surface.vertices.size());
        surface.vertices.push_back(x);
        auto const cell = [&](int d) { return static_cast<std::int64_t>(std::floor(x[d] / pitch)); };
        table[lattice_key(cell(0), cell(1), cell(2))].push_back(found);
      }
      vertex_of[n] = found;
    }
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

/// Twice the signed area of (a, b, p) in the plane (y, z), antisymmetric in a and b to the last bit: the two triangles
/// of an edge see opposite values, so that no line slips through between them.
double side(std::vector<Vec3> const& vertices, int a, int b, double y, double z) {
  bool const swapped = a > b;
  Vec3 const& p = vertices[swapped ? b : a];
  Vec3 const& q = vertices[swapped ? a : b];
  double const value = (q[1] - p[1]) * (z - p[2]) - (q[2] - p[2]) * (y - p[1]);
  return swapped ? -value : value;
}

/// The sign of `side`; a point on the edge counts as moved by (e, e^2) with an infinitely small e, the same for all
/// edges, so that a line through an edge or a vertex crosses the surface exactly once there.
int side_sign(std::vector<Vec3> const& vertices, int a, int b, double value) {
  if (value != 0.0) return value > 0.0 ? 1 : -1;
  double const dz = vertices[b][2] - vertices[a][2];
  if (dz != 0.0) return dz < 0.0 ? 1 : -1;
  double const dy = vertices[b][1] - vertices[a][1];
  if (dy != 0.0) return dy > 0.0 ? 1 : -1;
  return 0;
}

std::string place(Vec3 const& x) { return fmt::format("({:.6g}, {:.6g}, {:.6g}) m", x[0], x[1], x[2]); }

}  // namespace

struct Mesh::Data {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  Vec3 lower{}, upper{}, centre{};
  double volume = 0.0;
  std::array<std::vector<double>, 3> faces;

  // The triangles by the bins of the plane (y, z) that their boxes cover.
  std::array<int, 2> bins{1, 1};
  std::array<double, 2> bins_per_metre{};
  std::vector<std::size_t> bin_start;
  std::vector<int> bin_items;

  [[nodiscard]] int bin(int axis, double at) const {
    double const b = (at - lower[1 + axis]) * bins_per_metre[axis];
    return std::clamp(static_cast<int>(std::clamp(b, -1.0, 1e9)), 0, bins[axis] - 1);
  }

  /// Ranges of bins that a triangle covers: low and high along y, low and high along z.
  [[nodiscard]] std::array<int, 4> covered(Triangle const& t) const {
    auto const [y0, y1] = std::minmax({vertices[t[0]][1], vertices[t[1]][1], vertices[t[2]][1]});
    auto const [z0, z1] = std::minmax({vertices[t[0]][2], vertices[t[1]][2], vertices[t[2]][2]});
    return {bin(0, y0), bin(0, y1), bin(1, z0), bin(1, z1)};
  }

  void measure() {
    double constexpr infinity = std::numeric_limits<double>::infinity();
    lower = {infinity, infinity, infinity};
    upper = {-infinity, -infinity, -infinity};
    for (Vec3 const& v : vertices) {
      for (int d = 0; d < 3; ++d) {
        lower[d] = std::min(lower[d], v[d]);
        upper[d] = std::max(upper[d], v[d]);
      }
    }
    // Tetrahedra from the middle, so that a body far from the origin keeps its digits.
    Vec3 const middle = 0.5 * (lower + upper);
    double six = 0.0;
    Vec3 moment{0.0, 0.0, 0.0};
    for (Triangle const& t : triangles) {
      Vec3 const a = vertices[t[0]] - middle;
      Vec3 const b = vertices[t[1]] - middle;
      Vec3 const c = vertices[t[2]] - middle;
      Vec3 const across{b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]};
      double const part = dot(a, across);
      six += part;
      moment = moment + (0.25 * part) * (a + b + c);
    }
    volume = six / 6.0;
    centre = six != 0.0 ? middle + (1.0 / six) * moment : middle;
  }

  void find_faces() {
    for (int d = 0; d < 3; ++d) {
      auto& at = faces[d];
      at = {lower[d], upper[d]};
      for (Triangle const& t : triangles) {
        double const x = vertices[t[0]][d];
        if (vertices[t[1]][d] == x && vertices[t[2]][d] == x) at.push_back(x);
      }
      std::sort(at.begin(), at.end());
      at.erase(std::unique(at.begin(), at.end()), at.end());
    }
  }

  void fill_bins() {
    auto const count = static_cast<double>(triangles.size());
    int per_side = std::clamp(static_cast<int>(std::sqrt(count)), 1, 2048);
    // Long thin triangles cover many bins each: then coarser bins keep the table short.
    for (;; per_side = std::max(1, per_side / 2)) {
      for (int axis = 0; axis < 2; ++axis) {
        double const extent = upper[1 + axis] - lower[1 + axis];
        bins[axis] = extent > 0.0 ? per_side : 1;
        bins_per_metre[axis] = extent > 0.0 ? bins[axis] / extent : 0.0;
      }
      double entries = 0.0;
      for (Triangle const& t : triangles) {
        auto const c = covered(t);
        entries += static_cast<double>(c[1] - c[0] + 1) * (c[3] - c[2] + 1);
      }
      if (entries <= 16.0 * count + 1000.0 || per_side == 1) break;
    }
    bin_start.assign(static_cast<std::size_t>(bins[0]) * bins[1] + 1, 0);
    auto const each = [&](auto const& use) {
      for (std::size_t n = 0; n < triangles.size(); ++n) {
        auto const c = covered(triangles[n]);
        for (int k = c[2]; k <= c[3]; ++k) {
          for (int j = c[0]; j <= c[1]; ++j) use(static_cast<std::size_t>(k) * bins[0] + j, static_cast<int>(n));
        }
      }
    };
    each([&](std::size_t b, int) { ++bin_start[b + 1]; });
    std::partial_sum(bin_start.begin(), bin_start.end(), bin_start.begin());
    bin_items.resize(bin_start.back());
    std::vector<std::size_t> next(bin_start.begin(), bin_start.end() - 1);
    each([&](std::size_t b, int n) { bin_items[next[b]++] = n; });
  }

  /// The crossings of one line, unsorted. Their signs add up to 0 on a closed surface.
  [[nodiscard]] int collect(double y, double z, std::vector<Crossing>& crossings) const {
    crossings.clear();
    std::size_t const b = static_cast<std::size_t>(bin(1, z)) * bins[0] + bin(0, y);
    int balance = 0;
    for (std::size_t n = bin_start[b]; n < bin_start[b + 1]; ++n) {
      Triangle const& t = triangles[bin_items[n]];
      double const e0 = side(vertices, t[1], t[2], y, z);
      double const e1 = side(vertices, t[2], t[0], y, z);
      int const s = side_sign(vertices, t[1], t[2], e0);
      if (s == 0 || side_sign(vertices, t[2], t[0], e1) != s) continue;
      double const e2 = side(vertices, t[0], t[1], y, z);
      if (side_sign(vertices, t[0], t[1], e2) != s) continue;
      double const area = e0 + e1 + e2;
      if (area == 0.0) continue;
      double const x = (e0 * vertices[t[0]][0] + e1 * vertices[t[1]][0] + e2 * vertices[t[2]][0]) / area;
      // The outward normal points along +x where the line leaves the body.
      crossings.push_back({x, -s});
      balance -= s;
    }
    return balance;
  }

  /// The crossings of a line. Round-off beside a vertex may spoil their balance: then a line moved by less than the
  /// precision of the coordinates stands for it.
  void crossings_of(double y, double z, std::vector<Crossing>& crossings) const {
    if (!(y >= lower[1] && y <= upper[1] && z >= lower[2] && z <= upper[2])) {
      crossings.clear();
      return;
    }
    double const dy = 1e-10 * (upper[1] - lower[1]);
    double const dz = 1e-10 * (upper[2] - lower[2]);
    for (int attempt = 0; attempt < 8; ++attempt) {
      if (collect(y + attempt * dy, z + 0.618 * attempt * dz, crossings) == 0) return;
    }
    crossings.clear();
  }

  /// Where a line lies inside; false where the shells overlap or face against each other.
  bool spans(double y, double z, std::vector<Span>& out) const {
    out.clear();
    std::vector<Crossing> crossings;
    crossings_of(y, z, crossings);
    double const slack = 1e-9 * (upper[0] - lower[0]);
    std::sort(crossings.begin(), crossings.end(), [](Crossing const& p, Crossing const& q) { return p.x < q.x; });
    // Where shells touch, the line leaves the one before it enters the other.
    for (std::size_t n = 1; n < crossings.size(); ++n) {
      Crossing& p = crossings[n - 1];
      Crossing& q = crossings[n];
      if (p.sign > 0 && q.sign < 0 && q.x - p.x <= slack && n >= 2 && crossings[n - 2].sign > 0)
        std::swap(p.sign, q.sign);
    }
    bool proper = true;
    int depth = 0;
    for (Crossing const& c : crossings) {
      int const before = depth;
      depth += c.sign;
      proper = proper && (depth == 0 || depth == 1);
      if (before <= 0 && depth > 0) out.push_back({c.x, c.x});
      if (before > 0 && depth <= 0) out.back().to = c.x;
    }
    return proper;
  }
};

Mesh::Mesh(std::vector<Vec3> const& corners, std::string const& what) {
  auto const refuse = [&](std::string const& message) -> void { throw InputError(what + ": " + message); };
  if (corners.size() < 3) refuse("there are no triangles in it; export the body as a closed surface of triangles");
  if (corners.size() > 1'000'000'000) refuse("too many triangles; export the body with a coarser tolerance");
  double largest = 0.0;
  for (std::size_t n = 0; n < corners.size(); ++n) {
    for (double const c : corners[n]) {
      // The moments of the volume take the fourth power.
      if (!(std::abs(c) <= 1e60)) {
        refuse(
            fmt::format("triangle {} has a coordinate that is not a number or beyond all measure; export the body "
                        "again",
                        n / 3 + 1));
      }
      largest = std::max(largest, std::abs(c));
    }
  }
  Surface surface = weld(corners, 0.0);
  EdgeReport edges = check_edges(surface);
  if (edges.open > 0 && largest > 0.0) {
    // Writers round each corner by itself: weld within a few units of single precision.
    surface = weld(corners, 4.0 * std::numeric_limits<float>::epsilon() * largest);
    edges = check_edges(surface);
  }
  if (surface.triangles.empty()) refuse("all triangles are points or lines; export the body again");
  auto const middle = [&](std::array<int, 2> const& edge) {
    return place(0.5 * (surface.vertices[edge[0]] + surface.vertices[edge[1]]));
  };
  if (edges.open > 0) {
    refuse(
        fmt::format("the surface is not closed: {} open edge{}, the first at {}; repair the mesh or export the body "
                    "as a solid",
                    edges.open, edges.open == 1 ? "" : "s", middle(edges.first_open)));
  }
  if (edges.branched > 0) {
    refuse(
        fmt::format("{} edge{} shared by more than two triangles, the first at {}; separate the touching shells or "
                    "remove double triangles",
                    edges.branched, edges.branched == 1 ? " is" : "s are", middle(edges.first_branched)));
  }
  if (edges.against > 0) {
    refuse(
        fmt::format("neighbouring triangles face against each other at {} edge{}, the first at {}; make the normals "
                    "point outwards everywhere",
                    edges.against, edges.against == 1 ? "" : "s", middle(edges.first_against)));
  }
  auto data = std::make_shared<Data>();
  data->vertices = std::move(surface.vertices);
  data->triangles = std::move(surface.triangles);
  data->measure();
  if (data->volume < 0.0) {
    for (Triangle& t : data->triangles) std::swap(t[1], t[2]);
    data->volume = -data->volume;
  }
  Vec3 const extent = data->upper - data->lower;
  if (!(data->volume > 1e-9 * extent[0] * extent[1] * extent[2]) || !std::isfinite(data->volume))
    refuse("the surface encloses no volume; export the body as a solid");
  data->find_faces();
  data->fill_bins();
  // Shells that overlap or are inside out show as a line that enters twice, or leaves before it has entered.
  constexpr int lines = 61;
  std::vector<Span> scratch;
  for (int k = 0; k < lines; ++k) {
    for (int j = 0; j < lines; ++j) {
      double const y = data->lower[1] + (j + 0.5) / lines * extent[1];
      double const z = data->lower[2] + (k + 0.5) / lines * extent[2];
      if (!data->spans(y, z, scratch)) {
        refuse(
            fmt::format("its shells overlap or one of them is inside out (seen along x at y = {:.6g} m, z = {:.6g} m); "
                        "unite the parts into one solid before the export",
                        y, z));
      }
    }
  }
  data_ = std::move(data);
}

std::vector<std::array<Vec3, 3>> Mesh::triangles() const {
  std::vector<std::array<Vec3, 3>> all;
  all.reserve(data_->triangles.size());
  for (Triangle const& t : data_->triangles)
    all.push_back({data_->vertices[t[0]], data_->vertices[t[1]], data_->vertices[t[2]]});
  return all;
}

std::size_t Mesh::triangle_count() const { return data_->triangles.size(); }
Vec3 const& Mesh::lower() const { return data_->lower; }
Vec3 const& Mesh::upper() const { return data_->upper; }
Vec3 const& Mesh::centre() const { return data_->centre; }
double Mesh::volume() const { return data_->volume; }
std::vector<double> const& Mesh::faces(int direction) const { return data_->faces[direction]; }

void Mesh::spans(double y, double z, std::vector<Span>& out) const { (void)data_->spans(y, z, out); }

Mesh Mesh::turned(Index3 const& axes) const {
  std::vector<Vec3> corners;
  corners.reserve(3 * data_->triangles.size());
  for (Triangle const& t : data_->triangles) {
    for (int c = 0; c < 3; ++c) {
      Vec3 const& x = data_->vertices[t[c]];
      corners.push_back({x[axes[0]], x[axes[1]], x[axes[2]]});
    }
  }
  return {corners, "the turned mesh"};
}

bool Mesh::contains(Vec3 const& x) const {
  if (!(x[0] >= data_->lower[0] && x[0] <= data_->upper[0])) return false;
  std::vector<Crossing> crossings;
  data_->crossings_of(x[1], x[2], crossings);
  int depth = 0;
  for (Crossing const& c : crossings) {
    if (c.x <= x[0]) depth += c.sign;
  }
  return depth > 0;
}

bool Mesh::touches(Vec3 const& low, Vec3 const& high) const {
  Data const& m = *data_;
  for (int d = 0; d < 3; ++d) {
    if (low[d] > m.upper[d] || high[d] < m.lower[d]) return false;
  }
  for (int k = m.bin(1, low[2]); k <= m.bin(1, high[2]); ++k) {
    for (int j = m.bin(0, low[1]); j <= m.bin(0, high[1]); ++j) {
      std::size_t const b = static_cast<std::size_t>(k) * m.bins[0] + j;
      for (std::size_t n = m.bin_start[b]; n < m.bin_start[b + 1]; ++n) {
        Triangle const& t = m.triangles[m.bin_items[n]];
        bool reaches = true;
        for (int d = 0; d < 3; ++d) {
          auto const [from, to] = std::minmax({m.vertices[t[0]][d], m.vertices[t[1]][d], m.vertices[t[2]][d]});
          reaches = reaches && from <= high[d] && to >= low[d];
        }
        if (reaches) return true;
      }
    }
  }
  return false;
}

}  // namespace brisance::shape
