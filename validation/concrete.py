"""Concrete and soil: single points, calibration of the tensile damage, spall, a crater on four grids, a column of soil,
a beam with bars, a slab on soil, a charge in soil."""
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from common import COLOURS, INK, MUTED, ORANGE, RC, ROOT, listed, style, table

STATIC = {"concrete-48MPa": 4.0e6, "concrete-25MPa": 3.1e6}  # quasi-static tensile strength [Pa]
YIELD = 500e6  # of bars, the default of the program [Pa]
FILES = {"concrete-48MPa": "concrete_48mpa", "concrete-25MPa": "concrete_25mpa"}


def increase(rate, fc):
    """Dynamic increase factor of the tensile strength, [Malvar98], of fc [Pa]."""
    delta = 1.0 / (1.0 + 8.0 * fc / 10e6)
    beta = 10.0 ** (6.0 * delta - 2.0)
    return np.where(rate <= 1.0, (rate / 1e-6) ** delta, beta * np.cbrt(rate / 1e-6))


def material(name):
    return tomllib.loads((ROOT / "materials" / f"{FILES[name]}.toml").read_text())


def curves(run):
    """The output of `concrete_curves`: {(path, material): (x, y)}."""
    program = Path(run.program).parent / "concrete_curves"
    if not program.exists():
        sys.exit(f"{program} does not exist; build it: scripts/build release concrete_curves")
    out = {}
    for line in subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout.splitlines()[1:]:
        path, name, x, y = line.split(",")
        out.setdefault((path, name), []).append((float(x), float(y)))
    return {key: np.array(rows).T for key, rows in out.items()}


def paths(run):
    """Stress paths of single points."""
    data = curves(run)
    with plt.rc_context(RC):
        figure, axes = plt.subplots(1, 3, figsize=(10.5, 3.2))
        name = "concrete-48MPa"
        for colour, rate in zip(COLOURS[1:], ("1", "100", "10000")):
            x, y = data[(f"uniaxial {rate} /s", name)]
            axes[0].plot(100 * x, y * 1e-6, color=colour, label=f"{float(rate):g} /s")
        for colour, confinement in zip(COLOURS, ("10", "50", "200", "1500")):
            x, y = data[(f"triaxial {confinement} MPa", name)]
            axes[1].plot(100 * x, y * 1e-6, color=colour, label=f"{confinement} MPa")
        axes[1].axhline(336, color=ORANGE, linewidth=0.8)
        axes[1].text(6, 342, "S_max fc", color=ORANGE, fontsize=7.5)
        x, y = data[("hydrostat", name)]
        axes[2].plot(x, y * 1e-9, color=COLOURS[3])
        for axis, title, across, up in zip(
                axes, ("Uniaxial compression", "Triaxial compression", "Hydrostatic, unloaded twice"),
                ("strain [%]", "strain under load [%]", "mu = rho / rho0 - 1"),
                ("stress [MPa]", "Mises stress [MPa]", "pressure [GPa]")):
            axis.set(title=title, xlabel=across, ylabel=up)
            style(axis)
        axes[0].legend()
        axes[1].legend(title="confinement")
        figure.tight_layout()
        fc = material(name)["strength"]["fc"]
        most = data[("uniaxial 1 /s", name)][1].max()
    return {"uniaxial": f"{most / fc:.1f} f'c, {1e-6 * most:.0f} MPa"}, {"concrete_paths": figure}


def uniaxial_strength(rate, file, a, sigma0, gamma):
    """Strength [Pa] at constant strain rates [1/s] by Eq. (58) alone: elastic until the softening meets the stress."""
    hjc, law, eos = file["strength"], file["failure"], file["eos"]
    bulk = eos["P_crush"] / eos["mu_crush"]
    young = 9.0 * bulk * hjc["G"] / (3.0 * bulk + hjc["G"])
    factor = 1.0 + hjc["C"] * np.log(np.maximum(1.0, rate))
    cap = 1.0 / (1.0 / (hjc["A"] * hjc["fc"] * factor) + 1.0 / (3.0 * law["T_max"]))
    odds = np.full_like(rate, np.log(law["seed"] / (1.0 - law["seed"])))
    strength, steps = np.zeros_like(rate), 2000
    step = cap / steps
    for k in range(1, steps + 1):
        damage = 1.0 / (1.0 + np.exp(-odds))
        excess = np.maximum((k - 0.5) * step / ((1.0 - damage) * sigma0) - 1.0, 0.0)
        odds = np.minimum(odds + a * excess ** gamma * step / (young * rate), 30.0)
        meets = (strength == 0.0) & (k * step >= cap * (1.0 - 1.0 / (1.0 + np.exp(-odds))))
        strength[meets] = (k * step)[meets]
    return strength


