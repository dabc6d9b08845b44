#include "setup/place_initial_states.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "setup/fluids.hpp"
#include "setup/solid_cells.hpp"
#include "setup/velocity_field.hpp"
#include "shape/placement.hpp"

namespace brisance::setup {

namespace {

using shape::CellRange;
using shape::Share;

material::Fluid const& fluid_of(Case const& setup, InitialState const& initial) {
  material::Fluid const* other = initial.fluid > 0 ? setup.other_fluid(initial.fluid) : nullptr;
  return other != nullptr ? *other : setup.ambient.fluid;
}

/// The states of one block, those that move as they are at a place: parsers serve one thread each.
class MovingStates {
 public:
  MovingStates(Case const& setup, std::vector<int> const& moving, gas::Fluids const& fluids,
               std::vector<gas::Components> const& states)
      : setup_(&setup), fluids_(&fluids), states_(&states) {
    for (int const n : moving) {
      InitialState const& initial = setup.initial_states[static_cast<std::size_t>(n)];
      fields_.emplace(n, VelocityField(initial.state.velocity, initial.motion));
    }
    if (!moving.empty()) here_ = states;
  }

  std::vector<gas::Components> const& at(std::vector<Share> const& shares, Vec3 const& x) {
    if (fields_.empty()) return *states_;
    for (Share const& s : shares) {
      auto const field = fields_.find(s.shape);
      if (field == fields_.end()) continue;
      InitialState const& initial = setup_->initial_states[static_cast<std::size_t>(s.shape)];
      Primitive state = initial.state;
      state.velocity = field->second(x);
      here_[static_cast<std::size_t>(s.shape)] = gas::conserved_of(*fluids_, material::only(initial.fluid, state));
    }
    return here_;
  }

