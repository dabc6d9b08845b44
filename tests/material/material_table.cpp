/// Prints the Chapman-Jouguet table of docs/materials.md.
#include <cstdio>

#include "material_files.hpp"

int main() {
  for (auto const& line : brisance::test::chapman_jouguet_table(brisance::test::read_material_files().explosives)) {
    std::puts(line.c_str());
  }
}
