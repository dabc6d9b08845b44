#include "output/fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "output/dump_file.hpp"
#include "output/file.hpp"
#include "output/folder.hpp"
#include "output/manifest.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

DumpFile::Layout layout_of(FieldSpec const& spec, Index3 const& cells, FieldOptions const& options) {
  hsize_t const edge = cells[2] > 1 ? 64 : (cells[1] > 1 ? 256 : 65536);
  DumpFile::Layout layout;
  layout.shape = {hsize_t(cells[2]), hsize_t(cells[1]), hsize_t(cells[0])};
  layout.edge = {edge, edge, edge};
  if (spec.components > 1) {
    layout.shape.push_back(hsize_t(spec.components));
    layout.edge.push_back(hsize_t(spec.components));
  }
  layout.type = options.single_precision ? NumberType::float32 : NumberType::float64;
  layout.compression = options.compression;
  return layout;
}

/// Parts of the domain that are written at a time, x fastest: a chunk of each field, which may reach beyond the domain,
/// or without compression what of it lies within.
std::vector<grid::CellRange> chunks_of(Index3 const& cells, DumpFile::Layout const& layout) {
  std::vector<hsize_t> const edges = layout.chunk();
  Index3 const n{int(edges[2]), int(edges[1]), int(edges[0])};
  std::vector<grid::CellRange> chunks;
  for (int k = 0; k < cells[2]; k += n[2]) {
    for (int j = 0; j < cells[1]; j += n[1]) {
      for (int i = 0; i < cells[0]; i += n[0]) chunks.push_back({{i, j, k}, {i + n[0], j + n[1], k + n[2]}});
    }
  }
  if (layout.compression == 0) {
    for (grid::CellRange& chunk : chunks) chunk = grid::common(chunk, {{0, 0, 0}, cells});
  }
  return chunks;
}

/// What the fields have in the cells of a chunk.
class ChunkValues {
 public:
  /// Beyond the domain the values are 0.
  ChunkValues(grid::CellRange const& chunk, grid::Grid const& grid, std::vector<FieldSpec> const& fields,
              CellValues const& values) {
    std::size_t const cells = chunk.count();
    std::size_t components = 0;
    for (FieldSpec const& field : fields) {
      of_field_.emplace_back(cells * field.components, 0.0);
      components += field.components;
    }
    std::vector<double> all(components);
    Index3 const domain = grid.domain().cells;
    for (std::size_t n = 0; n < cells; ++n) {
      Index3 const cell = chunk.at(n);
      if (cell[0] >= domain[0] || cell[1] >= domain[1] || cell[2] >= domain[2]) continue;
      values(grid.locate(cell), all.data());
      double const* from = all.data();
      for (std::size_t f = 0; f < fields.size(); ++f) {
        int const count = fields[f].components;
        std::copy_n(from, count, of_field_[f].begin() + static_cast<std::ptrdiff_t>(n * count));
        from += count;
      }
    }
  }
  [[nodiscard]] std::vector<double> const& of_field(std::size_t number) const { return of_field_[number]; }

 private:
  std::vector<std::vector<double>> of_field_;
};

