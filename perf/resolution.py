#!/usr/bin/env python3
"""resolution.py PROGRAM MESH...: how flatten grows with the mesh, a table row each.

Runs every mesh --runs times (default 3) file to file, in turns, and states medians: seconds of each step, of the whole
process, peak memory a triangle, iterations to the tolerance and to within 0.1% of the converged energy.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import tempfile
import time


def run(program, mesh, folder, extra):
    report = pathlib.Path(folder) / "report.json"
    begin = time.monotonic()
    command = [program, "flatten", mesh, "-o", str(pathlib.Path(folder) / "out.ply"), "--report", str(report), "--quiet",
               "--flips", "keep"]
    code = subprocess.run(command + extra, stderr=subprocess.DEVNULL).returncode
    seconds = time.monotonic() - begin
    if code not in (0, 6):
        raise SystemExit(f"{mesh}: exit {code}")
    return seconds, json.loads(report.read_text())


def iterations_to(report, share):
    steps = [h for h in report["history"] if h["phase"] == "local_global"]
    least = steps[-1]["energy"]
    return next(h["iteration"] for h in steps if h["energy"] <= least * (1 + share))


def row(mesh, runs):
    reports = [report for _, report in runs]
    first = reports[0]
    triangles = first["mesh"]["triangles"]
    steps = [statistics.median(r["timings_s"][step] for r in reports) for step in first["timings_s"]]
    whole = statistics.median(seconds for seconds, _ in runs)
    memory = statistics.median(r["peak_memory_bytes"] for r in reports) / triangles
    cells = [pathlib.Path(mesh).name, f"{triangles:,}"] + [f"{s:.2f}" for s in steps]
    cells += [f"{whole:.2f}", f"{memory:.0f}", str(first["iterations"]), str(iterations_to(first, 1e-3)),
              f"{first['energy']['arap']:.6e}", str(first["flipped_triangles"])]
    return list(first["timings_s"]), cells


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--runs", type=int, default=3)
    arguments, extra = parser.parse_known_args()
    with tempfile.TemporaryDirectory() as folder:
        runs = {mesh: [] for mesh in arguments.meshes}
        for _ in range(arguments.runs):
            for mesh in arguments.meshes:
                runs[mesh].append(run(arguments.program, mesh, folder, extra))
    for k, mesh in enumerate(arguments.meshes):
        steps, cells = row(mesh, runs[mesh])
        if k == 0:
            header = ["mesh", "triangles"] + steps + ["whole (s)", "bytes/triangle", "iterations", "to 0.1%", "arap", "flips"]
            print("| " + " | ".join(header) + " |\n|" + " --- |" * len(header))
        print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
