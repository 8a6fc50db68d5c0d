#!/usr/bin/env python3
"""The speed bars: clrender's paths a second against others on the same work, in one run.

  spheres   scenes/spheres.xml, 512x512, 64 samples, depth 10, no roulette, against the prototype
            whose folder --prototype names (lanes_spheres.cpp, .cl), both at the same width
  mesh      bench/scenes/mesh_box.xml, a mesh of 70 thousand triangles in a box, against Mitsuba 3
            (llvm_ad_rgb); CLRENDER_PEER_PYTHON names a Python that has mitsuba and numpy

Both programs take turns; the medians count. Only rendering is timed: no reading, building or
compiling. What is not there is left out, and said.
"""

import argparse
import json
import os
import pathlib
import shutil
import statistics
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SHARED = ROOT.parent / "shared"
CLRENDER = ROOT / "build" / "clrender"
WORK = ROOT / "build" / "speed"


def run(command, **options):
    """The standard output of a command that has to succeed."""
    return subprocess.run([str(word) for word in command], check=True, text=True,
                          stdout=subprocess.PIPE, **options).stdout


def native_lanes():
    """The width of this processor's vectors in floats, as clrender would choose it."""
    flags = pathlib.Path("/proc/cpuinfo").read_text()
    return 16 if "avx512f" in flags else 8 if "avx2" in flags else 4


def clrender_rate(scene, *options):
    """Million paths a second of one render."""
    stats = WORK / "stats.json"
    run([CLRENDER, "-q", "-o", WORK / "picture.pfm", "--stats", stats, *options, scene])
    figures = json.loads(stats.read_text())
    return figures["paths"] / figures["seconds"]["render"] * 1e-6


def compare(title, rounds, ours, peer_name, peer):
    """Lets both take turns, prints every figure, the medians and their ratio."""
    print(f"{title}: million paths a second")
    print(f"  {'round':8}{'clrender':>12}{peer_name:>24}")
    ours()  # fills the kernel cache
    figures = []
    for number in range(1, rounds + 1):
        figures.append((ours(), peer()))
        print(f"  {number:<8}{figures[-1][0]:12.3f}{figures[-1][1]:24.3f}", flush=True)
    mine, theirs = (statistics.median(column) for column in zip(*figures))
    print(f"  {'median':8}{mine:12.3f}{theirs:24.3f}")
    print(f"  clrender / {peer_name}: {mine / theirs:.2f} (the bar is 1)\n", flush=True)


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
            return clrender_rate(ROOT / "scenes" / "spheres.xml", "-r", f"{size}x{size}", "-s", spp,
                                 "--max-depth", depth, "--rr-depth", 1000000, "--lanes", lanes)

        compare(f"spheres.xml, {lanes} lanes", arguments.rounds, clrender, "prototype", prototype)


def write_ply(obj, ply):
    """The triangles of an OBJ file as binary PLY, 1 high, standing on y = 0 around the axis."""
    points, triangles = [], []
    for line in obj.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            triangles.append([int(word.split("/")[0]) - 1 for word in words[1:]])
    low, high = ([pick(axis) for axis in zip(*points)] for pick in (min, max))
    origin = [(low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2]
    scale = 1 / (high[1] - low[1])
    with open(ply, "wb") as file:
        file.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
                    "property float x\nproperty float y\nproperty float z\n"
                    f"element face {len(triangles)}\n"
                    "property list uchar int vertex_indices\nend_header\n").encode())
        for point in points:
            file.write(struct.pack("<3f", *((p - o) * scale for p, o in zip(point, origin))))
        for triangle in triangles:
            file.write(struct.pack("<B3i", 3, *triangle))


def mesh(arguments):
    python = os.environ.get("CLRENDER_PEER_PYTHON")
    script = arguments.peers / "render_mitsuba.py"
    for needed, there in ((arguments.mesh, arguments.mesh.is_file()), (script, script.is_file()),
                          ("CLRENDER_PEER_PYTHON", bool(python))):
        if not there:
            print(f"mesh: left out, there is no {needed}\n")
            return
    scene = WORK / "mesh_box.xml"
    shutil.copy(ROOT / "bench" / "scenes" / "mesh_box.xml", scene)
    write_ply(arguments.mesh, WORK / "bunny.ply")
    pixels, spp, depth = 320 * 240, 64, 10

    def mitsuba():
        lines = run([python, script, "llvm_ad_rgb", scene, WORK / "mitsuba", spp]).splitlines()
        return pixels * spp / json.loads(lines[-1])["seconds"] * 1e-6

    def clrender():
        return clrender_rate(scene, "-s", spp, "--max-depth", depth, "--rr-depth", 1000000)

    compare("mesh_box.xml", arguments.rounds, clrender, "Mitsuba llvm_ad_rgb", mitsuba)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bars", nargs="*", choices=["spheres", "mesh", []], help="default: both")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--lanes", type=int, choices=[1, 8, 16], help="default: this processor's")
    parser.add_argument("--prototype", type=pathlib.Path, default=SHARED / "prototypes")
    parser.add_argument("--peers", type=pathlib.Path, default=SHARED / "peers")
    parser.add_argument("--mesh", type=pathlib.Path, default=SHARED / "meshes" / "bunny.obj")
    arguments = parser.parse_args()

    # Everyone gets the same cores: PoCL and Dr.Jit would count those of the machine.
    cores = str(len(os.sched_getaffinity(0)))
    os.environ.setdefault("POCL_MAX_PTHREAD_COUNT", cores)
    WORK.mkdir(parents=True, exist_ok=True)
    for name, measure in (("spheres", spheres), ("mesh", mesh)):
        if not arguments.bars or name in arguments.bars:
            measure(arguments)


if __name__ == "__main__":
    sys.exit(main())
