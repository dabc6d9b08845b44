"""The program as its users see it: exit codes, messages and files.

Usage: BRISANCE=path/to/brisance BRISANCE_SOURCE=path/to/tree python3 test_program.py [CLASS...]
"""
import csv
import json
import os
import re
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import h5py
import numpy

PROGRAM = os.environ["BRISANCE"]
SOURCE = Path(os.environ["BRISANCE_SOURCE"])

SMALL = """
title = "small"
[domain]
geometry = "spherical1d"
size = 1
cell = "5 mm"
[[charge]]
mass = "1 kg"
[[gauge]]
name = "near"
point = 0.5
[output]
field_interval = "0.1 ms"
[end]
time = "0.4 ms"
"""

# Too long to end before a signal comes.
LONG = SMALL.replace('"5 mm"', '"0.25 mm"').replace('"0.4 ms"', '"1 s"').replace('"0.1 ms"', '"0.5 s"')

PLANE = """
[domain]
geometry = "planar2d"
size = [1, 1]
cell = "10 mm"
[[charge]]
mass = "1 kg"
position = [0.5, 0.5]
[end]
time = "0.1 ms"
"""

# A charge across several blocks in 3D, with an obstacle and air that is quiet for a while.
BLAST_3D = """
[domain]
size = [1.6, 0.96, 0.96]
cell = "20 mm"
[boundaries]
y_low = "symmetry"
z_low = "wall"
[numerics]
block_cells = 16
sleep = SLEEP
scheme = "SCHEME"
[[charge]]
mass = "1 kg"
shape = "hemisphere"
position = [0.32, 0, 0]
[[obstacle]]
shape = "box"
lower = [0.8, 0, 0]
upper = [0.9, 0.4, 0.4]
[[gauge]]
line = {from = [0.5, 0.3, 0.1], to = [1.5, 0.9, 0.9], count = 3}
[output]
precision = "double"
[end]
time = "1 s"
steps = 40
"""


class Case(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)

    def deck(self, text, name="case.toml"):
        (self.folder / name).write_text(text)
        return name

    def brisance(self, *arguments, code=0, **options):
        done = subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True,
                              timeout=600, **options)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done


class CommandLine(Case):
    def test_help_names_commands_and_exit_codes(self):
        text = self.brisance("--help").stdout
        for word in ("run", "check", "info", "report", "kb", "0 done, 2 bad input, 3 stopped by the user",
                     "4 numerical failure or stopped by the audit", "5 input/output failure"):
            self.assertIn(word, text)

    def test_every_command_has_an_example(self):
        for command in ("run", "check", "info", "report", "kb"):
            self.assertIn(f"Example: brisance {command} ", self.brisance(command, "--help").stdout)

    def test_version(self):
        # With the license of the binary, which depends on what it is linked with.
        self.assertRegex(self.brisance("--version").stdout,
                         r"^brisance \d+\.\d+\.\d+\n"
                         r"(built with p4est [\d.]+ \(GPL-2\+\): this binary may be distributed under the GNU GPL, .*"
                         r"|built without p4est: grids have one level of blocks; BSD 3-Clause License)\n$")

    def test_wrong_command_lines_are_bad_input(self):
        self.brisance(code=2)
        self.brisance("explode", code=2)
        self.brisance("run", code=2)
        self.brisance("run", "a.toml", "--threads", "0", code=2)
        self.brisance("kb", "--charge", "1 kg", "--distance", "1 m", "--burst", "square", code=2)

    def test_a_full_standard_output_is_an_output_failure(self):
        with open("/dev/full", "w") as full:
            done = subprocess.run([PROGRAM, "info"], stdout=full, stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 5)
        self.assertIn("standard output", done.stderr)


