"""Builds a scene in Blender for Cycles, the way that Cycles renders it best.

Lights: a rectangle is an area light (sampled by solid angle; as an emissive mesh it has ten times
the variance) in front of a black plate, because lights let rays through. A sphere is a point light
with a radius (sampled by its cone).
Spheres: exact ones are the points of a point cloud, one cloud for each material. Glass, which has
to be hit from inside too, is a fine mesh.
"""

import math

import bpy
import numpy as np

from meshes import Mesh
from peers.scene_file import Material, Scene

# So many sphere lights that testing every ray against each of them costs more than it brings.
MANY_LIGHTS = 8
# The frame of an area light, which shines along its own -z, in that of a rectangle, along +z.
TURNED = np.diag([1.0, -1.0, -1.0, 1.0])


def frame(x, y, z, origin):
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = x, y, z, origin
    return matrix


def unit(vector):
    return vector / np.linalg.norm(vector)


def new_mesh(name, mesh):
    """A Blender mesh with the same normals and texture coordinates."""
    data = bpy.data.meshes.new(name)
    corners = np.ascontiguousarray(mesh.triangles, np.int32)
    data.vertices.add(len(mesh.points))
    data.vertices.foreach_set("co", np.ascontiguousarray(mesh.points, np.float32).ravel())
    data.loops.add(corners.size)
    data.loops.foreach_set("vertex_index", corners.ravel())
    data.polygons.add(len(corners))
    data.polygons.foreach_set("loop_start", np.arange(0, corners.size, 3, dtype=np.int32))
    if mesh.uvs is not None:  # Blender's v begins at the last row of the texture
        uvs = np.stack([mesh.uvs[:, 0], 1 - mesh.uvs[:, 1]], axis=1).astype(np.float32)
        layer = data.uv_layers.new(name="UVMap")
        layer.uv.foreach_set("vector", np.ascontiguousarray(uvs[corners.ravel()]).ravel())
    data.update(calc_edges=True)
    smooth = mesh.normals is not None
    data.polygons.foreach_set("use_smooth", np.full(len(corners), smooth))
    if smooth:
        normals = data.attributes.new("custom_normal", "FLOAT_VECTOR", "POINT")
        normals.data.foreach_set("vector", np.ascontiguousarray(mesh.normals, np.float32).ravel())
    return data


def fine_sphere(rings=180, segments=360):
    """The unit sphere of latitudes and longitudes, with exact normals."""
    theta, phi = np.meshgrid(np.arange(rings + 1) * math.pi / rings,
                             np.arange(segments) * 2 * math.pi / segments, indexing="ij")
    points = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)
    ring, column = (grid.ravel() for grid in
                    np.meshgrid(np.arange(rings), np.arange(segments), indexing="ij"))
    a, b = ring * segments + column, ring * segments + (column + 1) % segments
    c, d = a + segments, b + segments
    upper, lower = ring > 0, ring < rings - 1  # at the poles the squares are triangles
    triangles = np.concatenate([np.stack([a, d, b], 1)[upper], np.stack([a, c, d], 1)[lower]])
    points = points.reshape(-1, 3)
    return Mesh(points, triangles, points)


