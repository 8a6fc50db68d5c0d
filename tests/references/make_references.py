#!/usr/bin/env python3
"""Renders every scene of this folder (or those named) with Mitsuba 3, many independent times, and
writes NAME.exr: the mean of each pixel, the variance of that mean (layer `variance`), and the
standard error of the mean of the whole picture (attributes mean_se_R ...).

Not needed to run the tests. Install with `pip install mitsuba numpy`."""

import argparse
import math
import pathlib

import mitsuba as mi
import numpy as np

HERE = pathlib.Path(__file__).parent
SAMPLES = 8e6  # per picture
RUNS = 64      # independent runs that the variance is estimated from
XYZ = np.array([[0.412453, 0.357580, 0.180423],
                [0.212671, 0.715160, 0.072169],
                [0.019334, 0.119193, 0.950227]])


def colour_matrix(pixel_format):
    """What the film does to linear sRGB."""
    return {"luminance": XYZ[1:2], "xyz": XYZ}.get(pixel_format.removesuffix("_alpha").removesuffix("a"),
                                                  np.eye(3))


def accumulate(scene, film_format, runs, spp):
    """Per run: the sums of weight * value for each output channel, and of the weights."""
    has_alpha = film_format in ("rgba", "xyza", "luminance_alpha")
    matrix = colour_matrix(film_format)
    values, weights = [], []
    for run in range(runs):
        mi.render(scene, spp=spp, seed=7919 * (run + 1))
        raw = np.array(scene.sensors()[0].film().bitmap(raw=True), dtype=np.float64)
        value = raw[:, :, :3] @ matrix.T
        if has_alpha:
            value = np.concatenate([value, raw[:, :, 3:4]], -1)
        values.append(value)
        weights.append(raw[:, :, 3 + has_alpha][..., None])
    return np.array(values), np.array(weights)


def estimate(values, weights):
    """The ratio of the sums, and its variance from the runs' residuals (no bias from dividing
    few samples by their weights)."""
    runs = len(values)
    total = weights.sum(0)
    mean = values.sum(0) / total
    residual = (values - mean * weights) / total
    variance = (residual ** 2).sum(0) * runs / (runs - 1)
    picture_residual = residual.mean((1, 2))
    mean_se = np.sqrt((picture_residual ** 2).sum(0) * runs / (runs - 1))
    return mean, variance, mean_se


def round_mantissa(x, bits):
    """Fewer digits, so that the file compresses."""
    mantissa, exponent = np.frexp(x)
    return np.ldexp(np.round(mantissa * 2 ** bits) / 2 ** bits, exponent).astype(np.float32)


def film_format(path):
    """The pixel format as the scene (or the file it includes) states it."""
    text = path.read_text() + (HERE / "data" / "room.xml").read_text() * ("room.xml" in path.read_text())
    return text.split('name="pixel_format" value="')[1].split('"')[0]


def make_reference(path, samples):
    scene = mi.load_file(str(path))
    size = scene.sensors()[0].film().crop_size()
    spp = math.ceil(samples / (size[0] * size[1] * RUNS))
    mean, variance, mean_se = estimate(*accumulate(scene, film_format(path), RUNS, spp))
    names = {1: "Y", 2: "YA", 3: "RGB", 4: "RGBA"}[mean.shape[-1]]
    data = np.concatenate([round_mantissa(mean, 18), round_mantissa(variance, 8)], -1)
    bitmap = mi.Bitmap(data, mi.Bitmap.PixelFormat.MultiChannel,
                       channel_names=list(names) + ["variance." + n for n in names])
    for name, value in zip(names, mean_se):
        bitmap.metadata()["mean_se_" + name] = "%.6g" % value
    bitmap.metadata()["samples"] = str(spp * RUNS)
    bitmap.metadata()["renderer"] = "Mitsuba " + mi.__version__ + " " + mi.variant()
    bitmap.write(str(path.with_suffix(".exr")))
    noise = np.sqrt(variance.mean()) / max(np.abs(mean).mean(), 1e-9)
    print("%-22s %s spp %d  mean %.5g  relative noise %.3g  image %.2g" %
          (path.stem, mean.shape, spp * RUNS, mean.mean(), noise, mean_se.max() / mean.mean()),
          flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="scenes without .xml; default: all")
    parser.add_argument("--samples", type=float, default=SAMPLES)
    arguments = parser.parse_args()
    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    for path in [HERE / (n + ".xml") for n in arguments.names] or sorted(HERE.glob("*.xml")):
        make_reference(path, arguments.samples)


if __name__ == "__main__":
    main()
