#pragma once
/// The scene as the device gets it: arrays of shared structs, the acceleration structure,
/// the light tables, and what of it all the kernel has to know.

#include "bvh_builder.h"
#include "device/kernel_config.h"
#include "generality.h"
#include "scene/scene.h"
#include "shared/bsdf_parameters.h"
#include "shared/launch_data.h"
#include "shared/scene_buffers.def"
#include "shared/scene_data.h"

#include <array>
#include <cstddef>
#include <vector>

namespace clrender::inline CLR_PRECISION {

/// From scene coordinates to the renderer's: p' = (p - center) * scale, scale a power of two, so
/// that most of what is small lies within a unit of the origin, see choose_placement().
struct Placement {
    glm::dvec3 center{0.0};
    double scale = 1;

    [[nodiscard]] glm::dvec3 exact(const glm::dvec3 &p) const { return (p - center) * scale; }
    [[nodiscard]] Vec3 apply(const glm::dvec3 &p) const { return Vec3(exact(p)); }
};

/// The three corners of a triangle in the renderer's coordinates, front side anticlockwise.
using TriangleCorners = std::array<Vec3, 3>;

/// Its arrays are those of scene_buffers.def, which says what each holds.
struct FlatScene {
    FrameData frame{};
    Placement placement;
#define CLR_BUFFER_ARRAY(type, name, meaning) std::vector<type> name;
    CLR_SCENE_BUFFERS(CLR_BUFFER_ARRAY)
#undef CLR_BUFFER_ARRAY
    /// All but LANES, TILE, SAMPLER and PROFILE, which the render decides.
    KernelConfig config;
    std::size_t triangle_count = 0;
    /// What build_hierarchy() makes the tree of.
    std::vector<TriangleCorners> corners;
    std::vector<BvhSphere> bvh_spheres;

    [[nodiscard]] bool has_hierarchy() const {
        return config.HAS_TRIANGLES != 0 || config.HAS_BVH_SPHERES != 0;
    }
    [[nodiscard]] std::size_t bytes() const;
};

/// Calls `take` with each array of a scene, in the order of the kernels' arguments.
template <class Flat, class Take> void for_each_array(Flat &flat, Take take) {
#define CLR_BUFFER_TAKE(type, name, meaning) take(flat.name);
    CLR_SCENE_BUFFERS(CLR_BUFFER_TAKE)
#undef CLR_BUFFER_TAKE
}

/// Bytes of an array's elements.
template <class T> std::size_t bytes_of(const std::vector<T> &array) {
    return array.size() * sizeof(T);
}

/// What the command line says of the picture.
struct FlattenOptions {
    bool brute_force = false;   ///< --accel none
    bool pixel_centers = false; ///< all samples at pixel centres
    bool splat_filters = true;  ///< samples serve all pixels that the filter reaches, where it is
                                ///< not too wide; else the filter is sampled
    Strategy strategy = Strategy::mis;
    int light_samples = 0;   ///< as LIGHT_SAMPLES in kernel_config.def; 0: chosen
    Generality generality{}; ///< what the kernel is to be able to do beyond the scene
};

/// Flattens a parsed scene, all but the hierarchy: what the kernel has to know is known then. Warns
/// of scenes without light.
FlatScene flatten(const Scene &scene, const FlattenOptions &options = {});

/// Builds the hierarchy over the triangles and spheres that need one. Warns of degenerate ones.
void build_hierarchy(FlatScene &flat);

} // namespace clrender::inline CLR_PRECISION
