#!/usr/bin/env python3
"""natural_boundary.py MESH CONSTRAINTS.json FEATURE PICTURE.png [PLANISH]

Why conformal maps degenerate under constraints on the boundary (docs/methods.md): one chain is made straight in conformal
maps that differ in what becomes of the natural boundary conditions along it. Dense, in complex numbers, with numpy; knows
nothing of planish but `embed`. Prints a table and draws the first, the fourth and the fifth map, coloured by the mean stretch
(blue small, red large, a factor of 2 at the ends), each scaled to the size of least ARAP energy.
"""
import json
import struct
import subprocess
import sys
import tempfile
import zlib

import numpy as np


def embedded(mesh, constraints, program):
    with tempfile.TemporaryDirectory() as folder:
        obj, report = folder + "/m.obj", folder + "/r.json"
        subprocess.run([program, "embed", mesh, "-c", constraints, "-o", obj, "--report", report, "--quiet"], check=True)
        lines = [line.split() for line in open(obj)]
        position = np.array([[float(x) for x in w[1:4]] for w in lines if w and w[0] == "v"])
        triangle = np.array([[int(x.split("/")[0]) - 1 for x in w[1:4]] for w in lines if w and w[0] == "f"])
        return position, triangle, json.load(open(report))["features"]


def conformal_energy(position, triangle, left_out=frozenset()):
    """Hermitian matrix of half the Dirichlet energy less the area, and the boundary edges; the area without those left out."""
    n = len(position)
    matrix, edges = np.zeros((n, n), complex), set()
    for t in triangle:
        for i in range(3):
            a, b, c = t[i], t[(i + 1) % 3], t[(i + 2) % 3]
            u, v = position[a] - position[c], position[b] - position[c]
            weight = 0.5 * u.dot(v) / np.linalg.norm(np.cross(u, v))
            matrix[[a, b], [a, b]] += weight
            matrix[[a, b], [b, a]] -= weight
            edges.add((a, b))
    boundary = [e for e in edges if (e[1], e[0]) not in edges]
    for i, j in boundary:
        if (i, j) not in left_out:
            matrix[i, j] += 0.5j
            matrix[j, i] -= 0.5j
    return matrix, boundary


def minimise(matrix, chain, template, pins):
    """The least energy of maps z = p + c t along the chain: all forces on it act on p and c."""
    n, on_chain = len(matrix), set(chain)
    free = [v for v in range(n) if v not in on_chain]
    to_map = np.zeros((n, len(free) + 2), complex)
    to_map[free, range(len(free))] = 1
    to_map[chain, -2] = 1
    to_map[chain, -1] = template
    conditions = to_map[[v for v, _ in pins]]
    k = len(pins)
    whole = np.block([[to_map.conj().T @ matrix @ to_map, conditions.conj().T], [conditions, np.zeros((k, k))]])
    right = np.concatenate([np.zeros(len(free) + 2), [z for _, z in pins]])
    return to_map @ np.linalg.solve(whole, right)[:-k]


def replace_rows(matrix, chain, template, pins):
    """Conditions of the chain in place of the natural ones at its vertices but the first two."""
    matrix, right = matrix.copy(), np.zeros(len(matrix), complex)
    for k in range(2, len(chain)):
        ratio = (template[k] - template[k - 1]) / (template[1] - template[0])
        matrix[chain[k]] = 0
        for v, x in ((chain[k], 1), (chain[k - 1], -1), (chain[1], -ratio), (chain[0], ratio)):
            matrix[chain[k], v] += x
    for v, z in pins:
        matrix[v] = 0
        matrix[v, v], right[v] = 1, z
    return np.linalg.solve(matrix, right)


def stretches(position, triangle, z):
    """Signed singular values of each triangle, and its area."""
    e1, e2 = position[triangle[:, 1]] - position[triangle[:, 0]], position[triangle[:, 2]] - position[triangle[:, 0]]
    x1 = np.linalg.norm(e1, axis=1)
    x2, y2 = (e1 * e2).sum(1) / x1, np.linalg.norm(np.cross(e1, e2), axis=1) / x1
    d1, d2 = z[triangle[:, 1]] - z[triangle[:, 0]], z[triangle[:, 2]] - z[triangle[:, 0]]
    du = d1 / x1
    dv = (d2 - x2 * du) / y2
    p, q = abs(du - 1j * dv) / 2, abs(du + 1j * dv) / 2
    return p + q, p - q, 0.5 * x1 * y2


