#include "mpm/mpm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "mpm/burn.hpp"
#include "mpm/holds.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

/// Blocks small enough that a patch stays in the cache of a core, and that a small problem has some for every thread.
int block_cells_of(grid::Domain const& domain, int asked) {
  if (asked > 0) return asked;
  switch (domain.dimensions()) {
    case 3: return 8;
    case 2: return 32;
    default: return 256;
  }
}

FieldList fields_of(Body const& body, Options const& options, int dimensions) {
  material::Solid const& solid = body.solid;
  Transfer const transfer = body.transfer.value_or(options.transfer);
  FieldList fields;
  for (Field const vector : {Field::position_x, Field::velocity_x, Field::move_x}) fields.add(vector, 3);
  for (Field const scalar : {Field::mass, Field::density, Field::identity}) fields.add(scalar);
  if (options.shape == ShapeFunction::cpgimp) fields.add(Field::half_x, 3);
  if (transfer == Transfer::apic) fields.add(Field::affine_xx, 9);
  if (transfer == Transfer::apic && options.shape == ShapeFunction::bspline && !solid.has_deviator()) {
    if (dimensions > 1) fields.add(Field::cross_xy, dimensions == 2 ? 3 : 9);
    fields.add(Field::provisional);
  }
  if (body.books_work) fields.add(Field::provisional);
  if (transfer == Transfer::xpic) fields.add(Field::filtered_x, 3);
  for (Field const scalar : {Field::pressure, Field::viscosity, Field::energy}) fields.add(scalar);
  if (solid.has_deviator()) {
    fields.add(Field::deviator_xx, 6);
    fields.add(Field::origin_x, 3);
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
  if (solid.mixes() && solid.mixture->two) {
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
    throw InputError(fmt::format(
        "points of body \"{}\": the mass fraction {:.6g} and the volume fraction {:.6g} lie between 0 and 1", body.name,
        Y, alpha));
  }
  bool const mixes = body.solid.mixes() && body.solid.mixture->two;
  if (!mixes && (Y > 0.0 || alpha > 0.0)) {
    throw InputError(fmt::format(
        "points of body \"{}\" cannot hold a second fluid (mass fraction {:.6g}, volume fraction {:.6g}): its "
        "material mixes no two fluids",
        body.name, Y, alpha));
  }
}

/// Number of the 27 blocks around a block: offsets -1, 0, 1 per direction.
int around_index(Index3 const& o) { return (o[0] + 1) + 3 * ((o[1] + 1) + 3 * (o[2] + 1)); }

std::array<int, 27> blocks_around(grid::Grid const& grid, int block) {
  std::array<int, 27> around{};
  for (int k = -1; k <= 1; ++k) {
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        Index3 const offset{i, j, k};
        int there = block;
        for (int d = 0; d < 3 && there != grid::no_neighbour; ++d) {
          if (offset[d] != 0) there = grid.blocks()[there].neighbour[2 * d + (offset[d] > 0 ? 1 : 0)];
        }
        around[around_index(offset)] = there;
      }
    }
  }
  return around;
}

std::vector<Hold> holds_of(grid::Grid const& grid, Patch const& patch, std::vector<Constraint> const& constraints,
                           std::vector<int> const& field_of) {
  std::vector<Hold> holds;
  for (Constraint const& c : constraints) {
    for (int k = 0; k < patch.n[2]; ++k) {
      for (int j = 0; j < patch.n[1]; ++j) {
        for (int i = 0; i < patch.n[0]; ++i) {
          if (!holds_node(c.region, grid.domain(), patch.position({i, j, k}, grid.domain().h))) continue;
          Hold hold;
          hold.node = patch.index(i, j, k);
          hold.field = c.body < 0 ? -1 : field_of[c.body];
          hold.held = c.held;
          hold.velocity = c.velocity;
          holds.push_back(hold);
        }
      }
    }
  }
  return holds;
}

