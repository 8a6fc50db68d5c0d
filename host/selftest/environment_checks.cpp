#include "checks.h"

#include "flatten/flatten_parts.h"

#include <array>
#include <cmath>
#include <numbers>

namespace clrender::selftest {

namespace {

constexpr double pi = std::numbers::pi;

enum class Content { even, noise, sun, rows, mostly_black };

/// A scene of nothing but a map, turned about.
FlatScene map_scene(Random &random, int width, int height, Content content) {
    auto image = std::make_shared<Image>();
    image->width = width;
    image->height = height;
    image->channels = 3;
    image->type = PixelType::f32;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) {
                float value = random.unit();
                if (content == Content::even)
                    value = 0.5f + 0.01f * value;
                else if (content == Content::rows)
                    value = y == height / 2 ? 5 : 0.1f * value;
                else if (content == Content::mostly_black)
                    value = random.unit() < 0.1f ? value : 0;
                image->f32.push_back(value);
            }
    if (content == Content::sun || content == Content::mostly_black)
        for (std::size_t c = 0; c < 3; ++c)
            image->f32[3 * (static_cast<std::size_t>(width) * static_cast<std::size_t>(height / 3) +
                            static_cast<std::size_t>(width / 2)) +
                       c] = 1e5f;
    Scene scene;
    Emitter emitter;
    emitter.kind = EmitterKind::envmap;
    emitter.bitmap = image;
    const glm::dvec3 z = glm::normalize(random.direction());
    const glm::dvec3 x = glm::normalize(glm::cross(z, random.direction()));
    emitter.to_world = glm::dmat4(glm::dmat3(x, glm::cross(z, x), z));
    scene.emitters.push_back(emitter);
    SamplingOptions options;
    Flattening work{scene, options};
    double power = 0;
    flatten_environment(work, scene.emitters.front(), &power);
    return work.flat;
}

/// The map in double, from the same floats.
class MapOracle {
public:
    explicit MapOracle(const FlatScene &flat)
        : flat_(flat), width_(static_cast<int>(flat.frame.env_width)),
          rows_(static_cast<int>(flat.frame.env_height) - 1) {
        // The density goes by the weights of the texels and the solid angle of the rows.
        double total = 0;
        cells_.resize(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(width_));
        for (int row = 0; row < rows_; ++row)
            for (int column = 0; column < width_; ++column) {
                const double weight = (field(row, column, 3) + field(row, column + 1, 3) +
                                       field(row + 1, column, 3) + field(row + 1, column + 1, 3)) /
                                      4 * solid_angle(row);
                cells_[index(row, column)] = weight;
                total += weight;
            }
        for (double &cell : cells_)
            cell /= total;
        total_ = total;
    }

    struct Place {
        int row, column;
        double x, y; ///< within the cell
        double sine;
    };

    [[nodiscard]] Place place(const glm::dvec3 &world) const {
        const float *m = flat_.frame.env_rotation;
        const glm::dvec3 e(glm::dot(glm::dvec3(m[0], m[1], m[2]), world),
                           glm::dot(glm::dvec3(m[4], m[5], m[6]), world),
                           glm::dot(glm::dvec3(m[8], m[9], m[10]), world));
        const double sine = std::hypot(e.x, e.z);
        double u = std::atan2(e.x, -e.z) / (2 * pi) * width_ - 0.5;
        u -= std::floor(u / width_) * width_;
        const double v = std::atan2(sine, e.y) / pi * rows_;
        const int column = std::min(static_cast<int>(u), width_ - 1);
        const int row = std::min(static_cast<int>(v), rows_ - 1);
        return {row, column, u - column, v - row, sine / glm::length(e)};
    }

