"""TNT in free air: 1D against Kingery and Bulmash, 3D against 1D."""
import json
import re
import subprocess
import tomllib

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from common import (COLOURS, INK, MUTED, ORANGE, RC, ROOT, Variants, commit, listed, per_cent, processor, span, style,
                    table)
from matplotlib.ticker import FuncFormatter, NullFormatter

# key of summary.json: name, unit, factor from SI, target of the deviation in per cent, key of `kb --json`
QUANTITIES = {
    "peak_overpressure": ("peak overpressure", "kPa", 1e-3, 10, "incident_overpressure"),
    "arrival_time": ("arrival", "ms", 1e3, 3, "arrival"),
    "positive_impulse": ("positive impulse", "Pa s", 1.0, 10, "incident_impulse"),
}
ACCEPTANCE = (0.5, 1, 2, 3, 5, 10)  # scaled distances of the targets
CELLS = {False: {"free_air_1d": (2, 1, 0.5), "free_air_3d": (30, 20, 15)},  # mm, coarse to fine
         True: {"free_air_1d": (8, 4, 2), "free_air_3d": (60, 40, 30)}}
DIRECTIONS = {"axis": "axis", "face": "face diagonal", "body": "body diagonal"}
TNT = tomllib.loads((ROOT / "materials" / "tnt.toml").read_text())
ENERGY = TNT["energy"] / TNT["rho0"]  # of the detonation [J/kg]
AMBIENT_PRESSURE = 101325.0


def run(variants, case, cell):
    """One run of a case at a cell size [mm]: its log and its gauges."""
    result = variants(case, f"{cell:g}mm", {"cell": f"{cell:g} mm"})
    return {"cell": cell, "log": result.log, "gauges": result.gauges}


def kingery_bulmash(program, distances):
    """Curves of the quantities at the distances [m] from 1 kg of TNT."""
    curves = {key: [] for key in QUANTITIES}
    for distance in distances:
        command = [str(program), "kb", "--charge", "1", "--distance", f"{distance:.6g}", "--burst", "spherical",
                   "--json"]
        values = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["quantities"]
        for key, quantity in QUANTITIES.items():
            curves[key].append(values[quantity[4]]["value"])
    return {key: np.array(values) for key, values in curves.items()}


def point_source_energy(overpressure, distance):
    """Energy [J] of the point explosion with this peak overpressure [Pa] at this distance [m], after Brode (1955):
    dp/p0 = 0.137/x^3 + 0.119/x^2 + 0.269/x - 0.019 with x = r (p0/E)^(1/3), for dp/p0 from 0.1 to 10; outside None."""
    ratio = overpressure / AMBIENT_PRESSURE
    if not 0.1 <= ratio <= 10.0:
        return None
    roots = np.roots([ratio + 0.019, -0.269, -0.119, -0.137])
    x = roots[np.abs(roots.imag) < 1e-9].real.max()
    return AMBIENT_PRESSURE * (distance / x) ** 3


def by_distance(result):
    return sorted(result["gauges"].values(), key=lambda g: g["distance"])


def comparison_table(result):
    """The finest 1D run against Kingery-Bulmash; deviations beyond the target in bold."""
    rows = []
    for g in by_distance(result):
        z = g["scaled_distance"]
        row = [f"**{z:g}**" if z in ACCEPTANCE else f"{z:g}"]
        for key, (_, _, factor, target, _) in QUANTITIES.items():
            deviation = per_cent(g["ratio"][key])
            beyond = abs(g["ratio"][key] - 1.0) > target / 100.0
            row += [f"{g[key] * factor:.4g}", f"{g['kingery_bulmash'][key] * factor:.4g}",
                    f"**{deviation}**" if beyond else deviation]
        rows.append(row)
    header = ["Z [m/kg^(1/3)]"]
    for name, unit, _, _, _ in QUANTITIES.values():
        header += [f"{name} [{unit}]", "K-B", "deviation"]
    return table(header, rows)


