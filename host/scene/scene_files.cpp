#include "scene_files.h"

#include "../log.h"

#include <cmath>
#include <filesystem>
#include <fmt/core.h>
#include <utility>

namespace clrender {

namespace {

/// Refuses what is no number, which would spread over the whole picture, and takes what is negative
/// for black, as filters that ring leave it behind.
void check_values(Image &image, const std::string &path, const SourceLocation &referrer) {
    const SourceLocation where = referrer.file.empty() ? SourceLocation{path, 0} : referrer;
    const std::string subject = referrer.file.empty() ? "" : path + ": ";
    const auto channels = static_cast<std::size_t>(image.channels);
    const auto width = static_cast<std::size_t>(image.width);
    std::size_t negative = 0;
    for (std::size_t i = 0; i < image.f32.size(); ++i) {
        float &value = image.f32[i];
        if (!std::isfinite(value)) {
            const std::size_t pixel = i / channels;
            throw InputError(where, fmt::format("{}pixel ({}, {}) is {}, expected finite values",
                                                subject, pixel % width, pixel / width, value));
        }
        if (value < 0) {
            value = 0;
            ++negative;
        }
    }
    if (negative > 0)
        log::warn(where, fmt::format("{}{} negative values count as 0", subject, negative));
}

/// One of the ways to spell a path.
std::string normal(const std::string &path) {
    return std::filesystem::path(path).lexically_normal().string();
}

} // namespace

std::shared_ptr<const Image> SceneFiles::image(const std::string &path,
                                               const SourceLocation &where) {
    std::shared_ptr<const Image> &known = images_[normal(path)];
    if (!known) {
        const auto image = std::make_shared<Image>();
        reads_.add([image, path, where] {
            *image = read_image(path, where);
            check_values(*image, path, where);
        });
        known = image;
    }
    return known;
}

std::shared_ptr<const Mesh> SceneFiles::mesh(MeshFormat format, const std::string &path,
                                             const MeshReadOptions &options,
                                             const SourceLocation &where) {
    std::shared_ptr<const Mesh> &known =
        meshes_[{normal(path), format, options.face_normals, options.flip_tex_coords}];
    if (!known) {
        const auto mesh = std::make_shared<Mesh>();
        reads_.add([mesh, format, path, options, where] {
            *mesh = format == MeshFormat::obj ? read_obj_mesh(path, options, where)
                                              : read_ply_mesh(path, options, where);
        });
        known = mesh;
    }
    return known;
}

void SceneFiles::then(std::function<void()> check) {
    checks_.push_back(std::move(check));
}

void SceneFiles::read() {
    reads_.run();
    for (const auto &check : std::exchange(checks_, {}))
        check();
}

} // namespace clrender
