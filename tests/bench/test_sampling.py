"""Tests of bench/sampling.py: its table."""

import pathlib
import sys
import types
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "bench"))

import sampling  # noqa: E402


class Sampling(unittest.TestCase):
    def test_table_is_relative_to_the_own_choice(self):
        variants = {sampling.OWN: types.SimpleNamespace(error=2e-3, time=2),
                    "4 light samples": types.SimpleNamespace(error=1e-3, time=3)}
        text = sampling.report({pathlib.Path("sky.xml"): variants}, ["4 light samples"])
        self.assertIn("| relMSE as it is | 2.00e-03 |", text)
        self.assertIn("| 4 light samples | 0.50, 0.75 |", text)


if __name__ == "__main__":
    unittest.main()
