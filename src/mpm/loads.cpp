/// Pressures on surfaces, body forces, and their work; see `mpm.hpp`.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "mpm/mpm.hpp"
#include "mpm/set_kernels.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

double amplitude(ActiveLoad const& load, double time) {
  if (time < load.times.front() || time > load.times.back()) return 0.0;
  if (load.times.size() == 1) return load.pressures.back();
  auto const next = std::lower_bound(load.times.begin() + 1, load.times.end(), time);
  auto const n = static_cast<std::size_t>(next - load.times.begin());
  double const s = (time - load.times[n - 1]) / (load.times[n] - load.times[n - 1]);
  return (1.0 - s) * load.pressures[n - 1] + s * load.pressures[n];
}

/// The particles of a body by the cells of the grid, to find those around a place.
class ParticlesByCell {
 public:
  struct Near {
    std::size_t cell = 0;  ///< place in arrays over the domain
    int block = 0;
    int particle = 0;
    Vec3 x{0.0, 0.0, 0.0};
    double volume = 0.0;
  };
  struct Weighted {
    Near const* near;
    double weight;
  };

  ParticlesByCell(Mpm const& mpm, int body) : domain_(&mpm.grid().domain()) {
    for (int b = 0; b < mpm.grid().block_count(); ++b) {
      ParticleSet const& set = mpm.particles(b, body);
      for (int q = 0; q < set.size(); ++q) {
        Near near{0, b, q, {0.0, 0.0, 0.0}, set.field(Field::mass)[q] / set.field(Field::density)[q]};
        for (int d = 0; d < domain_->dimensions(); ++d) near.x[d] = set.field(Field::position_x + d)[q];
        near.cell = domain_->all_cells().offset(mpm.grid().cell_at(near.x));
        all_.push_back(near);
      }
    }
    std::stable_sort(all_.begin(), all_.end(), [](Near const& p, Near const& q) { return p.cell < q.cell; });
  }

  /// The particles around a place, weighted with their volume and a tent of a half width. Returns the sum of the
  /// weights.
  double weigh(Vec3 const& target, double reach, std::vector<Weighted>& around) const {
    around.clear();
    double sum = 0.0;
    grid::CellRange const cells = cells_around(target, reach);
    for_each_row(cells, [&](Index3 const& first) {
      std::size_t const begin = domain_->all_cells().offset(first);
      std::size_t const end = begin + static_cast<std::size_t>(cells.n(0));
      auto at = std::lower_bound(all_.begin(), all_.end(), begin,
                                 [](Near const& p, std::size_t cell) { return p.cell < cell; });
      for (; at != all_.end() && at->cell < end; ++at) {
        double weight = at->volume;
        for (int d = 0; d < domain_->dimensions(); ++d)
          weight *= std::max(0.0, 1.0 - std::abs(at->x[d] - target[d]) / reach);
        if (weight <= 0.0) continue;
        around.push_back({&*at, weight});
        sum += weight;
      }
    });
    return sum;
  }

 private:
  [[nodiscard]] int cell(int d, double x) const {
    return static_cast<int>(std::clamp(domain_->in_cells(d, x), 0.0, domain_->cells[d] - 1.0));
  }
  [[nodiscard]] grid::CellRange cells_around(Vec3 const& target, double reach) const {
    grid::CellRange cells;
    for (int d = 0; d < domain_->dimensions(); ++d) {
      cells.lower[d] = cell(d, target[d] - reach);
      cells.upper[d] = cell(d, target[d] + reach) + 1;
    }
    return cells;
  }

  grid::Domain const* domain_;
  std::vector<Near> all_;
};

