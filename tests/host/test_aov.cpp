/// Layers of first hits: what scenes ask for, how objects count, Cryptomatte, sums of records.

#include "film/aov_sums.h"
#include "film/cryptomatte.h"
#include "mitsuba_text_scene.h"
#include "scene/object_names.h"

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

using namespace clrender;

namespace {

std::string aov(const std::string &aovs) {
    return "<integrator type='aov'>\n<string name='aovs' value='" + aovs +
           "'/><integrator type='path' name='img'/><integrator type='direct'/></integrator>";
}

bool has(const std::string &text, const std::string &part) {
    return text.find(part) != std::string::npos;
}

/// Records of one row of pixels, of two samples each, at given places: depth 2 where the number is
/// not negative, which is that of the primitive.
struct Row {
    std::vector<float> records;
    HitStrip strip;

    Row(const std::vector<int> &prims, int aovs, float place) {
        strip.width = prims.size() / 2;
        strip.end_row = 1;
        strip.samples = 2;
        strip.aovs = aovs;
        records.resize(strip.runs() * strip.fields() * strip.stride());
        for (std::size_t i = 0; i < prims.size(); ++i) {
            const auto put = [&](std::size_t field, float value) {
                records[field * strip.stride() + i] = value;
            };
            put(0, std::bit_cast<float>(prims[i]));
            put(1, std::bit_cast<float>(-1));
            std::size_t field = 2;
            if ((aovs & CLR_AOV_DEPTH) != 0)
                put(field++, prims[i] >= 0 ? 2.0F : 0.0F);
            if ((aovs & CLR_AOV_PLACE) != 0) {
                put(field, place);
                put(field + 1, 0.5F);
            }
        }
        strip.records = records.data();
    }
};

HitTable two_objects() {
    HitTable table;
    table.ranges = {{0, 0, 1, false, {}}, {5, 1, 0, false, {}}};
    return table;
}

} // namespace

TEST_CASE("an aov integrator lists its layers", "[aov]") {
    const Scene scene = test::load_text(aov("a:depth, b.x:sh_normal,,c:prim_index d:albedo"));
    REQUIRE(scene.layers.aovs.size() == 4);
    CHECK(scene.layers.aovs[1].name == "b.x");
    CHECK(scene.layers.aovs[1].type == AovType::sh_normal);
    CHECK(scene.layers.aovs[3].type == AovType::albedo);
    REQUIRE(scene.layers.pictures.size() == 2);
    CHECK(scene.layers.pictures[0].name == "img");
    CHECK(scene.layers.pictures[1].name == "_arg_0");
    CHECK(scene.layers.pictures[1].integrator.kind == IntegratorKind::direct);
    CHECK(scene.integrator.kind == IntegratorKind::path);

    for (const char *wrong : {"depth", ":depth", "a:", "a:depth:b", "a : depth"})
        CHECK(has(test::error_of_text(aov(wrong)), "3: integrator \"aov\": \"aovs\""));
    CHECK(has(test::error_of_text(aov("a:dpeth")), "did you mean \"depth\"?"));
    CHECK(has(test::error_of_text(aov("a:boundary_test")),
              "3: integrator \"aov\": the type \"boundary_test\" is not supported"));
    CHECK(has(test::error_of_text(aov("a:depth,a:depth")), "\"a\" twice"));
}

// As Mitsuba 3.9.1 lists the shapes of such a scene.
TEST_CASE("shape indices count meshes last, from the last to the first", "[aov]") {
    const Scene scene = test::load_text(
        "<shape type='rectangle' id='r1'/><shape type='sphere' id='s1'/><shape type='cube' "
        "id='c1'/>"
        "<shape type='disk' id='d1'/><shape type='shapegroup' id='g'><shape type='cube'/></shape>"
        "<shape type='instance' id='i1'><ref id='g'/></shape><shape type='rectangle' id='r2'/>"
        "<shape type='sphere' id='s2'/><shape type='cube'/><shape type='sphere'/>");
    CHECK(scene.object_names ==
          std::vector<std::string>{"s1", "d1", "i1", "s2", "sphere_5", "cube_6", "r2", "c1", "r1"});
    CHECK(scene.instances.front().object == 2);
    for (const Shape &shape : scene.shapes)
        if (!shape.id.empty())
            CHECK(scene.object_names[static_cast<std::size_t>(shape.object)] == shape.id);
}

