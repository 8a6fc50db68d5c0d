#include "light_list.h"
#include "scene/mesh_attributes.h"
#include "shape_parts.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

namespace clrender::inline CLR_PRECISION {

namespace {

constexpr double pi = std::numbers::pi;

/// Where there is an environment map and other lights, each side gets at least this share of the
/// light samples: their powers cannot be compared where the scene has no natural bounds.
constexpr double least_share = 0.25;

/// As float32 has it. What the light tree is made of is rounded in either precision, so that both
/// have the same tree, and choose the same lights.
double in_single(clr_real value) {
    return double{static_cast<float>(value)};
}

glm::dvec3 in_single(const clr_real (&v)[3]) {
    return {in_single(v[0]), in_single(v[1]), in_single(v[2])};
}

/// Mean luminance of an attribute's values, by vertex or triangle.
double mean_luminance(const MeshAttribute &attribute, const Rgb &scale) {
    const std::size_t count = attribute.values.size() / attribute.channels;
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const float *value = &attribute.values[i * attribute.channels];
        sum += luminance(
            scale * (attribute.channels == 1 ? Rgb(value[0]) : Rgb(value[0], value[1], value[2])));
    }
    return count > 0 ? sum / static_cast<double>(count) : 0;
}

/// Mean luminance of a texture on a shape.
double mean_luminance(const Texture &texture, const Shape &shape) {
    if (texture.kind != TextureKind::attribute)
        return mean_luminance(texture);
    const MeshAttribute *attribute = find_attribute(*shape.mesh, texture.attribute);
    return attribute == nullptr ? 0 : mean_luminance(*attribute, texture.scale);
}

/// The cone of the normals by which a triangle shines: its own, or those of its vertices.
void set_cone(const LightTriangle &triangle, const glm::dvec3 &own, LightExtent &extent) {
    extent.axis = own;
    extent.cosine = 1;
    if (triangle.smooth == 0)
        return;
    glm::dvec3 sum{0.0};
    glm::dvec3 normal[3];
    for (std::size_t c = 0; c < 3; ++c) {
        normal[c] = in_single(triangle.normals[c]);
        sum += normal[c];
    }
    extent.cosine = -1;
    if (!(glm::length(sum) > 1e-3))
        return;
    extent.axis = glm::normalize(sum);
    extent.cosine = 1;
    for (const glm::dvec3 &n : normal)
        extent.cosine = std::min(extent.cosine, glm::dot(n, extent.axis));
}

LightExtent triangle_extent(const LightTriangle &triangle, const TriangleCorners &corner,
                            double radiance) {
    const glm::vec3 rounded[3] = {glm::vec3(corner[0]), glm::vec3(corner[1]), glm::vec3(corner[2])};
    const glm::dvec3 e1(rounded[1] - rounded[0]), e2(rounded[2] - rounded[0]);
    const double area = 0.5 * glm::length(glm::cross(e1, e2));
    LightExtent extent;
    extent.lower = glm::min(glm::min(rounded[0], rounded[1]), rounded[2]);
    extent.upper = glm::max(glm::max(rounded[0], rounded[1]), rounded[2]);
    extent.intensity = area * radiance;
    if (area > 0)
        set_cone(triangle, glm::normalize(glm::cross(e1, e2)), extent);
    return extent;
}

/// A surface that shines, as the functions for its kind of shape take it.
struct AreaEmitter {
    Light base{};        ///< its radiance
    double radiance = 0; ///< mean luminance
    int shape = none;    ///< index into Scene::shapes
};

/// One light for each triangle, so that its number tells the light; those of no area are never
/// chosen.
void add_triangles(Flattening &work, const AreaEmitter &emitter, EmitterInfo &info,
                   LightList &list) {
    FlatScene &flat = work.flat;
    info.kind = CLR_LIGHT_TRIANGLE;
    if (!(emitter.radiance > 0))
        return;
    const auto [first, count] = work.triangles_of_shape.at(emitter.shape);
    info.density = 1;
    info.light = list.size();
    info.first_prim = static_cast<uint>(flat.lane_wise_count() + first);
    const bool by_vertex = !flat.triangles.empty();
    for (std::size_t t = first; t < first + count; ++t) {
        const TriangleCorners &corner = flat.corners[t];
        const Vec3 e1 = corner[1] - corner[0];
        const Vec3 e2 = corner[2] - corner[0];
        LightTriangle triangle{};
        triangle.triangle = static_cast<uint>(t);
        store(triangle.v0, glm::dvec3(corner[0]));
        store(triangle.e1, glm::dvec3(e1));
        store(triangle.e2, glm::dvec3(e2));
        triangle.uvs[1][0] = triangle.uvs[2][1] = 1;
        for (std::size_t c = 0; by_vertex && c < 3; ++c) {
            const std::size_t vertex = flat.triangles[3 * t + c];
            if (!flat.normals.empty() && !std::isnan(flat.normals[3 * vertex])) {
                triangle.smooth = 1;
                std::copy_n(&flat.normals[3 * vertex], 3, triangle.normals[c]);
            }
            if (!flat.uvs.empty() && !std::isnan(flat.uvs[2 * vertex]))
                std::copy_n(&flat.uvs[2 * vertex], 2, triangle.uvs[c]);
        }
        const double area = 0.5 * glm::length(glm::cross(glm::dvec3(e1), glm::dvec3(e2)));
        Light light = emitter.base;
        light.kind = CLR_LIGHT_TRIANGLE;
        light.prim = static_cast<uint>(flat.light_triangles.size());
        light.area = static_cast<clr_real>(area);
        flat.light_triangles.push_back(triangle);
        list.add(light, triangle_extent(triangle, corner, emitter.radiance));
    }
}

/// The sphere's own entry, whether it is tested lane-wise or lies in the BVH.
void add_sphere(const Flattening &work, const AreaEmitter &emitter, EmitterInfo &info,
                LightList &list) {
    const FlatScene &flat = work.flat;
    const uint bvh_sphere = flat.frame.prim_bvh_sphere;
    const auto lane_wise = static_cast<uint>(flat.facts.sphere_count);
    Light light = emitter.base;
    light.prim = info.first_prim = work.primitive_of_shape.at(emitter.shape);
    info.light = list.size();
    const Sphere &sphere =
        flat.spheres[light.prim < bvh_sphere ? light.prim : light.prim - bvh_sphere + lane_wise];
    light.shape = light.prim < bvh_sphere
                      ? light.prim
                      : flat.shape_of[light.prim - lane_wise - flat.planars.size()];
    info.kind = light.kind = CLR_LIGHT_SPHERE;
    std::copy_n(sphere.center, 3, light.position);
    std::copy_n(sphere.center, 3, info.center);
    light.radius = info.radius = sphere.radius;
    // A sphere that shines inwards is met by chance only: nothing outside sees it.
    if (!(sphere.radius > 0) || !(emitter.radiance > 0))
        return;
    info.density = 1;
    const glm::dvec3 center = in_single(sphere.center);
    const double radius = in_single(sphere.radius);
    list.add(
        light,
        {center - radius, center + radius, {0, 0, 1}, -1, pi * radius * radius * emitter.radiance});
}

void add_planar(const Flattening &work, const AreaEmitter &emitter, EmitterInfo &info,
                LightList &list) {
    const FlatScene &flat = work.flat;
    Light light = emitter.base;
    info.first_prim = work.primitive_of_shape.at(emitter.shape);
    info.light = list.size();
    light.prim = info.first_prim - static_cast<uint>(flat.facts.sphere_count);
    info.kind = light.kind = CLR_LIGHT_PLANAR;
    const Planar &planar = flat.planars[light.prim];
    light.area = planar.area;
    if (!(emitter.radiance > 0) || !(planar.area > 0))
        return;
    info.density = 1 / planar.area;
    LightExtent extent;
    for (int c = 0; c < 3; ++c) {
        const double reach = std::abs(in_single(planar.du[c])) + std::abs(in_single(planar.dv[c]));
        extent.lower[c] = in_single(planar.origin[c]) - reach;
        extent.upper[c] = in_single(planar.origin[c]) + reach;
        extent.axis[c] = in_single(planar.normal[c]);
    }
    extent.cosine = 1;
    extent.intensity = in_single(light.area) * emitter.radiance;
    list.add(light, extent);
}

/// An ellipsoid, a cylinder or a disk of the BVH.
void add_quadric(const Flattening &work, const AreaEmitter &emitter, EmitterInfo &info,
                 LightList &list) {
    const FlatScene &flat = work.flat;
    Light light = emitter.base;
    light.prim = info.first_prim = work.primitive_of_shape.at(emitter.shape);
    info.light = list.size();
    info.kind = light.kind = CLR_LIGHT_QUADRIC;
    const Quadric &q = flat.quadrics[light.prim - flat.frame.prim_quadric];
    const QuadricExtent extent = quadric_extent(q);
    // An ellipsoid that shines inwards is met by chance only: nothing outside sees it.
    if (!(emitter.radiance > 0) || (q.kind == CLR_QUADRIC_ELLIPSOID && q.orientation < 0))
        return;
    info.density = 1;
    const glm::dvec3 center = in_single(q.center);
    LightExtent bounds{center - extent.half,
                       center + extent.half,
                       {0, 0, 1},
                       -1,
                       extent.projected_area * emitter.radiance};
    if (q.kind == CLR_QUADRIC_DISK) {
        bounds.axis = glm::normalize(in_single(q.z)) * in_single(q.orientation);
        bounds.cosine = 1;
    }
    list.add(light, bounds);
}

void add_area(Flattening &work, std::size_t index, LightList &list) {
    const Emitter &source = work.scene.emitters[index];
    EmitterInfo &info = work.flat.emitters[index];
    AreaEmitter emitter;
    emitter.shape = source.shape;
    emitter.radiance =
        mean_luminance(work.scene.textures[static_cast<std::size_t>(source.radiance)],
                       work.scene.shapes[static_cast<std::size_t>(source.shape)]);
    info.texture = emitter.base.texture =
        flatten_texture(work, source.radiance, Rgb{0.0}, info.radiance);
    std::copy_n(info.radiance, 3, emitter.base.radiance);
    switch (test_of(work.scene.shapes[static_cast<std::size_t>(source.shape)], work)) {
    case ShapeTest::sphere:
    case ShapeTest::bvh_sphere:
        add_sphere(work, emitter, info, list);
        break;
    case ShapeTest::planar:
        add_planar(work, emitter, info, list);
        break;
    case ShapeTest::quadric:
        add_quadric(work, emitter, info, list);
        break;
    case ShapeTest::triangles:
        add_triangles(work, emitter, info, list);
        break;
    }
}

/// The share of the samples that a map gets beside other lights: by the irradiance of either at the
/// middle of the scene, which is about two units across.
double environment_share(const std::vector<LightExtent> &extents, double power) {
    double others = 0;
    for (const LightExtent &extent : extents)
        others += extent.is_distant ? extent.intensity : pi * extent.intensity;
    return extents.empty()
               ? 1
               : std::clamp(pi * power / (pi * power + others), least_share, 1 - least_share);
}

/// The distance from any point of a light within which a sphere cannot come between: a line that
/// meets the sphere leaves it no nearer than the point where a tangent would touch it, for the
/// product of the distances of entry and exit is the tangent's square. 0 for no such distance.
double shadow_free_distance(const LightExtent &light, const Sphere &sphere) {
    const glm::dvec3 center(sphere.center[0], sphere.center[1], sphere.center[2]);
    const double reach = glm::length(light.upper - light.lower) / 2;
    const double nearest = glm::length((light.lower + light.upper) * 0.5 - center) - reach;
    const double tangent2 = nearest * nearest - double{sphere.radius} * sphere.radius;
    constexpr double margin = 0.999;
    return nearest > 0 && tangent2 > 0 ? margin * std::sqrt(tangent2) : 0;
}

/// What is simpler where there is one light: it needs no walk to tell its density, it is never in
/// its own way, and large spheres may be shown never to be.
void set_sole_light(const LightExtent &extent, FlatScene &flat) {
    Light &sole = flat.lights.front();
    if (sole.kind == CLR_LIGHT_PLANAR || sole.kind == CLR_LIGHT_TRIANGLE ||
        sole.kind == CLR_LIGHT_QUADRIC)
        store(sole.position, (extent.lower + extent.upper) * 0.5);
    const glm::dvec3 diagonal = extent.upper - extent.lower;
    flat.frame.final_distance2 = static_cast<clr_real>(glm::dot(diagonal, diagonal));
    if (sole.kind == CLR_LIGHT_TRIANGLE)
        for (EmitterInfo &info : flat.emitters)
            info.density = info.density > 0 ? 1 / sole.area : 0.0f;
    if (flat.facts.environment == CLR_ENVIRONMENT_MAP || flat.has_bvh_spheres() ||
        extent.is_distant)
        return;
    double distance = INFINITY;
    for (int i = 0; i < flat.facts.large_count; ++i)
        if (i != flat.sole_light_sphere())
            distance = std::min(
                distance, shadow_free_distance(extent, flat.spheres[static_cast<std::size_t>(i)]));
    flat.frame.shadow_free_distance = static_cast<clr_real>(distance);
}

/// How many lights to sample where a path first meets a diffuse surface. A second one costs a tenth
/// to a fifth of a path. It pays where light sampling is what makes most of the noise: with several
/// lights to choose from, and under a sky, where paths are short, in the penumbrae of a broad
/// light.
int light_samples(const Flattening &work, const LightList &list) {
    if (work.options.light_samples > 0)
        return work.options.light_samples;
    const uint choices = list.size() + (work.flat.facts.environment == CLR_ENVIRONMENT_MAP ? 1 : 0);
    const Integrator &integrator = work.scene.integrator;
    if (integrator.kind == IntegratorKind::depth || choices == 0)
        return 1;
    constexpr unsigned most = 16;
    if (integrator.kind == IntegratorKind::direct && integrator.emitter_samples > 1)
        return static_cast<int>(
            std::bit_floor(std::min(static_cast<unsigned>(integrator.emitter_samples), most)));
    if (choices > 1)
        return 2;
    if (list.size() == 0)
        return 1;
    // The scene is placed so that what the camera looks at lies around the origin.
    constexpr double broad = 0.4;
    const LightExtent &sole = list.extents.front();
    const double size = glm::length(sole.upper - sole.lower);
    const double distance = glm::length((sole.lower + sole.upper) * 0.5);
    return work.flat.facts.environment != CLR_ENVIRONMENT_NONE && size > broad * distance ? 2 : 1;
}

} // namespace

