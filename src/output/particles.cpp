#include "output/particles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "output/dump_file.hpp"
#include "output/file.hpp"
#include "output/folder.hpp"
#include "output/manifest.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

/// Numbers that count, not measure, are written as integers: single precision would round an identity.
bool counts(FieldSpec const& spec) { return spec.name == "body" || spec.name == "material" || spec.name == "identity"; }

int value_bytes(FieldSpec const& spec, bool single_precision) {
  if (counts(spec)) return spec.name == "identity" ? 8 : 4;
  return single_precision ? 4 : 8;
}

NumberType number_type(FieldSpec const& spec, bool single_precision) {
  bool const small = value_bytes(spec, single_precision) == 4;
  if (counts(spec)) return small ? NumberType::int32 : NumberType::int64;
  return small ? NumberType::float32 : NumberType::float64;
}

/// Writes a field chunk by chunk; they are compressed on all threads.
void write_chunks(DumpFile::Dataset const& data, DumpFile::Layout const& layout, std::vector<double> const& values) {
  std::size_t const components = layout.shape.size() > 1 ? layout.shape[1] : 1;
  std::size_t const size = layout.chunk()[0] * components;
  int const count = static_cast<int>((values.size() + size - 1) / size);
  std::vector<std::vector<char>> encoded(count);
  parallel_for(count, [&](int n, int) {
    std::vector<double> chunk(size, 0.0);
    std::size_t const first = size * static_cast<std::size_t>(n);
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(first), std::min(size, values.size() - first),
                chunk.begin());
    encoded[n] = encoded_chunk(chunk, layout.type, layout.compression);
  });
  for (int n = 0; n < count; ++n) {
    std::vector<hsize_t> start(layout.shape.size(), 0);
    start[0] = layout.chunk()[0] * static_cast<hsize_t>(n);
    data.write_chunk(start, encoded[n]);
  }
}

void write_field(DumpFile& file, FieldSpec const& spec, long count, FieldOptions const& options,
                 ParticleValues const& values, std::vector<double>& buffer) {
  constexpr hsize_t chunk = 65536;
  DumpFile::Layout layout;
  layout.shape = {hsize_t(count)};
  layout.edge = {chunk};
  if (spec.components > 1) {
    layout.shape.push_back(hsize_t(spec.components));
    layout.edge.push_back(hsize_t(spec.components));
  }
  layout.type = number_type(spec, options.single_precision);
  layout.compression = count > 0 ? options.compression : 0;
  auto const data = file.dataset(spec.name, layout, spec.unit, spec.meaning);
  buffer.clear();
  values(spec.name, buffer);
  if (buffer.size() != std::size_t(count) * spec.components)
    throw std::logic_error("field \"" + spec.name + "\": wrong number of values");
  if (layout.compression > 0) {
    write_chunks(data, layout, buffer);
  } else if (count > 0) {
    data.write(std::vector<hsize_t>(layout.shape.size(), 0), layout.shape, buffer.data());
  }
}

std::string data_item(std::string const& file, FieldSpec const& spec, long count, bool single_precision) {
  return fmt::format(
      "          <DataItem Dimensions=\"{}{}\" NumberType=\"{}\" Precision=\"{}\" Format=\"HDF\">{}:/points/{}"
      "</DataItem>\n",
      count, spec.components > 1 ? fmt::format(" {}", spec.components) : "", counts(spec) ? "Int" : "Float",
      value_bytes(spec, single_precision), file, spec.name);
}

std::string index_entry(std::string const& file, double time, long count, std::vector<FieldSpec> const& fields,
                        bool single_precision) {
  std::string out =
      fmt::format("      <Grid Name=\"points\" GridType=\"Uniform\">\n        <Time Value=\"{}\"/>\n", time);
  out += fmt::format("        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{}\"/>\n", count);
  for (auto const& field : fields) {
    std::string const item = data_item(file, field, count, single_precision);
    if (field.name == "position") {
      out += "        <Geometry GeometryType=\"XYZ\">\n" + item + "        </Geometry>\n";
      continue;
    }
    out += fmt::format("        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">\n{}        </Attribute>\n",
                       field.name,
                       field.components == 1   ? "Scalar"
                       : field.components == 3 ? "Vector"
                                               : "Matrix",
                       item);
  }
  return out + "      </Grid>\n";
}

}  // namespace

ParticleSeries::ParticleSeries(fs::path folder, FieldOptions options) : folder_(std::move(folder)), options_(options) {}

void ParticleSeries::dump(double time, long step, grid::Geometry geometry, long count,
                          std::vector<FieldSpec> const& fields, ParticleValues const& values) {
  std::string const name = add_dump(folder_, "points", count_, [&](fs::path const& temporary) {
    DumpFile file(std::size_t(bytes_per_dump(static_cast<double>(count), fields, options_.single_precision)), "points");
    file.attribute(file.root(), "time", std::array{time});
    file.attribute(file.root(), "step", std::array{step});
    file.attribute(file.root(), "geometry", word_of(geometry));
    file.attribute(file.root(), "count", std::array{count});
    std::vector<double> buffer;
    for (auto const& field : fields) write_field(file, field, count, options_, values, buffer);
    file.write(temporary);
  });
  // Readers of XDMF cannot take an empty grid: when all particles have left the domain, the index ends before.
  if (count > 0) entries_ += index_entry(name, time, count, fields, options_.single_precision);
  replace_file(folder_ / "points.xmf2", time_series_index(entries_));
  ++count_;
}

void ParticleSeries::archive(Archive& a) {
  a(count_, entries_);
  a.require(count_ >= 0, "the number of dumps");
  if (a.reading()) drop_later_dumps(folder_, "points", count_, entries_);
}

double ParticleSeries::bytes_per_dump(double particles, std::vector<FieldSpec> const& fields, bool single_precision) {
  double bytes = 0.0;
  for (auto const& field : fields) bytes += field.components * value_bytes(field, single_precision);
  return particles * bytes;
}

}  // namespace brisance::output
