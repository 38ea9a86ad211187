#!/usr/bin/env python3
"""Checks a flattening from its files alone: input mesh, output mesh with uv, report.

    independent_check.py INPUT OUTPUT REPORT.json [--schema report.schema.json] [-v]

Nothing of planish is used; python's standard library is all it needs (with the package jsonschema the report is also
validated against its schema). From the numbers in OUTPUT it recomputes what the report states, by definitions of its
own, and compares counts exactly and measures to 1e-9 relative, plus a bound on the rounding of needle triangles.

Definitions. A triangle t has the area A_t in space, and a Jacobian J_t from its own plane to the uv plane with signed
singular values s1 >= |s2| (s2 < 0 where the image is turned over); A is the sum of A_t.
  arap                 sum A_t ((s1 - 1)^2 + (s2 - 1)^2) / A
  symmetric_dirichlet  sum A_t (s1^2 + s2^2 + 1/s1^2 + 1/s2^2) / A, infinite (null) with a flip
  stretch              s1, s2, s1 s2, s1 / s2: extremes, mean and percentiles weighted by A_t
  flipped              image orientation <= 0: exact, as a rational number where floating point cannot decide
  overwound vertices   interior vertices around which their link winds at least twice (exact crossing number)
  overlapping pairs    triangles without a common vertex whose images share interior points: exact separating lines
  overlap fraction     sum of the pairs' common areas / sum of the image areas
and from the connectivity components, boundary loops and V - E + F.  OUTPUT must hold the vertices of INPUT first, in
their order and with their very coordinates, and unreferenced vertices at uv 0 0.

Prints one line of a table, and a line for each disagreement (-v: for each comparison).
Exit code: 0 all agree, 1 something does not, 2 a file cannot be read.
"""
import argparse
import collections
import gzip
import json
import math
import os
import struct
import sys
from fractions import Fraction

EPSILON = sys.float_info.epsilon


class Unreadable(Exception):
    """A file that is not there, or not in a format known here."""


# --------------------------------------------------------------------------------------------------------------------
# Meshes

class Mesh:
    """points [(x, y, z)]; faces [tuple of vertices]; uv: [(u, v)] per vertex, None where no face gives one."""

    def __init__(self):
        self.points, self.faces, self.uv = [], [], None


def read_bytes(path):
    try:
        with open(path, "rb") as file:
            content = file.read()
        return gzip.decompress(content) if path.lower().endswith(".gz") else content
    except (OSError, EOFError) as error:
        raise Unreadable(f"{path}: {error}")


def read_mesh(path):
    """OBJ, PLY or OFF, also gzipped; None for formats that are not read here."""
    name = path.lower().removesuffix(".gz")
    reader = {".obj": read_obj, ".ply": read_ply, ".off": read_off}.get(os.path.splitext(name)[1])
    if reader is None:
        return None
    content = read_bytes(path)
    try:
        return reader(content)
    except (ValueError, IndexError, KeyError, struct.error) as error:
        raise Unreadable(f"{path}: {error}")


def read_obj(content):
    mesh, coordinates, face_uv = Mesh(), [], []
    for line in content.decode("utf-8", "replace").replace("\\\n", " ").splitlines():
        words = line.split("#", 1)[0].split()
        if not words:
            continue
        if words[0] == "v":
            mesh.points.append(tuple(map(float, words[1:4])))
        elif words[0] == "vt":
            coordinates.append((float(words[1]), float(words[2]) if len(words) > 2 else 0.0))
        elif words[0] == "f":
            corners = [word.split("/") for word in words[1:]]
            mesh.faces.append(tuple(resolve(c[0], len(mesh.points)) for c in corners))
            face_uv.append([resolve(c[1], len(coordinates)) if len(c) > 1 and c[1] else None for c in corners])
    if coordinates:
        mesh.uv = uv_per_vertex(mesh, coordinates, face_uv)
    return mesh


