"""Tests of bench/launch.py through programs.launch: what a command took, and how it ended."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "bench"))

import programs  # noqa: E402


class Launch(unittest.TestCase):
    def test_output_time_and_memory(self):
        script = "import time; a = bytearray(64 << 20); time.sleep(.2); print(len(a))"
        output, seconds, peak = programs.launch([sys.executable, "-c", script], 60)
        self.assertEqual(output.strip(), str(64 << 20))
        self.assertGreater(seconds, .2)
        self.assertGreater(peak, 64)
        self.assertLess(peak, 128)

    def test_the_memory_of_this_process_is_not_counted(self):
        ballast = bytearray(b"x" * (256 << 20))
        peak = programs.launch(["true"], 60)[2]
        self.assertLess(peak, 64)
        del ballast

    def test_failure_names_the_code_and_the_last_line(self):
        with self.assertRaisesRegex(programs.Failed, "exit code 3: why"):
            programs.launch(["sh", "-c", "echo first >&2; echo why >&2; exit 3"], 60)

    def test_a_command_that_is_not_there(self):
        with self.assertRaisesRegex(programs.Failed, "cannot be started"):
            programs.launch(["./there-is-no-such-program"], 60)

    def test_what_does_not_end_is_killed(self):
        with self.assertRaisesRegex(programs.Failed, "no end after 0.3 s"):
            programs.launch(["sh", "-c", "sleep 60 & sleep 60"], .3)


if __name__ == "__main__":
    unittest.main()
