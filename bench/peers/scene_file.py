"""Reads the Mitsuba XML of the benchmark's scenes for the peers that cannot.

Only what bench/make_scenes.py writes: defaults, references, a perspective camera, rectangles,
spheres, binary PLY meshes of triangles and instances of groups of them, diffuse (also with a
bitmap), mirror and glass, area lights, an even sky or an environment map. Anything else is a
ValueError, never left out.
"""

import dataclasses
import functools
import pathlib
import xml.etree.ElementTree as ET

import numpy as np

from meshes import Mesh

Colour = tuple[float, float, float]


@dataclasses.dataclass(frozen=True)
class Material:
    """kind: "diffuse" (a colour or a texture file in sRGB), "mirror", "glass" (ior:
    inside/outside)."""
    kind: str = "diffuse"
    colour: Colour = (.5, .5, .5)
    texture: str | None = None
    ior: float = 1.0


@dataclasses.dataclass
class Shape:
    """kind: "sphere" (centre, radius), "rectangle" (the square from -1 to 1 in x and y, facing +z,
    under to_world) or "mesh" (mesh under to_world). radiance: what it emits on its outside, or
    None."""
    kind: str
    material: Material
    radiance: Colour | None = None
    centre: np.ndarray | None = None
    radius: float = 0.0
    to_world: np.ndarray | None = None
    mesh: Mesh | None = None


@dataclasses.dataclass
class Scene:
    """sky: a colour, the path of an environment map (Mitsuba's orientation, y up), or None."""
    width: int = 0
    height: int = 0
    fov: float = 0.0  # horizontal, degrees
    origin: np.ndarray | None = None
    target: np.ndarray | None = None
    up: np.ndarray | None = None
    max_depth: int = 0
    rr_depth: int = 0
    sky: Colour | pathlib.Path | None = None
    shapes: list[Shape] = dataclasses.field(default_factory=list)


@functools.cache
def read_ply(path, flat):
    """A binary PLY of float vertices and triangles; flat: without its normals."""
    data = pathlib.Path(path).read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    counts, names = {}, []
    for words in (line.split() for line in data[:end].decode().splitlines()):
        if words[0] == "element":
            counts[words[1]] = int(words[2])
        elif words[:2] == ["property", "float"]:
            names.append(words[2])
    vertices = np.frombuffer(data, "<f4", counts["vertex"] * len(names), end)
    faces = np.frombuffer(data, np.dtype([("count", "u1"), ("corners", "<i4", 3)]), counts["face"],
                          end + vertices.nbytes)
    vertices = vertices.reshape(-1, len(names)).astype(float)

    def columns(*wanted):
        there = wanted[0] in names
        return vertices[:, [names.index(name) for name in wanted]] if there else None

    return Mesh(columns("x", "y", "z"), faces["corners"],
                None if flat else columns("nx", "ny", "nz"), columns("u", "v"))


