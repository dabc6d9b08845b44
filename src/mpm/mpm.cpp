#include "mpm/mpm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "mpm/burn.hpp"
#include "mpm/constrained_nodes.hpp"
#include "mpm/shapes/shapes.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

/// Blocks small enough that a patch stays in the cache of a core, and that a small problem has some for every thread.
/// Between the limits the one is taken that divides the domain best: a last block of a few cells carries as many nodes
/// and ghost particles around them as a whole one.
int block_cells_of(grid::Domain const& domain, int specified) {
  if (specified > 0) return specified;
  int const usual = domain.dimensions() == 3 ? 8 : domain.dimensions() == 2 ? 32 : 256;
  int best = usual;
  double least_waste = std::numeric_limits<double>::infinity();
  for (int size = usual - usual / 8; size <= usual + usual / 8; ++size) {
    double whole = 1.0;
    for (int d = 0; d < domain.dimensions(); ++d) {
      double const n = domain.cells[d];
      whole *= std::ceil(n / size) * size / n;
    }
    // Of equal ones that nearest to the usual size.
    double const waste = whole + 1e-3 * std::abs(size - usual);
    if (waste < least_waste) {
      least_waste = waste;
      best = size;
    }
  }
  return best;
}

FieldList fields_of(Body const& body, Options const& options, int dimensions) {
  material::Material const& solid = body.solid;
  Transfer const transfer = body.transfer.value_or(options.transfer);
  FieldList fields;
  for (Field const vector : {Field::position_x, Field::velocity_x, Field::move_x}) fields.add(vector);
  for (Field const scalar : {Field::mass, Field::density, Field::identity}) fields.add(scalar);
  if (options.shape == ShapeFunction::cpgimp) fields.add(Field::half_x);
  if (transfer == Transfer::apic) fields.add(Field::affine_xx);
  if (transfer == Transfer::apic && options.shape == ShapeFunction::bspline && !solid.has_deviator()) {
    if (dimensions > 1) fields.add(Field::cross_xy, dimensions == 2 ? 3 : 9);
    fields.add(Field::provisional);
  }
  if (body.books_work) fields.add(Field::provisional);
  if (transfer == Transfer::xpic) fields.add(Field::filtered_x);
  for (Field const scalar : {Field::pressure, Field::viscosity, Field::energy}) fields.add(scalar);
  if (solid.has_deviator()) {
    fields.add(Field::deviator_xx);
    fields.add(Field::origin_x);
  }
  if (solid.plastic()) {
    fields.add(Field::plastic_strain);
    fields.add(Field::plastic_work);
  }
  if (solid.heats()) fields.add(Field::temperature);
  if (solid.damages()) fields.add(Field::damage);
  if (solid.crushes()) {
    for (Field const scalar : {Field::crushing, Field::cracking, Field::compression}) fields.add(scalar);
  }
  if (solid.burns()) fields.add(Field::lighting_time);
  if (solid.mixes() && solid.mixture->mixed()) {
    fields.add(Field::mass_fraction);
    fields.add(Field::volume_fraction);
  }
  return fields;
}

/// Throws InputError where a filling's composition is none, or none that the body can have.
void check_composition(Body const& body, Filling const& filling) {
  double const Y = filling.mass_fraction;
  double const alpha = filling.volume_fraction;
  if (!(Y >= 0.0 && Y <= 1.0 && alpha >= 0.0 && alpha <= 1.0)) {
    throw InputError(
        fmt::format("material points of body \"{}\": the mass fraction {:.6g} and the volume fraction {:.6g} must be "
                    "between 0 and 1",
                    body.name, Y, alpha));
  }
  bool const mixes = body.solid.mixes() && body.solid.mixture->mixed();
  if (!mixes && (Y > 0.0 || alpha > 0.0)) {
    throw InputError(
        fmt::format("material points of body \"{}\" cannot contain a second fluid (mass fraction {:.6g}, volume "
                    "fraction {:.6g}): the material does not mix two fluids",
                    body.name, Y, alpha));
  }
}

/// Largest compression so far of porous concrete at a density [kg/m3].
double first_compression(material::Material const& solid, double density) {
  auto const* eos = std::get_if<material::Compaction>(&solid.eos);
  return eos == nullptr ? 0.0 : std::max(0.0, density / eos->rho0 - 1.0);
}

