"""Cells of several sizes: blasts on blocks that follow the shocks against uniform cells, and what both cost; a plate in
small cells in a room of large ones against small cells all around."""
import os
import subprocess
import sys

import numpy

from common import ROOT, Result, commit, machine, per_cent, table, varied

# Size of today's cells [m], and by how much the coarsest cells of the adaptive run are larger than the finest of half.
CASES = {"street_3d": (0.25, 4), "hemisphere_3d": (0.032, 4)}
PAIRS = 3  # of runs with half cells, in turn
# The piece of the room around the plate that has its small cells everywhere: size [mm], and where the room goes on.
PIECE, OPEN_FACES = (512, 512, 1280), ("x_high", "y_high", "z_high")


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


def largest_jump(one, other, name):
    """The largest change of the pressure between two samples of a history, beyond the largest that the other run has
    within the same length of time near by, over its peak."""
    own, known = other.result.gauge(name), one.result.gauge(name)
    time, pressure = own["time"], own["overpressure"]
    near = 0.01 * known["time"][-1] * numpy.linspace(-1.0, 1.0, 101)

    def at(times):
        return numpy.interp(times[:, None] + near[None, :], known["time"], known["overpressure"])

    allowed = numpy.abs(at(time[1:]) - at(time[:-1])).max(axis=1)
    return (numpy.abs(numpy.diff(pressure)) - allowed).max() / known["overpressure"].max()


def median(values):
    return sorted(values)[len(values) // 2]


def compare(arguments, work, case, part, pairs):
    """Cells of `part` of the case's own size: on blocks that follow shocks, against the same everywhere."""
    cell, ratio = CASES[case]
    finest, coarsest = part * cell, ratio * cell / 2.0
    uniform, adaptive = [], []
    for n in range(pairs):
        name = f"{case}-{round(1 / part)}"
        uniform.append(Run(arguments, work, f"{name}-uniform-{n}", deck(case, finest)))
        adaptive.append(Run(arguments, work, f"{name}-levels-{n}", deck(case, finest, coarsest)))
    gain = median([u.seconds / a.seconds for u, a in zip(uniform, adaptive)])
    rows = [(name, *(per_cent(1.0 + x, 2) for x in rest),
             f"{100 * max(0.0, largest_jump(uniform[0], adaptive[0], name)):.2f} %")
            for name, *rest in differences(uniform[0], adaptive[0])]
    gauges = table(("gauge", "peak", "impulse", "arrival", "jumps"), rows)
    costs = table(("cells", "time [s]", "memory [MB]", "regrid"),
                  [(f"{1000 * finest:g} mm everywhere", f"{median([u.seconds for u in uniform]):.1f}",
                    f"{uniform[0].memory:.0f}", "-"),
                   (f"{1000 * coarsest:g} to {1000 * finest:g} mm", f"{median([a.seconds for a in adaptive]):.1f}",
                    f"{adaptive[0].memory:.0f}", f"{100 * adaptive[0].regrid:.1f} %")])
    memory = adaptive[0].memory / uniform[0].memory
    return f"""## {case}, cells of {1000 * finest:g} mm

Coarsest cells of {1000 * coarsest:g} mm, finest of {1000 * finest:g} mm, 1/{round(1 / part)} of the case's own, against
cells of {1000 * finest:g} mm everywhere: {gain:.2f} times as fast (median of {pairs} pairs in turn), {memory:.2f} of
the memory.

{costs}
Differences at the gauges; jumps: changes of the pressure between two samples that the other run does not have near by,
over the peak.

{gauges}"""


def plate(arguments, work):
    """The plate in the room against the same plate with its cells all around."""
    text = (ROOT / "cases" / "plate_in_room_3d" / "deck.toml").read_text()
    room = Run(arguments, work, "plate-room", text)
    changes = {"domain.size": "=[" + ", ".join(f'"{x} mm"' for x in PIECE) + "]", "domain.cell": "4 mm", "finest": None,
               "shocks": None, "charges": None, "mpm_region.cell": None}
    changes |= {f"boundaries.{face}": "outflow" for face in OPEN_FACES}
    piece = Run(arguments, work, "plate-piece", varied(text.replace("[adaptive]\n", ""), changes))

    def figures(run):
        middle, body = run.result.gauge("middle"), run.result.gauge("plate")
        below = run.gauges["below"]
        return (1000.0 * numpy.abs(middle["displacement_z"]).max(), 1000.0 * middle["displacement_z"][-1],
                numpy.abs(body["impulse_z"]).max(), below["largest_impulse"])

    names = ("largest deflection [mm]", "deflection at the end [mm]", "impulse of the gas on the plate [N s]",
             "impulse of the pressure below it [Pa s]")
    rows = [(name, f"{a:.4g}", f"{b:.4g}", per_cent(a / b, 2))
            for name, a, b in zip(names, figures(room), figures(piece))]
    return f"""## plate_in_room_3d

A plate in cells of 4 mm in a room of 64 mm: {room.seconds:.0f} s, {room.memory:.0f} MB. The same plate in a piece of
{" x ".join(str(x) for x in PIECE)} mm3 with cells of 4 mm everywhere: {piece.seconds:.0f} s, {piece.memory:.0f} MB.

{table(("quantity", "room", "piece", "difference"), rows)}"""


def validate(arguments, work):
    """Writes docs/validation/levels.md."""
    pairs = 1 if arguments.quick else PAIRS
    parts = [compare(arguments, work, case, 0.5, pairs) for case in CASES]
    parts.append(plate(arguments, work))
    if not arguments.quick:
        parts += [compare(arguments, work, case, 0.25, 1) for case in CASES]
    text = f"""# Cells of several sizes

Produced by `validation/run levels --threads {arguments.threads}`, commit {arguments.commit or commit()}; machine:
{machine()}.

""" + "\n".join(parts)
    target = work if arguments.quick else ROOT / "docs" / "validation"
    target.mkdir(parents=True, exist_ok=True)
    (target / "levels.md").write_text(text)
    print(f"wrote {target / 'levels.md'}; results of the runs: {work}")
