"""What tests of reports share: made-up output folders, and the pages drawn from them."""
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from brisance import report

SCRIPT = Path(report.__file__)


class Folders(unittest.TestCase):
    """One output folder of every kind that `synthetic` (a module with KINDS and write) can make up."""

    synthetic = None

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.root = Path(cls.scratch.name)
        for kind in cls.synthetic.KINDS if cls.synthetic else ():
            cls.synthetic.write(cls.root / kind, kind, dumps=3)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def page(self, kind):
        done = subprocess.run([sys.executable, SCRIPT, self.root / kind], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr, "")
        return (self.root / kind / "report.html").read_text(encoding="utf-8")

    def titles(self, page):
        return re.findall(r'<h2><span class="number">\d+</span>(.*?)</h2>', page)
