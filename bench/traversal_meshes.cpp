#include "traversal_meshes.h"

#include "shapes.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/common.hpp>
#include <sstream>
#include <stdexcept>
#include <tbb/parallel_for.h>

namespace clrender::bench {

namespace {

/// Positions and faces of an OBJ file; polygons become fans.
Triangles read_obj(const std::string &path) {
    std::ifstream file(path);
    if (!file) {
        throw std::runtime_error("cannot read " + path);
    }
    std::vector<glm::vec3> vertices;
    Triangles triangles;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "v") {
            glm::vec3 &v = vertices.emplace_back();
            words >> v.x >> v.y >> v.z;
        } else if (word == "f") {
            std::vector<glm::vec3> corners;
            while (words >> word) {
                const long index = std::stol(word);
                const long count = long(vertices.size());
                corners.push_back(vertices.at(std::size_t(index > 0 ? index - 1 : count + index)));
            }
            for (std::size_t i = 2; i < corners.size(); ++i) {
                triangles.push_back({corners[0], corners[i - 1], corners[i]});
            }
        }
    }
    return triangles;
}

/// A grid over the unit square of the surface, two triangles a cell.
Triangles generate(const std::string &shape, double count) {
    const Surface surface = make_shape(shape, count, 1);
    const auto rows = std::size_t(std::max(4.0, std::round(std::sqrt(count / 2 / surface.aspect))));
    const auto columns = std::size_t(std::max(4.0, std::round(count / 2 / double(rows))));
    std::vector<glm::vec3> vertices((rows + 1) * (columns + 1));
    tbb::parallel_for(std::size_t(0), rows + 1, [&](std::size_t row) {
        for (std::size_t column = 0; column <= columns; ++column) {
            const Vec3 p = surface_point(surface, double(column % columns) / double(columns),
                                         double(row) / double(rows));
            vertices[row * (columns + 1) + column] = {float(p.x), float(p.y), float(p.z)};
        }
    });

    Triangles triangles;
    triangles.reserve(2 * rows * columns);
    for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t column = 0; column < columns; ++column) {
            const glm::vec3 *below = &vertices[row * (columns + 1) + column];
            const glm::vec3 *above = below + columns + 1;
            triangles.push_back({below[0], below[1], above[1]});
            triangles.push_back({below[0], above[1], above[0]});
        }
    }
    return triangles;
}

void normalize(Triangles &triangles) {
    glm::vec3 lower(1e30f), upper(-1e30f);
    for (const auto &t : triangles) {
        for (const glm::vec3 &v : t) {
            lower = glm::min(lower, v);
            upper = glm::max(upper, v);
        }
    }
    const glm::vec3 middle = 0.5f * (lower + upper);
    const glm::vec3 size = upper - lower;
    const float scale = 2.0f / std::max({size.x, size.y, size.z});
    for (auto &t : triangles) {
        for (glm::vec3 &v : t) {
            v = (v - middle) * scale;
        }
    }
}

} // namespace

Triangles load_mesh(const std::string &name) {
    const std::size_t colon = name.rfind(':');
    Triangles triangles = colon == std::string::npos
                              ? read_obj(name)
                              : generate(name.substr(0, colon), std::stod(name.substr(colon + 1)));
    normalize(triangles);
    return triangles;
}

} // namespace clrender::bench
