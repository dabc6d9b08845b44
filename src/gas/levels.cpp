#include "gas/levels.hpp"

#include <algorithm>
#include <utility>

#include "core/loops.hpp"
#include "core/parallel.hpp"
#include "grid/exchange_plan.hpp"
#include "grid/fine_cells.hpp"
#include "grid/means.hpp"

namespace brisance::gas {

grid::CellRange Levels::cells_at(grid::Block const& block, int direction, Plane plane) {
  grid::CellRange cells = block.interior();
  int const layer = plane == Plane::low    ? 0
                    : plane == Plane::high ? block.n[direction] - 1
                                           : block.size[direction] / 2 - 1;
  cells.lower[direction] = layer;
  cells.upper[direction] = layer + 1;
  return cells;
}

Levels::Contact Levels::contact_at(grid::Block const& fine, int face) const {
  int const d = face / 2;
  Contact contact;
  contact.fine = fine.number;
  contact.face = face;
  grid::CellRange const own = fine.in_domain();
  grid::CellRange& core = contact.core;
  core = grid::coarse_cells(own, grid_->domain().dimensions());
  core.lower[d] = face % 2 == 0 ? own.lower[d] / 2 - 1 : own.upper[d] / 2;
  core.upper[d] = core.lower[d] + 1;
  contact.coarse = grid::coarser_block_beyond(*grid_, fine, face);
  grid::Block const& coarse = grid_->blocks()[contact.coarse];
  Index3 const beside = grid::image_cell(grid_->domain_of(coarse), core.lower);
  int const layer = coarse.cell_with(beside).within()[d];
  bool const fine_is_above = face % 2 == 0;
  contact.plane = fine_is_above && layer == coarse.n[d] - 1 ? Plane::high
                  : !fine_is_above && layer == 0            ? Plane::low
                                                            : Plane::middle;
  return contact;
}

Levels::Strip Levels::strip_at(Contact const& contact, IsSolid const& is_solid) const {
  int const level = grid_->blocks()[contact.coarse].level;
  int const dims = grid_->domain().dimensions();
  grid::Domain const& domain = grid_->domain(level);
  Strip strip;
  strip.box = contact.core.grown(1, dims);
  strip.holds.assign(strip.box.count(), Holds::nothing);
  // Slopes look at faces: what lies beyond an edge of the core has no say.
  auto const beyond = [&](Index3 const& cell, int d) {
    return cell[d] < contact.core.lower[d] || cell[d] >= contact.core.upper[d] ? 1 : 0;
  };
  auto const take_row = [&](grid::Block const& block, Index3 const& index, Index3 const& first, int count) {
    if (beyond(first, 1) + beyond(first, 2) > 1) return;
    grid::Cell const cell = block.cell_with(index);
    std::size_t const place = strip.box.offset(first);
    strip.rows.push_back({block.number, cell.offset, count, place});
    for (int i = 0; i < count; ++i) {
      bool const solid = is_solid && is_solid(block.cell_with({index[0] + i, index[1], index[2]}));
      strip.holds[place + i] = solid ? Holds::solid : Holds::gas;
    }
    if (strip.blocks.empty() || strip.blocks.back() != block.number) strip.blocks.push_back(block.number);
  };
  if (grid::common(strip.box, domain.all_cells()).count() == strip.box.count()) {
    grid_->for_each_block_in(level, strip.box, [&](grid::Block const& block, grid::CellRange const& cells) {
      for_each_row(cells, [&](Index3 const& first) { take_row(block, first, first, cells.n(0)); });
    });
  } else {
    for_each_cell(strip.box, [&](Index3 const& cell) {
      Index3 image = cell;
      if (!CoarsePatch::find_image(domain, image)) return;
      int const block = grid_->block_of(level, image);
      if (block != grid::no_neighbour) take_row(grid_->blocks()[block], image, cell, 1);
    });
  }
  std::sort(strip.blocks.begin(), strip.blocks.end());
  strip.blocks.erase(std::unique(strip.blocks.begin(), strip.blocks.end()), strip.blocks.end());
  return strip;
}

void Levels::close(Contact& contact, Strip const& strip) {
  int const d = contact.face / 2;
  bool any = false;
  contact.closed.clear();
  for_each_cell(contact.core, [&](Index3 const& cell) {
    Index3 const behind = grid::beside(cell, d, 1 - contact.face % 2);
    bool const closed =
        strip.holds[strip.box.offset(cell)] == Holds::solid || strip.holds[strip.box.offset(behind)] == Holds::solid;
    contact.closed.push_back(closed ? 1 : 0);
    any = any || closed;
  });
  if (!any) contact.closed.clear();
}

Levels::Levels(grid::Grid const& grid, Fluids const& fluids, int components, IsSolid const& is_solid)
    : grid_(&grid),
      fluids_(fluids),
      components_(components),
      covered_(grid.levels()),
      contacts_(grid.levels()),
      strips_(grid.levels()),
      strip_of_(grid, std::array<int, 6>{-1, -1, -1, -1, -1, -1}),
      registers_(grid.blocks().size()),
      clock_(grid.levels()) {
  for (grid::Block const& block : grid.blocks()) {
    if (block.covered_parts != 0) covered_[block.level].push_back(block.number);
    for (int face = 0; face < 6; ++face) {
      if (block.beyond[face] != grid::Beyond::coarser) continue;
      std::vector<Contact>& contacts = contacts_[block.level - 1];
      strip_of_[block.number][face] = static_cast<int>(contacts.size());
      contacts.push_back(contact_at(block, face));
      auto const make = [&](grid::Block const& of, Plane plane) {
        auto& sum = registers_[of.number][number_of(face / 2, plane)].sum;
        if (sum.empty()) sum.assign(cells_at(of, face / 2, plane).count() * values(), 0.0);
      };
      make(block, face % 2 == 0 ? Plane::low : Plane::high);
      make(grid.blocks()[contacts.back().coarse], contacts.back().plane);
    }
  }
  for (int level = 0; level < grid.levels(); ++level) {
    std::vector<Contact>& contacts = contacts_[level];
    strips_[level].resize(contacts.size());
    parallel_for(static_cast<int>(contacts.size()), [&](int n, int) {
      strips_[level][n] = strip_at(contacts[n], is_solid);
      if (is_solid) close(contacts[n], strips_[level][n]);
    });
  }
}

void Levels::set_quiescent(Components const& state, std::array<Components, 3> const& flux, Vec3 const& velocity) {
  quiet_ = state;
  quiet_flux_ = flux;
  quiet_velocity_ = velocity;
}

void Levels::gather(grid::Fields const& fields, grid::AwakeBlocks const& awake, Strip& strip, int stage) const {
  auto const is_awake = [&](int block) { return awake[block] != 0; };
  bool const quiet = std::none_of(strip.blocks.begin(), strip.blocks.end(), is_awake);
  if (stage == 0) strip.quiet = quiet;
  if (quiet && strip.quiet) return;
  std::size_t const pitch = strip.box.count();
  auto const make = [&](int of) {
    if (strip.stages[of].empty()) strip.stages[of].assign(pitch * components_, 0.0);
    return strip.stages[of].data();
  };
  if (strip.quiet) {  // it has been disturbed since
    strip.quiet = false;
    for (int before = 0; before < stage; ++before) {
      double* const cells = make(before);
      for (int c = 0; c < components_; ++c) std::fill_n(cells + pitch * c, pitch, quiet_[c]);
    }
  }
  double* const cells = make(stage);
  for (int c = 0; c < components_; ++c) {
    for (Strip::Row const& row : strip.rows)
      std::copy_n(fields.at(row.block, c) + row.offset, row.count, cells + pitch * c + row.place);
  }
}

void Levels::begin_step(grid::Fields const& fields, grid::AwakeBlocks const& awake, int level,
                        std::vector<int> const& order) {
  clock_[level].order = order;
  clock_[level].sweeps = 0;
  std::vector<Strip>& strips = strips_[level];
  parallel_for(static_cast<int>(strips.size()), [&](int n, int) { gather(fields, awake, strips[n], 0); });
}

void Levels::end_sweep(grid::Fields const& fields, grid::AwakeBlocks const& awake, int level) {
  int const stage = ++clock_[level].sweeps;
  std::vector<Strip>& strips = strips_[level];
  parallel_for(static_cast<int>(strips.size()), [&](int n, int) { gather(fields, awake, strips[n], stage); });
}

void Levels::begin_fine_step(int level, double begun, double length) {
  clock_[level].begun = begun;
  clock_[level].length = length;
  clock_[level].done = {false, false, false};
}

std::vector<double> Levels::at_present(Strip const& strip, int coarse_level) const {
  Clock const& coarse = clock_[coarse_level];
  Clock const& fine = clock_[coarse_level + 1];
  std::vector<double> u = strip.stages[0];
  auto const add = [&u](double part, std::vector<double> const& before, std::vector<double> const& after) {
    double* const to = u.data();
    double const* const from = before.data();
    double const* const until = after.data();
    auto const count = static_cast<int>(u.size());
    BRISANCE_VECTOR_LOOP
    for (int n = 0; n < count; ++n) to[n] += part * (until[n] - from[n]);
  };
  if (fine.begun > 0.0) add(fine.begun, strip.stages[0], strip.stages[coarse.sweeps]);
  for (int n = 0; n < coarse.sweeps; ++n) {
    if (fine.done[coarse.order[n]]) add(fine.length, strip.stages[n], strip.stages[n + 1]);
  }
  return u;
}

void Levels::fill(int b, int face, double* ghosts) const {
  grid::Block const& block = grid_->blocks()[b];
  int const level = block.level - 1;
  int const dims = grid_->domain().dimensions();
  int const number = strip_of_[b][face];
  Strip const& strip = strips_[level][number];
  Contact const& contact = contacts_[level][number];
  std::size_t const pitch = grid::ghost_box(block, face / 2).count();
  if (strip.quiet) {
    for (int c = 0; c < components_; ++c) std::fill_n(ghosts + pitch * c, pitch, quiet_[c]);
    return;
  }
  CoarsePatch patch(fluids_, components_, grid_->domain(level), contact.core);
  std::vector<double> const cells = at_present(strip, level);
  for (std::size_t n = 0; n < strip.holds.size(); ++n) {
    if (strip.holds[n] == Holds::nothing) continue;
    Components u{};
    for (int c = 0; c < components_; ++c) u[c] = cells[strip.holds.size() * c + n];
    if (strip.holds[n] == Holds::solid)
      patch.set_solid(n, u);
    else
      patch.set(n, u);
  }
  grid::CellRange const beyond = grid::ghosts_in_domain(block, face);
  Prolongation::Parts parts;
  for_each_cell(contact.core, [&](Index3 const& cell) {
    patch.split(cell, block.metric, parts);
    int part = 0;
    for_each_cell(grid::fine_cells(cell, dims), [&](Index3 const& fine) {
      std::size_t const at = beyond.offset(fine);
      for (int c = 0; c < components_; ++c) ghosts[pitch * c + at] = parts[part][c];
      ++part;
    });
  });
}

double* Levels::entry(int block, int direction, Plane plane, grid::Cell const& cell) {
  grid::CellRange const cells = cells_at(grid_->blocks()[block], direction, plane);
  Index3 at = cell.within();
  at[direction] = cells.lower[direction];
  return registers_[block][number_of(direction, plane)].sum.data() + cells.offset(at) * values();
}

void Levels::count(int b, BundleLayout const& layout, Plane plane, SweepContext const& s, BundleArrays& a) {
  grid::Block const& block = grid_->blocks()[b];
  int const layer = cells_at(block, s.direction, plane).lower[s.direction];
  int const side = plane == Plane::low ? 0 : 1;
  Components const& quiet = quiet_flux_[s.direction];
  for (int line = 0; line < layout.lines(); ++line) {
    // Face q lies above cell q.
    int q = s.direction == 0 ? layout.begin(line) : layout.begin(0) + line;
    q += (layer - 1 + side) * layout.stride;
    Index3 at = layout.end_cell(block, 0, line).within();
    at[s.direction] = layer;
    grid::Cell const cell = block.cell(at);
    double const weight = block.face_area(s.direction, side, cell) * s.dt;
    double* const sum = entry(b, s.direction, plane, cell);
    for (int c = 0; c <= energy; ++c) sum[c] += weight * (a[a_flux + c][q] - quiet[c]);
    for (int k = 1; k < s.present; ++k) {
      sum[partial_density(k)] += weight * a[a_flux + partial_density(k)][q];
      sum[volume_fraction(k)] += weight * a[a_flux + volume_fraction(k)][q];
    }
    if (s.progress) sum[progress] += weight * a[a_progress_flux][q];
    sum[components_] += weight * (a[a_face_speed][q] - quiet_velocity_[s.direction]);
  }
}

std::vector<grid::Cell> Levels::correct(grid::Fields& fields, Contact const& contact) {
  int const d = contact.face / 2;
  int const dims = grid_->domain().dimensions();
  grid::Block const& fine = grid_->blocks()[contact.fine];
  grid::Block const& coarse = grid_->blocks()[contact.coarse];
  double const outwards = contact.face % 2 == 0 ? 1.0 : -1.0;  // of the coarse cell
  Plane const fine_plane = contact.face % 2 == 0 ? Plane::low : Plane::high;
  std::vector<grid::Cell> changed;
  for_each_cell(contact.core, [&](Index3 const& index) {
    // Where the block lies behind a periodic boundary the core does not lie in it.
    grid::Cell const cell = *grid_->locate(coarse.level, grid::image_cell(grid_->domain_of(coarse), index));
    std::array<double, most_components + 1> more{};
    double* const own = entry(contact.coarse, d, contact.plane, cell);
    for (int c = 0; c < values(); ++c) more[c] = -std::exchange(own[c], 0.0);
    grid::CellRange parts = grid::fine_cells(index, dims);
    grid::CellRange const own_cells = fine.in_domain();
    parts.lower[d] = contact.face % 2 == 0 ? own_cells.lower[d] : own_cells.upper[d] - 1;
    parts.upper[d] = parts.lower[d] + 1;
    for_each_cell(parts, [&](Index3 const& part) {
      double* const sum = entry(contact.fine, d, fine_plane, *grid_->locate(fine.level, part));
      for (int c = 0; c < values(); ++c) more[c] += std::exchange(sum[c], 0.0);
    });
    if (!contact.closed.empty() && contact.closed[contact.core.offset(index)] != 0) return;
    if (std::all_of(more.begin(), more.begin() + values(), [](double x) { return x == 0.0; })) return;
    double const scale = outwards / coarse.volume(cell);
    for (int c = 0; c < components_; ++c) {
      if (c == shock) continue;
      double& u = fields.at(coarse.number, c)[cell.offset];
      // A volume fraction changes by its flux less what the flow compresses.
      u -= scale * (more[c] - (is_volume_fraction(c) ? u * more[components_] : 0.0));
    }
    changed.push_back(cell);
  });
  return changed;
}

void Levels::find_means(grid::Fields& fields, grid::AwakeBlocks const& awake, std::vector<int> const& blocks,
                        std::vector<std::uint8_t>& disturbed) const {
  int const dims = grid_->domain().dimensions();
  parallel_for(static_cast<int>(blocks.size()), [&](int n, int) {
    grid::Block const& block = grid_->blocks()[blocks[n]];
    grid_->for_each_block_in(block.level + 1, grid::fine_cells(block.in_domain(), dims),
                             [&](grid::Block const& fine, grid::CellRange const&) {
                               // Both hold quiescent gas alone.
                               if (awake[fine.number] == 0 && awake[block.number] == 0) return;
                               if (find_means(fields, block, fine)) disturbed[n] = 1;
                             });
  });
}

bool Levels::find_means(grid::Fields& fields, grid::Block const& coarse, grid::Block const& fine) const {
  grid::CellRange const cells = grid::coarse_cells(fine.in_domain(), grid_->domain().dimensions());
  grid::CellRange const box = coarse.in_domain();
  bool quiet = true;
  for (int c = 0; c < components_; ++c) {
    double* const to = fields.at(coarse.number, c);
    grid::take_means(fine, fields.at(fine.number, c), box, to);
    for_each_row(
        cells, [&](Index3 const& first) { quiet = quiet && all_equal(to + box.offset(first), cells.n(0), quiet_[c]); });
  }
  return !quiet;
}

}  // namespace brisance::gas