/// Moves the weights towards those whose mean place is the target, direction by direction.
void centre_weights(std::vector<ParticlesByCell::Weighted>& around, Vec3 const& target, int dims) {
  for (int d = 0; d < 2 * dims; ++d) {
    auto const away = [&](ParticlesByCell::Weighted const& p) { return p.near->x[d % dims] - target[d % dims]; };
    double first = 0.0;
    double second = 0.0;
    double most = 0.0;
    for (auto const& p : around) {
      first += p.weight * away(p);
      second += p.weight * away(p) * away(p);
    }
    double const slope = second > 0.0 ? -first / second : 0.0;
    for (auto const& p : around) most = std::max(most, -slope * away(p));
    double const part = most > 0.75 ? 0.75 / most : 1.0;
    for (auto& p : around) p.weight *= 1.0 + part * slope * away(p);
  }
}

}  // namespace

void Mpm::load(SurfacePressure const& pressure) {
  if (pressure.times.size() != pressure.pressures.size() || pressure.times.empty()) {
    throw InputError("a surface pressure needs equal numbers of times and pressures, at least one each");
  }
  if (!(pressure.thickness > 0.0))
    throw InputError("a surface pressure needs the thickness of the layer that carries it");
  std::vector<ActiveLoad>& loads = work_->loads;
  loads.push_back({pressure.body, pressure.times, pressure.pressures, {}});
  int const number = static_cast<int>(loads.size());
  carry(pressure.body, Field::load_x, 4);  // load_number is the fourth
  bool touched = false;
  bool const curved = !pressure.surface.empty();
  std::vector<std::vector<Vec3>> const forces = curved ? pushes(pressure) : std::vector<std::vector<Vec3>>{};
  Vec3 flat{0.0, 0.0, 0.0};
  for (int d = 0; d < 3; ++d) flat[d] = -pressure.normal[d] / pressure.thickness;
  // Particles that bear another pressure already bear both.
  auto const together = [&](int before, Vec3 const& its_direction, Vec3 const& direction) {
    auto parts = loads[static_cast<std::size_t>(before) - 1].parts;
    if (parts.empty()) parts.push_back({before - 1, its_direction});
    parts.push_back({number - 1, direction});
    // On a curved surface hardly two particles bear the same.
    for (std::size_t n = 0; !curved && n < loads.size(); ++n) {
      if (loads[n].parts == parts) return static_cast<int>(n) + 1;
    }
    loads.push_back({pressure.body, {}, {}, std::move(parts)});
    return static_cast<int>(loads.size());
  };
  for (int b = 0; b < grid_.block_count(); ++b) {
    ParticleSet& old = particles(b, pressure.body);
    for (int q = 0; q < old.size(); ++q) {
      Vec3 x{0.0, 0.0, 0.0};
      for (int d = 0; d < 3; ++d) x[d] = old.field(Field::position_x + d)[q];
      Vec3 direction = flat;
      if (curved) {
        double const volume = old.field(Field::mass)[q] / old.field(Field::density)[q];
        direction = (1.0 / volume) * forces[b][q];
        if (dot(direction, direction) == 0.0) continue;
      } else if (!shape::contains(pressure.within, grid_.domain(), x)) {
        continue;
      }
      touched = true;
      int const before = static_cast<int>(old.field(Field::load_number)[q]);
      Vec3 taken = direction;
      if (before > 0) {
        for (int d = 0; d < 3; ++d) taken[d] = old.field(Field::load_x + d)[q];
      }
      old.field(Field::load_number)[q] = before > 0 ? together(before, taken, direction) : number;
      for (int d = 0; d < 3; ++d) old.field(Field::load_x + d)[q] = before > 0 ? 1.0 : taken[d];
    }
  }
  if (touched) return;
  throw InputError(
      fmt::format("surface pressure {} has no effect: no material point of body \"{}\" lies in the layer that it "
                  "loads; move it, or make it larger than the particle spacing",
                  number, bodies_[pressure.body].name));
}

