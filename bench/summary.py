"""From the rows of a session to the figures of its tables and plots."""

import dataclasses
import statistics

import numpy as np

import curves
import noise

TARGETS = (1e-2, 1e-3)  # relMSE, trimmed
HEADLINE = 64  # samples a pixel


@dataclasses.dataclass
class Point:
    """One sample count: medians over the seeds. rate: million paths a second."""
    spp: int
    seconds: float
    rate: float
    error: noise.Error

    def efficiency(self):
        return curves.efficiency(self.error.trimmed, self.seconds)

    def efficiency_full(self):
        return curves.efficiency(self.error.full, self.seconds)


@dataclasses.dataclass
class Entry:
    """One renderer on one scene. points: by sample count; head: the one that is compared."""
    name: str
    label: str
    points: list[Point]
    head: Point
    times: list[curves.TimeTo | None]  # to TARGETS
    warm: float | None  # seconds
    cold: float | None
    peak_mib: float
    mean: float  # of the pictures with the most samples
    stack: np.ndarray
    agreement: noise.Agreement | None = None  # clrender only: with Mitsuba

    def line(self):
        return [(point.seconds, point.error.trimmed) for point in self.points]


@dataclasses.dataclass
class SceneSummary:
    """best: the peer with the highest efficiency; the ratios are clrender's efficiency over the
    best peer's, by the trimmed and by the full error; None without both."""
    name: str
    entries: list[Entry]
    best: Entry | None = None
    ratio: float | None = None
    ratio_full: float | None = None


def summarise_renderer(session, scene, renderer, seeds, spps):
    """The Entry, or None where fewer than two seeds are there."""
    measured = session.measured(scene, renderer, seeds, spps)
    if not measured:
        return None
    points = []
    for spp, rows in measured.items():
        stack = np.stack([noise.read_picture(session.picture(row)) for row in rows])
        seconds = statistics.median(float(row["seconds"]) for row in rows)
        pixels = stack.shape[1] * stack.shape[2]
        rate = statistics.median(pixels * float(row["real_spp"]) / float(row["seconds"])
                                 for row in rows)
        points.append(Point(spp, seconds, rate * 1e-6, noise.relative_error(stack)))
    head = next((point for point in points if point.spp == HEADLINE), points[-1])
    line = [(point.seconds, point.error.trimmed) for point in points]
    peak = max(float(row["peak_mib"]) for rows in measured.values() for row in rows)
    return Entry(renderer.name, renderer.label, points, head,
                 [curves.time_to(target, line) for target in TARGETS],
                 session.start_time(scene, renderer, cold=False),
                 session.start_time(scene, renderer, cold=True), peak,
                 float(stack.mean(dtype=float)), stack)


def summarise(session, seeds, spps):
    """A SceneSummary for each scene that anything is measured of."""
    summaries = []
    for scene in session.scenes:
        found = (summarise_renderer(session, scene, renderer, seeds, sorted(spps))
                 for renderer in session.renderers)
        entries = {entry.name: entry for entry in found if entry}
        if not entries:
            continue
        summary = SceneSummary(scene.stem, list(entries.values()))
        ours = entries.pop("clrender", None)
        if ours and entries:
            summary.best = max(entries.values(), key=lambda entry: entry.head.efficiency())
            summary.ratio = ours.head.efficiency() / summary.best.head.efficiency()
            summary.ratio_full = ours.head.efficiency_full() / max(
                entry.head.efficiency_full() for entry in entries.values())
        mitsuba = entries.get("mitsuba-scalar") or entries.get("mitsuba-llvm")
        if ours and mitsuba:
            ours.agreement = noise.agreement(ours.stack, mitsuba.stack)
        summaries.append(summary)
    return summaries
