#include "shape/mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "core/error.hpp"
#include "shape/closed_surface.hpp"
#include "shape/line_bins.hpp"
#include "shape/touched_boxes.hpp"

namespace brisance::shape {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Where a line along x passes through the surface; `sign` is +1 where it enters.
struct Crossing {
  double x = 0.0;
  int sign = 0;
  int triangle = 0;
};

/// Triangles that hang together: a closed surface of its own.
struct Shell {
  Vec3 lower{infinity, infinity, infinity};
  Vec3 upper{-infinity, -infinity, -infinity};
  double six_volumes = 0.0;
  bool overlaps = false;  ///< a line enters it within another one
  bool shows = false;     ///< a line enters or leaves the body through it
};

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

}  // namespace

struct Mesh::Data {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  Vec3 lower{}, upper{}, centre{};
  double volume = 0.0;
  std::array<std::vector<double>, 3> faces;

  std::vector<int> shell_of;  ///< of each triangle
  std::vector<Shell> shells;
  bool overlapping = false;
  bool joined = false;   ///< shells may lie within others
  bool upright = false;  ///< all triangles are level or upright

  std::optional<TouchedBoxes> touched;

  LineBins bins;

  void measure() {
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
      double const fraction = dot(a, across);
      six += fraction;
      moment = moment + (0.25 * fraction) * (a + b + c);
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
    upright = std::all_of(triangles.begin(), triangles.end(), [this](Triangle const& t) {
      Vec3 const& a = vertices[t[0]];
      Vec3 const& b = vertices[t[1]];
      Vec3 const& c = vertices[t[2]];
      auto const above = [](Vec3 const& p, Vec3 const& q) { return p[0] == q[0] && p[1] == q[1]; };
      return (a[2] == b[2] && b[2] == c[2]) || above(a, b) || above(b, c) || above(c, a);
    });
  }

  /// The crossings of one line, unsorted. Their signs add up to 0 on a closed surface.
  [[nodiscard]] int collect(double y, double z, Span const& part, std::vector<Crossing>& crossings) const {
    crossings.clear();
    int balance = 0;
    bins.on_line(y, z, part.from, part.to, [&](int n) {
      Shell const& shell = shells[shell_of[n]];
      if (shell.lower[0] > part.to || shell.upper[0] < part.from) return;
      Triangle const& t = triangles[n];
      double const e0 = side(vertices, t[1], t[2], y, z);
      double const e1 = side(vertices, t[2], t[0], y, z);
      int const s = side_sign(vertices, t[1], t[2], e0);
      if (s == 0 || side_sign(vertices, t[2], t[0], e1) != s) return;
      double const e2 = side(vertices, t[0], t[1], y, z);
      if (side_sign(vertices, t[0], t[1], e2) != s) return;
      double const area = e0 + e1 + e2;
      if (area == 0.0) return;
      double const x = (e0 * vertices[t[0]][0] + e1 * vertices[t[1]][0] + e2 * vertices[t[2]][0]) / area;
      // The outward normal points along +x where the line leaves the body.
      crossings.push_back({x, -s, n});
      balance -= s;
    });
    return balance;
  }

  /// The crossings of a line with the shells that lie in a part of it. Round-off beside a vertex may spoil their
  /// balance: then a line moved by less than the precision of the coordinates stands for it.
  void crossings_of(double y, double z, Span const& part, std::vector<Crossing>& crossings) const {
    if (!(y >= lower[1] && y <= upper[1] && z >= lower[2] && z <= upper[2])) {
      crossings.clear();
      return;
    }
    double const dy = 1e-10 * (upper[1] - lower[1]);
    double const dz = 1e-10 * (upper[2] - lower[2]);
    for (int attempt = 0; attempt < 8; ++attempt) {
      if (collect(y + attempt * dy, z + 0.618 * attempt * dz, part, crossings) == 0) return;
    }
    crossings.clear();
  }

  /// The crossings of a line in their order.
  void ordered_crossings(double y, double z, Span const& part, std::vector<Crossing>& crossings) const {
    crossings_of(y, z, part, crossings);
    double const slack = 1e-9 * (upper[0] - lower[0]);
    std::sort(crossings.begin(), crossings.end(), [](Crossing const& p, Crossing const& q) { return p.x < q.x; });
    // Where shells touch, the line leaves the one before it enters the other.
    for (std::size_t n = 1; n < crossings.size(); ++n) {
      Crossing& p = crossings[n - 1];
      Crossing& q = crossings[n];
      if (p.sign > 0 && q.sign < 0 && q.x - p.x <= slack && n >= 2 && crossings[n - 2].sign > 0) std::swap(p, q);
    }
  }

