"""Example 5.4: clamped circular plates of armour steel under spheres of TNT, after Neuberger, Peles & Rittel (2007)."""
import math
import re
import tomllib

import matplotlib.pyplot as plt
import numpy as np
from common import COLOURS, ORANGE, RC, ROOT, Curves, listed, nearest, per_cent, span, style

TITLE = "Clamped circular plates under charges"
CASE = "paper_plates"
# case: (factor of all lengths and times, TNT [kg], test, CFDMP, LS-DYNA), the last three peak deflection over thickness
CASES = {1: (1, 0.468, 2.60, 2.69, 2.59), 2: (2, 3.75, 2.70, 2.71, 2.62), 3: (4, 30.0, None, 2.68, None),
         4: (1, 1.094, 4.85, 5.20, 4.98), 5: (2, 8.75, 5.35, 5.45, 5.24), 6: (4, 70.0, None, 5.625, None)}
THICKNESS, HOLE = 0.010, 0.250  # of case 1, and the radius of the hole [m]
CELLS = {"quick": 3, "standard": 4, "fine": 6}  # over the thickness, in all cases
GRIDS = {"quick": (3,), "standard": (3, 4, 6), "fine": (4, 6, 8)}  # of case 1
MISES_TIMES = (0.3e-3, 0.5e-3, 1.0e-3)
LONG = 2.0  # factor by which case 5 runs longer, for its final shape
LIMIT, LIMIT_OF_SCALE = 5.0, 2.0  # targets: deviation from the tests, and between two sizes, per cent
WALL_END, WALL_GAUGES = "0.3 ms", 26
END = 0.8  # of case 1 [ms]
BOTH = '=["x", "y"]'  # directions of a clamp in which nothing slides
HELD, WIDE, STUCK = "plate fixed in the clamp", "grip of 250 mm", "gas sticks to the plate"
# Case 1 on the coarsest grid: changes of the deck, and additions to it.
VARIANTS = {
    HELD: ("held-clamp", {"constraint.held": BOTH}, ""),
    WIDE: ("wide", {}, ""),
    STUCK: ("stuck", {"mpm_region.slip": "=false"}, ""),
    "charge on the grid from the start": ("direct", {"start": "direct"}, ""),
    "domain higher by 160 mm": ("high", {"domain.upper": '=["280 mm", "500 mm"]'}, ""),
    "9 gas particles per cell": ("points", {"mpm_region.points_per_direction": 3}, ""),
    "linear viscosity of the gas 0.06": ("viscosity", {"mpm_region.linear_viscosity": 0.06}, ""),
    "plate by APIC": ("apic", {}, '\n[points]\ntransfer = "apic"\n'),
    "plate with locking control": ("locking", {}, "\n[points]\nlocking_control = true\n"),
}
SHOWN = (HELD, WIDE, STUCK)
# Other clamps with which cases 1 and 4 are run: name for files, radius of the plate [mm], changes of the constraint.
# None: it acts only on the middle of the thickness at the edge of the hole, about which the plate turns.
CLAMPS = {
    "slides, grip of 10 mm": ("slides-10", 260, {}),
    "slides, grip of 60 mm": ("slides-60", 310, {}),
    "slides, grip of 250 mm": ("slides-250", 500, {}),
    "fixed from D/2 on": ("held", 280, {"constraint.held": BOTH}),
    "slides and turns at D/2": ("hinge-slides", None, {}),
    "fixed and turns at D/2": ("hinge-held", None, {"constraint.held": BOTH}),
}


def number(value):
    return f"{value:.15g}"


def deck(case, cells):
    """The deck of a case with this number of cells over the thickness: case 1, all lengths and times scaled."""
    factor, mass = CASES[case][:2]
    text = (ROOT / "cases" / CASE / "deck.toml").read_text()
    h = 10.0 / cells
    top = 10.0 + h * max(7, math.ceil(20.0 / h - 1e-9))  # width + 2 cells remain free above the plate
    text = text.replace('"30 mm"]}\n\n[[con', f'"{number(top)} mm"]}}\n\n[[con', 1)
    text = re.sub(r'^cell = "[^"]*"', f'cell = "{number(h)} mm"', text, flags=re.MULTILINE)
    text = re.sub(r'^mass = "[^"]*"', f'mass = "{mass:g} kg"', text, flags=re.MULTILINE)
    if cells < 4 and case > 3:  # on coarse cells the region begins where the larger charges have not burnt completely
        text = re.sub(r"^start = .*\n", "", text, flags=re.MULTILINE)
    if factor == 1:
        return text
    return re.sub(r'"(-?[\d.]+) (mm|ms|us)"', lambda m: f'"{number(factor * float(m[1]))} {m[2]}"', text)


