#include "shape/heights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/error.hpp"
#include "shape/closed_surface.hpp"
#include "shape/data_file.hpp"

namespace brisance::shape {

namespace {

constexpr std::size_t most_points = 2'000'000;

/// The place of a value between the lines of a grid: 0 to the number of lines less two.
std::size_t cell_of(std::vector<double> const& lines, double at) {
  auto const above = std::upper_bound(lines.begin() + 1, lines.end() - 1, at);
  return static_cast<std::size_t>(above - lines.begin()) - 1;
}

/// What a place of a file is called.
std::string place_name(DataFile const& file, long place) {
  return fmt::format("{} {}", file.kind() == ".csv" ? "line" : "feature", place);
}

void check_count(DataFile const& file, std::size_t count) {
  if (count > most_points) {
    file.refuse(fmt::format("it has more than {} heights; cut out what lies in the domain, or use a coarser grid",
                            most_points));
  }
}

/// Evenly spaced lines of a grid.
struct Lines {
  double from = 0.0;
  double step = 0.0;
  std::size_t count = 0;

  [[nodiscard]] double at(std::size_t n) const { return from + static_cast<double>(n) * step; }
  [[nodiscard]] std::size_t nearest(double x) const { return static_cast<std::size_t>(std::lround((x - from) / step)); }
};

/// The different values of a coordinate as lines; `axis` is its name.
Lines lines_of(DataFile const& file, std::vector<HeightSample> const& samples, double HeightSample::*axis,
               char const* name) {
  constexpr double same = 1e-6;    // of the extent: closer values are one line, written with fewer digits
  constexpr double uneven = 1e-2;  // of the spacing: what rounding may do to one gap
  constexpr double drift = 0.1;    // and to all of them
  std::vector<HeightSample const*> sorted;
  sorted.reserve(samples.size());
  for (HeightSample const& s : samples) sorted.push_back(&s);
  std::sort(sorted.begin(), sorted.end(), [&](auto const* a, auto const* b) { return a->*axis < b->*axis; });
  double const extent = sorted.back()->*axis - sorted.front()->*axis;
  std::vector<HeightSample const*> lines;
  for (auto const* s : sorted) {
    if (lines.empty() || s->*axis - lines.back()->*axis > same * extent) lines.push_back(s);
  }
  if (lines.size() < 2) {
    file.refuse(fmt::format("all points have {} = {:.10g}; a grid has at least two values of x and two of y", name,
                            sorted.front()->*axis));
  }
  double const step = extent / static_cast<double>(lines.size() - 1);
  std::vector<double> gaps;
  for (std::size_t n = 1; n < lines.size(); ++n) gaps.push_back(lines[n]->*axis - lines[n - 1]->*axis);
  std::vector<double> in_order = gaps;
  auto const middle = in_order.begin() + static_cast<std::ptrdiff_t>(in_order.size() / 2);
  std::nth_element(in_order.begin(), middle, in_order.end());
  auto const uneven_at = [&](std::size_t n) {
    file.refuse(fmt::format(
        "{}: {} = {:.10g} lies {:.6g} from the value before, but others are {:.6g} apart; a grid is evenly spaced: add "
        "the missing points or resample the heights",
        place_name(file, lines[n]->place), name, lines[n]->*axis, gaps[n - 1], *middle));
  };
  for (std::size_t n = 1; n < lines.size(); ++n) {
    if (std::abs(gaps[n - 1] - *middle) > uneven * *middle) uneven_at(n);
  }
  for (std::size_t n = 1; n < lines.size(); ++n) {
    double const even = sorted.front()->*axis + static_cast<double>(n) * step;
    if (std::abs(lines[n]->*axis - even) > drift * step) uneven_at(n);
  }
  return {sorted.front()->*axis, step, lines.size()};
}

Heights grid_of(DataFile const& file, std::vector<HeightSample> const& samples, Frame const& frame) {
  if (samples.empty()) file.refuse("it contains no points");
  Lines const xs = lines_of(file, samples, &HeightSample::x, "x");
  Lines const ys = lines_of(file, samples, &HeightSample::y, "y");
  if (static_cast<double>(xs.count) * static_cast<double>(ys.count) > 2.0 * static_cast<double>(samples.size())) {
    file.refuse(
        fmt::format("its {} points have {} values of x and {} of y: they are no grid; resample the heights on a "
                    "regular grid",
                    samples.size(), xs.count, ys.count));
  }
  std::vector<HeightSample const*> at(xs.count * ys.count, nullptr);
  for (HeightSample const& s : samples) {
    auto& place = at[ys.nearest(s.y) * xs.count + xs.nearest(s.x)];
    if (place != nullptr) {
      file.refuse(fmt::format("{}: the point ({:.10g}, {:.10g}) is there already in {}; remove one of them",
                              place_name(file, s.place), s.x, s.y, place_name(file, place->place)));
    }
    place = &s;
  }
  Heights heights;
  for (std::size_t i = 0; i < xs.count; ++i) heights.x.push_back(frame.point({xs.at(i), 0.0, 0.0})[0]);
  for (std::size_t j = 0; j < ys.count; ++j) heights.y.push_back(frame.point({0.0, ys.at(j), 0.0})[1]);
  for (std::size_t n = 0; n < at.size(); ++n) {
    if (at[n] == nullptr) {
      file.refuse(fmt::format("there is no height at ({:.10g}, {:.10g}); {} of {} points are missing: add them",
                              xs.at(n % xs.count), ys.at(n / xs.count), at.size() - samples.size(), at.size()));
    }
    heights.z.push_back(frame.point({0.0, 0.0, at[n]->z})[2]);
  }
  return heights;
}

std::vector<HeightSample> csv_heights(DataFile const& file) {
  std::vector<HeightSample> samples;
  read_csv(file, {"x", "y", "z"}, 3, [&](CsvRow const& row) {
    samples.push_back({row.number(0), row.number(1), row.number(2), row.line});
    check_count(file, samples.size());
  });
  return samples;
}

/// The words of an ESRI ASCII grid, with the line for messages.
class AsciiGrid {
 public:
  explicit AsciiGrid(DataFile const& file) : file_(file) {}

