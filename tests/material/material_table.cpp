/// Prints the tables of docs/materials.md: explosives with their Chapman-Jouguet states, then solids.
#include <cstdio>

#include "material_files.hpp"

int main() {
  auto const files = brisance::test::read_material_files();
  for (auto const& line : brisance::test::chapman_jouguet_table(files.explosives)) std::puts(line.c_str());
  for (auto const& line : brisance::test::solid_table(files.solids)) std::puts(line.c_str());
}
