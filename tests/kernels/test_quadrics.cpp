/// Ellipsoids, cylinders and disks of the tree against double precision: what rays meet, the point,
/// the normal and the coordinates there, and light sampling of them.

#include "cl_test_device.h"
#include "config/kernel_config.h"
#include "flatten/flat_scene.h"
#include "host/mitsuba_text_scene.h"
#include "host/stderr_of.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/format.h>
#include <glm/gtc/matrix_inverse.hpp>
#include <numbers>
#include <random>

using namespace clrender;
using namespace clrender::test;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double rounding = 0x1p-24;
constexpr int lanes = 8;
constexpr std::size_t in_size = 9, out_size = 16;

using Random = std::mt19937;

double uniform(Random &random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

glm::dvec3 direction(Random &random) {
    const double z = uniform(random, -1, 1), phi = uniform(random, 0, 2 * pi);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

/// A shape as the scene has it, in the renderer's coordinates: points are origin + axes * p, with p
/// on the unit sphere, on the wall of x^2 + y^2 = 1, 0 <= z <= 1, or on the unit disk.
struct Truth {
    ShapeKind kind = ShapeKind::ellipsoid;
    glm::dvec3 origin{0.0};
    glm::dmat3 axes{1.0}, inverse{1.0};
    double flip = 1;

    [[nodiscard]] glm::dvec3 own(const glm::dvec3 &p) const { return inverse * (p - origin); }
    [[nodiscard]] glm::dvec3 point(const glm::dvec3 &own) const { return origin + axes * own; }
    [[nodiscard]] double size() const {
        return glm::length(axes[0]) + glm::length(axes[1]) + glm::length(axes[2]);
    }
    /// What all of them lose to rounding at a point like this, times a small number.
    [[nodiscard]] double unit(const glm::dvec3 &from) const {
        return rounding * (glm::length(from) + glm::length(origin) + size());
    }
    /// Whether the normal points inwards, of a disk along -z.
    [[nodiscard]] bool inwards() const {
        return (kind == ShapeKind::ellipsoid && glm::determinant(axes) < 0 ? -flip : flip) < 0;
    }
    /// The unit normal where the surface is at `own`.
    [[nodiscard]] glm::dvec3 normal(glm::dvec3 own) const {
        if (kind == ShapeKind::cylinder)
            own.z = 0;
        if (kind == ShapeKind::disk)
            own = {0, 0, 1};
        const double sign = inwards() ? -1 : 1;
        return sign * glm::normalize(glm::transpose(inverse) * own);
    }
    [[nodiscard]] glm::dvec2 uv(const glm::dvec3 &own) const {
        const double turn = std::atan2(own.y, own.x) / (2 * pi);
        const double angle = turn < 0 ? turn + 1 : turn;
        if (kind == ShapeKind::disk)
            return {std::hypot(own.x, own.y), angle};
        return {angle, kind == ShapeKind::cylinder
                           ? own.z
                           : std::atan2(std::hypot(own.x, own.y), own.z) / pi};
    }
    /// How far outside of the surface a point in own coordinates is, relative to the radius.
    [[nodiscard]] double height(const glm::dvec3 &own) const {
        return (kind == ShapeKind::ellipsoid ? glm::length(own) : std::hypot(own.x, own.y)) - 1;
    }
    /// The distances at which a line meets it, those within the outline, in order.
    [[nodiscard]] std::vector<double> roots(const glm::dvec3 &o, const glm::dvec3 &d) const {
        const glm::dvec3 f = own(o), g = inverse * d;
        if (kind == ShapeKind::disk) {
            const double t = -f.z / g.z;
            return std::hypot(f.x + t * g.x, f.y + t * g.y) <= 1 ? std::vector{t}
                                                                 : std::vector<double>{};
        }
        const double w = kind == ShapeKind::ellipsoid ? 1 : 0;
        const double a = g.x * g.x + g.y * g.y + w * g.z * g.z;
        const double b = -(f.x * g.x + f.y * g.y + w * f.z * g.z);
        const double c = f.x * f.x + f.y * f.y + w * f.z * f.z - 1;
        const double root = std::sqrt(b * b - a * c);
        std::vector<double> result;
        if (root >= 0)
            for (const double t : {(b - root) / a, (b + root) / a})
                if (const double z = f.z + t * g.z; w > 0 || (z >= 0 && z <= 1))
                    result.push_back(t);
        return result;
    }
};

/// A scene of such shapes; half a dozen scales, some stretched up to a thousand to one.
struct Shapes {
    FlatScene flat;
    std::vector<Truth> truth;
    std::vector<QuadricBlock> blocks; ///< by shape
};

Shapes random_shapes(ShapeKind kind, int count, double stretch, Random &random) {
    std::string xml;
    const char *name = kind == ShapeKind::ellipsoid  ? "sphere"
                       : kind == ShapeKind::cylinder ? "cylinder"
                                                     : "disk";
    for (int i = 0; i < count; ++i) {
        const double scale = std::exp(uniform(random, std::log(0.02), std::log(2.0)));
        const glm::dvec3 axis = direction(random),
                         place = direction(random) * uniform(random, 0, 3);
        const auto side = [&] {
            return scale * std::exp(uniform(random, -1, 1) * std::log(stretch));
        };
        xml += fmt::format(
            R"(<shape type="{}"><transform name="to_world"><scale x="{}" y="{}" z="{}"/>
               <matrix value="1 {} {} 0  0 1 {} 0  0 0 1 0  0 0 0 1"/>
               <rotate x="{}" y="{}" z="{}" angle="{}"/><translate x="{}" y="{}" z="{}"/></transform>
               <boolean name="flip_normals" value="{}"/></shape>)",
            name, side() * (i % 3 == 0 ? -1 : 1), side(), side(), uniform(random, -1, 1),
            uniform(random, -1, 1), uniform(random, -1, 1), axis.x, axis.y, axis.z,
            uniform(random, 0, 360), place.x, place.y, place.z, i % 2 == 0);
    }
    Scene scene;
    (void)::test::stderr_of([&] { scene = ::test::load_text(xml); });
    Shapes shapes;
    shapes.flat = flatten(scene);
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
        const Shape &shape = scene.shapes[i];
        REQUIRE(shape.kind == kind);
        Truth truth;
        truth.kind = kind;
        truth.origin = shapes.flat.placement.exact(glm::dvec3(shape.to_world[3]));
        truth.axes = glm::dmat3(shape.to_world) * shapes.flat.placement.scale;
        truth.inverse = glm::inverse(truth.axes);
        truth.flip = shape.flip_normals ? -1 : 1;
        shapes.truth.push_back(truth);
        const BvhQuadric &q = shapes.flat.bvh_quadrics.at(i);
        QuadricBlock block{};
        for (int lane = 0; lane < BVH_WIDTH; ++lane) {
            for (int axis = 0; axis < 3; ++axis) {
                block.center[axis][lane] = q.center[axis];
                for (std::size_t row = 0; row < 3; ++row)
                    block.rows[row][axis][lane] = q.rows[row][axis];
            }
            block.radius[lane] = q.radius;
            block.half_length[lane] = q.half_length;
            block.kind[lane] = q.kind;
            block.prim[lane] = q.prim;
        }
        shapes.blocks.push_back(block);
    }
    return shapes;
}

