"""Shared by the validations: running a deck in variants, tables, and the style of the figures."""
import ctypes
import hashlib
import json
import os
import platform
import re
import shutil
import resource
import signal
import subprocess
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "python"))
from brisance.results import Run, nearest  # noqa: E402, F401

FAILURE = 4  # exit code of a numerical failure
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


def span(values, form="{:g}"):
    """From the smallest to the largest of some numbers: "2 to 3", or "2" where all print alike."""
    low, high = form.format(min(values)), form.format(max(values))
    return low if low == high else f"{low} to {high}"


def listed(words):
    """Words joined as in a sentence: "a, b and c"; "none" for an empty list."""
    words = list(words)
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words) or "none"


class Curves:
    """Kingery and Bulmash's values for a mass of TNT [kg], from the program."""

    def __init__(self, program, mass=1):
        self.program, self.mass, self.known = str(program), mass, {}

    def __call__(self, burst, distance, key):
        if (burst, distance) not in self.known:
            command = [self.program, "kb", "--charge", f"{self.mass:g}", "--distance", f"{distance:.9g}", "--burst",
                       burst, "--json"]
            answer = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
            self.known[burst, distance] = answer["quantities"]
        return self.known[burst, distance][key]["value"]


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
    (in the first table of that name, to which a missing key is added; a missing table is added at the end). None
    removes the key's lines."""
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
        if not re.search(rf"^\[+{section}\]+", text, flags=re.MULTILINE):
            text = f"{text.rstrip()}\n\n[{section}]\n"
        head, found, rest = re.split(rf"(^\[+{section}\]+[^\n]*\n)", text, maxsplit=1, flags=re.MULTILINE)
        end = re.search(r"^\[", rest, flags=re.MULTILINE)
        body, rest = (rest[:end.start()], rest[end.start():]) if end else (rest, "")
        body, count = re.subn(rf"^{key} = .*$", line, body, flags=re.MULTILINE)
        text = head + found + ("" if count else line + "\n") + body + rest
    return text


def build_of(program):
    """A hash that identifies the build of the program."""
    return hashlib.sha256(Path(program).read_bytes()).hexdigest()


def end_with_parent():
    """In a process about to start: sends it a Ctrl-C when its parent ends, for whatever reason. On Linux only."""
    prctl = getattr(ctypes.CDLL(None), "prctl", None)
    if prctl is not None:
        prctl(1, signal.SIGINT)  # PR_SET_PDEATHSIG