def over_a_wall(text, points):
    """The burst of case 1 over a rigid plane in the position of the plate's face: gas cells alone, or gas particles in
    front of the plane, for which it is a mirror."""
    text = text[:text.index("[[body]]")]
    text = text.replace('lower = [0, "-60 mm"]', 'lower = [0, "10 mm"]', 1)
    # The 1D start ends about where that of the plate's deck does.
    start = '[remap]\nradius = "68 mm"\n'
    if points:
        start = '[mpm_region]\npoints_per_direction = 2\nbox = {lower = [0, "10 mm"], upper = ["280 mm", "45 mm"]}\n'
    return text + start + (
        '[boundaries]\ny_low = "wall"\n[[gauge]]\nname = "wall"\n'
        f'line = {{from = [0, "10 mm"], to = ["250 mm", "10 mm"], count = {WALL_GAUGES}}}\n[output]\n'
        f'gauge_interval = "1 us"\nfields = ["impulse"]\n[end]\ntime = "{WALL_END}"\n')


def gripped(text, radius):
    """The deck of case 1 with a plate of this radius [mm], which slides in the clamp from the edge of the hole on."""
    return text.replace('"280 mm"', f'"{radius} mm"')


def hinged(text, cells):
    """The deck of case 1 or 4 with a plate that can turn at the edge of the hole: there the middle of its thickness
    is constrained, a cell wide."""
    h = 10.0 / cells
    text = text.replace('["250 mm", 0], upper = ["280 mm", "10 mm"]',
                        f'["250 mm", "{number(5.0 - 0.52 * h)} mm"], upper = ["{number(250.0 + h)} mm", '
                        f'"{number(5.0 + 0.52 * h)} mm"]', 1)
    return gripped(text, number(250.0 + 2.0 * h))


def held_plate(text):
    """The deck of case 1 with the whole plate fixed."""
    text = text.replace('["250 mm", 0]', "[0, 0]", 1).replace('held = ["y"]\n', "", 1)
    return re.sub(r"^field_times = .*\n", "", text, flags=re.MULTILINE)


def wall_row(result):
    """Specific impulse [Pa s] on a rigid wall, cell by cell, and the size of the cells [m]."""
    return result.dumps[-1].values("impulse")[0], result.cell_size


def wall_impulse(result):
    """Impulse on a rigid wall [N s] within the radius of the plate, and specific impulse at its centre [Pa s]."""
    row, h = wall_row(result)
    return 2.0 * np.pi * np.sum(row * h * (np.arange(len(row)) + 0.5)) * h, row[0]


def gauged_impulse(result):
    """Impulse on a wall [N s] up to the radius of the hole, and specific impulse at its centre [Pa s], from its
    gauges."""
    r = np.linspace(0.0, HOLE, WALL_GAUGES)
    i = np.array([result.gauge(f"wall-{n + 1}")["impulse"][-1] for n in range(WALL_GAUGES)])
    return 2.0 * np.pi * np.trapz(i * r, r), i[0]


def loaded_plate(text, wall):
    """The plate of case 1 alone, under the impulse that gas cells exert on a rigid wall: rings of pressure that fall to
    zero within 20 us."""
    row, h = wall_row(wall)
    r = h * (np.arange(len(row)) + 0.5)
    text = re.sub(r"^start = .*\n|^fields = .*\n", "", text, flags=re.MULTILINE)
    text = re.sub(r"\[\[charge\]\].*?(?=\[\[body)", "", text, flags=re.DOTALL)
    text = re.sub(r"\[mpm_region\].*?(?=\[\[con)", "", text, flags=re.DOTALL)
    rings = np.concatenate((np.arange(0.0, 100.0, 5.0), np.arange(100.0, 251.0, 10.0)))
    for a, b in zip(rings[:-1], rings[1:]):
        inside = (r > a * 1e-3) & (r < b * 1e-3)
        impulse = np.sum((row * r)[inside]) / np.sum(r[inside])
        text += (f'\n[[surface_pressure]]\nbody = "plate"\nnormal = "+y"\n'
                 f'within = {{shape = "box", lower = ["{a:g} mm", 0], upper = ["{b:g} mm", "10 mm"]}}\n'
                 f'history = {{times = [0, "20 us"], pressures = ["{number(2.0 * impulse / 20e-6)} Pa", 0]}}\n')
    return text


