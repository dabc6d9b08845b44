/// The bridge, its ghost cells and theirs: cells that solids may not enter.
#pragma once

#include <string>
#include <vector>

#include "bridge/faces.hpp"
#include "mpm/mpm.hpp"

namespace brisance::bridge {

class ForbiddenCells {
 public:
  /// Keeps references to particles and faces.
  ForbiddenCells(mpm::Mpm const& particles, int gas_body, Faces const& faces);

  /// What is wrong where a solid has come into one; empty: none has.
  [[nodiscard]] std::string intruder() const;

 private:
  [[nodiscard]] bool contains(Index3 const& cell) const;

  mpm::Mpm const* particles_;
  int gas_body_;
  Faces const* faces_;
  Region const* region_;
  std::vector<int> blocks_;  ///< of the particles, that hold such cells
};

}  // namespace brisance::bridge
