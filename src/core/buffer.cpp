#include "core/buffer.hpp"

#include <malloc.h>
#include <sys/mman.h>

#include <cstdint>
#include <cstring>
#include <new>

namespace brisance {

namespace {

constexpr std::size_t large_page = std::size_t{1} << 21;
constexpr std::size_t many = std::size_t{1} << 19;  ///< bytes: neighbours share large pages
constexpr std::size_t most = 8 << 20;               ///< bytes: what is larger has pages of its own
constexpr std::size_t ahead = 2 * most;             ///< bytes by which the heap grows

/// Lets large allocations stand side by side on the heap, so that one's last large page is the first of the next: each
/// by itself would fill its last one by half, on the average.
void join_allocations() {
#ifdef M_MMAP_THRESHOLD
  mallopt(M_MMAP_THRESHOLD, static_cast<int>(most));
  mallopt(M_TOP_PAD, static_cast<int>(ahead));
  mallopt(M_TRIM_THRESHOLD, static_cast<int>(2 * ahead));
#endif
}

/// Asks for large pages, also behind the data, where the heap writes first what is left of it. A sweep along z reads
/// every line of cells from another page of 4 KiB, and the processor does not know the places of that many. A system
/// that has no large pages says so, and nothing is lost.
void advise([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  std::size_t const before = reinterpret_cast<std::uintptr_t>(begin) % large_page;
  std::size_t const behind = bytes < most ? ahead : 0;
  std::size_t const length = (before + bytes + behind) / large_page * large_page;
  if (length > 0) static_cast<void>(madvise(static_cast<char*>(begin) - before, length, MADV_HUGEPAGE));
#endif
}

}  // namespace

double* Buffer::allocate(std::size_t count) {
  if (count == 0) return nullptr;
  constexpr std::size_t line = 64;
  std::size_t const bytes = (count * sizeof(double) + line - 1) / line * line;
  bool const is_large = bytes >= many;
  if (is_large) {
    static bool const joined = (join_allocations(), true);
    static_cast<void>(joined);
  }
  void* const data = std::aligned_alloc(line, bytes);
  if (data == nullptr) throw std::bad_alloc();
  if (is_large) advise(data, bytes);
  std::memset(data, 0, bytes);
  return static_cast<double*>(data);
}

}  // namespace brisance