def fit(file, static, limit):
    """a, sigma0, gamma by least squares of the logarithm of the strength up to a rate: a simplex [NelderMead65]."""
    rate = 10.0 ** np.arange(-6.0, np.log10(limit) + 1e-9, 0.2)
    asked = np.log(static * increase(rate, file["strength"]["fc"]))

    def miss(p):
        if not 0.3 < p[2] < 4.0:
            return 1e9
        return np.sum((np.log(uniaxial_strength(rate, file, np.exp(p[0]), p[1] * static, p[2])) - asked) ** 2)
    corners = [np.array(p) for p in ((11.0, 1.1, 1.2), (12.0, 1.1, 1.2), (11.0, 1.3, 1.2), (11.0, 1.1, 1.8))]
    values = [miss(p) for p in corners]
    for _ in range(120):
        order = np.argsort(values)
        corners, values = [corners[i] for i in order], [values[i] for i in order]
        middle = np.mean(corners[:-1], axis=0)
        tries = [middle + k * (middle - corners[-1]) for k in (1.0, 2.0, -0.5)]
        best = min(tries, key=miss)
        if miss(best) < values[-1]:
            corners[-1], values[-1] = best, miss(best)
        else:
            corners = [corners[0]] + [0.5 * (p + corners[0]) for p in corners[1:]]
            values = [miss(p) for p in corners]
    best = corners[int(np.argmin(values))]
    return np.exp(best[0]), best[1] * static, best[2]


def calibration(run):
    """Strength at constant strain rates, compared with the curve to which a, sigma0 and gamma are fitted."""
    data = curves(run)
    rows = []
    with plt.rc_context(RC):
        figure, axes = plt.subplots(1, 2, figsize=(8.6, 3.4), sharey=True)
        for axis, (name, static) in zip(axes, STATIC.items()):
            file = material(name)
            fc = file["strength"]["fc"]
            rate, strength = data[("tension", name)]
            factor, asked = strength / static, increase(rate, fc)
            axis.loglog(rate, asked, color=INK, linewidth=1.0, label="[Malvar98]")
            axis.loglog(rate, factor, "o", color=ORANGE, markersize=3.5, label="computed")
            axis.set(title=name, xlabel="strain rate [1/s]", ylabel="strength / quasi-static")
            style(axis)
            axis.legend()
            limit = 200.0 if fc > 40e6 else 31.7
            fitted = rate <= limit
            error = factor / asked - 1.0
            damage = file["failure"]
            worst = np.argmax(np.abs(error[fitted]))
            a, sigma0, gamma = fit(file, static, limit)
            rows.append([name, f"{static * 1e-6:g}", f"{damage['a']:.4g} ({a:.3g})",
                         f"{damage['sigma0'] * 1e-6:g} ({sigma0 * 1e-6:.3g})", f"{damage['gamma']:g} ({gamma:.3g})",
                         f"{limit:.0f}",
                         f"{100 * np.sqrt(np.mean(error[fitted] ** 2)):.0f} %",
                         f"{100 * error[fitted][worst]:+.0f} % at {rate[fitted][worst]:.2g} /s",
                         f"{factor[-1]:.1f} ({asked[-1]:.1f})"])
        figure.tight_layout()
    header = ["material", "quasi-static MPa", "a 1/s", "sigma0 MPa", "gamma", "fitted to /s", "deviation rms", "worst",
              "factor at 178 /s (curve)"]
    hjc, name = material("concrete-25MPa")["strength"], "concrete-25MPa"
    cohesion = hjc["A"] * hjc["fc"]
    cohesive = f"{1e-6 * cohesion:.2f} MPa, {cohesion / STATIC[name]:.1f} times the quasi-static strength"
    return {"rates": table(header, rows), "cohesive": cohesive}, {"concrete_rates": figure}


