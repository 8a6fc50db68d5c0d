#!/usr/bin/env python3
"""What specialising the kernel brings: the kernel made for each scene, the one that can do
everything, and between them the one that can also do what one group of features is for.

Scenes are the benchmark's seven and scenes/spheres.xml; all kernels of a scene take turns. Writes
build/bench/results/ablation.md: seconds to compile without any cache, nanoseconds a path, and how
both grow group by group. Wants an idle machine, and about half an hour.
"""

import argparse
import json
import pathlib
import statistics
import sys
import tempfile

from benchmark import add_run_arguments, check_words, need_numpy, prepare_scenes, words
from catalogue import TITLES
from programs import ROOT, Failed, clrender_command, launch, use_cores
from tables import markdown, publish

# Names of kernels/shared/kernel_config.def by what they are about.
GROUPS = {
    "spheres": "SPHERE_COUNT,OPAQUE_COUNT,LARGE_COUNT,SHADOW_FREE_COUNT",
    "flat shapes": "PLANAR_COUNT,HAS_DISKS,SHADOWLESS_PLANAR_COUNT,PLANAR_AXES",
    "hierarchy": "HAS_TRIANGLES,HAS_BVH_SPHERES,HAS_VERTEX_NORMALS",
    "quadrics": "HAS_QUADRICS,HAS_QUADRIC_LIGHTS",
    "instances": "HAS_INSTANCES",
    "record layout": "RECORD_TABLE,MATERIALS_IN_RECORDS",
    "materials": "HAS_DIFFUSE,HAS_MIRROR,HAS_CONDUCTOR,HAS_DIELECTRIC,HAS_THINDIELECTRIC,HAS_NULL,"
                 "MATERIAL_SHADES",
    "rough materials": "HAS_ROUGHCONDUCTOR,HAS_ROUGHDIELECTRIC,HAS_PLASTIC,HAS_ROUGHPLASTIC,"
                       "HAS_PRINCIPLED,HAS_PRINCIPLEDTHIN,HAS_GGX,HAS_BECKMANN,HAS_TANGENTS,"
                       "HAS_SMOOTH_TRANSMISSION,BSDF_PARAMETERS,BSDF_TEXTURED",
    "trees of materials": "HAS_BLEND,HAS_NORMALMAP,HAS_BUMPMAP",
    "textures": "HAS_UVS,HAS_BITMAPS_U8,HAS_BITMAPS_F32,HAS_CHECKERBOARDS",
    "attributes of meshes": "HAS_ATTRIBUTES",
    "kinds of light": "HAS_AREA_EMITTERS,HAS_POINT_LIGHTS,HAS_SPHERE_LIGHTS,HAS_PLANAR_LIGHTS,"
                      "HAS_TRIANGLE_LIGHTS",
    "lights without a surface": "HAS_SPOT_LIGHTS,HAS_PROJECTORS,HAS_DIRECTIONAL_LIGHTS",
    "number of lights": "LIGHT_COUNT,HAS_ORIENTED_LIGHTS,SOLE_EMITTER,SOLE_LIGHT_SPHERE",
    "environment map": "ENVIRONMENT",
    "lens and clipping": "HAS_LENS,HAS_CLIP",
    "roulette": "ROULETTE",
    "alpha": "HAS_ALPHA",
}
# What a kernel cannot be forced to: the sky's model takes the place of the map.
NOT_FORCED = "HAS_SKY,HAS_SUN"
SPECIALISED, EVERYTHING = "specialised", "everything"
SPHERES = ROOT / "scenes" / "spheres.xml"


class Variant:
    """One kernel of a scene. features: what it was compiled for; compiling: seconds without any
    cache; path: nanoseconds; rays: of a path."""

    def __init__(self, name, scene, options, timeout):
        self.name, self.scene, self.timeout = name, scene, timeout
        generic = {SPECIALISED: "", EVERYTHING: "all"}.get(name, GROUPS.get(name))
        self.options = [*options, *(["--generic", generic] if generic else [])]
        self.cache = tempfile.TemporaryDirectory()
        self.times = []
        cold = self.run("-s", 1)["kernel"]
        self.features, self.compiling = cold["features"], cold["seconds"]

    def run(self, *options):
        """The figures of one render. The first one finds an empty cache."""
        folder = pathlib.Path(self.cache.name)
        environment = {"XDG_CACHE_HOME": str(folder), "POCL_CACHE_DIR": str(folder / "pocl")}
        stats = folder / "stats.json"
        launch(clrender_command(self.scene, folder / "picture.pfm", stats, *self.options, *options),
               self.timeout, environment)
        return json.loads(stats.read_text())

    def measure(self, spp):
        figures = self.run("-s", spp)
        self.times.append(figures["seconds"]["render"] / figures["paths"] * 1e9)
        self.rays = figures["rays"] / figures["paths"]

    @property
    def path(self):
        return statistics.median(self.times)


