#include "run/system.hpp"

#include "core/reduce.hpp"

namespace brisance::run {

System::System(Case c)
    : grid_(std::make_unique<grid::Grid const>(c.domain, c.numerics.block_cells)), setup(std::move(c)), grid(*grid_) {}

System::System(System&&) noexcept = default;

System::~System() = default;

bool System::finished() const {
  bool const time_over = clock.time >= setup.end.time * (1.0 - 1e-12);
  return time_over || (setup.end.steps > 0 && clock.step >= setup.end.steps) || bodies_have_left();
}

bool System::bodies_have_left() const { return gas == nullptr && mpm::particle_count(*particles) == 0; }

long System::active_cells() const {
  if (gas == nullptr) return 0;
  return sum_at_hand(grid.block_count(),
                     [&](int b) { return gas->awake(b) ? static_cast<long>(grid.blocks()[b].cell_count()) : 0L; });
}

}  // namespace brisance::run
