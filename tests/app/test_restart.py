"""A run that is stopped at any moment and resumed equals the uninterrupted one, byte for byte.

Usage: BRISANCE=path/to/brisance python3 test_restart.py [CLASS...]
The environment variable BRISANCE_RESTART_MOMENTS is the number of interruptions of each kind of case; the test suite
takes 2, `BRISANCE_RESTART_MOMENTS=20` is the long version, and BRISANCE_RESTART_SEED draws other moments.
"""
import json
import os
import random
import re
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

PROGRAM = os.environ["BRISANCE"]
MOMENTS = int(os.environ.get("BRISANCE_RESTART_MOMENTS", "2"))
SEED = int(os.environ.get("BRISANCE_RESTART_SEED", "1"))

# Programmed burn, two dump intervals, gauges that are sampled now and then, peak fields.
SPHERE = """
[domain]
geometry = "spherical1d"
size = 1.5
cell = "2.5 mm"
[numerics]
block_cells = 64
[[charge]]
mass = "1 kg"
[[gauge]]
name = "near"
point = 0.5
[[gauge]]
name = "far"
point = 1.2
[output]
field_interval = "0.1 ms"
field_times = ["0.133 ms"]
gauge_interval = "3 us"
precision = "double"
[checkpoint]
steps = 1
[end]
time = "0.5 ms"
"""

# Blocks that sleep and wake, an obstacle, gas that leaves the domain, a gauge at every step.
BURST = """
[domain]
geometry = "axisymmetric2d"
size = [0.8, 0.8]
cell = "12.5 mm"
[boundaries]
y_low = "wall"
[numerics]
block_cells = 16
[[charge]]
mass = "1 kg"
shape = "hemisphere"
position = [0, 0]
[[obstacle]]
shape = "box"
lower = [0.4, 0]
upper = [0.5, 0.2]
[[gauge]]
line = {from = [0.3, 0.1], to = [0.7, 0.7], count = 3}
[output]
field_interval = "0.05 ms"
precision = "double"
[[output.subset]]
name = "floor"
plane = {normal = "y", at = "20 mm"}
interval = "17 us"
[[output.subset]]
name = "near"
box = {lower = [0.3, 0], upper = [0.7, 0.5]}
cell = "25 mm"
interval = "40 us"
fields = ["pressure", "obstacle"]
[checkpoint]
interval = "2 us"
keep = 3
[end]
time = "1 ms"
steps = 220
"""

# Points that cross blocks, slide on each other, yield, heat, break and leave the domain; one is pushed.
IMPACT = """
[domain]
geometry = "planar2d"
size = ["48 mm", "40 mm"]
cell = "1 mm"
[points]
transfer = "TRANSFER"
shape_function = "SHAPE"
block_cells = 8
[[body]]
name = "plate"
material = "4340-steel"
shape = "box"
lower = ["20 mm", "2 mm"]
upper = ["24 mm", "38 mm"]
[[body]]
name = "rod"
material = "OFHC-copper"
shape = "box"
lower = ["4 mm", "16 mm"]
upper = ["18.5 mm", "22 mm"]
velocity = [600, 0]
[[body]]
name = "runaway"
material = "6061-T6"
shape = "box"
lower = ["42 mm", "4 mm"]
upper = ["47 mm", "9 mm"]
velocity = [900, 0]
[[contact]]
bodies = ["plate", "rod"]
friction = 0.3
[[constraint]]
within = {shape = "box", lower = ["20 mm", "36 mm"], upper = ["24 mm", "38 mm"]}
body = "plate"
[[surface_pressure]]
body = "rod"
normal = "-x"
history = {times = [0, "2 us", "12 us"], pressures = [0, "300 MPa", "100 MPa"]}
[[gauge]]
name = "tip"
body = "rod"
point = ["18 mm", "19 mm"]
[[gauge]]
name = "gone"
body = "runaway"
point = ["45 mm", "6 mm"]
[[gauge]]
body = "plate"
[output]
field_interval = "4 us"
precision = "double"
point_fields = ["velocity", "displacement", "stress", "energy", "plastic_strain", "temperature", "damage", "identity"]
[checkpoint]
steps = 2
[end]
time = "25 us"
"""

