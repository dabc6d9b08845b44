#include "bridge/gas_particles.hpp"

#include <algorithm>
#include <utility>

#include "bridge/conversion.hpp"
#include "core/parallel.hpp"

namespace brisance::bridge {

using mpm::Field;

void set_gradient(mpm::ParticleSet& set, int q, GasSlopes const& slopes, int dimensions, double h) {
  if (set.field(Field::affine_xx) == nullptr) return;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < dimensions; ++c) set.field(Field::affine_xx + (3 * r + c))[q] = slopes.velocity[c][r] / h;
  }
}

GasParticles::GasParticles(mpm::Mpm& particles, int body, material::Fluids const& fluids, Faces const& faces,
                           std::vector<int> const& outer_blocks)
    : particles_(&particles),
      body_(body),
      has_gradient_energy_(mpm::rules_of(particles.bodies()[body], particles.options()).has_gradient_energy),
      fluids_(&fluids),
      faces_(&faces) {
  Region const& region = faces.region();
  for (int const block : outer_blocks) {
    OuterBlock outer;
    outer.block = block;
    outer.cells = particles.grid().blocks()[block].in_domain();
    outer.inside.reserve(outer.cells.count());
    for_each_cell(outer.cells, [&](Index3 const& cell) {
      outer.inside.push_back(region.inside(region.from_particles(cell)) ? 1 : 0);
    });
    outer_blocks_.push_back(std::move(outer));
    absorbed_.push_back(empty_set());
  }
}

void GasParticles::append(int face, int lane, double depth, double mass, Primitive const& s, GasSlopes const& slopes,
                          mpm::ParticleSet& to) const {
  Face const& f = (*faces_)[face];
  grid::Metric const& cells = faces_->region().metric();
  int const dims = cells.dimensions();
  int const parts = faces_->parts();
  Index3 const sub = faces_->sub_cell(face, lane);
  int const q = to.append();
  for (int d = 0; d < 3; ++d) {
    double x = cells.centre({0, 0, 0})[d];
    if (d == f.direction) {
      double const least = 1e-9 * cells.h;  // inside, whatever the round-off
      double const at = std::clamp(depth, least, cells.h - least);
      x = cells.face(d, f.inside[d] + f.side) + (f.side == 0 ? at : -at);
    } else if (d < dims) {
      x = cells.place(d, f.inside[d] + (sub[d] + 0.5) / parts);
    }
    to.field(Field::position_x + d)[q] = x;
    to.field(Field::velocity_x + d)[q] = s.velocity[d];
    if (double* half = to.field(Field::half_x + d)) half[q] = 0.5 * cells.h / parts;
  }
  set_gradient(to, q, slopes, dims, cells.h);
  to.field(Field::mass)[q] = mass;
  to.field(Field::density)[q] = s.density;
  to.field(Field::pressure)[q] = s.pressure;
  to.field(Field::energy)[q] = specific_energy(*fluids_, s);
  if (double* Y = to.field(Field::mass_fraction)) Y[q] = s.mass_fraction[1];
  if (double* alpha = to.field(Field::volume_fraction)) alpha[q] = s.volume_fraction[1];
}

Amounts GasParticles::carried(mpm::ParticleSet const& set, int q) const {
  double const m = set.field(Field::mass)[q];
  double const* fraction = set.field(Field::mass_fraction);
  double const other = fraction == nullptr ? 0.0 : m * fraction[q];
  Amounts l;
  l.mass = {m - other, other};
  double square = 0.0;
  for (int d = 0; d < 3; ++d) {
    double const v = set.field(Field::velocity_x + d)[q];
    l.momentum[d] = m * v;
    square += v * v;
  }
  l.energy = m * (set.field(Field::energy)[q] + 0.5 * square);
  l.volume = m / set.field(Field::density)[q];
  if (has_gradient_energy_) l.energy += m * mpm::affine_energy(set, q, faces_->region().metric().h);
  return l;
}

Amounts GasParticles::handed_over(mpm::ParticleSet const& set, int q) const {
  Amounts l = carried(set, q);
  l.energy += particles_->bodies()[body_].reference_pressure * l.volume;
  return l;
}

bool GasParticles::is_inside(OuterBlock const& outer, Vec3 const& x) const {
  Region const& region = faces_->region();
  Index3 const cell = faces_->cell_at(x);
  Index3 const own = region.to_particles(cell);
  return outer.cells.contains(own) ? outer.inside[outer.cells.offset(own)] != 0 : region.inside(cell);
}

std::vector<mpm::ParticleSet> const& GasParticles::take_absorbed() {
  parallel_for(static_cast<int>(outer_blocks_.size()), [&](int n, int) {
    absorbed_[n].reorder({});
    mpm::ParticleSet& set = particles_->particles(outer_blocks_[n].block, body_);
    double const* x = set.field(Field::position_x);
    double const* y = set.field(Field::position_y);
    double const* z = set.field(Field::position_z);
    mpm::take_out(
        set,
        [&](mpm::ParticleSet const&, int q) {
          return !is_inside(outer_blocks_[n], {x[q], y[q], z[q]});
        },
        absorbed_[n]);
  });
  return absorbed_;
}

}  // namespace brisance::bridge
