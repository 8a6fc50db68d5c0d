#pragma once
/// The checks of the device functions: each runs probes and compares what they give with double
/// precision on the same floats, or with what a distribution has to be.

#include "probe_device.h"

namespace clrender::selftest {

using Checks = std::vector<Check>;

/// sincos_turn, turn_of, sphere_cap, make_frame, mis_weight, sample_cosine.
Checks check_math(ProbeDevice &device);

/// The random numbers.
Checks check_numbers(ProbeDevice &device);

/// sphere_intersect, sphere_root_bits, sphere_blocks, sphere_blocks_opaque.
Checks check_spheres(ProbeDevice &device);

/// planar_intersect and planar_intersect_across.
Checks check_planars(ProbeDevice &device);

/// camera_ray: place, direction, lens and clip distances.
Checks check_camera(ProbeDevice &device);

/// The weights of the reconstruction filters, splatted and sampled.
Checks check_filters(ProbeDevice &device);

/// Texture lookups and the coordinates on a sphere.
Checks check_textures(ProbeDevice &device);

/// The environment map: lookup, density, sampling.
Checks check_environment(ProbeDevice &device);

/// Samples of every kind of light, and the density that a path finds that meets one by chance.
Checks check_lights(ProbeDevice &device);

} // namespace clrender::selftest
