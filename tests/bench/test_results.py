"""Tests of bench/results.py: what was measured is found again, also by the next session."""

import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "bench"))

import results  # noqa: E402


class Results(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def table(self):
        return results.Table(self.folder / "table.csv", ["scene", "spp"], ["seconds"])

    def test_a_row_is_found_by_its_key_alone(self):
        table = self.table()
        table.add({"scene": "room", "spp": 4, "seconds": .5})
        self.assertEqual(table.find({"scene": "room", "spp": 4})["seconds"], "0.5")
        self.assertIsNone(table.find({"scene": "room", "spp": 16}))

    def test_a_new_session_finds_the_rows_of_the_last(self):
        self.table().add({"scene": "room", "spp": 4, "seconds": .5})
        self.table().add({"scene": "room", "spp": 16, "seconds": 2})
        self.assertEqual(len(self.table().rows), 2)

    def test_the_later_row_counts(self):
        self.table().add({"scene": "room", "spp": 4, "seconds": .5})
        self.table().add({"scene": "room", "spp": 4, "seconds": .25})
        self.assertEqual(self.table().find({"scene": "room", "spp": 4})["seconds"], "0.25")

    def test_a_scene_is_known_by_its_files(self):
        scene, mesh = self.folder / "scene.xml", self.folder / "mesh.ply"
        scene.write_text('<string name="filename" value="mesh.ply"/>')
        mesh.write_text("one")
        first = results.scene_id(scene)
        self.assertEqual(results.scene_id(scene), first)
        mesh.write_text("two")
        self.assertNotEqual(results.scene_id(scene), first)


if __name__ == "__main__":
    unittest.main()
