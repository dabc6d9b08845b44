/// Gauges: linear interpolation between cell centres, so that a gauge between two cells sees the shock between their
/// times. A gauge lies in a leaf of some level and sees cells of that level; where there are none, beside coarser
/// leaves, their values are interpolated in the same way between cells of the level below. Gauges of the material
/// points ride on the particle itself.
#include "observe/gauges.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/archive.hpp"
#include "core/timer.hpp"
#include "observe/gas_view.hpp"
#include "observe/gauge_columns.hpp"
#include "observe/particle_fields.hpp"
#include "run/system.hpp"

namespace brisance::observe {

/// Cells and their weights.
struct Stencil {
  std::vector<PlacedCell> cells;
  std::vector<double> weights;
};

namespace {

/// Adds the cells of a level around x with their weights, all times `whole`; beyond the last cell centre of the domain
/// the nearest cell counts alone. A cell that the level does not have is in turn replaced by those of the level below
/// around its centre. Those are there: the coarser leaf that holds it touches the leaf of x, and where that leaf's
/// neighbours are finer, covered blocks lie below them.
void add_cells_around(grid::Grid const& grid, int level, Vec3 const& x, double whole, Stencil& s) {
  grid::Domain const& domain = grid.domain(level);
  int const dims = domain.dimensions();
  Index3 low{0, 0, 0};
  Vec3 part{0.0, 0.0, 0.0};
  for (int d = 0; d < dims; ++d) {
    double const position = std::clamp(domain.in_cells(d, x[d]) - 0.5, 0.0, static_cast<double>(domain.cells[d] - 1));
    low[d] = std::min(static_cast<int>(position), domain.cells[d] - 2);
    part[d] = position - low[d];
  }
  for (int corner = 0; corner < 1 << dims; ++corner) {
    Index3 cell = low;
    double weight = whole;
    for (int d = 0; d < dims; ++d) {
      int const up = corner >> d & 1;
      cell[d] += up;
      weight *= up ? part[d] : 1.0 - part[d];
    }
    if (weight <= 0.0) continue;
    if (level > 0 && !grid.locate(level, cell)) {
      add_cells_around(grid, level - 1, domain.centre(cell), weight, s);
      continue;
    }
    s.cells.push_back({level, cell});
    s.weights.push_back(weight);
  }
}

Stencil stencil_at(grid::Grid const& grid, Vec3 const& x) {
  Stencil s;
  add_cells_around(grid, grid.block(grid.locate(x)).level, x, 1.0, s);
  return s;
}

Vec3 vector_at(mpm::ParticleSet const& set, mpm::Field first, int particle) {
  Vec3 v{0.0, 0.0, 0.0};
  for (int d = 0; d < 3; ++d) v[d] = set.field(first + d)[particle];
  return v;
}

double value_at(mpm::ParticleSet const& set, mpm::Field field, int particle) {
  double const* const values = set.field(field);
  return values == nullptr ? 0.0 : values[particle];
}

ParticleRecord record_of(mpm::ParticleSet const& set, int q, double time) {
  ParticleRecord r;
  r.time = time;
  r.position = vector_at(set, mpm::Field::position_x, q);
  r.velocity = vector_at(set, mpm::Field::velocity_x, q);
  r.pressure = value_at(set, mpm::Field::pressure, q);
  r.mises = mises_of(set, q);
  r.density = value_at(set, mpm::Field::density, q);
  r.plastic_strain = value_at(set, mpm::Field::plastic_strain, q);
  r.temperature = value_at(set, mpm::Field::temperature, q);
  r.damage = value_at(set, mpm::Field::damage, q);
  return r;
}

/// Calls use(n, of) for the columns that are sampled, n counts them.
template <class Column, class Use>
void for_each_sampled(std::vector<Column> const& columns, Use const& use) {
  std::size_t n = 0;
  for (Column const& column : columns) {
    if (auto const* of = std::get_if<typename Column::Sampled>(&column.value)) use(n++, *of);
  }
}

/// What a checkpoint holds of sampled columns: nothing where there are none.
template <class Column, class Record>
void archive_sampled(Archive& a, std::vector<Column> const& columns, std::vector<Record> const& records,
                     std::vector<double>& sampled) {
  std::size_t const count = sampled_columns(columns);
  if (count == 0) return;
  a(sampled);
  a.require(sampled.size() == count * records.size(), "the sampled columns of a gauge");
}

constexpr double body_records = 1000.0;  // of a run, about

}  // namespace

Gauges::Gauges(run::System const& system) {
  Case const& setup = system.setup;
  if (system.gas != nullptr) {
    for (Gauge const& gauge : setup.gauges) gas.push_back({gauge, {}, {}});
    Primitive const& quiet = setup.ambient.state;
    // As a cell of it is read, with its sound speed and energy.
    gas::Fluids const& fluids = system.gas->fluids();
    Primitive const read = gas::primitive_of(fluids, gas::conserved_of(fluids, quiet).data(), 1.0);
    for (GaugeHistory& history : gas) {
      if (!setup.start.remap || setup.start.from_checkpoint) break;
      history.records.push_back({0.0, quiet.pressure, quiet.density, quiet.velocity});
      for_each_sampled(gas_columns(), [&](std::size_t, auto of) { history.sampled.push_back(of(read)); });
    }
  }
  if (system.regions.empty()) return;
  for (ParticleGauge const& gauge : setup.particles.gauges) {
    ParticleGaugeHistory history;
    history.gauge = gauge;
    run::BodyPlace const at = system.place_of(gauge.body);
    if (gauge.point) history.identity = mpm::nearest(*system.regions[at.region].particles, at.body, *gauge.point);
    particles.push_back(std::move(history));
  }
}

Gauges::~Gauges() = default;

void Gauges::sample(run::System& system) {
  if (gas.empty() && system.regions.empty()) return;
  PhaseTimer const timer(system.timings["gauges"]);
  if (!system.regions.empty()) sample_particles(system);
  if (!gas.empty()) sample_gas(system);
}

void Gauges::find_stencils(run::System const& system) {
  long const changes = system.adaptation == nullptr ? 0 : system.adaptation->changes();
  if (view_ != nullptr && changes == changes_) return;
  changes_ = changes;
  stencils_.clear();
  std::vector<PlacedCell> seen;
  for (GaugeHistory const& history : gas) {
    Stencil const& s = stencils_.emplace_back(stencil_at(system.grid, history.gauge.position));
    seen.insert(seen.end(), s.cells.begin(), s.cells.end());
  }
  view_ = std::make_unique<GasView>(system, seen);
}

void Gauges::sample_gas(run::System const& system) {
  find_stencils(system);
  view_->update();
  for (std::size_t g = 0; g < gas.size(); ++g) sample_gauge(system, g, system.clock.time);
}

void Gauges::sample_level(run::System& system, int level, double time) {
  if (gas.empty() || level == 0 || system.setup.output.gauge_interval > 0.0) return;
  PhaseTimer const timer(system.timings["gauges"]);
  find_stencils(system);
  bool updated = false;
  for (std::size_t g = 0; g < gas.size(); ++g) {
    std::vector<PlacedCell> const& cells = stencils_[g].cells;
    auto const of_level = [level](PlacedCell const& cell) { return cell.level == level; };
    if (!std::all_of(cells.begin(), cells.end(), of_level)) continue;
    auto const in_particles = [this](PlacedCell const& cell) { return view_->in_particles(cell); };
    if (!updated && std::any_of(cells.begin(), cells.end(), in_particles)) {
      view_->update();
      updated = true;
    }
    sample_gauge(system, g, time);
  }
}

void Gauges::sample_gauge(run::System const& system, std::size_t number, double time) {
  GaugeHistory& history = gas[number];
  Stencil const& s = stencils_[number];
  GaugeRecord record;
  record.time = time;
  double sum = 0.0;
  std::vector<double> sampled(sampled_columns(gas_columns()), 0.0);
  for (std::size_t n = 0; n < s.cells.size(); ++n) {
    auto const seen = view_->at(s.cells[n]);
    if (!seen) continue;
    double const weight = s.weights[n];
    sum += weight;
    record.pressure += weight * seen->pressure;
    record.density += weight * seen->density;
    record.velocity = record.velocity + weight * seen->velocity;
    for_each_sampled(gas_columns(), [&](std::size_t c, auto of) { sampled[c] += weight * of(*seen); });
  }
  if (sum > 0.0) {
    record.pressure /= sum;
    record.density /= sum;
    record.velocity = (1.0 / sum) * record.velocity;
  } else {
    record.pressure = system.setup.ambient.state.pressure;  // a body has come over the gauge
  }
  // The last step of a level ends with that of the whole, maybe in another last digit: what is known last counts.
  bool const again =
      system.adaptation != nullptr && !history.records.empty() && time <= history.records.back().time * (1.0 + 1e-14);
  if (again) {
    history.records.pop_back();
    history.sampled.resize(history.sampled.size() - sampled.size());
  }
  history.records.push_back(record);
  for (double const value : sampled) history.sampled.push_back(sum > 0.0 ? value / sum : 0.0);
}

void Gauges::sample_particles(run::System const& system) {
  int const count = static_cast<int>(system.bodies.size());
  double const interval = system.setup.end.time / body_records;
  double const now = system.clock.time;
  bodies.resize(system.bodies.size());
  double const last = bodies[0].empty() ? -1.0 : bodies[0].back().time;
  bool const due = last < 0.0 || (now > last && (system.finished() || now >= last + interval * (1.0 - 1e-9)));
  // The sums of a body are taken once, whoever asks for them.
  std::vector<std::optional<mpm::BodySums>> sums(bodies.size());
  auto const sums_of = [&](int body) -> mpm::BodySums const& {
    if (!sums[body]) sums[body] = system.sums(body);
    return *sums[body];
  };
  for (int body = 0; due && body < count; ++body) bodies[body].push_back({now, sums_of(body)});
  for (ParticleGaugeHistory& history : particles) {
    int const body = history.gauge.body;
    if (!history.gauge.point) {
      history.bodies.push_back({now, sums_of(body)});
      continue;
    }
    if (history.lost) continue;
    run::BodyPlace const at = system.place_of(body);
    mpm::Mpm const& all = *system.regions[at.region].particles;
    history.place = mpm::find(all, at.body, history.identity, history.place);
    if (history.place.block < 0) {
      history.lost = true;
      continue;
    }
    mpm::ParticleSet const& set = all.particles(history.place.block, at.body);
    ParticleRecord record = record_of(set, history.place.index, now);
    // Also of particles that do not carry their origin: the gauge has seen it.
    if (!history.particles.empty()) record.displacement = record.position - history.particles.front().position;
    history.particles.push_back(record);
    for_each_sampled(particle_columns(),
                     [&](std::size_t, auto of) { history.sampled.push_back(of(set, history.place.index)); });
  }
}

void Gauges::record_bodies(run::System const& system) {
  if (bodies.empty() || bodies[0].back().time >= system.clock.time) return;
  for (std::size_t body = 0; body < bodies.size(); ++body)
    bodies[body].push_back({system.clock.time, system.sums(static_cast<int>(body))});
}

void archive(Archive& a, GaugeRecord& r) { a(r.time, r.pressure, r.density, r.velocity); }

void archive(Archive& a, ParticleRecord& r) {
  a(r.time, r.position, r.displacement, r.velocity, r.pressure, r.mises, r.density, r.plastic_strain, r.temperature,
    r.damage);
}

void archive(Archive& a, BodyRecord& r) { a(r.time, r.sums); }

void Gauges::archive(Archive& a, run::System const& system) {
  a.section("gauges");
  a.same(gas.size(), "the number of gauges");
  for (GaugeHistory& history : gas) {
    a.same(history.gauge.name, "the name of a gauge");
    a.same(history.gauge.position, "the position of gauge \"" + history.gauge.name + "\"");
    a(history.records);
    archive_sampled(a, gas_columns(), history.records, history.sampled);
  }
  a.same(particles.size(), "the number of gauges on particles and bodies");
  for (ParticleGaugeHistory& history : particles) {
    a.same(history.gauge.name, "the name of a gauge");
    a.same(history.identity, "the particle of gauge \"" + history.gauge.name + "\"");
    a(history.place.block, history.place.index, history.lost, history.particles, history.bodies);
    mpm::Mpm const& all = *system.regions[system.place_of(history.gauge.body).region].particles;
    a.require(history.place.block < all.grid().block_count() && (history.place.block < 0 || history.place.index >= 0),
              "the place of gauge \"" + history.gauge.name + "\"");
    archive_sampled(a, particle_columns(), history.particles, history.sampled);
  }
  a(bodies);
  a.require(bodies.empty() || bodies.size() == system.bodies.size(), "the number of bodies with a record");
}

}  // namespace brisance::observe
