#!/usr/bin/env python3
"""Renders aovs.xml with Mitsuba 3 (scalar_rgb) and writes aovs.exr: of each layer NAME the mean, with
the channels Y, YA or RGB, and as the layer variance_NAME the variance of that mean. Not needed to
run the tests."""

import pathlib

import mitsuba as mi
import numpy as np

RUNS, SPP = 16, 64
PATH = pathlib.Path(__file__).parent / "aovs.xml"

mi.set_variant("scalar_rgb")
mi.set_log_level(mi.LogLevel.Error)
scene = mi.load_file(str(PATH))
film = scene.sensors()[0].film()
pictures = []
for run in range(RUNS):
    mi.render(scene, spp=SPP, seed=7919 * (run + 1))
    pictures.append(np.array(film.bitmap(), dtype=np.float64))
names = [field.name for field in film.bitmap().struct_()]
pictures = np.array(pictures)
mean, variance = pictures.mean(0), pictures.var(0, ddof=1) / RUNS

layers = {}
for i, name in enumerate(names):
    if "." in name and not name.startswith("img."):
        layers.setdefault(name.split(".")[0], []).append(i)
data, channels = [], []
for prefix, values in (("", mean), ("variance_", variance)):
    for layer, places in layers.items():
        for suffix, place in zip({1: "Y", 2: "YA", 3: "RGB"}[len(places)], places):
            channels.append(prefix + layer + "." + suffix)
            data.append(values[:, :, place])
bitmap = mi.Bitmap(np.stack(data, -1).astype(np.float32), mi.Bitmap.PixelFormat.MultiChannel,
                   channel_names=channels)
bitmap.metadata()["renderer"] = "Mitsuba " + mi.__version__ + " " + mi.variant()
bitmap.write(str(PATH.with_suffix(".exr")))
