#!/usr/bin/env python3
"""The independent check agrees with closed forms, and finds every wrong number put into a right report."""
import argparse
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

import independent_check as checker

SCHEMA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "docs", "report.schema.json")


def constant(value):
    return dict.fromkeys(("min", "max", "mean", "p1", "p50", "p99"), value)


def report_of(mesh, arap, dirichlet, sigma_max, sigma_min, **others):
    """A report of a map with the same singular values everywhere; mesh: vertices, triangles, loops, euler."""
    report = {
        "version": 1, "planish": "0.1.0", "command": "", "input": "", "method": "arap",
        "mesh": {"vertices": mesh[0], "unreferenced_vertices": 0, "duplicate_positions": 0, "triangles": mesh[1], "components": 1,
                 "boundary_loops": mesh[2], "euler": mesh[3], "outer": [0], "mollified_triangles": 0},
        "energy": {"arap": arap, "symmetric_dirichlet": dirichlet},
        "stretch": {"sigma_max": constant(sigma_max), "sigma_min": constant(sigma_min),
                    "area_ratio": constant(sigma_max * sigma_min),
                    "angle_distortion": constant(sigma_max / sigma_min)},
        "flipped_triangles": 0, "flipped_ids": [], "overwound_vertices": 0, "overwound_ids": [], "overlapping_ids": [],
        "overlapping_pairs": 0, "overlap_area_fraction": 0.0, "iterations": 0, "converged": True, "gradient": 0.0,
        "holonomy_residual": 0.0, "history": [], "flips": {"method": "keep"}, "overlaps": {"method": "report"}, "timings_s": {}, "peak_memory_bytes": 0, "threads": 1,
        "repairs": [], "warnings": []}
    scale = math.sqrt(sigma_max * sigma_min)
    report["benchmark"] = {
        "max_area_distortion": 0.0, "average_area_error": 0.0, "min_singular_value": sigma_min / scale,
        "max_singular_value": sigma_max / scale, "proportion_flipped_triangles": 0.0, "bijectivity_violation_area": 0.0,
        "max_angle_distortion": sigma_max / sigma_min + sigma_min / sigma_max - 2,
        "average_angle_error": 2 * (math.pi / 4 - math.atan2(sigma_min, sigma_max)),  # right angles stay, 45 degrees do not
        "resolution": 2 * sigma_max / sigma_min}  # of a square of side 2
    report.update(others)
    return report


def obj_text(points, faces, uv=None):
    lines = ["v %r %r %r" % tuple(map(float, p)) for p in points]
    lines += ["vt %r %r" % tuple(map(float, c)) for c in uv or []]
    lines += ["f " + " ".join(f"{v + 1}/{v + 1}" if uv else f"{v + 1}" for v in face) for face in faces]
    return "\n".join(lines) + "\n"


def ply_bytes(points, faces, uv):
    head = (f"ply\nformat binary_little_endian 1.0\ncomment made here\nelement vertex {len(points)}\n" +
            "".join(f"property double {c}\n" for c in "xyzst") + "property uchar quality\n" +
            "property float texture_u\nproperty float texture_v\n" +  # as left from the input: not the map
            f"element face {len(faces)}\nproperty list uchar int vertex_indices\nproperty int origin\nend_header\n")
    rows = b"".join(struct.pack("<5dB2f", *p, *c, 7, 0.5, 0.25) for p, c in zip(points, uv))
    return head.encode() + rows + b"".join(struct.pack("<B3ii", 3, *f, 1) for f in faces)


