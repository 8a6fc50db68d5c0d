#include "gltf_document.h"

#include "../input_file.h"
#include "../log.h"
#include "../memory_limit.h"
#include "gltf_json.h"
#include "gltf_types.h"
#include "gltf_uri.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <limits>
#include <utility>

namespace clrender::gltf {

namespace {

using nlohmann::json;

/// What the readers make something of.
constexpr std::array known_extensions = {
    "KHR_draco_mesh_compression", "KHR_lights_punctual",
    "KHR_materials_clearcoat",    "KHR_materials_emissive_strength",
    "KHR_materials_ior",          "KHR_materials_sheen",
    "KHR_materials_specular",     "KHR_materials_transmission",
    "KHR_materials_unlit",        "KHR_materials_volume",
    "KHR_mesh_quantization",      "KHR_texture_transform"};

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
    std::uint32_t word = 0;
    for (std::size_t i = 4; i-- > 0;)
        word = word << 8 | static_cast<unsigned char>(bytes[at + i]);
    return word;
}

/// The JSON text of a file, and what a .glb file has behind it.
struct Chunks {
    std::string_view text, binary;
    bool is_binary = false;
};

Chunks chunks_of(std::string_view bytes, const std::string &path) {
    if (!bytes.starts_with("glTF"))
        return {bytes, {}, false};
    constexpr std::uint32_t json_chunk = 0x4e4f534a;
    constexpr std::uint32_t binary_chunk = 0x004e4942;
    const auto fail = [&](const std::string &what) { throw InputError({path, 0}, "GLB: " + what); };
    if (bytes.size() < 20)
        fail(fmt::format("{} bytes, expected a header of 12 and a chunk of JSON", bytes.size()));
    if (word_at(bytes, 4) != 2)
        fail(fmt::format("version {}, expected 2", word_at(bytes, 4)));
    const std::uint64_t length = word_at(bytes, 8);
    if (length > bytes.size())
        fail(
            fmt::format("the header promises {} bytes, but the file has {}", length, bytes.size()));
    Chunks chunks;
    chunks.is_binary = true;
    for (std::uint64_t at = 12; at + 8 <= length;) {
        const std::uint64_t size = word_at(bytes, at);
        const std::uint32_t type = word_at(bytes, at + 4);
        if (size > length - at - 8)
            fail(fmt::format("a chunk of {} bytes begins at byte {} of {}", size, at, length));
        const std::string_view content = bytes.substr(at + 8, size);
        if (at == 12 && type != json_chunk)
            fail("the first chunk is not JSON");
        if (at == 12)
            chunks.text = content;
        else if (type == binary_chunk && chunks.binary.data() == nullptr)
            chunks.binary = content;
        at += 8 + size;
    }
    if (chunks.text.empty())
        fail("the chunk of JSON is empty");
    return chunks;
}

/// A member that is an array, or null.
json *array_of(json &object, const char *name) {
    const auto found = object.find(name);
    return found != object.end() && found->is_array() ? &*found : nullptr;
}

void check_version(const json &root, const Document &document) {
    const auto asset = root.find("asset");
    const auto version = [&](const char *name) -> std::string {
        if (asset == root.end() || !asset->is_object() || !asset->contains(name) ||
            !(*asset)[name].is_string())
            return "";
        return (*asset)[name].get<std::string>();
    };
    if (version("version").empty())
        throw document.error("asset", "has no version, expected \"2.0\"");
    const std::string least = version("minVersion");
    if (!version("version").starts_with("2.") || (!least.empty() && least != "2.0"))
        throw document.error("asset", "version " + (least.empty() ? version("version") : least) +
                                          " of glTF, expected 2.0");
}

void check_extensions(json &root, const Document &document) {
    const auto is_known = [](const std::string &name) {
        return std::find(known_extensions.begin(), known_extensions.end(), name) !=
               known_extensions.end();
    };
    const auto each = [&](const char *list, const auto &use) {
        if (const json *names = array_of(root, list))
            for (const json &name : *names)
                if (name.is_string() && !is_known(name.get<std::string>()))
                    use(name.get<std::string>());
    };
    each("extensionsRequired", [&](const std::string &name) {
        throw document.error("extensionsRequired",
                             "the file needs " + name + ", which is not supported");
    });
    each("extensionsUsed", [&](const std::string &name) {
        document.warn("extensionsUsed", name + " is not supported and ignored");
    });
}

std::string resolved(const Document &document, const std::string &uri, const std::string &place) {
    const auto path = path_of_uri(uri);
    if (!path || path->empty())
        throw document.error(place, "the URI " + quoted_path(uri.substr(0, 200)) +
                                        " names no file beside this one");
    return (std::filesystem::path(document.path).parent_path() / *path).string();
}

std::string decoded(const Document &document, const std::string &uri, const std::string &place) {
    if (const std::string reason = claim_memory(uri.size()); !reason.empty())
        throw document.error(place, "its data " + reason);
    auto bytes = decode_data_uri(uri);
    if (!bytes)
        throw document.error(place, "broken data URI " + quoted_path(uri.substr(0, 60)) +
                                        ", expected base64 data");
    return std::move(*bytes);
}

std::string file_of(const Document &document, const std::string &path, std::uint64_t length,
                    const std::string &place) {
    const SourceLocation where{document.path, 0};
    InputFile file(path, where);
    if (file.size() < length)
        throw document.error(place, fmt::format("states {} bytes, but {} has {}", length,
                                                quoted_path(path), file.size()));
    if (const std::string reason = claim_memory(length); !reason.empty())
        throw document.error(place, reason);
    std::string bytes(length, '\0');
    bytes.resize(file.read(bytes.data(), bytes.size()));
    return bytes;
}

std::string uri_of(const json &object) {
    const auto uri = object.find("uri");
    return uri != object.end() && uri->is_string() ? uri->get<std::string>() : "";
}

void take_buffers(json &root, const Chunks &chunks, Document &document) {
    if (const json *list = array_of(root, "buffers"))
        for (const json &buffer : *list) {
            const int index = static_cast<int>(document.buffers.size());
            const std::string place = place_of("buffers", index);
            const auto stated = buffer.find("byteLength");
            if (!buffer.is_object() || stated == buffer.end() || !stated->is_number_unsigned())
                throw document.error(place, "has no byteLength, expected the number of its bytes");
            const auto length = stated->get<std::uint64_t>();
            const std::string uri = uri_of(buffer);
            std::string bytes;
            if (is_data_uri(uri))
                bytes = decoded(document, uri, place);
            else if (!uri.empty())
                bytes = file_of(document, resolved(document, uri, place), length, place);
            else if (chunks.is_binary && index == 0)
                bytes = chunks.binary;
            else
                throw document.error(place, "has no URI, expected one");
            if (bytes.size() < length)
                throw document.error(
                    place, fmt::format("states {} bytes, but {} has {}", length,
                                       uri.empty() ? "the binary chunk" : "its URI", bytes.size()));
            bytes.resize(length);
            document.buffers.push_back(std::move(bytes));
        }
    root.erase("buffers");
}

void take_images(json &root, Document &document) {
    if (const json *list = array_of(root, "images"))
        for (const json &image : *list) {
            const std::string place = place_of("images", static_cast<int>(document.images.size()));
            ImageSource source;
            const std::string uri = image.is_object() ? uri_of(image) : "";
            if (is_data_uri(uri))
                source.data = decoded(document, uri, place);
            else if (!uri.empty())
                source.file = resolved(document, uri, place);
            else if (image.is_object())
                if (const auto view = image.find("bufferView");
                    view != image.end() && view->is_number_unsigned())
                    source.buffer_view = static_cast<int>(std::min<std::uint64_t>(
                        view->get<std::uint64_t>(), std::numeric_limits<int>::max()));
            if (!source.is_there())
                throw document.error(place, "has neither a URI nor a bufferView, expected one");
            document.images.push_back(std::move(source));
        }
    root.erase("images");
}

/// tinygltf refuses indices without a buffer view, as compressed primitives have them; their
/// indices come with the compressed data.
void drop_compressed_indices(json &root) {
    json *meshes = array_of(root, "meshes");
    if (meshes == nullptr)
        return;
    for (json &mesh : *meshes)
        if (json *primitives = mesh.is_object() ? array_of(mesh, "primitives") : nullptr)
            for (json &primitive : *primitives)
                if (primitive.is_object() && primitive.contains("extensions") &&
                    primitive["extensions"].is_object() &&
                    primitive["extensions"].contains("KHR_draco_mesh_compression"))
                    primitive.erase("indices");
}

/// What tinygltf says, in one line.
std::string first_line(const std::string &text) {
    return text.substr(0, std::min(text.find('\n'), std::size_t{300}));
}

void parse_model(const json &root, Document &document) {
    const std::string text = root.dump();
    if (text.size() > std::numeric_limits<unsigned>::max())
        throw document.error("", "the JSON text is too long, expected less than 4 GiB");
    tinygltf::TinyGLTF parser;
    std::string fault;
    std::string warning;
    bool is_sound = false;
    try {
        is_sound = parser.LoadASCIIFromString(&document.model, &fault, &warning, text.data(),
                                              static_cast<unsigned>(text.size()), "");
    } catch (const std::exception &error) {
        fault = error.what();
    }
    if (!is_sound || !fault.empty())
        throw document.error("", fault.empty() ? "cannot be read as glTF" : first_line(fault));
    if (!warning.empty())
        document.warn("", first_line(warning));
}

} // namespace

