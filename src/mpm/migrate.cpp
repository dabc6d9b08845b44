/// The end of a step: points move, and those that leave their block go to the next. Between steps: gases get more or
/// fewer points.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "mpm/burn.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

/// Steps between two sorts of the points by cell: a point needs at least two steps to cross a cell, and the points of a
/// block stay close in memory anyhow.
constexpr long sort_interval = 24;

/// What happens to a point that moved out of its block.
struct Fate {
  bool lost = false;
  Index3 offset{0, 0, 0};  ///< block that it goes to, as -1, 0, 1 per direction
};

}  // namespace

void Mpm::migrate() {
  PhaseTimer const timer(timings_["migration"]);
  Workspace& w = *work_;
  int const bodies = static_cast<int>(bodies_.size());
  grid::Domain const& domain = grid_.domain();
  int const dims = domain.dimensions();
  double const inverse_h = 1.0 / domain.h;

  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    Patch const& patch = w.patches[block];
    std::vector<int>& stay = w.scratch[thread].order;
    Losses& lost = w.lost[block];
    lost = {};
    for (int body = 0; body < bodies; ++body) {
      PointSet& set = points(block, body);
      int const count = set.size();
      Outbox& out = w.outbox[set_index(block, body)];
      if (count == 0) continue;
      long outside = 0;
      for (int d = 0; d < dims; ++d) {
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
      if (outside == 0) continue;
      stay.clear();
      for (int q = 0; q < count; ++q) {
        Fate fate;
        bool moved = false;
        for (int d = 0; d < dims && !fate.lost; ++d) {
          double& x = set.field(Field::position_x + d)[q];
          double u = (x - patch.first[d]) * inverse_h;
          if (u >= 0.0 && u < patch.cells[d]) continue;
          if (!(u > -1.0 && u < patch.cells[d] + 1.0)) {
            w.trouble[block] =
                fmt::format("a point of body \"{}\" moved by more than a cell in one step (velocity {:.4g} m/s in {})",
                            bodies_[body].name, set.field(Field::velocity_x + d)[q], "xyz"[d]);
            fate.lost = true;
            break;
          }
          int const side = u < 0.0 ? 0 : 1;
          double const wall = patch.first[d] + side * patch.cells[d] * domain.h;
          Side const next = beyond(grid_, block, d, side);
          if (next.mirror) {
            // Velocity normal to a mirror plane vanishes there; what crosses does so by round-off or as a shock
            // arrives, and comes back as its mirror image does.
            x = wall - (x - wall);
            if (x - patch.first[d] >= patch.cells[d] * domain.h) x = std::nextafter(wall, patch.first[d]);
            double& v = set.field(Field::velocity_x + d)[q];
            v = -v;
            if (set.field(Field::affine_xx) != nullptr) {
              for (int j = 0; j < 3; ++j) {
                if (j == d) continue;
                set.field(Field::affine_xx + (3 * d + j))[q] *= -1.0;
                set.field(Field::affine_xx + (3 * j + d))[q] *= -1.0;
              }
            }
            for (int pair = 0; pair < 3; ++pair) {
              if (set.field(Field::cross_xy + 3 * pair) == nullptr) continue;
              bool const turned = pair == d || (pair + 1) % 3 == d;  // xy, yz, zx
              for (int j = 0; j < 3; ++j) {
                if (turned != (j == d)) set.field(Field::cross_xy + (3 * pair + j))[q] *= -1.0;
              }
            }
          } else if (next.block == grid::no_neighbour) {
            fate.lost = true;
          } else {
            fate.offset[d] = side == 0 ? -1 : 1;
            moved = true;
            if (domain.boundary[2 * d + side] == grid::Boundary::periodic) {
              double const length = domain.upper(d) - domain.lower[d];
              double const shift = x < domain.lower[d] ? length : x >= domain.upper(d) ? -length : 0.0;
              x += shift;
              if (double* origin = set.field(Field::origin_x + d)) origin[q] += shift;
              if (x < domain.lower[d]) x = domain.lower[d];
              if (x >= domain.upper(d)) x = std::nextafter(domain.upper(d), domain.lower[d]);
            }
          }
        }
        if (fate.lost) {
          double const m = set.field(Field::mass)[q];
          double square = 0.0;
          for (int d = 0; d < 3; ++d) {
            double const v = set.field(Field::velocity_x + d)[q];
            lost.momentum[d] += m * v;
            square += v * v;
          }
          lost.mass += m;
          lost.energy += m * (0.5 * square + set.field(Field::energy)[q]);
          if (rules_[body].books_work && !bodies_[body].solid.is_gas())
            lost.energy -= m * set.field(Field::provisional)[q];
          if (rules_[body].has_gradient_energy) lost.energy += m * affine_energy(set, q, domain.h);
          ++lost.points;
        } else if (moved) {
          out.points.append(set, q);
          int const where = (fate.offset[0] + 1) + 3 * ((fate.offset[1] + 1) + 3 * (fate.offset[2] + 1));
          out.destination.push_back(w.around[block][where]);
        } else {
          stay.push_back(q);
        }
      }
      set.reorder(stay);
    }
  });
  for (int const block : active_) {
    if (!w.trouble[block].empty()) throw NumericalError(w.trouble[block]);
    Losses const& lost = w.lost[block];
    losses_.mass += lost.mass;
    losses_.momentum = losses_.momentum + lost.momentum;
    losses_.energy += lost.energy;
    losses_.points += lost.points;
    constraint_impulse_ = constraint_impulse_ + w.impulse[block];
    outer_work_ += w.work[block];
    dissipation_ += w.dissipation[block];
    floored_ += w.floored[block];
    conducted_ += w.conducted[block];
    w.floored[block] = {};
    w.conducted[block] = {};
  }

  // Every block takes what the blocks around it have for it, in their order.
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
        PointSet& set = points(block, body);
        for (std::size_t q = 0; q < out.destination.size(); ++q) {
          if (out.destination[q] == block) set.append(out.points, static_cast<int>(q));
        }
      }
    }
  });
  for (Outbox& out : w.outbox) {
    if (out.destination.empty()) continue;
    out.destination.clear();
    out.points.reorder({});
  }
  if (!receivers.empty()) find_active();
  if (step_ % sort_interval != 0) return;
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    for (int body = 0; body < bodies; ++body) {
      PointSet& set = points(active_[n], body);
      if (set.size() > 1) sort(set, active_[n], w.scratch[thread].order);
    }
  });
}

