/// Material points: the state they carry, and how they are kept: per block and body one array for each field.
#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "core/buffer.hpp"
#include "core/vec.hpp"
#include "material/material.hpp"

namespace brisance {
class Archive;
}

namespace brisance::mpm {

/// Everything that a particle may carry. Vectors and tensors take consecutive fields.
enum class Field : int {
  position_x,  ///< [m], 3
  position_y,
  position_z,
  velocity_x,  ///< [m/s], 3
  velocity_y,
  velocity_z,
  mass,         ///< [kg]
  density,      ///< [kg/m3]
  pressure,     ///< of the equation of state [Pa]
  viscosity,    ///< bulk viscosity q [Pa]
  energy,       ///< specific internal energy [J/kg]
  provisional,  ///< part of it that the next step replaces: fluids, see `NodeWork::settle_work` [J/kg]
  identity,     ///< number of the particle, counted from 0 in the order of creation
  move_x,       ///< displacement of the present step [m], 3
  move_y,
  move_z,
  deviator_xx,  ///< deviator of the Cauchy stress [Pa], 6: xx yy zz xy yz zx
  deviator_yy,
  deviator_zz,
  deviator_xy,
  deviator_yz,
  deviator_zx,
  plastic_strain,
  plastic_work,  ///< [J/kg]
  temperature,   ///< [K]
  damage,
  crushing,         ///< concrete: damage by compression and shear, see `material::ParticleArrays`
  cracking,         ///< concrete: damage by tension
  compression,      ///< concrete: largest rho/rho0 - 1 so far
  mass_fraction,    ///< of the second fluid: gas
  volume_fraction,  ///< of the second fluid: gas
  lighting_time,    ///< when the detonation arrives [s]
  half_x,           ///< half the particle's lengths [m], 3: cpGIMP
  half_y,
  half_z,
  affine_xx,  ///< velocity gradient of APIC [1/s], 9, row by row
  affine_xy,
  affine_xz,
  affine_yx,
  affine_yy,
  affine_yz,
  affine_zx,
  affine_zy,
  affine_zz,
  cross_xy,  ///< mixed second derivatives of the velocity times h [1/s], 3 components each: APIC in fluids, [Fu17]
  cross_xy_y,
  cross_xy_z,
  cross_yz,
  cross_yz_y,
  cross_yz_z,
  cross_zx,
  cross_zx_y,
  cross_zx_z,
  filtered_x,  ///< velocity that XPIC takes away [m/s], 3
  filtered_y,
  filtered_z,
  load_x,  ///< outer force of a unit of surface pressure per volume [1/m], 3
  load_y,
  load_z,
  load_number,   ///< of the surface pressure that acts on the particle; 0: none
  bar_number,    ///< of the bar of the body that runs through the particle, from 1; 0: none
  bar_fraction,  ///< fraction of steel
  bar_x,         ///< its direction, 3
  bar_y,
  bar_z,
  bar_stress,          ///< [Pa]
  bar_plastic_strain,  ///< accumulated
  next_x,              ///< velocity at the end of the step, of proxy particles [m/s], 3
  next_y,
  next_z,
  origin_x,  ///< where the particle was at the start [m], 3
  origin_y,
  origin_z,
  count
};

inline constexpr int field_count = static_cast<int>(Field::count);

using brisance::operator+;  // that of vectors, which the next one would hide
[[nodiscard]] constexpr Field operator+(Field f, int d) { return static_cast<Field>(static_cast<int>(f) + d); }

/// What becomes of a field where two particles become one.
enum class Merge {
  by_mass,    ///< the mean of both
  by_volume,  ///< likewise
  largest,
  own,  ///< the sum, or what follows from others: whoever merges knows
};

/// Which components change their sign where a particle becomes its mirror image across a plane normal to a direction.
enum class Mirror {
  none,      ///< none of them: scalars, and places, which follow from the plane
  vector,    ///< the one along the normal
  tensor,    ///< symmetric, xx yy zz xy yz zx: the shears with the normal
  gradient,  ///< of a vector, row by row: the shears with the normal
  cross,  ///< mixed second derivatives of a vector, by pairs xy yz zx: turned by the pair, by the component or by both
};

/// A scalar, vector or tensor among the fields: its components follow each other.
struct Quantity {
  Field first;
  int components;
  char const* name;
  char const* unit;
  Mirror mirror;
  Merge merge;
};

/// All of them, in the order of `Field`. A new field has a row here and nowhere else.
inline constexpr std::array quantities{
    Quantity{Field::position_x, 3, "position", "m", Mirror::none, Merge::by_mass},
    Quantity{Field::velocity_x, 3, "velocity", "m/s", Mirror::vector, Merge::by_mass},
    Quantity{Field::mass, 1, "mass", "kg", Mirror::none, Merge::own},
    Quantity{Field::density, 1, "density", "kg/m3", Mirror::none, Merge::own},
    Quantity{Field::pressure, 1, "pressure", "Pa", Mirror::none, Merge::by_volume},
    Quantity{Field::viscosity, 1, "viscosity", "Pa", Mirror::none, Merge::by_volume},
    Quantity{Field::energy, 1, "energy", "J/kg", Mirror::none, Merge::by_mass},
    Quantity{Field::provisional, 1, "provisional_energy", "J/kg", Mirror::none, Merge::by_mass},
    Quantity{Field::identity, 1, "identity", "1", Mirror::none, Merge::own},
    Quantity{Field::move_x, 3, "move", "m", Mirror::none, Merge::by_mass},
    Quantity{Field::deviator_xx, 6, "deviator", "Pa", Mirror::tensor, Merge::by_mass},
    Quantity{Field::plastic_strain, 1, "plastic_strain", "1", Mirror::none, Merge::by_mass},
    Quantity{Field::plastic_work, 1, "plastic_work", "J/kg", Mirror::none, Merge::by_mass},
    Quantity{Field::temperature, 1, "temperature", "K", Mirror::none, Merge::by_mass},
    Quantity{Field::damage, 1, "damage", "1", Mirror::none, Merge::by_mass},
    Quantity{Field::crushing, 1, "compression_damage", "1", Mirror::none, Merge::by_mass},
    Quantity{Field::cracking, 1, "tensile_damage", "1", Mirror::none, Merge::by_mass},
    Quantity{Field::compression, 1, "compression", "1", Mirror::none, Merge::by_mass},
    Quantity{Field::mass_fraction, 1, "mass_fraction", "1", Mirror::none, Merge::by_mass},
    Quantity{Field::volume_fraction, 1, "volume_fraction", "1", Mirror::none, Merge::by_volume},
    Quantity{Field::lighting_time, 1, "lighting_time", "s", Mirror::none, Merge::largest},
    Quantity{Field::half_x, 3, "half_lengths", "m", Mirror::none, Merge::own},
    Quantity{Field::affine_xx, 9, "velocity_gradient", "1/s", Mirror::gradient, Merge::by_mass},
    Quantity{Field::cross_xy, 9, "cross_derivatives", "1/s", Mirror::cross, Merge::by_mass},
    Quantity{Field::filtered_x, 3, "filtered_velocity", "m/s", Mirror::vector, Merge::by_mass},
    Quantity{Field::load_x, 3, "load", "1/m", Mirror::vector, Merge::by_mass},
    Quantity{Field::load_number, 1, "load_number", "1", Mirror::none, Merge::by_mass},
    Quantity{Field::bar_number, 1, "bar_number", "1", Mirror::none, Merge::by_mass},
    Quantity{Field::bar_fraction, 1, "bar_fraction", "1", Mirror::none, Merge::by_mass},
    Quantity{Field::bar_x, 3, "bar_direction", "1", Mirror::vector, Merge::by_mass},
    Quantity{Field::bar_stress, 1, "bar_stress", "Pa", Mirror::none, Merge::by_mass},
    Quantity{Field::bar_plastic_strain, 1, "bar_plastic_strain", "1", Mirror::none, Merge::by_mass},
    Quantity{Field::next_x, 3, "next_velocity", "m/s", Mirror::vector, Merge::by_mass},
    Quantity{Field::origin_x, 3, "origin", "m", Mirror::none, Merge::by_mass},
};

/// The row that begins with a field.
[[nodiscard]] constexpr Quantity const& quantity_of(Field first) {
  for (Quantity const& q : quantities) {
    if (q.first == first) return q;
  }
  throw std::invalid_argument("no quantity begins with this field");
}

/// Does component c of a quantity change its sign in a mirror normal to direction d?
[[nodiscard]] constexpr bool turns(Mirror mirror, int c, int d) {
  switch (mirror) {
    case Mirror::none: return false;
    case Mirror::vector: return c == d;
    case Mirror::tensor: return c >= 3 && (c - 3 == d || (c - 2) % 3 == d);  // xy, yz, zx
    case Mirror::gradient: return (c / 3 == d) != (c % 3 == d);
    case Mirror::cross: return (c / 3 == d || (c / 3 + 1) % 3 == d) != (c % 3 == d);
  }
  return false;
}

/// Do the rows follow each other without a gap up to the last field?
[[nodiscard]] constexpr bool complete() {
  Field next{};
  for (Quantity const& q : quantities) {
    if (q.first != next) return false;
    next = next + q.components;
  }
  return next == Field::count;
}
static_assert(complete(), "every field belongs to a row of `quantities`, in the order of `Field`");

/// Which fields the particles of a body carry.
class FieldList {
 public:
  /// Adds a quantity with all its components, or the first few of them.
  void add(Field first, int components = 0) {
    if (components == 0) components = quantity_of(first).components;
    for (int c = 0; c < components; ++c) {
      if (slots_[static_cast<int>(first) + c] < 0) slots_[static_cast<int>(first) + c] = size_++;
    }
  }
  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] int slot(Field f) const { return slots_[static_cast<int>(f)]; }  ///< -1: not carried
  [[nodiscard]] bool has(Field f) const { return slot(f) >= 0; }

