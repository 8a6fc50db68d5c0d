#!/usr/bin/env python3
"""Writes the benchmark's eight scenes: Mitsuba 3 XML, binary PLY meshes, textures and a sky.

usage: make_scenes.py FOLDER [SCENE...]      all scenes, or those named; needs numpy

Every scene has the defaults width, height, max_depth and rr_depth (10 segments and no roulette
where nobody says otherwise) and sampler (for Mitsuba), a box filter, and nothing that one of the
renderers cannot do. The same files come out of every run.
"""

import math
import pathlib
import random
import shutil
import sys
import xml.etree.ElementTree as ET

import numpy as np

import meshes
from programs import BENCH, BUILD, BUNNY, ROOT, run

DEFAULTS = {"width": "320", "height": "240", "max_depth": "10", "rr_depth": "1000000",
            "sampler": "independent"}


# --- pieces of XML ----------------------------------------------

def numbers(values):
    return ", ".join(f"{value:.6g}" for value in values)


def diffuse(name, colour):
    return (f'<bsdf type="diffuse" id="{name}">'
            f'<rgb name="reflectance" value="{numbers(colour)}"/></bsdf>')


def textured(name, file):
    return (f'<bsdf type="diffuse" id="{name}"><texture type="bitmap" name="reflectance">'
            f'<string name="filename" value="{file}"/></texture></bsdf>')


MIRROR = '<bsdf type="conductor" id="mirror"><string name="material" value="none"/></bsdf>'
GLASS = ('<bsdf type="dielectric" id="glass"><float name="int_ior" value="1.5"/>'
         '<float name="ext_ior" value="1"/></bsdf>')


def look(surface):
    """What a shape is made of: the id of a BSDF, or the radiance (r, g, b) of a light."""
    if isinstance(surface, str):
        return f'<ref id="{surface}"/>'
    return f'<emitter type="area"><rgb name="radiance" value="{numbers(surface)}"/></emitter>'


def sphere(centre, radius, surface):
    x, y, z = (f"{value:.6g}" for value in centre)
    return (f'<shape type="sphere"><point name="center" x="{x}" y="{y}" z="{z}"/>'
            f'<float name="radius" value="{radius:.6g}"/>{look(surface)}</shape>')


def transform(scale=(1, 1, 1), rotate=None, translate=(0, 0, 0)):
    """scale, then rotate = (axis, degrees), then translate."""
    x, y, z = (f"{value:.6g}" for value in scale)
    text = f'<scale x="{x}" y="{y}" z="{z}"/>'
    if rotate:
        text += f'<rotate {rotate[0]}="1" angle="{rotate[1]:.6g}"/>'
    x, y, z = (f"{value:.6g}" for value in translate)
    return f'<transform name="to_world">{text}<translate x="{x}" y="{y}" z="{z}"/></transform>'


def rectangle(half_width, half_height, rotate, translate, surface):
    place = transform((half_width, half_height, 1), rotate, translate)
    return f'<shape type="rectangle">{place}{look(surface)}</shape>'


def ply(file, surface, place="", flat=False):
    faces = '<boolean name="face_normals" value="true"/>' if flat else ""
    return (f'<shape type="ply"><string name="filename" value="{file}"/>{faces}{place}'
            f'{look(surface)}</shape>')


def ground(half_size, surface):
    return rectangle(half_size, half_size, ("x", -90), (0, 0, 0), surface)


def box(half_width, height, near, far):
    """A closed room: floor at y = 0, z from far to near, one side red and one green."""
    depth, middle, up = (near - far) / 2, (near + far) / 2, height / 2
    return [
        diffuse("white", (.7, .7, .7)), diffuse("red", (.6, .1, .1)),
        diffuse("green", (.1, .5, .1)),
        rectangle(half_width, depth, ("x", -90), (0, 0, middle), "white"),
        rectangle(half_width, depth, ("x", 90), (0, height, middle), "white"),
        rectangle(half_width, up, None, (0, up, far), "white"),
        rectangle(half_width, up, ("y", 180), (0, up, near), "white"),
        rectangle(depth, up, ("y", 90), (-half_width, up, middle), "red"),
        rectangle(depth, up, ("y", -90), (half_width, up, middle), "green"),
    ]


def write_scene(folder, name, origin, target, fov, parts):
    """One scene file; fov is horizontal, in degrees."""
    defaults = "\n".join(f'    <default name="{key}" value="{value}"/>'
                         for key, value in DEFAULTS.items())
    body = "\n".join("    " + part for part in parts)
    (folder / f"{name}.xml").write_text(f"""<scene version="3.0.0">
{defaults}
    <integrator type="path">
        <integer name="max_depth" value="$max_depth"/>
        <integer name="rr_depth" value="$rr_depth"/>
    </integrator>
    <sensor type="perspective">
        <float name="fov" value="{fov}"/>
        <string name="fov_axis" value="x"/>
        <transform name="to_world">
            <lookat origin="{numbers(origin)}" target="{numbers(target)}" up="0, 1, 0"/>
        </transform>
        <film type="hdrfilm">
            <integer name="width" value="$width"/>
            <integer name="height" value="$height"/>
            <rfilter type="box"/>
        </film>
        <sampler type="$sampler"/>
    </sensor>
{body}
</scene>
""")


