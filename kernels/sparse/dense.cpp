#include "kernels/sparse/dense.hpp"

namespace planish {
namespace {

namespace baseline {
using Simd = simd::Baseline;
#include "kernels/sparse/dense_body.hpp"
}  // namespace baseline

#ifdef PLANISH_X86_SETS
#pragma GCC push_options
#pragma GCC target("avx2,fma")
namespace avx2 {
using Simd = simd::Avx2;
#include "kernels/sparse/dense_body.hpp"
}  // namespace avx2
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx512f,fma,prefer-vector-width=512")
namespace avx512 {
using Simd = simd::Avx512;
#include "kernels/sparse/dense_body.hpp"
}  // namespace avx512
#pragma GCC pop_options
#endif

}  // namespace

const DenseKernels& dense_kernels(InstructionSet set) {
#ifdef PLANISH_X86_SETS
  if (set == InstructionSet::Avx512) return avx512::kKernels;
  if (set == InstructionSet::Avx2) return avx2::kKernels;
#endif
  static_cast<void>(set);
  return baseline::kKernels;
}

}  // namespace planish
