#include "observe/gas_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "core/error.hpp"
#include "gas/place_obstacles.hpp"
#include "observe/gas_view.hpp"
#include "run/system.hpp"

namespace brisance::observe {

/// A cell of a block.
struct CellOf {
  run::System const& system;
  GasView const* view;
  grid::Cell at;
  PlacedCell cell;
};

/// Of the gas in a cell, by cells or particles.
using OfGas = double (*)(gas::Primitive const& gas, run::System const& system);
using VectorOfGas = Vec3 (*)(gas::Primitive const& gas, run::System const& system);
/// Of the cell itself.
using OfCell = double (*)(CellOf const& c);

struct GasField {
  FieldInfo info;
  std::variant<OfGas, VectorOfGas, OfCell> value;
  double (*without_gas)(run::System const& system) =
      nullptr;  ///< where particles hold the cell and there is no gas; null: 0
};

namespace {

/// 0: gas cells, 1: bridge, 2: particles.
double part_of_region(CellOf const& c) {
  for (run::Region const& of_system : c.system.regions) {
    bridge::Region const& region = of_system.bridge->region();
    int const layer = c.cell.level == region.level() ? region.layer(c.cell.index) : 0;
    if (layer > 0) return layer <= region.width() ? 1.0 : 2.0;
  }
  return 0.0;
}

/// Nothing keeps the peaks of particles; those of ghost cells belong to a part of the wave only.
double peak(CellOf const& c, double const* values) {
  return values == nullptr || part_of_region(c) == 2.0 ? 0.0 : values[c.at.offset];
}

double ambient_pressure(run::System const& w) { return w.setup.ambient.state.pressure; }

/// Fraction of a mixture that is not ambient fluid.
double beside_ambient(gas::Fractions const& parts) {
  double sum = parts[1];
  for (int k = 2; k < gas::most_fluids; ++k) sum += parts[k];
  return sum;
}

std::vector<GasField> const& gas_fields() {
  static std::vector<GasField> const fields{
      {{"pressure", "Pa", 1, "absolute pressure"},
       OfGas{[](gas::Primitive const& g, run::System const&) { return g.pressure; }},
       ambient_pressure},
      {{"overpressure", "Pa", 1, "pressure above ambient"},
       OfGas{[](gas::Primitive const& g, run::System const& w) { return g.pressure - ambient_pressure(w); }}},
      {{"density", "kg/m3", 1, "density of the mixture"},
       OfGas{[](gas::Primitive const& g, run::System const&) { return g.density; }}},
      {{"velocity", "m/s", 3, "velocity"},
       VectorOfGas{[](gas::Primitive const& g, run::System const&) { return g.velocity; }}},
      {{"energy", "J/m3", 1, "total energy per volume"},
       OfGas{[](gas::Primitive const& g, run::System const&) { return g.energy; }}},
      {{"sound_speed", "m/s", 1, "frozen sound speed of the mixture"},
       OfGas{[](gas::Primitive const& g, run::System const&) { return g.sound_speed; }}},
      {{"mach", "1", 1, "Mach number"},
       OfGas{[](gas::Primitive const& g, run::System const&) { return norm(g.velocity) / g.sound_speed; }}},
      {{"products", "1", 1, "mass fraction of the second fluid (detonation products)"},
       OfGas{[](gas::Primitive const& g, run::System const&) { return beside_ambient(g.mass_fraction); }}},
      {{"volume_fraction", "1", 1, "volume fraction of the second fluid"},
       OfGas{[](gas::Primitive const& g, run::System const&) { return beside_ambient(g.volume_fraction); }}},
      {{"burn_fraction", "1", 1, "burn fraction F of programmed burn"},
       OfCell{[](CellOf const& c) { return gas::burn_fraction(*c.system.gas, c.at); }}},
      {{"afterburn", "1", 1, "progress of the products' afterburn, 0 to 1"},
       OfCell{[](CellOf const& c) { return gas::afterburn_progress(*c.system.gas, c.at); }}},
      {{"peak_overpressure", "Pa", 1, "maximum overpressure so far"},
       OfCell{[](CellOf const& c) { return peak(c, c.system.gas->peaks().overpressure(c.at.block)); }}},
      {{"impulse", "Pa s", 1, "maximum running overpressure impulse so far"},
       OfCell{[](CellOf const& c) { return peak(c, c.system.gas->peaks().impulse(c.at.block)); }}},
      {{"obstacle", "1", 1, "fraction of the cell that rigid obstacles fill"},
       OfCell{[](CellOf const& c) { return 1.0 - gas::open_part(*c.system.gas, c.at); }}},
      {{"region", "1", 1, "0: gas cells, 1: bridge of the MPM region, 2: particles"}, OfCell{part_of_region}},
      {{"solid", "1", 1, "fraction of the cell that is filled by bodies of the MPM region"},
       OfCell{[](CellOf const& c) { return c.view == nullptr ? 0.0 : c.view->solid_at(c.cell); }}},
      {{"level", "1", 1, "level of the cell: 0 for the coarsest, each of the next half as large"},
       OfCell{[](CellOf const& c) { return static_cast<double>(c.cell.level); }}},
  };
  return fields;
}

PlacedCell placed(run::System const& system, grid::Cell const& cell) {
  grid::Block const& block = system.grid.block(cell);
  return {block.level, block.index(cell)};
}

/// The gas of a cell; obstacles show what their cells hold.
std::optional<gas::Primitive> gas_in(CellOf const& c) {
  if (c.view != nullptr && c.view->in_particles(c.cell)) return c.view->at(c.cell);
  gas::Gas const& gas = *c.system.gas;
  return gas.primitive(c.at);
}

}  // namespace

std::vector<FieldInfo> const& known_fields() {
  static std::vector<FieldInfo> const infos = [] {
    std::vector<FieldInfo> all;
    all.reserve(gas_fields().size());
    for (GasField const& field : gas_fields()) all.push_back(field.info);
    return all;
  }();
  return infos;
}

FieldValues::FieldValues(run::System const& system, std::vector<std::string> const& fields, GasView const* view)
    : system_(&system), view_(view) {
  for (std::string const& name : fields) {
    auto const& known = gas_fields();
    auto const found = std::find_if(known.begin(), known.end(), [&](GasField const& f) { return f.info.name == name; });
    if (found == known.end()) throw InputError(fmt::format("there is no field \"{}\"", name));
    fields_.push_back(&*found);
    components_ += found->info.components;
    need_gas_ = need_gas_ || !std::holds_alternative<OfCell>(found->value);
  }
}

void FieldValues::at(grid::Cell const& cell, double* out) const {
  CellOf const c{*system_, view_, cell, placed(*system_, cell)};
  put(c, need_gas_ ? gas_in(c) : std::nullopt, out);
}

void FieldValues::put(CellOf const& c, std::optional<gas::Primitive> const& gas, double* out) const {
  for (GasField const* field : fields_) {
    if (OfCell const* of_cell = std::get_if<OfCell>(&field->value)) {
      *out = (*of_cell)(c);
    } else if (!gas) {
      std::fill_n(out, field->info.components, field->without_gas != nullptr ? field->without_gas(*system_) : 0.0);
    } else if (OfGas const* scalar = std::get_if<OfGas>(&field->value)) {
      *out = (*scalar)(*gas, *system_);
    } else {
      Vec3 const v = std::get<VectorOfGas>(field->value)(*gas, *system_);
      std::copy(v.begin(), v.end(), out);
    }
    out += field->info.components;
  }
}

void FieldValues::row(grid::Cell const& first, int count, double* out) const {
  grid::Cell cell = first;
  std::optional<gas::Primitive> gas;
  for (int n = 0; n < count; ++n, ++cell.i, ++cell.offset) {
    CellOf const c{*system_, view_, cell, placed(*system_, cell)};
    // Undisturbed gas stands in many cells.
    bool const again = n > 0 && view_ == nullptr && gas::hold_the_same(*system_->gas, cell.block, cell.offset - 1);
    if (need_gas_ && !again) gas = gas_in(c);
    put(c, gas, out + static_cast<std::ptrdiff_t>(n) * components_);
  }
}

void block_field(run::System const& w, int b, std::string const& name, std::vector<double>& out, GasView const* view) {
  FieldValues const values(w, {name}, view);
  grid::Block const& block = w.grid.blocks()[b];
  out.assign(static_cast<std::size_t>(block.cell_count()) * values.components(), 0.0);
  for_each_cell(block, [&](grid::Cell const& cell) {
    values.at(cell, out.data() + static_cast<std::ptrdiff_t>(values.components()) * cell.offset);
  });
}

}  // namespace brisance::observe
