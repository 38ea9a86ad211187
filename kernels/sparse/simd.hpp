// Vectors of doubles for each instruction set, under one set of names. Kernels are written once over them, in texts that are
// included inside a namespace for each set (dense_body.hpp, supernode_body.hpp).
#pragma once

#include "kernels/base/lanes.hpp"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define PLANISH_X86_SETS
#include <immintrin.h>
#endif

namespace planish {

enum class InstructionSet { Baseline, Avx2, Avx512 };  ///< x86-64; AVX2 with fused multiply-add; AVX-512 F

/// What this processor can do, at best.
InstructionSet best_instruction_set();

namespace simd {

/// Two lanes, which every x86-64 has and compilers make of other processors' own. Products are rounded.
struct Baseline {
  using Vector __attribute__((vector_size(16))) = double;
  static constexpr Index kLanes = 2, kTileVectors = 3, kTileColumns = 4;
  static Vector load(const double* p) { return Vector{p[0], p[1]}; }
  static Vector load_part(const double* p, Index count) { return Vector{p[0], count > 1 ? p[1] : 0}; }
  static void store(double* p, Vector x) { p[0] = x[0], p[1] = x[1]; }
  static void store_part(double* p, Vector x, Index count) {
    p[0] = x[0];
    if (count > 1) p[1] = x[1];
  }
  static Vector all(double x) { return Vector{x, x}; }
  static Vector times(Vector a, Vector b) { return a * b; }
  template <class T>
  static T subtract_product(T a, T b, T c) {
    return c - a * b;
  }
  static double square_root(double x) { return __builtin_sqrt(x); }
  static double sum(Vector x) { return x[0] + x[1]; }
};

#ifdef PLANISH_X86_SETS
#pragma GCC push_options
#pragma GCC target("avx2,fma")

struct Avx2 {
  using Vector = __m256d;
  static constexpr Index kLanes = 4, kTileVectors = 3, kTileColumns = 4;
  PLANISH_INLINE static __m256i mask(Index count) {
    return _mm256_cmpgt_epi64(_mm256_set1_epi64x(count), _mm256_set_epi64x(3, 2, 1, 0));
  }
  PLANISH_INLINE static Vector load(const double* p) { return _mm256_loadu_pd(p); }
  PLANISH_INLINE static Vector load_part(const double* p, Index count) {
    return _mm256_maskload_pd(p, mask(count));
  }
  PLANISH_INLINE static void store(double* p, Vector x) { _mm256_storeu_pd(p, x); }
  PLANISH_INLINE static void store_part(double* p, Vector x, Index count) {
    _mm256_maskstore_pd(p, mask(count), x);
  }
  PLANISH_INLINE static Vector all(double x) { return _mm256_set1_pd(x); }
  PLANISH_INLINE static Vector times(Vector a, Vector b) { return _mm256_mul_pd(a, b); }
  PLANISH_INLINE static Vector subtract_product(Vector a, Vector b, Vector c) {
    return _mm256_fnmadd_pd(a, b, c);
  }
  PLANISH_INLINE static double subtract_product(double a, double b, double c) {
    return __builtin_fma(-a, b, c);
  }
  PLANISH_INLINE static double square_root(double x) { return __builtin_sqrt(x); }
  PLANISH_INLINE static double sum(Vector x) {
    const __m128d half = _mm_add_pd(_mm256_castpd256_pd128(x), _mm256_extractf128_pd(x, 1));
    return _mm_cvtsd_f64(_mm_add_sd(half, _mm_unpackhi_pd(half, half)));
  }
};

#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx512f,fma,prefer-vector-width=512")

struct Avx512 {
  using Vector = __m512d;
  static constexpr Index kLanes = 8, kTileVectors = 3, kTileColumns = 8;
  PLANISH_INLINE static __mmask8 mask(Index count) { return static_cast<__mmask8>((1u << count) - 1); }
  PLANISH_INLINE static Vector load(const double* p) { return _mm512_loadu_pd(p); }
  PLANISH_INLINE static Vector load_part(const double* p, Index count) {
    return _mm512_maskz_loadu_pd(mask(count), p);
  }
  PLANISH_INLINE static void store(double* p, Vector x) { _mm512_storeu_pd(p, x); }
  PLANISH_INLINE static void store_part(double* p, Vector x, Index count) {
    _mm512_mask_storeu_pd(p, mask(count), x);
  }
  PLANISH_INLINE static Vector all(double x) { return _mm512_set1_pd(x); }
  PLANISH_INLINE static Vector times(Vector a, Vector b) { return _mm512_mul_pd(a, b); }
  PLANISH_INLINE static Vector subtract_product(Vector a, Vector b, Vector c) {
    return _mm512_fnmadd_pd(a, b, c);
  }
  PLANISH_INLINE static double subtract_product(double a, double b, double c) {
    return __builtin_fma(-a, b, c);
  }
  PLANISH_INLINE static double square_root(double x) { return __builtin_sqrt(x); }
  PLANISH_INLINE static double sum(Vector x) {
    const __m256d half =
        _mm256_add_pd(__builtin_shufflevector(x, x, 0, 1, 2, 3), __builtin_shufflevector(x, x, 4, 5, 6, 7));
    const __m128d quarter = _mm_add_pd(_mm256_castpd256_pd128(half), _mm256_extractf128_pd(half, 1));
    return _mm_cvtsd_f64(_mm_add_sd(quarter, _mm_unpackhi_pd(quarter, quarter)));
  }
};

#pragma GCC pop_options
#endif

}  // namespace simd
}  // namespace planish
