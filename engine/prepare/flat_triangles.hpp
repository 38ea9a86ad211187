// Triangles without area are removed, with CGAL's halfedge operations where PLANISH_WITH_CGAL_GPL allows them.
#pragma once

#include "engine/model/error.hpp"
#include "engine/prepare/soup.hpp"

namespace planish {

/// Needles lose their short edge, caps at the border go, the long edge of other caps is flipped; where that
/// would open a hole or change the topology the triangle stays, for diagnose() to name. Components that are
/// not manifold and oriented are left alone.
/// Fails: InternalDefect; without PLANISH_WITH_CGAL_GPL NotBuilt, where there are such triangles.
Result<void> remove_flat_triangles(Soup& soup, MendingLog& log);

}  // namespace planish
