/// Mitsuba's own meshes (.serialized, versions 3 and 4): one or more in a file, each behind a
/// header of four bytes and compressed by zlib, with a dictionary of their places at the file's
/// end. All numbers are little-endian.

#include "../input_file.h"
#include "../log.h"
#include "../memory_limit.h"
#include "mesh_io.h"
#include "mesh_normals.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace clrender {

namespace {

constexpr std::uint16_t format_id = 0x041c;
constexpr std::uint64_t header_bytes = 4;

constexpr std::uint32_t flag_normals = 0x1;
constexpr std::uint32_t flag_uvs = 0x2;
constexpr std::uint32_t flag_colors = 0x8;
constexpr std::uint32_t flag_face_normals = 0x10;
constexpr std::uint32_t flag_double = 0x2000;

/// Vertices and triangles have numbers of 32 bits with a sign elsewhere.
constexpr std::uint64_t max_count = 0x7fffffff;
constexpr std::size_t max_name = 1 << 16;

/// No stream of DEFLATE holds more than so many bytes in one.
constexpr std::uint64_t max_expansion = 1032;

template <class T> T little_endian(const char *bytes) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes, sizeof(T));
    if (std::endian::native == std::endian::big)
        std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
}

/// The bytes of a mesh behind its header, decompressed as they are asked for.
class MeshStream {
public:
    /// The file is to stand behind the header; `left` bytes follow.
    MeshStream(InputFile &file, std::uint64_t left, std::string path)
        : file_(file), left_(left), path_(std::move(path)) {
        if (inflateInit(&stream_) != Z_OK)
            fail("does not fit into memory");
    }
    ~MeshStream() { inflateEnd(&stream_); }
    MeshStream(const MeshStream &) = delete;
    MeshStream &operator=(const MeshStream &) = delete;

    void read(char *bytes, std::size_t count);

    template <class T> T value() {
        std::array<char, sizeof(T)> bytes;
        read(bytes.data(), bytes.size());
        return little_endian<T>(bytes.data());
    }

    /// Fails where the rest of the file cannot hold so many bytes.
    void expect(std::uint64_t bytes) const {
        const std::uint64_t compressed = left_ + stream_.avail_in + 1;
        if (bytes / max_expansion > compressed)
            fail(fmt::format("{} bytes of mesh promised, but the file ends before", bytes));
    }

    [[noreturn]] void fail(const std::string &reason) const {
        throw InputError({path_, 0}, reason);
    }

private:
    InputFile &file_;
    std::uint64_t left_;
    std::string path_;
    z_stream stream_{};
    std::array<char, 1 << 16> input_{};
};

void MeshStream::read(char *bytes, std::size_t count) {
    while (count > 0) {
        if (stream_.avail_in == 0) {
            const std::uint64_t wanted = std::min<std::uint64_t>(left_, input_.size());
            const std::size_t got = file_.read(input_.data(), static_cast<std::size_t>(wanted));
            if (got == 0)
                fail("the file ends within its mesh");
            left_ -= got;
            stream_.next_in = reinterpret_cast<Bytef *>(input_.data());
            stream_.avail_in = static_cast<uInt>(got);
        }
        const auto piece = static_cast<uInt>(std::min<std::size_t>(count, 1U << 30));
        stream_.next_out = reinterpret_cast<Bytef *>(bytes);
        stream_.avail_out = piece;
        const int result = inflate(&stream_, Z_NO_FLUSH);
        const std::size_t done = piece - stream_.avail_out;
        bytes += done;
        count -= done;
        if (result == Z_STREAM_END && count > 0)
            fail("the mesh ends before all of its vertices and triangles");
        if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR)
            fail(fmt::format("the compressed mesh is damaged ({})",
                             stream_.msg != nullptr ? stream_.msg : "no zlib data"));
    }
}

/// Where a mesh begins, from the dictionary at the end of the file.
std::uint64_t find_mesh(InputFile &file, int index, int version, const std::string &path,
                        const SourceLocation &referrer) {
    const std::uint64_t word = version == 3 ? 4 : 8;
    std::array<char, 8> bytes{};
    const auto fail = [&](const std::string &reason) { throw InputError({path, 0}, reason); };
    if (file.size() < header_bytes + word + 4)
        fail("the file ends before its dictionary of meshes");
    file.seek(file.size() - 4);
    file.read(bytes.data(), 4);
    const auto count = little_endian<std::uint32_t>(bytes.data());
    if (count == 0 || count > (file.size() - header_bytes - 4) / word)
        fail(fmt::format("a dictionary of {} meshes, but the file is too short for it", count));
    if (static_cast<std::uint32_t>(index) >= count)
        throw InputError(referrer.file.empty() ? SourceLocation{path, 0} : referrer,
                         fmt::format("\"shape_index\" is {}, but {} has {} meshes, expected a "
                                     "number from 0 to {}",
                                     index, path, count, count - 1));
    const std::uint64_t dictionary = file.size() - 4 - word * count;
    file.seek(dictionary + word * static_cast<std::uint64_t>(index));
    file.read(bytes.data(), static_cast<std::size_t>(word));
    const std::uint64_t offset = version == 3 ? little_endian<std::uint32_t>(bytes.data())
                                              : little_endian<std::uint64_t>(bytes.data());
    if (offset >= dictionary || dictionary - offset < header_bytes)
        fail(
            fmt::format("mesh {} is said to begin at byte {}, where there is none", index, offset));
    return offset;
}

/// Reads the header at the place where the file stands; returns the version.
int read_header(InputFile &file, const std::string &path) {
    std::array<char, header_bytes> bytes{};
    if (file.read(bytes.data(), bytes.size()) < bytes.size() ||
        little_endian<std::uint16_t>(bytes.data()) != format_id)
        throw InputError({path, 0}, "not a .serialized file, expected one of Mitsuba");
    const auto version = little_endian<std::uint16_t>(bytes.data() + 2);
    if (version != 3 && version != 4)
        throw InputError({path, 0}, fmt::format("version {}, expected 3 or 4", version));
    return version;
}

