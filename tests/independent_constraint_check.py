#!/usr/bin/env python3
"""Checks that a flattening keeps its constraints, from the files alone: constraint file, flat mesh, report.

    independent_constraint_check.py CONSTRAINTS.json FLAT.(ply|obj) REPORT.json

Nothing of planish is used; python's standard library is all it needs. FLAT (also .gz) has the positions and the uv that
`planish flatten` wrote, REPORT the chains and regions of the features in FLAT, and an entry a constraint (two on a
seam: side 1 is left of the chain, side 2 right). Residuals are recomputed from the coordinates in FLAT; a reported one
is only held against the limit. L is the length of a chain in space, with the closing edge; vertices that an entry lists
as `yielded` follow another constraint and are left out.
  line       distance from the best-fit line / L; strict order along it; lengths of edges against those in space, times
             one factor where they scale, / L
  circle     | |p - c| - r | / r about a circle of least squares, of the radius that is given or that sweep_degrees asks
             for; lengths of edges times one factor / L; turning one way, once around where closed; an arc without
             sweep_degrees has about that of its best-fit circle in space
  curve      distance from the reported template in its best pose, not mirrored, / L. The template itself: edges not
             longer than in space, and the projection to the best-fit plane of the chain ("geodesic": lengths kept)
  region     (template: a point a vertex, ascending, or three a triangle where a seam runs through it) the same / square
             root of the area in space; every triangle of the template counter-clockwise; its largest
             relative change of a length is printed
  angle, parallel, perpendicular, direction   in degrees: +-degrees modulo 180, "oriented" modulo 360. A feature counts
             by its best-fit line, where it is a line or `measure` says so, else from its first to its last vertex
  pin        distance / diagonal of the map (of a vertex with several uv: the nearest)
Limits: 1e-9, angles 1e-7 degrees. Scales, orientations and angles that the report states are those of the map, free
scales of a group are equal, closed templates turn as the map does. A yielded vertex is held by a constraint of the same
or a higher rank and lies within 10 x `agreement` of its own place.

Prints a line a constraint, then "all agree" or a line for each fault.
Exit code: 0 all agree, 1 something does not, 2 a file cannot be read.
"""
import argparse
import cmath
import collections
import functools
import itertools
import json
import math
import struct
import sys

import independent_check as base
from independent_check import EPSILON, Unreadable

LIMIT = 1e-9
ANGLE_LIMIT = 1e-7       # degrees
RELATIONS = ("angle", "parallel", "perpendicular", "direction")
RANK = {"pin": 0, "line": 1, "circle": 1, "curve": 2, "region": 3}
NEARLY_STRAIGHT = 1e-3   # second over first singular value of a chain, DESIGN 3.2
CLEAR_COSINE = 0.3       # between a curve's plane and the surface: from here on there is no choice to mirror


class Fault(Exception):
    """A constraint that cannot be evaluated."""


# --------------------------------------------------------------------------------------------------------------------
# Files

class Flat:
    """points [(x, y, z)]; faces [(a, b, c)]; corner_uv [(u + i v) of each corner] a face."""

    def __init__(self, points, faces, corner_uv):
        self.points, self.faces, self.corner_uv = points, faces, corner_uv

    @functools.cached_property
    def half_edges(self):
        return {edge: t for t, (a, b, c) in enumerate(self.faces) for edge in ((a, b), (b, c), (c, a))}

    @functools.cached_property
    def copies(self):
        """{vertex: its different uv}"""
        copies = collections.defaultdict(set)
        for face, images in zip(self.faces, self.corner_uv):
            for v, z in zip(face, images):
                copies[v].add(z)
        return dict(copies)

    @functools.cached_property
    def extent(self):
        images = list(itertools.chain.from_iterable(self.corner_uv))
        us, vs = [z.real for z in images], [z.imag for z in images]
        return math.hypot(max(us) - min(us), max(vs) - min(vs))

    def uv_at(self, t, v):
        return self.corner_uv[t][self.faces[t].index(v)]

    def triangle_beside(self, a, b, side):
        """The one left of a -> b, of side 2 the one right of it; where there is none, the other one."""
        left, right = self.half_edges.get((a, b)), self.half_edges.get((b, a))
        first, second = (right, left) if side == 2 else (left, right)
        return second if first is None else first

    def is_torn(self, a, b):
        """Whether the two triangles of an edge lie apart in the map."""
        left, right = self.half_edges.get((a, b)), self.half_edges.get((b, a))
        return None not in (left, right) and any(self.uv_at(left, v) != self.uv_at(right, v) for v in (a, b))

    def corners(self, t):
        return [self.points[v] for v in self.faces[t]]


