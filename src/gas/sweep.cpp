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
#include "gas/schemes/schemes.hpp"

namespace brisance::gas {

void Gas::load_burn(int b, BundleLayout const& layout, BundleArrays& a) const {
  grid::Block const& block = grid_->blocks()[b];
  double* const F = a[a_burn];
  load_with_ghosts(
      layout, block, burn.times(b).data(), [this](BurnTime const& times) { return burn.fraction(times); }, F);
  // A row without products is calculated without their burn, and so are cells that hold none of them.
  double const* const alpha = a[volume_fraction(products_fluid)];
  for (int q = 0; q < layout.total; ++q) F[q] = burn.is_trace(alpha[q]) ? 1.0 : F[q];
}

grid::GhostSide Gas::ghosts_beyond(int b, int side, BundleLayout const& layout) const {
  return {layout, *grid_, exchange_, fields_, b, side};
}

void Gas::load_bundle(int b, BundleLayout const& layout, SweepContext& s, Workspace& w) const {
  grid::Block const& block = grid_->blocks()[b];
  BundleArrays& a = w.arrays;
  grid::GhostSide const low = ghosts_beyond(b, 0, layout);
  grid::GhostSide const high = ghosts_beyond(b, 1, layout);
  auto const load_component = [&](int c) {
    double* const to = a[state_array(c)];
    grid::load(layout, block, fields_.at(b, c), w.kept.cells_below(layout, c, low), high.cells(c), to);
    if (!high.in_slab()) w.kept.keep(layout, c, to);
  };
  for (int c = 0; c <= energy; ++c) load_component(c);
  if (s.shock_sensor) load_component(shock);
  // Rows of the ambient fluid alone cost what a single fluid costs. Faces of such a row carry no other, also seen from
  // the other side.
  int present = 1;
  for (int k = 1; k < fluids_.count; ++k) {
    load_component(volume_fraction(k));
    if (count_beyond(a[volume_fraction(k)], layout.total, vanishing_fraction) > 0) present = fluids_.count;
  }
  set_present(present, s);
  for (int k = 1; k < s.present; ++k) load_component(partial_density(k));
  s.progress = s.progress && s.present > products_fluid;
  if (s.progress) load_component(progress);
  auto const& solid = obstacles.solid(b);
  s.solid = !solid.empty();
  if (s.solid) {
    load_with_ghosts(
        layout, block, solid.data(), [](std::uint8_t x) { return x ? 1.0 : 0.0; }, a[a_solid]);
  }
  s.burning = s.present > products_fluid && burn.burning_in(b);
  if (s.burning) {
    load_burn(b, layout, a);
  }
  if (s.radial) load_shells(b, layout, s, a);
}

Gas::Shells Gas::shells_of(grid::Grid const& grid, grid::Block const& block) {
  Shells shells;
  if (grid::radial_exponent(grid.domain().geometry) == 0) return shells;
  for (int l = -grid::ghost_layers; l < block.n[0] + grid::ghost_layers; ++l) {
    grid::Shell const shell = grid.shell(block, l);
    shells.high.push_back(shell.high_area / shell.volume);
    shells.low.push_back(shell.low_area / shell.volume);
    // A mirror turns the velocity round, but its image spreads as the original does: the ratio of the two must keep its
    // sign.
    double const side = shell.mirrored ? -0.5 : 0.5;
    shells.spread.push_back(side * (shell.high_area - shell.low_area) / shell.volume);
  }
  return shells;
}

void Gas::load_shells(int b, BundleLayout const& layout, SweepContext const& s, BundleArrays& a) const {
  Shells const& shells = shells_[b];
  int const whole_row = layout.length + 2 * grid::ghost_layers;
  auto const load = [&](std::vector<double> const& from, int name) {
    for (int r = 0; r < layout.rows; ++r) {
      double* const to = a[name] + layout.begin(r) - grid::ghost_layers;
      for (int l = 0; l < whole_row; ++l) to[l] = s.dt * from[l];
    }
  };
  load(shells.high, a_area_high);
  load(shells.low, a_area_low);
  load(shells.spread, a_expansion);
}

void Gas::store(int b, BundleLayout const& layout, SweepContext const& s, BundleArrays& a) {
  grid::Block const& block = grid_->blocks()[b];
  auto const store_component = [&](int name, int c) {
    double const* from = a[name];
    double* to = fields_.at(b, c);
    for_each_run(layout, block, [=](int q, int offset, int count) { grid::copy_run(from + q, count, to + offset); });
  };
  for (int c = 0; c <= energy; ++c) store_component(a_state + c, c);
  if (s.shock_sensor) store_component(a_sensor, shock);
  for (int k = 1; k < s.present; ++k) {
    store_component(a_state + partial_density(k), partial_density(k));
    store_component(a_state + volume_fraction(k), volume_fraction(k));
  }
  if (s.progress) store_component(a_progress, progress);
}

void Gas::account_boundaries(int b, BundleLayout const& layout, SweepContext const& s, BundleArrays& a,
                             Account& account) const {
  grid::Block const& block = grid_->blocks()[b];
  for (int side = 0; side < 2; ++side) {
    if (!block.at_boundary(2 * s.direction + side) || block.covered) continue;
    double const sign = side == 0 ? -1.0 : 1.0;
    bool const is_cut = cut.cut_boundary(b, 2 * s.direction + side);
    for (int line = 0; line < layout.lines(); ++line) {
      // Face below the first or above the last of the block's own cells.
      int q = s.direction == 0 ? layout.begin(line) : layout.begin(0) + line;
      q += side == 0 ? -layout.stride : (layout.length - 1) * layout.stride;
      grid::Cell const cell = layout.end_cell(block, side, line);
      if (!coupling.is_own(cell) || block.is_covered(cell)) continue;
      double const area = is_cut ? cut.area(cell, s.direction, side) : block.face_area(s.direction, side, cell);
      Components& outflow = account.outflow;
      for (int c = 0; c <= energy; ++c) outflow[c] += sign * area * s.dt * a[a_flux + c][q];
      for (int k = 1; k < s.present; ++k) {
        int const c = partial_density(k);
        outflow[c] += sign * area * s.dt * a[a_flux + c][q];
      }
      if (s.progress) outflow[progress] += sign * area * s.dt * a[a_progress_flux][q];
    }
  }
}

void Gas::account_watched(int b, int bundle, BundleLayout const& layout, SweepContext const& s, BundleArrays& a) {
  grid::Block const& block = grid_->blocks()[b];
  for (Coupling::WatchedFace const& face : coupling.faces(b, s.direction, bundle)) {
    int const q = layout.place(block, face.cell);
    FaceFlux& sum = coupling.flux(face.number);
    auto const flux_of = [&](int c) { return a[a_flux + c][q]; };
    double const speed = a[a_face_speed][q];
    // What the pressure does is told from what the mass carries by the speed of the face: the flux of momentum is
    // mass flux * speed + pressure.
    double const pressure = a[a_flux + s.normal()][q] - mixture_density(s.present, flux_of) * speed;
    Amounts& carried = sum.carried;
    for (int k = 0; k < s.present; ++k) carried.mass[k] += s.dt * flux_of(partial_density(k));
    for (int d = 0; d < 3; ++d) carried.momentum[d] += s.dt * flux_of(momentum_x + d);
    carried.momentum[s.direction] -= s.dt * pressure;
    carried.energy += s.dt * (flux_of(energy) - pressure * speed);
    carried.volume += s.dt * speed;
    sum.impulse += s.dt * pressure;
    sum.work += s.dt * pressure * speed;
  }
}

void Gas::restore_frozen(int b, BundleLayout const& layout, BundleArrays& a) const {
  std::vector<Role> const& roles = coupling.roles(b);
  for_each_run(layout, grid_->blocks()[b], [&](int q, int offset, int count) {
    for (int n = 0; n < count; ++n) {
      if (roles[offset + n] != Role::frozen) continue;
      for (int c = 0; c < components(); ++c) a[state_array(c)][q + n] = fields_.at(b, c)[offset + n];
    }
  });
}

void Gas::burn_on(int b, BundleLayout const& layout, SweepContext const& s, BundleArrays& a, Account& account) const {
  material::Afterburn const& afterburn = *options_.afterburn;
  if (!s.burning) std::fill_n(a[a_burn], layout.total, 1.0);
  bool released = true;
  std::visit(
      [&](auto const& law) {
        if constexpr (requires { law.progress(0.0); }) {
          double const share = law.progress(time_at_step_end_) - law.progress(time_at_step_end_ - s.dt);
          released = share > 0.0;
          if (released) release_at_once(layout, afterburn.energy * share, a);
        } else {
          release_by_law(layout, s.dt, afterburn.energy, law, a);
        }
      },
      afterburn.rate);
  if (!released) return;
  grid::Block const& block = grid_->blocks()[b];
  double const* const release = a[a_release];
  bool const has_cut_cells = cut.in(b);
  auto const volume = [&](int at) {
    return has_cut_cells ? cut.volume(block.cell_at(at)) : block.volume(block.column(at));
  };
  if (block.covered) return;
  double sum = 0.0;
  for_each_run(layout, block, [&](int q, int offset, int count) {
    for (int n = 0; n < count; ++n) {
      if (block.covered_parts != 0 && block.is_covered(block.cell_at(offset + n))) continue;
      sum += release[q + n] * volume(offset + n);
    }
  });
  account.afterburn_energy += sum;
}

void Gas::measure(int b, int index, BundleLayout const& layout, SweepContext const& s, BundleArrays& a,
                  GuardCount& guards, Tally& tally) {
  grid::Block const& block = grid_->blocks()[b];
  int const dims = grid_->domain().dimensions();
  for (int r = 0; r < layout.rows; ++r) {
    double const fastest = signals(s, layout, a, layout.begin(r), layout.count(), dims, guards);
    tally.signal = std::max(tally.signal, fastest);
  }
  if (grid::radial_exponent(grid_->domain().geometry) > 0 && block.in_domain().lower[0] == 0) {
    // What leaves a cell at an axis or a centre empties it two or three times as fast.
    grid::Shell const inmost = grid_->shell(block, 0);
    double const factor = (inmost.high_area - inmost.low_area) * block.h() / inmost.volume;
    for_each_row_begin(layout, block, [&](int q) {
      double const rho = mixture_density(s, a, q);
      tally.signal = std::max(tally.signal, factor * a[momentum_x][q] / rho);
    });
  }
  if (s.dt > 0.0) keep_peaks(b, index, s, a);
  if (s.dt > 0.0) peaks_.follow(b, layout, a[a_p], quiet_.pressure, s.dt);
}

void Gas::account_guards(int b, BundleLayout const& layout, GuardCount const& guards, Tally& tally) const {
  grid::Block const& block = grid_->blocks()[b];
  if (!block.covered) tally.account.fallback_faces += guards.fallback_faces;
  for (Lift const& lift : guards.lifts) {
    for_each_run(layout, block, [&](int q, int offset, int count) {
      if (lift.q < q || lift.q >= q + count) return;
      int const at = offset + lift.q - q;
      bool const is_own = coupling.role(b, at) == Role::own && !block.is_covered(block.cell_at(at));
      if (!is_own && lift.finite) return;
      double const volume = cut.volume(block.cell_at(at));
      ++tally.account.guarded_cells;
      tally.account.guard_mass += lift.mass * volume;
      tally.account.guard_energy += lift.energy * volume;
      if (!lift.finite && tally.not_a_number < 0) tally.not_a_number = at;
    });
  }
}

std::vector<Gas::Part> Gas::make_parts(int level, int direction) const {
  std::vector<Part> parts;
  int tally = 0;
  for (grid::Chain const& chain : exchange_.plan().chains(direction)) {
    if (grid_->blocks()[chain.front()].level != level) continue;
    long cells = 0;
    for (int const b : chain) cells += grid_->blocks()[b].cell_count();
    int const bundles = grid::Bundles(grid_->blocks()[chain.front()], direction, options_.bundle_cells).count();
    int const count = static_cast<int>(std::clamp<long>(cells / options_.part_cells, 1, bundles));
    for (int n = 0; n < count; ++n) {
      parts.push_back({&chain, bundles * n / count, bundles * (n + 1) / count, tally});
      tally += static_cast<int>(chain.size());
    }
  }
  return parts;
}

grid::Ahead Gas::ahead_of(Part const& part, int position, int index, SweepContext const& s,
                          grid::AwakeBlocks const& awake, bool last) const {
  grid::Chain const& chain = *part.chain;
  int const blocks = static_cast<int>(chain.size());
  if (++index == part.end) {
    index = part.first;
    do {
      if (++position == blocks) return {};
    } while (!is_swept(chain[position], awake));
  }
  int const b = chain[position];
  int const behind = position + 1 < blocks ? chain[position + 1] : grid::no_neighbour;
  bool const ends = behind == grid::no_neighbour;
  grid::Block const& block = grid_->blocks()[b];
  BundleLayout const layout = grid::Bundles(block, s.direction, options_.bundle_cells).layout(index);
  grid::Ahead ahead(layout, block, ends ? nullptr : &grid_->blocks()[behind]);
  int const read = s.present > 1 ? components() : components_of(1);
  grid::GhostSide const low = ghosts_beyond(b, 0, layout);
  grid::GhostSide const high = ghosts_beyond(b, 1, layout);
  for (int c = 0; c < read; ++c) {
    ahead.add(fields_.at(b, c), ends ? nullptr : fields_.at(behind, c));
    if (low.in_slab()) grid::prefetch(layout, low.cells(c));
    if (high.in_slab()) grid::prefetch(layout, high.cells(c));
  }
  if (last) peaks_.announce(b, ahead);
  return ahead;
}

void Gas::sweep_part(Part const& part, SweepContext const& sweep, grid::AwakeBlocks const& awake, bool last,
                     Workspace& w) {
  grid::Chain const& chain = *part.chain;
  grid::Bundles const first(grid_->blocks()[chain.front()], sweep.direction, options_.bundle_cells);
  w.kept.begin(part.first, part.end, first.most_lines(), components());
  for (int position = 0; position < static_cast<int>(chain.size()); ++position) {
    int const b = chain[position];
    Tally& tally = tallies_[part.tally + position];
    tally = {};
    if (!awake[b]) account_asleep(b, part, sweep.direction, sweep.dt, tally.account);
    grid::Bundles const bundles(grid_->blocks()[b], sweep.direction, options_.bundle_cells);
    for (int index = part.first; index < part.end; ++index) {
      w.kept.turn(index);
      if (!is_swept(b, awake)) continue;
      BundleLayout const layout = bundles.layout(index);
      if (sweep.rests && coupling.roles(b).empty() && rests(b, index, layout, w.kept)) {
        account_quiet(b, layout, sweep.direction, sweep.dt, tally.account);
        if (last) tally.signal = std::max(tally.signal, quiet_.signal);
        continue;
      }
      SweepContext s = sweep;
      s.h = grid_->blocks()[b].h();
      load_bundle(b, layout, s, w);
      s.ahead = ahead_of(part, position, index, s, awake, last);
      sweep_bundle(b, index, layout, s, last, w.arrays, tally);
    }
  }
}

void Gas::sweep_bundle(int b, int index, BundleLayout const& layout, SweepContext& s, bool last, BundleArrays& a,
                       Tally& tally) {
  grid::Block const& block = grid_->blocks()[b];
  GuardCount guards;
  s.near_walls = obstacles.near_walls(b, s.direction, index);
  announce_nodes(b, s.direction, index);
  // `FacePass` asks for the next bundle; the other scheme has no pass that does.
  for (int n = 0; options_.scheme != Scheme::muscl_hancock && n < s.ahead.lines(); ++n) s.ahead.fetch(n);
  primitives(s, layout, a, guards);
  bool const checked = face_fluxes(options_.scheme, s, layout, a, guards);
  if (s.progress) progress_fluxes(s, layout, a);
  if (block.at_boundary(2 * s.direction) || block.at_boundary(2 * s.direction + 1))
    account_boundaries(b, layout, s, a, tally.account);
  account_watched(b, index, layout, s, a);
  for (auto const plane : {Levels::Plane::low, Levels::Plane::high, Levels::Plane::middle}) {
    if (levels_.counts(b, s.direction, plane)) levels_.count(b, layout, plane, s, a);
  }
  take_cut_changes(b, index, layout, s, a);
  passes_of(s).update(s, layout, a);
  if (checked && s.present > products_fluid) expand_cold_products(s, layout, a);
  if (!coupling.roles(b).empty()) restore_frozen(b, layout, a);
  if (last && s.present > products_fluid && options_.afterburn) burn_on(b, layout, s, a, tally.account);
  if (last) measure(b, index, layout, s, a, guards, tally);
  take_node_states(b, index, s, a);
  store(b, layout, s, a);
  if (s.rests && coupling.roles(b).empty()) disturbance_.note(b, layout, s, quiet_.state, a);
  account_guards(b, layout, guards, tally);
}

void Gas::measure_all() {
  SweepContext context;
  context.fluids = &fluids_;
  context.most_H = most_H();
  parallel_for(grid_->block_count(), [&](int b, int thread) {
    grid::Block const& block = grid_->blocks()[b];
    BundleArrays& a = workspaces_[thread].arrays;
    blocks_[b].signal = 0.0;
    grid::Bundles const bundles(block, 0, options_.bundle_cells);
    for (int index = 0; index < bundles.count(); ++index) {
      BundleLayout const layout = bundles.layout(index);
      SweepContext s = context;
      s.h = block.h();
      set_present(fluids_.count, s);
      s.burning = s.present > products_fluid && burn.burning_in(b);
      for_each_run(layout, block, [&](int q, int offset, int count) {
        for (int c = 0; c < components(); ++c) std::copy_n(fields_.at(b, c) + offset, count, a[state_array(c)] + q);
      });
      if (s.burning) load_burn(b, layout, a);
      GuardCount ignored;
      measure(b, index, layout, s, a, ignored, blocks_[b]);
    }
  });
  fastest_signal_ = largest_at_hand(grid_->block_count(), 0.0, [this](int b) { return blocks_[b].signal; });
}

}  // namespace brisance::gas
