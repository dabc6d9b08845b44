"""What the examples with the concrete slab measure, on slabs of known damage, and the decks they run.

Usage: BRISANCE=path/to/brisance python3 test_slab.py
"""
import os
import subprocess
import sys
import unittest
from pathlib import Path

SKIPPED = 77  # exit status that ctest takes as "skipped"
ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "validation"))

try:
    import numpy as np
    from paper import defect, slab3d
except ImportError as missing:
    print(f"skipped: the Python package {missing.name} is not installed")
    sys.exit(SKIPPED)


def slab(plane, cells, damage):
    """A slab of 1 m in cells of 1 m / cells, two points to a cell and direction, with damage(x, y, z)."""
    out = slab3d.Slab.__new__(slab3d.Slab)
    out.time, out.plane, out.up, out.spacing = 0.0, plane, 1 if plane else 2, 0.5 / cells
    layers = round(slab3d.THICKNESS / out.spacing)
    across = (np.arange(2 * cells) + 0.5) * out.spacing
    down = -(np.arange(layers) + 0.5) * out.spacing
    axes = (across, down) if plane else (across, across, down)
    points = np.stack([a.ravel() for a in np.meshgrid(*axes, indexing="ij")], axis=1)
    if plane:
        points = np.insert(points, 2, 0.0, axis=1)
    out.origin = points
    values = np.array([damage(*p) for p in points], dtype=float)
    out.values = {"damage": values, "compression_damage": 0.0 * values, "tensile_damage": values}
    return out


class Measures(unittest.TestCase):
    def test_disc_and_ring_are_told_apart(self):
        def disc_and_ring(x, y, z):
            r = np.hypot(x, y)
            return 1.0 if z > -0.02 and (r < 0.2 or 0.4 < r < 0.6) else 0.5
        s = slab(False, 50, disc_and_ring)
        # The area of a quarter disc of 20 spacings, by its lattice points: 1 % off at most.
        self.assertAlmostEqual(s.diameter(s.central_zone()), 0.4, delta=0.004)
        self.assertEqual(s.central_zone(top=False).sum(), 0)
        self.assertAlmostEqual(s.share(True), np.pi / 4.0 * (0.2 ** 2 + 0.6 ** 2 - 0.4 ** 2), delta=0.003)
        self.assertEqual(s.share(False), 0.0)
        self.assertEqual(s.share(False, level=0.5), 1.0)

    def test_corners_do_not_connect_and_sides_do(self):
        s = slab(False, 20, lambda x, y, z: 1.0 if (x < 0.1) == (y < 0.1) else 0.0)
        self.assertEqual(s.central_zone().sum(), 16)
        s = slab(False, 20, lambda x, y, z: 1.0 if x < 0.1 or y > 0.5 else 0.0)
        self.assertEqual(s.central_zone().sum(), 4 * 40 + 36 * 20)

    def test_axisymmetric(self):
        s = slab(True, 40, lambda r, y, _: 1.0 if (r < 0.25 and y > -0.02) or r > 0.5 else 0.0)
        self.assertAlmostEqual(s.diameter(s.central_zone()), 0.5, places=12)
        self.assertAlmostEqual(s.share(True), 0.25 ** 2 + 1.0 - 0.5 ** 2, places=12)
        self.assertEqual(s.diameter(s.central_zone(top=False)), 0.0)

    def test_unbroken_centre_has_no_zone(self):
        s = slab(False, 20, lambda x, y, z: 1.0 if np.hypot(x, y) > 0.3 else 0.99)
        self.assertEqual(s.diameter(s.central_zone()), 0.0)

    def test_growth_on_the_back_face(self):
        shots = [slab(False, 40, lambda x, y, z, r=r: float(np.hypot(x, y) < r)) for r in (0.0, 0.2, 0.4, 0.9)]
        for k, s in enumerate(shots):
            s.time = 1e-4 * k
        times, diameters, round_by = slab3d.back_face(shots)
        self.assertEqual(times, [1e-4, 2e-4])  # nothing is broken before, more than a third after
        self.assertAlmostEqual(diameters[0], 0.4, delta=0.01)
        self.assertAlmostEqual(diameters[1], 0.8, delta=0.01)
        self.assertAlmostEqual(round_by, 1.0, delta=0.05)
        squares = [slab(False, 40, lambda x, y, z, r=r: float(max(x, y) < r)) for r in (0.0, 0.3)]
        self.assertAlmostEqual(slab3d.back_face(squares)[2], np.sqrt(2.0), delta=0.01)

    def test_extent_of_compression_damage(self):
        s = slab(False, 40, lambda x, y, z: max(0.0, 1.0 - np.hypot(x, y)))
        s.values["compression_damage"] = s.values["damage"]
        self.assertAlmostEqual(slab3d.diameter_above(*slab3d.crushing_profile(s), 0.6), 0.8, delta=0.01)
        self.assertEqual(slab3d.diameter_above(*slab3d.crushing_profile(s), 1.1), 0.0)

    def test_rings_of_the_back_face(self):
        s = slab(False, 40, lambda x, y, z: float(0.3 < np.hypot(x, y) < 0.5))
        self.assertEqual([round(v, 1) for v in defect.rings(s, [0.0, 0.28, 0.32, 0.48, 0.52, 1.0])],
                         [0.0, 0.5, 1.0, 0.5, 0.0])

    def test_formula_of_the_paper(self):
        for mass, diameter in ((2.0, 0.219), (4.0, 0.247), (10.0, 0.304), (20.0, 0.374)):
            self.assertAlmostEqual(slab3d.empirical(mass), diameter, delta=0.0005)


class Decks(unittest.TestCase):
    def test_all_are_valid(self):
        decks = [ROOT / "cases" / slab3d.CASE / f"{n}.toml" for n in ("deck", "axisymmetric", "rigid", "interface")]
        for deck in (*decks, ROOT / "cases" / defect.CASE / "deck.toml"):
            finished = subprocess.run([os.environ["BRISANCE"], "check", str(deck)], capture_output=True, text=True)
            self.assertEqual(finished.returncode, 0, finished.stderr)

    def test_the_defect_alone_makes_the_difference(self):
        def keys(case):
            text = (ROOT / "cases" / case / "deck.toml").read_text()
            lines = [line.split("#")[0].strip() for line in text.splitlines()]
            other = ("title", "cut", "point =", "time", "field_interval", "field_times")
            return [line for line in lines if line and not line.startswith(other)]
        self.assertEqual(keys(slab3d.CASE), keys(defect.CASE))


if __name__ == "__main__":
    unittest.main()