def read_flat(path):
    is_obj = path.lower().removesuffix(".gz").endswith(".obj")
    content = base.read_bytes(path)
    try:
        flat = (read_obj if is_obj else read_ply)(content)
    except (ValueError, IndexError, KeyError, struct.error) as error:
        raise Unreadable(f"{path}: {error!r}")
    if not flat.faces or any(len(face) != 3 or len(images) != 3 for face, images in zip(flat.faces, flat.corner_uv)):
        raise Unreadable(f"{path}: not a mesh of triangles with uv")
    if not all(map(cmath.isfinite, itertools.chain.from_iterable(flat.corner_uv))):
        raise Unreadable(f"{path}: a uv is not finite")
    return flat


def read_obj(content):
    points, coordinates, faces, corner_uv = [], [], [], []
    for line in content.decode("utf-8", "replace").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append(tuple(map(float, words[1:4])))
        elif words[:1] == ["vt"]:
            coordinates.append(complex(float(words[1]), float(words[2])))
        elif words[:1] == ["f"]:
            corners = [word.split("/") for word in words[1:]]
            faces.append(tuple(base.resolve(c[0], len(points)) for c in corners))
            corner_uv.append(tuple(coordinates[base.resolve(c[1], len(coordinates))] for c in corners))
    return Flat(points, faces, corner_uv)


def read_ply(content):
    end = content.index(b"\n", content.index(b"end_header")) + 1
    layout, elements = None, []
    for words in map(str.split, content[:end].decode("utf-8", "replace").splitlines()):
        if words[:1] == ["format"]:
            layout = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append((words[-1], [base.PLY_TYPES[w] for w in words[1:-1] if w != "list"]))
    rows = base.ply_text_rows if layout == "ascii" else base.ply_binary_rows
    place = content[end:].split() if layout == "ascii" else (content, end)
    columns = collections.defaultdict(dict)
    for name, count, properties in elements:
        table, place = rows(place, count, properties, "<" if layout == "binary_little_endian" else ">")
        for i, (column, _) in enumerate(properties):
            columns[name][column] = [row[i] for row in table]
    return flat_of_columns(columns["vertex"], columns["face"])


def flat_of_columns(vertex, face):
    points, faces = list(zip(vertex["x"], vertex["y"], vertex["z"])), face["vertex_indices"]
    if not all(0 <= v < len(points) for corners in faces for v in corners):
        raise ValueError("a face names a vertex that does not exist")
    if "texcoord" in face:
        return Flat(points, faces, [tuple(map(complex, uv[0::2], uv[1::2])) for uv in face["texcoord"]])
    uv = list(map(complex, vertex["s"], vertex["t"]))
    return Flat(points, faces, [tuple(uv[v] for v in corners) for corners in faces])


def read_json(path):
    try:
        return json.loads(base.read_bytes(path))
    except ValueError as error:
        raise Unreadable(f"{path}: {error}")


# --------------------------------------------------------------------------------------------------------------------
# The plane, as complex numbers

def dot(a, b):
    """Of two complex numbers as vectors."""
    return a.real * b.real + a.imag * b.imag


def cross(a, b):
    return a.real * b.imag - a.imag * b.real


def mean(points):
    return complex(math.fsum(p.real for p in points), math.fsum(p.imag for p in points)) / len(points)


def signed_area(polygon):
    shifted = [p - polygon[0] for p in polygon]
    return math.fsum(map(cross, shifted, shifted[1:])) / 2


def turnings(points, closed):
    """Exterior angles, radians."""
    steps = [q - p for p, q in zip(points, points[1:] + (points[:1] if closed else []))]
    return [cmath.phase(q * p.conjugate()) for p, q in zip(steps, steps[1:] + (steps[:1] if closed else []))]


Line = collections.namedtuple("Line", "centre direction")


def line_through(points):
    """Total least squares; runs from the first to the last point."""
    centre = mean(points)
    arms = [p - centre for p in points]
    xx, yy = math.fsum(a.real ** 2 for a in arms), math.fsum(a.imag ** 2 for a in arms)
    direction = cmath.rect(1, math.atan2(2 * math.fsum(a.real * a.imag for a in arms), xx - yy) / 2)
    return Line(centre, direction if dot(direction, points[-1] - points[0]) >= 0 else -direction)


Circle = collections.namedtuple("Circle", "centre radius")


def least_squares(rows, right):
    """Few unknowns, by the normal equations."""
    n = len(rows[0])
    system = [[math.fsum(row[i] * row[j] for row in rows) for j in range(n)] +
              [math.fsum(row[i] * b for row, b in zip(rows, right))] for i in range(n)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda k: abs(system[k][i]))
        system[i], system[pivot] = system[pivot], system[i]
        if system[i][i] == 0:
            raise Fault("its points determine no circle")
        for k in range(n):
            if k != i:
                share = system[k][i] / system[i][i]
                system[k] = [a - share * b for a, b in zip(system[k], system[i])]
    return [system[i][n] / system[i][i] for i in range(n)]


