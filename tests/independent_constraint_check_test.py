#!/usr/bin/env python3
"""The independent check of constraints agrees with closed forms, and finds what is put wrong into map or report."""
import argparse
import cmath
import contextlib
import copy
import gzip
import io
import json
import math
import os
import struct
import tempfile
import unittest

import independent_constraint_check as checker

TURN, SHIFT = cmath.rect(1, 0.4), 3 - 2j  # of the maps below
DEGREES = math.degrees(0.4)


class Scenario:
    """A map with its constraint file and report. uv: u + i v of each vertex; corner_uv: of each corner, with seams."""

    def __init__(self, points, faces, uv, corner_uv=None):
        self.points, self.faces, self.uv, self.corner_uv = points, faces, list(uv), corner_uv
        self.rules, self.entries, self.features, self.extra = [], [], {}, {}

    def chain(self, name, vertices, closed=False):
        self.features[name] = {"vertices": list(vertices), "closed": closed, "length": 1.0, "max_deviation": 0.0}

    def add(self, rule, **entry):
        """A constraint and its entry; `sides` gives several."""
        named = {key: rule[key] for key in ("type", "feature", "features", "edges", "edge", "vertices") if key in rule}
        self.rules.append(rule)
        for side in entry.pop("sides", [None]):
            own = copy.deepcopy({**named, **({"side": side} if side else {}), **entry})
            self.entries.append({
                "name": rule.get("name", checker.default_name(rule)), "residual": 1e-16, "residual_abs": 1e-15,
                "scale": None, "orientation": None, "template": None, "mirrored": None, "planarity": None,
                "mismatch": None, "yielded": [], "degrees": None, **own})

    def entry(self, name, side=None):
        return next(e for e in self.entries if e["name"] == name and e.get("side") == side)

    def corners(self):
        return self.corner_uv or [tuple(self.uv[v] for v in face) for face in self.faces]

    def constraints(self):
        return {"version": 1, "features": {name: {} for name in self.features}, "constraints": self.rules, **self.extra}

    def report(self):
        return {"version": 1, "features": self.features, "constraints": self.entries}


def pairs(points):
    return [[z.real, z.imag] for z in points]


def obj_text(scenario):
    lines = ["v %r %r %r" % tuple(map(float, p)) for p in scenario.points]
    for face, images in zip(scenario.faces, scenario.corners()):
        lines += ["vt %r %r" % (z.real, z.imag) for z in images]
        lines.append("f " + " ".join(f"{v + 1}/{k}" for v, k in zip(face, (-3, -2, -1))))
    return "\n".join(lines + ["g row", "l 1 2"]) + "\n"


def ply_bytes(scenario):
    torn = scenario.corner_uv is not None
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(scenario.points)}\n" +
            "".join(f"property double {c}\n" for c in ("xyz" if torn else "xyzst")) + "property int origin_triangle\n" +
            f"element face {len(scenario.faces)}\nproperty list uchar int vertex_indices\n" +
            ("property list uchar double texcoord\n" if torn else "") + "property int origin\nelement edge 1\n" +
            "property int vertex1\nproperty int vertex2\nproperty int feature\nend_header\n")
    out = [head.encode()]
    for p, z in zip(scenario.points, scenario.uv):
        uv = () if torn else (z.real, z.imag)
        out.append(struct.pack(f"<{3 + len(uv)}di", *p, *uv, 0))
    for face, images in zip(scenario.faces, scenario.corners()):
        texcoord = struct.pack("<B6d", 6, *(x for z in images for x in (z.real, z.imag))) if torn else b""
        out.append(struct.pack("<B3i", 3, *face) + texcoord + struct.pack("<i", 0))
    return b"".join(out) + struct.pack("<3i", 0, 1, 0)


# --------------------------------------------------------------------------------------------------------------------
# Closed forms

COLUMNS, ROWS = (0.0, 1.0, 1.7, 3.0, 4.1), (0.0, 0.9, 2.0, 2.6)


def grid_faces(columns, rows):
    return [f for j in range(rows - 1) for i in range(columns - 1) for a in [j * columns + i]
            for f in ((a, a + 1, a + columns + 1), (a, a + columns + 1, a + columns))]


def bent_grid():
    """5 x 4 vertices, bent along the grid's columns: developable, so the flat grid is an isometric map."""
    profile = [(0.0, 0.0)]
    for step, direction in zip((b - a for a, b in zip(COLUMNS, COLUMNS[1:])), (0.0, 0.5, 0.9, 0.2)):
        x, z = profile[-1]
        profile.append((x + step * math.cos(direction), z + step * math.sin(direction)))
    points = [(x, y, z) for y in ROWS for x, z in profile]
    return points, grid_faces(len(COLUMNS), len(ROWS)), [complex(x, y) for y in ROWS for x in COLUMNS]


