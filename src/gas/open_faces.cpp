#include "gas/open_faces.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/archive.hpp"

namespace brisance::gas {

namespace {

/// Along rays flatter than this (75 degrees from the normal) waves are taken to come at this angle: with a cosine of 0
/// the face would be a wall for whatever else meets it.
constexpr double least_cosine = 0.25;

/// Difference of velocity across a wave with a difference of pressure d: d / (Z sqrt(1 + k d)). With k = G / (rho c^2)
/// and the fundamental derivative G this is a shock in an ideal or stiffened gas, exactly, and a rarefaction to third
/// order.
struct Wave {
  double impedance;
  double k;

  static constexpr double least = 0.05;  ///< of 1 + k d
  struct Response {
    double velocity;
    double slope;  ///< d velocity / d pressure
  };
  [[nodiscard]] Response to(double d) const {
    double const s = std::max(1.0 + k * d, least);
    double const per_pressure = 1.0 / (impedance * std::sqrt(s));
    return {d * per_pressure, s > least ? (1.0 + 0.5 * k * d) / s * per_pressure : per_pressure};
  }
};

/// How the afterflow of a cylindrical wave follows the pressure: K_1(z)/K_0(z) = 1 + 1/2 sum of weights / (z +
/// rates/4), z the frequency in units of c/r. A sum of poles as in [Alpert00], fitted to the Bessel functions on the
/// imaginary axis from 0.02 to 100 with the sum of the weights, 1, given by the limit of high frequencies; largest
/// error 2.6 %. One pole with the rate 1 is the condition of second order of [BaylissTurkel80], good for short waves
/// only.
constexpr std::array<double, OpenFaces::poles> weights{0.4350, 0.2436, 0.3214};
constexpr std::array<double, OpenFaces::poles> rates{0.0108, 0.3015, 2.264};

void remember(double dt, double source, double fading, double drift, OpenFaces::Memory& memory) {
  for (int k = 0; k < OpenFaces::poles; ++k) memory[k] += dt * (source - (rates[k] * fading + drift) * memory[k]);
}

/// Closure of a cell; where the ambient fluid is alone no other equation of state need be asked.
Mixture closure(Fluids const& fluids, Components const& u) {
  PerFluid const partial = partial_densities(fluids.count, u.data());
  for (int k = 1; k < fluids.count; ++k) {
    if (u[volume_fraction(k)] > vanishing_fraction)
      return mixture(fluids, partial, volume_fractions(fluids.count, u.data()));
  }
  Mixture m;
  std::visit([&](auto const& eos) { material::add_fluid(eos, 1.0, material::phase_density(partial[0], 1.0), m); },
             fluids.ambient());
  return m;
}

/// All fluids of a state compressed alike.
void compress(Fluids const& fluids, double scale, Components& u) {
  for (int k = 0; k < fluids.count; ++k) u[partial_density(k)] *= scale;
}

}  // namespace

OpenFaces::OpenFaces(grid::Grid const& grid, Fluids const& fluids, int components)
    : grid_(&grid), fluids_(fluids), components_(components), faces_(open_faces_of(grid)) {}

OpenFaces::Faces OpenFaces::open_faces_of(grid::Grid const& grid) {
  return {grid, [&grid](grid::Block const& block) {
            std::array<std::optional<Face>, 6> faces;
            for (int f = 0; f < 2 * grid.domain().dimensions(); ++f) {
              if (block.at_boundary(f) && grid.domain().boundary[f] == grid::Boundary::outflow) faces[f].emplace();
            }
            return faces;
          }};
}

OpenFaces::Known OpenFaces::known_at(grid::Grid const& grid, Faces const& faces, Vec3 const& x, int face) {
  grid::Cell const cell = grid.locate(x);
  Face const& of = *faces[cell.block][face];
  grid::CellRange layer = grid.block(cell).interior();
  layer.upper[face / 2] = 1;
  Index3 within = cell.within();
  within[face / 2] = 0;
  std::size_t const n = layer.offset(within);
  return {&of.beyond[of.beyond.size() == 1 ? 0 : n], &of.memory[n]};
}

void OpenFaces::follow(grid::Grid const& before, std::vector<int> const& numbers) {
  Faces const known = std::exchange(faces_, open_faces_of(*grid_));
  int const dims = grid_->domain().dimensions();
  for (grid::Block const& block : grid_->blocks()) {
    if (int const same = numbers[block.number]; same != grid::no_neighbour) {
      faces_[block.number] = known[same];
      continue;
    }
    for (int f = 0; f < 2 * dims; ++f) {
      if (!faces_[block.number][f]) continue;
      Face& face = *faces_[block.number][f];
      bool alike = true;
      for_each_face_cell(block, f / 2, f % 2, [&](grid::Cell const& cell) {
        // Its quarters, for the cells before may have been finer.
        Memory memory{};
        int quarters = 0;
        Known at{nullptr, nullptr};
        for_each_cell(grid::CellRange{{0, 0, 0}, {dims > 0 ? 2 : 1, dims > 1 ? 2 : 1, dims > 2 ? 2 : 1}},
                      [&](Index3 const& part) {
                        if (part[f / 2] != f % 2) return;
                        Vec3 x = block.centre(cell);
                        for (int d = 0; d < dims; ++d) x[d] += (part[d] - 0.5) * 0.5 * block.h();
                        at = known_at(before, known, x, f);
                        for (int k = 0; k < poles; ++k) memory[k] += (*at.memory)[k];
                        ++quarters;
                      });
        for (double& value : memory) value /= quarters;
        face.memory.push_back(memory);
        face.beyond.push_back(*at.beyond);
        alike = alike && face.beyond.back().conserved == face.beyond.front().conserved;
        Vec3 x = block.centre(cell);
        x[f / 2] += (f % 2 == 0 ? -0.5 : 0.5) * block.h();
        face.rays.push_back(ray_to(x, block.h(), f / 2, f % 2, face.beyond.back()));
      });
      if (alike) face.beyond = std::vector<Beyond>{face.beyond.front()};
    }
  }
}

OpenFaces::Beyond OpenFaces::beyond(Components const& u) const {
  Beyond a;
  a.conserved = u;
  Mixture const m = closure(fluids_, u);
  a.density = mixture_density(fluids_.count, u);
  for (int d = 0; d < 3; ++d) a.velocity[d] = u[momentum_x + d] / a.density;
  a.pressure = m.pressure(u[energy] - 0.5 * a.density * dot(a.velocity, a.velocity));
  a.modulus = m.bulk_modulus(a.pressure);
  a.nonlinearity = 1.0 + 0.5 / m.xi;
  return a;
}

WaveSource const* OpenFaces::nearest_source(Vec3 const& x, Vec3& nearest_way, double& distance) const {
  WaveSource const* nearest = nullptr;
  for (WaveSource const& source : sources_) {
    Vec3 way = x - source.position;
    for (int d = 0; d < 3; ++d) {
      if (d >= grid_->domain().dimensions() || source.spans[d]) way[d] = 0.0;
    }
    if (nearest == nullptr || norm(way) < distance) {
      nearest = &source;
      nearest_way = way;
      distance = norm(way);
    }
  }
  return nearest;
}

OpenFaces::Ray OpenFaces::ray_to(Vec3 const& x, double h, int direction, int side, Beyond const& outside) const {
  grid::Domain const& domain = grid_->domain();
  int const dims = domain.dimensions();
  int const exponent = grid::radial_exponent(domain.geometry);
  double const c = std::sqrt(outside.modulus / outside.density);
  Ray ray;
  ray.direction[direction] = side == 0 ? -1.0 : 1.0;
  std::array<double, 2> curvature{0.0, 0.0};
  double distance = 0.0;
  if (dims == 1) {
    if (side == 0 || exponent == 0) return ray;
    distance = x[0];
    curvature = {1.0 / x[0], exponent == 2 ? 1.0 / x[0] : 0.0};
  } else {
    Vec3 nearest_way{0.0, 0.0, 0.0};
    WaveSource const* const nearest = nearest_source(x, nearest_way, distance);
    if (nearest == nullptr || distance <= 0.0) return ray;
    // Between two mirrors waves spread until they are as far from the source as the mirrors from each other.
    int spreading = 0;
    std::array<bool, 3> spreads{false, false, false};
    for (int d = 0; d < dims; ++d) {
      Vec3 others = nearest_way;
      others[d] = 0.0;
      // Waves that come to such a boundary stay in the domain.
      bool const closed = grid::has_images(domain.boundary[2 * d]) && grid::has_images(domain.boundary[2 * d + 1]);
      bool const guided = closed && norm(others) >= domain.upper(d) - domain.lower[d];
      spreads[d] = !nearest->spans[d] && !guided;
      if (spreads[d])
        ++spreading;
      else
        nearest_way[d] = 0.0;
    }
    distance = norm(nearest_way);
    if (distance <= 0.0) return ray;
    ray.direction = (1.0 / distance) * nearest_way;
    double const along = ray.direction[direction] * (side == 0 ? -1.0 : 1.0);
    ray.cosine = spreads[direction] ? std::max(along, least_cosine) : 0.0;
    if (spreading == 3) curvature = {1.0 / distance, 1.0 / distance};
    if (spreading == 2) curvature = {1.0 / distance, 0.0};
    // Around an axis the front is a ring's.
    if (exponent == 1 && spreads[0]) {
      double const ring = x[0] > 0.0 ? std::max(ray.direction[0], 0.0) / x[0] : 0.0;
      curvature = {spreading == 2 ? 1.0 / distance : 0.0, std::min(ring, 1.0 / distance)};
    }
  }
  double const most = 0.5 / h;
  for (double& k : curvature) k = std::min(k, most);
  double const mean = 0.5 * (curvature[0] + curvature[1]);
  if (!(mean > 0.0)) return ray;
  double const difference = 0.5 * (curvature[0] - curvature[1]);
  ray.curvature = mean;
  // In a wind what lasts is no wave but the flow around the source. Far upstream its total pressure is that of the
  // wind: p - p_a = -rho_a u_a . (u - u_a). With this rate of forgetting the condition comes to it. Elsewhere nothing
  // is forgotten, and the pressure of a steady flow comes to that of the ambient gas.
  bool const windy = norm(outside.velocity) > 0.0;
  double const against = std::max(-dot(outside.velocity, ray.direction), 0.0);
  ray.fading = windy ? 0.0 : 0.5 * c * difference * difference / mean;
  ray.drift = mean * against / (1.0 - std::min(against / c, 0.9));
  return ray;
}

void OpenFaces::start(grid::Fields const& fields, Components const& ambient,
                      std::function<bool(grid::Cell const& cell)> const& consumed) {
  for (int b = 0; b < grid_->block_count(); ++b) {
    grid::Block const& block = grid_->blocks()[b];
    for (int f = 0; f < 6; ++f) {
      if (!faces_[b][f]) continue;
      Face& face = faces_[b][f].emplace();
      bool alike = true;
      auto const cells = static_cast<std::size_t>(block.cell_count() / block.n[f / 2]);
      face.beyond.reserve(cells);
      face.rays.reserve(cells);
      for_each_face_cell(block, f / 2, f % 2, [&](grid::Cell const& cell) {
        Components u{};
        for (int c = 0; c < components_; ++c) u[c] = fields.at(b, c)[cell.offset];
        if (consumed(cell)) u = ambient;
        face.beyond.push_back(beyond(u));
        alike = alike && u == face.beyond.front().conserved;
        Vec3 x = block.centre(cell);
        x[f / 2] += (f % 2 == 0 ? -0.5 : 0.5) * block.h();
        face.rays.push_back(ray_to(x, block.h(), f / 2, f % 2, face.beyond.back()));
      });
      face.memory.assign(face.rays.size(), Memory{});
      if (alike) face.beyond = std::vector<Beyond>{face.beyond.front()};
    }
  }
}

bool OpenFaces::outside_state(Beyond const& a, Ray const& ray, int direction, int side, double h, double dt,
                              Memory& memory, double& signal, Components& u) const {
  double const normal = side == 0 ? -1.0 : 1.0;
  double const rho = mixture_density(fluids_.count, u);
  Vec3 velocity{u[momentum_x] / rho, u[momentum_y] / rho, u[momentum_z] / rho};
  Mixture m = closure(fluids_, u);
  double const p = m.pressure(u[energy] - 0.5 * rho * dot(velocity, velocity));
  double const modulus = m.bulk_modulus(p);
  if (!(rho > 0.0) || !(modulus > 0.0)) return false;
  double const w = normal * velocity[direction];
  double const w_a = normal * a.velocity[direction];
  if (w_a <= -std::sqrt(a.modulus / a.density)) {  // enters faster than sound
    u = a.conserved;
    signal = std::max(signal, norm(a.velocity) + std::sqrt(a.modulus / a.density));
    return true;
  }
  Wave const leaving{std::sqrt(rho * modulus), (1.0 + 0.5 / m.xi) / modulus};
  Wave const outer{std::sqrt(a.density * a.modulus), a.nonlinearity / a.modulus};
  double afterflow = 0.0;
  for (int k = 0; k < poles; ++k) afterflow += weights[k] * memory[k];
  afterflow *= ray.curvature / a.density;
  // Not below what waves can expand the gas to on either side, with some distance.
  constexpr double most_expansion = 0.8;
  double const least_p = std::max(p - most_expansion / leaving.k, a.pressure - most_expansion / outer.k);
  double face_p = std::max(p, least_p);
  for (int n = 0; n < 8; ++n) {
    double const d = face_p - a.pressure;
    Wave::Response const inside = leaving.to(face_p - p);
    Wave::Response const outside = outer.to(d);
    double const miss = w - w_a - inside.velocity - ray.cosine * (outside.velocity + afterflow);
    double const before = face_p;
    face_p = std::max(least_p, face_p + miss / (inside.slope + ray.cosine * outside.slope));
    if (std::abs(face_p - before) <= 1e-12 * modulus) break;
  }
  // Nothing enters against gas that leaves faster than the wave which turns to it: sound, or a shock where the pressure
  // outside is higher.
  if (w >= std::sqrt(modulus / rho * std::max(1.0, 1.0 + leaving.k * (face_p - p)))) {
    remember(dt, p - a.pressure, ray.fading, ray.drift, memory);
    return false;
  }
  double const d = face_p - a.pressure;
  double const alone = outer.to(d).velocity;
  double const rise = ray.cosine * (alone + afterflow);
  double const face_w = w_a + rise;
  if (!std::isfinite(face_w)) return false;
  remember(dt, d + 0.25 * a.nonlinearity * a.density * alone * alone, ray.fading, ray.drift, memory);
  if (face_w >= 0.0) {
    double const scale = std::clamp(1.0 + (face_p - p) / modulus, 0.1, 10.0);
    compress(fluids_, scale, u);
    if (components_ > progress) u[progress] *= scale;
  } else {
    double const scale = std::clamp(1.0 + d / a.modulus, 0.1, 10.0);
    double const shocked = u[shock];
    u = a.conserved;
    u[shock] = shocked;
    compress(fluids_, scale, u);
    velocity = a.velocity + (rise / ray.cosine) * ray.direction;
  }
  velocity[direction] = normal * face_w;
  double const face_rho = mixture_density(fluids_.count, u);
  m = closure(fluids_, u);
  for (int c = 0; c < 3; ++c) u[momentum_x + c] = face_rho * velocity[c];
  u[energy] = m.rho_e(face_p) + 0.5 * face_rho * dot(velocity, velocity);
  double const face_modulus = m.bulk_modulus(face_p);
  if (!(face_modulus > 0.0) || !std::isfinite(u[energy])) return false;
  double const fastest = norm(velocity) + std::sqrt(face_modulus / face_rho);
  signal = std::max(signal, fastest);
  // The step was chosen without knowing of this inflow: it waits for the next one.
  return fastest * dt <= h;
}

void OpenFaces::fill(grid::Fields const& fields, int b, int direction, double dt, bool burning,
                     grid::Exchange& exchange) {
  grid::Block const& block = grid_->blocks()[b];
  for (int side = 0; side < 2; ++side) {
    if (!faces_[b][2 * direction + side]) continue;
    Face& face = *faces_[b][2 * direction + side];
    grid::CellRange slab = block.interior();
    slab.upper[direction] = grid::ghost_layers;
    std::size_t const count = slab.count();
    std::ptrdiff_t const layer = slab.stride(direction);
    double* const ghosts = exchange.ghosts(b, side);
    face.signal = 0.0;
    std::size_t number_in_face = 0;
    for_each_face_cell(block, direction, side, [&](grid::Cell const& cell) {
      std::size_t const n = number_in_face++;
      Beyond const& beyond = face.beyond[face.beyond.size() == 1 ? 0 : n];
      Ray const& ray = face.rays[n];
      if (ray.cosine == 0.0) return;
      Components u{};
      for (int c = 0; c < components_; ++c) u[c] = fields.at(b, c)[cell.offset];
      // What has not been disturbed stays as it is to the last bit: blocks there may sleep.
      if (face.memory[n] == Memory{} && u == beyond.conserved) return;
      if (burning && u[volume_fraction(products_fluid)] > 0.0) return;
      if (!outside_state(beyond, ray, direction, side, block.h(), dt, face.memory[n], face.signal, u)) return;
      Index3 lowest = cell.within();
      lowest[direction] = 0;
      std::size_t const first = slab.offset(lowest);
      for (int c = 0; c < components_; ++c) {
        for (int l = 0; l < grid::ghost_layers; ++l) ghosts[c * count + first + l * layer] = u[c];
      }
    });
  }
}

double OpenFaces::fastest_signal(int block) const {
  double fastest = 0.0;
  for (auto const& face : faces_[block]) {
    if (face) fastest = std::max(fastest, face->signal);
  }
  return fastest;
}

void OpenFaces::archive(Archive& a) {
  for (auto& faces : faces_) {
    for (auto& face : faces) {
      if (!face) continue;
      a.same(face->memory.size(), "the number of cells at an outflow boundary");
      for (auto& memory : face->memory) a(memory);
    }
  }
}

}  // namespace brisance::gas