/// The fields, chunk by chunk: values and their compression on all threads, the HDF5 library on this one.
void write_fields(DumpFile& file, grid::Grid const& grid, std::vector<FieldSpec> const& fields,
                  FieldOptions const& options, CellValues const& values) {
  Index3 const cells = grid.domain().cells;
  std::vector<DumpFile::Dataset> datasets;
  datasets.reserve(fields.size());
  for (FieldSpec const& field : fields)
    datasets.push_back(file.dataset(field.name, layout_of(field, cells, options), field.unit, field.meaning));
  if (fields.empty()) return;
  DumpFile::Layout const layout = layout_of(fields.front(), cells, options);  // chunks, type and level are those of all
  auto const chunks = chunks_of(cells, layout);
  int const total = static_cast<int>(chunks.size());
  int const together = 2 * threads();  // so many at a time bound the memory
  for (int first = 0; first < total; first += together) {
    int const count = std::min(together, total - first);
    std::vector<std::vector<std::vector<char>>> encoded(count);
    std::vector<std::unique_ptr<ChunkValues>> plain(count);
    parallel_for(count, [&](int n, int) {
      auto chunk = std::make_unique<ChunkValues>(chunks[first + n], grid, fields, values);
      if (layout.compression == 0) {
        plain[n] = std::move(chunk);
        return;
      }
      for (std::size_t f = 0; f < fields.size(); ++f) {
        encoded[n].push_back(encoded_chunk(chunk->of_field(f), layout.type, layout.compression));
      }
    });
    for (int n = 0; n < count; ++n) {
      grid::CellRange const& chunk = chunks[first + n];
      for (std::size_t f = 0; f < fields.size(); ++f) {
        std::vector<hsize_t> start{hsize_t(chunk.lower[2]), hsize_t(chunk.lower[1]), hsize_t(chunk.lower[0])};
        if (fields[f].components > 1) start.push_back(0);
        if (layout.compression > 0) {
          datasets[f].write_chunk(start, encoded[n][f]);
        } else {
          std::vector<hsize_t> extent{hsize_t(chunk.n(2)), hsize_t(chunk.n(1)), hsize_t(chunk.n(0))};
          if (fields[f].components > 1) extent.push_back(hsize_t(fields[f].components));
          datasets[f].write(start, extent, plain[n]->of_field(f).data());
        }
      }
    }
  }
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

std::string time_series_index(std::string const& entries) {
  return "<?xml version=\"1.0\"?>\n"
         "<Xdmf Version=\"2.0\">\n"
         "  <Domain>\n"
         "    <Grid Name=\"series\" GridType=\"Collection\" CollectionType=\"Temporal\">\n" +
         entries + "    </Grid>\n  </Domain>\n</Xdmf>\n";
}

std::string add_dump(fs::path const& folder, std::string const& kind, int number,
                     std::function<void(fs::path const& temporary)> const& write) {
  make_folder(folder / kind);
  std::string name = dump_name(kind, number);
  list_files(folder, {name});
  fs::path const temporary = folder / (name + ".part");
  QuietHdf5 const quiet;
  try {
    write(temporary);
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
  rename_file(temporary, folder / name);
  return name;
}

void drop_later_dumps(fs::path const& folder, std::string const& kind, int count, std::string const& entries) {
  for (auto const& name : listed_files(folder)) {
    auto const number = dump_number(kind, name);
    if (number && *number >= count) remove_listed(folder, name);
  }
  fs::path const index = folder / (kind + ".xmf2");
  if (count > 0) {
    replace_file(index, time_series_index(entries));
  } else {
    remove_listed(folder, kind + ".xmf2");
  }
}

FieldSeries::FieldSeries(fs::path folder, FieldOptions options) : folder_(std::move(folder)), options_(options) {}

void FieldSeries::dump(double time, long step, grid::Grid const& grid, std::vector<FieldSpec> const& fields,
                       CellValues const& values) {
  auto const& domain = grid.domain();
  std::string const name = add_dump(folder_, "fields", count_, [&](fs::path const& temporary) {
    DumpFile file(std::size_t(bytes_per_dump(domain, fields, options_.single_precision)), "cells");
    file.attribute(file.root(), "time", std::array{time});
    file.attribute(file.root(), "step", std::array{step});
    file.attribute(file.root(), "geometry", word_of(domain.geometry));
    file.attribute(file.root(), "origin", domain.lower);
    file.attribute(file.root(), "spacing", std::array{domain.smallest_cell()});
    file.attribute(file.root(), "cells", std::array<long, 3>{domain.cells[0], domain.cells[1], domain.cells[2]});
    write_fields(file, grid, fields, options_, values);
    file.write(temporary);
  });
  entries_ += index_entry(name, time, domain, fields, options_.single_precision);
  replace_file(folder_ / "fields.xmf2", time_series_index(entries_));
  ++count_;
}

void FieldSeries::archive(Archive& a) {
  a(count_, entries_);
  a.require(count_ >= 0, "the number of dumps");
  if (a.reading()) drop_later_dumps(folder_, "fields", count_, entries_);
}

double FieldSeries::bytes_per_dump(grid::Domain const& domain, std::vector<FieldSpec> const& fields,
                                   bool single_precision) {
  double components = 0.0;
  for (auto const& field : fields) components += field.components;
  return static_cast<double>(domain.cell_count()) * components * (single_precision ? 4.0 : 8.0);
}

}  // namespace brisance::output