def grid_scenario():
    """All kinds of constraints on the bent grid but circles."""
    points, faces, flat = bent_grid()
    s = Scenario(points, faces, [SHIFT + TURN * z for z in flat])
    s.chain("row", range(5))
    s.chain("column", (0, 5, 10, 15))
    s.chain("right", (4, 9, 14, 19))
    s.chain("ring", (6, 7, 8, 13, 12, 11), closed=True)
    s.features["plate"] = {"triangles": [t for t, f in enumerate(faces) if min(f) % 5 >= 2 and min(f) >= 5]}
    plate = sorted({v for t in s.features["plate"]["triangles"] for v in faces[t]})
    s.add({"type": "line", "feature": "row"}, scale=1.0, orientation=DEGREES, template=pairs(flat[:5]))
    s.add({"name": "side", "type": "line", "feature": "column", "lengths": "scale"}, scale=1.0,
          orientation=DEGREES + 90)
    s.add({"type": "curve", "feature": "ring", "shape": "geodesic"}, scale=1.0, orientation=DEGREES,
          template=pairs(flat[v] for v in (6, 7, 8, 13, 12, 11)))
    s.add({"type": "region", "feature": "plate"}, scale=1.0, orientation=DEGREES,
          template=pairs(flat[v] for v in plate))
    s.add({"type": "perpendicular", "features": ["column", "row"]}, degrees=90.0)
    s.add({"type": "parallel", "features": ["column", "right"], "measure": "chord"}, degrees=0.0)
    s.add({"type": "direction", "feature": "row", "degrees": DEGREES, "oriented": True}, degrees=DEGREES)
    s.add({"type": "angle", "edges": [[0, 5], [0, 1]], "degrees": 270, "oriented": True}, degrees=270.0)
    s.add({"type": "direction", "edge": [5, 0], "degrees": 90 + DEGREES}, degrees=90 + DEGREES)
    s.add({"type": "pin", "vertices": [3, 18], "uv": pairs((s.uv[3], s.uv[18]))})
    return s


def fan_scenario(rim, heights, uv, closed=True, name="rim"):
    """Vertex 0 within a rim of points in the plane with heights; the rim as a chain."""
    n = len(rim)
    faces = [(0, 1 + k, 1 + (k + 1) % n) for k in range(n)]
    points = [(0.1, 0.0, 0.3)] + [(z.real, z.imag, h) for z, h in zip(rim, heights)]
    s = Scenario(points, faces, [0.05 + 0.02j] + list(uv))
    s.chain(name, range(1, n + 1), closed)
    return s


RIM = [cmath.rect(2.0, a) for a in (0.0, 0.7, 1.2, 2.4, 3.3, 4.0, 5.5)]


def circle_scenario(scale=1.5, rule=None):
    """A rim that is a circle in space and in the map."""
    s = fan_scenario(RIM, [0.0] * 7, [SHIFT + scale * TURN * z for z in RIM])
    s.add({"type": "circle", "feature": "rim", **(rule or {})}, scale=scale, orientation=DEGREES, template=pairs(RIM))
    return s


def arc_scenario(sweep, rule=None, flip=False, scale=1.5, sweep_in_space=100.0):
    """Six equal chords: an arc in space and one of another sweep in the map."""
    angles = [math.radians(k / 5) for k in range(6)]
    space = [cmath.rect(2.0, sweep_in_space * a) for a in angles]
    radius = 2.0 * math.sin(math.radians(sweep_in_space / 10)) / math.sin(math.radians(sweep / 10))
    laid = [cmath.rect(radius, -sweep * a if flip else sweep * a) for a in angles]
    s = fan_scenario(space, [0.0] * 6, [SHIFT + scale * TURN * z for z in laid], closed=False)
    s.add({"type": "circle", "feature": "rim", **(rule or {})}, scale=scale, orientation=DEGREES, template=pairs(laid),
          mirrored=flip)
    return s


def curve_scenario(closed, scale=1.0, rule=None, mirrored=False):
    """Eight points of a circle, alternately above and below: their best-fit plane is that of the circle."""
    rim = [cmath.rect(1.0, k * math.pi / 4) for k in range(8)]
    seen = [z.conjugate() for z in rim] if mirrored else rim
    s = fan_scenario(rim, [(-1) ** k * 0.05 for k in range(8)], [SHIFT + scale * TURN * z for z in seen], closed)
    s.add({"type": "curve", "feature": "rim", **(rule or {})}, scale=scale, orientation=DEGREES, template=pairs(seen),
          mirrored=mirrored, planarity=0.05)
    return s


