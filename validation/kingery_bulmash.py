"""TNT against the curves of Kingery and Bulmash: incident and reflected, in free air and on the ground, with and
without afterburn, at sea level and at 3000 m."""
import json
import re
import subprocess

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from common import (COLOURS, INK, MUTED, ORANGE, RC, ROOT, Curves, Variants, commit, listed, machine, per_cent, span,
                    style, table)
from matplotlib.ticker import FuncFormatter, NullFormatter

DISTANCES = (0.5, 0.7, 1, 1.5, 2, 3, 4, 5, 7, 10)  # Z [m/kg^(1/3)], of 1 kg
GROUND = 2.0 ** (-1 / 3)  # a hemisphere on rigid ground is half of a sphere of twice its mass
FAR = 1  # Z beyond which texts give the deviations separately
ASIDE = 0.1  # distance of the gauge on the wall from the axis, in Z
SLANT = (1 + ASIDE ** 2) ** 0.5
AMBIENT = 101325.0
ALTITUDE = 3000.0
Q = 10.2e6  # afterburn energy of TNT [J/kg], materials/tnt.toml
# Afterburn: name, what it is, lines of the deck. The detonation of 1 kg is over after 15 us.
AFTERBURN = (
    ("miller", "Miller's law with the constants quoted for C-4: 6500/s at 100 GPa, m = 0.5, n = 0.1667, above 0.1 MPa",
     'model = "miller"\nrate = "6500 s-1"\nm = 0.5\nn = 0.1667\nminimum_pressure = 1e5\n'),
    ("3ms", "constant rate, from 0.03 to 3 ms", 'model = "constant_rate"\nbegin = 3e-5\nend = 3e-3\n'),
    ("10ms", "constant rate, from 0.03 to 10 ms", 'model = "constant_rate"\nbegin = 3e-5\nend = 1e-2\n'),
    ("30ms", "constant rate, from 0.03 to 30 ms", 'model = "constant_rate"\nbegin = 3e-5\nend = 3e-2\n'),
    ("quarter", "a quarter of the energy (2.55 MJ/kg) at a constant rate, from 0.03 to 3 ms",
     'model = "constant_rate"\nenergy = 2.55e6\nbegin = 3e-5\nend = 3e-3\n'),
)
# Walls: Z, size of the domain (r, y) [m], cell [m], end [s].
WALLS = ((0.5, (0.8, 1.2), 0.0025, 0.7e-3), (1, (1.6, 2.4), 0.005, 2.4e-3), (2, (2.8, 4.0), 0.008, 6e-3),
         (3, (4.0, 5.6), 0.0125, 10e-3), (5, (6.4, 8.4), 0.02, 18e-3), (7, (8.4, 11.2), 0.02, 25e-3),
         (10, (11.2, 15.2), 0.025, 36e-3))
QUANTITIES = {"peak_overpressure": ("peak overpressure", "kPa", 1e-3, "incident_overpressure"),
              "arrival_time": ("arrival", "ms", 1e3, "arrival"),
              "positive_impulse": ("positive impulse", "Pa s", 1.0, "incident_impulse"),
              "positive_duration": ("positive duration", "ms", 1e3, "duration")}


def gauges_text(points):
    return "".join(f'[[gauge]]\nname = "{name}"\npoint = {list(x)}\n' for name, x in points)


def free_air_deck(cell, points, afterburn="", ambient="", mass=1.0, size=14, end=32e-3):
    return (f'title = "{mass:g} kg of TNT in free air"\n[domain]\ngeometry = "spherical1d"\nsize = {size}\n'
            f'cell = {cell}\n'
            f'{ambient}[[charge]]\nexplosive = "TNT"\nmass = {mass}\n' + gauges_text(points)
            + (f"[afterburn]\n{afterburn}" if afterburn else "")
            + f"[output]\npeak_fields = false\n[end]\ntime = {end}\n")


