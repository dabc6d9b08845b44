"""Cells of several sizes: blasts on blocks that follow the shocks against uniform cells, and what both cost."""
import os
import subprocess
import sys
from common import ROOT, Result, commit, machine, per_cent, table, varied

# Size of today's cells [m], and by how much the coarsest cells of the adaptive run are larger than the finest of half.
CASES = {"street_3d": (0.25, 4), "hemisphere_3d": (0.032, 4)}
PAIRS = 3  # of runs with half cells, in turn


class Run:
    """A run of the program, with its time [s] and memory [MB]."""

    def __init__(self, arguments, work, name, text):
        folder, deck = work / f"levels-{name}", work / f"levels-{name}.toml"
        deck.write_text(text)
        command = [arguments.brisance, "run", deck, "--output", folder, "--threads", arguments.threads, "--force",
                   "--no-progress"]
        print(f"{name} ...", flush=True)
        process = subprocess.Popen([str(c) for c in command], stdout=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        if os.waitstatus_to_exitcode(status) != 0:
            sys.exit(f"{name}: failed with exit code {os.waitstatus_to_exitcode(status)}; see {folder}")
        self.result = Result(folder)
        self.memory = used.ru_maxrss / 1024.0
        self.seconds = self.result.log["wall_seconds"]
        timings = self.result.log["timings"]
        self.regrid = timings.get("regrid", 0.0) / self.seconds
        self.gauges = {g["name"]: g for g in self.result.summary["gauges"]}


def deck(case, cell, coarsest=None):
    """The deck of a case with cells of a size, or with a coarsest and that finest size."""
    text = varied((ROOT / "cases" / case / "deck.toml").read_text(), {"field_interval": None})
    text = varied(text, {"domain.cell": f"{1000 * (coarsest or cell):g} mm"})
    return text if coarsest is None else f'{text}\n[adaptive]\nfinest = "{1000 * cell:g} mm"\n'


def differences(one, other):
    """Largest differences of two runs at their gauges: peak, impulse, arrival; and the gauge of the largest peak's."""
    keys = ("peak_overpressure", "largest_impulse", "arrival_time")
    rows = []
    for name, gauge in one.gauges.items():
        seen = other.gauges[name]
        rows.append((name, *(seen[key] / gauge[key] - 1.0 if gauge.get(key) else float("nan") for key in keys)))
    return rows


def median(values):
    return sorted(values)[len(values) // 2]


def compare(arguments, work, case, pairs):
    cell, ratio = CASES[case]
    half = cell / 2.0
    uniform, adaptive = [], []
    for n in range(pairs):
        uniform.append(Run(arguments, work, f"{case}-half-uniform-{n}", deck(case, half)))
        adaptive.append(Run(arguments, work, f"{case}-half-levels-{n}", deck(case, half, ratio * half)))
    gain = median([u.seconds / a.seconds for u, a in zip(uniform, adaptive)])
    gauges = table(("gauge", "peak", "impulse", "arrival"),
                   [(name, *(per_cent(1.0 + x, 2) for x in rest)) for name, *rest in
                    differences(uniform[0], adaptive[0])])
    costs = table(("cells", "time [s]", "memory [MB]", "regrid"),
                  [(f"{1000 * half:g} mm everywhere", f"{median([u.seconds for u in uniform]):.1f}",
                    f"{uniform[0].memory:.0f}", "-"),
                   (f"{1000 * ratio * half:g} to {1000 * half:g} mm", f"{median([a.seconds for a in adaptive]):.1f}",
                    f"{adaptive[0].memory:.0f}", f"{100 * adaptive[0].regrid:.1f} %")])
    coarsest, finest = f"{1000 * ratio * half:g} mm", f"{1000 * half:g} mm"
    memory = adaptive[0].memory / uniform[0].memory
    return f"""## {case}

Coarsest cells of {coarsest}, finest of {finest}, half of the case's own, against cells of {finest} everywhere:
{gain:.2f} times as fast (median of {pairs} pairs in turn), {memory:.2f} of the memory.

{costs}
Differences at the gauges:

{gauges}"""


def validate(arguments, work):
    """Writes docs/validation/levels.md."""
    pairs = 1 if arguments.quick else PAIRS
    parts = [compare(arguments, work, case, pairs) for case in CASES]
    text = f"""# Cells of several sizes

Produced by `validation/run levels --threads {arguments.threads}`, commit {arguments.commit or commit()}; machine:
{machine()}.

""" + "\n".join(parts)
    target = work if arguments.quick else ROOT / "docs" / "validation"
    target.mkdir(parents=True, exist_ok=True)
    (target / "levels.md").write_text(text)
    print(f"wrote {target / 'levels.md'}; results of the runs: {work}")