/// Can the material pull at a wall? Gases and explosives cannot, nor can liquids that have no tension.
bool pulls(material::Solid const& solid) {
  if (solid.has_deviator()) return true;
  return !solid.mixes() && !solid.burns() && !solid.is_gas() && solid.minimum_pressure < 0.0;
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

}  // namespace

Mpm::Mpm(grid::Domain const& domain, std::vector<Body> bodies, Options const& options,
         std::vector<Constraint> const& constraints, std::vector<Contact> const& contacts)
    : grid_(domain, block_cells_of(domain, options.block_cells)),
      options_(options),
      bodies_(std::move(bodies)),
      next_identity_(bodies_.size(), 0),
      signals_(grid_.blocks().size(), 0.0),
      work_(std::make_unique<Workspace>()) {
  int const body_count = static_cast<int>(bodies_.size());
  if (body_count == 0) throw InputError("a calculation with material points needs at least one body");
  if (options_.xpic_order < 1) throw InputError("the order of XPIC is at least 1");

  // Bodies with a contact and rigid bodies have grid fields of their own, fluids that slip have one in common; all
  // others share the first. Rigid bodies that move alike and have the same contacts are one: where they touch, their
  // faces are no surface.
  Workspace& w = *work_;
  w.field_of.assign(bodies_.size(), 0);
  std::vector<char> own(bodies_.size(), 0);
  for (Contact const& c : contacts) {
    if (c.first == c.second || c.first < 0 || c.second < 0 || c.first >= body_count || c.second >= body_count) {
      throw InputError("a contact joins two different bodies");
    }
    own[c.first] = 1;
    own[c.second] = 1;
  }
  for (int b = 0; b < body_count; ++b) {
    if (bodies_[b].rigid_velocity) own[b] = 1;
  }
  auto const in_common = [&](bool slips) {
    int members = 0;
    for (int b = 0; b < body_count; ++b) {
      if (own[b] != 0 || bodies_[b].slips != slips) continue;
      w.field_of[b] = w.fields;
      ++members;
    }
    if (members > 0) ++w.fields;
  };
  w.fields = 0;
  in_common(false);
  in_common(true);
  auto const contacts_of = [&](int b) {
    std::vector<std::pair<int, double>> found;
    for (Contact const& c : contacts) {
      if (c.first == b || c.second == b) found.emplace_back(c.first == b ? c.second : c.first, c.friction);
    }
    std::sort(found.begin(), found.end());
    return found;
  };
  for (int b = 0; b < body_count; ++b) {
    if (own[b] == 0) continue;
    w.field_of[b] = -1;
    for (int a = 0; a < b && w.field_of[b] < 0 && bodies_[b].rigid_velocity; ++a) {
      bool const alike = bodies_[a].rigid_velocity == bodies_[b].rigid_velocity && contacts_of(a) == contacts_of(b);
      if (alike) w.field_of[b] = w.field_of[a];
    }
    if (w.field_of[b] < 0) w.field_of[b] = w.fields++;
  }
  w.slips.assign(w.fields, 0);
  for (int b = 0; b < body_count; ++b) w.slips[w.field_of[b]] = bodies_[b].slips ? 1 : 0;
  w.contact = w.fields > 1;
  w.one_sided.assign(w.fields, 0);
  for (int b = 0; b < body_count; ++b) {
    if (pulls(bodies_[b].solid) && !bodies_[b].rigid_velocity) w.one_sided[w.field_of[b]] = 1;
  }
  auto const& faces = domain.boundary;
  w.stops = std::find(w.one_sided.begin(), w.one_sided.end(), 1) != w.one_sided.end() &&
            std::find(faces.begin(), faces.end(), grid::Boundary::wall) != faces.end();
  for (int b = 0; b < body_count; ++b) {
    w.maps_back = w.maps_back || order_of(b) == StressOrder::musl;
    w.strains_early = w.strains_early || order_of(b) == StressOrder::usl;
    w.keeps_energy = w.keeps_energy || keeps_energy(b);
    w.counts_energy = w.counts_energy || (affine(b) && !bodies_[b].rigid_velocity);
    w.books_work = w.books_work || books_work(b);
    w.conducts = w.conducts || bodies_[b].shock_conduction > 0.0;
    if (bodies_[b].fills_space) w.filling = w.field_of[b];
  }
  w.shared.assign(w.fields, 0);
  w.affine.assign(w.fields, 0);
  w.heats.assign(w.fields, 0);
  for (int f = 0; f < w.fields; ++f) {
    auto const some = [&](bool wanted) {
      for (int b = 0; b < body_count; ++b) {
        if (w.field_of[b] == f && affine(b) == wanted) return true;
      }
      return false;
    };
    w.shared[f] = some(true) && some(false) ? 1 : 0;
    w.affine[f] = some(true) ? 1 : 0;
    for (int b = 0; b < body_count; ++b) {
      if (w.field_of[b] == f && keeps_energy(b)) w.heats[f] = 1;
    }
  }
  w.filters = std::any_of(bodies_.begin(), bodies_.end(),
                          [&](Body const& b) { return b.transfer.value_or(options_.transfer) == Transfer::xpic; });
  w.rigid.resize(w.fields);
  for (int b = 0; b < body_count; ++b) {
    if (bodies_[b].rigid_velocity) w.rigid[w.field_of[b]] = bodies_[b].rigid_velocity;
  }
  w.pushes = std::any_of(w.rigid.begin(), w.rigid.end(), [](auto const& velocity) { return velocity.has_value(); });
  w.laws.assign(static_cast<std::size_t>(w.fields) * w.fields, Law{});
  for (int a = 0; a < w.fields; ++a) {
    for (int b = 0; b < w.fields; ++b) {
      if (w.slips[a] == w.slips[b]) continue;
      w.laws[a * w.fields + b].kind = Law::Kind::slips;
      w.slides = true;
    }
  }
  w.parts.assign(w.fields, 0);
  for (Contact const& c : contacts) {
    int const a = w.field_of[c.first];
    int const b = w.field_of[c.second];
    w.laws[a * w.fields + b] = {Law::Kind::contact, c.friction};
    w.laws[b * w.fields + a] = {Law::Kind::contact, c.friction};
    w.touches = true;
    w.parts[a] = w.parts[b] = 1;
  }

  int const blocks = grid_.block_count();
  w.patches = make_patches(grid_, options_.shape == ShapeFunction::linear ? Linear::reach : Gimp::reach);
  for (int b = 0; b < blocks; ++b) {
    w.holds.push_back(holds_of(grid_, w.patches[b], constraints, w.field_of));
    w.has_hold.emplace_back();
    if (w.touches && !w.holds[b].empty()) {
      w.has_hold[b].assign(w.patches[b].count(), 0);
      for (Hold const& hold : w.holds[b]) w.has_hold[b][hold.node] = 1;
    }
    w.around.push_back(blocks_around(grid_, b));
    w.walls.push_back(walls_of(grid_, b, w.patches[b]));
    for (Body const& body : bodies_) {
      FieldList const fields = fields_of(body, options_, grid_.domain().dimensions());
      sets_.emplace_back(fields);
      w.outbox.push_back({PointSet(fields), {}});
    }
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
  w.even.resize(sets_.size());
  w.even_again.resize(sets_.size());
  w.even_present.assign(sets_.size(), 0);
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
  material::Solid const& solid = b.solid;
  double const density = filling.density.value_or(solid.density);
  double const energy = filling.specific_energy.value_or(solid.specific_energy);
  double const Y = filling.mass_fraction;
  double const alpha = filling.volume_fraction;
  check_composition(b, filling);
  double const pressure = solid.burns() ? 0.0 : material::pressure(solid, density, energy, Y, alpha);
  for (std::size_t n = 0; n < filling.positions.size(); ++n) {
    Vec3 const& x = filling.positions[n];
    for (int d = 0; d < domain.dimensions(); ++d) {
      if (x[d] >= domain.lower[d] && x[d] <= domain.upper(d)) continue;
      throw InputError(
          fmt::format("a point of body \"{}\" lies outside the domain: {} = {:.6g} m", b.name, "xyz"[d], x[d]));
    }
    PointSet& set = sets_[set_index(grid_.block_of(grid_.cell_at(x)), body)];
    int const q = set.append();
    for (int d = 0; d < 3; ++d) {
      set.field(Field::position_x + d)[q] = x[d];
      set.field(Field::velocity_x + d)[q] = b.rigid_velocity ? (*b.rigid_velocity)[d] : filling.velocity[d];
      if (double* origin = set.field(Field::origin_x + d)) origin[q] = x[d];
      if (double* half = set.field(Field::half_x + d)) half[q] = 0.5 * domain.h / b.points_per_direction;
    }
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

void Mpm::load(SurfacePressure const& pressure) {
  if (pressure.times.size() != pressure.pressures.size() || pressure.times.empty()) {
    throw InputError("a surface pressure needs as many times as pressures, at least one");
  }
  if (!(pressure.thickness > 0.0))
    throw InputError("a surface pressure needs the thickness of the layer that takes it");
  std::vector<ActiveLoad>& loads = work_->loads;
  loads.push_back({pressure.body, pressure.times, pressure.pressures, {}});
  int const number = static_cast<int>(loads.size());
  carry(pressure.body, Field::load_x, 4);  // load_number is the fourth
  bool touched = false;
  bool const curved = !pressure.surface.empty();
  std::vector<std::vector<Vec3>> const forces = curved ? pushes(pressure) : std::vector<std::vector<Vec3>>{};
  Vec3 flat{0.0, 0.0, 0.0};
  for (int d = 0; d < 3; ++d) flat[d] = -pressure.normal[d] / pressure.thickness;
  // Points that bear another pressure already bear both.
  auto const together = [&](int before, Vec3 const& its_direction, Vec3 const& direction) {
    auto parts = loads[static_cast<std::size_t>(before) - 1].parts;
    if (parts.empty()) parts.push_back({before - 1, its_direction});
    parts.push_back({number - 1, direction});
    // On a curved surface hardly two points bear the same.
    for (std::size_t n = 0; !curved && n < loads.size(); ++n) {
      if (loads[n].parts == parts) return static_cast<int>(n) + 1;
    }
    loads.push_back({pressure.body, {}, {}, std::move(parts)});
    return static_cast<int>(loads.size());
  };
  for (int b = 0; b < grid_.block_count(); ++b) {
    PointSet& old = sets_[set_index(b, pressure.body)];
    for (int q = 0; q < old.size(); ++q) {
      Vec3 x{0.0, 0.0, 0.0};
      for (int d = 0; d < 3; ++d) x[d] = old.field(Field::position_x + d)[q];
      Vec3 direction = flat;
      if (curved) {
        double const volume = old.field(Field::mass)[q] / old.field(Field::density)[q];
        direction = (1.0 / volume) * forces[b][q];
        if (dot(direction, direction) == 0.0) continue;
      } else if (!shape::contains(pressure.region, grid_.domain(), x)) {
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
  throw InputError(fmt::format(
      "surface pressure {} acts on nothing: no point of body \"{}\" lies in the loaded layer of its region; "
      "move the region, or make it larger than the points are apart",
      number, bodies_[pressure.body].name));
}

/// Each piece of the surface pushes on the points around a place half a layer below it, with weights that keep its
/// resultant, and its line of action as far as positive weights can.
std::vector<std::vector<Vec3>> Mpm::pushes(SurfacePressure const& pressure) const {
  grid::Domain const& domain = grid_.domain();
  int const dims = domain.dimensions();
  struct Near {
    long cell = 0;
    int block = 0;
    int point = 0;
    Vec3 x{0.0, 0.0, 0.0};
    double volume = 0.0;
  };
  auto const number_of = [&](Index3 const& cell) {
    return cell[0] + static_cast<long>(domain.cells[0]) * (cell[1] + static_cast<long>(domain.cells[1]) * cell[2]);
  };
  std::vector<std::vector<Vec3>> forces(grid_.block_count());
  std::vector<Near> all;
  for (int b = 0; b < grid_.block_count(); ++b) {
    PointSet const& set = points(b, pressure.body);
    forces[b].assign(set.size(), Vec3{0.0, 0.0, 0.0});
    for (int q = 0; q < set.size(); ++q) {
      Near near{0, b, q, {0.0, 0.0, 0.0}, set.field(Field::mass)[q] / set.field(Field::density)[q]};
      for (int d = 0; d < dims; ++d) near.x[d] = set.field(Field::position_x + d)[q];
      near.cell = number_of(grid_.cell_at(near.x));
      all.push_back(near);
    }
  }
  std::stable_sort(all.begin(), all.end(), [](Near const& p, Near const& q) { return p.cell < q.cell; });
  std::vector<Near const*> around;
  std::vector<double> weights;
  for (shape::Facet const& facet : pressure.surface) {
    Vec3 const target = facet.x - (0.5 * pressure.thickness / norm(facet.area)) * facet.area;
    double sum = 0.0;
    // Measured on spheres, discs and oblique cylinders: a tent of one and a half layers finds two points or more in
    // each direction nearly everywhere.
    for (double reach = 1.5 * pressure.thickness; sum == 0.0 && reach < 16.0 * pressure.thickness; reach *= 1.5) {
      around.clear();
      weights.clear();
      Index3 low{0, 0, 0};
      Index3 high{0, 0, 0};
      for (int d = 0; d < dims; ++d) {
        auto const cell = [&](double x) {
          return static_cast<int>(std::clamp((x - domain.lower[d]) / domain.h, 0.0, domain.cells[d] - 1.0));
        };
        low[d] = cell(target[d] - reach);
        high[d] = cell(target[d] + reach);
      }
      for (int k = low[2]; k <= high[2]; ++k) {
        for (int j = low[1]; j <= high[1]; ++j) {
          auto at = std::lower_bound(all.begin(), all.end(), number_of({low[0], j, k}),
                                     [](Near const& p, long cell) { return p.cell < cell; });
          for (long const end = number_of({high[0], j, k}); at != all.end() && at->cell <= end; ++at) {
            double weight = at->volume;
            for (int d = 0; d < dims; ++d) weight *= std::max(0.0, 1.0 - std::abs(at->x[d] - target[d]) / reach);
            if (weight <= 0.0) continue;
            around.push_back(&*at);
            weights.push_back(weight);
            sum += weight;
          }
        }
      }
    }
    if (!(sum > 0.0)) {
      throw InputError(fmt::format(
          "surface pressure on body \"{}\": no material point lies within 16 layers of its surface at ({:.6g}, {:.6g}, "
          "{:.6g}) m: the body is thinner there than points resolve; take smaller cells, or a region without that part",
          bodies_[pressure.body].name, facet.x[0], facet.x[1], facet.x[2]));
    }
    std::size_t const count = around.size();
    // Towards weights whose mean place is the target, direction by direction.
    for (int d = 0; d < 2 * dims; ++d) {
      double first = 0.0;
      double second = 0.0;
      double most = 0.0;
      sum = 0.0;
      for (std::size_t n = 0; n < count; ++n) {
        double const away = around[n]->x[d % dims] - target[d % dims];
        sum += weights[n];
        first += weights[n] * away;
        second += weights[n] * away * away;
      }
      double const slope = second > 0.0 ? -first / second : 0.0;
      for (std::size_t n = 0; n < count; ++n)
        most = std::max(most, -slope * (around[n]->x[d % dims] - target[d % dims]));
      double const part = most > 0.75 ? 0.75 / most : 1.0;
      for (std::size_t n = 0; n < count; ++n)
        weights[n] *= 1.0 + part * slope * (around[n]->x[d % dims] - target[d % dims]);
    }
    sum = 0.0;
    for (double const weight : weights) sum += weight;
    for (std::size_t n = 0; n < count; ++n) {
      Vec3& force = forces[around[n]->block][around[n]->point];
      force = force - (weights[n] / sum) * facet.area;
    }
  }
  return forces;
}

void Mpm::set_lighting(int body, std::function<double(Vec3 const&)> const& lighting_time) {
  for (int b = 0; b < grid_.block_count(); ++b) {
    PointSet& set = sets_[set_index(b, body)];
    double* lighting = set.field(Field::lighting_time);
    if (lighting == nullptr) continue;
    for (int q = 0; q < set.size(); ++q) {
      lighting[q] = lighting_time(
          {set.field(Field::position_x)[q], set.field(Field::position_y)[q], set.field(Field::position_z)[q]});
    }
  }
}

void Mpm::set_time(double time) { time_ = time; }

double Mpm::lowest_pressure(int body) const {
  std::vector<double> lowest(active_.size(), std::numeric_limits<double>::infinity());
  parallel_for(static_cast<int>(active_.size()), [&](int n, int) {
    auto const see = [&](PointSet const& set) {
      double const* p = set.field(Field::pressure);
      double least = lowest[n];
      for (int q = 0; q < set.size(); ++q) least = p[q] < least ? p[q] : least;
      lowest[n] = least;
    };
    see(points(active_[n], body));
    if (body == lent_body_) see(lent_[active_[n]]);
  });
  double least = std::numeric_limits<double>::infinity();
  for (double const p : lowest) least = std::min(least, p);
  return least;
}

StressOrder Mpm::order_of(int body) const {
  if (options_.order == StressOrder::usf) return StressOrder::usf;
  StressOrder const own = bodies_[body].order.value_or(options_.order);
  return own == StressOrder::usf ? options_.order : own;
}

bool Mpm::affine(int body) const { return bodies_[body].transfer.value_or(options_.transfer) == Transfer::apic; }

/// APIC projects the velocity of the nodes around a point on a linear function: what is left over is lost, and so is
/// what the points around a node differ in. Both are never negative, if the energy of the gradient is counted: in a
/// fluid they are a dissipation, as by viscosity, and heat. In a solid they have an account.
bool Mpm::has_gradient_energy(int body) const {
  return affine(body) && options_.shape == ShapeFunction::bspline && !bodies_[body].rigid_velocity;
}

bool Mpm::keeps_energy(int body) const {
  return has_gradient_energy(body) && !bodies_[body].solid.has_deviator() && order_of(body) != StressOrder::usf;
}

bool Mpm::books_work(int body) const {
  Body const& b = bodies_[body];
  return b.books_work && !keeps_energy(body) && !b.rigid_velocity;
}

void Mpm::lend_as(int body) {
  lent_body_ = body;
  // Gas fills the space up to walls, and its pressure may fall below that of reference: it keeps its images.
  work_->one_sided[work_->field_of[body]] = 0;
  lent_.clear();
  FieldList fields = this->fields(body);
  fields.add(Field::next_x, 3);
  for (int b = 0; b < grid_.block_count(); ++b) lent_.emplace_back(fields);
  gifts_.resize(lent_.size());
  work_->lent.resize(lent_.size());
}

void Mpm::add(int body, PointSet const& added) {
  for (int q = 0; q < added.size(); ++q) {
    Vec3 const x{added.field(Field::position_x)[q], added.field(Field::position_y)[q],
                 added.field(Field::position_z)[q]};
    PointSet& set = sets_[set_index(grid_.block_of(grid_.cell_at(x)), body)];
    set.append(added, q);
    set.field(Field::identity)[set.size() - 1] = static_cast<double>(next_identity_[body]++);
  }
  if (!added.empty()) find_active();
}

void Mpm::take_out(int block, int body, std::function<bool(PointSet const& set, int q)> const& outside, PointSet& to) {
  PointSet& set = points(block, body);
  std::vector<int> stay;
  stay.reserve(set.size());
  for (int q = 0; q < set.size(); ++q) {
    if (outside(set, q)) {
      to.append(set, q);
    } else {
      stay.push_back(q);
    }
  }
  if (static_cast<int>(stay.size()) < set.size()) set.reorder(stay);
}

long Mpm::hand_over_burnt(int explosive, int gas) {
  double const rate = burn_rate(bodies_[explosive].solid.detonation_speed, grid_.domain().h);
  long count = 0;
  std::vector<int> stay;
  for (int block = 0; block < grid_.block_count(); ++block) {
    PointSet& from = points(block, explosive);
    double const* lighting = from.field(Field::lighting_time);
    PointSet& to = points(block, gas);
    stay.clear();
    for (int q = 0; q < from.size(); ++q) {
      if (lighting != nullptr && burn_fraction(time_, lighting[q], rate) < 1.0) {
        stay.push_back(q);
        continue;
      }
      int const at = to.append();
      for (int n = 0; n < field_count; ++n) {
        auto const f = static_cast<Field>(n);
        if (double* value = to.field(f); value != nullptr && from.fields().has(f)) value[at] = from.field(f)[q];
      }
      to.field(Field::mass_fraction)[at] = 1.0;
      to.field(Field::volume_fraction)[at] = 1.0;
      to.field(Field::identity)[at] = static_cast<double>(next_identity_[gas]++);
      ++count;
    }
    if (static_cast<int>(stay.size()) < from.size()) from.reorder(stay);
  }
  return count;
}

void Mpm::find_active() {
  active_.clear();
  for (int b = 0; b < grid_.block_count(); ++b) {
    bool any = false;
    for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) any = any || !points(b, body).empty();
    any = any || (lent_body_ >= 0 && !lent_[b].empty());
    if (any) active_.push_back(b);
  }
}

void Mpm::update_signals() {
  parallel_for(grid_.block_count(), [&](int block, int) {
    double fastest = 0.0;
    for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
      PointSet const& set = points(block, body);
      material::Solid const& solid = bodies_[body].solid;
      double const* mass_fraction = set.field(Field::mass_fraction);
      double const* volume_fraction = set.field(Field::volume_fraction);
      for (int q = 0; q < set.size(); ++q) {
        double const Y = mass_fraction == nullptr ? 0.0 : mass_fraction[q];
        double const alpha = volume_fraction == nullptr ? 0.0 : volume_fraction[q];
        double const speed = norm(
            Vec3{set.field(Field::velocity_x)[q], set.field(Field::velocity_y)[q], set.field(Field::velocity_z)[q]});
        double const sound = bodies_[body].rigid_velocity
                                 ? 0.0
                                 : std::max(material::sound_speed(solid, set.field(Field::density)[q],
                                                                  set.field(Field::pressure)[q], Y, alpha),
                                            solid.detonation_speed);
        fastest = std::max(fastest, signal_weight(body) * (speed + sound));
      }
    }
    signals_[block] = fastest;
  });
  collect_signals();
}

void Mpm::collect_signals() {
  fastest_ = 0.0;
  for (int const block : active_) fastest_ = std::max(fastest_, signals_[block]);
}

double Mpm::stable_step() const { return options_.courant * grid_.domain().h / fastest_; }

long Mpm::point_count() const {
  long count = 0;
  for (PointSet const& set : sets_) count += set.size();
  return count;
}

BodySums Mpm::sums(int body) const {
  int const blocks = grid_.block_count();
  std::vector<BodySums> parts(blocks);
  parallel_for(blocks, [&](int block, int) {
    PointSet const& set = points(block, body);
    BodySums& s = parts[block];
    s.points = set.size();
    bool const affine = has_gradient_energy(body);
    bool const books = books_work(body) && !bodies_[body].solid.is_gas();
    for (int q = 0; q < set.size(); ++q) {
      double const m = set.field(Field::mass)[q];
      s.mass += m;
      double const* second = set.field(Field::mass_fraction);
      double const m1 = second == nullptr ? 0.0 : m * second[q];
      s.fluid_mass[0] += m - m1;
      s.fluid_mass[1] += m1;
      double square = 0.0;
      double moved = 0.0;
      for (int d = 0; d < 3; ++d) {
        double const v = set.field(Field::velocity_x + d)[q];
        double const x = set.field(Field::position_x + d)[q];
        s.momentum[d] += m * v;
        s.centre[d] += m * x;
        square += v * v;
        if (double const* origin = set.field(Field::origin_x + d)) moved += (x - origin[q]) * (x - origin[q]);
      }
      s.kinetic_energy += 0.5 * m * square;
      if (affine) s.kinetic_energy += m * affine_energy(set, q, grid_.domain().h);
      s.internal_energy += m * set.field(Field::energy)[q];
      if (books) s.provisional_energy += m * set.field(Field::provisional)[q];
      if (double const* work = set.field(Field::plastic_work)) s.plastic_work += m * work[q];
      if (double const* damage = set.field(Field::damage)) s.damaged_mass += damage[q] >= 1.0 ? m : 0.0;
      s.largest_displacement = std::max(s.largest_displacement, std::sqrt(moved));
    }
  });
  BodySums total;
  for (BodySums const& s : parts) {
    total.points += s.points;
    total.mass += s.mass;
    for (int f = 0; f < 2; ++f) total.fluid_mass[f] += s.fluid_mass[f];
    total.momentum = total.momentum + s.momentum;
    total.centre = total.centre + s.centre;
    total.kinetic_energy += s.kinetic_energy;
    total.internal_energy += s.internal_energy;
    total.provisional_energy += s.provisional_energy;
    total.plastic_work += s.plastic_work;
    total.damaged_mass += s.damaged_mass;
    total.largest_displacement = std::max(total.largest_displacement, s.largest_displacement);
  }
  if (total.mass > 0.0) total.centre = (1.0 / total.mass) * total.centre;
  return total;
}

Place Mpm::find(int body, long identity, Place hint) const {
  auto const wanted = static_cast<double>(identity);
  auto const look = [&](int block) -> Place {
    PointSet const& set = points(block, body);
    double const* identities = set.field(Field::identity);
    for (int q = 0; q < set.size(); ++q) {
      if (identities[q] == wanted) return {block, q};
    }
    return {};
  };
  if (hint.block >= 0) {
    PointSet const& set = points(hint.block, body);
    if (hint.index < set.size() && set.field(Field::identity)[hint.index] == wanted) return hint;
    for (int const block : work_->around[hint.block]) {
      if (block == grid::no_neighbour) continue;
      Place const place = look(block);
      if (place.block >= 0) return place;
    }
  }
  for (int block = 0; block < grid_.block_count(); ++block) {
    Place const place = look(block);
    if (place.block >= 0) return place;
  }
  return {};
}

long Mpm::nearest(int body, Vec3 const& x) const {
  double best = std::numeric_limits<double>::infinity();
  long identity = -1;
  int const dims = grid_.domain().dimensions();
  for (int block = 0; block < grid_.block_count(); ++block) {
    PointSet const& set = points(block, body);
    for (int q = 0; q < set.size(); ++q) {
      double square = 0.0;
      for (int d = 0; d < dims; ++d) {
        double const distance = set.field(Field::position_x + d)[q] - x[d];
        square += distance * distance;
      }
      auto const candidate = static_cast<long>(set.field(Field::identity)[q]);
      if (square < best || (square == best && candidate < identity)) {
        best = square;
        identity = candidate;
      }
    }
  }
  return identity;
}

std::size_t Mpm::bytes() const {
  std::size_t total = 0;
  for (PointSet const& set : sets_) total += set.bytes();
  for (auto const& nodes : work_->state) total += nodes.bytes();
  for (auto const& nodes : work_->velocity) total += nodes.bytes();
  for (auto const& nodes : work_->gradient) total += nodes.bytes();
  for (auto const& nodes : work_->area) total += nodes.bytes();
  for (auto const* all : {&work_->even, &work_->even_again}) {
    for (auto const& nodes : *all) total += nodes.bytes();
  }
  for (auto const& nodes : work_->extent) total += nodes.bytes();
  return total;
}

}  // namespace brisance::mpm
