#include "kernels/sparse/simd.hpp"

namespace planish {

InstructionSet best_instruction_set() {
#ifdef PLANISH_X86_SETS
  if (__builtin_cpu_supports("avx512f")) return InstructionSet::Avx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return InstructionSet::Avx2;
#endif
  return InstructionSet::Baseline;
}

}  // namespace planish