void Document::warn(const std::string &place, const std::string &what) const {
    log::warn({path, 0}, place.empty() ? what : place + ": " + what);
}

std::string_view Document::view(int index, const std::string &place) const {
    const tinygltf::BufferView &view =
        element(*this, model.bufferViews, index, "bufferView", place);
    const std::string &bytes =
        element(*this, buffers, view.buffer, "buffer", place_of("bufferViews", index));
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
        throw error(place_of("bufferViews", index),
                    fmt::format("{} bytes from byte {} on, of a buffer of {}", view.byteLength,
                                view.byteOffset, bytes.size()));
    return std::string_view(bytes).substr(view.byteOffset, view.byteLength);
}

Document read_document(const std::string &path) {
    Document document;
    document.path = path;
    std::string bytes;
    {
        InputFile file(path);
        if (const std::string reason = claim_memory(file.size()); !reason.empty())
            throw document.error("", reason);
        bytes.resize(file.size());
        bytes.resize(file.read(bytes.data(), bytes.size()));
    }
    const Chunks chunks = chunks_of(bytes, path);
    if (chunks.text.empty())
        throw document.error("", "the file is empty, expected a glTF file");
    json root = parse_json(chunks.text, path, !chunks.is_binary);
    check_version(root, document);
    check_extensions(root, document);
    check_types(root, document);
    take_buffers(root, chunks, document);
    take_images(root, document);
    document.has_animations = array_of(root, "animations") != nullptr;
    root.erase("animations");
    drop_compressed_indices(root);
    parse_model(root, document);
    return document;
}

} // namespace clrender::gltf
