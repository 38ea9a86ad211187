// Short cuts along edges that turn each component into a disk, or a disk with its holes.
#pragma once

#include <vector>

#include "engine/prepare/topology.hpp"

namespace planish {

struct CutGraphOptions {
  double sharp_degrees = 40;     ///< edges bent by more than this are sharp, [0, 180]
  double sharp_discount = 0.25;  ///< what an edge costs that is sharp or preferred, times its length; (0, 1]
};

struct CutGraph {
  std::vector<Index> corner;  ///< interior edges by the smaller half-edge, ascending
  double length = 0;          ///< mesh units
};

/// Interior edges along which to open the surface (open_along). Of each component
///   with boundary and genus 0: none;
///   closed, genus 0: a path between two points far apart, of two edges or more, that opens it to a disk;
///   closed, genus g > 0: a graph of cycle rank 2 g that opens it to a disk;
///   with boundary, genus g > 0: a graph that leaves it connected and of genus 0. Original holes stay loops of
///   their own, so there is one loop more than before. A hole is crossed, and joined to that new loop, only
///   where no other way was found; the new loop always exists.
/// Edges cost their length, less where they are sharp or preferred, so that cuts run along creases.
///   preferred_corner: half-edges of features, either twin
/// Pre: topology.manifold, positions finite.   Fails: never.
/// Cost: O(T log T) for each of a few roots, and a search near the cut for each of its arcs; components in
/// parallel; the same for any number of threads.
/// Ref: Erickson and Har-Peled 2004, Optimally cutting a surface into a disk; Erickson and Whittlesey 2005,
/// Greedy optimal homotopy and homology generators, 3.4 (tree and cotree); holes are contracted to nodes, the
/// union of the loops is pruned, and its arcs are replaced by shorter ones while there are any.
CutGraph find_cut_graph(const Exec& exec, const Surface& surface, const Topology& topology,
                        In<Index> preferred_corner, const CutGraphOptions& options = {});

}  // namespace planish
