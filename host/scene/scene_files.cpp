#include "scene_files.h"

#include "../log.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/core.h>
#include <utility>

namespace clrender {

namespace {

/// The largest finite value; 0 if there is none above.
float largest_of(const std::vector<float> &values) {
    float largest = 0;
    for (const float value : values)
        if (std::isfinite(value))
            largest = std::max(largest, value);
    return largest;
}

/// Values of one kind that a renderer cannot use.
struct BadValues {
    std::size_t count = 0;
    std::size_t first = 0; ///< index of a value

    void add(std::size_t i) {
        if (count++ == 0)
            first = i;
    }
};

/// Replaces what would spread over the whole picture, and says so: infinite values by the largest
/// finite one of the image, what is no number by 0. What is negative, as filters that ring leave it
/// behind, counts as 0 unless `keeps_negative`; silently where it is as small as rounding errors.
void repair_values(Image &image, const std::string &path, const SourceLocation &referrer,
                   bool keeps_negative) {
    const auto channels = static_cast<std::size_t>(image.channels);
    const auto width = static_cast<std::size_t>(image.width);
    const float largest = largest_of(image.f32);
    const float rounding = 0x1p-20F * largest;
    BadValues infinite;
    BadValues undefined;
    BadValues negative;
    for (std::size_t i = 0; i < image.f32.size(); ++i) {
        float &value = image.f32[i];
        if (std::isfinite(value) && (value >= 0 || keeps_negative))
            continue;
        if (std::isnan(value))
            undefined.add(i);
        else if (value > 0)
            infinite.add(i);
        else if (value < -rounding)
            negative.add(i);
        value = value > 0 ? largest : 0;
    }

    const bool is_named = !referrer.file.empty();
    const auto say = [&](const BadValues &bad, const std::string &what) {
        if (bad.count == 0)
            return;
        const std::size_t pixel = bad.first / channels;
        const std::string count =
            bad.count == 1 ? "1 value is" : fmt::format("{} values are", bad.count);
        log::warn(is_named ? referrer : SourceLocation{path, 0},
                  fmt::format("{}{} {} (pixel ({}, {}){})", is_named ? path + ": " : "", count,
                              what, pixel % width, pixel / width,
                              bad.count == 1 ? "" : " has the first"));
    };
    say(infinite, fmt::format("infinite, {} instead, the largest finite value", largest));
    say(undefined, "not a number, 0 instead");
    say(negative, "negative, 0 instead");
}

Mesh read_mesh(MeshFormat format, const std::string &path, const MeshReadOptions &options,
               const SourceLocation &where) {
    switch (format) {
    case MeshFormat::obj:
        return read_obj_mesh(path, options, where);
    case MeshFormat::ply:
        return read_ply_mesh(path, options, where);
    case MeshFormat::serialized:
        break;
    }
    return read_serialized_mesh(path, options, where);
}

/// One of the ways to spell a path.
std::string normal(const std::string &path) {
    return std::filesystem::path(path).lexically_normal().string();
}

} // namespace

void SceneFiles::read_into(Image &image, const std::function<Image()> &reader,
                           const std::string &path, const SourceLocation &where,
                           const ImageUse &use) {
    try {
        image = reader();
        repair_values(image, path, where, image.is_converted && !use.is_light);
    } catch (const InputError &error) {
        if (!use.is_optional)
            throw;
        // The error begins with the place, as the warning does.
        const std::string reason = error.what();
        log::warn(where, reason.substr(std::min(where.str().size() + 2, reason.size())) +
                             "; a plain colour is used");
    }
}

std::shared_ptr<const Image> SceneFiles::image(const std::string &path, const SourceLocation &where,
                                               const ImageUse &use) {
    return image([=] { return read_image(path, where, use.raw); }, path, where, use);
}

std::shared_ptr<const Image> SceneFiles::image_in_memory(std::string_view bytes,
                                                         const std::string &name,
                                                         const SourceLocation &where,
                                                         const ImageUse &use) {
    return image([=] { return decode_image(bytes, name, where, use.raw); }, name, where, use);
}

std::shared_ptr<const Image> SceneFiles::image(const std::function<Image()> &reader,
                                               const std::string &path, const SourceLocation &where,
                                               const ImageUse &use) {
    std::shared_ptr<const Image> &known =
        images_[{normal(path), use.raw, use.is_light, use.is_optional}];
    if (!known) {
        const auto image = std::make_shared<Image>();
        reads_.add(
            [image, reader, path, where, use] { read_into(*image, reader, path, where, use); });
        known = image;
    }
    return known;
}

std::shared_ptr<const Mesh> SceneFiles::mesh(MeshFormat format, const std::string &path,
                                             const MeshReadOptions &options,
                                             const SourceLocation &where) {
    std::shared_ptr<const Mesh> &known = meshes_[{normal(path), format, options.face_normals,
                                                  options.flip_tex_coords, options.shape_index}];
    if (!known) {
        const auto mesh = std::make_shared<Mesh>();
        reads_.add([this, mesh, format, path, options, where] {
            MeshReadOptions all = options;
            all.attributes = attributes_;
            *mesh = read_mesh(format, path, all, where);
        });
        known = mesh;
    }
    return known;
}

void SceneFiles::then(std::function<void()> check) {
    checks_.push_back(std::move(check));
}

void SceneFiles::read(bool all_faults) {
    reads_.run(all_faults);
    for (const auto &check : std::exchange(checks_, {}))
        check();
}

} // namespace clrender