    [[nodiscard]] glm::dvec3 radiance(const Place &p) const {
        return {between(p, 0), between(p, 1), between(p, 2)};
    }
    /// Per solid angle.
    [[nodiscard]] double density(const Place &p) const { return density_of(p, between(p, 3)); }
    /// The rounding error of the density that is allowed: that of its operations, and what the map
    /// changes by over `moved` cells.
    [[nodiscard]] double density_slack(const Place &p, double moved) const {
        return 1e-5 * density(p) + moved * density_of(p, largest_step(p, 3)) + 1e-30;
    }
    [[nodiscard]] double largest_step(const Place &p, int k) const {
        double low = field(p.row, p.column, k), high = low;
        for (const int row : {p.row, p.row + 1})
            for (const int column : {p.column, p.column + 1}) {
                low = std::min(low, field(row, column, k));
                high = std::max(high, field(row, column, k));
            }
        return high - low;
    }
    [[nodiscard]] const std::vector<double> &cells() const { return cells_; }
    [[nodiscard]] std::size_t index(int row, int column) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(column);
    }
    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int rows() const { return rows_; }

private:
    /// What a weight makes per solid angle: a row's solid angle is spread over its height in the
    /// map.
    [[nodiscard]] double density_of(const Place &p, double weight) const {
        return weight * solid_angle(p.row) / total_ * rows_ * width_ / (2 * pi * pi * p.sine);
    }
    [[nodiscard]] double field(int row, int column, int k) const {
        const int place = row * (width_ + 1) + column;
        return flat_.env_texels[4 * static_cast<std::size_t>(place) + static_cast<std::size_t>(k)];
    }
    [[nodiscard]] double between(const Place &p, int k) const {
        const double upper =
            glm::mix(field(p.row, p.column, k), field(p.row, p.column + 1, k), p.x);
        const double lower =
            glm::mix(field(p.row + 1, p.column, k), field(p.row + 1, p.column + 1, k), p.x);
        return glm::mix(upper, lower, p.y);
    }
    [[nodiscard]] double solid_angle(int row) const {
        return (std::cos(pi * row / rows_) - std::cos(pi * (row + 1) / rows_)) * 2 * pi / width_;
    }

    const FlatScene &flat_;
    int width_, rows_;
    std::vector<double> cells_;
    double total_ = 1;
};

struct MapErrors {
    Worst radiance, density, sample_density, integral;
    double deviation = 0;
};

/// Looks up random directions.
void check_lookup(ProbeDevice &device, const FlatScene &flat, const MapOracle &oracle,
                  MapErrors &errors) {
    Random random(31);
    std::vector<float> in;
    const std::size_t count = device.count(2e4);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec3 d = random.direction();
        for (int c = 0; c < 3; ++c)
            in.push_back(static_cast<float>(d[c]));
    }
    const std::vector<float> out = device.run_scene("probe_env_eval", flat, in, 3, 4);
    for (std::size_t i = 0; i < count; ++i) {
        const MapOracle::Place p = oracle.place({in[3 * i], in[3 * i + 1], in[3 * i + 2]});
        const glm::dvec3 expected = oracle.radiance(p);
        // What rounding of the direction moves the place by, in cells.
        const double moved = 4e-7 * (oracle.width() / p.sine + oracle.rows());
        for (int c = 0; c < 3; ++c)
            errors.radiance.see(
                std::abs(double{out[4 * i + static_cast<std::size_t>(c)]} - expected[c]) /
                (moved * oracle.largest_step(p, c) + 1e-6 * expected[c] + 1e-30));
        // The density jumps from row to row.
        if (p.y < 2 * moved || p.y > 1 - 2 * moved)
            continue;
        errors.density.see(std::abs(double{out[4 * i + 3]} - oracle.density(p)) /
                           oracle.density_slack(p, moved));
    }
}