struct Query {
    glm::vec3 o{0.0f}, d{0, 0, 1};
    bool on_self = false;
    double u1 = 0.5, u2 = 0.5;
};

struct Answer {
    double t, u, v;
    glm::dvec3 p, n, wi;
    double t_max, inv_pdf, pdf;
    bool valid;
};

/// The probe; query i is about shape `shape_of(i)`.
template <class ShapeOf>
std::vector<Answer> probe(const Shapes &shapes, const std::vector<Query> &queries,
                          const ShapeOf &shape_of) {
    static const auto *const device = new ClTestDevice;
    static const auto *const program = [] {
        KernelConfig config;
        config.LANES = lanes;
        config.HAS_QUADRICS = config.HAS_QUADRIC_LIGHTS = config.HAS_UVS = 1;
        config.LIGHT_COUNT = 1;
        return new cl::Program(device->build("probes/quadric_probes.cl", config.build_options()));
    }();
    std::vector<float> in;
    std::vector<Quadric> quadrics;
    std::vector<QuadricBlock> blocks;
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const Query &q = queries[i];
        in.insert(in.end(), {q.o.x, q.o.y, q.o.z, q.d.x, q.d.y, q.d.z, q.on_self ? 1.0f : 0.0f,
                             static_cast<float>(q.u1), static_cast<float>(q.u2)});
        quadrics.push_back(shapes.flat.quadrics[shape_of(i)]);
        blocks.push_back(shapes.blocks[shape_of(i)]);
    }
    cl::Kernel kernel(*program, "probe_quadrics");
    const cl::Buffer out = device->allocate(queries.size() * out_size * sizeof(float));
    const cl::Buffer quadric_buffer = device->upload(std::span<const Quadric>(quadrics));
    const cl::Buffer block_buffer = device->upload(std::span<const QuadricBlock>(blocks));
    const cl::Buffer in_buffer = device->upload(std::span<const float>(in));
    kernel.setArg(0, quadric_buffer);
    kernel.setArg(1, block_buffer);
    kernel.setArg(2, in_buffer);
    kernel.setArg(3, out);
    kernel.setArg(4, static_cast<cl_uint>(queries.size()));
    device->run(kernel, (queries.size() + lanes - 1) / lanes);
    const std::vector<float> f = device->download<float>(out, queries.size() * out_size);
    std::vector<Answer> answers;
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const float *a = &f[i * out_size];
        answers.push_back({a[0],
                           a[7],
                           a[8],
                           {a[1], a[2], a[3]},
                           {a[4], a[5], a[6]},
                           {a[9], a[10], a[11]},
                           a[12],
                           a[13],
                           a[15],
                           a[14] > 0.5f});
    }
    return answers;
}