def call(command):
    """Runs the program and returns its exit code and its processor time [s]. Ctrl-C and SIGTERM are passed on as one
    Ctrl-C, upon which the program writes a checkpoint; then this process ends too."""
    asked = []
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    # A process group of its own: otherwise a Ctrl-C of the terminal would reach it twice and end it at once.
    process = subprocess.Popen([str(c) for c in command], stdout=subprocess.DEVNULL, process_group=0,
                               preexec_fn=end_with_parent)

    def pass_on(number, _):
        asked.append(number)
        process.send_signal(signal.SIGINT)
    before = {number: signal.signal(number, pass_on) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        code = process.wait()
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    if asked:
        print("stopped; the same command with the same work folder continues from here", file=sys.stderr)
        raise Stopped(3)
    now = resource.getrusage(resource.RUSAGE_CHILDREN)
    return code, now.ru_utime + now.ru_stime - spent.ru_utime - spent.ru_stime


class Stopped(SystemExit):
    """The user stopped the run."""


class Variants:
    """Runs a case's deck in variants, in the folder `work`.

    Finished results of the same deck by the same build of the program are reused, with `reuse` those of any build; an
    interrupted run continues from its newest checkpoint. `costs` has a row per run: name, cells, points, steps, threads
    and wall time [s], over all restarts. Compare `seconds` of results where the machine is not idle.
    """

    def __init__(self, arguments, work):
        self.program, self.threads, self.reuse = arguments.brisance, arguments.threads, arguments.reuse
        self.work = Path(work)
        self.build = build_of(self.program)
        self.seconds = 0.0
        self.costs = []
        self.number, self.expected = 0, 0

    def expect(self, number):
        """Sets the number of runs that follow, for the progress."""
        self.number, self.expected = 0, number

    def __call__(self, case, name, changes=None, added="", may_fail=False, text=None):
        """Returns the results, or None if the run failed and `may_fail`. `text` replaces the case's deck."""
        text = varied(text or (ROOT / "cases" / case / "deck.toml").read_text(), changes or {}) + added
        folder = self.work / f"{case}-{name}"
        self.number += 1
        of = f" of {self.expected}" if self.expected >= self.number else ""
        print(f"[run {self.number}{of}] {case}, {name}: ", end="", flush=True)
        state = self.state(folder, text)
        if state == "finished":
            print("reused", flush=True)
        else:
            print("continues from its checkpoint ..." if state == "resumable" else "...", flush=True)
            self.calculate(case, name, text, state == "resumable", may_fail)
        if not (folder / "run.json").exists():
            sys.exit(f"{case}, {name}: no results; see `brisance check {self.work / f'{case}-{name}.toml'}`")
        result = Result(folder, self.note(folder).get("processor_seconds"))
        if result.log["status"] != "done":
            if may_fail:
                return None
            sys.exit(f"{folder}: the run is not done; its status is {result.log['status']}")
        self.seconds += result.log["wall_seconds"]
        self.costs.append((f"{case}, {name}", result.log["domain"]["cell_count"],
                           result.log.get("points", {}).get("count", 0), result.log["step"],
                           result.log["machine"]["threads"], round(result.log["wall_seconds"], 3)))
        return result

    def state(self, folder, text):
        """State of the run of this deck by this program in a folder: "finished", "resumable" or "nothing"."""
        try:
            same = (folder / "deck.toml").read_text() == text
            build = self.build if self.reuse else self.note(folder)["build"]
            log = json.loads((folder / "run.json").read_text())
        except (OSError, ValueError, KeyError):
            return "nothing"
        if not same or build != self.build:
            return "nothing"
        if log["status"] == "done" or log["exit_code"] == FAILURE:
            return "finished"
        return "resumable" if list(folder.glob("checkpoints/checkpoint_*.brz")) else "nothing"

    @staticmethod
    def note(folder, **contents):
        """The note beside the folder of a run; with `contents`, writes it."""
        path = folder.with_name(folder.name + ".note.json")
        if contents:
            path.write_text(json.dumps(contents))
        return json.loads(path.read_text()) if path.exists() else {}

    def calculate(self, case, name, text, resume, may_fail):
        folder, deck = self.work / f"{case}-{name}", self.work / f"{case}-{name}.toml"
        deck.write_text(text)
        self.note(folder, build=self.build)
        if not resume and (folder / "run.json").exists() and not (folder / "files.txt").exists():
            shutil.rmtree(folder)  # of a version without files.txt, which --force refuses
        command = [self.program, "run", deck, "--output", folder, "--threads", str(self.threads)]
        command += [] if sys.stderr.isatty() else ["--no-progress"]
        code, seconds = call([*command, "--resume" if resume else "--force"])
        if resume and code not in (0, FAILURE):
            print("  its checkpoints cannot be used; starting again ...", flush=True)
            resume = False
            code, seconds = call([*command, "--force"])
        if not resume:
            self.note(folder, build=self.build, processor_seconds=seconds)
        if code != 0 and not may_fail:
            sys.exit(f"{case}, {name}: failed with exit code {code}")


class Result(Run):
    """The output folder of a variant, and its cost."""

    def __init__(self, folder, processor_seconds=None):
        super().__init__(folder)
        self.processor_seconds = processor_seconds

    @property
    def seconds(self):
        """Processor time [s], which other programs on the machine hardly affect; wall time where it is not known."""
        return self.processor_seconds or self.log["wall_seconds"]
