#!/usr/bin/env python3
"""Checks embedded features from the files alone: input mesh, output mesh with features, report, constraint file.

    independent_embedding_check.py INPUT OUTPUT.ply REPORT.json [CONSTRAINTS.json] [-v]

Nothing of planish is used; python's standard library is all it needs. INPUT: obj, ply, off or stl with triangles, also
with .gz. What is checked:
  vertices    the input's stand first, bit for bit; new ones name a triangle of the input and barycentric coordinates
              that are >= 0, sum to 1 and give their position to 1e-13 of the mesh's size
  triangles   each lies in its origin and runs the way its origin does; those of one origin fill it. Decided in rational
              numbers: a place in a triangle is given by the coordinates of its corners 1 and 2 (corner 0 has the rest),
              a place on an edge by the coordinates of the edge's ends, for both triangles of the edge
  surface     edges with one or two triangles, vertices with a single fan; Euler characteristic and number of boundary
              loops as in the input; area ratio within 1e-12 of 1
  features    every step of a chain is an edge of the mesh; the PLY's element "edge" holds exactly these steps, under the
              number that a comment "feature NUMBER NAME" gives to the feature; no vertex of a chain twice in a row;
              lengths recomputed to 1e-12; regions ascending, and as the face property "region" has them
  sources     (with CONSTRAINTS.json)
    polyline       every vertex of the chain within max_distance (default: 1% of the length) of the polyline, every given
                   point within max_distance of the chain; max_deviation against the larger of these two one-sided
                   distances to 1e-9 of the mesh's size, from above also to the snapping of points: 1e-3 of the longest
                   edge of the input (the report may measure a vertex against the segment that it was traced for,
                   where a neighbouring segment is closer by as much)
    vertices       the chain visits the given vertices in their order; without join, only new vertices between
    loop, boundary_near   closed, every step has one triangle
    plane_cut      no vertex farther from the plane than max_deviation
    sharp_edges    every step bends by the given angle or more
    triangles      the region is what the given triangles were cut into
    enclosed_by    every edge between a triangle of the region and another one is a step of the enclosing chain

Prints "all agree", or a line for each disagreement (-v: for each comparison).
Exit code: 0 all agree, 1 something does not, 2 a file cannot be read.
"""
import argparse
import collections
import itertools
import json
import math
import os
import struct
import sys
from fractions import Fraction

import independent_check as base
from independent_check import Unreadable

SNAP_SHARE = 1e-3  # docs: points nearer than this share of an edge move onto a vertex or an edge


# --------------------------------------------------------------------------------------------------------------------
# Files

def read_input(path):
    name = path.lower().removesuffix(".gz")
    mesh = read_stl(base.read_bytes(path), path) if name.endswith(".stl") else base.read_mesh(path)
    if mesh is None:
        raise Unreadable(f"{path}: its format is not read here")
    if any(len(face) != 3 for face in mesh.faces):
        raise Unreadable(f"{path}: polygons are not read here")
    mesh.faces = [tuple(face) for face in mesh.faces]
    return mesh


def read_stl(content, path):
    """One vertex for all corners at the same position, in order of first occurrence."""
    (count,) = struct.unpack_from("<I", content, 80) if len(content) >= 84 else (-1,)
    if len(content) == 84 + 50 * count:
        corners = [row[3 * i:3 * i + 3] for row in struct.iter_unpack("<12f2x", content[84:]) for i in (1, 2, 3)]
    else:
        words = [line.split() for line in content.decode("ascii", "replace").splitlines()]
        corners = [tuple(map(float, w[1:4])) for w in words if w[:1] == ["vertex"]]
    if not corners or len(corners) % 3:
        raise Unreadable(f"{path}: no triangles")
    mesh, number = base.Mesh(), {}
    indices = [number.setdefault(corner, len(number)) for corner in corners]
    mesh.points = list(number)
    mesh.faces = list(zip(indices[0::3], indices[1::3], indices[2::3]))
    return mesh