def convergence_table(results):
    """Change of every value against the finest 1D grid."""
    finest = results[-1]
    header = ["Z [m/kg^(1/3)]"]
    for name, *_ in QUANTITIES.values():
        header += [f"{name}, h = {r['cell']:g} mm" for r in results[:-1]]
    rows = []
    for g in by_distance(finest):
        row = [f"{g['scaled_distance']:g}"]
        for key in QUANTITIES:
            row += [per_cent(r["gauges"][g["name"]][key] / g[key], 2) for r in results[:-1]]
        rows.append(row)
    return table(header, rows)


def energy_table(result):
    """Energies [J] of the point explosions that have the computed and the empirical peaks: a table and both lists."""
    rows, energies = [], []
    for g in by_distance(result):
        computed = point_source_energy(g["peak_overpressure"], g["distance"])
        empirical = point_source_energy(g["kingery_bulmash"]["peak_overpressure"], g["distance"])
        if computed and empirical:
            energies.append((computed, empirical))
            rows.append([f"{g['scaled_distance']:g}", f"{computed / 1e6:.2f}", f"{empirical / 1e6:.2f}",
                         f"{empirical / computed:.2f}"])
    return table(["Z [m/kg^(1/3)]", "computed [MJ]", "K-B [MJ]", "ratio"], rows), list(zip(*energies))


def duration_table(result):
    rows = []
    for g in by_distance(result):
        computed, empirical = g["positive_duration"], g["kingery_bulmash"]["positive_duration"]
        rows.append([f"{g['scaled_distance']:g}", f"{computed * 1e3:.3g}", f"{empirical * 1e3:.3g}",
                     per_cent(computed / empirical)])
    return table(["Z [m/kg^(1/3)]", "computed [ms]", "K-B [ms]", "deviation"], rows)


def octant_ratios(octant, fine):
    """Ratios 3D / 1D: {key: {z: {direction: ratio}}}."""
    ratios = {key: {} for key in QUANTITIES}
    for name, g in octant["gauges"].items():
        z, direction = re.fullmatch(r"z([\d.]+)-(\w+)", name).groups()
        for key in QUANTITIES:
            ratios[key].setdefault(float(z), {})[direction] = g[key] / fine["gauges"][f"z{z}"][key]
    return ratios


def octant_tables(octants, fine):
    text = ""
    for key, (name, *_) in QUANTITIES.items():
        rows = []
        for octant in octants:
            for z, values in sorted(octant_ratios(octant, fine)[key].items()):
                v = [values[d] for d in DIRECTIONS]
                cells_per_radius = octant["log"]["charges"][0]["cells_per_radius"]
                rows.append([f"{octant['cell']:g}", f"{cells_per_radius:.1f}", f"{z:g}", *(f"{x:.3f}" for x in v),
                             f"{np.mean(v):.3f}", f"{100 * (max(v) - min(v)) / np.mean(v):.1f} %"])
        text += f"\n**{name[0].upper() + name[1:]}, 3D / 1D**\n\n"
        header = ["h [mm]", "cells per charge radius", "Z [m/kg^(1/3)]", *DIRECTIONS.values(), "mean", "scatter"]
        text += table(header, rows)
    return text


def cost_table(results):
    rows = []
    for r in results:
        log = r["log"]
        audit = log["audit"]["relative_error"]
        rows.append([log["domain"]["geometry"], f"{r['cell']:g}", f"{log['domain']['cell_count']:,}",
                     f"{log['step']:,}", str(log["machine"]["threads"]), f"{log['wall_seconds']:.0f}",
                     f"{audit['energy']:.1e}"])
    return table(["geometry", "h [mm]", "cells", "steps", "threads", "wall time [s]", "energy balance"], rows)


