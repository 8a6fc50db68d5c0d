"""Triangle meshes of the benchmark's scenes: reading OBJ, writing PLY, and a few made from
formulas.

A mesh is a Mesh of numpy arrays. Everything is deterministic: the random numbers come from
random.Random, whose sequence is the same in every version of Python.
"""

import dataclasses
import math
import pathlib
import random

import numpy as np


@dataclasses.dataclass
class Mesh:
    """points (n, 3), triangles (m, 3) of indices; normals (n, 3) and uvs (n, 2) where there are
    any. uv follows Mitsuba's PLY: v = 0 is the first row of the texture."""
    points: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray | None = None
    uvs: np.ndarray | None = None


def read_obj(path):
    """An OBJ file of triangles in which a vertex has the same index for point, uv and normal."""
    columns = {"v": [], "vt": [], "vn": [], "f": []}
    for line in pathlib.Path(path).read_text().splitlines():
        kind, _, rest = line.partition(" ")
        if kind == "f":
            columns["f"].append([int(word.split("/")[0]) - 1 for word in rest.split()])
        elif kind in columns:
            columns[kind].append([float(word) for word in rest.split()])
    points, uvs, normals = (np.array(columns[kind]) if columns[kind] else None
                            for kind in ("v", "vt", "vn"))
    if uvs is not None:
        uvs = np.stack([uvs[:, 0], 1 - uvs[:, 1]], axis=1)  # OBJ counts v from the last row
    return with_normals(Mesh(points, np.array(columns["f"]), normals, uvs))


def with_normals(mesh):
    """The mesh with vertex normals: its own, or else the sum of its triangles' normals weighted by
    the angle at the corner. They are stored, since programs compute missing ones differently."""
    if mesh.normals is not None:
        return mesh
    corners = mesh.points[mesh.triangles]
    sums = np.zeros_like(mesh.points)
    for i in range(3):
        a, b = (corners[:, (i + k) % 3] - corners[:, i] for k in (1, 2))
        face = np.cross(a, b)
        area = np.linalg.norm(face, axis=1)
        angle = np.arctan2(area, (a * b).sum(1))
        np.add.at(sums, mesh.triangles[:, i], face * (angle / np.maximum(area, 1e-30))[:, None])
    normals = sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-30)
    return dataclasses.replace(mesh, normals=normals)


def standing(mesh, height=1.0):
    """The mesh scaled to a height, on the plane y = 0 and centred on the y axis."""
    low, high = mesh.points.min(0), mesh.points.max(0)
    origin = np.array([(low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2])
    points = (mesh.points - origin) * (height / (high[1] - low[1]))
    return dataclasses.replace(mesh, points=points)


def write_ply(mesh, path):
    """Binary little-endian PLY: float32 x y z, then nx ny nz and u v where the mesh has them."""
    arrays = [(mesh.points, "x y z"), (mesh.normals, "nx ny nz"), (mesh.uvs, "u v")]
    there = [(array, names) for array, names in arrays if array is not None]
    properties = "".join(f"property float {name}\n" for _, names in there for name in names.split())
    faces = np.zeros(len(mesh.triangles), np.dtype([("count", "u1"), ("corners", "<i4", 3)]))
    faces["count"], faces["corners"] = 3, mesh.triangles
    with open(path, "wb") as file:
        file.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {len(mesh.points)}\n"
                    f"{properties}element face {len(faces)}\n"
                    "property list uchar int vertex_indices\nend_header\n").encode())
        file.write(np.hstack([array for array, _ in there]).astype("<f4").tobytes())
        file.write(faces.tobytes())


def icosphere(level):
    """The unit sphere by `level` subdivisions of an icosahedron, with exact normals."""
    golden = (1 + 5 ** .5) / 2
    points = np.array([[x, y * golden, 0] for x in (-1, 1) for y in (-1, 1)])
    points = np.concatenate([np.roll(points, shift, axis=1) for shift in range(3)])
    # Its triangles: three corners, all an edge (of length 2) apart, seen anticlockwise from
    # outside.
    near = np.abs(np.linalg.norm(points[:, None] - points[None], axis=2) - 2) < 1e-9
    triangles = np.array([
        (i, j, k) if np.linalg.det(points[[i, j, k]]) > 0 else (i, k, j)
        for i in range(12) for j in range(i) for k in range(j)
        if near[i, j] and near[j, k] and near[i, k]])
    points = points / np.linalg.norm(points[0])
    for _ in range(level):
        edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unique, which = np.unique(edges, axis=0, return_inverse=True)
        middle = points[unique].sum(1)
        middle /= np.linalg.norm(middle, axis=1, keepdims=True)
        ab, bc, ca = (which.reshape(-1, 3) + len(points)).T
        a, b, c = triangles.T
        points = np.concatenate([points, middle])
        triangles = np.concatenate([np.stack(t, axis=1) for t in
                                    ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return Mesh(points, triangles, points.copy())


def waves(points, seed, count, lowest, highest, roughness):
    """A sum of `count` sine waves at points (n, k), with angular frequencies from lowest to highest
    and amplitudes that fall with the power -roughness of the frequency; within about -1 to 1."""
    draw = random.Random(seed)
    total, scale = np.zeros(len(points)), 0.0
    for i in range(count):
        frequency = lowest * (highest / lowest) ** (i / (count - 1))
        direction = np.array([draw.gauss(0, 1) for _ in range(points.shape[1])])
        direction *= frequency / np.linalg.norm(direction)
        amplitude = (frequency / lowest) ** -roughness
        total += amplitude * np.sin(points @ direction + draw.uniform(0, 2 * math.pi))
        scale += amplitude ** 2
    return total / math.sqrt(2 * scale)


def blob(seed, level):
    """A sphere with soft bumps, 20 * 4**level triangles."""
    mesh = icosphere(level)
    points = mesh.points * (1 + .35 * waves(mesh.points, seed, 12, 2.0, 9.0, 1.0))[:, None]
    return with_normals(Mesh(points, mesh.triangles))


def terrain(seed, cells, side, height):
    """A square landscape around the origin, 2 * cells**2 triangles, without normals."""
    steps = np.linspace(-side / 2, side / 2, cells + 1)
    z, x = (grid.ravel() for grid in np.meshgrid(steps, steps, indexing="ij"))
    flat = np.stack([x, z], axis=1)
    y = height * waves(flat, seed, 70, 6 / side, 2000 / side, .9)
    first = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    right, below, across = first + 1, first + cells + 1, first + cells + 2
    triangles = np.concatenate([np.stack([first, below, across], axis=1),
                                np.stack([first, across, right], axis=1)])
    return Mesh(np.stack([x, y, z], axis=1), triangles)
