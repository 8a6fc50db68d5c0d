#pragma once
/// BSDFs as scene files state them, one struct each. Indices are into Scene::textures for what may
/// be textured, into Scene::bsdfs for nested BSDFs; `none` for a colour means 1.

#include "../error.h"

#include <glm/glm.hpp>

#include <string>
#include <variant>

namespace clrender {

using Rgb = glm::dvec3;         ///< linear sRGB primaries, may exceed 1 for radiance
inline constexpr int none = -1; ///< "no such index"

struct DiffuseBsdf {
    int reflectance = none;
};

struct ConductorBsdf {
    int specular_reflectance = none;
    bool perfect_mirror = true; ///< material "none": the Fresnel factor is 1
    Rgb eta{0.0}, k{1.0};       ///< when not perfect_mirror
};

/// Refractive indices of both sides of a boundary; by default bk7 in air.
struct IndicesOfRefraction {
    double interior = 1.5046, exterior = 1.000277;
};

struct DielectricBsdf {
    IndicesOfRefraction ior;
    int specular_reflectance = none, specular_transmittance = none;
};

/// A sheet of a dielectric, so thin that it does not displace what passes.
struct ThinDielectricBsdf {
    IndicesOfRefraction ior;
    int specular_reflectance = none, specular_transmittance = none;
};

enum class MicrofacetKind { beckmann, ggx };

/// Roughness of a surface along dp/du and across; the textures hold numbers.
struct MicrofacetModel {
    MicrofacetKind kind = MicrofacetKind::beckmann;
    int alpha_u = none, alpha_v = none; ///< equal where the surface is isotropic
};

struct RoughConductorBsdf {
    MicrofacetModel microfacets;
    int specular_reflectance = none;
    int eta = none, k = none; ///< with eta 0 the Fresnel factor is 1
};

struct RoughDielectricBsdf {
    MicrofacetModel microfacets;
    IndicesOfRefraction ior;
    int specular_reflectance = none, specular_transmittance = none;
};

/// A diffuse base under a smooth boundary. By default polypropylene in air.
struct PlasticBsdf {
    IndicesOfRefraction ior{1.49, 1.000277};
    int diffuse_reflectance = none, specular_reflectance = none;
    bool nonlinear = false; ///< the hue of the base changes with each reflection inside
};

/// The same under a rough boundary.
struct RoughPlasticBsdf {
    PlasticBsdf plastic;
    MicrofacetKind microfacets = MicrofacetKind::beckmann;
    double alpha = 0.1;
};

/// What both of Burley's BSDFs have. All indices but that of the base colour are of numbers.
struct BurleyBsdf {
    int base_color = none, roughness = none, anisotropic = none;
    int spec_trans = none; ///< none, principled only: nothing passes
    int spec_tint = none, sheen = none, sheen_tint = none, flatness = none;
};

/// Burley's principled BSDF.
struct PrincipledBsdf : BurleyBsdf {
    int metallic = none, clearcoat = none, clearcoat_gloss = none;
    double eta = 1.5; ///< interior over exterior
};

/// Burley's thin principled BSDF.
struct PrincipledThinBsdf : BurleyBsdf {
    int eta = none;
    int diff_trans = none; ///< 0 to 2
};

/// All light passes.
struct NullBsdf {};

/// Light passes where the opacity, a number, is below 1.
struct MaskBsdf {
    int opacity = none;
    int nested = none;
};

/// (1 - weight) * first + weight * second.
struct BlendBsdf {
    int weight = none; ///< a number
    int first = none, second = none;
};

/// What normal and bump maps do at the horizon.
struct PerturbedNormals {
    bool flip_invalid = true; ///< turns normals over that wi sees from behind
    bool shadow = true;       ///< Conty Estevez et al., "A Microfacet-Based Shadowing Function to
                              ///< Solve the Bump Terminator Problem", Ray Tracing Gems 2019
};

struct NormalMapBsdf {
    int normalmap = none; ///< (n + 1) / 2 in the shading frame
    PerturbedNormals normals;
    int nested = none;
};

struct BumpMapBsdf {
    int height = none; ///< a number, in world units
    double scale = 1;
    PerturbedNormals normals;
    int nested = none;
};

struct TwosidedBsdf {
    int front = none, back = none; ///< equal if the file nests only one
};

template <typename First, typename... Models> using VariantBehind = std::variant<Models...>;
using BsdfModel = VariantBehind<void
#define CLR_PLUGIN(type, Model) , Model
#include "bsdf_plugins.def"
#undef CLR_PLUGIN
                                >;

struct Bsdf {
    BsdfModel model;
    std::string id;
    SourceLocation where;
};

struct Scene;

/// Whether a BSDF by itself, without those it nests, reflects or refracts some light so sharply
/// that what it throws of a small light are caustics.
bool is_mirror_like(const Scene &scene, const Bsdf &bsdf);

/// Whether light passes the surface, anywhere on it.
bool lets_light_through(const Scene &scene, int bsdf);

} // namespace clrender