def held_impulse(result):
    return result.log["points"]["audit"]["momentum"]["constraint_impulse"][1]


def deflection(result, factor):
    """Time [s] and deflection of the middle of the back face over the thickness; the peak and its time."""
    gauge = result.gauge("centre")
    t, u = gauge["time"], -gauge["displacement_y"] / (factor * THICKNESS)
    i = int(np.argmax(u))
    return t, u, u[i], t[i]


def plate(result, time):
    """The plate's particles in the dump nearest to a time [s], and its time."""
    d = nearest(result.point_dumps, time).read()
    mine = d["body"] == 0
    return {k: v[mine] for k, v in d.items() if k != "time"}, d["time"]


def back_face(points):
    """Radius [m] and height [m] of the lowest layer of particles, in the order of the radius."""
    start = points["position"] - points["displacement"]
    layer = start[:, 1] < start[:, 1].min() + 0.02 * THICKNESS  # the particles are some tenths apart
    order = np.argsort(start[layer, 0])
    return points["position"][layer][order, 0], points["displacement"][layer][order, 1]


def histories(runs, path):
    with plt.rc_context(RC):
        figure, axes = plt.subplots(1, 2, figsize=(10.6, 3.6), layout="constrained")
        for a, members in zip(axes, ((1, 2, 3), (4, 5, 6))):
            style(a)
            for k, case in enumerate(members):
                factor, _, test = CASES[case][:3]
                t, u = deflection(runs[case], factor)[:2]
                colour = (ORANGE, COLOURS[0], COLOURS[3])[k]
                a.plot(t / factor * 1e3, u, color=colour, linewidth=(4.0, 2.4, 1.0)[k], label=f"case {case}")
                if test is not None:
                    a.axhline(test, color=colour, linewidth=0.9, linestyle="--", label=f"case {case}, peak of the test")
            a.set(xlabel="time over the scale of the lengths [ms]", xlim=(0, END), ylim=(0, None))
            a.legend(loc="lower right")
        axes[0].set_ylabel("deflection / thickness")
        for a, case in zip(axes, (1, 4)):
            a.set_title(f"{CASES[case][1]:g} kg scaled")
        figure.savefig(path, dpi=130, facecolor="white")
        plt.close(figure)


def clamps_block(variants, runs, cells):
    """Table of cases 1 and 4 with other clamps and of the ratio of their deflections; and {label: deflections of
    cases 1 and 4}, that of the deck first."""
    clamped = {"slides, grip of 30 mm (used here)": [runs[1], runs[4]]}
    for label, (name, radius, changes) in CLAMPS.items():
        texts = {case: deck(case, cells) for case in (1, 4)}
        clamped[label] = [variants(CASE, f"clamp-{name}-{case}", changes,
                                   text=hinged(text, cells) if radius is None else gripped(text, radius))
                          for case, text in texts.items()]
    rows, peaks = [], {}
    for label, results in clamped.items():
        first, fourth = peaks[label] = [deflection(r, 1)[2] for r in results]
        rows.append([label, *(peak_of(r) for r in results), f"{fourth / first:.2f}", "–"])
    for label, k in (("tests", 2), ("[Cui14]", 3), ("LS-DYNA", 4)):
        one, two, four, five = (CASES[n][k] for n in (1, 2, 4, 5))
        rows.append([label, f"{one:.2f}", f"{four:.2f}", f"{four / one:.2f}", f"{five / two:.2f}"])
    caption = f"Clamps: peak deflection over thickness of cases 1 and 4, of {CASES[1][1]:g} and {CASES[4][1]:g} kg"
    header = ["clamp", "case 1", "case 4", "case 4 / case 1", "case 5 / case 2"]
    return ("table", caption, header, rows), peaks


