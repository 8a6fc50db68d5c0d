#include "flip.h"

#include "image/color.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tbb/parallel_for.h>
#include <vector>

namespace clrender {

namespace {

constexpr double pixels_per_degree = 67;
constexpr double pi = std::numbers::pi;

/// A picture of one channel.
struct Plane {
    int width = 0, height = 0;
    std::vector<double> values;

    Plane(int w, int h)
        : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x);
    }
};

/// Weights of the pixels from -radius to radius along one axis.
using Weights = std::vector<double>;

template <typename Function> Weights tabulate(int radius, Function function) {
    Weights weights;
    for (int x = -radius; x <= radius; ++x)
        weights.push_back(function(static_cast<double>(x)));
    return weights;
}

double sum(const Weights &weights) {
    double total = 0;
    for (const double weight : weights)
        total += weight;
    return total;
}

/// Along x with one set of weights and along y with another; pixels outside are those of the edge.
Plane convolve(const Plane &plane, const Weights &along_x, const Weights &along_y) {
    const auto radius = static_cast<int>(along_x.size() / 2);
    const auto place = [radius](int i) {
        const int index = i + radius;
        return static_cast<std::size_t>(index);
    };
    Plane rows(plane.width, plane.height), result(plane.width, plane.height);
    tbb::parallel_for(0, plane.height, [&](int y) {
        for (int x = 0; x < plane.width; ++x)
            for (int i = -radius; i <= radius; ++i)
                rows.values[rows.index(x, y)] +=
                    along_x[place(i)] *
                    plane.values[plane.index(std::clamp(x + i, 0, plane.width - 1), y)];
    });
    tbb::parallel_for(0, plane.height, [&](int y) {
        for (int x = 0; x < plane.width; ++x)
            for (int i = -radius; i <= radius; ++i)
                result.values[result.index(x, y)] +=
                    along_y[place(i)] *
                    rows.values[rows.index(x, std::clamp(y + i, 0, plane.height - 1))];
    });
    return result;
}

/// XYZ over that of white, and the linear opponent space of section 4.1.
struct ColorSpaces {
    glm::dmat3 to_xyz = srgb_to_xyz();
    glm::dmat3 from_xyz = glm::inverse(to_xyz);
    glm::dvec3 white = to_xyz * glm::dvec3(1);

    [[nodiscard]] glm::dvec3 opponent(const glm::dvec3 &rgb) const {
        const glm::dvec3 v = to_xyz * rgb / white;
        return {116 * v.y - 16, 500 * (v.x - v.y), 200 * (v.y - v.z)};
    }
    [[nodiscard]] glm::dvec3 rgb(const glm::dvec3 &opponent) const {
        const double y = (opponent.x + 16) / 116;
        return from_xyz * (glm::dvec3(y + opponent.y / 500, y, y - opponent.z / 200) * white);
    }
    /// CIELAB, its chroma scaled by lightness (the Hunt effect, section 4.1.2).
    [[nodiscard]] glm::dvec3 hunt_lab(const glm::dvec3 &rgb) const {
        const auto f = [](double t) {
            constexpr double delta = 6.0 / 29;
            return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
        };
        const glm::dvec3 v = to_xyz * rgb / white;
        const double lightness = 116 * f(v.y) - 16;
        return {lightness, 5 * lightness * (f(v.x) - f(v.y)), 2 * lightness * (f(v.y) - f(v.z))};
    }
};

/// A contrast sensitivity function as a sum of two Gaussians (table 1): a sqrt(pi / b)
/// exp(-pi^2 x^2 / b), x in degrees.
struct Sensitivity {
    double a1, b1, a2, b2;
};
constexpr Sensitivity sensitivities[3] = {
    {1, 0.0047, 0, 1e-5}, {1, 0.0053, 0, 1e-5}, {34.1, 0.04, 13.5, 0.025}};

Plane filter(const Plane &plane, const Sensitivity &s) {
    constexpr double widest = 0.04;
    const int radius =
        static_cast<int>(std::ceil(3 * std::sqrt(widest / (2 * pi * pi)) * pixels_per_degree));
    Plane result(plane.width, plane.height);
    double total = 0;
    for (const auto &[a, b] : {std::pair{s.a1, s.b1}, {s.a2, s.b2}}) {
        if (a == 0)
            continue;
        const Weights weights = tabulate(radius, [b = b](double x) {
            const double degrees = x / pixels_per_degree;
            return std::exp(-pi * pi * degrees * degrees / b);
        });
        const double scale = a * std::sqrt(pi / b);
        const Plane part = convolve(plane, weights, weights);
        for (std::size_t i = 0; i < result.values.size(); ++i)
            result.values[i] += scale * part.values[i];
        total += scale * sum(weights) * sum(weights);
    }
    for (double &value : result.values)
        value /= total;
    return result;
}

