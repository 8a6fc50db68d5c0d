#pragma once
/// From the objects of a scene file to a Scene. Each kind of object has its own .cpp file.

#include "mitsuba_document.h"
#include "mitsuba_properties.h"
#include "named_media.h"
#include "same_light.h"
#include "scene.h"
#include "scene_files.h"
#include "spectrum.h"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace clrender::mitsuba {

class SceneReader {
public:
    /// Where the document asks for all faults, what is wrong with one object does not keep the
    /// others from being read. `sensor`: the one to look through, counted from 0; else the first.
    explicit SceneReader(const Document &document, std::optional<int> sensor = {})
        : document_(document), all_faults_(document.all_faults), chosen_sensor_(sensor),
          faults_(document.faults) {}

    /// Throws InputError, with a line for each fault if all are asked for.
    Scene read();

private:
    // mitsuba_scene.cpp
    bool attempt(const std::function<void()> &step);
    void check_children(int object);
    void read_shapes(Properties &root);
    void read_scene_emitters(Properties &root);
    // mitsuba_objects.cpp
    /// Numbers what a shape of the scene has added to the shapes and instances.
    void number_object(int object, std::size_t first_shape, std::size_t first_instance);
    /// Those that are meshes, behind all others.
    void number_meshes();
    int name_object(int object);
    // mitsuba_scene.cpp
    void read_files();
    void read_view(Properties &root);
    void read_chosen_sensor(Properties &root);
    void check_other_sensors(Properties &root);
    void check_unused_media(Properties &root);
    void check_unused_bsdfs(Properties &root);
    void place_default_sensor();
    void warn_of_missing(Properties &root) const;

    // mitsuba_textures.cpp; all return indices into Scene::textures
    int add_constant(const Rgb &value);
    int read_texture(int object, SpectrumUse use);
    int read_new_texture(int object, SpectrumUse use);
    int read_bitmap(Properties &properties, SpectrumUse use);
    int read_checkerboard(Properties &properties, SpectrumUse use);
    // texture_channel.cpp
    std::shared_ptr<const Image>
    read_channel(Properties &properties, std::shared_ptr<const Image> source, TexelFormat format);
    // texture_scale.cpp
    int read_scaled_texture(Properties &properties, SpectrumUse use);
    // spectrum_objects.cpp
    int read_spectrum_object(Properties &properties, SpectrumUse use);
    int read_d65(Properties &properties, SpectrumUse use);
    // mitsuba_textures.cpp
    int read_raw_constant(Properties &properties, SpectrumUse use);
    // mitsuba_attributes.cpp
    int read_mesh_attribute(Properties &properties);
    /// Notes the attributes that a shape's textures show, to be checked when its mesh is read.
    void read_attributes_of(int object, Shape &shape);
    /// The colour or texture `name` of an object, or none.
    int read_colour(Properties &properties, const std::string &name, SpectrumUse use);
    /// The texture of the numbers `name`.
    int read_number(Properties &properties, const std::string &name, double fallback);
    /// The same as read_colour() where only one colour for the whole surface is supported.
    Rgb read_constant(Properties &properties, const std::string &name, SpectrumUse use,
                      const Rgb &fallback);

    // mitsuba_bsdfs.cpp; all return indices into Scene::bsdfs
    int read_bsdf(int object);
    std::vector<int> read_nested(Properties &properties, std::size_t count);
    int default_bsdf(double reflectance);
    BsdfModel read_model_of(const std::string &type, Properties &properties);
    // bsdf_<kind>.cpp
#define CLR_PLUGIN(type, Model) void read_model(Properties &properties, Model &bsdf);
#include "bsdf_plugins.def"
#undef CLR_PLUGIN
    /// The BSDF that a normal or bump map nests; it may not turn normals itself.
    int read_turned(Properties &properties);
    MicrofacetModel read_microfacets(Properties &properties);
    /// What dielectrics of all kinds multiply reflected and transmitted light with.
    template <typename Dielectric> void read_tints(Properties &properties, Dielectric &bsdf) {
        bsdf.specular_reflectance =
            read_colour(properties, "specular_reflectance", SpectrumUse::reflectance);
        bsdf.specular_transmittance =
            read_colour(properties, "specular_transmittance", SpectrumUse::reflectance);
    }
    /// What both principled BSDFs have.
    void read_model(Properties &properties, BurleyBsdf &bsdf);
    /// The texture of the numbers `name`, which are held to `most`.
    int read_share(Properties &properties, const std::string &name, double fallback,
                   double most = 1);

