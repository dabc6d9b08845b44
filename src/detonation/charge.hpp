/// Charges on the grid: which cells they fill, how the explosive burns.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "gas/gas.hpp"
#include "material/explosive.hpp"
#include "shape/shape.hpp"

namespace brisance::detonation {

struct InitiationPoint {
  Vec3 position{0.0, 0.0, 0.0};
  double delay = 0.0;  ///< [s]
};

/// The part of one charge that lies in the domain, cell by cell.
struct FilledCells {
  int level = 0;
  std::vector<Index3> cells;      ///< domain indices, all of one level
  std::vector<double> fractions;  ///< volume fraction of the charge in each, scaled to the specified mass
  double images = 1.0;            ///< how many times symmetry planes show this part
};

/// How many copies of the part in the domain make the whole body: 2 for every symmetry plane that cuts it. Throws
/// InputError when a symmetry plane cuts it off centre (it would overlap its own image) or when it reaches over another
/// boundary.
[[nodiscard]] double symmetry_images(shape::Shape const& shape, grid::Domain const& domain, std::string const& what);

/// Cells of a charge. The cells that it fills in part are scaled so that the volume in the domain times `images` is
/// `volume` exactly. Where obstacles are, `open` tells the part of a cell that they leave; fractions are of that part.
/// Solid cells, of which nothing is open, take nothing of the charge; those beside them take more. Throws InputError
/// where there is no room, or where cells of other levels are in the way.
[[nodiscard]] FilledCells fill_cells(shape::Shape const& shape, grid::Grid const& grid, double volume,
                                     std::string const& what,
                                     std::function<double(Index3 const&)> const& open = nullptr, int level = 0);

/// The level of the cells at the centre of a shape, where a charge lies.
[[nodiscard]] int level_of(shape::Shape const& shape, grid::Grid const& grid);

/// Fraction of each cell that charges have taken, by its level and its index in the domain.
using TakenCells = std::map<std::pair<int, Index3>, double>;

/// Puts products (unburnt or not: the same mass and energy) into the cells: partial density alpha rho0 and energy alpha
/// E0, at rest. What was in the cell before keeps its state in the rest of it. `taken` is what earlier charges left,
/// and is brought up to date. Throws InputError where charges overlap.
void place_charge(gas::Gas& gas, FilledCells const& filled, material::Explosive const& explosive, TakenCells& taken);

/// Lighting time of a point: the earliest arrival of a detonation wave from the initiation points, [Cui14] Sec. 4.1
/// [s].
[[nodiscard]] double lighting_time(Vec3 const& x, std::vector<InitiationPoint> const& points, double detonation_speed);

/// One charge as the burn sees it.
struct BurningCharge {
  shape::Shape shape;
  std::vector<InitiationPoint> initiation;
  material::Explosive explosive;
};

/// When the cells of the charges burn, level by level.
class BurnPlan {
 public:
  /// Gives the gas the lighting times of all cells that hold explosive and of those beside them, the end of the burn,
  /// and when each charge bursts: while it burns, and three times as long again while its products break out.
  BurnPlan(gas::Gas& gas, std::vector<BurningCharge> charges);
  ~BurnPlan();
  BurnPlan(BurnPlan const&) = delete;
  BurnPlan& operator=(BurnPlan const&) = delete;

  /// Gives blocks that are new their times.
  void set_times(gas::Gas& gas, std::vector<int> const& blocks);

 private:
  struct OfLevel;
  OfLevel const& of_level(grid::Grid const& grid, int level);
  std::vector<BurningCharge> charges_;
  std::vector<std::unique_ptr<OfLevel>> levels_;
};

/// The same of a charge that is all products from the start: it bursts as long as if it had burnt from its centre.
void expect_instantaneous_burst(gas::Gas& gas, shape::Shape const& shape, double detonation_speed);

}  // namespace brisance::detonation