# --- the sky ----------------------------------------------------

def write_radiance(picture, path):
    """A Radiance .hdr file of a float array (height, width, 3), without compression."""
    height, width = picture.shape[:2]
    mantissa, exponent = np.frexp(np.maximum(picture.max(2), 1e-38))
    bytes_ = np.empty((height, width, 4), np.uint8)
    bytes_[..., :3] = np.minimum(picture * (mantissa * 256 / picture.max(2))[..., None], 255)
    bytes_[..., 3] = exponent + 128
    with open(path, "wb") as file:
        file.write(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode())
        for row in bytes_:
            file.write(bytes([2, 2, width >> 8, width & 255]))
            for channel in row.T:
                for start in range(0, width, 128):  # runs of up to 128 literal bytes
                    piece = channel[start:start + 128].tobytes()
                    file.write(bytes([len(piece)]) + piece)


def write_sky(path, elevation, azimuth, diameter=3.0, height=512):
    """A clear sky above grey ground with a sun of `diameter` degrees at an elevation and azimuth in
    degrees; about four fifths of the light on the ground come from the sun."""
    width = 2 * height
    theta = (np.arange(height) + .5) / height * math.pi
    phi = (np.arange(width) + .5) / width * 2 * math.pi  # Mitsuba: (sin phi, -, -cos phi)
    theta, phi = np.meshgrid(theta, phi, indexing="ij")
    up = np.cos(theta)
    picture = np.where(up[..., None] > 0,
                       np.array([.95, .9, .82]) + np.clip(up, 0, 1)[..., None] ** .5
                       * (np.array([.18, .34, .75]) - np.array([.95, .9, .82])),
                       np.array([.12, .11, .1]))
    high, around = math.radians(elevation), math.radians(azimuth)
    cosine = (up * math.sin(high) + np.sin(theta) * math.cos(high) * np.cos(phi - around))
    # The share of a texel that the sun covers, from its distance in texels to the edge.
    away = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    cover = np.clip((diameter / 2 - away) / (180 / height) + .5, 0, 1)[..., None]
    write_radiance(picture * (1 - cover) + cover * np.array([2600., 2300., 1900.]), path)


# --- the scenes -------------------------------------------------

def standing_creature(folder, triangles):
    """The project's own creature, made of about so many triangles."""
    source = folder / "creature.obj"
    run(["ninja", "-C", BUILD, "--quiet", "clrender-make-mesh"])
    run([BUILD / "scenes" / "generator" / "clrender-make-mesh", "creature", triangles, source])
    return meshes.standing(meshes.read_obj(source))


def make_room(folder):
    """The report's room: scenes/spheres.xml with its defaults, in this size. Its camera turns the
    picture left to right, which takes no time and which not every renderer can: left out."""
    root = ET.parse(ROOT / "scenes" / "spheres.xml").getroot()
    for default in root.findall("default"):
        default.set("value", DEFAULTS.get(default.get("name"), default.get("value")))
    sampler = root.find("sensor/sampler")
    root.insert(0, ET.Element("default", name="sampler", value=sampler.get("type")))
    sampler.set("type", "$sampler")
    camera = root.find("sensor/transform")
    camera.remove(camera.find("scale"))
    ET.ElementTree(root).write(folder / "room.xml")


def make_mesh(folder):
    """A mesh of 70 thousand triangles in a diffuse box under a small lamp
    (bench/scenes/mesh_box.xml): the Stanford bunny where it is present, else the project's own
    creature."""
    mesh = (meshes.standing(meshes.read_obj(BUNNY)) if BUNNY.is_file()
            else standing_creature(folder, 70000))
    meshes.write_ply(mesh, folder / "mesh.ply")
    shutil.copy(BENCH / "scenes" / "mesh_box.xml", folder / "mesh.xml")


def make_sky(folder):
    """Three painted meshes on a ground under a sky whose sun is 3 degrees across."""
    write_sky(folder / "sky.hdr", elevation=38, azimuth=120)
    parts = ['<emitter type="envmap"><string name="filename" value="sky.hdr"/></emitter>',
             diffuse("ground", (.5, .45, .4)), ground(30, "ground")]
    for name, height, x, z in (("vase", 1.7, -1.4, -.3), ("ammonite", 1.5, .1, .4),
                               ("creature", 1.6, 1.6, -.4)):
        mesh = meshes.standing(meshes.read_obj(ROOT / "scenes" / "meshes" / f"{name}.obj"), height)
        mesh.points += [x, 0, z]
        meshes.write_ply(mesh, folder / f"{name}.ply")
        shutil.copy(ROOT / "scenes" / "textures" / f"{name}.png", folder)
        parts += [textured(name, f"{name}.png"), ply(f"{name}.ply", name)]
    write_scene(folder, "sky", (0, 1.9, 6), (.1, .75, 0), 42, parts)


