"""Error and bias of pictures, from independent runs alone; no reference is needed.

A stack holds the pictures of several seeds: float (seeds, height, width, 3), linear.
"""

import dataclasses
import pathlib

import numpy as np

TRIMMED = .001  # share of the pixels that the trimmed error leaves out
BLOCK = 16  # pixels, the side of the squares whose means are compared


def read_picture(path):
    """A picture from .npy or from a colour .pfm, first row on top."""
    path = pathlib.Path(path)
    if path.suffix == ".npy":
        return np.load(path)
    with open(path, "rb") as file:
        kind, size, scale = (file.readline().split() for _ in range(3))
        if kind != [b"PF"]:
            raise ValueError(f"{path} is not a colour PFM")
        width, height = map(int, size)
        order = "<f4" if float(scale[0]) < 0 else ">f4"
        return np.frombuffer(file.read(), order).reshape(height, width, 3)[::-1]


@dataclasses.dataclass(frozen=True)
class Error:
    """relMSE of one picture: of all pixels, and without the noisiest 0.1% of them."""
    full: float
    trimmed: float


def relative_error(stack):
    """relMSE = mean of variance/(mean² + 0.01), over pixels and channels; the unbiased variance
    between the seeds is the squared error that one picture of them has on average."""
    mean, variance = stack.mean(0, dtype=float), stack.var(0, ddof=1, dtype=float)
    of_pixel = np.sort((variance / (mean ** 2 + .01)).mean(-1).ravel())
    kept = len(of_pixel) - round(TRIMMED * len(of_pixel))
    return Error(float(of_pixel.mean()), float(of_pixel[:kept].mean()))


@dataclasses.dataclass(frozen=True)
class Agreement:
    """How far two renderers' pictures are apart: the difference of the image means as a share, in
    standard deviations, and the root mean square of the same over square blocks of pixels, beside
    the value that blocks of two unbiased renderers would have."""
    difference: float
    z_mean: float
    z_blocks: float
    z_expected: float


def _block_means(stack):
    """Mean of the channels in blocks of pixels, (seeds, blocks); incomplete ones at the edge are
    left out."""
    seeds, height, width, _ = stack.shape
    rows, columns = height // BLOCK, width // BLOCK
    cut = stack[:, :rows * BLOCK, :columns * BLOCK].mean(-1, dtype=float)
    return cut.reshape(seeds, rows, BLOCK, columns, BLOCK).mean((2, 4)).reshape(seeds, -1)


def _z(a, b):
    """Difference of the means over the seeds, in standard deviations."""
    variance = a.var(0, ddof=1) / len(a) + b.var(0, ddof=1) / len(b)
    rounding = 1e-5 * b.mean(0)  # where nothing is random, as in an even sky
    return (a.mean(0) - b.mean(0)) / np.sqrt(variance + rounding ** 2 + 1e-30)


def agreement(ours, theirs):
    """Compares two stacks; those with fewer than two seeds have no variance."""
    means = [stack.mean((1, 2, 3), dtype=float) for stack in (ours, theirs)]
    blocks = _z(*map(_block_means, (ours, theirs)))
    # With few seeds z follows Student's distribution, whose variance is freedom/(freedom - 2).
    freedom = len(ours) + len(theirs) - 2
    expected = (freedom / (freedom - 2)) ** .5 if freedom > 2 else float("inf")
    return Agreement(means[0].mean() / means[1].mean() - 1, float(_z(*means)),
                     float(np.sqrt((blocks ** 2).mean())), expected)
