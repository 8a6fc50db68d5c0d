"""How the benchmark talks to a peer: the command line, and one JSON line for each render.

A line has `spp` (asked for) and `real_spp` (in the picture), `seconds` (wall time of rendering,
without reading the scene and building its trees), `load` (seconds until rendering could begin),
`peak_mib` (the peak of the process's resident memory so far) and `picture`: an .npy file, float32
(height, width, 3), linear, first row on top.
"""

import argparse
import json
import pathlib

import numpy as np


def arguments(description):
    """What to render: .scene, .prefix of the pictures, .spp (a list), .seed, .threads, and
    .overrides for the scene's defaults (width, height, max_depth, rr_depth)."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("prefix")
    parser.add_argument("spp", type=int, nargs="+")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, required=True)
    for name in ("width", "height", "max_depth", "rr_depth"):
        parser.add_argument("--" + name.replace("_", "-"), type=int)
    found = parser.parse_args()
    names = ("width", "height", "max_depth", "rr_depth")
    found.overrides = {name: getattr(found, name) for name in names if getattr(found, name)}
    return found


def peak_memory():
    """The peak of this process's resident memory in MiB. Not getrusage, whose peak begins with that
    of the process that started this one."""
    for line in pathlib.Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmHWM:"):
            return int(line.split()[1]) / 1024
    return 0.0


def deliver(stream, prefix, spp, picture, seconds, load, real_spp=None):
    """Writes a picture and its JSON line."""
    file = f"{prefix}_{spp}.npy"
    np.save(file, np.ascontiguousarray(picture, np.float32))
    print(json.dumps({"spp": spp, "real_spp": real_spp or spp, "seconds": seconds, "load": load,
                      "peak_mib": peak_memory(), "picture": file}), file=stream, flush=True)
