"""Tests of bench/ablation.py: its groups are of the kernel's features, and all of them; its tables."""

import pathlib
import re
import sys
import types
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench"))

import ablation  # noqa: E402


def variant(compiling, path, rays):
    return types.SimpleNamespace(compiling=compiling, path=path, rays=rays)


class Ablation(unittest.TestCase):
    def test_every_feature_is_in_one_group(self):
        shared = ROOT / "kernels" / "shared"
        known = re.findall(r"^CLR_CONFIG\((\w+)", (shared / "kernel_config.def").read_text(),
                           re.MULTILINE)
        known += ["HAS_" + kind for kind in
                  re.findall(r"^CLR_BSDF(?:_NODE)?\((\w+)", (shared / "bsdf_list.def").read_text(), re.MULTILINE)]
        grouped = [name for names in ablation.GROUPS.values() for name in names.split(",")]
        self.assertEqual(len(grouped), len(set(grouped)))
        self.assertLessEqual(set(grouped), set(known))
        not_forced = set(ablation.NOT_FORCED.split(","))
        self.assertLessEqual(not_forced, set(known))
        self.assertEqual({name for name in known if name.startswith("HAS_")} - set(grouped),
                         not_forced)

    def test_tables(self):
        measured = {pathlib.Path("room.xml"): {
            "specialised": variant(1, 100, 9), "everything": variant(4, 250, 10),
            "alpha": variant(1.5, 110, 9)}}
        text = ablation.report(measured, ["alpha", "roulette"])
        self.assertIn("| `room` | 1.00 | 4.00 | 100 | 250 | **2.50** | 9.00 | 10.0% |", text)
        self.assertIn("| alpha | 1.10, +0.5 s |", text)
        self.assertIn("| roulette | - |", text)


if __name__ == "__main__":
    unittest.main()
