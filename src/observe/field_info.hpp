/// What is told of a field that a run can write.
#pragma once

#include <string>

namespace brisance::observe {

/// A field that can be written: `block_field` or `point_field` fills it.
struct FieldInfo {
  std::string name;  ///< as named in decks, e.g. "pressure"
  std::string unit;  ///< "Pa"
  int components;    ///< 1, 3, or 6: symmetric tensors, xx yy zz xy yz zx
  std::string meaning;
};

}  // namespace brisance::observe
