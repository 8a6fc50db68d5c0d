#include "film_filter.h"
#include "flatten_parts.h"
#include "shared/film_filter.h"

#include <climits>
#include <cmath>
#include <limits>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Tiles of one colour lie a tile apart, and no two of them may reach the same pixel.
constexpr int max_border = CLR_LEAST_TILE / 2;

/// Mitsuba's `depth` measures from the near plane, stated or not.
constexpr double depth_near_clip = 0.01;

void store(clr_real (&out)[3], const glm::dvec3 &v) {
    out[0] = static_cast<clr_real>(v.x);
    out[1] = static_cast<clr_real>(v.y);
    out[2] = static_cast<clr_real>(v.z);
}

/// Half the extent of the image plane at distance 1, along x and y.
glm::dvec2 image_plane_half_size(const Sensor &sensor, const FilmSettings &film) {
    const double width = film.width;
    const double height = film.height;
    const double aspect = width / height;
    const double tangent = std::tan(glm::radians(sensor.fov) / 2);
    FovAxis axis = sensor.fov_axis;
    if (axis == FovAxis::smaller)
        axis = width > height ? FovAxis::y : FovAxis::x;
    else if (axis == FovAxis::larger)
        axis = width > height ? FovAxis::x : FovAxis::y;

    double half_x = tangent;
    if (axis == FovAxis::y)
        half_x = tangent * aspect;
    else if (axis == FovAxis::diagonal)
        half_x = tangent * aspect / std::sqrt(1 + aspect * aspect);
    return {half_x, half_x / aspect};
}

void flatten_film(Flattening &work) {
    FlatScene &flat = work.flat;
    const FilmSettings &film = work.scene.film;
    FrameData &f = flat.frame;
    f.width = static_cast<uint>(film.crop_width);
    f.height = static_cast<uint>(film.crop_height);
    f.crop_x = film.crop_x;
    f.crop_y = film.crop_y;
    const PixelFormat format = film.pixel_format;
    flat.config.HAS_ALPHA = format == PixelFormat::luminance_alpha || format == PixelFormat::rgba ||
                                    format == PixelFormat::xyza
                                ? 1
                                : 0;
    f.filter_radius = static_cast<clr_real>(filter_radius(film.filter));
    if (work.options.pixel_centers)
        flat.config.FILTER = 2;
    else if (film.filter.kind != FilterKind::box) {
        // Splatting uses a sample for all pixels around it: three times fewer samples for the same
        // noise with the default filter. Very wide filters would reach too far for it.
        const int border = static_cast<int>(std::ceil(filter_radius(film.filter) - 0.5));
        flat.config.FILTER = border <= max_border ? 3 : 1;
        flat.config.BORDER = flat.config.FILTER == 3 ? border : 0;
        flat.filter = tabulate_filter(film.filter);
    }
}

void flatten_integrator(Flattening &work) {
    FlatScene &flat = work.flat;
    const Integrator &integrator = work.scene.integrator;
    FrameData &f = flat.frame;
    f.max_depth = integrator.max_depth < 0 ? INT_MAX : integrator.max_depth;
    f.rr_depth = integrator.rr_depth;
    const Strategy strategy = strategy_of(work);
    flat.config.STRATEGY = static_cast<int>(strategy);
    flat.config.HIDE_EMITTERS = integrator.hide_emitters ? 1 : 0;
    if (integrator.kind == IntegratorKind::direct) {
        f.max_depth = 2;
        f.rr_depth = INT_MAX;
    }
    // The last ray of a path would only bring what multiple importance sampling expects of it:
    // light. After some bounces all of it may as well come from light sampling, where that cannot
    // miss: of several lights it might choose one that is hidden, and seldom the one that shines.
    constexpr int long_path = 5;
    flat.config.FINAL_BY_LIGHTS = strategy == Strategy::mis && f.max_depth >= long_path &&
                                          f.max_depth < INT_MAX && flat.config.ENVIRONMENT == 0 &&
                                          flat.config.LIGHT_COUNT == 1 && !work.light_by_chance
                                      ? 1
                                      : 0;
    flat.config.INTEGRATOR = integrator.kind == IntegratorKind::depth ? 1 : 0;
    flat.config.HAS_ROULETTE =
        integrator.kind != IntegratorKind::depth && f.rr_depth < f.max_depth ? 1 : 0;
}

} // namespace

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

    // The axes as unit vectors: a scale in the camera's matrix moves nothing but the clip planes.
    const glm::dvec3 right = -glm::normalize(glm::dvec3(sensor.to_world[0]));
    const glm::dvec3 up = glm::normalize(glm::dvec3(sensor.to_world[1]));
    const glm::dvec3 axis = glm::normalize(glm::dvec3(sensor.to_world[2]));
    store(f.origin, glm::dvec3(flat.placement.apply(glm::dvec3(sensor.to_world[3]))));
    store(f.axis, axis);
    store(f.lens_x, right);
    store(f.lens_y, up);

    // Film position (x, y) in pixels looks along corner + x step_x + y step_y.
    const glm::dvec2 half = image_plane_half_size(sensor, scene.film);
    const glm::dvec3 step_x = right * (2 * half.x / scene.film.width);
    const glm::dvec3 step_y = -up * (2 * half.y / scene.film.height);
    const glm::dvec2 middle = {scene.film.width * (0.5 - sensor.principal_point_offset.x),
                               scene.film.height * (0.5 - sensor.principal_point_offset.y)};
    store(f.step_x, step_x);
    store(f.step_y, step_y);
    store(f.corner, axis - step_x * middle.x - step_y * middle.y);

    const double unit = flat.placement.scale;
    f.length_unit = static_cast<clr_real>(1 / unit);
    const bool depth = scene.integrator.kind == IntegratorKind::depth;
    f.near_clip =
        static_cast<clr_real>(unit * sensor.near_clip.value_or(depth ? depth_near_clip : 0));
    f.far_clip = static_cast<clr_real>(
        unit * sensor.far_clip.value_or(std::numeric_limits<double>::infinity()));
    flat.config.HAS_CLIP = sensor.near_clip || sensor.far_clip ? 1 : 0;
    if (sensor.kind == SensorKind::thinlens) {
        flat.config.HAS_LENS = sensor.aperture_radius > 0 ? 1 : 0;
        f.aperture_radius = static_cast<clr_real>(unit * sensor.aperture_radius);
        f.focus_distance = static_cast<clr_real>(unit * sensor.focus_distance);
    }
}

} // namespace clrender::inline CLR_PRECISION
