#include "setup/place_region.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "mpm/shapes/shapes.hpp"
#include "run/products.hpp"
#include "run/system.hpp"
#include "setup/place_bodies.hpp"
#include "setup/region_gaps.hpp"
#include "shape/placement.hpp"

namespace brisance::setup {

namespace {

using mpm::Field;

/// Cells beside the bodies in a box that the program chooses: the bridge, two layers that solids keep clear of, and
/// room for the bodies to move.
constexpr int usual_room = 8;
constexpr double most_cells = 5e7;  // of a region, and of the box around it: 8 particles in each fill 100 GB

/// Layers of cells outside the region that give the nodes there all they need: B-splines of particles near the face
/// reach nodes one cell outside, and these reach as far again.
int proxy_layers(mpm::ShapeFunction shape) { return 1 + 2 * mpm::reach_of(shape); }

bridge::CellBox cells_of(grid::Domain const& domain, shape::Box const& box) {
  bridge::CellBox cells;
  for (int d = 0; d < domain.dimensions(); ++d) {
    std::array<int, 2> bounds{};
    for (int side = 0; side < 2; ++side) {
      double const x = side == 0 ? box.lower[d] : box.upper[d];
      double const at = domain.in_cells(d, x);
      double const nearest = std::round(at);
      if (std::abs(at - nearest) > 1e-6 * std::max(1.0, std::abs(nearest))) {
        throw InputError(
            fmt::format("the faces of the MPM region must be cell faces: {} = {:.6g} m lies inside a cell; the nearest "
                        "cell faces are at {:.6g} and {:.6g} m",
                        "xyz"[d], x, domain.place(d, std::floor(at)), domain.place(d, std::ceil(at))));
      }
      bounds[side] = static_cast<int>(nearest);
    }
    cells.lower[d] = bounds[0];
    cells.upper[d] = bounds[1];
  }
  return cells;
}

/// The bodies of a region.
std::vector<Body> bodies_in(Case const& setup, std::size_t number) {
  std::vector<Body> bodies;
  for (int const body : setup.bodies_of(number)) bodies.push_back(setup.particles.bodies[body]);
  return bodies;
}

/// What an explosive throws out of soil flies anywhere.
bool throws_out(std::vector<Body> const& bodies) {
  return std::any_of(bodies.begin(), bodies.end(), [](Body const& b) { return b.solid.burns(); }) &&
         std::any_of(bodies.begin(), bodies.end(), [](Body const& b) {
           return std::holds_alternative<material::DruckerPrager>(b.solid.strength) && !b.rigid;
         });
}

/// As much of it as a region may take.
bridge::CellBox whole_domain(grid::Domain const& domain) {
  bridge::CellBox cells;
  for (int d = 0; d < domain.dimensions(); ++d) {
    auto const kept = [&](int side) { return grid::is_given(domain.boundary[2 * d + side]) ? bridge::least_gap : 0; };
    cells.lower[d] = kept(0);
    cells.upper[d] = domain.cells[d] - kept(1);
  }
  return cells;
}

bridge::CellBox box_around_bodies(Case const& setup, std::size_t number) {
  grid::Domain const domain = setup.region_domain(number);
  std::vector<Body> const bodies = bodies_in(setup, number);
  if (throws_out(bodies)) return whole_domain(domain);
  int const margin = margin_of(setup.mpm_regions[number]);
  bridge::CellBox cells;
  for (int d = 0; d < domain.dimensions(); ++d) {
    double low = domain.upper(d);
    double high = domain.lower[d];
    for (Body const& body : bodies) {
      shape::Box const box = shape::bounds(body.shape);
      low = std::min(low, box.lower[d]);
      high = std::max(high, box.upper[d]);
    }
    double const slack = 1e-6;  // a body that ends on a face does not reach into the next cell
    int first = static_cast<int>(std::floor(domain.in_cells(d, low) + slack)) - margin;
    int last = static_cast<int>(std::ceil(domain.in_cells(d, high) - slack)) + margin;
    // A strip of gas beside the boundary would be too narrow to be worth it.
    if (first < margin / 2 + 4) first = 0;
    if (last > domain.cells[d] - (margin / 2 + 4)) last = domain.cells[d];
    cells.lower[d] = std::max(first, 0);
    cells.upper[d] = std::min(last, domain.cells[d]);
  }
  return cells;
}

std::vector<bridge::CellBox> boxes_of(Case const& setup, std::size_t number) {
  std::vector<bridge::CellBox> cells;
  for (shape::Box const& box : setup.mpm_regions[number].boxes)
    cells.push_back(cells_of(setup.region_domain(number), box));
  if (cells.empty()) cells.push_back(box_around_bodies(setup, number));
  return cells;
}

/// The part of space that the gas particles of a region fill.
shape::Shape gas_space(Case const& setup, std::size_t number, std::vector<bridge::CellBox> const& boxes) {
  grid::Domain const domain = setup.region_domain(number);
  std::vector<shape::Shape> parts;
  for (bridge::CellBox const& cells : boxes) {
    shape::Box box;
    for (int d = 0; d < 3; ++d) {
      bool const resolved = d < domain.dimensions();
      box.lower[d] = resolved ? domain.face(d, cells.lower[d]) : -1e30;
      box.upper[d] = resolved ? domain.face(d, cells.upper[d]) : 1e30;
    }
    parts.emplace_back(box);
  }
  shape::Shape whole = parts.size() == 1 ? parts.front() : shape::combine(shape::Operation::united, parts);
  std::vector<Body> const bodies = bodies_in(setup, number);
  if (bodies.empty()) return whole;
  std::vector<shape::Shape> left{whole};
  for (Body const& body : bodies) left.push_back(body.shape);
  return shape::combine(shape::Operation::difference, left);
}

/// Gas particles of the last region in the state of the cells that they lie in.
void fill_gas(run::System& w, int body) {
  std::size_t const number = w.regions.size() - 1;
  mpm::Mpm& particles = *w.regions.back().particles;
  grid::Domain const domain = w.setup.region_domain(number);
  int const parts = w.setup.mpm_regions[number].gas_particles(domain.dimensions());
  shape::Placement const placement =
      shape::place_particles(gas_space(w.setup, number, boxes_of(w.setup, number)), domain, parts);
  mpm::ParticleSet set(mpm::fields(particles, body));
  double const half = 0.5 * domain.smallest_cell() / parts;
  for (std::size_t n = 0; n < placement.positions.size(); ++n) {
    Vec3 const& x = placement.positions[n];
    grid::Cell const cell = w.grid.locate(x);
    gas::Primitive const s = w.gas->primitive(cell);
    int const q = set.append();
    for (int d = 0; d < 3; ++d) {
      set.field(Field::position_x + d)[q] = x[d];
      set.field(Field::velocity_x + d)[q] = s.velocity[d];
      if (double* h = set.field(Field::half_x + d)) h[q] = half;
    }
    set.field(Field::mass)[q] = s.density * placement.volumes[n];
    set.field(Field::density)[q] = s.density;
    set.field(Field::pressure)[q] = s.pressure;
    set.field(Field::energy)[q] = s.energy / s.density - 0.5 * dot(s.velocity, s.velocity);
    if (double* Y = set.field(Field::mass_fraction)) Y[q] = s.mass_fraction[1];
    if (double* alpha = set.field(Field::volume_fraction)) alpha[q] = s.volume_fraction[1];
  }
  particles.add(body, set);
  particles.update_signals();
}

/// Does anything in a region move by itself?
bool moves(Case const& setup, std::size_t number) {
  auto const is_moving = [](Vec3 const& v) { return dot(v, v) > 0.0; };
  Particles const& p = setup.particles;
  auto const here = [&](int body) { return body < 0 || setup.region_with(body) == number; };
  std::vector<Body> const all = bodies_in(setup, number);
  bool const bodies = std::any_of(all.begin(), all.end(), [&](Body const& b) {
    return b.moves() || b.density || b.specific_energy || b.solid.burns();
  });
  bool const constrained = std::any_of(p.constraints.begin(), p.constraints.end(),
                                       [&](mpm::Constraint const& c) { return here(c.body) && is_moving(c.velocity); });
  bool const loaded = std::any_of(p.pressures.begin(), p.pressures.end(),
                                  [&](mpm::SurfacePressure const& pressure) { return here(pressure.body); });
  return bodies || constrained || loaded || is_moving(p.options.body_force) || is_moving(setup.ambient.state.velocity);
}

void check_neighbours(run::System const& w, bridge::Region const& region) {
  auto const check = [&](Index3 const& index) {
    grid::Cell const cell = region.locate(w.grid, index);
    if (w.gas->obstacles.contain(cell)) {
      throw InputError(
          "an obstacle lies in the MPM region or within 3 cells of it: make it a body, or move one of them");
    }
    if (w.gas->burn.burning() && gas::burn_fraction(*w.gas, cell) < 1.0) {
      throw InputError(
          "a charge lies in the MPM region or within 3 cells of it: make the MPM region smaller, or make the charge a "
          "body");
    }
  };
  for (Index3 const& cell : region.cells()) check(cell);
  for (Index3 const& cell : region.proxy_cells()) check(region.clamped(cell));
}

}  // namespace

int proxy_reach(Case const& setup) { return proxy_layers(setup.particles.options.shape); }

int margin_of(MpmRegion const& region) { return region.margin > 0 ? region.margin : region.width + 2 + usual_room; }

bridge::Region region_of(Case const& setup, std::size_t number) {
  std::vector<bridge::CellBox> const boxes = boxes_of(setup, number);
  double cells = 0.0;
  for (bridge::CellBox const& box : boxes) {
    double count = 1.0;
    for (int d = 0; d < setup.domain.dimensions(); ++d) count *= std::max(0, box.upper[d] - box.lower[d]);
    cells += count;
  }
  if (cells > most_cells) {
    throw InputError(fmt::format(
        "the MPM region has {:.4g} cells; allowed: at most {:.3g}: make it smaller, or make the cells larger", cells,
        most_cells));
  }
  double around = 1.0;  // cells of the smallest box that holds all: they are kept too, a few bytes each
  for (int d = 0; d < setup.domain.dimensions(); ++d) {
    auto const low = std::ranges::min_element(boxes, {}, [d](bridge::CellBox const& b) { return b.lower[d]; });
    auto const high = std::ranges::max_element(boxes, {}, [d](bridge::CellBox const& b) { return b.upper[d]; });
    around *= std::max(0, high->upper[d] - low->lower[d]);
  }
  if (around > most_cells) {
    throw InputError(
        fmt::format("the boxes of the MPM region are so far apart that the box around them has {:.4g} cells; allowed: "
                    "at most {:.3g}: move them closer together, or simulate them separately",
                    around, most_cells));
  }
  return {setup.region_domain(number), boxes, setup.mpm_regions[number].width,
          proxy_layers(setup.particles.options.shape), setup.mpm_regions[number].level};
}

namespace {

void place_region(run::System& w, std::size_t number) {
  MpmRegion const& settings = w.setup.mpm_regions[number];
  run::Region& made = w.regions.emplace_back();
  bridge::Region region = region_of(w.setup, number);
  Primitive const& ambient = w.setup.ambient.state;

  mpm::Body gas;
  gas.name = w.setup.mpm_regions.size() > 1 ? fmt::format("gas of region {}", number + 1) : "gas";
  gas.solid = material::gas_of(w.gas->fluids(), ambient.density, ambient.pressure);
  gas.particles_per_direction = settings.gas_particles(w.setup.domain.dimensions());
  calculate_as_gas(settings, gas);
  gas.shock_conduction = settings.shock_conduction;
  gas.books_work = true;
  gas.fills_space = settings.transport == bridge::Transport::ledger;
  place_bodies(w, made, region.particles_domain(), {gas});
  int const gas_body = static_cast<int>(made.bodies.size());
  made.bodies.push_back(static_cast<int>(w.bodies.size()));
  fill_gas(w, gas_body);
  mpm::BodySums const sums = mpm::sums(*made.particles, gas_body);
  w.bodies.push_back({gas.name, gas.solid.name, sums.particles, sums.mass, sums.mass});

  bridge::Options options;
  options.width = settings.width;
  options.transport = settings.transport;
  options.particles_per_direction = settings.gas_particles(w.setup.domain.dimensions());
  options.reference_pressure = settings.reference_pressure;
  options.activation = settings.activation.value_or(1e-3 * ambient.pressure);
  // A region whose gas differs from the ambient one anywhere does not sleep either.
  bool still = !moves(w.setup, number);
  for (Index3 const& cell : region.cells()) {
    if (!still) break;
    gas::Primitive const s = w.gas->primitive(region.locate(w.grid, cell));
    still = std::abs(s.pressure - ambient.pressure) <= options.activation && norm(s.velocity) == 0.0;
  }
  options.awake = !still;
  made.bridge =
      std::make_unique<bridge::Bridge>(*w.gas, *made.particles, gas_body, std::move(region), options, ambient);
  check_neighbours(w, made.bridge->region());
  run::hand_over_products(w.setup, made);
  std::string const intruder = made.bridge->intruder();
  if (!intruder.empty()) throw InputError(intruder);
}

}  // namespace

void place_regions(run::System& w) {
  std::vector<bridge::Region> places;
  places.reserve(w.setup.mpm_regions.size());
  for (std::size_t n = 0; n < w.setup.mpm_regions.size(); ++n) places.push_back(region_of(w.setup, n));
  if (auto const conflict = conflict_of(w.setup, places)) throw InputError(conflict->problem);
  for (std::size_t number = 0; number < w.setup.mpm_regions.size(); ++number) place_region(w, number);
}

}  // namespace brisance::setup