def seam_scenario():
    """A flat grid of 3 x 3 vertices, opened along its middle column; the right half is turned by 0.3 in the map."""
    points = [(float(i), float(j), 0.0) for j in range(3) for i in range(3)]
    faces = grid_faces(3, 3)
    left, right = [complex(p[0], p[1]) for p in points], [5 + cmath.rect(1, 0.3) * complex(p[0], p[1]) for p in points]
    half = [left if min(f) % 3 == 0 else right for f in faces]
    s = Scenario(points, faces, left, [tuple(uv[v] for v in f) for f, uv in zip(faces, half)])
    s.chain("cut", (1, 4, 7))
    s.add({"type": "line", "feature": "cut"}, scale=1.0, sides=(1, 2))
    s.entry("line cut", 1)["orientation"], s.entry("line cut", 2)["orientation"] = 90.0, 90 + math.degrees(0.3)
    s.add({"type": "direction", "feature": "cut", "degrees": 90}, degrees=90.0, sides=(1,))
    s.entries[-1].pop("side")
    s.add({"type": "angle", "edges": [[1, 4], [1, 2]], "degrees": math.degrees(math.pi / 2 - 0.3)},
          degrees=math.degrees(math.pi / 2 - 0.3))
    s.add({"type": "pin", "vertices": [4], "uv": pairs([right[4]])})
    s.extra["seams"] = ["cut"]
    return s


# --------------------------------------------------------------------------------------------------------------------