def mises(runs, path):
    """[Cui14] Fig. 18."""
    with plt.rc_context(RC):
        figure, axes = plt.subplots(2, 3, figsize=(12.0, 2.7), layout="compressed", sharex=True, sharey=True)
        for row, case in zip(axes, (2, 5)):
            for a, time in zip(row, MISES_TIMES):
                p, when = plate(runs[case], time)
                x, y = p["position"][:, 0] * 1e3, p["position"][:, 1] * 1e3
                for side in (-1, 1):
                    shown = a.scatter(side * x, y, c=p["mises"] / 1e6, s=1.2, linewidths=0, cmap="turbo", vmin=0,
                                      vmax=1300)
                a.set(title=f"case {case}, {when * 1e3:.1f} ms", aspect="equal", xlim=(-560, 560), ylim=(-130, 40))
        for a in axes[-1]:
            a.set_xlabel("r [mm]")
        for a in axes[:, 0]:
            a.set_ylabel("y [mm]")
        figure.colorbar(shown, ax=axes, label="Mises stress [MPa]", shrink=0.9)
        figure.savefig(path, dpi=130, facecolor="white")
        plt.close(figure)


def profile(result, path):
    """[Cui14] Fig. 17."""
    with plt.rc_context(RC):
        figure, a = plt.subplots(figsize=(9.0, 3.0), layout="constrained")
        style(a)
        for time, colour in ((MISES_TIMES[-1], COLOURS[1]), (np.inf, ORANGE)):
            p, when = plate(result, min(time, 1.0))
            r, y = back_face(p)
            a.plot(np.concatenate((-r[::-1], r)) * 1e3, np.concatenate((y[::-1], y)) * 1e3, color=colour,
                   linewidth=1.5, label=f"{when * 1e3:.2f} ms")
        a.set(xlabel="r [mm]", ylabel="height of the back face [mm]")
        a.legend()
        figure.savefig(path, dpi=130, facecolor="white")
        plt.close(figure)


def draw_in(result):
    """Inward motion of the plate of case 1 or 4 at the edge of the hole [m], in the dump nearest to 0.5 ms."""
    p, _ = plate(result, 0.5e-3)
    start = p["position"][:, 0] - p["displacement"][:, 0]
    return -np.mean(p["displacement"][np.abs(start - HOLE) < result.cell_size, 0])


def variants_figure(runs, path):
    with plt.rc_context(RC):
        figure, a = plt.subplots(figsize=(7.4, 3.8), layout="constrained")
        style(a)
        for (label, result), (colour, line) in zip(runs.items(), (
                (COLOURS[1], "-"), (COLOURS[2], "-"), (COLOURS[3], "-"), (ORANGE, "-"), (ORANGE, "--"),
                ("#2f8a57", "-"))):
            t, u = deflection(result, 1)[:2]
            a.plot(t * 1e3, u, line, color=colour, linewidth=1.4, label=label)
        a.axhline(CASES[1][2], color="#66727f", linewidth=0.9, linestyle=":", label="peak of the test")
        a.set(xlabel="time [ms]", ylabel="deflection / thickness", xlim=(0, 0.8), ylim=(0, None))
        a.legend(fontsize=7.5, loc="lower right")
        figure.savefig(path, dpi=130, facecolor="white")
        plt.close(figure)


