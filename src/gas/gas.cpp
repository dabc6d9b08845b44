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
  if (!fluids.two) return single_fluid_components;
  return options.afterburn && options.afterburn->carried() ? afterburn_components : two_fluid_components;
}

Components conserved_of(Fluids const& fluids, MixtureState const& s) {
  Components u{};
  double const alpha = fluids.two ? s.volume_fraction : 0.0;
  u[density] = (1.0 - alpha) * s.ambient_density;
  u[second_density] = alpha * s.second_density;
  u[volume_fraction] = alpha;
  double const rho = u[density] + u[second_density];
  for (int d = 0; d < 3; ++d) u[momentum_x + d] = rho * s.velocity[d];
  u[energy] =
      mixture(fluids, u[density], u[second_density], alpha).rho_e(s.pressure) + 0.5 * rho * dot(s.velocity, s.velocity);
  return u;
}

}  // namespace

Gas::Gas(grid::Grid const& grid, Fluids const& fluids, Options const& options, MixtureState const& quiescent,
         std::array<MixtureState, 6> const& inflow)
    : grid_(&grid),
      fluids_(fluids),
      options_(options),
      quiescent_(quiescent),
      fields_(grid, component_count(fluids, options)),
      exchange_(grid, fields_.components(),
                [&] {
                  std::array<Components, 6> outside;
                  for (int face = 0; face < 6; ++face) outside[face] = conserved_of(fluids, inflow[face]);
                  return exchange_rules(conserved_of(fluids, quiescent), outside, component_count(fluids, options));
                }()),
      open_faces_(grid, fluids, fields_.components()),
      awake_(grid, 1),
      blocks_(grid),
      peaks_(grid, [count = options.peak_fields ? peak_count : 0](grid::Block const& block) {
        return Buffer(static_cast<std::size_t>(block.cell_count()) * count);
      }) {
  auto const u = conserved(quiescent);
  for (int b = 0; b < grid.block_count(); ++b) {
    for (int c = 0; c < components(); ++c) std::fill_n(fields_.at(b, c), grid.blocks()[b].cell_count(), u[c]);
  }
}

Components Gas::conserved(MixtureState const& state) const { return conserved_of(fluids_, state); }

void Gas::set(grid::Cell const& cell, MixtureState const& state) {
  auto const u = conserved(state);
  for (int c = 0; c < components(); ++c) fields_.at(cell.block, c)[cell.offset] = u[c];
}

void Gas::set_conserved(grid::Cell const& cell, double ambient, double second, Vec3 const& momentum,
                        double total_energy, double fraction) {
  auto const [block, offset] = std::pair{cell.block, cell.offset};
  fields_.at(block, density)[offset] = ambient;
  for (int d = 0; d < 3; ++d) fields_.at(block, momentum_x + d)[offset] = momentum[d];
  fields_.at(block, energy)[offset] = total_energy;
  if (fluids_.two) {
    fields_.at(block, second_density)[offset] = second;
    fields_.at(block, volume_fraction)[offset] = fraction;
  }
  if (components() > progress) fields_.at(block, progress)[offset] = 0.0;
}

void Gas::set_obstacles(int block, std::vector<std::uint8_t> solid) { blocks_[block].solid = std::move(solid); }

bool Gas::is_obstacle(grid::Cell const& cell) const {
  auto const& solid = blocks_[cell.block].solid;
  return !solid.empty() && solid[grid_->block(cell).with_ghosts().offset(cell.within())] != 0;
}

void Gas::set_roles(int block, std::vector<Role> roles) {
  BlockData& data = blocks_[block];
  data.all_held = std::all_of(roles.begin(), roles.end(), [](Role r) { return r == Role::held; });
  bool const all_own = std::all_of(roles.begin(), roles.end(), [](Role r) { return r == Role::own; });
  data.roles = all_own ? std::vector<Role>{} : std::move(roles);
}

int Gas::watch(Index3 const& cell, int direction) {
  WatchedFace const face{grid_->locate(cell), static_cast<int>(watched_.size())};
  grid::Bundles const bundles(grid_->block(face.cell), direction, options_.bundle_cells);
  auto& faces = blocks_[face.cell.block].watched[direction];
  faces.resize(bundles.count());
  faces[bundles.index_of(face.cell)].push_back(face);
  watched_.emplace_back();
  return face.number;
}

void Gas::set_burn_times(int block, std::vector<BurnTime> times) { blocks_[block].burn_times = std::move(times); }

void Gas::set_burn(double detonation_speed, double end_time, double trace) {
  detonation_speed_ = detonation_speed;
  burn_end_ = end_time;
  trace_ = std::max(trace, vanishing_fraction);
}

namespace {

/// Charges that are lit together begin at times that differ by rounding, and no step is that short: what is about to
/// begin within this part of a burst's duration has begun.
constexpr double at_once = 1e-3;

bool begun(std::array<double, 2> const& burst, double time) {
  return time >= burst[0] - at_once * (burst[1] - burst[0]);
}

}  // namespace

