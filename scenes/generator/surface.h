#pragma once
#include "vec.h"
#include <functional>

/// How the unit square of texture coordinates is glued into a closed surface.
///   torus        both directions wrap around
///   revolved     u wraps around; v = 0 and v = 1 are each one point
///   octahedral   the square is folded into a sphere by the equal-area octahedral map
///                (Clarberg 2008, "Fast equal-area mapping of the (hemi)sphere using SIMD")
enum class Topology { torus, revolved, octahedral };

/// A closed surface over the unit square and the colours painted on it.
struct Surface {
    Topology topology = Topology::torus;
    /// Width over height of a square cell of texture space on the surface: shapes the triangles.
    double aspect = 1;
    /// Torus and revolved: the point at (u, v).
    std::function<Vec3(double u, double v)> point;
    /// Octahedral: the point in direction d of the unit sphere.
    std::function<Vec3(Vec3 d)> displaced;
    /// The colour (sRGB, 0 to 1) at a point of the surface with these texture coordinates.
    std::function<Vec3(Vec3 p, double u, double v)> colour;
};

/// The point of the unit sphere at (u, v) of the octahedral square.
Vec3 octahedral_direction(double u, double v);

/// The surface's point at (u, v), whatever its topology.
Vec3 surface_point(const Surface &surface, double u, double v);

/// The unit normal at (u, v), outward if `outward` is 1 (see outward_sign), from central
/// differences over a distance of `step` in the unit square.
Vec3 surface_normal(const Surface &surface, double u, double v, double step, double outward);

/// 1 where du x dv points out of the surface, -1 where it points in.
double outward_sign(const Surface &surface);