    // mitsuba_shapes.cpp
    void read_shape(int object);
    void read_sphere(Properties &properties, Shape &shape);
    void read_cylinder(Properties &properties, Shape &shape);
    void read_mesh_file(Properties &properties, Shape &shape);
    void read_surface(Properties &properties, Shape &shape);

    // mitsuba_instances.cpp
    int read_group(int object);
    void read_instance(int object);
    void finish_groups();

    // mitsuba_emitters.cpp
    void read_emitter(int object);
    int read_area_emitter(int object, int shape);
    void read_point(Properties &properties, Emitter &emitter);
    void read_envmap(Properties &properties, Emitter &emitter);
    // emitter_<kind>.cpp
    void read_spot(Properties &properties, Emitter &emitter);
    void read_sunsky(Properties &properties, Emitter &emitter);
    void read_directional(Properties &properties, Emitter &emitter);
    void read_projector(Properties &properties, Emitter &emitter);
    /// Fails where the texture `name` of a light is that of a mesh.
    void check_projected(const Properties &properties, const std::string &name, int texture) const;

    // mitsuba_sensor.cpp, mitsuba_film.cpp, mitsuba_integrator.cpp
    void read_sensor(int object);
    void read_sampler(int object);
    void read_film(int object);
    void read_integrator(int object);
    void read_wrapped_integrator(Properties &properties);
    void read_other_integrator(Properties &properties, const SameLight &other);
    // mitsuba_aov.cpp
    void read_layers(Properties &properties);

    const Document &document_;
    bool all_faults_;
    std::optional<int> chosen_sensor_;
    std::vector<std::string> faults_; ///< lines, each once
    struct NumberedMesh {
        int object;
        std::size_t shape;
    };
    std::vector<NumberedMesh> meshes_; ///< of the scene, in the file's order
    Scene scene_;
    bool load_images_ = true;  ///< off while objects that no shape uses are checked
    std::map<int, int> bsdfs_; ///< by object
    std::map<std::pair<int, SpectrumUse>, int> textures_;
    std::map<double, int> default_bsdfs_; ///< by reflectance
    std::set<int> open_bsdfs_, area_emitters_;
    SceneFiles files_;
    std::vector<std::size_t> shapes_from_files_; ///< places in Scene::shapes

    /// A group whose files may be still to read.
    struct ReadGroup {
        ShapeGroup shapes;
        std::vector<bool> from_files; ///< by `shapes`: a mesh file has it
        std::vector<Shape> copied;    ///< each instance adds one to the scene
    };
    std::vector<ReadGroup> read_groups_; ///< as Scene::groups
    std::map<int, int> groups_;          ///< by object
};

/// Fails where a colour is not what `use` allows; Mitsuba refuses an <rgb> reflectance above 1, but
/// lets floats and uniform spectra pass, of which a warning tells.
void check_range(const Properties &properties, const std::string &name, const Rgb &rgb,
                 SpectrumUse use, bool is_rgb);

/// Linear sRGB of a spectrum; warns where it had to be clamped. `what` is it for the message.
Rgb colour_of_spectrum(const Spectrum &spectrum, SpectrumUse use, const SourceLocation &where,
                       const std::string &what);

/// Whether read_spectrum_object() knows the type.
bool is_spectrum_type(const std::string &type);

/// The metal that a conductor names; it then states neither eta nor k.
std::optional<ComplexIor> read_metal(Properties &properties);
/// int_ior and ext_ior, numbers or names of media; those of `ior` where they are not stated.
IndicesOfRefraction read_iors(Properties &properties, IndicesOfRefraction ior = {});
PerturbedNormals read_perturbed_normals(Properties &properties);
/// The distribution of microfacets; how it is sampled changes the noise alone.
MicrofacetKind read_distribution(Properties &properties);

struct FieldOfView {
    double degrees;
    FovAxis axis;
};
/// `fov` and `fov_axis`, or `focal_length`, of cameras and projectors.
FieldOfView read_field_of_view(Properties &properties);

/// One of the reconstruction filters.
ReconstructionFilter read_filter(const Document &document, int object);

/// Gives a shape from a mesh file the normals that Mitsuba gives it after `to_world`.
void follow_transform(Shape &shape);

/// Fails where a sphere or a cylinder becomes so thin that float32 would say little of it.
void check_thickness(const Properties &properties, const Shape &shape);

/// What a light's texture or map is multiplied with; 1 where nothing is stated.
double read_emitter_scale(Properties &properties);

/// The world-space box around all shapes and instances; false if there are none.
bool bounds_of(const Scene &scene, glm::dvec3 &lowest, glm::dvec3 &highest);

} // namespace clrender::mitsuba