  /// Where a line lies inside: in one shell or in several that overlap.
  void spans(double y, double z, Span const& part, std::vector<Span>& out) const {
    out.clear();
    std::vector<Crossing> crossings;
    ordered_crossings(y, z, part, crossings);
    int depth = 0;
    for (Crossing const& c : crossings) {
      int const before = depth;
      depth += c.sign;
      if (before <= 0 && depth > 0) out.push_back({c.x, c.x});
      if (before > 0 && depth <= 0) out.back().to = c.x;
    }
  }

  void find_shells() {
    std::vector<int> root(vertices.size());
    std::iota(root.begin(), root.end(), 0);
    auto const find = [&](int v) {
      while (root[v] != v) v = root[v] = root[root[v]];
      return v;
    };
    for (Triangle const& t : triangles) {
      root[find(t[1])] = find(t[0]);
      root[find(t[2])] = find(t[0]);
    }
    std::vector<int> number(vertices.size(), -1);
    Vec3 const middle = 0.5 * (lower + upper);
    for (Triangle const& t : triangles) {
      int& shell = number[find(t[0])];
      if (shell < 0) {
        shell = static_cast<int>(shells.size());
        shells.emplace_back();
      }
      shell_of.push_back(shell);
      Shell& s = shells[shell];
      for (int const v : t) {
        for (int d = 0; d < 3; ++d) {
          s.lower[d] = std::min(s.lower[d], vertices[v][d]);
          s.upper[d] = std::max(s.upper[d], vertices[v][d]);
        }
      }
      Vec3 const a = vertices[t[0]] - middle;
      Vec3 const b = vertices[t[1]] - middle;
      Vec3 const c = vertices[t[2]] - middle;
      s.six_volumes += dot(a, Vec3{b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]});
    }
  }

  /// What the boxes around two shells have in common, of all pairs, unless there are very many.
  [[nodiscard]] std::vector<std::array<Vec3, 2>> common_boxes() const {
    constexpr std::size_t most = 20000;
    std::vector<Shell> sorted = shells;
    std::sort(sorted.begin(), sorted.end(), [](Shell const& p, Shell const& q) { return p.lower[0] < q.lower[0]; });
    std::vector<std::array<Vec3, 2>> boxes;
    for (std::size_t m = 0; m < sorted.size(); ++m) {
      for (std::size_t n = m + 1; n < sorted.size() && sorted[n].lower[0] < sorted[m].upper[0]; ++n) {
        std::array<Vec3, 2> box;
        bool common = true;
        for (int d = 0; d < 3; ++d) {
          box[0][d] = std::max(sorted[m].lower[d], sorted[n].lower[d]);
          box[1][d] = std::min(sorted[m].upper[d], sorted[n].upper[d]);
          common = common && box[0][d] < box[1][d];
        }
        if (common) boxes.push_back(box);
        if (boxes.size() == most) return boxes;
      }
    }
    return boxes;
  }

  /// Notes how shells lie to each other along a line; false where the line leaves the body before it has entered it.
  bool look_along(double y, double z, Span const& part) {
    std::vector<Crossing> crossings;
    ordered_crossings(y, z, part, crossings);
    int depth = 0;
    bool proper = true;
    for (Crossing const& c : crossings) {
      Shell& shell = shells[shell_of[c.triangle]];
      if (c.sign > 0 && depth > 0) shell.overlaps = overlapping = true;
      if (c.sign < 0 && depth > 1) overlapping = true;
      depth += c.sign;
      if (depth == (c.sign > 0 ? 1 : 0)) shell.shows = true;
      proper = proper && depth >= 0;
    }
    return proper;
  }

  [[nodiscard]] std::array<Vec3, 2> box_of(int triangle) const {
    Triangle const& t = triangles[triangle];
    std::array<Vec3, 2> box{vertices[t[0]], vertices[t[0]]};
    for (int const v : t) {
      for (int d = 0; d < 3; ++d) {
        box[0][d] = std::min(box[0][d], vertices[v][d]);
        box[1][d] = std::max(box[1][d], vertices[v][d]);
      }
    }
    return box;
  }
};

Mesh::Mesh(std::vector<Vec3> const& corners, std::string const& what)
    : Mesh(closed_surface(corners, what), false, what) {}

Mesh Mesh::of_shells(Surface surface, std::string const& what) { return {std::move(surface), true, what}; }

