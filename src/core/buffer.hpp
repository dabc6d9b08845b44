/// Contiguous doubles on a cache-line boundary.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>

namespace brisance {

class Buffer {
 public:
  Buffer() = default;
  /// `count` zeros.
  explicit Buffer(std::size_t count) : size_(count) {
    if (count == 0) return;
    std::size_t const bytes = (count * sizeof(double) + 63) / 64 * 64;
    data_.reset(static_cast<double*>(std::aligned_alloc(64, bytes)));
    if (!data_) throw std::bad_alloc();
    std::memset(data_.get(), 0, bytes);
  }
  [[nodiscard]] double* data() { return data_.get(); }
  [[nodiscard]] double const* data() const { return data_.get(); }
  [[nodiscard]] std::size_t size() const { return size_; }
  double& operator[](std::size_t i) { return data_.get()[i]; }
  double operator[](std::size_t i) const { return data_.get()[i]; }

 private:
  struct Free {
    void operator()(double* p) const { std::free(p); }
  };
  std::unique_ptr<double[], Free> data_;
  std::size_t size_ = 0;
};

}  // namespace brisance
