#pragma once
/// From records of first hits to the layers beside a picture.

#include "cryptomatte.h"
#include "hit_strip.h"
#include "hit_table.h"
#include "image/image.h"
#include "scene/aov.h"

#include <string>
#include <utility>
#include <vector>

namespace clrender {

/// The depth of pixels that show nothing, as Blender has it.
inline constexpr float no_depth = 1e10F;

/// A layer with the full names of its channels.
struct NamedLayer {
    std::vector<std::string> channels;
    Image image;
};

/// What a pass over the picture is for.
enum class AovPass {
    filtered, ///< means by the reconstruction filter, as in Mitsuba
    boxed,    ///< by pixels, numbers of what most samples meet
    matte,    ///< Cryptomatte, by the reconstruction filter
};

/// The filter's weight of a sample for a pixel, one axis: a step function of the distance.
struct SplatFilter {
    int border = 0;            ///< pixels beyond its own that a sample reaches
    double radius = 0.5;       ///< where it ends, pixels
    std::vector<float> values; ///< by steps out to the radius; empty: a box of one pixel

    /// Of the pixels -border ... border around that of the sample, which lies `d` into it.
    void weights(float d, float *out) const;
};

/// Takes the records of a picture strip by strip, from top to bottom. What becomes of them depends
/// on nothing but the records.
class AovSums {
public:
    AovSums(AovPass pass, std::vector<Aov> aovs, const HitTable &table, SplatFilter filter,
            std::size_t width, std::size_t height);
    /// `object_names` and `bsdf_names` by the table's indices: of mattes.
    void set_names(std::vector<std::string> object_names, std::vector<std::string> bsdf_names);

    /// The CLR_AOV_* that the records need.
    [[nodiscard]] int fields() const;
    void take(const HitStrip &strip);
    /// After all strips, or where there are to be no more. Pixels without samples are 0.
    std::vector<NamedLayer> finish();

private:
    struct Matte {
        std::string name;
        std::vector<std::string> names;
        std::vector<float> ids;
        std::vector<std::vector<MattePair>> pairs; ///< by pixel, of rows that are not yet ranked
        std::vector<float> ranks;                  ///< 2 * matte_ranks by pixel
    };

    void take_boxed(const HitStrip &strip, std::size_t y);
    void take_filtered(const HitStrip &strip);
    void take_matte(const HitStrip &strip);
    void rank_rows(std::size_t end);
    void write_values(const HitStrip &strip, std::size_t x, std::size_t y, float *out) const;

    AovPass pass_;
    std::vector<Aov> aovs_;
    const HitTable &table_;
    SplatFilter filter_;
    std::size_t width_, height_;
    std::size_t channels_ = 0;  ///< of all layers together
    std::vector<float> sums_;   ///< `channels_` by pixel
    std::vector<float> weight_; ///< by pixel: of all samples
    std::vector<Matte> mattes_; ///< objects, materials
    std::size_t ranked_rows_ = 0;
};

} // namespace clrender
