"""Renders a scene with Mitsuba 3. usage: python -m peers.mitsuba_peer VARIANT SCENE PREFIX
SPP..."""

import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

from peers import protocol

# Samples of one launch in llvm mode: its memory grows with them. More at a time is no faster.
WAVEFRONT = 20_000_000


def render(scene, spp, at_once, seed):
    """The mean picture of spp samples a pixel, in launches of at most at_once."""
    total, done = 0, 0
    while done < spp:
        count = min(at_once, spp - done)
        # Mitsuba hashes the seed, so neighbouring ones are independent.
        picture = mi.render(scene, spp=count, seed=seed * 100_000 + done)
        total = total + np.array(picture, dtype=np.float64)[..., :3] * count
        done += count
    return total / spp


def main():
    variant = sys.argv.pop(1)
    arguments = protocol.arguments(__doc__)
    mi.set_variant(variant)
    mi.set_log_level(mi.LogLevel.Error)
    dr.set_thread_count(arguments.threads)
    start = time.perf_counter()
    overrides = {name: str(value) for name, value in arguments.overrides.items()}
    scene = mi.load_file(str(arguments.scene), **overrides)
    load = time.perf_counter() - start

    width, height = scene.sensors()[0].film().size()
    vectorised = variant.startswith("llvm")
    if vectorised and max(arguments.spp) > 1:
        render(scene, 1, 1, 0)  # compiles the kernel, or fetches it from the cache
    for spp in arguments.spp:
        at_once = max(1, WAVEFRONT // (width * height)) if vectorised else spp
        start = time.perf_counter()
        picture = render(scene, spp, at_once, arguments.seed)
        seconds = time.perf_counter() - start
        protocol.deliver(sys.stdout, arguments.prefix, spp, picture, seconds, load)


main()
