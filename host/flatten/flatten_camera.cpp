#include "film_filter.h"
#include "flatten_parts.h"
#include "log.h"
#include "scene/limits.h"
#include "shared/film_filter.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <limits>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Mitsuba's `depth` measures from the near plane, stated or not.
constexpr double depth_near_clip = 0.01;

void flatten_film(Flattening &work) {
    FlatScene &flat = work.flat;
    const FilmSettings &film = work.scene.film;
    FrameData &f = flat.frame;
    flat.border = work.options.pixel_centers ? 0 : sampled_border(film);
    f.width = static_cast<uint>(film.crop_width + 2 * flat.border);
    f.height = static_cast<uint>(film.crop_height + 2 * flat.border);
    f.crop_x = film.crop_x - flat.border;
    f.crop_y = film.crop_y - flat.border;
    const PixelFormat format = film.pixel_format;
    flat.facts.has_alpha = (format == PixelFormat::luminance_alpha || format == PixelFormat::rgba ||
                            format == PixelFormat::xyza) &&
                           !work.is_black();
    f.filter_radius = static_cast<clr_real>(filter_radius(film.filter));
    if (work.options.pixel_centers || film.filter.kind == FilterKind::box)
        return;
    flat.facts.filter_border = filter_border(film.filter);
    flat.filter = tabulate_filter(film.filter);
}

void flatten_integrator(Flattening &work) {
    FlatScene &flat = work.flat;
    const Integrator &integrator = work.scene.integrator;
    FrameData &f = flat.frame;
    if (work.is_black())
        log::warn("max_depth 0 leaves no light: the picture is black");
    f.max_depth = integrator.max_depth < 0 ? INT_MAX : integrator.max_depth;
    f.rr_depth = integrator.rr_depth.value_or(window_end_depth);
    flat.facts.weight_window = !integrator.rr_depth && integrator.kind == IntegratorKind::path;
    // Lanes whose rays walk no tree keep step, and one that ends early only waits for the others.
    // Deep in the scene nearly all of them end.
    constexpr int depth_in_step = 6;
    f.window_depth = flat.has_hierarchy() ? 0 : depth_in_step;
    flat.facts.free_passages = integrator.skips_passages && integrator.max_depth >= 0;
    if (f.max_depth > max_depth_without_roulette || flat.facts.free_passages)
        f.rr_depth = std::min(f.rr_depth, max_depth_without_roulette);
    flat.facts.hides_emitters = integrator.hide_emitters;
    flat.facts.shows_depth = integrator.kind == IntegratorKind::depth;
    if (integrator.kind == IntegratorKind::direct) {
        f.max_depth = 2;
        f.rr_depth = INT_MAX;
    }
}

/// The rays of the film positions (x, y), in pixels: from the eye's place plus
/// origin + x origin_x + y origin_y along way + x way_x + y way_y, whose component along the axis
/// is 1. The axis is a unit vector; `depth_axis` is at right angles to the plane on which the rays
/// begin, and grows by 1 with a step along the axis.
struct FilmRays {
    glm::dvec3 axis, depth_axis;
    glm::dvec3 way, way_x{0.0}, way_y{0.0};
    glm::dvec3 origin{0.0}, origin_x{0.0}, origin_y{0.0};
    double near_scale = 1; ///< scene units to a unit of near_clip
};

FilmRays perspective_rays(const Sensor &sensor, const FilmSettings &film) {
    // The axes as unit vectors: a scale in the camera's matrix moves nothing but the clip planes.
    const glm::dvec3 right = -glm::normalize(glm::dvec3(sensor.to_world[0]));
    const glm::dvec3 up = glm::normalize(glm::dvec3(sensor.to_world[1]));
    FilmRays rays{};
    rays.axis = rays.depth_axis = glm::normalize(glm::dvec3(sensor.to_world[2]));
    const double aspect = double(film.width) / film.height;
    const glm::dvec2 half = image_plane_half_size(sensor.fov, sensor.fov_axis, aspect);
    rays.way_x = right * (2 * half.x / film.width);
    rays.way_y = -up * (2 * half.y / film.height);
    const glm::dvec2 middle = {film.width * (0.5 - sensor.principal_point_offset.x),
                               film.height * (0.5 - sensor.principal_point_offset.y)};
    rays.way = rays.axis - rays.way_x * middle.x - rays.way_y * middle.y;
    return rays;
}

FilmRays orthographic_rays(const Sensor &sensor, const FilmSettings &film) {
    const glm::dvec3 left(sensor.to_world[0]);
    const glm::dvec3 up(sensor.to_world[1]);
    const glm::dvec3 forward(sensor.to_world[2]);
    FilmRays rays{};
    rays.near_scale = glm::length(forward);
    rays.way = rays.axis = forward / rays.near_scale;
    const glm::dvec3 normal = glm::cross(left, up);
    rays.depth_axis = normal / glm::dot(normal, rays.axis);
    rays.origin_x = left * (-2.0 / film.width);
    rays.origin_y = up * (-2.0 / film.width);
    rays.origin = left + up * (double(film.height) / film.width);
    return rays;
}

FilmRays film_rays(const Sensor &sensor, const FilmSettings &film) {
    switch (sensor.kind) {
    case SensorKind::perspective:
    case SensorKind::thinlens:
        break;
    case SensorKind::orthographic:
        return orthographic_rays(sensor, film);
    }
    return perspective_rays(sensor, film);
}

/// A pixel's width on the image plane at distance 1 from which on float32 directions do for pixels.
constexpr double narrow_pixel = CLR_EITHER(0x1p-17, 0x1p-46);

