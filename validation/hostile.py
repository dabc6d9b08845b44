"""Runs the decks of tests/hostile: each must be refused with place and remedy, give the right result, or end with a
true message. What a deck expects is in the comments at its head, one `# key: value` per line:

  hostile: what it tries (needed)
  exit: 2              allowed exit codes, one or several
  says: words          what the terminal must show; may be repeated
  silent: words        what it must not show
  balanced: true       what the audit must say; without it, true after exit 0
  value: summary.gauges.0.peak_overpressure 1.2e5 0.05
                       a number of summary.json or run.json, within this relative tolerance (absolute if 0 is right)
  range: PATH LOW HIGH a number between two bounds
  equals: other.toml   the gauges' files of this deck are those of the other one, to the byte
  command: check       instead of run
  append_hex: 00 ff    bytes that the runner puts at the end of the deck
  pad: 1100000         bytes of comment that the runner puts at the end
  quick: true          part of the quick subset (--quick), which ctest runs
"""
import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DECKS = ROOT / "tests" / "hostile"
LIMIT = 30  # of one run [s]
CODES = (0, 2, 3, 4, 5)
KEYS = ("hostile", "exit", "says", "silent", "balanced", "value", "range", "equals", "command", "append_hex", "pad",
        "quick")


class Wrong(Exception):
    """The fault of a case."""


def expectations(path):
    """The `# key: value` lines at the head of a deck."""
    found = {}
    for line in path.read_bytes().decode("utf-8", "replace").splitlines():
        match = re.match(r"# ([a-z_]+): (.+)$", line)
        if not match:
            break
        if match[1] not in KEYS:
            raise Wrong(f"the runner does not know the line {line!r}")
        found.setdefault(match[1], []).append(match[2].strip())
    for key in ("hostile", "exit"):
        if key not in found:
            raise Wrong(f"its head has no line `# {key}: ...`")
    return found


def place(path, wanted, folder):
    """Copies the deck to the folder where it runs, with the runner's additions."""
    folder.mkdir(parents=True, exist_ok=True)
    deck = folder / path.name
    text = path.read_bytes()
    for digits in wanted.get("append_hex", []):
        text += bytes.fromhex(digits)
    for length in wanted.get("pad", []):
        text += b"\n#" + b"x" * int(length) + b"\n"
    deck.write_bytes(text)
    return deck


def execute(program, deck, command):
    """Runs one deck; returns its exit code, its output and the folder of its results."""
    results = deck.parent / deck.stem
    shutil.rmtree(results, ignore_errors=True)
    arguments = [str(program), command, deck.name]
    if command == "run":
        arguments += ["--output", results.name, "--threads", "1", "--no-progress"]
    try:
        done = subprocess.run(arguments, cwd=deck.parent, stdin=subprocess.DEVNULL, capture_output=True,
                              timeout=LIMIT, check=False)
    except subprocess.TimeoutExpired as late:
        raise Wrong(f"not done after {LIMIT} s") from late
    return done.returncode, (done.stdout + done.stderr).decode("utf-8", "replace"), results


def number(results, path):
    """A number of a JSON file of the results: `summary.gauges.0.peak_overpressure`."""
    name, *keys = path.split(".")
    value = json.loads((results / f"{name}.json").read_text(encoding="utf-8"))
    for key in keys:
        value = value[int(key)] if isinstance(value, list) else value[key]
    if value is None:
        raise Wrong(f"{path} has no value")
    return value


def judge_refusal(name, text):
    """A refusal must name the place, by line or key, and say what to do."""
    errors = [line for line in text.splitlines() if "error:" in line and not re.search(r": \d+ errors?$", line)]
    if not errors:
        raise Wrong("refused without an error line")
    for line in errors:
        if not re.search(rf"{re.escape(name)}(:\d+)?|\[\[?[a-z_]+|`", line):
            raise Wrong(f"this error names no place: {line}")
        if len(line.split("error", 1)[1].split()) < 6:
            raise Wrong(f"this error has no remedy: {line}")


def judge_values(wanted, results):
    """Checks the numbers that the deck expects."""
    for line in wanted.get("value", []):
        path, right, tolerance = line.split()
        got, right, tolerance = number(results, path), float(right), float(tolerance)
        if not abs(got - right) <= tolerance * (abs(right) or 1):
            raise Wrong(f"{path} is {got:.6g}, correct is {right:.6g}")
    for line in wanted.get("range", []):
        path, low, high = line.split()
        got = number(results, path)
        if not float(low) <= got <= float(high):
            raise Wrong(f"{path} is {got:.6g}, not between {low} and {high}")


