#pragma once
#include "surface.h"
#include <string>

// All throw std::runtime_error where a file cannot be read or written.

/// Paints the surface's colours over its texture square.
void write_texture(const Surface &surface, int width, int height, const std::string &path);

/// A latitude-longitude map (+y up) of a clear evening: a deep zenith, a warm horizon with thin
/// clouds and a soft sun, over a dim ground. Radiance HDR.
void write_sky(int width, int height, const std::string &path);

/// The picture with every pixel repeated `factor` times in both directions.
void enlarge(const std::string &input, int factor, const std::string &output);
