"""Plots of error against time, a file for each scene and one of all."""

import math

import matplotlib
import numpy as np

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import LogFormatterMathtext, NullFormatter  # noqa: E402

# Okabe and Ito's colours, which people with any colour vision can tell apart; and the markers differ.
STYLES = {"clrender": ("#D55E00", "o"), "mitsuba-llvm": ("#0072B2", "s"), "mitsuba-scalar": ("#56B4E9", "D"),
          "luxcore": ("#009E73", "^"), "cycles": ("#CC79A7", "v")}
TITLES = {
    "room": "The report's room", "mesh": "A mesh in a box, small lamp", "sky": "Painted meshes, sky with a sun",
    "glass": "Mirror and glass in a box", "lights": "400 sphere lights, 50 meshes",
    "million": "A million triangles, sky and lamp", "spheres": "Ten thousand spheres",
}
INK, FAINT = "#333333", "#9a9a9a"


def display(picture):
    """Linear radiance as sRGB from 0 to 1, exposed so that the median is a middle grey."""
    exposed = picture * (.2 / max(float(np.median(picture)), 1e-6))
    exposed = np.clip(exposed / (1 + .25 * exposed), 0, 1)
    return np.where(exposed <= .0031308, 12.92 * exposed, 1.055 * exposed ** (1 / 2.4) - .055)


def limits(summary):
    """The ranges of both axes, with room for the labels on the right."""
    points = [point for entry in summary.entries for point in entry.line()]
    (left, right), (low, high) = ((min(column), max(column)) for column in zip(*points))
    width = max(right / left, 10)
    return (left / width ** .06, left * width ** 1.32), (low / (high / low) ** .12, high * (high / low) ** .1)


def label_ends(axes, summary, size):
    """Writes each renderer's name at the end of its line, moved up or down where names would overlap."""
    gap = 1.25 * size * axes.figure.dpi / 72
    placed = []
    for entry in sorted(summary.entries, key=lambda entry: entry.line()[-1][1]):
        x, y = axes.transData.transform(entry.line()[-1])
        wide = .62 * size * len(entry.label) * axes.figure.dpi / 72
        wanted = y
        for other_x, other_y, other_wide in placed:
            if other_x - wide < x < other_x + other_wide:
                wanted = max(wanted, other_y + gap)
        placed.append((x, wanted, wide))
        axes.annotate(entry.label, entry.line()[-1], xytext=(.8 * size, (wanted - y) * 72 / axes.figure.dpi),
                      textcoords="offset points", va="center", size=size, color=STYLES[entry.name][0],
                      fontweight="bold" if entry.name == "clrender" else "normal")


def draw(axes, summary, size=10):
    """One scene: a line for each renderer, guides of slope -1 behind them."""
    axes.set(xscale="log", yscale="log")
    (left, right), (low, high) = limits(summary)
    axes.set_xlim(left, right)
    axes.set_ylim(low, high)
    axes.set_facecolor("#fbfbf9")
    # Along a guide the efficiency is the same; from one to the next it is ten times as high.
    for power in range(math.floor(math.log10(low * left)), math.ceil(math.log10(high * right)) + 1):
        axes.plot([left, right], [10.0 ** power / left, 10.0 ** power / right], color="#dcdcd6",
                  linewidth=.8, linestyle=(0, (4, 4)), zorder=0)
    for entry in reversed(summary.entries):
        colour, marker = STYLES[entry.name]
        ours = entry.name == "clrender"
        axes.plot(*zip(*entry.line()), color=colour, marker=marker, linewidth=2.4 if ours else 1.5,
                  markersize=.6 * size if ours else .5 * size, markeredgecolor="white", markeredgewidth=.8,
                  zorder=3 if ours else 2, clip_on=False)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(FAINT)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_formatter(NullFormatter())
        axis.set_major_formatter(LogFormatterMathtext())
    axes.tick_params(which="both", colors=INK, labelsize=.9 * size)
    axes.tick_params(which="minor", color=FAINT, length=2)
    axes.set_title(TITLES.get(summary.name, summary.name), loc="left", size=1.2 * size, color=INK, pad=size)


def add_picture(axes, summary):
    """The scene itself, small, in the corner where the lines are not."""
    inset = axes.inset_axes([.66, .68, .34, .34])
    entry = summary.entries[0]
    inset.imshow(display(entry.stack.mean(0)), interpolation="lanczos")
    inset.set_axis_off()


def annotate_samples(axes, summary, size):
    """The sample counts beside the points of the first renderer."""
    for point, (x, y) in zip(summary.entries[0].points, summary.entries[0].line()):
        axes.annotate(f"{point.spp} spp" if point is summary.entries[0].points[0] else str(point.spp), (x, y),
                      xytext=(-.5 * size, -.9 * size), textcoords="offset points", ha="right", va="center",
                      size=.8 * size, color=INK)


def plot_scene(summary, path):
    figure, axes = plt.subplots(figsize=(7.2, 5), dpi=160, layout="constrained")
    draw(axes, summary)
    axes.set_xlabel("seconds of rendering", color=INK)
    axes.set_ylabel("relMSE (without the noisiest 0.1% of the pixels)", color=INK)
    add_picture(axes, summary)
    annotate_samples(axes, summary, 10)
    figure.canvas.draw()
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
