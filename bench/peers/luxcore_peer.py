"""Renders a scene with LuxCore's CPU path engine. usage: python -m peers.luxcore_peer SCENE PREFIX
SPP..."""

import os
import pathlib
import sys
import sysconfig
import time

# The wheel brings its own allocator, which frees what the C library's allocated and crashes, unless
# that is replaced from the start.
if "libtbbmalloc_proxy" not in os.environ.get("LD_PRELOAD", ""):
    libraries = pathlib.Path(sysconfig.get_path("platlib")) / "pyluxcore.libs"
    for proxy in libraries.glob("libtbbmalloc_proxy*"):
        os.execve(sys.executable, sys.orig_argv, {**os.environ, "LD_PRELOAD": str(proxy)})

# LuxCore writes to both streams, and a log handler in Python makes it abort at the end.
OUTPUT, sys.stderr = os.fdopen(os.dup(1), "w"), os.fdopen(os.dup(2), "w")
for stream in (1, 2):
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream)

import numpy as np  # noqa: E402
import pyluxcore  # noqa: E402

pyluxcore.Init()

from peers import protocol  # noqa: E402
from peers.luxcore_scene import Translation  # noqa: E402
from peers.scene_file import read_scene  # noqa: E402


def configuration(scene, threads, seed):
    """The same work as the others (depth, filter, nothing clamped or adaptive), and what makes
    LuxCore best at it: Sobol' points, lights chosen by their power."""
    depths = {f"path.pathdepth.{kind}": scene.max_depth
              for kind in ("total", "diffuse", "glossy", "specular")}
    settings = {
        "renderengine.type": "PATHCPU", "renderengine.seed": seed, "native.threads.count": threads,
        "sampler.type": "SOBOL", "sampler.sobol.adaptive.strength": 0,
        "lightstrategy.type": "POWER",
        **depths, "path.russianroulette.depth": scene.rr_depth,
        "path.clamping.variance.maxvalue": 0, "path.hybridbackforward.enable": 0,
        "film.width": scene.width, "film.height": scene.height,
        "film.noiseestimation.warmup": 1 << 30, "film.filter.type": "BOX",
        "film.filter.width": .5, "film.filter.xwidth": .5, "film.filter.ywidth": .5,
        "film.imagepipelines.0.0.type": "NOP",
        "film.outputs.0.type": "RGB", "film.outputs.0.filename": "unused.exr",
    }
    properties = pyluxcore.Properties()
    properties.SetFromString("".join(f"{key} = {value}\n" for key, value in settings.items()))
    return properties


def wait_for(session, samples):
    """Polls, ever more often as the end comes near, until so many samples are done."""
    start = time.perf_counter()
    while True:
        session.UpdateStats()
        done = session.GetStats().Get("stats.renderengine.total.samplecount").GetFloat()
        if done >= samples:
            return
        spent = time.perf_counter() - start
        left = (samples - done) * spent / done if done else .002
        time.sleep(min(max(.8 * left, .001), 1 if done > .02 * samples else .01))


def main():
    arguments = protocol.arguments(__doc__)
    start = time.perf_counter()
    scene = read_scene(arguments.scene, arguments.overrides)
    translated = Translation(scene).scene
    built = time.perf_counter() - start
    pixels = scene.width * scene.height
    for spp in arguments.spp:
        start = time.perf_counter()
        # The seed of a sample count too is its own: or the fewer samples would be the first of the
        # more.
        properties = configuration(scene, arguments.threads, arguments.seed * 1000 + spp)
        session = pyluxcore.RenderSession(pyluxcore.RenderConfig(properties, translated))
        session.Start()  # builds the trees and the tables of the lights, then lets the threads go
        begin = time.perf_counter()
        wait_for(session, spp * pixels)
        seconds = time.perf_counter() - begin
        session.Stop()
        picture = np.zeros((scene.height, scene.width, 3), np.float32)
        film = session.GetFilm()
        film.GetOutputFloat(pyluxcore.FilmOutputType.RGB, picture, 0, False)
        real = film.GetStats().Get("stats.film.total.samplecount").GetFloat() / pixels
        load = built + begin - start
        protocol.deliver(OUTPUT, arguments.prefix, spp, picture[::-1], seconds, load, real)
    os._exit(0)  # its destructors crash


main()