double luminance(const Rgb &c) {
    return glm::dot(c, Rgb{0.212671, 0.715160, 0.072169});
}

double mean_luminance(const Texture &texture) {
    if (texture.kind == TextureKind::constant)
        return luminance(texture.value);
    if (texture.kind == TextureKind::checkerboard)
        return (luminance(texture.color0) + luminance(texture.color1)) / 2;
    const Image &image = *texture.bitmap;
    const std::size_t count =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i)
        sum += luminance(texture.scale * texel_color(image, i, texture.format));
    return sum / static_cast<double>(count);
}

void flatten_lights(Flattening &work) {
    FlatScene &flat = work.flat;
    flat.emitters.resize(work.is_black() ? 0 : work.scene.emitters.size());
    LightList list;
    double map_power = 0;
    for (std::size_t i = 0; i < flat.emitters.size(); ++i) {
        const Emitter &emitter = work.scene.emitters[i];
        switch (emitter.kind) {
        case EmitterKind::point:
            add_point(work, emitter, list);
            break;
        case EmitterKind::spot:
            add_spot(work, emitter, list);
            break;
        case EmitterKind::projector:
            add_projector(work, emitter, list);
            break;
        case EmitterKind::directional:
            add_directional(emitter, list);
            break;
        case EmitterKind::area:
            add_area(work, i, list);
            break;
        case EmitterKind::constant:
        case EmitterKind::envmap:
            flatten_environment(work, emitter, &map_power);
            break;
        case EmitterKind::sunsky:
            flatten_sunsky(work, emitter, list, &map_power);
            break;
        }
    }
    if (flat.facts.environment == CLR_ENVIRONMENT_MAP)
        flat.frame.env_probability =
            static_cast<clr_real>(environment_share(list.extents, map_power));
    flat.facts.light_samples = light_samples(work, list);
    // A tree needs two lights; those without light are never chosen.
    while (work.wants("LIGHT_COUNT") && list.size() < 2)
        list.add({}, {});
    flat.lights = list.lights;
    if (flat.lights.size() > 1) {
        LightTree tree = build_light_tree(list.extents);
        for (std::size_t i = 0; i < flat.lights.size(); ++i)
            flat.lights[i].trail = tree.trail[i];
        flat.light_nodes = std::move(tree.nodes);
    } else if (flat.lights.size() == 1) {
        set_sole_light(list.extents.front(), flat);
    }
}

} // namespace clrender::inline CLR_PRECISION
