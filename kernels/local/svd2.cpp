#include "kernels/local/svd2.hpp"

namespace planish {

void singular_values(Range r, In<Mat2> jacobian, Out<SingularValues> sigma) {
  for (Index t = r.begin; t < r.end; ++t) sigma[t] = singular_values(jacobian[t]);
}

}  // namespace planish
