/// Contiguous doubles on a cache-line boundary, in large pages where the system has them.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>

namespace brisance {

class Buffer {
 public:
  Buffer() = default;
  /// `count` zeros.
  explicit Buffer(std::size_t count) : data_(allocate(count)), size_(count) {}
  [[nodiscard]] double* data() { return data_.get(); }
  [[nodiscard]] double const* data() const { return data_.get(); }
  [[nodiscard]] std::size_t size() const { return size_; }
  double& operator[](std::size_t i) { return data_.get()[i]; }
  double operator[](std::size_t i) const { return data_.get()[i]; }

 private:
  struct Free {
    void operator()(double* p) const { std::free(p); }
  };
  /// `count` zeros; null for none. Throws std::bad_alloc.
  [[nodiscard]] static double* allocate(std::size_t count);

  std::unique_ptr<double[], Free> data_;
  std::size_t size_ = 0;
};

}  // namespace brisance