class KingeryBulmash(Case):
    def kb(self, *arguments):
        return json.loads(self.brisance("kb", *arguments, "--json").stdout)

    def test_units_do_not_matter(self):
        a = self.kb("--charge", "10 kg", "--distance", "5 m", "--burst", "hemispherical")
        b = self.kb("--charge", "10000 g", "--distance", "500 cm", "--burst", "hemispherical")
        self.assertAlmostEqual(a["scaled_distance"], 5 / 10 ** (1 / 3), places=3)
        for name, quantity in a["quantities"].items():
            self.assertAlmostEqual(quantity["value"] / b["quantities"][name]["value"], 1.0, places=12)

    def test_hopkinson_scaling(self):
        one = self.kb("--charge", "1 kg", "--distance", "2 m", "--burst", "spherical")["quantities"]
        eight = self.kb("--charge", "8 kg", "--distance", "4 m", "--burst", "spherical")["quantities"]
        for name in ("incident_overpressure", "reflected_overpressure", "shock_speed"):
            self.assertAlmostEqual(eight[name]["value"] / one[name]["value"], 1.0, places=6)
        for name in ("incident_impulse", "reflected_impulse", "arrival", "duration"):
            self.assertAlmostEqual(eight[name]["value"] / one[name]["value"], 2.0, places=6)

    def test_altitude_scales_after_sachs(self):
        # ISO 2533 at 3000 m: 70121.2 Pa and 328.583 m/s; at the sea 101325 Pa and 340.294 m/s.
        p, c = 70121.2 / 101325, 328.583 / 340.294
        length = p ** (-1 / 3)
        sea = self.kb("--charge", "1 kg", "--distance", "2 m", "--burst", "spherical")
        up = self.kb("--charge", "1 kg", "--distance", f"{2 * length:.9f} m", "--burst", "spherical",
                     "--altitude", "3 km")
        self.assertAlmostEqual(up["scaled_distance"] / sea["scaled_distance"], 1.0, places=5)
        self.assertAlmostEqual(up["ambient_pressure"], 70121.2, delta=0.1)
        for name, factor in (("incident_overpressure", p), ("reflected_overpressure", p), ("dynamic_pressure", p),
                             ("shock_speed", c), ("arrival", length / c), ("duration", length / c),
                             ("incident_impulse", p * length / c), ("reflected_impulse", p * length / c)):
            ratio = up["quantities"][name]["value"] / sea["quantities"][name]["value"]
            # The digits of the table above, and the steepness of the curves.
            self.assertAlmostEqual(ratio / factor, 1.0, delta=5e-5, msg=name)
        self.assertIn("70.121 kPa", self.brisance("kb", "--charge", "1 kg", "--distance", "2 m", "--burst", "spherical",
                                                  "--altitude", "3 km").stdout)
        self.assertIn("--altitude", self.brisance("kb", "--charge", "1 kg", "--distance", "2 m", "--burst", "spherical",
                                                  "--altitude", "3 kg", code=2).stderr)

    def test_values_of_the_published_curves(self):
        # Rows of the table in tests/empirical/test_kingery_bulmash.cpp, 1 kg of TNT, with its tolerance.
        names = ("incident_overpressure", "reflected_overpressure", "incident_impulse", "reflected_impulse", "arrival")
        for burst, distance, *expected in (
                ("hemispherical", 1, 1356.7e3, 8144.9e3, 236.43, 884.77, 0.46751e-3),
                ("hemispherical", 10, 14.807e3, 31.544e3, 31.013, 59.327, 21.635e-3),
                ("spherical", 0.5, 3884.8e3, 30360e3, 141.29, 1454.1, 0.15408e-3),
                ("spherical", 5, 31.296e3, 70.022e3, 40.619, 83.317, 8.9953e-3)):
            got = self.kb("--charge", "1 kg", "--distance", f"{distance} m", "--burst", burst)["quantities"]
            for name, value in zip(names, expected):
                self.assertAlmostEqual(got[name]["value"] / value, 1.0, delta=5e-5, msg=f"{burst} {distance} {name}")

    def test_other_explosives_count_by_their_tnt_equivalents(self):
        c4 = self.kb("--charge", "1 kg", "--distance", "3 m", "--burst", "spherical", "--explosive", "C-4")
        same = self.kb("--charge", f"{c4['tnt_mass_for_pressure']} kg", "--distance", "3 m", "--burst", "spherical")
        self.assertGreater(c4["tnt_mass_for_pressure"], 1.0)
        self.assertAlmostEqual(c4["quantities"]["incident_overpressure"]["value"]
                               / same["quantities"]["incident_overpressure"]["value"], 1.0, places=9)

    def test_an_unknown_tnt_equivalent_leaves_its_quantities_out(self):
        anfo = ("--charge", "1 kg", "--distance", "3 m", "--burst", "spherical", "--explosive", "ANFO")
        answer = self.kb(*anfo)
        self.assertEqual(answer["tnt_mass_for_pressure"], 0.82)
        self.assertIsNone(answer["tnt_mass_for_impulse"])
        self.assertIsNotNone(answer["quantities"]["incident_overpressure"]["value"])
        self.assertIsNone(answer["quantities"]["incident_impulse"]["value"])
        self.assertIn("TNT equivalent: 0.82 kg for pressures, unknown for impulses and times",
                      self.brisance("kb", *anfo).stdout)

    def test_outside_the_curves_there_is_no_value(self):
        far = self.kb("--charge", "1 kg", "--distance", "100 m", "--burst", "spherical")
        self.assertIsNone(far["quantities"]["incident_overpressure"]["value"])

    def test_the_dynamic_pressure_names_its_own_range(self):
        # 1 kg at 0.8 m: 1521 kPa, 15 ambient pressures; the other curves go down to Z = 0.0531.
        text = self.brisance("kb", "--charge", "1 kg", "--distance", "0.8 m", "--burst", "spherical").stdout
        self.assertRegex(text, r"dynamic pressure +- \(known for Z from 0\.964\d* to 40: valid up to an "
                               r"overpressure of 10 ambient pressures")
        self.assertNotIn("two values", text)
        far = self.brisance("kb", "--charge", "1 kg", "--distance", "41 m", "--burst", "spherical").stdout
        self.assertRegex(far, r"dynamic pressure +- \(known for Z from 0\.964\d* to 40\)")

    def test_the_hemispherical_impulse_tells_its_variant(self):
        def text(distance):
            return self.brisance("kb", "--charge", "1 kg", "--distance", distance, "--burst", "hemispherical").stdout
        self.assertIn("Two values of one coefficient", text("2 m"))
        self.assertIn("changes the impulse by -0.7 %", text("2 m"))
        answer = self.kb("--charge", "1 kg", "--distance", "2 m", "--burst", "hemispherical")
        self.assertAlmostEqual(answer["incident_impulse_of_other_fit"], 0.99314, places=5)
        self.assertIsNone(self.kb("--charge", "1 kg", "--distance", "2 m", "--burst",
                                  "spherical")["incident_impulse_of_other_fit"])
        self.assertEqual(answer["quantities"]["duration"]["scaled_distances"], [0.178, 40.0])
        self.assertNotIn("two values", text("0.9 m"))

    def test_bad_values_name_the_option(self):
        bad = ("--distance", "5 kg", "--burst", "spherical")
        self.assertIn('--distance: "5 kg" is a mass', self.brisance("kb", "--charge", "1 kg", *bad, code=2).stderr)
        negative = self.brisance("kb", "--charge=-1 kg", "--distance", "5 m", "--burst", "spherical", code=2)
        self.assertIn("must be positive", negative.stderr)
        unknown = self.brisance("kb", "--charge", "1 kg", "--distance", "5 m", "--burst", "spherical", "--explosive",
                                "TMT", code=2)
        self.assertIn('did you mean "TNT"?', unknown.stderr)


