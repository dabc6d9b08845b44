/// Ends of a simulation that its own state decides on: [end] gauges and [end] kinetic_energy.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "observe/gauges.hpp"

namespace brisance::run {
class World;
}

namespace brisance::session {

/// Looks at the state after some of the steps: every tenth one, and from step 1000 on about a hundred times while their
/// number grows to e times as many, so that looking costs little however long the records are. Steps are counted, not
/// seconds: the results do not depend on the machine, and a resumed run ends where an uninterrupted one does.
class EndConditions {
 public:
  /// What has come to pass, for people; nothing where the simulation goes on.
  [[nodiscard]] std::optional<std::string> met(run::World const& world, observe::Gauges const& gauges);
  void archive(Archive& a);

 private:
  [[nodiscard]] bool is_at_rest(run::World const& world);

  long next_look_ = 0;          ///< step
  std::vector<double> times_;   ///< of the looks at the kinetic energy [s]
  std::vector<double> motion_;  ///< kinetic energy [J]
};

}  // namespace brisance::session
