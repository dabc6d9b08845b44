"""The start by a remap: a burst in 3D from a 1D start, compared with the same burst in 1D throughout and in 3D
throughout; the time of the remap; the 1D start by material points compared with that by the gas scheme; products that
become an ideal gas."""
import re

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from common import COLOURS, INK, ORANGE, RC, ROOT, Variants, commit, machine, per_cent, span, style, table

DISTANCES = (0.25, 0.3, 0.35, 0.4, 0.45)  # of the gauges [m]
DIRECTIONS = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1), "xy": (1, 1, 0), "yz": (0, 1, 1), "xyz": (1, 1, 1)}
QUANTITIES = {"arrival_time": "arrival", "front_overpressure": "peak at the front",
              "peak_overpressure": "peak in the record", "positive_impulse": "impulse"}
CHARGE_RADIUS = 52.7118  # [mm]
REMAP_RADIUS = 0.15  # of the shock [m]
REMAP_RADII = (0.1, 0.15, 0.2, 0.24, 0.29)  # of the runs in axisymmetry
FLAT = {"x": (1, 0), "30deg": (0.8660254, 0.5), "60deg": (0.5, 0.8660254), "z": (0, 1)}
FORMED = 1.6  # radii of the remap from which on a front counts as formed
LATE = 10  # relative volume
CUT_OVERS = (0, 4, 5, 7, 10, 20)  # relative volumes from which products are an ideal gas; 0: never
FARTHER = (0.5, 0.7, 1.0, 1.4)  # gauges of a larger domain in axisymmetry [m]
FAR = (0.3, 0.5, 0.8, 1.2, 2.0, 3.0, 5.0)  # gauges of those runs [m]
CELLS = {False: {"remap": ("10.4", "5.2", "2.6"), "direct": ("10.4", "5.2", "3.25")},  # [mm]
         True: {"remap": ("20.8", "10.4"), "direct": ("20.8", "10.4")}}
FLAT_CELLS = {False: ("5.2", "2.6", "1.3"), True: ("10.4",)}  # of the runs in axisymmetry [mm]
STARTS = {False: {"gas": ("1", "0.26", "0.13", "0.065"), "points": ("1", "0.26", "0.13")},  # of the 1D start [mm]
          True: {"gas": ("1", "0.26"), "points": ("1",)}}
SAME_TIME = "70 us"  # of the profiles of gas and points


def reference_deck(distances=DISTANCES, size=0.78, end="0.26 ms"):
    gauges = "".join(f'[[gauge]]\nname="r{d}"\npoint=[{d}]\n' for d in distances)
    return f"""[domain]
geometry="spherical1d"
size={size}
cell="0.26 mm"
[[charge]]
mass="1 kg"
{gauges}[end]
time="{end}"
"""


def octant_deck(start, cell):
    gauges = ""
    for d in DISTANCES:
        for name, v in DIRECTIONS.items():
            length = np.sqrt(sum(x * x for x in v))
            gauges += f'[[gauge]]\nname="r{d}-{name}"\npoint={[float(d * x / length) for x in v]}\n'
    remap = f'[remap]\ncell="0.26 mm"\nradius={REMAP_RADIUS}\n' if start == "remap" else ""
    return f"""start="{start}"
[domain]
size=[0.52,0.52,0.52]
cell="{cell} mm"
[boundaries]
x_low="symmetry"
y_low="symmetry"
z_low="symmetry"
[[charge]]
mass="1 kg"
{remap}{gauges}[end]
time="0.26 ms"
"""


def flat_deck(cell, radius, distances=DISTANCES, size=0.52, end="0.26 ms"):
    gauges = "".join(f'[[gauge]]\nname="r{d}-{name}"\npoint=[{d * v[0]:.9f},{d * v[1]:.9f}]\n'
                     for d in distances for name, v in FLAT.items())
    return f"""start="remap"
[domain]
geometry="axisymmetric2d"
size=[{size},{size}]
cell="{cell} mm"
[boundaries]
y_low="symmetry"
[[charge]]
mass="1 kg"
[remap]
cell="0.26 mm"
radius={radius}
{gauges}[end]
time="{end}"
"""


def cut_over_deck(volume):
    gauges = "".join(f'[[gauge]]\nname="r{d}"\npoint=[{d}]\n' for d in FAR)
    numerics = f"[numerics]\nideal_products={volume}\n" if volume else ""
    return f"""[domain]
geometry="spherical1d"
size=8
cell="1 mm"
[[charge]]
mass="1 kg"
{numerics}{gauges}[end]
time="12 ms"
"""


