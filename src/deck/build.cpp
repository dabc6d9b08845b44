/// The whole of a deck: from checked values to a case.
#include "deck/build.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "core/error.hpp"
#include "deck/deck.hpp"

namespace brisance::deck {

namespace {

constexpr double most_cells = 2147483648.0;  ///< 2^31
constexpr double fewest_cells = 4.0;         ///< per direction: the stencil of the schemes
constexpr double most_dumps = 1e4;
constexpr double most_records = 1e7;     ///< per gauge
constexpr double cell_tolerance = 1e-6;  ///< relative, of an extent to a whole number of cells

/// "x", "x and y" or "x, y and z".
std::string direction_list(int count) { return count == 1 ? "x" : count == 2 ? "x and y" : "x, y and z"; }

}  // namespace

std::string point_text(Vec3 const& p, int dimensions) {
  std::string out = "[";
  for (int d = 0; d < dimensions; ++d) out += fmt::format("{}{:.6g}", d > 0 ? ", " : "", p[d]);
  return out + "]";
}

run::Case Builder::build() {
  out_.title = deck_.text("title").value_or("");
  domain();
  own_materials();
  own_solids();
  ambient();
  if (geometry_known_) {
    has_gas_ = !has_bodies() || speaks_of_gas();
    boundaries();
    if (has_bodies()) {
      bodies();
      constraints();
      contacts();
      surface_pressures();
      reinforcements();
    } else {
      refuse_points();
    }
    if (has_gas_) {
      obstacles();
      charges();
      regions();
    } else {
      warn_of_unused_gas();
      warn_of_fluids_in_empty_space();
    }
    gauges();
  }
  points_options();
  if (geometry_known_) mpm_region();
  numerics();
  end();
  if (geometry_known_) afterburn();
  output();
  start();
  checkpoint();
  audit();
  compare();
  unused_materials();
  nothing_is_dropped();
  return std::move(out_);
}

/// What a deck names is built, or an error says why it is not.
void Builder::nothing_is_dropped() const {
  if (report_.failed()) return;
  auto const named = [&](std::string_view key) {
    auto const* all = deck_.sections(key);
    return all == nullptr ? std::size_t{0} : all->size();
  };
  for (auto const& [key, built] :
       {std::pair{"charge", out_.charges.size()}, std::pair{"body", out_.points.bodies.size()},
        std::pair{"region", out_.regions.size()}, std::pair{"gauge", out_.gauges.size() + out_.points.gauges.size()}}) {
    if (built >= named(key)) continue;  // a line of gauges is many
    throw std::logic_error(fmt::format("of {} [[{}]] {} were built, and nothing says why", named(key), key, built));
  }
}

bool Builder::speaks_of_gas() const {
  for (auto const* key : {"mpm_region", "charge", "region", "obstacle", "inflow"}) {
    if (deck_.given(key)) return true;
  }
  auto const* all = deck_.sections("gauge");
  return all != nullptr && std::any_of(all->begin(), all->end(),
                                       [](Section const& gauge) { return !gauge.doubtful() && !gauge.given("body"); });
}

std::optional<Vec3> Builder::point(Section const& section, std::string_view key) {
  auto const* values = section.numbers(key);
  if (values == nullptr) return std::nullopt;
  auto const count = static_cast<int>(values->size());
  if (count < dims()) {
    error(section, key,
          fmt::format("{} has {} element{}, but {} resolves {}: give {} elements", section.shown(key), count,
                      count == 1 ? "" : "s", word_of(geometry()), direction_list(dims()), dims()));
    return std::nullopt;
  }
  Vec3 out{0.0, 0.0, 0.0};
  for (int d = 0; d < count; ++d) {
    if (d >= dims() && (*values)[d] != 0.0) {
      error(section, key,
            fmt::format("{} has a value in direction {}, but {} resolves only {}: remove it or write 0",
                        section.shown(key), directions[d], word_of(geometry()), direction_list(dims())));
      return std::nullopt;
    }
    out[d] = (*values)[d];
  }
  return out;
}

void Builder::domain() {
  Section const* section = deck_.section("domain");
  if (section == nullptr) return;
  auto const word = section->text("geometry");
  if (!word) return;
  out_.domain.geometry = *value_of<Geometry>(*word);
  geometry_known_ = true;
  if (section->doubtful()) return;

  auto const h = section->number("cell");
  if (h) out_.domain.h = *h;
  std::optional<Vec3> lower = Vec3{0.0, 0.0, 0.0};
  if (section->given("lower")) lower = point(*section, "lower");
  auto const upper = point(*section, "upper");
  auto const size = point(*section, "size");
  if (!section->given("upper") && !section->given("size")) {
    report_.error(section->place, "domain.size",
                  "the extent of the domain is missing; write for example size = [4, 4, 3] (or upper = ...), in m");
    return;
  }
  if (lower && radial() && (*lower)[0] < 0.0) {
    error(*section, "lower",
          fmt::format("{} starts at a negative radius; in {} x is the radius: write 0 or more", section->shown("lower"),
                      word_of(geometry())));
    return;
  }
  if (!h || !lower || (section->given("upper") && !upper) || (section->given("size") && !size)) return;
  out_.domain.lower = *lower;

  std::string_view const key = upper ? "upper" : "size";
  bool sound = true;
  double count = 1.0;
  for (int d = 0; d < dims(); ++d) {
    double const extent = upper ? (*upper)[d] - (*lower)[d] : (*size)[d];
    if (upper && size && std::abs(extent - (*size)[d]) > cell_tolerance * std::abs(extent)) {
      error(*section, "size",
            fmt::format("{} disagrees with lower and upper in direction {}, which are {:g} m apart: give only "
                        "one of size and upper",
                        section->shown("size"), directions[d], extent));
      return;
    }
    if (extent <= 0.0) {
      error(*section, key,
            fmt::format("{} leaves no extent in direction {} ({:g} m): it must be positive", section->shown(key),
                        directions[d], extent));
      sound = false;
      continue;
    }
    double const cells = extent / *h;
    double const whole = std::max(1.0, std::round(cells));
    count *= whole;
    if (whole > most_cells) continue;
    if (std::abs(cells - whole) > cell_tolerance * cells) {
      double const below = std::floor(cells);
      std::string const nearest_extents = below >= 1.0
                                              ? fmt::format("{:.9g} or {:.9g} m", below * *h, (below + 1.0) * *h)
                                              : fmt::format("{:.9g} m", *h);
      error(*section, key,
            fmt::format("{} is not a whole number of cells: {:.9g} m in direction {} are {:.6g} cells of {:.9g} m; "
                        "make the extent "
                        "{}, or change the cell",
                        section->shown(key), extent, directions[d], cells, *h, nearest_extents));
      sound = false;
      continue;
    }
    if (whole < fewest_cells) {
      error(*section, key,
            fmt::format(
                "{} gives {:g} cell{} in direction {}; allowed: at least {:g}: make the extent {:.9g} m or more, or "
                "the cell smaller",
                section->shown(key), whole, whole > 1.0 ? "s" : "", directions[d], fewest_cells, fewest_cells * *h));
      sound = false;
      continue;
    }
    out_.domain.cells[d] = static_cast<int>(whole);
  }
  if (!sound) return;
  double const coarser = *h * std::pow(count / most_cells, 1.0 / dims());
  if (count >= most_cells) {
    error(*section, "cell",
          fmt::format("{} gives {:.4g} cells; allowed: fewer than 2^31 ({:.4g}); choose a cell above {:.3g} m or a "
                      "smaller domain",
                      section->shown("cell"), count, most_cells, coarser));
    return;
  }
  domain_known_ = true;
}

void Builder::boundaries() {
  Section const* section = deck_.section("boundaries");
  auto const kind = [](std::string const& word) { return *value_of<Boundary>(word); };
  boundaries_known_ = section == nullptr || !section->broken("all");
  Boundary const all = section == nullptr ? Boundary::outflow : kind(section->text("all").value_or("outflow"));
  bool const axis = radial() && out_.domain.lower[0] == 0.0;
  for (int f = 0; f < 6; ++f) {
    std::string_view const face = grid::face_names[f];
    bool const given = section != nullptr && section->given(face);
    if (f / 2 >= dims()) {
      if (given) {
        error(*section, face,
              fmt::format("{} has no face {}: it resolves only {}; remove the key", word_of(geometry()), face,
                          direction_list(dims())));
      }
      continue;
    }
    Boundary& b = out_.domain.boundary[f];
    b = f == 0 && axis ? Boundary::symmetry : all;
    if (!given) continue;
    auto const word = section->text(face);
    if (!word) {
      boundaries_known_ = false;
      continue;
    }
    b = kind(*word);
    if (f == 0 && axis && b != Boundary::symmetry) {
      error(*section, face,
            fmt::format("\"{}\" is not possible at radius 0; allowed: \"symmetry\", which is the default there: remove "
                        "the key",
                        *word));
    }
    if (f / 2 == 0 && radial() && b == Boundary::periodic) {
      error(*section, face,
            fmt::format("\"periodic\" is not possible along the radius x of {}; choose another boundary",
                        word_of(geometry())));
    }
  }
  if (!boundaries_known_) return;
  for (int d = 0; d < dims(); ++d) {
    bool const low = out_.domain.boundary[2 * d] == Boundary::periodic;
    bool const high = out_.domain.boundary[2 * d + 1] == Boundary::periodic;
    if (low == high || (radial() && d == 0)) continue;
    int const other = low ? 2 * d + 1 : 2 * d;
    error(*section,
          section->given(grid::face_names[low ? 2 * d : 2 * d + 1]) ? grid::face_names[low ? 2 * d : 2 * d + 1] : "all",
          fmt::format("\"periodic\" joins both faces of a direction, but {} is \"{}\": make both periodic",
                      grid::face_names[other], word_of(out_.domain.boundary[other])));
  }
  inflow(section);
}

void Builder::numerics() {
  Section const* section = deck_.section("numerics");
  if (section == nullptr) return;
  auto& n = out_.numerics;
  choose(*section, "scheme", n.scheme);
  n.courant = section->number("courant").value_or(n.courant);
  n.block_cells = static_cast<int>(section->integer("block_cells").value_or(n.block_cells));
  n.sleep = section->boolean("sleep").value_or(n.sleep);
  n.limiter_beta = section->number("limiter_beta").value_or(n.limiter_beta);
  n.carbuncle_cure = section->boolean("carbuncle_cure").value_or(n.carbuncle_cure);
  n.density_floor = section->number("density_floor").value_or(n.density_floor);
  n.pressure_floor = section->number("pressure_floor").value_or(n.pressure_floor);
  n.viscosity = section->number("viscosity").value_or(n.viscosity);
  if (auto const volume = section->number("ideal_products")) cut_over(*volume);
  if (n.block_cells != 0 && n.block_cells < 4) {
    error(*section, "block_cells",
          fmt::format("{} is too small; allowed: 0 (chosen by the program) or 4 to 4096", n.block_cells));
  }
  if (n.scheme == run::Scheme::lax_wendroff) {
    for (auto const* key : {"limiter_beta", "carbuncle_cure"}) {
      if (section->given(key))
        report_.warning(section->place_of(key), section->path_of(key), "has no effect with lax-wendroff");
    }
  } else if (section->given("viscosity")) {
    report_.warning(section->place_of("viscosity"), section->path_of("viscosity"), "has no effect with muscl-hancock");
  }
}

void Builder::cut_over(double volume) {
  bool found = false;
  auto const set = [&](auto& eos) {
    if (auto* jwl = std::get_if<material::Jwl>(&eos)) {
      jwl->ideal_beyond = volume;
      found = true;
    }
  };
  for (auto& charge : out_.charges) charge.explosive.products.ideal_beyond = volume;
  if (out_.second_fluid) set(out_.second_fluid->eos);
  for (auto& body : out_.points.bodies) set(body.solid.eos);
  if (found || !out_.charges.empty()) return;
  Section const& section = *deck_.section("numerics");
  report_.warning(section.place_of("ideal_products"), section.path_of("ideal_products"),
                  "has no effect: nothing in the deck has a JWL equation of state");
}

void Builder::end() {
  Section const* section = deck_.section("end");
  if (section == nullptr) return;
  out_.end.steps = section->integer("steps").value_or(0);
  out_.end.gauges = section->text("gauges").has_value();
  out_.end.kinetic_energy = section->number("kinetic_energy").value_or(0.0);
  out_.end.wall_clock = section->number("wall_clock").value_or(0.0);
  auto const* gauges = deck_.sections("gauge");
  bool const of_gas = has_gas_ && gauges != nullptr && std::any_of(gauges->begin(), gauges->end(), [](auto const& g) {
                        return g.doubtful() || !g.given("body");
                      });
  if (out_.end.gauges && !of_gas && !deck_.broken("gauge")) {
    error(*section, "gauges", "there is no gauge in the gas: add [[gauge]] with a point, or remove the key");
  }
  auto const time = section->number("time");
  if (!time) return;
  out_.end.time = *time;
  end_known_ = true;
  check_onsets();
}

void Builder::checkpoint() {
  Section const* section = deck_.section("checkpoint");
  if (section == nullptr) return;
  auto& c = out_.checkpoint;
  c.interval = section->number("interval").value_or(c.interval);
  c.steps = section->integer("steps").value_or(c.steps);
  c.wall_clock = section->number("wall_clock").value_or(c.wall_clock);
  c.keep = static_cast<int>(section->integer("keep").value_or(c.keep));
  c.at_end = section->boolean("at_end").value_or(c.at_end);
  c.on_signal = section->boolean("on_signal").value_or(c.on_signal);
}

void Builder::audit() {
  Section const* section = deck_.section("audit");
  if (section == nullptr) return;
  auto& limits = out_.audit;
  limits.warn = section->number("warn").value_or(limits.warn);
  limits.fail = section->number("fail").value_or(limits.fail);
  bool const read = !section->broken("warn") && !section->broken("fail");
  if (read && limits.fail > 0.0 && limits.warn > limits.fail) {
    error(*section, section->given("fail") ? "fail" : "warn",
          fmt::format("the run would stop at fail = {:g} before it warns at warn = {:g}: make `fail` larger, `warn` "
                      "smaller, or `fail = 0` for a run that never stops",
                      limits.fail, limits.warn));
  }
}

void Builder::output() {
  Section const* section = deck_.section("output");
  if (section == nullptr) return;
  auto& o = out_.output;
  o.field_interval = section->number("field_interval").value_or(o.field_interval);
  o.gauge_interval = section->number("gauge_interval").value_or(o.gauge_interval);
  o.peak_fields = section->boolean("peak_fields").value_or(o.peak_fields);
  o.single_precision = section->text("precision").value_or("single") == "single";
  if (auto const* times = section->numbers("field_times")) o.field_times = *times;
  if (auto const* fields = section->strings("fields")) {
    o.fields.clear();
    for (auto const& field : *fields) {
      if (std::find(o.fields.begin(), o.fields.end(), field) == o.fields.end()) o.fields.push_back(field);
    }
  }
  if (auto const* fields = section->strings("point_fields")) {
    o.point_fields.clear();
    for (auto const& field : *fields) {
      if (std::find(o.point_fields.begin(), o.point_fields.end(), field) == o.point_fields.end()) {
        o.point_fields.push_back(field);
      }
    }
  }
  for (auto const* key : {"fields", "peak_fields"}) {
    if (!has_gas_ && section->given(key)) warn(*section, key, "has no effect in a deck of bodies without gas");
  }
  bool const region = has_gas_ && (has_bodies() || deck_.given("mpm_region"));
  o.gas_points = section->boolean("gas_points").value_or(o.gas_points);
  o.profile = section->boolean("profile").value_or(o.profile);
  if (!region && section->given("gas_points")) {
    warn(*section, "gas_points", "has no effect in a deck without an MPM region");
  }
  if (!has_bodies() && !(region && o.gas_points) && section->given("point_fields")) {
    warn(*section, "point_fields",
         region ? "has no effect in a deck without bodies, unless gas_points = true"
                : "has no effect in a deck without bodies");
  }
  std::sort(o.field_times.begin(), o.field_times.end());
  if (!end_known_) return;
  double const time = out_.end.time;
  if (!o.field_times.empty() && o.field_times.back() > time) {
    error(*section, "field_times",
          fmt::format("{:g} s lies after the end of the calculation at {:g} s: remove it or calculate longer",
                      o.field_times.back(), time));
  }
  for (auto const& [key, interval, what] : {std::tuple{"field_interval", o.field_interval, "dumps are written"},
                                            std::tuple{"gauge_interval", o.gauge_interval, "gauges record"}}) {
    if (section->given(key) && interval > time) {
      warn(*section, key,
           fmt::format("is longer than the calculation, {:g} s: {} at its start and its end only", time, what));
    }
  }
  too_many(*section, "field_interval", o.field_interval, most_dumps, "field dumps");
  too_many(*section, "gauge_interval", o.gauge_interval, most_records, "records per gauge");
}

void Builder::too_many(Section const& section, std::string_view key, double interval, double most, char const* things) {
  if (interval <= 0.0 || out_.end.time / interval <= most) return;
  error(section, key,
        fmt::format("{} until {:g} s makes {:.4g} {}; allowed: at most {:g}; write at least {:.3g} s",
                    section.shown(key), out_.end.time, out_.end.time / interval, things, most, out_.end.time / most));
}

void Builder::compare() {
  Section const* section = deck_.section("compare");
  auto const word = section == nullptr ? std::optional<std::string>("auto") : section->text("burst");
  if (!word) return;
  if (*word == "spherical") out_.burst = run::Burst::spherical;
  if (*word == "hemispherical") out_.burst = run::Burst::hemispherical;
  if (*word == "auto") out_.burst = automatic_burst();
  auto const* charges = deck_.sections("charge");
  bool const one = charges != nullptr && charges->size() == 1;
  if (*word != "auto" && *word != "none" && !one && !deck_.broken("charge")) {
    error(*section, "burst",
          fmt::format("\"{}\" needs exactly one charge, there are {}: write \"none\"", *word,
                      charges == nullptr ? 0 : charges->size()));
  }
  if (!has_gas_) out_.burst = run::Burst::none;
  bool const points = has_bodies() && points_move();
  // A wind blows against obstacles and walls.
  bool const wind = has_gas_ && norm(out_.ambient.state.velocity) > 0.0;
  bool const gas = wind || deck_.given("charge") || deck_.given("region") || deck_.given("inflow");
  if (points || gas) return;
  if (!has_gas_) {
    report_.warning(deck_.place_of("body"), "body",
                    "nothing will happen: no body moves, burns or is under pressure, and no load or body force acts");
  } else if (has_bodies()) {
    report_.warning(deck_.place, "charge",
                    "nothing will happen: there is no charge, no region and no inflow, no body moves or burns, and no "
                    "load or body force acts");
  } else {
    report_.warning(deck_.place, "charge", "nothing will happen: there is no charge, no region and no inflow");
  }
}

Result read_text(std::string_view text, std::string_view name) {
  Result result;
  Report report{std::string(name)};
  auto const deck = read(text, deck_schema(), report);
  if (deck) {
    Builder builder(*deck, report);
    run::Case built = builder.build();
    if (!report.failed()) {
      result.materials = builder.materials(built);
      built.deck_path = name;
      built.deck_text = text;
      result.case_ = std::move(built);
    }
  }
  result.errors = report.errors();
  if (!report.failed()) result.warnings = report.warnings();
  return result;
}

Result read_file(std::string const& path) {
  Result too_large;
  std::error_code unknown;  // of a pipe: the reading ends at the limit
  auto const size = std::filesystem::file_size(path, unknown);
  if (!unknown && size > largest_deck) {
    too_large.errors.push_back({path, 1, 1, "", size_problem(fmt::format("{}", size))});
    return too_large;
  }
  std::ifstream file(path, std::ios::binary);
  std::string text;
  std::array<char, 65536> part{};
  while (text.size() <= largest_deck && (file.read(part.data(), part.size()), file.gcount() > 0)) {
    text.append(part.data(), static_cast<std::size_t>(file.gcount()));
  }
  // A folder opens, but does not read.
  if (!file.is_open() || file.bad()) throw IoError(fmt::format("the deck \"{}\" cannot be read", path));
  if (text.size() > largest_deck) {
    too_large.errors.push_back({path, 1, 1, "", size_problem(fmt::format("more than {}", largest_deck))});
    return too_large;
  }
  return read_text(text, path);
}

}  // namespace brisance::deck
