/// [boundaries]: what happens at the faces of the domain.
#include <fmt/format.h>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

std::vector<std::string> const& faces() {
  static std::vector<std::string> const names{"x_low", "x_high", "y_low", "y_high", "z_low", "z_high"};
  return names;
}

Table const& boundaries_table() {
  static Table const table = [] {
    Table t{
        "Conditions at the faces of the domain. `outflow` lets waves out, as if the initial gas continued beyond the "
        "face; `wall` is rigid (the ground); `symmetry` is a mirror plane; `inflow` prescribes the state given in "
        "`[inflow.FACE]`; `periodic` joins opposite faces; `zero_gradient` copies the cells next to the face, which "
        "reflects part of every wave of varying strength and is meant for comparison.",
        {},
        {},
        {}};
    t.keys.push_back(word<grid::Boundary>("all")
                         .of(word_of(grid::Domain{}.boundary[0]))
                         .like("\"outflow\"")
                         .means("All faces that are not listed"));
    for (auto const& face : faces()) {
      t.keys.push_back(
          word(face, all_words<grid::Boundary>())
              .note(face == "x_low" ? "as `all`; `symmetry` if x is a radius and x_low is at 0" : "as `all`")
              .like("\"symmetry\"")
              .means(fmt::format("Face at the {} end of {}", face.substr(2), face.substr(0, 1))));
    }
    return t;
  }();
  return table;
}

void build_boundaries(Draft& draft) {
  Section const* section = draft.deck.section("boundaries");
  draft.boundaries_known = section == nullptr || !section->broken("all");
  Boundary all = grid::Domain{}.boundary[0];
  if (section != nullptr) choose(*section, "all", all);
  bool const axis = draft.radial() && draft.out.domain.lower[0] == 0.0;
  for (int f = 0; f < 6; ++f) {
    std::string_view const face = grid::face_names[f];
    bool const given = section != nullptr && section->given(face);
    if (f / 2 >= draft.dims()) {
      if (given) {
        draft.error(*section, face,
                    fmt::format("{} has no face {}: it resolves {} only; remove the key", word_of(draft.geometry()),
                                face, direction_list(draft.dims())));
      }
      continue;
    }
    Boundary& b = draft.out.domain.boundary[f];
    b = f == 0 && axis ? Boundary::symmetry : all;
    if (!given) continue;
    auto const word = section->text(face);
    if (!word) {
      draft.boundaries_known = false;
      continue;
    }
    b = *value_of<Boundary>(*word);
    if (f == 0 && axis && b != Boundary::symmetry) {
      draft.error(
          *section, face,
          fmt::format(
              "\"{}\" is not possible at radius 0; allowed: \"symmetry\", which is the default there; remove the key",
              *word));
    }
    if (f / 2 == 0 && draft.radial() && b == Boundary::periodic) {
      draft.error(*section, face,
                  fmt::format("\"periodic\" is not possible along the radius x of {}; choose another boundary",
                              word_of(draft.geometry())));
    }
  }
  if (!draft.boundaries_known) return;
  for (int d = 0; d < draft.dims(); ++d) {
    bool const low = draft.out.domain.boundary[2 * d] == Boundary::periodic;
    bool const high = draft.out.domain.boundary[2 * d + 1] == Boundary::periodic;
    if (low == high || (draft.radial() && d == 0)) continue;
    int const other = low ? 2 * d + 1 : 2 * d;
    draft.error(
        *section,
        section->given(grid::face_names[low ? 2 * d : 2 * d + 1]) ? grid::face_names[low ? 2 * d : 2 * d + 1] : "all",
        fmt::format("\"periodic\" joins both faces of a direction, but {} is \"{}\": make both faces periodic",
                    grid::face_names[other], word_of(draft.out.domain.boundary[other])));
  }
  build_inflow(draft, section);
}

}  // namespace brisance::deck
