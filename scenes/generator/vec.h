#pragma once
#include <cmath>

/// A point, direction or colour of three doubles.
struct Vec3 {
    double x = 0, y = 0, z = 0;
};

inline Vec3 operator+(Vec3 a, Vec3 b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3 operator-(Vec3 a, Vec3 b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3 operator*(Vec3 a, double s) {
    return {a.x * s, a.y * s, a.z * s};
}
inline double dot(Vec3 a, Vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3 cross(Vec3 a, Vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3 a) {
    return std::sqrt(dot(a, a));
}
inline Vec3 normalize(Vec3 a) {
    return a * (1 / length(a));
}
inline Vec3 mix(Vec3 a, Vec3 b, double t) {
    return a * (1 - t) + b * t;
}

/// 0 below `low`, 1 above `high`, a cubic in between.
inline double smoothstep(double low, double high, double x) {
    const double t = std::fmin(1, std::fmax(0, (x - low) / (high - low)));
    return t * t * (3 - 2 * t);
}

inline constexpr double pi = 3.14159265358979323846;