def wall_deck(z, size, cell, end, afterburn=""):
    """The charge on the axis, z from a rigid wall at y = 0; gauges on the wall at the foot of the axis and beside it.
    Half of the way to the wall is simulated in one dimension."""
    return (f'title = "1 kg of TNT, {z:g} m from a wall"\nstart = "remap"\n[remap]\nradius = {0.5 * z}\n'
            f'cell = 1e-3\n[domain]\ngeometry = "axisymmetric2d"\nsize = {list(size)}\n'
            f'cell = {cell}\n[boundaries]\ny_low = "wall"\n[[charge]]\nexplosive = "TNT"\nmass = 1\n'
            f'position = [0, {z}]\n' + gauges_text([("wall", (0, 0)), ("aside", (ASIDE * z, 0))])
            + (f"[afterburn]\n{afterburn}" if afterburn else "")
            + f"[output]\npeak_fields = false\n[end]\ntime = {end}\n")


def ground_deck(cell, kind):
    """A hemisphere of 1 kg on the ground: on a wall, or as the upper half of 2 kg by symmetry."""
    charge = ('shape = "hemisphere"\nnormal = "+y"\nmass = 1\n' if kind == "wall" else "mass = 2\n")
    points = [(f"{side}{z:g}", x) for z in (1, 2, 3) for side, x in (("ground", (z, 0)), ("up", (0, z)))]
    return ('title = "1 kg of TNT on the ground"\n[domain]\ngeometry = "axisymmetric2d"\nsize = [3.6, 3.6]\n'
            f'cell = {cell}\n[boundaries]\ny_low = "{kind}"\n[[charge]]\nexplosive = "TNT"\n{charge}position = [0, 0]\n'
            + gauges_text(points) + "[output]\npeak_fields = false\n[end]\ntime = 6.5e-3\n")


def reflected(overpressure):
    """Peak overpressure on a rigid wall behind a shock of this incident overpressure [Pa]: Rankine-Hugoniot,
    gamma = 1.4."""
    return 2 * overpressure * (7 * AMBIENT + 4 * overpressure) / (7 * AMBIENT + overpressure)


def incident_rows(gauges, curves, burst, name_of):
    header = ["Z [m/kg^(1/3)]"]
    for name, unit, _, _ in QUANTITIES.values():
        header += [f"{name} [{unit}]", "K-B", "deviation"]
    rows = []
    for z in DISTANCES:
        g, row = gauges[name_of(z)], [f"{z:g}"]
        for key, (_, _, factor, empirical) in QUANTITIES.items():
            reference = curves(burst, z, empirical)
            # For a burst on the ground the charge of the run is GROUND^-3 times as large: at the same scaled distance,
            # times and impulses grow with the cube root of the mass.
            scale = 1.0 if burst == "spherical" or key == "peak_overpressure" else 1 / GROUND
            value = g[key] and g[key] * scale
            row += ["-" if value is None else f"{value * factor:.4g}", f"{reference * factor:.4g}",
                    "-" if value is None else per_cent(value / reference)]
        rows.append(row)
    return table(header, rows)


def afterburn_rows(plain, burnt, curves, key):
    empirical = QUANTITIES[key][3]
    header = ["Z [m/kg^(1/3)]", "without"] + [name for name, *_ in AFTERBURN]
    rows = []
    for z in DISTANCES:
        reference = curves("spherical", z, empirical)
        values = [plain] + [burnt[name] for name, *_ in AFTERBURN]
        rows.append([f"{z:g}"] + ["-" if v[f"z{z:g}"][key] is None else per_cent(v[f"z{z:g}"][key] / reference)
                                  for v in values])
    return table(header, rows)


def released_rows(burnt):
    rows = []
    for name, what, _ in AFTERBURN:
        log = burnt[name, "log"]
        audit = log["audit"]
        rows.append([name, what, f"{audit['afterburn_energy'] / 1e6:.2f}", f"{audit['relative_error']['energy']:.1e}"])
    return table(["column", "afterburn of 10.2 MJ/kg", "released by 32 ms [MJ]", "energy balance"], rows)


