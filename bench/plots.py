"""Plots of error against time, a file for each scene and one of all."""

import math

import matplotlib
import numpy as np

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
from matplotlib import patheffects  # noqa: E402
from matplotlib.ticker import LogFormatterMathtext, LogFormatterSciNotation  # noqa: E402

from catalogue import TITLES  # noqa: E402

# Okabe and Ito's colours, which people with any colour vision can tell apart; and the markers
# differ.
STYLES = {"clrender": ("#D55E00", "o"), "mitsuba-llvm": ("#0072B2", "s"),
          "mitsuba-scalar": ("#56B4E9", "D"), "luxcore": ("#009E73", "^"),
          "cycles": ("#CC79A7", "v")}
INK, FAINT, PAPER = "#333333", "#9a9a9a", "#fbfbf9"


def display(picture):
    """Linear radiance as sRGB from 0 to 1, exposed by its median."""
    exposed = picture * (.4 / max(float(np.median(picture)), 1e-6))
    exposed = np.clip(exposed / (1 + .25 * exposed), 0, 1)
    return np.where(exposed <= .0031308, 12.92 * exposed, 1.055 * exposed ** (1 / 2.4) - .055)


def limits(summary):
    """The ranges of both axes, with room below the lines for their names."""
    points = [point for entry in summary.entries for point in entry.line()]
    (left, right), (low, high) = ((min(column), max(column)) for column in zip(*points))
    width, height = max(right / left, 10), max(high / low, 10)
    return (left / width ** .12, left * width ** 1.15), (low / height ** .3, high * height ** .08)


def label_ends(axes, summary, size):
    """Writes each renderer's name below the end of its line, further down where names would
    overlap."""
    pixels = axes.figure.dpi / 72
    placed = []
    for entry in sorted(summary.entries, key=lambda entry: entry.line()[-1][0]):
        x, y = axes.transData.transform(entry.line()[-1])
        half, high = .31 * size * len(entry.label) * pixels, 1.15 * size * pixels
        below = y - .95 * high
        for other_x, other_below, other_half in sorted(placed, key=lambda label: -label[1]):
            if abs(x - other_x) < half + other_half and abs(below - other_below) < high:
                below = other_below - high
        placed.append((x, below, half))
        label = axes.annotate(entry.label, entry.line()[-1], xytext=(0, (below - y) / pixels),
                              textcoords="offset points", ha="center", va="center", size=size,
                              color=STYLES[entry.name][0], zorder=4,
                              fontweight="bold" if entry.name == "clrender" else "normal")
        label.set_path_effects([patheffects.withStroke(linewidth=3, foreground=PAPER)])


def label_guide(axes, size):
    """Says what the guides are, on the highest one that is long enough: there are no lines."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    lowest, highest = math.floor(math.log10(low * left)), math.ceil(math.log10(high * right))
    for power in range(highest, lowest, -1):
        # The part of the guide inside of the axes, from one edge to another.
        start, end = max(left, 10.0 ** power / high), min(right, 10.0 ** power / low)
        if end > start * (right / left) ** .3:
            place = (start * end) ** .5
            ends = [(seconds, 10.0 ** power / seconds) for seconds in (start, end)]
            dx, dy = np.diff(axes.transData.transform(ends), axis=0)[0]
            axes.text(place, 10.0 ** power / place, "equal efficiency", size=.75 * size,
                      rotation=math.degrees(math.atan2(dy, dx)), color=FAINT, ha="center",
                      va="center", rotation_mode="anchor", backgroundcolor=PAPER, zorder=1)
            return


def draw(axes, summary, size=10):
    """One scene: a line for each renderer, guides of slope -1 behind them."""
    axes.set(xscale="log", yscale="log")
    (left, right), (low, high) = limits(summary)
    axes.set_xlim(left, right)
    axes.set_ylim(low, high)
    axes.set_facecolor(PAPER)
    # Along a guide the efficiency is the same; from one to the next it is ten times as high.
    for power in range(math.floor(math.log10(low * left)), math.ceil(math.log10(high * right)) + 1):
        axes.plot([left, right], [10.0 ** power / left, 10.0 ** power / right], color="#dcdcd6",
                  linewidth=.8, linestyle=(0, (4, 4)), zorder=0)
    for entry in reversed(summary.entries):
        colour, marker = STYLES[entry.name]
        ours = entry.name == "clrender"
        axes.plot(*zip(*entry.line()), color=colour, marker=marker, linewidth=2.4 if ours else 1.5,
                  markersize=.6 * size if ours else .5 * size, markeredgecolor="white",
                  markeredgewidth=.8, zorder=3 if ours else 2, clip_on=False)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(FAINT)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_formatter(LogFormatterSciNotation())  # only where decades are few
        axis.set_major_formatter(LogFormatterMathtext())
    axes.tick_params(which="both", colors=INK, labelsize=.9 * size)
    axes.tick_params(which="minor", color=FAINT, length=2, labelsize=.75 * size)
    axes.set_title(TITLES[summary.name], loc="left", size=1.2 * size, color=INK, pad=size)


def add_picture(axes, summary):
    """The scene itself, small, in the corner where the lines are not."""
    inset = axes.inset_axes([.02, .03, .27, .27])
    entry = summary.entries[0]
    inset.imshow(display(entry.stack.mean(0)), interpolation="lanczos")
    inset.set_axis_off()


def annotate_samples(axes, summary, size):
    """The sample counts beside the points of the first renderer."""
    first = summary.entries[0]
    for i, place in enumerate(first.line()):
        axes.annotate(f"{first.points[i].spp}{'' if i else ' spp'}", place, color=INK,
                      xytext=(-.75 * size, -.05 * size), textcoords="offset points", ha="right",
                      va="center", size=.8 * size)


def plot_scene(summary, path):
    figure, axes = plt.subplots(figsize=(7.2, 5), dpi=160, layout="constrained")
    draw(axes, summary)
    axes.set_xlabel("seconds of rendering", color=INK)
    axes.set_ylabel("relMSE (without the noisiest 0.1% of the pixels)", color=INK)
    add_picture(axes, summary)
    annotate_samples(axes, summary, 10)
    figure.canvas.draw()
    label_guide(axes, 10)
    label_ends(axes, summary, 10)
    figure.savefig(path)
    plt.close(figure)


def plot_all(summaries, path):
    """All scenes beside each other."""
    columns = min(len(summaries), 3)
    rows = -(-len(summaries) // columns)
    figure, grid = plt.subplots(rows, columns, figsize=(4.4 * columns, 3.5 * rows), dpi=130,
                                layout="constrained", squeeze=False)
    cells = list(grid.ravel())
    for axes, summary in zip(cells, summaries):
        draw(axes, summary, 8)
    for axes in cells[len(summaries):]:
        axes.set_axis_off()
    figure.supxlabel("seconds of rendering", color=INK, size=9)
    figure.supylabel("relMSE", color=INK, size=9)
    figure.canvas.draw()
    for axes, summary in zip(cells, summaries):
        label_ends(axes, summary, 8)
    figure.savefig(path)
    plt.close(figure)


def plot(summaries, folder):
    """Writes SCENE.png for each scene and overview.png."""
    for summary in summaries:
        plot_scene(summary, folder / f"{summary.name}.png")
    if summaries:
        plot_all(summaries, folder / "overview.png")