class IndependentCheck(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        # A square grid of 3 x 3 vertices in a slanted plane, its image 1.1 times as long and 0.9 times as wide.
        c, s = math.cos(0.3), math.sin(0.3)
        self.points = [(i * c, j, i * s) for j in range(3) for i in range(3)]
        self.uv = [(1.1 * i, 0.9 * j) for j in range(3) for i in range(3)]
        self.faces = [f for a in (0, 1, 3, 4) for f in ((a, a + 1, a + 4), (a, a + 4, a + 3))]
        dirichlet = 1.1 ** 2 + 0.9 ** 2 + 1.1 ** -2 + 0.9 ** -2
        self.report = report_of((9, 8, 1, 1), 0.02, dirichlet, 1.1, 0.9)

    def write(self, name, content):
        path = os.path.join(self.folder, name)
        with open(path, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return path

    def disagreements(self, report=None, points=None, faces=None, uv=None, source=None, output=None):
        points, faces, uv = points or self.points, faces or self.faces, uv or self.uv
        arguments = argparse.Namespace(
            input=source or self.write("in.obj", obj_text(points, faces)),
            output=output or self.write("out.obj", obj_text(points, faces, uv)),
            report=self.write("report.json", json.dumps(report or self.report)),
            schema=SCHEMA, tolerance=1e-9, max_overlap_triangles=1000, header=False, verbose=False)
        with contextlib.redirect_stdout(io.StringIO()):
            return checker.check(arguments)

    def test_closed_form_agrees(self):
        self.assertEqual(self.disagreements(), 0)

    def test_ply_and_gzip_agree(self):
        ply = ply_bytes(self.points, self.faces, self.uv)
        self.assertEqual(self.disagreements(output=self.write("out.ply", ply)), 0)
        self.assertEqual(self.disagreements(output=self.write("out.ply.gz", gzip.compress(ply))), 0)

    def test_off_input_is_compared(self):
        text = "OFF\n9 8 0\n" + "".join("%r %r %r\n" % p for p in self.points)
        text += "".join("3 %d %d %d\n" % f for f in self.faces)
        self.assertEqual(self.disagreements(source=self.write("in.off", text)), 0)
        swapped = text.replace("3 0 1 4\n3 0 4 3\n", "3 0 4 3\n3 0 1 4\n")
        self.assertEqual(self.disagreements(source=self.write("in.off", swapped)), 1)

    def test_every_wrong_number_is_found(self):
        def numbers(node, path=()):
            if isinstance(node, dict):
                for key, value in node.items():
                    yield from numbers(value, path + (key,))
            elif type(node) in (int, float):
                yield path

        checked = ("mesh", "energy", "stretch", "flipped_triangles", "overwound_vertices", "overlapping_pairs",
                   "overlap_area_fraction", "benchmark")
        unchecked = (("mesh", "mollified_triangles"), ("mesh", "duplicate_positions"))
        for path in numbers({key: self.report[key] for key in checked}):
            if path in unchecked:
                continue
            report = copy.deepcopy(self.report)
            node = report
            for key in path[:-1]:
                node = node[key]
            node[path[-1]] += 1 if isinstance(node[path[-1]], int) else 1e-8 * max(1.0, node[path[-1]])
            with self.subTest(path):
                self.assertEqual(self.disagreements(report), 1)

    def test_moved_vertex_and_missing_field_are_found(self):
        moved = [(x, y + (1e-15 if k == 4 else 0), z) for k, (x, y, z) in enumerate(self.points)]
        self.assertEqual(self.disagreements(source=self.write("moved.obj", obj_text(moved, self.faces))), 1)
        report = copy.deepcopy(self.report)
        del report["energy"]
        self.assertGreaterEqual(self.disagreements(report), 1)

    def test_unreferenced_vertex_must_lie_at_the_origin(self):
        report = copy.deepcopy(self.report)
        report["mesh"].update(vertices=10, unreferenced_vertices=1)
        points = self.points + [(5, 5, 5)]
        self.assertEqual(self.disagreements(report, points=points, uv=self.uv + [(0, 0)]), 0)
        self.assertEqual(self.disagreements(report, points=points, uv=self.uv + [(1, 0)]), 1)

    def test_flip_is_found_where_floating_point_cannot_see_it(self):
        # Three points on one line but for the last bit; the products round to the same number.
        tiny = 2.0 ** -53
        a, b, c = (0.5, 0.5), (12.0, 12.0), (24.0, 24.0)
        self.assertEqual(checker.orientation(a, b, c), 0)
        self.assertEqual(checker.orientation((0.5, 0.5 + tiny), b, c), 1)
        self.assertEqual(checker.orientation((0.5, 0.5 - tiny), b, c), -1)

    def test_flipped_triangle_is_counted(self):
        uv = list(self.uv)
        uv[0] = (1.5, 1.2)  # the first corner pulled over its opposite edge
        chart = self.chart(self.points, self.faces, uv)
        self.assertEqual(chart.flipped, [0, 1])
        self.assertEqual(chart.symmetric_dirichlet.value, math.inf)
        self.assertLess(min(chart.quantities["sigma_min"][0]), 0)

    def chart(self, points, faces, uv):
        mesh = checker.Mesh()
        mesh.points, mesh.faces, mesh.uv = points, faces, uv
        return checker.Map(mesh)

    def test_fan_that_winds_twice_is_overwound(self):
        for turns, expected in ((1, []), (2, [0]), (3, [0])):
            n = 12
            rim = [(math.cos(2 * math.pi * turns * k / n), math.sin(2 * math.pi * turns * k / n)) for k in range(n)]
            faces = [(0, 1 + k, 1 + (k + 1) % n) for k in range(n)]
            points = [(0, 0, 1)] + [(math.cos(2 * math.pi * k / n), math.sin(2 * math.pi * k / n), 0) for k in range(n)]
            chart = self.chart(points, faces, [(0, 0)] + rim)
            self.assertEqual(chart.flipped, [])
            self.assertEqual(chart.overwound, expected)

    def test_overlaps_are_counted_with_their_area(self):
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (3, 0, 0), (4, 0, 0), (3, 1, 0)]
        faces = [(0, 1, 2), (3, 4, 5)]
        for shift, pairs, fraction in ((0.5, 1, 0.125), (1.0, 0, 0.0), (0.0, 1, 0.5)):
            uv = [(0, 0), (1, 0), (0, 1), (shift, 0), (1 + shift, 0), (shift, 1)]
            found = checker.find_overlaps(self.chart(points, faces, uv))
            self.assertEqual(found[0], pairs)
            self.assertAlmostEqual(found[1], fraction, 14)
            self.assertAlmostEqual(found[2], 2 * fraction, 14)

    def test_touching_triangles_do_not_overlap(self):
        self.assertEqual(checker.find_overlaps(self.chart(self.points, self.faces, self.uv)), (0, 0.0, 0.0))

    def test_annulus_and_two_components_are_counted(self):
        ring = [(math.cos(k), math.sin(k)) for k in (2 * math.pi * i / 6 for i in range(6))]
        uv = ring + [(2 * x, 2 * y) for x, y in ring]
        faces = [f for i in range(6) for j in [(i + 1) % 6] for f in ((i, 6 + i, 6 + j), (i, 6 + j, j))]
        twice = faces + [tuple(v + 12 for v in f) for f in faces]
        chart = self.chart([(x, y, 0) for x, y in 2 * uv], twice, uv + [(x + 9, y) for x, y in uv])
        self.assertEqual((chart.components, chart.loops, chart.euler), (2, 4, 0))

    def test_files_that_cannot_be_read_are_named(self):
        with self.assertRaises(checker.Unreadable):
            self.disagreements(output=os.path.join(self.folder, "missing.ply"))
        with self.assertRaises(checker.Unreadable):
            self.disagreements(output=self.write("flat.obj", obj_text(self.points, self.faces)))
        with self.assertRaises(checker.Unreadable):
            self.disagreements(output=self.write("cut.ply", ply_bytes(self.points, self.faces, self.uv)[:-5]))


if __name__ == "__main__":
    unittest.main()