def wall_rows(walls, plain, curves):
    header = ["Z [m/kg^(1/3)]", "h [mm]", "peak on the wall [kPa]", "K-B", "deviation", "with 2 h",
              "impulse on the wall [Pa s]", "K-B", "deviation", "with 2 h", "with 2 h and afterburn 3ms",
              "peak on the axis / beside it", "peak from the incident 1D peak [kPa]", "deviation"]
    rows = []
    for z, *_ in WALLS:
        log = walls[z, "log"]
        here, rough, burnt = (w["aside"] for w in (walls[z], walls[z, "coarse"], walls[z, "burnt"]))
        peak, impulse = (curves("spherical", z * SLANT, f"reflected_{x}") for x in ("overpressure", "impulse"))
        exact = reflected(plain[f"z{z:g}"]["peak_overpressure"])
        rows.append([f"{z:g}", f"{log['domain']['cell_size'] * 1e3:g}",
                     f"{here['peak_overpressure'] / 1e3:.4g}", f"{peak / 1e3:.4g}"]
                    + [per_cent(x["peak_overpressure"] / peak) for x in (here, rough)]
                    + [f"{here['positive_impulse']:.4g}", f"{impulse:.4g}"]
                    + [per_cent(x["positive_impulse"] / impulse) for x in (here, rough, burnt)]
                    + [f"{walls[z]['wall']['peak_overpressure'] / here['peak_overpressure']:.2f}", f"{exact / 1e3:.4g}",
                       per_cent(exact / curves("spherical", z, "reflected_overpressure"))])
    return table(header, rows)


def ground_rows(ground, sphere):
    rows = []
    for z in (1, 2, 3):
        for key, (name, _, _, _) in QUANTITIES.items():
            if key == "positive_duration":
                continue
            one = sphere[f"z{z:g}"][key]
            rows.append([f"{z:g}", name] + [f"{ground[f'{side}{z:g}'][key] / one:.3f}" for side in ("ground", "up")])
    return table(["distance [m]", "quantity", "2D along the ground / 1D", "2D on the axis / 1D"], rows)


def altitude_rows(sea, high, factors):
    header = ["Z [m/kg^(1/3)] at sea level"] + [f"{name}, 3000 m / scaled" for name, *_ in QUANTITIES.values()]
    rows = [[f"{z:g}"] + ["-" if sea[f"z{z:g}"][key] is None or high[f"z{z:g}"][key] is None else
                          per_cent(high[f"z{z:g}"][key] / (sea[f"z{z:g}"][key] * factors[key]), 2)
                          for key in QUANTITIES] for z in DISTANCES]
    return table(header, rows)


def beyond(values, least=0.0):
    """Deviations in per cent, of {Z: ratio}, from a distance on: "-12.1 to +3.0"."""
    return span([100.0 * (r - 1.0) for z, r in values.items() if z >= least], "{:+.1f}")


def incident_ratios(gauges, curves, burst, name_of):
    """Values over the curves, {quantity: {Z: ratio}}, as in `incident_rows`."""
    ratios = {}
    for key, (_, _, _, empirical) in QUANTITIES.items():
        scale = 1.0 if burst == "spherical" or key == "peak_overpressure" else 1 / GROUND
        ratios[key] = {z: gauges[name_of(z)][key] * scale / curves(burst, z, empirical) for z in DISTANCES
                       if gauges[name_of(z)][key]}
    return ratios


def incident_text(ratios):
    """The deviations of `incident_ratios` in words."""
    peaks = ratios["peak_overpressure"]
    worst = max(peaks, key=lambda z: abs(peaks[z] - 1.0))
    return (f"Deviations: arrivals {beyond(ratios['arrival_time'])} %, peaks {beyond(peaks)} %, the largest at "
            f"Z = {worst:g}, from Z = {FAR:g} on {beyond(peaks, FAR)} %; impulses from Z = {FAR:g} on "
            f"{beyond(ratios['positive_impulse'], FAR)} %, "
            f"positive phases {beyond(ratios['positive_duration'], FAR)} %.")