def start_deck(method, cell):
    return f"""start="remap"
[domain]
geometry="axisymmetric2d"
size=[0.6,1.2]
cell="5 mm"
[[charge]]
mass="1 kg"
position=[0,0.6]
[remap]
time="{SAME_TIME}"
method="{method}"
cell="{cell} mm"
[output]
fields=["pressure"]
[end]
time="0.5 ms"
steps=2
"""


def ratios(result, reference, distances=DISTANCES):
    """For every quantity and distance: values in all directions over those of the 1D run."""
    fine, gauges = reference.gauges, result.gauges
    directions = DIRECTIONS if f"r{distances[0]}-xyz" in gauges else FLAT

    def ratio(key, d, n):
        value = gauges[f"r{d}-{n}"][key]  # the peak at the front may not be known
        return np.nan if value is None else value / fine[f"r{d}"][key]
    return {key: {d: np.array([ratio(key, d, n) for n in directions]) for d in distances} for key in QUANTITIES}


def deviations(v):
    """Smallest to largest deviation of ratios."""
    return "-" if np.isnan(v).any() else f"{per_cent(v.min())} to {per_cent(v.max())}"


def scatter(v):
    """Largest minus smallest, relative to the mean."""
    return (v.max() - v.min()) / v.mean()


def comparison(runs, reference):
    rows = []
    for (start, cell), run in runs.items():
        r = ratios(run, reference)
        for d in DISTANCES:
            row = [start, cell, f"{CHARGE_RADIUS / float(cell):.1f}", f"{d:g}"]
            for key in QUANTITIES:
                v = r[key][d]
                row += [deviations(v), "-" if np.isnan(v).any() else f"{100 * scatter(v):.1f} %"]
            rows.append(row)
    header = ["start", "h [mm]", "cells per charge radius", "distance [m]"]
    for name in QUANTITIES.values():
        header += [name, "scatter"]
    return table(header, rows)


def verdict(runs, reference):
    """The finest remapped run compared with the limits, as a table."""
    r = ratios([run for (start, _), run in runs.items() if start == "remap"][-1], reference)
    rows = []
    for key, limit in (("arrival_time", 1), ("front_overpressure", 5), ("peak_overpressure", 5),
                       ("positive_impulse", 5)):
        worst = 100 * max(np.abs(v - 1.0).max() for v in r[key].values())
        spread = 100 * max(scatter(v) for v in r[key].values())
        if np.isnan(worst):
            rows.append([QUANTITIES[key], "unknown", f"{limit} %", "", "unknown", "3 %", ""])
            continue
        rows.append([QUANTITIES[key], f"{worst:.1f} %", f"{limit} %", "met" if worst <= limit else "**missed**",
                     f"{spread:.1f} %", "3 %", "met" if spread <= 3 else "**missed**"])
    return table(["", "largest deviation", "limit", "", "largest scatter", "limit", ""], rows)


def radii_table(flat, reference):
    rows = []
    for (cell, radius), run in flat.items():
        r = ratios(run, reference)["front_overpressure"]
        # Before the remap a gauge reads ambient gas.
        rows.append([cell, f"{CHARGE_RADIUS / float(cell):.0f}", f"{radius:g}",
                     *("before" if d <= radius else deviations(r[d]) for d in DISTANCES)])
    return table(["h [mm]", "cells per charge radius", "shock at the remap [m]", *(f"{d:g} m" for d in DISTANCES)],
                 rows)


def farther_table(runs, reference):
    rows = []
    for cell, run in runs.items():
        r = ratios(run, reference, FARTHER)
        for key in ("peak_overpressure", "front_overpressure"):
            rows.append([cell, f"{CHARGE_RADIUS / float(cell):.0f}", QUANTITIES[key],
                         *(deviations(r[key][d]) for d in FARTHER)])
    return table(["h [mm]", "cells per charge radius", "", *(f"{d:g} m" for d in FARTHER)], rows)


def cut_over_table(runs):
    full = runs[0].gauges
    rows = []
    for volume, run in runs.items():
        if not volume:
            continue
        gauges = run.gauges
        row = [f"{volume:g}"]
        for key in ("arrival_time", "peak_overpressure", "positive_impulse"):
            deviation = [gauges[f"r{d}"][key] / full[f"r{d}"][key] for d in FAR]
            worst = int(np.argmax(np.abs(np.array(deviation) - 1.0)))
            row.append(f"{per_cent(deviation[worst], 2)} at {FAR[worst]:g} m")
        rows.append(row)
    return table(["V of the cut-over", "arrival", "peak", "impulse"], rows)


