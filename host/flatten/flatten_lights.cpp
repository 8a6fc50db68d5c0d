#include "alias_table.h"
#include "flatten_parts.h"
#include "log.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace clrender {

namespace {

constexpr double pi = std::numbers::pi;

/// Where there is an environment map and other lights, each side gets at least this share of the
/// light samples: their powers cannot be compared where the scene has no natural bounds.
constexpr double least_share = 0.25;

void store(float (&out)[3], const glm::dvec3 &v) {
    out[0] = static_cast<float>(v.x);
    out[1] = static_cast<float>(v.y);
    out[2] = static_cast<float>(v.z);
}

/// Mean luminance of a texture; of a bitmap's texels, which may be off by what a mesh shows of it.
double mean_luminance(const Texture &texture) {
    if (texture.kind == TextureKind::constant)
        return luminance(texture.value);
    if (texture.kind == TextureKind::checkerboard)
        return (luminance(texture.color0) + luminance(texture.color1)) / 2;
    const Image &image = *texture.bitmap;
    const auto channels = static_cast<std::size_t>(image.channels);
    const std::size_t count =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        Rgb c;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t at = i * channels + (channels >= 3 ? k : 0);
            c[static_cast<int>(k)] = image.type == PixelType::f32 ? image.f32[at]
                                     : texture.raw                ? image.u8[at] / 255.0
                                                   : srgb_decode(image.u8[at] / 255.0);
        }
        sum += luminance(c);
    }
    return sum / static_cast<double>(count);
}

/// The lights found so far, and what each emits.
struct LightList {
    std::vector<Light> lights;
    std::vector<double> power;
    std::vector<std::size_t> emitter; ///< by Scene::emitters

    void add(const Light &light, double watts, std::size_t of) {
        if (!(watts > 0))
            return;
        lights.push_back(light);
        power.push_back(watts);
        emitter.push_back(of);
    }
};

void add_point(const Flattening &work, std::size_t index, LightList &list) {
    const Emitter &emitter = work.scene.emitters[index];
    const double unit = work.flat.placement.scale;
    Light light{};
    light.kind = CLR_LIGHT_POINT;
    light.texture = CLR_NONE;
    store(light.position, glm::dvec3(work.flat.placement.apply(emitter.position)));
    store(light.radiance, emitter.intensity * unit * unit);
    list.add(light, 4 * pi * luminance(emitter.intensity) * unit * unit, index);
}

/// One light for each triangle, by its area.
void add_mesh(Flattening &work, std::size_t index, const Light &base, double radiance,
              LightList &list) {
    FlatScene &flat = work.flat;
    const Emitter &emitter = work.scene.emitters[index];
    const Shape &shape = work.scene.shapes[static_cast<std::size_t>(emitter.shape)];
    const std::size_t first = work.first_triangle_of_shape.at(emitter.shape);
    const std::size_t count = shape.kind == ShapeKind::mesh ? shape.mesh->triangles.size() : 2;
    const bool by_vertex = !flat.triangles.empty();
    for (std::size_t t = first; t < first + count; ++t) {
        const TriangleCorners &corner = work.corners[t];
        const glm::vec3 e1 = corner[1] - corner[0];
        const glm::vec3 e2 = corner[2] - corner[0];
        LightTriangle triangle{};
        store(triangle.v0, glm::dvec3(corner[0]));
        store(triangle.e1, glm::dvec3(e1));
        store(triangle.e2, glm::dvec3(e2));
        const float default_uvs[6] = {0, 0, 1, 0, 0, 1};
        std::copy(default_uvs, default_uvs + 6, triangle.uvs);
        for (std::size_t c = 0; by_vertex && c < 3; ++c) {
            const std::size_t vertex = flat.triangles[3 * t + c];
            if (!flat.normals.empty() && !std::isnan(flat.normals[3 * vertex])) {
                triangle.smooth = 1;
                std::copy_n(&flat.normals[3 * vertex], 3, &triangle.normals[3 * c]);
            }
            if (!flat.uvs.empty() && !std::isnan(flat.uvs[2 * vertex]))
                std::copy_n(&flat.uvs[2 * vertex], 2, &triangle.uvs[2 * c]);
        }
        const double area = 0.5 * glm::length(glm::cross(glm::dvec3(e1), glm::dvec3(e2)));
        Light light = base;
        light.kind = CLR_LIGHT_TRIANGLE;
        light.prim = static_cast<uint>(flat.light_triangles.size());
        light.area = static_cast<float>(area);
        if (area * radiance > 0)
            flat.light_triangles.push_back(triangle);
        list.add(light, pi * area * radiance, index);
    }
}

