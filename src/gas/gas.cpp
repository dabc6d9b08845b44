#include "gas/gas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/reduce.hpp"
#include "core/timer.hpp"

namespace brisance::gas {

namespace {

grid::ExchangeRules exchange_rules(Components const& quiescent, std::array<Components, 6> const& inflow,
                                   int components) {
  grid::ExchangeRules rules;
  rules.mirrored_component = {momentum_x, momentum_y, momentum_z};
  rules.quiescent.assign(quiescent.begin(), quiescent.begin() + components);
  for (int face = 0; face < 6; ++face)
    rules.inflow[face].assign(inflow[face].begin(), inflow[face].begin() + components);
  return rules;
}

int component_count(Fluids const& fluids, Options const& options) {
  bool const carried = fluids.mixed() && options.afterburn && options.afterburn->carried();
  return carried ? most_components : components_of(fluids.count);
}

}  // namespace

Gas::Gas(grid::Grid const& grid, Fluids const& fluids, Options const& options, Primitive const& quiescent,
         std::array<Primitive, 6> const& inflow)
    : obstacles(grid, options.bundle_cells),
      cut(grid, options.bundle_cells),
      burn(grid),
      coupling(grid, options.bundle_cells),
      grid_(&grid),
      fluids_(fluids),
      options_(options),
      quiescent_(quiescent),
      fields_(grid, component_count(fluids, options)),
      exchange_(
          grid, fields_.components(),
          [&] {
            std::array<Components, 6> outside;
            for (int face = 0; face < 6; ++face) outside[face] = conserved_of(fluids, inflow[face]);
            return exchange_rules(conserved_of(fluids, quiescent), outside, component_count(fluids, options));
          }(),
          options.chains ? options.bundle_cells : 0),
      open_faces_(grid, fluids, fields_.components()),
      awake_(grid, 1),
      disturbance_(grid),
      blocks_(grid),
      shells_(grid, [&grid](grid::Block const& block) { return shells_of(grid, block); }),
      parts_(grid.levels()),
      levels_(grid, fluids, fields_.components()),
      peaks_(grid, options.peak_fields) {
  auto const u = conserved_of(fluids, quiescent);
  open_faces_.set_sources(options.wave_sources);
  for (int b = 0; b < grid.block_count(); ++b) {
    for (int c = 0; c < components(); ++c) std::fill_n(fields_.at(b, c), grid.blocks()[b].cell_count(), u[c]);
  }
  std::vector<int> all(grid.blocks().size());
  std::iota(all.begin(), all.end(), 0);
  find_levels(all);
}

void Gas::set(grid::Cell const& cell, Primitive const& state) {
  auto const u = conserved_of(fluids_, state);
  for (int c = 0; c < components(); ++c) fields_.at(cell.block, c)[cell.offset] = u[c];
  note_change(cell);
}

void Gas::set(grid::Cell const& cell, Amounts const& per_volume, Fractions const& fraction) {
  auto const [block, offset] = std::pair{cell.block, cell.offset};
  for (int k = 0; k < fluids_.count; ++k) fields_.at(block, partial_density(k))[offset] = per_volume.mass[k];
  for (int d = 0; d < 3; ++d) fields_.at(block, momentum_x + d)[offset] = per_volume.momentum[d];
  fields_.at(block, energy)[offset] = per_volume.energy;
  for (int k = 1; k < fluids_.count; ++k) fields_.at(block, volume_fraction(k))[offset] = fraction[k];
  if (components() > progress) fields_.at(block, progress)[offset] = 0.0;
  note_change(cell);
}

void Gas::fill_opened(grid::Cell const& to, grid::Cell const& donor) {
  if (burn_fraction(*this, donor) < 1.0) return;
  Components u{};
  for (int c = 0; c < components(); ++c) u[c] = fields_.at(donor.block, c)[donor.offset];
  double square = 0.0;
  for (int d = 0; d < 3; ++d) {
    square += u[momentum_x + d] * u[momentum_x + d];
    u[momentum_x + d] = 0.0;
  }
  u[energy] -= 0.5 * square / mixture_density(fluids_.count, u);
  u[shock] = 0.0;
  double const volume = grid_->block(to).volume(to);
  for (int c = 0; c < components(); ++c) {
    double& value = fields_.at(to.block, c)[to.offset];
    blocks_[to.block].account.opened[c] += volume * (u[c] - value);
    value = u[c];
  }
  note_change(to);
}

double Gas::most_H() const { return fluids_.any_bears_tension() ? std::numeric_limits<double>::infinity() : 0.0; }

void Gas::start(double time) {
  time_ = time;
  time_at_step_end_ = time;
  burn.follow(time_, time_at_step_end_);
  auto const quiet = conserved_of(fluids_, quiescent_);
  parallel_for(grid_->block_count(), [&](int b, int) {
    bool quiescent = options_.sleep;
    for (int c = 0; c < components() && quiescent; ++c) {
      double const* u = fields_.at(b, c);
      quiescent =
          std::all_of(u, u + grid_->blocks()[b].cell_count(), [value = quiet[c]](double x) { return x == value; });
    }
    awake_[b] = quiescent ? 0 : 1;
  });
  open_faces_.start(fields_, quiet, [this](grid::Cell const& cell) {
    // Explosive that the boundary cuts through burns away; what lies beyond it does not.
    auto const& times = burn.times(cell.block);
    if (!fluids_.mixed() || times.empty()) return false;
    if (!(fields_.at(cell.block, volume_fraction(products_fluid))[cell.offset] > 0.0)) return false;
    return std::isfinite(times[grid_->block(cell).with_ghosts().offset(cell.within())].end);
  });
  prepare_workspaces();
  obstacles.find_near_walls();
  find_quiescence();
  std::vector<int> all(grid_->blocks().size());
  std::iota(all.begin(), all.end(), 0);
  find_levels(all);
  for (int b = 0; b < grid_->block_count(); ++b) {
    if (grid_->blocks()[b].covered_parts != 0) awake_[b] = options_.sleep && is_quiescent_block(b) ? 0 : 1;
  }
  disturbance_.find(fields_, quiet);
  load_nodes();
  if (quiet[momentum_x] != 0.0 || quiet[momentum_y] != 0.0 || quiet[momentum_z] != 0.0) {
    for (Node const& node : cut.nodes()) awake_[node.cell.block] = 1;  // a wall in the wind
    wake_where_wind_changes();
  }
  measure_all();
}

void Gas::prepare_workspaces() {
  workspaces_.clear();
  for (int t = 0; t < threads(); ++t) workspaces_.emplace_back();
}

Primitive Gas::primitive(grid::Cell const& cell) const {
  Components u{};
  for (int c = 0; c < components(); ++c) u[c] = fields_.at(cell.block, c)[cell.offset];
  return primitive_of(fluids_, u.data(), burn_fraction(*this, cell));
}

bool hold_the_same(Gas const& gas, int block, int offset) {
  if (gas.burn.burning_in(block)) return false;
  for (int c = 0; c < gas.fields().components(); ++c) {
    double const* const u = gas.fields().at(block, c) + offset;
    if (u[0] != u[1]) return false;
  }
  return true;
}

std::vector<Primitive> gather(Gas const& gas, std::vector<Index3> const& cells, int level) {
  std::vector<Primitive> states;
  states.reserve(cells.size());
  for (Index3 const& cell : cells) states.push_back(gas.primitive(gas.grid().locate(level, cell).value()));
  return states;
}

Account& Account::operator+=(Account const& other) {
  for (int c = 0; c < most_components; ++c) outflow[c] += other.outflow[c];
  guarded_cells += other.guarded_cells;
  fallback_faces += other.fallback_faces;
  guard_mass += other.guard_mass;
  guard_energy += other.guard_energy;
  afterburn_energy += other.afterburn_energy;
  for (int c = 0; c < most_components; ++c) opened[c] += other.opened[c];
  return *this;
}

Account Gas::account() const {
  Account sum = carried_;
  for (Tally const& block : blocks_) sum += block.account;
  return sum;
}

void Gas::report_not_a_number(int b, int direction) const {
  grid::Block const& block = grid_->blocks()[b];
  Vec3 const x = block.centre(block.cell_at(blocks_[b].not_a_number));
  throw NumericalError(fmt::format(
      "the state of the cell at ({:.6g}, {:.6g}, {:.6g}) m became NaN (not a number) at t = {:.6g} s in the sweep "
      "along {}; try a smaller numerics.courant, numerics.scheme = \"muscl-hancock\", or another domain.cell",
      x[0], x[1], x[2], time_, "xyz"[direction]));
}

SweepContext Gas::sweep_context(int direction, double dt) const {
  SweepContext context;
  context.fluids = &fluids_;
  context.direction = direction;
  context.dt = dt;
  context.h = grid_->smallest_cell();
  context.beta = options_.beta;
  context.floors.density = options_.density_floor;
  context.floors.pressure = options_.pressure_floor;
  context.viscosity = options_.viscosity;
  context.shock_sensor =
      options_.carbuncle_cure && options_.scheme == Scheme::muscl_hancock && grid_->domain().dimensions() > 1;
  context.progress = components() > progress;
  context.most_H = most_H();
  context.bounded_phase = fluids_.mixed() && std::holds_alternative<material::IdealGas>(fluids_.ambient());
  for (int k = 1; k < fluids_.count; ++k) {
    context.xi_slope[k] = 1.0 / material::gruneisen(fluids_.eos[k]) - 1.0 / material::gruneisen(fluids_.ambient());
  }
  context.rests = options_.sleep && norm(quiescent_.velocity) == 0.0;
  context.radial = direction == 0 && grid::radial_exponent(grid_->domain().geometry) > 0;
  return context;
}

void Gas::set_present(int present, SweepContext& s) const {
  s.present = present;
  auto const* ideal = std::get_if<material::IdealGas>(&fluids_.ambient());
  bool const constant = present == 1 && ideal != nullptr && options_.scheme == Scheme::muscl_hancock;
  s.sums = constant ? Sums::none : Sums::all;
  s.gamma = constant ? ideal->gamma : 0.0;
}

void Gas::add_tallies(std::vector<Part> const& parts) {
  for (Part const& part : parts) {
    for (std::size_t position = 0; position < part.chain->size(); ++position) {
      Tally& sum = blocks_[(*part.chain)[position]];
      Tally const& tally = tallies_[part.tally + position];
      sum.account += tally.account;
      sum.signal = std::max(sum.signal, tally.signal);
      if (sum.not_a_number < 0) sum.not_a_number = tally.not_a_number;
    }
  }
}

std::vector<int> Gas::sweeps_of(bool reverse) const {
  std::vector<int> order;
  for (int direction : options_.sweep_order) {
    if (direction < grid_->domain().dimensions()) order.push_back(direction);
  }
  if (reverse) std::reverse(order.begin(), order.end());
  return order;
}

void Gas::sweep_level(int level, int direction, double dt, bool last) {
  {
    PhaseTimer const timer(timings_["exchange"]);
    exchange_.fill(
        fields_, level, direction, awake_,
        [&](int b) {
          if (awake_[b] && open_faces_.at(b, direction))
            open_faces_.fill(fields_, b, direction, dt, burn.burning_in(b), exchange_);
        },
        [this](int b, int face, double* ghosts) { levels_.fill(b, face, ghosts); });
  }
  PhaseTimer const timer(timings_["sweeps"]);
  SweepContext const context = sweep_context(direction, dt);
  std::vector<Part> const& parts = parts_[level][direction];
  parallel_for(static_cast<int>(parts.size()),
               [&](int n, int thread) { sweep_part(parts[n], context, awake_, last, workspaces_[thread]); });
  for (int const b : grid_->blocks_of(level)) {
    if (last && awake_[b] && !coupling.all_frozen(b)) blocks_[b].signal = 0.0;
  }
  add_tallies(parts);
  if (!cut.nodes().empty() && level == cut.level()) share_small_cells(context, last);
  for (int const b : grid_->blocks_of(level)) {
    if (blocks_[b].not_a_number >= 0) report_not_a_number(b, direction);
  }
}

void Gas::advance_level(int level, double time, double dt, bool reverse, Companion const& companion) {
  if (companion.sees(level)) {
    time_ = time;
    companion.before(level, time, dt);
  }
  time_at_step_end_ = time + dt;
  burn.follow(time, time_at_step_end_);
  if (level == cut.level()) find_walls();
  bool const finer = level + 1 < grid_->levels();
  std::vector<int> const order = sweeps_of(reverse);
  if (finer) levels_.begin_step(fields_, awake_, level, order);
  for (int const direction : order) {
    sweep_level(level, direction, dt, direction == order.back());
    if (level > 0) levels_.end_fine_sweep(level, direction);
    if (finer) levels_.end_sweep(fields_, awake_, level);
  }
  if (finer) {
    double begun = 0.0;
    for (int number = 0; begun < 1.0; ++number) {
      double const left = 1.0 - begun;
      double const length = left / fine_steps(level, left);
      levels_.begin_fine_step(level + 1, begun, length);
      advance_level(level + 1, time + begun * dt, length * dt, number % 2 == 1, companion);
      begun = length == left ? 1.0 : begun + length;
    }
    take_from_finer(level);
  }
  if (companion.sees(level)) {
    time_ = time + dt;
    companion.after(level, time, dt);
  }
  if (companion.look) companion.look(level, time + dt);
}

double Gas::fine_steps(int level, double left) const {
  double signal = 0.0;
  for (int finer = level + 1; finer < grid_->levels(); ++finer) {
    for (int const b : grid_->blocks_of(finer)) signal = std::max(signal, blocks_[b].signal);
  }
  return std::ceil(2.0 * left * std::max(1.0, signal / most_signal_) * (1.0 - 1e-12));
}

void Gas::take_from_finer(int level) {
  PhaseTimer const timer(timings_["levels"]);
  auto const note = [this](grid::Cell const& cell) {
    awake_[cell.block] = 1;
    disturbance_.note(cell);
  };
  levels_.correct(fields_, level, note);
  levels_.restrict(fields_, awake_, level, [this](int block) {
    awake_[block] = 1;
    disturbance_.find(fields_, quiet_.state, block);
  });
}

void Gas::advance(double dt, bool reverse, Companion const& companion) {
  if (static_cast<int>(workspaces_.size()) < threads()) prepare_workspaces();  // more threads than at the start
  double const end = time_ + dt;
  // Splitting is stable up to 1; a user may have chosen a step nearer to it.
  constexpr double most_courant = 0.9;
  most_signal_ = std::max(most_courant * grid_->domain().smallest_cell() / dt, 1.05 * fastest_signal_);
  advance_level(0, time_, dt, reverse, companion);
  time_ = end;
  time_at_step_end_ = end;
  burn.follow(time_, time_at_step_end_);
  fastest_signal_ = largest_at_hand(
      grid_->block_count(), 0.0, [this](int b) { return std::max(blocks_[b].signal, open_faces_.fastest_signal(b)); });
}

}  // namespace brisance::gas