bool Gas::bursting() const {
  return std::any_of(bursts_.begin(), bursts_.end(),
                     [this](auto const& burst) { return begun(burst, time_) && time_ < burst[1]; });
}

double Gas::next_burst() const {
  double next = std::numeric_limits<double>::infinity();
  for (auto const& burst : bursts_) {
    if (!begun(burst, time_)) next = std::min(next, burst[0]);
  }
  return next;
}

double Gas::most_H() const {
  bool const tension =
      material::bears_tension(fluids_.ambient) || (fluids_.two && material::bears_tension(fluids_.second));
  return tension ? std::numeric_limits<double>::infinity() : 0.0;
}

double Gas::burn_fraction_of(BurnTime const& times) const {
  double const t = time_at_step_end_;
  if (t >= times.end) return 1.0;
  return t > times.begin ? std::max((t - times.begin) / (times.end - times.begin), smallest_burn_fraction)
                         : smallest_burn_fraction;
}

bool Gas::is_trace(double alpha) const { return std::abs(alpha) <= trace_; }

double Gas::unlit_compression(double unburnt_density) const {
  if (!fluids_.two || !burning()) return 0.0;
  constexpr double ahead = 6.0;  // cells that the detonation runs meanwhile: its own foot compresses what is nearer
  constexpr double a_good_part = 0.1;
  return largest_over(grid_->block_count(), 0.0, [&](int b) {
    double most = 0.0;
    if (blocks_[b].burn_times.empty()) return most;
    grid::Block const& block = grid_->blocks()[b];
    double const soonest = time_ + ahead * block.h() / detonation_speed_;
    grid::CellRange const box = block.with_ghosts();
    for_each_cell(block, [&](grid::Cell const& cell) {
      double const alpha = fields_.at(b, volume_fraction)[cell.offset];
      bool const soon = blocks_[b].burn_times[box.offset(cell.within())].begin < soonest;
      if (soon || alpha < a_good_part || !is_own(cell)) return;
      most = std::max(most, fields_.at(b, second_density)[cell.offset] / (alpha * unburnt_density) - 1.0);
    });
    return most;
  });
}

double Gas::burn_fraction(grid::Cell const& cell) const {
  auto const& times = blocks_[cell.block].burn_times;
  if (times.empty() || !burning()) return 1.0;
  if (is_trace(fields_.at(cell.block, volume_fraction)[cell.offset])) return 1.0;
  return burn_fraction_of(times[grid_->block(cell).with_ghosts().offset(cell.within())]);
}

double Gas::afterburn_progress(grid::Cell const& cell) const {
  if (!fluids_.two || !options_.afterburn) return 0.0;
  double const products = fields_.at(cell.block, second_density)[cell.offset];
  if (!(products > 0.0)) return 0.0;
  if (auto const* constant = std::get_if<material::ConstantRateAfterburn>(&options_.afterburn->rate)) {
    return constant->progress(time_);
  }
  return std::clamp(fields_.at(cell.block, progress)[cell.offset] / products, 0.0, 1.0);
}

void Gas::start(double time) {
  time_ = time;
  time_at_step_end_ = time;
  auto const quiet = conserved(quiescent_);
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
    auto const& times = blocks_[cell.block].burn_times;
    if (!fluids_.two || times.empty() || !(fields_.at(cell.block, volume_fraction)[cell.offset] > 0.0)) return false;
    return std::isfinite(times[grid_->block(cell).with_ghosts().offset(cell.within())].end);
  });
  prepare_workspaces();
  std::vector<int> all(blocks_.size());
  std::iota(all.begin(), all.end(), 0);
  find_near_walls(all);
  quiet_pressure_ = quiescent_pressure();
  if (quiet[momentum_x] != 0.0 || quiet[momentum_y] != 0.0 || quiet[momentum_z] != 0.0) wake_where_wind_changes();
  measure_all();
}

void Gas::prepare_workspaces() {
  int capacity = 0;
  int width = 1;
  for (grid::Block const& block : grid_->blocks()) {
    for (int d = 0; d < grid_->domain().dimensions(); ++d) {
      grid::Bundles const bundles(block, d, options_.bundle_cells);
      capacity = std::max(capacity, bundles.capacity());
      width = std::max(width, d == 0 ? 1 : bundles.width());
    }
  }
  workspaces_.clear();
  for (int t = 0; t < threads(); ++t) workspaces_.emplace_back(array_count, capacity, width);
}

