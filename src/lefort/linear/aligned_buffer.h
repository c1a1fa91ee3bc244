/// \file
/// A large aligned array of doubles whose allocation may fail.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace lefort::linear {

/// An array of `size` doubles, aligned at least to cache lines, not initialized. False as a
/// condition if the allocation failed.
class AlignedBuffer {
 public:
  AlignedBuffer() = default;
  explicit AlignedBuffer(std::int64_t size) {
    const std::size_t bytes = std::size_t(size) * sizeof(double);
    const std::size_t alignment = bytes < 2 * kLargePage ? kCacheLine : kLargePage;
    const std::size_t whole = (bytes / alignment + 1) * alignment;
    numbers_.reset(static_cast<double*>(std::aligned_alloc(alignment, whole)));
#if defined(__linux__)
    // The kernel clears a few large pages faster than many small ones, and the TLB covers more
    // memory with large pages.
    if (alignment == kLargePage && numbers_ != nullptr)
      ::madvise(numbers_.get(), whole, MADV_HUGEPAGE);  // A hint; failure has no effect on results.
#endif
  }

  [[nodiscard]] double* data() { return numbers_.get(); }
  [[nodiscard]] const double* data() const { return numbers_.get(); }
  [[nodiscard]] explicit operator bool() const { return numbers_ != nullptr; }

 private:
  static constexpr std::size_t kCacheLine = 64;
  static constexpr std::size_t kLargePage = std::size_t(1) << 21;
  struct Free {
    void operator()(double* numbers) const { std::free(numbers); }
  };
  std::unique_ptr<double[], Free> numbers_;
};

}  // namespace lefort::linear