def fit_circle(points, radius=None):
    """Least squares of the distances from it, by Gauss and Newton from the algebraic circle."""
    middle = mean(points)
    size = max(abs(p - middle) for p in points)
    local = [(p - middle) / size for p in points]
    d, e, f = least_squares([(p.real, p.imag, 1.0) for p in local], [-abs(p) ** 2 for p in local])
    centre = -complex(d, e) / 2
    r = math.sqrt(max(0.0, abs(centre) ** 2 - f)) if radius is None else radius / size
    for _ in range(30):
        arms = [p - centre for p in local]
        rows = [(a.real / abs(a), a.imag / abs(a)) + ((1.0,) if radius is None else ()) for a in arms]
        step = least_squares(rows, [abs(a) - r for a in arms])
        centre += complex(step[0], step[1])
        r += step[2] if radius is None else 0.0
        if max(map(abs, step)) <= 1e-15 * r:
            break
    return Circle(middle + size * centre, size * r)


def sweep_about(centre, points):
    """Radians."""
    arms = [p - centre for p in points]
    return abs(math.fsum(cmath.phase(q * p.conjugate()) for p, q in zip(arms, arms[1:])))


def arc_radius(lengths, sweep):
    """Of the arc with these chords and this sweep (radians): bisection of half the sector of the longest."""
    longest = max(lengths)
    others = list(lengths)
    others.remove(longest)

    def total(half):
        return 2 * half + 2 * math.fsum(math.asin(min(1.0, l * math.sin(half) / longest)) for l in others)

    low, high = 0.0, math.pi
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if total(middle) < sweep else (low, middle)
    return longest / (2 * math.sin(low))


class Pose:
    """The similarity z = p + c t without reflection that takes a template best to its image; isometry: scale given."""

    def __init__(self, template, image, scale=None):
        self.source, self.target = mean(template), mean(image)
        arms = [t - self.source for t in template]
        products = [a.conjugate() * (z - self.target) for a, z in zip(arms, image)]
        squared = math.fsum(abs(a) ** 2 for a in arms)
        self.turn = mean(products) * len(products) / squared
        if scale is not None:
            self.turn *= scale / abs(self.turn)
        self.spread = math.sqrt(squared / len(arms))

    def distances(self, template, image):
        return [abs(z - self.target - self.turn * (t - self.source)) for t, z in zip(template, image)]


def wrap(degrees, period):
    """Into [-period / 2, period / 2)."""
    return (degrees + period / 2) % period - period / 2


def angle_error(angle, wanted, oriented):
    if oriented:
        return abs(wrap(angle - wanted, 360))
    return min(abs(wrap(angle - wanted, 180)), abs(wrap(angle + wanted, 180)))


# --------------------------------------------------------------------------------------------------------------------
# Space

def minus(p, q):
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


def dot3(p, q):
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


def cross3(p, q):
    return p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]


def normal(a, b, c):
    """Twice as long as the triangle has area."""
    return cross3(minus(b, a), minus(c, a))


def unit(p):
    length = math.hypot(*p)
    return tuple(x / length for x in p) if length > 0 else p


def eigen_3x3(matrix):
    """[(value, vector)] of a symmetric matrix, largest first: Jacobi rotations."""
    a, q = [list(row) for row in matrix], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    for i, j in 12 * ((0, 1), (0, 2), (1, 2)):
        half = math.atan2(2 * a[i][j], a[i][i] - a[j][j]) / 2
        c, s = math.cos(half), math.sin(half)
        for row in a + q:
            row[i], row[j] = c * row[i] + s * row[j], c * row[j] - s * row[i]
        a[i], a[j] = ([c * x + s * y for x, y in zip(a[i], a[j])], [c * y - s * x for x, y in zip(a[i], a[j])])
    return sorted(((a[k][k], tuple(row[k] for row in q)) for k in range(3)), reverse=True)


Projection = collections.namedtuple("Projection", "image heights spread normal")  # spread: eigenvalues, largest first


def project(points):
    """To the best-fit plane through the mean, every point weighted equally."""
    middle = [math.fsum(p[i] for p in points) / len(points) for i in range(3)]
    arms = [minus(p, middle) for p in points]
    size = max(math.hypot(*a) for a in arms)
    moments = [[math.fsum(a[i] / size * a[j] / size for a in arms) for j in range(3)] for i in range(3)]
    (x, e1), (y, e2), (z, _) = eigen_3x3(moments)
    up = cross3(e1, e2)
    return Projection([complex(dot3(a, e1), dot3(a, e2)) for a in arms], [dot3(a, up) for a in arms], (x, y, z), up)


# --------------------------------------------------------------------------------------------------------------------
# Chains

