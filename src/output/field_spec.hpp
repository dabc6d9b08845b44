/// What dumps say of a field.
#pragma once

#include <string>

namespace brisance::output {

/// A field as it is written.
struct FieldSpec {
  std::string name;
  std::string unit;
  int components = 1;  ///< 1 or 3, of particles 6 too: symmetric tensors, xx yy zz xy yz zx
  std::string meaning;
};

}  // namespace brisance::output