/// Reads vectors of N numbers of either precision.
template <int N>
std::vector<glm::vec<N, double>> read_vectors(MeshStream &stream, std::uint64_t count,
                                              bool is_double, const char *what) {
    std::vector<glm::vec<N, double>> vectors(count);
    const std::size_t size = is_double ? sizeof(double) : sizeof(float);
    std::array<char, sizeof(double) * N> bytes;
    for (std::uint64_t i = 0; i < count; ++i) {
        stream.read(bytes.data(), size * N);
        for (int c = 0; c < N; ++c) {
            const char *at = bytes.data() + size * static_cast<std::size_t>(c);
            const double value =
                is_double ? little_endian<double>(at) : double{little_endian<float>(at)};
            if (!(std::abs(value) <= std::numeric_limits<float>::max()))
                stream.fail(fmt::format("the {} of vertex {} is {}, expected finite numbers", what,
                                        i, value));
            vectors[i][c] = value;
        }
    }
    return vectors;
}

void read_triangles(MeshStream &stream, std::uint64_t count, std::uint64_t vertices, Mesh &mesh) {
    mesh.triangles.resize(count);
    for (std::uint64_t i = 0; i < count; ++i)
        for (std::uint32_t &vertex : mesh.triangles[i]) {
            vertex = stream.value<std::uint32_t>();
            if (vertex >= vertices)
                stream.fail(fmt::format("triangle {} has the vertex {}, expected a number from 0 "
                                        "to {}",
                                        i, vertex, vertices - 1));
        }
}

/// Checks that so many vertices and triangles can be in the file, and claims their memory.
void claim_mesh(const MeshStream &stream, std::uint32_t flags, std::uint64_t vertices,
                std::uint64_t triangles) {
    if (vertices == 0 || vertices > max_count || triangles == 0 || triangles > max_count)
        stream.fail(fmt::format("{} vertices and {} triangles, expected from 1 to {}", vertices,
                                triangles, max_count));
    const std::uint64_t numbers = 3 + ((flags & flag_normals) != 0 ? 3U : 0U) +
                                  ((flags & flag_uvs) != 0 ? 2U : 0U) +
                                  ((flags & flag_colors) != 0 ? 3U : 0U);
    const std::uint64_t size = (flags & flag_double) != 0 ? sizeof(double) : sizeof(float);
    stream.expect(vertices * numbers * size + triangles * sizeof(Mesh::triangles[0]));
    // While vectors are read, they are there in double precision.
    if (const std::string reason = claim_memory(
            vertices * (numbers * sizeof(float) + 2 * sizeof(glm::dvec3) + sizeof(glm::vec3)) +
            triangles * sizeof(Mesh::triangles[0]));
        !reason.empty())
        stream.fail(reason);
}

/// Version 4 has a name before the counts.
void skip_name(MeshStream &stream) {
    for (std::size_t length = 0; stream.value<char>() != '\0'; ++length)
        if (length == max_name)
            stream.fail("the name of the mesh is longer than 64 KiB");
}

void read_vertices(MeshStream &stream, std::uint32_t flags, std::uint64_t count,
                   const MeshReadOptions &options, Mesh &mesh) {
    const bool is_double = (flags & flag_double) != 0;
    mesh.positions = read_vectors<3>(stream, count, is_double, "place");
    if ((flags & flag_normals) != 0)
        for (const glm::dvec3 &normal : read_vectors<3>(stream, count, is_double, "normal")) {
            const double length = glm::length(normal);
            mesh.normals.push_back(length > 0 ? glm::vec3(normal / length) : glm::vec3(0.0F));
        }
    if ((flags & flag_uvs) != 0)
        for (const glm::dvec2 &uv : read_vectors<2>(stream, count, is_double, "coordinates"))
            mesh.uvs.emplace_back(uv);
    if ((flags & flag_colors) == 0)
        return;
    MeshAttribute colors;
    colors.name = "vertex_color";
    for (const glm::dvec3 &color : read_vectors<3>(stream, count, is_double, "colour"))
        for (int c = 0; c < 3; ++c)
            if (options.attributes.count(colors.name) != 0)
                colors.values.push_back(static_cast<float>(color[c]));
    mesh.attributes.push_back(std::move(colors));
}

} // namespace

Mesh read_serialized_mesh(const std::string &path, const MeshReadOptions &options,
                          const SourceLocation &referrer) {
    InputFile file(path, referrer);
    int version = read_header(file, path);
    std::uint64_t offset = 0;
    if (options.shape_index > 0) {
        offset = find_mesh(file, options.shape_index, version, path, referrer);
        file.seek(offset);
        version = read_header(file, path);
    }

    MeshStream stream(file, file.size() - offset - header_bytes, path);
    const auto flags = stream.value<std::uint32_t>();
    if (version == 4)
        skip_name(stream);
    const auto vertices = stream.value<std::uint64_t>();
    const auto triangles = stream.value<std::uint64_t>();
    claim_mesh(stream, flags, vertices, triangles);

    Mesh mesh;
    read_vertices(stream, flags, vertices, options, mesh);
    read_triangles(stream, triangles, vertices, mesh);
    if ((flags & flag_face_normals) != 0 && !options.face_normals)
        log::warn(SourceLocation{path, 0},
                  "the flag of the file for face normals is ignored, as by "
                  "Mitsuba 3: \"face_normals\" of the shape says it");
    set_normals(mesh, options.face_normals);
    return mesh;
}

} // namespace clrender