def pull_back(gauge, after, speed, density, noise=0.03):
    """The first fall of the free face's speed after a time [s]: (peak, least [m/s], time of it, stress [Pa], strain
    rate [1/s]); stress = rho c du / 2, rate = du / (2 c dt) between a tenth and nine tenths of the fall."""
    t, u = gauge["time"], gauge["velocity_x"]
    k = np.searchsorted(t, after)
    peak = np.median(u[max(k - 40, 0):k]) if noise > 0.05 else u[:k].max()
    low, at = u[k], k
    for j in range(k, len(t)):
        if u[j] < low:
            low, at = u[j], j
        elif u[j] > low + noise * peak:
            break
    fall = peak - low
    first = k + np.argmax(u[k:at + 1] < peak - 0.1 * fall)
    last = k + np.argmax(u[k:at + 1] < peak - 0.9 * fall)
    return peak, low, t[at], 0.5 * density * speed * fall, 0.8 * fall / (2.0 * speed * max(t[last] - t[first], 1e-9))


def sound_speed(name):
    file = material(name)
    eos, strength = file["eos"], file["strength"]
    return np.sqrt((eos["P_crush"] / eos["mu_crush"] + 4.0 / 3.0 * strength["G"]) / file["density"])


def impact(run):
    """Plate impact at two velocities: pull-back strength and its rate, with and without the crack band."""
    name = "concrete-48MPa"
    speed, density = sound_speed(name), material(name)["density"]
    rows = []
    with plt.rc_context(RC):
        figure, axis = plt.subplots(figsize=(6.4, 3.2))
        for velocity, colour in ((4.0, COLOURS[1]), (8.0, COLOURS[3])):
            for law, dashes in (("none", "-"), ("crack_band", "--")):
                result = run("plate_impact_1d", f"{velocity:g}-{law}",
                             {"velocity": f"=[{velocity:g}]", "points.regularisation": law})
                gauge = result.gauge("face")
                axis.plot(1e6 * gauge["time"], gauge["velocity_x"], dashes, color=colour,
                          label=f"{velocity:g} m/s" + (", crack band" if law == "crack_band" else ""))
                if law != "none":
                    continue
                _, _, _, stress, rate = pull_back(gauge, 230e-6, speed, density, 0.1)
                rows.append([f"{velocity:g}", f"{0.5 * density * speed * velocity * 1e-6:.1f}", f"{rate:.0f}",
                             f"{stress * 1e-6:.1f}", f"{stress / STATIC[name]:.2f}",
                             f"{float(increase(rate, 48e6)):.2f}",
                             f"{100 * result.log['points']['audit']['energy']['drift']:+.2f} %"])
        axis.set(xlabel="time [us]", ylabel="speed of the free face [m/s]", xlim=(80, 400))
        style(axis)
        axis.legend()
        figure.tight_layout()
    header = ["impact m/s", "elastic stress MPa", "rate 1/s", "pull-back strength MPa", "over quasi-static",
              "[Malvar98] at this rate", "energy drift"]
    return {"impact": table(header, rows)}, {"concrete_impact": figure}


def spall_estimate(pulse, law, speed, cap):
    """Distance [m] from the free face where the softening first reaches the stress of the reflected elastic pulse, with
    the rate law integrated along the wave: the incident pulse(t - x/c) less its mirror image pulse(t + x/c)."""
    x = np.arange(0.5e-3, 0.25, 0.5e-3)
    odds = np.full_like(x, np.log(law["seed"] / (1.0 - law["seed"])))
    step = 2e-8
    for k in range(10000):
        t = k * step
        stress = pulse(t - x / speed) - pulse(t + x / speed)
        damage = 1.0 / (1.0 + np.exp(-odds))
        excess = np.maximum(stress / ((1.0 - damage) * law["sigma0"]) - 1.0, 0.0)
        odds = np.minimum(odds + law["a"] * excess ** law["gamma"] * step, 30.0)
        hit = (stress > 0.0) & (stress >= cap * (1.0 - 1.0 / (1.0 + np.exp(-odds))))
        if hit.any():
            return x[hit].mean()
    return np.nan