/// The largest of some numbers, of which a NaN is the largest.
struct Largest {
    double value = 0;
    void add(double v) { value = v <= value ? value : v; }
};

/// A ray towards the shape from near or far: its origin, rounded, and its direction of length 1.
Query random_ray(const Truth &truth, Random &random) {
    glm::dvec3 target = direction(random) * std::cbrt(uniform(random, 0, 1));
    if (truth.kind != ShapeKind::ellipsoid)
        target = {target.x, target.y,
                  truth.kind == ShapeKind::cylinder ? uniform(random, 0, 1) : 0};
    const double distance =
        truth.size() * std::exp(uniform(random, std::log(1e-3), std::log(30.0)));
    Query query;
    query.o = glm::vec3(truth.point(target) + direction(random) * distance);
    query.d = glm::vec3(glm::normalize(truth.point(target) - glm::dvec3(query.o)));
    return query;
}

void check_rays(ShapeKind kind, double stretch) {
    Random random(7);
    const int count = small_tests() ? 256 : 8192;
    const Shapes shapes = random_shapes(kind, count, stretch, random);
    std::vector<Query> queries;
    for (const Truth &truth : shapes.truth)
        queries.push_back(random_ray(truth, random));
    const auto same = [](std::size_t i) { return i; };
    const std::vector<Answer> found = probe(shapes, queries, same);

    Largest t_error, p_error, n_error, uv_error, self_error;
    int wrong = 0, met = 0, met_again = 0, left = 0;
    std::vector<Query> leaving;
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const Truth &truth = shapes.truth[i];
        const glm::dvec3 o(queries[i].o), d = glm::normalize(glm::dvec3(queries[i].d));
        const double unit = truth.unit(o);
        leaving.push_back({glm::vec3(found[i].p), glm::vec3(direction(random)), true});
        std::vector<double> ahead;
        for (const double t : truth.roots(o, d))
            if (t > 0)
                ahead.push_back(t);
        // Undecided within rounding: at the outline, at a tangent, at the surface.
        const auto cosine_at = [&](double t) {
            return std::abs(glm::dot(truth.normal(truth.own(o + t * d)), d));
        };
        if (ahead.empty() || std::isinf(found[i].t)) {
            wrong += ahead.empty() != std::isinf(found[i].t) ? 1 : 0;
            continue;
        }
        ++met;
        double nearest = INFINITY;
        for (const double t : ahead)
            nearest = std::min(nearest, std::abs(t - found[i].t) * cosine_at(t) / unit);
        t_error.add(nearest);
        wrong += std::abs(ahead.front() - found[i].t) * cosine_at(ahead.front()) > 64 * unit;

        const glm::dvec3 own = truth.own(found[i].p);
        const glm::dvec3 normal = truth.normal(own);
        const double slope =
            glm::length(glm::transpose(truth.inverse) *
                        (kind == ShapeKind::ellipsoid  ? glm::normalize(own)
                         : kind == ShapeKind::cylinder ? glm::normalize(glm::dvec3(own.x, own.y, 0))
                                                       : glm::dvec3(0, 0, 1)));
        p_error.add(std::abs(kind == ShapeKind::disk ? own.z : truth.height(own)) / slope /
                    truth.unit(glm::dvec3(0.0)));
        // What a shift of the point by a unit changes in own coordinates, and of the normal.
        const double shift =
            truth.unit(glm::dvec3(0.0)) * std::sqrt(glm::dot(truth.inverse[0], truth.inverse[0]) +
                                                    glm::dot(truth.inverse[1], truth.inverse[1]) +
                                                    glm::dot(truth.inverse[2], truth.inverse[2]));
        const double turn = shift * shift / truth.unit(glm::dvec3(0.0)) / slope;
        n_error.add(glm::length(normal - found[i].n) / (rounding + turn));
        const glm::dvec2 uv = truth.uv(own);
        if (std::hypot(own.x, own.y) > 0.05 && uv.x > 1e-3 && uv.x < 1 - 1e-3 && uv.y > 1e-3 &&
            uv.y < 1 - 1e-3)
            uv_error.add(std::max(std::abs(uv.x - found[i].u), std::abs(uv.y - found[i].v)) /
                         (rounding + shift));
    }
    // From where they have met it: outwards nothing is met again, inwards the far side.
    const std::vector<Answer> again = probe(shapes, leaving, same);
    for (std::size_t i = 0; i < queries.size(); ++i) {
        if (std::isinf(found[i].t))
            continue;
        const Truth &truth = shapes.truth[i];
        const glm::dvec3 o(leaving[i].o), d = glm::normalize(glm::dvec3(leaving[i].d));
        const double cosine = glm::dot(
            glm::transpose(truth.inverse) *
                (kind == ShapeKind::ellipsoid ? truth.own(o) : truth.own(o) * glm::dvec3(1, 1, 0)),
            d);
        if (kind == ShapeKind::disk || cosine > 1e-4 * glm::length(truth.inverse * d)) {
            ++left;
            met_again += std::isinf(again[i].t) ? 0 : 1;
            continue;
        }
        std::vector<double> roots = truth.roots(o, d);
        const double unit = truth.unit(o);
        if (roots.empty() || std::isinf(again[i].t))
            continue;
        self_error.add(std::abs(roots.back() - again[i].t) *
                       std::abs(glm::dot(truth.normal(truth.own(o + roots.back() * d)), d)) / unit);
    }
    INFO(fmt::format("kind {} stretch {}: {} met; largest errors: t {:.3g}, point {:.3g}, normal "
                     "{:.3g}, uv {:.3g}, chord {:.3g} units; {} of {} wrong, {} of {} met again",
                     static_cast<int>(kind), stretch, met, t_error.value, p_error.value,
                     n_error.value, uv_error.value, self_error.value, wrong, count, met_again,
                     left));
    CHECK(met > count / 4);
    CHECK(left > met / 4);
    CHECK(met_again == 0);
    CHECK(t_error.value <= 8);
    CHECK(p_error.value <= 4);
    CHECK(n_error.value <= 2);
    CHECK(uv_error.value <= 4);
    CHECK(self_error.value <= 8);
    CHECK(wrong <= count / 2000);
}

