"""What the validations share: running a deck in variants, tables, and the look of the figures."""
import json
import os
import platform
import re
import subprocess
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import h5py  # noqa: E402
import numpy as np  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent
INK, MUTED, GRID = "#1d2733", "#66727f", "#e3e8ed"
COLOURS = ("#b5d3ec", "#7db3de", "#3f84c2", "#1f4f88")  # coarse to fine
ORANGE = "#c8641b"
RC = {"font.family": "DejaVu Sans", "font.size": 8.5, "text.color": INK, "axes.labelcolor": INK,
      "legend.frameon": False, "axes.titlesize": 9.5, "axes.titleweight": "bold", "axes.titlelocation": "left"}


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def per_cent(ratio, digits=1):
    return f"{100.0 * (ratio - 1.0):+.{digits}f} %"


def style(axes):
    axes.grid(True, which="major", color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color("#9aa5b1")
    axes.tick_params(colors=MUTED, which="both")


def processor():
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def machine():
    return f"{processor()}, {os.cpu_count()} cores"


def commit():
    def git(*arguments):
        return subprocess.run(["git", "-C", str(ROOT), *arguments], capture_output=True, text=True).stdout.strip()
    changed = git("status", "--porcelain", "--", "src", "materials", "cases", "CMakeLists.txt", "cmake")
    return git("rev-parse", "--short", "HEAD") + (" with uncommitted changes" if changed else "")


def literal(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:g}" if isinstance(value, (int, float)) else f'"{value}"'


def varied(text, changes):
    """A deck's text with the value of some keys replaced. A change is `key` (all lines of that key) or `section.key`
    (in the first table of that name, where a missing key is added). None takes the key's lines away."""
    for name, value in changes.items():
        section, _, key = name.rpartition(".")
        if value is None:
            text = re.sub(rf"^{key} = .*\n", "", text, flags=re.MULTILINE)
            continue
        line = f"{key} = {value[1:] if str(value).startswith('=') else literal(value)}"
        if not section:
            text, count = re.subn(rf"^{key} = .*$", line, text, flags=re.MULTILINE)
            if count == 0:
                sys.exit(f"no line `{key} = ...` in the deck")
            continue
        head, found, rest = re.split(rf"(^\[+{section}\]+[^\n]*\n)", text, maxsplit=1, flags=re.MULTILINE)
        end = re.search(r"^\[", rest, flags=re.MULTILINE)
        body, rest = (rest[:end.start()], rest[end.start():]) if end else (rest, "")
        body, count = re.subn(rf"^{key} = .*$", line, body, flags=re.MULTILINE)
        text = head + found + ("" if count else line + "\n") + body + rest
    return text


class Variants:
    """Runs a case in variants. Results of the same deck by the same program are taken again where `reuse` is set."""

    def __init__(self, arguments, work):
        self.program, self.threads, self.reuse = arguments.brisance, arguments.threads, arguments.reuse
        self.work = work
        self.seconds = 0.0

    def __call__(self, case, name, changes=None, added="", may_fail=False, text=None):
        """Returns the results, or None where the run failed and may. `text` stands for the case's deck."""
        text = varied(text or (ROOT / "cases" / case / "deck.toml").read_text(), changes or {}) + added
        folder = self.work / f"{case}-{name}"
        done = (folder / "run.json").exists() and (folder / "deck.toml").exists()
        if not (self.reuse and done and (folder / "deck.toml").read_text() == text):
            deck = self.work / f"{case}-{name}.toml"
            deck.write_text(text)
            print(f"{case}, {name} ...", flush=True)
            command = [self.program, "run", deck, "--output", folder, "--force", "--no-progress", "--threads",
                       str(self.threads)]
            finished = subprocess.run([str(c) for c in command], stdout=subprocess.DEVNULL,
                                      stderr=subprocess.DEVNULL if may_fail else None)
            if finished.returncode != 0 and not may_fail:
                sys.exit(f"{case}, {name}: failed with exit code {finished.returncode}")
        if not (folder / "run.json").exists():
            sys.exit(f"{case}, {name}: no results; see `brisance check {self.work / f'{case}-{name}.toml'}`")
        result = Result(folder)
        if result.log["status"] != "done":
            if may_fail:
                return None
            sys.exit(f"{folder}: the run is not done but {result.log['status']}")
        self.seconds += result.log["wall_seconds"]
        return result


class Result:
    """The output folder of a run of material points."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.log = json.loads((self.folder / "run.json").read_text())
        self.bodies = self.log.get("points", {}).get("bodies", [])
        self.h = self.log["domain"]["cell_size"]

    def csv(self, name):
        """Columns of a CSV file by their headers without the units."""
        path = self.folder / name
        header = [h.split(" [")[0].strip('"') for h in path.read_text().split("\n", 1)[0].split(",")]
        values = np.atleast_2d(np.genfromtxt(path, delimiter=",", skip_header=1))
        return {h: values[:, k] for k, h in enumerate(header)}

    def gauge(self, name):
        return self.csv(f"gauges/{name}.csv")

    def dumps(self):
        return sorted(self.folder.glob("points/points_*.h5"))

    @staticmethod
    def dump(path):
        with h5py.File(path, "r") as file:
            return {name: file["points"][name][...].astype(float) for name in file["points"]} | {
                "time": float(file.attrs["time"])}

    def energies(self):
        """Time, and the kinetic and internal energies of all bodies together."""
        columns = self.csv("energies.csv")

        def total(kind):
            return sum(v for k, v in columns.items() if k.endswith(kind))
        return columns["time"], total("kinetic_energy"), total("internal_energy")