def first_cracked(result, end):
    """Distances [m] from the end of the bar of the particles in its farther half that cracked first."""
    for dump in result.point_dumps:
        dump = dump.read()
        x = end - (dump["position"][:, 0] - dump["displacement"][:, 0])
        cracked = (dump["tensile_damage"] >= 1.0) & (x < 0.5 * end)
        if cracked.any():
            return x[cracked]
    return np.array([np.nan])


def bar(run):
    """Position of the spall plane against elastic waves."""
    name = "concrete-48MPa"
    file = material(name)
    speed, density, law, hjc = sound_speed(name), file["density"], file["failure"], file["strength"]
    nu_factor = 3.0 * file["eos"]["P_crush"] / file["eos"]["mu_crush"]
    nu = (nu_factor - 2.0 * hjc["G"]) / (2.0 * (nu_factor + hjc["G"]))
    # Largest uniaxial-strain tension of undamaged concrete, q / (A fc) + p / T_max = 1.
    cap = 1.0 / ((1.0 - 2.0 * nu) / (1.0 - nu) / (hjc["A"] * hjc["fc"])
                 + (1.0 + nu) / (3.0 * (1.0 - nu)) / law["T_max"])
    rows = []
    duration = 60e-6
    with plt.rc_context(RC):
        figure, axes = plt.subplots(1, 2, figsize=(9.0, 3.2))
        for peak, colour in zip((12e6, 16e6, 24e6), COLOURS[1:]):
            def pulse(t, peak=peak):
                return np.where((t < 0.0) | (t > duration), 0.0, peak * (1.0 - t / duration))
            estimate = spall_estimate(pulse, law, speed, cap)
            result = run("spall_bar_1d", f"{peak * 1e-6:g}", {
                "history": f'={{times = [0, "60 us"], pressures = ["{peak * 1e-6:g} MPa", 0]}}'})
            banded = run("spall_bar_1d", f"{peak * 1e-6:g}-band", {
                "history": f'={{times = [0, "60 us"], pressures = ["{peak * 1e-6:g} MPa", 0]}}',
                "points.regularisation": "crack_band"})
            plane, wide = first_cracked(result, 0.5), first_cracked(banded, 0.5)
            gauge = result.gauge("face")
            _, _, _, stress, _ = pull_back(gauge, 143e-6, speed, density)
            classical = stress / peak * 0.5 * duration * speed
            rows.append([f"{peak * 1e-6:g}", f"{1e3 * plane.mean():.1f}", f"{1e3 * estimate:.1f}",
                         f"{100 * (plane.mean() / estimate - 1):+.1f} %", f"{stress * 1e-6:.1f}",
                         f"{1e3 * classical:.1f}", f"{100 * (plane.mean() / classical - 1):+.1f} %",
                         f"{1e3 * wide.mean():.1f}",
                         f"{100 * result.log['points']['audit']['energy']['drift']:+.2f} %"])
            axes[0].plot(1e6 * gauge["time"], gauge["velocity_x"], color=colour, label=f"{peak * 1e-6:g} MPa")
            dump = result.point_dumps[-1].read()
            x = dump["position"][:, 0] - dump["displacement"][:, 0]
            order = np.argsort(x)
            axes[1].plot(1e3 * (0.5 - x[order]), dump["tensile_damage"][order], color=colour)
            axes[1].axvline(1e3 * estimate, color=colour, linestyle=":")
        axes[0].set(title="Free face", xlabel="time [us]", ylabel="speed [m/s]", xlim=(120, 250))
        axes[1].set(title="Tensile damage at the end", xlabel="distance from the free face [mm]", ylabel="D_t",
                    xlim=(0, 160))
        axes[0].legend()
        for axis in axes:
            style(axis)
        figure.tight_layout()
    header = ["pulse MPa", "first cracked at mm", "waves and rate law mm", "deviation", "pull-back strength MPa",
              "classical mm", "deviation", "with crack band mm", "energy drift"]
    return {"bar": table(header, rows)}, {"concrete_bar": figure}