def judge_run(wanted, code, text, results):
    """Terminal, run.json and the deck's expectation must agree."""
    record = results / "run.json"
    if not record.exists():
        if code == 0:
            raise Wrong("exit 0 without run.json")
        return "no results"
    told = json.loads(record.read_text(encoding="utf-8"))
    if told.get("exit_code") != code:
        raise Wrong(f"exit {code}, but run.json says {told.get('exit_code')}")
    balanced = told["audit"]["balanced"]
    if code == 0:
        if balanced == ("NOT BALANCED" in text):
            raise Wrong("terminal and run.json disagree about the audit")
        if re.search(r"[\[,:\s]-?(nan|inf)\b", text, re.IGNORECASE):
            raise Wrong("the terminal shows nan or inf after exit 0")
    expected = wanted.get("balanced", ["true"] if code == 0 else [None])[0]
    if expected is not None and balanced != (expected == "true"):
        raise Wrong(f"audit balanced: {str(balanced).lower()}, expected {expected}")
    if code == 0:
        try:
            judge_values(wanted, results)
        except Wrong as wrong:
            raise Wrong(f"{'balanced beside a wrong value: ' if balanced else ''}{wrong}") from wrong
    return "balanced" if balanced else "NOT BALANCED"


def judge_twin(program, path, other, results):
    """The gauge files of two decks must be the same."""
    wanted = expectations(DECKS / other)
    code, _, twin = execute(program, place(DECKS / other, wanted, results.parent / f"{path.stem}-twin"), "run")
    if code != 0:
        raise Wrong(f"{other} ends with exit {code}")
    files = sorted(file.name for file in (twin / "gauges").iterdir())
    if not files:
        raise Wrong(f"{other} has no gauges to compare")
    for file in files:
        if (twin / "gauges" / file).read_bytes() != (results / "gauges" / file).read_bytes():
            raise Wrong(f"gauges/{file} differs from that of {other}")


def judge(program, path, work):
    """Runs one case; returns how it ended, or raises Wrong."""
    wanted = expectations(path)
    command = wanted.get("command", ["run"])[0]
    code, text, results = execute(program, place(path, wanted, work), command)
    if code not in CODES:
        raise Wrong(f"crashed, exit {code}: {text.strip()[-200:]}")
    allowed = [int(word) for word in re.findall(r"\d+", wanted["exit"][0])]
    if code not in allowed:
        raise Wrong(f"exit {code}, expected {wanted['exit'][0]}: {text.strip()[-300:]}")
    flat = " ".join(text.split())
    for words in wanted.get("says", []):
        if words not in flat:
            raise Wrong(f"does not say {words!r}: {flat[-300:]}")
    for words in wanted.get("silent", []):
        if words in flat:
            raise Wrong(f"says {words!r}")
    if "\x1b" in text:
        raise Wrong("an escape sequence reaches the terminal")
    outcome = ""
    if code == 2:
        judge_refusal(path.name, text)
        if (results / "run.json").exists():
            raise Wrong("refused, but it left results")
    elif command == "run":
        outcome = judge_run(wanted, code, text, results)
        if code == 4 and not re.search(r"numerical failure at t = .*step \d+", flat):
            raise Wrong("exit 4 without time, step and reason")
    for other in wanted.get("equals", []):
        judge_twin(program, path, other, results)
    return f"exit {code}{', ' + outcome if outcome else ''}"


def run_one(program, path, work):
    """One case: its name, whether it passed, and a line about it."""
    try:
        how, passed = judge(program, path, work), True
    except Wrong as wrong:
        how, passed = str(wrong), False
    except (KeyError, IndexError, TypeError, ValueError, OSError) as trouble:
        how, passed = f"its results cannot be read: {trouble!r}", False
    line = f"{'pass' if passed else 'FAIL'}  {path.stem:34} {' '.join(how.split())}"
    print(line, flush=True)
    return path.stem, passed, line


def run_all(program, work, quick=False):
    """All cases, two at a time; a list of (name, passed, line)."""
    program, work = Path(program).resolve(), Path(work).resolve()
    work.mkdir(parents=True, exist_ok=True)
    paths = sorted(DECKS.glob("*.toml"))
    if quick:
        paths = [path for path in paths if "\n# quick: true" in path.read_bytes().decode("utf-8", "replace")]
    with ThreadPoolExecutor(2) as pool:
        return list(pool.map(lambda path: run_one(program, path, work), paths))


def main():
    parser = argparse.ArgumentParser(description="Run the hostile decks of tests/hostile.")
    parser.add_argument("--brisance", default=ROOT / "build" / "release" / "bin" / "brisance", help="the program")
    parser.add_argument("--work", help="folder for the runs (default: a temporary folder)")
    parser.add_argument("--quick", action="store_true", help="only the decks marked quick")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        cases = run_all(given.brisance, given.work or scratch, given.quick)
    failed = sum(not passed for _, passed, _ in cases)
    print(f"{len(cases)} hostile decks, {failed} failed")
    return 1 if failed or not cases else 0


if __name__ == "__main__":
    sys.exit(main())
