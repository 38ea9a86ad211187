#include "kernels/sparse/supernode.hpp"

namespace planish {
namespace {

// Panels are short and many: the processor does not foresee the next one. Asking for what comes 4 kB later makes
// solves a third faster.
constexpr Offset kAhead = 512;

namespace baseline {
using Simd = simd::Baseline;
#include "kernels/sparse/supernode_body.hpp"
}  // namespace baseline

#ifdef PLANISH_X86_SETS
#pragma GCC push_options
#pragma GCC target("avx2,fma")
namespace avx2 {
using Simd = simd::Avx2;
#include "kernels/sparse/supernode_body.hpp"
}  // namespace avx2
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx512f,fma,prefer-vector-width=512")
namespace avx512 {
using Simd = simd::Avx512;
#include "kernels/sparse/supernode_body.hpp"
}  // namespace avx512
#pragma GCC pop_options
#endif

}  // namespace

const PanelSolves& panel_solves(InstructionSet set) {
#ifdef PLANISH_X86_SETS
  if (set == InstructionSet::Avx512) return avx512::kSolves;
  if (set == InstructionSet::Avx2) return avx2::kSolves;
#endif
  static_cast<void>(set);
  return baseline::kSolves;
}

}  // namespace planish
