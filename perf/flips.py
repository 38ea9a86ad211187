#!/usr/bin/env python3
"""flips.py PROGRAM FOLDER...: what removing flips takes on the meshes and constraint sets of folders, a table row each.

A mesh without boundary is opened with --cut auto. NAME.SET.constraints.json is a set for the mesh that NAME.features.json
names. Columns: flipped triangles and overwound vertices where local/global steps ended, and in the result; overlapping pairs
(with --overlaps remove, which goes to the program as every unknown option does: before, in the result, and the map that the
removal began at); Newton steps in patches (of the slowest ones), away from flips, and down to the minimum; energies; seconds of
the whole process.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile
import time

MESHES = (".obj", ".ply", ".off", ".stl", ".stl.gz", ".obj.gz")


def cases(folder):
    folder = pathlib.Path(folder)
    for path in sorted(folder.iterdir()):
        if path.name.lower().endswith(MESHES):
            yield path.name, [str(path)]
    for path in sorted(folder.glob("*.constraints.json")):
        name = path.name.removesuffix(".constraints.json")
        features = json.loads((folder / (name.rsplit(".", 1)[0] + ".features.json")).read_text())
        yield name, [str(folder / features["mesh"]), "-c", str(path)]


def flatten(program, arguments, extra, folder, limit):
    report = folder / "report.json"
    command = [program, "flatten", *arguments, "-o", str(folder / "out.ply"), "--report", str(report), "--quiet"]
    report.unlink(missing_ok=True)
    begin = time.monotonic()
    try:
        code = subprocess.run(command + extra, stderr=subprocess.DEVNULL, timeout=limit).returncode
    except subprocess.TimeoutExpired:
        return time.monotonic() - begin, "time", None
    return time.monotonic() - begin, code, json.loads(report.read_text()) if report.exists() else None


def figure(value, form):
    return "inf" if value is None else format(value, form)


def overlaps(report):
    removal, left = report["overlaps"], report["overlapping_pairs"]
    return f"{removal['pairs_before']}, {left}, {removal['start']}" if removal.get("pairs_before") else str(left)


def row(name, seconds, code, report):
    if report is None:
        return [name, str(code)] + [""] * 10 + [f"{seconds:.1f}"]
    flips, energy = report["flips"], report["energy"]
    residuals = [c["residual"] for c in report.get("constraints", [])]
    return [name, str(code),
            f"{flips.get('flipped_before', '')} / {flips.get('overwound_before', '')}",
            f"{report['flipped_triangles']} / {report['overwound_vertices']}", overlaps(report),
            f"{flips.get('patch_steps', '')} / {flips.get('untangling_steps', '')} / {flips.get('newton_steps', '')}",
            str(report["iterations"]), f"{report['gradient'] or 0:.1e}", figure(flips.get("arap_before"), ".4e"),
            figure(energy["arap"], ".4e"), figure(energy["symmetric_dirichlet"], ".4f"),
            f"{max(residuals):.0e}" if residuals else "", f"{seconds:.1f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--limit", type=float, default=600, help="seconds a case may take")
    arguments, extra = parser.parse_known_args()
    header = ["case", "exit", "flips / overwound before", "after", "overlaps", "patch / untangling / Newton steps", "iterations",
              "gradient", "arap before", "arap", "symmetric Dirichlet", "residual", "s"]
    print("| " + " | ".join(header) + " |\n|" + " --- |" * len(header))
    with tempfile.TemporaryDirectory() as folder:
        for source in arguments.folders:
            for name, case in cases(source):
                result = flatten(arguments.program, case, extra, pathlib.Path(folder), arguments.limit)
                if result[1] == 4:
                    result = flatten(arguments.program, case + ["--cut", "auto"], extra, pathlib.Path(folder),
                                     arguments.limit)
                print("| " + " | ".join(row(name, *result)) + " |", flush=True)


if __name__ == "__main__":
    main()
