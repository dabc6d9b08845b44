/// No failure.
#pragma once

#include <array>

#include "core/parameter.hpp"

namespace brisance::material {

struct NoFailure {
  static constexpr char const* name = "none";
  static constexpr bool damages = false;
  static constexpr auto parameters() { return std::array<Parameter<NoFailure>, 0>{}; }
};

}  // namespace brisance::material
