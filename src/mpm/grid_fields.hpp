/// The fields of the grid: which bodies share one, and what fields that meet in a node do to each other.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "grid/grid.hpp"
#include "mpm/model.hpp"

namespace brisance::mpm {

/// Law between two grid fields.
struct Law {
  enum class Kind {
    glued,    ///< one velocity
    contact,  ///< they part and slide
    slips,    ///< one velocity across the surface of that which does not slip
  };
  Kind kind = Kind::glued;
  double friction = 0.0;
};

/// A node whose velocity is prescribed.
struct ConstrainedNode {
  int node = 0;
  int field = -1;  ///< grid field; -1: all
  std::array<bool, 3> components{true, true, true};
  Vec3 velocity{0.0, 0.0, 0.0};
  int driver = -1;  ///< number of the history that the velocity follows; -1: none
};

/// Bodies with a contact and rigid bodies have grid fields of their own, fluids that slip have one in common; all
/// others share the first. Rigid bodies that move alike and have the same contacts are one: where they touch, their
/// faces are no surface.
struct GridFields {
  int fields = 1;
  std::vector<int> field_of;               ///< body -> grid field
  std::vector<std::optional<Vec3>> rigid;  ///< velocity of rigid grid fields
  std::vector<Law> laws;                   ///< field x field
  std::vector<char> slips;                 ///< per field: of the bodies that slip
  std::vector<char> parts;                 ///< per field: parts from some other
  std::vector<char> one_sided;             ///< per field: its bodies are free to leave walls
  std::vector<char> affine;                ///< per field: some body has APIC
  std::vector<char> shared;                ///< per field: and some has not
  std::vector<char> heats;                 ///< per field: what APIC loses is heat, see `BodyRules::keeps_energy`
  std::vector<char> early;                 ///< per field: all bodies are updated by USL
  int filling = -1;                        ///< field of a body that fills space; -1: none

  // What some field or body needs of a step.
  bool contact = false;        ///< more than one field
  bool slides = false;         ///< some fields slip along others
  bool touches = false;        ///< some fields part and slide
  bool pushes = false;         ///< some bodies are rigid: somebody wants to know what they give
  bool stops = false;          ///< there are walls, and fields free to leave them
  bool filters = false;        ///< some body uses XPIC
  bool maps_back = false;      ///< some body is updated by MUSL
  bool strains_early = false;  ///< some body is updated by USL
  bool conducts = false;       ///< some body conducts heat in shocks
  bool books_work = false;     ///< some body does, see `BodyRules`
  bool keeps_energy = false;   ///< some body's transfer loses no energy
  bool counts_energy = false;  ///< some body has APIC

  /// Do all particles of a field take over the nodes' velocity, and is what they lose by that counted, and no heat?
  [[nodiscard]] bool taken_over(int field) const {
    return affine[field] != 0 && shared[field] == 0 && heats[field] == 0;
  }
  [[nodiscard]] bool slips_along(int fluid, int body) const {
    return laws[fluid * fields + body].kind == Law::Kind::slips && slips[fluid] != 0;
  }
  /// Constraints hold bodies; what slips along these need not be constrained.
  [[nodiscard]] bool constrains(int field, ConstrainedNode const& constrained) const {
    return constrained.field < 0 ? slips[field] == 0 : constrained.field == field;
  }
};

/// Throws InputError where a contact does not join two different bodies.
[[nodiscard]] GridFields make_grid_fields(grid::Domain const& domain, Options const& options,
                                          std::vector<Body> const& bodies, std::vector<BodyRules> const& rules,
                                          std::vector<Contact> const& contacts);

}  // namespace brisance::mpm
