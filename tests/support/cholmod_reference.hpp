// CHOLMOD's supernodal factorization, as tests and benchmarks compare with it.
#pragma once

#include <vector>

#include "engine/solve/symmetric_matrix.hpp"

namespace planish {

class CholmodReference {
 public:
  /// Analysis with a given order, or with METIS where it is empty. The matrix must outlive the reference.
  explicit CholmodReference(const SymmetricMatrix& matrix, In<Index> order = {});
  ~CholmodReference();
  CholmodReference(const CholmodReference&) = delete;
  CholmodReference& operator=(const CholmodReference&) = delete;

  /// False where it is not positive definite.
  bool factor();
  /// Two right-hand sides, u and v of rhs.   Pre: factor() was true.
  std::vector<Vec2> solve(In<Vec2> rhs);

  double flops() const;           ///< of the factorization, as CHOLMOD counts them
  double factor_entries() const;  ///< of the factor, without the zeros of relaxed supernodes
  std::vector<Index> order() const;

  /// METIS's order alone.
  static std::vector<Index> metis(const SymmetricMatrix& matrix);

 private:
  struct State;
  State* state_;
};

}  // namespace planish
