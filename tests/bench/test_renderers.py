"""Tests of bench/renderers.py: each renderer's own roulette."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "bench"))

import renderers  # noqa: E402


def depths(rr_depth):
    """What each renderer is told of the depth of roulette, by name."""
    settings = renderers.Settings(32, 24, 10, rr_depth, 2, 60)
    said = {}
    for renderer in renderers.RENDERERS:
        spp = 4 if renderer.name == "clrender" else [4]
        command = [str(word) for word in renderer.command("a.xml", "out", spp, 1, settings)]
        said[renderer.name] = command[command.index("--rr-depth") + 1]
    return said


class Roulette(unittest.TestCase):
    def test_a_depth_is_told_to_all(self):
        self.assertEqual(set(depths(7).values()), {"7"})

    def test_own_is_the_default_of_each(self):
        self.assertEqual(depths(renderers.OWN),
                         {"clrender": "auto", "mitsuba-llvm": "5", "mitsuba-scalar": "5",
                          "luxcore": "3", "cycles": "1"})


if __name__ == "__main__":
    unittest.main()
