#!/usr/bin/env python3
"""Writes the glTF models of this folder.

materials.gltf: balls of the materials that glTF has, on a textured ground, under two lamps: the back
row metal and the front row paint of growing roughness, between them glass, glass in a thin sheet, a
coat, a normal map, alpha as holes and as blending, and vertex colours.

lights.gltf: the three kinds of punctual lights over one mesh that many nodes show, mirrored as well.
"""
import base64
import json
import math
import os
import struct
import zlib


class Model:
    """A glTF file that is put together."""

    def __init__(self):
        self.data = b""
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}]}

    def add(self, name, item):
        self.json.setdefault(name, []).append(item)
        return len(self.json[name]) - 1

    def view(self, data):
        self.data += b"\0" * (-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)}
        self.data += data
        return self.add("bufferViews", view)

    def accessor(self, rows, letter="f", normalized=False):
        """Rows of numbers, or numbers; `letter` is that of `struct`."""
        rows = [row if isinstance(row, tuple) else (row,) for row in rows]
        numbers = [number for row in rows for number in row]
        accessor = {
            "bufferView": self.view(struct.pack(f"<{len(numbers)}{letter}", *numbers)),
            "componentType": {"B": 5121, "H": 5123, "f": 5126}[letter],
            "count": len(rows),
            "type": {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}[len(rows[0])],
        }
        if normalized:
            accessor["normalized"] = True
        if letter == "f" and len(rows[0]) == 3:
            accessor["min"] = [min(column) for column in zip(*rows)]
            accessor["max"] = [max(column) for column in zip(*rows)]
        return self.add("accessors", accessor)

    def texture(self, width, height, channels, pixel, sampler=None):
        """A picture of bytes, `pixel(x, y)` each."""
        rows = b"".join(b"\0" + bytes(v for x in range(width) for v in pixel(x, y)) for y in range(height))
        chunk = lambda tag, data: struct.pack(">I", len(data)) + tag + data + struct.pack(">I", zlib.crc32(tag + data))
        header = struct.pack(">IIBBBBB", width, height, 8, {3: 2, 4: 6}[channels], 0, 0, 0)
        png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")
        texture = {"source": self.add("images", {"bufferView": self.view(png), "mimeType": "image/png"})}
        if sampler:
            texture["sampler"] = self.add("samplers", sampler)
        return self.add("textures", texture)

    def material(self, color=(1, 1, 1, 1), metallic=0, roughness=0.5, extensions=None, base=None, gloss=None, **more):
        pbr = {"baseColorFactor": list(color), "metallicFactor": metallic, "roughnessFactor": roughness}
        if base is not None:
            pbr["baseColorTexture"] = base
        if gloss is not None:
            pbr["metallicRoughnessTexture"] = gloss
        material = {"pbrMetallicRoughness": pbr, **more}
        if extensions:
            material["extensions"] = extensions
            for name in extensions:
                self.use(name)
        return self.add("materials", material)

    def use(self, extension):
        used = self.json.setdefault("extensionsUsed", [])
        if extension not in used:
            used.append(extension)

    def mesh(self, attributes, indices, material):
        primitive = {"attributes": attributes, "indices": indices, "material": material}
        return self.add("meshes", {"primitives": [primitive]})

    def node(self, **node):
        self.json["scenes"][0]["nodes"].append(self.add("nodes", node))

    def look(self, eye, at, **node):
        """A node that looks along -z from one place at another."""
        back = unit([a - b for a, b in zip(eye, at)])
        right = unit(cross([0, 1, 0], back))
        up = cross(back, right)
        columns = [*right, 0, *up, 0, *back, 0, *eye, 1]
        self.node(matrix=[round(v, 6) for v in columns], **node)

    def light(self, place, at=None, **light):
        self.use("KHR_lights_punctual")
        lights = self.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append(light)
        node = {"extensions": {"KHR_lights_punctual": {"light": len(lights) - 1}}}
        if at is None:
            self.node(translation=place, **node)
        else:
            self.look(place, at, **node)

    def save(self, path):
        data = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        self.json["buffers"] = [{"byteLength": len(self.data), "uri": data}]
        with open(path, "w", encoding="utf-8") as file:
            json.dump(self.json, file, separators=(",", ":"))
            file.write("\n")


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def ball(model, columns=48, rows=24):
    """The attributes and indices of a unit sphere."""
    places, coordinates, corners = [], [], []
    for j in range(rows + 1):
        for i in range(columns + 1):
            theta, phi = math.pi * j / rows, 2 * math.pi * i / columns
            places.append((math.sin(theta) * math.cos(phi), math.cos(theta), -math.sin(theta) * math.sin(phi)))
            coordinates.append((i / columns, j / rows))
    for j in range(rows):
        for i in range(columns):
            a = j * (columns + 1) + i
            b = a + columns + 1
            corners += [a, b, a + 1] if j > 0 else []
            corners += [a + 1, b, b + 1] if j < rows - 1 else []
    place = model.accessor(places)
    return {"POSITION": place, "NORMAL": place, "TEXCOORD_0": model.accessor(coordinates)}, model.accessor(corners, "H")


