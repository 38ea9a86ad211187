#!/usr/bin/env python3
"""suite.py BUILD: every target of DESIGN 6 that can be measured here, as a ratio taken in one run.

Runs BUILD/perf/solver_bench and flattens sampled bonnets file to file with BUILD/planish, all in turns; writes BUILD/perf.json
and prints a table. PLANISH_PERF_MESH: another mesh for the solver's part. Within ten minutes on two cores.
"""
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

SIZES = (57_000, 227_000, 909_000, 3_600_000)
MAIN = 909_000
SMALL = 57_000
ROUGH = "0.02"  # noise that turns triangles over
KEEP = ("--flips", "keep")
NEAR_ENOUGH = ("--tolerance", "1e-2")  # ends within a thousandth of the least energy, which is checked

# key: (target, whether more is better)
TARGETS = {
    "solve_vs_cholmod": (6, True),
    "solve_single_vs_cholmod": (None, True),
    "solve_vs_read_limit": (2, False),
    "factor_vs_cholmod": (5, True),
    "newton_factor_vs_cholmod": (None, True),
    "solver_total_vs_cholmod": (4, True),
    "solver_threads2_speedup": (None, True),
    "analyze_vs_metis": (None, True),
    "fill_flops_vs_metis": (None, False),
    "local_vs_read_limit": (1 / 0.6, False),
    "read_ply_s_per_mtri": (0.15, False),
    "read_obj_s_per_mtri": (0.6, False),
    "flatten_vs_eigen_ldlt": (10, True),
    "flatten_vs_cgal_arap": (20, True),
    "constrained_vs_free": (1.3, False),
    "untangled_vs_keep": (2, False),
    "untangled_vs_keep_rough": (2, False),
    "untangled_vs_keep_rough_to_tolerance": (None, False),
    "bytes_per_triangle": (700, False),
    "growth_exponent": (math.log(4.6) / math.log(4), False),
    "threads2_speedup": (1.7, True),
}


def solver(build, folder):
    out = folder / "solver.json"
    subprocess.run([build / "perf/solver_bench", f"--benchmark_out={out}", "--benchmark_out_format=json"], check=True,
                   stdout=subprocess.DEVNULL)
    rows = json.loads(out.read_text())["benchmarks"]
    fields = ("own_s", "other_s", "gflop", "gflops", "own_gflop", "own_entries", "other_entries")
    return {row["name"].split("/")[0]: {"value": row["ratio"], **{f: row[f] for f in fields if f in row}} for row in rows}


class Program:
    def __init__(self, build, folder):
        self.path, self.folder = build / "planish", folder

    def sample(self, triangles, *more, suffix=".ply", noise="0.0002"):
        mesh = self.folder / f"hood_{triangles}_{noise}_{len(more)}{suffix}"
        subprocess.run([self.path, "sample", "hood", "--triangles", str(triangles), "--noise", noise, "-o", mesh, *more],
                       check=True, stdout=subprocess.DEVNULL)
        return mesh

    def flatten(self, mesh, *more, flips=False):
        """Seconds of the process, and its report; its map has been certified by the program itself. flips: it must have some."""
        report = self.folder / "report.json"
        command = [self.path, "flatten", mesh, "-o", self.folder / "out.ply", "--report", report, "--quiet", *more]
        begin = time.monotonic()
        code = subprocess.run(command, stderr=subprocess.DEVNULL).returncode
        seconds = time.monotonic() - begin
        facts = json.loads(report.read_text())
        if code != (6 if flips else 0) or not facts["converged"]:
            raise SystemExit(f"suite.py: {mesh} {more}: exit {code}")
        return seconds, facts


def in_turns(turns, **runs):
    """Medians of each run's numbers, the runs taken in turns."""
    taken = {name: [] for name in runs}
    for _ in range(turns):
        for name, run in runs.items():
            taken[name].append(run())
    return {name: statistics.median(values) for name, values in taken.items()}


def growth(program):
    meshes = {n: program.sample(n) for n in SIZES}
    taken = in_turns(2, **{str(n): lambda n=n: program.flatten(meshes[n], "--flips", "keep")[0] for n in SIZES})
    x = [math.log(n) for n in SIZES]
    y = [math.log(taken[str(n)]) for n in SIZES]
    mean_x, mean_y = statistics.mean(x), statistics.mean(y)
    slope = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)
    return {"value": slope, "seconds": taken}


def threads(program, mesh):
    taken = in_turns(3, one=lambda: program.flatten(mesh, "--threads", "1")[0],
                     two=lambda: program.flatten(mesh, "--threads", "2")[0])
    return {"value": taken["one"] / taken["two"], **taken}


def near_enough(program, mesh, *more):
    """The energy a thousandth above the least, which runs with NEAR_ENOUGH must reach."""
    return 1.001 * program.flatten(mesh, "--tolerance", "1e-8", *more)[1]["energy"]["arap"]


def seconds_to(bound, program, mesh, *more, flips=False):
    seconds, facts = program.flatten(mesh, *NEAR_ENOUGH, *more, flips=flips)
    if facts["energy"]["arap"] > bound:
        raise SystemExit(f"suite.py: {mesh} {more}: the energy is more than a thousandth above the least")
    return seconds


def constrained(program, mesh):
    features = program.folder / "features.json"
    same = program.sample(MAIN, "--features", features, "--feature-count", "20")
    with_features = ("-c", features, *KEEP)
    free, bound = near_enough(program, mesh, *KEEP), near_enough(program, same, *with_features)
    taken = in_turns(3, free=lambda: seconds_to(free, program, mesh, *KEEP),
                     features=lambda: seconds_to(bound, program, same, *with_features))
    return {"value": taken["features"] / taken["free"], **taken}