def plot(results, octants, curve_distances, curves, path):
    matplotlib.rcParams.update(RC)
    fine = results[-1]
    figure, axes = plt.subplots(2, 3, figsize=(10.6, 6.6), height_ratios=(1.35, 1.0), layout="constrained")
    gauges = by_distance(fine)
    z = [g["scaled_distance"] for g in gauges]
    plain = FuncFormatter(lambda value, _: f"{value:g}")
    for a, (key, (name, unit, factor, _, _)) in zip(axes[0], QUANTITIES.items()):
        style(a)
        a.loglog(curve_distances, curves[key] * factor, color=ORANGE, linewidth=1.8, label="Kingery-Bulmash")
        a.loglog(z, [g[key] * factor for g in gauges], "o-", color=COLOURS[-1], markersize=4.5, linewidth=1.0,
                 label=f"computed, 1D, h = {fine['cell']:g} mm")
        a.set_title(f"{name[0].upper() + name[1:]} [{unit}]")
        a.set_xlabel("scaled distance Z [m/kg$^{1/3}$]")
        a.set_xticks([0.5, 1, 2, 5, 10])
        a.xaxis.set_major_formatter(plain)
        a.xaxis.set_minor_formatter(NullFormatter())
        low, high = a.get_ylim()
        if high / low < 100:
            a.set_yticks([t for t in (10, 20, 50, 100, 200, 500) if low <= t <= high])
        a.yaxis.set_major_formatter(plain)
        a.yaxis.set_minor_formatter(NullFormatter())
    axes[0][0].legend(loc="upper right")

    markers = {"axis": "o", "face": "s", "body": "^"}
    ratios = [octant_ratios(octant, fine) for octant in octants]
    distances = sorted(next(iter(ratios[0].values())))
    colours = COLOURS[-len(octants):]
    step = 0.84 / len(octants)
    for a, (key, (name, *_)) in zip(axes[1], QUANTITIES.items()):
        style(a)
        a.axhline(1.0, color=INK, linewidth=0.9)
        for n, (octant, ratio) in enumerate(zip(octants, ratios)):
            for m, distance in enumerate(distances):
                for p, (direction, marker) in enumerate(markers.items()):
                    x = m + step * (n - 0.5 * (len(octants) - 1)) + 0.22 * step * (p - 1)
                    a.plot(x, ratio[key][distance][direction], marker, color=colours[n], markersize=5,
                           markeredgewidth=0)
        a.set_xticks(range(len(distances)), [f"Z = {d:g}" for d in distances])
        a.tick_params(axis="x", length=0)
        a.set_xlim(-0.5, len(distances) - 0.5)
        a.xaxis.grid(False)
        a.set_title(f"{name[0].upper() + name[1:]}, 3D / 1D")
    handles = [plt.Line2D([], [], marker="o", linestyle="", color=colours[n], label=f"h = {o['cell']:g} mm")
               for n, o in enumerate(octants)]
    handles += [plt.Line2D([], [], marker=markers[d], linestyle="", color=MUTED, label=label)
                for d, label in DIRECTIONS.items()]
    figure.get_layout_engine().set(rect=(0.0, 0.045, 1.0, 0.955))
    figure.legend(handles=handles, loc="lower center", ncols=len(handles))
    figure.savefig(path, dpi=120, facecolor="white")
    plt.close(figure)


def misses(result):
    """One sentence per quantity on the targets."""
    lines = []
    for key, (name, _, _, target, _) in QUANTITIES.items():
        ratios = {g["scaled_distance"]: g["ratio"][key] for g in by_distance(result)
                  if g["scaled_distance"] in ACCEPTANCE}
        beyond = [f"{z:g} ({per_cent(r)})" for z, r in ratios.items() if abs(r - 1.0) > target / 100.0]
        verdict = "met everywhere" if not beyond else f"missed at Z = {', '.join(beyond)}"
        lines.append(f"- {name} within {target} %: {verdict}")
    return "\n".join(lines)


