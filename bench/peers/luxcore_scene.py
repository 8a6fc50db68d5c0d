"""Describes a scene to LuxCore, the way that its CPU path engine renders it best.

Spheres: LuxCore has none, so they are fine meshes with exact normals, all instances of one. Of a
wall that is a huge sphere only the part near the scene is made. A sphere that shines is LuxCore's
sphere light, which is sampled by solid angle but cannot be hit: a shining mesh just inside shows it
to the camera, mirrors and glass, and not to diffuse paths, for which the light itself already
counts.
"""


import numpy as np
import pyluxcore

from meshes import Mesh, icosphere
from peers.scene_file import Material, Scene, read_radiance

# From Mitsuba's directions (y up) to those of LuxCore's environment maps (z up).
TO_MAP = np.array([[0., 0, -1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
SQUARE = Mesh(np.array([[-1., -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]),
              np.array([[0, 1, 2], [0, 2, 3]]))


def linear(picture):
    """sRGB values from 0 to 1, made linear."""
    return np.where(picture <= .04045, picture / 12.92, ((picture + .055) / 1.055) ** 2.4)


def cap(direction, half_width, cells=96):
    """The part of the unit sphere around a direction, a square of tangents up to half_width."""
    direction = direction / np.linalg.norm(direction)
    x = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    x /= np.linalg.norm(x)
    steps = np.linspace(-half_width, half_width, cells + 1)
    u, v = (grid.ravel()[:, None] for grid in np.meshgrid(steps, steps, indexing="ij"))
    points = direction + u * x + v * np.cross(direction, x)
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    a = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    b, c, d = a + 1, a + cells + 1, a + cells + 2
    return Mesh(points, np.concatenate([np.stack([a, c, d], 1), np.stack([a, d, b], 1)]), points)


def enlarge(picture, factor=4):
    """An environment map with Mitsuba's interpolation, in `factor` times as many rows and columns.
    LuxCore samples whole texels; with its own interpolation the dark ones beside a sun, which then
    shine but are hardly sampled, are fireflies. Fine texels without interpolation match exactly."""
    height, width = picture.shape[:2]
    x = (np.arange(factor * width) + .5) / factor - .5
    # Mitsuba's first and last rows are the poles.
    y = (np.arange(factor * height) + .5) / (factor * height) * (height - 1)
    left, top = np.floor(x).astype(int), np.minimum(y.astype(int), height - 2)
    right, down = (x - left)[None, :, None], (y - top)[:, None, None]
    rows = picture[top] * (1 - down) + picture[top + 1] * down
    return rows[:, left % width] * (1 - right) + rows[:, (left + 1) % width] * right


class Translation:
    """A pyluxcore.Scene (.scene) and the properties of its camera, made from a Scene."""

    def __init__(self, source: Scene):
        self.scene = pyluxcore.Scene()
        self.lines, self.count = [], 0
        self.materials, self.meshes = {}, {}
        self.reach = np.linalg.norm(source.target - source.origin)
        self.add_camera(source)
        self.add_sky(source.sky)
        for shape in source.shapes:
            if shape.kind == "sphere":
                self.add_sphere(shape, source.target)
            else:
                mesh = shape.mesh if shape.kind == "mesh" else SQUARE
                self.add_object(self.mesh(mesh), self.material(shape.material, shape.radiance),
                                shape.to_world)
        properties = pyluxcore.Properties()
        properties.SetFromString("".join(self.lines))
        self.scene.Parse(properties)

    def put(self, name, *values):
        """A property: one word, or numbers."""
        words = [v if isinstance(v, str) else repr(float(v)) for value in values
                 for v in ([value] if isinstance(value, str) else np.ravel(value))]
        self.lines.append(f"scene.{name} = {' '.join(words)}\n")

    def new(self, kind):
        self.count += 1
        return f"{kind}{self.count}"

    def add_camera(self, source):
        self.put("camera.type", "perspective")
        self.put("camera.lookat.orig", source.origin)
        self.put("camera.lookat.target", source.target)
        self.put("camera.up", source.up)
        self.put("camera.fieldofview", source.fov)
        # x from -1 to 1: the field of view is horizontal. LuxCore's raster lies a row too low.
        width, height = source.width, source.height
        self.put("camera.screenwindow", -1, 1, -(height + 2) / width, (height - 2) / width)
        self.put("camera.autovolume.enable", "0")
        self.put("camera.cliphither", 1e-3)

    def add_sky(self, sky):
        if sky is None:
            return
        if isinstance(sky, tuple):
            self.put("lights.sky.type", "constantinfinite")
            self.put("lights.sky.gain", sky)
        else:
            self.add_picture("sky_map", enlarge(read_radiance(sky)))
            self.put("lights.sky.type", "infinite")
            self.put("lights.sky.file", "sky_map")
            self.put("lights.sky.gamma", 1)
            self.put("lights.sky.storage", "float")
            self.put("lights.sky.filter", "nearest")
            self.put("lights.sky.gain", 1, 1, 1)
            self.put("lights.sky.transformation", np.linalg.inv(TO_MAP).T)
        self.put("lights.sky.color", 1, 1, 1)

    def add_picture(self, name, picture):
        """A linear float picture under a name that stands for a file."""
        height, width = picture.shape[:2]
        picture = np.ascontiguousarray(picture, np.float32)
        self.scene.DefineImageMap(name, picture, 1.0, 3, width, height)

    def material(self, wanted: Material, radiance=None, shown=False):
        """The name of a material. shown: its light is seen but neither sampled nor found by diffuse
        paths."""
        key = wanted, radiance, shown
        if key in self.materials:
            return self.materials[key]
        name = self.materials[key] = self.new("material")
        prefix = f"materials.{name}."
        self.put(prefix + "type", "matte" if wanted.kind == "diffuse" else wanted.kind)
        if wanted.texture:
            from PIL import Image
            picture = np.asarray(Image.open(wanted.texture).convert("RGB")) / 255
            self.add_picture(f"{name}_map", linear(picture))
            self.put(f"textures.{name}.type", "imagemap")
            self.put(f"textures.{name}.file", f"{name}_map")
            self.put(f"textures.{name}.gamma", 1)
            self.put(prefix + "kd", name)
        elif wanted.kind == "diffuse":
            self.put(prefix + "kd", wanted.colour)
        else:
            self.put(prefix + "kr", 1, 1, 1)
        if wanted.kind == "glass":
            self.put(prefix + "kt", 1, 1, 1)
            self.put(prefix + "interiorior", wanted.ior)
            self.put(prefix + "exteriorior", 1)
        if radiance:
            self.put(prefix + "emission", radiance)
            self.put(prefix + "emission.directlightsampling.type",
                     "DISABLED" if shown else "ENABLED")
            for kind in ("diffuse", "glossy") if shown else ():
                self.put(prefix + f"visibility.indirect.{kind}.enable", "0")
        return name

    def mesh(self, mesh):
        """The name of a mesh, which is defined once."""
        if id(mesh) not in self.meshes:
            def tuples(array):
                return None if array is None else list(map(tuple, array.tolist()))
            name = self.new("mesh")
            arrays = mesh.points, mesh.triangles, mesh.normals, mesh.uvs
            self.scene.DefineMesh(name, *map(tuples, arrays), None, None)
            self.meshes[id(mesh)] = name, mesh  # held: an id is only unique while it lives
        return self.meshes[id(mesh)][0]

    def add_object(self, mesh, material, matrix):
        prefix = f"objects.{self.new('object')}."
        self.put(prefix + "shape", mesh)
        self.put(prefix + "material", material)
        self.put(prefix + "transformation", matrix.T)

    def ball(self, level):
        """The icosphere of a level, made once."""
        if level not in self.meshes:
            self.meshes[level] = icosphere(level)
        return self.mesh(self.meshes[level])

    def add_sphere(self, shape, target):
        matrix = np.eye(4)
        matrix[:3, 3] = shape.centre
        radius, small = shape.radius, shape.radius < .02 * self.reach
        if shape.radiance:
            matrix[:3, :3] *= .9999 * radius
            glow = self.material(shape.material, shape.radiance, shown=True)
            self.add_object(self.ball(2 if small else 4), glow, matrix)
            prefix = f"lights.{self.new('light')}."
            self.put(prefix + "type", "sphere")
            self.put(prefix + "position", shape.centre)
            self.put(prefix + "radius", radius)
            self.put(prefix + "color", 1, 1, 1)
            self.put(prefix + "gain", np.array(shape.radiance) * 4 * np.pi ** 2 * radius ** 2)
            return
        matrix[:3, :3] *= radius
        if radius > 10 * self.reach:
            mesh = self.mesh(cap(target - shape.centre, 2.5 * self.reach / radius))
        else:
            mesh = self.ball(4 if small else 5)
        self.add_object(mesh, self.material(shape.material), matrix)