def resolve(word, count):
    """OBJ counts from 1, or from the end with negative numbers."""
    index = int(word)
    index = index - 1 if index > 0 else count + index
    if not 0 <= index < count:
        raise ValueError(f"index {word} with {count} elements before it")
    return index


def uv_per_vertex(mesh, coordinates, face_uv):
    uv = [None] * len(mesh.points)
    for face, texture in zip(mesh.faces, face_uv):
        for vertex, index in zip(face, texture):
            if index is None:
                continue
            if uv[vertex] is not None and uv[vertex] != coordinates[index]:
                raise ValueError(f"vertex {vertex} has several uv")
            uv[vertex] = coordinates[index]
    if len(coordinates) == len(mesh.points):  # then unreferenced vertices have theirs, too
        uv = [coordinates[v] if value is None else value for v, value in enumerate(uv)]
    return uv


PLY_TYPES = {"char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H",
             "uint16": "H", "int": "i", "int32": "i", "uint": "I", "uint32": "I", "float": "f", "float32": "f",
             "double": "d", "float64": "d"}


def read_ply(content):
    end = content.index(b"end_header")
    end = content.index(b"\n", end) + 1
    lines = [line.split() for line in content[:end].decode("ascii", "replace").splitlines()]
    if lines[0] != ["ply"]:
        raise ValueError("not a PLY file")
    layout, elements = None, []
    for words in lines[1:]:
        if words[:1] == ["format"]:
            layout = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            types = [PLY_TYPES[w] for w in words[1:-1] if w != "list"]
            elements[-1][2].append((words[-1], types))
    rows = ply_text_rows if layout == "ascii" else ply_binary_rows
    mesh, place = Mesh(), content[end:].split() if layout == "ascii" else (content, end)
    for name, count, properties in elements:
        table, place = rows(place, count, properties, "<" if layout == "binary_little_endian" else ">")
        names = [p[0] for p in properties]
        if name == "vertex":
            x, y, z = (names.index(c) for c in "xyz")
            mesh.points = [(row[x], row[y], row[z]) for row in table]
            # s t is the map; another spelling beside it is a parameterization that the input already had.
            for u, v in (("s", "t"), ("u", "v"), ("texture_u", "texture_v")):
                if mesh.uv is None and u in names and v in names:
                    iu, iv = names.index(u), names.index(v)
                    mesh.uv = [(row[iu], row[iv]) for row in table]
        elif name == "face":
            column = next(i for i, n in enumerate(names) if n in ("vertex_indices", "vertex_index"))
            mesh.faces = [row[column] for row in table]
    return mesh


def ply_binary_rows(place, count, properties, order):
    """Rows of one element as tuples; a list is a tuple within."""
    content, offset = place
    if all(len(types) == 1 for _, types in properties):
        row = struct.Struct(order + "".join(types[0] for _, types in properties))
        end = offset + count * row.size
        if len(content) < end:
            raise ValueError("the file ends too early")
        return list(row.iter_unpack(content[offset:end])), (content, end)
    table = []
    for _ in range(count):
        values = []
        for _, types in properties:
            length = 1
            if len(types) == 2:
                (length,) = struct.unpack_from(order + types[0], content, offset)
                offset += struct.calcsize(types[0])
            value = struct.unpack_from(f"{order}{length}{types[-1]}", content, offset)
            offset += length * struct.calcsize(types[-1])
            values.append(value if len(types) == 2 else value[0])
        table.append(tuple(values))
    return table, (content, offset)


def ply_text_rows(words, count, properties, _order):
    table, i = [], 0
    for _ in range(count):
        values = []
        for _, types in properties:
            convert = float if types[-1] in "fd" else int
            if len(types) == 2:
                length, i = int(words[i]), i + 1
                values.append(tuple(convert(w) for w in words[i:i + length]))
                i += length
            else:
                values.append(convert(words[i]))
                i += 1
        table.append(tuple(values))
    return table, words[i:]


