"""Renders a scene with Blender's Cycles. usage: python -m peers.cycles_peer SCENE PREFIX SPP..."""

import os
import time

OUTPUT = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)  # what Blender prints goes to standard error

import bpy  # noqa: E402
import numpy as np  # noqa: E402

from peers import protocol  # noqa: E402
from peers.cycles_scene import Translation  # noqa: E402
from peers.scene_file import read_scene  # noqa: E402


def configure(target, scene, threads):
    """The same work as the others (depth, filter, nothing clamped, guided, adaptive or denoised),
    and what makes Cycles fastest at it: its light tree, tabulated Sobol' points, spatial splits."""
    render, cycles, view = target.render, target.cycles, target.view_settings
    render.engine, cycles.device = "CYCLES", "CPU"
    render.threads_mode, render.threads = "FIXED", threads
    render.resolution_x, render.resolution_y = scene.width, scene.height
    render.resolution_percentage = 100
    render.use_persistent_data = True
    render.use_compositing = render.use_sequencer = False
    render.use_simplify = render.use_motion_blur = False
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_guiding = False
    cycles.use_auto_tile = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    cycles.light_sampling_threshold = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1
    cycles.use_light_tree, cycles.debug_use_spatial_splits = True, True
    cycles.sampling_pattern = "TABULATED_SOBOL"
    # Mitsuba counts the segments of a path, Cycles the bounces after direct light. A path that hits
    # a light goes on behind it unless there are no transparent bounces.
    bounces = max(0, scene.max_depth - 2)
    for name in ("max", "diffuse", "glossy", "transmission"):
        setattr(cycles, "max_bounces" if name == "max" else name + "_bounces", bounces)
    cycles.volume_bounces = cycles.transparent_max_bounces = cycles.min_transparent_bounces = 0
    # Roulette ends paths after so many bounces.
    cycles.min_light_bounces = min(max(0, scene.rr_depth - 1), bounces)
    cycles.film_exposure, view.exposure, view.gamma, view.view_transform = 1, 0, 1, "Raw"
    output = render.image_settings
    output.file_format, output.color_mode, output.color_depth = "OPEN_EXR", "RGB", "32"
    output.exr_codec = "NONE"


def render(target, spp, seed):
    """Wall seconds of a render, from Blender's look at every object to the finished picture."""
    target.cycles.samples, target.cycles.seed = spp, seed
    # Persistent data keeps the sample count and the seed too, unless something is tagged; a full
    # tag would send all meshes again.
    target.update_tag(refresh={"TIME"})
    start = time.perf_counter()
    bpy.ops.render.render(write_still=False)
    return time.perf_counter() - start


def read_picture(file):
    """The float picture of a file that Blender wrote."""
    image = bpy.data.images.load(file)
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    values = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(values)
    bpy.data.images.remove(image)
    os.remove(file)
    return values.reshape(height, width, -1)[::-1, :, :3]


def main():
    arguments = protocol.arguments(__doc__)
    start = time.perf_counter()
    scene = read_scene(arguments.scene, arguments.overrides)
    target = Translation(scene).target
    configure(target, scene, arguments.threads)
    if max(arguments.spp) > 1:
        render(target, 1, 0)  # builds the trees and tables, which stay
    load = time.perf_counter() - start

    # Blender gives its floats to files only. They are read when all is rendered: an image that
    # comes and goes makes the next render send every mesh to Cycles again.
    seconds = {}
    for spp in arguments.spp:
        seconds[spp] = render(target, spp, arguments.seed * 1000 + spp)
        bpy.data.images["Render Result"].save_render(f"{arguments.prefix}_{spp}.exr", scene=target)
    for spp in arguments.spp:
        picture = read_picture(f"{arguments.prefix}_{spp}.exr")
        protocol.deliver(OUTPUT, arguments.prefix, spp, picture, seconds[spp], load)


main()
