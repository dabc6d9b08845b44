#include "material/amounts.hpp"

namespace brisance::material {

// Not inline: whether the compiler rounds between multiplication and addition depends on the code around. Here every
// sum is rounded alike, wherever it is taken.
void Amounts::add(Amounts const& other, double factor) {
  for (int k = 0; k < most_fluids; ++k) mass[k] += factor * other.mass[k];
  for (int d = 0; d < 3; ++d) momentum[d] += factor * other.momentum[d];
  energy += factor * other.energy;
  volume += factor * other.volume;
}

}  // namespace brisance::material
