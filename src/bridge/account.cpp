#include "bridge/account.hpp"

namespace brisance::bridge {

// Not inline: whether the compiler rounds between multiplication and addition depends on the code around. Here every
// sum is rounded alike, wherever it is taken.
void Account::add(Account const& other, double factor) {
  for (int f = 0; f < 2; ++f) mass[f] += factor * other.mass[f];
  for (int d = 0; d < 3; ++d) momentum[d] += factor * other.momentum[d];
  energy += factor * other.energy;
  volume += factor * other.volume;
}

}  // namespace brisance::bridge