def growth(origin, moved, spacing, radius, height):
    """Growth of a cylinder on the axis and sinking of its upper face [m3], from its outermost particles' motion."""
    def ring(points, component):
        return (2.0 * np.pi * origin[points, 0] * spacing * moved[points, component]).sum()
    top, bottom = origin[:, 1] > height - spacing, origin[:, 1] < spacing
    side = origin[:, 0] > radius - spacing
    sunk = -ring(top, 1)
    return 2.0 * np.pi * radius * spacing * moved[side, 0].sum() - ring(bottom, 1) - sunk, sunk


def crater_text(changes):
    """Values of the text on the changes between grids, (grids, relative change of every value of the table), and on the
    openings of the crack band."""
    law = material("concrete-25MPa")["failure"]
    scale = law["fracture_energy"] / law["sigma0"]  # [m]
    opening = {d: -np.log(1.0 - d) * scale for d in (0.5, 0.75, 0.99)}

    def largest(chosen):
        return listed(f"{100 * np.abs(values[chosen]).max():.1f} % from {grids}" for grids, values in changes)
    return {"crater_damage": largest(slice(0, 4)), "crater_faces": largest(slice(5, 7)), "w_c": f"{1e6 * scale:.0f}",
            "w_half": f"{1e6 * opening[0.5]:.0f}", "w_three": f"{1e6 * opening[0.75]:.0f}",
            "w_one": f"{1e6 * opening[0.99]:.0f}", "strain_coarse": f"{100 * opening[0.99] / 10e-3:.1f}",
            "strain_fine": f"{100 * opening[0.99] / 2.5e-3:.1f}"}


def crater(run):
    """The crater on four grids with the crack band, on three without."""
    cells = {"crack_band": (10.0, 5.0, 2.5, 1.25), "none": (10.0, 5.0, 2.5)}
    rows, last, changes = [], {}, []
    for law in cells:
        values = {}
        for cell in cells[law]:
            result = run("concrete_crater_2d", f"{cell:g}-{law}",
                         {"domain.cell": f"{cell:g} mm", "points.regularisation": law})
            zones = result.log["points"]["broken_zones"][0]
            dump = result.point_dumps[-1].read()
            origin, spacing = dump["position"] - dump["displacement"], 0.5 * result.cell_size
            volume = 2.0 * np.pi * origin[:, 0] * spacing ** 2
            top = (origin[:, 1] > 0.3 - spacing) & (dump["damage"] >= 0.5)
            grown, sunk = growth(origin, dump["displacement"], spacing, 0.4, 0.3)
            drift = result.log["points"]["audit"]["energy"]["drift"]
            values[cell] = (1e6 * zones["damaged"]["volume"], 1e6 * volume[dump["damage"] >= 0.75].sum(),
                            2e3 * np.sqrt(volume[top].sum() / spacing / np.pi), 1e6 * (volume * dump["damage"]).sum(),
                            1e6 * (volume * dump["compression_damage"]).sum(), 1e6 * grown, 1e6 * sunk,
                            1e6 * (zones["cracked"]["volume"] + zones["crushed"]["volume"]))
            rows.append([law, f"{cell:g}"] + [f"{v:.{n}f}" for v, n in zip(values[cell], (0, 0, 0, 0, 1, 2, 2, 0))]
                        + [f"{100 * drift:+.2f} %"])
            last[law, cell] = (origin, dump)
        for middle, fine in zip(cells[law][1:], cells[law][2:]):
            if law == "crack_band":
                changes.append((f"{middle:g} to {fine:g} mm", np.array(values[fine]) / values[middle] - 1.0))
            rows.append([law, f"change {middle:g} to {fine:g}"]
                        + [f"{100 * (b / a - 1):+.1f} %" for a, b in zip(values[middle], values[fine])] + [""])
    with plt.rc_context(RC):
        figure, axes = plt.subplots(2, 4, figsize=(12.5, 4.8), sharex=True, sharey=True)
        for row, law in zip(axes, cells):
            for axis, cell in zip(row, cells[law]):
                origin, dump = last[law, cell]
                marks = axis.scatter(1e3 * origin[:, 0], 1e3 * origin[:, 1], c=dump["damage"], s=(0.27 * cell) ** 2,
                                     cmap="inferno_r", vmin=0, vmax=1, linewidths=0)
                axis.set(title=f"{law}, {cell:g} mm", aspect="equal", xlim=(0, 330), ylim=(60, 305))
        axes[1, 3].set_axis_off()
        for axis in (*axes[1, :3], axes[0, 3]):
            axis.set_xlabel("radius [mm]")
            axis.tick_params(labelbottom=True)
        for axis in axes[:, 0]:
            axis.set_ylabel("height [mm]")
        figure.tight_layout()
        figure.colorbar(marks, ax=axes, label="damage", shrink=0.7)
    header = ["regularisation", "cell mm", "volume with D >= 1/2 cm3", "with D >= 3/4 cm3", "diameter on the face mm",
              "integral of D cm3", "integral of D_c cm3", "growth of the block cm3", "face sunk in cm3",
              "volume with D = 1 cm3", "energy drift"]
    return {"crater": table(header, rows), **crater_text(changes)}, {"concrete_crater": figure}


