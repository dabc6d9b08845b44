#include "detonation/profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/archive.hpp"
#include "core/error.hpp"

namespace brisance::detonation {

namespace {

void add_constants(std::vector<Constant>& to, std::string const& role, material::Eos const& eos) {
  std::visit(
      [&]<class Model>(Model const& model) {
        for (auto const& p : Model::parameters())
          to.push_back({fmt::format("{} {}.{}", role, Model::name, p.key), model.*p.member});
      },
      eos);
}

}  // namespace

void archive(Archive& a, InitiationPoint& p) { a(p.position, p.delay); }
void archive(Archive& a, Constant& c) { a(c.name, c.value); }

void Profile::archive(Archive& a) {
  a.section("profile");
  a(domain.geometry, domain.lower, domain.h, domain.cells, time, components, state, pressure, ambient, ambient_pressure,
    mirrored);
  a(charge.explosive, charge.shape, charge.mass, charge.radius, charge.length, charge.initiation, constants);
}

double Profile::reach() const {
  double const r = domain.upper(0);
  if (domain.geometry != grid::Geometry::axisymmetric2d) return r;
  return std::hypot(r, std::max(std::abs(domain.lower[1]), std::abs(domain.upper(1))));
}

double Profile::sum(int c) const {
  double const* const values = component(c);
  grid::CellRange const all = domain.all_cells();
  double total = 0.0;
  for (int j = 0; j < domain.cells[1]; ++j) {
    double row = 0.0;
    for (int i = 0; i < domain.cells[0]; ++i) row += values[all.offset({i, j, 0})] * domain.cell_volume(i);
    total += row;
  }
  return total;
}

std::vector<Constant> constants_of(material::Explosive const& explosive, gas::Fluids const& fluids,
                                   gas::Primitive const& ambient) {
  std::vector<Constant> constants{{"explosive energy", explosive.energy},
                                  {"explosive detonation_speed", explosive.detonation_speed}};
  add_constants(constants, "products", fluids.eos[gas::products_fluid]);
  add_constants(constants, "ambient", fluids.ambient());
  constants.push_back({"ambient pressure", ambient.pressure});
  constants.push_back({"ambient density", ambient.density});
  return constants;
}

Profile profile_of(gas::Gas const& gas, gas::Primitive const& ambient, Vec3 const& centre, double time) {
  grid::Domain const& domain = gas.grid().domain();
  if (gas.burn.burning())
    throw InputError("the explosive is still burning: the profile would contain unburnt explosive");
  auto const quiet = gas::conserved_of(gas.fluids(), ambient);
  Index3 first = domain.cells;
  Index3 last{-1, -1, 0};
  for (grid::Block const& block : gas.grid().blocks()) {
    for_each_cell(block, [&](grid::Cell const& cell) {
      bool same = true;
      for (int c = 0; c < gas.fields().components() && same; ++c)
        same = gas.fields().at(cell.block, c)[cell.offset] == quiet[c];
      if (same) return;
      Index3 const index = block.index(cell);
      for (int d = 0; d < 2; ++d) {
        first[d] = std::min(first[d], index[d]);
        last[d] = std::max(last[d], index[d]);
      }
    });
  }
  if (last[0] < 0) throw InputError("nothing has happened: there is no blast wave to store in a profile");
  first[0] = 0;

  Profile p;
  p.time = time;
  p.domain = domain;
  p.domain.boundary.fill(grid::Boundary::symmetry);
  for (int d = 0; d < domain.dimensions(); ++d) {
    bool const low = d > 0 && first[d] == 0;
    if (last[d] == domain.cells[d] - 1 || (low && !domain.is_mirror(2 * d))) {
      throw InputError(
          fmt::format("the blast wave has reached the {} end of {} of the domain: stop earlier or enlarge the domain",
                      low ? "low" : "high", "xyz"[d]));
    }
    p.mirrored = p.mirrored || low;
    p.domain.lower[d] = domain.face(d, first[d]) - (d > 0 ? centre[d] : 0.0);
    p.domain.cells[d] = last[d] - first[d] + 1;
  }
  p.components = gas.fields().components();
  p.ambient.assign(quiet.begin(), quiet.begin() + p.components);
  p.ambient_pressure = ambient.pressure;
  p.state.resize(p.cell_count() * p.components);
  p.pressure.resize(p.cell_count());
  grid::CellRange const all = p.domain.all_cells();
  for_each_cell(all, [&](Index3 const& own) {
    grid::Cell const cell =
        gas.grid().locate(Index3{first[0] + own[0], (domain.dimensions() > 1 ? first[1] : 0) + own[1], 0});
    std::size_t const n = all.offset(own);
    for (int c = 0; c < p.components; ++c)
      p.state[c * p.cell_count() + n] = gas.fields().at(cell.block, c)[cell.offset];
    p.pressure[n] = gas.primitive(cell).pressure;
  });
  return p;
}

Profile scaled(Profile p, double mass) {
  double const ratio = mass / p.charge.mass;
  if (std::abs(ratio - 1.0) < 1e-12) return p;  // the same charge: the same bits
  double const factor = p.domain.geometry == grid::Geometry::cylindrical1d ? std::sqrt(ratio) : std::cbrt(ratio);
  p.charge.mass = mass;
  for (double* length :
       {&p.domain.h, &p.domain.lower[0], &p.domain.lower[1], &p.charge.radius, &p.charge.length, &p.time})
    *length *= factor;
  for (InitiationPoint& point : p.charge.initiation) point = {factor * point.position, factor * point.delay};
  return p;
}

Profile merged(Profile const& fine, int together) {
  Profile p = fine;
  int const shells = fine.domain.cells[0];
  int const count = (shells + together - 1) / together;
  p.domain.cells[0] = count;
  p.domain.h = together * fine.domain.h;
  p.state.assign(static_cast<std::size_t>(p.components) * count, 0.0);
  p.pressure.assign(count, 0.0);
  for (int n = 0; n < count; ++n) {
    double const whole = p.domain.cell_volume(n);
    auto const mean = [&](double const* values, double ambient) {
      double sum = 0.0;
      double filled = 0.0;
      for (int i = n * together; i < std::min(shells, (n + 1) * together); ++i) {
        double const volume = fine.domain.cell_volume(i);
        sum += volume * values[i];
        filled += volume;
      }
      bool const cut = (n + 1) * together > shells;
      return (sum + (cut ? ambient * (whole - filled) : 0.0)) / whole;
    };
    for (int c = 0; c < p.components; ++c)
      p.state[static_cast<std::size_t>(c) * count + n] = mean(fine.component(c), p.ambient[c]);
    p.pressure[n] = mean(fine.pressure.data(), p.ambient_pressure);
  }
  return p;
}

}  // namespace brisance::detonation
