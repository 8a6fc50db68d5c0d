#pragma once
#include <vector>

/// A smooth curve (uniform cubic B-spline) in the half plane of radius and height that begins and
/// ends on the axis, parametrised by arc length from 0 to 1.
class Profile {
public:
    struct Point {
        double r = 0, y = 0;
    };
    explicit Profile(std::vector<Point> controls);
    Point at(double fraction) const;

private:
    Point spline(double t) const;
    std::vector<Point> controls_;
    std::vector<double> arc_; ///< arc length at equal steps of the spline's parameter
};

/// From the foot's centre up the outside of a vase, over its lip and down inside.
Profile vase_profile();