def run(variants, resolution, target):
    cells = CELLS[resolution]
    coarse = GRIDS[resolution][0]
    grids = {}
    chosen = {label: v for label, v in VARIANTS.items() if resolution != "quick" or label in SHOWN}
    variants.expect(len(CASES) + 2 * len(GRIDS[resolution]) + len(chosen) + 4
                    + 2 * len(CLAMPS) * (resolution != "quick"))
    runs = {}
    for case in CASES:
        end = {"end.time": f"{number(END * CASES[case][0] * (LONG if case == 5 else 1.0))} ms"}
        runs[case] = variants(CASE, f"case{case}-{cells}", end, text=deck(case, cells))
    for n in GRIDS[resolution]:
        grids[n] = runs[1] if n == cells else variants(CASE, f"case1-{n}", text=deck(1, n))
    others = {label: variants(CASE, f"{name}-{coarse}", changes, added,
                              text=gripped(deck(1, coarse), 500 if label == WIDE else 280))
              for label, (name, changes, added) in chosen.items()}
    wall = variants(CASE, "wall", {}, text=over_a_wall(deck(1, 4), points=False))
    mirror = variants(CASE, "mirror", {}, text=over_a_wall(deck(1, 4), points=True))
    held = {n: variants(CASE, f"held-{n}", {"end.time": WALL_END}, text=held_plate(deck(1, n)))
            for n in GRIDS[resolution]}
    alone = {
        "plate alone, impulse of the rigid wall": variants(
            CASE, f"alone-{coarse}", text=loaded_plate(deck(1, coarse), wall)),
        "the same, plate fixed in the clamp": variants(
            CASE, f"alone-held-{coarse}", VARIANTS[HELD][1], text=loaded_plate(deck(1, coarse), wall)),
    }

    # On coarser cells case 4 is direct.
    block, of_clamps = clamps_block(variants, runs, cells) if resolution != "quick" else (None, {})

    histories(runs, target / "histories.png")
    mises(runs, target / "mises.png")
    profile(runs[5], target / "profile.png")
    shown = {f"{n} cells over the thickness": r for n, r in grids.items()}
    shown |= {f"{label}, {coarse} cells": others[label] for label in SHOWN}
    variants_figure(shown, target / "variants.png")

    peaks = {case: deflection(r, CASES[case][0])[2] for case, r in runs.items()}
    acceptance = []
    for case, (_, _, test, paper, _) in CASES.items():
        if test is None:
            continue
        ratio = peaks[case] / test
        acceptance.append((f"Case {case}: peak deflection over thickness", f"{peaks[case]:.2f}, {per_cent(ratio)}",
                           f"{test:.2f} within {LIMIT:g} % (paper {paper:.2f}, {per_cent(paper / test)})",
                           bool(abs(ratio - 1.0) <= LIMIT / 100.0)))
    paper = {case: values[3] for case, values in CASES.items()}
    trend = peaks[3] / peaks[2], peaks[6] / peaks[5], peaks[5] / peaks[4]
    acceptance += [
        ("Case 3 like case 2: hardly any effect of the scale", per_cent(trend[0]),
         f"within {LIMIT_OF_SCALE:g} % (paper {per_cent(paper[3] / paper[2])})",
         bool(abs(trend[0] - 1.0) <= LIMIT_OF_SCALE / 100.0)),
        ("Case 6 above case 5, case 5 above case 4: less rate hardening in the larger plates",
         f"{per_cent(trend[1])}, {per_cent(trend[2])}",
         f"both above 0 (paper {per_cent(paper[6] / paper[5])}, {per_cent(paper[5] / paper[4])})",
         bool(trend[1] > 1.0 and trend[2] > 1.0)),
    ]
    if len(grids) > 1:
        last = [deflection(r, 1)[2] for r in grids.values()]
        acceptance.append(("Case 1: change of the peak from the middle grid to the finest", per_cent(last[2] / last[1]),
                           "within 3 %", bool(abs(last[2] / last[1] - 1.0) <= 0.03)))
    mass = max(max(abs(e) for e in r.log["audit"]["relative_error"]["mass"]) for r in runs.values())
    drift = max((r.log["mpm_region"]["energy"]["drift"] for r in runs.values()), key=abs)
    full, middle = wall_impulse(wall)
    finest = held_impulse(held[GRIDS[resolution][-1]])
    seconds = grids[cells].log["wall_seconds"]
    acceptance += [
        ("Mass of both fluids, all cases: largest relative error", f"{mass:.0e}", "round-off, 1e-11",
         bool(mass < 1e-11)),
        ("Energy, all cases: largest drift", f"{100.0 * drift:+.2f} %", "within 1 %", bool(abs(drift) <= 0.01)),
        ("Impulse on a plate that is fixed everywhere (finest grid), relative to that on a rigid wall below gas cells",
         per_cent(finest / full),
         "within 5 %", bool(abs(finest / full - 1.0) <= 0.05)),
        (f"Time of case 1, {variants.threads} thread{'s' if variants.threads > 1 else ''}", f"{seconds:.0f} s",
         "below 30 min", bool(seconds < 1800.0)),
    ]

    rows = []
    for case, (factor, kg, test, paper, dyna) in CASES.items():
        _, _, peak, when = deflection(runs[case], factor)
        body = runs[case].gauge("plate")
        rows.append([f"{case}", f"{10 * factor}", f"{0.5 * factor:g}", f"{kg:g}", f"{100 * factor}",
                     "-" if test is None else f"{test:.2f}", f"{paper:g}", "-" if dyna is None else f"{dyna:.2f}",
                     f"{peak:.2f}", "-" if test is None else per_cent(peak / test), per_cent(peak / paper),
                     f"{when * 1e3:.2f}", f"{-body['momentum_y'].min() / factor**3:.0f}",
                     f"{body['plastic_work'][-1] / factor**3 / 1e3:.1f}",
                     f"{100 * runs[case].log['mpm_region']['energy']['drift']:+.2f} %"])
    header = ["case", "t [mm]", "D [m]", "TNT [kg]", "R [mm]", "test", "paper", "LS-DYNA", "here", "against test",
              "against paper", "time of the peak [ms]", "largest momentum / scale^3 [N s]",
              "plastic work / scale^3 [kJ]", "energy drift"]
    table = []
    for n, r in grids.items():
        table.append([f"{n} cells over the thickness", *row_of(r)])
    for label, r in (others | alone).items():
        table.append([f"{label}, {coarse} cells", *row_of(r)])
    by_gauges, of_points = gauged_impulse(wall), gauged_impulse(mirror)
    loads = [["gas cells of 2.5 mm over a rigid wall", f"{full:.0f}", "", f"{by_gauges[0]:.0f}", "",
              f"{middle:.0f}"],
             ["particles over a mirror plane, cells of 2.5 mm", "-", "-", f"{of_points[0]:.0f}",
              per_cent(of_points[0] / by_gauges[0]), f"{of_points[1]:.0f}"]]
    for n, r in held.items():
        loads.append([f"particles over a fixed plate, {n} cells over its thickness", f"{held_impulse(r):.0f}",
                      per_cent(held_impulse(r) / full), "-", "-", "-"])
    blocks = [
        ("text", SETUP),
        ("table", "Peak deflection of the middle of the back face over the thickness ([Cui14] Tables 1 and 2)", header,
         rows),
        ("figure", "histories.png", "Deflection of the middle of the back face"),
        ("figure", "profile.png", "Back face of case 5 ([Cui14] Fig. 17). It still oscillates elastically"),
        ("figure", "mises.png", "Mises stress, true shapes ([Cui14] Fig. 18)"),
        ("table", "Case 1 on several grids and in variants; drawn in: about 0.5 ms",
         ["run", "peak deflection / t", "time of the peak [ms]", "drawn in at D/2 [mm]", "largest momentum [N s]",
          "largest kinetic energy [kJ]", "particles", "wall time [s]"], table),
        ("figure", "variants.png", "Case 1 on several grids and in variants"),
        *([block] if block else []),
        ("table", f"Impulse on the face of case 1 to {WALL_END}",
         ["run", "on the whole face [N s]", "against the wall", "within D/2, by gauges [N s]", "against the wall",
          "at the centre [Pa s]"], loads),
        ("text", discussion(variants, runs, grids, others, next(iter(alone.values())),
                            {"full": full, "middle": middle, "held": held}, of_clamps)),
    ]
    return {"acceptance": acceptance, "blocks": blocks, "costs": variants.costs}


