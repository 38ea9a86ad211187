#!/usr/bin/env python3
"""layers.py ROOT: who may include whom (STYLE: app -> io, engine -> engine/model -> kernels), kept by a machine.

Also: TBB only in engine/exec/*.cpp; Eigen, Embree, CGAL, CHOLMOD, cairo, zlib, JSON, fast_float and CLI11 only in .cpp
files; kernels allocate nothing and throw nothing.
"""
import pathlib
import re
import sys

# Layer of a file by its longest matching folder, and the layers it may include beside its own.
LAYERS = {
    "kernels": set(),
    "engine/model": {"kernels"},
    "engine/exec": {"kernels"},
    "engine": {"engine/model", "engine/exec", "kernels"},
    "io": {"engine/model", "engine/exec", "kernels"},
    "app": {"io", "engine", "engine/model", "engine/exec", "kernels"},
}
# Headers of plain data that io needs to write reports about; they belong to the model in all but place.
DATA_HEADERS = {"engine/prepare/validate.hpp", "engine/prepare/repair.hpp", "engine/sample/panels.hpp"}
THIRD_PARTY = re.compile(
    r"<(tbb/|oneapi/|Eigen/|embree|CGAL/|cholmod|cairo|zlib|nlohmann/|fast_float/|CLI/|fmt/|metis)")
FORBIDDEN_IN_KERNELS = re.compile(r"\b(new|throw|malloc|std::vector|std::string|std::thread|printf|std::cout)\b")


def layer_of(path):
    matches = [layer for layer in LAYERS if path.startswith(layer + "/")]
    return max(matches, key=len) if matches else None


def faults_of(root, file):
    name = file.relative_to(root).as_posix()
    layer = layer_of(name)
    for number, line in enumerate(file.read_text().splitlines(), 1):
        place = f"{name}:{number}"
        quoted = re.match(r'\s*#include\s+"([^"]+)"', line)
        if quoted:
            target = layer_of(quoted[1])
            allowed = LAYERS[layer] | {layer}
            if target is None or (target not in allowed and not (layer == "io" and quoted[1] in DATA_HEADERS)):
                yield f"{place}: {layer} may not include {quoted[1]}"
        third_party = re.match(r"\s*#include\s+" + THIRD_PARTY.pattern, line)
        if third_party and name.endswith(".hpp"):
            yield f"{place}: {line.strip()} in a header"
        if third_party and third_party[1] in ("tbb/", "oneapi/") and layer != "engine/exec":
            yield f"{place}: TBB outside engine/exec"
        if layer == "kernels" and FORBIDDEN_IN_KERNELS.search(line.split("//")[0]):
            yield f"{place}: kernels neither allocate nor throw nor print: {line.strip()}"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    files = [f for layer in ("kernels", "engine", "io", "app") for f in sorted((root / layer).rglob("*.[hc]pp"))]
    faults = [fault for f in files for fault in faults_of(root, f)]
    print("\n".join(faults) or f"{len(files)} files keep the direction of knowledge")
    sys.exit(1 if faults or not files else 0)


if __name__ == "__main__":
    main()