def make_glass(folder):
    """A mirror ball, a glass ball and a mirror on the wall in a box under a small lamp."""
    write_scene(folder, "glass", (0, .95, 3.3), (0, .8, 0), 42, [
        *box(1.2, 1.8, 3.6, -1.2), MIRROR, GLASS,
        sphere((-.5, .45, -.45), .45, "mirror"), sphere((.5, .4, .15), .4, "glass"),
        rectangle(.35, .45, ("y", -90), (1.19, .95, -.2), "mirror"),
        rectangle(.2, .2, ("x", 90), (0, 1.79, 0), (24, 21, 17))])


def make_lights(folder):
    """400 small spherical lights of powers over three decades above 50 meshes."""
    draw = random.Random(5)
    parts = [diffuse("ground", (.5, .5, .5)), ground(12, "ground"),
             rectangle(12, 4, None, (0, 4, -6), "ground")]
    for kind in range(5):
        meshes.write_ply(meshes.standing(meshes.blob(kind, 3)), folder / f"blob{kind}.ply")
        parts.append(diffuse(f"paint{kind}", [.25 + .55 * draw.random() for _ in range(3)]))
    for i in range(50):
        place = transform([.45 + .4 * draw.random()] * 3, ("y", draw.uniform(0, 360)),
                          (1.3 * (i % 10 - 4.5), 0, 1.3 * (i // 10 - 3)))
        parts.append(ply(f"blob{i % 5}.ply", f"paint{draw.randrange(5)}", place))
    for _ in range(400):
        radius = draw.uniform(.015, .04)
        power = 10 ** draw.uniform(-2, 1)  # of pi * area * radiance
        tint = [.4 + .6 * draw.random() for _ in range(3)]
        place = draw.uniform(-6.5, 6.5), draw.uniform(1, 3.2), draw.uniform(-5, 3)
        radiance = [power * c / (4 * math.pi ** 2 * radius ** 2) for c in tint]
        parts.append(sphere(place, radius, radiance))
    write_scene(folder, "lights", (0, 4, 8.5), (0, .7, -1), 50, parts)


def make_million(folder):
    """A landscape of a million triangles under an even sky and a lamp."""
    meshes.write_ply(meshes.terrain(seed=3, cells=708, side=16, height=1.1), folder / "terrain.ply")
    write_scene(folder, "million", (0, 4.6, 8.5), (0, -.4, 0), 48, [
        '<emitter type="constant"><rgb name="radiance" value="0.35, 0.42, 0.55"/></emitter>',
        diffuse("earth", (.55, .45, .33)), ply("terrain.ply", "earth", flat=True),
        sphere((-3, 4, -1.5), .4, (170, 140, 100))])


def make_spheres(folder):
    """Ten thousand diffuse spheres on a ground, under a lamp and a faint sky."""
    draw = random.Random(7)
    parts = ['<emitter type="constant"><rgb name="radiance" value="0.12, 0.14, 0.18"/></emitter>',
             diffuse("ground", (.4, .4, .4)), ground(40, "ground")]
    for kind in range(6):
        parts.append(diffuse(f"paint{kind}", [.2 + .6 * draw.random() for _ in range(3)]))
    for i in range(10000):
        radius = draw.uniform(.03, .075)
        x, z = (.12 * (cell - 49.5) + draw.uniform(-.02, .02) for cell in (i % 100, i // 100))
        y = radius + .4 * draw.random() ** 4
        parts.append(sphere((x, y, z), radius, f"paint{draw.randrange(6)}"))
    parts.append(rectangle(.8, .8, ("x", 90), (1, 3.5, 0), (22, 20, 17)))
    write_scene(folder, "spheres", (0, 2.2, 5.2), (0, 0, .9), 42, parts)


def make_herd(folder, side=64):
    """side^2 instances of a creature of six thousand triangles on a ground under a sky."""
    write_sky(folder / "sky.hdr", elevation=38, azimuth=120)
    meshes.write_ply(standing_creature(folder, 6000), folder / "herd.ply")
    draw = random.Random(11)
    parts = ['<emitter type="envmap"><string name="filename" value="sky.hdr"/></emitter>',
             diffuse("ground", (.5, .45, .4)), ground(2 * side, "ground"),
             diffuse("skin", (.62, .4, .27)),
             f'<shape type="shapegroup" id="animal">{ply("herd.ply", "skin")}</shape>']
    for i in range(side * side):
        place = transform([draw.uniform(.7, 1.1)] * 3, ("y", draw.uniform(0, 360)),
                          (1.3 * (i % side - (side - 1) / 2) + draw.uniform(-.2, .2), 0,
                           1.3 * (i // side - (side - 1) / 2) + draw.uniform(-.2, .2)))
        parts.append(f'<shape type="instance"><ref id="animal"/>{place}</shape>')
    write_scene(folder, "herd", (0, side * .2, side * .75), (0, 0, side * .1), 42, parts)


SCENES = {"room": make_room, "mesh": make_mesh, "sky": make_sky, "glass": make_glass,
          "lights": make_lights, "million": make_million, "spheres": make_spheres,
          "herd": make_herd}


def main():
    if len(sys.argv) < 2 or sys.argv[1] in ("-h", "--help"):
        print(__doc__.strip())
        return 2
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[2:] or SCENES:
        SCENES[name](folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
