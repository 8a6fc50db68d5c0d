#include "film_sums.h"

#include <cmath>
#include <cstdint>

namespace clrender {

namespace {

constexpr int alpha = 3;

/// The words of four integers, the lowest first.
template <int count> using Words = uint[count][4];

/// The integer, rounded to a double, times 2^exponent.
template <int count> double value_of(const Words<count> &words, int channel, int exponent) {
    const bool negative = words[count - 1][channel] >> 31U != 0;
    // The size of a negative number is its complement plus one. Words of one sign, added from the
    // lowest on, lose nothing that a double would keep.
    std::uint64_t carry = negative ? 1 : 0;
    long double size = 0;
    for (int i = 0; i < count; ++i) {
        carry += negative ? ~words[i][channel] : words[i][channel];
        size += std::ldexp(static_cast<long double>(carry & 0xffffffffU), 32 * i);
        carry >>= 32U;
    }
    return static_cast<double>(std::ldexp(negative ? -size : size, exponent));
}

template <int count> void add_words(Words<count> &sum, const Words<count> &part) {
    for (int channel = 0; channel < 4; ++channel) {
        std::uint64_t carry = 0;
        for (int i = 0; i < count; ++i) {
            carry += std::uint64_t{sum[i][channel]} + part[i][channel];
            sum[i][channel] = static_cast<uint>(carry);
            carry >>= 32U;
        }
    }
}

std::uint64_t joined(const uint (&weight)[2]) {
    return std::uint64_t{weight[1]} << 32U | weight[0];
}

} // namespace

double PixelSums::colour(int channel) const {
    return value_of<CLR_COLOUR_WORDS>(pixel_.colour, channel,
                                      CLR_COLOUR_LSB + (channel == alpha ? 0 : exponent_));
}

double PixelSums::scatter(int channel) const {
    return value_of<CLR_SCATTER_WORDS>(pixel_.scatter, channel,
                                       CLR_SCATTER_LSB + (channel == alpha ? 0 : 2 * exponent_));
}

double PixelSums::weight() const {
    return std::ldexp(static_cast<double>(static_cast<std::int64_t>(joined(pixel_.weight))),
                      CLR_WEIGHT_LSB);
}

void add_pixel(FilmPixel &sum, const FilmPixel &part) {
    add_words<CLR_COLOUR_WORDS>(sum.colour, part.colour);
    add_words<CLR_SCATTER_WORDS>(sum.scatter, part.scatter);
    const std::uint64_t weight = joined(sum.weight) + joined(part.weight);
    sum.weight[0] = static_cast<uint>(weight);
    sum.weight[1] = static_cast<uint>(weight >> 32U);
    sum.samples += part.samples;
    sum.clamped += part.clamped;
}

} // namespace clrender