class Info(Case):
    def test_overview_lists_materials_and_models(self):
        text = self.brisance("info").stdout
        for word in ("TNT", "C-4", "air", "water", "spherical1d", "muscl-hancock", "jwl", "peak_overpressure"):
            self.assertIn(word, text)

    def test_one_material_with_parameters_and_source(self):
        text = self.brisance("info", "tnt").stdout
        for word in ("TNT: explosive", "source:", "detonation_speed", "m/s"):
            self.assertIn(word, text)

    def test_which_water_is_for_what(self):
        overview = self.brisance("info").stdout
        self.assertRegex(overview, r"water: for shocks of 0.5 to 4 GPa.*1625 m/s.*Cole \(1948\)")
        self.assertRegex(overview, r"water_mg: for shocks below 1 GPa.*1480 m/s.*Cole \(1948\)")
        self.assertIn("for shocks below 1 GPa", self.brisance("info", "water_mg").stdout)
        self.assertIn("for shocks of 0.5 to 4 GPa", self.brisance("info", "water").stdout)

    def test_peaks_in_the_two_waters_are_those_of_the_documentation(self):
        # docs/materials.md, "Two waters": percent off Cole's 52.4 MPa / Z^1.13 with cells of 2 mm, rounded.
        deck = (SOURCE / "cases/underwater_1d/deck.toml").read_text()
        for fluid, expected in (("water", (26, 19, 16, 14)), ("water_mg", (-4, -15, -21, -23))):
            path = self.folder / f"{fluid}.toml"
            path.write_text(deck.replace('"water_mg"', f'"{fluid}"'))
            out = self.folder / fluid
            self.brisance("run", path, "--output", out, "--quiet")
            gauges = json.loads((out / "summary.json").read_text())["gauges"]
            for gauge, percent in zip(gauges, expected):
                cole = 52.4e6 * float(gauge["name"][1:]) ** -1.13
                self.assertAlmostEqual(100 * (gauge["peak_overpressure"] / cole - 1), percent, delta=1.5,
                                       msg=f"{fluid} {gauge['name']}")
            audit = json.loads((out / "run.json").read_text())["audit"]["relative_error"]
            self.assertLess(audit["energy"], 1e-12)

    def test_unknown_material(self):
        self.assertIn('did you mean "TNT"?', self.brisance("info", "TMT", code=2).stderr)

    def test_deck_reference_is_the_documented_one(self):
        self.assertEqual(self.brisance("info", "--deck-reference").stdout, (SOURCE / "docs/deck.md").read_text())

    def test_json_schema_is_printed(self):
        schema = json.loads(self.brisance("info", "--json-schema").stdout)
        self.assertEqual(schema["$schema"], "https://json-schema.org/draft/2020-12/schema")
        self.assertEqual(schema["required"], ["domain", "end"])
        self.assertIn("charge", schema["properties"])


