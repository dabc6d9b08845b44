/// One sweep over one block: load a bundle, primitives, face fluxes, update, measure.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"
#include "core/reduce.hpp"
#include "gas/afterburn.hpp"
#include "gas/gas.hpp"
#include "gas/primitives.hpp"
#include "gas/schemes/cold_products.hpp"
#include "gas/schemes/lax_wendroff.hpp"
#include "gas/schemes/muscl_hancock.hpp"

namespace brisance::gas {

void Gas::load_burn(int b, BundleLayout const& layout, BundleArrays& a) const {
  grid::Block const& block = grid_->blocks()[b];
  double* const F = a[a_burn];
  load_with_ghosts(
      layout, block, blocks_[b].burn_times.data(), [this](BurnTime const& times) { return burn_fraction_of(times); },
      F);
  // A row without the second fluid is calculated without its burn, and so are cells that hold none of it.
  double const* const alpha = a[volume_fraction];
  for (int q = 0; q < layout.total; ++q) F[q] = is_trace(alpha[q]) ? 1.0 : F[q];
}

void Gas::load_bundle(int b, BundleLayout const& layout, SweepContext& s, BundleArrays& a) const {
  grid::Block const& block = grid_->blocks()[b];
  BlockData const& data = blocks_[b];
  int const slab = block.cell_count() / block.n[s.direction] * grid::ghost_layers;
  double const* low = exchange_.ghosts(b, 0);
  double const* high = exchange_.ghosts(b, 1);
  auto const load_component = [&](int c) {
    grid::load(layout, block, fields_.at(b, c), low + static_cast<std::size_t>(c) * slab,
               high + static_cast<std::size_t>(c) * slab, a[state_array(c)]);
  };
  for (int c = density; c <= energy; ++c) load_component(c);
  if (s.shock_sensor) load_component(shock);
  s.two = fluids_.two;
  if (s.two) {
    load_component(volume_fraction);
    // Rows without the second fluid cost what a single fluid costs. Faces of such a row carry none of it, also seen
    // from the other side.
    s.two = count_beyond(a[volume_fraction], layout.total, vanishing_fraction) > 0;
    if (s.two) load_component(second_density);
    if (s.two && s.progress) load_component(progress);
  }
  s.solid = !data.solid.empty();
  if (s.solid) {
    load_with_ghosts(
        layout, block, data.solid.data(), [](std::uint8_t x) { return x ? 1.0 : 0.0; }, a[a_solid]);
  }
  s.burning = s.two && !data.burn_times.empty() && burning();
  if (s.burning) {
    load_burn(b, layout, a);
  }
  if (s.radial) load_shells(block, layout, s, a);
}

void Gas::load_shells(grid::Block const& block, BundleLayout const& layout, SweepContext const& s,
                      BundleArrays& a) const {
  int const first = layout.begin(0);
  for (int l = -grid::ghost_layers; l < layout.length + grid::ghost_layers; ++l) {
    grid::Shell const shell = grid_->shell(block, l);
    a[a_area_high][first + l] = s.dt * shell.high_area / shell.volume;
    a[a_area_low][first + l] = s.dt * shell.low_area / shell.volume;
    // A mirror turns the velocity round, but its image spreads as the original does: the ratio of the two must keep its
    // sign.
    double const side = shell.mirrored ? -1.0 : 1.0;
    a[a_expansion][first + l] = side * 0.5 * s.dt * (shell.high_area - shell.low_area) / shell.volume;
  }
  int const whole_row = layout.length + 2 * grid::ghost_layers;
  for (int r = 1; r < layout.rows; ++r) {
    for (int const name : {a_area_high, a_area_low, a_expansion}) {
      std::copy_n(a[name] + first - grid::ghost_layers, whole_row, a[name] + layout.begin(r) - grid::ghost_layers);
    }
  }
}

void Gas::update(BundleLayout const& layout, SweepContext const& s, BundleArrays& a) {
  int const st = layout.stride;
  double const lambda = s.dt / s.h;
  double const* const solid = a[a_solid];
  auto const advance_component = [&](int c) {
    double* const u = a[state_array(c)];
    double const* const flux = a[flux_array(c)];
    for (int r = 0; r < layout.rows; ++r) {
      int const begin = layout.begin(r);
      int const end = begin + layout.count();
      if (!s.radial && !s.solid) {
        BRISANCE_VECTOR_LOOP
        for (int q = begin; q < end; ++q) u[q] -= lambda * (flux[q] - flux[q - st]);
        continue;
      }
      double const* const high = a[a_area_high];
      double const* const low = a[a_area_low];
      // The pressure in the flux acts on the difference to the cell's own: uniform pressure then leaves a ring or shell
      // exactly at rest.
      double const* const own = a[a_p_half];
      double const with_pressure = c == s.normal() ? 1.0 : 0.0;
      BRISANCE_VECTOR_LOOP
      for (int q = begin; q < end; ++q) {
        double const p = s.radial ? with_pressure * own[q] : 0.0;
        double const change =
            s.radial ? high[q] * (flux[q] - p) - low[q] * (flux[q - st] - p) : lambda * (flux[q] - flux[q - st]);
        double const fluid = s.solid ? 1.0 - solid[q] : 1.0;
        u[q] -= fluid * change;
      }
    }
  };
  if (s.two) {
    // d(alpha)/dt + u d(alpha)/dx = 0, as a flux minus alpha times the divergence of the face velocities
    // [JohnsenColonius06].
    double* const alpha = a[volume_fraction];
    double const* const flux = a[a_flux + volume_fraction];
    double const* const speed = a[a_face_speed];
    double const* const high = a[a_area_high];
    double const* const low = a[a_area_low];
    for (int r = 0; r < layout.rows; ++r) {
      int const begin = layout.begin(r);
      int const end = begin + layout.count();
      BRISANCE_VECTOR_LOOP
      for (int q = begin; q < end; ++q) {
        double const above = s.radial ? high[q] : lambda;
        double const below = s.radial ? low[q] : lambda;
        double const fluid = s.solid ? 1.0 - solid[q] : 1.0;
        alpha[q] -=
            fluid * (above * (flux[q] - alpha[q] * speed[q]) - below * (flux[q - st] - alpha[q] * speed[q - st]));
      }
    }
    advance_component(second_density);
    if (s.progress) advance_component(progress);
  }
  for (int c = density; c <= energy; ++c) advance_component(c);
}

void Gas::store(int b, BundleLayout const& layout, SweepContext const& s, BundleArrays& a) {
  grid::Block const& block = grid_->blocks()[b];
  auto const store_component = [&](int name, int c) {
    double const* from = a[name];
    double* to = fields_.at(b, c);
    for_each_run(layout, block, [=](int q, int offset, int count) { grid::copy_run(from + q, count, to + offset); });
  };
  for (int c = density; c <= energy; ++c) store_component(a_state + c, c);
  if (s.shock_sensor) store_component(a_sensor, shock);
  if (s.two) {
    store_component(second_density, second_density);
    store_component(volume_fraction, volume_fraction);
    if (s.progress) store_component(a_progress, progress);
  }
}

void Gas::account_boundaries(int b, BundleLayout const& layout, SweepContext const& s, BundleArrays& a) {
  grid::Block const& block = grid_->blocks()[b];
  for (int side = 0; side < 2; ++side) {
    if (!block.at_boundary(2 * s.direction + side)) continue;
    double const sign = side == 0 ? -1.0 : 1.0;
    for (int line = 0; line < layout.lines(); ++line) {
      // Face below the first or above the last of the block's own cells.
      int q = s.direction == 0 ? layout.begin(line) : layout.begin(0) + line;
      q += side == 0 ? -layout.stride : (layout.length - 1) * layout.stride;
      grid::Cell const cell = layout.end_cell(block, side, line);
      if (!is_own(cell)) continue;
      double const area = block.face_area(s.direction, side, cell);
      auto& outflow = blocks_[b].account.outflow;
      for (int c = density; c <= energy; ++c) outflow[c] += sign * area * s.dt * a[a_flux + c][q];
      if (s.two) outflow[second_density] += sign * area * s.dt * a[a_flux + second_density][q];
      if (s.two && s.progress) outflow[progress] += sign * area * s.dt * a[a_progress_flux][q];
    }
  }
}

void Gas::account_watched(int b, int bundle, BundleLayout const& layout, SweepContext const& s, BundleArrays& a) {
  grid::Block const& block = grid_->blocks()[b];
  for (WatchedFace const& face : blocks_[b].watched[s.direction][bundle]) {
    int const q = layout.place(block, face.cell);
    FaceFlux& sum = watched_[face.number];
    double const first = a[a_flux + density][q];
    double const second = s.two ? a[a_flux + second_density][q] : 0.0;
    double const speed = a[a_face_speed][q];
    // What the pressure does is told from what the mass carries by the speed of the face: the flux of momentum is
    // mass flux * speed + pressure.
    double const pressure = a[a_flux + s.normal()][q] - (first + second) * speed;
    sum.mass[0] += s.dt * first;
    sum.mass[1] += s.dt * second;
    for (int d = 0; d < 3; ++d) sum.momentum[d] += s.dt * a[a_flux + momentum_x + d][q];
    sum.momentum[s.direction] -= s.dt * pressure;
    sum.energy += s.dt * (a[a_flux + energy][q] - pressure * speed);
    sum.impulse += s.dt * pressure;
    sum.work += s.dt * pressure * speed;
    sum.volume += s.dt * speed;
  }
}

void Gas::restore_held(int b, BundleLayout const& layout, BundleArrays& a) const {
  std::vector<Role> const& roles = blocks_[b].roles;
  for_each_run(layout, grid_->blocks()[b], [&](int q, int offset, int count) {
    for (int n = 0; n < count; ++n) {
      if (roles[offset + n] != Role::held) continue;
      for (int c = 0; c < components(); ++c) a[state_array(c)][q + n] = fields_.at(b, c)[offset + n];
    }
  });
}

void Gas::burn_on(int b, BundleLayout const& layout, SweepContext const& s, BundleArrays& a) {
  material::Afterburn const& afterburn = *options_.afterburn;
  if (!s.burning) std::fill_n(a[a_burn], layout.total, 1.0);
  bool released = true;
  if (auto const* constant = std::get_if<material::ConstantRateAfterburn>(&afterburn.rate)) {
    double const share = constant->progress(time_at_step_end_) - constant->progress(time_at_step_end_ - s.dt);
    released = share > 0.0;
    if (released) release_at_once(layout, afterburn.energy * share, a);
  } else {
    release_after_miller(layout, s.dt, afterburn.energy, std::get<material::MillerAfterburn>(afterburn.rate), a);
  }
  if (!released) return;
  grid::Block const& block = grid_->blocks()[b];
  double const* const release = a[a_release];
  double sum = 0.0;
  for_each_run(layout, block, [&](int q, int offset, int count) {
    for (int n = 0; n < count; ++n) {
      sum += release[q + n] * block.volume(block.column(offset + n));
    }
  });
  blocks_[b].account.afterburn_energy += sum;
}

void Gas::measure(int b, BundleLayout const& layout, SweepContext const& s, BundleArrays& a, GuardCount& guards) {
  grid::Block const& block = grid_->blocks()[b];
  int const dims = grid_->domain().dimensions();
  for (int r = 0; r < layout.rows; ++r) {
    double const fastest = s.two ? signals<true>(s, layout, a, layout.begin(r), layout.count(), dims, guards)
                                 : signals<false>(s, layout, a, layout.begin(r), layout.count(), dims, guards);
    blocks_[b].signal = std::max(blocks_[b].signal, fastest);
  }
  if (grid::radial_exponent(grid_->domain().geometry) > 0 && block.in_domain().lower[0] == 0) {
    // What leaves a cell at an axis or a centre empties it two or three times as fast.
    grid::Shell const inmost = grid_->shell(block, 0);
    double const factor = (inmost.high_area - inmost.low_area) * block.h() / inmost.volume;
    for_each_row_begin(layout, block, [&](int q) {
      double const rho = a[density][q] + (s.two ? a[second_density][q] : 0.0);
      blocks_[b].signal = std::max(blocks_[b].signal, factor * a[momentum_x][q] / rho);
    });
  }
  if (!options_.peak_fields || s.dt <= 0.0) return;
  int const cells = block.cell_count();
  double* const peak = peaks_[b].data() + static_cast<std::ptrdiff_t>(peak_pressure) * cells;
  double* const running = peaks_[b].data() + static_cast<std::ptrdiff_t>(running_impulse) * cells;
  double* const largest = peaks_[b].data() + static_cast<std::ptrdiff_t>(largest_impulse) * cells;
  double const ambient = quiet_pressure_;
  double const* const p = a[a_p];
  double const dt = s.dt;
  for_each_run(layout, block, [&](int q, int offset, int count) {
    BRISANCE_VECTOR_LOOP
    for (int n = 0; n < count; ++n) {
      double const over = p[q + n] - ambient;
      peak[offset + n] = std::max(peak[offset + n], over);
      running[offset + n] += over * dt;
      largest[offset + n] = std::max(largest[offset + n], running[offset + n]);
    }
  });
}

void Gas::sweep_block(int b, SweepContext const& sweep, bool last, BundleArrays& a) {
  grid::Block const& block = grid_->blocks()[b];
  BlockData& data = blocks_[b];
  if (last) data.signal = 0.0;
  bool const at_boundary = block.at_boundary(2 * sweep.direction) || block.at_boundary(2 * sweep.direction + 1);
  grid::Bundles const bundles(block, sweep.direction, options_.bundle_cells);
  for (int index = 0; index < bundles.count(); ++index) {
    BundleLayout const layout = bundles.layout(index);
    SweepContext s = sweep;
    s.h = block.h();
    load_bundle(b, layout, s, a);
    GuardCount guards;
    auto const& near_walls = data.near_walls[sweep.direction];
    s.near_walls = near_walls.empty() || near_walls[index].empty() ? nullptr : &near_walls[index];
    if (s.two)
      primitives<true>(s, layout, a, guards);
    else
      primitives<false>(s, layout, a, guards);
    bool checked = false;
    if (options_.scheme == Scheme::muscl_hancock) {
      checked = s.two ? muscl_hancock<true>(s, layout, a, guards) : muscl_hancock<false>(s, layout, a, guards);
    } else {
      if (s.two)
        lax_wendroff<true>(s, layout, a, guards);
      else
        lax_wendroff<false>(s, layout, a, guards);
    }
    if (s.two && s.progress) progress_fluxes(s, layout, a);
    if (at_boundary) account_boundaries(b, layout, s, a);
    if (!data.watched[s.direction].empty()) account_watched(b, index, layout, s, a);
    update(layout, s, a);
    if (checked && s.two) expand_cold_products(s, layout, a);
    if (!data.roles.empty()) restore_held(b, layout, a);
    if (last && s.two && options_.afterburn) burn_on(b, layout, s, a);
    if (last) measure(b, layout, s, a, guards);
    store(b, layout, s, a);
    data.account.fallback_faces += guards.fallback_faces;
    for (Lift const& lift : guards.lifts) {
      for_each_run(layout, block, [&](int q, int offset, int count) {
        if (lift.q < q || lift.q >= q + count) return;
        int const at = offset + lift.q - q;
        if (role(b, at) != Role::own && lift.finite) return;
        double const volume = block.volume(block.column(at));
        ++data.account.guarded_cells;
        data.account.guard_mass += lift.mass * volume;
        data.account.guard_energy += lift.energy * volume;
        if (!lift.finite && data.not_a_number < 0) data.not_a_number = at;
      });
    }
  }
}

void Gas::measure_all() {
  SweepContext context;
  context.fluids = &fluids_;
  context.most_H = most_H();
  parallel_for(grid_->block_count(), [&](int b, int thread) {
    grid::Block const& block = grid_->blocks()[b];
    BundleArrays& a = workspaces_[thread];
    blocks_[b].signal = 0.0;
    grid::Bundles const bundles(block, 0, options_.bundle_cells);
    for (int index = 0; index < bundles.count(); ++index) {
      BundleLayout const layout = bundles.layout(index);
      SweepContext s = context;
      s.h = block.h();
      s.two = fluids_.two;
      s.burning = s.two && !blocks_[b].burn_times.empty() && burning();
      for_each_run(layout, block, [&](int q, int offset, int count) {
        for (int c = 0; c < components(); ++c) std::copy_n(fields_.at(b, c) + offset, count, a[state_array(c)] + q);
      });
      if (s.burning) load_burn(b, layout, a);
      GuardCount ignored;
      measure(b, layout, s, a, ignored);
    }
  });
  fastest_signal_ = largest_at_hand(grid_->block_count(), 0.0, [this](int b) { return blocks_[b].signal; });
}

}  // namespace brisance::gas
