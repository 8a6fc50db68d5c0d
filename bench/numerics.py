#!/usr/bin/env python3
"""bench/numerics.py: the pictures of docs/numerics.md, by clrender (left) and Mitsuba 3 (right).

Writes docs/images/numerics_NAME.png for each scene below: objects from .02 units on, on a sphere of
radius 10^8; the same objects seen from 10^6 units away by a narrow angle; and the inside
of a closed box under a bright sky, which has to be black. Wants what `scripts/bench --install-peers`
makes, or CLRENDER_PEER_PYTHON.
"""

import math
import pathlib
import subprocess
import sys
import tempfile

from programs import CLRENDER, ROOT, peer_python, run

SIZE = (360, 270)
BOX = "1241 -456 777"  # the middle of the closed box
IMAGES = ROOT / "docs" / "images"

# Renders a scene with Mitsuba and joins both pictures. Arguments: scene, clrender's EXR, result.
JOIN = """
import sys
import numpy as np
import mitsuba as mi
mi.set_variant("scalar_rgb")
scene, ours, result = sys.argv[1:]
theirs = mi.Bitmap(np.array(mi.render(mi.load_file(scene))))
def displayed(bitmap):
    return np.array(bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.UInt8, True))
left, right = displayed(mi.Bitmap(ours)), displayed(theirs)
gap = np.full((left.shape[0], 6, 3), 255, np.uint8)
mi.Bitmap(np.concatenate([left, gap, right], 1)).write(result)
"""


def transform(*steps):
    return f'<transform name="to_world">{"".join(steps)}</transform>'


def sensor(origin, target, fov):
    return f"""<sensor type="perspective"><float name="fov" value="{fov!r}"/>
        <float name="near_clip" value="1e-3"/><float name="far_clip" value="1e10"/>
        {transform(f'<lookat origin="{origin}" target="{target}" up="0 1 0"/>')}
        <film type="hdrfilm"><integer name="width" value="{SIZE[0]}"/>
        <integer name="height" value="{SIZE[1]}"/></film>
        <sampler type="independent"><integer name="sample_count" value="256"/></sampler></sensor>"""


def diffuse(colour):
    return f'<bsdf type="diffuse"><rgb name="reflectance" value="{colour}"/></bsdf>'


def sphere(center, radius, inside):
    x, y, z = center
    return f"""<shape type="sphere"><point name="center" x="{x!r}" y="{y!r}" z="{z!r}"/>
        <float name="radius" value="{radius!r}"/>{inside}</shape>"""


def objects():
    colours = (".8 .3 .2", ".2 .4 .8", ".8 .7 .3", ".3 .7 .4")
    parts = []
    for i in range(12):
        radius = (0.25, 0.12, 0.05, 0.02)[i % 4]
        place = (-1.1 + 0.2 * i, radius, 0.9 * math.sin(2.1 * i))
        parts.append(sphere(place, radius, diffuse(colours[i % 4])))
    for i in range(8):
        half = (0.15, 0.06, 0.03, 0.01)[i % 4]
        parts.append(f"""<shape type="cube">{transform(
            f'<scale value="{half}"/>', f'<rotate y="1" angle="{17 * i}"/>',
            f'<translate x="{1.1 - 0.29 * i}" y="{half}" z="{0.9 * math.sin(1.3 * i + 2)}"/>')}
            {diffuse(colours[(i + 1) % 4])}</shape>""")
    sun = '<emitter type="area"><rgb name="radiance" value="3000"/></emitter>'
    parts.append(sphere((503, 704, 503), 10.0, sun))
    parts.append('<emitter type="constant"><rgb name="radiance" value=".4 .5 .7"/></emitter>')
    return "".join(parts)


def far_camera(distance):
    half_width = 1.4
    way = distance * math.hypot(1, 0.25)
    return sensor(f"0 {0.15 + 0.25 * distance!r} {distance!r}", "0 .15 0",
                  2 * math.degrees(math.atan(half_width / way)))


def sealed_box():
    surface = f'<bsdf type="twosided">{diffuse(".95")}</bsdf>'
    turns = [("y", 0), ("y", 90), ("y", 180), ("y", 270), ("x", 90), ("x", -90)]
    walls = [f"""<shape type="rectangle">{transform(
        '<translate z="-1"/>', f'<rotate {axis}="1" angle="{angle}"/>',
        '<rotate x=".8" y=".6" angle="31"/>', f'<translate value="{BOX}"/>')}{surface}</shape>"""
             for axis, angle in turns]
    return "".join(walls) + '<emitter type="constant"><rgb name="radiance" value="1e5"/></emitter>'


def scenes():
    radius = 1e8
    planet = sphere((0, -radius, 0), radius, diffuse(".35 .4 .3"))
    floor = f"""<shape type="rectangle">{transform('<scale value="20"/>',
        '<rotate x="1" angle="-90"/>')}{diffuse(".35 .4 .3")}</shape>"""
    return {
        "planet": sensor("0 1.2 4", "0 .15 0", 38.0) + planet + objects(),
        "far_camera": far_camera(1e6) + floor + objects(),
        "sealed_box": sensor(BOX, "1240 -457 776", 100.0) + sealed_box(),
    }


def main():
    python = peer_python()
    if python is None:
        sys.exit("numerics.py: Mitsuba is missing: scripts/bench --install-peers")
    with tempfile.TemporaryDirectory() as folder:
        for name, body in scenes().items():
            scene, ours = (pathlib.Path(folder) / f"{name}.{kind}" for kind in ("xml", "exr"))
            depth = 100 if name == "sealed_box" else 5
            scene.write_text(f'<scene version="3.0.0"><integrator type="path">'
                             f'<integer name="max_depth" value="{depth}"/></integrator>'
                             f"{body}</scene>")
            run([CLRENDER, "-q", scene, "-o", ours])
            result = IMAGES / f"numerics_{name}.png"
            subprocess.run([python, "-c", JOIN, scene, ours, result], check=True)
            print(result.relative_to(ROOT))


if __name__ == "__main__":
    main()