// Published vectors of MurmurHash3_x86_32 with seed 0.
TEST_CASE("Cryptomatte hashes names", "[aov]") {
    CHECK(murmur_hash("") == 0);
    CHECK(murmur_hash("test") == 0xba6bd213);
    CHECK(murmur_hash("Hello, world!") == 0xc0363e43);
    CHECK(murmur_hash("The quick brown fox jumps over the lazy dog") == 0x2e4ff723);
    for (int i = 0; i < 20000; ++i) {
        const float id = cryptomatte_id("object" + std::to_string(i));
        CHECK(std::isnormal(id));
    }
    const auto metadata = cryptomatte_metadata("crypto_object", {"ball", "a \"b\""});
    const std::string key = "cryptomatte/" + [] {
        char text[9];
        std::snprintf(text, sizeof(text), "%08x", murmur_hash("crypto_object"));
        return std::string(text, 7);
    }();
    CHECK(metadata.at(key + "/name") == "crypto_object");
    CHECK(metadata.at(key + "/hash") == "MurmurHash3_32");
    CHECK(metadata.at(key + "/conversion") == "uint32_to_float32");
    const auto manifest = nlohmann::json::parse(metadata.at(key + "/manifest"));
    CHECK(std::stoul(manifest.at("ball").get<std::string>(), nullptr, 16) ==
          std::bit_cast<std::uint32_t>(cryptomatte_id("ball")));
    CHECK(manifest.contains("a \"b\""));
}

TEST_CASE("layers by pixels have exact numbers", "[aov]") {
    const HitTable table = two_objects();
    // Pixels: twice object 1, half of it nothing, object 2 beside object 1, nothing.
    const Row row({0, 1, -1, 2, 7, 3, -1, -1}, CLR_AOV_DEPTH, 0.5F);
    AovSums sums(AovPass::boxed, {{"shape_index", AovType::shape_index}, {"d", AovType::depth}},
                 table, {}, 4, 1);
    sums.take(row.strip);
    const auto layers = sums.finish();
    REQUIRE(layers.size() == 2);
    CHECK(layers[0].channels == std::vector<std::string>{"shape_index.I"});
    CHECK(layers[0].image.f32 == std::vector<float>{1, 0, 2, 0});
    CHECK(layers[1].image.f32 == std::vector<float>{2, 2, 2, 0});
}

TEST_CASE("layers are filtered as pictures are", "[aov]") {
    const HitTable table = two_objects();
    // A tent of radius 1 in two steps: weights 1 up to half a pixel, .5 beyond.
    const SplatFilter filter{1, 1, {1.0F, 0.5F}};
    const Row row({0, 0, -1, -1, 7, 7}, CLR_AOV_DEPTH | CLR_AOV_PLACE, 0.75F);
    AovSums sums(AovPass::filtered, {{"d", AovType::depth}, {"n", AovType::shape_index}}, table,
                 filter, 3, 1);
    sums.take(row.strip);
    const auto layers = sums.finish();
    // A sample at .75 lies .25 from its own centre and .75 from that of the next pixel.
    const std::vector<float> depth = layers[0].image.f32, number = layers[1].image.f32;
    CHECK(depth[0] == Approx(2));
    CHECK(depth[1] == Approx(2 * 0.5 / 1.5));
    CHECK(depth[2] == Approx(2 / 1.5));
    CHECK(number[1] == Approx(1 * 0.5 / 1.5));
    CHECK(number[2] == Approx(2 / 1.5));
}

TEST_CASE("mattes keep all pairs and rank them", "[aov]") {
    const HitTable table = two_objects();
    const SplatFilter filter{1, 1, {1.0F, 0.5F}};
    const Row row({0, 0, 7, 7, -1, -1}, CLR_AOV_PLACE, 0.75F);
    AovSums sums(AovPass::matte, {}, table, filter, 3, 1);
    sums.set_names({"first", "second"}, {"red", "blue"});
    sums.take(row.strip);
    const auto layers = sums.finish();
    REQUIRE(layers.size() == 6);
    CHECK(layers[0].channels.front() == "crypto_object00.R");
    const std::vector<float> &v = layers[0].image.f32;
    const float first = cryptomatte_id("first"), second = cryptomatte_id("second");
    CHECK(v[0] == first);
    CHECK(v[1] == 1);
    CHECK(v[4] == second);
    CHECK(v[5] == Approx(1 / 1.5));
    CHECK(v[6] == first);
    CHECK(v[7] == Approx(0.5 / 1.5));
    CHECK(v[8] == second);
    CHECK(v[9] == Approx(0.5 / 1.5)); // the rest is nothing
    CHECK(v[10] == 0);
    CHECK(layers[3].channels.front() == "crypto_material00.R");
    CHECK(layers[3].image.f32[0] == cryptomatte_id("blue"));
}
