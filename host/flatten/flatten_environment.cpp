#include "flatten_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

namespace clrender::inline CLR_PRECISION {

namespace {

constexpr double pi = std::numbers::pi;

/// Linear radiance of pixel `at`.
Rgb radiance_of(const Emitter &emitter, std::size_t at) {
    return texel_color(*emitter.bitmap, at, {emitter.raw}) * emitter.scale;
}

/// Solid angle of the cells between rows j and j + 1 of `rows` + 1, each of `width` in the row.
double cell_solid_angle(std::size_t j, std::size_t rows, std::size_t width) {
    const double top = std::cos(pi * static_cast<double>(j) / static_cast<double>(rows));
    const double bottom = std::cos(pi * static_cast<double>(j + 1) / static_cast<double>(rows));
    return (top - bottom) * 2 * pi / static_cast<double>(width);
}

/// Appends the distribution of steps of these weights to `cdf`, and to `guide` the step that each
/// multiple of 1 / count lies in. Steps of equal weight where there is none.
void append_distribution(std::span<const double> weights, std::vector<clr_real> &cdf,
                         std::vector<uint> &guide) {
    const std::size_t count = weights.size();
    const std::size_t first = cdf.size();
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    double sum = 0;
    cdf.push_back(0.0f);
    for (std::size_t i = 0; i < count; ++i) {
        sum += total > 0 ? weights[i] / total : 1 / static_cast<double>(count);
        cdf.push_back(static_cast<clr_real>(std::min(sum, 1.0)));
    }
    cdf.back() = 1.0f;
    std::size_t step = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const auto u = static_cast<clr_real>(static_cast<double>(i) / static_cast<double>(count));
        while (step + 1 < count && cdf[first + step + 1] <= u)
            ++step;
        // One step back, where the device's product of u and the count may round up to i.
        guide.push_back(
            static_cast<uint>(step > 0 && cdf[first + step] >= u * (1 - 1e-6f) ? step - 1 : step));
    }
}

/// Radiance and luminance of the map's pixels, each row's first once more behind its last.
void append_texels(const Emitter &emitter, FlatScene &flat) {
    const std::size_t width = flat.frame.env_width, height = flat.frame.env_height;
    flat.env_texels.reserve(4 * (width + 1) * height);
    for (std::size_t row = 0; row < height; ++row)
        for (std::size_t column = 0; column <= width; ++column) {
            const Rgb c = radiance_of(emitter, row * width + column % width);
            for (int k = 0; k < 3; ++k)
                flat.env_texels.push_back(static_cast<clr_real>(c[k]));
            flat.env_texels.push_back(static_cast<clr_real>(luminance(c)));
        }
}

/// What light sampling makes of a map: the weights of the cells between four texels each.
struct CellWeights {
    std::vector<double> cells; ///< row by row
    double total = 0;
};

/// What of a luminance is above the floor.
clr_real weight_above(clr_real luminance, clr_real floor) {
    return std::max(luminance - floor, clr_real{0});
}

/// Weights by the luminance above `floor` times the solid angle.
CellWeights weigh_cells(const FlatScene &flat, clr_real floor) {
    const std::size_t width = flat.frame.env_width, rows = flat.frame.env_height - 1;
    const auto weight_at = [&](std::size_t row, std::size_t column) {
        return double{weight_above(flat.env_texels[4 * (row * (width + 1) + column) + 3], floor)};
    };
    CellWeights weights;
    weights.cells.reserve(width * rows);
    for (std::size_t j = 0; j < rows; ++j)
        for (std::size_t i = 0; i < width; ++i) {
            const double mean = (weight_at(j, i) + weight_at(j, i + 1) + weight_at(j + 1, i) +
                                 weight_at(j + 1, i + 1)) /
                                4;
            weights.cells.push_back(mean * cell_solid_angle(j, rows, width));
            weights.total += weights.cells.back();
        }
    return weights;
}

} // namespace

