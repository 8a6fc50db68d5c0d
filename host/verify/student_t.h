#pragma once
/// Student's t distribution.

namespace clrender::verify {

/// The probability that |t| is above `t` >= 0, with `degrees` >= 1 of freedom; relative error below
/// 1e-10.
double t_tail(double t, int degrees);

/// The t whose t_tail() is `probability`, in (0, 1).
double t_critical(double probability, int degrees);

} // namespace clrender::verify
