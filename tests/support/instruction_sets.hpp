// The instruction sets that this processor has, for kernels to be tested with each.
#pragma once

#include <vector>

#include "kernels/sparse/simd.hpp"

namespace planish {

inline std::vector<InstructionSet> available_sets() {
  std::vector<InstructionSet> sets = {InstructionSet::Baseline};
  if (best_instruction_set() != InstructionSet::Baseline) sets.push_back(InstructionSet::Avx2);
  if (best_instruction_set() == InstructionSet::Avx512) sets.push_back(InstructionSet::Avx512);
  return sets;
}

}  // namespace planish