def square(model):
    """Those of [-1, 1]^2 in y = 0, seen from above."""
    places = [(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]
    attributes = {
        "POSITION": model.accessor(places),
        "NORMAL": model.accessor([(0, 1, 0)] * 4),
        "TEXCOORD_0": model.accessor([(0, 1), (1, 1), (1, 0), (0, 0)]),
    }
    return attributes, model.accessor([0, 1, 2, 0, 2, 3], "B")


def transform(**values):
    return {"extensions": {"KHR_texture_transform": values}}


def materials():
    m = Model()
    m.use("KHR_texture_transform")
    ball_parts, square_parts = ball(m), square(m)
    checker = m.texture(2, 2, 3, lambda x, y: (205, 200, 190) if x == y else (120, 118, 115), {"magFilter": 9728})
    ground = m.material(roughness=0.7, base={"index": checker, **transform(scale=[12, 12], rotation=0.4)})
    m.node(mesh=m.mesh(*square_parts, ground), scale=[12, 1, 12])
    wall = m.material((0.45, 0.5, 0.6, 1), roughness=0.9)
    m.node(mesh=m.mesh(*square_parts, wall), scale=[12, 1, 4], rotation=[math.sqrt(0.5), 0, 0, math.sqrt(0.5)], translation=[0, 4, -5.5])

    strong = lambda s: {"KHR_materials_emissive_strength": {"emissiveStrength": s}}
    warm = m.material((0, 0, 0, 1), emissiveFactor=[1, 0.85, 0.65], extensions=strong(14))
    cool = m.material((0, 0, 0, 1), emissiveFactor=[0.6, 0.8, 1], extensions=strong(7))
    m.node(mesh=m.mesh(*square_parts, warm), scale=[1.6, 1, 1.6], rotation=[1, 0, 0, 0], translation=[-4, 7, 2])
    m.node(mesh=m.mesh(*square_parts, cool), scale=[1.2, 1, 1.2], rotation=[1, 0, 0, 0], translation=[4.5, 6, 3])

    stripes = m.texture(32, 32, 4, lambda x, y: (230, 120, 40, 255 if (x + y) // 4 % 2 else 0))
    fade = m.texture(1, 32, 4, lambda x, y: (40, 140, 220, min(255, 8 * y)))

    def dome(x, y):
        u, v = (x % 16 - 7.5) / 7, (y % 16 - 7.5) / 7
        n = (u, -v, math.sqrt(1 - u * u - v * v)) if u * u + v * v < 0.8 else (0, 0, 1)
        return [round(127.5 * (c + 1)) for c in n]

    bumps = m.texture(64, 64, 3, dome)
    gloss = m.texture(16, 16, 3, lambda x, y: (255, 40 if (x // 4 + y // 4) % 2 else 150, 255 if (x // 4 + y // 4) % 2 else 0))
    repeat = lambda texture, u, v: {"index": texture, **transform(scale=[u, v])}
    colors = [tuple(round(127.5 * (1 + math.sin(0.26 * i + 2 * c))) for c in range(3)) + (255,) for i in range(49)]
    painted = dict(ball_parts[0], COLOR_0=m.accessor(colors * 25, "B", True))
    glass = {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.5}}
    volume = {"KHR_materials_volume": {"thicknessFactor": 1.4, "attenuationDistance": 2, "attenuationColor": [0.5, 0.9, 0.6]}}
    coat = {"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.05}}
    rows = [
        [m.material((0.95, 0.75, 0.35, 1), 1, r) for r in (0.05, 0.2, 0.4, 0.7, 1)],
        [
            m.material((1, 1, 1, 1), roughness=0, extensions={**glass, **volume}),
            m.material(roughness=0.5, base=repeat(stripes, 4, 2), alphaMode="MASK"),
            m.material((0.8, 0.8, 0.8, 1), 1, 1, gloss=repeat(gloss, 4, 2), doubleSided=True),
            m.material((0.6, 0.1, 0.15, 1), roughness=0.35, normalTexture=repeat(bumps, 3, 1.5), extensions=coat),
            m.material(roughness=0.4, base={"index": fade}, alphaMode="BLEND"),
        ],
        [m.material((0.15, 0.35, 0.75, 1), 0, r) for r in (0.05, 0.2, 0.4, 0.7, 1)],
    ]
    for j, row in enumerate(rows):
        for i, index in enumerate(row):
            m.node(mesh=m.mesh(*ball_parts, index), scale=[0.75] * 3, translation=[1.8 * (i - 2), 0.75, 1.9 * (j - 1.3)])
    rough = m.material(roughness=0.6)
    m.node(mesh=m.mesh(painted, ball_parts[1], rough), scale=[0.45] * 3, translation=[-1.8, 0.45, 3.1])
    m.node(mesh=m.mesh(painted, ball_parts[1], rough), scale=[-0.45, 0.45, 0.45], translation=[1.8, 0.45, 3.1])
    camera = {"type": "perspective", "perspective": {"yfov": 0.5, "aspectRatio": 1.6, "znear": 0.1}}
    m.look([0, 4.6, 11.5], [0, 0.7, 0], camera=m.add("cameras", camera))
    m.save("materials.gltf")


def lights():
    m = Model()
    parts, square_parts = ball(m, 24, 12), square(m)
    m.node(mesh=m.mesh(*square_parts, m.material((0.6, 0.6, 0.6, 1), roughness=0.9)), scale=[10, 1, 10])
    shown = m.mesh(*parts, m.material((0.8, 0.75, 0.7, 1), roughness=0.6))
    for i in range(48):
        angle, radius = 2.4 * i, 0.55 * math.sqrt(i + 1)
        size = 0.16 + 0.12 * (i % 5) / 4
        turn = [0, math.sin(angle / 2), 0, math.cos(angle / 2)]
        m.node(mesh=shown, scale=[size * (-1 if i % 2 else 1), size * (1 + i % 3), size], rotation=turn,
               translation=[radius * math.cos(angle), size * (1 + i % 3), radius * math.sin(angle)])
    m.light([0, 2.2, 0], type="point", intensity=12, color=[1, 0.8, 0.5])
    m.light([-6, 6, 4], [-1.5, 0, 0.5], type="spot", intensity=160, color=[0.4, 0.6, 1], spot={"innerConeAngle": 0.15, "outerConeAngle": 0.25})
    m.light([4, 5, 3], [0, 0, 0], type="directional", intensity=0.6, color=[1, 0.9, 0.9])
    camera = {"type": "perspective", "perspective": {"yfov": 0.5, "aspectRatio": 1.6, "znear": 0.1}}
    m.look([0, 6, 10], [0, 0.3, 0], camera=m.add("cameras", camera))
    m.save("lights.gltf")


if __name__ == "__main__":
    os.chdir(os.path.dirname(os.path.abspath(__file__)))
    materials()
    lights()