# Gas and points together: a charge beside a slab, the region wakes on the way, points are born, split, merge and leave.
SLAB = """
[domain]
geometry = "planar2d"
lower = ["-120 mm", 0]
upper = ["200 mm", "240 mm"]
cell = "5 mm"
[numerics]
block_cells = 16
[[charge]]
explosive = "TNT"
shape = "cylinder"
position = [0, "120 mm"]
radius = "40 mm"
[solids.stone]
density = 2400
E = "30 GPa"
nu = 0.2
[[body]]
name = "slab"
material = "stone"
shape = "box"
lower = ["130 mm", "80 mm"]
upper = ["150 mm", "160 mm"]
[mpm_region]
box = {lower = ["80 mm", "40 mm"], upper = ["200 mm", "200 mm"]}
width = 3
[[gauge]]
name = "free"
point = ["-60 mm", "120 mm"]
[[gauge]]
name = "front"
point = ["112 mm", "120 mm"]
[[gauge]]
body = "slab"
[output]
field_interval = "10 us"
precision = "double"
[[output.subset]]
name = "middle"
plane = {normal = "y", at = "120 mm"}
interval = "4 us"
[checkpoint]
steps = 2
[end]
time = "45 us"
"""


# The same with a second slab in a region of its own, which the wave reaches later.
SLABS = SLAB.replace('upper = ["200 mm", "240 mm"]', 'upper = ["380 mm", "240 mm"]').replace("[mpm_region]", '''[[body]]
name = "second"
material = "stone"
shape = "box"
lower = ["290 mm", "80 mm"]
upper = ["310 mm", "160 mm"]
[[mpm_region]]
box = {lower = ["240 mm", "40 mm"], upper = ["360 mm", "200 mm"]}
width = 2
[[mpm_region]]''').replace('time = "45 us"', 'time = "80 us"').replace("[output]", '''[[gauge]]
body = "second"
point = ["292 mm", "120 mm"]
[output]
gas_points = true''')


class Case(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)

    def deck(self, text, name="case.toml"):
        (self.folder / name).write_text(text)
        return name

    def command(self, *arguments):
        return [PROGRAM, "run", "case.toml", "--threads", "1", *arguments]

    def brisance(self, *arguments, code=0):
        done = subprocess.run(self.command(*arguments), cwd=self.folder, capture_output=True, text=True, timeout=600)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def contents(self, name):
        """Every byte that a run leaves, without checkpoints and without what the clock on the wall says."""
        out = {}
        for path in sorted((self.folder / name).rglob("*")):
            key = str(path.relative_to(self.folder / name))
            if path.is_dir() or key.startswith("checkpoints/"):
                continue
            out[key] = path.read_bytes()
        # Also not on the list; what is there follows from what is kept.
        out["files.txt"] = b"".join(line for line in out["files.txt"].splitlines(keepends=True)
                                    if not line.startswith(b"checkpoints/"))
        log = json.loads(out.pop("run.json"))
        for key in ("timings", "wall_seconds", "cell_updates_per_second", "started_at", "resumed_at_steps"):
            log.pop(key)
        for key in ("bytes", "point_updates_per_second"):
            log.get("points", {}).pop(key, None)
        for key in ("bridge_seconds", "bridge_share"):
            log.get("mpm_region", {}).pop(key, None)  # several regions have no such keys
        out["run.json"] = json.dumps(log, sort_keys=True).encode()
        return out

    def assert_same(self, whole, name):
        found = self.contents(name)
        self.assertEqual(found.keys(), whole.keys())
        self.assertEqual([key for key in whole if found[key] != whole[key]], [], name)

    def checkpoints(self, name):
        return sorted((self.folder / name / "checkpoints").glob("checkpoint_*.brz"))


