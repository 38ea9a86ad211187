#!/usr/bin/env python3
"""deform.py PROGRAM FOLDER...: deforming free maps to the constraint sets of folders, beside flattening with them.

Of each NAME.SET.constraints.json the mesh that NAME.features.json names is flattened without constraints (one without
boundary is opened with --cut auto), the result deformed with its features held, and again with --poses free --overlaps
remove, and the mesh flattened with the constraints. Columns: exit codes, flipped triangles and overwound vertices, energies,
largest displacement of a vertex of the input from the free map (after the best isometry; "-" where charts are several)
over the length of the map's box, worst residual of both deformations (degrees for relations), what was released, seconds,
overlapping pairs. The deformed maps are checked by verify, which exits with 6 for overlaps, too.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile
import time


def cases(folder):
    folder = pathlib.Path(folder)
    for path in sorted(folder.glob("*.constraints.json")):
        name = path.name.removesuffix(".constraints.json")
        features = json.loads((folder / (name.rsplit(".", 1)[0] + ".features.json")).read_text())
        yield name, str(folder / features["mesh"]), str(path)


def run(*command):
    begin = time.monotonic()
    code = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode
    return code, time.monotonic() - begin


def read_uv(path, count):
    """uv of the first vertices of an OBJ that planish wrote, as complex numbers; None where a vertex has several."""
    vt, uv = [], {}
    for line in open(path):
        if line.startswith("vt "):
            vt.append(complex(*map(float, line.split()[1:3])))
        elif line.startswith("f "):
            for corner in line.split()[1:]:
                v, t = corner.split("/")[:2]
                if uv.setdefault(int(v) - 1, vt[int(t) - 1]) != vt[int(t) - 1]:
                    return None
    return [uv[v] for v in range(count) if v in uv]


def count_vertices(path):
    return sum(line.startswith("v ") for line in open(path))


def largest_displacement(free, other):
    if free is None or other is None or len(free) != len(other):
        return None
    mean = [sum(x) / len(x) for x in (free, other)]
    a, b = ([z - m for z in x] for x, m in zip((free, other), mean))
    turn = sum(z * w.conjugate() for z, w in zip(a, b))
    turn /= abs(turn)
    box = abs(complex(max(z.real for z in a) - min(z.real for z in a), max(z.imag for z in a) - min(z.imag for z in a)))
    return max(abs(z - w * turn) for z, w in zip(a, b)) / box


def figure(value, form):
    return "-" if value is None else format(value, form)


def together(values, form=None):
    return " / ".join("-" if v is None else str(v) if form is None else format(v, form) for v in values)


def row(program, name, mesh, constraints, folder):
    given_map = str(folder / "given.obj")
    flatten = ["flatten", mesh, "--overlaps", "report"]  # what is deformed: maps as rigid as they can be
    code, _ = run(program, *flatten, "-o", given_map)
    cut = []
    if code == 4:
        cut = ["--cut", "auto"]
        code, _ = run(program, *flatten, "-o", given_map, *cut)
    if code not in (0, 6):
        return [name, f"free map: exit {code}"]
    count = count_vertices(given_map)
    map_free = read_uv(given_map, count)
    runs = {"held": ["deform", given_map], "free": ["deform", given_map, "--poses", "free", "--overlaps", "remove"],
            "flat": [*flatten, *cut]}
    codes, seconds, reports, moved, verified = [], [], [], [], []
    for kind, command in runs.items():
        output, report = (str(folder / f"{kind}.{ext}") for ext in ("obj", "json"))
        pathlib.Path(report).unlink(missing_ok=True)
        code, time_taken = run(program, *command, "-c", constraints, "-o", output, "--report", report)
        codes.append(code)
        seconds.append(time_taken)
        done = pathlib.Path(report).exists()
        reports.append(json.loads(pathlib.Path(report).read_text()) if done else None)
        moved.append(largest_displacement(map_free, read_uv(output, count)) if done else None)
        if done and kind != "flat":
            verified.append(run(program, "verify", output, "-c", constraints, "--report", report)[0])
    given = reports[0] or reports[1]
    deformed = [r for r in reports[:2] if r]
    residual = max((c["residual"] for r in deformed for c in r["constraints"]), default=0)
    return [name, together(codes), together([r and f"{r['flipped_triangles']}, {r['overwound_vertices']}" for r in reports]),
            figure(given and given["deformation"]["given_arap"], ".3e"),
            together([r and r["energy"]["arap"] for r in reports], ".3e"), together(moved, ".2%"), f"{residual:.0e}",
            together([r and r["deformation"]["release"] for r in reports[:2]]), together(seconds, ".1f"),
            together([r and r["overlapping_pairs"] for r in reports]),
            together("yes" if code == 0 else f"exit {code}" for code in verified)]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("folders", nargs="+")
    arguments = parser.parse_args()
    header = ["set", "exit: held / free / flatten", "flips, overwound", "given arap", "arap", "largest displacement", "residual",
              "released", "s", "overlaps", "verified"]
    print("| " + " | ".join(header) + " |\n|" + " --- |" * len(header))
    with tempfile.TemporaryDirectory() as folder:
        for source in arguments.folders:
            for name, mesh, constraints in cases(source):
                print("| " + " | ".join(row(arguments.program, name, mesh, constraints, pathlib.Path(folder))) + " |",
                      flush=True)


if __name__ == "__main__":
    main()
