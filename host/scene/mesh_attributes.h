#pragma once
/// The attributes of meshes that textures show.

#include "mesh_io.h"
#include "ply_header.h"

#include <array>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace clrender {

/// The attributes of a PLY file's vertices or faces on their way from its properties to a mesh.
/// They are named as Mitsuba names them: r, g, b or red, green, blue are "color"; runs of
/// properties NAME_0 NAME_1 NAME_2 (1 2 3, x y z) are "NAME", and NAME_r NAME_g NAME_b
/// "NAME_color".
class PlyAttributes {
public:
    /// `prefix` is "vertex_" or "face_"; values are kept of the attributes in `wanted`, and `path`
    /// is for warnings.
    PlyAttributes(const PlyElement &element, const std::string &prefix,
                  const std::set<std::string> &wanted, const std::string &path);

    /// Whether a property belongs to what is wanted.
    [[nodiscard]] bool wants(std::size_t property) const {
        return !places_.empty() && places_[property].attribute != none;
    }
    /// Takes such a property's value, which is finite.
    void set(std::size_t property, double value);
    /// To be called when all properties of an element have been set.
    void finish_element();

    [[nodiscard]] bool is_empty() const { return places_.empty(); }
    /// Bytes that the values of so many elements take.
    [[nodiscard]] std::uint64_t bytes(std::uint64_t elements) const;

    /// Hands the attributes over. With `element_of`, the element of each triangle, one value for
    /// each triangle.
    void move_to(Mesh &mesh, const std::vector<std::uint32_t> *element_of = nullptr);

private:
    struct Place {
        int attribute = none;
        std::size_t channel = 0;
    };

    void add(const std::string &name, const PlyElement &element,
             const std::vector<std::size_t> &properties, const std::set<std::string> &wanted);
    void add_colors(const PlyElement &element, const std::string &prefix,
                    const std::set<std::string> &wanted, const std::string &path);
    void add_runs(const PlyElement &element, const std::string &prefix,
                  const std::set<std::string> &wanted);

    std::vector<MeshAttribute> attributes_;
    std::vector<std::array<float, 3>> element_; ///< the values at hand, by attribute
    std::vector<Place> places_;                 ///< by property; empty: none is wanted
};

/// The attribute of that name, or null.
const MeshAttribute *find_attribute(const Mesh &mesh, const std::string &name);

/// The largest of an attribute's values.
double largest_value(const MeshAttribute &attribute);

/// Takes colours as displays show them, integers or from 0 to 1, to linear ones from 0 to 1.
void decode_colors(MeshAttribute &attribute);

} // namespace clrender