class Chain:
    """A feature's chain in space and, on one of its sides, in the map."""

    def __init__(self, flat, feature, side, yielded=()):
        self.flat, self.vertices, self.closed = flat, feature["vertices"], feature["closed"]
        n = len(self.vertices)
        self.steps = [(k, (k + 1) % n) for k in range(n if self.closed else n - 1)]
        self.triangles = [self.triangle(self.vertices[i], self.vertices[j], side) for i, j in self.steps]
        self.space = [flat.points[v] for v in self.vertices]
        self.lengths = [math.dist(self.space[i], self.space[j]) for i, j in self.steps]
        self.length = math.fsum(self.lengths)
        self.image = self.find_image()
        self.kept = [k for k, v in enumerate(self.vertices) if v not in yielded]
        kept = set(self.kept)
        self.kept_steps = [(abs(self.image[j] - self.image[i]), length)
                           for (i, j), length in zip(self.steps, self.lengths) if i in kept and j in kept]

    def triangle(self, a, b, side):
        t = self.flat.triangle_beside(a, b, side)
        if t is None:
            raise Fault(f"{a} and {b} follow each other in the chain without an edge of the mesh")
        return t

    def find_image(self):
        image = [None] * len(self.vertices)
        for step, t in zip(self.steps, self.triangles):
            for k in step:
                z = self.flat.uv_at(t, self.vertices[k])
                if image[k] not in (None, z):
                    raise Fault(f"the map is torn across the chain at vertex {self.vertices[k]}")
                image[k] = z
        if len(image) < 2:
            raise Fault("a chain of fewer than two vertices")
        return image

    def chosen(self, fewest):
        """The vertices that determine a pose: those not yielded, or all where they are too few."""
        return [self.image[k] for k in self.kept] if len(self.kept) >= fewest else self.image

    def factor(self):
        """Length in the map over length in space, of the edges that did not yield."""
        kept = math.fsum(length for _, length in self.kept_steps)
        return math.fsum(image for image, _ in self.kept_steps) / kept if kept > 0 else None

    def reach(self):
        """The part of the chain that the factor is measured on."""
        return math.fsum(length for _, length in self.kept_steps) / self.length

    def edge_error(self, factor):
        return max((abs(image - factor * length) for image, length in self.kept_steps), default=0.0) / self.length

    def is_seam(self):
        return all(self.flat.is_torn(self.vertices[i], self.vertices[j]) for i, j in self.steps)

    def surface_normal(self):
        """Mean of the unit normals beside the chain."""
        pairs = [(self.vertices[i], self.vertices[j]) for i, j in self.steps]
        beside = {self.flat.triangle_beside(a, b, side) for a, b in pairs for side in (1, 2)}
        normals = [unit(normal(*self.flat.corners(t))) for t in beside]
        return unit(tuple(math.fsum(n[i] for n in normals) for i in range(3)))


# --------------------------------------------------------------------------------------------------------------------
# Constraints

def default_name(rule):
    words = [rule["type"], *([rule["feature"]] if "feature" in rule else rule.get("features", []))]
    words += [f"{a}-{b}" for a, b in rule.get("edges", [rule["edge"]] if "edge" in rule else [])]
    vertices = rule.get("vertices", [])
    words += map(str, vertices[:3])
    return " ".join(words) + (f" and {len(vertices) - 3} more" if len(vertices) > 3 else "")


def given_scale(rule):
    """The factor that the file gives; None: free."""
    if rule["type"] == "line" and rule.get("lengths", "keep") == "keep":
        return 1.0
    fixed = rule["type"] in ("curve", "region") and "scale_group" not in rule
    scale = rule.get("scale", 1.0 if fixed else "free")
    return None if scale == "free" else float(scale)


class Job:
    """The three files, and what constraints need to know of each other."""

    def __init__(self, constraints, flat, report):
        self.flat, self.features, self.entries = flat, report.get("features", {}), report["constraints"]
        self.rules = {rule.get("name", default_name(rule)): rule for rule in constraints.get("constraints", [])}
        self.agreement = constraints.get("agreement", 1e-3)
        self.lines = {rule["feature"] for rule in self.rules.values() if rule["type"] == "line"}
        self.line_yielded = {(e["feature"], e.get("side") or 0): set(e.get("yielded") or ())
                             for e in self.entries if e["type"] == "line"}

    def feature(self, name):
        if name not in self.features:
            raise Fault(f"the report has no feature '{name}'")
        return self.features[name]


