/// [[refine]]: parts of the domain with smaller cells.
#include <fmt/format.h>

#include "core/text.hpp"
#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/places.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

Table const& refine_table() {
  static Table const table{
      "A part of the domain whose cells are no larger than a size during the whole simulation; needs `[adaptive]`. "
      "Give `cell` or `level`.",
      joined(shape_keys(), {number("cell", "m", smallest, 1e4)
                                .note("from `level`")
                                .like("\"20 mm\"")
                                .means("Largest cell size: `domain.cell` halved a whole number of times, at least "
                                       "`adaptive.finest`"),
                            typed(Type::integer, "level", "1", 0, 12)
                                .note("from `cell`")
                                .like("2")
                                .means("The same as a number of halvings")}),
      {},
      {}};
  return table;
}

namespace {

constexpr std::size_t most_parts = 1000;

std::optional<int> level_of_part(Draft const& draft, Section const& section) {
  bool const by_cell = section.given("cell");
  if (by_cell == section.given("level")) {
    std::string const size = quantity(draft.out.domain_of(draft.out.adaptive.finest).h, "m", 9);
    draft.report.error(section.place, section.path,
                       fmt::format("it has {}, but exactly one of them tells how fine it is: write, for "
                                   "example, cell = \"{}\"",
                                   by_cell ? "both cell and level" : "neither cell nor level", size));
    return std::nullopt;
  }
  if (by_cell) return level_up_to_finest(draft, section, "cell");
  auto const level = section.integer("level");
  int const finest = draft.out.adaptive.finest;
  if (!level || *level <= finest) return level ? std::optional(static_cast<int>(*level)) : std::nullopt;
  draft.error(section, "level",
              fmt::format("{} has cells of {}, finer than adaptive.finest, which is level {}: write at most {}, or "
                          "reduce adaptive.finest",
                          *level, quantity(draft.out.domain_of(static_cast<int>(*level)).h, "m", 9), finest, finest));
  return std::nullopt;
}

}  // namespace

void build_refinements(Draft& draft) {
  auto const* all = draft.deck.sections("refine");
  if (all == nullptr) return;
  if (all->size() > most_parts) {
    draft.error(draft.deck, "refine",
                fmt::format("there are {} refined parts; allowed: at most {}", all->size(), most_parts));
    return;
  }
  for (Section const& section : *all) {
    auto const shape = build_shape(draft, section, Use::gas, std::nullopt);
    if (shape) touches_domain(draft, section, *shape, "refined part");
    if (section.doubtful()) continue;
    auto const level = level_of_part(draft, section);
    if (shape && level) draft.out.adaptive.parts.push_back({*shape, *level});
  }
}

}  // namespace brisance::deck
