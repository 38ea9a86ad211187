// RapidCheck generators of constrained cases.
#pragma once

#include <rapidcheck.h>

#include "tests/support/random_constraints.hpp"

namespace planish {

/// Counterexamples shrink by leaving out items.
inline rc::Gen<CaseSeeds> case_seeds(Index least_triangles, Index most_triangles, int most_items) {
  return rc::gen::withSize([=](int) {
    const auto item = rc::gen::noShrink(rc::gen::resize(100, rc::gen::arbitrary<std::uint32_t>()));
    return rc::gen::build<CaseSeeds>(
        rc::gen::set(&CaseSeeds::mesh, item),
        rc::gen::set(&CaseSeeds::triangles,
                     rc::gen::noShrink(
                         rc::gen::resize(100, rc::gen::inRange<Index>(least_triangles, most_triangles)))),
        rc::gen::set(&CaseSeeds::items,
                     rc::gen::resize(most_items, rc::gen::container<std::vector<std::uint32_t>>(item))));
  });
}

}  // namespace planish