 private:
  std::array<int, field_count> slots_ = [] {
    std::array<int, field_count> none{};
    none.fill(-1);
    return none;
  }();
  int size_ = 0;
};

/// The particles of one body in one block: field by field, each field contiguous.
class ParticleSet {
 public:
  ParticleSet() = default;
  explicit ParticleSet(FieldList const& fields) : fields_(fields) {}

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] FieldList const& fields() const { return fields_; }
  /// The values of a field, or null where the particles do not carry it.
  [[nodiscard]] double* field(Field f) {
    int const slot = fields_.slot(f);
    return slot < 0 ? nullptr : data_.data() + static_cast<std::size_t>(slot) * capacity_;
  }
  [[nodiscard]] double const* field(Field f) const { return const_cast<ParticleSet*>(this)->field(f); }

  /// Appends a particle whose fields are all 0 and returns its index.
  int append();
  /// Appends a copy of a particle of another set with the same fields.
  void append(ParticleSet const& from, int index);
  /// Puts the particles into the given order, which may leave some out.
  void reorder(std::vector<int> const& order);
  [[nodiscard]] std::size_t bytes() const { return data_.size() * sizeof(double); }
  void archive(Archive& a);  ///< in a checkpoint, see state.cpp

 private:
  void reserve(std::size_t wanted);

  FieldList fields_;
  Buffer data_;
  std::size_t capacity_ = 0;
  int size_ = 0;
};

/// Kinetic energy per mass [J/kg] of APIC's velocity gradient C and of the mixed second derivatives B within a
/// particle, with the second moment h^2/4 of quadratic B-splines: h^2/8 C:C + h^4/32 B:B.
[[nodiscard]] double affine_energy(ParticleSet const& set, int particle, double h);

}  // namespace brisance::mpm