def read_off(content):
    lines = (line.split("#", 1)[0].split() for line in content.decode("utf-8", "replace").splitlines())
    lines = [words for words in lines if words]
    if not lines[0][0].endswith("OFF"):
        raise ValueError("not an OFF file")
    head = lines[0][1:] or lines[1]
    begin = 1 if lines[0][1:] else 2
    num_points, num_faces = int(head[0]), int(head[1])
    mesh = Mesh()
    mesh.points = [tuple(map(float, words[:3])) for words in lines[begin:begin + num_points]]
    faces = lines[begin + num_points:begin + num_points + num_faces]
    mesh.faces = [tuple(map(int, words[1:1 + int(words[0])])) for words in faces]
    return mesh


# --------------------------------------------------------------------------------------------------------------------
# Exact orientation

def orientation(a, b, c):
    """Sign of the area of a, b, c, exact."""
    left = (a[0] - c[0]) * (b[1] - c[1])
    right = (a[1] - c[1]) * (b[0] - c[0])
    area = left - right
    if abs(area) > 4 * EPSILON * (abs(left) + abs(right)) and abs(area) > 1e-290:  # twice the known bound 3 u + 16 u^2
        return 1 if area > 0 else -1
    ax, ay, bx, by, cx, cy = map(Fraction, (*a, *b, *c))
    area = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
    return (area > 0) - (area < 0)


# --------------------------------------------------------------------------------------------------------------------
# Measures

def singular_values(p, u):
    """(s1, s2, area in space, needle) of a triangle with corners p in space and u in the plane.

    The plane of the triangle takes its x axis along the longest edge. needle = longest edge^2 / (2 area) says how many
    times larger than one rounding error the errors of s1 and s2 can be."""
    (p0, p1, p2), (u0, u1, u2) = p, u
    lengths = [math.dist(p1, p0), math.dist(p2, p1), math.dist(p0, p2)]
    longest = lengths.index(max(lengths))
    if longest == 1:
        p0, p1, p2, u0, u1, u2 = p1, p2, p0, u1, u2, u0
    elif longest == 2:
        p0, p1, p2, u0, u1, u2 = p2, p0, p1, u2, u0, u1
    length = lengths[longest]
    ax, ay, az = p1[0] - p0[0], p1[1] - p0[1], p1[2] - p0[2]
    bx, by, bz = p2[0] - p0[0], p2[1] - p0[1], p2[2] - p0[2]
    doubled = math.hypot(ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx)
    if doubled == 0:
        return math.nan, math.nan, 0.0, math.inf
    x2, y2 = (ax * bx + ay * by + az * bz) / length, doubled / length
    xu, xv = (u1[0] - u0[0]) / length, (u1[1] - u0[1]) / length  # image of the unit vector along x, then along y
    yu, yv = (u2[0] - u0[0] - x2 * xu) / y2, (u2[1] - u0[1] - x2 * xv) / y2
    conformal = math.hypot(xu + yv, xv - yu) / 2
    anticonformal = math.hypot(xu - yv, xv + yu) / 2
    return conformal + anticonformal, conformal - anticonformal, doubled / 2, length * length / doubled


def ratio(a, b):
    return a / b if b != 0 else math.inf


def reciprocal_square(x):
    return ratio(1.0, x * x)


Measure = collections.namedtuple("Measure", "value rounding")  # rounding: bound on its own errors


def mean(values, roundings, areas):
    area = math.fsum(areas)
    return Measure(math.fsum(v * a for v, a in zip(values, areas)) / area,
                   math.fsum(r * a for r, a in zip(roundings, areas)) / area)


