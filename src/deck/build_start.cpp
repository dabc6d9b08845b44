/// The start of a deck: charges on the grid, or bursts in one direction that are remapped.
#include <fmt/format.h>

#include <filesystem>

#include "core/error.hpp"
#include "deck/build.hpp"
#include "setup/start.hpp"

namespace brisance::deck {

void Builder::start() {
  bool const asked = deck_.text("start") == "remap";
  Section const* section = deck_.section("remap");
  if (out_.output.profile && geometry_known_) {
    bool const possible = geometry() == Geometry::spherical1d || geometry() == Geometry::cylindrical1d ||
                          geometry() == Geometry::axisymmetric2d;
    auto const* charges = deck_.sections("charge");
    bool const one = charges != nullptr && charges->size() == 1;
    if (!possible || !one || has_bodies() || deck_.given("obstacle") || deck_.given("region") ||
        deck_.given("mpm_region")) {
      error(*deck_.section("output"), "profile",
            fmt::format("a profile is the burst of one charge in spherical1d, cylindrical1d or axisymmetric2d without "
                        "bodies, obstacles and regions; this deck {}: remove the key",
                        !possible ? fmt::format("is of {}", word_of(geometry()))
                        : !one    ? fmt::format("has {} charges", charges == nullptr ? 0 : charges->size())
                                  : "has one of these"));
    }
  }
  if (!asked) {
    if (section != nullptr && !deck_.broken("start")) {
      report_.warning(section->place, section->path, "has no effect without start = \"remap\" at the head of the deck");
    }
    return;
  }
  run::Start& s = out_.start;
  s.remap = true;
  std::string_view key = "start";
  Section const* blamed = &deck_;
  if (section != nullptr) {
    choose(*section, "method", s.method);
    s.cell = section->number("cell").value_or(0.0);
    s.time = section->number("time");
    s.radius = section->number("radius");
    if (auto const file = section->text("profile")) {
      s.profile = (std::filesystem::path(report_.file()).parent_path() / *file).string();
      for (auto const* other : {"method", "cell", "time", "radius"}) {
        if (!section->given(other)) continue;
        error(*section, other,
              fmt::format("{} belongs to the 1D calculation, in whose place the profile stands: remove one of the two",
                          section->shown(other)));
      }
    }
    if (s.method == run::StartMethod::points && deck_.given("afterburn")) {
      error(
          *section, "method",
          fmt::format("{} does not go with [afterburn], which is of gas cells: write \"gas\", or remove the afterburn",
                      section->shown("method")));
    }
    if (section->given("time") && section->given("radius")) {
      error(*section, "radius",
            fmt::format("{} is given beside a time: remove one of the two", section->shown("radius")));
    }
    for (auto const* candidate : {"cell", "time", "radius", "profile"}) {
      if (!section->given(candidate)) continue;
      blamed = section;
      key = candidate;
    }
  }
  Place const place = blamed->place_of(key);
  s.place = fmt::format("{}:{}:{}: error: {}", report_.file(), place.line, place.column, blamed->path_of(key));
  if (!has_gas_ && geometry_known_) {
    error(deck_, "start", "\"remap\" needs a charge in gas, and this deck has bodies in empty space: remove it");
    return;
  }
  if (s.time && end_known_ && *s.time >= out_.end.time) {
    error(*section, "time",
          fmt::format(
              "{} is not before the end of the calculation at {:g} s: choose an earlier time, or calculate longer",
              section->shown("time"), out_.end.time));
    return;
  }
  // What the parts of the deck mean together can be told only when all of them are sound.
  bool const sound = domain_known_ && boundaries_known_ && end_known_ && !report_.failed();
  if (!sound || !s.profile.empty()) return;
  try {
    for (std::size_t n = 0; n < std::max<std::size_t>(1, out_.charges.size()); ++n) (void)setup::plan_start(out_, n);
  } catch (InputError const& problem) {
    error(*blamed, key, problem.what());
  }
}

}  // namespace brisance::deck
