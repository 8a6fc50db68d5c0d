"""What the benchmarks share: where things are, how programs are run, and clrender itself."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

BENCH = pathlib.Path(__file__).resolve().parent
ROOT = BENCH.parent
BUILD = ROOT / "build"
SHARED = ROOT.parent / "shared"
CLRENDER = BUILD / "clrender"
BUNNY = SHARED / "meshes" / "bunny.obj"


class Failed(Exception):
    """A program that ended with an error, or did not end in time; the text says how."""


def run(command, **options):
    """The standard output of a command that has to succeed."""
    return subprocess.run([str(word) for word in command], check=True, text=True,
                          stdout=subprocess.PIPE, **options).stdout


def launch(command, timeout, environment=None):
    """Runs a command in its own session. Returns its standard output, the wall seconds from exec to
    exit and the peak of its resident memory in MiB; raises Failed."""
    with tempfile.TemporaryDirectory() as folder:
        report, errors = (pathlib.Path(folder) / name for name in ("report.json", "errors"))
        launcher = [sys.executable, "-I", "-S", BENCH / "launch.py", timeout, report, *command]
        with open(errors, "wb") as stderr:
            output = subprocess.run([str(word) for word in launcher], text=True, cwd=BENCH,
                                    stdout=subprocess.PIPE, stderr=stderr,
                                    env={**os.environ, **(environment or {})}).stdout
        last = errors.read_text(errors="replace").strip().splitlines()[-1:]
        if not report.is_file():
            raise Failed(": ".join(["cannot be started", *last]))
        figures = json.loads(report.read_text())
        if figures["code"] != 0:
            ending = (f"no end after {timeout:g} s" if figures["code"] is None
                      else f"exit code {figures['code']}")
            raise Failed(": ".join([ending, *last]))
        return output, figures["seconds"], figures["peak_mib"]


def available_cores():
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0))


def use_cores(count):
    """Gives this process and all that it starts the same cores. PoCL counts those of the machine,
    so it is told besides."""
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:count])
    os.environ["POCL_MAX_PTHREAD_COUNT"] = str(count)


def peer_python():
    """The Python that has the peers: CLRENDER_PEER_PYTHON, else what `scripts/bench
    --install-peers` made, else None."""
    named = os.environ.get("CLRENDER_PEER_PYTHON")
    installed = BUILD / "peers-env" / "bin" / "python"
    return named or (str(installed) if installed.is_file() else None)


def clrender_command(scene, picture, stats, *options):
    """The command that renders a scene file into a picture and writes its figures to stats."""
    return [CLRENDER, "-q", "-o", picture, "--stats", stats, *options, scene]


def clrender_rate(scene, folder, *options):
    """Million paths a second of one render, its files in folder; only the launches are timed."""
    stats = folder / "stats.json"
    run(clrender_command(scene, folder / "picture.pfm", stats, *options))
    figures = json.loads(stats.read_text())
    return figures["paths"] / figures["seconds"]["render"] * 1e-6
