"""The machinery of validation/run: runs that are taken again or go on, and the report of the paper's examples.

Usage: BRISANCE=path/to/brisance python3 test_validation.py [CLASS...]
"""
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from types import SimpleNamespace

SKIPPED = 77  # exit status that ctest takes as "skipped"
ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ["BRISANCE"]
sys.path.insert(0, str(ROOT / "validation"))

try:
    import common
    import paper
except ImportError as missing:
    print(f"skipped: the Python package {missing.name} is not installed")
    sys.exit(SKIPPED)

SHORT = """
[domain]
geometry = "spherical1d"
size = 1
cell = "5 mm"
[[charge]]
mass = "1 kg"
[end]
time = "0.1 ms"
"""
# Some ten seconds: a signal comes before the end.
LONG = SHORT.replace('"5 mm"', '"0.5 mm"').replace('"0.1 ms"', '"20 ms"')
ONE_VARIANT = """
import sys
sys.path.insert(0, sys.argv[1])
from types import SimpleNamespace
from common import Variants
run = Variants(SimpleNamespace(brisance=sys.argv[2], threads=1, reuse=False), sys.argv[3])
print("steps", run("case", "one", text=open(sys.argv[4]).read()).log["step"])
"""


class Scratch(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = Path(folder.name)

    def variants(self, **changes):
        arguments = {"brisance": PROGRAM, "threads": 1, "reuse": False} | changes
        return common.Variants(SimpleNamespace(**arguments), self.work)


class Reuse(Scratch):
    def test_same_deck_is_taken_again_and_another_is_not(self):
        first = self.variants()("case", "one", text=SHORT)
        written = (first.folder / "run.json").stat().st_mtime_ns
        again = self.variants()
        again("case", "one", text=SHORT)
        self.assertEqual((first.folder / "run.json").stat().st_mtime_ns, written)
        wall = round(first.log["wall_seconds"], 3)
        self.assertEqual(again.costs, [("case, one", 200, 0, first.log["step"], 1, wall)])
        self.assertGreater(first.processor_seconds, 0.0)
        other = self.variants()("case", "one", text=SHORT.replace("0.1 ms", "0.2 ms"))
        self.assertGreater(other.log["step"], first.log["step"])

    def test_another_build_calculates_anew_unless_told_not_to(self):
        first = self.variants()("case", "one", text=SHORT)
        (self.work / "case-one.note.json").write_text('{"build": "another"}')
        written = (first.folder / "run.json").stat().st_mtime_ns
        self.variants(reuse=True)("case", "one", text=SHORT)
        self.assertEqual((first.folder / "run.json").stat().st_mtime_ns, written)
        self.variants()("case", "one", text=SHORT)
        self.assertNotEqual((first.folder / "run.json").stat().st_mtime_ns, written)

    def test_failure(self):
        with self.assertRaises(SystemExit):
            self.variants()("case", "one", text=SHORT.replace("0.1 ms", "-1 s"))


class Interrupted(Scratch):
    def command(self, deck):
        return [sys.executable, "-c", ONE_VARIANT, str(ROOT / "validation"), PROGRAM, str(self.work), str(deck)]

    def test_stopped_run_goes_on(self):
        deck = self.work / "given.toml"
        deck.write_text(LONG)
        for number in (signal.SIGINT, signal.SIGTERM):
            process = subprocess.Popen(self.command(deck), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            log = self.work / "case-one" / "run.json"
            steps = json.loads(log.read_text())["step"] if log.exists() else 0
            before = log.stat().st_mtime_ns if log.exists() else 0
            while process.poll() is None and (not log.exists() or log.stat().st_mtime_ns == before):
                time.sleep(0.01)
            time.sleep(0.3)
            process.send_signal(number)
            out, err = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 3, out + err)
            self.assertIn("continues from here", err)
            self.assertGreater(json.loads(log.read_text())["step"], steps)
        self.assertIn("continues from its checkpoint", out)
        self.finish(deck, log, 2)

    def finish(self, deck, log, stops):
        """The rest is not waited for: the deck gets an earlier end, which `--resume` allows."""
        text = LONG.replace('"20 ms"', f'{json.loads(log.read_text())["time"] * 1.05}')
        (self.work / "case-one" / "deck.toml").write_text(text)
        deck.write_text(text)
        done = subprocess.run(self.command(deck), capture_output=True, text=True)
        self.assertIn("continues from its checkpoint", done.stdout)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(json.loads(log.read_text())["resumed_at_steps"]), stops)

    def test_killed_script_takes_its_run_along(self):
        deck = self.work / "given.toml"
        deck.write_text(LONG)
        log = self.work / "case-one" / "run.json"
        with subprocess.Popen(self.command(deck), stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            while not log.exists():
                time.sleep(0.01)
            time.sleep(0.3)
            process.kill()
        for _ in range(200):
            if json.loads(log.read_text())["status"] == "stopped":
                break
            time.sleep(0.05)
        self.assertEqual(json.loads(log.read_text())["status"], "stopped")
        self.finish(deck, log, 1)


class Paper(Scratch):
    def section(self, name, resolution="standard", **changes):
        folder = self.work / "sections" / name
        folder.mkdir(parents=True)
        (folder / "one.png").write_bytes(b"a figure")
        section = {"title": "Two <& three",
                   "acceptance": [("what & why", "3 %", "< 4 %", True), ("other", "5", "4", False)],
                   "blocks": [("text", "<p>It <b>is</b>.</p>"), ("table", "caption <1>", ["a", "b"], [["1 < 2", "x"]]),
                              ("figure", "one.png", "a figure")],
                   "costs": [("a run", 1000, 0, 7, 2, 12.5)],
                   "made": {"resolution": resolution, "commit": "abc", "machine": "m", "build": "b", "date": "d",
                            "command": "c"}} | changes
        (folder / "section.json").write_text(json.dumps(section))

    def page(self, resolution="standard"):
        return paper.compose(self.work, self.work / "report", resolution).read_text(encoding="utf-8")

    def test_fabricated_section(self):
        self.section("plates")
        page = self.page()
        self.assertIn("Two &lt;&amp; three", page)
        self.assertIn("<b>is</b>", page)
        self.assertIn("1 &lt; 2", page)
        self.assertIn("1 <small>of 2</small>", page)
        self.assertEqual(page.count(">missed</span>"), 2)
        self.assertEqual(page.count(">not run</span>"), 4)
        self.assertEqual(page.count("Not run at this resolution"), 4)
        self.assertIn("12.5", page)
        for figure in re.findall(r'<img src="([^"]+)"', page):
            self.assertTrue((self.work / "report" / figure).exists(), figure)
        self.assertEqual(re.findall(r'(?:src|href)="(?:https?:)?//', page), [])

    def test_sections_of_other_resolutions_and_failed_ones(self):
        self.section("sod", resolution="quick")
        self.section("slab2d", failed="run 3 failed", acceptance=[])
        page = self.page()
        self.assertEqual(page.count("Not run at this resolution"), 4)
        self.assertIn("Failed: run 3 failed", page)
        self.assertIn(">failed</span>", page)

    def test_section_stays_when_the_work_folder_is_gone(self):
        self.section("plates")
        self.page()
        (self.work / "sections").rename(self.work / "elsewhere")
        self.assertEqual(self.page().count("Not run at this resolution"), 4)

    def test_modules(self):
        for name in paper.EXAMPLES:
            if paper.present(name):
                module = __import__(f"paper.{name}", fromlist=[name])
                self.assertTrue(module.TITLE and callable(module.run))

    def test_quick_shock_tube(self):
        done = subprocess.run([sys.executable, ROOT / "validation" / "run", "paper", "--example", "sod", "--quick",
                               "--work", self.work, "--brisance", PROGRAM], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        section = json.loads((self.work / "sections" / "sod" / "section.json").read_text())
        self.assertGreaterEqual(len(section["acceptance"]), 5)
        errors = [line for line in section["acceptance"] if line[0].startswith("Error of the pressure")]
        self.assertEqual([line[3] for line in errors], [True] * 4, errors)
        page = (self.work / "report" / "index.html").read_text(encoding="utf-8")
        figures = re.findall(r'<img src="([^"]+)"', page)
        self.assertEqual(len(figures), 2)
        for figure in figures:
            self.assertTrue((self.work / "report" / figure).read_bytes().startswith(b"\x89PNG"))


if __name__ == "__main__":
    unittest.main()