def young(flat, reference):
    """Accuracy of the peak at the front in axisymmetry soon after a remap, and later."""
    soon, later = [], []
    for (_, radius), run in flat.items():
        for d, values in ratios(run, reference)["front_overpressure"].items():
            if d > radius and not np.isnan(values).any():
                (soon if d < FORMED * radius else later).extend(100.0 * (values - 1.0))
    if not soon or not later:
        return "These grids do not show how a young front develops."
    return (f"Up to {FORMED:g} times the radius of the remap the peak at the front deviates by "
            f"{span(soon, '{:+.1f}')} %, beyond that by {span(later, '{:+.1f}')} % (all cells and positions of the "
            "table).")


def gain(reference):
    """Excess of the reference's peak at the front over the peak of its record, in per cent."""
    return 100.0 * float(np.mean([g["front_overpressure"] / g["peak_overpressure"] - 1.0
                                  for g in reference.gauges.values()]))


def late_cut_over(runs):
    """The largest change of any value by a late cut-over."""
    full = runs[0].gauges
    worst = max(abs(run.gauges[name][key] / full[name][key] - 1.0) for volume, run in runs.items()
                if volume >= LATE for name in full for key in ("arrival_time", "peak_overpressure",
                                                               "positive_impulse"))
    return f"From V = {LATE:g} on no value changes by more than {100 * worst:.2f} %."


def later_rises(history):
    """The largest rise of the pressure after the first peak, relative to the peak, and when it began [s]."""
    t, p = history["time"], history["overpressure"]
    first = int(np.argmax(p))
    low = np.minimum.accumulate(p[first:])
    rise = p[first:] - low
    at = int(np.argmax(rise))
    return rise[at] / p[first], t[first:][int(np.argmin(p[first:first + at + 1]))]


def rises(runs, reference):
    rows = []
    for d in DISTANCES:
        row = [f"{d:g}"]
        for result, name in [(reference, f"r{d}")] + [(r, f"r{d}-{n}") for (s, _), r in runs.items() if s == "remap"
                                                      for n in ("x", "xyz")]:
            rise, at = later_rises(result.gauge(name))
            row.append(f"{100 * rise:.2f} % from {at * 1e6:.0f} us")
        rows.append(row)
    names = [f"h = {c} mm, {n}" for (s, c) in runs if s == "remap" for n in ("axis", "diagonal")]
    return table(["distance [m]", "1D", *names], rows)


def audits(runs):
    rows = []
    for (start, cell), run in runs.items():
        if start != "remap":
            continue
        s = run.log["starts"][0]
        rows.append([cell, f"{s['cells_per_radius']:.1f}",
                     f"{s['before']['mass'][1]:.15g}", f"{s['after']['mass'][1]:.15g}",
                     f"{s['before']['mass'][0]:.12g}", f"{s['after']['mass'][0]:.12g}", f"{s['before']['energy']:.12g}",
                     f"{s['after']['energy']:.12g}", f"{s['relative_error']:.1e}", f"{s['quadrature_error']:.0e}"])
    return table(["h [mm]", "cells per burst radius", "products before [kg]", "after", "air before [kg]", "after",
                  "energy before [J]", "after", "largest relative error", "before the correction"], rows)


def mean_error(run, reference, key):
    """Mean over all gauges; not a number where one of them has no value."""
    return float(np.mean([np.abs(v - 1.0) for v in ratios(run, reference)[key].values()]))


def cell_updates(run):
    return run.log["domain"]["cell_count"] * run.log["step"]


def equal_accuracy(runs, reference):
    """Cost of a direct simulation as accurate as a remapped one, interpolated between the direct runs; a bound beyond
    them."""
    rows = []
    direct = [run for (start, _), run in runs.items() if start == "direct"]
    for key, name in QUANTITIES.items():
        errors = np.array([mean_error(run, reference, key) for run in direct])
        costs = np.array([cell_updates(run) for run in direct], dtype=float)
        if np.isnan(errors[-1]):
            continue
        for (start, cell), run in runs.items():
            error = mean_error(run, reference, key)
            if start != "remap" or np.isnan(error):
                continue
            told = ~np.isnan(errors)
            if error < errors[told].min():
                ratio = f"> {costs[-1] / cell_updates(run):.3g}"
            elif error > errors[told].max():
                ratio = f"< {costs[told][0] / cell_updates(run):.3g}"
            else:
                ratio = f"{np.exp(np.interp(-error, -errors[told], np.log(costs[told]))) / cell_updates(run):.3g}"
            rows.append([name, cell, f"{100 * error:.2f} %", ratio])
    return table(["mean error of", "h of the remapped run [mm]", "its error", "cell updates, direct / remapped"], rows)


