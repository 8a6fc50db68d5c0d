/// The light tree on the device: what it chooses, and that both ways to a probability agree.

#include "cl_test_device.h"
#include "device/kernel_config.h"
#include "flatten/light_tree.h"

#include <catch2/catch.hpp>
#include <map>
#include <random>

using namespace clrender;
using namespace clrender::test;

namespace {

struct Choices {
    std::vector<uint> light;
    std::vector<float> stated, found;
};

std::string options_for(int lanes, bool oriented) {
    KernelConfig config;
    config.LANES = lanes;
    config.LIGHT_COUNT = -1;
    config.HAS_ORIENTED_LIGHTS = oriented ? 1 : 0;
    return config.build_options();
}

Choices choose(const ClTestDevice &device, const LightTree &tree, bool oriented, int lanes,
               const std::vector<float> &points, const std::vector<float> &normals,
               const std::vector<float> &numbers) {
    cl::Kernel kernel(device.build("probes/light_tree_probes.cl", options_for(lanes, oriented)),
                      "probe_light_tree");
    const std::size_t count = numbers.size();
    const cl::Buffer light = device.allocate(count * sizeof(uint));
    const cl::Buffer stated = device.allocate(count * sizeof(float));
    const cl::Buffer found = device.allocate(count * sizeof(float));
    const cl::Buffer in[] = {device.upload<LightNode>(tree.nodes), device.upload<uint>(tree.trail),
                             device.upload<float>(points), device.upload<float>(normals),
                             device.upload<float>(numbers)};
    cl_uint argument = 0;
    for (const cl::Buffer &buffer : in)
        kernel.setArg(argument++, buffer);
    kernel.setArg(argument++, light);
    kernel.setArg(argument++, stated);
    kernel.setArg(argument++, found);
    kernel.setArg(argument++, static_cast<cl_uint>(count));
    const auto width = static_cast<std::size_t>(lanes);
    device.run(kernel, (count + width - 1) / width, 1);
    return {device.download<uint>(light, count), device.download<float>(stated, count),
            device.download<float>(found, count)};
}

/// Points and small patches in a cube, of very different intensity.
std::vector<LightExtent> random_lights(std::size_t count, bool oriented) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(-1, 1);
    std::normal_distribution<double> gauss;
    std::vector<LightExtent> lights(count);
    for (LightExtent &light : lights) {
        const glm::dvec3 center(place(random), place(random), place(random));
        light.lower = center - 0.01;
        light.upper = center + 0.01;
        light.intensity = std::exp(3 * gauss(random));
        light.axis = glm::normalize(glm::dvec3(gauss(random), gauss(random), gauss(random)));
        light.cosine = oriented ? 1 : -1;
    }
    return lights;
}

} // namespace

TEST_CASE("lights are chosen as often as their probability says", "[oclgrind]") {
    const ClTestDevice device;
    const bool oriented = GENERATE(false, true);
    const std::size_t light_count = 60;
    const auto lights = random_lights(light_count, oriented);
    const LightTree tree = build_light_tree(lights);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> place(-1.5f, 1.5f);
    const std::size_t count = small_tests() ? 64 : 20000;
    for (int point = 0; point < (small_tests() ? 2 : 12); ++point) {
        const glm::dvec3 p(place(random), place(random), place(random));
        const glm::dvec3 n =
            glm::normalize(glm::dvec3(place(random), place(random), place(random)));
        std::vector<float> points, normals, numbers;
        for (std::size_t i = 0; i < count; ++i) {
            for (int c = 0; c < 3; ++c) {
                points.push_back(static_cast<float>(p[c]));
                normals.push_back(static_cast<float>(n[c]));
            }
            numbers.push_back((static_cast<float>(i) + 0.5f) / static_cast<float>(count));
        }
        const Choices result =
            choose(device, tree, oriented, point % 2 == 0 ? 8 : 16, points, normals, numbers);
        std::map<uint, std::size_t> chosen;
        double stated_sum = 0;
        std::size_t lost = 0;
        for (std::size_t i = 0; i < count; ++i) {
            // A walk may end where bounds promise more than their lights keep.
            if (result.light[i] == CLR_NONE) {
                ++lost;
                continue;
            }
            REQUIRE(result.found[i] == Approx(result.stated[i]).epsilon(1e-4));
            if (chosen[result.light[i]]++ == 0)
                stated_sum += result.stated[i];
        }
        INFO("point " << point << (oriented ? ", oriented" : ""));
        for (std::size_t i = 0; i < count && !small_tests(); ++i) {
            if (result.light[i] == CLR_NONE)
                continue;
            const double expected = result.stated[i] * static_cast<double>(count);
            const double sigma = std::sqrt(expected);
            REQUIRE(std::abs(static_cast<double>(chosen[result.light[i]]) - expected) <
                    5 * sigma + 2);
        }
        const double lost_share = static_cast<double>(lost) / static_cast<double>(count);
        CHECK(lost_share < 0.3);
        CHECK(stated_sum < 1.001 - lost_share);
        if (!small_tests())
            CHECK(stated_sum > 0.99 - lost_share);
    }
}