class Output(base.Mesh):
    """A PLY file with everything in it: columns {element: {property: [value]}}, features {number: name}."""

    def __init__(self, path):
        super().__init__()
        content = base.read_bytes(path)
        try:
            self.read(content)
        except (ValueError, IndexError, KeyError, struct.error) as error:
            raise Unreadable(f"{path}: {error!r}")

    def read(self, content):
        end = content.index(b"\n", content.index(b"end_header")) + 1
        lines = content[:end].decode("utf-8", "replace").splitlines()
        layout, elements, self.features = None, [], {}
        for line in lines:
            words = line.split()
            if words[:1] == ["format"]:
                layout = words[1]
            elif words[:2] == ["comment", "feature"] and len(words) > 3 and words[2].isdigit():
                self.features[int(words[2])] = line.split(" ", 3)[3]
            elif words[:1] == ["element"]:
                elements.append((words[1], int(words[2]), []))
            elif words[:1] == ["property"]:
                elements[-1][2].append((words[-1], [base.PLY_TYPES[w] for w in words[1:-1] if w != "list"]))
        text = layout == "ascii"
        rows = base.ply_text_rows if text else base.ply_binary_rows
        place = content[end:].split() if text else (content, end)
        self.columns = collections.defaultdict(dict)
        for name, count, properties in elements:
            table, place = rows(place, count, properties, "<" if layout == "binary_little_endian" else ">")
            for i, (column, _) in enumerate(properties):
                self.columns[name][column] = [row[i] for row in table]
        vertex, face = self.columns["vertex"], self.columns["face"]
        self.points = list(zip(vertex["x"], vertex["y"], vertex["z"]))
        self.faces = [tuple(f) for f in face["vertex_indices"]]
        self.origin = face["origin"]
        self.places = list(zip(vertex["origin_triangle"], zip(vertex["b0"], vertex["b1"], vertex["b2"])))
        edge = self.columns["edge"] or {"vertex1": [], "vertex2": [], "feature": []}
        self.edges = collections.Counter(zip(edge["feature"], edge["vertex1"], edge["vertex2"]))
        indices = set(itertools.chain.from_iterable(self.faces))
        if not all(len(f) == 3 for f in self.faces) or not indices <= set(range(len(self.points))):
            raise ValueError("a face is no triangle of the file's vertices")


# --------------------------------------------------------------------------------------------------------------------
# Surfaces

def minus(p, q):
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


def dot(p, q):
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


def cross(p, q):
    return p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]


def normal(mesh, t):
    a, b, c = (mesh.points[v] for v in mesh.faces[t])
    return cross(minus(b, a), minus(c, a))


class Surface:
    """What a mesh is made of, without regard to where it lies."""

    def __init__(self, mesh):
        self.mesh = mesh
        self.half_edges, self.repeated = {}, []
        for t, (a, b, c) in enumerate(mesh.faces):
            for edge in ((a, b), (b, c), (c, a)):
                if edge in self.half_edges:
                    self.repeated.append(edge)
                self.half_edges[edge] = t
        referenced = set(itertools.chain.from_iterable(mesh.faces))
        border = {a: b for a, b in self.half_edges if (b, a) not in self.half_edges}
        self.euler = len(referenced) - (len(self.half_edges) + self.num_border()) // 2 + len(mesh.faces)
        self.forked = self.find_forked()
        self.loops = 0
        while border:
            self.loops += 1
            _, vertex = border.popitem()
            while vertex in border:
                vertex = border.pop(vertex)
        self.area = math.fsum(math.hypot(*normal(mesh, t)) / 2 for t in range(len(mesh.faces)))

    def num_border(self):
        return sum(1 for a, b in self.half_edges if (b, a) not in self.half_edges)

    def find_forked(self):
        """Vertices whose triangles form no single fan."""
        links = collections.defaultdict(dict)
        for a, b, c in self.mesh.faces:
            links[a][b], links[b][c], links[c][a] = c, a, b
        forked = []
        for v, link in links.items():
            starts = link.keys() - set(link.values())
            first = at = next(iter(starts or link))
            steps = 0
            while at in link and steps < len(link):
                at, steps = link[at], steps + 1
            if len(starts) > 1 or steps < len(link) or (not starts and at != first):
                forked.append(v)
        return forked

    def has_edge(self, a, b):
        return (a, b) in self.half_edges or (b, a) in self.half_edges

    def triangles_at(self, a, b):
        return [self.half_edges[e] for e in ((a, b), (b, a)) if e in self.half_edges]