def costs(runs, reference):
    rows = []
    for (start, cell), run in runs.items():
        r = ratios(run, reference)
        errors = [f"{100 * mean_error(run, reference, key):.2f} %".replace("nan %", "-") for key in QUANTITIES]
        spread = 100 * np.mean([scatter(v) for v in r["peak_overpressure"].values()])
        log = run.log
        before = log["timings"].get("start", 0.0)
        updates = cell_updates(run) / 1e6
        rows.append([start, cell, f"{log['domain']['cell_count']:,}", f"{log['step']:,}", f"{updates:,.0f}",
                     f"{before:.0f}", f"{log['timings']['sweeps'] + log['timings']['exchange']:.0f}", *errors,
                     f"{spread:.1f} %"])
    return table(["start", "h [mm]", "cells", "steps", "million cell updates", "1D start [s]", "steps in 3D [s]",
                  *(f"mean error of the {n}" for n in QUANTITIES.values()), "mean scatter of the peak"], rows)


def cumulated(profile, radii, component):
    """Integral of a component of a profile from the centre to the radii."""
    values = np.append(profile.values(component), profile.ambient(component))
    edges = 4 / 3 * np.pi * (np.arange(len(values)) * profile.spacing) ** 3
    sums = np.append(0.0, np.cumsum(values[:-1] * np.diff(edges)))
    asked = 4 / 3 * np.pi * radii ** 3
    return np.interp(asked, edges, sums) + np.maximum(0.0, asked - edges[-1]) * values[-1]


def difference(of, reference, component, cell):
    """L1 of means over `cell` [m] of a component of the start's profile, relative."""
    radii = np.arange(0.0, 0.34, cell)
    a = np.diff(cumulated(reference.profiles["start_1"], radii, component))
    b = np.diff(cumulated(of.profiles["start_1"], radii, component))
    return np.abs(a - b).sum() / np.abs(a).sum()


# of a profile, and their names in the table
COMPONENTS = {"pressure": "pressure", "density": "air", "second_density": "products", "momentum_x": "momentum",
              "energy": "energy"}


def points_worst(starts, gas):
    """Largest difference between the finest run with material points and a run with gas."""
    points = [key for key in starts if key[0] == "points"][-1]
    gas = starts[gas or ("gas", points[1])]
    return f"{100 * max(difference(starts[points], gas, c, 0.26e-3) for c in COMPONENTS):.2f} %"


def start_table(starts):
    finest = list(key for key in starts if key[0] == "gas")[-1]
    rows = []
    for key, run in starts.items():
        row = [key[0], key[1], f"{CHARGE_RADIUS / float(key[1]):.0f}"]
        for cell in (0.26e-3, 5e-3):
            row += [f"{100 * difference(run, starts[finest], c, cell):.2f} %" for c in COMPONENTS]
        rows.append(row + [f"{run.log['timings']['start']:.1f}"])
    names = COMPONENTS.values()
    return table(["method", "cell [mm]", "cells per charge radius", *names, *(f"{n}, 5 mm" for n in names), "time [s]"],
                 rows)


