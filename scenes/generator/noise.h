#pragma once
#include "vec.h"
#include <cstdint>
#include <vector>

/// Gradient noise on a lattice of hashed gradients: smooth, about -1 to 1, zero at lattice points.
double gradient_noise(Vec3 p, uint32_t seed);

/// Sum of `octaves` gradient noises, each twice as fine and half as strong as the one before.
double fractal_noise(Vec3 p, int octaves, uint32_t seed);

/// Distances from p to its nearest and second nearest of the points scattered one to a unit cell.
struct CellDistances {
    double nearest = 0, second = 0;
    uint32_t id = 0; ///< a hash of the nearest point
};
CellDistances cell_noise(Vec3 p, uint32_t seed);

/// A sum of plane waves of one wavelength and random directions: about normally distributed, with
/// the winding level sets of brain coral.
class WaveField {
public:
    WaveField(double wavelength, int waves, uint32_t seed);
    double operator()(Vec3 p) const;

private:
    struct Wave {
        Vec3 k;
        double phase;
    };
    std::vector<Wave> waves_;
};
