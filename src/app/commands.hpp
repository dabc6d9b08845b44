/// The program's commands. Each returns the exit code, prints what it has to say, and throws `Error` where it fails.
#pragma once

#include <string>

#include "core/error.hpp"

namespace brisance::app {

struct RunArguments {
  std::string deck;
  std::string output;         ///< folder; empty: chosen from the deck's name
  int threads = 0;            ///< 0: all cores
  std::string simd = "auto";  ///< set of vector instructions
  bool force = false;         ///< replace earlier results
  bool resume = false;        ///< go on from the newest checkpoint
  bool quiet = false;         ///< say nothing but errors
  bool progress = true;
};
[[nodiscard]] ExitCode run_deck(RunArguments const& arguments);

struct CheckArguments {
  std::string deck;
  bool json = false;
};
[[nodiscard]] ExitCode check_deck(CheckArguments const& arguments);

struct MigrateArguments {
  std::string deck;
  std::string output;  ///< file for the result; empty: the deck itself
};
/// Renames the keys that had another name in earlier versions.
[[nodiscard]] ExitCode migrate_deck(MigrateArguments const& arguments);

struct InfoArguments {
  std::string name;  ///< of a material; empty: overview
  bool deck_reference = false;
  bool json_schema = false;
};
[[nodiscard]] ExitCode info(InfoArguments const& arguments);

struct ReportArguments {
  std::string folder;   ///< of the results
  bool blocks = false;  ///< show the outlines of the grid's blocks
};
[[nodiscard]] ExitCode report(ReportArguments const& arguments);

struct KbArguments {
  std::string charge;    ///< mass with unit
  std::string distance;  ///< length with unit
  std::string burst;     ///< "hemispherical" or "spherical"
  std::string explosive = "TNT";
  std::string altitude;  ///< length with unit; empty: the sea level
  bool json = false;
};
[[nodiscard]] ExitCode kb(KbArguments const& arguments);

/// Output folder for a deck when none is named: "NAME-results" in the working directory. NAME is the deck's file name
/// without its ending or, for a file called deck.toml, the name of its folder.
[[nodiscard]] std::string default_output_folder(std::string const& deck);

}  // namespace brisance::app
