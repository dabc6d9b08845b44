/// The reference manual of the deck, printed from the schema.
#include <fmt/format.h>

#include <map>

#include "deck/deck.hpp"
#include "deck/schema.hpp"

namespace brisance::deck {

namespace {

std::string type_text(Key const& key) {
  switch (key.type) {
    case Type::number: return "quantity";
    case Type::integer: return "whole number";
    case Type::boolean: return "boolean";
    case Type::text: return "string";
    case Type::name: return "name";
    case Type::word: return "word";
    case Type::axis: return "word or vector";
    case Type::words: return "list of words";
    case Type::names: return "list of strings";
    case Type::numbers: return "list of quantities";
    case Type::integers: return "list of whole numbers";
    case Type::point: return "point";
    case Type::field: return "point or expressions";
    case Type::pairs: return "list of pairs";
    case Type::table: return key.choices.empty() ? "table" : "table or word";
    case Type::tables: return key.single ? "table or list of tables" : "list of tables";
    case Type::named: return "named tables";
  }
  return {};
}

std::string allowed_text(Key const& key) {
  switch (key.type) {
    case Type::number:
    case Type::integer:
    case Type::numbers:
    case Type::integers:
    case Type::pairs:
    case Type::point:
    case Type::field: return range_text(key);
    case Type::word:
    case Type::axis:
    case Type::words: return fmt::format("`{}`", fmt::join(key.choices, "`, `"));
    case Type::table: return key.choices.empty() ? "" : fmt::format("`{}`", fmt::join(key.choices, "`, `"));
    case Type::boolean: return "`true`, `false`";
    case Type::name: return "letters, digits and . _ - +";
    default: return "";
  }
}

std::string rows(std::vector<Key> const& keys) {
  std::string out = "| key | type | allowed | default | meaning | example |\n|---|---|---|---|---|---|\n";
  for (auto const& key : keys) {
    out += fmt::format("| `{}` | {} | {} | {} | {} | `{} = {}` |\n", key.name, type_text(key), allowed_text(key),
                       default_text(key), key.explanation, key.name, key.sample);
  }
  return out;
}

std::string table_text(std::string const& heading, Table const& table) {
  std::string out = fmt::format("\n{}\n\n{}\n\n{}", heading, table.meaning, rows(table.keys));
  for (auto const& [word, keys] : table.variants) {
    if (keys.empty()) continue;
    out += fmt::format("\nFurther keys with `{} = \"{}\"`:\n\n{}", table.selector, word, rows(keys));
  }
  return out;
}

/// The tables in a table, each of which is explained once, where it comes first; in those in turn what is new.
std::string inner_tables_text(std::string const& name, Table const& table, std::map<Table const*, std::string>& told,
                              bool only_new = false) {
  std::string out;
  for (auto const& key : table.keys) {
    if (key.table == nullptr) continue;
    auto const [first, fresh] = told.try_emplace(key.table, fmt::format("`{}` of `{}`", key.name, name));
    if (!fresh && only_new) continue;
    out += fresh ? table_text(fmt::format("### {}", first->second), *key.table) +
                       inner_tables_text(key.name, *key.table, told, true)
                 : fmt::format("\n### `{}` of `{}`\n\nSame keys as {}.\n", key.name, name, first->second);
  }
  return out;
}

constexpr std::string_view introduction = R"manual(# Deck reference

This page is printed from the program's schema by `brisance info --deck-reference`; edit the schema, not this file.

A deck is one TOML file that describes one simulation. Unknown keys are errors. All errors of a deck are reported together.
The shortest useful deck:

```toml
[domain]
size = [4, 4, 4]
cell = "40 mm"
[boundaries]
z_low = "wall"
[[charge]]
mass = "20 kg"
position = [2, 2, 2]
[[gauge]]
point = [4, 2, 1]
[end]
time = "5 ms"
```

- A **quantity** is a number in SI units (an angle: in degrees) or a string with a unit, as in `"12.5 kg"`, `"20 us"`, `"25 MPa"`, `"50 mm"`, `"15 degC"`,
  `"33 deg"`. The dimension is checked. An angle is a dimension of its own, not a pure number. The ranges below are in SI units and degrees.
- A **unit** is a product of whole powers: `"kg/m3"`, `"kg m^-3"`, `"J/(kg K)"`, `"1/s"`; `/` applies to the next unit only. The known units, also with prefixes and written out
  (`"millimeters"`): `m`, `in`, `ft`, `yd`, `mi`, `mil`, `nautical_mile`; `g`, `t`, `lb` (`lbs`, `lbm`), `ounce`, `grain`, `slug`, `short_ton`, `long_ton`; `s`, `sec`, `min`, `h`, `hr`, `d`;
  `K`, `degC`, `degF`, `degR`; `deg`, `°`, `rad`; `N`, `kgf`, `gf`, `lbf`, `ozf`, `kip`, `dyne`; `Pa`, `bar`, `atm`, `psi` (`psia`), `ksi`, `torr`, `mmHg`, `inHg`; `J`, `erg`, `eV`, `Btu`; `W`;
  `Hz`; `l`, `L`, `cc`; `knot`; `standard_gravity`; `mol`; `A`, `V`; `%`. Symbols are case-sensitive. A unit that has several meanings (`ton`, `kiloton`, `gr`, `cal`, `gallon`) or looks like another
  unit (`kt`, `oz`, `C`, `F`, `Mm`, `lb/in2` for a pressure) is rejected, and the message says what to write instead. `brisance check` prints every number of a material as it was read.
- A temperature below 150 K gives a warning: a number without a unit is in kelvin.
- A **point** is a list with one quantity per resolved direction: three in cartesian3d, two in planar2d and axisymmetric2d, one in
  the 1D geometries, where the brackets are optional. Directions that are not resolved may be written as 0.
- Messages count tables from 1: `charge[2].mass` is the mass of the second `[[charge]]`.
- Extents must be whole numbers of cells, within one part per million.
- A deck may have at most 1 MiB, 2^31 cells, 100 charges, 1000 obstacles, 100 bodies and 100000 gauges.
- The combinations `add`, `cut`, `common` (applied in this order) are available for bodies and for `within` of
  `[[constraint]]` and `[[surface_pressure]]`.
- In planar2d and cylindrical1d, masses and energies are per metre of the unresolved direction (`"10 kg"` and `"10 kg/m"`
  mean the same); in planar1d they are per square metre. In axisymmetric2d and spherical1d they are those of the whole body.
)manual";

}  // namespace

std::string reference_manual() {
  std::string out(introduction);
  Table const& deck = deck_schema();
  std::vector<Key> plain;
  for (auto const& key : deck.keys) {
    if (key.table == nullptr) plain.push_back(key);
  }
  out += fmt::format("\n## Keys at the top of the deck\n\n{}", rows(plain));
  std::map<Table const*, std::string> told;
  for (auto const& key : deck.keys) {
    if (key.table == nullptr) continue;
    std::string heading = fmt::format("[{}]", key.name);
    if (key.type == Type::tables && !key.single) heading = fmt::format("[[{}]]", key.name);
    if (key.type == Type::named) heading = fmt::format("[{}.{}]", key.name, key.choices.empty() ? "NAME" : "FACE");
    out += table_text(fmt::format("## `{}`", heading), *key.table) + inner_tables_text(heading, *key.table, told);
  }
  return out;
}

}  // namespace brisance::deck
