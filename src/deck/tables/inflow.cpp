/// [inflow.FACE]: the states that enter the domain.
#include <fmt/format.h>

#include <algorithm>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

Table const& inflow_table() {
  static Table const table{
      "State of the ambient fluid that enters through a face whose boundary is `inflow`.",
      {density().note("that of `[ambient]`").means("Density"), pressure().note("that of `[ambient]`").means("Pressure"),
       velocity().required().means("Velocity")},
      {},
      {}};
  return table;
}

namespace {

/// In empty space nothing lies beyond a face.
void refuse_given(Draft const& draft, Section const* boundaries) {
  std::vector<std::string> possible;
  for (auto const& w : words(Boundary{})) {
    if (!grid::is_given(w.value)) possible.emplace_back(w.name);
  }
  for (int f = 0; f < 2 * draft.dims(); ++f) {
    Boundary const boundary = draft.out.domain.boundary[f];
    if (!grid::is_given(boundary)) continue;
    draft.error(
        *boundaries, boundaries->given(grid::face_names[f]) ? grid::face_names[f] : "all",
        fmt::format(
            "\"{}\" is not possible here because the bodies of this deck move in empty space; allowed: {}; with "
            "[mpm_region] there is gas",
            word_of(boundary), quoted_list(possible)));
    return;
  }
}

}  // namespace

void build_inflow(Draft& draft, Section const* section) {
  for (auto& state : draft.out.inflow) state = draft.out.ambient.state;
  if (!draft.has_gas) {
    refuse_given(draft, section);
    return;
  }
  std::array<bool, 6> described{};
  draft.each("inflow", [&](Section const& given) {
    int const f = static_cast<int>(std::find(grid::face_names.begin(), grid::face_names.end(), given.name) -
                                   grid::face_names.begin());
    described[f] = true;
    if (f / 2 >= draft.dims() || draft.out.domain.boundary[f] != Boundary::inflow) {
      draft.report.error(
          given.place, given.path,
          fmt::format("the face {} is \"{}\", so this table has no effect: write {} = \"inflow\" in [boundaries] or "
                      "remove the table",
                      given.name, f / 2 >= draft.dims() ? "not resolved" : word_of(draft.out.domain.boundary[f]),
                      given.name));
      return;
    }
    if (auto const s = fluid_state(draft, given, draft.out.ambient.fluid, draft.out.ambient.state, "density"))
      draft.out.inflow[f] = *s;
  });
  for (int f = 0; f < 2 * draft.dims(); ++f) {
    if (draft.out.domain.boundary[f] != Boundary::inflow || described[f]) continue;
    std::string_view const key = section->given(grid::face_names[f]) ? grid::face_names[f] : "all";
    draft.error(
        *section, key,
        fmt::format("\"inflow\" needs the entering state: add [inflow.{}] with velocity = [...]", grid::face_names[f]));
  }
}

}  // namespace brisance::deck
