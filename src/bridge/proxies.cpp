#include "bridge/proxies.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "bridge/conversion.hpp"
#include "bridge/gas_particles.hpp"
#include "core/parallel.hpp"

namespace brisance::bridge {

using mpm::Field;

Proxies::Proxies(mpm::Mpm& particles, int gas_body, Faces const& faces, SharedGas const& shared)
    : particles_(&particles), faces_(&faces), shared_(&shared) {
  particles.proxies().belong_to(gas_body, particles.particles(0, gas_body).fields());
  Region const& region = faces.region();
  std::map<int, std::vector<ProxyCell>> by_block;
  for (Index3 const& cell : region.proxy_cells()) {
    Index3 const inner = region.clamped(cell);
    ProxyCell proxy;
    proxy.cell = cell;
    proxy.face = faces.before(cell);
    if (region.inside(inner)) {
      proxy.average = shared.average_of(inner);
    } else {
      proxy.state = shared.state_of(inner);
    }
    by_block[particles.grid().block_of(region.to_particles(cell))].push_back(proxy);
  }
  for (auto& [block, cells] : by_block) blocks_.push_back({block, std::move(cells)});
}

std::vector<int> Proxies::blocks() const {
  std::vector<int> blocks;
  for (ProxyBlock const& block : blocks_) blocks.push_back(block.block);
  return blocks;
}

void Proxies::make_proxies(ProxyCell const& proxy, double begin, double end, Ledger const& ledger,
                           mpm::ParticleSet& set) const {
  Region const& region = faces_->region();
  CellStates const& states = shared_->states();
  Primitive centre;
  GasSlopes slopes;
  Vec3 next{0.0, 0.0, 0.0};  // velocity at the end
  std::array<Vec3, 3> next_slopes{};
  if (proxy.state >= 0) {
    // Pressure and density at the beginning; the velocity, as that of the particles, half a step behind it.
    double const half_step = 0.5 * (end - begin);
    states.at(proxy.state, begin, centre, slopes);
    states.velocity_at(proxy.state, begin - half_step, centre.velocity, slopes.velocity);
    states.velocity_at(proxy.state, end - half_step, next, next_slopes);
  } else {
    CellSums const& s = shared_->sums()[proxy.average];
    if (s.volume < 0.1 * region.metric().cell_volume(region.clamped(proxy.cell)[0])) return;  // a solid lies there
    centre = bridge::primitive(shared_->fluids(), s);
    next = centre.velocity;
  }
  // Copies, which the calls below cannot change.
  grid::Metric const cells = region.metric();
  int const parts = faces_->parts();
  int const dims = cells.dimensions();
  grid::CellRange sub_cells;
  for (int d = 0; d < dims; ++d) sub_cells.upper[d] = parts;
  double const half = 0.5 * cells.h / parts;
  int q = set.size();
  for (std::size_t n = 0; n < sub_cells.count(); ++n) set.append();
  auto const fields_of = [&set](Field first) {
    return std::array{set.field(first), set.field(first + 1), set.field(first + 2)};
  };
  auto const position = fields_of(Field::position_x);
  auto const velocity = fields_of(Field::velocity_x);
  auto const later = fields_of(Field::next_x);
  auto const half_length = fields_of(Field::half_x);
  double* const density = set.field(Field::density);
  double* const pressure = set.field(Field::pressure);
  double* const mass = set.field(Field::mass);
  for_each_cell(sub_cells, [&](Index3 const& sub) {
    Vec3 offset{0.0, 0.0, 0.0};
    Vec3 x = cells.centre({0, 0, 0});
    for (int d = 0; d < dims; ++d) {
      offset[d] = (sub[d] + 0.5) / parts - 0.5;
      x[d] = cells.place(d, proxy.cell[d] + (sub[d] + 0.5) / parts);
    }
    for (int d = 0; d < dims; ++d) {
      if (proxy.face[d] < 0) continue;
      double const shift = std::clamp(ledger.reach(proxy.face[d], x), -2.0 * half, 2.0 * half);
      x[d] += shift;
      offset[d] += shift / cells.h;
    }
    Primitive const s = at_offset(centre, slopes, offset);
    for (int d = 0; d < 3; ++d) {
      position[d][q] = x[d];
      velocity[d][q] = s.velocity[d];
      later[d][q] = next[d];
      for (int across = 0; across < dims; ++across) later[d][q] += offset[across] * next_slopes[across][d];
      if (half_length[d] != nullptr) half_length[d][q] = half;
    }
    set_gradient(set, q, slopes, dims, cells.h);
    density[q] = s.density;
    pressure[q] = s.pressure;
    mass[q] = s.density * faces_->standard_volume(proxy.cell, sub);
    ++q;
  });
}

void Proxies::make(double begin, double end, Ledger const& ledger) {
  parallel_for(static_cast<int>(blocks_.size()), [&](int n, int) {
    mpm::ParticleSet& set = particles_->proxies().particles(blocks_[n].block);
    set.reorder({});
    for (ProxyCell const& cell : blocks_[n].cells) make_proxies(cell, begin, end, ledger, set);
  });
}

}  // namespace brisance::bridge
