"""Tests of bench/noise.py on made-up noise; skipped where there is no numpy."""

import importlib.util
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "bench"))

if importlib.util.find_spec("numpy"):
    import numpy as np

    import noise


@unittest.skipUnless(importlib.util.find_spec("numpy"), "needs numpy")
class Noise(unittest.TestCase):
    def stack(self, level=.1, mean=2.0, seeds=4, key=1):
        shape = (seeds, 96, 128, 3)
        return np.random.default_rng(key).normal(mean, level, shape).astype(np.float32)

    def test_error_of_known_noise(self):
        # variance/(mean² + 0.01), of .1 around 2.
        error = noise.relative_error(self.stack())
        self.assertAlmostEqual(error.full / (.01 / 4.01), 1, delta=.03)
        self.assertLess(error.trimmed, error.full)
        self.assertGreater(error.trimmed, .97 * error.full)

    def test_trimming_leaves_out_a_few_bright_pixels(self):
        clean = noise.relative_error(self.stack())
        stack = self.stack()
        stack[0, 3, :8] = 1000  # 8 of 12288 pixels
        error = noise.relative_error(stack)
        self.assertAlmostEqual(error.trimmed / clean.trimmed, 1, delta=.02)
        self.assertGreater(error.full, 1.5 * clean.full)

    def test_unbiased_pictures_agree(self):
        found = noise.agreement(self.stack(key=1), self.stack(key=2))
        self.assertLess(abs(found.difference), 1e-3)
        self.assertLess(abs(found.z_mean), 4)
        self.assertAlmostEqual(found.z_expected, 1.5 ** .5)
        self.assertLess(found.z_blocks, 2)

    def test_a_brighter_picture_does_not_agree(self):
        found = noise.agreement(self.stack(mean=2.02, key=1), self.stack(key=2))
        self.assertAlmostEqual(found.difference, .01, delta=1e-3)
        self.assertGreater(found.z_mean, 10)
        self.assertGreater(found.z_blocks, 2)

    def test_pfm_has_its_last_row_first(self):
        rows = np.arange(12, dtype="<f4").reshape(2, 2, 3)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "picture.pfm"
            path.write_bytes(b"PF\n2 2\n-1.0\n" + rows.tobytes())
            np.testing.assert_array_equal(noise.read_picture(path), rows[::-1])


if __name__ == "__main__":
    unittest.main()
