#include "output/fields.hpp"

#include <fmt/format.h>

#include <array>
#include <stdexcept>

#include "core/error.hpp"
#include "output/dump_file.hpp"
#include "output/file.hpp"
#include "output/folder.hpp"
#include "output/manifest.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

void write_field(DumpFile& file, FieldSpec const& spec, grid::Grid const& grid, FieldOptions const& options,
                 BlockValues const& values) {
  auto const& cells = grid.domain().cells;
  hsize_t const edge = cells[2] > 1 ? 64 : (cells[1] > 1 ? 256 : 65536);
  DumpFile::Layout layout;
  layout.shape = {hsize_t(cells[2]), hsize_t(cells[1]), hsize_t(cells[0])};
  layout.edge = {edge, edge, edge};
  if (spec.components > 1) {
    layout.shape.push_back(hsize_t(spec.components));
    layout.edge.push_back(hsize_t(spec.components));
  }
  layout.type = options.single_precision ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
  layout.compression = options.compression;
  auto const data = file.dataset(spec.name, layout, spec.unit, spec.meaning);

  std::vector<double> buffer;
  for (int b = 0; b < grid.block_count(); ++b) {
    auto const& block = grid.blocks()[b];
    buffer.clear();
    values(b, spec.name, buffer);
    if (buffer.size() != std::size_t(block.cell_count()) * spec.components)
      throw std::logic_error("field \"" + spec.name + "\": wrong number of values in a block");
    auto const& o = block.origin;
    auto const& n = block.n;
    std::vector<hsize_t> start{hsize_t(o[2]), hsize_t(o[1]), hsize_t(o[0])};
    std::vector<hsize_t> count{hsize_t(n[2]), hsize_t(n[1]), hsize_t(n[0])};
    if (spec.components > 1) {
      start.push_back(0);
      count.push_back(hsize_t(spec.components));
    }
    data.write(start, count, buffer.data());
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
                       BlockValues const& values) {
  make_folder(folder_ / "fields");
  std::string const name = dump_name("fields", count_);
  list_files(folder_, {name});
  fs::path const temporary = folder_ / (name + ".part");
  auto const& domain = grid.domain();
  QuietHdf5 const quiet;
  try {
    DumpFile file(std::size_t(bytes_per_dump(domain, fields, options_.single_precision)), "cells");
    file.attribute(file.root(), "time", std::array{time});
    file.attribute(file.root(), "step", std::array{step});
    file.attribute(file.root(), "geometry", word_of(domain.geometry));
    file.attribute(file.root(), "origin", domain.lower);
    file.attribute(file.root(), "spacing", std::array{domain.smallest_cell()});
    file.attribute(file.root(), "cells", std::array<long, 3>{domain.cells[0], domain.cells[1], domain.cells[2]});
    for (auto const& field : fields) write_field(file, field, grid, options_, values);
    file.write(temporary);
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
  rename_file(temporary, folder_ / name);
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