def size_of(mesh):
    return max((abs(x) for p in mesh.points for x in p), default=0.0)


# --------------------------------------------------------------------------------------------------------------------
# Places in the triangles of the input

class Origins:
    """Vertices of the output as exact places in triangles of the input."""

    def __init__(self, original, output):
        self.original, self.output = original, output
        self.count = len(original.points)

    def place(self, vertex, triangle):
        """Coordinates of the corners 1 and 2 of a triangle that contains the vertex, or None where it does not."""
        corners = self.original.faces[triangle]
        if vertex < self.count:
            return tuple(Fraction(int(corners[i] == vertex)) for i in (1, 2)) if vertex in corners else None
        home, weights = self.output.places[vertex]
        if home == triangle:
            return Fraction(weights[1]), Fraction(weights[2])
        share = {v: Fraction(w) for v, w in zip(self.original.faces[home], weights) if w != 0}
        if len(share) > 2 or not share.keys() <= set(corners):
            return None
        return tuple(share.get(corners[i], Fraction(0)) for i in (1, 2))

    def position(self, vertex):
        """From its coordinates, in floating point but for the weights' sum."""
        home, weights = self.output.places[vertex]
        a, b, c = (self.original.points[v] for v in self.original.faces[home])
        return tuple(math.fsum((x * weights[0], y * weights[1], z * weights[2])) for x, y, z in zip(a, b, c))

    def fault_of(self, vertex):
        """What is wrong with the coordinates of a new vertex, or None."""
        home, weights = self.output.places[vertex]
        if not 0 <= home < len(self.original.faces):
            return f"origin_triangle {home}"
        exact = sum(map(Fraction, weights))
        if min(weights) < 0 or abs(exact - 1) > Fraction(1, 2 ** 51):
            return f"coordinates {weights}"
        if 0 in weights and exact != 1:
            return f"coordinates on an edge that sum to 1 only in rounding: {weights}"
        return None


def check_vertices(verdict, original, output, origins):
    count = len(original.points)
    pack = struct.Struct("<3d").pack
    verdict.note(len(output.points) >= count, f"vertices: {len(output.points)} in the output, {count} in the input")
    moved = [v for v, (p, q) in enumerate(zip(original.points, output.points)) if pack(*p) != pack(*q)]
    verdict.none("vertices of the input that moved", moved)
    new = range(count, len(output.points))
    faults = [(v, fault) for v in new if (fault := origins.fault_of(v))]
    verdict.none("new vertices without a place on the input", faults)
    if faults:
        raise Hopeless
    allowed = 1e-13 * size_of(original)
    far = [(v, d) for v in new if (d := math.dist(origins.position(v), output.points[v])) > allowed]
    verdict.none(f"new vertices farther than {allowed:.2e} from their place", far)
    used = set(itertools.chain.from_iterable(output.faces))
    verdict.none("new vertices without triangles", [v for v in new if v not in used])
    wrong = []
    for v, (home, weights) in enumerate(output.places[:count]):
        if v in used and (not 0 <= home < len(original.faces) or
                          weights != tuple(float(c == v) for c in original.faces[home])):
            wrong.append(v)
    verdict.none("vertices of the input whose own place is not at a corner of theirs", wrong)


