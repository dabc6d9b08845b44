"""Subsets of the field output beside the dumps of the whole domain, from real runs, as the Python package reads them.

Usage: BRISANCE=path/to/brisance python3 test_subsets.py
"""
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SKIPPED = 77  # exit status that ctest takes as "skipped"
PROGRAM = os.environ["BRISANCE"]
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

try:
    import numpy as np

    from brisance import results
except ImportError as missing:
    print(f"skipped: the Python package {missing.name} is not installed")
    sys.exit(SKIPPED)

DECK = """
[domain]
geometry = "GEOMETRY"
size = SIZE
cell = "CELL"
[boundaries]
y_low = "wall"
LEVELS
[[charge]]
radius = "80 mm"
position = CENTRE
[[obstacle]]
shape = "box"
lower = LOW
upper = HIGH
[output]
field_interval = "50 us"
precision = "double"
[[output.subset]]
name = "cut"
plane = {normal = "y", at = "0.315 m"}
[[output.subset]]
name = "part"
box = {lower = LOW, upper = BOX}
interval = "25 us"
[[output.subset]]
name = "means"
box = {lower = LOW, upper = BOX}
cell = "80 mm"
fields = ["density", "velocity"]
[end]
time = "0.1 ms"
"""
LAST_ONLY = ("peak_overpressure", "impulse")  # fields of the last dump of the whole domain
LEVELS = '[adaptive]\nfinest = "10 mm"\n'


class Subsets(unittest.TestCase):
    def run_case(self, dims, levels):
        point = (lambda *x: str(list(x[:dims])))
        words = {"GEOMETRY": "cartesian3d" if dims == 3 else "axisymmetric2d", "SIZE": point(1.28, 0.64, 0.64),
                 "CELL": "40 mm" if levels or dims == 3 else "20 mm", "LEVELS": LEVELS if levels else "",
                 "CENTRE": point(0.0, 0.3, 0.0), "LOW": point(0.32, 0.08, 0.0), "HIGH": point(0.4, 0.32, 0.24),
                 "BOX": point(0.95, 0.47, 0.3)}
        text = DECK
        if dims == 3:
            text = text.replace('y_low = "wall"', 'y_low = "wall"\nx_low = "symmetry"\nz_low = "symmetry"')
        for word, value in words.items():
            text = text.replace(word, value)
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        folder = Path(scratch.name)
        (folder / "case.toml").write_text(text)
        done = subprocess.run([PROGRAM, "run", "case.toml", "--output", "out", "--quiet"], cwd=folder,
                              capture_output=True, text=True, timeout=600)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return results.Run(folder / "out")

    def assert_same(self, values, expected, dims, whole):
        """Equal but for the few cells that are replaced by means so that levels enclose finer ones."""
        differ = np.abs(values - expected) > 1e-13 * np.abs(expected)
        finest = getattr(whole, "finest", 0)
        replaced = 2 * dims * sum(2 ** (dims * level) for level in range(1, finest + 1)) * 2
        self.assertLessEqual(differ.reshape(len(values), -1).sum(), 3 * replaced)
        self.assertLess(differ.mean(), 0.05)

    def assert_plane(self, run, dims):
        """Each square or line has what the whole dump holds there."""
        self.assertEqual([dump.time for dump in run.subsets["cut"]], [dump.time for dump in run.dumps])
        for cut, whole in zip(run.subsets["cut"], run.dumps):
            self.assertEqual((cut.normal, cut.position, cut.step), (1, 0.315, whole.step))
            self.assertEqual(cut.fields, [field for field in whole.fields if field not in LAST_ONLY])
            centres = cut.centres()
            np.testing.assert_array_equal(centres[:, 1], 0.315)
            index = [[whole.layer(d, x) for x in centres[:, d]] for d in range(dims)]
            for field in ("pressure", "velocity"):
                self.assert_same(cut.values(field), whole.values(field)[tuple(index[::-1])], dims, whole)
            self.assertAlmostEqual(np.sum(cut.sizes() ** (dims - 1)), 1.28 * 0.64 ** (dims - 2))
        self.assertGreater(np.ptp(run.subsets["cut"][-1].values("pressure")), 1e4)

    def assert_box(self, run, dims):
        self.assertEqual(len(run.subsets["part"]), 5)
        np.testing.assert_allclose([dump.time for dump in run.subsets["part"]], np.arange(5) * 25e-6, rtol=1e-12)
        for part, whole in zip(run.subsets["part"][::2], run.dumps):
            self.assertEqual(part.time, whole.time)
            kept, whole.level = getattr(whole, "level", None), part.level
            window = []
            for d in range(dims):
                first = whole.layer(d, part.centres(d)[0])
                window.append(slice(first, first + part.cells[d]))
                np.testing.assert_allclose(part.edges(d)[0], whole.edges(d)[first], atol=1e-12)
            for field in ("pressure", "velocity", "density"):
                expected = whole.values(field)[tuple(window[::-1])]
                self.assert_same(part.values(field), expected, dims, whole)
                if field == "density" and dims == 3:
                    self.assertAlmostEqual(part.values(field).sum() / expected.sum(), 1.0, delta=1e-12)
            whole.level = kept

    def assert_means(self, run, dims):
        """Volume and density together give the mass that the whole dump holds in the box."""
        for part, whole in zip(run.subsets["means"], run.dumps):
            self.assertEqual(part.fields, ["density", "velocity"])
            self.assertEqual((part.finest, part.spacing), (0, 0.08))

            def mass(dump, ends):
                density = dump.values("density")
                x = [dump.centres(d) for d in range(dims)]
                inside = [(ends[d][0] < x[d]) & (x[d] < ends[d][1]) for d in range(dims)]
                volume = dump.spacing ** dims * (x[0] if dims == 2 else np.ones_like(x[0]))
                return np.sum((density * volume)[np.ix_(*inside[::-1])])

            ends = [part.edges(d)[[0, -1]] for d in range(dims)]
            self.assertAlmostEqual(mass(part, ends) / mass(whole, ends), 1.0, delta=1e-12)

    def test_uniform_axisymmetric(self):
        self.check(2, False)

    def test_levels_axisymmetric(self):
        self.check(2, True)

    def test_uniform_3d(self):
        self.check(3, False)

    def test_levels_3d(self):
        self.check(3, True)

    def check(self, dims, levels):
        run = self.run_case(dims, levels)
        self.assertEqual(sorted(run.subsets), ["cut", "means", "part"])
        self.assert_plane(run, dims)
        self.assert_box(run, dims)
        self.assert_means(run, dims)
        if levels:
            self.assertGreater(len(set(np.round(run.subsets["cut"][-1].sizes(), 6))), 1)
            self.assertGreater(run.subsets["part"][-1].finest, 0)


if __name__ == "__main__":
    unittest.main()
