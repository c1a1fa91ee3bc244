/// \file
/// Attributes that compile a function for one instruction set, with the loops that are inlined into
/// it. Fused multiply-add is disabled, so that all instruction sets give the same bits.
#pragma once

#include <lefort/field/simd.h>

#if defined(__x86_64__)
#include <immintrin.h>  // For the builtins; functions of the header are bound to one target.
#endif

#define LEFORT_INLINE inline __attribute__((always_inline))
#if defined(__x86_64__)
#define LEFORT_AVX512 \
  __attribute__((target("avx512f,avx512vl,avx512bw,avx512dq,popcnt,prefer-vector-width=512")))
#define LEFORT_AVX2 __attribute__((target("avx2,popcnt")))
#endif