  Heights read(Frame const& frame) {
    read_head();
    std::size_t const columns = count("ncols");
    std::size_t const rows = count("nrows");
    check_count(file_, columns * rows);
    double const size = needed("cellsize");
    if (!(size > 0.0)) file_.refuse(line_, fmt::format("cellsize is {:g}; it must be positive", size));
    double const x = corner("xllcorner", "xllcenter", size);
    double const y = corner("yllcorner", "yllcenter", size);
    auto const none = head("nodata_value");
    Heights heights;
    for (std::size_t i = 0; i < columns; ++i)
      heights.x.push_back(frame.point({x + static_cast<double>(i) * size, 0.0, 0.0})[0]);
    for (std::size_t j = 0; j < rows; ++j)
      heights.y.push_back(frame.point({0.0, y + static_cast<double>(j) * size, 0.0})[1]);
    heights.z.resize(columns * rows);
    for (std::size_t j = rows; j-- > 0;) {  // from the north
      for (std::size_t i = 0; i < columns; ++i) {
        double const z = value();
        if (none && z == *none)
          file_.refuse(line_, fmt::format("there is no height at ({:.10g}, {:.10g}): fill the gap",
                                          x + static_cast<double>(i) * size, y + static_cast<double>(j) * size));
        heights.z[j * columns + i] = frame.point({0.0, 0.0, z})[2];
      }
    }
    if (auto const more = word(); !more.empty())
      file_.refuse(line_, fmt::format("{} follows the last of {} x {} heights", shown(more), columns, rows));
    return heights;
  }

 private:
  std::string_view word() {
    std::string_view const text = file_.text;
    constexpr std::string_view blank = " \t\r\n";
    std::size_t const begin = std::min(text.find_first_not_of(blank, at_), text.size());
    line_ += std::count(text.begin() + static_cast<std::ptrdiff_t>(at_),
                        text.begin() + static_cast<std::ptrdiff_t>(begin), '\n');
    at_ = std::min(text.find_first_of(blank, begin), text.size());
    return text.substr(begin, at_ - begin);
  }

  double value() {
    auto const text = word();
    if (text.empty()) file_.refuse(line_, "it ends before the last height; write ncols x nrows of them");
    auto const number = number_of(text);
    if (!number) file_.refuse(line_, fmt::format("{} is no number", shown(text)));
    return *number;
  }