/// The solid angle of what shows its front to a point, by the midpoints of a grid on the surface.
double lit_angle(const Truth &truth, const glm::dvec3 &from) {
    constexpr int steps = 400;
    const double volume = std::abs(glm::determinant(truth.axes));
    double sum = 0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double a = (i + 0.5) / steps, phi = 2 * pi * (j + 0.5) / steps;
            const bool round = truth.kind == ShapeKind::ellipsoid;
            const double r = round ? std::sqrt(1 - (2 * a - 1) * (2 * a - 1))
                             : truth.kind == ShapeKind::disk ? std::sqrt(a)
                                                             : 1;
            const double z = round ? 2 * a - 1 : truth.kind == ShapeKind::disk ? 0 : a;
            const glm::dvec3 own(r * std::cos(phi), r * std::sin(phi), z);
            const glm::dvec3 own_normal = round ? own
                                          : truth.kind == ShapeKind::disk
                                              ? glm::dvec3(0, 0, 1)
                                              : glm::dvec3(own.x, own.y, 0);
            const double own_area = (round ? 4 : truth.kind == ShapeKind::disk ? 1 : 2) * pi;
            const double area = own_area / (steps * steps) * volume *
                                glm::length(glm::transpose(truth.inverse) * own_normal);
            const glm::dvec3 way = truth.point(own) - from;
            const double cosine = -glm::dot(truth.normal(own), way) / glm::length(way);
            sum += std::max(cosine, 0.0) * area / glm::dot(way, way);
        }
    return sum;
}

