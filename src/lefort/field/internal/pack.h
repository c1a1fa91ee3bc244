/// \file
/// Vectors of a fixed number of lanes, in as many registers as an instruction set needs for them.
///
/// The compiler turns comparisons and selections of vectors that are wider than a register into
/// scalar code, so such vectors are divided here.
#pragma once

#include <lefort/field/internal/simd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace lefort::field::internal {

/// Bytes of a register.
template <Simd simd>
inline constexpr std::size_t kRegisterBytes = simd == Simd::kAvx512 ? 64
                                              : simd == Simd::kAvx2 ? 32
                                                                    : 16;

/// `kCount` numbers. All functions are inlined into functions compiled for `simd`.
template <class Number, std::size_t kCount, Simd simd>
struct Pack {
  static constexpr std::size_t kBytes = std::min(kCount * sizeof(Number), kRegisterBytes<simd>);
  static constexpr std::size_t kParts = kCount * sizeof(Number) / kBytes;
  typedef Number Register __attribute__((vector_size(kBytes)));  // NOLINT(modernize-use-using)
  // NOLINTNEXTLINE(modernize-use-using)
  typedef Number Unaligned
      __attribute__((vector_size(kBytes), aligned(alignof(Number)), may_alias));
  static constexpr std::size_t kPartLanes = kBytes / sizeof(Number);
  /// Result of comparisons; true lanes are -1.
  using Mask =
      Pack<std::conditional_t<sizeof(Number) == 4, std::int32_t, std::int64_t>, kCount, simd>;

  Register parts[kParts];

  /// f(n) is register n.
  template <class F>
  static LEFORT_INLINE Pack of(const F& f) {
    return of(f, std::make_index_sequence<kParts>());
  }
  template <class F, std::size_t... n>
  static LEFORT_INLINE Pack of(const F& f, std::index_sequence<n...>) {
    return {{f(n)...}};
  }
  static LEFORT_INLINE Pack filled(Number value) {
    return of([value](std::size_t) __attribute__((always_inline)) { return Register{} + value; });
  }
  /// \param from  as many numbers in as many registers.
  template <class From>
  static LEFORT_INLINE Pack converted(const Pack<From, kCount, simd>& from) {
    return of([&](std::size_t n) __attribute__((always_inline)) {
      return __builtin_convertvector(from.parts[n], Register);
    });
  }
  /// \param from  of any alignment.
  static LEFORT_INLINE Pack loaded(const Number* from) {
    return of([from](std::size_t n) __attribute__((always_inline)) {
      return Register(*reinterpret_cast<const Unaligned*>(from + n * kPartLanes));
    });
  }
  LEFORT_INLINE void store(Number* to) const {
    for (std::size_t n = 0; n < kParts; ++n)
      *reinterpret_cast<Unaligned*>(to + n * kPartLanes) = parts[n];
  }

  friend LEFORT_INLINE Pack operator+(const Pack& a, const Pack& b) {
    return of([&](std::size_t n)
                  __attribute__((always_inline)) { return a.parts[n] + b.parts[n]; });
  }
  friend LEFORT_INLINE Pack operator-(const Pack& a, const Pack& b) {
    return of([&](std::size_t n)
                  __attribute__((always_inline)) { return a.parts[n] - b.parts[n]; });
  }
  friend LEFORT_INLINE Pack operator*(const Pack& a, const Pack& b) {
    return of([&](std::size_t n)
                  __attribute__((always_inline)) { return a.parts[n] * b.parts[n]; });
  }
  friend LEFORT_INLINE Pack operator/(const Pack& a, const Pack& b) {
    return of([&](std::size_t n)
                  __attribute__((always_inline)) { return a.parts[n] / b.parts[n]; });
  }
  friend LEFORT_INLINE Pack operator-(const Pack& a) {
    return of([&](std::size_t n) __attribute__((always_inline)) { return -a.parts[n]; });
  }
  friend LEFORT_INLINE Pack operator+(const Pack& a, Number b) { return a + filled(b); }
  friend LEFORT_INLINE Pack operator-(const Pack& a, Number b) { return a - filled(b); }
  friend LEFORT_INLINE Pack operator-(Number a, const Pack& b) { return filled(a) - b; }
  friend LEFORT_INLINE Pack operator*(const Pack& a, Number b) { return a * filled(b); }
  friend LEFORT_INLINE Pack operator/(Number a, const Pack& b) { return filled(a) / b; }

