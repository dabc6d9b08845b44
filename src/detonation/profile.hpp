/// The profile of a burst: what a simulation with fewer directions left of it at one moment, as the cells of that
/// simulation hold it. A later simulation begins with it, [Cui14] Sec. 4.1.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "detonation/charge.hpp"
#include "gas/gas.hpp"

namespace brisance {
class Archive;
}

namespace brisance::detonation {

/// A number that two simulations must share before one can go on with the other's profile.
struct Constant {
  std::string name;  ///< e.g. "jwl.A"
  double value = 0.0;
};

/// The charge that burst. Its initiation points are relative to its centre.
struct BurstCharge {
  std::string explosive;
  std::string shape;    ///< "sphere" or "cylinder"
  double mass = 0.0;    ///< of the whole body, mirror images included [kg]; of a cylinder in the plane [kg/m]
  double radius = 0.0;  ///< [m]
  double length = 0.0;  ///< of a cylinder of finite length [m]
  std::vector<InitiationPoint> initiation;
};

struct Profile {
  /// The cells that the burst has reached; the centre of the charge is the origin. x is the radius, in `axisymmetric2d`
  /// y the axis. The spherical and cylindrical ones begin at radius 0.
  grid::Domain domain;
  double time = 0.0;             ///< since the start of the simulation [s]
  int components = 0;            ///< conserved components, in the order of gas/layout.hpp
  std::vector<double> state;     ///< per component and cell, x fastest; the momentum along x is the radial one
  std::vector<double> pressure;  ///< per cell [Pa]
  std::vector<double> ambient;   ///< components of the gas around
  double ambient_pressure = 0.0;
  /// Is the low face of the axis a mirror of the burst? Without it nothing has reached that face.
  bool mirrored = false;
  BurstCharge charge;
  std::vector<Constant> constants;  ///< of the explosive, its products and the ambient fluid

  [[nodiscard]] std::size_t cell_count() const { return static_cast<std::size_t>(domain.cell_count()); }
  [[nodiscard]] double const* component(int c) const {
    return state.data() + static_cast<std::size_t>(c) * cell_count();
  }
  /// Radius of the smallest ball, or cylinder in the plane, around the charge's centre that holds the burst [m].
  [[nodiscard]] double reach() const;
  /// Integral of a component over the cells, in the units of `Metric::cell_volume`.
  [[nodiscard]] double sum(int component) const;

  void archive(Archive& a);
};

/// The explosive, its products and the ambient gas as a list of constants.
[[nodiscard]] std::vector<Constant> constants_of(material::Explosive const& explosive, gas::Fluids const& fluids,
                                                 gas::Primitive const& ambient);

/// The part of a simulation that differs from its ambient state. `centre` is that of the charge. The charge and the
/// constants are left to the caller. Throws InputError where the burst has reached a face of the domain that is no
/// mirror, or where explosive still burns.
[[nodiscard]] Profile profile_of(gas::Gas const& gas, gas::Primitive const& ambient, Vec3 const& centre, double time);

/// The burst of a charge of another mass, [Hopkinson15]: lengths and times change by the cube root of the ratio of the
/// masses (by the square root in the plane), states stay.
[[nodiscard]] Profile scaled(Profile profile, double mass);

/// A spherical or cylindrical profile in shells that are so many times as thick: what a shell holds is the sum of what
/// its parts hold, its pressure their mean. The last shell may reach beyond the burst, into ambient gas.
[[nodiscard]] Profile merged(Profile const& profile, int together);

}  // namespace brisance::detonation
