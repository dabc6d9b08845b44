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

bool is_uniform(Prolongation::Coarse const& cell) {
  return std::all_of(cell.beside.begin(), cell.beside.end(), [&cell](PhaseState const* beside) {
    return beside == nullptr || (beside->alpha == cell.state->alpha && beside->density == cell.state->density &&
                                 beside->velocity == cell.state->velocity && beside->pressure == cell.state->pressure);
  });
}

/// A coarse cell that is being split: what the parts hold, from one quantity to the next.
class Split {
 public:
  Split(Fluids const& fluids, Prolongation::Coarse const& cell, int dimensions)
      : fluids_(&fluids), cell_(&cell), dimensions_(dimensions), count_(1 << dimensions) {
    for (int n = 0; n < count_; ++n) {
      volume_[n] = 1.0;
      for (int d = 0; d < dimensions; ++d) {
        bool const high = (n >> d & 1) != 0;
        offsets_[n][d] = high ? 0.25 : -0.25;
        volume_[n] *= d > 0 ? 0.5 : high ? 1.0 - cell.low_part : cell.low_part;
      }
    }
  }

  void find_volume_fractions() {
    alpha_.fill(cell_->state->alpha);
    for (int k = 1; k < fluids_->count; ++k) {
      PerPart const change = differences([k](PhaseState const& s) { return s.alpha[k]; }, volume_);
      for (int n = 0; n < count_; ++n) {
        alpha_[n][k] += change[n];
        alpha_[n][0] -= change[n];
      }
    }
  }

  void find_densities(Prolongation::Parts& parts) {
    for (int k = 0; k < fluids_->count; ++k) {
      int const partial = partial_density(k);
      double const own = cell_->state->density[k];
      if (own > 0.0) {
        PerPart weight{};
        for (int n = 0; n < count_; ++n) weight[n] = volume_[n] * alpha_[n][k];
        // Neighbours without the fluid have no say.
        PerPart const change =
            differences([k, own](PhaseState const& s) { return s.density[k] > 0.0 ? s.density[k] : own; }, weight);
        for (int n = 0; n < count_; ++n) parts[n][partial] = alpha_[n][k] * (own + change[n]);
      }
      for (int n = 0; n < count_; ++n) mass_[n] += volume_[n] * parts[n][partial];
    }
    for (int n = 0; n < count_; ++n) {
      for (int k = 1; k < fluids_->count; ++k) parts[n][volume_fraction(k)] = alpha_[n][k];
    }
  }

  void find_velocities() {
    velocity_.fill(cell_->state->velocity);
    for (int d = 0; d < 3; ++d) {
      PerPart const change = differences([d](PhaseState const& s) { return s.velocity[d]; }, mass_);
      for (int n = 0; n < count_; ++n) velocity_[n][d] += change[n];
    }
  }

  /// Momentum and energy. Are all parts sound?
  [[nodiscard]] bool find_energies(Prolongation::Parts& parts) {
    std::array<Mixture, Prolongation::most_parts> closure{};
    PerPart weight{};
    double xi = 0.0;
    double bound = 0.0;  // energy that is no pressure's: kinetic, and B
    for (int n = 0; n < count_; ++n) {
      closure[n] = mixture(*fluids_, partial_densities(fluids_->count, parts[n].data()),
                           volume_fractions(fluids_->count, parts[n].data()));
      weight[n] = volume_[n] * closure[n].xi;
      xi += weight[n];
      bound += 0.5 * mass_[n] * dot(velocity_[n], velocity_[n]) + volume_[n] * closure[n].B;
    }
    double const pressure = ((*cell_->conserved)[energy] - bound) / xi;
    PerPart const change = differences([](PhaseState const& s) { return s.pressure; }, weight);
    bool sound = true;
    for (int n = 0; n < count_; ++n) {
      double const p = pressure + change[n];
      double const rho = mass_[n] / volume_[n];
      sound = sound && rho > 0.0 && closure[n].bulk_modulus(p) > 0.0 && (p > 0.0 || cell_->state->pressure <= 0.0);
      for (int d = 0; d < 3; ++d) parts[n][momentum_x + d] = rho * velocity_[n][d];
      parts[n][energy] = closure[n].rho_e(p) + 0.5 * rho * dot(velocity_[n], velocity_[n]);
    }
    return sound;
  }

