/// The device functions against double precision: the checks of --self-test, at every width.

#include "cl_test_device.h"
#include "selftest/checks.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fmt/core.h>
#include <set>

using namespace clrender;
using namespace clrender::selftest;

namespace {

/// All widths share one program each, however many tests use it.
ProbeDevice &probes(int lanes) {
    static std::map<int, ProbeDevice> *const all = new std::map<int, ProbeDevice>;
    const auto found = all->find(lanes);
    if (found != all->end())
        return found->second;
    const char *number = std::getenv("CLRENDER_TEST_DEVICE");
    const DeviceEntry entry = choose_device(number != nullptr ? number : "0");
    // 10^6 rays a check in the stress suite.
    const double scale = test::small_tests() ? 1e-3 : test::full_stress() ? 1 : 0.05;
    return all->emplace(lanes, ProbeDevice(entry, lanes, embedded_kernel_sources(), scale))
        .first->second;
}

void expect(Checks (*check)(ProbeDevice &)) {
    const int lanes = GENERATE(1, 4, 8, 16);
    for (const Check &row : check(probes(lanes))) {
        const std::string line = describe(row);
        fmt::print("{} ({} lanes)\n", line, lanes);
        INFO(line);
        CHECK(row.passed());
    }
}

/// The embedded sources with one change.
std::vector<KernelSource> changed(const std::string &file, const std::string &from,
                                  const std::string &to) {
    std::vector<KernelSource> sources = embedded_kernel_sources();
    for (KernelSource &source : sources) {
        const std::size_t at = source.name == file ? source.text.find(from) : std::string::npos;
        if (at != std::string::npos) {
            source.text.replace(at, from.size(), to);
            return sources;
        }
    }
    FAIL("no '" << from << "' in " << file);
    return sources;
}

} // namespace

TEST_CASE("device functions: a wrong kernel fails the check of the function that is wrong") {
    struct Fault {
        const char *file, *from, *to; ///< the change
        Checks (*check)(ProbeDevice &);
        const char *function; ///< that has to fail, and no function beside it
    };
    const std::vector<Fault> faults{
        {"sphere.clh", "real near = along - root;", "real near = along - 0.999f * root;",
         check_spheres, "sphere_intersect"},
        {"planar.clh", "real t = -above / v3_dot(n, d);",
         "real t = 1.0001f * -above / v3_dot(n, d);", check_planars, "planar_intersect"},
        {"texture.clh", "return m < n ? m : period - 1 - m;", "return m < n ? m : period - m - 2;",
         check_textures, "texture_apply"},
        {"environment.clh", "lower - upper, upper);", "lower - upper, 1.01f * upper);",
         check_environment, "env_eval"},
        {"light.clh", "real drop = u1 * cap;", "real drop = u1 * u1 * cap;", check_lights,
         "light_sample_local"},
        {"sampling.clh", "*cosine = sqrt(1.0f - u2);", "*cosine = 1.0f - u2;", check_math,
         "sample_cosine"},
    };
    const char *number = std::getenv("CLRENDER_TEST_DEVICE");
    const DeviceEntry entry = choose_device(number != nullptr ? number : "0");
    for (const Fault &fault : faults) {
        ProbeDevice device(entry, 4, changed(fault.file, fault.from, fault.to), 0.05);
        std::set<std::string> wrong;
        for (const Check &row : fault.check(device))
            if (!row.passed())
                wrong.insert(row.function);
        INFO(fault.file << ": " << fault.to);
        CHECK(wrong == std::set<std::string>{fault.function});
    }
}

TEST_CASE("device functions: small mathematics", "[oclgrind][stress]") {
    expect(check_math);
}

TEST_CASE("device functions: random numbers", "[oclgrind][stress]") {
    expect(check_numbers);
}

TEST_CASE("random numbers are the same at every width", "[oclgrind]") {
    const std::size_t count = test::small_tests() ? 64 : 1 << 16;
    Random random(9);
    std::vector<std::uint32_t> groups(2 * count / probe_group), in(2 * count);
    for (std::uint32_t &value : groups)
        value = random.bits();
    for (std::uint32_t &value : in)
        value = random.bits();
    std::vector<float> narrow;
    for (const int lanes : {1, 4, 8, 16}) {
        ProbeDevice &device = probes(lanes);
        cl::Kernel kernel = device.kernel("probe_numbers");
        const cl::Buffer first = device.upload(groups);
        kernel.setArg(0, first);
        const std::vector<float> values = device.launch(kernel, 1, device.upload(in), count, 5);
        if (lanes == 1)
            narrow = values;
        CHECK(values == narrow);
    }
}

TEST_CASE("device functions: spheres", "[oclgrind][stress]") {
    expect(check_spheres);
}

TEST_CASE("device functions: rectangles and disks", "[stress]") {
    expect(check_planars);
}

TEST_CASE("device functions: camera rays", "[oclgrind][stress]") {
    expect(check_camera);
}

TEST_CASE("device functions: reconstruction filters", "[stress]") {
    expect(check_filters);
}

TEST_CASE("device functions: textures", "[oclgrind][stress]") {
    expect(check_textures);
}

TEST_CASE("device functions: environment maps", "[oclgrind][stress]") {
    expect(check_environment);
}

TEST_CASE("device functions: lights", "[oclgrind][stress]") {
    expect(check_lights);
}
