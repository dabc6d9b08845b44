/// Bodies that stand at the start under the weight of what is above them.
#pragma once

#include <array>
#include <map>
#include <vector>

#include "case/case.hpp"

namespace brisance::setup {

/// State of a place in a body under its overburden.
struct GravityState {
  double density = 0.0;              ///< [kg/m3]
  double specific_energy = 0.0;      ///< [J/kg]
  std::array<double, 6> deviator{};  ///< of the stress [Pa]
};

/// The weight above places of a case: integrals of rho g along the verticals, from the top of the domain down, over all
/// bodies that stand on each other, those with `lateral_stress` as dense as their weight makes them.
class Overburden {
 public:
  /// `cells`: the domain with the cells that the particles see. Throws InputError where the body force points along no
  /// axis.
  Overburden(Case const& setup, grid::Domain const& cells);

  /// Vertical stress [Pa] at a place of a body.
  [[nodiscard]] double at(Vec3 const& x);
  /// The state of a body's material under a vertical stress [Pa].
  [[nodiscard]] GravityState state(Body const& body, double vertical) const;
  /// Largest vertical stress in a body [Pa], over verticals at most `stride` cells apart.
  [[nodiscard]] double largest(Body const& body, int stride);

 private:
  using Sequence = std::vector<signed char>;  ///< body at each sample of a vertical, -1: none

  [[nodiscard]] Sequence sequence(Vec3 const& x) const;
  /// Vertical stress at the ends of the samples, from the top.
  [[nodiscard]] std::vector<double> const& profile(Sequence const& bodies);
  [[nodiscard]] double density(int body, double vertical) const;

  Case const* setup_;
  int axis_ = 0;           ///< direction of gravity
  double g_ = 0.0;         ///< its size [m/s2]
  bool downwards_ = true;  ///< towards the low side
  int samples_ = 0;        ///< along a vertical
  double spacing_ = 0.0;   ///< of them [m]
  std::map<Sequence, std::vector<double>> profiles_;
  std::map<std::pair<double, double>, std::vector<double> const*> verticals_;  ///< by their place
};

/// Does the material bear its state without yielding?
[[nodiscard]] bool bears(material::Material const& solid, GravityState const& state);

}  // namespace brisance::setup