def peak_of(result):
    """Peak deflection of the middle of case 1 or 4 over the thickness, as a text."""
    _, _, peak, when = deflection(result, 1)
    return f"{peak:.2f}" + (" (still rising)" if when > 0.98 * result.log["time"] else "")


def row_of(result):
    when = deflection(result, 1)[3]
    body = result.gauge("plate")
    inwards = draw_in(result)
    return [peak_of(result), f"{when * 1e3:.2f}", f"{inwards * 1e3:.2f}", f"{-body['momentum_y'].min():.0f}",
            f"{body['kinetic_energy'].max() / 1e3:.2f}", f"{result.log['points']['count']:,}",
            f"{result.log['wall_seconds']:.0f}"]


SETUP = """
<p>A plate of rolled armour steel (RHA), clamped between two thick plates with a hole of diameter D, under a bare sphere
of TNT lit in its centre. Six cases in two series; each series is one arrangement at the scales 1, 2 and 4. The tests
measured the largest deflection of the centre while the plate moves, with a comb below it, that is, on its back face;
here it is that of the material point nearest to the centre of the back face.</p>
<p>Axisymmetric. Gas cells everywhere, material points (particles) for the plate and for the gas from its open back to
two thicknesses above it, where a bridge of 5 cells joins both. The charge detonates in a 1D simulation until its shock
is about to meet the MPM region (in <code>quick</code> those of cases 4 to 6 burn on the grid, because the region begins
too near). RHA: Johnson-Cook and Mie-Grueneisen with the constants of [Cui14], JWL of TNT of [Cui14], no afterburn. The
clamp: from the edge of the hole on, 30 mm wide, the plate may slide inwards without friction, but moves neither up nor
down. The thick plates themselves, of unknown thickness, are left out. All cases have the same number of cells over the
thickness, so that the scales differ only in the strain rate. No constant was fitted; <b>the clamp is the one choice
that was made with knowledge of the tests</b>: how the plates were gripped, and how far they extended beyond the hole,
is not printed. The table of the clamps shows the effect of others. The deck is <code>cases/paper_plates</code>.</p>
"""


