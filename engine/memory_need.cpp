#include "engine/memory_need.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace planish {
namespace {

// Bytes a triangle, and an entry of the factor; fitted to the peaks of sampled bonnets.
constexpr Offset kProcess = 16'000'000;  // before any mesh
constexpr Offset kChecks = 330, kColumns = 300;
constexpr double kSystem = 12, kAnalysis = 2.8;
constexpr double kNewton =
    80;  // each entry is a block of 2 x 2 there, and the factor of local/global is still kept

std::string readable(Offset bytes) {
  const bool large = bytes >= 1'000'000'000;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), large ? "%.2f GB" : "%.0f MB",
                static_cast<double>(bytes) * (large ? 1e-9 : 1e-6));
  return text.data();
}

}  // namespace

Offset memory_of_checks(Index num_triangles) { return kProcess + kChecks * num_triangles; }

MemoryNeed memory_need(Index num_triangles, Offset factor_nonzeros, Index border) {
  constexpr Offset kDenseCopies = 3;  // corner, Schur complement, its factor
  const auto entries = static_cast<double>(factor_nonzeros);
  const Offset columns =
      kProcess + kColumns * num_triangles + kDenseCopies * 8 * border * static_cast<Offset>(border);
  MemoryNeed need;
  need.local_global = columns + static_cast<Offset>(kSystem * entries);
  need.at_once = need.local_global + static_cast<Offset>(kAnalysis * entries);
  need.newton = columns + static_cast<Offset>(kNewton * entries);
  const Offset checks = memory_of_checks(num_triangles);
  for (Offset* bytes : {&need.local_global, &need.at_once, &need.newton}) *bytes = std::max(*bytes, checks);
  return need;
}

Result<void> within_memory(Offset needed, Offset limit, const std::string& what) {
  if (limit == 0 || needed <= limit) return {};
  return fail(ErrorCode::OutOfMemory,
              what + " about " + readable(needed) + " of memory, the limit is " + readable(limit));
}

}  // namespace planish
