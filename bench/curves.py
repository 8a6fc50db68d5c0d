"""Error against time, without numpy: efficiency, the time to an error, means of ratios."""

import dataclasses
import math


def efficiency(error, seconds):
    """1/(relMSE x seconds): twice as much is the same picture in half the time, whatever the sample
    count, as long as the error falls like 1/seconds."""
    return 1 / (error * seconds)


def geometric_mean(values):
    """None without values; the values are positive."""
    values = list(values)
    return math.exp(math.fsum(map(math.log, values)) / len(values)) if values else None


def slope(points):
    """Least-squares slope of log(error) over log(seconds) of points (seconds, error); None where
    the points do not define one."""
    logs = [(math.log(seconds), math.log(error)) for seconds, error in points]
    mean_x, mean_y = (math.fsum(column) / len(logs) for column in zip(*logs))
    width = math.fsum((x - mean_x) ** 2 for x, _ in logs)
    return math.fsum((x - mean_x) * (y - mean_y) for x, y in logs) / width if width > 0 else None


@dataclasses.dataclass(frozen=True)
class TimeTo:
    """Seconds to an error; extrapolated: outside of what was measured."""
    seconds: float
    extrapolated: bool


def time_to(error, points):
    """When the line through the points (seconds, error), straight between neighbours on log-log
    axes, reaches an error. Outside of them it goes on from the nearest one with the slope of all.
    None with fewer than two points or where the error does not fall."""
    points = sorted(points)
    if len(points) < 2:
        return None
    for (t0, e0), (t1, e1) in zip(points, points[1:]):
        if e0 >= error >= e1 and e0 > e1:
            share = math.log(e0 / error) / math.log(e0 / e1)
            return TimeTo(t0 * (t1 / t0) ** share, False)
    falls = slope(points)
    if falls is None or falls >= 0:
        return None
    # Above every measured error: before the first point; else after the last.
    seconds, nearest = points[0] if error > points[0][1] else points[-1]
    return TimeTo(seconds * (error / nearest) ** (1 / falls), True)


def relative_difference(values):
    """Each value's distance from the median of all, as a share of the median."""
    ordered = sorted(values)
    half = len(ordered) // 2
    median = ordered[half] if len(ordered) % 2 else (ordered[half - 1] + ordered[half]) / 2
    return [value / median - 1 for value in values]