def untangled(program, mesh):
    """To a thousandth, of a bonnet without flips, and of a rough one that has some; that one down to the tolerance too."""
    rough = program.sample(SMALL, noise=ROUGH)
    rows = {}
    for key, of, has_flips in (("untangled_vs_keep", mesh, False), ("untangled_vs_keep_rough", rough, True)):
        keep = lambda *more: program.flatten(of, *KEEP, *more, flips=has_flips)
        least = keep("--tolerance", "1e-8")[1]["energy"]["arap"], near_enough(program, of)
        taken = in_turns(3, untangled=lambda: seconds_to(least[1], program, of),
                         keep=lambda: seconds_to(1.001 * least[0], program, of, *KEEP, flips=has_flips))
        rows[key] = {"value": taken["untangled"] / taken["keep"], **taken}
    taken = in_turns(2, untangled=lambda: program.flatten(rough)[0],
                     keep=lambda: program.flatten(rough, *KEEP, flips=True)[0])
    rows["untangled_vs_keep_rough_to_tolerance"] = {"value": taken["untangled"] / taken["keep"], **taken}
    return rows


def readers(program):
    rows = {}
    for key, suffix in (("read_ply_s_per_mtri", ".ply"), ("read_obj_s_per_mtri", ".obj")):
        mesh = program.sample(MAIN, suffix=suffix)
        reports = [program.flatten(mesh, "--flips", "keep")[1] for _ in range(3)]
        rows[key] = {"value": statistics.median(r["timings_s"]["read"] * 1e6 / r["mesh"]["triangles"] for r in reports)}
    return rows


def eigen(build, program):
    mesh = program.sample(MAIN)
    bound = near_enough(program, mesh, *KEEP)
    own = in_turns(3, own=lambda: seconds_to(bound, program, mesh, *KEEP))["own"]
    said = json.loads(subprocess.run([build / "perf/eigen_peer", mesh, str(bound), program.folder / "peer.ply"], check=True,
                                     capture_output=True, text=True).stdout)
    return {"value": said["seconds"] / own, "own_s": own, "other_s": said["seconds"], "other_steps": said["steps"]}


def cgal_arap(build, program):
    peer = build / "perf/cgal_arap_peer"
    if not peer.exists():  # PLANISH_WITH_CGAL_GPL is off
        return None
    mesh = program.sample(SMALL)
    taken = in_turns(3, own=lambda: program.flatten(mesh, "--flips", "keep")[0])
    own = program.flatten(mesh, "--flips", "keep")[1]["energy"]["arap"]
    said = json.loads(subprocess.run([peer, mesh, program.folder / "peer.ply"], check=True, capture_output=True, text=True).stdout)
    if own > said["energy"] * 1.001:
        raise SystemExit(f"suite.py: CGAL's energy is {said['energy']}, the own {own}")
    return {"value": said["seconds"] / taken["own"], "own_s": taken["own"], "other_s": said["seconds"], "own_energy": own,
            "other_energy": said["energy"]}


def memory(program, mesh):
    peak = program.flatten(mesh)[1]
    triangles = peak["mesh"]["triangles"]
    return {"value": peak["peak_memory_bytes"] / triangles,
            "up_to_step": {step: size / triangles for step, size in peak["peak_memory_by_step_bytes"].items()}}


def measure(build, folder):
    program = Program(build, folder)
    rows = {}

    def part(name, work):
        begin = time.monotonic()
        rows.update(work())
        print(f"{name}: {time.monotonic() - begin:.0f} s", file=sys.stderr, flush=True)

    part("solver", lambda: solver(build, folder))
    mesh = program.sample(MAIN)
    part("memory", lambda: {"bytes_per_triangle": memory(program, mesh)})
    part("readers", lambda: readers(program))
    part("features", lambda: {"constrained_vs_free": constrained(program, mesh)})
    part("flips", lambda: untangled(program, mesh))
    part("threads", lambda: {"threads2_speedup": threads(program, mesh)})
    part("Eigen", lambda: {"flatten_vs_eigen_ldlt": eigen(build, program)})
    part("CGAL", lambda: {"flatten_vs_cgal_arap": cgal_arap(build, program)})
    part("growth", lambda: {"growth_exponent": growth(program)})
    return rows


def table(rows):
    lines = ["| key | value | target | met | seconds, own and other |", "| --- | --- | --- | --- | --- |"]
    for key, (target, more) in TARGETS.items():
        row = rows[key]
        if row is None:
            lines.append(f"| {key} | not built | | | |")
            continue
        met = "" if target is None else "yes" if (row["value"] >= target) == more or row["value"] == target else "**MISSED**"
        wanted = "" if target is None else f"{'>=' if more else '<='} {target:.3g}"
        if "own_s" in row and "other_s" in row:
            taken = f"{row['own_s']:.4f} {row['other_s']:.4f}"
        else:
            taken = ", ".join(f"{k} {v:.3g}" for k, v in row.items() if k != "value" and isinstance(v, float))
        lines.append(f"| {key} | {row['value']:.3g} | {wanted} | {met} | {taken} |")
    return "\n".join(lines)


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        rows = measure(build, pathlib.Path(name))
    load = os.getloadavg()
    result = {"version": 1, "seconds": time.monotonic() - begin, "load_average": load, "threads": os.cpu_count(), "results": rows}
    (build / "perf.json").write_text(json.dumps(result, indent=1))
    print(table(rows))
    print(f"\n{result['seconds']:.0f} s, {result['threads']} threads, load {load[0]:.1f} at the end")


if __name__ == "__main__":
    main()