class Check(Case):
    def test_every_example_deck_is_valid(self):
        decks = sorted(SOURCE.glob("cases/*/deck.toml"))
        self.assertGreaterEqual(len(decks), 4)
        for deck in decks:
            plan = json.loads(self.brisance("check", deck, "--json").stdout)
            for charge in plan["charges"]:
                self.assertLess(abs(charge["relative_error"]), 1e-12, deck)
            self.assertLess(plan["memory_bytes"], 4e9, deck)
            self.brisance("check", deck)

    def test_the_decks_of_the_documentation_are_valid(self):
        for page in ("README.md", "docs/user-guide.md", "docs/deck.md"):
            decks = re.findall(r"```toml\n(\[domain.*?|title.*?)```", (SOURCE / page).read_text(), re.DOTALL)
            self.assertGreaterEqual(len(decks), 1, page)
            for text in decks:
                self.brisance("check", self.deck(text))

    def test_check_prints_what_it_understood_of_materials(self):
        deck = self.folder / "soil.toml"
        deck.write_text("""
[end]
time = 1e-3
[domain]
size = [1, 1, 1]
cell = 0.05
[points]
body_force = [0, 0, -9.81]
[[body]]
material = "sand"
shape = "box"
lower = [0, 0, 0]
upper = [1, 1, 0.5]
[solids.sand]
density = "1.6 g/cm3"
E = "5 MPa"
nu = 0.3
strength = {model = "drucker_prager", cohesion = 0, friction = "33 degrees"}
""")
        text = self.brisance("check", deck).stdout
        self.assertRegex(text, r'\nsand, from the deck\n  density +1600 kg/m3 +"1.6 g/cm3"\n  E +5000000 Pa +"5 MPa"\n')
        self.assertRegex(text, r'\n  strength.friction +33 deg +"33 degrees"\n')
        self.assertRegex(text, r'\n  eos.K +4166666.67 Pa +from E and nu\n')
        parameters = json.loads(self.brisance("check", deck, "--json").stdout)["material_parameters"]
        self.assertEqual(parameters["sand"]["parameters"]["strength.friction"],
                         {"value": 33.0, "unit": "deg", "deck": '"33 degrees"'})
        deck.write_text(SMALL + '[ambient]\nfluid = "water_mg"\n')
        text = self.brisance("check", deck).stdout
        self.assertRegex(text, r"\nwater_mg, from the library\n  for shocks below 1 GPa.*Cole")
        self.assertRegex(text, r"\n  C0 +1480 m/s\n")

    def test_check_promises_what_run_does(self):
        deck = self.deck(SMALL)
        plan = json.loads(self.brisance("check", deck, "--json").stdout)
        self.brisance("run", deck, "--quiet")
        log = json.loads((self.folder / "case-results/run.json").read_text())
        self.assertEqual(plan["dumps"], log["dumps"])
        self.assertEqual(plan["blocks"], log["blocks"])
        self.assertAlmostEqual(plan["charges"][0]["realised_mass"], log["charges"][0]["realised_mass"], places=12)

    def test_all_errors_of_a_deck_in_one_go(self):
        bad = self.deck(SMALL.replace("cell =", "cel =").replace("1 kg", "1 m"))
        text = self.brisance("check", bad, code=2).stderr
        self.assertIn('case.toml:6:1: error: domain.cel: unknown key "cel"', text)
        self.assertIn('did you mean "cell"?', text)
        self.assertIn("case.toml:8:", text)
        self.assertIn("expected a mass", text)
        self.assertFalse((self.folder / "case-results").exists())

    @unittest.skipIf(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") > 150e9, "this machine may hold the case")
    def test_a_case_larger_than_the_machine_is_refused_before_it_starts(self):
        deck = self.deck(SMALL.replace('"spherical1d"', '"cartesian3d"').replace("size = 1", "size = [25, 25, 25]")
                         .replace('"5 mm"', '"20 mm"').replace("point = 0.5", "point = [5, 5, 5]")
                         .replace('"1 kg"', '"1 kg"\nposition = [6, 6, 6]'))
        self.assertIn("this machine has", self.brisance("run", deck, code=2).stderr)
        self.assertFalse((self.folder / "case-results").exists())


class Run(Case):
    def test_a_run_leaves_everything(self):
        done = self.brisance("run", self.deck(SMALL), "--output", "out", "--threads", 2)
        out = self.folder / "out"
        for name in ("run.json", "deck.toml", "fields.xmf2", "gauges/near.csv", "summary.csv", "summary.json"):
            self.assertGreater((out / name).stat().st_size, 0, name)
        self.assertEqual(len(list(out.glob("fields/*.h5"))), 5)
        self.assertEqual((out / "deck.toml").read_text(), SMALL)
        log = json.loads((out / "run.json").read_text())
        self.assertEqual((log["status"], log["exit_code"]), ("done", 0))
        self.assertEqual(log["time"], 0.4e-3)
        self.assertLess(max(log["audit"]["relative_error"]["mass"] + [log["audit"]["relative_error"]["energy"]]), 1e-12)
        for word in ("near", "Kingery-Bulmash", "audit: balanced", "results: out", "brisance report out"):
            self.assertIn(word, done.stdout)

    def test_quiet_is_quiet(self):
        done = self.brisance("run", self.deck(SMALL), "--quiet")
        self.assertEqual((done.stdout, done.stderr), ("", ""))

    def test_results_are_not_overwritten_unless_forced(self):
        deck = self.deck(SMALL)
        self.brisance("run", deck, "--quiet")
        refused = self.brisance("run", deck, code=5)
        self.assertIn("--force", refused.stderr)
        self.brisance("run", deck, "--quiet", "--force")

    def test_force_leaves_what_is_not_the_runs(self):
        deck = self.deck(SMALL)
        self.brisance("run", deck, "--output", "out", "--quiet")
        out = self.folder / "out"
        mine = [out / name for name in ("gauges/mine.csv", "fields/mine.h5", "fields/fields_000099.h5", "notes.txt",
                                        "checkpoints/mine.brz", "points.xmf2")]
        for path in mine:
            path.write_text("mine")
        other = self.folder / "other.toml"
        other.write_text(SMALL.replace('"near"', '"elsewhere"'))
        self.brisance("run", other, "--output", "out", "--quiet", "--force")
        for path in mine:
            self.assertEqual(path.read_text(), "mine")
        self.assertFalse((out / "gauges/near.csv").exists())
        self.assertTrue((out / "gauges/elsewhere.csv").exists())
        # A file of somebody else in the place of a result: neither written nor removed.
        (out / "gauges/near.csv").write_text("mine")
        self.assertIn('gauges/near.csv" already exists',
                      self.brisance("run", deck, "--output", "out", "--force", code=5).stderr)
        self.assertEqual((out / "gauges/near.csv").read_text(), "mine")
        self.assertTrue((out / "gauges/elsewhere.csv").exists())

    def test_links_in_the_folder_are_not_followed(self):
        deck = self.deck(SMALL)
        theirs = self.folder / "theirs"
        theirs.mkdir()
        (theirs / "near.csv").write_text("mine")
        (theirs / "deck.toml").write_text("mine")
        self.brisance("run", deck, "--output", "out", "--quiet")
        out = self.folder / "out"
        (out / "gauges/near.csv").unlink()
        (out / "gauges").rmdir()
        (out / "gauges").symlink_to(theirs)
        for option in ("--force", "--resume"):
            (self.folder / deck).write_text(SMALL.replace("0.4 ms", "0.5 ms"))
            self.assertIn('gauges" is a link', self.brisance("run", deck, "--output", "out", option, code=5).stderr)
        (out / "gauges").unlink()
        (out / "deck.toml").unlink()
        (out / "deck.toml").symlink_to(theirs / "deck.toml")
        self.assertIn('deck.toml" is a link', self.brisance("run", deck, "--output", "out", "--force", code=5).stderr)
        for path in theirs.iterdir():
            self.assertEqual(path.read_text(), "mine")
        # The folder itself may be one: that is where the user wants the results.
        (self.folder / "link").symlink_to(self.folder / "real")
        (self.folder / "real").mkdir()
        self.brisance("run", deck, "--output", "link/", "--quiet")
        self.assertTrue((self.folder / "real/gauges/near.csv").exists())

    def test_a_folder_belongs_to_one_run(self):
        process, gauge = self.started()
        for options in ((), ("--force",), ("--resume",)):
            done = self.brisance("run", "case.toml", "--output", "out", *options, code=5)
            self.assertIn(f"another run (process {process.pid} on ", done.stderr)
        self.assertIsNone(process.poll())
        size = gauge.stat().st_size
        process.kill()
        process.communicate()
        self.assertGreaterEqual(gauge.stat().st_size, size)
        self.deck(LONG.replace('"1 s"', '"1 s"\nsteps = 3'))
        self.brisance("run", "case.toml", "--output", "out", "--force", "--quiet")
        self.assertFalse((self.folder / "out/.brisance-lock").exists())

    def test_a_reader_that_has_read_enough_ends_nothing(self):
        deck = self.deck(SMALL.replace('cell = "5 mm"', 'cell = "2.5 mm"'))
        for redirection in ("| head -1", "2>&1 | head -1", "2>&1 | true", ">&-", ">&- 2>&- <&-"):
            with self.subTest(redirection):
                command = f"'{PROGRAM}' run {deck} --output out --force {redirection}; exit ${{PIPESTATUS[0]}}"
                done = subprocess.run(["bash", "-c", command], cwd=self.folder, capture_output=True, text=True,
                                      timeout=300)
                self.assertEqual(done.returncode, 0, done.stderr)
                log = json.loads((self.folder / "out/run.json").read_text())
                self.assertEqual((log["status"], log["dumps"]), ("done", 5))
                self.assertTrue((self.folder / "out/summary.csv").exists())
                self.assertEqual((self.folder / "out/deck.toml").read_text(), (self.folder / deck).read_text())
        done = subprocess.run(["bash", "-c", f"'{PROGRAM}' info --deck-reference | head -1; exit ${{PIPESTATUS[0]}}"],
                              capture_output=True, timeout=60)
        self.assertEqual(done.returncode, 0)

    def test_the_clock_stops_a_run_that_goes_on_later(self):
        text = LONG.replace('time = "1 s"', 'time = "1 s"\nwall_clock = "0.3 s"')
        self.assertIn("stopped by the wall-clock limit",
                      self.brisance("run", self.deck(text), "--output", "out", code=3).stdout)
        before = json.loads((self.folder / "out/run.json").read_text())["step"]
        self.deck(text.replace("wall_clock", f"steps = {before + 20}\n# wall_clock"))
        self.brisance("run", "case.toml", "--output", "out", "--resume", "--quiet")
        log = json.loads((self.folder / "out/run.json").read_text())
        self.assertEqual((log["status"], log["step"]), ("done", before + 20))

    def test_a_resumed_run_goes_on_with_its_vector_instructions(self):
        kept = SMALL + "[checkpoint]\nat_end = true\n"
        whole = self.deck(kept)
        short = self.deck(kept.replace('time = "0.4 ms"', 'time = "0.4 ms"\nsteps = 40'), "short.toml")

        def results(folder):
            log = json.loads((self.folder / folder / "run.json").read_text())
            return log["machine"]["simd"], (self.folder / folder / "gauges" / "near.csv").read_bytes()

        self.brisance("run", whole, "--simd", "scalar", "--output", "straight")
        self.brisance("run", short, "--simd", "scalar", "--output", "stopped")
        resumed = self.brisance("run", whole, "--resume", "--output", "stopped")
        self.assertNotIn("vector instructions", resumed.stderr)
        self.assertEqual(results("stopped")[0], "scalar")
        self.assertEqual(results("stopped"), results("straight"))
        if ", scalar;" not in self.brisance("run", short, "--output", "other").stdout:
            other = self.brisance("run", whole, "--resume", "--simd", "scalar", "--output", "other")
            self.assertRegex(other.stderr, "the run began with the vector instructions .* and goes on with scalar")

    def test_unknown_vector_instructions_are_refused(self):
        run = self.brisance("run", self.deck(SMALL), "--simd", "mmx", code=2)
        self.assertIn("--simd mmx: no set of vector instructions; possible here: auto, scalar", run.stderr)

    def test_report(self):
        self.brisance("run", self.deck(SMALL), "--output", "out", "--quiet")
        path = self.brisance("report", "out").stdout.strip()
        page = (self.folder / path).read_text()
        self.assertIn("near", page)
        self.assertIn("1 kg", page)

    def test_report_with_the_outlines_of_blocks(self):
        self.brisance("run", self.deck(PLANE), "--output", "out", "--quiet")
        pages = [(self.folder / self.brisance("report", "out", *options).stdout.strip()).read_text()
                 for options in ([], ["--blocks"])]
        self.assertNotEqual(*pages)

    def test_report_of_nothing(self):
        self.assertIn("does not contain run.json", self.brisance("report", ".", code=5).stderr)

    def started(self, *before):
        """A long run that has put gauge records on the disk; `before` are words before the command."""
        process = subprocess.Popen([*before, PROGRAM, "run", self.deck(LONG), "--output", "out"], cwd=self.folder,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        gauge = self.folder / "out/gauges/near.csv"
        for _ in range(600):
            if gauge.exists() and gauge.stat().st_size > 1000:
                return process, gauge
            time.sleep(0.1)
        process.kill()
        self.fail(process.communicate())

    def test_nohup_keeps_a_run_alive(self):
        process, _ = self.started("nohup")
        process.send_signal(signal.SIGHUP)
        time.sleep(0.5)
        self.assertIsNone(process.poll())
        process.terminate()
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 3)

    def interrupted(self, number):
        process, gauge = self.started()
        process.send_signal(number)
        text, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 3, text)
        self.assertRegex(text, r"stopped by the user at t = .*, 0\.\d % of the time, step \d+")
        log = json.loads((self.folder / "out/run.json").read_text())
        self.assertEqual((log["status"], log["exit_code"]), ("stopped", 3))
        rows = list(csv.reader(gauge.read_text().splitlines()))
        self.assertEqual(len(rows), log["step"] + 2)  # head, initial state, one per step
        self.assertEqual({len(row) for row in rows}, {9})
        self.assertAlmostEqual(float(rows[-1][0]) / log["time"], 1.0, places=9)
        last = sorted((self.folder / "out/fields").glob("*.h5"))[-1]
        with h5py.File(last) as dump:
            self.assertEqual(dump.attrs["step"], log["step"])
        self.assertTrue((self.folder / "out/summary.csv").exists())

    def test_sigterm_stops_and_writes(self):
        self.interrupted(signal.SIGTERM)

    def test_sigint_stops_and_writes(self):
        self.interrupted(signal.SIGINT)


