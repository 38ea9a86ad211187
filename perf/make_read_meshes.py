#!/usr/bin/env python3
"""Writes one wavy grid in every format that planish reads, for read_bench.

usage: make_read_meshes.py [TRIANGLES [FOLDER]]        (1000000, the current folder)
"""
import math, os, random, struct, sys

triangles = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
folder = sys.argv[2] if len(sys.argv) > 2 else '.'
n = round(math.sqrt(triangles / 2)) + 1
rng = random.Random(1)


def float32(x):
    return struct.unpack('<f', struct.pack('<f', x))[0]


# Coordinates are float32, so that STL holds the same ones.
points = [(float32(i / n + 1e-4 * rng.random()), float32(j / n + 1e-4 * rng.random()),
           float32(0.1 * math.sin(9 * i / n) * math.cos(7 * j / n) + 1e-5 * rng.random()))
          for j in range(n) for i in range(n)]
faces = []
for j in range(n - 1):
    for i in range(n - 1):
        a = j * n + i
        faces += [(a, a + 1, a + n + 1), (a, a + n + 1, a + n)]


def out(name):
    return open(os.path.join(folder, name), 'wb')


with out('grid.obj') as f:
    f.write(''.join('v %.9g %.9g %.9g\n' % p for p in points).encode())
    f.write(''.join('f %d %d %d\n' % (a + 1, b + 1, c + 1) for a, b, c in faces).encode())
with out('grid_uv.obj') as f:
    f.write(''.join('v %.9g %.9g %.9g\n' % p for p in points).encode())
    f.write(''.join('vt %.9g %.9g\n' % p[:2] for p in points).encode())
    f.write(''.join('f %d/%d %d/%d %d/%d\n' % (a + 1, a + 1, b + 1, b + 1, c + 1, c + 1) for a, b, c in faces).encode())
with out('grid.off') as f:
    f.write(b'OFF\n%d %d 0\n' % (len(points), len(faces)))
    f.write(''.join('%.9g %.9g %.9g\n' % p for p in points).encode())
    f.write(''.join('3 %d %d %d\n' % t for t in faces).encode())
for name, kind in (('grid.ply', 'binary_little_endian'), ('grid_ascii.ply', 'ascii')):
    with out(name) as f:
        f.write(b'ply\nformat %s 1.0\nelement vertex %d\n' % (kind.encode(), len(points)))
        f.write(b'property double x\nproperty double y\nproperty double z\n')
        f.write(b'element face %d\nproperty list uchar int vertex_indices\nend_header\n' % len(faces))
        if kind == 'ascii':
            f.write(''.join('%.9g %.9g %.9g\n' % p for p in points).encode())
            f.write(''.join('3 %d %d %d\n' % t for t in faces).encode())
        else:
            f.write(b''.join(struct.pack('<3d', *p) for p in points))
            f.write(b''.join(struct.pack('<B3i', 3, *t) for t in faces))
with out('grid.stl') as f:
    f.write(b'planish'.ljust(80) + struct.pack('<I', len(faces)))
    f.write(b''.join(struct.pack('<12fH', 0, 0, 0, *points[a], *points[b], *points[c], 0) for a, b, c in faces))
with out('grid_ascii.stl') as f:
    f.write(b'solid grid\n')
    for t in faces:
        f.write(b'facet normal 0 0 0\n outer loop\n')
        f.write(''.join('  vertex %.9g %.9g %.9g\n' % points[v] for v in t).encode())
        f.write(b' endloop\nendfacet\n')
    f.write(b'endsolid grid\n')
