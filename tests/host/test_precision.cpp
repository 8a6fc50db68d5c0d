/// Numbers in the kernels' text are the same in both precisions.

#include "device/kernel_sources.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <regex>
#include <string>
#include <vector>

using namespace clrender;

namespace {

/// What is left of a kernel's file in double precision.
std::string in_double(const std::string &text) {
    std::string left = std::regex_replace(text, std::regex(R"(CLR_EITHER\([^,]*,)"), "(");
    for (std::size_t at = left.find("#if CLR_DOUBLE"); at != std::string::npos;
         at = left.find("#if CLR_DOUBLE", at + 1)) {
        const std::size_t otherwise = left.find("#else", at);
        const std::size_t end = left.find("#endif", at);
        if (otherwise < end)
            left.erase(otherwise, end - otherwise);
    }
    return left;
}

/// The literals of type float whose value float32 rounds.
std::vector<std::string> rounded_literals(const std::string &text) {
    static const std::regex literal(
        R"((?:^|[^\w.])((?:0x[0-9a-fA-F.]+p[-+]?\d+|\d+\.?\d*(?:e[-+]?\d+)?)f)\b)");
    std::vector<std::string> found;
    for (std::sregex_iterator at(text.begin(), text.end(), literal), end; at != end; ++at) {
        const std::string value = at->str(1);
        if (std::strtod(value.c_str(), nullptr) != double{std::strtof(value.c_str(), nullptr)})
            found.push_back(value);
    }
    return found;
}

} // namespace

TEST_CASE("Literals that float32 rounds are told from others", "[kernel]") {
    const std::vector<std::string> rounded = {"0.1f", "1e-5f", "3.14159f"};
    CHECK(rounded_literals("a = 0.1f + 1e-5f - 0.5f * -3.14159f / 0x1p-24f + 1.0f;") == rounded);
    CHECK(in_double("CLR_EITHER(0.1f, 0.1)") == "( 0.1)");
    CHECK(in_double("#if CLR_DOUBLE\na\n#else\n0.1f\n#endif\nb") == "#if CLR_DOUBLE\na\n#endif\nb");
}

TEST_CASE("No number of the kernels is rounded to float32 in double precision", "[kernel]") {
    for (const KernelSource &source : embedded_kernel_sources()) {
        INFO(source.name);
        CHECK(rounded_literals(in_double(source.text)).empty());
    }
}
