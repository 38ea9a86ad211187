#!/usr/bin/env python3
"""deform.py PROGRAM FOLDER...: deforming free maps to the constraint sets of folders, beside flattening with them.

Of each NAME.SET.constraints.json the mesh that NAME.features.json names is flattened without constraints (one without
boundary is opened with --cut auto), the result deformed, and the mesh flattened with the constraints. Columns: exit codes,
flipped triangles and overwound vertices, energies, largest displacement of a vertex of the input from the free map (of
flatten: after the best isometry; "-" where charts are several) over the length of the map's box, worst residual of deform
(degrees for relations), what was released, seconds. The
results are checked by verify, which exits with 6 for overlaps, too.
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


def row(program, name, mesh, constraints, folder):
    free, deformed, flat = (str(folder / f"{n}.obj") for n in ("free", "deformed", "flat"))
    reports = {n: folder / f"{n}.json" for n in ("deform", "flatten")}
    for path in reports.values():
        path.unlink(missing_ok=True)
    code, _ = run(program, "flatten", mesh, "-o", free)
    cut = []
    if code == 4:
        cut = ["--cut", "auto"]
        code, _ = run(program, "flatten", mesh, "-o", free, *cut)
    if code not in (0, 6):
        return [name, f"free map: exit {code}"]
    code_d, seconds_d = run(program, "deform", free, "-c", constraints, "-o", deformed, "--report", reports["deform"])
    code_f, seconds_f = run(program, "flatten", mesh, "-c", constraints, "-o", flat, "--report", reports["flatten"], *cut)
    d, f = (json.loads(p.read_text()) if p.exists() else None for p in reports.values())
    if d is None:
        return [name, f"{code_d} / {code_f}"]
    code_v, _ = run(program, "verify", deformed, "-c", constraints, "--report", reports["deform"])
    count = count_vertices(free)
    map_free = read_uv(free, count)
    moved = [largest_displacement(map_free, read_uv(path, count)) for path in (deformed, flat)]
    residual = max((c["residual"] for c in d["constraints"]), default=0)
    return [name, f"{code_d} / {code_f}", f"{d['flipped_triangles']}, {d['overwound_vertices']} / "
            + (f"{f['flipped_triangles']}, {f['overwound_vertices']}" if f else "-"),
            figure(d["deformation"]["given_arap"], ".3e"),
            figure(d["energy"]["arap"], ".3e") + " / " + figure(f and f["energy"]["arap"], ".3e"),
            figure(moved[0], ".2%") + " / " + figure(moved[1], ".2%"), f"{residual:.0e}",
            d["deformation"]["release"], f"{seconds_d:.1f} / {seconds_f:.1f}",
            f"{d['overlapping_pairs']} / {f['overlapping_pairs'] if f else '-'}", "yes" if code_v == 0 else f"exit {code_v}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("folders", nargs="+")
    arguments = parser.parse_args()
    header = ["set", "exit: deform / flatten", "flips, overwound", "free arap", "arap", "largest displacement", "residual",
              "released", "s", "overlaps", "verified"]
    print("| " + " | ".join(header) + " |\n|" + " --- |" * len(header))
    with tempfile.TemporaryDirectory() as folder:
        for source in arguments.folders:
            for name, mesh, constraints in cases(source):
                print("| " + " | ".join(row(arguments.program, name, mesh, constraints, pathlib.Path(folder))) + " |",
                      flush=True)


if __name__ == "__main__":
    main()