class Map:
    """What OUTPUT says about itself."""

    def __init__(self, mesh):
        self.mesh = mesh
        self.images = [tuple(mesh.uv[v] for v in face) for face in mesh.faces]
        self.orientations = [orientation(*image) for image in self.images]
        self.flipped = [t for t, o in enumerate(self.orientations) if o <= 0]
        self.measure()
        self.connect()
        self.find_overwound()

    def measure(self):
        points = self.mesh.points
        rows = [singular_values([points[v] for v in face], image)
                for face, image in zip(self.mesh.faces, self.images)]
        s1, s2, self.areas = ([row[i] for row in rows] for i in range(3))
        error = [16 * EPSILON * row[3] * row[0] for row in rows]  # of s1 and s2
        gap = [ratio(e, abs(b)) for e, b in zip(error, s2)]       # relative error of s2
        self.quantities = {
            "sigma_max": (s1, error),
            "sigma_min": (s2, error),
            "area_ratio": ([a * b for a, b in zip(s1, s2)], [2 * a * e for a, e in zip(s1, error)]),
            "angle_distortion": ([ratio(a, b) for a, b in zip(s1, s2)],
                                 [2 * abs(ratio(a, b)) * g for a, b, g in zip(s1, s2, gap)])}
        self.arap = mean([(a - 1) ** 2 + (b - 1) ** 2 for a, b in zip(s1, s2)],
                         [2 * (abs(a - 1) + abs(b - 1)) * e + e * e for a, b, e in zip(s1, s2, error)], self.areas)
        if self.flipped:
            self.symmetric_dirichlet = Measure(math.inf, 0.0)
        else:
            self.symmetric_dirichlet = mean(
                [a * a + b * b + reciprocal_square(a) + reciprocal_square(b) for a, b in zip(s1, s2)],
                [4 * g * (b * b + reciprocal_square(b)) + 4 * a * e for a, b, e, g in zip(s1, s2, error, gap)],
                self.areas)

    def connect(self):
        """Components across edges, boundary loops, Euler characteristic, vertices inside."""
        half_edges = {}
        for t, (a, b, c) in enumerate(self.mesh.faces):
            for edge in ((a, b), (b, c), (c, a)):
                if edge in half_edges:
                    raise Unreadable(f"half-edge {edge} is used twice")
                half_edges[edge] = t
        parent = list(range(len(self.mesh.faces)))

        def root(t):
            while parent[t] != t:
                parent[t] = parent[parent[t]]
                t = parent[t]
            return t

        leaving = {}
        for (a, b), t in half_edges.items():
            other = half_edges.get((b, a))
            if other is None:
                leaving[a] = b
            elif root(t) != root(other):
                parent[root(t)] = root(other)
        referenced = {v for face in self.mesh.faces for v in face}
        self.interior = referenced - leaving.keys()
        self.unreferenced = len(self.mesh.points) - len(referenced)
        self.components = sum(1 for t in range(len(parent)) if root(t) == t)
        num_edges = (len(half_edges) + len(leaving)) // 2
        self.euler = len(referenced) - num_edges + len(self.mesh.faces)
        self.loops = 0
        while leaving:
            self.loops += 1
            _, vertex = leaving.popitem()
            while vertex in leaving:
                vertex = leaving.pop(vertex)

    def find_overwound(self):
        """How often the link of a vertex winds around it: crossings of the ray from the vertex to the right.

        The side of the vertex on which a link edge crosses its height is the orientation of its triangle."""
        winding = collections.Counter()
        for face, image, side in zip(self.mesh.faces, self.images, self.orientations):
            for i in range(3):
                height, start, end = image[i][1], image[i - 2][1], image[i - 1][1]
                if start <= height < end and side > 0:
                    winding[face[i]] += 1
                elif end <= height < start and side < 0:
                    winding[face[i]] -= 1
        self.overwound = sorted(v for v, turns in winding.items() if turns > 1 and v in self.interior)


# --------------------------------------------------------------------------------------------------------------------
# Overlaps

def box_of(image):
    xs, ys = [p[0] for p in image], [p[1] for p in image]
    return min(xs), min(ys), max(xs), max(ys)


