"""Bursts that break out of their charge: every explosive of the library on coarse and fine grids, in air at several
altitudes and in helium, one line per case. A case passes if the run ends normally, no guard has added energy and, from
six cells per radius on, the peaks at three gauges are within 15 % of those of the same run at Courant number 0.2.

Then the hostile decks of tests/hostile. Exit code 1 if a case fails. `scripts/matrix` calls this.
"""
import argparse
import collections
import functools
import itertools
import math
import os
import subprocess
import sys
import tempfile
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "python"))
from brisance.results import Run  # noqa: E402

RADIUS = 0.05  # of the charge [m]
AMBIENTS = {"sea level": "", "10 km": 'altitude = "10 km"\n', "20 km": 'altitude = "20 km"\n',
            "32 km": 'altitude = "32 km"\n', "helium": 'fluid = "helium"\n'}
GRIDS = {"planar2d": (3, 4, 6, 7, 9, 10, 12, 16), "axisymmetric2d": (3, 4, 6, 7, 9, 10, 12, 16),
         "cartesian3d": (3, 6, 7, 10)}  # cells per radius
SHAPE = {"planar2d": "cylinder", "axisymmetric2d": "sphere", "cartesian3d": "sphere"}
IN_3D = ("TNT", "C-4", "PETN-1.77")  # and the fastest and the lightest of the library
COMPARED_FROM = 6  # cells per radius
FULL_STEP, SHORT_STEP = 0.8, 0.2  # Courant numbers
MOST_DIFFERENCE = 0.15
# Two radii from the centre beside an axis, then near and far between the axes [m].
GAUGES = {2: [(0.1, 0.002), (0.067, 0.067), (0.112, 0.112)],
          3: [(0.1, 0.002, 0.002), (0.055, 0.055, 0.055), (0.091, 0.091, 0.091)]}

Case = collections.namedtuple("Case", "geometry explosive cells ambient")


@functools.cache
def explosives():
    """The library's explosives, with detonation speed and density."""
    found = {}
    for file in sorted((ROOT / "materials").glob("*.toml")):
        material = tomllib.loads(file.read_text(encoding="utf-8"))
        if "detonation_speed" in material:
            found[material["name"]] = material["detonation_speed"], material["rho0"]
    return found


def cases(full):
    """All combinations, or enough of them for every pair of explosive, grid and atmosphere to occur."""
    library = explosives()
    fastest = max(library, key=lambda name: library[name][0])
    lightest = min(library, key=lambda name: library[name][1])
    in_3d = dict.fromkeys((*IN_3D, fastest, lightest))
    for geometry, grids in GRIDS.items():
        names = in_3d if geometry == "cartesian3d" else library
        for (e, name), (g, cells), (a, ambient) in itertools.product(enumerate(names), enumerate(grids),
                                                                     enumerate(AMBIENTS)):
            if full or geometry == "cartesian3d" or (e + g + a) % 2 == 0:
                yield Case(geometry, name, cells, ambient)


def deck(case, courant):
    dims = 3 if case.geometry == "cartesian3d" else 2
    planes = [d for d in range(dims) if (case.geometry, d) != ("axisymmetric2d", 0)]
    sides = "".join(f'{"xyz"[d]}_low = "symmetry"\n' for d in planes)
    gauges = "".join(f"[[gauge]]\npoint = {list(x)}\n" for x in GAUGES[dims])
    h = RADIUS / case.cells
    return f"""[domain]
geometry = "{case.geometry}"
size = {[4 * case.cells * h] * dims}
cell = {h!r}
[boundaries]
{sides}[ambient]
{AMBIENTS[case.ambient]}[[charge]]
explosive = "{case.explosive}"
shape = "{SHAPE[case.geometry]}"
radius = {RADIUS}
position = {[0] * dims}
{gauges}[numerics]
courant = {courant}
[output]
fields = []
peak_fields = false
[checkpoint]
at_end = false
[end]
time = {30e-6 * max(1.0, 7000.0 / explosives()[case.explosive][0])!r}
"""


