#pragma once
/// Refractive indices by name.

#include "scene.h"

#include <optional>
#include <string>
#include <vector>

namespace clrender {

/// The index of a transparent medium ("water", "bk7"; capitals do not matter).
std::optional<double> named_ior(const std::string &name);

/// Real and imaginary part of the index of a metal, for red, green and blue.
struct ComplexIor {
    Rgb eta, k;
};

/// A metal or another opaque material ("Au", "Cu_palik"; capitals matter).
std::optional<ComplexIor> named_metal(const std::string &name);

/// All names, for error messages.
std::vector<std::string> named_ior_names();
std::vector<std::string> named_metal_names();

} // namespace clrender
