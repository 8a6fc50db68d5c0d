#include "film_sums.h"

#include <cmath>
#include <cstdint>

namespace clrender {

namespace {

constexpr int alpha = 3;

/// The words of four integers, the lowest first.
template <int count> using Words = uint[count][4];

/// The integer times `unit`, a power of two; rounded once but for the last bits of a long double.
template <int count> double value_of(const Words<count> &words, int channel, double unit) {
    const bool negative = words[count - 1][channel] >> 31U != 0;
    // The size of a negative number is its complement plus one.
    const uint flip = negative ? ~0U : 0U;
    long double size = 0;
    for (int i = count; i-- > 0;)
        size = size * 0x1p32L + static_cast<long double>(words[i][channel] ^ flip);
    size += static_cast<long double>(flip & 1U);
    return static_cast<double>(negative ? -size : size) * unit;
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

FilmUnits::FilmUnits(int film_exponent)
    : colour(std::ldexp(1.0, CLR_COLOUR_LSB + film_exponent)),
      alpha(std::ldexp(1.0, CLR_COLOUR_LSB)),
      colour_scatter(std::ldexp(1.0, CLR_SCATTER_LSB + 2 * film_exponent)),
      alpha_scatter(std::ldexp(1.0, CLR_SCATTER_LSB)) {}

double PixelSums::colour(int channel) const {
    return value_of<CLR_COLOUR_WORDS>(pixel_.colour, channel,
                                      channel == alpha ? units_.alpha : units_.colour);
}

double PixelSums::scatter(int channel) const {
    return value_of<CLR_SCATTER_WORDS>(
        pixel_.scatter, channel, channel == alpha ? units_.alpha_scatter : units_.colour_scatter);
}

double PixelSums::weight() const {
    constexpr double unit = 1.0 / (1 << -CLR_WEIGHT_LSB);
    return static_cast<double>(static_cast<std::int64_t>(joined(pixel_.weight))) * unit;
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
