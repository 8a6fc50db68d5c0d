#pragma once
/// Cryptomatte (Friedman and Jones, "Fully automatic ID mattes with support for motion blur and
/// transparency", 2015; specification 1.2.0): ids are hashes of names, and each pixel has pairs of
/// an id and its coverage.

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace clrender {

/// MurmurHash3_x86_32 (Appleby) of a text, with seed 0.
std::uint32_t murmur_hash(std::string_view text);

/// The id of a name: the bits of a float that is finite and no denormal.
float cryptomatte_id(std::string_view name);

/// An id by the index of its name, and the sum of the weights of its samples.
struct MattePair {
    int name = -1;
    float weight = 0;
};

/// Pairs of a pixel that are written.
inline constexpr std::size_t matte_ranks = 6;

/// Ranks the pairs of a pixel by their coverage, weight / `total`, and puts the first matte_ranks
/// of them, id and coverage, into `out`; zeros behind the last. `ids` by name.
void rank_matte(std::vector<MattePair> &pairs, float total, const std::vector<float> &ids,
                float *out);

/// The attributes that an EXR file has for the layer `name`.
std::map<std::string, std::string> cryptomatte_metadata(const std::string &name,
                                                        const std::vector<std::string> &names);

} // namespace clrender
