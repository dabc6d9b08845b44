#include "core/parallel.hpp"

#include <omp.h>
#include <sched.h>

#include <algorithm>
#include <exception>
#include <vector>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace brisance {

namespace {
int requested_threads = 0;
}

void set_threads(int count) { requested_threads = count; }

int threads() { return requested_threads > 0 ? requested_threads : omp_get_num_procs(); }

void parallel_for(int count, std::function<void(int, int)> const& body) {
  if (count <= 0) return;
  std::exception_ptr failure;
#pragma omp parallel num_threads(std::min(threads(), count)) if (count > 1)
  {
    FlushSubnormals const flush;
    int const thread = omp_get_thread_num();
#pragma omp for schedule(dynamic, 1)
    for (int index = 0; index < count; ++index) {
      try {
        body(index, thread);
      } catch (...) {
#pragma omp critical(brisance_parallel_failure)
        if (!failure) failure = std::current_exception();
      }
    }
  }
  if (failure) std::rethrow_exception(failure);
}

void use_all_cores() {
  int const places = omp_get_num_places();
  if (places == 0) return;  // nothing is bound
  cpu_set_t cores;
  CPU_ZERO(&cores);
  for (int place = 0; place < places; ++place) {
    std::vector<int> numbers(omp_get_place_num_procs(place));
    omp_get_place_proc_ids(place, numbers.data());
    for (int const core : numbers) CPU_SET(core, &cores);
  }
  sched_setaffinity(0, sizeof cores, &cores);  // where it fails, the thread stays where it is
}

#if defined(__SSE2__)
FlushSubnormals::FlushSubnormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040U); }
FlushSubnormals::~FlushSubnormals() { _mm_setcsr(saved_); }
#else
FlushSubnormals::FlushSubnormals() : saved_(0) {}
FlushSubnormals::~FlushSubnormals() { (void)saved_; }
#endif

}  // namespace brisance
