/// The end of a step: particles move, and those that leave their block go to the next.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "mpm/cells.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

/// Steps between two sorts of the particles, the first one after the first step, and between two looks whether so many
/// have moved that one is due at once: where more than a part of them lies before its predecessor. Of eight to a cell a
/// group with the same nodes has then come apart into two.
constexpr long sort_interval = 24;
constexpr long look_interval = 4;
constexpr double most_backwards = 1.0 / 16.0;

/// What happens to a particle that moved out of its block.
struct Fate {
  bool lost = false;
  bool moved = false;
  Index3 offset{0, 0, 0};  ///< block that it goes to, as -1, 0, 1 per direction
};

/// A particle becomes its mirror image across a plane normal to d: what carries a direction turns.
void turn(ParticleSet& set, int q, int d) {
  for (Quantity const& quantity : quantities) {
    if (quantity.mirror == Mirror::none) continue;
    for (int c = 0; c < quantity.components; ++c) {
      double* const values = turns(quantity.mirror, c, d) ? set.field(quantity.first + c) : nullptr;
      if (values != nullptr) values[q] = -values[q];
    }
  }
}

/// A particle that left the domain through a periodic face comes in again on the other side.
void wrap(ParticleSet& set, int q, int d, grid::Domain const& domain) {
  double& x = set.field(Field::position_x + d)[q];
  double const length = domain.upper(d) - domain.lower[d];
  double const shift = x < domain.lower[d] ? length : x >= domain.upper(d) ? -length : 0.0;
  x += shift;
  if (double* origin = set.field(Field::origin_x + d)) origin[q] += shift;
  if (x < domain.lower[d]) x = domain.lower[d];
  if (x >= domain.upper(d)) x = std::nextafter(domain.upper(d), domain.lower[d]);
}

/// Where a particle goes that may have left its block. In `wild` the direction in which it left by more than a cell.
Fate fate_of(ParticleSet& set, int q, grid::Grid const& grid, int block, Patch const& patch, std::optional<int>& wild) {
  double const inverse_h = 1.0 / patch.h;
  Fate fate;
  for (int d = 0; d < patch.dimensions && !fate.lost; ++d) {
    double& x = set.field(Field::position_x + d)[q];
    double u = (x - patch.first[d]) * inverse_h;
    if (u >= 0.0 && u < patch.cells[d]) continue;
    if (!(u > -1.0 && u < patch.cells[d] + 1.0)) {
      wild = d;
      fate.lost = true;
      break;
    }
    int const side = u < 0.0 ? 0 : 1;
    double const wall = patch.first[d] + side * patch.cells[d] * patch.h;
    Side const next = beyond(grid, block, d, side);
    if (next.mirror) {
      // Velocity normal to a mirror plane vanishes there; what crosses does so by round-off or as a shock arrives, and
      // comes back as its mirror image does.
      x = wall - (x - wall);
      if (x - patch.first[d] >= patch.cells[d] * patch.h) x = std::nextafter(wall, patch.first[d]);
      turn(set, q, d);
    } else if (next.block == grid::no_neighbour) {
      fate.lost = true;
    } else {
      fate.offset[d] = side == 0 ? -1 : 1;
      fate.moved = true;
      if (grid.domain().boundary[2 * d + side] == grid::Boundary::periodic) wrap(set, q, d, grid.domain());
    }
  }
  return fate;
}

/// Adds the way of the step to the places of a set; returns how many points are no longer in its block.
long move_on(ParticleSet& set, Patch const& patch) {
  int const count = set.size();
  double const inverse_h = 1.0 / patch.h;
  long outside = 0;
  for (int d = 0; d < patch.dimensions; ++d) {
    double* x = set.field(Field::position_x + d);
    double const* move = set.field(Field::move_x + d);
    double const first = patch.first[d];
    double const cells = patch.cells[d];
    BRISANCE_VECTOR_LOOP
    for (int q = 0; q < count; ++q) {
      x[q] += move[q];
      double const u = (x[q] - first) * inverse_h;
      outside += (u >= 0.0) & (u < cells) ? 0 : 1;  // NaN counts as outside
    }
  }
  return outside;
}

/// Which points are no longer in the block of a set: 1, the others 0.
void mark_outside(ParticleSet const& set, Patch const& patch, std::vector<int>& marks) {
  int const count = set.size();
  marks.assign(count, 0);
  int* const mark = marks.data();
  double const inverse_h = 1.0 / patch.h;
  for (int d = 0; d < patch.dimensions; ++d) {
    double const* x = set.field(Field::position_x + d);
    double const first = patch.first[d];
    double const cells = patch.cells[d];
    BRISANCE_VECTOR_LOOP
    for (int q = 0; q < count; ++q) {
      double const u = (x[q] - first) * inverse_h;
      mark[q] |= (u >= 0.0) & (u < cells) ? 0 : 1;
    }
  }
}

/// Books a particle that leaves the domain.
void lose(Losses& lost, ParticleSet const& set, int q, Body const& body, BodyRules const& rules, double h) {
  double const m = set.field(Field::mass)[q];
  double square = 0.0;
  for (int d = 0; d < 3; ++d) {
    double const v = set.field(Field::velocity_x + d)[q];
    lost.momentum[d] += m * v;
    square += v * v;
  }
  lost.mass += m;
  lost.energy += m * (0.5 * square + set.field(Field::energy)[q]);
  if (rules.books_work && !body.solid.is_gas()) lost.energy -= m * set.field(Field::provisional)[q];
  if (rules.has_gradient_energy) lost.energy += m * affine_energy(set, q, h);
  ++lost.particles;
}

}  // namespace