  /// Names and their values, as long as there are names.
  void read_head() {
    for (;;) {
      std::size_t const at = at_;
      long const line = line_;
      std::string name(word());
      if (name.empty() || number_of(name)) {
        at_ = at;
        line_ = line;
        return;
      }
      for (char& c : name) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c | 0x20);
      }
      constexpr std::array names{"ncols",     "nrows",     "cellsize",  "xllcorner",
                                 "xllcenter", "yllcorner", "yllcenter", "nodata_value"};
      if (std::find(names.begin(), names.end(), name) == names.end())
        file_.refuse(line_,
                     fmt::format("{} is no name of the header; allowed: {}", shown(name), fmt::join(names, ", ")));
      head_.emplace_back(name, value());
    }
  }

  [[nodiscard]] std::optional<double> head(std::string_view name) const {
    for (auto const& [known, number] : head_) {
      if (known == name) return number;
    }
    return std::nullopt;
  }
  [[nodiscard]] double needed(std::string_view name) const {
    auto const found = head(name);
    if (!found) file_.refuse(fmt::format("its header lacks {}", name));
    return *found;
  }
  [[nodiscard]] std::size_t count(std::string_view name) const {
    double const n = needed(name);
    if (!(n >= 2.0 && n <= static_cast<double>(most_points)) || n != std::floor(n))
      file_.refuse(fmt::format("{} is {:g}; it must be a whole number from 2 to {}", name, n, most_points));
    return static_cast<std::size_t>(n);
  }
  /// The first point: heights stand for the centres of cells.
  [[nodiscard]] double corner(std::string_view corner_name, std::string_view centre_name, double size) const {
    auto const centre = head(centre_name);
    return centre ? *centre : needed(corner_name) + 0.5 * size;
  }

  DataFile const& file_;
  std::size_t at_ = 0;
  long line_ = 1;
  std::vector<std::pair<std::string, double>> head_;
};

}  // namespace

double Heights::lowest() const { return *std::min_element(z.begin(), z.end()); }

bool Heights::covers(double px, double py) const {
  return px >= x.front() && px <= x.back() && py >= y.front() && py <= y.back();
}

double Heights::over(double px, double py) const {
  std::size_t const i = cell_of(x, px);
  std::size_t const j = cell_of(y, py);
  double const u = (px - x[i]) / (x[i + 1] - x[i]);
  double const v = (py - y[j]) / (y[j + 1] - y[j]);
  double const a = at(i, j);
  double const c = at(i + 1, j + 1);
  if (u >= v) return a + u * (at(i + 1, j) - a) + v * (c - at(i + 1, j));
  return a + v * (at(i, j + 1) - a) + u * (c - at(i, j + 1));
}

double Heights::lowest_between(double x0, double x1, double y0, double y1) const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t j = cell_of(y, y0); j <= cell_of(y, y1) + 1; ++j) {
    for (std::size_t i = cell_of(x, x0); i <= cell_of(x, x1) + 1; ++i) least = std::min(least, at(i, j));
  }
  return least;
}

Heights Heights::reaching(double x0, double x1, double y0, double y1) const {
  Heights wide;
  // The lines, and which of the old ones gives the heights of each.
  auto const widened = [](std::vector<double> const& lines, double from, double to, std::vector<double>& out) {
    std::vector<std::size_t> source;
    auto const add = [&](double at, std::size_t n) {
      out.push_back(at);
      source.push_back(n);
    };
    if (from < lines.front()) add(from, 0);
    for (std::size_t n = 0; n < lines.size(); ++n) add(lines[n], n);
    if (to > lines.back()) add(to, lines.size() - 1);
    return source;
  };
  auto const columns = widened(x, x0, x1, wide.x);
  auto const rows = widened(y, y0, y1, wide.y);
  for (std::size_t const j : rows) {
    for (std::size_t const i : columns) wide.z.push_back(at(i, j));
  }
  return wide;
}

