/// What the particles of a simulation come to, and where mass, momentum and energy went.
#pragma once

#include <array>

#include "core/archive.hpp"
#include "core/vec.hpp"
#include "grid/grid.hpp"
#include "material/primitive.hpp"

namespace brisance::mpm {

/// Sums over the particles of one body.
struct BodySums {
  long particles = 0;
  double mass = 0.0;  ///< [kg]
  /// Of it, of each fluid: gas. Each is summed by itself: of products and a little air the
  /// difference of two sums would lose three digits of the air.
  material::PerFluid fluid_mass{};
  Vec3 momentum{0.0, 0.0, 0.0};  ///< [kg m/s]
  Vec3 centre{0.0, 0.0, 0.0};    ///< of mass [m]
  double kinetic_energy = 0.0;   ///< [J]
  double internal_energy = 0.0;  ///< [J]
  /// Part of it that the next step puts the real work in the place of, of bodies that book the work of the nodes [J].
  /// Without it the energies are those of one time: velocities stand half a step before positions and stress.
  double provisional_energy = 0.0;
  double plastic_work = 0.0;          ///< [J]
  double largest_displacement = 0.0;  ///< [m]; of bodies that know their origin
  double damaged_mass = 0.0;          ///< mass with damage 1 [kg]

  /// Adds up; `centre` holds sums of mass times place until it is divided.
  BodySums& operator+=(BodySums const& other);
};

/// What left through free faces of the domain.
struct Losses {
  double mass = 0.0;
  Vec3 momentum{0.0, 0.0, 0.0};
  double energy = 0.0;
  long particles = 0;

  Losses& operator+=(Losses const& more) {
    mass += more.mass;
    momentum = momentum + more.momentum;
    energy += more.energy;
    particles += more.particles;
    return *this;
  }
};

/// Kinetic energy that particles lost, known where and why [J].
struct Dissipation {
  /// At nodes that constraints hold: what arrives there with another velocity takes theirs, a plastic impact.
  double constraints = 0.0;
  double filtered = 0.0;  ///< by the fraction of PIC, and by XPIC
  double apic = 0.0;      ///< by APIC in bodies whose heat it is not: solids, and fluids without B-splines
  double friction = 0.0;  ///< to the friction of contacts; it heats nothing
  double damping = 0.0;   ///< by `Options::damping`

  [[nodiscard]] double sum() const { return constraints + filtered + apic + friction + damping; }
  Dissipation& operator+=(Dissipation const& more) {
    constraints += more.constraints;
    filtered += more.filtered;
    apic += more.apic;
    friction += more.friction;
    damping += more.damping;
    return *this;
  }
};

/// What gave gas particles their least energy back. A gas that has less than that of no pressure pushes nothing any
/// more and never comes back: its energy is lifted to it, which adds energy, as the guards of the gas cells do.
struct FloorCount {
  double energy = 0.0;  ///< added [J]
  long particles = 0;   ///< lifted, each as often as it was

  FloorCount& operator+=(FloorCount const& more) {
    energy += more.energy;
    particles += more.particles;
    return *this;
  }
};

/// What `Body::shock_conduction` did: what some particles give others take.
struct ConductionCount {
  double moved = 0.0;  ///< heat that changed its particle [J]
  double made = 0.0;   ///< what was taken less what was given [J]: round-off

  ConductionCount& operator+=(ConductionCount const& more) {
    moved += more.moved;
    made += more.made;
    return *this;
  }
};

/// What was booked since the start.
struct Accounts {
  Losses losses;
  /// Momentum that constraints and rigid bodies gave to the particles [kg m/s].
  Vec3 constraint_impulse{0.0, 0.0, 0.0};
  /// Work that constraints, rigid bodies, surface pressures and the body force did on the particles [J].
  double outer_work = 0.0;
  Dissipation dissipation;    ///< what constrained nodes and filters took, of bodies with FLIP and XPIC
  FloorCount floored;         ///< energy that gas was given because it had less than none
  ConductionCount conducted;  ///< heat that went from points to others in shocks

  Accounts& operator+=(Accounts const& more) {
    losses += more.losses;
    constraint_impulse = constraint_impulse + more.constraint_impulse;
    outer_work += more.outer_work;
    dissipation += more.dissipation;
    floored += more.floored;
    conducted += more.conducted;
    return *this;
  }
};

/// What proxy particles gave to a node in a step, in the directions of the axes: what they lost of it themselves,
/// forces included. Summed over all nodes it is what the other particles gained. The part of the reference pressure is
/// left out.
struct NodeGift {
  Index3 node{0, 0, 0};          ///< of the grid
  Vec3 impulse{0.0, 0.0, 0.0};   ///< by their forces [kg m/s]
  Vec3 work{0.0, 0.0, 0.0};      ///< of these [J]
  Vec3 momentum{0.0, 0.0, 0.0};  ///< that the others took from theirs at the node's new velocity [kg m/s]
  double energy = 0.0;           ///< kinetic, likewise [J]
};

/// Where a particle is kept.
struct Place {
  int block = -1;
  int index = -1;
};

void archive(Archive& a, BodySums& sums);

}  // namespace brisance::mpm