# A quarter of a burst in free air, small enough for a test.
REMAP = """
start = "remap"
[domain]
size = [0.4, 0.4, 0.4]
cell = "20 mm"
[boundaries]
x_low = "symmetry"
y_low = "symmetry"
z_low = "symmetry"
[remap]
cell = "1 mm"
[[charge]]
mass = "1 kg"
[[gauge]]
name = "g"
point = [0.3, 0, 0]
[end]
time = "0.1 ms"
"""

# A cylinder above the ground, until its shock has been reflected there.
CYLINDER = """
[domain]
geometry = "axisymmetric2d"
size = [0.3, 0.4]
cell = "2.5 mm"
[boundaries]
y_low = "wall"
[[charge]]
shape = "cylinder"
mass = "0.5 kg"
length_to_diameter = 1
position = [0, 0.1]
[output]
profile = true
[end]
time = "25 us"
"""

CYLINDER_3D = """
start = "remap"
[domain]
size = [0.4, 0.4, 0.4]
cell = "10 mm"
[boundaries]
x_low = "symmetry"
y_low = "symmetry"
z_low = "wall"
[remap]
profile = "flat/profiles/end.h5"
[[charge]]
shape = "cylinder"
mass = "0.5 kg"
length_to_diameter = 1
position = [0, 0, 0.1]
[end]
time = "0.05 ms"
"""