std::vector<ConstrainedNode> constrained_nodes_of(grid::Metric const& cells, Patch const& patch,
                                                  std::vector<Constraint> const& constraints,
                                                  std::vector<int> const& field_of) {
  std::vector<ConstrainedNode> constrained_nodes;
  int drivers = 0;
  for (Constraint const& c : constraints) {
    int const driver = c.history ? drivers++ : -1;
    for_each_cell(patch.all(), [&](Index3 const& node) {
      if (!contains_node(c.within, cells, patch.position(node))) return;
      ConstrainedNode constrained;
      constrained.node = patch.index(node);
      constrained.field = c.body < 0 ? -1 : field_of[c.body];
      constrained.components = c.components;
      constrained.velocity = c.velocity;
      constrained.driver = driver;
      constrained_nodes.push_back(constrained);
    });
  }
  return constrained_nodes;
}

std::vector<WallFace> walls_of(grid::Grid const& grid, int block, Patch const& patch) {
  std::vector<WallFace> walls;
  for (int d = 0; d < patch.dimensions; ++d) {
    for (int side = 0; side < 2; ++side) {
      if (!beyond(grid, block, d, side).mirror) continue;
      if (grid.domain().boundary[2 * d + side] != grid::Boundary::wall) continue;
      walls.push_back({2 * d + side, d, side == 0 ? 1 : -1, patch.reach + side * patch.cells[d]});
    }
  }
  return walls;
}

std::vector<FieldList> carried_fields(std::vector<Body> const& bodies, Options const& options, int dimensions) {
  std::vector<FieldList> all;
  all.reserve(bodies.size());
  for (Body const& body : bodies) all.push_back(fields_of(body, options, dimensions));
  return all;
}

}  // namespace

Mpm::Mpm(grid::Domain const& domain, std::vector<Body> bodies, Options const& options,
         std::vector<Constraint> const& constraints, std::vector<Contact> const& contacts)
    : grid_(domain, block_cells_of(domain, options.block_cells)),
      options_(options),
      bodies_(std::move(bodies)),
      carried_(carried_fields(bodies_, options_, grid_.domain().dimensions())),
      sets_(grid_,
            [this](grid::Block const&) {
              std::vector<ParticleSet> sets;
              for (FieldList const& fields : carried_) sets.emplace_back(fields);
              return sets;
            }),
      proxies_(grid_),
      next_identity_(bodies_.size(), 0),
      signals_(grid_.blocks().size(), 0.0),
      work_(std::make_unique<Workspace>()) {
  if (bodies_.empty()) throw InputError("a simulation with material points needs at least one body");
  if (options_.xpic_order < 1) throw InputError("the order of XPIC must be at least 1");

  for (Body const& body : bodies_) rules_.push_back(rules_of(body, options_));
  Workspace& w = *work_;
  static_cast<GridFields&>(w) = make_grid_fields(domain, options_, bodies_, rules_, contacts);
  int const blocks = grid_.block_count();
  w.patches = make_patches(grid_, reach_of(options_.shape));
  for (Constraint const& c : constraints) {
    if (c.history) w.drivers.push_back({*c.history, c.velocity});
  }
  for (int b = 0; b < blocks; ++b) {
    w.constrained_nodes.push_back(
        constrained_nodes_of(grid_.blocks()[b].metric, w.patches[b], constraints, w.field_of));
    w.is_constrained.emplace_back();
    if (w.touches && !w.constrained_nodes[b].empty()) {
      w.is_constrained[b].assign(w.patches[b].count(), 0);
      for (ConstrainedNode const& constrained : w.constrained_nodes[b]) w.is_constrained[b][constrained.node] = 1;
    }
    w.around.push_back(blocks_around(grid_, b));
    w.walls.push_back(walls_of(grid_, b, w.patches[b]));
    for (FieldList const& fields : carried_) w.outbox.push_back({ParticleSet(fields), {}});
  }
  std::size_t const slots = static_cast<std::size_t>(blocks) * w.fields;
  w.state.resize(slots);
  w.velocity.resize(slots);
  w.momentum.resize(slots);
  w.momentum_present.assign(slots, 0);
  w.gradient.resize(slots);
  w.area.resize(slots);
  w.area_present.assign(slots, 0);
  w.filled.resize(slots);
  w.filled_present.assign(slots, 0);
  w.even.resize(w.outbox.size());
  w.even_again.resize(w.outbox.size());
  w.even_present.assign(w.outbox.size(), 0);
  w.extent.resize(slots);
  w.gap.resize(slots);
  w.gap_present.assign(slots, 0);
  w.stopped.resize(slots);
  w.present.assign(slots, 0);
  w.shocked.assign(blocks, 0);
  w.impulse.assign(blocks, Vec3{0.0, 0.0, 0.0});
  w.work.assign(blocks, 0.0);
  w.dissipation.assign(blocks, Dissipation{});
  w.floored.assign(blocks, FloorCount{});
  w.conducted.assign(blocks, ConductionCount{});
  w.meetings.resize(blocks);
  w.lost.resize(blocks);
  w.trouble.resize(blocks);
}

