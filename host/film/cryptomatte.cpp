#include "cryptomatte.h"

#include <algorithm>
#include <bit>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace clrender {

std::uint32_t murmur_hash(std::string_view text) {
    constexpr std::uint32_t c1 = 0xcc9e2d51U, c2 = 0x1b873593U;
    const auto byte = [&](std::size_t i) {
        return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]));
    };
    const auto mixed = [](std::uint32_t k) { return std::rotl(k * c1, 15) * c2; };
    std::uint32_t h = 0;
    const std::size_t whole = text.size() / 4 * 4;
    for (std::size_t i = 0; i < whole; i += 4) {
        h ^= mixed(byte(i) | byte(i + 1) << 8 | byte(i + 2) << 16 | byte(i + 3) << 24);
        h = std::rotl(h, 13) * 5 + 0xe6546b64U;
    }
    std::uint32_t rest = 0;
    for (std::size_t i = text.size(); i > whole; --i)
        rest = rest << 8 | byte(i - 1);
    h ^= mixed(rest);
    h ^= static_cast<std::uint32_t>(text.size());
    h ^= h >> 16;
    h *= 0x85ebca6bU;
    h ^= h >> 13;
    h *= 0xc2b2ae35U;
    return h ^ h >> 16;
}

float cryptomatte_id(std::string_view name) {
    std::uint32_t hash = murmur_hash(name);
    // Exponents of 0 and 255 are those of denormals, infinities and NaNs.
    const std::uint32_t exponent = hash >> 23 & 255;
    if (exponent == 0 || exponent == 255)
        hash ^= 1U << 23;
    return std::bit_cast<float>(hash);
}

void rank_matte(std::vector<MattePair> &pairs, float total, const std::vector<float> &ids,
                float *out) {
    std::sort(pairs.begin(), pairs.end(), [](const MattePair &a, const MattePair &b) {
        return a.weight != b.weight ? a.weight > b.weight : a.name < b.name;
    });
    for (std::size_t i = 0; i < matte_ranks; ++i) {
        // Filters with negative lobes may leave less than nothing, or more than all.
        const bool has = i < pairs.size() && total > 0 && pairs[i].weight > 0;
        out[2 * i] = has ? ids[static_cast<std::size_t>(pairs[i].name)] : 0;
        out[2 * i + 1] = has ? std::min(pairs[i].weight / total, 1.0F) : 0;
    }
}

std::map<std::string, std::string> cryptomatte_metadata(const std::string &name,
                                                        const std::vector<std::string> &names) {
    nlohmann::json manifest = nlohmann::json::object();
    for (const std::string &entry : names)
        manifest[entry] =
            fmt::format("{:08x}", std::bit_cast<std::uint32_t>(cryptomatte_id(entry)));
    const std::string key = "cryptomatte/" + fmt::format("{:08x}", murmur_hash(name)).substr(0, 7);
    return {{key + "/name", name},
            {key + "/hash", "MurmurHash3_32"},
            {key + "/conversion", "uint32_to_float32"},
            {key + "/manifest",
             manifest.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)}};
}

} // namespace clrender
