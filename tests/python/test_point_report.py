"""Reports of runs of material points, from made-up output folders."""
import json
import sys
import unittest
from pathlib import Path

SKIPPED = 77  # exit status that ctest takes as "skipped"

try:
    import numpy as np

    import report_folders
    import synthetic_points
    from brisance import point_figures, report, results
except ImportError as missing:
    print(f"skipped: the Python package {missing.name} is not installed")
    sys.exit(SKIPPED)

SCRIPT = Path(report.__file__)


class Folders(report_folders.Folders):
    synthetic = synthetic_points


class Pages(Folders):
    def test_axisymmetric(self):
        page = self.page("2d")
        self.assertEqual(self.titles(page), ["Simulation", "Bodies", "Pictures", "Gauges", "Energies", "Conservation",
                                             "Cost and versions", "Deck"])
        # Mises, plastic strain, pressure, speed; gauges, energies, timings.
        self.assertEqual(page.count("<img "), 7)
        for part in ("Made-up &lt;points&gt;", "quadratic B-spline, MUSL, XPIC(2), locking control", "2,000",
                     "body force (0, -9.81, 0) m/s²", "Mirrored at the axis", "drift", "-0.2 %", "within 0.5 %",
                     "copper: a handbook", "z: -2.9", "0.25 J at constrained nodes",
                     "0.125 J by contact friction"):
            self.assertIn(part, page)
        self.assertNotIn("Overpressure field", page)

    def test_three_dimensions_have_an_outer_view_and_two_planes(self):
        page = self.page("3d")
        # Outer view, two planes of bodies and four quantities, gauges, energies, timings.
        self.assertEqual(page.count("<img "), 1 + 2 * 5 + 3)
        self.assertIn("block &lt;beside&gt;", page)

    def test_one_dimension_has_profiles(self):
        page = self.page("1d")
        self.assertIn("Profiles at several times", page)
        self.assertIn("17 particles left the domain", page)
        self.assertIn("* The particle left the domain", page)

    def test_without_dumps_gauges_and_end(self):
        page = self.page("bare")
        self.assertEqual(self.titles(page), ["Simulation", "Bodies", "Conservation", "Cost and versions", "Deck"])
        self.assertIn("not finished", page)

    def test_of_a_run_that_drifts(self):
        path = self.root / "2d/run.json"
        sound = path.read_text(encoding="utf-8")
        log = json.loads(sound)
        log["audit"].update(balanced=False, reasons=["the energy has drifted"])
        log["audit"]["findings"]["drift"]["reported"] = True
        path.write_text(json.dumps(log), encoding="utf-8")
        try:
            page = self.page("2d")
        finally:
            path.write_text(sound, encoding="utf-8")
        self.assertEqual(page.count(report.badge("bad", "NOT BALANCED")), 2)
        self.assertIn("<li>the energy has drifted</li>", page)
        self.assertIn(report.badge("bad", "more than 0.5 %"), page)


class Verdicts(unittest.TestCase):
    def test_of_the_drift(self):
        verdict = {drift: report.drift_verdict({"drift": drift})
                   for drift in (None, 5e-4, -5e-4, 4e-3, 6e-3, -5e-2)}
        self.assertIn("not a number", verdict[None])
        self.assertIn("within 0.1 %", verdict[5e-4])
        self.assertIn("within 0.1 %", verdict[-5e-4])
        self.assertIn("within 0.5 %", verdict[4e-3])
        self.assertEqual(verdict[6e-3], report.badge("bad", "more than 0.5 %"))
        self.assertEqual(verdict[-5e-2], report.badge("bad", "more than 0.5 %"))

    def test_of_the_drift_by_the_limits_of_the_deck(self):
        def verdict(drift, warn, told):
            return report.drift_verdict({"drift": 0.0, "largest_drift": drift},
                                        {"audit": {"findings": {"drift": {"warn": warn, "reported": told}}}})
        self.assertEqual(verdict(0.04, 0.05, False), report.badge("good", "within 5 %"))
        self.assertEqual(verdict(0.06, 0.05, True), report.badge("bad", "more than 5 %"))
        self.assertEqual(verdict(0.06, 0.0, False), report.badge("warn", "not checked"))
        self.assertEqual(verdict(0.06, 0.005, False), report.badge("good", "within the most recent work of the loads"))


class Figures(Folders):
    def test_symmetry_planes_are_shown(self):
        run = results.Run(self.root / "3d")
        flat = point_figures.Flat(run, 1)
        dump = run.point_dumps[0]
        layer = dump.values("position")[flat.chosen(dump), 1]
        self.assertEqual(set(np.round(layer, 7)), {0.00025})
        self.assertEqual(len(layer), dump.count // 12)
        self.assertEqual(flat.title, "symmetry plane y = 0 m")

    def test_mirrored_at_the_axis(self):
        flat = point_figures.Flat(results.Run(self.root / "2d"))
        self.assertAlmostEqual(flat.low[0], -flat.high[0])
        # Radius 6 mm, 1.3 times that at the foot.
        self.assertGreater(flat.high[0], 7e-3)

    def test_prefixes(self):
        self.assertEqual([point_figures.scaled(v, "m") for v in (2.0, 0.02, 3e-5, 0.0)],
                         [(1.0, "m"), (1000.0, "mm"), (1e6, "µm"), (1.0, "m")])

    def test_nearest_points_hide_those_behind(self):
        axes = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
        points = np.array([[0.5, 0.5, 0.2], [0.5, 0.5, 0.9], [0.5, 0.5, 0.1]])
        for order in ([0, 1, 2], [2, 1, 0], [1, 0, 2]):
            values, _, inside = point_figures.splat(points[order], points[order, 2], 0.1, np.zeros(2), np.ones(2), axes)
            self.assertTrue(inside.any())
            self.assertFalse(inside.all())
            self.assertEqual(set(values[inside]), {0.9})

    def test_picture_of_many_points_fills_gaps(self):
        class Panel:
            def imshow(self, mean, **_):
                self.mean = mean

        flat = point_figures.Flat(results.Run(self.root / "2d"))
        x, y = np.meshgrid(np.arange(20.0), np.arange(20.0))
        points = np.stack([x.ravel(), y.ravel()], axis=1)
        kept = points[~((points == [7.0, 7.0]).all(axis=1))]
        flat.size, flat.low, flat.high = 1.0 / 1.02, np.full(2, -0.5), np.full(2, 25.5)
        panel = Panel()
        flat._image(panel, kept, kept[:, 0], None, None)
        self.assertFalse(panel.mean.mask[7, 7])
        self.assertAlmostEqual(panel.mean[7, 7], 7.0)
        self.assertTrue(panel.mean.mask[24, 24])


if __name__ == "__main__":
    unittest.main()