 private:
  /// What a quantity differs by from its mean in each part, by the slopes in all directions; the mean is taken by
  /// weights.
  template <class Of>
  [[nodiscard]] PerPart differences(Of const& quantity, PerPart const& weight) const {
    double const own = quantity(*cell_->state);
    Vec3 slope{0.0, 0.0, 0.0};
    double least = own;
    double most = own;
    double reach = 0.0;
    for (int d = 0; d < dimensions_; ++d) {
      if (cell_->beside[2 * d] == nullptr || cell_->beside[2 * d + 1] == nullptr) continue;
      double const low = quantity(*cell_->beside[2 * d]);
      double const high = quantity(*cell_->beside[2 * d + 1]);
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
    for (int n = 0; n < count_; ++n) {
      middle = middle + weight[n] * offsets_[n];
      whole += weight[n];
    }
    if (!(whole > 0.0)) return difference;
    middle = (1.0 / whole) * middle;
    for (int n = 0; n < count_; ++n) difference[n] = dot(slope, offsets_[n] - middle);
    return difference;
  }

  Fluids const* fluids_;
  Prolongation::Coarse const* cell_;
  int dimensions_;
  int count_;
  Offsets offsets_{};
  PerPart volume_{};
  PerPart mass_{};  ///< in parts of the coarse cell's volume
  std::array<PerFluid, Prolongation::most_parts> alpha_{};
  std::array<Vec3, Prolongation::most_parts> velocity_{};
};

}  // namespace

namespace {

/// Is there no more than a trace of any fluid but the ambient one? Sweeps then look at nothing else either.
bool is_pure(Fluids const& fluids, PhaseState const& state) {
  for (int k = 1; k < fluids.count; ++k) {
    if (state.alpha[k] > vanishing_fraction) return false;
  }
  return true;
}

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
  double const internal = u[energy] - 0.5 * rho * dot(state.velocity, state.velocity);
  auto const* const ideal = std::get_if<material::IdealGas>(&fluids.ambient());
  if (ideal != nullptr && is_pure(fluids, state)) {
    state.pressure = (ideal->gamma - 1.0) * internal;
    return state;
  }
  state.pressure = mixture(fluids, partial, alpha).pressure(internal);
  return state;
}

void Prolongation::split(Coarse const& cell, Parts& parts) const {
  Components const& u = *cell.conserved;
  std::fill_n(parts.begin(), this->parts(), u);
  if (is_uniform(cell)) return;  // to the last bit
  Split split(*fluids_, cell, dimensions_);
  split.find_volume_fractions();
  split.find_densities(parts);
  split.find_velocities();
  if (!split.find_energies(parts)) {
    std::fill_n(parts.begin(), this->parts(), u);
    return;
  }
  if (components_ <= progress) return;
  int const products = partial_density(products_fluid);
  for (int n = 0; n < this->parts(); ++n) {
    if (u[products] > 0.0) parts[n][progress] = u[progress] / u[products] * parts[n][products];
  }
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

void CoarsePatch::set_solid(std::size_t place, Components const& conserved) {
  conserved_[place] = conserved;
  known_[place] = 0;
}

void CoarsePatch::split(Index3 const& index, grid::Metric const& fine, Prolongation::Parts& parts) const {
  std::size_t const place = box_.offset(index);
  if (known_[place] == 0) {
    std::fill_n(parts.begin(), prolongation_.parts(), conserved_[place]);
    return;
  }
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
