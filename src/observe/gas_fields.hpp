/// The fields of the gas that a run can write. A field is one row of a table in gas_fields.cpp, which holds how it is
/// found: that is all it takes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "grid/cell.hpp"
#include "material/primitive.hpp"
#include "observe/field_info.hpp"

namespace brisance::run {
class System;
}

namespace brisance::observe {

class GasView;

/// All of them, in the order of the manual.
[[nodiscard]] std::vector<FieldInfo> const& known_fields();

struct GasField;
struct CellOf;

/// Values of some fields, cell by cell: the gas of a cell is looked up once for all of them. With a view of all cells
/// those that particles hold show the gas of the particles, and where there is none the ambient pressure and else 0.
class FieldValues {
 public:
  /// Keeps references. Throws InputError for an unknown name.
  FieldValues(run::System const& system, std::vector<std::string> const& fields, GasView const* view = nullptr);

  /// Numbers per cell: one for each component.
  [[nodiscard]] int components() const { return components_; }
  /// Those of a cell, field by field. May be called from several threads.
  void at(grid::Cell const& cell, double* out) const;
  /// Those of `count` cells of a block, from `first` on along x.
  void row(grid::Cell const& first, int count, double* out) const;

 private:
  /// Writes the fields of a cell whose gas is known.
  void put(CellOf const& cell, std::optional<material::Primitive> const& gas, double* out) const;

  run::System const* system_;
  GasView const* view_;
  std::vector<GasField const*> fields_;
  int components_ = 0;
  bool need_gas_ = false;
};

/// Values of a field in one block: x fastest, components interleaved; `out` is resized. See `FieldValues`.
void block_field(run::System const& system, int block, std::string const& field, std::vector<double>& out,
                 GasView const* view = nullptr);

}  // namespace brisance::observe