def plots(runs, reference, starts, target):
    matplotlib.rcParams.update(RC)
    figure, axes = plt.subplots(1, 3, figsize=(12.0, 3.9), layout="constrained")
    remapped = [(c, r) for (s, c), r in runs.items() if s == "remap"]
    for a, d in zip(axes, (DISTANCES[0], DISTANCES[2], DISTANCES[4])):
        style(a)
        for colour, (cell, run) in zip(COLOURS[-len(remapped):], remapped):
            for n, line in (("x", "-"), ("xyz", "--")):
                h = run.gauge(f"r{d}-{n}")
                a.plot(h["time"] * 1e6, h["overpressure"] / 1e6, line, color=colour, linewidth=1.1,
                       label=f"3D, h = {cell} mm" if n == "x" else None)
        h = reference.gauge(f"r{d}")
        a.plot(h["time"] * 1e6, h["overpressure"] / 1e6, color=ORANGE, linewidth=1.1, label="1D, h = 0.26 mm")
        a.set_xlim(30, 250)
        a.set_yscale("symlog", linthresh=0.1)
        a.set_title(f"Overpressure [MPa] at {d:g} m")
        a.set_xlabel("time [us]")
    axes[0].plot([], [], "--", color=COLOURS[-1], linewidth=1.1, label="dashed: along the diagonal")
    axes[0].legend()
    figure.savefig(target / "remap_histories.png", dpi=120, facecolor="white")
    plt.close(figure)

    figure, axes = plt.subplots(1, 3, figsize=(12.0, 3.9), layout="constrained")
    gas = [key for key in starts if key[0] == "gas"][-1]
    points = [key for key in starts if key[0] == "points"][-1]
    for key, colour in ((points, ORANGE), (gas, INK)):
        profile = starts[key].profiles["start_1"]
        rho = profile.values("density") + profile.values("second_density")
        for a, values in zip(axes, (rho, profile.values("momentum_x") / rho, profile.values("pressure") / 1e6)):
            a.plot(profile.radii(), values, color=colour, linewidth=0.9, label=f"{key[0]}, cells of {key[1]} mm")
    for a, title in zip(axes, ("Density [kg/m³]", "Velocity [m/s]", "Pressure [MPa]")):
        style(a)
        a.set_title(f"{title} at {SAME_TIME}")
        a.set_xlabel("radius [m]")
        if "Velocity" not in title:
            a.set_yscale("log")
    axes[0].legend()
    figure.savefig(target / "remap_starts.png", dpi=120, facecolor="white")
    plt.close(figure)


def validate(arguments, work):
    """Writes docs/validation/remap.md and its figures."""
    run = Variants(arguments, work)
    reference = run("remap", "reference", text=reference_deck())
    cells = CELLS[arguments.quick]
    octants = {(start, cell): run("remap", f"{start}-{cell}mm", text=octant_deck(start, cell))
               for start in cells for cell in cells[start]}
    starts = {(method, cell): run("remap", f"start-{method}-{cell}mm", text=start_deck(method, cell))
              for method, sizes in STARTS[arguments.quick].items() for cell in sizes}
    flat = {(cell, radius): run("remap", f"flat-{cell}mm-{radius}", text=flat_deck(cell, radius))
            for cell in FLAT_CELLS[arguments.quick] for radius in REMAP_RADII}
    far = {"distances": FARTHER, "size": 1.56, "end": "3 ms"}
    farther = {cell: run("remap", f"farther-{cell}mm", text=flat_deck(cell, REMAP_RADIUS, **far))
               for cell in FLAT_CELLS[arguments.quick][:2]}
    far_reference = run("remap", "farther-reference", text=reference_deck(**{**far, "size": 1.95}))
    cut_overs = {volume: run("remap", f"ideal-{volume}", text=cut_over_deck(volume)) for volume in CUT_OVERS}
    target = work if arguments.quick else ROOT / "docs" / "validation"
    target.mkdir(parents=True, exist_ok=True)
    plots(octants, reference, starts, target)
    values = {"command": "validation/run remap" + (" --quick" if arguments.quick else ""),
              "commit": arguments.commit or commit(), "machine": machine(),
              "threads": str(reference.log["machine"]["threads"]), "audits": audits(octants),
              "comparison": comparison(octants, reference), "rises": rises(octants, reference),
              "costs": costs(octants, reference),
              "verdict": verdict(octants, reference), "radii": radii_table(flat, reference),
              "farther": farther_table(farther, far_reference),
              "equal": equal_accuracy(octants, reference), "cut_overs": cut_over_table(cut_overs),
              "vanished": f"{60 / 0.95:.0f}", "young": young(flat, reference), "gain": f"{gain(reference):.1f}",
              "late_cut_over": late_cut_over(cut_overs), "charge_radius": f"{CHARGE_RADIUS:.1f}",
              "remap_radius": f"{REMAP_RADIUS:g}", "gauges": f"{len(DISTANCES) * len(DIRECTIONS)}",
              "finest": f"{CHARGE_RADIUS / float(cells['remap'][-1]):.0f}", "same_time": SAME_TIME,
              "points_cells": f"{CHARGE_RADIUS / float(STARTS[arguments.quick]['points'][-1]):.0f}",
              "far": f"{FAR[0]:g} to {FAR[-1]:g}", "points_same": points_worst(starts, None),
              "points_finest": points_worst(starts, [key for key in starts if key[0] == "gas"][-1]),
              "starts": start_table(starts)}
    template = (ROOT / "validation" / "remap.md.in").read_text()
    page = re.sub(r"@(\w+)@", lambda match: values[match.group(1)].rstrip("\n"), template)
    (target / "remap.md").write_text(page)
    print(f"wrote {target / 'remap.md'}; results of the runs: {work}")
