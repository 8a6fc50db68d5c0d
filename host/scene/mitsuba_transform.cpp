#include "mitsuba_transform.h"

#include "../log.h"
#include "mitsuba_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_access.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace clrender::mitsuba {

namespace {

std::string named(pugi::xml_node node, const std::string &attribute) {
    return "<" + std::string(node.name()) + "> " + attribute;
}

glm::dmat4 parse_translate(pugi::xml_node node, const XmlFile &file) {
    check_attributes(node, file, {}, {"x", "y", "z", "value"});
    return glm::translate(glm::dmat4(1), parse_triple(node, file, 0));
}

glm::dmat4 parse_scale(pugi::xml_node node, const XmlFile &file) {
    check_attributes(node, file, {}, {"x", "y", "z", "value"});
    return glm::scale(glm::dmat4(1), parse_triple(node, file, 1));
}

glm::dmat4 parse_rotate(pugi::xml_node node, const XmlFile &file) {
    check_attributes(node, file, {"angle"}, {"x", "y", "z", "value"});
    const glm::dvec3 axis = parse_triple(node, file, 0);
    const double angle =
        parse_number(file.where(node), named(node, "angle"), node.attribute("angle").value());
    if (!(glm::length(axis) > 0))
        throw InputError(file.where(node),
                         "the axis of <rotate> is 0 0 0, expected a direction, as in y=\"1\"");
    if (std::abs(glm::length(axis) - 1) > 1e-3)
        log::warn(file.where(node), "the axis of <rotate> is not of length 1: as in Mitsuba 3, the "
                                    "result is not a rotation");

    // Rodrigues' formula with the axis as it is.
    const double sine = std::sin(glm::radians(angle));
    const double cosine = std::cos(glm::radians(angle));
    const glm::dmat3 cross(0, axis.z, -axis.y, -axis.z, 0, axis.x, axis.y, -axis.x, 0);
    return glm::dmat4(glm::dmat3(cosine) + sine * cross +
                      (1 - cosine) * glm::outerProduct(axis, axis));
}

glm::dmat4 parse_matrix(pugi::xml_node node, const XmlFile &file) {
    check_attributes(node, file, {"value"});
    const std::vector<double> numbers =
        parse_numbers(file.where(node), named(node, "value"), node.attribute("value").value());
    if (numbers.size() != 9 && numbers.size() != 16)
        throw InputError(file.where(node), "<matrix> has " + std::to_string(numbers.size()) +
                                               " numbers, expected 16 or 9, row by row");
    const int side = numbers.size() == 16 ? 4 : 3;
    glm::dmat4 matrix(1);
    auto number = numbers.begin();
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column)
            matrix[column][row] = *number++;
    return matrix;
}

glm::dvec3 parse_point_list(pugi::xml_node node, const XmlFile &file, const char *attribute) {
    const std::vector<double> numbers =
        parse_numbers(file.where(node), named(node, attribute), node.attribute(attribute).value());
    if (numbers.size() != 3)
        throw InputError(file.where(node), named(node, attribute) + " has " +
                                               std::to_string(numbers.size()) +
                                               " numbers, expected 3");
    return {numbers[0], numbers[1], numbers[2]};
}

/// The up direction that Mitsuba takes where none is given: the first tangent of the orthonormal
/// basis around the view direction (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
glm::dvec3 default_up(const glm::dvec3 &n) {
    const double sign = std::copysign(1.0, n.z);
    const double a = -1 / (sign + n.z);
    return {1 + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x};
}

glm::dmat4 parse_lookat(pugi::xml_node node, const XmlFile &file) {
    check_attributes(node, file, {"origin", "target"}, {"up"});
    const glm::dvec3 origin = parse_point_list(node, file, "origin");
    const glm::dvec3 direction = glm::normalize(parse_point_list(node, file, "target") - origin);
    glm::dvec3 up(0);
    if (node.attribute("up"))
        up = parse_point_list(node, file, "up");
    if (up == glm::dvec3(0))
        up = default_up(direction);

    const glm::dvec3 left = glm::normalize(glm::cross(glm::normalize(up), direction));
    if (!std::isfinite(left.x + left.y + left.z))
        throw InputError(file.where(node), "<lookat> has no direction, expected a target away from "
                                           "the origin and an up that is not along the view");
    return {glm::dvec4(left, 0), glm::dvec4(glm::cross(direction, left), 0),
            glm::dvec4(direction, 0), glm::dvec4(origin, 1)};
}

} // namespace