Primitive Gas::to_primitive(double const* u, double F) const {
  double const rho1 = fluids_.two ? u[second_density] : 0.0;
  double const alpha = fluids_.two ? u[volume_fraction] : 0.0;
  Mixture const m = mixture(fluids_, u[density], rho1, alpha, F);
  Primitive w;
  w.density = u[density] + rho1;
  for (int d = 0; d < 3; ++d) w.velocity[d] = u[momentum_x + d] / w.density;
  w.pressure = m.pressure(u[energy] - 0.5 * w.density * dot(w.velocity, w.velocity));
  w.volume_fraction = alpha;
  w.mass_fraction = rho1 / w.density;
  w.sound_speed = std::sqrt(std::max(0.0, m.bulk_modulus(w.pressure)) / w.density);
  return w;
}

Primitive Gas::primitive(grid::Cell const& cell) const {
  Components u{};
  for (int c = 0; c < components(); ++c) u[c] = fields_.at(cell.block, c)[cell.offset];
  return to_primitive(u.data(), burn_fraction(cell));
}

std::vector<Primitive> Gas::gather(std::vector<Index3> const& cells) const {
  std::vector<double> const values = exchange_.gather(fields_, cells);
  std::vector<Primitive> result;
  result.reserve(cells.size());
  for (std::size_t n = 0; n < cells.size(); ++n) {
    result.push_back(to_primitive(values.data() + n * components(), burn_fraction(grid_->locate(cells[n]))));
  }
  return result;
}

double const* Gas::peak_overpressure(int block) const {
  return options_.peak_fields
             ? peaks_[block].data() + static_cast<std::size_t>(peak_pressure) * grid_->blocks()[block].cell_count()
             : nullptr;
}

double const* Gas::peak_impulse(int block) const {
  return options_.peak_fields
             ? peaks_[block].data() + static_cast<std::size_t>(largest_impulse) * grid_->blocks()[block].cell_count()
             : nullptr;
}

Account& Account::operator+=(Account const& other) {
  for (int c = 0; c < afterburn_components; ++c) outflow[c] += other.outflow[c];
  guarded_cells += other.guarded_cells;
  fallback_faces += other.fallback_faces;
  guard_mass += other.guard_mass;
  guard_energy += other.guard_energy;
  afterburn_energy += other.afterburn_energy;
  for (int c = 0; c < afterburn_components; ++c) opened[c] += other.opened[c];
  return *this;
}

Account Gas::account() const {
  return sum_at_hand(grid_->block_count(), [this](int b) -> Account const& { return blocks_[b].account; });
}

void Gas::report_not_a_number(int b, int direction) const {
  grid::Block const& block = grid_->blocks()[b];
  Vec3 const x = block.centre(block.cell_at(blocks_[b].not_a_number));
  throw NumericalError(fmt::format(
      "the state of the cell at ({:.6g}, {:.6g}, {:.6g}) m became not a number at t = {:.6g} s in the sweep along {}; "
      "remedies: a smaller numerics.courant, numerics.scheme = \"muscl-hancock\", a finer or coarser domain.cell near "
      "the charge",
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
  context.bounded_phase = fluids_.two && std::holds_alternative<material::IdealGas>(fluids_.ambient);
  context.radial = direction == 0 && grid::radial_exponent(grid_->domain().geometry) > 0;
  return context;
}

void Gas::advance(double dt, bool reverse) {
  int const dims = grid_->domain().dimensions();
  time_at_step_end_ = time_ + dt;
  if (static_cast<int>(workspaces_.size()) < threads()) prepare_workspaces();  // more threads than at the start
  std::vector<int> order;
  for (int direction : options_.sweep_order) {
    if (direction < dims) order.push_back(direction);
  }
  if (reverse) std::reverse(order.begin(), order.end());
  for (int direction : order) {
    bool const last = direction == order.back();
    {
      PhaseTimer const timer(timings_["exchange"]);
      exchange_.fill(fields_, direction, awake_);
      parallel_for(grid_->block_count(), [&](int b, int) {
        if (!awake_[b] || !open_faces_.at(b, direction)) return;
        open_faces_.fill(fields_, b, direction, dt, !blocks_[b].burn_times.empty() && burning(), exchange_);
      });
    }
    PhaseTimer const timer(timings_["sweeps"]);
    SweepContext const context = sweep_context(direction, dt);
    bool const all_awake = std::all_of(awake_.begin(), awake_.end(), [](std::uint8_t awake) { return awake != 0; });
    Components const quiet_flux = all_awake ? Components{} : quiescent_flux(context);
    parallel_for(grid_->block_count(), [&](int b, int thread) {
      if (blocks_[b].all_held) return;
      if (awake_[b])
        sweep_block(b, context, last, workspaces_[thread]);
      else
        account_asleep(b, context, quiet_flux);
    });
    for (int b = 0; b < grid_->block_count(); ++b) {
      if (blocks_[b].not_a_number >= 0) report_not_a_number(b, direction);
    }
  }
  time_ += dt;
  fastest_signal_ = largest_at_hand(
      grid_->block_count(), 0.0, [this](int b) { return std::max(blocks_[b].signal, open_faces_.fastest_signal(b)); });
}

}  // namespace brisance::gas
