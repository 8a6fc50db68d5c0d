/// Lights without a surface: points, spots, projectors, directional ones.

#include "light_list.h"
#include "scene/similarity.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clrender::inline CLR_PRECISION {

namespace {

constexpr double pi = std::numbers::pi;

/// The width of the ramp of a spot that has none, in turns: more than angles are rounded by.
constexpr double narrowest_ramp = CLR_EITHER(1e-7, 1e-14);

const Texture *texture_of(const Flattening &work, const Emitter &emitter) {
    return emitter.radiance == none
               ? nullptr
               : &work.scene.textures[static_cast<std::size_t>(emitter.radiance)];
}

/// Row `i` of a matrix.
glm::dvec3 row_of(const glm::dmat3 &m, int i) {
    return {m[0][i], m[1][i], m[2][i]};
}

/// What all lights at one place have.
Light light_at(const Flattening &work, uint kind, const glm::dvec3 &position, LightExtent &extent) {
    const Placement &placement = work.flat.placement;
    Light light{};
    light.kind = kind;
    light.texture = CLR_NONE;
    const glm::dvec3 place = (position - placement.center) * placement.scale;
    store(light.position, place);
    extent.lower = extent.upper = place;
    return light;
}

/// The light of a beam, with its axes still to be scaled for the texture: those of its own space,
/// by the inverse of to_world.
Light beam_at(const Flattening &work, uint kind, const Emitter &emitter, LightExtent &extent) {
    Light light = light_at(work, kind, glm::dvec3(emitter.to_world[3]), extent);
    light.prim = static_cast<uint>(work.flat.light_beams.size());
    extent.axis = glm::normalize(glm::dvec3(emitter.to_world[2]));
    return light;
}

} // namespace

void add_point(const Flattening &work, const Emitter &emitter, LightList &list) {
    const double unit = work.flat.placement.scale;
    LightExtent extent;
    Light light = light_at(work, CLR_LIGHT_POINT, emitter.position, extent);
    store(light.radiance, emitter.intensity * unit * unit);
    extent.intensity = luminance(emitter.intensity) * unit * unit;
    if (extent.intensity > 0)
        list.add(light, extent);
}

void add_spot(Flattening &work, const Emitter &emitter, LightList &list) {
    const double unit = work.flat.placement.scale;
    const double cutoff = glm::radians(emitter.cutoff_angle);
    LightExtent extent;
    Light light = beam_at(work, CLR_LIGHT_SPOT, emitter, extent);
    store(light.radiance, emitter.intensity * unit * unit);
    extent.intensity = luminance(emitter.intensity) * unit * unit;
    double reach = 1; // of the texture, as a tangent
    if (const Texture *texture = texture_of(work, emitter); texture != nullptr) {
        clr_real ignored[3];
        light.texture = flatten_texture(work, emitter.radiance, Rgb{0.0}, ignored);
        extent.intensity *= mean_luminance(*texture);
        reach = 2 * std::tan(cutoff);
    }
    if (!(extent.intensity > 0))
        return;

    const glm::dmat3 inverse = glm::inverse(glm::dmat3(emitter.to_world));
    LightBeam beam{};
    store(beam.to_u, row_of(inverse, 0) / reach);
    store(beam.to_v, row_of(inverse, 1) / reach);
    store(beam.axis, row_of(inverse, 2));
    beam.reach = static_cast<clr_real>(reach);
    beam.cutoff = static_cast<clr_real>(emitter.cutoff_angle / 360);
    beam.ramp = static_cast<clr_real>(
        1 / std::max((emitter.cutoff_angle - emitter.beam_width) / 360, narrowest_ramp));
    work.flat.light_beams.push_back(beam);
    if (emitter.cutoff_angle < 90 && is_similarity(glm::dmat3(emitter.to_world), 1e-6)) {
        extent.cosine = std::cos(cutoff);
        extent.is_beam = true;
    }
    list.add(light, extent);
}

void add_projector(Flattening &work, const Emitter &emitter, LightList &list) {
    const double unit = work.flat.placement.scale;
    LightExtent extent;
    Light light = beam_at(work, CLR_LIGHT_PROJECTOR, emitter, extent);
    const double strength = pi * emitter.scale * unit * unit;
    clr_real constant[3] = {1, 1, 1};
    light.texture = flatten_texture(work, emitter.radiance, Rgb{0.0}, constant);
    const Texture &texture = *texture_of(work, emitter);
    store(light.radiance, Rgb(constant[0], constant[1], constant[2]) * strength);

    const Image *picture = texture.bitmap.get();
    const double aspect = picture == nullptr ? 1 : double(picture->width) / picture->height;
    const glm::dvec2 half = image_plane_half_size(emitter.fov, emitter.fov_axis, aspect);
    const glm::dmat3 to_world(emitter.to_world);
    const glm::dmat3 inverse = glm::inverse(to_world);
    LightBeam beam{};
    store(beam.to_u, row_of(inverse, 0) / (-2 * half.x));
    store(beam.to_v, row_of(inverse, 1) / (-2 * half.y));
    store(beam.axis, row_of(inverse, 2));
    store(beam.front, to_world[2]);

    // Its strength along the axis, where 1 / (z^2 (front . direction)) is a length.
    extent.intensity = strength * mean_luminance(texture) * glm::length(to_world[2]);
    if (!(extent.intensity > 0))
        return;
    extent.cosine = 1;
    extent.is_beam = true;
    for (const double x : {-half.x, half.x})
        for (const double y : {-half.y, half.y})
            extent.cosine =
                std::min(extent.cosine,
                         glm::dot(glm::normalize(to_world * glm::dvec3(x, y, 1)), extent.axis));
    if (!(extent.cosine > 0)) {
        extent.cosine = -1;
        extent.is_beam = false;
    }
    work.flat.light_beams.push_back(beam);
    list.add(light, extent);
}

void add_directional(const Emitter &emitter, LightList &list) {
    Light light{};
    light.kind = CLR_LIGHT_DIRECTIONAL;
    light.texture = CLR_NONE;
    store(light.position, -emitter.direction);
    store(light.radiance, emitter.intensity);
    LightExtent extent;
    extent.is_distant = true;
    extent.lower = extent.upper = -emitter.direction;
    extent.intensity = luminance(emitter.intensity);
    if (extent.intensity > 0)
        list.add(light, extent);
}

} // namespace clrender::inline CLR_PRECISION
