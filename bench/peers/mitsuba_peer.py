"""Renders a scene with Mitsuba 3.

usage: python -m peers.mitsuba_peer VARIANT SAMPLER SCENE PREFIX SPP...
"""

import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

from peers import protocol

# Samples of one launch in llvm mode: its memory grows with them. More at a time is no faster.
WAVEFRONT = 20_000_000


def samples_at_once(variant, pixels, spp):
    """Samples a pixel of one launch: a power of two where they are not all, which every sampler can
    do exactly."""
    most = WAVEFRONT // pixels
    if not variant.startswith("llvm") or spp <= most:
        return spp
    return 1 << max(0, most.bit_length() - 1)


def render(scene, spp, at_once, seed):
    """The mean picture and its samples a pixel: at least spp, in launches of at_once. A sampler
    that cannot do a number takes the next that it can."""
    total, done = 0, 0
    while done < spp:
        # Mitsuba hashes the seed, so neighbouring ones are independent.
        picture = mi.render(scene, spp=min(at_once, spp - done), seed=seed * 100_000 + done)
        count = scene.sensors()[0].sampler().sample_count()
        total = total + np.array(picture, dtype=np.float64)[..., :3] * count
        done += count
    return total / done, done


def main():
    variant, sampler = sys.argv.pop(1), sys.argv.pop(1)
    arguments = protocol.arguments(__doc__)
    mi.set_variant(variant)
    mi.set_log_level(mi.LogLevel.Error)
    dr.set_thread_count(arguments.threads)
    start = time.perf_counter()
    overrides = {name: str(value) for name, value in arguments.overrides.items()}
    scene = mi.load_file(str(arguments.scene), sampler=sampler, **overrides)
    load = time.perf_counter() - start

    width, height = scene.sensors()[0].film().size()
    if variant.startswith("llvm") and max(arguments.spp) > 1:
        # Compiles the kernel, or fetches it from the cache. One sample may need another.
        render(scene, 4, 4, 0)
    for spp in arguments.spp:
        at_once = samples_at_once(variant, width * height, spp)
        start = time.perf_counter()
        picture, real_spp = render(scene, spp, at_once, arguments.seed)
        seconds = time.perf_counter() - start
        protocol.deliver(sys.stdout, arguments.prefix, spp, picture, seconds, load, real_spp)


main()