PopulationCount Mpm::control_population(int body, PopulationOptions const& options) {
  PhaseTimer const timer(timings_["population"]);
  check(options);
  Body const& b = bodies_.at(body);
  material::Solid const& solid = b.solid;
  if (solid.has_deviator() || solid.plastic() || b.rigid_velocity) {
    throw InputError(fmt::format("the points of body \"{}\" cannot split and merge: it is no gas", b.name));
  }
  for (ActiveLoad const& load : work_->loads) {
    if (load.body != body) continue;
    throw InputError(fmt::format(
        "the points of body \"{}\" cannot split and merge: some carry a surface pressure; load a solid instead",
        b.name));
  }
  Workspace& w = *work_;
  if (static_cast<int>(w.population.size()) < threads()) w.population.resize(threads());
  w.population_of_block.assign(grid_.block_count(), {});
  auto const place_of = [&](int block) {
    PopulationPlace place{&grid_, block, &w.patches[block], b.points_per_direction};
    if (solid.burns()) place.lit_before = time_ - 1.0 / burn_rate(solid.detonation_speed, grid_.domain().h);
    return place;
  };

  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    w.population_of_block[block] = split_points(points(block, body), place_of(block), options, w.population[thread],
                                                w.outbox[set_index(block, body)]);
  });
  long split = 0;
  bool moved = false;
  for (int const block : active_) {
    split += w.population_of_block[block].split;
    Outbox& out = w.outbox[set_index(block, body)];
    if (out.destination.empty()) continue;
    moved = true;
    for (std::size_t q = 0; q < out.destination.size(); ++q) {
      points(out.destination[q], body).append(out.points, static_cast<int>(q));
    }
    out.destination.clear();
    out.points.reorder({});
  }
  if (moved) find_active();
  for (int n = 0; split > 0 && n < static_cast<int>(active_.size()); ++n) {
    PointSet& set = points(active_[n], body);
    double* identity = set.field(Field::identity);
    for (int q = 0; q < set.size(); ++q) {
      if (identity[q] < 0.0) identity[q] = static_cast<double>(next_identity_[body]++);
    }
  }

  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    PopulationCount& count = w.population_of_block[block];
    PopulationCount const merged = merge_points(points(block, body), place_of(block), options, w.population[thread]);
    count.merged = merged.merged;
    count.heat += merged.heat;
  });
  PopulationCount total;
  for (PopulationCount const& count : w.population_of_block) {
    total.split += count.split;
    total.merged += count.merged;
    total.heat += count.heat;
  }
  return total;
}

void Mpm::sort(PointSet& set, int block, std::vector<int>& order) const {
  Patch const& patch = work_->patches[block];
  double const inverse_h = 1.0 / grid_.domain().h;
  int const cells = patch.cells[0] * patch.cells[1] * patch.cells[2];
  std::vector<int> start(static_cast<std::size_t>(cells) + 1, 0);
  std::vector<int> cell_of(set.size(), 0);
  int stride = 1;
  for (int d = 0; d < patch.dimensions; ++d) {
    double const* x = set.field(Field::position_x + d);
    for (int q = 0; q < set.size(); ++q) {
      int const i = static_cast<int>((x[q] - patch.first[d]) * inverse_h);
      cell_of[q] += stride * std::clamp(i, 0, patch.cells[d] - 1);
    }
    stride *= patch.cells[d];
  }
  bool sorted = true;
  for (int q = 0; q < set.size(); ++q) {
    ++start[cell_of[q] + 1];
    sorted = sorted && (q == 0 || cell_of[q] >= cell_of[q - 1]);
  }
  if (sorted) return;
  for (int c = 0; c < cells; ++c) start[c + 1] += start[c];
  order.resize(set.size());
  for (int q = 0; q < set.size(); ++q) order[start[cell_of[q]]++] = q;
  set.reorder(order);
}

}  // namespace brisance::mpm