glm::dvec3 parse_triple(pugi::xml_node node, const XmlFile &file, double missing) {
    const SourceLocation where = file.where(node);
    if (const pugi::xml_attribute value = node.attribute("value")) {
        if (node.attribute("x") || node.attribute("y") || node.attribute("z"))
            throw InputError(where, "<" + std::string(node.name()) +
                                        "> has both value and x, y, z, expected one of the two");
        const std::vector<double> numbers =
            parse_numbers(where, named(node, "value"), value.value());
        if (numbers.size() == 1)
            return glm::dvec3(numbers[0]);
        if (numbers.size() == 3)
            return {numbers[0], numbers[1], numbers[2]};
        throw InputError(where, named(node, "value") + " has " + std::to_string(numbers.size()) +
                                    " numbers, expected 3 or 1");
    }

    glm::dvec3 triple(missing);
    constexpr std::array<const char *, 3> names{"x", "y", "z"};
    for (int i = 0; i < 3; ++i) {
        const char *name = names.at(static_cast<std::size_t>(i));
        if (const pugi::xml_attribute attribute = node.attribute(name))
            triple[i] = parse_number(where, named(node, name), attribute.value());
    }
    return triple;
}

void check_attributes(pugi::xml_node node, const XmlFile &file,
                      const std::vector<std::string> &required,
                      const std::vector<std::string> &optional) {
    std::vector<std::string> allowed = required;
    allowed.insert(allowed.end(), optional.begin(), optional.end());
    const std::string element = "<" + std::string(node.name()) + ">";
    for (const pugi::xml_attribute attribute : node.attributes()) {
        const std::string name = attribute.name();
        if (std::find(allowed.begin(), allowed.end(), name) == allowed.end())
            throw InputError(file.where(node),
                             std::string("unknown attribute ").append(in_quotes(name)) + " of " +
                                 element + ", " + expected_one_of(name, allowed));
    }
    for (const std::string &name : required)
        if (!node.attribute(name.c_str()))
            throw InputError(file.where(node), std::string(element)
                                                   .append(" has no attribute \"")
                                                   .append(name)
                                                   .append("\", expected ")
                                                   .append(name)
                                                   .append("=\"...\""));
}

bool is_singular(const glm::dmat3 &matrix) {
    const double volume = glm::length(matrix[0]) * glm::length(matrix[1]) * glm::length(matrix[2]);
    return !(std::abs(glm::determinant(matrix)) > 1e-12 * volume);
}

glm::dmat4 parse_transform(pugi::xml_node transform, const XmlFile &file, Parameters &parameters) {
    using Parser = glm::dmat4 (*)(pugi::xml_node, const XmlFile &);
    static const std::map<std::string, Parser> parsers{{"translate", parse_translate},
                                                       {"scale", parse_scale},
                                                       {"rotate", parse_rotate},
                                                       {"matrix", parse_matrix},
                                                       {"lookat", parse_lookat}};

    // Each step is applied after those before it.
    glm::dmat4 result(1);
    for (const pugi::xml_node node : transform.children()) {
        if (node.type() != pugi::node_element)
            continue;
        const auto parser = parsers.find(node.name());
        if (parser == parsers.end()) {
            std::vector<std::string> names;
            names.reserve(parsers.size());
            for (const auto &[name, unused] : parsers)
                names.push_back(name);
            throw InputError(file.where(node), "unknown element " + in_quotes(node.name()) +
                                                   " in <transform>, " +
                                                   expected_one_of(node.name(), names));
        }
        parameters.substitute(node, file);
        result = parser->second(node, file) * result;
    }

    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!std::isfinite(result[column][row]))
                throw InputError(file.where(transform),
                                 "<transform> is not finite, expected smaller numbers");
    if (glm::row(result, 3) != glm::dvec4(0, 0, 0, 1))
        throw InputError(file.where(transform),
                         "<transform> has a perspective part, expected 0 0 0 1 in the last row");
    return result;
}

} // namespace clrender::mitsuba