class Remap(Case):
    """A start by a remap, from the deck to the log."""

    def log(self, folder):
        return json.loads((self.folder / folder / "run.json").read_text())

    def test_bursts_are_kept_scaled_and_used_again(self):
        self.deck(REMAP, "one.toml")
        done = self.brisance("run", "one.toml", "--output", "one")
        self.assertIn("remapped at", done.stdout)
        self.assertIn("relative error", done.stdout)
        one = self.log("one")
        start = one["starts"][0]
        self.assertLess(start["relative_error"], 1e-12)
        self.assertIn('gauge "g"', start["near"])
        self.assertEqual(json.loads((self.folder / "one/summary.json").read_text())["starts"], one["starts"])
        # The gauge holds ambient gas at the time 0, and goes on at the remap.
        times = [line.split(",")[0] for line in (self.folder / "one/gauges/g.csv").read_text().splitlines()[1:3]]
        self.assertEqual(float(times[0]), 0.0)
        self.assertAlmostEqual(float(times[1]) / start["time"], 1.0, places=9)

        # Eight times the mass in twice the domain: the same numbers at twice the time.
        scaled = REMAP.replace('cell = "1 mm"', 'profile = "one/profiles/start_1.h5"').replace('"1 kg"', '"8 kg"')
        scaled = scaled.replace("0.4, 0.4, 0.4", "0.8, 0.8, 0.8").replace('"20 mm"', '"40 mm"')
        scaled = scaled.replace("0.3, 0, 0", "0.6, 0, 0").replace('"0.1 ms"', '"0.2 ms"')
        self.deck(scaled, "eight.toml")
        self.assertIn("profile", self.brisance("check", "eight.toml").stdout)
        self.brisance("run", "eight.toml", "--output", "eight")
        eight = self.log("eight")
        self.assertAlmostEqual(eight["starts"][0]["time"] / start["time"], 2.0, places=9)
        self.assertAlmostEqual(eight["starts"][0]["before"]["energy"] / start["before"]["energy"], 8.0, places=9)

        def peak(folder):
            summary = json.loads((self.folder / folder / "summary.json").read_text())
            return summary["gauges"][0]["peak_overpressure"]
        self.assertAlmostEqual(peak("eight") / peak("one"), 1.0, places=6)

        self.deck(scaled.replace('mass = "8 kg"', 'mass = "8 kg"\nexplosive = "C-4"'), "other.toml")
        for command in (("check", "other.toml"), ("run", "other.toml", "--output", "other")):
            errors = self.brisance(*command, code=2).stderr
            self.assertIn("other.toml:11:11: error: remap.profile: ", errors)
            self.assertIn("its explosive is TNT, but that of the deck is C-4", errors)
        self.deck(scaled.replace("start_1", "start_9"), "none.toml")
        self.assertIn("does not exist", self.brisance("check", "none.toml", code=5).stderr)

    def test_an_axisymmetric_burst_goes_into_3d(self):
        self.deck(CYLINDER, "flat.toml")
        self.brisance("run", "flat.toml", "--output", "flat")
        self.deck(CYLINDER_3D, "solid.toml")
        self.brisance("run", "solid.toml", "--output", "solid")
        log = self.log("solid")
        self.assertLess(log["starts"][0]["relative_error"], 1e-12)
        self.assertAlmostEqual(log["charges"][0]["realised_mass"], 0.5, places=9)
        self.assertAlmostEqual(log["starts"][0]["time"] / 25e-6, 1.0, places=12)
        self.deck(CYLINDER_3D.replace('"wall"', '"outflow"'), "solid.toml")
        self.assertIn("must be a wall or a symmetry plane there", self.brisance("check", "solid.toml", code=2).stderr)