  friend LEFORT_INLINE Mask operator<(const Pack& a, const Pack& b) {
    return Mask::of([&](std::size_t n) __attribute__((always_inline)) {
      return typename Mask::Register(a.parts[n] < b.parts[n]);
    });
  }
  friend LEFORT_INLINE Mask operator<=(const Pack& a, const Pack& b) {
    return Mask::of([&](std::size_t n) __attribute__((always_inline)) {
      return typename Mask::Register(a.parts[n] <= b.parts[n]);
    });
  }
};

/// `a` where the mask is true, else `b`.
template <class Number, std::size_t kCount, Simd simd>
LEFORT_INLINE Pack<Number, kCount, simd> select(
    const typename Pack<Number, kCount, simd>::Mask& mask, const Pack<Number, kCount, simd>& a,
    const Pack<Number, kCount, simd>& b) {
  return Pack<Number, kCount, simd>::of([&](std::size_t n) __attribute__((always_inline)) {
    return mask.parts[n] ? a.parts[n] : b.parts[n];
  });
}

template <class Number, std::size_t kCount, Simd simd>
LEFORT_INLINE Pack<Number, kCount, simd> smaller(const Pack<Number, kCount, simd>& a,
                                                 const Pack<Number, kCount, simd>& b) {
  return Pack<Number, kCount, simd>::of([&](std::size_t n) __attribute__((always_inline)) {
    return a.parts[n] < b.parts[n] ? a.parts[n] : b.parts[n];
  });
}

template <class Number, std::size_t kCount, Simd simd>
LEFORT_INLINE Pack<Number, kCount, simd> larger(const Pack<Number, kCount, simd>& a,
                                                const Pack<Number, kCount, simd>& b) {
  return Pack<Number, kCount, simd>::of([&](std::size_t n) __attribute__((always_inline)) {
    return a.parts[n] > b.parts[n] ? a.parts[n] : b.parts[n];
  });
}

/// True if a lane is true.
template <class Mask>
LEFORT_INLINE bool any(const Mask& mask) {
  auto all = mask.parts[0];
  for (std::size_t n = 1; n < Mask::kParts; ++n) all |= mask.parts[n];
  if constexpr (Mask::kBytes == 64) {
    typedef std::int64_t Eight __attribute__((vector_size(64)));  // NOLINT(modernize-use-using)
    const auto eight = reinterpret_cast<Eight>(all);
    const auto four = __builtin_shufflevector(eight, eight, 0, 1, 2, 3) |
                      __builtin_shufflevector(eight, eight, 4, 5, 6, 7);
    const auto two =
        __builtin_shufflevector(four, four, 0, 1) | __builtin_shufflevector(four, four, 2, 3);
    return (two[0] | two[1]) != 0;
  }
#if defined(__x86_64__)
  // Lanes are 0 or -1, so the top bits of their quarters decide.
  if constexpr (Mask::kBytes == 32) {
    typedef float Eight __attribute__((vector_size(32)));  // NOLINT(modernize-use-using)
    return __builtin_ia32_movmskps256(reinterpret_cast<Eight>(all)) != 0;
  }
  if constexpr (Mask::kBytes == 16) {
    typedef float Four __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)
    return __builtin_ia32_movmskps(reinterpret_cast<Four>(all)) != 0;
  }
#endif
  bool found = false;
  for (std::size_t l = 0; l < Mask::kPartLanes; ++l) found |= all[l] != 0;
  return found;
}

/// True if a lane of `a` is less than that of `b`. Compilers do not use the mask registers of
/// AVX-512 for this.
template <class Number, std::size_t kCount, Simd simd>
LEFORT_INLINE bool any_less(const Pack<Number, kCount, simd>& a,
                            const Pack<Number, kCount, simd>& b) {
#if defined(__x86_64__)
  constexpr int kLess = 1, kCurrentRounding = 4;
  constexpr bool kIs512 = Pack<Number, kCount, simd>::kBytes == 64;
  static_assert(!kIs512 || Pack<Number, kCount, simd>::kParts == 1);
  if constexpr (kIs512 && sizeof(Number) == sizeof(float))
    return __builtin_ia32_cmpps512_mask(a.parts[0], b.parts[0], kLess, -1, kCurrentRounding) != 0;
  if constexpr (kIs512 && sizeof(Number) == sizeof(double))
    return __builtin_ia32_cmppd512_mask(a.parts[0], b.parts[0], kLess, -1, kCurrentRounding) != 0;
#endif
  return any(a < b);
}

}  // namespace lefort::field::internal
