#pragma once
/// <transform>: lookat, translate, rotate, scale and matrix, one applied after the other.

#include "mitsuba_parameters.h"
#include "xml_file.h"

#include <glm/glm.hpp>

namespace clrender::mitsuba {

/// Throws InputError if a number is bad, or an element or attribute unknown, or the result is not
/// finite or not affine. It may be singular.
glm::dmat4 parse_transform(pugi::xml_node transform, const XmlFile &file, Parameters &parameters);

/// The three numbers of x=, y=, z= (`missing` where not stated) or of value= (three, or one for
/// all).
glm::dvec3 parse_triple(pugi::xml_node node, const XmlFile &file, double missing);

/// Throws InputError unless every attribute of `node` is allowed and the required ones are there.
void check_attributes(pugi::xml_node node, const XmlFile &file,
                      const std::vector<std::string> &required,
                      const std::vector<std::string> &optional = {});

/// True if the 3x3 part of an affine transformation (or a to_uv matrix) has no inverse to speak of.
bool is_singular(const glm::dmat3 &matrix);

} // namespace clrender::mitsuba
