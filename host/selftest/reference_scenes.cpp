#include "reference_scenes.h"

#include "scene/cube_mesh.h"

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <numbers>

namespace clrender::selftest {

namespace {

constexpr double pi = std::numbers::pi;

/// A scene in the making.
struct Builder {
    Scene scene;

    Builder(int side, double fov, const glm::dvec3 &eye, const glm::dvec3 &target) {
        scene.name = "self-test";
        scene.film.width = scene.film.crop_width = side;
        scene.film.height = scene.film.crop_height = side;
        scene.film.filter.kind = FilterKind::box;
        scene.sensor.fov = fov;
        const glm::dvec3 axis = glm::normalize(target - eye);
        const glm::dvec3 left = glm::normalize(glm::cross(glm::dvec3(0.1, 1, 0.2), axis));
        glm::dmat4 &m = scene.sensor.to_world;
        m[0] = glm::dvec4(left, 0);
        m[1] = glm::dvec4(glm::cross(axis, left), 0);
        m[2] = glm::dvec4(axis, 0);
        m[3] = glm::dvec4(eye, 1);
        scene.integrator.rr_depth = 1 << 30;
    }

    int constant(double value) {
        Texture texture;
        texture.value = Rgb(value);
        scene.textures.push_back(texture);
        return static_cast<int>(scene.textures.size()) - 1;
    }

    int diffuse(int texture) { return add(DiffuseBsdf{texture}); }

    int add(const BsdfModel &model) {
        scene.bsdfs.push_back({model, {}, {}});
        return static_cast<int>(scene.bsdfs.size()) - 1;
    }

    Shape &shape(ShapeKind kind, int bsdf, const glm::dmat4 &to_world) {
        Shape shape;
        shape.kind = kind;
        shape.bsdf = bsdf;
        shape.to_world = to_world;
        scene.shapes.push_back(shape);
        return scene.shapes.back();
    }

