#include "run/system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/reduce.hpp"
#include "grid/partition.hpp"

namespace brisance::run {

namespace {

grid::Forest forest_of(Case const& c, grid::Grid const& grid) {
  Index3 parts{1, 1, 1};
  for (int d = 0; d < c.domain.dimensions(); ++d)
    parts[d] = (c.domain.cells[d] + grid.block_size()[d] - 1) / grid.block_size()[d];
  return {parts, c.domain.dimensions(), grid::periodic_directions(c.domain)};
}

}  // namespace

System::System(Case c)
    : grid_(std::make_unique<grid::Grid>(c.domain, c.numerics.block_cells)),
      forest_(forest_of(c, *grid_)),
      setup(std::move(c)),
      grid(*grid_) {}

System::System(Case c, grid::Forest forest)
    : grid_(std::make_unique<grid::Grid>(c.domain, grid::refinable_partition_of(c.domain, c.numerics.block_cells).size,
                                         forest)),
      forest_(std::move(forest)),
      setup(std::move(c)),
      grid(*grid_) {}

void System::regrid(grid::Forest forest) {
  gas->regrid(*grid_, forest, [this](std::vector<int> const& new_blocks) { adaptation->furnish(*gas, new_blocks); });
  forest_ = std::move(forest);
  for (Region& region : regions) region.bridge->follow_blocks();
}

System::System(System&&) noexcept = default;

System::~System() = default;

bool System::finished() const {
  bool const time_over = clock.time >= setup.end.time * (1.0 - 1e-12);
  return time_over || (setup.end.steps > 0 && clock.step >= setup.end.steps) || bodies_have_left();
}

bool System::bodies_have_left() const { return gas == nullptr && particle_count() == 0; }

BodyPlace System::place_of(int body) const {
  for (std::size_t r = 0; r < regions.size(); ++r) {
    auto const found = std::ranges::find(regions[r].bodies, body);
    if (found != regions[r].bodies.end()) return {r, static_cast<int>(found - regions[r].bodies.begin())};
  }
  throw std::logic_error(fmt::format("there is no body {}", body));
}

mpm::BodySums System::sums(int body) const {
  BodyPlace const place = place_of(body);
  return mpm::sums(*regions[place.region].particles, place.body);
}

long System::particle_count() const {
  long count = 0;
  for (Region const& region : regions) count += mpm::particle_count(*region.particles);
  return count;
}

mpm::Accounts System::accounts() const {
  if (regions.empty()) return {};
  mpm::Accounts sum = regions.front().particles->accounts();
  for (std::size_t r = 1; r < regions.size(); ++r) sum += regions[r].particles->accounts();
  return sum;
}

long System::active_cells() const {
  if (gas == nullptr) return 0;
  return sum_at_hand(grid.block_count(),
                     [&](int b) { return gas->awake(b) ? static_cast<long>(grid.blocks()[b].cell_count()) : 0L; });
}

}  // namespace brisance::run