def fitted(position, triangle, z):
    s1, s2, area = stretches(position, triangle, z)
    return z * (area * (s1 + s2)).sum() / (area * (s1 * s1 + s2 * s2)).sum()


def draw(path, triangle, maps, means, width=500):
    """Maps side by side, each in a square."""
    image = np.full((width, width * len(maps), 3), 255, np.uint8)
    for k, (z, mean) in enumerate(zip(maps, means)):
        extent = max(np.ptp(z.real), np.ptp(z.imag))
        at = (z - (z.real.min() + z.real.max() + 1j * (z.imag.min() + z.imag.max())) / 2) / extent * 0.94 * width
        x, y = at.real + width * (k + 0.5), width / 2 - at.imag
        value = np.clip(np.log2(np.maximum(mean, 1e-9)), -1, 1)
        for t, s in zip(triangle, value):
            colour = np.array([255, 255, 255]) * (1 - abs(s)) + np.array([190, 30, 40] if s > 0 else [40, 70, 180]) * abs(s)
            columns = np.arange(max(int(x[t].min()), k * width), min(int(x[t].max()) + 1, (k + 1) * width - 1) + 1)
            rows = np.arange(max(int(y[t].min()), 0), min(int(y[t].max()) + 1, width - 1) + 1)
            u, v = np.meshgrid(columns + 0.5, rows + 0.5)
            side = [(x[t[i]] - x[t[i - 1]]) * (v - y[t[i - 1]]) - (y[t[i]] - y[t[i - 1]]) * (u - x[t[i - 1]]) for i in range(3)]
            inside = (np.min(side, 0) >= -0.5) | (np.max(side, 0) <= 0.5)
            image[rows[0]:rows[-1] + 1, columns[0]:columns[-1] + 1][inside] = 0.93 * colour
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    header = struct.pack(">IIBBBBB", image.shape[1], image.shape[0], 8, 2, 0, 0, 0)
    rows = b"".join(b"\0" + row.tobytes() for row in image)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def main():
    mesh, constraints, feature, picture = sys.argv[1:5]
    program = sys.argv[5] if len(sys.argv) > 5 else "build/planish"
    position, triangle, features = embedded(mesh, constraints, program)
    chain = features[feature]["vertices"]
    steps = np.linalg.norm(np.diff(position[chain], axis=0), axis=1)
    template = np.concatenate([[0], np.cumsum(steps)]).astype(complex)
    whole, boundary = conformal_energy(position, triangle)
    on_chain = set(chain)
    along = frozenset(e for e in boundary if e[0] in on_chain and e[1] in on_chain)
    ends = sorted({v for e in boundary for v in e})
    distance = np.linalg.norm(position[ends][:, None] - position[ends][None], axis=2)
    i, j = np.unravel_index(distance.argmax(), distance.shape)
    far = [ends[i], ends[j]]
    middle = position[chain].mean(0)
    edge = max((e for e in boundary if not on_chain & set(e)), key=lambda e: np.linalg.norm(position[e[0]] - middle))

    def pins(pair):
        return [(pair[0], 0), (pair[1], np.linalg.norm(position[pair[0]] - position[pair[1]]))]

    cases = [("natural boundary everywhere, a far pair pinned", lambda: minimise(whole, chain, template, pins(far))),
             ("the same, the chain's ends pinned", lambda: minimise(whole, chain, template, pins([chain[0], chain[-1]]))),
             ("the same, one edge pinned", lambda: minimise(whole, chain, template, pins(edge))),
             ("boundary term left out along the chain",
              lambda: minimise(conformal_energy(position, triangle, along)[0], chain, template, pins(far))),
             ("conditions of the chain in place of natural ones", lambda: replace_rows(whole, chain, template, pins(far)))]
    maps, means = [], []
    print("| | arap | conformal | least stretch | largest | flipped |\n| --- | --- | --- | --- | --- | --- |")
    for name, solve in cases:
        z = fitted(position, triangle, solve())
        s1, s2, area = stretches(position, triangle, z)
        energy = (area * ((s1 - 1) ** 2 + (s2 - 1) ** 2)).sum() / area.sum()
        conformal = (area * (s1 - s2) ** 2 / 2).sum() / area.sum()
        print(f"| {name} | {energy:.2e} | {conformal:.2e} | {s2.min():.3g} | {s1.max():.3g} | {(s2 <= 0).sum()} |", flush=True)
        maps.append(z)
        means.append((s1 + s2) / 2)
    shown = [0, 3, 4]
    draw(picture, triangle, [maps[k] for k in shown], [means[k] for k in shown])


if __name__ == "__main__":
    main()
