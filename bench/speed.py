#!/usr/bin/env python3
"""The speed bars: clrender's paths a second against others on the same work, in one run.

  spheres   scenes/spheres.xml, 512x512, 64 samples, depth 10, no roulette, against the prototype
            whose folder --prototype names (lanes_spheres.cpp, .cl), both at the same width
  mesh      the benchmark's scene of that name, a mesh of 70 thousand triangles in a box, against
            Mitsuba 3 (llvm_ad_rgb); needs a Python with mitsuba and numpy, see scripts/bench
  materials the benchmark's glass scene against itself with one of its materials on everything: what
            lanes of different materials cost each other; the bar is 1.5 times the dearest one

The programs or scenes take turns; the medians count. Only rendering is timed: no reading, building
or compiling. What is not there is left out, and said. scripts/bench measures more: error against
time.
"""

import argparse
import json
import os
import pathlib
import shutil
import statistics
import sys
import tempfile
import xml.etree.ElementTree as xml

from programs import (BENCH, BUILD, ROOT, SHARED, available_cores, clrender_rate, peer_python, run,
                      use_cores)
from renderers import find_llvm

WORK = BUILD / "speed"
# Connections over mirrors and through glass are work that the others do not do.
SAME_WORK = ("--specular-connections", "off")


def native_lanes():
    """The width of this processor's vectors in floats, as clrender would choose it."""
    flags = pathlib.Path("/proc/cpuinfo").read_text()
    return 16 if "avx512f" in flags else 8 if "avx2" in flags else 4


def take_turns(title, rounds, columns):
    """Lets the columns (name -> function) take turns, prints every figure and the medians, which
    it returns by name."""
    print(title)
    widths = [max(12, len(name) + 3) for name in columns]

    def line(label, figures):
        cells = "".join(f"{figure:{width}.4g}" for figure, width in zip(figures, widths))
        print(f"  {label:8}{cells}", flush=True)

    print(f"  {'round':8}" + "".join(f"{name:>{width}}" for name, width in zip(columns, widths)))
    for measure in columns.values():
        measure()  # fills the kernel caches
    figures = []
    for number in range(1, rounds + 1):
        figures.append([measure() for measure in columns.values()])
        line(str(number), figures[-1])
    medians = [statistics.median(column) for column in zip(*figures)]
    line("median", medians)
    return dict(zip(columns, medians))


def compare(title, rounds, bar, ours, peer_name, peer):
    """Lets both take turns, prints every figure, the medians and their ratio."""
    medians = take_turns(f"{title}: million paths a second", rounds,
                         {"clrender": ours, peer_name: peer})
    print(f"  clrender / {peer_name}: {medians['clrender'] / medians[peer_name]:.2f} "
          f"(the bar is {bar})\n", flush=True)


def spheres(arguments):
    source = arguments.prototype / "lanes_spheres.cpp"
    if not source.is_file():
        print(f"spheres: left out, there is no {source}\n")
        return
    lanes = arguments.lanes or native_lanes()
    size, spp, depth = 512, 64, 10
    with tempfile.TemporaryDirectory() as name:
        # The prototype measures three widths; of its copy here only the one that is wanted.
        folder = pathlib.Path(name)
        shutil.copy(arguments.prototype / "lanes_spheres.cl", folder)
        text = source.read_text().replace("{1,8,16}", f"{{{lanes}}}")
        (folder / "lanes_spheres.cpp").write_text(text)
        run(["g++", "-O2", "-std=c++17", "lanes_spheres.cpp", "-o", "lanes_spheres", "-lOpenCL"],
            cwd=folder)

        def prototype():
            for line in run(["./lanes_spheres", size, spp, depth], cwd=folder).splitlines():
                words = line.split()
                if words[:2] == ["lanes", str(lanes)]:
                    return float(words[words.index("Mpaths/s") - 1])
            raise RuntimeError(f"the prototype printed no line for {lanes} lanes")

        def clrender():
            return clrender_rate(ROOT / "scenes" / "spheres.xml", WORK, "-r", f"{size}x{size}",
                                 "-s", spp, *SAME_WORK, "--max-depth", depth, "--rr-depth", 1000000,
                                 "--lanes", lanes)

        compare(f"spheres.xml, {lanes} lanes", arguments.rounds, 1.3, clrender, "prototype",
                prototype)


def mesh(arguments):
    python, llvm = peer_python(), find_llvm()
    for needed, there in (("Python with mitsuba (scripts/bench --install-peers)", python),
                          ("LLVM 16 or newer (apt: libllvm19)", llvm)):
        if not there:
            print(f"mesh: left out, there is no {needed}\n")
            return
    os.environ["DRJIT_LIBLLVM_PATH"] = llvm
    run([python, BENCH / "make_scenes.py", WORK, "mesh"])
    scene, pixels, spp = WORK / "mesh.xml", 320 * 240, 64

    def mitsuba():
        lines = run([python, "-m", "peers.mitsuba_peer", "llvm_ad_rgb", "independent", scene,
                     WORK / "mitsuba", spp, "--threads", available_cores()], cwd=BENCH).splitlines()
        return pixels * spp / json.loads(lines[-1])["seconds"] * 1e-6

    def clrender():
        return clrender_rate(scene, WORK, "-s", spp)

    compare("A mesh in a box", arguments.rounds, 1, clrender, "Mitsuba llvm_ad_rgb", mitsuba)


def of_one_material(scene, kind, written):
    """The scene with its first material of this type on all of its shapes."""
    tree = xml.parse(scene)
    root = tree.getroot()
    materials = root.findall("bsdf")
    parts = list(next(material for material in materials if material.get("type") == kind))
    for material in materials:
        material[:] = parts
        material.set("type", kind)
    tree.write(written)


def materials(arguments):
    python = peer_python()
    if not python:
        print("materials: left out, there is no Python with numpy "
              "(scripts/bench --install-peers)\n")
        return
    run([python, BENCH / "make_scenes.py", WORK, "glass"])
    mixed, spp = WORK / "glass.xml", 64
    kinds = ["diffuse", "conductor", "dielectric"]
    scenes = {kind: WORK / f"glass_{kind}.xml" for kind in kinds}
    for kind, scene in scenes.items():
        of_one_material(mixed, kind, scene)
    scenes["mixed"] = mixed
    title = "The glass scene with one material on everything, and as it is: seconds a million paths"
    medians = take_turns(title, arguments.rounds,
                         {name: lambda scene=scene: 1 / clrender_rate(scene, WORK, "-s", spp,
                                                                      *SAME_WORK)
                          for name, scene in scenes.items()})
    dearest = max(medians[kind] for kind in kinds)
    print(f"  mixed / dearest: {medians['mixed'] / dearest:.2f} (the bar is 1.5)\n", flush=True)


BARS = {"spheres": spheres, "mesh": mesh, "materials": materials}


def bar(name):
    if name not in BARS:
        raise argparse.ArgumentTypeError(f"there is no {name!r}, expected {', '.join(BARS)}")
    return name


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bars", nargs="*", type=bar, help="default: all")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--lanes", type=int, choices=[1, 8, 16], help="default: this processor's")
    parser.add_argument("--prototype", type=pathlib.Path, default=SHARED / "prototypes")
    arguments = parser.parse_args()

    use_cores(available_cores())
    WORK.mkdir(parents=True, exist_ok=True)
    for name in arguments.bars or BARS:
        BARS[name](arguments)


if __name__ == "__main__":
    sys.exit(main())
