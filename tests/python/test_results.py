"""The reader of results: the examples of docs/output.md, and what it makes of folders of every kind."""
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SKIPPED = 77  # exit status that ctest takes as "skipped"
ROOT = Path(__file__).resolve().parents[2]

try:
    import h5py
    import numpy as np

    import synthetic_points
    import synthetic_run
    from brisance import results
except ImportError as missing:
    print(f"skipped: the Python package {missing.name} is not installed")
    sys.exit(SKIPPED)


def write_profile(path):
    """A profile of a start as src/output/profile_file.cpp lays it out, of two components."""
    path.parent.mkdir()
    with h5py.File(path, "w") as file:
        file.attrs.update(time=5e-6, origin=[0.0, 0.0, 0.0], spacing=0.01, cells=[3, 1], ambient_pressure=1e5)
        state = file.create_dataset("profile/state", data=[[[9.0, 8.0, 7.0]], [[1.0, 2.0, 3.0]]])
        state.attrs["names"] = np.bytes_("density\nmomentum_x")
        file["profile/pressure"] = [[3e5, 2e5, 1e5]]
        file["profile/ambient"] = [1.225, 0.0]


class Reader(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.root = Path(cls.scratch.name)
        synthetic_run.write(cls.root / "out", "2d", dumps=3)
        synthetic_run.write(cls.root / "line", "1d", dumps=2)
        synthetic_points.write(cls.root / "points_out", "2d", dumps=3)
        synthetic_points.write(cls.root / "bare", "bare")
        write_profile(cls.root / "out/profiles/start_1.h5")

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def example(self, number):
        """What an example of docs/output.md prints, word by word."""
        part = (ROOT / "docs/output.md").read_text(encoding="utf-8").split("\n## Reading results in Python\n")[1]
        code = re.findall(r"```python\n(.*?)```", part.split("\n## ")[0], re.DOTALL)[number]
        done = subprocess.run([sys.executable, "-c", code], cwd=self.root, capture_output=True, text=True,
                              env=os.environ | {"PYTHONPATH": str(ROOT / "python")})
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.splitlines()

    def test_example_of_gas(self):
        lines = self.example(0)
        self.assertEqual(lines[0], "done 0.05")
        place = synthetic_run.KINDS["2d"]["gauges"]
        for n, line in enumerate(lines[1:3]):
            distance = np.hypot(*place[n][:2])
            peak = synthetic_run.peak(distance) if synthetic_run.arrival(distance) < 0.02 else 0.0
            self.assertTrue(line.startswith(f"gauge {n + 1} 0.02 {round(peak)} "), line)
        self.assertEqual(lines[3].split()[:2], ["0.01", "0.025"])
        # The front at 10 ms: the cell of the row in which the overpressure is largest.
        x = (np.arange(160) + 0.5) * 0.05
        over = synthetic_run.overpressure(np.hypot(x, 0.525), 0.01)
        self.assertEqual(int(lines[3].split()[2]), over.argmax())

    def test_example_of_points(self):
        first, second = self.example(1)
        self.assertEqual(first.split(), ["4e-05", str(round(0.75 * 11.75, 2)), "186.0", "185.6"])
        self.assertAlmostEqual(float(second.split()[0]), -0.25 * 11.75e-3, places=9)
        self.assertIn("['bar']", second)

    def test_values_have_the_directions_of_the_run(self):
        line, plane = (results.Run(self.root / name).dumps[0] for name in ("line", "out"))
        self.assertEqual(line.values("pressure").shape, (1500,))
        self.assertEqual(line.values("velocity").shape, (1500, 3))
        self.assertEqual(plane.values("pressure").shape, (80, 160))
        np.testing.assert_array_equal(plane.values("pressure"), plane.plane("pressure", 2, 0))

    def test_profile(self):
        run = results.Run(self.root / "out")
        self.assertEqual(list(run.profiles), ["start_1"])
        profile = run.profiles["start_1"]
        self.assertEqual(profile.components, ["density", "momentum_x"])
        self.assertEqual(list(profile.values("momentum_x")), [1.0, 2.0, 3.0])
        self.assertEqual(list(profile.values("pressure")), [3e5, 2e5, 1e5])
        self.assertEqual([profile.ambient(c) for c in ("pressure", "density")], [1e5, 1.225])
        np.testing.assert_allclose(profile.radii(), [0.005, 0.015, 0.025])

    def test_run_that_is_not_done_has_histories_without_a_summary(self):
        summary = self.root / "out/summary.json"
        kept = summary.read_bytes()
        summary.unlink()
        try:
            run = results.Run(self.root / "out")
            self.assertEqual(run.gauges, {})
            self.assertEqual(len(run.gauge("gauge 1")["time"]), 2001)
        finally:
            summary.write_bytes(kept)

    def test_last_line_that_is_cut_off_is_left_out(self):
        path = self.root / "out/gauges/gauge_1.csv"
        whole = path.read_bytes()
        head, *_, last = whole.splitlines(keepends=True)
        try:
            # Between two numbers, within the last one, and after it without the end of the line.
            for cut in (last[:20], last[:-3], last[:-1]):
                path.write_bytes(whole + cut)
                self.assertEqual(len(results.Run(self.root / "out").gauge("gauge 1")["time"]), 2001, cut)
            path.write_bytes(head)
            self.assertEqual(len(results.Run(self.root / "out").gauge("gauge 1")["time"]), 0)
            path.write_bytes(head[:12])
            with self.assertRaises(KeyError):
                results.Run(self.root / "out").gauge("gauge 1")
        finally:
            path.write_bytes(whole)

    def test_run_of_another_format_is_refused_by_name(self):
        log = self.root / "line" / "run.json"
        text = log.read_text()
        try:
            log.write_text(re.sub(r'"format": 2\b', '"format": 3', text))
            with self.assertRaisesRegex(results.UnknownFormat, "format 3, but this reader supports 2"):
                results.Run(self.root / "line")
        finally:
            log.write_text(text)

    def test_no_dump_is_told(self):
        with self.assertRaisesRegex(ValueError, "no dump"):
            results.nearest(results.Run(self.root / "bare").dumps, 0.0)

    def test_unknown_gauge_is_named_with_those_there_are(self):
        with self.assertRaisesRegex(KeyError, "gauge 3.*gauge 1, gauge 2"):
            results.Run(self.root / "out").gauge("gauge 3")

    def test_names_of_files(self):
        self.assertEqual([results.file_name(n) for n in ("a b", "r0.25-x", ".x", "", "ü")],
                         ["a_b", "r0.25-x", "_.x", "_", "__"])

    def test_folder_without_dumps_and_energies(self):
        run = results.Run(self.root / "bare")
        self.assertEqual((run.dumps, run.point_dumps, run.profiles, run.energies), ([], [], {}, None))


class OneReader(unittest.TestCase):
    def test_validation_and_report_do_not_open_files_of_results(self):
        # hostile.py alone compares what stands in the files with what a deck says, word by word.
        scripts = [p for p in (*(ROOT / "validation").rglob("*.py"), *(ROOT / "python").rglob("*.py"))
                   if p.name not in ("hostile.py", "results.py")]
        self.assertGreater(len(scripts), 15)
        words = ("h5py.File", "genfromtxt", "loadtxt", '"summary.json"', '.csv")', "fields/", "points/points_")
        self.assertEqual([(path.name, word) for path in scripts for word in words
                          if word in path.read_text(encoding="utf-8")], [])


if __name__ == "__main__":
    unittest.main()