/// Positive and negative weights are scaled to sums of 1 and -1.
Weights balanced(Weights weights) {
    double positive = 0, negative = 0;
    for (const double weight : weights)
        (weight > 0 ? positive : negative) += std::abs(weight);
    for (double &weight : weights)
        weight /= weight > 0 ? positive : negative;
    return weights;
}

/// How strong edges and points are in each pixel (section 4.2).
struct Features {
    Plane edges, points;
};

Features find_features(const Plane &lightness) {
    constexpr double feature_width = 0.082; // degrees
    const double deviation = 0.5 * feature_width * pixels_per_degree;
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    const auto gauss = [&](double x) { return std::exp(-x * x / (2 * deviation * deviation)); };
    Weights blur = tabulate(radius, gauss);
    const double total = sum(blur);
    for (double &weight : blur)
        weight /= total;
    const Weights edge = balanced(tabulate(radius, [&](double x) { return -x * gauss(x); }));
    const Weights point = balanced(tabulate(
        radius, [&](double x) { return (x * x / (deviation * deviation) - 1) * gauss(x); }));
    const auto strength = [&](const Weights &weights) {
        Plane result = convolve(lightness, weights, blur);
        const Plane other = convolve(lightness, blur, weights);
        for (std::size_t i = 0; i < result.values.size(); ++i)
            result.values[i] = std::hypot(result.values[i], other.values[i]);
        return result;
    };
    return {strength(edge), strength(point)};
}

/// A picture as both halves of the metric need it.
struct Seen {
    std::vector<glm::dvec3> colours; ///< filtered, in hunt_lab()
    Features features;
};

/// Linear RGB in [0, 1].
glm::dvec3 displayed(const Image &image, std::size_t pixel) {
    glm::dvec3 rgb;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t i =
            pixel * static_cast<std::size_t>(image.channels) + (image.channels <= 2 ? 0 : c);
        const double value =
            image.type == PixelType::u8 ? srgb_decode(image.u8[i] / 255.0) : double{image.f32[i]};
        rgb[static_cast<int>(c)] = std::isfinite(value) ? std::clamp(value, 0.0, 1.0) : 0;
    }
    return rgb;
}

Seen see(const Image &image, const ColorSpaces &spaces) {
    std::vector<Plane> planes(3, Plane(image.width, image.height));
    Plane lightness(image.width, image.height);
    for (std::size_t i = 0; i < lightness.values.size(); ++i) {
        const glm::dvec3 opponent = spaces.opponent(displayed(image, i));
        for (int c = 0; c < 3; ++c)
            planes[static_cast<std::size_t>(c)].values[i] = opponent[c];
        lightness.values[i] = (opponent.x + 16) / 116;
    }
    for (std::size_t c = 0; c < 3; ++c)
        planes[c] = filter(planes[c], sensitivities[c]);

    Seen seen = {{}, find_features(lightness)};
    seen.colours.reserve(lightness.values.size());
    for (std::size_t i = 0; i < lightness.values.size(); ++i) {
        const glm::dvec3 rgb =
            spaces.rgb({planes[0].values[i], planes[1].values[i], planes[2].values[i]});
        seen.colours.push_back(spaces.hunt_lab(glm::clamp(rgb, 0.0, 1.0)));
    }
    return seen;
}

/// HyAB to the power of 0.7 (section 4.1.3).
double colour_distance(const glm::dvec3 &a, const glm::dvec3 &b) {
    constexpr double exponent = 0.7;
    return std::pow(std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z), exponent);
}

/// Compresses large distances: those up to 40% of the largest take 95% of the range.
double redistribute(double distance, double largest) {
    constexpr double knee = 0.4, at_knee = 0.95;
    const double limit = knee * largest;
    return distance < limit ? at_knee * distance / limit
                            : at_knee + (1 - at_knee) * (distance - limit) / (largest - limit);
}

} // namespace

Image flip_map(const Image &a, const Image &reference) {
    const ColorSpaces spaces;
    const double largest = colour_distance(spaces.hunt_lab({0, 1, 0}), spaces.hunt_lab({0, 0, 1}));
    const Seen seen_a = see(a, spaces), seen_r = see(reference, spaces);
    Image map;
    map.width = a.width;
    map.height = a.height;
    map.channels = 1;
    for (std::size_t i = 0; i < seen_a.colours.size(); ++i) {
        const double colour =
            redistribute(colour_distance(seen_a.colours[i], seen_r.colours[i]), largest);
        const auto difference = [i](const Plane &p, const Plane &q) {
            return std::abs(p.values[i] - q.values[i]);
        };
        const double feature =
            std::sqrt(std::max(difference(seen_a.features.edges, seen_r.features.edges),
                               difference(seen_a.features.points, seen_r.features.points)) /
                      std::numbers::sqrt2);
        map.f32.push_back(static_cast<float>(std::pow(colour, 1 - feature)));
    }
    return map;
}

} // namespace clrender
