#include "checks.h"

#include <cmath>
#include <fmt/core.h>
#include <numbers>

namespace clrender::selftest {

namespace {

constexpr double pi = std::numbers::pi;

void store(float (&out)[3], const glm::dvec3 &v) {
    for (int c = 0; c < 3; ++c)
        out[c] = static_cast<float>(v[c]);
}

glm::dvec3 vector(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

/// A camera somewhere, with a crop window, clip distances and a lens; `half_angle` of its view in
/// degrees.
FrameData random_camera(Random &random, int film, double half_angle, double aperture) {
    FrameData f{};
    const glm::dvec3 axis = glm::normalize(random.direction());
    const glm::dvec3 right = glm::normalize(glm::cross(axis, random.direction()));
    const glm::dvec3 up = glm::cross(right, axis);
    const double half = std::tan(half_angle * pi / 180);
    const glm::dvec3 eye = random.point();
    store(f.axis, axis);
    store(f.lens_x, right);
    store(f.lens_y, up);
    store(f.step_x, right * (2 * half / film));
    store(f.step_y, -up * (2 * half / film));
    store(f.corner, axis - right * half + up * half);
    f.width = f.height = static_cast<uint>(film / 2);
    f.crop_x = film / 4;
    f.crop_y = film / 3;
    f.aperture_radius = static_cast<float>(aperture);
    f.focus_distance = static_cast<float>(random.between(0.5, 20));
    // Rays start at the eye, or at some depth before the scene.
    const double depth = random.unit() < 0.5f ? 0 : random.between(0.1, 3);
    store(f.start, eye + depth * vector(f.corner));
    store(f.start_x, depth * vector(f.step_x));
    store(f.start_y, depth * vector(f.step_y));
    f.lens_share = static_cast<float>(1 - depth / double{f.focus_distance});
    f.near_clip = static_cast<float>(random.between(0.01, 1));
    f.far_clip = static_cast<float>(random.between(10, 100));
    return f;
}

struct CameraErrors {
    Worst origin, direction, pixels, clip;
    std::vector<glm::dvec2> film, lens;
};

/// Compares the rays of one camera. `out` is what probe_camera writes.
void compare(const FrameData &f, const std::vector<float> &in, const std::vector<float> &out,
             CameraErrors &errors) {
    const glm::dvec3 axis = vector(f.axis);
    const double pixel = glm::length(vector(f.step_x));
    for (std::size_t i = 0; i < in.size() / 3; ++i) {
        const float *r = &out[12 * i];
        const double x = double{in[3 * i]} + f.crop_x + r[8];
        const double y = double{in[3 * i + 1]} + f.crop_y + r[9];
        glm::dvec3 way = vector(f.corner) + x * vector(f.step_x) + y * vector(f.step_y);
        const glm::dvec3 start = vector(f.start) + x * vector(f.start_x) + y * vector(f.start_y);
        const double radius = std::sqrt(double{r[10]}) * f.aperture_radius;
        const double angle = 2 * pi * r[11];
        const glm::dvec3 on_lens = radius * std::cos(angle) * vector(f.lens_x) +
                                   radius * std::sin(angle) * vector(f.lens_y);
        const glm::dvec3 o = start + double{f.lens_share} * on_lens;
        way = way * double{f.focus_distance} - on_lens;
        const glm::dvec3 d = glm::normalize(way);
        const glm::dvec3 ray_o(r[0], r[1], r[2]), ray_d(r[3], r[4], r[5]);
        errors.origin.see(glm::length(ray_o - o));
        errors.direction.see(glm::length(ray_d - d));
        errors.direction.see(std::abs(glm::length(ray_d) - 1));
        // Seen from the lens, at the focus.
        errors.pixels.see(glm::length(ray_d - d) * glm::length(way) /
                          (double{f.focus_distance} * pixel));
        const double cosine = glm::dot(axis, d);
        errors.clip.see(std::abs(r[6] * cosine / f.near_clip - 1));
        errors.clip.see(std::abs(r[7] * cosine / f.far_clip - 1));
        errors.film.emplace_back(r[8], r[9]);
        if (radius > 0 && std::abs(f.lens_share) > 0.1f) { // on the lens, even by area and angle
            const glm::dvec3 offset = (ray_o - start) / double{f.lens_share};
            const double across = glm::dot(offset, vector(f.lens_x));
            const double upward = glm::dot(offset, vector(f.lens_y));
            const double turn = std::atan2(upward, across) / (2 * pi);
            const double share = (across * across + upward * upward) /
                                 (double{f.aperture_radius} * f.aperture_radius);
            errors.lens.emplace_back(std::min(turn - std::floor(turn), 1 - 1e-9),
                                     std::min(share / (1 + 1e-5), 1 - 1e-9));
        }
    }
}

void check_size(ProbeDevice &device, int film, double bar, Checks &checks) {
    CameraErrors errors, narrow;
    constexpr int cameras = 20;
    for (int camera = 0; camera < cameras; ++camera) {
        Random random(100 + static_cast<std::uint32_t>(camera));
        // Every fifth has so narrow a view that unit vectors in float32 do not tell its pixels.
        const bool is_narrow = camera % 5 == 4;
        FlatScene flat;
        flat.frame =
            random_camera(random, film, random.between(is_narrow ? 0.01 : 10, is_narrow ? 1 : 70),
                          camera % 2 == 0 ? 0.2 : 0);
        const int visible = film / 2; // the crop window
        std::vector<float> in;
        const std::size_t count = device.count(1e6 / cameras);
        for (std::size_t i = 0; i < count; ++i) {
            in.push_back(std::floor(random.unit() * static_cast<float>(visible)));
            in.push_back(std::floor(random.unit() * static_cast<float>(visible)));
            in.push_back(static_cast<float>(random.bits() % 64));
        }
        compare(flat.frame, in, device.run_scene("probe_camera", flat, in, 3, 12),
                is_narrow ? narrow : errors);
    }
    const std::string of = fmt::format(", film of {} pixels", film);
    checks.push_back(
        {"camera_ray", "largest error of the direction, pixels" + of, errors.pixels.value(), bar});
    checks.push_back({"camera_ray", "largest error of the direction, narrow views" + of,
                      std::max(narrow.direction.value(), errors.direction.value()), 4e-7});
    checks.push_back(
        {"camera_ray", "largest error of the origin" + of, errors.origin.value(), 5e-6});
    checks.push_back(
        {"camera_ray", "largest relative error of clip distances" + of, errors.clip.value(), 1e-6});
    checks.push_back({"camera_ray", "chi-square of places in the pixel, deviations" + of,
                      deviation_from_even(errors.film, 16), 4});
    checks.push_back({"camera_ray", "chi-square of places on the lens, deviations" + of,
                      deviation_from_even(errors.lens, 16), 4});
}

} // namespace

Checks check_camera(ProbeDevice &device) {
    Checks checks;
    check_size(device, 512, 1e-3, checks);
    // On so fine a film of a view of 2 degrees, unit vectors in float32 are a 30th of a pixel
    // apart.
    check_size(device, 16384, 0.05, checks);
    return checks;
}

} // namespace clrender::selftest
