#!/usr/bin/env python3
"""features.py PROGRAM: what 1, 10, 20, 100, 1000 constrained features cost, a table row each.

Samples a bonnet of --triangles (default 1,000,000) with so many features (lines and circles in turns), and flattens it file
to file, unconstrained and with each set, in turns, --runs times (default 3). States medians: seconds of each step, of the
whole process and its ratio to the unconstrained run, peak memory, entries of the factor, iterations, worst residual.
"""
import argparse
import json
import pathlib
import re
import statistics
import subprocess
import tempfile
import time

STEPS = ("embed", "compile", "order", "start", "local_global", "measure")


def sample(program, folder, triangles, count):
    mesh, features = folder / "hood.ply", folder / f"{count}.json"
    command = [program, "sample", "hood", "--triangles", str(triangles), "--noise", "0.0002", "-o", str(mesh),
               "--features", str(features)]
    subprocess.run(command + (["--feature-count", str(count)] if count else []), check=True, stdout=subprocess.DEVNULL)
    return mesh, features


def flatten(program, mesh, features, folder):
    report = folder / "report.json"
    command = [program, "flatten", str(mesh), "-o", str(folder / "out.ply"), "--report", str(report), "--quiet",
               "--flips", "keep"]
    begin = time.monotonic()
    code = subprocess.run(command + features, stderr=subprocess.DEVNULL).returncode
    seconds = time.monotonic() - begin
    if code not in (0, 6):
        raise SystemExit(f"{features}: exit {code}")
    return seconds, json.loads(report.read_text())


def factor_entries(program, mesh, features):
    said = subprocess.run([program, "flatten", str(mesh), "--dry-run"] + features, check=True, capture_output=True, text=True)
    return int(re.search(r"factor of (\d+) entries", said.stdout)[1])


def row(count, runs, plain_seconds, entries):
    seconds = statistics.median(s for s, _ in runs)
    reports = [report for _, report in runs]
    first = reports[0]
    steps = [statistics.median(r["timings_s"].get(step, 0) for r in reports) for step in STEPS]
    memory = statistics.median(r["peak_memory_bytes"] for r in reports) * 1e-9
    residual = max((c["residual"] for c in first.get("constraints", [])), default=0)
    return [str(count), f"{first['mesh']['triangles']:,}"] + [f"{s:.2f}" for s in steps] + [
        f"{seconds:.2f}", f"{seconds / plain_seconds:.2f}", f"{memory:.2f}", f"{entries * 1e-6:.1f}",
        str(first.get("elimination", {}).get("border_unknowns", 0)), str(first["iterations"]), f"{residual:.0e}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--triangles", type=int, default=1_000_000)
    parser.add_argument("--counts", type=int, nargs="+", default=[1, 10, 20, 100, 1000])
    parser.add_argument("--runs", type=int, default=3)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        options = {0: []}
        for count in arguments.counts:
            mesh, features = sample(arguments.program, folder, arguments.triangles, count)
            options[count] = ["-c", str(features)]
        runs = {count: [] for count in options}
        for _ in range(arguments.runs):
            for count in options:
                runs[count].append(flatten(arguments.program, mesh, options[count], folder))
        plain = statistics.median(seconds for seconds, _ in runs[0])
        header = ["features", "triangles", *STEPS, "whole (s)", "ratio", "memory (GB)", "factor (M)", "border", "iterations",
                  "residual"]
        print("| " + " | ".join(header) + " |\n|" + " --- |" * len(header))
        for count in options:
            entries = factor_entries(arguments.program, mesh, options[count])
            print("| " + " | ".join(row(count, runs[count], plain, entries)) + " |", flush=True)


if __name__ == "__main__":
    main()