class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def write(self, name, content):
        path = os.path.join(self.folder, name)
        with open(path, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return path

    def output(self, scenario, flat=None):
        arguments = argparse.Namespace(
            constraints=self.write("constraints.json", json.dumps(scenario.constraints())),
            flat=flat or self.write("flat.ply", ply_bytes(scenario)),
            report=self.write("report.json", json.dumps(scenario.report())))
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            self.count = checker.check(arguments)
        return out.getvalue().splitlines()

    def faults(self, scenario, flat=None):
        return [line for line in self.output(scenario, flat) if line.startswith("fault: ")]

    def agrees(self, scenario, flat=None):
        self.assertEqual(self.faults(scenario, flat), [])

    def finds(self, scenario, *texts):
        """Exactly these faults, in this order."""
        faults = self.faults(scenario)
        self.assertEqual(len(faults), len(texts), faults)
        self.assertEqual(self.count, len(texts))
        for fault, text in zip(faults, texts):
            self.assertIn(text, fault)


class Files(Case):
    def test_every_kind_of_file_agrees(self):
        for scenario in (grid_scenario(), seam_scenario(), circle_scenario()):
            self.agrees(scenario)
            self.agrees(scenario, self.write("flat.obj", obj_text(scenario)))
            self.agrees(scenario, self.write("flat.obj.gz", gzip.compress(obj_text(scenario).encode())))
            self.agrees(scenario, self.write("flat.ply.gz", gzip.compress(ply_bytes(scenario))))

    def test_a_line_is_printed_for_each_constraint(self):
        lines = self.output(grid_scenario())
        self.assertEqual([line.split(":")[0] for line in lines],
                         ["line row", "side", "curve ring", "region plate", "perpendicular column row",
                          "parallel column right", "direction row", "angle 0-5 0-1", "direction 5-0", "pin 3 18",
                          "all agree"])

    def test_names_are_those_of_planish(self):
        for rule, name in (({"type": "pin", "vertices": [3, 4, 5, 6, 9]}, "pin 3 4 5 and 2 more"),
                           ({"type": "angle", "edges": [[3, 8], [20, 21]]}, "angle 3-8 20-21"),
                           ({"type": "direction", "edge": [3, 8]}, "direction 3-8"),
                           ({"type": "parallel", "features": ["left sill", "b"]}, "parallel left sill b")):
            self.assertEqual(checker.default_name(rule), name)

    def test_files_that_cannot_be_read_are_named(self):
        s = grid_scenario()
        for flat in (os.path.join(self.folder, "missing.ply"), self.write("cut.ply", ply_bytes(s)[:-20 * 13]),
                     self.write("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")):
            with self.assertRaises(checker.Unreadable):
                self.output(s, flat)
        s.uv[0] = complex(math.nan, 0)
        with self.assertRaises(checker.Unreadable):
            self.output(s)


class Entries(Case):
    def test_each_constraint_needs_its_entry(self):
        s = grid_scenario()
        s.entries = [e for e in s.entries if e["name"] != "side"]
        self.finds(s, "side: sides [] in the report")
        s.entries.append({**s.entries[0], "name": "other"})
        self.finds(s, "an entry 'other', the constraint file has none", "side: sides []")

    def test_entries_say_what_the_file_says(self):
        s = grid_scenario()
        s.entry("line row")["type"] = "curve"
        self.finds(s, "line row: 'type' is curve")
        s = grid_scenario()
        s.entry("perpendicular column row")["features"].reverse()
        self.finds(s, "'features' is ['row', 'column']")
        s = grid_scenario()
        del s.features["right"]
        self.finds(s, "parallel column right: the report has no feature 'right'")

    def test_reported_residuals_are_held_against_the_limit(self):
        for name, wrong in (("line row", 2e-9), ("pin 3 18", 2e-9), ("direction row", 2e-7)):
            s = grid_scenario()
            s.entry(name)["residual"] = wrong
            self.finds(s, f"{name}: reported residual {wrong:.3e}")
        s = grid_scenario()
        s.entry("direction row")["residual"] = 5e-8
        self.agrees(s)
        s.entry("line row")["residual"] = math.nan
        s.entry("side")["residual"] = None
        s.entry("curve ring")["residual_abs"] = -1.0
        self.finds(s, "line row: reported residual nan", "side: a field is missing", "residual_abs is -1.0")

    def test_what_means_nothing_is_a_fault(self):
        s = grid_scenario()
        s.rules[-1]["vertices"], s.entries[-1]["vertices"] = [3, 99], [3, 99]
        s.rules[-1]["name"] = "pin 3 18"
        self.finds(s, "pin 3 18: vertex 99 has no uv")
        s = grid_scenario()
        s.rules[0]["type"] = s.entries[0]["type"] = "spiral"
        s.rules[0]["name"] = "line row"
        self.finds(s, "line row: type 'spiral' is not known here")
        s = grid_scenario()
        s.entry("direction row")["yielded"] = [2]
        self.finds(s, "direction row: yielded vertices that no constraint of its rank or above holds [2]")
        s = grid_scenario()
        s.features["row"]["vertices"] = [0]
        self.finds(s, "line row: a chain of fewer than two vertices", "perpendicular column row", "direction row")

    def test_missing_fields_are_faults(self):
        for name, key in (("line row", "residual"), ("line row", "scale"), ("curve ring", "template"),
                          ("region plate", "orientation"), ("direction row", "degrees")):
            s = grid_scenario()
            del s.entry(name)[key]
            self.finds(s, f"{name}: a field is missing or has no meaning: KeyError('{key}')")

    def test_every_wrong_number_is_found(self):
        for k, entry in enumerate(grid_scenario().entries):
            for key in ("scale", "orientation", "degrees"):
                if entry[key] is not None:
                    s = grid_scenario()
                    s.entries[k][key] += {"scale": 1e-7, "orientation": 1e-5, "degrees": 1e-6}[key]
                    with self.subTest(entry["name"], key=key):
                        self.finds(s, "in the report")

    def test_every_moved_vertex_is_found(self):
        whole = grid_scenario()
        bound = {v for f in whole.features.values() for v in f.get("vertices", ())}
        bound |= {v for t in whole.features["plate"]["triangles"] for v in whole.faces[t]} | {18}
        for v in range(len(whole.uv)):
            for step in (1e-7, -1e-7j):
                s = grid_scenario()
                s.uv[v] += step
                with self.subTest(v=v, step=step):
                    self.assertEqual(bool(self.faults(s)), v in bound)
        self.assertLess(len(bound), len(whole.uv))


class Lines(Case):
    def row(self, rule, image, **entry):
        points, faces, flat = bent_grid()
        s = Scenario(points, faces, [SHIFT + TURN * z for z in flat])
        s.uv[:5] = [SHIFT + TURN * z for z in image]
        s.chain("row", range(5))
        s.add({"type": "line", "feature": "row", **rule}, **entry)
        return s

    def test_lengths(self):
        stretched = [1.2 * x for x in COLUMNS]
        uneven = [x * x for x in COLUMNS]
        self.agrees(self.row({"lengths": "scale"}, stretched, scale=1.2))
        self.agrees(self.row({"lengths": "scale", "scale": 1.2}, stretched))
        self.agrees(self.row({"lengths": "free"}, uneven, orientation=DEGREES))
        self.finds(self.row({}, stretched), "line row: residual 6.341e-02")
        self.finds(self.row({"lengths": "scale"}, stretched, scale=1.1), "scale 1.2", )
        self.finds(self.row({"lengths": "scale"}, stretched), "the free scale is not reported")
        self.finds(self.row({"lengths": "scale", "scale": 1.1}, stretched, scale=1.2), "1.1 in the constraint file")
        self.finds(self.row({"lengths": "scale"}, uneven, scale=4.1), "residual")
        self.finds(self.row({}, COLUMNS, scale=1.01), "1.01 in the report")

    def test_order(self):
        swapped = [0.0, 1.7, 1.0, 3.0, 4.1]
        self.finds(self.row({"lengths": "free"}, swapped), "1 steps against the order along the line [(1, 2)]")
        self.finds(self.row({"lengths": "free"}, [0.0, 1.0, 1.0, 3.0, 4.1]), "[(1, 2)]")
        self.agrees(self.row({"lengths": "free"}, [-x for x in COLUMNS], orientation=DEGREES - 180))

    def test_a_closed_chain_is_no_line(self):
        s = self.row({"lengths": "free"}, COLUMNS)
        s.chain("row", (0, 1, 6), closed=True)
        self.finds(s, "against the order", "residual")

    def test_a_step_without_an_edge(self):
        s = self.row({}, COLUMNS)
        s.chain("row", (0, 1, 3))
        self.finds(s, "1 and 3 follow each other")

    def test_free_scales_of_a_group_are_one(self):
        points, faces, flat = bent_grid()
        s = Scenario(points, faces, [complex(1.2 * z.real, 1.2 * z.imag) for z in flat])
        s.chain("row", range(5))
        s.chain("column", (0, 5, 10, 15))
        for name in ("row", "column"):
            s.add({"type": "line", "feature": name, "lengths": "scale", "scale_group": "g"}, scale=1.2)
        self.agrees(s)
        s.uv = [complex(z.real, 1.1 * z.imag) for z in s.uv]
        s.entries[1]["scale"] = 1.32
        self.finds(s, "scale group 'g': 1.2")


class Circles(Case):
    def test_circles_agree(self):
        self.agrees(circle_scenario())
        self.agrees(circle_scenario(rule={"scale": 1.5}))
        self.agrees(circle_scenario(rule={"radius": 3.0}))
        s = circle_scenario()
        s.entries[0]["template"] = None
        self.agrees(s)

    def test_radius_and_scale(self):
        self.finds(circle_scenario(rule={"radius": 3.001}), "residual")
        self.finds(circle_scenario(rule={"scale": 1.4}), "1.4 in the constraint file")

    def test_moved_vertices(self):
        for step in (1e-7, 1e-7j):
            s = circle_scenario()
            s.uv[3] += step
            s.entries[0]["orientation"] = None
            self.assertIn("residual", self.faults(s)[-1])

    def test_a_circle_that_lies_mirrored(self):
        s = circle_scenario()
        s.uv = [z.conjugate() for z in s.uv]
        s.entries[0]["orientation"] = None
        self.finds(s, "signed area", "residual")
        s.entries[0]["template"] = None
        self.agrees(s)  # nothing says which side is up

    def test_edges_out_of_proportion(self):
        s = circle_scenario()
        s.uv[3] = SHIFT + 1.5 * TURN * cmath.rect(2.0, 1.3)
        s.entries[0]["template"] = s.entries[0]["orientation"] = None
        self.finds(s, "1.5 in the report", "residual")

    def test_once_around(self):
        star = [cmath.rect(2.0, 4 * math.pi * k / 5) for k in range(5)]
        ring = [cmath.rect(1.0, 2 * math.pi * k / 5) for k in range(5)]
        s = fan_scenario(ring, [0.0] * 5, star)
        scale = abs(star[1] - star[0]) / abs(ring[1] - ring[0])
        s.add({"type": "circle", "feature": "rim"}, scale=scale)
        self.finds(s, "the chain goes 2.000 times around")
        folded = [cmath.rect(1, math.pi / 2 * k) for k in (0, 1, 2, 3, 2, 3)]  # there, back, and there again
        ring = [cmath.rect(1.0, 2 * math.pi * k / 6) for k in range(6)]
        s = fan_scenario(ring, [0.0] * 6, folded)
        s.add({"type": "circle", "feature": "rim"}, scale=math.sqrt(2))
        self.assertTrue(any("bends both ways" in fault for fault in self.faults(s)))

    def test_centre_outside(self):
        rim = [cmath.rect(2.0, a) for a in (0.3, 0.7, 1.2, 1.9)]
        s = fan_scenario(rim, [0.0] * 4, rim)
        s.add({"type": "circle", "feature": "rim", "scale": 1}, scale=1.0, template=pairs(rim), orientation=0.0)
        self.agrees(s)

    def test_arcs_agree(self):
        self.agrees(arc_scenario(100.0))
        self.agrees(arc_scenario(60.0, {"sweep_degrees": 60}))
        self.agrees(arc_scenario(0.3, {"sweep_degrees": 0.3}))
        self.agrees(arc_scenario(359.0, {"sweep_degrees": 359}))
        self.agrees(arc_scenario(60.0, {"sweep_degrees": 60, "mirror": True}, flip=True))
        radius = 1.5 * 2.0 * math.sin(math.radians(10)) / math.sin(math.radians(6))
        self.agrees(arc_scenario(60.0, {"sweep_degrees": 60, "radius": radius}))

    def test_arcs_that_sweep_too_far(self):
        self.finds(arc_scenario(60.001, {"sweep_degrees": 60}), "residual")
        self.finds(arc_scenario(100.001), "the template sweeps 100.001")
        self.finds(arc_scenario(60.0, {"sweep_degrees": 60, "radius": 5.0}), "radius", "residual")
        s = arc_scenario(100.0)
        s.uv[1:] = arc_scenario(100.001).uv[1:]
        s.entries[0]["orientation"] = None
        self.finds(s, "residual")

    def test_arcs_need_template_and_side(self):
        s = arc_scenario(100.0)
        s.entries[0]["template"] = None
        s.entries[0]["orientation"] = None
        self.finds(s, "an arc without its template")
        self.finds(arc_scenario(60.0, {"sweep_degrees": 60, "mirror": True}), "'mirror' is True")
        s = arc_scenario(60.0, {"sweep_degrees": 60})
        s.uv = arc_scenario(60.0, flip=True).uv
        s.entries[0]["orientation"] = None
        self.finds(s, "residual")

    def test_template_lengths(self):
        s = circle_scenario()
        s.entries[0]["template"] = pairs(1.01 * z for z in RIM)
        self.finds(s, "an edge of the template is off by")
        s.entries[0]["template"] = pairs(RIM[:-1])
        self.finds(s, "the template has 6 points, the feature 7 vertices")


class Curves(Case):
    def test_curves_agree(self):
        for closed in (True, False):
            self.agrees(curve_scenario(closed))
            self.agrees(curve_scenario(closed, 1.3, {"scale": "free"}))
            self.agrees(curve_scenario(closed, 1.3, {"scale": 1.3}))
        self.agrees(curve_scenario(False, rule={"mirror": True}, mirrored=True))

    def test_scale(self):
        self.finds(curve_scenario(True, 1.3), "1.3 in the report", "residual")
        self.finds(curve_scenario(True, 1.3, {"scale": 1.2}), "1.3 in the report", "residual")
        s = curve_scenario(True, 1.3, {"scale": "free"})
        s.entries[0]["scale"] = None
        self.finds(s, "the free scale is not reported")

    def test_mirrored_maps(self):
        s = curve_scenario(False)
        s.uv = [z.conjugate() for z in s.uv]
        s.entries[0]["orientation"] = None
        self.finds(s, "residual")
        s = curve_scenario(True)
        s.uv = [z.conjugate() for z in s.uv]
        s.entries[0]["orientation"] = None
        self.finds(s, "signed area", "residual")

    def test_mirrored_templates(self):
        self.finds(curve_scenario(False, rule={"mirror": False}, mirrored=True), "'mirror' is False")
        s = curve_scenario(False, mirrored=True)
        s.entries[0]["mirrored"] = False
        self.finds(s, "from the chain as projected to its best-fit plane")

    def test_templates_that_are_no_projection(self):
        s = curve_scenario(True)
        s.points = [(x, y, 0.0) for x, y, _ in s.points]
        self.agrees(s)
        s.entries[0]["template"] = pairs(complex(0.99 * x, y) for x, y in s.entries[0]["template"])
        self.finds(s, "from the chain as projected", "residual")
        s.entries[0]["template"] = pairs(complex(1.1 * x, y) for x, y in curve_scenario(True).entries[0]["template"])
        self.finds(s, "an edge of the template", "from the chain as projected", "residual")
        s.entries[0]["template"] = None
        self.finds(s, "the report has no template")

    def test_a_slanted_plane(self):
        s = curve_scenario(False)
        a, b = math.cos(0.6), math.sin(0.6)
        s.points = [(a * x - b * z, y, b * x + a * z) for x, y, z in s.points]
        self.agrees(s)
        s.points = [(x, -z, y) for x, y, z in s.points]
        self.agrees(s)

    def test_nearly_straight(self):
        points, faces, flat = bent_grid()
        s = Scenario(points, faces, flat)
        s.chain("right", (4, 9, 14, 19))
        s.add({"type": "curve", "feature": "right"}, scale=1.0, template=pairs([0, 0.9, 2.0, 2.6]), mirrored=False)
        self.agrees(s)
        s.entries[0]["template"] = pairs([0, 0.9, 2.0, 2.5])
        self.finds(s, "as projected", "residual")

    def test_geodesic(self):
        s = grid_scenario()
        s.rules[2]["shape"] = "plane"
        self.finds(s, "curve ring: the template is")
        s = grid_scenario()
        s.entry("curve ring")["template"][0][0] += 1e-6
        s.entry("curve ring")["orientation"] = None
        self.finds(s, "an edge of the template is off", "curve ring: residual")


class Regions(Case):
    def test_scale(self):
        points, faces, flat = bent_grid()
        for given, wrong in ((1.2, 1.1), ("free", None)):
            s = Scenario(points, faces, [SHIFT + 1.2 * TURN * z for z in flat])
            s.features["all"] = {"triangles": list(range(len(faces)))}
            s.add({"type": "region", "feature": "all", "scale": given}, scale=1.2, template=pairs(flat))
            self.agrees(s)
            s.entries[0]["scale"] = wrong
            self.finds(s, "1.1 in the report" if wrong else "the free scale is not reported")

    def test_a_map_that_is_mirrored(self):
        s = grid_scenario()
        s.uv = [z.conjugate() for z in s.uv]
        self.assertTrue(any("region plate: residual" in fault for fault in self.faults(s)))

    def test_templates_that_flip(self):
        s = grid_scenario()
        template = s.entry("region plate")["template"]
        template[:] = [[-x, y] for x, y in template]
        faults = self.faults(s)
        self.assertTrue(any("triangles of the template are turned over" in fault for fault in faults), faults)

    def test_distortion_is_printed(self):
        s = grid_scenario()
        s.entry("region plate")["template"] = [[1.01 * x, y] for x, y in s.entry("region plate")["template"]]
        line = next(line for line in self.output(s) if line.startswith("region plate"))
        self.assertIn("the template changes lengths by 1.0e-02", line)


class Relations(Case):
    def relation(self, rule, degrees, second=1j):
        """A row along u and a column along `second`, both chords."""
        points, faces, flat = bent_grid()
        s = Scenario(points, faces, [z.real + second * z.imag for z in flat])
        s.chain("row", range(5))
        s.chain("column", (0, 5, 10, 15))
        s.add({"features": ["row", "column"], **rule}, degrees=degrees)
        return s

    def test_undirected_angles(self):
        second = cmath.rect(1, math.radians(70))
        for degrees in (70, 110):
            self.agrees(self.relation({"type": "angle", "degrees": degrees}, 70.0, second))
            self.agrees(self.relation({"type": "angle", "degrees": degrees}, 110.0, second.conjugate()))
        self.finds(self.relation({"type": "angle", "degrees": 70.001}, 70.0, second), "residual 1.000e-03 degrees")
        self.finds(self.relation({"type": "perpendicular"}, 70.0, second), "residual 2.000e+01 degrees")
        self.finds(self.relation({"type": "parallel"}, 70.0, second), "residual 7.000e+01 degrees")

    def test_oriented_angles(self):
        second = cmath.rect(1, math.radians(70))
        self.agrees(self.relation({"type": "angle", "degrees": 70, "oriented": True}, 70.0, second))
        self.agrees(self.relation({"type": "angle", "degrees": 250, "oriented": True}, 250.0, -second))
        self.finds(self.relation({"type": "angle", "degrees": 290, "oriented": True}, 70.0, second),
                   "residual 1.400e+02")
        self.agrees(self.relation({"type": "perpendicular", "oriented": True}, 90.0))
        self.finds(self.relation({"type": "perpendicular", "oriented": True}, -90.0, -1j), "residual 1.800e+02")
        self.agrees(self.relation({"type": "perpendicular"}, -90.0, -1j))

    def test_measure(self):
        s = self.relation({"type": "angle", "degrees": 90, "measure": "line"}, 90.0)
        s.uv[5] += 0.1  # bends the column, keeps its chord
        self.assertEqual(len(self.faults(s)), 2)
        s.rules[0]["measure"] = "chord"
        self.agrees(s)
        del s.rules[0]["measure"]
        self.agrees(s)
        s.add({"type": "line", "feature": "column", "lengths": "free"})
        self.assertEqual(len(self.faults(s)), 3)  # now the column counts by its line

    def test_directions(self):
        s = self.relation({"type": "parallel"}, 90.0)
        s.rules, s.entries = [], []
        s.add({"type": "direction", "feature": "column", "degrees": 90, "oriented": True}, degrees=90.0)
        s.add({"type": "direction", "edge": [5, 0], "degrees": 270, "oriented": True}, degrees=-90.0)
        s.add({"type": "direction", "edge": [1, 0], "degrees": 0}, degrees=180.0)
        self.agrees(s)
        s.uv = [1j * z for z in s.uv]
        self.assertEqual(len(self.faults(s)), 6)

    def test_nothing_to_measure(self):
        s = self.relation({"type": "angle", "degrees": 90}, 90.0, 0)
        self.finds(s, "without two directions")
        s = self.relation({"type": "parallel"}, 90.0)
        s.rules, s.entries = [], []
        s.add({"type": "direction", "edge": [0, 99], "degrees": 0}, degrees=0.0)
        self.finds(s, "0-99 is no edge of the mesh")


class Seams(Case):
    def move(self, s, triangle_side, step):
        """Moves vertex 4 on one side of the seam."""
        for t, face in enumerate(s.faces):
            if 4 in face and (min(face) % 3 == 0) == (triangle_side == 1):
                s.corner_uv[t] = tuple(z + step if v == 4 else z for v, z in zip(face, s.corner_uv[t]))

    def test_sides_are_told_apart(self):
        for side in (1, 2):
            s = seam_scenario()
            self.move(s, side, 1e-6)
            faults = self.faults(s)
            self.assertTrue(faults)
            self.assertEqual({f"(side {k})" in " ".join(faults) for k in (1, 2)}, {True, False})
            self.assertIn(f"line cut (side {side}): residual", " ".join(faults))

    def test_each_side_needs_its_entry(self):
        s = seam_scenario()
        s.entries.remove(s.entry("line cut", 2))
        self.finds(s, "line cut: sides [1] in the report")
        del s.entries[0]["side"]
        self.finds(s, "its feature is a seam, and the report has one entry")

    def test_a_pin_holds_one_of_the_copies(self):
        s = seam_scenario()
        s.rules[-1]["uv"] = pairs([seam_scenario().uv[4]])
        self.agrees(s)
        s.rules[-1]["uv"][0][0] += 1e-6
        self.finds(s, "pin 4: residual")

    def test_a_chain_across_a_seam(self):
        s = seam_scenario()
        s.chain("across", (3, 4, 5))
        s.add({"type": "line", "feature": "across"}, scale=1.0)
        self.finds(s, "line across: the map is torn across the chain at vertex 4")


class Yielding(Case):
    def scenario(self, by=1e-4):
        """The plate's lower border follows a line that lies lower than the plate's template."""
        s = grid_scenario()
        s.chain("border", (7, 8, 9))
        s.add({"type": "line", "feature": "border", "lengths": "scale", "scale": 1}, scale=1.0)
        for v in (7, 8, 9):
            s.uv[v] -= by * 1j * TURN
        s.rules = [r for r in s.rules if r.get("feature") in ("plate", "border")]
        s.entries = [e for e in s.entries if e.get("feature") in ("plate", "border")]
        s.entry("region plate").update(yielded=[7, 8, 9], orientation=None)
        return s

    def test_yielded_vertices_are_left_out(self):
        s = self.scenario()
        self.agrees(s)
        self.assertIn("3 of 9 yielded", " ".join(self.output(s)))
        s.entry("region plate")["yielded"] = [7, 8]
        self.finds(s, "region plate: residual")
        s = self.scenario()
        s.uv[13] += 1e-7
        self.finds(s, "region plate: residual")

    def test_they_yield_to_someone_and_not_far(self):
        s = self.scenario()
        s.entry("region plate")["yielded"].append(13)
        self.finds(s, "region plate: yielded vertices that no constraint of its rank or above holds [13]")
        s = self.scenario()
        s.entry("region plate")["yielded"].append(0)
        self.finds(s, "vertices that are not its own are yielded: [0]", "no constraint of its rank")
        s = self.scenario()
        s.entry("region plate")["yielded"], s.entry("line border")["yielded"] = [], [7]
        self.finds(s, "region plate: residual", "line border: yielded vertices that no")
        self.finds(self.scenario(0.05), "a yielded vertex strays by 5.0")

    def test_one_vertex_or_none_is_left(self):
        for kept in ([], [9]):
            s = grid_scenario()
            s.rules, s.entries = [], []
            s.chain("border", (7, 8, 9))
            s.add({"type": "curve", "feature": "border", "shape": "geodesic", "scale": "free"}, scale=1.0,
                  template=pairs([0, 1.3, 2.4001]), mirrored=False, yielded=[v for v in (7, 8, 9) if v not in kept])
            self.finds(s, "an edge of the template is off by 1.0", "curve border: yielded vertices that no")
            s.add({"type": "line", "feature": "border"}, scale=1.0)
            self.finds(s, "an edge of the template is off by 1.0")

    def test_a_circle_that_yields_to_a_pin(self):
        s = circle_scenario()
        s.uv[3] += 1e-4
        s.entries[0]["orientation"] = None
        s.add({"type": "pin", "vertices": [3], "uv": pairs([s.uv[3]])})
        self.finds(s, "1.5 in the report", "circle rim: residual")
        s.entries[0]["yielded"] = [3]
        self.agrees(s)

    def test_a_line_that_yields_gives_its_direction_without_it(self):
        s = grid_scenario()
        s.uv[2] += 1e-4j * TURN
        s.rules, s.entries = s.rules[:1] + s.rules[6:7], s.entries[:1] + s.entries[6:7]
        s.add({"type": "pin", "vertices": [2], "uv": pairs([s.uv[2]])})
        self.assertEqual(len(self.faults(s)), 4)  # residual and orientation of the line, direction and its degrees
        s.entries[0]["yielded"] = [2]
        self.agrees(s)


class Numbers(unittest.TestCase):
    def test_eigenvalues(self):
        turned = [[2, 1, 0], [1, 2, 0], [0, 0, 5]]
        found = checker.eigen_3x3(turned)
        for (value, vector), wanted in zip(found, (5, 3, 1)):
            self.assertAlmostEqual(value, wanted, 14)
            for row, x in zip(turned, vector):
                self.assertAlmostEqual(sum(a * b for a, b in zip(row, vector)), wanted * x, 14)

    def test_circles_of_points_that_lie_on_none(self):
        found = checker.fit_circle([1, 1j, -1, -1j, 3, 3j, -3, -3j])
        self.assertAlmostEqual(abs(found.centre), 0, 14)
        self.assertAlmostEqual(found.radius, 2, 14)

    def test_short_arcs(self):
        for sweep in (1e-3, 0.1, 3.0):
            arc = [100 + cmath.rect(7.0, 1 + sweep * k / 9) for k in range(10)]
            found = checker.fit_circle(arc)
            self.assertLess(max(abs(abs(z - found.centre) / found.radius - 1) for z in arc), 1e-12)
            self.assertAlmostEqual(checker.arc_radius([abs(q - p) for p, q in zip(arc, arc[1:])], sweep), 7.0, 7)

    def test_arcs_with_a_dominant_chord(self):
        arc = [cmath.rect(1.0, a) for a in (0, 0.2, 5.0, 5.5)]  # one sector of more than half a turn
        self.assertAlmostEqual(checker.arc_radius([abs(q - p) for p, q in zip(arc, arc[1:])], 5.5), 1.0, 12)


if __name__ == "__main__":
    unittest.main()
