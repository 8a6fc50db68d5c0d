"""The Markdown tables of a benchmark."""

import datetime
import math
import pathlib
import re

import curves
from noise import TRIMMED
from renderers import OWN
from summary import TARGETS
from tables import markdown


def figure(value, digits=3):
    """A number with so many significant digits, with an exponent where it is very small or
    large."""
    if value is None or not math.isfinite(value):
        return "–"
    if value != 0 and not 1e-2 <= abs(value) < 1e5:
        return f"{value:.{digits - 1}e}"
    return f"{value:.{digits}g}" if abs(value) < 10 ** digits else f"{value:.0f}"


def seconds(value):
    """Seconds; those that are extrapolated in italics with a tilde."""
    if value is None:
        return "–"
    return f"*~{figure(value.seconds)}*" if value.extrapolated else figure(value.seconds)


def machine(cores):
    model = re.search(r"model name\s*: (.*)", pathlib.Path("/proc/cpuinfo").read_text())
    flags = pathlib.Path("/proc/cpuinfo").read_text()
    vectors = "AVX-512" if "avx512f" in flags else "AVX2" if "avx2" in flags else "no AVX2"
    return f"{cores} cores of {model.group(1) if model else 'an unknown processor'} ({vectors})"


def overview(summaries):
    """Efficiency of all renderers on all scenes, and how clrender stands to the best peer."""
    labels = {entry.name: entry.label for summary in summaries for entry in summary.entries}
    rows = []
    for summary in summaries:
        entries = {entry.name: entry for entry in summary.entries}
        cells = [figure(entries[name].head.efficiency()) if name in entries else "–"
                 for name in labels]
        best = summary.best.label if summary.best else "–"
        rows.append([summary.name, *cells, best, f"**{figure(summary.ratio)}**",
                     figure(summary.ratio_full)])
    compared = [summary for summary in summaries if summary.best]
    if compared:
        ratios = [summary.ratio for summary in compared]
        ratios_full = [summary.ratio_full for summary in compared]
        for title, of in (("geometric mean", curves.geometric_mean), ("smallest", min)):
            rows.append([title, *[""] * (len(labels) + 1), f"**{figure(of(ratios))}**",
                         figure(of(ratios_full))])
    return markdown(["scene", *labels.values(), "best peer", "clrender / best", "untrimmed"], rows)


def details(summary):
    header = ["renderer", "Mpaths/s", "relMSE", "untrimmed", "efficiency",
              *[f"s to {target:g}" for target in TARGETS], "warm start s", "cold start s",
              "peak MiB"]
    rows = []
    for entry in summary.entries:
        head = entry.head
        figures = [head.rate, head.error.trimmed, head.error.full, head.efficiency()]
        rows.append([entry.label, *map(figure, figures), *map(seconds, entry.times),
                     *map(figure, (entry.warm, entry.cold, entry.peak_mib))])
    return markdown(header, rows)


def bias(summaries, seeds):
    """The image means beside each other, and clrender against Mitsuba in standard deviations, where
    there are seeds enough to know them."""
    labels = {entry.name: entry.label for summary in summaries for entry in summary.entries}
    rows = []
    for summary in summaries:
        away = curves.relative_difference([entry.mean for entry in summary.entries])
        cells = {entry.name: f"{100 * value:+.2f}%" for entry, value in zip(summary.entries, away)}
        agreement = next((entry.agreement for entry in summary.entries if entry.agreement), None)
        ours = ["–"] * 3
        if agreement:
            ours[0] = f"{100 * agreement.difference:+.2f}%"
        if agreement and seeds >= 4 and math.isfinite(agreement.z_expected):
            ours[1:] = (f"{agreement.z_mean:+.1f}",
                        f"{agreement.z_blocks:.2f} ({agreement.z_expected:.2f})")
        rows.append([summary.name, *[cells.get(name, "–") for name in labels], *ours])
    return markdown(["scene", *labels.values(), "clrender - Mitsuba", "z of the mean",
                     "z of blocks (unbiased)"], rows)


def roulette_title(settings):
    if settings.rr_depth == OWN:
        return "each renderer's own roulette"
    if settings.rr_depth > settings.max_depth:
        return "no roulette"
    return f"roulette from {settings.rr_depth}"


def write_report(session, summaries, seeds, path):
    """Writes the report of a session and returns its text."""
    settings = session.settings
    spps = sorted({entry.head.spp for summary in summaries for entry in summary.entries})
    programs = ", ".join(f"{renderer.label} {renderer.version()}" for renderer in session.renderers)
    roulette = roulette_title(settings)
    parts = [
        f"# Run time against error\n\n{datetime.date.today()}, {machine(settings.cores)}. "
        f"{programs}. {settings.width}x{settings.height}, box filter, depth {settings.max_depth}, "
        f"{roulette}, {len(seeds)} seeds.\n",
        f"Efficiency = 1/(relMSE x seconds) at {' and '.join(map(str, spps))} samples a pixel. "
        "relMSE = mean of variance/(mean² + 0.01) between the seeds, without the noisiest "
        f"{100 * TRIMMED:g}% of the pixels; the columns *untrimmed* are with them. Seconds of "
        "rendering only.\n",
        overview(summaries),
    ]
    for summary in summaries:
        parts.append(f"## {summary.name}\n\n{details(summary)}")
    parts.append("In italics: extrapolated. Starts are whole processes at one sample a pixel, cold "
                 "with empty kernel caches. Peak: resident memory.\n")
    parts.append("## Bias\n\nImage means against the median of all renderers; clrender against "
                 "Mitsuba, also in standard deviations.\n\n" + bias(summaries, len(seeds)))
    left_out = [f"- {scene}, {renderer}: {reason}"
                for (scene, renderer), reason in session.failures.items()]
    left_out += [f"- {scene}: no time for seed {seed}" for scene, seed in session.skipped]
    if left_out:
        parts.append("## Left out\n\n" + "\n".join(left_out) + "\n")
    text = "\n".join(parts)
    path.write_text(text)
    return text