/// The density over all directions: two by two points in each cell, which is exact for what is
/// bilinear in the map's coordinates.
void check_integral(ProbeDevice &device, const FlatScene &flat, const MapOracle &oracle,
                    MapErrors &errors) {
    std::vector<float> in;
    std::vector<double> weights;
    const float *m = flat.frame.env_rotation;
    for (int row = 0; row < 2 * oracle.rows(); ++row)
        for (int column = 0; column < 2 * oracle.width(); ++column) {
            const double theta = pi * (row + 0.5) / (2 * oracle.rows());
            const double phi = 2 * pi * ((column + 0.5) / 2 + 0.5) / oracle.width();
            const glm::dvec3 e(std::sin(phi) * std::sin(theta), std::cos(theta),
                               -std::cos(phi) * std::sin(theta));
            for (int c = 0; c < 3; ++c)
                in.push_back(static_cast<float>(m[c] * e.x + m[4 + c] * e.y + m[8 + c] * e.z));
            weights.push_back(std::sin(theta) * pi / (2 * oracle.rows()) * 2 * pi /
                              (2 * oracle.width()));
        }
    const std::vector<float> out = device.run_scene("probe_env_eval", flat, in, 3, 4);
    double integral = 0;
    for (std::size_t i = 0; i < weights.size(); ++i)
        integral += weights[i] * double{out[4 * i + 3]};
    errors.integral.see(std::abs(integral - 1));
}

/// Samples, against the shares of the cells, and their density against what a lookup gives.
void check_samples(ProbeDevice &device, const FlatScene &flat, const MapOracle &oracle,
                   MapErrors &errors) {
    Random random(32);
    std::vector<float> in;
    const std::size_t count = device.count(5e4);
    for (std::size_t i = 0; i < 2 * count; ++i)
        in.push_back(random.unit());
    const std::vector<float> out = device.run_scene("probe_env_sample", flat, in, 2, 7);
    std::vector<float> directions;
    for (std::size_t i = 0; i < count; ++i)
        directions.insert(directions.end(), {out[7 * i], out[7 * i + 1], out[7 * i + 2]});
    const std::vector<float> found = device.run_scene("probe_env_eval", flat, directions, 3, 4);
    std::vector<double> counts(oracle.cells().size(), 0.0), expected;
    for (const double cell : oracle.cells())
        expected.push_back(cell * static_cast<double>(count));
    for (std::size_t i = 0; i < count; ++i) {
        const MapOracle::Place p =
            oracle.place({directions[3 * i], directions[3 * i + 1], directions[3 * i + 2]});
        ++counts[oracle.index(p.row, p.column)];
        const double moved = 1e-6 * (oracle.width() / p.sine + oracle.rows());
        if (p.y < 2 * moved || p.y > 1 - 2 * moved)
            continue;
        errors.sample_density.see(std::abs(double{out[7 * i + 6]} - double{found[4 * i + 3]}) /
                                  oracle.density_slack(p, moved));
    }
    errors.deviation = std::max(errors.deviation, chi_square_deviation(counts, expected));
}

} // namespace

Checks check_environment(ProbeDevice &device) {
    MapErrors errors;
    Random random(30);
    for (const auto &[width, height] : {std::pair{2, 3}, std::pair{5, 4}, std::pair{16, 9},
                                        std::pair{33, 17}, std::pair{128, 65}}) {
        // A simulated device, which is asked for few lookups, gets the smallest maps alone: the
        // integral takes four lookups a texel.
        if (device.count(1e6) < 10000 && width * height > 20)
            continue;
        for (const Content content :
             {Content::even, Content::noise, Content::sun, Content::rows, Content::mostly_black}) {
            const FlatScene flat = map_scene(random, width, height, content);
            const MapOracle oracle(flat);
            check_lookup(device, flat, oracle, errors);
            check_integral(device, flat, oracle, errors);
            check_samples(device, flat, oracle, errors);
        }
    }
    return {
        {"env_eval", "error of radiance over that of the direction", errors.radiance.value(), 1},
        {"env_eval", "error of the density over its bound", errors.density.value(), 1},
        {"env_eval", "integral of the density, off 1 by", errors.integral.value(), 1e-3},
        {"env_sample", "density against env_eval's, over the error's bound",
         errors.sample_density.value(), 1},
        {"env_sample", "chi-square against the density, all maps, deviations", errors.deviation,
         4}};
}

} // namespace clrender::selftest