def run(program, folder, text):
    """Exit code, audit, peaks of the gauges [Pa] and the last message of a run."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "deck.toml").write_text(text, encoding="utf-8")
    out = folder / "out"
    command = [program, "run", folder / "deck.toml", "--output", out, "--threads", "1", "--force", "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    message = (done.stderr.strip().splitlines() or [""])[0]
    try:
        result = Run(out)
        peaks = [gauge["peak_overpressure"] for gauge in result.summary["gauges"]]
    except (OSError, ValueError):
        return done.returncode, {}, [], message
    return done.returncode, result.log["audit"] | {"step": result.log["step"]}, peaks, message


def check(program, work, case):
    """The result of a case: passed or not, largest difference of a peak, audit, and a line of text."""
    folder = work / "-".join(map(str, case)).replace(" ", "_").replace("/", "_")
    code, audit, peaks, message = run(program, folder, deck(case, FULL_STEP))
    difference = None
    if case.cells >= COMPARED_FROM and code == 0:
        other, _, short, _ = run(program, folder, deck(case, SHORT_STEP))
        if other == 0 and len(short) == len(peaks):
            difference = max(abs(a / b - 1.0) if b > 0.0 else 0.0 for a, b in zip(peaks, short))
        else:
            code, message = other, "with short steps"
    guard = audit.get("guard_energy") or 0.0
    clean = code == 0 and guard == 0.0 and not audit.get("guarded_cells")
    passed = clean and (difference or 0.0) <= MOST_DIFFERENCE
    line = (f"{case.geometry:15} {case.explosive:16} {case.cells:3} cells {case.ambient:10} exit {code}  "
            f"{audit.get('step', 0):5} steps  guards {guard:.3g} J  "
            f"limited faces {audit.get('fallback_faces', 0):6}")
    line += f"  peaks within {100 * difference:4.1f} %" if difference is not None else ""
    line += "" if passed else "  FAILED"
    return case, passed, difference, audit, line + (f"  {message}" if code else "")


def page(results, arguments, seconds):
    """The page of the matrix: cases, failures and differences by geometry and cells."""
    from common import commit, machine, table
    rows = []
    groups = collections.defaultdict(list)
    for case, passed, difference, audit, _ in results:
        groups[case.geometry, case.cells].append((case.ambient, passed, difference, audit))
    for (geometry, cells), members in groups.items():
        row = [geometry, str(cells), str(len(members)), str(sum(not m[1] for m in members)),
               f"{sum(m[3].get('guard_energy') or 0.0 for m in members):.3g}",
               str(sum(m[3].get("fallback_faces") or 0 for m in members))]
        for ambient in AMBIENTS:
            worst = max((m[2] for m in members if m[0] == ambient and m[2] is not None), default=None)
            row.append("" if worst is None else f"{100 * worst:.1f}")
        rows.append(row)
    header = ["geometry", "cells per radius", "cases", "failed", "energy of guards [J]", "limited faces",
              *(f"{a} [%]" for a in AMBIENTS)]
    failed = sum(not result[1] for result in results)
    in_3d = len({case.explosive for case, *_ in results if case.geometry == "cartesian3d"})
    near, far = (math.hypot(*x) / RADIUS for x in GAUGES[2][1:])
    return f"""# Bursts that break out of their charge

Charges of 50 mm radius, programmed burn, in a domain of four radii, 30 us (longer where the
detonation is slower than 7 km/s): {len(explosives())} explosives in 2D, {in_3d} in 3D, in air at four altitudes and in
helium. A case fails if the exit code of the run is not 0, if a guard adds energy, or, from {COMPARED_FROM} cells per
radius on, if a peak at one of three gauges (two radii from the centre beside an axis, {near:.1f} and {far:.1f} radii
between the axes) differs by more than {100 * MOST_DIFFERENCE:.0f} % from that of the same run at Courant number
{SHORT_STEP}. The last five columns give the largest such difference. Limited faces: fluxes that were blended with a
first-order one.

{table(header, rows)}
{len(results)} cases, {failed} failed. Produced by `scripts/matrix --full`, commit {commit()}, {machine()},
{seconds / 60.0:.0f} minutes.

This table does not show how much the peaks depend on the cell size. It shows that they depend little on the time step.
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--full", action="store_true", help="every combination; writes docs/validation/matrix.md")
    parser.add_argument("--brisance", default=str(ROOT / "build/release/bin/brisance"), help="the program")
    parser.add_argument("--work", help="folder of the runs (default: a temporary folder)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="runs in parallel")
    parser.add_argument("--only", default="", help="only cases whose names contain this word; no hostile decks")
    arguments = parser.parse_args()
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as scratch, ThreadPoolExecutor(arguments.jobs) as pool:
        work = Path(arguments.work or scratch)
        wanted = [c for c in cases(arguments.full) if arguments.only in " ".join(map(str, c))]
        results = []
        for result in pool.map(lambda case: check(arguments.brisance, work, case), wanted):
            results.append(result)
            print(result[-1], flush=True)
        failed = sum(not r[1] for r in results)
        worst = max((r[2] for r in results if r[2] is not None), default=0.0)
        seconds = time.monotonic() - begin
        print(f"{len(results)} bursts, {failed} failed, peaks within {100 * worst:.1f} %, {seconds:.0f} s")
        if not arguments.only:
            import hostile
            hostile_results = hostile.run_all(arguments.brisance, work / "hostile")
            failed += sum(not passed for _, passed, _ in hostile_results)
            print(f"{len(hostile_results)} hostile decks, {sum(not p for _, p, _ in hostile_results)} failed")
    if arguments.full and not arguments.only:
        target = ROOT / "docs" / "validation" / "matrix.md"
        target.write_text(page(results, arguments, seconds), encoding="utf-8")
        print(f"written: {target.relative_to(ROOT)}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