def without_table(text, name):
    """A deck without its tables [[name]]."""
    return re.sub(rf"^\[\[{name}\]\][^\n]*\n(?:(?!\[)[^\n]*\n)*", "", text, flags=re.MULTILINE)


def cracked_section(file, width, depth, area):
    """Bending stiffness [N m2] and lever arm [m] of a cracked section, linear in compression; bars of 200 GPa."""
    hjc, eos = file["strength"], file["eos"]
    bulk = eos["P_crush"] / eos["mu_crush"]
    share = area / (width * depth) * 200e9 * (3.0 * bulk + hjc["G"]) / (9.0 * bulk * hjc["G"])
    neutral = depth * (np.sqrt(share ** 2 + 2.0 * share) - share)
    lever = depth - neutral / 3.0
    return 200e9 * area * (depth - neutral) * lever, lever


def beam(run):
    """A beam under a pressure pulse with and without bars."""
    deck = (ROOT / "cases" / "reinforced_beam_3d" / "deck.toml").read_text()
    rows, told = [], []
    with plt.rc_context(RC):
        figure, axes = plt.subplots(1, 3, figsize=(11.0, 3.0))
        for bars, colour in ((True, COLOURS[3]), (False, ORANGE)):
            name = "with bars" if bars else "without"
            result = run("reinforced_beam_3d", "bars" if bars else "plain",
                         text=None if bars else without_table(deck, "reinforcement"))
            gauge = result.gauge("middle")
            low = np.argmin(gauge["displacement_z"])
            zones = result.log["points"]["broken_zones"][0]
            stress = estimate = "-"
            axes[0].plot(1e3 * gauge["time"], -1e3 * gauge["displacement_z"], color=colour, label=name)
            if bars:
                stiffness, lever = cracked_section(material("concrete-48MPa"), 0.04, 0.06, np.pi * 0.004 ** 2)
                time, mean, most = [], [], []
                for dump in result.point_dumps:
                    dump = dump.read()
                    x = dump["position"][:, 0] - dump["displacement"][:, 0]
                    steel = (dump["bar_fraction"] > 0.0) & (x < 0.05)
                    time.append(dump["time"])
                    mean.append(dump["bar_stress"][steel].mean())
                    most.append(dump["bar_stress"][dump["bar_fraction"] > 0.0].max())
                    if abs(dump["time"] - 2e-3) < 1e-6:
                        axis = axes[2]
                        marks = axis.scatter(*(1e3 * dump["position"][:, ::2].T), c=dump["damage"], s=3,
                                             cmap="inferno_r", vmin=0, vmax=1, linewidths=0)
                        axis.set(title="Damage with bars, 2 ms", xlabel="from the middle [mm]", ylabel="height [mm]",
                                 aspect="equal")
                        figure.colorbar(marks, ax=axis, shrink=0.8)
                axes[1].plot(1e3 * np.array(time), 1e-6 * np.array(mean), color=colour, label="mean within 50 mm")
                axes[1].plot(1e3 * np.array(time), 1e-6 * np.array(most), "--", color=colour, label="largest")
                axes[1].axhline(1e-6 * YIELD, color=MUTED, linewidth=0.8)
                axes[1].text(0.05, 1e-6 * YIELD + 5, "yield", color=MUTED, fontsize=7.5)
                # Simply supported over 2 x 0.38 m, evenly loaded.
                moment = 9.6 * stiffness * -gauge["displacement_z"][low] / 0.76 ** 2
                stress = f"{max(mean) * 1e-6:.0f} ({max(most) * 1e-6:.0f})"
                estimate = f"{moment / (np.pi * 0.004 ** 2 * lever) * 1e-6:.0f}"
                state = "stay elastic" if max(most) < 0.999 * YIELD else "yield"
                told.append(f"With bars, which {state}, the deflection is largest at {1e3 * gauge['time'][low]:.1f} ms")
            else:
                still = "still grows" if low > 0.99 * len(gauge["time"]) else "comes back"
                told.append(f"without them it {still} when the run ends")
            rows.append([name, f"{-1e3 * gauge['displacement_z'][low]:.2f}"
                         + (" and moving" if low > 0.99 * len(gauge["time"]) else ""),
                         f"{1e3 * gauge['time'][low]:.2f}", stress, estimate, f"{1e3 * zones['cracked']['volume']:.2f}",
                         f"{100 * result.log['points']['audit']['energy']['drift']:+.2f} %"])
        axes[0].set(title="Deflection of the middle", xlabel="time [ms]", ylabel="[mm]")
        axes[1].set(title="Stress of the bars", xlabel="time [ms]", ylabel="[MPa]")
        for axis in axes[:2]:
            style(axis)
            axis.legend()
        figure.tight_layout()
    header = ["beam", "largest deflection mm", "at ms", "bar stress MPa: mean in the middle (largest)",
              "of a cracked section at this deflection", "cracked of 1.28 l", "energy drift"]
    return {"beam": table(header, rows), "beam_text": "; ".join(told) + "."}, {"concrete_beam": figure}