class Check:
    """One entry of the report."""

    def __init__(self, job, rule, entry):
        self.job, self.rule, self.entry = job, rule, entry
        self.type, self.side = rule["type"], entry.get("side") or 0
        self.title = entry["name"] + (f" (side {self.side})" if self.side else "")
        self.yielded = set(entry.get("yielded") or ())
        self.faults, self.held, self.note, self.factor = [], set(), "", None
        self.limit = ANGLE_LIMIT if self.type in RELATIONS else LIMIT

    def fault(self, text):
        self.faults.append(f"{self.title}: {text}")

    def run(self):
        """Collects the faults and prints the line; the residual is nan where it cannot be had."""
        residual, unit_name = math.nan, " degrees" if self.type in RELATIONS else ""
        try:
            if self.type not in RANK and self.type not in RELATIONS:
                raise Fault(f"type '{self.type}' is not known here")
            self.check_entry()
            residual = getattr(self, "relation" if self.type in RELATIONS else self.type)()
            for what, value in (("residual", residual), ("reported residual", self.entry["residual"])):
                if not value <= self.limit:
                    self.fault(f"{what} {value:.3e}{unit_name}, {self.limit:.0e} allowed")
        except Fault as fault:
            self.fault(str(fault))
        except (KeyError, IndexError, TypeError, ValueError, ZeroDivisionError) as error:
            self.fault(f"a field is missing or has no meaning: {error!r}")
        print(f"{self.title}: residual {residual:.2e}{unit_name}, reported {self.entry.get('residual')}{self.note}")

    def check_entry(self):
        for key in ("type", "feature", "features", "edges", "edge", "vertices"):
            if key in self.rule and self.entry.get(key) != self.rule[key]:
                self.fault(f"'{key}' is {self.entry.get(key)} in the report, {self.rule[key]} in the constraint file")
        stated = self.entry["residual_abs"]
        if not (stated is None and self.type in RELATIONS or 0 <= stated < math.inf):
            self.fault(f"residual_abs is {stated}")

    # ---- parts that several kinds share

    def chain(self):
        chain = Chain(self.job.flat, self.job.feature(self.rule["feature"]), self.side, self.yielded)
        self.hold(chain.vertices)
        return chain

    def hold(self, vertices):
        self.held = set(vertices) - self.yielded
        strangers = self.yielded - set(vertices)
        if strangers:
            self.fault(f"vertices that are not its own are yielded: {sorted(strangers)[:5]}")
        if self.yielded:
            self.note += f", {len(self.yielded)} of {len(set(vertices))} yielded"

    def template(self, count):
        """None where the report has none."""
        if self.entry["template"] is None:
            return None
        if len(self.entry["template"]) != count:
            raise Fault(f"the template has {len(self.entry['template'])} points, the feature {count} vertices")
        return [complex(x, y) for x, y in self.entry["template"]]

    def largest(self, distances, kept, size, fewest):
        """Of those that did not yield, over the size; the others must not stray."""
        holds = set(kept)
        stray = max((d for k, d in enumerate(distances) if k not in holds), default=0.0)
        if not stray <= 10 * self.job.agreement * size:
            self.fault(f"a yielded vertex strays by {stray:.3e}, the agreement is {self.job.agreement} of {size:.3e}")
        return max((distances[k] for k in kept), default=0.0) / size if len(kept) >= fewest else 0.0

    def check_scale(self, factor, reach):
        """factor: that of the map, measured on a part `reach` of the feature."""
        given, stated, self.factor, allowed = given_scale(self.rule), self.entry["scale"], factor, LIMIT / reach
        if given is not None and not abs(factor / given - 1) <= allowed:
            self.fault(f"scale {factor!r} in the map, {given!r} in the constraint file")
        if stated is not None and not abs(factor / stated - 1) <= allowed:
            self.fault(f"scale {factor!r} in the map, {stated!r} in the report")
        if given is None and stated is None:
            self.fault("the free scale is not reported")

    def check_orientation(self, direction):
        stated = self.entry["orientation"]
        if stated is not None and not abs(wrap(math.degrees(cmath.phase(direction)) - stated, 360)) <= 1e-6:
            self.fault(f"orientation {math.degrees(cmath.phase(direction))!r} in the map, {stated!r} in the report")

    def check_mirror(self, closed):
        asked = self.rule.get("mirror")
        if asked is not None and not closed and self.entry["mirrored"] is not asked:
            self.fault(f"'mirror' is {asked} in the constraint file, 'mirrored' {self.entry['mirrored']} in the report")

    def posed(self, template, image, kept, size):
        """Largest distance from the template in its best pose, over the size."""
        used = kept if len(kept) > 1 else range(len(image))
        scale = None if self.type == "circle" else given_scale(self.rule)
        pose = Pose([template[k] for k in used], [image[k] for k in used], scale)
        if len(kept) > 1:
            self.check_orientation(pose.turn)
            if self.type != "circle":  # its edges have told
                self.check_scale(abs(pose.turn), min(1.0, pose.spread / size))
        return self.largest(pose.distances(template, image), kept, size, 2)

    def check_turn(self, chain, template):
        """Closed ones turn the same way in the template and in the map."""
        if chain.closed and not signed_area(template) * signed_area(chain.image) > 0:
            self.fault(f"signed area {signed_area(template):.3e} of the template, "
                       f"{signed_area(chain.image):.3e} in the map")

    # ---- line

    def line(self):
        chain = self.chain()
        template = self.template(len(chain.vertices))
        axis = line_through(chain.chosen(2))
        distances = [abs(cross(axis.direction, z - axis.centre)) for z in chain.image]
        residual = self.largest(distances, chain.kept, chain.length, 2)
        self.check_order(chain, axis)
        if len(chain.kept) > 1:
            self.check_orientation(axis.direction if template is None else
                                   Pose([template[k] for k in chain.kept], chain.chosen(2)).turn)
        lengths = self.rule.get("lengths", "keep")
        factor = 1.0 if lengths == "keep" else chain.factor()
        if lengths == "free" or factor is None:
            return residual
        self.check_scale(factor, 1.0 if lengths == "keep" else chain.reach())
        return max(residual, chain.edge_error(factor))

    def check_order(self, chain, axis):
        kept = chain.kept + (chain.kept[:1] if chain.closed else [])
        along = [dot(axis.direction, chain.image[k] - axis.centre) for k in kept]
        lost = [(chain.vertices[i], chain.vertices[j])
                for i, j, a, b in zip(kept, kept[1:], along, along[1:]) if not a < b]
        if lost:
            self.fault(f"{len(lost)} steps against the order along the line {lost[:5]}")

    # ---- circle

    def circle(self):
        chain = self.chain()
        template, factor = self.template(len(chain.vertices)), chain.factor()
        radius = self.known_radius(chain, factor)
        found = fit_circle(chain.chosen(3), radius)
        distances = [abs(abs(z - found.centre) - found.radius) for z in chain.image]
        residual = self.largest(distances, chain.kept, found.radius, 3)
        self.check_bends(chain)
        self.check_mirror(chain.closed)
        if factor is not None:
            self.check_scale(factor, chain.reach())
            residual = max(residual, chain.edge_error(factor))
        if template is None:
            if not chain.closed:
                self.fault("an arc without its template: nothing says how far it sweeps")
            return residual
        self.check_circle_template(chain, template)
        return max(residual, self.posed(template, chain.image, chain.kept, chain.length))

    def known_radius(self, chain, factor):
        """In the map, where the file determines it; None: it is free."""
        sweep, radius = self.rule.get("sweep_degrees"), self.rule.get("radius")
        if sweep is None or chain.closed:
            return radius
        of_sweep = arc_radius(chain.lengths, math.radians(sweep))
        if radius is None:
            return None if factor is None else factor * of_sweep
        if factor is not None and not abs(factor * of_sweep / radius - 1) <= LIMIT / chain.reach():
            self.fault(f"radius {factor * of_sweep!r} from the lengths in the map and the sweep, {radius!r} asked for")
        return radius

    def check_bends(self, chain):
        """All one way, never back, and once around where closed."""
        bends = turnings([chain.image[k] for k in chain.kept], chain.closed)
        if len(chain.kept) < 3 or not bends:
            return
        total, slack = math.fsum(bends), 1e-4
        sign = 1 if total >= 0 else -1
        if min(sign * b for b in bends) < -slack or max(sign * b for b in bends) > math.pi - slack:
            self.fault("the chain bends both ways")
        if chain.closed and abs(abs(total) - 2 * math.pi) > slack:
            self.fault(f"the chain goes {total / (2 * math.pi):.3f} times around")

    def check_circle_template(self, chain, template):
        self.check_turn(chain, template)
        self.check_template_lengths(chain, template)
        if chain.closed or "sweep_degrees" in self.rule:
            return
        seen = project(chain.space).image
        in_space, laid = fit_circle(seen), fit_circle(template)
        wanted, found = sweep_about(in_space.centre, seen), sweep_about(laid.centre, template)
        misfit = max(abs(abs(z - in_space.centre) - in_space.radius) for z in seen) / in_space.radius
        if not abs(found - wanted) <= 1e-6 + 20 * misfit / wanted:  # other fits differ by some 8 misfit / sweep
            self.fault(f"the template sweeps {math.degrees(found):.6f} degrees, "
                       f"the best-fit circle in space {math.degrees(wanted):.6f}")

    def check_template_lengths(self, chain, template, shorter=False):
        """Those of the chain; shorter: or less."""
        excess = [abs(template[j] - template[i]) - length for (i, j), length in zip(chain.steps, chain.lengths)]
        worst = max(excess if shorter else map(abs, excess))
        if not worst <= LIMIT * chain.length:
            self.fault(f"an edge of the template is off by {worst:.3e} from its length in space, L {chain.length:.3e}")

    # ---- curve

    def curve(self):
        chain = self.chain()
        template = self.template(len(chain.vertices))
        if template is None:
            raise Fault("the report has no template")
        residual = self.posed(template, chain.image, chain.kept, chain.length)
        self.check_turn(chain, template)
        self.check_mirror(chain.closed)
        planar = self.rule.get("shape", "plane") == "plane"
        self.check_template_lengths(chain, template, shorter=planar)
        if planar:
            self.check_projection(chain, template)
        return residual

    def check_projection(self, chain, template):
        """The template is the chain, seen across its best-fit plane."""
        seen = project(chain.space)
        height, (x, y, z) = max(map(abs, seen.heights)), seen.spread
        uncertainty = min(1.0, 64 * EPSILON * base.ratio(x, y - z))  # of the plane, radians
        allowed = LIMIT * chain.length + uncertainty * height
        straight = y < 1.1 * NEARLY_STRAIGHT ** 2 * x
        if straight:  # then the plane is that of the surface
            allowed += 2 * max(math.hypot(p.imag, h) for p, h in zip(seen.image, seen.heights))
        views = [seen.image, [p.conjugate() for p in seen.image]]
        cosine = dot3(seen.normal, chain.surface_normal())
        if not chain.closed and not straight and abs(cosine) > CLEAR_COSINE:
            views = [views[(cosine < 0) != bool(self.entry["mirrored"])]]
        off = min(max(Pose(view, template, 1.0).distances(view, template)) for view in views)
        if not off <= allowed:
            self.fault(f"the template is {off:.3e} from the chain as projected to its best-fit plane, "
                       f"{allowed:.3e} allowed")

    # ---- region

    def region(self):
        flat, triangles = self.job.flat, self.job.feature(self.rule["feature"])["triangles"]
        images = collections.defaultdict(set)
        for t in triangles:
            for v, z in zip(flat.faces[t], flat.corner_uv[t]):
                images[v].add(z)
        self.hold(images)
        laid = self.laid_out(triangles, sorted(images))
        self.check_region_template(triangles, laid)
        size = math.sqrt(math.fsum(math.hypot(*normal(*flat.corners(t))) / 2 for t in triangles))
        corners = list(dict.fromkeys((v, p, z) for t, points in zip(triangles, laid)
                                     for v, p, z in zip(flat.faces[t], points, flat.corner_uv[t])))
        kept = [k for k, (v, _, _) in enumerate(corners) if v not in self.yielded]
        return self.posed([p for _, p, _ in corners], [z for _, _, z in corners], kept, size)

    def laid_out(self, triangles, vertices):
        """The template's corners of each triangle: it has a point a vertex, or, opened by a seam, three a triangle."""
        if self.entry["template"] is None:
            raise Fault("the report has no template")
        if len(self.entry["template"]) == 3 * len(triangles) > len(vertices):
            points = self.template(3 * len(triangles))
            return [tuple(points[k:k + 3]) for k in range(0, len(points), 3)]
        place = dict(zip(vertices, self.template(len(vertices))))
        return [tuple(place[v] for v in self.job.flat.faces[t]) for t in triangles]

    def check_region_template(self, triangles, places):
        flat, turned, distortion = self.job.flat, [], 0.0
        for t, laid in zip(triangles, places):
            solid = flat.corners(t)
            if base.orientation(*((z.real, z.imag) for z in laid)) <= 0:
                turned.append(t)
            for i in range(3):
                distortion = max(distortion, abs(abs(laid[i] - laid[i - 1]) / math.dist(solid[i], solid[i - 1]) - 1))
        self.note += f", the template changes lengths by {distortion:.1e}"
        if turned:
            self.fault(f"{len(turned)} triangles of the template are turned over or flat {turned[:5]}")

    # ---- relations

    def relation(self):
        directions = self.directions()
        if 0 in directions or len(directions) != 2:
            raise Fault("without two directions")
        angle = math.degrees(cmath.phase(directions[1] * directions[0].conjugate()))
        wanted = {"parallel": 0.0, "perpendicular": 90.0}.get(self.type)
        wanted, oriented = self.rule["degrees"] if wanted is None else wanted, self.rule.get("oriented", False)
        if not angle_error(angle, self.entry["degrees"], oriented) <= ANGLE_LIMIT:
            self.fault(f"{angle!r} degrees in the map, {self.entry['degrees']!r} in the report")
        return angle_error(angle, wanted, oriented)

    def directions(self):
        first = [1 + 0j] if self.type == "direction" else []
        if "edges" in self.rule or "edge" in self.rule:
            return first + [self.edge_direction(*edge) for edge in self.rule.get("edges", [self.rule.get("edge")])]
        return first + [self.feature_direction(name) for name in self.rule.get("features", [self.rule.get("feature")])]

    def feature_direction(self, name):
        measure = self.rule.get("measure", "line" if name in self.job.lines else "chord")
        by_side = self.job.line_yielded
        chain = Chain(self.job.flat, self.job.feature(name), self.side,
                      by_side.get((name, self.side), by_side.get((name, 0), ())))
        return line_through(chain.chosen(2)).direction if measure == "line" else chain.image[-1] - chain.image[0]

    def edge_direction(self, a, b):
        flat = self.job.flat
        t = flat.triangle_beside(a, b, self.side)
        if t is not None:
            return flat.uv_at(t, b) - flat.uv_at(t, a)
        ends = [flat.copies.get(v, ()) for v in (a, b)]  # embedding has split the edge
        if [len(copies) for copies in ends] != [1, 1]:
            raise Fault(f"{a}-{b} is no edge of the mesh, and its ends have {len(ends[0])} and {len(ends[1])} uv")
        (start,), (end,) = ends
        return end - start

    # ---- pin

    def pin(self):
        flat, distances = self.job.flat, []
        self.hold(self.rule["vertices"])
        for v, uv in zip(self.rule["vertices"], self.rule["uv"]):
            if v not in flat.copies:
                raise Fault(f"vertex {v} has no uv")
            distances.append(min(abs(z - complex(*uv)) for z in flat.copies[v]))
        kept = [k for k, v in enumerate(self.rule["vertices"]) if v not in self.yielded]
        return self.largest(distances, kept, flat.extent, 1)


