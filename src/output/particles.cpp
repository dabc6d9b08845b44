#include "output/particles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/parallel.hpp"
#include "output/dump.hpp"

namespace brisance::output {

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

/// Adds a field to a dump, chunk by chunk.
void gather(Dump& dump, FieldSpec const& spec, long count, FieldOptions const& options, ParticleValues const& values,
            std::vector<double>& buffer) {
  constexpr hsize_t most = 65536;
  DumpFile::Layout layout;
  layout.shape = {hsize_t(count)};
  layout.edge = {most};
  if (spec.components > 1) {
    layout.shape.push_back(hsize_t(spec.components));
    layout.edge.push_back(hsize_t(spec.components));
  }
  layout.type = number_type(spec, options.single_precision);
  layout.compression = count > 0 ? options.compression : 0;
  int const dataset = dump.add_dataset(spec, layout);
  buffer.clear();
  values(spec.name, buffer);
  if (buffer.size() != std::size_t(count) * spec.components)
    throw std::logic_error("field \"" + spec.name + "\": wrong number of values");
  if (count == 0) return;
  std::size_t const size = layout.chunk()[0] * spec.components;
  std::size_t const chunks = (buffer.size() + size - 1) / size;
  std::size_t const first_chunk = dump.add_chunks(chunks);
  parallel_for(static_cast<int>(chunks), [&](int n, int) {
    std::vector<double> chunk(size, 0.0);
    std::size_t const first = size * static_cast<std::size_t>(n);
    std::copy_n(buffer.begin() + static_cast<std::ptrdiff_t>(first), std::min(size, buffer.size() - first),
                chunk.begin());
    std::vector<hsize_t> start(layout.shape.size(), 0);
    start[0] = layout.chunk()[0] * static_cast<hsize_t>(n);
    dump.set_chunk(first_chunk + n, dataset, std::move(start), shuffled(chunk, layout.type));
  });
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

ParticleSeries::ParticleSeries(std::filesystem::path const& folder, FieldOptions options)
    : series_(folder, "points"), options_(options) {}

GatheredDump ParticleSeries::dump(double time, long step, grid::Geometry geometry, long count,
                                  std::vector<FieldSpec> const& fields, ParticleValues const& values) {
  auto dump = std::make_shared<Dump>(
      "points", std::size_t(bytes_per_dump(static_cast<double>(count), fields, options_.single_precision)),
      [time, step, geometry, count](DumpFile& file) {
        file.attribute(file.root(), "time", std::array{time});
        file.attribute(file.root(), "step", std::array{step});
        file.attribute(file.root(), "geometry", word_of(geometry));
        file.attribute(file.root(), "count", std::array{count});
      });
  std::vector<double> buffer;
  for (FieldSpec const& field : fields) gather(*dump, field, count, options_, values, buffer);
  return series_.add(std::move(dump), DumpPlace::next, [&](std::string const& file) {
    // Readers of XDMF cannot take an empty grid: when all particles have left the domain, the index ends before.
    return count > 0 ? index_entry(file, time, count, fields, options_.single_precision) : std::string();
  });
}

double ParticleSeries::bytes_per_dump(double particles, std::vector<FieldSpec> const& fields, bool single_precision) {
  double bytes = 0.0;
  for (auto const& field : fields) bytes += field.components * value_bytes(field, single_precision);
  return particles * bytes;
}

}  // namespace brisance::output
