#include "unsupported.h"

#include <array>

namespace clrender::mitsuba {

namespace {

struct Unsupported {
    const char *tag, *type, *nearest;
};

constexpr const char *solid = "shapes without a medium inside";
constexpr const char *mesh = "a mesh: \"ply\" or \"obj\"";
constexpr const char *tubes = "a mesh of the tubes: \"ply\" or \"obj\"";
constexpr const char *camera = "\"perspective\"";

constexpr const char *sky = "\"sunsky\" for one moment";

constexpr std::array<Unsupported, 61> table{{
    {"bsdf", "phong", "\"roughplastic\""},
    {"bsdf", "ward", "\"roughconductor\""},
    {"bsdf", "coating", "\"plastic\""},
    {"bsdf", "roughcoating", "\"roughplastic\""},
    {"bsdf", "roughdiffuse", "\"diffuse\""},
    {"bsdf", "difftrans", "\"diffuse\""},
    {"bsdf", "hair", "\"roughconductor\""},
    {"bsdf", "measured", "\"roughconductor\""},
    {"bsdf", "pplastic", "\"roughplastic\""},
    {"bsdf", "polarizer", "\"null\""},
    {"bsdf", "circular", "\"null\""},
    {"bsdf", "retarder", "\"null\""},
    {"bsdf", "measured_polarized", "\"roughconductor\""},
    {"bsdf", "microfacet", "\"roughplastic\""},
    {"bsdf", "mixturebsdf", "\"blendbsdf\""},
    {"bsdf", "composite", "\"blendbsdf\""},
    {"bsdf", "hk", "\"diffuse\""},
    {"bsdf", "irawan", "\"diffuse\""},
    {"shape", "sdfgrid", mesh},
    {"shape", "bsplinecurve", tubes},
    {"shape", "linearcurve", tubes},
    {"shape", "hair", tubes},
    {"shape", "ellipsoids", "\"sphere\""},
    {"shape", "ellipsoidsmesh", "\"sphere\""},
    {"shape", "heightfield", mesh},
    {"shape", "deformable", mesh},
    {"emitter", "collimated", "\"spot\" with a small cutoff_angle"},
    {"emitter", "timed_sunsky", sky},
    {"sensor", "batch", "the sensors inside of it in its place, of which --sensor chooses one"},
    {"sensor", "radiancemeter", camera},
    {"sensor", "irradiancemeter", camera},
    {"sensor", "fluencemeter", camera},
    {"sensor", "distant", camera},
    {"sensor", "hdistant", camera},
    {"sensor", "mdistant", camera},
    {"sensor", "mradiancemeter", camera},
    {"sensor", "spherical", camera},
    {"sensor", "fisheye", camera},
    {"sensor", "telecentric", camera},
    {"sensor", "perspective_rdist", camera},
    {"sensor", "perspectiverdist", camera},
    {"medium", "homogeneous", solid},
    {"medium", "heterogeneous", solid},
    {"subsurface", "dipole", solid},
    {"subsurface", "singlescatter", solid},
    {"texture", "volume", "\"bitmap\""},
    {"texture", "gridtexture", "\"checkerboard\""},
    {"texture", "wireframe", "\"checkerboard\""},
    {"texture", "curvature", "\"bitmap\""},
    {"texture", "noise", "\"bitmap\""},
    {"film", "specfilm", "\"hdrfilm\""},
    {"integrator", "stokes", "the integrator inside of it"},
    {"integrator", "ao", "\"direct\""},
    {"integrator", "field", "\"depth\""},
    {"integrator", "multichannel", "the first integrator inside of it"},
    {"integrator", "vpl", "\"path\""},
    {"integrator", "singlescatter", "\"path\""},
    {"integrator", "volprim_rf_basic", "\"path\""},
    {"integrator", "volprim_tomography", "\"path\""},
    {"rfilter", "wsinc", "\"lanczos\""},
    {"rfilter", "sinc", "\"lanczos\""},
}};

} // namespace

std::string nearest_supported(const std::string &tag, const std::string &type) {
    for (const Unsupported &entry : table)
        if (tag == entry.tag && type == entry.type)
            return entry.nearest;
    return "";
}

} // namespace clrender::mitsuba