    /// Makes the last shape shine.
    void light(double radiance) {
        Emitter emitter;
        emitter.kind = EmitterKind::area;
        emitter.radiance = constant(radiance);
        emitter.shape = static_cast<int>(scene.shapes.size()) - 1;
        scene.shapes.back().emitter = static_cast<int>(scene.emitters.size());
        scene.emitters.push_back(emitter);
    }
};

glm::dmat4 placed(const glm::dvec3 &at, double scale) {
    return glm::scale(glm::translate(glm::dmat4(1), at), glm::dvec3(scale));
}

struct Mean {
    double value, error;
};

/// The mean of the red channel and its standard error, all pixels being independent.
Mean render_mean(const Scene &scene, RenderOptions how, int spp) {
    how.spp = spp;
    how.with_variance = true;
    const RenderResult result = render_scene(scene, how);
    const auto channels = static_cast<std::size_t>(result.image.channels);
    double sum = 0, variance = 0;
    for (std::size_t i = 0; i < result.image.f32.size(); i += channels) {
        sum += double{result.image.f32[i]};
        variance += double{result.variance.f32[i]};
    }
    const std::size_t count = result.image.f32.size() / channels;
    const auto pixels = static_cast<double>(count);
    return {sum / pixels, std::sqrt(variance) / pixels};
}

/// The relative error of a mean beside four standard errors and `systematic`.
Check compare(const std::string &what, const Mean &mean, double expected, double systematic) {
    return {"reference scene", what, std::abs(mean.value / expected - 1),
            4 * mean.error / expected + systematic};
}

/// Spheres that lose no light, in front of a sky of radiance 1, cannot be seen.
Check check_furnace(const RenderOptions &how) {
    Builder b(24, 40, {0, 0, -6}, {0, 0, 0});
    b.shape(ShapeKind::sphere, b.diffuse(b.constant(1)), placed({-1.3, 0, 0}, 1));
    b.shape(ShapeKind::sphere, b.add(DielectricBsdf{}), placed({1.3, 0, 0}, 1));
    b.shape(ShapeKind::sphere, b.add(ConductorBsdf{}), placed({0, 1.6, 0.5}, 0.8));
    Emitter sky;
    sky.kind = EmitterKind::constant;
    sky.radiance = b.constant(1);
    b.scene.emitters.push_back(sky);
    return compare("furnace of diffuse, glass and mirror spheres: mean, relative error",
                   render_mean(b.scene, how, 16), 1, 1e-5);
}

/// In a closed box whose walls shine with radiance 1 and reflect the share a, it is 1 / (1 - a).
Check check_box(const RenderOptions &how) {
    Builder b(24, 70, {0.3, -0.2, 0.1}, {1, 0.4, 0.3});
    constexpr double albedo = 0.5;
    Shape &box = b.shape(ShapeKind::mesh, b.diffuse(b.constant(albedo)),
                         glm::rotate(glm::dmat4(1), 0.5, glm::dvec3(1, 2, 3)));
    box.mesh = cube_mesh();
    box.flip_normals = true;
    b.light(1);
    b.scene.integrator.max_depth = 30;
    return compare("closed box of triangles that shines inwards: mean, relative error",
                   render_mean(b.scene, how, 64), 1 / (1 - albedo), 1e-5);
}

/// The irradiance of a polygon of radiance 1 on a surface of normal n at p, all of it above
/// (Lambert; Arvo, "Analytic methods for simulated light transport", 1995).
double polygon_irradiance(const std::vector<glm::dvec3> &corners, const glm::dvec3 &p,
                          const glm::dvec3 &n) {
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = glm::normalize(corners[i] - p);
        const glm::dvec3 b = glm::normalize(corners[(i + 1) % corners.size()] - p);
        const glm::dvec3 across = glm::cross(a, b);
        sum += std::acos(glm::dot(a, b)) * glm::dot(glm::normalize(across), n);
    }
    return std::abs(sum) / 2;
}

/// A point of a textured floor under a sphere, a rectangle, a triangle, a disk and a point light.
Check check_lights(const RenderOptions &how) {
    Builder b(8, 0.2, {2, 3, -1}, {0, 0, 0});
    b.scene.sensor.kind = SensorKind::thinlens;
    b.scene.sensor.aperture_radius = 0.001;
    b.scene.sensor.focus_distance = std::sqrt(14.0);
    auto grey = std::make_shared<Image>();
    grey->width = grey->height = 2;
    grey->channels = 3;
    grey->type = PixelType::u8;
    grey->u8.assign(12, 102);
    Texture bitmap;
    bitmap.kind = TextureKind::bitmap;
    bitmap.bitmap = grey;
    bitmap.format.raw = true;
    b.scene.textures.push_back(bitmap);
    constexpr double albedo = 102 / 255.0;
    const glm::dvec3 up(0, 1, 0), here(0);
    const int black = b.diffuse(b.constant(0));
    // The rectangle's +z becomes up.
    b.shape(ShapeKind::rectangle, b.diffuse(0),
            glm::rotate(placed(here, 10), -pi / 2, glm::dvec3(1, 0, 0)));
    b.scene.bsdfs.back().model = DiffuseBsdf{0};

    const glm::dvec3 sphere_at(-2, 2, 1);
    b.shape(ShapeKind::sphere, black, placed(sphere_at, 0.5));
    b.light(3);
    const double distance = glm::length(sphere_at);
    double irradiance = 3 * pi * 0.25 / (distance * distance) * sphere_at.y / distance;

    // Down is the side that shines.
    const glm::dmat4 rectangle =
        glm::rotate(placed({1, 3, 2}, 0.7), pi / 2 + 0.4, glm::dvec3(1, 0, 0));
    b.shape(ShapeKind::rectangle, black, rectangle);
    b.light(2);
    std::vector<glm::dvec3> corners;
    for (const auto &[x, y] :
         {std::pair{-1, -1}, std::pair{1, -1}, std::pair{1, 1}, std::pair{-1, 1}})
        corners.emplace_back(rectangle * glm::dvec4(x, y, 0, 1));
    irradiance += 2 * polygon_irradiance(corners, here, up);

    auto mesh = std::make_shared<Mesh>();
    mesh->positions = {{-1.5, 2, -1}, {-0.5, 2.5, -1.2}, {-1, 1.5, -2}};
    mesh->triangles = {{0, 1, 2}, {0, 2, 1}};
    b.shape(ShapeKind::mesh, black, glm::dmat4(1)).mesh = mesh;
    b.light(5);
    irradiance += 5 * polygon_irradiance(mesh->positions, here, up);

    // Straight above, and parallel to the floor.
    b.shape(ShapeKind::disk, black, glm::rotate(placed({0, 6, 0}, 1.5), pi / 2, {1, 0, 0}));
    b.light(4);
    irradiance += 4 * pi * 2.25 / (2.25 + 36);

    Emitter point;
    point.kind = EmitterKind::point;
    point.position = {-3, 1, -2};
    point.intensity = Rgb(6);
    b.scene.emitters.push_back(point);
    const double away = glm::length(point.position);
    irradiance += 6 / (away * away) * point.position.y / away;

    b.scene.integrator.max_depth = 2;
    // The pixels see a hundredth of a unit.
    return compare("textured floor under lights of five kinds: mean, relative error",
                   render_mean(b.scene, how, 1024), albedo / pi * irradiance, 1e-4);
}

} // namespace

std::vector<Check> check_reference_scenes(const RenderOptions &how) {
    return {check_furnace(how), check_box(how), check_lights(how)};
}

} // namespace clrender::selftest
