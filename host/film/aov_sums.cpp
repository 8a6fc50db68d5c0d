#include "aov_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <tbb/parallel_for.h>

namespace clrender {

namespace {

/// The primitive and the instance are the first fields of a record.
constexpr std::size_t prim_field = 0, instance_field = 1;

/// What a type is made of: bits of CLR_AOV_*.
int bits_of(AovType type) {
    switch (type) {
    case AovType::albedo:
        return CLR_AOV_ALBEDO;
    case AovType::depth:
        return CLR_AOV_DEPTH;
    case AovType::position:
    case AovType::camera_depth:
        return CLR_AOV_POSITION;
    case AovType::uv:
        return CLR_AOV_UV;
    case AovType::geo_normal:
        return CLR_AOV_GEO_NORMAL;
    case AovType::sh_normal:
        return CLR_AOV_SH_NORMAL;
    case AovType::dp_du:
    case AovType::dp_dv:
        return CLR_AOV_TANGENTS;
    case AovType::duv_dx:
    case AovType::duv_dy:
        return CLR_AOV_UV_PARTIALS | CLR_AOV_TANGENTS;
    case AovType::prim_index:
        return CLR_AOV_UV; // which half of a rectangle is met
    case AovType::shape_index:
        return 0;
    case AovType::reflectance:
        return CLR_AOV_REFLECTANCE;
    }
    return 0;
}

/// Where the fields of one bit begin.
std::size_t field_of(int aovs, int bit) {
    return static_cast<std::size_t>(CLR_HIT_FIELDS(aovs & (bit - 1)));
}

/// Where the values of a type begin; not of numbers.
std::size_t first_field(AovType type, int aovs) {
    switch (type) {
    case AovType::dp_dv:
        return field_of(aovs, CLR_AOV_TANGENTS) + 3;
    case AovType::dp_du:
        return field_of(aovs, CLR_AOV_TANGENTS);
    case AovType::duv_dx:
        return field_of(aovs, CLR_AOV_UV_PARTIALS);
    case AovType::duv_dy:
        return field_of(aovs, CLR_AOV_UV_PARTIALS) + 2;
    default:
        return field_of(aovs, bits_of(type));
    }
}

bool is_number(AovType type) {
    return type == AovType::prim_index || type == AovType::shape_index;
}

/// One sample of a pixel.
struct SampleOfPixel {
    const HitStrip &strip;
    std::size_t x, y, sample;

