/// `brisance kb`: Kingery-Bulmash values of one charge at one distance.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/commands.hpp"
#include "app/print.hpp"
#include "core/text.hpp"
#include "core/units.hpp"
#include "deck/library.hpp"
#include "deck/schema.hpp"
#include "empirical/standard_atmosphere.hpp"
#include "observe/blast_summary.hpp"
#include "output/json.hpp"

namespace brisance::app {

namespace {

double si_quantity(char const* option, std::string const& text, char const* unit) {
  units::Quantity const q = units::parse(text, unit);
  if (!q.value) throw InputError(fmt::format("{}: {}", option, q.problem));
  if (!(*q.value > 0.0) || !std::isfinite(*q.value))
    throw InputError(fmt::format("{}: \"{}\" must be positive", option, text));
  return *q.value;
}

material::Explosive const& known_explosive(std::string const& name) {
  auto const* explosive = deck::library().explosive(name);
  if (explosive == nullptr) {
    throw InputError(fmt::format("--explosive: \"{}\" is not a known explosive; {}", name,
                                 deck::suggestion(name, deck::library().explosive_names(), "known explosives")));
  }
  return *explosive;
}

run::Ambient air_at(std::string const& height) {
  auto const* air = deck::library().fluid("air");
  run::Ambient ambient;
  ambient.fluid = *air;
  ambient.state.density = air->density;
  ambient.state.pressure = air->pressure;
  if (!height.empty()) {
    units::Quantity const altitude = units::parse(height, "m");
    if (!altitude.value) throw InputError(fmt::format("--altitude: {}", altitude.problem));
    auto const state = empirical::standard_atmosphere(*altitude.value);
    ambient.state.pressure = state.pressure;
    ambient.state.density = state.density;
  }
  return ambient;
}

/// The answer to the question.
struct Answer {
  material::Explosive const* explosive = nullptr;
  double mass = 0.0;      ///< [kg]
  double distance = 0.0;  ///< [m]
  std::string burst_word;
  empirical::Burst burst = empirical::Burst::hemispherical;
  bool at_altitude = false;
  run::Ambient ambient;
  empirical::Blast blast;
  std::optional<double> by_pressure;      ///< mass of TNT for pressures [kg]
  std::optional<double> by_impulse;       ///< for impulses and times [kg]
  std::optional<double> scaled_distance;  ///< [m/kg^(1/3)]
  std::optional<double> other;            ///< incident impulse by the other fit over this one
};

Answer answer_to(KbArguments const& arguments) {
  Answer a;
  a.explosive = &known_explosive(arguments.explosive);
  a.at_altitude = !arguments.altitude.empty();
  a.ambient = air_at(arguments.altitude);
  a.mass = si_quantity("--charge", arguments.charge, "kg");
  a.distance = si_quantity("--distance", arguments.distance, "m");
  a.burst_word = arguments.burst;
  bool const spherical = arguments.burst == "spherical";
  a.burst = spherical ? empirical::Burst::spherical : empirical::Burst::hemispherical;
  // As a gauge of a case asks, so that both give the same answer.
  a.blast = observe::empirical_blast(*a.explosive, a.mass, a.ambient,
                                     spherical ? run::Burst::spherical : run::Burst::hemispherical, a.distance);
  auto const tnt_mass = [&a](std::optional<double> equivalent) {
    return equivalent ? std::optional(a.mass * *equivalent) : std::nullopt;
  };
  a.by_pressure = tnt_mass(a.explosive->tnt_equivalent_pressure);
  a.by_impulse = tnt_mass(a.explosive->tnt_equivalent_impulse);
  if (a.by_pressure) a.scaled_distance = a.blast.scaled_distance;
  if (a.by_pressure && a.by_impulse) {
    double const z = a.blast.scaled_distance * std::cbrt(*a.by_pressure / *a.by_impulse);
    a.other = empirical::other_incident_impulse(z, a.burst);
  }
  return a;
}

void print_json(Answer const& a) {
  nlohmann::json quantities = nlohmann::json::object();
  for (auto const& field : empirical::blast_fields) {
    auto const range = empirical::validity(field, a.burst);
    quantities[std::string(field.key)] = {{"value", output::json_or_null(a.blast.*field.value)},
                                          {"unit", field.unit},
                                          {"scaled_distances", {range.lowest, range.highest}}};
  }
  nlohmann::json const answer{{"explosive", a.explosive->name},
                              {"mass", a.mass},
                              {"tnt_mass_for_pressure", output::json_or_null(a.by_pressure)},
                              {"tnt_mass_for_impulse", output::json_or_null(a.by_impulse)},
                              {"distance", a.distance},
                              {"burst", a.burst_word},
                              {"scaled_distance", output::json_or_null(a.scaled_distance)},
                              {"ambient_pressure", a.ambient.state.pressure},
                              {"ambient_density", a.ambient.state.density},
                              {"incident_impulse_of_other_fit", output::json_or_null(a.other)},
                              {"quantities", quantities}};
  print(stdout, "{}\n", answer.dump(2));
}

void print_head(Answer const& a) {
  print(stdout, "{:g} kg of {}, {} burst, {:g} m{}\n", a.mass, a.explosive->name, a.burst_word, a.distance,
        a.scaled_distance ? fmt::format(": Z = {:.4g} m/kg^(1/3)", *a.scaled_distance) : "");
  if (a.explosive->name != "TNT") {
    auto const mass_text = [](std::optional<double> m) { return m ? fmt::format("{:g} kg", *m) : "unknown"; };
    print(stdout, "TNT equivalent: {} for pressures, {} for impulses and times\n", mass_text(a.by_pressure),
          mass_text(a.by_impulse));
  }
  if (a.at_altitude) {
    print(stdout, "air at {} and {:.4g} kg/m3; Z is scaled to sea level; without this scaling it would be {:.4g}\n",
          quantity(a.ambient.state.pressure, "Pa", 5), a.ambient.state.density,
          a.distance / std::cbrt(a.by_pressure.value_or(a.mass)));
  }
  print(stdout, "\n");
}

void print_table(Answer const& a) {
  for (auto const& field : empirical::blast_fields) {
    auto const value = a.blast.*field.value;
    bool const of_impulse = field.scaling == empirical::Scaling::impulse || field.scaling == empirical::Scaling::time;
    if (of_impulse ? !a.by_impulse : !a.by_pressure) {
      print(stdout, "{:<24} {:>10} (the TNT equivalent is unknown)\n", field.label, "-");
    } else if (value) {
      print(stdout, "{:<24} {:>10.4g} {}\n", field.label, *value * field.display_factor, field.display_unit);
    } else {
      auto const range = empirical::validity(field, a.burst);
      bool const derived = field.value == &empirical::Blast::dynamic_pressure;
      print(
          stdout, "{:<24} {:>10} (known for Z from {:.4g} to {:.4g}{})\n", field.label, "-", range.lowest,
          range.highest,
          derived && a.blast.scaled_distance < range.lowest
              ? fmt::format(
                    ": valid up to an overpressure of {:g} ambient pressures, while air still behaves as an ideal gas",
                    empirical::strongest_ideal_shock)
              : "");
    }
  }
}

}  // namespace

ExitCode kb(KbArguments const& arguments) {
  Answer const a = answer_to(arguments);
  if (arguments.json) {
    print_json(a);
    return ExitCode::done;
  }
  print_head(a);
  print_table(a);
  if (a.other) {
    print(stdout,
          "\nTwo values of one coefficient for the incident impulse of hemispherical bursts are in use. The value used "
          "here, from\nthe metric listings, joins the curve for small Z better; the other one changes the impulse by "
          "{:+.1f} %.\n",
          100.0 * (*a.other - 1.0));
  }
  return ExitCode::done;
}

}  // namespace brisance::app