Heights read_heights(std::filesystem::path const& path, Frame const& frame) {
  DataFile const file(path);
  if (file.kind() == ".asc") return AsciiGrid(file).read(frame);
  if (file.kind() == ".csv") return grid_of(file, csv_heights(file), frame);
  if (file.kind() != ".geojson" && file.kind() != ".json")
    file.refuse("a height grid is a file .csv (columns x, y, z), .asc (ESRI ASCII grid) or .geojson (points)");
  auto const samples = geojson_heights(file);
  check_count(file, samples.size());
  return grid_of(file, samples, frame);
}

Heights read_profile(std::filesystem::path const& path, Frame const& frame) {
  DataFile const file(path);
  if (file.kind() != ".csv") file.refuse("the profile of a terrain is a file .csv with the columns x and z");
  std::vector<HeightSample> samples;
  read_csv(file, {"x", "z"}, 2, [&](CsvRow const& row) {
    samples.push_back({row.number(0), 0.0, row.number(1), row.line});
    check_count(file, samples.size());
  });
  if (samples.size() < 2) file.refuse(fmt::format("{} points are no profile; give at least two", samples.size()));
  std::stable_sort(samples.begin(), samples.end(), [](auto const& a, auto const& b) { return a.x < b.x; });
  Heights heights;
  heights.y = {-0.5, 0.5};
  for (std::size_t n = 0; n < samples.size(); ++n) {
    HeightSample const& s = samples[n];
    Vec3 const at = frame.point({s.x, s.z, 0.0});  // two dimensions: heights are y
    if (n > 0 && !(at[0] > heights.x.back())) {
      file.refuse(s.place, fmt::format("x = {:.10g} is there already in line {}; remove one of them", s.x,
                                       samples[n - 1].place));
    }
    heights.x.push_back(at[0]);
    heights.z.push_back(at[1]);
  }
  heights.z.insert(heights.z.end(), heights.z.begin(), heights.z.end());
  return heights;
}

Mesh ground(Heights const& heights, double bottom, std::string const& what) {
  std::size_t const nx = heights.x.size();
  std::size_t const ny = heights.y.size();
  if (!(bottom < heights.lowest())) {
    throw InputError(fmt::format("{}: the bottom at {:g} m is not below the lowest height, {:g} m; lower it", what,
                                 bottom, heights.lowest()));
  }
  Surface surface;
  for (std::size_t j = 0; j < ny; ++j) {
    for (std::size_t i = 0; i < nx; ++i) surface.vertices.push_back({heights.x[i], heights.y[j], heights.at(i, j)});
  }
  auto const top = [&](std::size_t i, std::size_t j) { return static_cast<int>(j * nx + i); };
  for (std::size_t j = 0; j + 1 < ny; ++j) {
    for (std::size_t i = 0; i + 1 < nx; ++i) {
      surface.triangles.push_back({top(i, j), top(i + 1, j), top(i + 1, j + 1)});
      surface.triangles.push_back({top(i, j), top(i + 1, j + 1), top(i, j + 1)});
    }
  }
  // Around the rim anticlockwise: walls down to the bottom, and the bottom from its middle.
  std::vector<int> rim;
  for (std::size_t i = 0; i + 1 < nx; ++i) rim.push_back(top(i, 0));
  for (std::size_t j = 0; j + 1 < ny; ++j) rim.push_back(top(nx - 1, j));
  for (std::size_t i = nx - 1; i > 0; --i) rim.push_back(top(i, ny - 1));
  for (std::size_t j = ny - 1; j > 0; --j) rim.push_back(top(0, j));
  int const below = static_cast<int>(surface.vertices.size());
  int const count = static_cast<int>(rim.size());
  for (int const v : rim) surface.vertices.push_back({surface.vertices[v][0], surface.vertices[v][1], bottom});
  int const middle = static_cast<int>(surface.vertices.size());
  surface.vertices.push_back(
      {0.5 * (heights.x.front() + heights.x.back()), 0.5 * (heights.y.front() + heights.y.back()), bottom});
  for (int n = 0; n < count; ++n) {
    int const next = (n + 1) % count;
    surface.triangles.push_back({rim[n], below + n, below + next});
    surface.triangles.push_back({rim[n], below + next, rim[next]});
    surface.triangles.push_back({middle, below + next, below + n});
  }
  return Mesh::of_shells(std::move(surface), what);
}

}  // namespace brisance::shape