void check_light_samples(ShapeKind kind) {
    Random random(11);
    constexpr int side = 96;
    const Shapes shapes = random_shapes(kind, 24, 3, random);
    double worst = 0;
    Largest pdf_error;
    int compared = 0, met = 0;
    for (std::size_t k = 0; k < shapes.truth.size(); ++k) {
        const Truth &truth = shapes.truth[k];
        if (kind == ShapeKind::ellipsoid && truth.inwards())
            continue; // never sampled
        const glm::vec3 from(truth.origin +
                             direction(random) * truth.size() * uniform(random, 0.6, 3));
        if (kind == ShapeKind::ellipsoid && truth.height(truth.own(from)) < 0.2)
            continue; // not from inside
        std::vector<Query> queries;
        for (int i = 0; i < side * side; ++i)
            queries.push_back(
                {from, {0, 0, 1}, false, (i % side + 0.5) / side, (i / side + 0.5) / side});
        const auto same = [k](std::size_t) { return k; };
        const std::vector<Answer> samples = probe(shapes, queries, same);
        double sum = 0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            sum += samples[i].valid ? samples[i].inv_pdf : 0;
            queries[i].d = glm::vec3(samples[i].wi);
        }
        const double expected = lit_angle(truth, from);
        if (expected > 1e-3) {
            worst = std::max(worst, std::abs(sum / (side * side) / expected - 1));
            ++compared;
        }
        // Rays that way meet it where the sample ends, with the density of the sample; a grazing
        // hit moves far by a rounding, and thin shapes turn by it.
        const std::vector<Answer> hits = probe(shapes, queries, same);
        const double thickness = 1 / std::sqrt(glm::dot(truth.inverse[0], truth.inverse[0]) +
                                               glm::dot(truth.inverse[1], truth.inverse[1]) +
                                               glm::dot(truth.inverse[2], truth.inverse[2]));
        const double rounding =
            0x1p-24 * (glm::length(truth.origin) + double{glm::length(from)}) / thickness;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const double cosine = std::abs(glm::dot(hits[i].n, glm::dvec3(samples[i].wi)));
            if (!samples[i].valid || !(std::abs(hits[i].t / samples[i].t_max - 1) < 1e-3) ||
                cosine < 0.25)
                continue;
            ++met;
            pdf_error.add(std::abs(hits[i].pdf * samples[i].inv_pdf - 1) * cosine / rounding);
        }
    }
    INFO(fmt::format("kind {}: {} shapes, solid angle off by {:.3g}; {} samples met, density by "
                     "{:.3g} roundings",
                     static_cast<int>(kind), compared, worst, met, pdf_error.value));
    CHECK(compared >= 5);
    CHECK(met > compared * side * side / 3);
    CHECK(worst < 0.01);
    CHECK(pdf_error.value < 16);
}

} // namespace

TEST_CASE("rays meet ellipsoids, cylinders and disks where double precision does", "[quadrics]") {
    for (const ShapeKind kind : {ShapeKind::ellipsoid, ShapeKind::cylinder, ShapeKind::disk})
        for (const double stretch : {2.0, 30.0})
            check_rays(kind, stretch);
}

TEST_CASE("light samples of ellipsoids, cylinders and disks cover what shines", "[quadrics]") {
    for (const ShapeKind kind : {ShapeKind::ellipsoid, ShapeKind::cylinder, ShapeKind::disk})
        check_light_samples(kind);
}
