/// Gauges: linear interpolation between cell centres, so that a gauge between two cells sees the shock between their
/// times. Gauges of the material points ride on the point itself.
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/timer.hpp"
#include "observe/gas_view.hpp"
#include "observe/point_fields.hpp"
#include "run/world.hpp"

namespace brisance::run {

namespace {

struct Stencil {
  std::vector<Index3> cells;
  std::vector<double> weights;
};

/// The cells around x and their weights; beyond the last cell centre the nearest cell counts alone.
Stencil stencil_at(grid::Domain const& domain, Vec3 const& x) {
  Stencil s;
  int const dims = domain.dimensions();
  Index3 low{0, 0, 0};
  Vec3 part{0.0, 0.0, 0.0};
  for (int d = 0; d < dims; ++d) {
    double const position =
        std::clamp((x[d] - domain.lower[d]) / domain.h - 0.5, 0.0, static_cast<double>(domain.cells[d] - 1));
    low[d] = std::min(static_cast<int>(position), domain.cells[d] - 2);
    part[d] = position - low[d];
  }
  for (int corner = 0; corner < 1 << dims; ++corner) {
    Index3 cell = low;
    double weight = 1.0;
    for (int d = 0; d < dims; ++d) {
      int const up = corner >> d & 1;
      cell[d] += up;
      weight *= up ? part[d] : 1.0 - part[d];
    }
    if (weight <= 0.0) continue;
    s.cells.push_back(cell);
    s.weights.push_back(weight);
  }
  return s;
}

}  // namespace

namespace {

Vec3 vector_at(mpm::PointSet const& set, mpm::Field first, int point) {
  Vec3 v{0.0, 0.0, 0.0};
  for (int d = 0; d < 3; ++d) v[d] = set.field(first + d)[point];
  return v;
}

double value_at(mpm::PointSet const& set, mpm::Field field, int point) {
  double const* const values = set.field(field);
  return values == nullptr ? 0.0 : values[point];
}

PointRecord record_of(mpm::PointSet const& set, int q, double time) {
  PointRecord r;
  r.time = time;
  r.position = vector_at(set, mpm::Field::position_x, q);
  r.velocity = vector_at(set, mpm::Field::velocity_x, q);
  r.pressure = value_at(set, mpm::Field::pressure, q);
  r.mises = observe::mises_of(set, q);
  r.density = value_at(set, mpm::Field::density, q);
  r.plastic_strain = value_at(set, mpm::Field::plastic_strain, q);
  r.temperature = value_at(set, mpm::Field::temperature, q);
  r.damage = value_at(set, mpm::Field::damage, q);
  return r;
}

constexpr double body_records = 1000.0;  // of a run, about

}  // namespace

void World::sample_points() {
  int const count = static_cast<int>(bodies.size());
  double const interval = setup.end.time / body_records;
  body_histories.resize(bodies.size());
  double const last = body_histories[0].empty() ? -1.0 : body_histories[0].back().time;
  bool const due = last < 0.0 || (clock.time > last && (finished() || clock.time >= last + interval * (1.0 - 1e-9)));
  // The sums of a body are taken once, whoever asks for them.
  std::vector<std::optional<mpm::BodySums>> sums(bodies.size());
  auto const sums_of = [&](int body) -> mpm::BodySums const& {
    if (!sums[body]) sums[body] = points->sums(body);
    return *sums[body];
  };
  for (int body = 0; due && body < count; ++body) body_histories[body].push_back({clock.time, sums_of(body)});
  for (PointGaugeHistory& history : point_gauges) {
    int const body = history.gauge.body;
    if (!history.gauge.point) {
      history.bodies.push_back({clock.time, sums_of(body)});
      continue;
    }
    if (history.lost) continue;
    history.place = points->find(body, history.identity, history.place);
    if (history.place.block < 0) {
      history.lost = true;
      continue;
    }
    PointRecord record = record_of(points->points(history.place.block, body), history.place.index, clock.time);
    // Also of points that do not carry their origin: the gauge has seen it.
    if (!history.points.empty()) record.displacement = record.position - history.points.front().position;
    history.points.push_back(record);
  }
}

void World::record_bodies() {
  if (points == nullptr || body_histories.empty() || body_histories[0].back().time >= clock.time) return;
  for (std::size_t body = 0; body < body_histories.size(); ++body)
    body_histories[body].push_back({clock.time, points->sums(static_cast<int>(body))});
}

void World::sample_gauges() {
  if (gauges.empty() && points == nullptr) return;
  PhaseTimer const timer(timings["gauges"]);
  if (points != nullptr) sample_points();
  if (gauges.empty()) return;
  if (gauge_view_ == nullptr) {
    std::vector<Index3> cells;
    for (GaugeHistory const& history : gauges) {
      Stencil const s = stencil_at(setup.domain, history.gauge.position);
      cells.insert(cells.end(), s.cells.begin(), s.cells.end());
    }
    gauge_view_ = std::make_unique<observe::GasView>(*this, cells);
  }
  gauge_view_->update();
  for (GaugeHistory& history : gauges) {
    Stencil const s = stencil_at(setup.domain, history.gauge.position);
    GaugeRecord record;
    record.time = clock.time;
    double sum = 0.0;
    for (std::size_t n = 0; n < s.cells.size(); ++n) {
      auto const seen = gauge_view_->at(s.cells[n]);
      if (!seen) continue;
      double const weight = s.weights[n];
      sum += weight;
      record.pressure += weight * seen->state.pressure;
      record.density += weight * seen->state.density;
      record.velocity = record.velocity + weight * seen->state.velocity;
    }
    if (sum > 0.0) {
      record.pressure /= sum;
      record.density /= sum;
      record.velocity = (1.0 / sum) * record.velocity;
    } else {
      record.pressure = setup.ambient.state.pressure;  // a body has come over the gauge
    }
    history.records.push_back(record);
  }
}

}  // namespace brisance::run
