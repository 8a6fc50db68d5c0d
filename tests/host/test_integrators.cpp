/// Integrators that are rendered by path tracing, and those around another one.

#include "flatten/flat_scene.h"
#include "mitsuba_text_scene.h"
#include "stderr_of.h"

#include <catch2/catch.hpp>

using namespace clrender;

namespace {

bool has(const std::string &text, const std::string &part) {
    return text.find(part) != std::string::npos;
}

struct Loaded {
    Integrator integrator;
    std::string said;
};

Loaded load(const std::string &content) {
    Loaded loaded;
    loaded.said = test::stderr_of([&] { loaded.integrator = test::load_text(content).integrator; });
    return loaded;
}

std::string integrator(const std::string &type, const std::string &content = "") {
    return "<integrator type='" + type + "'>" + content + "</integrator>";
}

const char *const point_light = "<emitter type='point'/>";
const char *const mirror = "<shape type='sphere'><bsdf type='conductor'/></shape>";
const char *const leaf =
    "<shape type='disk'><bsdf type='mask'><bsdf type='diffuse'/></bsdf></shape>";

} // namespace

TEST_CASE("integrators of the same light are path tracing", "[integrators]") {
    for (const char *type :
         {"volpath", "volpathmis", "volpath_simple", "bdpt", "sppm", "ppm", "vcm", "ptracer",
          "photonmapper", "pssmlt", "mlt", "erpt", "guided_path"}) {
        CAPTURE(type);
        const Loaded loaded = load(integrator(
            type, "<integer name='max_depth' value='9'/><integer name='rr_depth' value='7'/>"
                  "<float name='initial_radius' value='.1'/><boolean name='light_image' "
                  "value='true'/><integer name='photon_count' value='1000'/>"));
        CHECK(loaded.integrator.kind == IntegratorKind::path);
        CHECK(loaded.integrator.max_depth == 9);
        CHECK(loaded.integrator.rr_depth == 7);
        CHECK(has(loaded.said, "scene.xml:2: warning: integrator \"" + std::string(type) +
                                   "\" is rendered by path tracing"));
        CHECK(load(integrator(type)).integrator.max_depth == -1);
        CHECK(loaded.integrator.skips_passages == has(type, "volpath"));
    }

    // Mitsuba's integrators for derivatives end after 6 segments where no depth is stated.
    for (const char *type : {"prb", "prb_basic", "prb_reparam", "prb_projective", "prbvolpath"}) {
        CHECK(load(integrator(type)).integrator.max_depth == 6);
        CHECK(
            load(integrator(type, "<integer name='max_depth' value='-1'/>")).integrator.max_depth ==
            -1);
    }
    CHECK(load(integrator("direct_projective")).integrator.kind == IntegratorKind::direct);
    CHECK(has(test::error_of_text(integrator("bdpt", "\n<integer name='max_depth' value='-2'/>")),
              "3: integrator \"bdpt\": \"max_depth\""));
    // What is written wrong is told, in place of a picture of other depth.
    for (const char *name : {"maxDepth", "max_dpth"})
        CHECK(has(test::error_of_text(integrator(
                      "volpath", "\n<integer name='" + std::string(name) + "' value='2'/>")),
                  "3: integrator \"volpath\" has the unknown property \"" + std::string(name) +
                      "\", did you mean \"max_depth\"?"));
}

TEST_CASE("caches around an integrator are left out", "[integrators]") {
    const std::string path = integrator("path", "<integer name='max_depth' value='4'/>");
    for (const char *type : {"irrcache", "adaptive"}) {
        const Loaded loaded = load(integrator(type, "<float name='quality' value='2'/>" + path));
        CHECK(loaded.integrator.kind == IntegratorKind::path);
        CHECK(loaded.integrator.max_depth == 4);
        CHECK(has(loaded.said,
                  "scene.xml:2: warning: integrator \"" + std::string(type) + "\" is left out"));
        CHECK(has(test::error_of_text(integrator(type)), "has 0 nested integrators, expected one"));
        CHECK(has(test::error_of_text(integrator(type, path + path)), "has 2 nested integrators"));
        CHECK(has(
            test::error_of_text(integrator(
                type, "\n" + integrator("aov", "<string name='aovs' value='d:depth'/>" + path))),
            "3: integrator \"aov\" is nested"));
        CHECK(has(test::error_of_text(
                      integrator(type, path + "\n<boolean name='indirect_only' value='true'/>")),
                  "3: \"indirect_only\" of integrator \"" + std::string(type) +
                      "\" is not supported"));
    }
    const Loaded photons = load(integrator("irrcache", integrator("photonmapper")));
    CHECK(photons.integrator.kind == IntegratorKind::path);
}