class Interrupted(Case):
    """Killed at random moments. With a checkpoint at every step or two a good part of them lies within a write."""

    def newest(self, name):
        steps = [int(path.stem.split("_")[1]) for path in self.checkpoints(name)]
        return max(steps, default=-1)

    def kill(self, name, number, step, delay):
        """Starts or resumes the run and kills it a moment after its checkpoint of the given step; was it in time?"""
        resume = "--resume" if self.newest(name) >= 0 else "--force"
        process = subprocess.Popen(self.command("--output", name, "--quiet", resume), cwd=self.folder,
                                   stderr=subprocess.PIPE, text=True)
        while self.newest(name) < step and process.poll() is None:
            time.sleep(0.0005)
        time.sleep(delay)
        process.send_signal(number)
        _, errors = process.communicate(timeout=60)
        self.assertIn(process.returncode, (0, 3, -number), errors)
        if process.returncode == 3:
            log = json.loads((self.folder / name / "run.json").read_text())
            self.assertEqual(self.newest(name), log["step"])
        return process.returncode != 0

    def interrupt(self, text):
        draw = random.Random(SEED)
        self.deck(text)
        self.brisance("--output", "whole", "--quiet")
        whole = self.contents("whole")
        steps = json.loads(whole["run.json"])["step"]
        within_writes = 0
        landed = 0
        for attempt in range(5 * MOMENTS):
            name = f"cut-{attempt}"
            number = signal.SIGTERM if landed % 2 == 0 else signal.SIGKILL
            # The second hits a run that has been resumed itself, the last one while it takes up the folder.
            moments = [(step, 0.004) for step in sorted(draw.randint(0, steps) for _ in range(2))] + [(-1, 0.05)]
            killed = [self.kill(name, number, step, draw.uniform(0.0, longest)) for step, longest in moments]
            landed += killed[0]
            within_writes += (self.folder / name / "checkpoints/checkpoint.part").exists()
            self.brisance("--output", name, "--quiet", "--resume")
            self.assert_same(whole, name)
            shutil.rmtree(self.folder / name)
            if landed == MOMENTS:
                break
        self.assertEqual(landed, MOMENTS, "the runs end before the signals come")
        print(f"{landed} runs interrupted, {within_writes} ended within a write of a checkpoint", flush=True)

    def test_sphere(self):
        self.interrupt(SPHERE)

    def test_burst(self):
        self.interrupt(BURST)

    def test_burst_on_levels(self):
        version = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, check=True).stdout
        if "without p4est" in version:
            self.skipTest("built without p4est")
        self.interrupt(BURST.replace("[[charge]]", '[adaptive]\nfinest = "6.25 mm"\n[[charge]]', 1))

    def test_impact_flip(self):
        self.interrupt(IMPACT.replace("TRANSFER", "flip").replace("SHAPE", "bspline"))

    def test_slab(self):
        self.interrupt(SLAB)

    def test_slabs_in_regions_of_their_own(self):
        self.interrupt(SLABS)
        log = json.loads((self.folder / "whole/run.json").read_text())
        self.assertEqual([region["awake_since"] is None for region in log["mpm_regions"]], [False, False])

    def test_remap(self):
        self.interrupt('start = "remap"\n[remap]\ncell = "0.5 mm"' + SLAB)

    @unittest.skipIf(MOMENTS < 3, "the long version tries the other transfers")
    def test_impact_apic(self):
        self.interrupt(IMPACT.replace("TRANSFER", "apic").replace("SHAPE", "cpgimp"))

    @unittest.skipIf(MOMENTS < 3, "the long version tries the other transfers")
    def test_impact_xpic(self):
        self.interrupt(IMPACT.replace("TRANSFER", "xpic").replace("SHAPE", "gimp"))


