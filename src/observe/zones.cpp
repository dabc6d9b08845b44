#include "observe/zones.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "run/system.hpp"

namespace brisance::observe {

namespace {

using mpm::Field;

enum class Kind { crushed, cracked };

/// A broken particle: where it was, and how much of the body it stands for.
struct Broken {
  Vec3 origin{0.0, 0.0, 0.0};
  double volume = 0.0;
  Kind kind = Kind::crushed;
};

/// The particles of a body that matter here.
struct Survey {
  std::vector<Broken> broken;
  Vec3 low{0.0, 0.0, 0.0};  ///< box around the particles at the start, each with its half size
  Vec3 high{0.0, 0.0, 0.0};
};

Survey survey_of(run::System const& w, run::BodyPlace const& place, BrokenZones& zones) {
  mpm::Mpm const& particles = *w.regions[place.region].particles;
  int const body = place.body;
  Survey survey;
  double const far = std::numeric_limits<double>::max();
  survey.low = {far, far, far};
  survey.high = {-far, -far, -far};
  double const density = particles.bodies()[body].solid.density;
  for (int block = 0; block < particles.grid().block_count(); ++block) {
    mpm::ParticleSet const& set = particles.particles(block, body);
    double const* const crushing = set.field(Field::crushing);
    double const* const cracking = set.field(Field::cracking);
    double const* const damage = set.field(Field::damage);
    double const* const mass = set.field(Field::mass);
    for (int q = 0; q < set.size(); ++q) {
      Broken particle;
      for (int d = 0; d < 3; ++d) {
        particle.origin[d] = set.field(Field::origin_x + d)[q];
        survey.low[d] = std::min(survey.low[d], particle.origin[d]);
        survey.high[d] = std::max(survey.high[d], particle.origin[d]);
      }
      if (damage[q] >= 0.5) {
        zones.damaged.mass += mass[q];
        zones.damaged.volume += mass[q] / density;
      }
      bool const crushed = crushing[q] >= 1.0;
      if (!crushed && cracking[q] < 1.0) continue;
      particle.kind = crushed ? Kind::crushed : Kind::cracked;
      particle.volume = mass[q] / density;
      BrokenPart& part = crushed ? zones.crushed : zones.cracked;
      part.mass += mass[q];
      part.volume += particle.volume;
      survey.broken.push_back(particle);
    }
  }
  double const half = 0.5 * particles.grid().smallest_cell() / particles.bodies()[body].particles_per_direction;
  for (int d = 0; d < w.setup.domain.dimensions(); ++d) {
    survey.low[d] -= half;
    survey.high[d] += half;
  }
  return survey;
}

/// Cells that hold broken particles, and which of them hang together with a face.
class Cells {
 public:
  Cells(grid::Metric const& metric, std::vector<Broken> const& broken, Kind kind) : metric_(&metric) {
    for (Broken const& particle : broken) {
      if (particle.kind == kind) joined_[cell_of(particle.origin)] = false;
    }
  }
  [[nodiscard]] Index3 cell_of(Vec3 const& x) const {
    Index3 cell{0, 0, 0};
    for (int d = 0; d < metric_->dimensions(); ++d) {
      cell[d] = static_cast<int>(std::floor(metric_->in_cells(d, x[d])));
    }
    return cell;
  }
  /// Joins the cell of a particle on the face and all broken ones that hang together with it, corners included.
  void join(Index3 const& start) {
    auto const first = joined_.find(start);
    if (first == joined_.end() || first->second) return;
    first->second = true;
    std::vector<Index3> front{start};
    while (!front.empty()) {
      Index3 const at = front.back();
      front.pop_back();
      for_each_cell(grid::around(at, 1, 3), [&](Index3 const& cell) {
        auto const next = joined_.find(cell);
        if (next == joined_.end() || next->second) return;
        next->second = true;
        front.push_back(next->first);
      });
    }
  }
  [[nodiscard]] bool joined(Vec3 const& x) const { return joined_.at(cell_of(x)); }

 private:
  grid::Metric const* metric_;
  std::map<Index3, bool> joined_;
};

struct Extent {
  double diameter = 0.0;
  double depth = 0.0;
  std::optional<double> beyond;  ///< distance to the nearest broken particle that does not hang together with the face
};

Extent extent_of(grid::Domain const& domain, Survey const& survey, Kind kind, int face, double spacing, double images) {
  int const d = face / 2;
  auto const below = [&](Broken const& particle) {  // distance from the face
    return face % 2 == 0 ? particle.origin[d] - survey.low[d] : survey.high[d] - particle.origin[d];
  };
  Cells cells(domain, survey.broken, kind);
  double area = 0.0;
  for (Broken const& particle : survey.broken) {
    if (particle.kind != kind || below(particle) > spacing) continue;
    cells.join(cells.cell_of(particle.origin));
    area += particle.volume / spacing * images;
  }
  Extent out;
  for (Broken const& particle : survey.broken) {
    if (particle.kind != kind) continue;
    double const distance = below(particle);
    if (cells.joined(particle.origin)) {
      out.depth = std::max(out.depth, distance + 0.5 * spacing);
    } else {
      out.beyond = std::min(out.beyond.value_or(distance), distance);
    }
  }
  if (domain.dimensions() > 1) {
    bool const planar = domain.geometry == grid::Geometry::planar2d;
    out.diameter = planar ? area : 2.0 * std::sqrt(area / std::numbers::pi);
  }
  return out;
}

}  // namespace

std::vector<BrokenZones> broken_zones(run::System const& w) {
  std::vector<BrokenZones> all;
  if (w.regions.empty()) return all;
  for (std::size_t b = 0; b < w.setup.particles.bodies.size(); ++b) {
    int const body = static_cast<int>(b);
    run::BodyPlace const place = w.place_of(body);
    mpm::Mpm const& particles = *w.regions[place.region].particles;
    mpm::Body const& made_of = particles.bodies()[place.body];
    if (!made_of.solid.crushes()) continue;
    grid::Domain const domain = w.setup.region_domain(place.region);
    BrokenZones zones;
    zones.body = body;
    Survey const survey = survey_of(w, place, zones);
    double const spacing = particles.grid().smallest_cell() / made_of.particles_per_direction;
    auto const mirrored = [&](int face) {
      int const d = face / 2;
      double const gap = face % 2 == 0 ? survey.low[d] - domain.lower[d] : domain.upper(d) - survey.high[d];
      return domain.boundary[face] == grid::Boundary::symmetry && std::abs(gap) < 0.5 * spacing;
    };
    for (int face = 0; face < 2 * domain.dimensions() && survey.low[0] <= survey.high[0]; ++face) {
      bool const axis = face == 0 && grid::radial_exponent(domain.geometry) > 0 && survey.low[0] < spacing;
      if (mirrored(face) || axis) continue;
      double images = 1.0;
      for (int other = 0; other < 2 * domain.dimensions(); ++other) {
        if (other / 2 != face / 2 && mirrored(other)) images *= 2.0;
      }
      Extent const crushed = extent_of(domain, survey, Kind::crushed, face, spacing, images);
      Extent const cracked = extent_of(domain, survey, Kind::cracked, face, spacing, images);
      zones.faces.push_back({static_cast<grid::Face>(face), crushed.diameter, crushed.depth, cracked.diameter,
                             cracked.depth, cracked.beyond});
    }
    all.push_back(std::move(zones));
  }
  return all;
}

}  // namespace brisance::observe