def change(results):
    """The largest change of each value from the next coarser grid to the finest."""
    coarse, fine = (r["gauges"] for r in results[-2:])
    return listed(f"{100 * max(abs(coarse[g][key] / fine[g][key] - 1.0) for g in fine):.2f} % ({name})"
                  for key, (name, *_) in QUANTITIES.items())


def mean_deviations(result):
    """Mean deviations of impulse, duration and peak from the curves in words; and where the impulse deviates most."""
    def ratio(g, key):
        return g[key] / g["kingery_bulmash"][key]
    gauges = by_distance(result)
    means = [per_cent(np.mean([ratio(g, f"{key}") for g in gauges]))
             for key in ("positive_impulse", "positive_duration", "peak_overpressure")]
    worst = max(gauges, key=lambda g: abs(ratio(g, "positive_impulse") - 1.0))
    words = "On average over the distances the impulse deviates by {}, the positive phase by {} and the peak by {}."
    return words.format(*means), per_cent(ratio(worst, "positive_impulse")), f"{worst['scaled_distance']:g}"


def cells_per_radius(results):
    return span([r["log"]["charges"][0]["cells_per_radius"] for r in results], "{:.1f}")


def page(results, octants, command, built_from):
    fine = results[-1]
    energies, (computed, empirical) = energy_table(fine)
    missing, worst, worst_z = mean_deviations(fine)
    radius = (3.0 / (4.0 * np.pi * TNT["rho0"])) ** (1.0 / 3.0)  # of 1 kg
    machine = fine["log"]["machine"]
    template = (ROOT / "validation" / "free_air.md.in").read_text()
    values = {
        "command": command, "commit": built_from, "version": fine["log"]["versions"]["brisance"],
        "machine": f"{processor()}, {machine['cores']} cores", "cell": f"{fine['cell']:g}",
        "cells_1d": ", ".join(f"{r['cell']:g}" for r in results),
        "cells_3d": ", ".join(f"{r['cell']:g}" for r in octants),
        "comparison": comparison_table(fine), "misses": misses(fine), "convergence": convergence_table(results),
        "settled": change(results), "missing": missing, "worst_impulse": worst, "worst_z": worst_z,
        "computed_energies": span([e / 1e6 for e in computed], "{:.2f}"),
        "empirical_energies": span([e / 1e6 for e in empirical], "{:.2f}"),
        "burnt_energy": f"{(ENERGY + TNT['afterburn']['energy']) / 1e6:.1f}", "density": f"{TNT['rho0']:g}",
        "charge_radius": f"{1e3 * radius:.1f}", "radius_3d": cells_per_radius(octants),
        "radius_1d": cells_per_radius(results), "cell_coarse": f"{results[0]['cell']:g}",
        "more_steps": f"{fine['log']['step'] / results[0]['log']['step']:.1f}",
        "energy": energies, "duration": duration_table(fine), "specific_energy": f"{ENERGY / 1e6:.2f}",
        "octants": octant_tables(octants, fine), "cost": cost_table(results + octants),
    }
    return re.sub(r"@(\w+)@", lambda match: values[match.group(1)].rstrip("\n"), template)


def validate(arguments, work):
    """Writes docs/validation/free_air.md and its figure."""
    cells = CELLS[arguments.quick]
    variants = Variants(arguments, work)
    runs = {case: [run(variants, case, cell) for cell in sizes] for case, sizes in cells.items()}
    target = work if arguments.quick else ROOT / "docs" / "validation"
    target.mkdir(parents=True, exist_ok=True)
    distances = np.geomspace(0.45, 11.0, 60)
    plot(runs["free_air_1d"], runs["free_air_3d"], distances, kingery_bulmash(arguments.brisance, distances),
         target / "free_air.png")
    command = "validation/run free_air" + (" --quick" if arguments.quick else "")
    built_from = arguments.commit or commit()
    (target / "free_air.md").write_text(page(runs["free_air_1d"], runs["free_air_3d"], command, built_from))
    print(f"wrote {target / 'free_air.md'} and free_air.png; results of the runs: {work}")