/// Each piece of the surface pushes on the particles around a place half a layer below it, with weights that keep its
/// resultant, and its line of action as far as positive weights can.
std::vector<std::vector<Vec3>> Mpm::pushes(SurfacePressure const& pressure) const {
  int const dims = grid_.domain().dimensions();
  std::vector<std::vector<Vec3>> forces(grid_.block_count());
  for (int b = 0; b < grid_.block_count(); ++b)
    forces[b].assign(particles(b, pressure.body).size(), Vec3{0.0, 0.0, 0.0});
  ParticlesByCell const by_cell(*this, pressure.body);
  std::vector<ParticlesByCell::Weighted> around;
  for (shape::Facet const& facet : pressure.surface) {
    Vec3 const target = facet.x - (0.5 * pressure.thickness / norm(facet.area)) * facet.area;
    double sum = 0.0;
    // Measured on spheres, discs and oblique cylinders: a tent of one and a half layers finds two particles or more in
    // each direction nearly everywhere.
    for (double reach = 1.5 * pressure.thickness; sum == 0.0 && reach < 16.0 * pressure.thickness; reach *= 1.5)
      sum = by_cell.weigh(target, reach, around);
    if (!(sum > 0.0)) {
      throw InputError(fmt::format(
          "surface pressure on body \"{}\": no material point lies within 16 layers of its surface at ({:.6g}, {:.6g}, "
          "{:.6g}) m: the body is too thin there to be resolved; use smaller cells, or exclude this part from the load",
          bodies_[pressure.body].name, facet.x[0], facet.x[1], facet.x[2]));
    }
    centre_weights(around, target, dims);
    sum = 0.0;
    for (auto const& p : around) sum += p.weight;
    for (auto const& p : around) {
      Vec3& force = forces[p.near->block][p.near->particle];
      force = force - (p.weight / sum) * facet.area;
    }
  }
  return forces;
}

OuterForces Mpm::outer_forces() const {
  OuterForces outer;
  for (ActiveLoad const& load : work_->loads) {
    Vec3 p{0.0, 0.0, 0.0};
    for (ActiveLoad::Part const& part : load.parts)
      p = p + amplitude(work_->loads[static_cast<std::size_t>(part.load)], time_) * part.direction;
    if (load.parts.empty()) p.fill(amplitude(load, time_));
    outer.pressures.push_back(p);
  }
  outer.body_force = options_.body_force;
  outer.acceleration = options_.acceleration;
  outer.time = time_;
  return outer;
}

double Mpm::work_on(int block, int body, OuterForces const& outer) const {
  ParticleSet const& set = particles(block, body);
  if (bodies_[body].rigid_velocity) return 0.0;
  Vec3 const& g = options_.body_force;
  double const* load_number = set.field(Field::load_number);
  double const* mass = set.field(Field::mass);
  double work = 0.0;
  if (dot(g, g) > 0.0) {
    for (int d = 0; d < 3; ++d) {
      double const* move = set.field(Field::move_x + d);
      for (int q = 0; q < set.size(); ++q) work += mass[q] * g[d] * move[q];
    }
  }
  if (outer.acceleration) {
    for (int q = 0; q < set.size(); ++q) {
      Vec3 const a = outer.acceleration(
          {set.field(Field::position_x)[q], set.field(Field::position_y)[q], set.field(Field::position_z)[q]},
          outer.time);
      for (int d = 0; d < 3; ++d) work += mass[q] * a[d] * set.field(Field::move_x + d)[q];
    }
  }
  if (load_number != nullptr) {
    for (int q = 0; q < set.size(); ++q) {
      if (load_number[q] <= 0.0) continue;
      double const volume = mass[q] / set.field(Field::density)[q];
      Vec3 const& p = outer.pressures[static_cast<std::size_t>(load_number[q]) - 1];
      for (int d = 0; d < 3; ++d)
        work += volume * p[d] * set.field(Field::load_x + d)[q] * set.field(Field::move_x + d)[q];
    }
  }
  return work;
}

}  // namespace brisance::mpm
