/// Constraints whose velocity follows a history.
#include <algorithm>

#include "core/parallel.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

double MotionHistory::way(double from, double to) const {
  double const first = displacement ? 0.0 : values.front();
  double const last = displacement ? 0.0 : values.back();
  double sum = first * std::max(0.0, std::min(to, times.front()) - from);
  auto const next = std::upper_bound(times.begin(), times.end(), from);
  for (auto n = static_cast<std::size_t>(next - times.begin()); n < times.size() && (n == 0 || times[n - 1] < to);
       ++n) {
    if (n == 0) continue;
    double const begin = std::max(from, times[n - 1]);
    double const end = std::min(to, times[n]);
    double const slope = (values[n] - values[n - 1]) / (times[n] - times[n - 1]);
    sum += (end - begin) * (displacement ? slope : values[n - 1] + slope * (0.5 * (begin + end) - times[n - 1]));
  }
  return sum + last * std::max(0.0, to - std::max(from, times.back()));
}

void Mpm::prescribe(double dt) {
  Workspace& w = *work_;
  std::vector<Vec3> velocities(w.drivers.size(), Vec3{0.0, 0.0, 0.0});
  bool released = false;
  for (std::size_t n = 0; n < w.drivers.size(); ++n) {
    Driver& driver = w.drivers[n];
    if (driver.released) continue;
    driver.released = driver.history.over(time_);
    released = released || driver.released;
    velocities[n] = (driver.history.way(time_, time_ + dt) / dt) * driver.direction;
  }
  if (w.drivers.empty()) return;
  parallel_for(grid_.block_count(), [&](int block, int) {
    std::vector<ConstrainedNode>& nodes = w.constrained_nodes[block];
    if (released) {
      std::erase_if(nodes, [&](ConstrainedNode const& at) {
        return at.driver >= 0 && w.drivers[static_cast<std::size_t>(at.driver)].released;
      });
      std::vector<char>& marks = w.is_constrained[block];
      std::fill(marks.begin(), marks.end(), 0);
      for (std::size_t n = 0; !marks.empty() && n < nodes.size(); ++n) marks[nodes[n].node] = 1;
    }
    for (ConstrainedNode& at : nodes) {
      if (at.driver >= 0) at.velocity = velocities[static_cast<std::size_t>(at.driver)];
    }
  });
}

}  // namespace brisance::mpm