def most_momentum(result):
    """The plate's, downwards [N s]."""
    return -result.gauge("plate")["momentum_y"].min()


def ratios_of(case_values):
    """Deflections of the larger charge over those of the smaller, of {case: deflection}; None where one is missing."""
    pairs = ((case_values[4], case_values[1]), (case_values[5], case_values[2]))
    return [large / small for large, small in pairs if large and small]


def on_the_tests(peaks):
    """Which tests are met, and how the sizes differ."""
    tests = {case: values[2] for case, values in CASES.items() if values[2]}
    off = {case: peaks[case] / test for case, test in tests.items()}
    missed = [case for case, ratio in off.items() if abs(ratio - 1.0) > LIMIT / 100.0]
    paper = {case: CASES[case][3] / test for case, test in tests.items()}
    worst = max(paper, key=lambda case: abs(paper[case] - 1.0))
    scaled = [peaks[b] / peaks[a] for a, b in ((1, 2), (2, 3), (4, 5), (5, 6))]
    low, high = (1.0 - LIMIT / 100.0) * tests[5], (1.0 + LIMIT / 100.0) * tests[4]
    hardening = tomllib.loads((ROOT / "materials" / "rha.toml").read_text())["strength"]["C"] * math.log(2.0)
    of_missed = listed(f"case {case} ({per_cent(off[case])})" for case in missed)
    return f"""<li><b>{len(off) - len(missed)} of the {len(off)} tests are met within {LIMIT:g} %</b>; missed:
{of_missed}. The paper's worst is {per_cent(paper[worst])} in case {worst}. Cases 1 and 2,
and 4 and 5, are the same arrangement in two sizes. Rate hardening, their only difference, adds C ln 2 =
{100 * hardening:.1f} % to the yield stress per halving of the lengths; here the deflection changes by
{span([100 * (s - 1) for s in scaled], "{:+.1f}")} % per doubling, in the tests by {per_cent(tests[2] / tests[1])} and
{per_cent(tests[5] / tests[4])}. Whoever scales meets both tests of the larger charge, {tests[4]:.2f} and
{tests[5]:.2f}, within {LIMIT:g} % only with values between {low:.2f} and {high:.2f}.</li>"""


def on_the_load(variants, loads, alone, coarse, grids):
    """The impulse on the face, and its effect on a plate without gas."""
    burst = grids[coarse].log["charges"][0]
    distance = burst["centre"][1] - THICKNESS
    expected = Curves(variants.program, CASES[1][1])("spherical", distance, "reflected_impulse")
    held = [held_impulse(r) / loads["full"] for r in loads["held"].values()]
    free = deflection(alone, 1)[2] / deflection(grids[coarse], 1)[2]
    return f"""<li><b>The load.</b> Over a rigid wall the gas cells give {1e-3 * loads["middle"]:.1f} kPa s at the
centre; Kingery and Bulmash's reflected impulse at this distance is {1e-3 * expected:.1f} (<code>brisance kb</code>).
The impulse on a plate that is fixed everywhere differs from that on the wall by
{span([100 * (h - 1) for h in held], "{:+.1f}")} %. The deflection of a plate alone, without any gas, under the impulse
of the rigid wall differs from that of the coupled run on {coarse} cells by {per_cent(free)}: this is the effect of the
coupling.</li>"""