void add_area(Flattening &work, std::size_t index, LightList &list) {
    FlatScene &flat = work.flat;
    const Emitter &emitter = work.scene.emitters[index];
    const Texture &texture = work.scene.textures[static_cast<std::size_t>(emitter.radiance)];
    const double radiance = mean_luminance(texture);
    flat.config.HAS_AREA_EMITTERS = 1;
    Light light{};
    light.texture = flatten_texture(work, emitter.radiance, Rgb{0.0}, light.radiance);
    EmitterInfo &info = flat.emitters[index];
    std::copy_n(light.radiance, 3, info.radiance);
    info.texture = light.texture;

    const auto found = work.primitive_of_shape.find(emitter.shape);
    if (found == work.primitive_of_shape.end()) {
        info.kind = CLR_LIGHT_TRIANGLE;
        add_mesh(work, index, light, radiance, list);
        return;
    }
    light.prim = found->second;
    if (work.scene.shapes[static_cast<std::size_t>(emitter.shape)].kind == ShapeKind::sphere) {
        // The sphere's own entry, whether it is tested lane-wise or lies in the BVH.
        const uint bvh_sphere = flat.frame.prim_bvh_sphere;
        const Sphere &sphere =
            flat.spheres[light.prim < bvh_sphere ? light.prim : light.prim - bvh_sphere];
        light.shape =
            light.prim < bvh_sphere ? light.prim : flat.shape_of[light.prim - flat.planars.size()];
        info.kind = light.kind = CLR_LIGHT_SPHERE;
        std::copy_n(sphere.center, 3, light.position);
        std::copy_n(sphere.center, 3, info.center);
        light.area = info.radius = sphere.radius;
        // A sphere that shines inwards is met by chance only: nothing outside sees it.
        if (sphere.radius > 0)
            list.add(light, 4 * pi * pi * sphere.radius * sphere.radius * radiance, index);
        return;
    }
    light.prim -= static_cast<uint>(flat.config.SPHERE_COUNT);
    info.kind = light.kind = CLR_LIGHT_PLANAR;
    light.area = flat.planars[light.prim].area;
    list.add(light, pi * light.area * radiance, index);
}

/// Probabilities in proportion to power, the environment's share held within bounds.
std::vector<double> choose_probabilities(const LightList &list) {
    std::vector<double> probability = list.power;
    const double total = std::accumulate(probability.begin(), probability.end(), 0.0);
    for (double &p : probability)
        p /= total;
    for (std::size_t i = 0; i < probability.size(); ++i)
        if (list.lights[i].kind == CLR_LIGHT_ENVIRONMENT && probability.size() > 1) {
            const double share = std::clamp(probability[i], least_share, 1 - least_share);
            const double others = (1 - share) / std::max(1 - probability[i], 1e-30);
            for (double &p : probability)
                p *= others;
            probability[i] = share;
            break;
        }
    return probability;
}

void add_environment(Flattening &work, std::size_t index, LightList &list) {
    double power = 0;
    flatten_environment(work, work.scene.emitters[index], &power);
    if (work.flat.config.ENVIRONMENT != 2)
        return;
    Light light{};
    light.kind = CLR_LIGHT_ENVIRONMENT;
    light.texture = CLR_NONE;
    // The scene is about two units across.
    list.add(light, pi * power, index);
}

} // namespace

double luminance(const Rgb &c) {
    return glm::dot(c, Rgb{0.212671, 0.715160, 0.072169});
}

void flatten_lights(Flattening &work) {
    FlatScene &flat = work.flat;
    flat.emitters.resize(work.scene.emitters.size());
    LightList list;
    for (std::size_t i = 0; i < work.scene.emitters.size(); ++i) {
        switch (work.scene.emitters[i].kind) {
        case EmitterKind::point:
            add_point(work, i, list);
            break;
        case EmitterKind::area:
            add_area(work, i, list);
            break;
        case EmitterKind::constant:
        case EmitterKind::envmap:
            add_environment(work, i, list);
            break;
        }
    }
    if (work.scene.emitters.empty() && work.scene.integrator.kind != IntegratorKind::depth)
        log::warn("the scene has no light: the picture will be black");

    // What light sampling would have given is left with the emitters, for multiple importance
    // sampling.
    const std::vector<double> probability = choose_probabilities(list);
    for (std::size_t i = 0; i < list.lights.size(); ++i) {
        Light &light = list.lights[i];
        light.inv_probability = static_cast<float>(1 / probability[i]);
        const auto chosen = static_cast<float>(probability[i]);
        EmitterInfo &info = flat.emitters[list.emitter[i]];
        if (light.kind == CLR_LIGHT_SPHERE)
            info.density = chosen;
        else if (light.kind == CLR_LIGHT_ENVIRONMENT)
            flat.frame.env_probability = chosen;
        else if (light.kind != CLR_LIGHT_POINT)
            info.density = static_cast<float>(probability[i] / light.area);
    }
    for (const Light &light : list.lights) {
        flat.config.HAS_POINT_LIGHTS |= light.kind == CLR_LIGHT_POINT ? 1 : 0;
        flat.config.HAS_SPHERE_LIGHTS |= light.kind == CLR_LIGHT_SPHERE ? 1 : 0;
        flat.config.HAS_PLANAR_LIGHTS |= light.kind == CLR_LIGHT_PLANAR ? 1 : 0;
        flat.config.HAS_TRIANGLE_LIGHTS |= light.kind == CLR_LIGHT_TRIANGLE ? 1 : 0;
    }
    flat.lights = list.lights;
    flat.frame.light_count = static_cast<uint>(flat.lights.size());
    if (!flat.lights.empty()) {
        flat.light_alias = build_alias_table(probability);
        flat.config.LIGHT_COUNT = flat.lights.size() == 1 ? 1 : -1;
        const Light &first = flat.lights.front();
        if (flat.lights.size() == 1 && first.kind == CLR_LIGHT_SPHERE &&
            flat.config.HAS_BVH_SPHERES == 0)
            flat.config.SOLE_LIGHT_SPHERE = static_cast<int>(first.prim);
    }
}

} // namespace clrender