def grid_cells(box, cell, origin):
    x0, y0 = int((box[0] - origin[0]) / cell), int((box[1] - origin[1]) / cell)
    x1, y1 = int((box[2] - origin[0]) / cell), int((box[3] - origin[1]) / cell)
    return ((x, y) for x in range(x0, x1 + 1) for y in range(y0, y1 + 1))


def candidate_pairs(boxes):
    """Pairs whose boxes share interior points, each once: in the cell of the lower left corner of the common part."""
    origin = (min(b[0] for b in boxes), min(b[1] for b in boxes))
    extent = max(max(b[2] for b in boxes) - origin[0], max(b[3] for b in boxes) - origin[1])
    mean_size = math.fsum(max(b[2] - b[0], b[3] - b[1]) for b in boxes) / len(boxes)
    cell = max(1.5 * mean_size, extent / (2 * math.isqrt(len(boxes)) + 1)) or 1.0  # no box covers more than some 4 n
    grid = collections.defaultdict(list)
    for t, box in enumerate(boxes):
        for place in grid_cells(box, cell, origin):
            grid[place].append(t)
    for place, members in grid.items():
        for k, s in enumerate(members):
            b = boxes[s]
            for t in members[:k]:
                c = boxes[t]
                left, low = max(b[0], c[0]), max(b[1], c[1])
                if left < min(b[2], c[2]) and low < min(b[3], c[3]):
                    if (int((left - origin[0]) / cell), int((low - origin[1]) / cell)) == place:
                        yield t, s


def separated(a, b):
    """An edge line of the counter-clockwise triangle a has b on its outer side (or on the line)."""
    return any(all(orientation(a[i], a[i - 2], p) <= 0 for p in b) for i in range(3))


def common_area(a, b):
    """Of two counter-clockwise triangles: a, clipped by the sides of b."""
    polygon = list(a)
    for i in range(3):
        (px, py), (qx, qy) = b[i], b[i - 2]
        sides = [(qx - px) * (y - py) - (qy - py) * (x - px) for x, y in polygon]
        clipped = []
        for k, (point, side) in enumerate(zip(polygon, sides)):
            before, side_before = polygon[k - 1], sides[k - 1]
            if (side < 0 < side_before) or (side_before < 0 < side):
                f = side_before / (side_before - side)
                clipped.append((before[0] + f * (point[0] - before[0]), before[1] + f * (point[1] - before[1])))
            if side >= 0:
                clipped.append(point)
        polygon = clipped
    return doubled_area(polygon) / 2


def doubled_area(polygon):
    """About the first corner, so that a polygon far from the origin loses nothing."""
    if len(polygon) < 3:
        return 0.0
    ox, oy = polygon[0]
    shifted = [(x - ox, y - oy) for x, y in polygon]
    return math.fsum(p[0] * q[1] - p[1] * q[0] for p, q in zip(shifted, shifted[1:]))


def find_overlaps(chart):
    """(number of pairs without a common vertex, their common areas / area of the map, area of the surface that lies under
    other triangles, once for each of them / all of it)"""
    faces = [set(face) for face in chart.mesh.faces]
    turned = [image if o > 0 else image[::-1] for image, o in zip(chart.images, chart.orientations)]
    solid = [t for t, o in enumerate(chart.orientations) if o != 0]
    if not solid:
        return 0, 0.0, 0.0
    pairs, common, covered = 0, [], []
    for i, j in candidate_pairs([box_of(turned[t]) for t in solid]):
        s, t = solid[i], solid[j]
        if separated(turned[s], turned[t]) or separated(turned[t], turned[s]):
            continue
        area = common_area(turned[s], turned[t])
        covered += [2 * area * chart.areas[k] / doubled_area(turned[k]) for k in (s, t)]
        if faces[s].isdisjoint(faces[t]):
            pairs += 1
            common.append(area)
    return (pairs, math.fsum(common) / (math.fsum(doubled_area(image) for image in turned) / 2),
            math.fsum(covered) / math.fsum(chart.areas))


