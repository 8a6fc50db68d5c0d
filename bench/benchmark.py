#!/usr/bin/env python3
"""Run time against error: clrender and other renderers on the same scenes, taking turns in one run.

Writes into build/bench/results: runs.csv and starts.csv (a row as soon as it is measured; what is
already there is not measured again), table.md, a plot for each scene and overview.png; the same
with each renderer's own roulette into build/bench/results/roulette_own.
docs/benchmark.md says what is measured and how. Wants an idle machine.
"""

import argparse
import importlib.util
import os
import shutil
import sys
import time

from catalogue import TITLES
from programs import BUILD, available_cores, use_cores
from renderers import LABELS, OWN, Settings, find_llvm, installed
from session import Session
from tables import FOLDER

QUICK = {"renderers": ["clrender", "mitsuba-llvm"], "spp": [16, 64], "seeds": 3, "starts": 1}
FULL = {"renderers": list(LABELS), "spp": [4, 16, 64, 256], "seeds": 4, "starts": 2}
NEVER = 1000000  # a depth that no path has
QUICK_SECONDS = 255  # for the rounds; scenes, start-up and tables take the rest of five minutes


def words(text):
    return [word for word in text.split(",") if word]


def counts(text):
    return sorted({int(word) for word in words(text)})


def depths(text):
    return [OWN if word == OWN else NEVER if word == "never" else int(word)
            for word in words(text)]


def size(text):
    width, height = (int(word) for word in text.split("x"))
    return width, height


def add_run_arguments(parser, resolution, timeout):
    """What all benchmarks of scenes can be told of a run, with these defaults."""
    text = "x".join(map(str, resolution))
    parser.add_argument("--resolution", type=size, default=resolution, metavar="WxH",
                        help=f"({text})")
    parser.add_argument("--cores", type=int, default=available_cores(),
                        help="for each renderer (all)")
    parser.add_argument("--timeout", type=float, default=timeout,
                        help=f"seconds for one process ({timeout})")


def check_words(parser, arguments, known):
    """Ends where an argument names what there is not; known: argument -> its words."""
    for name, there in known.items():
        for word in getattr(arguments, name):
            if word not in there:
                parser.error(f"--{name}: there is no {word}; known: {', '.join(there)}")


def check_seeds(parser, arguments):
    if arguments.seeds < 2:
        parser.error("--seeds: the error is the variance between at least 2")


def parse():
    parser = argparse.ArgumentParser(prog="scripts/bench", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true",
                        help="at most five minutes: clrender and Mitsuba llvm, fewer seeds and "
                             "samples, always anew, into build/bench/quick")
    parser.add_argument("--only", type=words, default=list(TITLES), metavar="SCENE,...",
                        help="these scenes: " + " ".join(TITLES))
    parser.add_argument("--renderers", type=words, metavar="NAME,...",
                        help="these renderers: " + " ".join(LABELS))
    parser.add_argument("--spp", type=counts, metavar="N,...", help="sample counts (4,16,64,256)")
    parser.add_argument("--seeds", type=int, help="independent runs of each, at least 2 (4)")
    parser.add_argument("--starts", type=int, help="warm and cold starts of each (2)")
    parser.add_argument("--max-depth", type=int, default=10, help="longest path in segments (10)")
    parser.add_argument("--rr-depth", type=depths, default=[NEVER, OWN], metavar="N,...",
                        help="depth from which roulette ends paths, for everyone, or own, as each "
                             "renderer does where nobody says; a table for each (never,own)")
    parser.add_argument("--mitsuba-sampler", default="multijitter", metavar="NAME",
                        choices=["multijitter", "independent", "orthogonal", "stratified"],
                        help="(multijitter), its best; independent, orthogonal, stratified")
    add_run_arguments(parser, resolution=(320, 240), timeout=1800)
    parser.add_argument("--fresh", action="store_true",
                        help="forgets what has been measured before")
    parser.add_argument("--report", action="store_true",
                        help="measures nothing: tables and plots only")
    arguments = parser.parse_args()

    usual = QUICK if arguments.quick else FULL
    for name, value in usual.items():
        if getattr(arguments, name) is None:
            setattr(arguments, name, value)
    check_words(parser, arguments, {"only": TITLES, "renderers": LABELS})
    check_seeds(parser, arguments)
    return arguments


def need_numpy():
    if importlib.util.find_spec("numpy") is None:
        sys.exit("error: this Python has no numpy. scripts/bench --install-peers makes one that "
                 "has, and the peers; or CLRENDER_PEER_PYTHON names one")


def prepare_scenes(names):
    """The scene files, made anew, with the same content every time."""
    import make_scenes
    folder = FOLDER / "scenes"
    folder.mkdir(parents=True, exist_ok=True)
    for name in names:
        make_scenes.SCENES[name](folder)
    return [folder / f"{name}.xml" for name in names]


def conclude(session, seeds, spps, folder):
    """Prints the tables and writes them, and the plots."""
    import report
    import summary
    summaries = summary.summarise(session, seeds, spps)
    if not any(found.entries for found in summaries):
        sys.exit("Nothing has been measured yet.")
    print("\n" + report.write_report(session, summaries, seeds, folder / "table.md"))
    if importlib.util.find_spec("matplotlib") is None:
        print("plots: left out, this Python has no matplotlib")
        return
    import plots
    plots.plot(summaries, folder)


def main():
    started = time.monotonic()
    arguments = parse()
    need_numpy()
    use_cores(arguments.cores)
    if find_llvm():
        os.environ["DRJIT_LIBLLVM_PATH"] = find_llvm()

    folder = FOLDER / ("quick" if arguments.quick else "results")
    if arguments.fresh or (arguments.quick and not arguments.report):
        shutil.rmtree(folder, ignore_errors=True)
    scenes = prepare_scenes(arguments.only)
    renderers = installed(arguments.renderers, arguments.mitsuba_sampler)
    seeds = range(1, arguments.seeds + 1)
    failures = False
    for rr_depth in arguments.rr_depth[:1] if arguments.quick else arguments.rr_depth:
        # Without roulette the results lie in the folder itself, others in one of their own.
        results = folder if rr_depth == NEVER else folder / f"roulette_{rr_depth}"
        settings = Settings(*arguments.resolution, arguments.max_depth, rr_depth, arguments.cores,
                            arguments.timeout)
        session = Session(results, scenes, renderers, settings)
        if not arguments.report:
            session.render(seeds, arguments.spp,
                           started + QUICK_SECONDS if arguments.quick else None)
            session.start_up(arguments.starts, scenes[:1] if arguments.quick else scenes)
        conclude(session, seeds, arguments.spp, results)
        failures = failures or bool(session.failures)
    took = time.monotonic() - started
    print(f"Written to {folder.relative_to(BUILD.parent)}, after {took:.0f} s")
    return 1 if failures else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit("\nStopped. The same command goes on from here.")
