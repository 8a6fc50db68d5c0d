"""A session of measuring: the renderers take turns, and what has been measured is not run again."""

import dataclasses
import pathlib
import statistics
import time

import results
from programs import Failed
from renderers import start_seconds


class Session:
    """Measures into the tables of a folder. failures: (scene, renderer) -> reason; such a pair is
    not tried again. skipped: the rounds that the time was too short for."""

    def __init__(self, folder, scenes, renderers, settings):
        self.scenes, self.renderers, self.settings = scenes, renderers, settings
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        self.runs, self.starts = results.runs_table(folder), results.starts_table(folder)
        self.subjects = {(scene, renderer.name): results.subject(scene, renderer, settings)
                         for scene in scenes for renderer in renderers}
        self.failures, self.skipped = {}, []

    def render(self, seeds, spps, deadline=None):
        """One round for each seed and scene. deadline (time.monotonic()): the rounds after the
        first that would probably not end before it are left out."""
        took = {}
        for number, seed in enumerate(seeds):
            for scene in self.scenes:
                if deadline and number and time.monotonic() + took[scene] > deadline:
                    self.skipped.append((scene.stem, seed))
                    continue
                start = time.monotonic()
                # Each renderer is first in one round, so that none always follows the same other.
                first = number % len(self.renderers)
                for renderer in self.renderers[first:] + self.renderers[:first]:
                    self.render_seed(scene, renderer, seed, spps, f"{number + 1}/{len(seeds)}")
                took[scene] = time.monotonic() - start

    def render_seed(self, scene, renderer, seed, spps, position):
        subject = self.subjects[scene, renderer.name]
        wanted = [spp for spp in spps if not self.has(subject, seed, spp)]
        if not wanted or (scene.stem, renderer.name) in self.failures:
            return
        prefix = self.folder / "pictures" / scene.stem / f"{renderer.name}_{seed}"
        prefix.parent.mkdir(parents=True, exist_ok=True)
        say(f"round {position}  {scene.stem:8} {renderer.name:14} seed {seed}:", end="")
        try:
            for run in renderer.render(scene, prefix, wanted, seed, self.settings):
                picture = pathlib.Path(run.picture).relative_to(self.folder)
                self.runs.add({**subject, "seed": seed, **dataclasses.asdict(run),
                               "picture": picture})
                say(f"  {run.spp} spp {run.seconds:.3g} s", end="")
            say("")
        except Failed as failure:
            self.failures[scene.stem, renderer.name] = str(failure)
            say(f"  failed: {failure}")

    def has(self, subject, seed, spp):
        row = self.runs.find({**subject, "seed": seed, "spp": spp})
        return row is not None and self.picture(row).is_file()

    def picture(self, row):
        """The path of a row's picture."""
        return self.folder / row["picture"]

    def start_up(self, repeats, scenes):
        """Times whole processes at one sample a pixel, with and without kernel caches."""
        for scene in scenes:
            for renderer in self.renderers:
                if (scene.stem, renderer.name) not in self.failures:
                    self.start_up_one(scene, renderer, repeats)

    def start_up_one(self, scene, renderer, repeats):
        subject = self.subjects[scene, renderer.name]
        missing = [(cold, repeat) for cold in (0, 1) for repeat in range(repeats)
                   if self.starts.find({**subject, "cold": cold, "repeat": repeat}) is None]
        if not missing:
            return
        say(f"start-up  {scene.stem:8} {renderer.name:14}:", end="")
        try:
            if any(not cold for cold, _ in missing):
                start_seconds(renderer, scene, self.settings, cold=False)  # fills the caches
            for cold, repeat in missing:
                seconds = start_seconds(renderer, scene, self.settings, bool(cold))
                self.starts.add({**subject, "cold": cold, "repeat": repeat, "seconds": seconds})
                say(f"  {'cold' if cold else 'warm'} {seconds:.3g} s", end="")
            say("")
        except Failed as failure:
            say(f"  failed: {failure}")

    def start_time(self, scene, renderer, cold):
        """Median seconds of the starts measured, or None."""
        subject = {**self.subjects[scene, renderer.name], "cold": str(int(cold))}
        found = [float(row["seconds"]) for row in self.starts.rows.values()
                 if all(row[name] == str(value) for name, value in subject.items())]
        return statistics.median(found) if found else None

    def measured(self, scene, renderer, seeds, spps):
        """The rows of a renderer and scene: sample count -> rows of the seeds, where there are at
        least two."""
        subject = self.subjects[scene, renderer.name]
        found = {}
        for spp in spps:
            rows = [self.runs.find({**subject, "seed": seed, "spp": spp}) for seed in seeds
                    if self.has(subject, seed, spp)]
            if len(rows) >= 2:
                found[spp] = rows
        return found


def say(text, end="\n"):
    print(text, end=end, flush=True)