# --------------------------------------------------------------------------------------------------------------------
# Comparison

class Verdict:
    def __init__(self, tolerance, verbose):
        self.tolerance, self.verbose = tolerance, verbose
        self.disagreements = 0

    def note(self, agrees, text):
        self.disagreements += not agrees
        if self.verbose or not agrees:
            print(("  agrees    " if agrees else "  DISAGREES ") + text)

    def equal(self, name, reported, found):
        self.note(reported == found, f"{name}: reported {reported}, found {found}")

    def near(self, name, reported, found, rounding=0.0):
        """null in a report is a number that is infinite or undefined."""
        if reported is None or not math.isfinite(found):
            self.note(reported is None and not math.isfinite(found), f"{name}: reported {reported}, found {found}")
            return
        allowed = self.tolerance * max(abs(reported), abs(found)) + rounding
        self.note(abs(reported - found) <= allowed,
                  f"{name}: reported {reported!r}, found {found!r}, differ by {abs(reported - found):.2e}, "
                  f"{allowed:.2e} allowed")


def check_spread(verdict, name, reported, values, roundings, areas):
    if any(math.isnan(v) for v in values):
        verdict.note(False, f"{name}: a triangle has no area in space")
        return
    for key, pick in (("min", min), ("max", max)):
        at = values.index(pick(values))
        verdict.near(f"{name}.{key}", reported[key], values[at], roundings[at])
    average = mean(values, roundings, areas)
    verdict.near(f"{name}.mean", reported["mean"], average.value, average.rounding)
    total = math.fsum(areas)
    for key, share in (("p1", 0.01), ("p50", 0.5), ("p99", 0.99)):
        level = reported[key]
        if level is None:
            verdict.note(math.inf in values or -math.inf in values, f"{name}.{key}: reported None")
            continue
        slack = verdict.tolerance * abs(level)
        below = math.fsum(a for v, a, r in zip(values, areas, roundings) if v < level - slack - r) / total
        up_to = math.fsum(a for v, a, r in zip(values, areas, roundings) if v <= level + slack + r) / total
        verdict.note(below <= share + 1e-9 and up_to >= share - 1e-9,
                     f"{name}.{key}: {below:.6%} of the area is below the reported {level!r}, {up_to:.6%} is not above")


def space_angles(corners):
    """At each corner, from its two edges."""
    angles = []
    for i in range(3):
        a, b = ([q - p for p, q in zip(corners[i], corners[i - k])] for k in (1, 2))
        cosine = sum(x * y for x, y in zip(a, b))
        across = math.sqrt(max(0.0, sum(x * x for x in a) * sum(y * y for y in b) - cosine * cosine))
        angles.append(math.atan2(across, cosine))
    return angles


def check_benchmark(verdict, chart, reported):
    """Figures of Shay, Solomon and Stein but for overlaps: surface and map scaled to the area 1 each."""
    s1, s2 = (chart.quantities[name][0] for name in ("sigma_max", "sigma_min"))
    error = max(chart.quantities["sigma_max"][1])
    total = math.fsum(chart.areas)
    image = math.fsum(abs(a * b) * area for a, b, area in zip(s1, s2, chart.areas))
    scale = math.sqrt(total / image)
    shares = [(area / total, abs(a * b) * area / image) for a, b, area in zip(s1, s2, chart.areas)]
    worst = max(ratio(abs(a), abs(b)) + ratio(abs(b), abs(a)) - 2 for a, b in zip(s1, s2))
    wrong = sum(o < 0 for o in chart.orientations) / len(s1)
    angles = math.fsum(a * sum(abs(x - y) for x, y in zip(space_angles([chart.mesh.points[v] for v in face]),
                                                          space_angles(image)))
                       for (a, _), face, image in zip(shares, chart.mesh.faces, chart.images))
    xs, ys = zip(*(z for image in chart.images for z in image))
    least = min(abs(b) for b in s2)
    # Angles from coordinates carry a square root of rounding where they are flat.
    found = {"max_area_distortion": (max(ratio(a, b) + ratio(b, a) - 2 for a, b in shares), 8 * error),
             "average_area_error": (math.fsum(abs(a - b) for a, b in shares), 8 * error),
             "min_singular_value": (scale * least, 2 * error), "max_singular_value": (scale * max(s1), 2 * error),
             "proportion_flipped_triangles": (min(wrong, 1 - wrong), 0), "max_angle_distortion": (worst, 8 * error * (1 + worst)),
             "average_angle_error": (angles, 1e-9),
             "resolution": (ratio(max(max(xs) - min(xs), max(ys) - min(ys)), least), 2 * error * ratio(1.0, least))}
    for name, (value, rounding) in found.items():
        verdict.near("benchmark." + name, reported[name], value, rounding)