 private:
  Case const* setup_;
  gas::Fluids const* fluids_;
  std::vector<gas::Components> const* states_;
  std::vector<gas::Components> here_;
  std::map<int, VelocityField> fields_;
};

}  // namespace

InitialStatePlacing::InitialStatePlacing(Case const& setup, grid::Grid const* grid) : setup_(&setup) {
  if (grid == nullptr || grid->levels() == 1) {
    pieces_.push_back({setup.domain, setup.domain.all_cells()});
  } else {
    for (grid::Block const& block : grid->blocks()) {
      for_each_uncovered_box(block, [&](CellRange const& cells) {
        pieces_.push_back({grid->domain_of(block), cells});
      });
    }
  }
  for (InitialState const& initial : setup.initial_states) {
    shapes_.push_back(initial.shape);
    asked_.push_back(shape::volume_inside(initial.shape, setup.domain));
  }
  all_ = shapes_;
  for (Obstacle const& obstacle : setup.obstacles) all_.push_back(obstacle.shape);
  scales_.assign(shapes_.size(), 1.0);
  placed_.assign(shapes_.size(), 0.0);
  for (InitialState const& initial : setup.initial_states)
    kinetic_.push_back(0.5 * initial.state.density * dot(initial.state.velocity, initial.state.velocity));
}

void InitialStatePlacing::scale(std::vector<Share>& shares) const {
  bool const full = sum_of(shares) > 1.0 - 1e-9;
  double room = 1.0;
  for (std::size_t n = shares.size(); n-- > 0;) {
    Share& s = shares[n];
    if (s.fraction < 1.0) s.fraction = std::min(room, s.fraction * scales_[static_cast<std::size_t>(s.shape)]);
    if (n == 0 && full) s.fraction = room;  // the lowest has the rest of a cell that initial states fill
    room -= s.fraction;
  }
}

void InitialStatePlacing::for_each(grid::Domain const& domain, CellRange const& range, Visit const& visit) const {
  int const first_obstacle = static_cast<int>(shapes_.size());
  shape::for_each_share(all_, domain, range, [&](CellRange const& r, std::vector<Share> const& shares) {
    double obstacles = 0.0;
    for (Share const& s : shares) obstacles += s.shape >= first_obstacle ? s.fraction : 0.0;
    if (SolidCells::solid(obstacles)) return true;
    // What an obstacle takes of a cell that stays gas is gas of the initial states.
    std::vector<Share> parts = obstacles > 0.0 ? shape::shares_of_cell(shapes_, domain, r.lower) : shares;
    if (parts.empty()) return true;
    scale(parts);
    return visit(r, parts);
  });
}

bool InitialStatePlacing::measure(long most) {
  long cut = 0;
  for (std::size_t n = 0; n < shapes_.size(); ++n) {
    if (std::holds_alternative<shape::Box>(shapes_[n])) continue;
    double full = 0.0;
    double part = 0.0;
    for (Piece const& piece : pieces_) {
      grid::Domain const& domain = piece.domain;
      shape::for_each_share({shapes_[n]}, domain, grid::common(piece.cells, shape::cells_around(shapes_[n], domain)),
                            [&](CellRange const& r, std::vector<Share> const& shares) {
                              double const f = shares.front().fraction;
                              (f < 1.0 ? part : full) += f * shape::volume_of(r, domain);
                              return ++cut <= most;
                            });
    }
    if (cut > most) return false;
    double const missing = asked_[n] - full - part;
    if (part > 0.0 && std::abs(missing) > 1e-13 * asked_[n] && asked_[n] > full) scales_[n] = (asked_[n] - full) / part;
  }
  placed_.assign(shapes_.size(), 0.0);
  for (Piece const& piece : pieces_) {
    grid::Domain const& domain = piece.domain;
    for_each(domain, piece.cells, [&](CellRange const& r, std::vector<Share> const& shares) {
      for (Share const& s : shares)
        placed_[static_cast<std::size_t>(s.shape)] += s.fraction * shape::volume_of(r, domain);
      return ++cut <= most;
    });
  }
  if (cut <= most) measure_motion();
  return cut <= most;
}

void InitialStatePlacing::measure_motion() {
  for (std::size_t n = 0; n < shapes_.size(); ++n) {
    InitialState const& initial = setup_->initial_states[n];
    if (!initial.motion.any() || !(placed_[n] > 0.0)) continue;
    VelocityField field(initial.state.velocity, initial.motion);
    double sum = 0.0;
    for (auto const& piece : pieces_) {
      grid::Domain const& domain = piece.domain;
      CellRange const cells = grid::common(piece.cells, shape::cells_around(shapes_[n], domain));
      for_each(domain, cells, [&](CellRange const& r, std::vector<Share> const& shares) {
        for (Share const& s : shares) {
          if (s.shape != static_cast<int>(n)) continue;
          grid::for_each_cell(r, [&](Index3 const& index) {
            Vec3 const v = field(domain.centre(index));
            sum += s.fraction * domain.cell_volume(index[0]) * dot(v, v);
          });
        }
        return true;
      });
    }
    kinetic_[n] = 0.5 * initial.state.density * sum / placed_[n];
  }
}

void InitialStatePlacing::fill(gas::Gas& gas) {
  if (shapes_.empty()) return;
  measure(std::numeric_limits<long>::max());
  std::vector<gas::Components> states;
  for (InitialState const& initial : setup_->initial_states)
    states.push_back(gas::conserved_of(gas.fluids(), material::only(initial.fluid, initial.state)));
  grid::Grid const& grid = gas.grid();
  std::vector<int> moving;
  for (std::size_t n = 0; n < shapes_.size(); ++n) {
    if (setup_->initial_states[n].motion.any()) moving.push_back(static_cast<int>(n));
  }
  parallel_for(grid.block_count(), [&](int b, int) {
    grid::Block const& block = grid.blocks()[b];
    MovingStates own(*setup_, moving, gas.fluids(), states);
    auto const fill_box = [&](CellRange const& r, std::vector<Share> const& shares) {
      double rest = 1.0;
      for (Share const& s : shares) rest -= s.fraction;
      grid::for_each_cell(r, [&](Index3 const& index) {
        grid::Cell const cell = grid.locate(block.level, index).value();
        std::vector<gas::Components> const& here = own.at(shares, block.centre(cell));
        for (int c = 0; c < gas.fields().components(); ++c) {
          double& u = gas.fields().at(b, c)[cell.offset];
          if (shares.size() == 1 && shares.front().fraction >= 1.0) {
            u = here[static_cast<std::size_t>(shares.front().shape)][c];
            continue;
          }
          double mixed = std::max(rest, 0.0) * u;
          for (Share const& s : shares) mixed += s.fraction * here[static_cast<std::size_t>(s.shape)][c];
          u = mixed;
        }
        if (!r.single() || gas.primitive(cell).sound_speed > 0.0) return;
        Vec3 const x = block.centre(cell);
        throw InputError(
            fmt::format("the initial states and the ambient in the cell at ({:.6g}, {:.6g}, {:.6g}) m cannot be mixed: "
                        "their mean is outside the equation of state; align its faces with cell faces",
                        x[0], x[1], x[2]));
      });
      return true;
    };
    for_each_uncovered_box(block, [&](CellRange const& cells) { for_each(grid.domain_of(block), cells, fill_box); });
  });
}

void InitialStatePlacing::give_way(detonation::TakenCells const& taken) {
  if (shapes_.empty()) return;
  for (auto const& [place, part] : taken) {
    grid::Domain const domain = setup_->domain_of(place.first);
    for_each(domain, grid::around(place.second, 0, 0),
             [&, part = part](CellRange const& r, std::vector<Share> const& shares) {
               for (Share const& s : shares)
                 placed_[static_cast<std::size_t>(s.shape)] -= part * s.fraction * shape::volume_of(r, domain);
               return true;
             });
  }
}

std::vector<run::InitialStateReport> InitialStatePlacing::reports() const {
  std::vector<run::InitialStateReport> all;
  for (std::size_t n = 0; n < shapes_.size(); ++n) {
    InitialState const& initial = setup_->initial_states[n];
    Primitive const& s = initial.state;
    material::Fluid const& fluid = fluid_of(*setup_, initial);
    double const energy = s.density * material::internal_energy(fluid.eos, s.density, s.pressure) + kinetic_[n];
    run::InitialStateReport report;
    report.fluid = fluid.name;
    report.specified_volume = asked_[n];
    report.volume = placed_[n];
    report.specified_mass = s.density * asked_[n];
    report.mass = s.density * placed_[n];
    report.specified_energy = energy * asked_[n];
    report.energy = energy * placed_[n];
    all.push_back(report);
  }
  return all;
}

bool InitialStatePlacing::vanishes(std::size_t initial) const {
  if (!(asked_[initial] > 0.0)) return true;
  bool found = false;
  for (auto const& [domain, cells] : pieces_) {
    if (found) break;
    CellRange const range = grid::common(cells, shape::cells_around(shapes_[initial], domain));
    for_each(domain, range, [&](CellRange const&, std::vector<Share> const& s) {
      found = std::any_of(s.begin(), s.end(), [&](Share const& share) {
        return share.shape == static_cast<int>(initial) && share.fraction > 0.0;
      });
      return !found;
    });
  }
  return !found;
}

}  // namespace brisance::setup
