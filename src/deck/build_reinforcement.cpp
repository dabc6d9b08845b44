/// Bars of smeared reinforcement.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "deck/build.hpp"

namespace brisance::deck {

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
      return fmt::format("the bar reaches {:.4g} m over the face {} ({} = {:.6g} m), {}", -least, grid::face_names[f],
                         directions[d], plane,
                         mirror ? fmt::format("which is a symmetry plane, but its middle at {} = {:.6g} m does not lie "
                                              "on it: put the middle on the plane, or end the bar there",
                                              directions[d], f % 2 == 0 ? plane + middle : plane - middle)
                                : fmt::format("which is \"{}\": end it within the body", word_of(domain.boundary[f])));
    }
    // Along the plane and less than a radius from it the bar and its image are in each other's way.
    bool const along = std::abs(depth(bar.from) - depth(bar.to)) <= 1e-3 * norm(bar.to - bar.from);
    if (mirror && along && std::abs(middle) > tiny && least < 0.5 * bar.diameter - tiny) {
      return fmt::format(
          "the bar lies {:.4g} m from the symmetry plane {} ({} = {:.6g} m), less than its radius: it "
          "would overlap its own mirror image; put its axis on the plane or farther away",
          least, grid::face_names[f], directions[d], plane);
    }
  }
  return std::nullopt;
}

}  // namespace

void Builder::reinforcements() {
  each("reinforcement", [&](Section const& section) { reinforcement(section); });
}

void Builder::reinforcement(Section const& section) {
  if (section.doubtful()) return;
  mpm::Bar bar;
  if (section.given("body")) {
    auto const name = section.text("body");
    auto const body = name ? body_named(section, "body", *name) : std::nullopt;
    if (!body) return;
    bar.body = *body;
  } else if (body_names_.size() > 1) {
    report_.error(
        section.place, section.path_of("body"),
        fmt::format("there are several bodies: name the one that holds the bar; write for example body = \"{}\"",
                    body_names_.front()));
    return;
  }
  if (geometry() != grid::Geometry::cartesian3d) {
    report_.error(section.place, section.path,
                  fmt::format("bars are those of cartesian3d, and this is {}: remove them", word_of(geometry())));
    return;
  }
  auto const from = point(section, "from");
  auto const to = point(section, "to");
  auto const diameter = section.number("diameter");
  auto const copies = section.integer("copies");
  for (auto const& [key, member] : {std::pair{"E", &mpm::Bar::E}, std::pair{"yield", &mpm::Bar::yield},
                                    std::pair{"hardening", &mpm::Bar::hardening}}) {
    auto const value = section.number(key);
    if (!value) return;
    bar.*member = *value;
  }
  if (!from || !to || !diameter || !copies || body_names_.empty()) return;
  if (norm(*to - *from) == 0.0) {
    error(section, "to", "is the same point as `from`: a bar has a length");
    return;
  }
  if (*diameter >= 2.0 * out_.domain.h) {
    error(section, "diameter",
          fmt::format("{} is two cells of {:g} m or more: the grid resolves this bar, make it a [[body]] with shape = "
                      "\"cylinder\" and cut it out of the other",
                      section.shown("diameter"), out_.domain.h));
    return;
  }
  Vec3 step{0.0, 0.0, 0.0};
  if (section.given("step")) {
    auto const given = point(section, "step");
    if (!given) return;
    step = *given;
  } else if (*copies > 1) {
    report_.error(section.place, section.path_of("step"),
                  "several copies need the way from one to the next; write for example step = [0, \"0.1 m\", 0]");
    return;
  }
  bar.diameter = *diameter;
  for (long n = 0; n < *copies; ++n) {
    bar.from = *from + static_cast<double>(n) * step;
    bar.to = *to + static_cast<double>(n) * step;
    if (domain_known_ && boundaries_known_) {
      if (auto const problem = misplaced(bar, out_.domain, tiny())) {
        error(section, "from", *copies > 1 ? fmt::format("copy {}: {}", n + 1, *problem) : *problem);
        return;
      }
    }
    out_.points.bars.push_back(bar);
  }
}

}  // namespace brisance::deck