def read_radiance(path):
    """An environment map as bench/make_scenes.py writes it: float (height, width, 3)."""
    data = pathlib.Path(path).read_bytes()
    start = data.index(b"\n\n") + 2
    end = data.index(b"\n", start) + 1
    height, width = (int(word) for word in data[start:end].split()[1::2])
    pieces = -(-width // 128)
    length = 4 + 4 * (width + pieces)
    rows = np.frombuffer(data, np.uint8, height * length, end).reshape(height, length)
    lengths = np.arange(pieces) * 129  # each run of literal bytes begins with its length
    bytes_ = np.delete(rows[:, 4:].reshape(height, 4, -1), lengths, axis=2).astype(float)
    scale = np.where(bytes_[:, 3] > 0, 2.0 ** (bytes_[:, 3] - 136), 0)
    return np.moveaxis((bytes_[:, :3] + .5) * scale[:, None], 1, 2)


class _Reader:
    def __init__(self, path, overrides):
        self.folder = path.parent
        self.root = ET.parse(path).getroot()
        self.values = {e.get("name"): e.get("value") for e in self.root.iter("default")}
        self.values.update({name: str(value) for name, value in overrides.items()})
        self.named = {e.get("id"): e for e in self.root.iter("bsdf")}
        self.groups = {}

    def text(self, element, attribute="value"):
        text = element.get(attribute)
        return self.values[text[1:]] if text.startswith("$") else text

    def vector(self, element, attribute="value"):
        numbers = [float(word) for word in self.text(element, attribute).replace(",", " ").split()]
        return numbers * 3 if len(numbers) == 1 else numbers

    def child(self, element, name):
        """The child of that name, or None."""
        return next((e for e in element if e.get("name") == name), None)

    def number(self, element, name):
        return float(self.text(self.child(element, name)))

    def colour(self, element, name):
        return tuple(self.vector(self.child(element, name)))

    def file(self, element):
        return self.folder / self.text(self.child(element, "filename"))

    def transform(self, element):
        """The product of a transform's steps, of which each is applied after those before it."""
        matrix = np.eye(4)
        for step in element if element is not None else ():
            m = np.eye(4)
            if step.tag == "scale":
                m[:3, :3] = np.diag(self.vector(step) if step.get("value") else
                                    [float(step.get(axis, 1)) for axis in "xyz"])
            elif step.tag == "translate":
                m[:3, 3] = [float(step.get(axis, 0)) for axis in "xyz"]
            elif step.tag == "rotate":
                x, y, z = (float(step.get(axis, 0)) for axis in "xyz")
                cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) / np.linalg.norm([x, y, z])
                angle = np.radians(float(step.get("angle")))
                m[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
            else:
                raise ValueError(f"transform {step.tag}")
            matrix = m @ matrix
        return matrix

    def material(self, shape):
        """The BSDF inside a shape, or the one that it refers to; Mitsuba's default where there is
        none."""
        reference = shape.find("ref")
        bsdf = shape.find("bsdf") if reference is None else self.named[reference.get("id")]
        if bsdf is None:
            return Material()
        kind = bsdf.get("type")
        if kind == "diffuse":
            texture = bsdf.find("texture")
            if texture is None:
                return Material(colour=self.colour(bsdf, "reflectance"))
            if texture.get("type") == "bitmap":
                return Material(texture=str(self.file(texture)))
        elif kind == "conductor" and self.text(self.child(bsdf, "material")) == "none":
            return Material("mirror")
        elif kind == "dielectric":
            inside, outside = (self.number(bsdf, name) for name in ("int_ior", "ext_ior"))
            return Material("glass", ior=inside / outside)
        raise ValueError(f"bsdf {kind}")

    def shape(self, element):
        kind, light = element.get("type"), element.find("emitter")
        shape = Shape(kind, self.material(element),
                      None if light is None else self.colour(light, "radiance"))
        if kind == "sphere":
            centre = self.child(element, "center")
            shape.centre = np.array([float(centre.get(axis)) for axis in "xyz"])
            shape.radius = self.number(element, "radius")
            if element.find("transform") is not None:
                raise ValueError("a sphere with a transform")
        elif kind == "rectangle":
            shape.to_world = self.transform(element.find("transform"))
        elif kind == "ply":
            flag = self.child(element, "face_normals")
            flat = flag is not None and self.text(flag) == "true"
            shape.kind, shape.mesh = "mesh", read_ply(self.file(element), flat)
            shape.to_world = self.transform(element.find("transform"))
        else:
            raise ValueError(f"shape {kind}")
        if light is not None and shape.kind == "mesh":
            raise ValueError("a mesh that emits light")
        return shape

    def instance(self, element):
        """The shapes of a group, sharing its meshes, where the instance puts them."""
        matrix = self.transform(element.find("transform"))
        shapes = self.groups[element.find("ref").get("id")]
        if any(shape.kind == "sphere" for shape in shapes):
            raise ValueError("a sphere in a group")
        return [dataclasses.replace(shape, to_world=matrix @ shape.to_world) for shape in shapes]

    def scene(self):
        scene = Scene()
        for element in self.root:
            kind = element.get("type")
            if element.tag == "integrator" and kind == "path":
                scene.max_depth = int(self.number(element, "max_depth"))
                scene.rr_depth = int(self.number(element, "rr_depth"))
            elif element.tag == "sensor" and kind == "perspective":
                (camera,) = element.find("transform")  # a lookat, and nothing else
                scene.origin, scene.target, scene.up = (
                    np.array(self.vector(camera, name)) for name in ("origin", "target", "up"))
                scene.fov = self.number(element, "fov")
                scene.width, scene.height = (
                    int(self.number(element.find("film"), name)) for name in ("width", "height"))
            elif element.tag == "shape" and kind == "shapegroup":
                self.groups[element.get("id")] = [self.shape(e) for e in element.findall("shape")]
            elif element.tag == "shape" and kind == "instance":
                scene.shapes += self.instance(element)
            elif element.tag == "shape":
                scene.shapes.append(self.shape(element))
            elif element.tag == "emitter" and kind == "constant":
                scene.sky = self.colour(element, "radiance")
            elif element.tag == "emitter" and kind == "envmap":
                scene.sky = self.file(element)
            elif element.tag not in ("default", "bsdf"):
                raise ValueError(f"{element.tag} {kind}")
        return scene


def read_scene(path, overrides):
    """The scene of a file, with other values for some of its defaults; raises ValueError."""
    return _Reader(pathlib.Path(path), overrides).scene()
