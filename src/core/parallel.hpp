/// Threads. This is the only interface to the threading runtime; `parallel.cpp` is the only file that names it.
#pragma once

#include <functional>

namespace brisance {

/// Number of threads that `parallel_for` uses from now on; 0 means all cores that the process may use.
void set_threads(int count);
[[nodiscard]] int threads();

/// Calls body(index, thread) once for every index in [0, count). The order and the distribution over threads are free,
/// so the body may write only what belongs to its index (or to its thread, as scratch that the result does not depend
/// on). An exception from a body is rethrown here after all others have ended.
void parallel_for(int count, std::function<void(int index, int thread)> const& body);

/// Lets the calling thread run on all cores that the process may use: a thread that one of `parallel_for` starts is
/// else bound to the same core where those are bound (OMP_PROC_BIND).
void use_all_cores();

/// Lets the floating-point unit treat subnormal numbers as zero on this thread while the guard lives: products of many
/// small fractions at a diffuse interface would otherwise run at a tenth of the speed.
class FlushSubnormals {
 public:
  FlushSubnormals();
  ~FlushSubnormals();
  FlushSubnormals(FlushSubnormals const&) = delete;
  FlushSubnormals& operator=(FlushSubnormals const&) = delete;

 private:
  unsigned saved_;
};

}  // namespace brisance