TEST_CASE("light that path tracing does not find is warned of", "[integrators]") {
    const char *const caustics = "(caustics)";
    CHECK(has(load(std::string(point_light) + mirror + integrator("bdpt")).said, caustics));
    CHECK_FALSE(has(load(std::string(point_light) + mirror + integrator("path")).said, caustics));
    CHECK_FALSE(has(load(std::string(point_light) + leaf + integrator("bdpt")).said, caustics));
    CHECK_FALSE(
        has(load(std::string(mirror) + "<emitter type='constant'/>" + integrator("sppm")).said,
            caustics));

    for (const char *smooth :
         {"<bsdf type='principled'><float name='roughness' value='0'/></bsdf>",
          "<bsdf type='principled'><float name='roughness' value='.05'/><float name='spec_trans' "
          "value='1'/></bsdf>",
          "<bsdf type='principledthin'><float name='roughness' value='0'/></bsdf>",
          "<bsdf type='roughconductor'><float name='alpha' value='0'/></bsdf>",
          "<bsdf type='roughdielectric'><float name='alpha' value='.001'/></bsdf>",
          "<bsdf type='roughplastic'><float name='alpha' value='0'/></bsdf>"})
        CHECK(has(load(std::string(point_light) + "<shape type='sphere'>" + smooth + "</shape>" +
                       integrator("bdpt"))
                      .said,
                  caustics));
    for (const char *rough :
         {"<bsdf type='principled'/>", "<bsdf type='roughconductor'/>",
          "<bsdf type='roughconductor'><float name='alpha_u' value='0'/><float name='alpha_v' "
          "value='.2'/></bsdf>",
          "<bsdf type='roughplastic'/>"})
        CHECK_FALSE(has(load(std::string(point_light) + "<shape type='sphere'>" + rough +
                             "</shape>" + integrator("bdpt"))
                            .said,
                        caustics));

    const char *const shines = "do not shine through";
    CHECK(has(load(std::string(leaf) + point_light + integrator("volpath")).said, shines));
    CHECK_FALSE(has(load(leaf + integrator("volpath")).said, shines));
}

TEST_CASE("layers around a picture", "[integrators]") {
    const std::string path = integrator("path", "<integer name='max_depth' value='4'/>");
    const Loaded aov =
        load(integrator("aov", "<string name='aovs' value='dd.y:depth,nn:sh_normal'/>" + path));
    CHECK(aov.integrator.max_depth == 4);
    CHECK(load(integrator("moment", path)).integrator.max_depth == 4);
    const std::string aovs = "<string name='aovs' value='dd:depth'/>";
    const Loaded two = load(integrator("aov", aovs + path + integrator("direct")));
    CHECK(two.integrator.max_depth == 4);
    CHECK(has(test::error_of_text(integrator("aov", path)), "2: integrator \"aov\" has no string"));
    const Loaded none = load(integrator("aov", aovs));
    CHECK(none.integrator.max_depth == 0);
    CHECK(has(none.said, "2: warning: integrator \"aov\" has no nested integrator: the picture"));
    CHECK(has(test::error_of_text(integrator("moment")), "2: integrator \"moment\" has no nested"));
    CHECK(has(test::error_of_text("<integrator type='aov' id='a'><string name='aovs' "
                                  "value=''/><ref id='a'/></integrator>"),
              "is nested, expected a path integrator inside"));
}

TEST_CASE("paths of no edges bring nothing", "[integrators]") {
    const std::string content =
        "<sensor type='perspective'><film type='hdrfilm'><string name='pixel_format' "
        "value='rgba'/></film></sensor><shape type='sphere'><emitter type='area'/></shape>"
        "<emitter type='constant'/><emitter type='point'/>";
    for (const char *depth : {"0", "1"}) {
        const Scene scene = test::load_text(
            content +
            integrator("path", std::string("<integer name='max_depth' value='") + depth + "'/>"));
        FlatScene flat;
        const std::string said = test::stderr_of([&] { flat = flatten(scene); });
        const bool black = *depth == '0';
        CHECK(has(said, "max_depth 0 leaves no light: the picture is black") == black);
        CHECK(flat.lights.empty() == black);
        CHECK(flat.emitters.empty() == black);
        CHECK((flat.shapes.at(0).emitter == CLR_NONE) == black);
        CHECK((flat.facts.environment == CLR_ENVIRONMENT_NONE) == black);
        CHECK(flat.facts.has_alpha == !black);
    }
}
