/// What is written of the material points.
#pragma once

#include <string>
#include <vector>

#include "mpm/mpm.hpp"
#include "observe/field_info.hpp"

namespace brisance::run {
class System;
}

namespace brisance::observe {

/// The fields of the particles that a deck may ask for, components 1, 3 or 6.
[[nodiscard]] std::vector<FieldInfo> const& known_particle_fields();

/// What every dump holds beside the specified fields: position, body (its number in the deck, from 0) and material
/// (number of the first body of the same material).
[[nodiscard]] std::vector<FieldInfo> const& standing_particle_fields();

/// Number of particles that are dumped: of all bodies, or of all but the gas.
[[nodiscard]] long dumped_particles(run::System const& system);

/// Values of a field of either list at all particles that are dumped, components interleaved: region by region, block
/// by block, within a block body by body. A field that a body does not carry is 0 there. `out` is resized. Throws
/// InputError for an unknown name.
void particle_field(run::System const& system, std::string const& name, std::vector<double>& out);

/// Equivalent stress (von Mises) of one particle [Pa]; 0 without a deviator.
[[nodiscard]] double mises_of(mpm::ParticleSet const& set, int particle);

}  // namespace brisance::observe