def on_the_clamp(others, grids, coarse, clamps):
    """Gas that sticks, the clamp, and the ratio of the two charges."""
    base, stuck = grids[coarse], others[STUCK]
    peaks = {label: deflection(r, 1)[2] for label, r in ((HELD, others[HELD]), (WIDE, others[WIDE]), ("", base))}
    text = f"""<li><b>Gas that sticks to the plate</b>, as in the paper, where everything shares one grid: with
<code>slip = false</code> the plate receives {most_momentum(stuck):.0f} N s instead of {most_momentum(base):.0f} and
deflects by {deflection(stuck, 1)[2]:.2f} instead of {peaks[""]:.2f}.</li>
<li><b>The clamp.</b> Case 1 on {coarse} cells, fixed at D/2, so that nothing is drawn in: {peaks[HELD]:.2f}. Sliding
with a {WIDE}: {peaks[WIDE]:.2f}. Sliding as in the deck: {peaks[""]:.2f}. Tests with small charges showed no effect of
the height of the clamp [Bonorchis09].</li>"""
    if not clamps:
        return text
    tests = ratios_of({case: values[2] for case, values in CASES.items()})
    others = ratios_of({case: values[3] for case, values in CASES.items()}) + ratios_of(
        {case: values[4] for case, values in CASES.items()})
    taken, *_ = here = {label: fourth / first for label, (first, fourth) in clamps.items()}
    nearest_to = min(here, key=lambda label: abs(here[label] - np.mean(tests)))
    more = here[taken] > max(tests)
    end = (" The real clamp therefore yielded more to the smaller charges, and was drawn in less by the larger ones, "
           "than the one used here: plates that separate and turn a little, and bolts that the plate comes to bear "
           "against, would behave in this way. Such a clamp has two parameters that are not known; it was not tried."
           if more else "")
    return text + f"""<li><b>The step from {CASES[1][1]:g} to {CASES[4][1]:g} kg</b> increases the deflection by a
factor of {listed(f"{r:.2f}" for r in tests)} in the tests, {span(others, "{:.2f}")} in the other simulations and
{here[taken]:.2f} here (table of the clamps). Of the clamps there, "{nearest_to}" has the ratio nearest to that of the
tests, {here[nearest_to]:.2f}; its deflection in case 1 deviates by {per_cent(clamps[nearest_to][0] / CASES[1][2])} from
the test.{end}</li>"""


def discussion(variants, runs, grids, others, alone, loads, clamps):
    """What the runs show, from their values. `clamps`: {label: deflections of cases 1 and 4}."""
    coarse = next(iter(grids))
    peaks = {case: deflection(r, CASES[case][0])[2] for case, r in runs.items()}
    by_grid = {n: deflection(r, 1)[2] for n, r in grids.items()}
    further = {label: deflection(r, 1)[2] / by_grid[coarse] for label, r in others.items() if label not in SHOWN}
    changed = listed(f"{label} {per_cent(ratio)}" for label, ratio in further.items())
    variations = f" Changed on {coarse} cells: {changed}." if further else ""
    energy = runs[1].log["mpm_region"]["energy"]
    drifts = [100.0 * r.log["mpm_region"]["energy"]["drift"] for r in runs.values()]
    of_plate = runs[1].gauge("plate")["kinetic_energy"].max()
    return f"""
<h3>What it shows</h3>
<ul>
{on_the_tests(peaks)}
{on_the_load(variants, loads, alone, coarse, grids)}
{on_the_clamp(others, grids, coarse, clamps)}
<li><b>The grid.</b> Case 1: {listed(f"{peak:.2f} on {n}" for n, peak in by_grid.items())} cells over the
thickness.{variations}</li>
<li><b>Audit.</b> The drift of the energy is {span(drifts, "{:+.2f}")} % of the energy at work; in case 1
{abs(energy["drift"]) * energy["scale"] / 1e3:.1f} kJ, compared with a largest kinetic energy of the plate of
{of_plate / 1e3:.1f} kJ. This does not prove that the plate receives the right share; the plate alone under the same
impulse is better evidence.</li>
<li><b>Shapes.</b> They were not compared quantitatively with the photograph of [Cui14] Fig. 17.</li>
</ul>
"""
