#include "load_scene.h"

#include "../input_file.h"
#include "../log.h"
#include "../memory_limit.h"
#include "camera_place.h"
#include "gltf_scene.h"
#include "mitsuba_xml.h"
#include "model_scene.h"
#include "object_names.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace clrender {

namespace {

Scene read_scene(const std::string &path, const LoadOptions &options) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".xml")
        return load_mitsuba_xml(path, options);
    const bool is_gltf = extension == ".gltf" || extension == ".glb";
    if (!is_gltf && extension != ".obj" && extension != ".ply")
        throw InputError({path, 0},
                         "unknown kind of scene, expected a .xml, .gltf, .glb, .obj or .ply file");

    for (const auto &[name, value] : options.defines)
        log::warn(std::string("-D ").append(name).append(": nothing in ").append(path) +
                  " uses it");
    if (is_gltf)
        return load_gltf(path, options);
    if (options.sensor.value_or(0) != 0)
        throw InputError({path, 0},
                         "the model has a camera of its own alone, expected no --sensor");
    return load_model(path);
}

/// Bytes that the device's arrays take, on the host and on the device together, rounded up from
/// what meshes and maps have taken. A mesh counts for each shape that has it.
std::uint64_t flat_bytes_estimate(const Scene &scene) {
    constexpr std::uint64_t triangle_bytes = 250;
    constexpr std::uint64_t vertex_bytes = 40;
    constexpr std::uint64_t instance_bytes = 400;
    constexpr std::uint64_t texel_bytes_u8 = 8;
    constexpr std::uint64_t texel_bytes_f32 = 24;
    constexpr std::uint64_t map_bytes = 48;
    const auto pixels = [](const Image &image) {
        return static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height);
    };
    std::uint64_t bytes = 0;
    const auto add_meshes = [&](const std::vector<Shape> &shapes) {
        for (const Shape &shape : shapes)
            if (shape.mesh)
                bytes += triangle_bytes * shape.mesh->triangles.size() +
                         vertex_bytes * shape.mesh->positions.size();
    };
    add_meshes(scene.shapes);
    for (const ShapeGroup &group : scene.groups)
        add_meshes(group.shapes);
    bytes += instance_bytes * scene.instances.size();
    for (const Texture &texture : scene.textures)
        if (texture.bitmap)
            bytes += pixels(*texture.bitmap) *
                     (texture.bitmap->type == PixelType::u8 ? texel_bytes_u8 : texel_bytes_f32);
    for (const Emitter &emitter : scene.emitters)
        if (emitter.bitmap)
            bytes += map_bytes * pixels(*emitter.bitmap);
    return bytes;
}

} // namespace

Scene load_scene(const std::string &path, const LoadOptions &options) {
    forget_memory_claims();
    forget_input_files();
    Scene scene = read_scene(path, options);
    if (const std::string reason = claim_memory(flat_bytes_estimate(scene)); !reason.empty())
        throw InputError({path, 0}, "the scene " + reason);
    name_objects(scene);
    warn_of_enclosed_camera(scene);
    return scene;
}

} // namespace clrender
