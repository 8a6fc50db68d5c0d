#pragma once
/// The parsed scene: plain structs in double precision, validated by the readers, with the defaults
/// of Mitsuba 3. Nothing here knows of OpenCL. Everything refers to everything else by index.

#include "../error.h"
#include "../image/texels.h"
#include "aov.h"
#include "bsdf.h"
#include "sky_model.h"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace clrender {

enum class TextureKind { constant, bitmap, checkerboard, attribute };
enum class TextureFilter { bilinear, nearest };
enum class TextureWrap { repeat, mirror, clamp };

/// A colour over a surface, looked up at to_uv * (u, v, 1). The first (top) row of a bitmap begins
/// at v = 0, texel (i, j) of w x h has its centre at ((i + .5) / w, (j + .5) / h). A checkerboard
/// shows color0 where the fractions of u and v lie both above or both below one half, else color1.
struct Texture {
    TextureKind kind = TextureKind::constant;
    bool is_number = false;              ///< one value is asked for, not a colour: the mean of a
                                         ///< constant one, the luminance of a bitmap, or a channel
    int channel = none;                  ///< 0 to 2: of a bitmap that is asked for a number
    Rgb value{0.5};                      ///< constant
    std::shared_ptr<const Image> bitmap; ///< bitmap; shared by all textures that name the same file
    TexelFormat format;                  ///< bitmap
    TextureFilter filter = TextureFilter::bilinear;
    TextureWrap wrap = TextureWrap::repeat;
    std::optional<TextureWrap> wrap_v; ///< along v, if it is another
    Rgb color0{0.4}, color1{0.2}; ///< checkerboard
    std::string attribute;        ///< attribute: its name, as MeshAttribute has it
    Rgb scale{1};                 ///< attribute, bitmap: what its values are multiplied with
    std::string product;          ///< attribute, bitmap: a second factor, an attribute's name
    std::string coordinates;      ///< bitmap: the attribute that is looked up in place of (u, v)
    std::optional<double> cutoff; ///< numbers: 1 from here on, 0 below
    glm::dmat3 to_uv{1.0};
};

/// What a mesh holds for textures: a colour or a number by vertex, which is interpolated, or by
/// triangle.
struct MeshAttribute {
    std::string name;          ///< begins with "vertex_" or "face_"
    std::size_t channels = 3;  ///< 1 or 3
    double whole = 0;          ///< of integers the largest that their type holds, else 0
    std::vector<float> values; ///< `channels` a vertex or triangle; empty: nothing asks for it
};

/// Whether an attribute of that name is one of faces.
bool is_face_attribute(const std::string &name);

/// An indexed triangle mesh in its own object space, before Shape::to_world.
struct Mesh {
    std::vector<glm::dvec3> positions;
    std::vector<glm::vec3> normals; ///< per vertex, unit length, or empty: flat
    std::vector<glm::vec2> uvs;     ///< per vertex, or empty
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<MeshAttribute> attributes;
    bool has_computed_normals = false; ///< the file states none: they are smooth_normals()
};

enum class ShapeKind { sphere, ellipsoid, cylinder, rectangle, disk, mesh };

/// A shape with its place, surface and light. Geometry, normals and (u, v) are Mitsuba's: the
/// rectangle is [-1,1]^2 in z = 0 with normal +z and uv in [0,1]^2, the disk is the unit disk in
/// z = 0, the sphere is |x| = 1 (its reader folds `center` and `radius` into to_world; it is an
/// ellipsoid where to_world is no similarity), the cylinder x^2 + y^2 = 1, 0 <= z <= 1, with no
/// caps. A cube is read as a mesh. World normals: rectangle, disk and vertex normals go through the
/// inverse transpose of to_world, also if it mirrors; a mesh without vertex normals takes them from
/// the order of its transformed vertices (mirrored, it turns inside out); those of spheres,
/// ellipsoids and cylinders point outwards, or inwards if to_world mirrors. Then flip_normals turns
/// shading and geometric normals over. An area light shines, and the front of a BSDF lies, where
/// the shading normal points.
struct Shape {
    ShapeKind kind = ShapeKind::sphere;
    glm::dmat4 to_world{1.0};
    std::shared_ptr<const Mesh> mesh;
    bool flip_normals = false;
    int bsdf = none;    ///< index; the readers give a default diffuse .5 BSDF to shapes without one
    int emitter = none; ///< index of an area emitter
    std::vector<int> attribute_textures; ///< those that it shows with attributes of its mesh
    int object = none;                   ///< index into Scene::object_names; in groups none
    std::string id;
    SourceLocation where;
};

/// Shapes that are shown by instances alone, as often as there are: rectangles and meshes, placed
/// in the group's own coordinates. None emits.
struct ShapeGroup {
    std::vector<Shape> shapes;
};

/// A group in a place of the scene. Normals go through the inverse transpose of `to_world`, also if
/// it mirrors, after all that the group's shapes do to them.
struct ShapeInstance {
    int group = none; ///< index
    glm::dmat4x3 to_world{1.0};
    int object = none; ///< index into Scene::object_names
};

enum class FovAxis { x, y, diagonal, smaller, larger };

enum class EmitterKind { point, area, constant, envmap, spot, directional, projector, sunsky };