def ground(run):
    """A slab under a pressure pulse, on soil and free."""
    deck = (ROOT / "cases" / "slab_on_soil_2d" / "deck.toml").read_text()
    soil = re.compile(r"^\[\[\w+\]\][^\n]*\n(?:(?!\[)[^\n]*\n)*?name = \"soil\"\n(?:(?!\[)[^\n]*\n)*",
                      re.MULTILINE)  # body and gauge
    rows, shots = [], []
    with plt.rc_context(RC):
        figure, axes = plt.subplots(1, 3, figsize=(11.0, 3.0))
        for name, text, colour in (("on soil", None, COLOURS[3]), ("free", soil.sub("", deck), ORANGE)):
            result = run("slab_on_soil_2d", name.replace(" ", "_"), text=text)
            below = result.gauge("slab.below")
            axes[0].plot(1e3 * below["time"], -1e3 * below["displacement_y"], color=colour, label=name)
            zones = result.log["points"]["broken_zones"][0]
            energy = result.log["points"]["audit"]["energy"]
            pushed = f"{result.gauge('soil')['pressure'].max() * 1e-6:.2f}" if text is None else "-"
            rows.append([name, f"{-1e3 * below['displacement_y'].min():.2f}", pushed,
                         f"{1e3 * zones['cracked']['volume']:.1f}", f"{100 * energy['drift']:+.2f} %"])
            shots.append(result.point_dumps[-1].read())
        for axis, dump, name in zip(axes[1:], shots, ("on soil", "free")):
            slab = dump["body"] == 0
            x = 1e3 * dump["position"]
            if not slab.all():
                axis.scatter(x[~slab, 0], x[~slab, 1], c="#d9cfbf", s=1.0, linewidths=0)
            marks = axis.scatter(x[slab, 0], x[slab, 1], c=dump["damage"][slab], s=2.0, cmap="inferno_r", vmin=0,
                                 vmax=1, linewidths=0)
            axis.set(title=f"Damage, {name}, {1e3 * dump['time']:.0f} ms", xlabel="radius [mm]", ylabel="height [mm]",
                     aspect="equal", xlim=(0, 820), ylim=(-150, 170))
        axes[0].set(title="Lower face, middle", xlabel="time [ms]", ylabel="[mm]")
        style(axes[0])
        axes[0].legend()
        figure.tight_layout()
        figure.colorbar(marks, ax=axes[2], shrink=0.6)
    header = ["slab", "largest deflection of the lower face mm", "largest pressure in the soil MPa", "cracked l",
              "energy drift"]
    return {"ground": table(header, rows)}, {"concrete_ground": figure}


