"""The report is drawn from made-up output folders of every kind; its parts are checked one by one."""
import json
import re
import subprocess
import sys
import unittest
from pathlib import Path

SKIPPED = 77  # exit status that ctest takes as "skipped"

try:
    import numpy as np

    import report_folders
    import synthetic_run
    from brisance import figures, report, results
except ImportError as missing:
    print(f"skipped: the Python package {missing.name} is not installed")
    sys.exit(SKIPPED)

SCRIPT = Path(report.__file__)


class Folders(report_folders.Folders):
    synthetic = synthetic_run


class Pages(Folders):
    def test_three_dimensions(self):
        page = self.page("3d")
        self.assertEqual(self.titles(page), ["Simulation", "Charge", "Gauges", "Scaled distance", "Overpressure field",
                                             "Peak values", "Conservation", "Cost and versions", "Deck"])
        # Histories, scaled distance, slices in two planes (there is an obstacle), peak map, timings.
        self.assertEqual(page.count("<img "), 6)

    def test_page_needs_no_other_file(self):
        page = self.page("3d")
        self.assertEqual(re.findall(r'(?:src|href)="(?!data:)[^"]*"', page), [])

    def test_text_from_the_deck_is_escaped(self):
        page = self.page("3d")
        self.assertIn("8 kg TNT on the ground &lt;made-up wave&gt;", page)
        self.assertIn("# A made-up deck with &lt;angle brackets&gt; &amp; an ampersand", page)
        self.assertNotIn("<made-up", page)

    def test_afterburn(self):
        self.assertNotIn("after the detonation", self.page("1d"))
        path = self.root / "1d/run.json"
        without = path.read_text(encoding="utf-8")
        log = json.loads(without)
        log["afterburn"] = {"model": "constant_rate", "energy": 1.02e7, "begin": 1e-4, "end": 1e-2}
        log["audit"]["afterburn_energy"] = 8.16e7
        path.write_text(json.dumps(log), encoding="utf-8")
        try:
            page = self.page("1d")
        finally:
            path.write_text(without, encoding="utf-8")
        self.assertIn("outflow plus guards plus afterburn", page)
        self.assertIn("released 8.16·10<sup>7</sup> J after the detonation", page)

    def test_panels(self):
        self.assertNotIn("failed at", self.page("1d"))
        path = self.root / "1d/run.json"
        without = path.read_text(encoding="utf-8")
        log = json.loads(without)
        vent = {"name": "vent", "fails_at": 5e3, "area": 0.5, "open_area": 0.5, "failed_at": 5.5e-3, "open_at": 2.5e-2,
                "difference": 5653.0, "largest_difference": 4900.0, "speed": 16.4}
        door = vent | {"name": "<door>", "failed_at": None, "open_at": None, "difference": None, "open_area": 0.0}
        log["panels"] = [vent, door]
        log["audit"]["panels"] = {"mass": [-0.002, 0.0], "energy": -584.0}
        path.write_text(json.dumps(log), encoding="utf-8")
        try:
            page = self.page("1d")
        finally:
            path.write_text(without, encoding="utf-8")
        self.assertIn("outflow plus guards plus panels must equal", page)
        self.assertRegex(page, r"vent</td><td>5</td><td[^>]*>5.5</td><td>5.653</td><td[^>]*>25</td>")
        self.assertRegex(page, r"&lt;door&gt;</td><td>5</td><td[^>]*>intact</td><td>4.9</td><td[^>]*>-</td>")
        self.assertRegex(page, r"584 J relative to ambient gas")

    def test_unknown_tnt_equivalent(self):
        path = self.root / "1d/summary.json"
        known = path.read_text(encoding="utf-8")
        summary = json.loads(known)
        summary.pop("kingery_bulmash_curve", None)
        for gauge in summary["gauges"]:
            gauge["scaled_distance"] = None
        path.write_text(json.dumps(summary), encoding="utf-8")
        try:
            titles = self.titles(self.page("1d"))
        finally:
            path.write_text(known, encoding="utf-8")
        self.assertIn("Gauges", titles)
        self.assertNotIn("Scaled distance", titles)

    def test_two_dimensions(self):
        self.assertIn("Overpressure field", self.titles(self.page("2d")))

    def test_one_dimension_has_profiles_instead_of_slices(self):
        titles = self.titles(self.page("1d"))
        self.assertIn("Profiles", titles)
        self.assertNotIn("Overpressure field", titles)

    def test_without_charge_gauges_fields_and_end(self):
        page = self.page("bare")
        self.assertEqual(self.titles(page), ["Simulation", "Conservation", "Cost and versions", "Deck"])
        self.assertIn("not finished", page)

    def test_verdicts(self):
        page = self.page("3d")
        self.assertEqual(page.count("conserved to round-off"), 2)
        self.assertEqual(page.count("not conserved"), 1)
        self.assertIn("In 12 cell updates", page)
        self.assertIn("guards active", page)
        self.assertNotIn("NOT BALANCED", page)
        self.assertEqual(page.count(report.badge("good", "balanced")), 1)

    def test_guards_that_add_too_much(self):
        path = self.root / "1d/run.json"
        sound = path.read_text(encoding="utf-8")
        log = json.loads(sound)
        log["audit"].update(balanced=False, guard_energy=6.2e8, for_comparison=True,
                            reasons=["guards added 6.2e+08 J, <much>"])
        log["audit"]["findings"]["guard_energy"].update(amount=6.2e8, reported=True)
        path.write_text(json.dumps(log), encoding="utf-8")
        try:
            page = self.page("1d")
        finally:
            path.write_text(sound, encoding="utf-8")
        # In the head of the page and over the table; not one good word about the energy.
        self.assertEqual(page.count(report.badge("bad", "NOT BALANCED")), 2)
        self.assertIn("<li>guards added 6.2e+08 J, &lt;much&gt;</li>", page)
        self.assertIn(report.badge("bad", "too much added by guards"), page)
        self.assertIn("so the run is not stopped", page)
        self.assertNotIn(report.badge("good", "balanced"), page)

    def test_gauge_table_holds_values_and_ratios(self):
        page = self.page("3d")
        r = float(np.linalg.norm(synthetic_run.KINDS["3d"]["gauges"][0]))
        self.assertIn(f"<td>{synthetic_run.peak(r) * 1e-3:.0f}</td>", page)
        self.assertIn(f'<td class="ratio">{1 / 1.06:.3f}</td>', page)

    def test_whole_record_and_clipped_peaks(self):
        page = self.page("3d")
        third = np.linalg.norm(synthetic_run.KINDS["3d"]["gauges"][2])
        marked = f'<td class="clipped">{report.number(synthetic_run.peak(third) * 1e-3, 4, True)}†</td>'
        self.assertEqual(page.count(marked), 1)
        self.assertEqual(page.count('<td class="clipped">17 %†</td>'), 1)
        self.assertEqual(page.count('class="clipped"'), 2)  # no other gauge is marked
        self.assertIn(f"<td>{report.number(1.25 * synthetic_run.impulse(third), 4, True)}</td>", page)
        self.assertIn("<td>-2.468</td><td>-7.750</td>", page)
        self.assertIn("clip this peak by 5 %", page)

    def test_results_without_the_whole_record(self):
        path = self.root / "1d/summary.json"
        new = path.read_text(encoding="utf-8")
        summary = json.loads(new)
        for gauge in summary["gauges"]:
            for key in ("largest_impulse", "negative_phase", "expected_clipping", "peak_front_overpressure"):
                gauge.pop(key)
        path.write_text(json.dumps(summary), encoding="utf-8")
        try:
            page = self.page("1d")
        finally:
            path.write_text(new, encoding="utf-8")
        self.assertIn("positive impulse", page)
        self.assertNotIn("largest impulse", page)

    def test_folder_without_run(self):
        done = subprocess.run([sys.executable, SCRIPT, self.root], capture_output=True, text=True)
        self.assertEqual(done.returncode, 5)
        self.assertIn("it does not contain run.json", done.stderr)

    def test_missing_package_is_named(self):
        hide = "import sys, runpy; sys.modules['h5py'] = None; sys.argv = sys.argv[1:]; " \
               "runpy.run_path(sys.argv[0], run_name='__main__')"
        done = subprocess.run([sys.executable, "-c", hide, SCRIPT, self.root / "3d"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 5)
        self.assertIn("the Python package h5py is missing", done.stderr)


class Results(Folders):
    def test_plane_is_the_right_layer(self):
        dump = results.Run(self.root / "3d").dumps[-1]
        x, y = dump.centres(0), dump.centres(1)
        plane = dump.plane("pressure", 2, 3)
        z = dump.centres(2)[3]
        distance = np.sqrt(x[None, :] ** 2 + y[:, None] ** 2 + z ** 2)
        expected = synthetic_run.AMBIENT + np.maximum(synthetic_run.overpressure(distance, dump.time),
                                                      -0.6 * synthetic_run.AMBIENT)
        self.assertEqual(plane.shape, (96, 96))
        np.testing.assert_allclose(plane, expected, rtol=1e-6)

    def test_layer_is_clamped_to_the_domain(self):
        dump = results.Run(self.root / "3d").dumps[0]
        self.assertEqual([dump.layer(2, z) for z in (-1.0, 0.0, 0.13, 99.0)], [0, 0, 1, 63])

    def test_dumps_are_in_order_of_time(self):
        times = [dump.time for dump in results.Run(self.root / "1d").dumps]
        self.assertEqual(times, [0.0, 0.01, 0.02])

    def test_cut_off_last_line_of_a_gauge_is_left_out(self):
        run = results.Run(self.root / "2d")
        path = self.root / "2d" / run.summary["gauges"][0]["file"]
        whole = path.read_text()
        try:
            path.write_text(whole + "0.03,1013")
            self.assertEqual(len(results.Run(self.root / "2d").histories["gauge 1"]["time"]), 2001)
        finally:
            path.write_text(whole)


class Formats(unittest.TestCase):
    def test_numbers(self):
        self.assertEqual([report.number(v) for v in (None, 0, 0.5, 12345.0, 1.5e-7, 2e9)],
                         ["–", "0", "0.5", "12345", "1.5·10<sup>−7</sup>", "2·10<sup>9</sup>"])
        self.assertEqual([report.number(v, 4, True) for v in (2.5, 1182.0, 12345.6)], ["2.500", "1182", "12346"])

    def test_durations(self):
        self.assertEqual([report.duration(s) for s in (12.34, 153, 7260)], ["12.3 s", "2 min 33 s", "2 h 01 min"])

    def test_chosen_indices_hold_the_ends(self):
        self.assertEqual(figures.chosen(3, 6), [0, 1, 2])
        self.assertEqual(figures.chosen(100, 4), [0, 33, 66, 99])

    def test_nice_ceiling(self):
        self.assertEqual([figures.nice_ceiling(v) for v in (0.3, 1.0, 1.1, 4.9, 700.0)], [0.5, 1.0, 2.0, 5.0, 1000.0])


if __name__ == "__main__":
    unittest.main()