def doubled(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def check_triangles(verdict, original, output, origins):
    pieces = collections.defaultdict(list)
    for t, origin in enumerate(output.origin):
        pieces[origin].append(t)
    verdict.none("triangles of the input without a piece", [t for t in range(len(original.faces)) if t not in pieces])
    verdict.none("origins that do not exist", [t for t in pieces if not 0 <= t < len(original.faces)])
    outside, turned, unfilled = [], [], []
    for origin, parts in pieces.items():
        if not 0 <= origin < len(original.faces):
            continue
        a, b, c = original.faces[origin]
        if len(parts) == 1 and output.faces[parts[0]] in ((a, b, c), (b, c, a), (c, a, b)):
            continue
        total = Fraction(0)
        for t in parts:
            places = [origins.place(v, origin) for v in output.faces[t]]
            if None in places:
                outside.append(t)
                continue
            area = doubled(*places)
            total += area
            if area <= 0:
                turned.append(t)
        if total != 1:
            unfilled.append((origin, float(total)))
    verdict.none("triangles that do not lie in their origin", outside)
    verdict.none("triangles turned over or flat against their origin", turned)
    verdict.none("triangles of the input that their pieces do not fill (share)", unfilled)


def check_surface(verdict, before, after):
    verdict.none("half-edges with several triangles", after.repeated)
    verdict.none("vertices without a single fan of triangles", after.forked)
    verdict.equal("Euler characteristic: that of the input", before.euler, after.euler)
    verdict.equal("boundary loops: those of the input", before.loops, after.loops)
    ratio = after.area / before.area
    verdict.note(abs(ratio - 1) <= 1e-12, f"area: {ratio!r} of the input's")


# --------------------------------------------------------------------------------------------------------------------
# Features

def steps_of(feature):
    chain = feature["vertices"]
    steps = list(zip(chain, chain[1:]))
    return steps + [(chain[-1], chain[0])] if feature["closed"] else steps


def check_chain(verdict, name, feature, output, surface, number):
    chain = feature["vertices"]
    inside = all(isinstance(v, int) and 0 <= v < len(output.points) for v in chain)
    verdict.note(inside and len(chain) >= (3 if feature["closed"] else 2), f"{name}: {len(chain)} vertices")
    if not inside:
        raise Hopeless
    steps = steps_of(feature)
    verdict.none(f"{name}: steps that are no edge", [s for s in steps if not surface.has_edge(*s)])
    once = collections.Counter(tuple(sorted(s)) for s in steps)
    verdict.none(f"{name}: edges walked twice", [s for s, times in once.items() if times > 1])
    written = collections.Counter({(a, b): n for (f, a, b), n in output.edges.items() if f == number})
    verdict.none(f"{name}: steps that are not in the element edge", list((collections.Counter(steps) - written)))
    verdict.none(f"{name}: rows of the element edge that are no step", list(written - collections.Counter(steps)))
    length = math.fsum(math.dist(output.points[a], output.points[b]) for a, b in steps)
    verdict.near(f"{name}: length", feature["length"], length)


def check_features(verdict, report, output, surface):
    numbers = {name: number for number, name in output.features.items()}
    verdict.equal("names of features: report and comments", sorted(report["features"]), sorted(numbers))
    verdict.none("rows of the element edge without a feature",
                 sorted({f for f, _, _ in output.edges if f not in output.features}))
    for name, feature in report["features"].items():
        if "triangles" not in feature:
            check_chain(verdict, name, feature, output, surface, numbers.get(name))
            continue
        region = feature["triangles"]
        known = all(isinstance(t, int) and 0 <= t < len(output.faces) for t in region)
        verdict.note(known and region and all(s < t for s, t in zip(region, region[1:])),
                     f"{name}: {len(region)} triangles, ascending")
        verdict.note(not any(f == numbers.get(name) for f, _, _ in output.edges), f"{name}: a region without edges")
        if not known:
            raise Hopeless


def check_region_column(verdict, report, output):
    """The face property "region": the number of a region that has the face, -1 where none has."""
    numbers = {name: number for number, name in output.features.items()}
    holders = collections.defaultdict(set)
    for name, feature in report["features"].items():
        for t in feature.get("triangles", ()):
            holders[t].add(numbers.get(name))
    column = output.columns["face"].get("region", [-1] * len(output.faces))
    verdict.none("faces whose property region is none of theirs",
                 [t for t, number in enumerate(column) if number not in holders.get(t, {-1})])


def check_counts(verdict, report, original, output):
    facts = report["embedding"]
    verdict.equal("vertices_added", facts["vertices_added"], len(output.points) - len(original.points))
    verdict.equal("triangles_added", facts["triangles_added"], len(output.faces) - len(original.faces))


# --------------------------------------------------------------------------------------------------------------------
# What the constraint file asked for

def distance_to_segment(p, a, b):
    along = minus(b, a)
    squared = dot(along, along)
    s = min(1.0, max(0.0, dot(minus(p, a), along) / squared)) if squared > 0 else 0.0
    return math.dist(p, (a[0] + s * along[0], a[1] + s * along[1], a[2] + s * along[2]))


def closed_walk(points, closed):
    return list(zip(points, points[1:])) + ([(points[-1], points[0])] if closed else [])


def farthest(points, segments):
    """(largest distance of a point from the segments, number of that point)"""
    return max((min(distance_to_segment(p, a, b) for a, b in segments), k) for k, p in enumerate(points))


class Sources:
    """Each kind of feature against what was asked for."""

    def __init__(self, verdict, report, original, output, surface):
        self.verdict, self.features, self.original = verdict, report["features"], original
        self.output, self.surface = output, surface
        self.size = size_of(original)
        self.snapping = SNAP_SHARE * max(math.dist(original.points[a], original.points[b])
                                         for face in original.faces for a, b in zip(face, face[1:] + face[:1]))

    def check(self, name, source):
        kinds = {"polyline": self.polyline, "vertices": self.vertices, "loop": self.boundary,
                 "boundary_near": self.boundary, "plane_cut": self.plane_cut, "sharp_edges": self.sharp_edges,
                 "triangles": self.triangles, "enclosed_by": self.enclosed_by}
        for kind in kinds.keys() & source.keys():
            kinds[kind](name, source, self.features[name])

    def polyline(self, name, source, feature):
        given, closed = [tuple(map(float, p)) for p in source["polyline"]], source.get("closed", False)
        segments = closed_walk(given, closed)
        most = source.get("max_distance", 0.01 * math.fsum(math.dist(a, b) for a, b in segments))
        chain = [self.output.points[v] for v in feature["vertices"]]
        self.verdict.equal(f"{name}: closed", feature["closed"], closed)
        from_polyline, at = farthest(chain, segments)
        self.verdict.note(from_polyline <= most, f"{name}: vertex {feature['vertices'][at]} is {from_polyline:.3e} from "
                                                 f"the polyline, {most:.3e} allowed")
        from_chain, at = farthest(given, closed_walk(chain, closed))
        self.verdict.note(from_chain <= most, f"{name}: point {at} is {from_chain:.3e} from the chain, "
                                              f"{most:.3e} allowed")
        found, reported = max(from_polyline, from_chain), feature["max_deviation"]
        rounding = 1e-9 * self.size
        self.verdict.note(found - rounding <= reported <= found + rounding + self.snapping,
                          f"{name}: max_deviation: reported {reported!r}, found {found!r}, differ by "
                          f"{reported - found:.2e}, snapping {self.snapping:.2e}")
        self.verdict.note(reported <= most + rounding, f"{name}: max_deviation {reported!r}, {most!r} allowed")

    def vertices(self, name, source, feature):
        given, chain = source["vertices"], feature["vertices"]
        self.verdict.equal(f"{name}: closed", feature["closed"], source.get("closed", False))
        shortest = source.get("join") == "shortest"
        old = [v for v in chain if v < len(self.original.points)]
        if not shortest:
            self.verdict.note(old == given, f"{name}: the given vertices, and only new ones between")
            return
        rest = iter(chain)
        self.verdict.note(all(v in rest for v in given), f"{name}: passes the given vertices in their order")

    def boundary(self, name, _source, feature):
        self.verdict.equal(f"{name}: closed", feature["closed"], True)
        inner = [s for s in steps_of(feature) if len(self.surface.triangles_at(*s)) != 1]
        self.verdict.none(f"{name}: steps that are not on the boundary", inner)

    def plane_cut(self, name, source, feature):
        plane = source["plane_cut"]
        unit = [x / math.hypot(*plane["normal"]) for x in plane["normal"]]
        off = [abs(dot(minus(self.output.points[v], plane["point"]), unit)) for v in feature["vertices"]]
        allowed = feature["max_deviation"] + 1e-12 * self.size
        self.verdict.note(max(off) <= allowed, f"{name}: {max(off):.3e} off its plane, {allowed:.3e} allowed")

    def sharp_edges(self, name, source, feature):
        flat = []
        for a, b in steps_of(feature):
            sides = [normal(self.output, t) for t in self.surface.triangles_at(a, b)]
            angle = len(sides) == 2 and math.degrees(math.atan2(math.hypot(*cross(*sides)), dot(*sides)))
            if angle is False or angle < source["sharp_edges"]["degrees"] - 1e-6:
                flat.append(((a, b), angle))
        self.verdict.none(f"{name}: steps that bend less", flat)

    def triangles(self, name, source, feature):
        chosen = set(source["triangles"])
        pieces = [t for t, origin in enumerate(self.output.origin) if origin in chosen]
        self.verdict.note(pieces == feature["triangles"], f"{name}: the pieces of the given triangles")

    def enclosed_by(self, name, source, feature):
        border = {tuple(sorted(s)) for s in steps_of(self.features[source["enclosed_by"]])}
        region, escapes, met = set(feature["triangles"]), [], set()
        for (a, b), t in self.surface.half_edges.items():
            if t not in region:
                continue
            met.add(tuple(sorted((a, b))))
            other = self.surface.half_edges.get((b, a), t)
            if other not in region and tuple(sorted((a, b))) not in border:
                escapes.append((a, b))
        self.verdict.none(f"{name}: edges over which it goes on beyond its border", escapes)
        self.verdict.none(f"{name}: edges of its border that it does not reach", sorted(border - met))


# --------------------------------------------------------------------------------------------------------------------
# Comparison

class Hopeless(Exception):
    """Further comparisons would have no meaning."""


class Verdict(base.Verdict):
    def none(self, name, found):
        self.note(not found, f"{name}: {len(found)}" + (f" {found[:5]}" if found else ""))


def compare(verdict, original, output, report, constraints):
    origins = Origins(original, output)
    check_vertices(verdict, original, output, origins)
    check_triangles(verdict, original, output, origins)
    surface = Surface(output)
    check_surface(verdict, Surface(original), surface)
    check_counts(verdict, report, original, output)
    check_features(verdict, report, output, surface)
    check_region_column(verdict, report, output)
    if constraints is None:
        return
    asked = constraints.get("features", {})
    verdict.equal("names of features: report and constraint file", sorted(report["features"]), sorted(asked))
    sources = Sources(verdict, report, original, output, surface)
    for name, source in asked.items():
        if name in report["features"]:
            sources.check(name, source)


def read_json(path):
    try:
        return json.loads(base.read_bytes(path))
    except ValueError as error:
        raise Unreadable(f"{path}: {error}")


def check(arguments):
    """Number of disagreements."""
    verdict = Verdict(1e-12, arguments.verbose)
    report = read_json(arguments.report)
    constraints = read_json(arguments.constraints) if arguments.constraints else None
    if report.get("repairs"):
        raise Unreadable(f"{arguments.report}: the mesh was repaired, its triangles are not those of the input")
    original, output = read_input(arguments.input), Output(arguments.output)
    try:
        compare(verdict, original, output, report, constraints)
    except (KeyError, TypeError) as error:
        verdict.note(False, f"a field is missing or of another type: {error!r}")
    except Hopeless:
        print("  the rest is not compared")
    name = os.path.basename(arguments.output)
    print(f"{name}: {verdict.disagreements} disagree" if verdict.disagreements else f"{name}: all agree")
    return verdict.disagreements


def main():
    parser = argparse.ArgumentParser(description="Recomputes what embedding features must keep, from the files alone.")
    parser.add_argument("input", help="mesh that was read (.obj .ply .off .stl, .gz)")
    parser.add_argument("output", help="mesh with features as planish wrote it (.ply, .gz)")
    parser.add_argument("report", help="report of the same run (.json)")
    parser.add_argument("constraints", nargs="?", help="constraint file of the same run (.json)")
    parser.add_argument("-v", "--verbose", action="store_true", help="print every comparison")
    try:
        return 1 if check(parser.parse_args()) else 0
    except Unreadable as error:
        print(error, file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