ASPECT = 4.0  # height over half width of the column of cases/soil_column_2d


def column(run):
    """Collapse of a column of soil."""
    result = run("soil_column_2d", "column")
    shots = []
    for dump in result.point_dumps:
        dump = dump.read()
        if any(abs(dump["time"] - t) < 1e-6 for t in (0.0, 0.2, 0.4, 1.0)):
            shots.append(dump)
    with plt.rc_context(RC):
        figure, axes = plt.subplots(1, len(shots), figsize=(10.5, 2.6), sharey=True)
        for axis, dump in zip(axes, shots):
            axis.scatter(dump["position"][:, 0], dump["position"][:, 1], c=np.minimum(dump["plastic_strain"], 2.0), s=4,
                         cmap="viridis", linewidths=0)
            axis.set(title=f"{dump['time']:.1f} s", aspect="equal", xlim=(0, 0.6), ylim=(0, 0.42))
            axis.tick_params(colors=MUTED)
        figure.tight_layout()
    x = shots[-1]["position"]
    bulk = np.sort(x[:, 0])[int(0.99 * len(x))]
    height = x[x[:, 0] < 0.01, 1].max()
    slope = np.degrees(np.arctan2(height, bulk))
    energy = result.log["points"]["audit"]["energy"]
    coarse = run("soil_column_2d", "column-20", {"domain.cell": "20 mm"}).log["points"]["audit"]["energy"]

    def part(key, of):
        return f"{100 * of[key] / max(abs(of['initial']), abs(of['current'] + of['lost'])):.1f} %"
    rows = [["run-out (99 % of the mass) / half width", f"{bulk / 0.1:.2f}",
             f"1 + 1.9 a^(2/3) = {1.0 + 1.9 * ASPECT ** (2.0 / 3.0):.1f}"],
            ["height left / half width", f"{height / 0.1:.2f}", f"0.65 a^(2/5) = {0.65 * ASPECT ** 0.4:.1f}"],
            ["mean slope", f"{slope:.0f} degrees", "below the angle of friction, 33"],
            ["kinetic energy lost at constrained nodes, relative to all energy",
             part("lost_at_constrained_nodes", energy),
             f"(cells of 20 mm: {part('lost_at_constrained_nodes', coarse)})"],
            ["energy drift in addition", f"{100 * energy['drift']:+.2f} %",
             f"(cells of 20 mm: {100 * coarse['drift']:+.2f} %)"]]
    return {"column": table(["quantity", "computed", "experiments with sand [Lube05]"], rows)}, {
        "concrete_column": figure}


def charges(run):
    """A charge in soil under a plate, on three grids."""
    rows, impulses = [], []
    for cell in (12.0, 8.0, 16.0 / 3.0):
        result = run("charge_in_soil_2d", f"{cell:.3g}", {"domain.cell": f"{cell} mm"})
        plate = next(body for body in result.bodies if body["body"] == "plate")["end"]
        impulses.append(plate["momentum"][1])
        change = f"{100 * (impulses[-1] / impulses[-2] - 1):+.1f} %" if len(impulses) > 1 else ""
        rows.append([f"{cell:.3g}", f"{impulses[-1]:.1f}", change, f"{plate['velocity'][1]:.2f}",
                     f"{100 * result.log['points']['audit']['energy']['drift']:+.2f} %"])
    header = ["cell mm", "impulse of the plate N s", "change", "its velocity m/s", "energy drift"]
    return {"charges": table(header, rows)}, {}


PARTS = {"paths": paths, "calibration": calibration, "impact": impact, "bar": bar, "crater": crater, "column": column,
         "beam": beam, "ground": ground, "charges": charges}
