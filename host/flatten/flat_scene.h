#pragma once
/// The scene as the device gets it: arrays of shared structs, the acceleration structure,
/// the light tables, and what else of the scene the kernel is specialised on.

#include "bvh_builder.h"
#include "config/sampling_options.h"
#include "film/hit_table.h"
#include "scene/scene.h"
#include "shared/bsdf_parameters.h"
#include "shared/instance.h"
#include "shared/launch_data.h"
#include "shared/quadric.h"
#include "shared/scene_buffers.def"
#include "shared/scene_data.h"
#include "shared/specular_connector.h"

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

/// A group's triangles among FlatScene::corners, in its own coordinates.
struct FlatGroup {
    std::size_t first = 0, count = 0;
};

/// What of a scene a kernel is specialised on and its arrays do not show (see config_of()).
struct SceneFacts {
    int sphere_count = 0;     ///< lane-wise spheres, of which
    int opaque_count = 0;     ///< the first so many are opaque and rays start outside them,
    int large_count = 0;      ///< of those the first so many as large as the scene or larger,
    int huge_count = 0;       ///< and the last so many huge against the scene beside them
    int shadowless_count = 0; ///< the last so many planars never come before a light
    int planar_axes = 0;      ///< as PLANAR_AXES
    int environment = CLR_ENVIRONMENT_NONE;
    bool has_sky = false;  ///< as HAS_SKY
    int light_samples = 1; ///< as LIGHT_SAMPLES
    int filter_border = 0; ///< pixels around its own that a sample reaches
    Strategy strategy = Strategy::mis;
    bool shows_depth = false;   ///< the depth integrator
    bool weight_window = false; ///< roulette is one, where paths are long enough
    bool hides_emitters = false;
    bool free_passages = false; ///< as FREE_PASSAGES, if there are passages
    bool has_alpha = false;
    bool has_clip = false;
    bool far_camera = false;
    double unstated_near = 0; ///< depth of Mitsuba's near clip plane, where near_clip has none
};

/// Its arrays are those of scene_buffers.def, which says what each holds.
struct FlatScene {
    FrameData frame{};
    int border = 0; ///< pixels of the frame on each side that are sampled, but not in the picture
    Placement placement;
#define CLR_BUFFER_ARRAY(type, name, meaning) std::vector<type> name;
    CLR_SCENE_BUFFERS(CLR_BUFFER_ARRAY)
#undef CLR_BUFFER_ARRAY
    SceneFacts facts;
    std::size_t triangle_count = 0;
    HitTable hits; ///< where SamplingOptions::first_hits asks for it
    /// What build_hierarchy() makes the tree of.
    std::vector<TriangleCorners> corners;
    std::vector<BvhSphere> bvh_spheres;
    std::vector<BvhQuadric> bvh_quadrics;
    /// What it makes the groups' trees of. Until then Instance::root is the index of a group.
    std::vector<FlatGroup> groups;

    /// Primitives that every ray tests.
    [[nodiscard]] std::size_t lane_wise_count() const {
        return static_cast<std::size_t>(facts.sphere_count) + planars.size();
    }
    [[nodiscard]] bool has_hierarchy() const {
        return triangle_count > 0 || has_bvh_spheres() || !bvh_quadrics.empty();
    }
    [[nodiscard]] bool has_bvh_spheres() const {
        return spheres.size() > static_cast<std::size_t>(facts.sphere_count);
    }
    /// Whether some material's shading frame follows dp/du.
    [[nodiscard]] bool has_tangents() const;
    /// Whether surfaces need coordinates: attributes of meshes do not.
    [[nodiscard]] bool needs_uvs() const;
    /// The lane-wise sphere that is the only light, or none.
    [[nodiscard]] int sole_light_sphere() const;
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

/// Flattens a parsed scene, all but the hierarchy: what the kernel has to know is known then. Warns
/// of scenes without light.
FlatScene flatten(const Scene &given, const SamplingOptions &options = {});

/// Builds the hierarchy over the triangles and spheres that need one. Warns of degenerate ones.
void build_hierarchy(FlatScene &flat);

} // namespace clrender::inline CLR_PRECISION
