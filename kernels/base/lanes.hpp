// Four doubles at once, and one binary for several instruction sets.
#pragma once

#include "kernels/base/types.hpp"

namespace planish {

/// Four doubles, loaded from any address; plain arithmetic works lane by lane.
using Lanes __attribute__((vector_size(32), aligned(8), may_alias)) = double;
inline constexpr Index kLanes = 4;

}  // namespace planish

/// Compiles a function for the baseline and for AVX2; the loader picks. The arithmetic is the same in both
/// (no contraction to fused multiply-add), so are the bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define PLANISH_CLONES __attribute__((target_clones("default", "avx2")))
#else
#define PLANISH_CLONES
#endif

/// For helpers of such functions that pass Lanes by value: called instead of inlined, the two sides would disagree
/// on the registers. Inlined, there is no call, and the compiler's warning about it is idle.
#pragma GCC diagnostic ignored "-Wpsabi"
#define PLANISH_INLINE [[gnu::always_inline]] inline
