#include "flatten_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Every vertex weighs all connectors against each other; more than these are not worth their time.
constexpr std::size_t most_connectors = 24;
/// A sphere that hardly refracts focuses nothing.
constexpr double least_eta = 1.001;

glm::dvec3 vec(const clr_real (&v)[3]) {
    return {v[0], v[1], v[2]};
}

double average(const clr_real (&color)[3]) {
    return luminance(vec(color));
}

/// A light as the connectors see it.
struct ConnectedLight {
    uint index = 0; ///< into FlatScene::lights
    uint prim = 0;
    glm::dvec3 middle{0.0};
    glm::dvec3 normal{0.0}; ///< of a planar, else 0
    double area = 0;        ///< as it is seen from afar, in front
    double radiance = 0;

    /// Radiance times the area that is seen from a point.
    [[nodiscard]] double intensity_towards(const glm::dvec3 &point) const {
        if (normal == glm::dvec3(0.0))
            return radiance * area;
        const double cosine = glm::dot(glm::normalize(point - middle), normal);
        return radiance * area * std::max(cosine, 0.0);
    }
};

/// The lights that have a shape of their own, without textures; meshes are too many lights each.
std::vector<ConnectedLight> connected_lights(const FlatScene &flat) {
    std::vector<ConnectedLight> lights;
    for (std::size_t i = 0; i < flat.lights.size(); ++i) {
        const Light &light = flat.lights[i];
        if (light.texture != CLR_NONE)
            continue;
        ConnectedLight found;
        found.index = static_cast<uint>(i);
        found.radiance = average(light.radiance);
        if (light.kind == CLR_LIGHT_SPHERE) {
            found.prim = static_cast<uint>(light.prim);
            found.middle = vec(light.position);
            found.area = std::numbers::pi * light.radius * light.radius;
        } else if (light.kind == CLR_LIGHT_PLANAR) {
            const Planar &planar = flat.planars[light.prim];
            found.prim = static_cast<uint>(light.prim) + static_cast<uint>(flat.facts.sphere_count);
            found.middle = vec(planar.origin);
            found.normal = vec(planar.normal);
            found.area = planar.area;
        }
        if (found.radiance * found.area > 0)
            lights.push_back(found);
    }
    return lights;
}

/// Whether a material is smooth, and the same all over the surface.
bool is_specular(const FlatScene &flat, uint material) {
    if (material == CLR_NO_MATERIAL)
        return false;
    const Material &m = flat.materials[material];
    const uint kind = m.kind & CLR_BSDF_KIND_MASK;
    return (kind == CLR_BSDF_MIRROR || kind == CLR_BSDF_CONDUCTOR || kind == CLR_BSDF_DIELECTRIC) &&
           m.texture == CLR_NONE && (kind != CLR_BSDF_DIELECTRIC || m.texture2 == CLR_NONE);
}

/// What the surface leaves of the light.
SpecularConnector base_connector(const FlatScene &flat, std::size_t prim, uint material) {
    const Material &m = flat.materials[material];
    SpecularConnector c{};
    c.prim = static_cast<uint>(prim);
    std::copy_n(m.color, 3, c.color);
    c.material = m.kind == CLR_BSDF_CONDUCTOR ? material : CLR_NONE;
    if (m.kind == CLR_BSDF_DIELECTRIC)
        c.inv_eta = m.eta[1];
    return c;
}