void Mpm::migrate() {
  PhaseTimer const timer(timings_["migration"]);
  Workspace& w = *work_;
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    w.lost[active_[n]] = {};
    for (int body = 0; body < static_cast<int>(bodies_.size()); ++body)
      send_off(active_[n], body, w.scratch[thread].order);
  });
  for (int const block : active_) {
    if (!w.trouble[block].empty()) throw NumericalError(w.trouble[block]);
    book_block(block);
  }
  if (take_in()) find_active();
  if (step_ % look_interval != 1) return;
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
      ParticleSet& set = particles(active_[n], body);
      if (set.size() > 1) sort(set, active_[n], w.scratch[thread].order);
    }
  });
}

/// Moves the particles of a block, and puts those that leave it into its outbox.
void Mpm::send_off(int block, int body, std::vector<int>& stay) {
  Workspace& w = *work_;
  Patch const& patch = w.patches[block];
  ParticleSet& set = particles(block, body);
  Outbox& out = w.outbox[set_index(block, body)];
  if (set.empty() || move_on(set, patch) == 0) return;
  mark_outside(set, patch, stay);
  std::size_t kept = 0;  // the list takes the place of the marks that have been read
  for (int q = 0; q < set.size(); ++q) {
    if (stay[q] == 0) {
      stay[kept++] = q;
      continue;
    }
    std::optional<int> wild;
    Fate const fate = fate_of(set, q, grid_, block, patch, wild);
    if (wild) {
      w.trouble[block] = fmt::format(
          "a material point of body \"{}\" moved by more than one cell in one step (velocity {:.4g} m/s in {})",
          bodies_[body].name, set.field(Field::velocity_x + *wild)[q], "xyz"[*wild]);
    }
    if (fate.lost) {
      lose(w.lost[block], set, q, bodies_[body], rules_[body], patch.h);
    } else if (fate.moved) {
      out.particles.append(set, q);
      out.destination.push_back(w.around[block][around_index(fate.offset)]);
    } else {
      stay[kept++] = q;
    }
  }
  stay.resize(kept);
  if (static_cast<int>(kept) < set.size()) set.reorder(stay);
}

/// Adds what was booked in a block in the step.
void Mpm::book_block(int block) {
  Workspace& w = *work_;
  Losses const& lost = w.lost[block];
  accounts_.losses.mass += lost.mass;
  accounts_.losses.momentum = accounts_.losses.momentum + lost.momentum;
  accounts_.losses.energy += lost.energy;
  accounts_.losses.particles += lost.particles;
  accounts_.constraint_impulse = accounts_.constraint_impulse + w.impulse[block];
  accounts_.outer_work += w.work[block];
  accounts_.dissipation += w.dissipation[block];
  accounts_.floored += w.floored[block];
  accounts_.conducted += w.conducted[block];
  w.floored[block] = {};
  w.conducted[block] = {};
}

/// Every block takes what the blocks around it have for it, in their order. Was there anything?
bool Mpm::take_in() {
  Workspace& w = *work_;
  int const bodies = static_cast<int>(bodies_.size());
  std::vector<int> receivers;
  for (int const block : active_) {
    for (int body = 0; body < bodies; ++body) {
      auto const& to = w.outbox[set_index(block, body)].destination;
      receivers.insert(receivers.end(), to.begin(), to.end());
    }
  }
  std::sort(receivers.begin(), receivers.end());
  receivers.erase(std::unique(receivers.begin(), receivers.end()), receivers.end());
  parallel_for(static_cast<int>(receivers.size()), [&](int n, int) {
    int const block = receivers[n];
    std::array<int, 27> around = w.around[block];
    // Across periodic faces one block may lie on several sides; it gives once.
    std::sort(around.begin(), around.end());
    auto const last = std::unique(around.begin(), around.end());
    for (auto from = around.begin(); from != last; ++from) {
      if (*from == grid::no_neighbour) continue;
      for (int body = 0; body < bodies; ++body) {
        Outbox const& out = w.outbox[set_index(*from, body)];
        ParticleSet& set = particles(block, body);
        for (std::size_t q = 0; q < out.destination.size(); ++q) {
          if (out.destination[q] == block) set.append(out.particles, static_cast<int>(q));
        }
      }
    }
  });
  for (Outbox& out : w.outbox) {
    if (out.destination.empty()) continue;
    out.destination.clear();
    out.particles.reorder({});
  }
  return !receivers.empty();
}

/// Brings particles that touch the same nodes together, see groups.hpp, where they have moved apart.
void Mpm::sort(ParticleSet& set, int block, std::vector<int>& order) const {
  Patch const& patch = work_->patches[block];
  std::vector<int> place;
  std::vector<int> start;
  if (patch.reach > 0) {
    find_nearest_nodes(set, patch, place);
  } else {
    find_cells(set, patch, place);
  }
  int backwards = 0;
  for (int q = 1; q < set.size(); ++q) backwards += place[q] < place[q - 1] ? 1 : 0;
  bool const due = step_ % sort_interval == 1 || backwards > most_backwards * set.size();
  if (backwards == 0 || !due) return;
  find_starts(place, patch.reach > 0 ? patch.count() : patch.cell_range().count(), start);
  order.resize(set.size());
  for (int q = 0; q < set.size(); ++q) order[start[place[q]]++] = q;
  set.reorder(order);
}

}  // namespace brisance::mpm
