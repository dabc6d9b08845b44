/// JSON has no infinity and no NaN: such values, and absent ones, are null.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace brisance::output {

[[nodiscard]] inline nlohmann::json json_or_null(std::optional<double> value) {
  if (!value || !std::isfinite(*value)) return nullptr;
  return *value;
}

}  // namespace brisance::output