    [[nodiscard]] float value(std::size_t field) const { return strip.values(x, y, field)[sample]; }
    [[nodiscard]] std::int32_t prim() const { return HitStrip::whole(value(prim_field)); }
    [[nodiscard]] std::int32_t instance() const { return HitStrip::whole(value(instance_field)); }
};

/// The object that a sample meets, counted from 1; 0 for none.
int object_number(const SampleOfPixel &s, const HitTable &table) {
    const std::int32_t prim = s.prim();
    return prim < 0 ? 0 : table.object_of(static_cast<std::uint32_t>(prim), s.instance()) + 1;
}

/// The face of its mesh that a sample meets, from 0; 0 where there is none.
float face_number(const SampleOfPixel &s, const HitTable &table) {
    const std::int32_t prim = s.prim();
    if (prim < 0)
        return 0;
    const auto number = static_cast<std::uint32_t>(prim);
    const HitRange &range = table.range_of(number);
    if (range.is_rectangle) {
        const std::size_t uv = field_of(s.strip.aovs, CLR_AOV_UV);
        return s.value(uv) + s.value(uv + 1) > 1 ? 1.0F : 0.0F;
    }
    const std::uint32_t face = number - range.first;
    return static_cast<float>(range.faces.empty() ? face : range.faces[face]);
}

/// The point of `sum`, a sum of renderer's coordinates with this sum of weights.
glm::dvec3 scene_point(const HitTable &table, const glm::dvec3 &sum, double weight) {
    return sum / table.scale + table.center * weight;
}

} // namespace

void SplatFilter::weights(float d, float *out) const {
    if (values.empty()) {
        out[0] = 1;
        return;
    }
    const float steps = static_cast<float>(values.size()) / static_cast<float>(radius);
    for (int i = 0; i <= 2 * border; ++i) {
        const float distance = std::abs(static_cast<float>(i - border) + 0.5F - d);
        const auto step = static_cast<std::size_t>(distance * steps);
        out[i] = step < values.size() ? values[step] : 0;
    }
}

AovSums::AovSums(AovPass pass, std::vector<Aov> aovs, const HitTable &table, SplatFilter filter,
                 std::size_t width, std::size_t height)
    : pass_(pass), aovs_(std::move(aovs)), table_(table), filter_(std::move(filter)), width_(width),
      height_(height) {
    for (const Aov &aov : aovs_)
        channels_ += aov_suffixes(aov.type).size();
    sums_.assign(width * height * channels_, 0.0F);
    if (pass != AovPass::boxed)
        weight_.assign(width * height, 0.0F);
}

void AovSums::set_names(std::vector<std::string> object_names,
                        std::vector<std::string> bsdf_names) {
    mattes_.push_back({"crypto_object", std::move(object_names), {}, {}, {}});
    mattes_.push_back({"crypto_material", std::move(bsdf_names), {}, {}, {}});
    for (Matte &matte : mattes_) {
        for (const std::string &name : matte.names)
            matte.ids.push_back(cryptomatte_id(name));
        matte.pairs.resize(width_ * height_);
        matte.ranks.assign(width_ * height_ * 2 * matte_ranks, 0.0F);
    }
}

int AovSums::fields() const {
    int bits = pass_ == AovPass::filtered ? 0 : CLR_AOV_PASSES;
    for (const Aov &aov : aovs_)
        bits |= bits_of(aov.type);
    if (pass_ != AovPass::boxed)
        bits |= CLR_AOV_PLACE;
    return bits;
}

void AovSums::take(const HitStrip &strip) {
    switch (pass_) {
    case AovPass::filtered:
        take_filtered(strip);
        break;
    case AovPass::boxed:
        tbb::parallel_for(strip.first_row, strip.end_row,
                          [&](std::size_t y) { take_boxed(strip, y); });
        break;
    case AovPass::matte:
        take_matte(strip);
        break;
    }
}

/// The layers of a row of pixels, each from its own samples. Colours and normals are means over all
/// of them, places and coordinates over those that meet something; numbers are of the object that
/// most of them meet, the first of these samples where there are several.
void AovSums::take_boxed(const HitStrip &strip, std::size_t y) {
    std::vector<int> objects(strip.samples);
    for (std::size_t x = 0; x < width_; ++x) {
        std::size_t hits = 0;
        for (std::size_t s = 0; s < strip.samples; ++s) {
            objects[s] = object_number({strip, x, y, s}, table_);
            hits += objects[s] > 0 ? 1 : 0;
        }
        std::size_t chosen = 0;
        std::ptrdiff_t most = 0;
        for (std::size_t s = 0; s < strip.samples; ++s) {
            const std::ptrdiff_t count = std::count(objects.begin(), objects.end(), objects[s]);
            if (count > most) {
                most = count;
                chosen = s;
            }
        }
        const auto sum = [&](std::size_t field) {
            const float *values = strip.values(x, y, field);
            float total = 0;
            for (std::size_t s = 0; s < strip.samples; ++s)
                total += values[s];
            return total;
        };
        float *out = &sums_[(y * width_ + x) * channels_];
        const double per_sample = 1.0 / static_cast<double>(strip.samples);
        const double per_hit = hits > 0 ? 1.0 / static_cast<double>(hits) : 0;
        for (const Aov &aov : aovs_) {
            const std::size_t count = aov_suffixes(aov.type).size();
            const std::size_t field = is_number(aov.type) ? 0 : first_field(aov.type, strip.aovs);
            const SampleOfPixel sample{strip, x, y, chosen};
            if (aov.type == AovType::shape_index) {
                out[0] = static_cast<float>(objects[chosen]);
            } else if (aov.type == AovType::prim_index) {
                out[0] = face_number(sample, table_);
            } else if (aov.type == AovType::position || aov.type == AovType::camera_depth) {
                const glm::dvec3 p(sum(field), sum(field + 1), sum(field + 2));
                const glm::dvec3 point = scene_point(table_, p * per_hit, hits > 0 ? 1 : 0);
                if (aov.type == AovType::position)
                    for (std::size_t c = 0; c < 3; ++c)
                        out[c] = static_cast<float>(point[static_cast<int>(c)]);
                else
                    out[0] = hits > 0
                                 ? static_cast<float>(glm::dot(point - table_.eye, table_.axis))
                                 : no_depth;
            } else {
                const bool of_surface = bits_of(aov.type) < CLR_AOV_GEO_NORMAL ||
                                        (bits_of(aov.type) & CLR_AOV_TANGENTS) != 0;
                for (std::size_t c = 0; c < count; ++c)
                    out[c] =
                        static_cast<float>(sum(field + c) * (of_surface ? per_hit : per_sample));
            }
            out += count;
        }
    }
}

/// The values of all layers for the samples of a pixel, sample by sample.
void AovSums::write_values(const HitStrip &strip, std::size_t x, std::size_t y, float *out) const {
    for (std::size_t s = 0; s < strip.samples; ++s) {
        const SampleOfPixel sample{strip, x, y, s};
        for (const Aov &aov : aovs_) {
            const std::size_t count = aov_suffixes(aov.type).size();
            if (aov.type == AovType::shape_index) {
                out[0] = static_cast<float>(object_number(sample, table_));
            } else if (aov.type == AovType::prim_index) {
                out[0] = face_number(sample, table_);
            } else {
                const std::size_t field = first_field(aov.type, strip.aovs);
                for (std::size_t c = 0; c < count; ++c)
                    out[c] = sample.value(field + c);
                if (aov.type == AovType::position && sample.prim() >= 0) {
                    const glm::dvec3 point =
                        scene_point(table_, glm::dvec3(out[0], out[1], out[2]), 1);
                    for (std::size_t c = 0; c < count; ++c)
                        out[c] = static_cast<float>(point[static_cast<int>(c)]);
                }
            }
            out += count;
        }
    }
}

namespace {

/// Calls `take(pixel, target pixel, sample, weight)` for all samples of a strip that reach rows of
/// the picture, a target row at a time: each pixel gets its samples in the order of their rows,
/// columns and numbers, whatever the strips.
template <class Take>
void for_each_splat(const HitStrip &strip, const SplatFilter &filter, std::size_t height,
                    const Take &take) {
    const auto border = static_cast<std::size_t>(filter.border);
    const std::size_t place = field_of(strip.aovs, CLR_AOV_PLACE);
    const std::size_t first = strip.first_row - std::min(strip.first_row, border);
    const std::size_t end = std::min(strip.end_row + border, height);
    tbb::parallel_for(first, end, [&](std::size_t row) {
        std::vector<float> wx(2 * border + 1), wy(2 * border + 1);
        const std::size_t from = std::max(row - std::min(row, border), strip.first_row);
        const std::size_t to = std::min(row + border + 1, strip.end_row);
        for (std::size_t y = from; y < to; ++y)
            for (std::size_t x = 0; x < strip.width; ++x)
                for (std::size_t s = 0; s < strip.samples; ++s) {
                    filter.weights(strip.values(x, y, place)[s], wx.data());
                    filter.weights(strip.values(x, y, place + 1)[s], wy.data());
                    const float w = wy[row + border - y];
                    for (std::size_t i = 0; i <= 2 * border; ++i)
                        if (x + i >= border && x + i - border < strip.width)
                            take(x, y, s, row * strip.width + x + i - border, w * wx[i]);
                }
    });
}

} // namespace

void AovSums::take_filtered(const HitStrip &strip) {
    const std::size_t of_pixel = strip.samples * channels_;
    std::vector<float> values((strip.end_row - strip.first_row) * width_ * of_pixel);
    tbb::parallel_for(strip.first_row, strip.end_row, [&](std::size_t y) {
        for (std::size_t x = 0; x < width_; ++x)
            write_values(strip, x, y, &values[((y - strip.first_row) * width_ + x) * of_pixel]);
    });
    for_each_splat(
        strip, filter_, height_,
        [&](std::size_t x, std::size_t y, std::size_t sample, std::size_t target, float weight) {
            const float *value = values.data() + ((y - strip.first_row) * width_ + x) * of_pixel +
                                 sample * channels_;
            float *sum = sums_.data() + target * channels_;
            for (std::size_t c = 0; c < channels_; ++c)
                sum[c] += weight * value[c];
            weight_[target] += weight;
        });
}

void AovSums::take_matte(const HitStrip &strip) {
    struct Names {
        int object, bsdf;
    };
    std::vector<Names> names((strip.end_row - strip.first_row) * width_ * strip.samples);
    tbb::parallel_for(strip.first_row, strip.end_row, [&](std::size_t y) {
        Names *out = &names[(y - strip.first_row) * width_ * strip.samples];
        for (std::size_t x = 0; x < width_; ++x)
            for (std::size_t s = 0; s < strip.samples; ++s) {
                const SampleOfPixel sample{strip, x, y, s};
                const std::int32_t prim = sample.prim();
                const int bsdf =
                    prim < 0 ? -1 : table_.range_of(static_cast<std::uint32_t>(prim)).bsdf;
                *out++ = {object_number(sample, table_) - 1, bsdf};
            }
    });
    const auto add = [](std::vector<MattePair> &pairs, int name, float weight) {
        if (name < 0)
            return;
        const auto known = std::find_if(pairs.begin(), pairs.end(),
                                        [&](const MattePair &pair) { return pair.name == name; });
        if (known == pairs.end())
            pairs.push_back({name, weight});
        else
            known->weight += weight;
    };
    for_each_splat(
        strip, filter_, height_,
        [&](std::size_t x, std::size_t y, std::size_t sample, std::size_t target, float weight) {
            const Names name = names[((y - strip.first_row) * width_ + x) * strip.samples + sample];
            add(mattes_[0].pairs[target], name.object, weight);
            add(mattes_[1].pairs[target], name.bsdf, weight);
            weight_[target] += weight;
        });
    // The next strip's samples may still reach the last rows.
    rank_rows(strip.end_row - std::min(strip.end_row, static_cast<std::size_t>(filter_.border)));
}

/// Ranks the pairs of the rows up to `end`, and frees them.
void AovSums::rank_rows(std::size_t end) {
    const std::size_t first = ranked_rows_ * width_;
    ranked_rows_ = std::max(ranked_rows_, end);
    for (Matte &matte : mattes_)
        tbb::parallel_for(first, std::max(first, end * width_), [&](std::size_t pixel) {
            rank_matte(matte.pairs[pixel], weight_[pixel], matte.ids,
                       &matte.ranks[pixel * 2 * matte_ranks]);
            matte.pairs[pixel] = std::vector<MattePair>();
        });
}

namespace {

/// Channels [first, first + count) of `stride` in each pixel.
Image image_of(const std::vector<float> &values, std::size_t width, std::size_t height,
               std::size_t stride, std::size_t first, std::size_t count) {
    Image image;
    image.width = static_cast<int>(width);
    image.height = static_cast<int>(height);
    image.channels = static_cast<int>(count);
    image.f32.reserve(width * height * count);
    for (std::size_t pixel = 0; pixel < width * height; ++pixel)
        for (std::size_t c = first; c < first + count; ++c)
            image.f32.push_back(values[pixel * stride + c]);
    return image;
}

} // namespace

std::vector<NamedLayer> AovSums::finish() {
    if (pass_ == AovPass::filtered)
        for (std::size_t pixel = 0; pixel < width_ * height_; ++pixel)
            for (std::size_t c = 0; c < channels_ && weight_[pixel] != 0; ++c)
                sums_[pixel * channels_ + c] /= weight_[pixel];
    std::vector<NamedLayer> layers;
    std::size_t first = 0;
    for (const Aov &aov : aovs_) {
        NamedLayer layer;
        for (const std::string &suffix : aov_suffixes(aov.type))
            layer.channels.push_back(aov.name + "." + suffix);
        layer.image = image_of(sums_, width_, height_, channels_, first, layer.channels.size());
        first += layer.channels.size();
        layers.push_back(std::move(layer));
    }
    rank_rows(height_);
    constexpr std::size_t of_layer = 4;
    for (const Matte &matte : mattes_)
        for (std::size_t c = 0; c < 2 * matte_ranks; c += of_layer) {
            const std::string name = matte.name + "0" + std::to_string(c / of_layer) + ".";
            layers.push_back(
                {{name + "R", name + "G", name + "B", name + "A"},
                 image_of(matte.ranks, width_, height_, 2 * matte_ranks, c, of_layer)});
        }
    return layers;
}

} // namespace clrender
