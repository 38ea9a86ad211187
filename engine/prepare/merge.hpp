// Vertices at equal positions become one where triangles then share an edge that was an open border of both.
#pragma once

#include "engine/prepare/soup.hpp"

namespace planish {

/// Merged vertices stay behind, unreferenced; the one with the smallest index takes their corners. Not
/// merged, and said so: vertices whose union would put a third triangle on an edge.
void merge_vertices(Soup& soup, MendingLog& log);

}  // namespace planish
