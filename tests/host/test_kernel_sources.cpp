/// How the kernel's files become one text.

#include "device/kernel_program.h"
#include "error.h"

#include <catch2/catch.hpp>
#include <limits>
#include <regex>

using namespace clrender;

namespace {

int count_of(const std::string &text, const std::string &what) {
    int count = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
        ++count;
    return count;
}

} // namespace

TEST_CASE("headers with a guard are joined once, others wherever they are included", "[kernel]") {
    const std::vector<KernelSource> sources = {
        {"main.cl",
         "#include \"a.clh\"\n#include \"part.clh\"\n#include \"part.clh\"\nint last;\n"},
        {"a.clh",
         "#ifndef A\n#define A\n#include \"b.clh\"\n#include \"part.clh\"\nint a;\n#endif\n"},
        {"b.clh", "#ifndef B\n#define B\n#include \"a.clh\"\nint b;\n#endif\n"},
        {"part.clh", "int PART;\n#include \"part.clh\"\n#include \"b.clh\"\n"}};
    const std::string text = join_sources(sources, "main.cl");
    CHECK(count_of(text, "int a;") == 1);
    CHECK(count_of(text, "int b;") == 1);
    CHECK(count_of(text, "int PART;") == 3);
    CHECK(text.find("int b;") < text.find("int a;"));
    CHECK(text.find("#include") == std::string::npos);
    CHECK(text.find("#line 4 \"main.cl\"\nint last;") != std::string::npos);
}

TEST_CASE("a header that is not there is named", "[kernel]") {
    CHECK_THROWS_WITH(join_sources({{"main.cl", "#include \"none.clh\"\n"}}, "main.cl"),
                      Catch::Contains("none.clh"));
}

TEST_CASE("no literal of the kernels is subnormal in float32: devices may take it for 0") {
    const std::regex number("[0-9][0-9.]*e-[0-9]+");
    for (const KernelSource &source : embedded_kernel_sources())
        for (auto found = std::sregex_iterator(source.text.begin(), source.text.end(), number);
             found != std::sregex_iterator(); ++found) {
            const double value = std::stod(found->str());
            INFO(source.name << ": " << found->str());
            CHECK((value == 0 || value >= double{std::numeric_limits<float>::min()}));
        }
}