class Failures(Case):
    def test_missing_deck(self):
        self.assertIn("none.toml", self.brisance("run", "none.toml", code=5).stderr)
        self.brisance("check", "none.toml", code=5)

    def test_a_folder_is_no_deck(self):
        self.brisance("check", ".", code=5)

    def test_bad_deck(self):
        self.assertIn("case.toml:1:", self.brisance("run", self.deck("x = ["), code=2).stderr)

    def test_a_deck_that_is_too_large_is_not_read(self):
        path = self.folder / "large.toml"
        with open(path, "w") as deck:
            deck.truncate(1 << 40)  # takes no space, and would take hours to read
        done = self.brisance("check", path, code=2)
        self.assertIn("the deck has 1099511627776 bytes; allowed: at most 1048576", done.stderr)
        self.assertIn("the deck has more than 1048576 bytes", self.brisance("check", "/dev/zero", code=2).stderr)
        exact = SMALL + "#" * (1048576 - len(SMALL))
        self.brisance("check", self.deck(exact))
        self.brisance("check", self.deck(exact + "#"), code=2)

    def test_long_lists_of_messages_are_cut(self):
        deck = self.deck(SMALL + "".join(f"[[gauge]]\npoint = {n + 2}\n" for n in range(70)))
        lines = self.brisance("check", deck, code=2).stderr.splitlines()
        self.assertEqual(sum(": error: gauge[" in line for line in lines), 50)
        self.assertEqual(lines[50:], ["and 20 more", "brisance: error: case.toml: 70 errors"])
        body = '[[body]]\nname = "b{0}"\nmaterial = "RHA"\nshape = "box"\nlower = {1:.3f}\nupper = {2:.3f}\n'
        thin = ('[domain]\ngeometry = "planar1d"\nsize = 2\ncell = "5 mm"\n[end]\ntime = "1 ms"\n'
                + "".join(body.format(n, 0.02 * n, 0.02 * n + 0.005) for n in range(60)))
        warned = self.brisance("check", self.deck(thin))
        self.assertEqual(warned.stdout.count("across its shortest side"), 50)
        self.assertIn("and 10 more", warned.stdout)

    def test_guards_that_add_energy_stop_the_run(self):
        # A floor ten times the ambient pressure.
        guarded = SMALL.replace("0.4 ms", "20 us") + (
            "[ambient]\npressure = '1 kPa'\ndensity = 0.012\n[numerics]\npressure_floor = '10 kPa'\n")
        done = self.brisance("run", self.deck(guarded), "--output", "out", code=4)
        self.assertIn("the audit stopped the run: guards added", done.stderr)
        self.assertTrue((self.folder / "out/checkpoints/stopped.brz").exists())
        log = json.loads((self.folder / "out/run.json").read_text(encoding="utf-8"))
        self.assertIs(log["audit"]["balanced"], False)
        # For comparison it runs on, and says what is wrong.
        compared = self.deck(guarded + "scheme = 'lax-wendroff'\n")
        done = self.brisance("run", compared, "--output", "out", "--force")
        self.assertIn("audit: NOT BALANCED", done.stdout)
        self.assertIn("NOT BALANCED: guards added", done.stdout)
        self.assertNotIn("audit: balanced", done.stdout)

    def test_output_inside_a_file(self):
        deck = self.deck(SMALL)
        self.assertIn("Not a directory", self.brisance("run", deck, "--output", f"{deck}/out", code=5).stderr)

    def test_output_that_cannot_be_created(self):
        # /proc refuses new folders even to root.
        self.assertIn("/proc/out", self.brisance("run", self.deck(SMALL), "--output", "/proc/out", code=5).stderr)

    def test_disk_that_fills_up_during_the_run(self):
        # The size limit of files stands for the full disk: writing beyond it fails in the same way.
        deck = self.deck(LONG)
        limited = ["bash", "-c", f"ulimit -f 200; exec '{PROGRAM}' run {deck} --output out"]
        done = subprocess.run(limited, cwd=self.folder, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertIn("File too large", done.stderr)

    @unittest.skipUnless(os.geteuid() == 0, "needs root to mount a small disk")
    def test_disk_that_is_too_small_is_refused_before_the_run(self):
        disk = self.folder / "disk"
        disk.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk], capture_output=True)
        if mounted.returncode != 0:
            self.skipTest("mounting is not allowed here")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        deck = self.deck(SMALL.replace('"5 mm"', '"0.5 mm"').replace('"0.1 ms"', '"0.01 ms"'))
        done = self.brisance("run", deck, "--output", disk / "out", code=5)
        self.assertIn("not enough space", done.stderr)
        self.assertNotIn("step", done.stderr)
        # Subsets count too.
        checkpoints = "[checkpoint]\nat_end = false\non_signal = false\nwall_clock = 0\nkeep = 1\n"
        for interval, refused in (("0", False), ('"0.1 us"', True)):
            subset = (f'[[output.subset]]\nname = "cut"\nplane = {{normal = "x", at = 0.5}}\ninterval = {interval}\n'
                      'fields = ["pressure"]\n')
            deck = self.deck(PLANE.replace('"10 mm"', '"100 mm"') + "[output]\npeak_fields = false\n" + subset +
                             checkpoints)
            # One that is not refused may still meet the end of this disk later, whose files take whole pages.
            done = subprocess.run([PROGRAM, "run", deck, "--output", disk / "out", "--force", "--quiet"],
                                  cwd=self.folder, capture_output=True, text=True, timeout=300)
            self.assertEqual("not enough space" in done.stderr, refused, done.stderr)


