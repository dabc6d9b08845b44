/// Bars of smeared reinforcement.
#include <fmt/format.h>

#include "deck/build.hpp"

namespace brisance::deck {

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
    report_.error(
        section.place, section.path,
        fmt::format("bars are those of cartesian3d, and this is {}: remove them", grid::geometry_name(geometry())));
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
    out_.points.bars.push_back(bar);
  }
}

}  // namespace brisance::deck