class Translation:
    """Puts a Scene into Blender's current scene."""

    def __init__(self, scene: Scene):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.target = bpy.context.scene
        self.materials, self.meshes = {}, {}
        self.add_camera(scene)
        self.add_sky(scene.sky)
        lights, balls = [], {}
        for shape in scene.shapes:
            if shape.kind == "sphere" and shape.radiance:
                lights.append(shape)
            elif shape.kind == "sphere" and shape.material.kind == "glass":
                scale = np.diag([shape.radius] * 3 + [1.0])
                scale[:3, 3] = shape.centre
                self.add_mesh("glass", fine_sphere, shape.material, scale)
            elif shape.kind == "sphere":
                balls.setdefault(shape.material, []).append(shape)
            elif shape.kind == "rectangle" and shape.radiance:
                self.add_rectangle_light(shape)
            elif shape.kind == "rectangle":
                self.add_rectangle(shape.material, shape.to_world)
            else:
                self.add_mesh(id(shape.mesh), lambda mesh=shape.mesh: mesh, shape.material,
                              shape.to_world)
        for material, group in balls.items():
            self.add_cloud(group, self.material(material))
        if lights:
            specular = any(shape.material.kind != "diffuse" for shape in scene.shapes)
            self.add_sphere_lights(lights, hidden=len(lights) > MANY_LIGHTS and not specular)

    def add(self, name, data, matrix):
        thing = bpy.data.objects.new(name, data)
        thing.matrix_world = matrix.T.tolist()
        self.target.collection.objects.link(thing)
        # Cycles would move the starts of rays near flat-looking edges; nobody else does.
        thing.cycles.shadow_terminator_geometry_offset = 0
        thing.cycles.shadow_terminator_offset = 0
        return thing

    def add_camera(self, scene):
        camera = bpy.data.cameras.new("camera")
        camera.sensor_fit, camera.angle_x = "HORIZONTAL", math.radians(scene.fov)
        camera.clip_start, camera.clip_end = 1e-4, 1e6
        forward = unit(scene.target - scene.origin)
        right = unit(np.cross(forward, scene.up))
        matrix = frame(right, np.cross(right, forward), -forward, scene.origin)
        self.target.camera = self.add("camera", camera, matrix)

    def add_sky(self, sky):
        world = self.target.world = bpy.data.worlds.new("world")
        world.use_nodes = True
        tree = world.node_tree
        tree.nodes.clear()
        background, output = (tree.nodes.new("ShaderNode" + kind)
                              for kind in ("Background", "OutputWorld"))
        tree.links.new(background.outputs[0], output.inputs["Surface"])
        if sky is None or isinstance(sky, tuple):
            background.inputs["Color"].default_value = (*(sky or (0, 0, 0)), 1)
            return
        coordinates, mapping, picture = (tree.nodes.new("ShaderNode" + kind)
                                         for kind in ("TexCoord", "Mapping", "TexEnvironment"))
        picture.image = bpy.data.images.load(str(sky))
        picture.image.colorspace_settings.name = "Linear Rec.709"
        picture.interpolation, picture.projection = "Linear", "EQUIRECTANGULAR"
        # Mitsuba's map has y up, Blender's z.
        mapping.vector_type = "POINT"
        mapping.inputs["Rotation"].default_value = (math.pi / 2, 0, math.pi / 2)
        tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs["Vector"], picture.inputs["Vector"])
        tree.links.new(picture.outputs["Color"], background.inputs["Color"])

    def material(self, wanted: Material):
        if wanted in self.materials:
            return self.materials[wanted]
        material = self.materials[wanted] = bpy.data.materials.new(wanted.kind)
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        kind = {"diffuse": "BsdfDiffuse", "mirror": "BsdfGlossy", "glass": "BsdfGlass"}[wanted.kind]
        bsdf, output = (tree.nodes.new("ShaderNode" + name) for name in (kind, "OutputMaterial"))
        tree.links.new(bsdf.outputs[0], output.inputs["Surface"])
        bsdf.inputs["Roughness"].default_value = 0
        colour = wanted.colour if wanted.kind == "diffuse" else (1, 1, 1)
        bsdf.inputs["Color"].default_value = (*colour, 1)
        if wanted.kind == "glass":
            bsdf.inputs["IOR"].default_value = wanted.ior
        if wanted.texture:
            picture = tree.nodes.new("ShaderNodeTexImage")
            picture.image = bpy.data.images.load(wanted.texture, check_existing=True)
            picture.image.colorspace_settings.name = "sRGB"
            picture.interpolation, picture.extension = "Linear", "REPEAT"
            tree.links.new(picture.outputs["Color"], bsdf.inputs["Color"])
        return material

    def add_mesh(self, key, make, material, matrix):
        """An object of a mesh. Objects share it, as true instances, where the material is the same:
        that sits on the mesh, since one on the object makes Cycles copy the mesh."""
        if (key, material) not in self.meshes:
            data = self.meshes[key, material] = new_mesh(str(key), make())
            data.materials.append(self.material(material))
        self.add("mesh", self.meshes[key, material], matrix)

    def add_rectangle(self, material, matrix):
        def square():
            corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
            return Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]))
        self.add_mesh("rectangle", square, material, matrix)

    def add_rectangle_light(self, shape):
        x, y, origin = (shape.to_world[:3, i] for i in (0, 1, 3))
        half_x, half_y = np.linalg.norm(x), np.linalg.norm(y)
        normal = np.cross(x, y) / (half_x * half_y)
        light = bpy.data.lights.new("lamp", "AREA")
        light.shape, light.size, light.size_y = "RECTANGLE", 2 * half_x, 2 * half_y
        self.set_power(light, shape.radiance, 4 * half_x * half_y * math.pi)
        self.add("lamp", light, frame(x / half_x, y / half_y, normal, origin) @ TURNED)
        plate = shape.to_world.copy()
        plate[:3, 3] -= 1e-4 * max(half_x, half_y) * normal
        self.add_rectangle(shape.material, plate)

    @staticmethod
    def set_power(light, radiance, factor):
        light.color = [c / max(radiance) for c in radiance]
        light.energy = max(radiance) * factor

    def add_sphere_lights(self, shapes, hidden):
        """hidden: the lights are only sampled, and the camera sees a cloud of spheres that glow in
        their places. Cycles tests a ray against every visible light, one by one: with hundreds that
        takes half of the time. Only right where the camera alone sees them without sampling: so not
        with mirrors and glass."""
        for shape in shapes:
            light = bpy.data.lights.new("lamp", "POINT")
            light.shadow_soft_size, light.use_soft_falloff = shape.radius, False
            self.set_power(light, shape.radiance, 4 * math.pi ** 2 * shape.radius ** 2)
            light.cycles.use_multiple_importance_sampling = not hidden
            matrix = np.eye(4)
            matrix[:3, 3] = shape.centre
            self.add("lamp", light, matrix).visible_camera = not hidden
        if not hidden:
            return
        glow = bpy.data.materials.new("glow")
        glow.use_nodes = True
        tree = glow.node_tree
        tree.nodes.clear()
        colour, emission, output = (tree.nodes.new("ShaderNode" + kind)
                                    for kind in ("Attribute", "Emission", "OutputMaterial"))
        colour.attribute_type, colour.attribute_name = "GEOMETRY", "radiance"
        tree.links.new(colour.outputs["Vector"], emission.inputs["Color"])
        tree.links.new(emission.outputs[0], output.inputs["Surface"])
        glow.cycles.emission_sampling = "NONE"
        cloud = self.add_cloud(shapes, glow, shrink=.999)  # or a light would lie in its own shadow
        cloud.visible_diffuse = cloud.visible_glossy = cloud.visible_transmission = False

    def add_cloud(self, shapes, material, shrink=1.0):
        """Spheres as a point cloud, which geometry nodes make from the points of a mesh: there is
        no call that makes one."""
        data = bpy.data.meshes.new("cloud")
        data.vertices.add(len(shapes))
        columns = {"position": ("FLOAT_VECTOR", "vector", [shape.centre for shape in shapes]),
                   "size": ("FLOAT", "value", [shape.radius * shrink for shape in shapes]),
                   "radiance": ("FLOAT_VECTOR", "vector",
                                [shape.radiance or (0, 0, 0) for shape in shapes])}
        for name, (kind, field, values) in columns.items():
            attribute = (data.attributes.get(name) or data.attributes.new(name, kind, "POINT"))
            attribute.data.foreach_set(field, np.array(values, np.float32).ravel())
        cloud = self.add("cloud", data, np.eye(4))
        tree = bpy.data.node_groups.new("cloud", "GeometryNodeTree")
        for name, way in (("in", "INPUT"), ("out", "OUTPUT")):
            tree.interface.new_socket(name, in_out=way, socket_type="NodeSocketGeometry")
        source, points, painted, size, sink = (tree.nodes.new(kind) for kind in (
            "NodeGroupInput", "GeometryNodeMeshToPoints", "GeometryNodeSetMaterial",
            "GeometryNodeInputNamedAttribute", "NodeGroupOutput"))
        size.data_type, size.inputs["Name"].default_value = "FLOAT", "size"
        painted.inputs["Material"].default_value = material
        for here, there in ((source.outputs[0], points.inputs["Mesh"]),
                            (size.outputs["Attribute"], points.inputs["Radius"]),
                            (points.outputs[0], painted.inputs["Geometry"]),
                            (painted.outputs[0], sink.inputs[0])):
            tree.links.new(here, there)
        cloud.modifiers.new("cloud", "NODES").node_group = tree
        return cloud