def check_map(verdict, chart, report):
    check_benchmark(verdict, chart, report["benchmark"])
    verdict.near("energy.arap", report["energy"]["arap"], *chart.arap)
    verdict.near("energy.symmetric_dirichlet", report["energy"]["symmetric_dirichlet"], *chart.symmetric_dirichlet)
    for name, (values, roundings) in chart.quantities.items():
        check_spread(verdict, "stretch." + name, report["stretch"][name], values, roundings, chart.areas)
    listed = 64
    verdict.equal("flipped_triangles", report["flipped_triangles"], len(chart.flipped))
    verdict.equal("flipped_ids", report["flipped_ids"], chart.flipped[:listed])
    verdict.equal("overwound_vertices", report["overwound_vertices"], len(chart.overwound))
    verdict.equal("overwound_ids", report["overwound_ids"], chart.overwound[:listed])


def check_mesh(verdict, chart, report):
    facts, mesh = report["mesh"], chart.mesh
    verdict.equal("mesh.vertices", facts["vertices"], len(mesh.points))
    verdict.equal("mesh.unreferenced_vertices", facts["unreferenced_vertices"], chart.unreferenced)
    verdict.equal("mesh.triangles", facts["triangles"], len(mesh.faces))
    verdict.equal("mesh.components", facts["components"], chart.components)
    verdict.equal("mesh.boundary_loops", facts["boundary_loops"], chart.loops)
    verdict.equal("mesh.euler", facts["euler"], chart.euler)


def check_origin(verdict, original, mesh, repaired):
    """The input's vertices stand first, unmoved; its triangles too, unless it had to be repaired or has polygons."""
    if original is None:
        verdict.note(True, "input: its format is not read here, vertices and triangles are not compared")
        return
    count = len(original.points)
    moved = [v for v, (p, q) in enumerate(zip(original.points, mesh.points)) if p != q]
    verdict.note(len(mesh.points) >= count, f"vertices: {len(mesh.points)} in the output, {count} in the input")
    verdict.note(not moved, f"vertices of the input that moved: {len(moved)} {moved[:5]}")
    if not repaired and all(len(face) == 3 for face in original.faces):
        verdict.note([tuple(f) for f in original.faces] == mesh.faces, "triangles are those of the input, in order")


def check_unreferenced(verdict, mesh):
    referenced = {v for face in mesh.faces for v in face}
    wrong = [v for v, uv in enumerate(mesh.uv) if v not in referenced and uv is not None and uv != (0.0, 0.0)]
    verdict.note(not wrong, f"unreferenced vertices away from uv 0 0: {wrong[:5]}")


def check_overlaps(verdict, chart, report, most_triangles):
    if len(chart.mesh.faces) > most_triangles:
        verdict.note(True, f"overlaps are not looked for above {most_triangles} triangles")
        return None
    pairs, fraction, covered = find_overlaps(chart)
    verdict.equal("overlapping_pairs", report["overlapping_pairs"], pairs)
    verdict.near("overlap_area_fraction", report["overlap_area_fraction"], fraction, 1e-13)
    verdict.near("benchmark.bijectivity_violation_area", report["benchmark"]["bijectivity_violation_area"], covered, 1e-13)
    return pairs


