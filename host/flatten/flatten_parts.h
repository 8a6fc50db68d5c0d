#pragma once
/// The steps of flatten(), in their order, and what they tell each other.

#include "cuboids.h"
#include "flat_scene.h"
#include "scene/shape_bounds.h"

#include <map>
#include <string>

namespace clrender::inline CLR_PRECISION {

struct LightList;

/// Some of FlatScene::corners, one after the other.
struct TriangleRange {
    std::size_t first = 0, count = 0;
};

/// A flat scene in the making: how the scene's numbers map to the flat one's.
struct Flattening {
    const Scene &scene;
    const SamplingOptions &options;
    FlatScene flat{};
    std::vector<Box> boxes{};                      ///< by Scene::shapes, in world coordinates
    std::vector<Box> instance_boxes{};             ///< by Scene::instances, likewise
    std::vector<CuboidFaces> cuboids{};            ///< tested as such, not face by face
    std::map<int, uint> texture_index{};           ///< by Scene::textures
    std::map<std::string, uint> attribute_index{}; ///< by name, of those that shapes show
    std::map<int, uint> sides_of_bsdf{};           ///< by Scene::bsdfs, as ShapeInfo::materials
    std::map<int, uint> primitive_of_shape{};      ///< by Scene::shapes, spheres and planars
    std::vector<int> lane_wise_shapes{}; ///< Scene::shapes by lane-wise primitive, or none
    std::map<int, TriangleRange> triangles_of_shape{}; ///< by Scene::shapes, meshes
    std::size_t vertex_count = 0;
    bool vertex_normals = false;    ///< some mesh has them, so all have the arrays
    bool spheres_in_bvh = false;    ///< there are too many to test them one by one
    bool rectangles_in_bvh = false; ///< likewise, with the disks; as triangles
    bool disks_in_bvh = false;      ///< likewise, as quadrics

    /// Whether the kernel is to be able to do it, needed or not (a name of kernel_config.def).
    [[nodiscard]] bool wants(const char *name) const {
        return is_forced(options.forced_features, name);
    }
    /// Whether paths have no edges, which bring nothing: not even what shines at the camera.
    [[nodiscard]] bool is_black() const {
        return scene.integrator.kind == IntegratorKind::path && scene.integrator.max_depth == 0;
    }
    /// Whether surfaces need coordinates; asked when all textures are flattened.
    [[nodiscard]] bool needs_uvs() const {
        return flat.needs_uvs() || wants("HAS_UVS") || options.first_hits;
    }
};

/// Where the scene is put: the origin is the median of the places of its shapes, weighted by the
/// inverse of their sizes, and the unit is their median distance from it. Neither depends on the
/// camera, nor do they move for something that is far away or huge.
/// `boxes` are those of the scene's shapes, `instance_boxes` those of its instances.
Placement choose_placement(const Scene &scene, const std::vector<Box> &boxes,
                           const std::vector<Box> &instance_boxes);

/// Fills attribute_index.
void number_attributes(Flattening &work);

/// Materials and textures of the BSDFs that shapes use; fills sides_of_bsdf.
void flatten_materials(Flattening &work);

/// What differs between the dielectrics among these: CLR_SHADES_TINTS, CLR_SHADES_INDICES or both.
int dielectric_shades(const std::vector<Material> &materials);

/// Index of a texture in the flat scene; CLR_NONE for a constant one and for none, whose colour
/// (`absent` for none) goes to constant[0..2].
uint flatten_texture(Flattening &work, int texture, Rgb absent, clr_real *constant);

/// Spheres, planars, meshes, quadrics and the BVH; shape infos name emitters by Scene's index.
void flatten_shapes(Flattening &work);

/// The meshes of groups, behind those of the scene, and the places of their instances.
void flatten_instances(Flattening &work);

/// The lights to sample, the emitters to meet.
void flatten_lights(Flattening &work);

/// The alpha of camera rays that leave the scene for an environment.
clr_real environment_alpha(const Integrator &integrator);

/// The ways of light over mirrors and through glass; asked when all else is flattened.
void flatten_specular_connectors(Flattening &work);

/// The environment: a constant one, or a map with its table, of which only the probability of its
/// light is left to fill. `power` becomes the integral over all directions of the luminance that
/// light sampling goes by, and is left alone without a map.
void flatten_environment(Flattening &work, const Emitter &emitter, double *power);

/// The sky of `sunsky`, by which light sampling chooses as by a map, and its sun, which is one of
/// the lights. `power` as for flatten_environment().
void flatten_sunsky(Flattening &work, const Emitter &emitter, LightList &list, double *power);

/// The largest channel of a sky, to a few per cent.
double largest_sky_radiance(const SunSky &sunsky);

/// The distributions of light sampling over the texels of a map.
/// Returns the integral over all directions of the luminance that is sampled; 0 for a black map.
double build_map_cells(FlatScene &flat, bool alone);

/// The map of a constant environment, or of none, that light sampling never chooses: for kernels
/// that are forced to have one. Not where light sampling alone counts, for which a map and a
/// constant environment mean different things.
void make_environment_map(FlatScene &flat);

/// The option, where the scene's integrator does not say otherwise.
Strategy strategy_of(const Flattening &work);

/// Camera, film and the bounds of the bounce loop.
void flatten_camera(Flattening &work);

/// Half the extent of the image plane at distance 1, along x and y; `aspect` is width over height.
glm::dvec2 image_plane_half_size(double fov, FovAxis axis, double aspect);

/// The film's unit of colour (FrameData::film_exponent): the power of two above the largest
/// radiance that a light of the scene gives, so that a film that is brighter by a power of two has
/// the same bits. One of depths is a distance that scenes seldom reach.
int film_exponent(const Scene &scene, const Placement &placement);

/// Relative luminance of linear sRGB (Rec. 709).
double luminance(const Rgb &c);

} // namespace clrender::inline CLR_PRECISION