/// The distributions of light sampling over the map, and its texels' weights. The mean luminance is
/// left to BSDF sampling, which finds what is no brighter as often as it pays (Karlik et al., "MIS
/// compensation: optimizing sampling techniques in multiple importance sampling", 2019), but where
/// light sampling is `alone`.
/// Returns the integral over all directions of the luminance that is sampled; 0 for a black map.
double build_map_cells(FlatScene &flat, bool alone) {
    const std::size_t width = flat.frame.env_width, rows = flat.frame.env_height - 1;
    clr_real floor = 0;
    CellWeights weights = weigh_cells(flat, floor);
    if (!(weights.total > 0))
        return 0;
    if (!alone) {
        const auto mean = static_cast<clr_real>(weights.total / (4 * pi));
        CellWeights above = weigh_cells(flat, mean);
        // A map that is even all over has nothing brighter but for rounding.
        constexpr double least_part = 1e-5;
        if (above.total > least_part * weights.total) {
            weights = std::move(above);
            floor = mean;
        }
    }
    // The device squares the weights of the texels: the largest is brought between 1 and 2.
    clr_real largest = 0;
    for (std::size_t i = 3; i < flat.env_texels.size(); i += 4) {
        flat.env_texels[i] = weight_above(flat.env_texels[i], floor);
        largest = std::max(largest, flat.env_texels[i]);
    }
    const int exponent = std::ilogb(largest);
    for (std::size_t i = 3; i < flat.env_texels.size(); i += 4)
        flat.env_texels[i] = std::ldexp(flat.env_texels[i], -exponent);
    const auto count = static_cast<double>(rows);
    flat.frame.env_density = static_cast<clr_real>(2 * count * std::sin(pi / (2 * count)) /
                                                   (pi * std::ldexp(weights.total, -exponent)));
    std::vector<double> weight_of_row(rows, 0.0);
    for (std::size_t i = 0; i < weights.cells.size(); ++i)
        weight_of_row[i / width] += weights.cells[i];
    append_distribution(weight_of_row, flat.env_cdf, flat.env_guide);
    for (std::size_t j = 0; j < rows; ++j)
        append_distribution(std::span(weights.cells).subspan(j * width, width), flat.env_cdf,
                            flat.env_guide);
    return weights.total;
}

clr_real environment_alpha(const Integrator &integrator) {
    return integrator.kind == IntegratorKind::path && !integrator.hide_emitters ? 1.0f : 0.0f;
}

void flatten_environment(Flattening &work, const Emitter &emitter, double *power) {
    FlatScene &flat = work.flat;
    FrameData &f = flat.frame;
    f.env_alpha = environment_alpha(work.scene.integrator);
    if (emitter.kind == EmitterKind::constant) {
        const Rgb radiance = work.scene.textures[static_cast<std::size_t>(emitter.radiance)].value;
        for (int c = 0; c < 3; ++c)
            f.env_radiance[c] = static_cast<clr_real>(radiance[c]);
        flat.facts.environment = CLR_ENVIRONMENT_CONSTANT;
        return;
    }

    f.env_width = static_cast<uint>(emitter.bitmap->width);
    f.env_height = static_cast<uint>(emitter.bitmap->height);
    append_texels(emitter, flat);
    const glm::dmat3 to_map = glm::inverse(glm::dmat3(emitter.to_world));
    for (int row = 0; row < 3; ++row) {
        const glm::dvec3 axis =
            glm::normalize(glm::dvec3(to_map[0][row], to_map[1][row], to_map[2][row]));
        for (int column = 0; column < 3; ++column)
            f.env_rotation[4 * row + column] = static_cast<clr_real>(axis[column]);
    }
    *power = build_map_cells(flat, flat.facts.strategy == Strategy::light);
    // A map that is black all over adds nothing.
    flat.facts.environment = *power > 0 ? CLR_ENVIRONMENT_MAP : CLR_ENVIRONMENT_CONSTANT;
}

void make_environment_map(FlatScene &flat) {
    const int own = flat.facts.environment;
    if (own == CLR_ENVIRONMENT_MAP || flat.facts.strategy == Strategy::light)
        return;
    FrameData &f = flat.frame;
    constexpr std::size_t side = 2;
    flat.env_texels.clear();
    for (std::size_t i = 0; i < (side + 1) * side; ++i)
        for (int k = 0; k < 4; ++k)
            flat.env_texels.push_back(k < 3 && own == CLR_ENVIRONMENT_CONSTANT ? f.env_radiance[k]
                                                                               : 0.0f);
    flat.env_cdf.clear();
    flat.env_guide.clear();
    const std::vector<double> even(side, 1.0);
    append_distribution(std::span(even).first(side - 1), flat.env_cdf, flat.env_guide);
    append_distribution(even, flat.env_cdf, flat.env_guide);
    f.env_width = f.env_height = side;
    f.env_probability = 0;
    f.env_rotation[0] = f.env_rotation[5] = f.env_rotation[10] = 1;
}

} // namespace clrender::inline CLR_PRECISION