TEST_CASE("all lights together have probability 1, and one that shines on a surface its part",
          "[oclgrind]") {
    const ClTestDevice device;
    const std::size_t light_count = small_tests() ? 9 : 300;
    const auto lights = random_lights(light_count, true);
    const LightTree tree = build_light_tree(lights);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-1, 1);
    const std::size_t point_count = small_tests() ? 2 : 200;
    std::vector<float> points, normals;
    std::vector<uint> trails;
    std::vector<char> reachable;
    for (std::size_t k = 0; k < point_count; ++k) {
        const glm::dvec3 p(place(random), place(random), place(random));
        const glm::dvec3 n =
            glm::normalize(glm::dvec3(place(random), place(random), place(random)));
        for (std::size_t i = 0; i < light_count; ++i) {
            for (int c = 0; c < 3; ++c) {
                points.push_back(static_cast<float>(p[c]));
                normals.push_back(static_cast<float>(n[c]));
            }
            trails.push_back(tree.trail[i]);
            const glm::dvec3 way = (lights[i].lower + lights[i].upper) * 0.5 - p;
            reachable.push_back(glm::dot(way, n) > 0 && glm::dot(-way, lights[i].axis) > 0);
        }
    }
    cl::Kernel kernel(device.build("probes/light_tree_probes.cl", options_for(8, true)),
                      "probe_light_probability");
    const std::size_t count = trails.size();
    const cl::Buffer out = device.allocate(count * sizeof(float));
    const cl::Buffer in[] = {device.upload<LightNode>(tree.nodes), device.upload<uint>(trails),
                             device.upload<float>(points), device.upload<float>(normals)};
    for (cl_uint i = 0; i < 4; ++i)
        kernel.setArg(i, in[i]);
    kernel.setArg(4, out);
    kernel.setArg(5, static_cast<cl_uint>(count));
    device.run(kernel, (count + 7) / 8, 1);
    const auto probability = device.download<float>(out, count);
    for (std::size_t k = 0; k < point_count; ++k) {
        double sum = 0;
        for (std::size_t i = k * light_count; i < (k + 1) * light_count; ++i) {
            sum += probability[i];
            INFO("point " << k << ", light " << i % light_count);
            REQUIRE((!reachable[i] || probability[i] > 0));
        }
        // A child that no light of its own can use may still be walked into: the rest goes there.
        CHECK(sum < 1 + 1e-4);
        CHECK(sum > 0.2);
    }
}

TEST_CASE("trees stay within their levels, and trails lead to their lights") {
    std::vector<LightExtent> same(3000);
    std::vector<LightExtent> apart(3000);
    double place = 1;
    for (std::size_t i = 0; i < same.size(); ++i) {
        same[i].intensity = apart[i].intensity = 1;
        place *= 0.99;
        apart[i].lower = apart[i].upper = glm::dvec3(place, 0, 0);
    }
    for (const auto &lights : {same, apart, random_lights(2, true), random_lights(777, true)}) {
        const LightTree tree = build_light_tree(lights);
        REQUIRE(tree.nodes.size() == lights.size() - 1);
        for (std::size_t i = 0; i < lights.size(); ++i) {
            uint node = 0;
            uint trail = tree.trail[i];
            int level = 0;
            while ((node & CLR_LIGHT_LEAF) == 0) {
                const LightBounds &bounds = tree.nodes[node].bounds[trail & 1];
                const glm::dvec3 center(bounds.center[0], bounds.center[1], bounds.center[2]);
                for (const glm::dvec3 &corner : {lights[i].lower, lights[i].upper}) {
                    const glm::dvec3 way = corner - center;
                    REQUIRE(glm::dot(way, way) <= bounds.radius2 * 1.0001 + 1e-12);
                }
                REQUIRE(bounds.intensity >= lights[i].intensity * 0.9999);
                node = bounds.child;
                trail >>= 1;
                ++level;
            }
            REQUIRE(level <= CLR_LIGHT_TREE_LEVELS);
            REQUIRE(node == (CLR_LIGHT_LEAF | static_cast<uint>(i)));
        }
    }
}
