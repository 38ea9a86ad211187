// Included inside a namespace that has Simd, as the kernels' texts are: no include guard.

/// Calls body(W) with W = width, at most Simd::kTileColumns, as a constant.
template <class Body>
PLANISH_INLINE void with_width(Index width, Body&& body) {
  if constexpr (Simd::kTileColumns == 8) {
    switch (width) {
      case 8: return body.template operator()<8>();
      case 7: return body.template operator()<7>();
      case 6: return body.template operator()<6>();
      case 5: return body.template operator()<5>();
      default: break;
    }
  }
  switch (width) {
    case 4: return body.template operator()<4>();
    case 3: return body.template operator()<3>();
    case 2: return body.template operator()<2>();
    default: return body.template operator()<1>();
  }
}
