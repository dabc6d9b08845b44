#include "bridge/ledger.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "bridge/conversion.hpp"
#include "core/parallel.hpp"

namespace brisance::bridge {

namespace {

constexpr int group = 64;  // faces that a thread takes at a time

/// A mass near to `wanted`: not less than the usual one / 1.25, and not more beyond it than fills a quarter of a
/// particle's volume at the fluid's own density.
double near_mass(double usual, double wanted, double own_density, double volume) {
  constexpr double most = 0.25;
  return std::clamp(wanted, usual / (1.0 + most), usual + most * own_density * volume);
}

/// Sum of the sizes of the masses [kg].
double size_of(Amounts const& amounts) {
  double sum = 0.0;
  for (double const mass : amounts.mass) sum += std::abs(mass);
  return sum;
}

/// Do the compositions of two states differ by more than this mass fraction?
bool is_contact(Primitive const& a, Primitive const& b, double part) {
  for (int k = 1; k < most_fluids; ++k) {
    if (std::abs(a.mass_fraction[k] - b.mass_fraction[k]) > part) return true;
  }
  return false;
}

/// The composition of a state that holds masses [kg] of a sum. Where all fluids are there they keep the ratio of their
/// own densities, and so the pressure.
void set_composition(PerFluid const& masses, double sum, PerFluid const& own_density, Primitive& state) {
  for (int k = 1; k < most_fluids; ++k) state.mass_fraction.set(k, masses[k] / sum);
  if (std::any_of(own_density.begin(), own_density.end(), [](double rho) { return !(rho > 0.0); })) return;
  PerFluid filled{};
  double all = 0.0;
  for (int k = 0; k < most_fluids; ++k) {
    filled[k] = masses[k] / own_density[k];
    all += filled[k];
  }
  for (int k = 1; k < most_fluids; ++k) state.volume_fraction.set(k, filled[k] / all);
}

constexpr double least_fraction = 1e-6;
constexpr int most_births = 16;  // of one lane in one step: more is not met within the Courant limit

}  // namespace

Ledger::Ledger(Faces const& faces, SharedGas const& shared)
    : faces_(&faces), shared_(&shared), accounts_(faces.lane_count()), shares_(faces), outwards_(faces.count(), 0) {}

Amounts Ledger::sum() const {
  Amounts sum;
  for (Amounts const& account : accounts_) sum.add(account);
  return sum;
}

double Ledger::reach(int face, Vec3 const& x) const {
  int const lane = faces_->lane_of(face, x);
  double const length = accounts_[faces_->number(face, lane)].volume / faces_->lane_area(face, lane);
  return (*faces_)[face].side == 0 ? length : -length;
}

double Ledger::content() const {
  double sum = 0.0;
  for (Amounts const& account : accounts_) sum += size_of(account);
  return sum;
}

double Ledger::surplus() const {
  Faces const& faces = *faces_;
  double sum = 0.0;
  for (int f = 0; f < faces.count(); ++f) {
    if (faces[f].open) continue;  // through open faces gas leaves at once
    double const density = std::max(shared_->outside(f).density, shared_->inside(f).density);
    for (int lane = 0; lane < faces.lanes(); ++lane) {
      Amounts const& account = accounts_[faces.number(f, lane)];
      double const particle = density * faces.standard_volume(faces[f].inside, faces.sub_cell(f, lane));
      sum += std::max(0.0, size_of(account) - 2.0 * particle);
    }
  }
  return sum;
}

void Ledger::find_directions(Fluxes const& watched, double share) {
  for (int f = 0; f < faces_->count(); ++f) {
    Face const& face = (*faces_)[f];
    if (face.open) continue;
    gas::FaceFlux const& flux = watched[face.watch];
    if (flux.impulse == 0.0) continue;  // both sides sleep
    double const sign = face.side == 0 ? share : -share;
    outwards_[f] = sign * flux.carried.total() < 0.0 ? 1 : 0;
  }
}

void Ledger::add_fluxes(Fluxes const& watched, double share) {
  for (int f = 0; f < faces_->count(); ++f) {
    Face const& face = (*faces_)[f];
    if (face.open) continue;
    gas::FaceFlux const& flux = watched[face.watch];
    if (flux.impulse == 0.0) continue;
    double const sign = face.side == 0 ? share : -share;
    for (int lane = 0; lane < faces_->lanes(); ++lane) {
      at(f, lane).add(flux.carried, sign * faces_->lane_area(f, lane));
    }
  }
}

void Ledger::add_pressure(Fluxes const& watched, double share, double dt, double reference, double resting) {
  for (int f = 0; f < faces_->count(); ++f) {
    Face const& face = (*faces_)[f];
    if (face.open) continue;
    gas::FaceFlux const& flux = watched[face.watch];
    bool const asleep = flux.impulse == 0.0;
    double const inward = face.side == 0 ? 1.0 : -1.0;
    double const impulse = (asleep ? resting * dt : share * flux.impulse) - reference * dt;
    double const work = share * flux.work;
    for (int lane = 0; lane < faces_->lanes(); ++lane) {
      double const area = inward * faces_->lane_area(f, lane);
      at(f, lane).momentum[face.direction] += area * impulse;
      at(f, lane).energy += area * work;
    }
  }
}

void Ledger::take_gifts(mpm::ProxyParticles& proxies, std::vector<int> const& blocks, Amounts& outflow) {
  gifts_.assign(faces_->count(), Amounts{});
  int const dims = faces_->region().domain().dimensions();
  for (int const block : blocks) {
    for (mpm::NodeGift const& gift : proxies.gifts(block)) {
      for (NodeShares::Share const& s : shares_.around(gift.node)) {
        for (int d = 0; d < dims; ++d) gifts_[s.face].momentum[d] += s.fraction * gift.momentum[d];
        gifts_[s.face].energy += s.fraction * gift.energy;
      }
      for (int d = 0; d < dims; ++d) {
        for (NodeShares::Share const& s : shares_.across(gift.node, d)) {
          gifts_[s.face].momentum[d] += s.fraction * gift.impulse[d];
          gifts_[s.face].energy += s.fraction * gift.work[d];
        }
      }
    }
  }
  for (int f = 0; f < faces_->count(); ++f) {
    if ((*faces_)[f].open) {
      outflow.energy -= gifts_[f].energy;
      continue;
    }
    double area = 0.0;
    for (int lane = 0; lane < faces_->lanes(); ++lane) area += faces_->lane_area(f, lane);
    for (int lane = 0; lane < faces_->lanes(); ++lane) at(f, lane).add(gifts_[f], -faces_->lane_area(f, lane) / area);
  }
}

void Ledger::add_inflow(double dt, std::optional<double> reference, Amounts& outflow) {
  Faces const& faces = *faces_;
  for (int f = 0; f < faces.count(); ++f) {
    if (!faces[f].open) continue;
    if (shared_->solid_at(f)) continue;
    CellSums const& sums = shared_->sums_at(f);
    if (sums.volume < 0.1 * faces.region().metric().cell_volume(faces[f].inside[0])) continue;
    Primitive const s = primitive(shared_->fluids(), sums);
    double const inward = faces[f].inward(s.velocity);
    double const e = specific_energy(shared_->fluids(), s) + 0.5 * dot(s.velocity, s.velocity);
    Amounts const gas_per_mass = per_mass(s, e);
    for (int lane = 0; lane < faces.lanes(); ++lane) {
      double const volume = faces.lane_area(f, lane) * dt * inward;
      if (!reference) outflow.energy -= volume * s.pressure;
      if (inward <= 0.0) continue;
      double const mass = volume * s.density;
      at(f, lane).add(gas_per_mass, mass);
      at(f, lane).volume += volume;
      outflow.add(gas_per_mass, -mass);
      outflow.volume -= volume;
      outflow.energy -= volume * reference.value_or(0.0);
    }
  }
}

/// The volumes of the accounts are what has crossed by the velocity of the face, less what particles took along; they
/// shrink and grow with the gas there. Where gas flows out, away from contacts, the masses tell better what is missing
/// in space than the volumes that particles carry; and no more than one particle's volume can be missing.
void Ledger::follow_volumes(double dt) {
  Faces const& faces = *faces_;
  int const dims = faces.region().domain().dimensions();
  double const h = faces.region().metric().h;
  for (int f = 0; f < faces.count(); ++f) {
    if (faces[f].open) continue;
    Primitive const& outside = shared_->outside(f);
    Primitive const& inside = shared_->inside(f);
    GasSlopes const slopes = shared_->slopes_outside(f);
    double divergence = faces[f].inward(inside.velocity - outside.velocity) / h;
    for (int d = 0; d < dims; ++d) {
      if (d != faces[f].direction) divergence += slopes.velocity[d][d] / h;
    }
    double const stretch = std::exp(dt * divergence);
    bool const contact = differ(inside.density, outside.density, 0.1);
    for (int lane = 0; lane < faces.lanes(); ++lane) {
      Amounts& account = at(f, lane);
      if (outwards_[f] != 0 && !contact) {
        Amounts const& before = before_[faces.number(f, lane)];
        account.volume = before.volume + (account.total() - before.total()) / outside.density;
      }
      account.volume *= stretch;
      if (outwards_[f] == 0) continue;
      double const most = faces.standard_volume(faces[f].inside, faces.sub_cell(f, lane));
      account.volume = std::clamp(account.volume, -most, most);
    }
  }
}

/// Where gas flows out at an angle, particles leave through other lanes than the fluxes say: rows of particles cross a
/// face in few places, the flux does so evenly. Without an exchange along the surface the accounts would drift apart
/// without bound. Half of the difference to the neighbours is evened out in every step; not where gas flows in, for
/// particles are injected there when their lane is ripe, and lanes in step make regular rows.
void Ledger::level() {
  if (faces_->region().domain().dimensions() == 1) return;
  double const rate = 0.5 / (2.0 * (faces_->region().domain().dimensions() - 1));
  before_ = accounts_;
  auto const flows_out = [&](std::size_t lane) { return outwards_[faces_->face_of(lane)] != 0; };
  for (std::size_t n = 0; n < accounts_.size(); ++n) {
    if (!flows_out(n)) continue;
    for (int const other : faces_->neighbours(n)) {
      if (other < 0 || !flows_out(other)) continue;
      accounts_[n].add(before_[other], rate);
      accounts_[n].add(before_[n], -rate);
    }
  }
}

long Ledger::inject(GasParticles& particles) {
  Faces const& faces = *faces_;
  int const count = faces.count();
  int const groups = (count + group - 1) / group;
  std::vector<mpm::ParticleSet> injected(groups);
  double const spacing = faces.region().metric().h / faces.parts();
  parallel_for(groups, [&](int g, int) {
    for (int f = g * group; f < std::min(count, (g + 1) * group); ++f) {
      for (int lane = 0; lane < faces.lanes(); ++lane) {
        Amounts& account = at(f, lane);
        if (account.volume <= 0.0) continue;
        if (faces[f].open && shared_->sums_at(f).volume <= 0.0) continue;
        GasSlopes slopes;
        Primitive const donor = shared_->donor(f, lane, slopes);
        if (faces[f].inward(donor.velocity) <= 0.0) continue;
        double const volume = faces.standard_volume(faces[f].inside, faces.sub_cell(f, lane));
        PerFluid usual{};
        PerFluid own_density{};  // of a fluid that is not there nothing is known
        for (int k = 0; k < most_fluids; ++k) {
          usual[k] = donor.mass_fraction[k] * donor.density * volume;
          double const fraction = donor.volume_fraction[k];
          if (fraction > least_fraction) own_density[k] = usual[k] / (fraction * volume);
        }
        for (int n = 0; n < most_births && account.volume >= 0.5 * volume; ++n) {
          // What is left of the ledger after the injection is to have the donor's partial densities.
          double const left = account.volume / volume - 1.0;
          PerFluid masses{};
          double mass = 0.0;
          for (int k = 0; k < most_fluids; ++k) {
            masses[k] = near_mass(usual[k], account.mass[k] - left * usual[k], own_density[k], volume);
            mass += masses[k];
          }
          Primitive state = donor;
          state.density = mass / volume;
          set_composition(masses, mass, own_density, state);
          double const depth = (account.volume / volume - 0.5) * spacing;
          if (injected[g].fields().size() == 0) injected[g] = particles.empty_set();
          particles.append(f, lane, depth, mass, state, slopes, injected[g]);
          int const last = injected[g].size() - 1;
          account.add(faces[f].open ? particles.carried(injected[g], last) : particles.handed_over(injected[g], last),
                      -1.0);
        }
      }
    }
  });
  long sum = 0;
  for (mpm::ParticleSet const& set : injected) {
    if (set.empty()) continue;
    particles.add(set);
    sum += set.size();
  }
  return sum;
}

/// What an account holds beyond the gas in its volume, the fluxes of the gas gave and the particles did not take, or
/// the other way round. It goes back to the gas cell outside, a fraction of it in every step, and never more than is
/// small beside what the cell holds. To the particles it cannot go: they would answer at once, and the two would swing.
void Ledger::give_back(gas::Gas& gas, double dt, double reference) {
  constexpr double length = 20.0;  // that sound goes while most of a surplus is given back [cells]
  constexpr double bleed = 200.0;  // see below
  constexpr double most = 0.02;    // of what a cell holds, in a step
  Faces const& faces = *faces_;
  grid::Metric const& cells = faces.region().metric();
  int const dims = cells.dimensions();
  material::Fluids const& fluids = shared_->fluids();
  double const usual = std::min(0.5, dt * shared_->states().fastest_signal() / (length * cells.h));
  for (int f = 0; f < faces.count(); ++f) {
    if (faces[f].open) continue;
    Primitive const& outside = shared_->outside(f);
    Primitive const& inside = shared_->inside(f);
    // While a contact stands at the face nobody can tell what belongs in the account.
    if (is_contact(inside, outside, 0.1)) continue;
    Primitive const& own = outwards_[f] != 0 ? inside : outside;
    double const heat_outside = specific_energy(fluids, outside);
    double const energy =
        specific_energy(fluids, own) + 0.5 * dot(own.velocity, own.velocity) + reference / own.density;
    Amounts const gas_per_mass = per_mass(own, energy);
    double const strain = std::abs(faces[f].inward(inside.velocity - outside.velocity)) / cells.h * dt;
    // Rows of particles cross a face at once, the fluxes do so evenly: what is under way in uniform flow belongs there,
    // and sound should pass undisturbed. Errors come with strain; where it is 0.5 % in a step or more all goes back.
    double const part = usual * std::min(1.0, bleed * strain);
    double const cell = std::abs(cells.cell_volume(faces[f].outside()[0])) / faces.lanes();
    Amounts given_by_face;
    given_.assign(faces.lanes(), Amounts{});
    for (int lane = 0; lane < faces.lanes(); ++lane) {
      Amounts& account = at(f, lane);
      double const volume = faces.standard_volume(faces[f].inside, faces.sub_cell(f, lane));
      Amounts rest = account;
      rest.volume = 0.0;
      rest.add(gas_per_mass, -own.density * std::clamp(account.volume, -volume, volume));
      double const mass = cell * outside.density;
      double const heat = mass * heat_outside;
      auto const limited = [&](double wanted, double scale) {
        return std::clamp(part * wanted, -most * scale, most * scale);
      };
      Amounts& given = given_[lane];
      for (int k = 0; k < most_fluids; ++k) given.mass[k] = limited(rest.mass[k], mass * outside.mass_fraction[k]);
      for (int d = 0; d < dims; ++d) given.momentum[d] = limited(rest.momentum[d], std::sqrt(mass * heat));
      given.energy = limited(rest.energy, heat);
      given_by_face.add(given);
    }
    // The cell keeps most of its heat: fast gas has little beside its motion.
    double const mass = cell * faces.lanes() * outside.density;
    Vec3 const momentum = mass * outside.velocity + given_by_face.momentum;
    double const motion = 0.5 * mass * dot(outside.velocity, outside.velocity);
    double const heated =
        given_by_face.energy + motion - 0.5 * dot(momentum, momentum) / (mass + given_by_face.total());
    if (heated < -most * mass * heat_outside) continue;
    for (int lane = 0; lane < faces.lanes(); ++lane) at(f, lane).add(given_[lane], -1.0);
    add_to_cell(gas, faces.region().locate(gas.grid(), faces[f].outside()), given_by_face);
  }
}

}  // namespace brisance::bridge
