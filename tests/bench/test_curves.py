"""Tests of bench/curves.py: figures of lines whose answers are known."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "bench"))

import curves  # noqa: E402


class Curves(unittest.TestCase):
    # An error of 0.1 after one second that falls like 1/seconds.
    line = [(1, .1), (4, .025), (16, .00625)]

    def test_efficiency_is_the_same_along_a_line_of_slope_minus_one(self):
        for seconds, error in self.line:
            self.assertAlmostEqual(curves.efficiency(error, seconds), 10)

    def test_slope(self):
        self.assertAlmostEqual(curves.slope(self.line), -1)
        self.assertAlmostEqual(curves.slope([(1, 1), (2, 2 ** -1.5), (4, 4 ** -1.5)]), -1.5)
        self.assertIsNone(curves.slope([(2, .1), (2, .2)]))

    def test_time_to_an_error_within_the_points(self):
        found = curves.time_to(.01, self.line)
        self.assertAlmostEqual(found.seconds, 10)
        self.assertFalse(found.extrapolated)

    def test_time_to_an_error_that_was_measured(self):
        for seconds, error in self.line:
            found = curves.time_to(error, self.line)
            self.assertAlmostEqual(found.seconds, seconds)
            self.assertFalse(found.extrapolated)

    def test_time_to_an_error_beyond_either_end(self):
        for error, seconds in ((.001, 100), (.2, .5)):
            found = curves.time_to(error, self.line)
            self.assertAlmostEqual(found.seconds, seconds)
            self.assertTrue(found.extrapolated)

    def test_time_to_follows_the_piece_between_two_points(self):
        # Slope -2, then -1: between 1 and 10 seconds a tenth of the error takes sqrt(10) times as
        # long.
        found = curves.time_to(.1, [(1, 1), (10, .01), (100, .001)])
        self.assertAlmostEqual(found.seconds, 10 ** .5)

    def test_no_time_where_the_error_does_not_fall(self):
        self.assertIsNone(curves.time_to(.01, [(1, .1), (2, .1)]))
        self.assertIsNone(curves.time_to(.01, [(1, .1), (2, .2)]))
        self.assertIsNone(curves.time_to(.01, [(1, .1)]))

    def test_geometric_mean(self):
        self.assertAlmostEqual(curves.geometric_mean([1, 4, 16]), 4)
        self.assertIsNone(curves.geometric_mean([]))

    def test_relative_difference(self):
        for found, expected in zip(curves.relative_difference([1, 1.1, .9]), (0, .1, -.1)):
            self.assertAlmostEqual(found, expected)
        for found, expected in zip(curves.relative_difference([1, 3]), (-.5, .5)):
            self.assertAlmostEqual(found, expected)


if __name__ == "__main__":
    unittest.main()
