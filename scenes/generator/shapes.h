#pragma once
#include "surface.h"
#include <cstdint>
#include <string>
#include <vector>

/// The names that make_shape knows.
std::vector<std::string> shape_names();

/// The shape of that name, about two units tall, standing on y = 0 where it has a foot. `triangles`
/// bounds the detail: waves shorter than a few edges are left out. Throws std::invalid_argument.
Surface make_shape(const std::string &name, double triangles, uint32_t seed);
