/// What several MPM regions of a case leave to each other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bridge/region.hpp"
#include "case/case.hpp"

namespace brisance::setup {

/// Two regions that do not go together.
struct RegionConflict {
  std::size_t first = 0;
  std::size_t second = 0;  ///< after the first
  std::string problem;     ///< and what to do
};

/// Cells, of the larger ones, that two regions must leave between them: those that the gas needs and those beside a
/// region that act as particles.
[[nodiscard]] int least_gap_of_regions(Case const& setup);

/// The first two of all regions of a case, in their order, that overlap, are too near to each other, or lie on levels
/// for which there are too few cells between them; nothing: all is well.
[[nodiscard]] std::optional<RegionConflict> conflict_of(Case const& setup, std::vector<bridge::Region> const& regions);

}  // namespace brisance::setup
