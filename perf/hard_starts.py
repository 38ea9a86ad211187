#!/usr/bin/env python3
"""hard_starts.py BUILD [--half HALF_BODY.obj] [--maze MAZE.obj]: how often each procedure against flips ends without any, from
starts far from a map without flips. A table row a case, a column a procedure: solved of tried, seconds.

Scattered: squares with a held rim whose inner vertices begin anywhere (BUILD/perf/scattered_start). Spiral: a bar of 120 x 4
squares whose boundary is pinned to a spiral, by its number of turns. Quarter: a quarter of the half body's boundary becomes a
straight line of the same lengths, eight quarters. All but the scattered ones by the program; solved: flips and overwound
vertices are 0 and all constraints are met.
"""
import argparse
import json
import math
import pathlib
import subprocess
import tempfile
import time

METHODS = ("untangle", "weights", "stiffening")
LONG, ACROSS = 120, 4


def scattered(build, side, seeds):
    out = subprocess.run([build / "perf" / "scattered_start", str(side), str(seeds)], check=True, capture_output=True, text=True)
    for line in out.stdout.splitlines():
        method, solved, tried, seconds = line.split()
        yield method, int(solved), int(tried), float(seconds)


def write_bar(path):
    row = ACROSS + 1
    with open(path, "w") as file:
        for i in range(LONG + 1):
            for j in range(row):
                file.write(f"v {i} {j} 0\n")
        for i in range(LONG):
            for j in range(1, ACROSS + 1):
                a = i * row + j
                file.write(f"f {a} {a + row} {a + row + 1}\nf {a} {a + row + 1} {a + 1}\n")


def spiral_pins(turns):
    """The bar's middle line on r = b phi, its boundary beside it."""
    span, radius = 2 * math.pi * turns, 1.5 * ACROSS
    pitch = (LONG - radius * span) / (0.5 * span * span)
    pins = {}
    for i in range(LONG + 1):
        s = i
        phi = (-radius + math.sqrt(radius * radius + 2 * pitch * s)) / pitch if abs(pitch) > 1e-9 else s / radius
        for j in range(ACROSS + 1):
            if i in (0, LONG) or j in (0, ACROSS):
                r = radius + pitch * phi + j - ACROSS / 2
                pins[i * (ACROSS + 1) + j] = [r * math.sin(phi), r * math.cos(phi)]
    return {"version": 1, "features": {},
            "constraints": [{"type": "pin", "vertices": list(pins), "uv": list(pins.values())}]}


def boundary_of(path):
    """The longest boundary loop's vertices, in order, and positions."""
    points, after, seen = [], {}, set()
    for line in open(path):
        if line.startswith("v "):
            points.append([float(x) for x in line.split()[1:4]])
        elif line.startswith("f "):
            face = [int(x.split("/")[0]) - 1 for x in line.split()[1:]]
            seen.update(zip(face, face[1:] + face[:1]))
    for a, b in seen:
        if (b, a) not in seen:
            after[a] = b
    loops = []
    while after:
        v, nxt = after.popitem()
        loop = [v]
        while nxt != loop[0]:
            loop.append(nxt)
            nxt = after.pop(nxt)
        loops.append(loop)
    loop = max(loops, key=len)
    first = loop.index(min(loop))
    return loop[first:] + loop[:first], points


def quarters(path, count=8):
    loop, points = boundary_of(path)
    length = [0.0]
    for a, b in zip(loop, loop[1:] + loop[:1]):
        length.append(length[-1] + math.dist(points[a], points[b]))
    for k in range(count):
        begin = length[-1] * k / count
        inside = [v for v, s in zip(loop, length) if (s - begin) % length[-1] <= length[-1] / 4]
        at = {v: (s - begin) % length[-1] for v, s in zip(loop, length)}
        inside.sort(key=at.get)
        yield {"version": 1, "features": {"quarter": {"vertices": inside}},
               "constraints": [{"type": "line", "feature": "quarter"}]}


def is_solved(report):
    return report["flipped_triangles"] == 0 and report["overwound_vertices"] == 0 and all(
        c["residual"] <= 1e-9 for c in report.get("constraints", []))


def by_program(build, mesh, constraint_sets, folder):
    for method in METHODS:
        begin, solved = time.monotonic(), 0
        for constraints in constraint_sets:
            report, file = folder / "report.json", folder / "constraints.json"
            report.unlink(missing_ok=True)
            command = [build / "planish", "flatten", mesh, "-o", folder / "out.ply", "--report", report, "--quiet", "--flips", method,
                       "--overlaps", "report"]
            if constraints:
                file.write_text(json.dumps(constraints))
                command += ["-c", file]
            subprocess.run(command, stderr=subprocess.DEVNULL)
            solved += report.exists() and is_solved(json.loads(report.read_text()))
        yield method, solved, len(constraint_sets), time.monotonic() - begin


def print_row(name, results):
    print("| " + " | ".join([name] + [f"{solved} of {tried}, {seconds:.1f} s" for _, solved, tried, seconds in results]) + " |",
          flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--half", type=pathlib.Path)
    parser.add_argument("--maze", type=pathlib.Path)
    arguments = parser.parse_args()
    print("| case | " + " | ".join(METHODS) + " |\n|" + " --- |" * (1 + len(METHODS)))
    for side, seeds in ((10, 20), (30, 10), (100, 3)):
        print_row(f"scattered, {side} x {side}", scattered(arguments.build, side, seeds))
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        bar = folder / "bar.obj"
        write_bar(bar)
        for turns in (0.5, 1, 1.5, 2):
            print_row(f"spiral, {turns} turns", by_program(arguments.build, bar, [spiral_pins(turns)], folder))
        if arguments.half:
            print_row("quarter", by_program(arguments.build, arguments.half, list(quarters(arguments.half)), folder))
        if arguments.maze:
            print_row("maze", by_program(arguments.build, arguments.maze, [None], folder))


if __name__ == "__main__":
    main()