# --------------------------------------------------------------------------------------------------------------------
# The whole

def check_entries(job):
    """Every constraint has an entry, on a seam two."""
    faults = [f"the report has an entry '{e['name']}', the constraint file has none" for e in job.entries
              if e["name"] not in job.rules]
    for name, rule in job.rules.items():
        sides = sorted(e.get("side") or 0 for e in job.entries if e["name"] == name)
        if sides not in ([0], [1, 2]):
            faults.append(f"{name}: sides {sides} in the report, one entry or the sides 1 and 2 needed")
        elif sides == [0] and rule["type"] in ("line", "circle", "curve") and is_seam(job, rule["feature"]):
            faults.append(f"{name}: its feature is a seam, and the report has one entry, not one a side")
    return faults


def is_seam(job, name):
    try:
        return Chain(job.flat, job.features[name], 0).is_seam()
    except (Fault, KeyError, IndexError, TypeError, ValueError):
        return False  # its own check says why


def check_groups(checks):
    """Free scales of a group are one."""
    groups, faults = collections.defaultdict(list), []
    for check in checks:
        if "scale_group" in check.rule and given_scale(check.rule) is None and check.factor is not None:
            groups[check.rule["scale_group"]].append(check)
    for name, members in groups.items():
        for check in members[1:]:
            if not abs(check.factor / members[0].factor - 1) <= 10 * LIMIT:
                faults.append(f"scale group '{name}': {members[0].factor!r} of {members[0].title}, "
                              f"{check.factor!r} of {check.title}")
    return faults