class Resume(Case):
    SMALL = SPHERE.replace('"2.5 mm"', '"10 mm"').replace("steps = 1", "steps = 10")

    def stopped(self, text=SMALL):
        """The folder of a run that has been killed: a finished one without its last checkpoint and its end."""
        self.deck(text)
        self.brisance("--output", "whole", "--quiet")
        shutil.copytree(self.folder / "whole", self.folder / "cut")
        log = json.loads((self.folder / "cut/run.json").read_text())
        log["status"] = "running"
        (self.folder / "cut/run.json").write_text(json.dumps(log))
        return self.contents("whole")

    def test_a_damaged_checkpoint_is_refused_and_the_previous_one_used(self):
        whole = self.stopped()
        newest = self.checkpoints("cut")[-1]
        good = newest.read_bytes()
        damages = {
            "it is truncated: it has": good[:len(good) // 2],
            "the header alone needs": good[:7],
            "it does not begin with": b"x" + good[1:],
            "its header is damaged": good[:20] + bytes([good[20] ^ 4]) + good[21:],
            "its data are damaged": good[:-9] + bytes([good[-9] ^ 128]) + good[-8:],
        }
        for words, content in damages.items():
            with self.subTest(words):
                shutil.copytree(self.folder / "cut", self.folder / "damaged")
                (self.folder / "damaged/checkpoints" / newest.name).write_bytes(content)
                done = self.brisance("--output", "damaged", "--resume")
                self.assertIn(f'the checkpoint "damaged/checkpoints/{newest.name}" cannot be used: ', done.stderr)
                self.assertIn(words, done.stderr)
                previous = self.checkpoints("cut")[-2].name
                self.assertIn(f'using the checkpoint "damaged/checkpoints/{previous}"', done.stderr)
                self.assertIn(f"resuming from damaged/checkpoints/{previous}: t = ", done.stdout)
                self.assert_same(whole, "damaged")
                self.assertTrue((self.folder / "damaged/checkpoints" / (newest.name + ".refused")).exists())
                shutil.rmtree(self.folder / "damaged")

    def test_without_a_good_checkpoint_nothing_is_touched(self):
        self.stopped()
        for path in self.checkpoints("cut"):
            path.write_bytes(path.read_bytes()[:-1])
        before = self.contents("cut")
        done = self.brisance("--output", "cut", "--resume", code=5)
        self.assertEqual(done.stderr.count("it is truncated"), 2)
        self.assertIn("contains no valid checkpoint", done.stderr)
        self.assertIn("--force", done.stderr)
        self.assertEqual(self.contents("cut"), before)
        self.assertIn("contains no checkpoint", self.brisance("--output", "nowhere", "--resume", code=5).stderr)
        self.assertFalse((self.folder / "nowhere").exists())

    def test_a_finished_run_is_left_alone(self):
        self.stopped()
        before = self.contents("whole")
        self.assertIn("has already finished", self.brisance("--output", "whole", "--resume").stdout)
        self.assertEqual(self.contents("whole"), before)

    def test_a_finished_run_goes_on_when_its_end_is_moved(self):
        self.stopped()
        former = (self.folder / "whole/gauges/near.csv").read_text()
        self.deck(self.SMALL.replace('"0.5 ms"', '"0.7 ms"'))
        self.brisance("--output", "whole", "--resume", "--quiet")
        log = json.loads((self.folder / "whole/run.json").read_text())
        self.assertEqual((log["time"], log["status"]), (0.7e-3, "done"))
        self.assertTrue((self.folder / "whole/gauges/near.csv").read_text().startswith(former[:-200]))
        self.assertEqual(len(list((self.folder / "whole/fields").iterdir())), 9)

    def test_subsets_may_come_and_go(self):
        def series(name):
            listed = json.loads((self.folder / "out/subsets" / f"{name}.hdf.series").read_text())["files"]
            there = sorted(path.name for path in (self.folder / "out/subsets").glob(f"{name}_*.hdf"))
            self.assertEqual([file["name"] for file in listed], there)
            return [file["time"] for file in listed]

        with_floor = BURST.replace("steps = 220", "").replace('"1 ms"', '"0.2 ms"')
        parts = re.split(r"(?=\[\[output\.subset\]\]|\[checkpoint\])", with_floor)
        head, floor, near, rest = parts
        self.deck(head + floor + rest)
        self.brisance("--output", "out", "--quiet")
        former = series("floor")
        self.assertEqual(former[-1], 0.2e-3)
        later = rest.replace('"0.2 ms"', '"0.3 ms"')
        self.deck(head + near + later)
        self.brisance("--output", "out", "--resume", "--quiet")
        self.assertEqual(series("floor"), former)
        fresh = series("near")
        self.assertEqual(len(fresh), 3)
        for moment, expected in zip(fresh, (0.24e-3, 0.28e-3, 0.3e-3)):
            self.assertAlmostEqual(moment, expected, delta=1e-12)

    def test_only_the_last_dump_holds_peaks_also_when_the_end_is_moved(self):
        def with_peaks(name):
            return [n for n, dump in enumerate(sorted((self.folder / name / "fields").iterdir()))
                    if b"peak_overpressure" in dump.read_bytes()]

        self.deck(self.SMALL)
        self.brisance("--output", "whole", "--quiet")
        self.assertEqual(with_peaks("whole"), [6])
        self.deck(self.SMALL.replace('"0.5 ms"', '"0.4 ms"').replace("steps = 10", "at_end = true"))
        self.brisance("--output", "moved", "--quiet")
        self.assertEqual(with_peaks("moved"), [5])
        self.deck(self.SMALL)
        self.brisance("--output", "moved", "--resume", "--quiet")
        self.assertEqual(with_peaks("moved"), [6])
        self.assert_same(self.contents("whole"), "moved")

    def test_another_deck_is_refused(self):
        self.stopped()
        changes = (('"1 kg"', '"2 kg"', "charge"),
                   ("block_cells = 64", "block_cells = 32", "numerics.block_cells"),
                   ('precision = "double"', "peak_fields = false", "output.peak_fields"))
        for old, new, key in changes:
            self.deck(self.SMALL.replace(old, new))
            done = self.brisance("--output", "cut", "--resume", code=2)
            self.assertIn(f"--resume: {key} of ", done.stderr)
            self.assertIn("only [end], [output]", done.stderr)
        # What does not touch the state may change.
        self.deck("# a remark\n" + self.SMALL.replace("steps = 10", "steps = 7"))
        self.brisance("--output", "cut", "--resume", "--quiet")

    def test_force_and_resume_contradict_each_other(self):
        self.deck(self.SMALL)
        self.assertIn("--force", self.brisance("--force", "--resume", code=2).stderr)

    def test_what_is_asked_for_is_kept(self):
        self.deck(self.SMALL.replace("steps = 10", "steps = 10\nkeep = 3\nat_end = false"))
        self.brisance("--output", "out", "--quiet")
        steps = [int(re.search(r"_(\d+)\.brz", path.name).group(1)) for path in self.checkpoints("out")]
        last = json.loads((self.folder / "out/run.json").read_text())["step"] // 10 * 10
        self.assertEqual(steps, [last - 20, last - 10, last])
        # --force takes them away with the other results.
        self.deck(self.SMALL.replace("steps = 10", "steps = 0\nwall_clock = 0\nat_end = false"))
        self.brisance("--output", "out", "--quiet", "--force")
        self.assertEqual(self.checkpoints("out"), [])

    def test_threads_may_change(self):
        whole = self.stopped()
        self.checkpoints("cut")[-1].unlink()
        done = subprocess.run([PROGRAM, "run", "case.toml", "--threads", "2", "--output", "cut", "--resume", "--quiet"],
                              cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        found = self.contents("cut")
        for log in (found, whole):
            log["run.json"] = {k: v for k, v in json.loads(log["run.json"]).items() if k != "machine"}
        self.assertEqual(found, whole)


if __name__ == "__main__":
    unittest.main()
