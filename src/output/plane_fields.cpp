#include "output/plane_fields.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace brisance::output {

namespace {

constexpr double line_type = 3.0;    // VTK_LINE
constexpr double square_type = 9.0;  // VTK_QUAD

/// Corners of cells in a plane, each once, and the numbers of those of each cell.
struct Mesh {
  std::vector<double> points;        ///< x, y, z of each corner [m]
  std::vector<double> connectivity;  ///< of each cell, going round it
  std::size_t corners = 2;           ///< of a cell
};

/// The directions along the plane.
std::vector<int> directions_in(grid::Domain const& domain, int normal) {
  std::vector<int> along;
  for (int d = 0; d < domain.dimensions(); ++d) {
    if (d != normal) along.push_back(d);
  }
  return along;
}

/// Places of corners are counted in cells of the level `finest`.
Mesh mesh_of(ShownCells const& cells, grid::Domain const& domain, int finest, int normal, double position) {
  using Corner = std::array<int, 2>;
  std::vector<int> const along = directions_in(domain, normal);
  Mesh mesh;
  mesh.corners = std::size_t{1} << along.size();
  std::vector<Corner> all;
  all.reserve(cells.count() * mesh.corners);
  for (CellBox const& box : cells.boxes) {
    for_each_cell(box.cells, [&](Index3 const& index) {
      grid::CellRange const cell{index, {index[0] + 1, index[1] + 1, index[2] + 1}};
      grid::CellRange const fine = observe::on_level(cell, box.level, finest, domain.dimensions());
      int const a = along.front();
      int const b = along.back();
      if (along.size() == 1) {
        all.push_back({fine.lower[a], 0});
        all.push_back({fine.upper[a], 0});
      } else {
        all.push_back({fine.lower[a], fine.lower[b]});
        all.push_back({fine.upper[a], fine.lower[b]});
        all.push_back({fine.upper[a], fine.upper[b]});
        all.push_back({fine.lower[a], fine.upper[b]});
      }
    });
  }
  std::vector<Corner> own = all;
  std::ranges::sort(own);
  own.erase(std::unique(own.begin(), own.end()), own.end());
  grid::Domain const places = observe::with_level(domain, finest);
  for (Corner const& corner : own) {
    Vec3 x = domain.lower;
    x[normal] = position;
    for (std::size_t n = 0; n < along.size(); ++n) x[along[n]] = places.face(along[n], corner[n]);
    mesh.points.insert(mesh.points.end(), x.begin(), x.end());
  }
  mesh.connectivity.reserve(all.size());
  for (Corner const& corner : all)
    mesh.connectivity.push_back(static_cast<double>(std::ranges::lower_bound(own, corner) - own.begin()));
  return mesh;
}

void gather_mesh(Dump& dump, Mesh const& mesh) {
  std::size_t const cells = mesh.connectivity.size() / mesh.corners;
  std::size_t const points = mesh.points.size() / 3;
  auto const number = [&](char const* name, double value, char const* meaning) {
    gather_table(dump, {name, "1", 1, meaning}, {value}, NumberType::int64);
  };
  number("NumberOfPoints", static_cast<double>(points), "corners of cells");
  number("NumberOfCells", static_cast<double>(cells), "cells that the plane cuts");
  number("NumberOfConnectivityIds", static_cast<double>(mesh.connectivity.size()), "elements of Connectivity");
  std::vector<double> offsets;
  for (std::size_t n = 0; n <= cells; ++n) offsets.push_back(static_cast<double>(n * mesh.corners));
  gather_table(dump, {"Points", "m", 3, "corners of cells"}, mesh.points, NumberType::float64);
  gather_table(dump, {"Connectivity", "1", 1, "numbers of the corners of each cell, going round it"}, mesh.connectivity,
               NumberType::int64);
  gather_table(dump, {"Offsets", "1", 1, "where the corners of each cell begin in Connectivity"}, offsets,
               NumberType::int64);
  gather_table(dump, {"Types", "1", 1, "3: line, 9: square"},
               std::vector<double>(cells, mesh.corners == 2 ? line_type : square_type), NumberType::uint8);
}

}  // namespace

std::shared_ptr<Dump> plane_dump(DumpMoment const& moment, grid::Grid const& grid, observe::SubsetCells const& plane,
                                 double position, std::vector<FieldSpec> const& fields, FieldOptions const& options,
                                 RowValues const& values) {
  grid::Domain const domain = grid.domain();
  ShownCells cells;
  for (ShownCells const& level : leaves_of(grid, plane)) {
    for (CellBox const& box : level.boxes) cells.add(box);
  }
  auto const count = static_cast<double>(cells.count());
  double const bytes = FieldSeries::bytes_per_dump(count, fields, options.single_precision) +
                       count * plane_bytes_per_cell(domain.dimensions());
  long const normal = plane.normal();
  auto dump = std::make_shared<Dump>("VTKHDF", std::size_t(bytes), [moment, domain, normal, position](DumpFile& file) {
    describe(file, moment, domain, "UnstructuredGrid");
    file.attribute(file.root(), "normal", std::array{normal});
    file.attribute(file.root(), "position", std::array{position});
    for (char const* data : {"CellData", "PointData", "FieldData"}) (void)file.add_group(data);
  });
  gather_mesh(*dump, mesh_of(cells, domain, plane.finest(), plane.normal(), position));
  gather_fields(*dump, "CellData", cells, grid, fields, options, values);
  return dump;
}

double plane_bytes_per_cell(int dimensions) {
  constexpr double whole_number = 8.0;
  constexpr double point = 24.0;
  double const corners = dimensions == 3 ? 4.0 : 2.0;
  return point + (corners + 1.0) * whole_number + 1.0;  // about one corner per cell; a byte tells its type
}

}  // namespace brisance::output
