/// [adaptive]: cells of several sizes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.hpp"
#include "core/text.hpp"
#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"
#include "grid/forest.hpp"
#include "grid/partition.hpp"

namespace brisance::deck {

namespace {

constexpr int most_halvings = 12;
/// Blocks are changed after at most one step of the coarsest cells. In it a shock crosses 16 cells of this level, which
/// is a block.
constexpr int deepest_shocks = 4;
constexpr double cell_tolerance = 1e-6;  ///< relative, of a cell size to a permitted one

Key cell_size(char const* name) { return number(name, "m", smallest, 1e4); }

Settings<run::Adaptive> const& settings() {
  using A = run::Adaptive;
  static Settings<A> const all{
      cell_size("finest")
          .required()
          .like("\"10 mm\"")
          .means("Finest cell size: `domain.cell` halved a whole number of times, up to 12. The other sizes of this "
                 "table obey "
                 "the same rule"),
      cell_size("shocks")
          .note("`finest`")
          .like("\"20 mm\"")
          .means("Cell size to which shocks are followed; at least 1/16 of `domain.cell`"),
      cell_size("charges").note("`finest`").like("\"10 mm\"").means("Cell size of charges until they have burst"),
      cell_size("obstacles")
          .note("`shocks`")
          .like("\"10 mm\"")
          .means("Cell size at surfaces of obstacles, where they are not on faces of larger cells; at most `shocks`"),
      cell_size("gauges")
          .note("none: gauges do not refine")
          .like("\"10 mm\"")
          .means("Cell size within 4 cells of gauges in the gas"),
      cell_size("products")
          .note("none: the surface does not refine")
          .like("\"40 mm\"")
          .means("Cell size at the surface of the detonation products; at least `shocks`"),
      {&A::threshold,
       number("threshold", "1", 0.0, 1.0)
           .like("0.3")
           .means("Norm of the second differences of the pressure [Lohner87], 0 to 1, above which compressed gas is "
                  "treated as a shock; a smaller value refines weaker waves")},
      {&A::most_cells, number("cells", "1", 0.0, 1e12)
                           .like("2e6")
                           .means("Limit on the number of cells of the domain; 0: none. Where it is reached, the "
                                  "weakest shocks stay on larger cells, with a warning")}};
  return all;
}

}  // namespace

Table const& adaptive_table() {
  static Table const table{
      "Cells of several sizes (2D and 3D): `domain.cell` is the coarsest, and cells are halved where something asks "
      "for it, namely shocks, charges, surfaces of obstacles, the MPM region, gauges and `[[refine]]`. Time steps are "
      "halved with the cells. `[adaptive]` with `finest` is all that is needed.",
      settings().keys(),
      {},
      {}};
  return table;
}

namespace {

/// Size of the cells of a level, without round-off.
std::string size_text(Draft const& draft, int level) { return quantity(draft.out.domain_of(level).h, "m", 9); }

/// The level whose cells have the size that a key gives; nothing where there is none, which is reported with the
/// nearest sizes of levels up to `most`.
std::optional<int> level_of_cell(Draft const& draft, Section const& section, std::string_view key, int most) {
  auto const size = section.number(key);
  if (!size) return std::nullopt;
  double const halvings = std::log2(draft.out.domain.h / *size);
  int const level = std::clamp(static_cast<int>(std::lround(halvings)), 0, most_halvings);
  double const nearest = draft.out.domain_of(level).h;
  if (std::abs(nearest - *size) <= cell_tolerance * *size) return level;
  int const coarser = std::clamp(static_cast<int>(std::floor(halvings)), 0, std::max(most, 1) - 1);
  draft.error(section, key,
              fmt::format("{} is not the coarsest cell size, domain.cell = {}, halved up to {} times: write \"{}\" or "
                          "\"{}\"",
                          section.shown(key), size_text(draft, 0), most_halvings, size_text(draft, coarser),
                          size_text(draft, coarser + 1)));
  return std::nullopt;
}

}  // namespace

std::optional<int> level_up_to_finest(Draft const& draft, Section const& section, std::string_view key) {
  int const finest = draft.out.adaptive.finest;
  auto const level = level_of_cell(draft, section, key, finest);
  if (!level || *level <= finest) return level;
  draft.error(
      section, key,
      fmt::format("{} is finer than the finest cells, adaptive.finest = \"{}\": write that or a larger size, or "
                  "reduce adaptive.finest",
                  section.shown(key), size_text(draft, finest)));
  return std::nullopt;
}

namespace {

/// Can the domain have cells so fine?
bool can_have(Draft const& draft, Section const& section, int finest) {
  if (finest == 0) return true;
  if (draft.dims() == 1) {
    draft.error(section, "finest",
                fmt::format("{} has cells of one size only: remove [adaptive], or make domain.cell smaller",
                            word_of(draft.geometry())));
    return false;
  }
  if (!grid::Forest::can_refine(draft.dims())) {
    draft.error(section, "finest",
                "this program was built without p4est, so all cells have one size: remove [adaptive], or use a program "
                "that was built with -DBRISANCE_FOREST=ON");
    return false;
  }
  Section const& domain = *draft.deck.section("domain");
  std::string_view const key = domain.given("upper") ? "upper" : "size";
  try {
    grid::Partition const partition = grid::refinable_partition_of(draft.out.domain, draft.out.numerics.block_cells);
    // A row of blocks may be halved as often as all of them.
    int const longest_row = std::ranges::max(partition.parts);
    int const deepest = grid::Forest({longest_row, 1, 1}, draft.dims(), {}).deepest_level();
    if (finest <= deepest) return true;
    draft.error(section, "finest",
                fmt::format("{} is too fine for {} blocks along a direction: write \"{}\" or a larger size, "
                            "or make the domain smaller",
                            section.shown("finest"), longest_row, size_text(draft, deepest)));
  } catch (InputError const& problem) {
    draft.error(domain, key, fmt::format("{} (for [adaptive])", problem.what()));
  }
  return false;
}

/// Blocks of cells that are halved.
bool blocks_can_be_halved(Draft const& draft) {
  Section const* section = draft.deck.section("numerics");
  int const cells = draft.out.numerics.block_cells;
  if (section == nullptr || cells % 2 == 0) return true;
  draft.error(
      *section, "block_cells",
      fmt::format("{} is odd, but with [adaptive] blocks are halved: write {} or {}", cells, cells - 1, cells + 1));
  return false;
}

/// Levels of what asks for finer cells; false after an error.
bool read_levels(Draft& draft, Section const& section) {
  run::Adaptive& a = draft.out.adaptive;
  bool sound = true;
  auto const read = [&](std::string_view key, int otherwise) {
    if (!section.given(key)) return otherwise;
    auto const level = level_up_to_finest(draft, section, key);
    sound = sound && level;
    return level.value_or(otherwise);
  };
  a.shocks = read("shocks", a.finest);
  a.charges = read("charges", a.finest);
  a.obstacles = read("obstacles", a.shocks);
  if (section.given("gauges")) a.gauges = read("gauges", 0);
  if (section.given("products")) a.products = read("products", 0);
  if (!sound) return false;
  if (a.shocks > deepest_shocks) {
    bool const given = section.given("shocks");
    draft.error(
        section, given ? "shocks" : "finest",
        fmt::format("{} is domain.cell halved {} times, but shocks can be followed through {} halvings at most: "
                    "write shocks = \"{}\"{}, or make domain.cell smaller",
                    section.shown(given ? "shocks" : "finest"), a.shocks, deepest_shocks,
                    size_text(draft, deepest_shocks), given ? "" : " beside it"));
    return false;
  }
  if (a.obstacles < a.shocks) {
    draft.error(section, "obstacles",
                fmt::format("{} is coarser than the cells of shocks, \"{}\", which shocks need at surfaces too: write "
                            "this or a smaller size, or make `shocks` coarser",
                            section.shown("obstacles"), size_text(draft, a.shocks)));
    sound = false;
  }
  if (a.products && *a.products > a.shocks) {
    draft.error(section, "products",
                fmt::format("{} is finer than the cells of shocks, \"{}\": write this or a larger size, or make "
                            "`shocks` finer",
                            section.shown("products"), size_text(draft, a.shocks)));
    sound = false;
  }
  return sound;
}

/// The cells that material points see in a region; nothing after an error.
std::optional<int> read_region_level(Draft const& draft, Section const& region) {
  int const finest = draft.out.adaptive.finest;
  if (!region.given("cell")) return finest;
  auto const level = level_of_cell(draft, region, "cell", finest > 0 ? finest : most_halvings);
  if (!level) return std::nullopt;
  if (*level > 0 && !draft.deck.given("adaptive")) {
    draft.error(region, "cell",
                fmt::format("{} needs cells of several sizes: add finest = {} in a table [adaptive]",
                            region.shown("cell"), region.shown("cell")));
    return std::nullopt;
  }
  if (!level_up_to_finest(draft, region, "cell")) return std::nullopt;
  if (*level < draft.out.adaptive.shocks) {
    draft.error(region, "cell",
                fmt::format("{} is coarser than the cells of shocks, \"{}\", which would ask for finer cells in the "
                            "region: write this or a smaller size, or make adaptive.shocks coarser",
                            region.shown("cell"), size_text(draft, draft.out.adaptive.shocks)));
    return std::nullopt;
  }
  return level;
}

/// The same of all regions; false after an error.
bool read_region_levels(Draft& draft) {
  std::vector<int> levels;
  bool sound = true;
  for (Section const& region : draft.region_sections()) {
    auto const level = read_region_level(draft, region);
    sound = sound && level;
    levels.push_back(level.value_or(0));
  }
  draft.region_levels = levels.empty() ? std::vector<int>{draft.out.adaptive.finest} : std::move(levels);
  return sound;
}

/// Keys that change nothing.
void warn_of_unused(Draft const& draft, Section const& section) {
  if (draft.out.adaptive.finest == 0) {
    draft.warn(section, "finest", "has no effect: it is domain.cell, so that all cells have one size");
    return;
  }
  if (section.given("charges") && draft.deck.text("start") == "remap")
    draft.warn(section, "charges", "has no effect with start = \"remap\": the charges detonate in 1D simulations");
  int const cells = draft.out.numerics.block_cells;
  Index3 const size = grid::refinable_partition_of(draft.out.domain, cells).size;
  for (int d = 0; cells > 0 && d < draft.dims(); ++d) {
    if (size[d] == cells) continue;
    Section const& numerics = *draft.deck.section("numerics");
    draft.warn(numerics, "block_cells",
               fmt::format("the domain cannot be divided into such blocks along {}: they have {} cells there",
                           directions[d], size[d]));
  }
}

/// Bodies in empty space, or tables that need [adaptive]; false after an error.
bool belongs_here(Draft const& draft) {
  for (auto const* key : {"adaptive", "refine"}) {
    if (draft.has_gas || !draft.deck.given(key)) continue;
    draft.report.error(draft.deck.place_of(key), key,
                       "material points alone have one cell size: remove the table, or surround the bodies with gas, "
                       "with [ambient] and [mpm_region]");
    return false;
  }
  auto const* parts = draft.deck.sections("refine");
  if (parts == nullptr || parts->empty() || draft.deck.given("adaptive")) return true;
  draft.report.error(parts->front().place, parts->front().path,
                     "cells of several sizes need the finest of them: add finest = \"10 mm\", for example, in a table "
                     "[adaptive]");
  return false;
}

}  // namespace

void build_adaptive(Draft& draft) {
  if (!belongs_here(draft) || !draft.domain_known || !draft.boundaries_known) return;
  Section const* section = draft.deck.section("adaptive");
  // What lies where, and whether it is large enough for its cells, can only be told where these are known.
  draft.domain_known = false;
  if (draft.deck.broken("adaptive")) return;
  if (section != nullptr) {
    run::Adaptive read;
    bool sound = settings().read(*section, read) && !section->doubtful();
    draft.out.adaptive = read;
    auto const finest = level_of_cell(draft, *section, "finest", most_halvings);
    if (!finest || !can_have(draft, *section, *finest)) return;
    draft.out.adaptive.finest = *finest;
    sound = read_levels(draft, *section) && sound;
    if (*finest > 0) sound = blocks_can_be_halved(draft) && sound;
    if (!sound) return;
    warn_of_unused(draft, *section);
  }
  if (!read_region_levels(draft)) return;
  draft.domain_known = true;
  build_refinements(draft);
}

}  // namespace brisance::deck
