/// Columns of the files of gauges: what each is called and how it is found. A new quantity is one row of a table in
/// gauge_columns.cpp.
#pragma once

#include <fmt/format.h>

#include <string>
#include <variant>
#include <vector>

#include "material/primitive.hpp"
#include "observe/gauges.hpp"

namespace brisance::observe {

/// A scalar, or a vector with the columns NAME_x, NAME_y and NAME_z. `Moment`: one record of a gauge; `State`: what the
/// gauge sees at that time.
template <class Moment, class... State>
struct GaugeColumn {
  using Scalar = double (*)(Moment const& moment);
  using Vector = Vec3 (*)(Moment const& moment);
  /// Found when the gauge is sampled and kept beside its record: for what no record holds.
  using Sampled = double (*)(State... state);

  char const* name;  ///< "": a position, with the columns x, y and z
  char const* unit;
  std::variant<Scalar, Vector, Sampled> value;
};

/// One record of a gauge in the gas.
struct GasMoment {
  GaugeRecord const& record;
  double ambient_pressure;  ///< [Pa]
  double impulse;           ///< integral of the overpressure so far [Pa s]
  double const* sampled;    ///< of the columns that are sampled
};
/// One record of a gauge on a particle.
struct ParticleMoment {
  ParticleRecord const& record;
  double const* sampled;
};
/// One record of a gauge on a body.
struct BodyMoment {
  mpm::BodySums const& sums;
  double const* sampled = nullptr;
};

/// `Sampled` is interpolated between the cells around the gauge; where there is no gas it is 0.
using GasColumn = GaugeColumn<GasMoment, material::Primitive const&>;
using ParticleColumn = GaugeColumn<ParticleMoment, mpm::ParticleSet const&, int>;
using BodyColumn = GaugeColumn<BodyMoment>;

/// The columns behind the time, in the order of the files.
[[nodiscard]] std::vector<GasColumn> const& gas_columns();
[[nodiscard]] std::vector<ParticleColumn> const& particle_columns();
[[nodiscard]] std::vector<BodyColumn> const& body_columns();

/// How many of the columns are sampled.
template <class Column>
[[nodiscard]] std::size_t sampled_columns(std::vector<Column> const& columns) {
  std::size_t count = 0;
  for (Column const& column : columns) count += std::holds_alternative<typename Column::Sampled>(column.value) ? 1 : 0;
  return count;
}

/// The line of names and units: "time [s],pressure [Pa],...", with the end of the line.
template <class Column>
[[nodiscard]] std::string header_of(std::vector<Column> const& columns) {
  std::string text = "time [s]";
  for (Column const& column : columns) {
    std::string const name = column.name;
    if (!std::holds_alternative<typename Column::Vector>(column.value)) {
      text += fmt::format(",{} [{}]", name, column.unit);
      continue;
    }
    for (char const axis : {'x', 'y', 'z'}) {
      text += fmt::format(",{}{} [{}]", name.empty() ? "" : name + "_", axis, column.unit);
    }
  }
  return text + "\n";
}

/// The values of a record in the columns, as a line.
template <class Column, class Moment>
[[nodiscard]] std::string row_of(std::vector<Column> const& columns, double time, Moment const& moment) {
  std::string text = fmt::format("{:.10g}", time);
  auto const add = [&text](double value) { fmt::format_to(std::back_inserter(text), ",{:.10g}", value); };
  double const* sampled = moment.sampled;
  for (Column const& column : columns) {
    if (auto const* scalar = std::get_if<typename Column::Scalar>(&column.value)) {
      add((*scalar)(moment));
    } else if (auto const* vector = std::get_if<typename Column::Vector>(&column.value)) {
      for (double const component : (*vector)(moment)) add(component);
    } else {
      add(*sampled++);
    }
  }
  return text + "\n";
}

}  // namespace brisance::observe