Mesh::Mesh(Surface surface, bool joined, std::string const& what) {
  auto const refuse = [&](std::string const& message) -> void { throw InputError(what + ": " + message); };
  auto data = std::make_shared<Data>();
  data->joined = joined;
  data->vertices = std::move(surface.vertices);
  data->triangles = std::move(surface.triangles);
  data->measure();
  if (data->volume < 0.0) {
    for (Triangle& t : data->triangles) std::swap(t[1], t[2]);
    data->volume = -data->volume;
  }
  Vec3 const extent = data->upper - data->lower;
  double const least = joined ? 0.0 : 1e-9 * extent[0] * extent[1] * extent[2];
  if (!(data->volume > least) || !std::isfinite(data->volume))
    refuse("the surface encloses no volume; export the body as a solid");
  data->find_faces();
  data->find_shells();
  std::vector<std::array<Vec3, 2>> boxes;
  boxes.reserve(data->triangles.size());
  for (std::size_t n = 0; n < data->triangles.size(); ++n) boxes.push_back(data->box_of(static_cast<int>(n)));
  data->touched.emplace(data->lower, data->upper, boxes);
  std::vector<LineBins::Bounds> shell_boxes;
  for (Shell const& shell : data->shells) shell_boxes.push_back({shell.lower, shell.upper});
  data->bins = LineBins(data->lower, data->upper, boxes, data->shell_of, shell_boxes);
  // A shell that is inside out shows as a line that leaves before it has entered.
  auto const look = [&](Vec3 const& low, Vec3 const& high, int lines) {
    for (int k = 0; k < lines; ++k) {
      for (int j = 0; j < lines; ++j) {
        double const y = low[1] + (j + 0.5) / lines * (high[1] - low[1]);
        double const z = low[2] + (k + 0.5) / lines * (high[2] - low[2]);
        if (data->look_along(y, z, joined ? Span{low[0], high[0]} : whole_line) || joined) continue;
        refuse(
            fmt::format("one of its shells is inside out (seen along x at y = {:.6g} m, z = {:.6g} m); make all "
                        "normals point outwards",
                        y, z));
      }
    }
  };
  look(data->lower, data->upper, 61);
  std::size_t const shells = data->shells.size();
  int const lines_each = shells > 2000 ? 5 : shells > 200 ? 11 : 31;
  for (std::size_t n = 0; n < shells && shells > 1; ++n) look(data->shells[n].lower, data->shells[n].upper, lines_each);
  for (auto const& [low, high] : data->common_boxes()) look(low, high, 7);
  for (Shell const& shell : data->shells) {
    if (joined || !(shell.six_volumes > 0.0) || !shell.overlaps || shell.shows) continue;
    Vec3 const middle = 0.5 * (shell.lower + shell.upper);
    refuse(fmt::format(
        "the shell around ({:.6g}, {:.6g}, {:.6g}) m lies wholly inside another one; turn its normals round "
        "if it is a cavity, or remove it",
        middle[0], middle[1], middle[2]));
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
bool Mesh::overlaps() const { return data_->overlapping; }
std::vector<double> const& Mesh::faces(int direction) const { return data_->faces[direction]; }

bool Mesh::upright() const { return data_->upright; }

void Mesh::spans(double y, double z, std::vector<Span>& out, Span const& part) const { data_->spans(y, z, part, out); }

Mesh Mesh::mapped(std::function<Vec3(Vec3 const&)> const& f, std::string const& what) const {
  Surface surface{{}, data_->triangles};
  surface.vertices.reserve(data_->vertices.size());
  for (Vec3 const& x : data_->vertices) surface.vertices.push_back(f(x));
  return {std::move(surface), data_->joined, what};
}

Mesh Mesh::turned(Index3 const& axes) const {
  return mapped([&](Vec3 const& x) { return Vec3{x[axes[0]], x[axes[1]], x[axes[2]]}; }, "the turned mesh");
}

bool Mesh::contains(Vec3 const& x) const {
  if (!(x[0] >= data_->lower[0] && x[0] <= data_->upper[0])) return false;
  std::vector<Crossing> crossings;
  data_->crossings_of(x[1], x[2], {x[0], x[0]}, crossings);
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
  if (!m.touched->any_in({low, high})) return false;
  return m.bins.any_in(
      {low, high}, [&](int n) { return m.box_of(n); }, [](int) { return true; });
}

void Mesh::faces_in(int direction, Vec3 const& low, Vec3 const& high, std::vector<double>& out) const {
  Data const& m = *data_;
  auto const add = [&](double at) {
    if (at > low[direction] && at < high[direction]) out.push_back(at);
  };
  add(m.lower[direction]);
  add(m.upper[direction]);
  if (m.faces[direction].size() == 2) return;  // no others
  std::size_t const first = out.size();
  (void)m.bins.any_in(
      {low, high}, [&](int n) { return m.box_of(n); },
      [&](int n) {
        auto const [from, to] = m.box_of(n);
        if (from[direction] == to[direction]) add(from[direction]);
        return false;
      });
  auto const begin = out.begin() + static_cast<std::ptrdiff_t>(first);
  std::sort(begin, out.end());
  out.erase(std::unique(begin, out.end()), out.end());
}

}  // namespace brisance::shape