Mpm::~Mpm() = default;

void Mpm::fill(int body, Filling const& filling) {
  grid::Domain const& domain = grid_.domain();
  Body const& b = bodies_.at(body);
  material::Material const& solid = b.solid;
  double density = filling.density.value_or(solid.density);
  double energy = filling.specific_energy.value_or(solid.specific_energy);
  double const Y = filling.mass_fraction;
  double const alpha = filling.volume_fraction;
  check_composition(b, filling);
  double pressure = solid.burns() ? 0.0 : material::pressure(solid, density, energy, Y, alpha);
  for (std::size_t n = 0; n < filling.positions.size(); ++n) {
    if (!filling.densities.empty()) {
      density = filling.densities[n];
      energy = filling.specific_energies[n];
      pressure = material::pressure(solid, density, energy, Y, alpha);
    }
    Vec3 const& x = filling.positions[n];
    for (int d = 0; d < domain.dimensions(); ++d) {
      if (x[d] >= domain.lower[d] && x[d] <= domain.upper(d)) continue;
      throw InputError(fmt::format("a material point of body \"{}\" lies outside the domain: {} = {:.6g} m", b.name,
                                   "xyz"[d], x[d]));
    }
    grid::Block const& block = grid_.blocks()[grid_.block_of(grid_.cell_at(x))];
    ParticleSet& set = particles(block.number, body);
    int const q = set.append();
    for (int d = 0; d < 3; ++d) {
      set.field(Field::position_x + d)[q] = x[d];
      Vec3 const& v = filling.velocities.empty() ? filling.velocity : filling.velocities[n];
      set.field(Field::velocity_x + d)[q] = b.rigid_velocity ? (*b.rigid_velocity)[d] : v[d];
      if (double* origin = set.field(Field::origin_x + d)) origin[q] = x[d];
      if (double* half = set.field(Field::half_x + d)) half[q] = 0.5 * block.h() / b.particles_per_direction;
    }
    for (int k = 0; k < 9 && !filling.gradients.empty(); ++k) {
      if (double* affine = set.field(Field::affine_xx + k))
        affine[q] = filling.gradients[n][static_cast<std::size_t>(k)];
    }
    for (int c = 0; c < 6 && !filling.deviators.empty(); ++c) {
      if (double* s = set.field(Field::deviator_xx + c)) s[q] = filling.deviators[n][static_cast<std::size_t>(c)];
    }
    if (double* most = set.field(Field::compression)) most[q] = first_compression(solid, density);
    set.field(Field::mass)[q] = density * filling.volumes[n];
    set.field(Field::density)[q] = density;
    set.field(Field::pressure)[q] = pressure;
    set.field(Field::energy)[q] = energy;
    set.field(Field::identity)[q] = static_cast<double>(next_identity_[body]++);
    if (double* temperature = set.field(Field::temperature)) temperature[q] = solid.temperature;
    if (double* lighting = set.field(Field::lighting_time)) lighting[q] = std::numeric_limits<double>::max();
    if (double* fraction = set.field(Field::mass_fraction)) fraction[q] = Y;
    if (double* fraction = set.field(Field::volume_fraction)) fraction[q] = alpha;
  }
  find_active();
  update_signals();
}

}  // namespace brisance::mpm
