/// [[reinforcement]]: bars of steel, smeared over the particles of a body.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

namespace {

Settings<mpm::Bar> const& settings() {
  using B = mpm::Bar;
  static Settings<B> const all{
      typed(Type::text, "body").note("the only body").like("\"slab\"").means("Name of the body"),
      position("from").required().like("[0, 0.1, 0.03]").means("One end of the bar axis, in the body"),
      position("to").required().like("[1, 0.1, 0.03]").means("Other end of the bar axis"),
      {&B::diameter, number("diameter", "m", smallest, far).required().like("\"12 mm\"").means("Diameter")},
      typed(Type::integer, "copies", "1", 1, 10000).of(1L).like("10").means("Number of equal parallel bars"),
      position("step")
          .note("required for several copies")
          .like("[0, \"0.1 m\", 0]")
          .means("Offset from one copy to the next"),
      {&B::E, number("E", "Pa", 1.0, 1e13).like("\"200 GPa\"").means("Young's modulus")},
      {&B::yield, number("yield", "Pa", 0.0, 1e12).like("\"500 MPa\"").means("Yield stress")},
      {&B::hardening,
       number("hardening", "Pa", 0.0, 1e13).like("\"1 GPa\"").means("Plastic modulus, d sigma / d eps_p")}};
  return all;
}

}  // namespace

Table const& reinforcement_table() {
  static Table const table{
      "A steel bar in a body, or a row of bars, too thin for the grid to resolve. The bar is smeared over the material "
      "points within one cell of its axis; these particles carry the axial stress of the bar in addition to their own "
      "stress. Only in cartesian3d. Model a bar with a diameter of two cells or more as a separate `[[body]]` that is "
      "cut out of the other. Where bars cross, the particles belong to the first. A bar with its centre on a symmetry "
      "plane continues behind it as its mirror image, as bodies do.",
      settings().keys(),
      {},
      {}};
  return table;
}

namespace {

/// What is wrong with the place of a bar: as with bodies, only a symmetry plane through its middle may cut it.
std::optional<std::string> misplaced(mpm::Bar const& bar, grid::Domain const& domain, double tiny) {
  for (int f = 0; f < 2 * domain.dimensions(); ++f) {
    int const d = f / 2;
    double const plane = f % 2 == 0 ? domain.lower[d] : domain.upper(d);
    auto const depth = [&](Vec3 const& x) { return f % 2 == 0 ? x[d] - plane : plane - x[d]; };
    double const least = std::min(depth(bar.from), depth(bar.to));
    double const middle = 0.5 * (depth(bar.from) + depth(bar.to));
    bool const mirror = domain.boundary[f] == grid::Boundary::symmetry;
    if (least < -tiny && !(mirror && std::abs(middle) <= tiny)) {
      return fmt::format("the bar extends {:.4g} m beyond the face {} ({} = {:.6g} m), {}", -least, grid::face_names[f],
                         directions[d], plane,
                         mirror ? fmt::format("which is a symmetry plane, but its centre at {} = {:.6g} m is not on "
                                              "the plane: put the centre on the plane, or end the bar there",
                                              directions[d], f % 2 == 0 ? plane + middle : plane - middle)
                                : fmt::format("which is \"{}\": end it within the body", word_of(domain.boundary[f])));
    }
    // Along the plane and less than a radius from it the bar and its image are in each other's way.
    bool const along = std::abs(depth(bar.from) - depth(bar.to)) <= 1e-3 * norm(bar.to - bar.from);
    if (mirror && along && std::abs(middle) > tiny && least < 0.5 * bar.diameter - tiny) {
      return fmt::format(
          "the bar is {:.4g} m from the symmetry plane {} ({} = {:.6g} m), less than its radius, so it would overlap "
          "its own mirror image: put its axis on the plane or farther away",
          least, grid::face_names[f], directions[d], plane);
    }
  }
  return std::nullopt;
}

void reinforcement(Draft& draft, Section const& section) {
  if (section.doubtful()) return;
  mpm::Bar bar;
  if (section.given("body")) {
    auto const name = section.text("body");
    auto const body = name ? body_named(draft, section, "body", *name) : std::nullopt;
    if (!body) return;
    bar.body = *body;
  } else if (draft.body_names.size() > 1) {
    draft.report.error(
        section.place, section.path_of("body"),
        fmt::format("there are several bodies: name the one that contains the bar; write, for example, body = \"{}\"",
                    draft.body_names.front()));
    return;
  }
  if (draft.geometry() != grid::Geometry::cartesian3d) {
    draft.report.error(
        section.place, section.path,
        fmt::format("bars are available in cartesian3d only, but this is {}: remove them", word_of(draft.geometry())));
    return;
  }
  auto const from = draft.point(section, "from");
  auto const to = draft.point(section, "to");
  auto const copies = section.integer("copies");
  if (!settings().read(section, bar)) return;
  if (!from || !to || !copies || draft.body_names.empty()) return;
  if (norm(*to - *from) == 0.0) {
    draft.error(section, "to", "is the same point as `from`, so the bar has no length");
    return;
  }
  double const h = draft.particle_domain(bar.body).h;
  if (bar.diameter >= 2.0 * h) {
    draft.error(section, "diameter",
                fmt::format("{} is two cells of {:g} m or more, so the grid resolves this bar: make it a [[body]] with "
                            "shape = \"cylinder\" and cut it out of the other",
                            section.shown("diameter"), h));
    return;
  }
  Vec3 step{0.0, 0.0, 0.0};
  if (section.given("step")) {
    auto const given = draft.point(section, "step");
    if (!given) return;
    step = *given;
  } else if (*copies > 1) {
    draft.report.error(
        section.place, section.path_of("step"),
        "several copies need the offset from one to the next; write, for example, step = [0, \"0.1 m\", 0]");
    return;
  }
  for (long n = 0; n < *copies; ++n) {
    bar.from = *from + static_cast<double>(n) * step;
    bar.to = *to + static_cast<double>(n) * step;
    if (draft.domain_known && draft.boundaries_known) {
      if (auto const problem = misplaced(bar, draft.out.domain, draft.tiny())) {
        draft.error(section, "from", *copies > 1 ? fmt::format("copy {}: {}", n + 1, *problem) : *problem);
        return;
      }
    }
    draft.out.particles.bars.push_back(bar);
  }
}

}  // namespace

void build_reinforcements(Draft& draft) {
  draft.each("reinforcement", [&](Section const& section) { reinforcement(draft, section); });
}

}  // namespace brisance::deck