def afterburn_text(plain, burnt, curves):
    """Effect of each release on peaks and impulses, one line each; and the deviation of the best ones."""
    lines, worst = [], {"peak_overpressure": {}, "positive_impulse": {}}
    for name, what, _ in AFTERBURN:
        ratios = incident_ratios(burnt[name], curves, "spherical", lambda z: f"z{z:g}")
        change = [100.0 * (burnt[name][f"z{z:g}"]["positive_impulse"] / plain[f"z{z:g}"]["positive_impulse"] - 1.0)
                  for z in DISTANCES if burnt[name][f"z{z:g}"]["positive_impulse"]]
        lines.append(f"- `{name}`: peaks {beyond(ratios['peak_overpressure'])} %, impulses "
                     f"{beyond(ratios['positive_impulse'])} % from the curves; impulses "
                     f"{span(change, '{:+.1f}')} % from those without afterburn.")
        for key, values in worst.items():
            values[name] = max(abs(r - 1.0) for r in ratios[key].values())
    best = listed(f"{100 * min(values.values()):.0f} % ({QUANTITIES[key][0]}, `{min(values, key=values.get)}`)"
                  for key, values in worst.items())
    return "\n".join(lines), best


def wall_texts(walls, plain, curves):
    """Values of the text on reflection."""
    def rise(key):
        return span([100.0 * (walls[z]["aside"][key] / walls[z, "coarse"]["aside"][key] - 1.0) for z, *_ in WALLS],
                    "{:+.1f}")
    by_reflection = {z: reflected(plain[f"z{z:g}"]["peak_overpressure"])
                     / curves("spherical", z, "reflected_overpressure") for z, *_ in WALLS}
    impulses = {z: walls[z]["aside"]["positive_impulse"] / curves("spherical", z * SLANT, "reflected_impulse")
                for z, *_ in WALLS}
    near = WALLS[0][0]
    incident, curve = (curves("spherical", near, f"{kind}_overpressure") for kind in ("incident", "reflected"))
    return {"axis": span([walls[z]["wall"]["peak_overpressure"] / walls[z]["aside"]["peak_overpressure"]
                          for z, *_ in WALLS], "{:.2f}"),
            "halved": rise("peak_overpressure"), "impulse_halved": rise("positive_impulse"),
            "by_reflection": beyond(by_reflection), "wall_impulses": beyond(impulses), "nearest": f"{near:g}",
            "strength": f"{curve / AMBIENT:.0f}", "own_incident": f"{1e-3 * incident:.0f}",
            "own_reflected": f"{1e-6 * reflected(incident):.1f}", "curve_reflected": f"{1e-6 * curve:.1f}"}


def altitude_text(sea, high, factors):
    """Deviations of scaled values near the charge and beyond. `factors`: by quantity."""
    parts = []
    for key, (name, _, _, _) in QUANTITIES.items():
        ratios = {z: high[f"z{z:g}"][key] / (sea[f"z{z:g}"][key] * factors[key]) for z in DISTANCES
                  if high[f"z{z:g}"][key] and sea[f"z{z:g}"][key]}
        parts.append(f"{name} {beyond(ratios)} %, from Z = {FAR:g} on {beyond(ratios, FAR)} %")
    return f"Deviations from it: {'; '.join(parts)}."


def ground_check_text(ground, sphere):
    """The largest deviations of 2D from 1D by quantity."""
    def largest(key):
        return 100 * max(abs(ground[f"{side}{z:g}"][key] / sphere[f"z{z:g}"][key] - 1.0)
                         for z in (1, 2, 3) for side in ("ground", "up"))
    return listed(f"{largest(key):.1f} % ({name})" for key, (name, *_) in QUANTITIES.items()
                  if key != "positive_duration")


def axes_of_curves(a, title, label):
    style(a)
    a.set_xscale("log")
    a.set_title(title)
    a.set_xlabel(label)
    a.set_xticks([0.5, 1, 2, 5, 10])
    a.xaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    a.xaxis.set_minor_formatter(NullFormatter())