/// What `sunsky` makes of its atmosphere; black where the sun is below the horizon.
struct SunSky {
    SkyDistribution sky;                     ///< scaled
    glm::dvec3 sun_direction{0.0, 0.0, 1.0}; ///< towards it, in the world
    double half_aperture = sun_half_angle;   ///< of the disk, radians
    Rgb sun_radiance{0.0};                   ///< of the disk
};

/// Spots and projectors shine along +z of their own space. A spot's texture covers the square
/// around its cone, u along +x and v along +y; a projector's picture lies as a camera's does, +y up
/// and +x to the left, its first row on top.
struct Emitter {
    EmitterKind kind = EmitterKind::area;
    /// Texture index. area; constant: a constant one; spot: what its light is multiplied with, or
    /// none; projector: a pi-th of the irradiance at distance 1, before `scale`.
    int radiance = none;
    Rgb intensity{0.0};        ///< point, spot: W/sr; directional: W/m^2
    glm::dvec3 position{0.0};  ///< point
    glm::dvec3 direction{0.0}; ///< directional: where its light goes, unit length
    double cutoff_angle = 20;  ///< spot: degrees from the axis, from where on it is dark
    double beam_width = 15;    ///< spot: degrees up to which it is brightest, at most cutoff_angle
    double fov = 52.2;         ///< projector: degrees along fov_axis
    FovAxis fov_axis = FovAxis::x;       ///< projector
    int shape = none;                    ///< area
    std::shared_ptr<const Image> bitmap; ///< envmap: latitude-longitude, at least 2 x 3 pixels
    bool raw = false;                    ///< envmap: u8 data are linear
    double scale = 1;                    ///< envmap, projector
    SunSky sunsky;                       ///< sunsky
    glm::dmat4 to_world{1.0};            ///< envmap, spot, projector, sunsky; +z of a sky is up
    SourceLocation where;
};

enum class SensorKind { perspective, thinlens, orthographic };

/// The camera looks along +z of its own space, +y up and +x to the left of the picture. Rays of an
/// orthographic one begin on z = 0, where the picture is two units wide.
struct Sensor {
    SensorKind kind = SensorKind::perspective;
    glm::dmat4 to_world{1.0};
    double fov = 52.2; ///< degrees along fov_axis; focal_length is folded into (fov, diagonal)
    FovAxis fov_axis = FovAxis::x;
    std::optional<double> near_clip, far_clip; ///< only where the file states them
    glm::dvec2 principal_point_offset{0.0};    ///< fractions of the film's width and height
    double aperture_radius = 0;                ///< thinlens
    double focus_distance = 1;                 ///< thinlens
    SourceLocation where;
};

enum class FilterKind { box, tent, gaussian, mitchell, catmullrom, lanczos };

/// Reconstruction filter; defaults are Mitsuba's.
struct ReconstructionFilter {
    FilterKind kind = FilterKind::gaussian;
    double radius = 1;             ///< tent (1)
    double stddev = 0.5;           ///< gaussian; its radius is 4 stddev
    double b = 1. / 3, c = 1. / 3; ///< mitchell
    int lobes = 3;                 ///< lanczos
};

enum class PixelFormat { luminance, luminance_alpha, rgb, rgba, xyz, xyza };

struct FilmSettings {
    int width = 768, height = 576;
    int crop_x = 0, crop_y = 0, crop_width = 0,
        crop_height = 0;        ///< resolved: never 0 after reading
    bool sample_border = false; ///< samples lie outside of the crop window as well, as far as the
                                ///< filter reaches
    ReconstructionFilter filter;
    PixelFormat pixel_format = PixelFormat::rgb;
    SourceLocation where;
};

enum class IntegratorKind { path, direct, depth };

struct Integrator {
    IntegratorKind kind = IntegratorKind::path;
    int max_depth = -1;          ///< path: edges of the longest path; -1 = unbounded
    std::optional<int> rr_depth; ///< path: roulette from this depth on; where none is stated, as a
                                 ///< weight window
    bool hide_emitters = false;
    bool skips_passages = false; ///< path: what lets light pass straight is no edge
    int emitter_samples = 1;     ///< direct
    int bsdf_samples = 1;        ///< direct
    SourceLocation where;
};

/// A picture that is a layer as well: that of an integrator inside of one for layers.
struct IntegratorLayer {
    std::string name;
    Integrator integrator;
};

/// What Mitsuba's integrators `aov` and `moment` add to a picture.
struct SceneLayers {
    std::vector<Aov> aovs;
    std::vector<IntegratorLayer> pictures; ///< the first one's is also the scene's picture
    bool moments = false;                  ///< of XYZ, the first and second ones of `pictures`
};

struct Scene {
    std::string name; ///< the scene file without folder and extension
    std::vector<Texture> textures;
    std::vector<Bsdf> bsdfs;
    std::vector<Shape> shapes;
    std::vector<ShapeGroup> groups;
    std::vector<ShapeInstance> instances;
    /// What shape indices count, in Mitsuba's order: what is no mesh, instances included, as in the
    /// file, then the meshes from last to first; rectangles are meshes. Ids, or made-up names.
    std::vector<std::string> object_names;
    std::vector<Emitter> emitters;
    Sensor sensor;
    FilmSettings film;
    Integrator integrator;
    SceneLayers layers;
    int sample_count = 16; ///< scene files that state none have 4, as in Mitsuba
};

} // namespace clrender
