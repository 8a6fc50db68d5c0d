#pragma once
/// The scene as the device gets it: arrays of shared structs, the acceleration structure,
/// the light tables, and what of it all the kernel has to know.

#include "bvh_builder.h"
#include "device/kernel_config.h"
#include "generality.h"
#include "scene/scene.h"
#include "shared/launch_data.h"
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

/// Names follow the kernel's arguments (kernels/scene.clh says what each array holds).
struct FlatScene {
    FrameData frame{};
    Placement placement;
    std::vector<Sphere> spheres;
    std::vector<SphereTest> sphere_tests;
    std::vector<Planar> planars;
    std::vector<PrimitiveRecord> records;
    Bvh bvh;
    std::vector<uint> triangles;
    std::vector<clr_real> normals;
    std::vector<clr_real> uvs;
    std::vector<uint> shape_of;
    std::vector<ShapeInfo> shapes;
    std::vector<clr_real> shape_frames;
    std::vector<Material> materials;
    std::vector<EmitterInfo> emitters;
    std::vector<Light> lights;
    std::vector<LightTriangle> light_triangles;
    std::vector<LightNode> light_nodes;
    std::vector<TextureInfo> textures;
    std::vector<uint> texels_u8;
    std::vector<clr_real> texels_f32;
    std::vector<clr_real> decode;
    std::vector<clr_real> env_texels;
    std::vector<clr_real> env_cdf;
    std::vector<uint> env_guide;
    std::vector<clr_real> filter;
    /// All but LANES, TILE, SAMPLER and PROFILE, which the render decides.
    KernelConfig config;
    std::size_t triangle_count = 0;
    /// What build_hierarchy() makes `bvh` of.
    std::vector<TriangleCorners> corners;
    std::vector<BvhSphere> bvh_spheres;

    [[nodiscard]] bool has_hierarchy() const {
        return config.HAS_TRIANGLES != 0 || config.HAS_BVH_SPHERES != 0;
    }
    [[nodiscard]] std::size_t bytes() const;
};

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
