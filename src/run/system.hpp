/// The system that is simulated: a case, what was built of it, and the time that it has come to.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "gas/gas.hpp"
#include "grid/forest.hpp"
#include "grid/grid.hpp"
#include "run/adaptation.hpp"
#include "run/panels.hpp"
#include "run/reports.hpp"

namespace brisance::run {

struct Clock {
  double time = 0.0;  ///< [s]
  double dt = 0.0;    ///< length of the last step [s]
  long step = 0;
  long gas_steps = 0;       ///< steps of the gas within these
  long particle_steps = 0;  ///< of the particles
};

/// Material points on a background grid of their own: an MPM region, or bodies in a vacuum.
struct Region {
  std::unique_ptr<mpm::Mpm> particles;
  std::unique_ptr<bridge::Bridge> bridge;  ///< joins them to the gas around; null in a vacuum
  /// Numbers of its bodies in `System::bodies`, in the order in which `particles` has them.
  std::vector<int> bodies;
  std::optional<double> awake_since;  ///< when it woke [s]
  long steps = 0;                     ///< of the particles

  /// The body of the gas particles in `particles`, -1 in a vacuum.
  [[nodiscard]] int gas_body() const { return bridge == nullptr ? -1 : bridge->gas_body(); }
  /// Do the particles take part in the step?
  [[nodiscard]] bool moves() const { return bridge == nullptr || bridge->awake(); }
};

/// Where a body is: the number of its region, and its own number there.
struct BodyPlace {
  std::size_t region = 0;
  int body = 0;
};

/// Wall-clock seconds per phase of the step and of the output.
using Timings = std::map<std::string, double>;

/// What a simulation moves, and what became of its case on the grid. `setup` fills it, `advance` moves it, `observe`
/// looks at it.
class System {
  std::unique_ptr<grid::Grid> grid_;  ///< keeps its place when the system moves
  grid::Forest forest_;               ///< of its blocks, where it has several levels

 public:
  /// A case and its grid, with nothing in it.
  explicit System(Case setup);
  /// The same with the leaves of a forest.
  System(Case setup, grid::Forest forest);
  ~System();
  System(System&&) noexcept;
  System& operator=(System&&) = delete;

  Case setup;
  grid::Grid const& grid;
  std::unique_ptr<gas::Gas> gas;           ///< null where the case has bodies in a vacuum
  std::vector<Region> regions;             ///< empty where the case is one of gas alone
  std::unique_ptr<Panels> panels;          ///< null where the case has none
  std::unique_ptr<Adaptation> adaptation;  ///< null where all cells are of one size
  Clock clock;
  std::vector<ChargeReport> charges;
  std::vector<InitialStateReport> initial_states;  ///< what became of each on the grid
  std::vector<ObstacleReport> obstacles;           ///< and of each obstacle
  std::vector<StartReport> starts;                 ///< of each charge, where the case starts by a remap
  std::vector<BodyReport> bodies;                  ///< those of the case, then the gas of each region
  Timings timings;
  /// Looks at the gas of a level after each of its steps, at a time [s]; null: nobody does. Steps of finer levels end
  /// within one of the whole.
  std::function<void(int level, double time)> look;

  [[nodiscard]] grid::Forest const& forest() const { return forest_; }
  /// Changes the blocks to the leaves of a forest, and all that follows them.
  void regrid(grid::Forest forest);

  /// Is the end time or the step limit reached, or have all bodies left the domain?
  [[nodiscard]] bool finished() const;
  /// Of a simulation of bodies alone: none of their particles is left.
  [[nodiscard]] bool bodies_have_left() const;
  /// Number of cells of the blocks that are awake.
  [[nodiscard]] long active_cells() const;
  /// Are there gas and particles?
  [[nodiscard]] bool coupled() const { return gas != nullptr && !regions.empty(); }
  /// Is a body the gas of a region?
  [[nodiscard]] bool is_gas(int body) const { return body >= static_cast<int>(setup.particles.bodies.size()); }
  [[nodiscard]] BodyPlace place_of(int body) const;
  /// What the particles of a body come to.
  [[nodiscard]] mpm::BodySums sums(int body) const;
  /// Of all regions.
  [[nodiscard]] long particle_count() const;
  /// What the particles of all regions have booked, in the order of the regions.
  [[nodiscard]] mpm::Accounts accounts() const;
};

/// Largest stable time step of the present state [s].
[[nodiscard]] double stable_step(System const& system);

/// One step n -> n+1, not beyond `latest` [s]. Returns dt. Throws NumericalError.
double advance(System& system, double latest);

}  // namespace brisance::run