class Determinism(Case):
    def results(self, name, threads, sleep="true", scheme="muscl-hancock"):
        deck = self.deck(BLAST_3D.replace("SLEEP", sleep).replace("SCHEME", scheme), f"{name}.toml")
        self.brisance("run", deck, "--output", name, "--threads", threads, "--quiet")
        contents = {path.name: path.read_bytes() for path in (self.folder / name / "gauges").iterdir()}
        for path in sorted((self.folder / name / "fields").iterdir()):
            with h5py.File(path) as dump:
                for field, data in dump["cells"].items():
                    contents[f"{path.name}/{field}"] = data[...].tobytes()
                    self.assertTrue(numpy.isfinite(data[...]).all())
        self.assertEqual(len(contents), 3 + 5 + 7)  # gauges, fields, and those of the last dump
        return contents

    def assert_same(self, a, b):
        self.assertEqual(a.keys(), b.keys())
        self.assertEqual([name for name in a if a[name] != b[name]], [])

    def test_threads_and_sleep_do_not_change_a_bit(self):
        for scheme in ("muscl-hancock", "lax-wendroff"):
            with self.subTest(scheme=scheme):
                one = self.results(f"{scheme}-1", 1, scheme=scheme)
                self.assert_same(one, self.results(f"{scheme}-2", 2, scheme=scheme))
                self.assert_same(one, self.results(f"{scheme}-4", 4, scheme=scheme))
                self.assert_same(one, self.results(f"{scheme}-awake", 2, "false", scheme))


if __name__ == "__main__":
    unittest.main()
