/// What a case will compute and what it costs, known before anything large is allocated.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "run/case.hpp"
#include "run/world.hpp"

namespace brisance::app {

struct Plan {
  double cells = 0.0;
  int blocks = 0;
  double memory_bytes = 0.0;          ///< estimate for the whole program
  double machine_memory_bytes = 0.0;  ///< what this machine, or the limit set on this process, has
  double steps = 0.0;                 ///< estimate
  std::vector<run::ChargeReport> charges;
  std::vector<run::BodyReport> bodies;
  double points = 0.0;  ///< material points; 0: a calculation of the gas
  long dumps = 0;
  double dump_bytes = 0.0;        ///< of one dump, uncompressed
  double gauge_bytes = 0.0;       ///< of all gauge files, estimate
  double checkpoint_bytes = 0.0;  ///< of one checkpoint without gauge histories, estimate for points
  std::vector<std::string> warnings;
};

/// Works the plan out. Throws InputError where the case cannot be realised.
[[nodiscard]] Plan plan(run::Case const& setup);

/// Throws InputError when the case needs more memory than the machine has.
void refuse_unless_it_fits(Plan const& plan);

[[nodiscard]] std::string plan_text(run::Case const& setup, Plan const& plan);
[[nodiscard]] nlohmann::json plan_json(run::Case const& setup, Plan const& plan);

}  // namespace brisance::app
