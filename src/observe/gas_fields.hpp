/// The fields of the gas that a run can write. A field is one row of a table in gas_fields.cpp, which holds how it is
/// found: that is all it takes.
#pragma once

#include <string>
#include <vector>

#include "observe/field_info.hpp"

namespace brisance::run {
class System;
}

namespace brisance::observe {

class GasView;

/// All of them, in the order of the manual.
[[nodiscard]] std::vector<FieldInfo> const& known_fields();

/// Values of a field in one block: x fastest, components interleaved; `out` is resized. With a view of all cells those
/// that particles hold show the gas of the particles, and where there is none the ambient pressure and else 0. Throws
/// InputError for an unknown name.
void block_field(run::System const& system, int block, std::string const& field, std::vector<double>& out,
                 GasView const* view = nullptr);

}  // namespace brisance::observe