/// The depth at which camera rays start, in scene units: that of the nearest shape, so that neither
/// the eye's place nor the direction loses pixels to rounding, however far away the eye is. Where a
/// narrow angle is seen, and some shape begins long before the middle of the scene, rays come in
/// legs (FAR_CAMERA) to a start before that middle.
double start_depth(Flattening &work, const FilmRays &rays) {
    const Scene &scene = work.scene;
    const glm::dvec3 &axis = rays.depth_axis;
    const double pixel = std::min(glm::length(rays.way_x), glm::length(rays.way_y));
    const bool narrow = scene.sensor.kind != SensorKind::orthographic && pixel < narrow_pixel;
    const glm::dvec3 eye(scene.sensor.to_world[3]);
    const double unit = 1 / work.flat.placement.scale;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
        const Range depths = shape_range(scene.shapes[i], work.boxes[i], eye, axis);
        if (depths.high > 0)
            nearest = std::min(nearest, depths.low);
    }
    for (const Box &box : work.instance_boxes) {
        const Range depths = box_range(box, eye, axis);
        if (depths.high > 0)
            nearest = std::min(nearest, depths.low);
    }
    constexpr double margin = 0x1p-4, reach = 4, far_away = 16;
    const double before_all = std::isfinite(nearest) ? std::max(nearest - margin * unit, 0.0) : 0;
    const double middle = glm::dot(work.flat.placement.center - eye, axis);
    if (!narrow || middle - before_all < far_away * unit ||
        scene.integrator.kind == IntegratorKind::depth ||
        scene.sensor.near_clip.value_or(0) > middle - reach * unit)
        return before_all;
    work.flat.facts.far_camera = true;
    return middle - reach * unit;
}

} // namespace

glm::dvec2 image_plane_half_size(double fov, FovAxis axis, double aspect) {
    const double tangent = std::tan(glm::radians(fov) / 2);
    if (axis == FovAxis::smaller)
        axis = aspect > 1 ? FovAxis::y : FovAxis::x;
    else if (axis == FovAxis::larger)
        axis = aspect > 1 ? FovAxis::x : FovAxis::y;

    double half_x = tangent;
    if (axis == FovAxis::y)
        half_x = tangent * aspect;
    else if (axis == FovAxis::diagonal)
        half_x = tangent * aspect / std::sqrt(1 + aspect * aspect);
    return {half_x, half_x / aspect};
}

Strategy strategy_of(const Flattening &work) {
    const Integrator &integrator = work.scene.integrator;
    if (integrator.kind == IntegratorKind::direct && integrator.bsdf_samples == 0)
        return Strategy::light;
    if (integrator.kind == IntegratorKind::direct && integrator.emitter_samples == 0)
        return Strategy::bsdf;
    return work.options.strategy;
}

void flatten_camera(Flattening &work) {
    const Scene &scene = work.scene;
    FlatScene &flat = work.flat;
    const Sensor &sensor = scene.sensor;
    FrameData &f = flat.frame;
    flatten_film(work);
    flatten_integrator(work);

    const FilmRays rays = film_rays(sensor, scene.film);
    store(f.axis, rays.axis);
    store(f.lens_x, -glm::normalize(glm::dvec3(sensor.to_world[0])));
    store(f.lens_y, glm::normalize(glm::dvec3(sensor.to_world[1])));
    store(f.step_x, rays.way_x);
    store(f.step_y, rays.way_y);
    store(f.corner, rays.way);

    const double unit = flat.placement.scale;
    f.length_unit = static_cast<clr_real>(1 / unit);
    flat.facts.has_clip = sensor.near_clip || sensor.far_clip;
    f.focus_distance = 1; // without a lens, for kernels that are forced to have one
    if (sensor.kind == SensorKind::thinlens) {
        f.aperture_radius = static_cast<clr_real>(unit * sensor.aperture_radius);
        f.focus_distance = static_cast<clr_real>(unit * sensor.focus_distance);
    }

    const double start = start_depth(work, rays);
    const glm::dvec3 eye = flat.placement.exact(glm::dvec3(sensor.to_world[3]));
    store(f.start, eye + (rays.origin + rays.way * start) * unit);
    store(f.start_x, (rays.origin_x + rays.way_x * start) * unit);
    store(f.start_y, (rays.origin_y + rays.way_y * start) * unit);
    f.lens_share = static_cast<clr_real>(1 - start / sensor.focus_distance);
    const bool depth = scene.integrator.kind == IntegratorKind::depth;
    const double near_clip = sensor.near_clip.value_or(depth ? depth_near_clip : 0);
    const double near = near_clip * rays.near_scale;
    const double far =
        near + sensor.far_clip.value_or(std::numeric_limits<double>::infinity()) - near_clip;
    flat.facts.unstated_near = depth || sensor.near_clip ? 0 : depth_near_clip * rays.near_scale;
    flat.hits.center = flat.placement.center;
    flat.hits.scale = unit;
    flat.hits.eye = glm::dvec3(sensor.to_world[3]);
    flat.hits.axis = rays.axis;
    f.near_clip = static_cast<clr_real>(unit * std::max(near - start, 0.0));
    f.far_clip = static_cast<clr_real>(unit * (far - start));
    f.skipped_depth = static_cast<clr_real>(unit * std::max(start - near, 0.0));
    f.first_leg = static_cast<clr_real>(unit * (std::min(start, far) - near));
}

} // namespace clrender::inline CLR_PRECISION
