#include "film_sums.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace clrender {

namespace {

constexpr int alpha = 3;

/// The words of four integers, the lowest first.
template <int count> using Words = uint[count][4];

/// The integer times `unit`, a power of two; exact but for the last bits of a long double.
template <int count> long double value_of(const Words<count> &words, int channel, double unit) {
    const bool negative = words[count - 1][channel] >> 31U != 0;
    // The size of a negative number is its complement plus one.
    const uint flip = negative ? ~0U : 0U;
    long double size = 0;
    for (int i = count; i-- > 0;)
        size = size * 0x1p32L + static_cast<long double>(words[i][channel] ^ flip);
    size += static_cast<long double>(flip & 1U);
    return (negative ? -size : size) * static_cast<long double>(unit);
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

void add_weight(uint (&sum)[2], const uint (&part)[2]) {
    const std::uint64_t weight = joined(sum) + joined(part);
    sum[0] = static_cast<uint>(weight);
    sum[1] = static_cast<uint>(weight >> 32U);
}

} // namespace

FilmUnits::FilmUnits(int film_exponent)
    : colour(std::ldexp(1.0, CLR_COLOUR_LSB + film_exponent)),
      alpha(std::ldexp(1.0, CLR_COLOUR_LSB)),
      colour_first(std::ldexp(1.0, CLR_FIRST_LSB + film_exponent)),
      alpha_first(std::ldexp(1.0, CLR_FIRST_LSB)),
      colour_second(std::ldexp(1.0, CLR_SECOND_LSB + 2 * film_exponent)),
      alpha_second(std::ldexp(1.0, CLR_SECOND_LSB)) {}

double PixelSums::colour(int channel) const {
    return static_cast<double>(value_of<CLR_COLOUR_WORDS>(
        pixel_.colour, channel, channel == alpha ? units_.alpha : units_.colour));
}

double PixelSums::weight() const {
    constexpr double unit = 1.0 / (1 << -CLR_WEIGHT_LSB);
    return static_cast<double>(static_cast<std::int64_t>(joined(pixel_.weight))) * unit;
}

double PixelSums::mean(int channel) const {
    const double sum = weight();
    return sum != 0 ? colour(channel) / sum : 0;
}

double PixelMoments::weight() const {
    constexpr double unit = 1.0 / static_cast<double>(std::uint64_t{1} << -CLR_SQUARE_WEIGHT_LSB);
    return static_cast<double>(joined(moments_.weight)) * unit;
}

double PixelMoments::scatter(int channel, double mean) const {
    const long double first = value_of<CLR_FIRST_WORDS>(
        moments_.first, channel, channel == alpha ? units_.alpha_first : units_.colour_first);
    const long double second = value_of<CLR_SECOND_WORDS>(
        moments_.second, channel, channel == alpha ? units_.alpha_second : units_.colour_second);
    const auto m = static_cast<long double>(mean);
    const long double sum = second - m * (2 * first - m * static_cast<long double>(weight()));
    return std::max(static_cast<double>(sum), 0.0);
}

double variance_of_sum(const PixelMoments &moments, double weight, int channel, double mean) {
    const double squares = moments.weight();
    if (!(squares > 0))
        return 0;
    // The number of samples that count (Kish 1965, section 11.7), of which the mean takes one.
    const double count = std::max(weight * weight / squares, 1.5);
    return moments.scatter(channel, mean) * count / (count - 1);
}

void add_pixel(FilmPixel &sum, const FilmPixel &part) {
    add_words<CLR_COLOUR_WORDS>(sum.colour, part.colour);
    add_weight(sum.weight, part.weight);
    sum.samples += part.samples;
    sum.clamped += part.clamped;
}

void add_moments(FilmMoments &sum, const FilmMoments &part) {
    add_words<CLR_FIRST_WORDS>(sum.first, part.first);
    add_words<CLR_SECOND_WORDS>(sum.second, part.second);
    add_weight(sum.weight, part.weight);
}

} // namespace clrender
