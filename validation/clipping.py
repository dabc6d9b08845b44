"""How much of the peaks of blasts the cells clip: bursts of TNT on converging grids, in the open and at a rigid wall,
compared with what `brisance check` reports before the run and the summary after it."""
import json
import math
import subprocess
from string import Template

from common import ROOT, Variants, commit, per_cent, table

AMBIENT = 101325.0
RADIUS = 0.0527  # of 1 kg of TNT [m]
FEWEST = 4  # cells per charge radius
REFERENCE = 1600  # cells to the gauge, of the run whose decay gives the incident peak
# Distance of the gauge from 1 kg [m], and when its record ends [s].
DISTANCES = ((0.7, 0.6e-3), (1, 1e-3), (1.5, 2e-3), (2, 3.2e-3), (3, 6.2e-3), (5, 12e-3), (10, 27e-3))
NUMBERS = (100, 200, 400, 800)  # cells to the gauge


def deck(z, number, wall, end):
    """1 kg of TNT in the open or in a rigid sphere of the radius z, and a gauge there."""
    return (f'title = "1 kg of TNT, gauge at {z:g} m, {number} cells"\n[domain]\ngeometry = "spherical1d"\n'
            f'size = {z if wall else 1.6 * z}\ncell = {z / number:.12g}\n[boundaries]\n'
            f'x_high = "{"wall" if wall else "outflow"}"\n[[charge]]\nexplosive = "TNT"\nmass = 1\n'
            f'[[gauge]]\nname = "g"\npoint = {z}\n[output]\npeak_fields = false\n[end]\ntime = {end}\n')


def reflected(p):
    """Overpressure on a wall behind the reflection of a shock of this overpressure, gamma = 1.4 [Pa]."""
    return 2 * p * (7 * AMBIENT + 4 * p) / (7 * AMBIENT + p)


def clipping(length, cells):
    a = length * math.log(2) / cells
    return -math.expm1(a * math.log(a) - (1 + a) * math.log1p(a))


def captured_length(part, cells):
    """The length of the captured shock [cells] that clips this fraction of a peak; None where it is not clipped."""
    if part <= 0:
        return None
    low, high = 1e-3, 50.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if clipping(middle, cells) < part else (low, middle)
    return low


def law(strength, wall):
    """The law of `captured_length` in src/observe/blast_wave.cpp."""
    return 0.55 * strength ** -0.23 + (1.15 * strength ** 2 / (1 + strength ** 2) if wall else 0.0)


def before(program, path):
    answer = json.loads(subprocess.run([str(program), "check", "--json", str(path)], check=True, capture_output=True,
                                       text=True).stdout)
    return answer["gauge_peaks"][0]


def rows_of(variants, wall, numbers):
    rows = []
    for z, end in DISTANCES:
        kind = "wall" if wall else "open"
        fine = variants("clipping", f"open-{z:g}-{REFERENCE}", text=deck(z, REFERENCE, False, end)).gauges["g"]
        incident = fine["front_overpressure"]
        right = reflected(incident) if wall else incident
        runs = [n for n in numbers if RADIUS * n / z >= FEWEST]
        # N of all grids from the finest record: the time in which the pressure falls to half of the right peak.
        finest = variants("clipping", f"{kind}-{z:g}-{REFERENCE}", text=deck(z, REFERENCE, wall, end)).gauges["g"]
        for number in runs:
            name = f"{kind}-{z:g}-{number}"
            g = variants("clipping", name, text=deck(z, number, wall, end)).gauges["g"]
            expected = before(variants.program, variants.work / f"clipping-{name}.toml")
            cells = finest["cells_per_half_width"] * number / REFERENCE
            part = 1 - g["peak_overpressure"] / right
            length = captured_length(part, cells)
            front = g["peak_front_overpressure"]
            rows.append([f"{z:g}", f"{incident / AMBIENT:.3g}", f"{number}", f"{cells:.3g}", per_cent(1 - part),
                         "-" if length is None else f"{length:.2f}", f"{law(incident / AMBIENT, wall):.2f}",
                         f"-{100 * expected['expected_clipping']:.1f} %", f"-{100 * g['expected_clipping']:.1f} %",
                         "-" if front is None else per_cent(front / right)])
    return rows


HEADER = ["Z [m/kg^(1/3)]", "Δp/p0 of the incident shock", "cells to the gauge", "N", "peak of the record",
          "w [cells]", "w from the law", "clipping by `check`", "by the summary", "peak at the front"]


def validate(arguments, work):
    """Writes docs/validation/clipping.md."""
    variants = Variants(arguments, work)
    numbers = NUMBERS[:2] if arguments.quick else NUMBERS
    in_the_open, at_walls = (rows_of(variants, wall, numbers) for wall in (False, True))
    target = work if arguments.quick else ROOT / "docs" / "validation"
    target.mkdir(parents=True, exist_ok=True)
    text = Template((ROOT / "validation" / "clipping.md.in").read_text()).substitute(
        command="validation/run clipping" + (" --quick" if arguments.quick else ""),
        commit=arguments.commit or commit(), reference=REFERENCE, fewest=FEWEST,
        in_the_open=table(HEADER, in_the_open), at_walls=table(HEADER, at_walls))
    (target / "clipping.md").write_text(text)
    print(f"wrote {target / 'clipping.md'}; results of the runs: {work}")
