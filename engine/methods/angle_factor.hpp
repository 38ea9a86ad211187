// The factor of the system of the rows' multipliers, definite or not.
#pragma once

#include <memory>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/solve/symmetric_matrix.hpp"

namespace planish {

class AngleFactor {
 public:
  /// order: fill-reducing, of the rows
  AngleFactor(const Exec& exec, std::vector<Index> order);
  ~AngleFactor();
  AngleFactor(const AngleFactor&) = delete;
  AngleFactor& operator=(const AngleFactor&) = delete;

  /// indefinite: without pivoting, so that it may fail.   Fails: FactorizationFailed, OutOfMemory.
  Result<void> factor(const SymmetricMatrix& a, bool indefinite);
  /// Two right-hand sides in, their solutions out.   Pre: factor() succeeded.
  void solve(std::vector<Vec2>& x) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace planish