def measure(scene, groups, arguments):
    """The variants of a scene by name; a group that changes no feature has none."""
    width, height = arguments.resolution
    options = ["-r", f"{width}x{height}", "--max-depth", 10, "--rr-depth", 1000000]
    variants = {}
    for name in [SPECIALISED, EVERYTHING, *groups]:
        variant = Variant(name, scene, options, arguments.timeout)
        if name in GROUPS and variant.features == variants[SPECIALISED].features:
            continue
        variants[name] = variant
        print(f"{title(scene)}: {name}: {variant.compiling:.2f} s to compile", flush=True)
    for number in range(arguments.rounds):
        for variant in variants.values():
            variant.measure(arguments.spp)
        times = ", ".join(f"{v.name} {v.times[-1]:.0f}" for v in variants.values())
        print(f"{title(scene)}: round {number + 1}/{arguments.rounds}: ns a path: {times}",
              flush=True)
    return variants


def title(scene):
    return f"`{scene.name if scene == SPHERES else scene.stem}`"


def report(measured, groups):
    """The tables; measured: scene -> its variants."""
    rows = []
    for scene, variants in measured.items():
        own, full = variants[SPECIALISED], variants[EVERYTHING]
        skipped = 1 - own.rays / full.rays
        rows.append([title(scene), f"{own.compiling:.2f}", f"{full.compiling:.2f}",
                     f"{own.path:.0f}", f"{full.path:.0f}", f"**{full.path / own.path:.2f}**",
                     f"{own.rays:.2f}", f"{100 * skipped:.1f}%"])
    text = ("The kernel that can do everything against the one made for the scene:\n\n" +
            markdown(["scene", "compile, s", "everything", "a path, ns", "everything",
                      "times faster", "rays a path", "rays skipped"], rows))
    rows = []
    for name in groups:
        cells = [name]
        for variants in measured.values():
            own, more = variants[SPECIALISED], variants.get(name)
            cells.append(f"{more.path / own.path:.2f}, {more.compiling - own.compiling:+.1f} s"
                         if more else "-")
        rows.append(cells)
    if rows:
        text += ("\nA group of features compiled in beside what the scene needs: time a path over "
                 "that of the\nkernel made for the scene, and seconds more to compile; -: the scene "
                 "needs all of it.\n\n" +
                 markdown(["group", *map(title, measured)], rows))
    return text


def parse():
    known = [*TITLES, SPHERES.name]
    parser = argparse.ArgumentParser(prog="scripts/bench --ablation", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", type=words, default=known, metavar="SCENE,...",
                        help="these scenes: " + " ".join(known))
    parser.add_argument("--groups", type=words, default=list(GROUPS), metavar="NAME,...",
                        help="these groups of features (all; '' for none): " + ", ".join(GROUPS))
    parser.add_argument("--rounds", type=int, default=3, help="of which the medians count (3)")
    parser.add_argument("--spp", type=int, default=64, help="samples a pixel (64)")
    add_run_arguments(parser, resolution=(320, 240), timeout=600)
    arguments = parser.parse_args()
    check_words(parser, arguments, {"only": known, "groups": GROUPS})
    return arguments


def main():
    arguments = parse()
    use_cores(arguments.cores)
    generated = [name for name in arguments.only if name in TITLES]
    scenes = []
    if generated:
        need_numpy()
        scenes = prepare_scenes(generated)
    if SPHERES.name in arguments.only:
        scenes.append(SPHERES)
    try:
        measured = {scene: measure(scene, arguments.groups, arguments) for scene in scenes}
    except Failed as failure:
        sys.exit(f"error: {failure}")
    publish(report(measured, arguments.groups), "ablation.md")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit("\nStopped.")
