"""The renderers that are compared: which are there, how each is run, and what a run yields."""

import dataclasses
import hashlib
import importlib.metadata
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

from programs import CLRENDER, Failed, clrender_command, launch


OWN = "own"


@dataclasses.dataclass(frozen=True)
class Settings:
    """What is the same for all renderers of a session. rr_depth: a number, or OWN, each renderer's
    default. timeout: seconds for one process."""
    width: int
    height: int
    max_depth: int
    rr_depth: int | str
    cores: int
    timeout: float

    def rr_depth_of(self, renderer):
        return renderer.own_rr_depth if self.rr_depth == OWN else self.rr_depth


@dataclasses.dataclass(frozen=True)
class Run:
    """One picture. Seconds are wall time; peak_mib is resident memory. seconds: rendering alone;
    load: reading the scene, building trees, compiling."""
    spp: int
    real_spp: float
    seconds: float
    load: float
    peak_mib: float
    picture: str


class Clrender:
    name = "clrender"
    label = "clrender"
    own_rr_depth = "auto"

    def version(self):
        """Which build it is, or None where there is none."""
        if not CLRENDER.is_file():
            return None
        return hashlib.sha256(CLRENDER.read_bytes()).hexdigest()[:12]

    def missing(self):
        return f"there is no {CLRENDER}; scripts/build makes it"

    def command(self, scene, prefix, spp, seed, settings):
        options = ["-r", f"{settings.width}x{settings.height}", "--max-depth", settings.max_depth,
                   "--rr-depth", settings.rr_depth_of(self), "--seed", seed, "-s", spp]
        return clrender_command(scene, f"{prefix}_{spp}.pfm", f"{prefix}_{spp}.json", *options)

    def render(self, scene, prefix, spps, seed, settings):
        """Yields the Runs of one seed, a process for each sample count."""
        for spp in spps:
            _, _, peak = launch(self.command(scene, prefix, spp, seed, settings), settings.timeout)
            stats = pathlib.Path(f"{prefix}_{spp}.json")
            figures = json.loads(stats.read_text())
            stats.unlink()
            seconds = figures["seconds"]
            load = sum(seconds[part] for part in ("parse", "build", "compile", "upload"))
            yield Run(spp, spp, seconds["render"], load, peak, f"{prefix}_{spp}.pfm")

    def start(self, scene, prefix, settings, environment):
        """Wall seconds of a whole process that renders one sample a pixel."""
        return launch(self.command(scene, prefix, 1, 1, settings), settings.timeout, environment)[1]


class Peer:
    """A renderer from a Python package, run by a module of bench/peers. own_rr_depth: from where
    on its defaults end paths by roulette."""

    def __init__(self, name, label, package, module, own_rr_depth):
        self.name, self.label, self.package = name, label, package
        self.module, self.words, self.own_rr_depth = module, (), own_rr_depth

    def version(self):
        try:
            return importlib.metadata.version(self.package)
        except importlib.metadata.PackageNotFoundError:
            return None

    def missing(self):
        return f"this Python has no {self.package}; scripts/bench --install-peers gets it"

    def command(self, scene, prefix, spps, seed, settings):
        return [sys.executable, "-m", f"peers.{self.module}", *self.words, scene, prefix, *spps,
                "--seed", seed, "--threads", settings.cores,
                "--width", settings.width, "--height", settings.height,
                "--max-depth", settings.max_depth,
                "--rr-depth", settings.rr_depth_of(self)]

    def render(self, scene, prefix, spps, seed, settings):
        """Yields the Runs of one seed, all in one process."""
        output = launch(self.command(scene, prefix, spps, seed, settings), settings.timeout)[0]
        lines = [json.loads(line) for line in output.splitlines() if line.startswith("{")]
        if len(lines) != len(spps):
            raise Failed(f"{len(lines)} pictures instead of {len(spps)}")
        for line in lines:
            yield Run(**line)

    def start(self, scene, prefix, settings, environment):
        """Wall seconds of a whole process that renders one sample a pixel."""
        command = self.command(scene, prefix, [1], 1, settings)
        return launch(command, settings.timeout, environment)[1]


class Mitsuba(Peer):
    """sampler: see docs/benchmark.md. llvm mode needs an LLVM that Mitsuba 3.9 gets on with: 14 and
    15 make it abort."""

    def __init__(self, name, label, variant, sampler="multijitter"):
        super().__init__(name, label, "mitsuba", "mitsuba_peer", own_rr_depth=5)
        self.variant = variant
        self.use_sampler(sampler)

    def use_sampler(self, sampler):
        self.sampler, self.words = sampler, (self.variant, sampler)

    def lacks_llvm(self):
        return self.variant.startswith("llvm") and not find_llvm()

    def version(self):
        version = super().version()
        return f"{version} {self.sampler}" if version and not self.lacks_llvm() else None

    def missing(self):
        return ("there is no LLVM 16 or newer (apt: libllvm19)" if self.lacks_llvm()
                else super().missing())


def find_llvm():
    """The path of the newest LLVM library from 16 on, or what DRJIT_LIBLLVM_PATH says; None."""
    if os.environ.get("DRJIT_LIBLLVM_PATH"):
        return os.environ["DRJIT_LIBLLVM_PATH"]
    try:
        known = subprocess.run(["/sbin/ldconfig", "-p"], capture_output=True, text=True).stdout
    except OSError:
        return None
    found = re.findall(r"libLLVM(?:-|\.so\.)(\d+)\S* .*=> (\S+)", known)
    usable = [(int(version), path) for version, path in found if int(version) >= 16]
    return max(usable)[1] if usable else None


RENDERERS = [
    Clrender(),
    Mitsuba("mitsuba-llvm", "Mitsuba llvm", "llvm_ad_rgb"),
    Mitsuba("mitsuba-scalar", "Mitsuba scalar", "scalar_rgb"),
    Peer("luxcore", "LuxCore", "pyluxcore", "luxcore_peer", own_rr_depth=3),
    Peer("cycles", "Cycles", "bpy", "cycles_peer", own_rr_depth=1),
]
LABELS = {renderer.name: renderer.label for renderer in RENDERERS}


def installed(names, mitsuba_sampler):
    """Those of the named renderers that are there; says which are not, and why."""
    there = []
    for renderer in RENDERERS:
        if isinstance(renderer, Mitsuba):
            renderer.use_sampler(mitsuba_sampler)
        if renderer.name in names:
            if renderer.version():
                there.append(renderer)
            else:
                print(f"{renderer.name}: left out, {renderer.missing()}")
    return there


def start_seconds(renderer, scene, settings, cold):
    """Wall seconds of a process that renders one sample; cold: with no kernel in any cache."""
    with tempfile.TemporaryDirectory() as folder:
        caches = ("HOME", "XDG_CACHE_HOME", "POCL_CACHE_DIR", "DRJIT_CACHE_DIR")
        environment = {}
        for name in caches if cold else ():
            environment[name] = os.path.join(folder, name)
            os.mkdir(environment[name])
        return renderer.start(scene, os.path.join(folder, "start"), settings, environment)