def plot(plain, burnt, ground_plain, walls, curves, path):
    matplotlib.rcParams.update(RC)
    figure, axes = plt.subplots(2, 3, figsize=(11.2, 7.2), layout="constrained")
    label = "scaled distance Z [m/kg$^{1/3}$]"
    shades = [COLOURS[3], COLOURS[2], COLOURS[1], MUTED, ORANGE]
    z = np.array(DISTANCES)
    for a, key in zip(axes[0], ("peak_overpressure", "arrival_time", "positive_impulse")):
        name, _, _, empirical = QUANTITIES[key]
        axes_of_curves(a, f"{name[0].upper() + name[1:]}, free air / K-B", label)
        reference = np.array([curves("spherical", d, empirical) for d in DISTANCES])
        a.axhline(1.0, color=ORANGE, linewidth=1.6)
        a.plot(z, [plain[f"z{d:g}"][key] for d in DISTANCES] / reference, "o-", color=INK, markersize=4,
               linewidth=1.4, label="without afterburn")
        for (variant, *_), colour in zip(AFTERBURN, shades):
            values = [burnt[variant][f"z{d:g}"][key] or np.nan for d in DISTANCES]
            a.plot(z, values / reference, color=colour, linewidth=1.2, label=f"afterburn {variant}",
                   linestyle="--" if variant == "quarter" else "-")
    axes[0][2].legend(loc="upper right", fontsize=7)

    a = axes[1][0]
    axes_of_curves(a, "On the ground (2 kg in free air) / K-B hemisphere", label)
    a.axhline(1.0, color=ORANGE, linewidth=1.6)
    for (key, (name, _, _, empirical)), colour in zip(list(QUANTITIES.items())[:3], (INK, COLOURS[1], COLOURS[2])):
        scale = 1.0 if key == "peak_overpressure" else 1 / GROUND
        ratio = [ground_plain[f"g{d:g}"][key] * scale / curves("hemispherical", d, empirical) for d in DISTANCES]
        a.plot(z, ratio, "o-", color=colour, markersize=4, linewidth=1.2, label=name)
    a.legend(fontsize=7)

    fine = np.geomspace(0.45, 6, 40)
    for a, what, unit, factor in ((axes[1][1], "overpressure", "kPa", 1e-3), (axes[1][2], "impulse", "Pa s", 1.0)):
        axes_of_curves(a, f"Reflected {what} [{unit}]", label)
        a.set_yscale("log")
        a.set_xticks([0.5, 1, 2, 5])
        a.plot(fine, [curves("spherical", d, f"reflected_{what}") * factor for d in fine], color=ORANGE, linewidth=1.6,
               label="Kingery-Bulmash")
        key = "peak_overpressure" if what == "overpressure" else "positive_impulse"
        places = [w[0] for w in WALLS]
        a.plot(places, [walls[d]["aside"][key] * factor for d in places], "o", color=INK, markersize=5,
               label="on the wall, 2D")
        if what == "overpressure":
            near = [d for d in DISTANCES if d <= 5]
            a.plot(near, [reflected(plain[f"z{d:g}"]["peak_overpressure"]) * factor for d in near], "-",
                   color=COLOURS[2], linewidth=1.2, label="from the 1D incident peak")
        else:
            a.plot(places, [walls[d, "burnt"]["aside"][key] * factor for d in places], "s", color=COLOURS[1],
                   markersize=5, label="on the wall, 2D, afterburn 3ms")
        a.legend(fontsize=7)
    figure.savefig(path, dpi=120, facecolor="white")
    plt.close(figure)


