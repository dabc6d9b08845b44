#include "gas/prolongation.hpp"

#include <algorithm>
#include <cmath>

#include "gas/limiters.hpp"

namespace brisance::gas {

namespace {

/// Where the centres of the parts lie, in coarse cells from the centre of the coarse one; by the part.
using Offsets = std::array<Vec3, Prolongation::most_parts>;
using PerPart = std::array<double, Prolongation::most_parts>;

/// The monotonised-central limiter.
constexpr double half_beta = 1.0;

/// What a quantity differs by from its mean in each part, by the slopes in all directions: weights belong to the means.
struct Linear {
  int dimensions;
  int parts;
  Offsets const* offsets;

  template <class Of>
  [[nodiscard]] PerPart of(Prolongation::Coarse const& cell, Of const& quantity, PerPart const& weight) const {
    double const own = quantity(*cell.state);
    Vec3 slope{0.0, 0.0, 0.0};
    double least = own;
    double most = own;
    double reach = 0.0;
    for (int d = 0; d < dimensions; ++d) {
      if (cell.beside[2 * d] == nullptr || cell.beside[2 * d + 1] == nullptr) continue;
      double const low = quantity(*cell.beside[2 * d]);
      double const high = quantity(*cell.beside[2 * d + 1]);
      slope[d] = 2.0 * limited_half(own - low, high - own, half_beta);
      least = std::min({least, low, high});
      most = std::max({most, low, high});
      reach += 0.25 * std::abs(slope[d]);
    }
    PerPart difference{};
    if (reach == 0.0) return difference;
    // All directions together stay between what the neighbours hold.
    double const room = std::min(most - own, own - least);
    if (reach > room) slope = (room / reach) * slope;
    Vec3 middle{0.0, 0.0, 0.0};
    double whole = 0.0;
    for (int n = 0; n < parts; ++n) {
      middle = middle + weight[n] * (*offsets)[n];
      whole += weight[n];
    }
    if (!(whole > 0.0)) return difference;
    middle = (1.0 / whole) * middle;
    for (int n = 0; n < parts; ++n) difference[n] = dot(slope, (*offsets)[n] - middle);
    return difference;
  }
};

}  // namespace

PhaseState phase_state_of(Fluids const& fluids, Components const& u) {
  PhaseState state;
  Fractions const alpha = volume_fractions(fluids.count, u.data());
  PerFluid const partial = partial_densities(fluids.count, u.data());
  double const rho = mixture_density(fluids.count, u);
  for (int k = 0; k < fluids.count; ++k) {
    state.alpha[k] = alpha[k];
    if (alpha[k] > vanishing_fraction) state.density[k] = partial[k] / alpha[k];
  }
  for (int d = 0; d < 3; ++d) state.velocity[d] = u[momentum_x + d] / rho;
  state.pressure =
      mixture(fluids, partial, alpha).pressure(u[energy] - 0.5 * rho * dot(state.velocity, state.velocity));
  return state;
}

void Prolongation::split(Coarse const& cell, Parts& parts) const {
  Components const& u = *cell.conserved;
  int const count = this->parts();
  int const fluids = fluids_->count;
  for (int n = 0; n < count; ++n) parts[n] = u;
  bool uniform = true;
  for (int face = 0; face < 2 * dimensions_ && uniform; ++face) {
    PhaseState const* const beside = cell.beside[face];
    uniform =
        beside == nullptr || (beside->alpha == cell.state->alpha && beside->density == cell.state->density &&
                              beside->velocity == cell.state->velocity && beside->pressure == cell.state->pressure);
  }
  if (uniform) return;  // to the last bit

  Offsets offsets{};
  PerPart volume{};
  for (int n = 0; n < count; ++n) {
    volume[n] = 1.0;
    for (int d = 0; d < dimensions_; ++d) {
      bool const high = (n >> d & 1) != 0;
      offsets[n][d] = high ? 0.25 : -0.25;
      volume[n] *= d > 0 ? 0.5 : high ? 1.0 - cell.low_part : cell.low_part;
    }
  }
  Linear const linear{dimensions_, count, &offsets};
  std::array<PerFluid, most_parts> alpha{};
  for (int n = 0; n < count; ++n) alpha[n] = cell.state->alpha;
  for (int k = 1; k < fluids; ++k) {
    PerPart const change = linear.of(
        cell, [k](PhaseState const& s) { return s.alpha[k]; }, volume);
    for (int n = 0; n < count; ++n) {
      alpha[n][k] += change[n];
      alpha[n][0] -= change[n];
    }
  }
  PerPart mass{};
  for (int k = 0; k < fluids; ++k) {
    double const own = cell.state->density[k];
    if (!(own > 0.0)) {
      for (int n = 0; n < count; ++n) mass[n] += volume[n] * u[partial_density(k)];
      continue;
    }
    PerPart weight{};
    for (int n = 0; n < count; ++n) weight[n] = volume[n] * alpha[n][k];
    // Neighbours without the fluid have no say.
    PerPart const change = linear.of(
        cell, [k, own](PhaseState const& s) { return s.density[k] > 0.0 ? s.density[k] : own; }, weight);
    for (int n = 0; n < count; ++n) {
      parts[n][partial_density(k)] = alpha[n][k] * (own + change[n]);
      mass[n] += volume[n] * parts[n][partial_density(k)];
    }
  }
  double kinetic = 0.0;
  std::array<Vec3, most_parts> velocity{};
  for (int n = 0; n < count; ++n) velocity[n] = cell.state->velocity;
  for (int d = 0; d < 3; ++d) {
    PerPart const change = linear.of(
        cell, [d](PhaseState const& s) { return s.velocity[d]; }, mass);
    for (int n = 0; n < count; ++n) velocity[n][d] += change[n];
  }
  for (int n = 0; n < count; ++n) kinetic += 0.5 * mass[n] * dot(velocity[n], velocity[n]);

  std::array<Mixture, most_parts> closure{};
  PerPart weight{};
  double xi = 0.0;
  double B = 0.0;
  for (int n = 0; n < count; ++n) {
    for (int k = 1; k < fluids; ++k) parts[n][volume_fraction(k)] = alpha[n][k];
    closure[n] =
        mixture(*fluids_, partial_densities(fluids, parts[n].data()), volume_fractions(fluids, parts[n].data()));
    weight[n] = volume[n] * closure[n].xi;
    xi += weight[n];
    B += volume[n] * closure[n].B;
  }
  double const pressure = (u[energy] - kinetic - B) / xi;
  PerPart const change = linear.of(
      cell, [](PhaseState const& s) { return s.pressure; }, weight);
  bool sound = true;
  for (int n = 0; n < count; ++n) {
    double const p = pressure + change[n];
    double const rho = mass[n] / volume[n];
    sound = sound && rho > 0.0 && closure[n].bulk_modulus(p) > 0.0 && (p > 0.0 || cell.state->pressure <= 0.0);
    for (int d = 0; d < 3; ++d) parts[n][momentum_x + d] = rho * velocity[n][d];
    parts[n][energy] = closure[n].rho_e(p) + 0.5 * rho * dot(velocity[n], velocity[n]);
    if (components_ > progress) {
      double const own = u[partial_density(products_fluid)];
      parts[n][progress] = own > 0.0 ? u[progress] / own * parts[n][partial_density(products_fluid)] : u[progress];
    }
  }
  if (sound) return;
  for (int n = 0; n < count; ++n) parts[n] = u;
}

CoarsePatch::CoarsePatch(Fluids const& fluids, int components, grid::Domain const& domain, grid::CellRange const& core)
    : fluids_(&fluids),
      prolongation_(fluids, components, domain.dimensions()),
      dimensions_(domain.dimensions()),
      box_(core.grown(1, domain.dimensions())),
      conserved_(box_.count()),
      state_(box_.count()),
      known_(box_.count(), 0) {}

bool CoarsePatch::find_image(grid::Domain const& domain, Index3& index) {
  for (int d = 0; d < domain.dimensions(); ++d) {
    int const n = domain.cells[d];
    if (index[d] >= 0 && index[d] < n) continue;
    if (domain.boundary[2 * d] != grid::Boundary::periodic) return false;
    index[d] = (index[d] + n) % n;
  }
  return true;
}

void CoarsePatch::set(std::size_t place, Components const& conserved) {
  conserved_[place] = conserved;
  state_[place] = phase_state_of(*fluids_, conserved);
  known_[place] = 1;
}

void CoarsePatch::split(Index3 const& index, grid::Metric const& fine, Prolongation::Parts& parts) const {
  std::size_t const place = box_.offset(index);
  Prolongation::Coarse coarse{&conserved_[place], &state_[place]};
  for (int face = 0; face < 2 * dimensions_; ++face) {
    std::size_t const beside = box_.offset(grid::beside(index, face / 2, face % 2));
    if (known_[beside] != 0) coarse.beside[face] = &state_[beside];
  }
  if (grid::radial_exponent(fine.geometry) > 0) {
    double const low = fine.cell_volume(2 * index[0]);
    coarse.low_part = low / (low + fine.cell_volume(2 * index[0] + 1));
  }
  prolongation_.split(coarse, parts);
}

}  // namespace brisance::gas
