/// The material files as the build embedded them.
#pragma once

#include <string_view>
#include <vector>

namespace brisance::deck {

struct EmbeddedFile {
  std::string_view name;  ///< "materials/tnt.toml"
  std::string_view text;
};

[[nodiscard]] std::vector<EmbeddedFile> const& embedded_materials();

}  // namespace brisance::deck
