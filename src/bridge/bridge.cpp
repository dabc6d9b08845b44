#include "bridge/bridge.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bridge/conversion.hpp"
#include "bridge/printed.hpp"

namespace brisance::bridge {

using mpm::Field;

Bridge::Bridge(gas::Gas& gas, mpm::Mpm& particles, int gas_body, Region region, Options const& options,
               gas::Primitive const& ambient)
    : gas_(&gas),
      particles_(&particles),
      gas_body_(gas_body),
      region_(std::move(region)),
      options_(options),
      ambient_(ambient),
      awake_(options.awake),
      faces_(region_, options.particles_per_direction),
      shared_(gas, particles, gas_body, faces_),
      ghosts_(gas, region_, shared_),
      proxies_(particles, gas_body, faces_, shared_),
      gas_particles_(particles, gas_body, gas.fluids(), faces_, proxies_.blocks()),
      ledger_(faces_, shared_),
      forbidden_cells_(particles, gas_body, faces_) {
  set_roles();
  watch_faces();
}

void Bridge::set_roles() {
  grid::Grid const& grid = gas_->grid();
  for (int const b : grid.blocks_of(region_.level())) {
    grid::Block const& block = grid.blocks()[b];
    std::vector<gas::Role> roles;
    roles.reserve(block.cell_count());
    for_each_cell(block.in_domain(), [&](Index3 const& cell) { roles.push_back(region_.role(cell)); });
    // A block may have cells of several regions.
    std::vector<gas::Role> const& before = gas_->coupling.roles(b);
    for (std::size_t n = 0; n < before.size(); ++n) {
      if (roles[n] == gas::Role::own) roles[n] = before[n];
    }
    gas_->coupling.set_roles(b, std::move(roles));
  }
}

void Bridge::watch_faces() {
  for (Face& face : region_.faces()) {
    if (!face.open) {
      Index3 const below = face.side == 0 ? face.outside() : face.inside;
      face.watch = gas_->coupling.watch(region_.locate(gas_->grid(), below), face.direction);
    }
  }
}

void Bridge::follow_blocks() {
  shared_.follow_blocks();
  ghosts_.follow_blocks();
}

bool Bridge::wake() {
  if (awake_) return true;
  auto const& cells = region_.proxy_cells();
  grid::Grid const& grid = gas_->grid();
  for (Index3 const& cell : cells) {
    if (region_.clamped(cell) != cell) continue;
    grid::Cell const at = region_.locate(grid, cell);
    if (!gas_->awake(at.block)) continue;
    double const p = gas_->primitive(at).pressure;
    if (std::abs(p - ambient_.pressure) > options_.activation) {
      awake_ = true;
      // What crossed the faces meanwhile belongs to the particles; what the gas at rest pushed there, they have not
      // felt.
      if (options_.transport == Transport::ledger) ledger_.add_fluxes(gas_->coupling.watched(), 1.0);
      forget_fluxes(gas_->coupling, region_);
      particles_->set_time(gas_->time());
      return true;
    }
  }
  return false;
}

void Bridge::lend_nodes_to_ghosts() {
  shared_.average();
  ghosts_.fill(last_step_);
  keep_wind_awake();
}

/// Blocks that sleep in a uniform wind would not tell what flows through their faces.
void Bridge::keep_wind_awake() {
  if (dot(ambient_.velocity, ambient_.velocity) == 0.0) return;
  for (Face const& face : region_.faces()) {
    if (!face.open) gas_->wake(region_.locate(gas_->grid(), face.outside()).block);
  }
}

void Bridge::lend_cells_to_nodes(double begin, double end) {
  proxies_.make(begin, end, ledger_);
  take_reference_off();
}

/// Forces come from differences of pressure: the same pressure taken off everywhere changes nothing but the error of
/// the sums over particles, which is proportional to what is left. It must not exceed the lowest pressure of the gas:
/// particles under negative pressure attract each other and gather in clumps.
void Bridge::take_reference_off() {
  double reference = options_.reference_pressure.value_or(
      std::clamp(mpm::lowest_pressure(*particles_, gas_body_), 0.0, ambient_.pressure));
  for (int body = 0; body < static_cast<int>(particles_->bodies().size()); ++body) {
    // The stress of solids counts from the ambient pressure.
    bool const is_gas = body == gas_body_;
    particles_->set_reference_pressure(body, is_gas ? reference : reference - ambient_.pressure);
  }
}

void Bridge::exchange(double share, double dt) {
  last_step_ = dt;
  ledger_.begin_step();
  take_absorbed();
  count_pressure(share);
  ledger_.find_directions(gas_->coupling.watched(), share);
  std::optional<double> reference;
  if (options_.transport == Transport::ledger) reference = particles_->bodies()[gas_body_].reference_pressure;
  ledger_.add_inflow(dt, reference, traffic_.outflow);
  if (options_.transport == Transport::ledger) {
    ledger_.add_fluxes(gas_->coupling.watched(), share);
    ledger_.add_pressure(gas_->coupling.watched(), share, dt, particles_->bodies()[gas_body_].reference_pressure,
                         ambient_.pressure);
    ledger_.take_gifts(particles_->proxies(), proxies_.blocks(), traffic_.outflow);
    ledger_.follow_volumes(dt);
    ledger_.level();
    traffic_.injected += ledger_.inject(gas_particles_);
    ledger_.give_back(*gas_, dt, particles_->bodies()[gas_body_].reference_pressure);
  } else {
    traffic_.injected += inject_as_printed(faces_, shared_, gas_particles_, dt);
  }
}

void Bridge::take_absorbed() {
  for (mpm::ParticleSet const& set : gas_particles_.take_absorbed()) {
    for (int q = 0; q < set.size(); ++q) {
      Vec3 x{0.0, 0.0, 0.0};
      Vec3 move{0.0, 0.0, 0.0};
      for (int d = 0; d < 3; ++d) {
        x[d] = set.field(Field::position_x + d)[q];
        move[d] = set.field(Field::move_x + d)[q];
      }
      int const face = faces_.crossed(x, move);
      Amounts const load = gas_particles_.carried(set, q);
      ++traffic_.absorbed;
      if (faces_[face].open) {
        traffic_.outflow.add(options_.transport == Transport::ledger ? gas_particles_.handed_over(set, q) : load);
      } else if (options_.transport == Transport::ledger) {
        ledger_.absorb(face, faces_.lane_of(face, x), gas_particles_.handed_over(set, q));
      } else {
        add_to_cell(*gas_, region_.locate(gas_->grid(), faces_[face].outside()), load);
      }
    }
  }
}

/// Counts what the pressure of the gas did at the faces.
void Bridge::count_pressure(double share) {
  for (int f = 0; f < faces_.count(); ++f) {
    Face const& face = faces_[f];
    if (face.open) continue;
    gas::FaceFlux const& flux = gas_->coupling.watched()[face.watch];
    if (flux.impulse == 0.0) continue;  // both sides sleep
    double const sign = face.side == 0 ? share : -share;
    double area = 0.0;
    for (int lane = 0; lane < faces_.lanes(); ++lane) area += faces_.lane_area(f, lane);
    traffic_.pressure_work += sign * area * flux.work;
    traffic_.pressure_impulse[face.direction] += sign * area * flux.impulse;
  }
}

std::vector<CellSums> Bridge::gas_in(std::vector<Index3> const& cells) const {
  Averages averages(region_.domain(), *particles_, region_.shift(), cells);
  averages.compute(*particles_, gas_body_);
  return averages.sums();
}

void forget_fluxes(gas::Coupling& coupling, Region const& region) {
  // Not those of other regions, which are still to take theirs over.
  for (Face const& face : region.faces()) {
    if (!face.open) coupling.flux(face.watch) = {};
  }
}

gas::Primitive Bridge::primitive(CellSums const& sums) const { return bridge::primitive(gas_->fluids(), sums); }

}  // namespace brisance::bridge
