"""The reader of results: the examples of docs/output.md, and what it makes of folders of every kind."""
import json
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


def example(number, folder):
    """What an example of docs/output.md prints in a folder, word by word."""
    part = (ROOT / "docs/output.md").read_text(encoding="utf-8").split("\n## Reading results in Python\n")[1]
    code = re.findall(r"```python\n(.*?)```", part.split("\n## ")[0], re.DOTALL)[number]
    done = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True,
                          env=os.environ | {"PYTHONPATH": str(ROOT / "python")})
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return done.stdout.splitlines()


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

    def test_example_of_gas(self):
        lines = example(0, self.root)
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
        first, second = example(2, self.root)
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

    def test_outlines_of_a_uniform_dump_are_its_blocks(self):
        dump = results.Run(self.root / "out").dumps[0]
        cells = [n for n in dump.cells if n > 1]
        blocks = dump.outlines(2, 0.0)
        self.assertEqual(len(blocks), np.prod([-(-n // 16) for n in cells[:2]]))
        self.assertEqual({level for level, _, _ in blocks}, {0})
        area = sum(np.prod(high - low) for _, low, high in blocks)
        self.assertAlmostEqual(area, np.prod(cells[:2]) * dump.spacing ** 2)
        with h5py.File(dump.path, "r+") as file:
            size = file.attrs.pop("block_size")
        try:
            self.assertEqual(results.Dump(dump.path).outlines(2, 0.0), [])  # of an earlier version
        finally:
            with h5py.File(dump.path, "r+") as file:
                file.attrs["block_size"] = size

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


def write_subsets(folder):
    """Two dumps of a plane and one of a box as src/output/plane_fields.cpp and level_fields.cpp lay them out."""
    (folder / "subsets").mkdir(parents=True)
    (folder / "run.json").write_text('{"format": 2}')
    files = []
    for number in range(2):
        files.append({"name": f"street_{number:06d}.hdf", "time": 4e-3 * number})
        with h5py.File(folder / "subsets" / files[-1]["name"], "w") as file:
            file.attrs.update(time=4e-3 * number, step=number, geometry="cartesian3d", normal=2, position=1.5)
            group = file.create_group("VTKHDF")
            group.attrs["Type"] = np.bytes_("UnstructuredGrid")
            group["NumberOfCells"] = [2]
            # A large square beside a small one, which share a corner.
            group["Points"] = [[0, 0, 1.5], [2, 0, 1.5], [2, 2, 1.5], [0, 2, 1.5], [3, 0, 1.5], [3, 1, 1.5],
                               [2, 1, 1.5]]
            group["Connectivity"] = [0, 1, 2, 3, 1, 4, 5, 6]
            group["CellData/pressure"] = [1e5, 1e5 + number]
            group["CellData/velocity"] = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]
    (folder / "subsets/street.hdf.series").write_text(json.dumps({"files": files}))
    (folder / "subsets/street_000002.hdf").write_text("a dump that a killed run has not listed")
    with h5py.File(folder / "subsets/corner_000000.hdf", "w") as file:
        file.attrs.update(time=0.0, step=0, geometry="cartesian3d", origin=[1.0, 0.0, 0.0], spacing=0.5,
                          cells=[4, 2, 1])
        group = file.create_group("VTKHDF")
        group.attrs["Type"] = np.bytes_("OverlappingAMR")
        group.create_group("Level0").attrs["Spacing"] = [0.5] * 3
        group["Level0/AMRBox"] = [[0, 3, 0, 1, 0, 0]]
        group["Level0/CellData/pressure"] = np.arange(8.0)
    (folder / "subsets/corner.hdf.series").write_text(
        json.dumps({"files": [{"name": "corner_000000.hdf", "time": 0.0}]}))


class Subsets(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.root = Path(cls.scratch.name)
        write_subsets(cls.root / "subsets_out")

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_planes_and_boxes_are_listed_by_name(self):
        run = results.Run(self.root / "subsets_out")
        self.assertEqual(list(run.subsets), ["corner", "street"])
        self.assertEqual([dump.time for dump in run.subsets["street"]], [0.0, 4e-3])
        cut = run.subsets["street"][1]
        self.assertEqual((cut.count, cut.normal, cut.position, cut.fields), (2, 2, 1.5, ["pressure", "velocity"]))
        np.testing.assert_array_equal(cut.centres(), [[1.0, 1.0, 1.5], [2.5, 0.5, 1.5]])
        np.testing.assert_array_equal(cut.sizes(), [2.0, 1.0])
        np.testing.assert_array_equal(cut.values("pressure"), [1e5, 1e5 + 1])
        self.assertEqual(cut.values("velocity").shape, (2, 3))
        box = run.subsets["corner"][0]
        np.testing.assert_array_equal(box.values("pressure"), [[[0, 1, 2, 3], [4, 5, 6, 7]]])
        np.testing.assert_array_equal(box.edges(0), [1.0, 1.5, 2.0, 2.5, 3.0])

    def test_example_of_subsets(self):
        self.assertEqual(example(1, self.root), ["0.004 2 1.5 1", "(4, 2, 1) (1, 2, 4)"])


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