def check_schema(verdict, report, path):
    try:
        import jsonschema
    except ImportError:
        verdict.note(True, "schema: not validated, python has no package jsonschema")
        return
    schema = json.loads(read_bytes(path))
    errors = sorted(jsonschema.Draft202012Validator(schema).iter_errors(report), key=lambda e: list(e.absolute_path))
    for error in errors[:5]:
        verdict.note(False, f"schema: /{'/'.join(map(str, error.absolute_path))}: {error.message}")
    if not errors:
        verdict.note(True, "schema: the report is valid")


def read_output(path):
    mesh = read_mesh(path)
    if mesh is None or mesh.uv is None or not mesh.faces:
        raise Unreadable(f"{path}: no triangles with uv")
    for t, face in enumerate(mesh.faces):
        if len(face) != 3 or any(mesh.uv[v] is None for v in face):
            raise Unreadable(f"{path}: face {t} is no triangle with uv")
        if not all(math.isfinite(x) for v in face for x in mesh.uv[v]):
            raise Unreadable(f"{path}: face {t} has a uv that is not finite")
    return mesh


COLUMNS = ("output", "triangles", "arap", "sigma min", "sigma max", "flips", "overwound", "overlaps", "verdict")


def table_line(cells):
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def check(arguments):
    """Number of disagreements."""
    verdict = Verdict(arguments.tolerance, arguments.verbose)
    try:
        report = json.loads(read_bytes(arguments.report))
    except ValueError as error:
        raise Unreadable(f"{arguments.report}: {error}")
    check_schema(verdict, report, arguments.schema)
    mesh = read_output(arguments.output)
    chart = Map(mesh)
    overlaps = None
    try:
        check_origin(verdict, read_mesh(arguments.input), mesh, bool(report["repairs"]))
        check_unreferenced(verdict, mesh)
        check_mesh(verdict, chart, report)
        check_map(verdict, chart, report)
        overlaps = check_overlaps(verdict, chart, report, arguments.max_overlap_triangles)
    except (KeyError, TypeError) as error:
        verdict.note(False, f"report: a field is missing or of another type: {error!r}")
    if arguments.header:
        print(table_line(COLUMNS))
        print(table_line(["---"] * len(COLUMNS)))
    smallest, largest = min(chart.quantities["sigma_min"][0]), max(chart.quantities["sigma_max"][0])
    print(table_line((os.path.basename(arguments.output), len(mesh.faces), f"{chart.arap.value:.6g}",
                      f"{smallest:.6f}", f"{largest:.6f}", len(chart.flipped), len(chart.overwound),
                      "-" if overlaps is None else overlaps,
                      f"{verdict.disagreements} disagree" if verdict.disagreements else "all agree")))
    return verdict.disagreements


def main():
    folder = os.path.dirname(os.path.abspath(__file__))
    parser = argparse.ArgumentParser(description="Recomputes a flattening's report from the files alone.")
    parser.add_argument("input", help="mesh that was flattened (.obj .ply .off, .gz; others are not compared)")
    parser.add_argument("output", help="mesh with uv as planish wrote it (.obj .ply, .gz)")
    parser.add_argument("report", help="report of the same run (.json)")
    parser.add_argument("--schema", default=os.path.join(folder, "..", "docs", "report.schema.json"))
    parser.add_argument("--tolerance", type=float, default=1e-9, help="relative (default 1e-9)")
    parser.add_argument("--max-overlap-triangles", type=int, default=100000,
                        help="larger meshes are not searched for overlaps (default 100000)")
    parser.add_argument("--header", action="store_true", help="print the table's head first")
    parser.add_argument("-v", "--verbose", action="store_true", help="print every comparison")
    try:
        return 1 if check(parser.parse_args()) else 0
    except Unreadable as error:
        print(error, file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