def validate(arguments, work):
    run = Variants(arguments, work)
    curves = Curves(arguments.brisance)
    coarse = 4e-3 if arguments.quick else 1e-3
    points = [(f"z{z:g}", (z,)) for z in DISTANCES] + [(f"g{z:g}", (z * GROUND,)) for z in DISTANCES]
    plain = run("kb", "free-air", text=free_air_deck(coarse, points)).gauges
    burnt = {}
    for name, _, lines in AFTERBURN:
        result = run("kb", f"afterburn-{name}", text=free_air_deck(coarse, points, lines))
        burnt[name], burnt[name, "log"] = result.gauges, result.log
    walls = {}
    factor = 2.0 if arguments.quick else 1.0
    for z, size, cell, end in WALLS:
        result = run("kb", f"wall-{z:g}", text=wall_deck(z, size, cell * factor, end))
        walls[z], walls[z, "log"] = result.gauges, result.log
        # With afterburn on a grid twice as coarse, and without it on the same grid.
        for name, lines in (("coarse", ""), ("burnt", AFTERBURN[1][2])):
            folder = f"wall-{z:g}-{'afterburn' if lines else name}"
            walls[z, name] = run("kb", folder, text=wall_deck(z, size, 2.0 * cell * factor, end, lines)).gauges
    ground = run("kb", "ground-wall", text=ground_deck(0.01 * factor, "wall"))
    mirror = run("kb", "ground-symmetry", text=ground_deck(0.01 * factor, "symmetry"))
    same = all(np.array_equal(values, mirror.gauge(name)[column])
               for name in ground.gauges for column, values in ground.gauge(name).items())
    sphere = run("kb", "sphere-2kg", text=free_air_deck(coarse, [(f"z{z:g}", (z,)) for z in (1, 2, 3)], mass=2.0,
                                                        size=5, end=6.5e-3)).gauges
    at_sea = json.loads(subprocess.run([str(arguments.brisance), "kb", "--charge", "1", "--distance", "1", "--burst",
                                        "spherical", "--altitude", f"{ALTITUDE} m", "--json"], check=True,
                                       capture_output=True, text=True).stdout)
    pressure = at_sea["ambient_pressure"] / AMBIENT
    sound = np.sqrt(pressure / (at_sea["ambient_density"] / 1.225))
    length = pressure ** (-1 / 3)
    high = run("kb", "altitude", text=free_air_deck(
        coarse, [(f"z{z:g}", (z * length,)) for z in DISTANCES], ambient=f"[ambient]\naltitude = {ALTITUDE}\n", size=16,
        end=38e-3)).gauges

    target = work if arguments.quick else ROOT / "docs" / "validation"
    plot(plain, burnt, plain, walls, curves, target / "kingery_bulmash.png")
    charge = ground.log["charges"][0], mirror.log["charges"][0]
    time = length / sound
    factors = {"peak_overpressure": pressure, "arrival_time": time, "positive_impulse": pressure * time,
               "positive_duration": time}
    rates, best = afterburn_text(plain, burnt, curves)
    values = {
        "command": "validation/run kingery_bulmash" + (" --quick" if arguments.quick else ""),
        "commit": arguments.commit or commit(), "machine": machine(), "minutes": f"{run.seconds / 60:.0f}",
        "cell": f"{coarse * 1e3:g}", "free_air": incident_rows(plain, curves, "spherical", lambda z: f"z{z:g}"),
        "ground": incident_rows(plain, curves, "hemispherical", lambda z: f"g{z:g}"),
        "afterburn": released_rows(burnt), "peaks": afterburn_rows(plain, burnt, curves, "peak_overpressure"),
        "impulses": afterburn_rows(plain, burnt, curves, "positive_impulse"),
        "arrivals": afterburn_rows(plain, burnt, curves, "arrival_time"),
        "walls": wall_rows(walls, plain, curves), "ground_check": ground_rows(ground.gauges, sphere),
        "same": "the same to the last digit" if same else "NOT the same",
        "masses": "{:.12g} kg on the wall, {:.12g} kg with its image".format(*(c["realised_mass"] for c in charge)),
        "altitude": altitude_rows(plain, high, factors), "altitude_text": altitude_text(plain, high, factors),
        "free_air_text": incident_text(incident_ratios(plain, curves, "spherical", lambda z: f"z{z:g}")),
        "ground_text": incident_text(incident_ratios(plain, curves, "hemispherical", lambda z: f"g{z:g}")),
        "ground_cell": f"{1e3 * ground.cell_size:g}", "ground_check_text": ground_check_text(ground.gauges, sphere),
        "afterburn_text": rates, "best_rates": best, **wall_texts(walls, plain, curves),
        "thin_air": f"{at_sea['ambient_pressure'] / 1e3:.3f} kPa, {at_sea['ambient_density']:.4f} kg/m³",
        "factors": f"pressures {pressure:.4f}, distances {length:.4f}, times {time:.4f}",
    }
    template = (ROOT / "validation" / "kingery_bulmash.md.in").read_text()
    text = re.sub(r"@(\w+)@", lambda match: values[match.group(1)].rstrip("\n"), template)
    (target / "kingery_bulmash.md").write_text(text)
    print(f"wrote {target / 'kingery_bulmash.md'} and kingery_bulmash.png; results of the runs: {work}")
