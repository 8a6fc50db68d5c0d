#!/usr/bin/env python3
"""What the ways of sampling bring: the picture's error at equal samples and at equal time, with each
of them switched off or set otherwise, over that of the program's own choice.

All variants of a scene take turns, with the same seeds. Writes build/bench/results/sampling.md.
Wants an idle machine, and about a quarter of an hour.
"""

import argparse
import json
import pathlib
import statistics
import sys
import tempfile

from benchmark import (add_run_arguments, check_seeds, check_words, need_numpy, prepare_scenes,
                       words)
from catalogue import TITLES
from programs import Failed, clrender_command, launch, use_cores
from tables import markdown, publish

OWN = "as it is"
VARIANTS = {
    "independent samples": ["--sampler", "independent"],
    "1 light sample": ["--light-samples", 1],
    "2 light samples": ["--light-samples", 2],
    "4 light samples": ["--light-samples", 4],
    "no specular connections": ["--specular-connections", "off"],
    "light sampling alone": ["--strategy", "light"],
    "BSDF sampling alone": ["--strategy", "bsdf"],
    "no roulette": ["--rr-depth", 1000000],
    "roulette from depth 5": ["--rr-depth", 5],
}


class Variant:
    """Renders of a scene with some options: seconds of each, and the pictures of all seeds."""

    def __init__(self, scene, options, folder, timeout):
        self.scene, self.options, self.folder, self.timeout = scene, options, folder, timeout
        self.seconds, self.pictures = [], []

    def measure(self, spp, seed):
        import noise
        picture, stats = self.folder / "picture.pfm", self.folder / "stats.json"
        launch(clrender_command(self.scene, picture, stats, "-s", spp, "--seed", seed,
                                *self.options), self.timeout)
        self.pictures.append(noise.read_picture(picture))
        self.seconds.append(json.loads(stats.read_text())["seconds"]["render"])

    @property
    def time(self):
        return statistics.median(self.seconds)

    @property
    def error(self):
        import noise
        import numpy
        return noise.relative_error(numpy.array(self.pictures)).trimmed


def measure(scene, arguments, folder):
    """The variants of a scene by name."""
    width, height = arguments.resolution
    rest = ["-r", f"{width}x{height}", "--max-depth", 10]
    own = ["--rr-depth", "auto"]
    variants = {name: Variant(scene, [*rest, *([] if "--rr-depth" in options else own), *options],
                              folder, arguments.timeout)
                for name, options in [(OWN, []), *((n, VARIANTS[n]) for n in arguments.variants)]}
    for variant in variants.values():
        variant.measure(1, 0)  # compiles the kernel
        variant.seconds, variant.pictures = [], []
    for seed in range(1, arguments.seeds + 1):
        for variant in variants.values():
            variant.measure(arguments.spp, seed)
        print(f"{scene.stem}: seed {seed}/{arguments.seeds}", flush=True)
    return variants


def report(measured, names):
    """The table; measured: scene -> its variants."""
    rows = [["relMSE " + OWN, *(f"{v[OWN].error:.2e}" for v in measured.values())]]
    for name in names:
        cells = []
        for variants in measured.values():
            error = variants[name].error / variants[OWN].error
            cells.append(f"{error:.2f}, {error * variants[name].time / variants[OWN].time:.2f}")
        rows.append([name, *cells])
    return markdown(["", *(f"`{scene.stem}`" for scene in measured)], rows)


def parse():
    parser = argparse.ArgumentParser(prog="scripts/bench --sampling", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", type=words, default=list(TITLES), metavar="SCENE,...",
                        help="these scenes: " + " ".join(TITLES))
    parser.add_argument("--variants", type=words, default=list(VARIANTS), metavar="NAME,...",
                        help="these: " + ", ".join(VARIANTS))
    parser.add_argument("--seeds", type=int, default=4, help="at least 2 (4)")
    parser.add_argument("--spp", type=int, default=64, help="samples a pixel (64)")
    add_run_arguments(parser, resolution=(160, 120), timeout=600)
    arguments = parser.parse_args()
    check_words(parser, arguments, {"only": TITLES, "variants": VARIANTS})
    check_seeds(parser, arguments)
    return arguments


def main():
    arguments = parse()
    use_cores(arguments.cores)
    need_numpy()
    try:
        with tempfile.TemporaryDirectory() as folder:
            measured = {scene: measure(scene, arguments, pathlib.Path(folder))
                        for scene in prepare_scenes(arguments.only)}
    except Failed as failure:
        sys.exit(f"error: {failure}")
    text = ("Over the program's own choice: relMSE at equal samples, at equal time (relMSE times "
            f"seconds);\n{arguments.spp} samples a pixel, {arguments.seeds} seeds.\n\n" +
            report(measured, arguments.variants))
    publish(text, "sampling.md")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit("\nStopped.")
