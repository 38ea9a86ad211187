#!/usr/bin/env python3
"""instructions.py BUILD [--update]: instructions of the main kernels and of a small whole run, against a baseline.

Counted by callgrind on one thread, so that no clock and no neighbour on the machine matters; valgrind offers AVX2 and no
AVX-512, so that is the instruction set. More than 5 % above perf/instructions.json fails; --update writes that file anew. The
counts belong to the compiler that the file names.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

BASELINE = pathlib.Path(__file__).with_name("instructions.json")
ALLOWED = 1.05
TRIANGLES = 12_000
KERNELS = {"order": ".ply", "analyse": ".ply", "factor": ".ply", "solve": ".ply", "round": ".ply",
           "solve_rounded": ".ply", "local": ".ply", "read ply": ".ply", "read obj": ".obj"}


def instructions(command, toggle):
    """Instructions that a command executes, inside one function where that is given."""
    options = ["--tool=callgrind", "--callgrind-out-file=/dev/null"] + (["--toggle-collect=" + toggle] if toggle else [])
    done = subprocess.run(["valgrind", *options, *map(str, command)], capture_output=True, text=True)
    found = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode != 0 or not found or int(found[1]) == 0:
        raise SystemExit(f"instructions.py: {command}: exit {done.returncode}\n{done.stderr[-2000:]}")
    return int(found[1])


def count(build, folder):
    mesh = {}
    for suffix in (".ply", ".obj"):
        mesh[suffix] = folder / ("hood" + suffix)
        subprocess.run([build / "planish", "sample", "hood", "--triangles", str(TRIANGLES), "--noise", "0.0002", "-o",
                        mesh[suffix]], check=True, stdout=subprocess.DEVNULL)
    counts = {name: instructions([build / "perf/gate", name.split()[0], mesh[suffix]], "planish_gate")
              for name, suffix in KERNELS.items()}
    counts["flatten"] = instructions([build / "planish", "flatten", mesh[".ply"], "-o", folder / "out.ply", "--quiet",
                                      "--threads", "1"], None)
    return counts


def compiler(build):
    cache = (build / "CMakeCache.txt").read_text()
    path = re.search(r"^CMAKE_CXX_COMPILER:\w+=(.*)$", cache, re.M)[1]
    return subprocess.run([path, "--version"], check=True, capture_output=True, text=True).stdout.splitlines()[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--update", action="store_true")
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    if " avx2 " not in pathlib.Path("/proc/cpuinfo").read_text():
        raise SystemExit("instructions.py: the baseline is for AVX2, which this processor lacks")
    with tempfile.TemporaryDirectory() as name:
        counts = count(build, pathlib.Path(name))
    if arguments.update:
        BASELINE.write_text(json.dumps({"compiler": compiler(build), "instructions": counts}, indent=1) + "\n")
        print(f"wrote {BASELINE}")
        return
    baseline = json.loads(BASELINE.read_text())
    if compiler(build) != baseline["compiler"]:
        print(f"instructions.py: the baseline is of {baseline['compiler']}, this is {compiler(build)}", file=sys.stderr)
    worse = []
    for key, value in counts.items():
        ratio = value / baseline["instructions"][key]
        print(f"{key:13} {value:14,d}  {100 * (ratio - 1):+6.2f} %")
        if ratio > ALLOWED:
            worse.append(key)
    if worse:
        raise SystemExit(f"instructions.py: more than 5 % above the baseline: {', '.join(worse)} (./dev gate --update where "
                         "that is meant)")


if __name__ == "__main__":
    main()