def check_yielded(checks):
    """Who yields leaves a vertex to someone."""
    faults = []
    for check in checks:
        rank = RANK.get(check.type, -1)  # relations hold nothing, so they have nothing to yield
        others = [other.held for other in checks if other is not check and RANK.get(other.type, 9) <= rank]
        free = sorted(check.yielded.difference(*others))
        if free:
            faults.append(f"{check.title}: yielded vertices that no constraint of its rank or above holds {free[:5]}")
    return faults


def run(constraints, flat, report):
    """All faults; prints a line an entry."""
    try:
        job = Job(constraints, flat, report)
        faults = check_entries(job)
    except (KeyError, TypeError, AttributeError) as error:
        return [f"a field is missing or of another type: {error!r}"]
    checks = [Check(job, job.rules[e["name"]], e) for e in job.entries if e["name"] in job.rules]
    for check in checks:
        check.run()
        faults += check.faults
    return faults + check_groups(checks) + check_yielded(checks)


def check(arguments):
    """Number of faults."""
    faults = run(read_json(arguments.constraints), read_flat(arguments.flat), read_json(arguments.report))
    print("\n".join(f"fault: {text}" for text in faults) or "all agree")
    return len(faults)


def main():
    parser = argparse.ArgumentParser(description="Recomputes from the files alone how a map keeps its constraints.")
    parser.add_argument("constraints", help="constraint file (.json)")
    parser.add_argument("flat", help="mesh with uv as planish wrote it (.ply .obj, .gz)")
    parser.add_argument("report", help="report of the same run (.json)")
    try:
        return 1 if check(parser.parse_args()) else 0
    except Unreadable as error:
        print(error, file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