void add_sphere(const FlatScene &flat, std::size_t prim, const ConnectedLight &light,
                std::vector<SpecularConnector> &out) {
    const Sphere &sphere = flat.spheres[prim];
    const uint front = flat.shapes[prim].materials & CLR_NO_MATERIAL;
    const glm::dvec3 center = vec(sphere.center);
    const double distance = glm::length(light.middle - center);
    if (!(sphere.radius > 0) || !is_specular(flat, front) || light.prim == prim ||
        !(distance > sphere.radius))
        return;
    SpecularConnector c = base_connector(flat, prim, front);
    store(c.place, center);
    c.size = sphere.radius;
    c.light = light.index;
    store(c.toward, (light.middle - center) / distance);
    // The image of the light in a ball is as bright as the light, and that of one half the radius
    // away. A planar that turns its back on the centre may still shine on the sphere.
    const double irradiance = light.intensity_towards(center) / (distance * distance);
    const double image = irradiance * sphere.radius * sphere.radius / 4;
    const Material &m = flat.materials[front];
    const bool glass = m.kind == CLR_BSDF_DIELECTRIC;
    constexpr double reflected_by_glass = 0.08, passed_by_glass = 0.85, focus = 4;
    c.kind = CLR_CONNECT_REFLECTION;
    c.weight = static_cast<clr_real>(image * average(m.color) * (glass ? reflected_by_glass : 1));
    if (c.weight > 0)
        out.push_back(c);
    const uint back = flat.shapes[prim].materials >> 16;
    if (!glass || back != front || !(m.eta[0] > least_eta))
        return;
    c.kind = CLR_CONNECT_REFRACTION;
    c.weight = static_cast<clr_real>(image * focus * average(m.color2) * passed_by_glass);
    for (int k = 0; k < 3; ++k)
        c.color[k] = m.color2[k] * m.color2[k];
    if (c.weight > 0)
        out.push_back(c);
}

void add_plane(const FlatScene &flat, std::size_t prim, bool back, const ConnectedLight &light,
               std::vector<SpecularConnector> &out) {
    const Planar &planar = flat.planars[prim - static_cast<std::size_t>(flat.facts.sphere_count)];
    const uint sides = flat.shapes[prim].materials;
    const uint material = back ? sides >> 16 : sides & CLR_NO_MATERIAL;
    if (!(planar.area > 0) || !is_specular(flat, material) || light.prim == prim ||
        flat.materials[material].kind == CLR_BSDF_DIELECTRIC)
        return;
    const double sign = back ? -1 : 1;
    const glm::dvec3 normal = vec(planar.normal) * sign;
    const double above = glm::dot(normal, light.middle) - planar.distance * sign;
    SpecularConnector c = base_connector(flat, prim, material);
    store(c.place, normal);
    c.size = static_cast<clr_real>(planar.distance * sign);
    c.kind = CLR_CONNECT_PLANE;
    c.light = light.index;
    store(c.toward, light.middle - normal * (2 * above));
    c.weight = static_cast<clr_real>(light.intensity_towards(vec(planar.origin)) *
                                     average(flat.materials[material].color));
    if (above > 0 && c.weight > 0)
        out.push_back(c);
}

} // namespace

void flatten_specular_connectors(Flattening &work) {
    FlatScene &flat = work.flat;
    constexpr int least_edges = 3; // to the vertex, to the specular surface, to the light
    if (!work.options.specular_connections || flat.facts.shows_depth ||
        flat.facts.strategy == Strategy::bsdf || flat.frame.max_depth < least_edges)
        return;
    std::vector<SpecularConnector> &all = flat.specular_connectors;
    const auto spheres = static_cast<std::size_t>(flat.facts.sphere_count);
    const auto ordinary = spheres - static_cast<std::size_t>(flat.facts.huge_count);
    for (const ConnectedLight &light : connected_lights(flat)) {
        for (std::size_t prim = 0; prim < ordinary; ++prim)
            if (flat.shapes[prim].emitter == CLR_NONE)
                add_sphere(flat, prim, light, all);
        for (std::size_t prim = spheres; prim < flat.lane_wise_count(); ++prim)
            for (const bool back : {false, true})
                if (flat.shapes[prim].emitter == CLR_NONE)
                    add_plane(flat, prim, back, light, all);
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const auto &a, const auto &b) { return a.weight > b.weight; });
    all.resize(std::min(all.size(), most_connectors));
}

} // namespace clrender::inline CLR_PRECISION
