#include "output/fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

#include "core/parallel.hpp"
#include "output/dump.hpp"
#include "output/level_fields.hpp"

namespace brisance::output {

namespace {

/// Edge of the chunks in a direction: at most `most`, and such that the last one is not much smaller than the others.
hsize_t chunk_edge(int cells, int most) {
  int const chunks = (cells + most - 1) / most;
  return static_cast<hsize_t>((cells + chunks - 1) / chunks);
}

DumpFile::Layout layout_of(FieldSpec const& spec, Index3 const& cells, FieldOptions const& options) {
  int const most = cells[2] > 1 ? 64 : (cells[1] > 1 ? 256 : 65536);
  DumpFile::Layout layout;
  for (int d = 2; d >= 0; --d) {
    layout.shape.push_back(static_cast<hsize_t>(cells[d]));
    layout.edge.push_back(chunk_edge(cells[d], most));
  }
  if (spec.components > 1) {
    layout.shape.push_back(hsize_t(spec.components));
    layout.edge.push_back(hsize_t(spec.components));
  }
  layout.type = options.single_precision ? NumberType::float32 : NumberType::float64;
  layout.compression = options.compression;
  return layout;
}

/// The chunks of each field, x fastest. They may reach beyond the domain.
std::vector<grid::CellRange> chunks_of(Index3 const& cells, DumpFile::Layout const& layout) {
  std::vector<hsize_t> const edges = layout.chunk();
  Index3 const n{int(edges[2]), int(edges[1]), int(edges[0])};
  std::vector<grid::CellRange> chunks;
  for (int k = 0; k < cells[2]; k += n[2]) {
    for (int j = 0; j < cells[1]; j += n[1]) {
      for (int i = 0; i < cells[0]; i += n[0]) chunks.push_back({{i, j, k}, {i + n[0], j + n[1], k + n[2]}});
    }
  }
  return chunks;
}

/// What the fields have in the cells of a chunk, field by field. Beyond the domain it is 0.
std::vector<std::vector<double>> chunk_values(grid::CellRange const& chunk, grid::Grid const& grid,
                                              std::vector<FieldSpec> const& fields, RowValues const& values) {
  std::vector<std::vector<double>> of_field;
  std::size_t components = 0;
  for (FieldSpec const& field : fields) {
    of_field.emplace_back(chunk.count() * field.components, 0.0);
    components += field.components;
  }
  std::vector<double> row(components * chunk.n(0));
  grid::CellRange const inside = grid::common(chunk, {{0, 0, 0}, grid.domain().cells});
  for (int k = inside.lower[2]; k < inside.upper[2]; ++k) {
    for (int j = inside.lower[1]; j < inside.upper[1]; ++j) {
      for (int i = inside.lower[0]; i < inside.upper[0];) {
        grid::Cell const first = grid.locate(Index3{i, j, k});
        grid::Block const& block = grid.block(first);
        int const count = std::min(inside.upper[0] - i, block.n[0] - first.i);
        values(first, count, row.data());
        std::size_t const n =
            (std::size_t(k - chunk.lower[2]) * chunk.n(1) + (j - chunk.lower[1])) * chunk.n(0) + (i - chunk.lower[0]);
        double const* from = row.data();
        for (std::size_t f = 0; f < fields.size(); ++f) {
          int const own = fields[f].components;
          double* const to = of_field[f].data() + n * own;
          for (int cell = 0; cell < count; ++cell) {
            for (int c = 0; c < own; ++c) to[cell * own + c] = from[cell * components + c];
          }
          from += own;
        }
        i += count;
      }
    }
  }
  return of_field;
}

/// Adds the fields to a dump, chunk by chunk.
void gather(Dump& dump, grid::Grid const& grid, std::vector<FieldSpec> const& fields, FieldOptions const& options,
            RowValues const& values) {
  if (fields.empty()) return;
  Index3 const cells = grid.domain().cells;
  for (FieldSpec const& field : fields) dump.add_dataset(field, layout_of(field, cells, options));
  DumpFile::Layout const layout = layout_of(fields.front(), cells, options);  // chunks and type are those of all
  auto const chunks = chunks_of(cells, layout);
  dump.add_chunks(chunks.size() * fields.size());
  parallel_for(static_cast<int>(chunks.size()), [&](int n, int) {
    grid::CellRange const& chunk = chunks[n];
    auto const of_field = chunk_values(chunk, grid, fields, values);
    for (std::size_t f = 0; f < fields.size(); ++f) {
      std::vector<hsize_t> start{hsize_t(chunk.lower[2]), hsize_t(chunk.lower[1]), hsize_t(chunk.lower[0])};
      if (fields[f].components > 1) start.push_back(0);
      dump.set_chunk(n * fields.size() + f, static_cast<int>(f), std::move(start), shuffled(of_field[f], layout.type));
    }
  });
}

/// The index's entry of one dump. XDMF lists the slowest direction first.
std::string index_entry(std::string const& file, double time, grid::Domain const& domain,
                        std::vector<FieldSpec> const& fields, bool single_precision) {
  auto const& n = domain.cells;
  std::string out =
      fmt::format("      <Grid Name=\"cells\" GridType=\"Uniform\">\n        <Time Value=\"{}\"/>\n", time);
  out += fmt::format("        <Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"{} {} {}\"/>\n", n[2] + 1, n[1] + 1,
                     n[0] + 1);
  out += fmt::format(
      "        <Geometry GeometryType=\"ORIGIN_DXDYDZ\">\n"
      "          <DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" Format=\"XML\">{2} {1} "
      "{0}</DataItem>\n"
      "          <DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" Format=\"XML\">{3} {3} "
      "{3}</DataItem>\n"
      "        </Geometry>\n",
      domain.lower[0], domain.lower[1], domain.lower[2], domain.smallest_cell());
  for (auto const& field : fields) {
    bool const vector = field.components == 3;
    out += fmt::format(
        "        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Cell\">\n"
        "          <DataItem Dimensions=\"{} {} {}{}\" NumberType=\"Float\" Precision=\"{}\" Format=\"HDF\">"
        "{}:/cells/{}</DataItem>\n"
        "        </Attribute>\n",
        field.name, vector ? "Vector" : "Scalar", n[2], n[1], n[0], vector ? " 3" : "", single_precision ? 4 : 8, file,
        field.name);
  }
  return out + "      </Grid>\n";
}

}  // namespace

FieldSeries::FieldSeries(std::filesystem::path const& folder, FieldOptions options, DumpForm form)
    : series_(folder, "fields", form), options_(options), form_(form) {}

GatheredDump FieldSeries::dump(double time, long step, grid::Grid const& grid, std::vector<FieldSpec> const& fields,
                               RowValues const& values, DumpPlace place) {
  if (form_ == DumpForm::vtkhdf) {
    return series_.add(level_dump({time, step}, grid, fields, options_, values), place,
                       [time](std::string const& file) { return level_index_entry(file, time); });
  }
  grid::Domain const& domain = grid.domain();
  auto dump = std::make_shared<Dump>(
      "cells", std::size_t(bytes_per_dump(domain, fields, options_.single_precision)),
      [time, step, domain, block = grid.block_size()](DumpFile& file) {
        file.attribute(file.root(), "time", std::array{time});
        file.attribute(file.root(), "step", std::array{step});
        file.attribute(file.root(), "geometry", word_of(domain.geometry));
        file.attribute(file.root(), "origin", domain.lower);
        file.attribute(file.root(), "spacing", std::array{domain.smallest_cell()});
        file.attribute(file.root(), "cells", std::array<long, 3>{domain.cells[0], domain.cells[1], domain.cells[2]});
        file.attribute(file.root(), "block_size", std::array<long, 3>{block[0], block[1], block[2]});
      });
  gather(*dump, grid, fields, options_, values);
  return series_.add(std::move(dump), place, [&](std::string const& file) {
    return index_entry(file, time, domain, fields, options_.single_precision);
  });
}

double FieldSeries::bytes_per_dump(grid::Domain const& domain, std::vector<FieldSpec> const& fields,
                                   bool single_precision) {
  return bytes_per_dump(static_cast<double>(domain.cell_count()), fields, single_precision);
}

double FieldSeries::bytes_per_dump(double cells, std::vector<FieldSpec> const& fields, bool single_precision) {
  double components = 0.0;
  for (auto const& field : fields) components += field.components;
  return cells * components * (single_precision ? 4.0 : 8.0);
}

}  // namespace brisance::output
