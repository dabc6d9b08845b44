"""Validation of the material points. Each part runs a case in variants and renews its part of
docs/validation/points.md; the text of the parts is in validation/points.md.in."""
import re

import matplotlib.pyplot as plt
import numpy as np
from common import COLOURS, INK, MUTED, ORANGE, RC, ROOT, commit, listed, machine, per_cent, span, style, table
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.ticker import NullFormatter

SHAPES = ("linear", "gimp", "cpgimp", "bspline")
SHAPE_COLOURS = dict(zip(SHAPES, ("#9aa5b1", "#2f8a57", ORANGE, COLOURS[3])))
LABELS = {"linear": "linear", "gimp": "GIMP", "cpgimp": "cpGIMP", "bspline": "B-spline"}
TNT_SPEED, TNT_CJ = 6930.0, 20.98e9  # of the default TNT; the pressure from its JWL constants (docs/materials.md)
FAILED = "fails"


def energy_drift(result):
    """Relative deviation of the energy from its initial value, at every record: of the plain sum, and with the kinetic
    energy, which belongs to the middle of the step like the velocity, moved to its end."""
    time, kinetic, internal = result.total_energies()
    lost = result.log["points"]["audit"]["energy"]["lost"] or 0.0
    start = kinetic[0] + internal[0]
    plain = (kinetic + internal) / start - 1.0
    if lost > 1e-6 * start:
        plain[-1] += lost / start
    centred = (internal[1:-1] + 0.5 * (kinetic[1:-1] + kinetic[2:])) / start - 1.0
    return time, plain, centred


# --- Sod's tube

def sod_exact(x, time, gamma=1.4):
    """Density, velocity and pressure of the exact solution; the diaphragm is at 0.5. The pressure between the waves
    is found by bisection of [Toro09] Eq. (4.5); the left wave is a rarefaction and the right one a shock."""
    rl, pl, rr, pr = 1.0, 1.0, 0.125, 0.1
    cl, cr = np.sqrt(gamma * pl / rl), np.sqrt(gamma * pr / rr)
    power = (gamma - 1.0) / (2.0 * gamma)

    def left(p):
        return 2.0 * cl / (gamma - 1.0) * ((p / pl) ** power - 1.0)

    def right(p):
        return (p - pr) * np.sqrt(2.0 / ((gamma + 1.0) * rr) / (p + (gamma - 1.0) / (gamma + 1.0) * pr))
    low, high = pr, pl
    for _ in range(200):
        p = 0.5 * (low + high)
        low, high = (p, high) if left(p) + right(p) < 0.0 else (low, p)
    u = 0.5 * (right(p) - left(p))
    rsl = rl * (p / pl) ** (1.0 / gamma)
    g = (gamma - 1.0) / (gamma + 1.0)
    rsr = rr * (p / pr + g) / (g * p / pr + 1.0)
    shock = cr * np.sqrt((gamma + 1.0) / (2.0 * gamma) * p / pr + power)
    s = (np.asarray(x) - 0.5) / time
    c = 2.0 / (gamma + 1.0) * (cl - 0.5 * (gamma - 1.0) * s)
    tail = u - np.sqrt(gamma * p / rsl)
    fan = (s >= -cl) & (s < tail)
    rho = np.select([s < -cl, s < tail, s < u, s < shock], [rl, rl * (c / cl) ** (2.0 / (gamma - 1.0)), rsl, rsr], rr)
    vel = np.select([s < -cl, s < tail, s < shock], [0.0, 2.0 / (gamma + 1.0) * (cl + s), u], 0.0)
    pre = np.where(fan, pl * (c / cl) ** (2.0 * gamma / (gamma - 1.0)), np.select([s < -cl, s < shock], [pl, p], pr))
    return rho, vel, pre


def sod_profile(result):
    d = result.point_dumps[-1].read()
    # Of equal volume within each body at the start.
    order = np.argsort(d["position"][:, 0])
    x = d["position"][order, 0]
    values = (d["density"][order], d["velocity"][order, 0], d["pressure"][order])
    return x, values, d["mass"][order] / d["density"][order], d["time"]


def sod_errors(result):
    """Mean deviation of density, velocity and pressure over the tube of length 1 m; None for a run that failed."""
    if result is None:
        return None
    x, values, volume, time = sod_profile(result)
    return [float(np.sum(volume * np.abs(v - e))) for v, e in zip(values, sod_exact(x, time))]


def judged_by_the_reader(run):
    """Comparisons of methods show drifts that would stop a run."""
    return lambda case, name, changes, **more: run(case, name, {"audit.fail": 0} | changes, **more)


def densities(result, low=0.52, high=0.6):
    """Between two positions behind the rarefaction: the density from counting the particles in space, and the mean of
    the densities that they carry."""
    x, (density, _, _), length, _ = sod_profile(result)
    inside = (x > low) & (x < high)
    return (density * length)[inside].sum() / (high - low), density[inside].mean()


def sod_text(results, errors, orders, others):
    """Values of the text on densities, orders and variants. `others`: error of the pressure by variant."""
    linear = [densities(results["linear", 1000, c]) for c in (2, 4, 8)]
    kept = [abs(carried / counted - 1.0) for s in ("cpgimp", "bspline") for c in (2, 4, 8)
            for counted, carried in [densities(results[s, 1000, c])]]
    default, *more = others
    return {"sod_exact": f"{float(sod_exact(0.56, 0.143)[0]):.3f}", "sod_kept": f"{100 * max(kept):.1f}",
            "sod_counted": listed(f"{counted:.3f}" for counted, _ in linear),
            "sod_carried": listed(f"{carried:.3f}" for _, carried in linear),
            "sod_orders": span([orders[s, c] for s in ("cpgimp", "bspline") for c in (2, 4, 8)], "{:.1f}"),
            "sod_over": listed(f"{others[name] / others[default]:.2f} ({name})" for name in more
                               if np.isfinite(others[name]))}


def sod(run):
    run = judged_by_the_reader(run)
    cells, counts = (125, 250, 500, 1000), (2, 4, 8)
    results = {(s, n, c): run("sod_points_1d", f"{s}-{n}-{c}", {
        "shape_function": s, "cell": f"={1.0 / n:g}", "points_per_cell": f"={c}",
        "point_fields": '=["velocity", "pressure", "density", "mass"]'}, may_fail=True)
        for s in SHAPES for n in cells for c in counts}
    errors = {key: sod_errors(r) for key, r in results.items()}
    rows, orders = [], {}
    for s in SHAPES:
        for c in counts:
            p = [errors[s, n, c][2] if errors[s, n, c] else np.nan for n in cells]
            fine = errors[s, cells[-1], c]
            drift = results[s, cells[-1], c].log["points"]["audit"]["energy"]["drift"] if fine else np.nan
            order = orders[s, c] = np.log2(p[0] / p[-1]) / np.log2(cells[-1] / cells[0])
            rows.append([LABELS[s], str(c), *(f"{v:.4f}" for v in p), f"{order:.2f}",
                         *([f"{fine[0]:.4f}", f"{fine[1]:.4f}"] if fine else [FAILED] * 2), f"{100 * drift:+.2f} %"])
    header = ["shape function", "particles per cell", *(f"p, {n} cells" for n in cells), "order of p",
              "rho, 1000 cells", "u, 1000 cells", "energy, 1000 cells"]
    variants = {"as default: MUSL, FLIP": {}, "USF": {"points.stress_order": "usf"},
                "USL": {"points.stress_order": "usl"}, "APIC": {"points.transfer": "apic"},
                "XPIC": {"points.transfer": "xpic"}, "FLIP with 5 % of PIC": {"points.pic_fraction": 0.05},
                "no bulk viscosity": {"points.linear_viscosity": 0.0, "points.quadratic_viscosity": 0.0},
                "linear viscosity 0.3": {"points.linear_viscosity": 0.3},
                "quadratic viscosity 3": {"points.quadratic_viscosity": 3.0}}
    others, of_bspline = [], {}
    for name, changes in variants.items():
        row = [name]
        for s in ("linear", "gimp", "cpgimp", "bspline"):
            case = "-".join(f"{k.split('.')[1]}-{v}" for k, v in changes.items()) or "default"
            result = run("sod_points_1d", f"{s}-1000-4-{case}", {
                "shape_function": s, "cell": "=0.001", "points_per_cell": "=4",
                "point_fields": '=["velocity", "pressure", "density", "mass"]', **changes}, may_fail=True)
            e = sod_errors(result)
            good = e and np.isfinite(e[2]) and e[2] < 10
            row.append(f"{e[2]:.4f}" if good else FAILED)
            of_bspline[name] = e[2] if good else np.nan  # the last of the shape functions
        others.append(row)

    plt.rcParams.update(RC)
    figure, axes = plt.subplots(2, 4, figsize=(13.4, 6.2), layout="constrained")
    fine_x = np.linspace(0.0, 1.0, 4001)
    exact = sod_exact(fine_x, 0.143)
    for row, c in enumerate((2, 4)):
        for a, k, name in zip(axes[row][:3], range(3), ("density", "velocity", "pressure")):
            style(a)
            for s in ("linear", "gimp", "bspline"):
                x, values, _, _ = sod_profile(results[s, 1000, c])
                a.plot(x, values[k], linewidth=0.8, color=SHAPE_COLOURS[s], label=LABELS[s],
                       alpha=0.8 if s == "linear" else 1.0)
            a.plot(fine_x, exact[k], color=INK, linewidth=0.8, linestyle=(0, (4, 2)), label="exact")
            a.set_ylim(0.0, 1.25)
            a.set_title(f"{name[0].upper() + name[1:]}, {c} per cell")
            a.set_xlabel("x")
        a = axes[row][3]
        style(a)
        for s in SHAPES:
            a.loglog([1.0 / n for n in cells], [errors[s, n, c][2] if errors[s, n, c] else np.nan for n in cells], "o-",
                     color=SHAPE_COLOURS[s], markersize=4, linewidth=1.0, label=LABELS[s])
        h = np.array([1e-3, 8e-3])
        a.loglog(h, 0.0025 * (h / 1e-3), color=MUTED, linewidth=0.8, linestyle=":", label="first order")
        a.set_title(f"L1 error of the pressure, {c} per cell")
        a.set_xticks([1e-3, 2e-3, 4e-3, 8e-3], ["0.001", "0.002", "0.004", "0.008"])
        a.xaxis.set_minor_formatter(NullFormatter())
        a.set_ylim(1.5e-3, 0.4)
        a.set_xlabel("h")
    axes[0][0].legend()
    axes[0][3].legend()
    return {"sod_table": table(header, rows), "sod_variants": table(["variant", *(LABELS[s] for s in SHAPES)], others),
            **sod_text(results, errors, orders, of_bspline)}, {"points_sod": figure}


# --- slab of TNT

def slab_row(name, result):
    if result is None:
        return [name, *[FAILED] * 8]
    arrivals, peaks = [], []
    for station in ("x40", "x70", "x97.5"):
        g = result.gauge(station)
        p, t = g["pressure"], g["time"]
        peak = np.nanmax(p)
        n = int(np.argmax(p >= 0.5 * peak))
        arrival = t[n - 1] + (t[n] - t[n - 1]) * (0.5 * peak - p[n - 1]) / (p[n] - p[n - 1])
        arrivals.append(per_cent(arrival * TNT_SPEED / g["x"][0], 2))
        peaks.append(per_cent(peak / TNT_CJ))
    highest = max(float(np.max(d.values("pressure"))) for d in result.point_dumps)
    drift = 100.0 * result.log["points"]["audit"]["energy"]["drift"]
    return [name, *arrivals, *peaks, f"{highest / 1e9:.2f}", f"{drift:+.2f} %"]


def slab_text(results):
    """Deviations of the shape functions, from the rows of the table."""
    lines = []
    for label, result in results.items():
        row = slab_row(label, result)
        if row[1] == FAILED:
            lines.append(f"{label} {FAILED}")
            continue
        lines.append(f"{label}: arrival {row[1]} to {row[3]}, peak {row[4]} to {row[6]}, energy {row[8]}")
    return "; ".join(lines) + "."


def tnt_slab_points(run):
    run = judged_by_the_reader(run)
    case = "tnt_slab_points_1d"
    results = {s: run(case, s, {"shape_function": s}, may_fail=True) for s in SHAPES}
    rows = [slab_row(f"{LABELS[s]}, MUSL, FLIP", r) for s, r in results.items()]
    for name, changes in {"USF": {"points.stress_order": "usf"},
                          "USF, Courant 0.2": {"points.stress_order": "usf", "points.courant": 0.2},
                          "USL": {"points.stress_order": "usl"},
                          "APIC": {"points.transfer": "apic"}, "XPIC": {"points.transfer": "xpic"}}.items():
        folder = "bspline-" + name.lower().replace(", courant ", "-")
        rows.append(slab_row(f"B-spline, {name}", run(case, folder, changes, may_fail=True)))
    for c in (1, 4):
        changes = {"cell": f"{0.025 * c:g} mm", "body.points_per_cell": c}
        rows.append(slab_row(f"B-spline, {c} per cell", run(case, f"bspline-{c}", changes, may_fail=True)))
    for cell in (0.2, 0.1):
        name = f"B-spline, spacing {cell / 2:g} mm"
        rows.append(slab_row(name, run(case, f"bspline-{cell}", {"cell": f"{cell:g} mm"}, may_fail=True)))
    header = ["variant", *(f"arrival, {x} mm" for x in (40, 70, 97.5)), *(f"peak, {x} mm" for x in (40, 70, 97.5)),
              "highest in any dump [GPa]", "energy at the end"]

    plt.rcParams.update(RC)
    figure, axes = plt.subplots(1, 2, figsize=(10.6, 3.4), layout="constrained")
    for a, s in zip(axes, ("bspline", "linear")):
        style(a)
        result = results[s]
        if result is None:
            continue
        for d in result.point_dumps[4:29:6]:
            d = d.read()
            order = np.argsort(d["position"][:, 0])
            a.plot(d["position"][order, 0] * 1e3, d["pressure"][order] / 1e9, color=SHAPE_COLOURS[s], linewidth=0.8)
        a.axhline(TNT_CJ / 1e9, color=ORANGE, linewidth=1.0)
        a.text(1.0, TNT_CJ / 1e9 + 0.4, "Chapman-Jouguet pressure", color=ORANGE)
        a.set_ylim(0.0, 26.0)
        a.set_xlim(0.0, 120.0)
        a.set_title(f"{LABELS[s]}: pressure [GPa] every 3 us")
        a.set_xlabel("x [mm]")
    text = slab_text({LABELS[s]: r for s, r in results.items()})
    return {"slab_table": table(header, rows), "slab_text": text, "speed": f"{TNT_SPEED:g}",
            "cj": f"{TNT_CJ / 1e9:.2f}"}, {"points_tnt_slab": figure}


# --- cased cube

def cube_text(histories):
    """Values of the text on the energies. `histories`: times and deviations, plain and centred, by shape and Courant
    number."""
    last = {s: [f"{100 * h[1][-1]:+.3f} %" for (shape, _), h in histories.items() if shape == s] for s in SHAPES}
    end = "; ".join(f"{LABELS[s]} {', '.join(values)}" for s, values in last.items())
    deepest = {key: np.abs(h[1]).max() for key, h in histories.items()}
    smooth = [s for s in SHAPES if s != "linear"]  # linear ones lose energy permanently
    return {"cube_end": end, "cube_dip": span([100 * deepest[s, 0.4] for s in smooth], "{:.2f}"),
            "cube_half": span([deepest[s, 0.2] / deepest[s, 0.4] for s in smooth], "{:.2f}"),
            "cube_centred": listed(f"{100 * np.abs(histories[s, 0.4][2]).max():.3f} % ({LABELS[s]})" for s in SHAPES)}


def cased_cube(run):
    rows, histories = [], {}
    for s in SHAPES:
        for courant in (0.4, 0.3, 0.2):
            # No intermediate dumps: a step shortened for one would shift the middle of the step.
            result = run("cased_cube_3d", f"{s}-{courant}", {"shape_function": s, "courant": courant,
                                                             "gauge_interval": "=0", "field_interval": "=0"})
            time, plain, centred = energy_drift(result)
            histories[s, courant] = time, plain, centred
            rows.append([LABELS[s], f"{courant:g}", f"{result.log['step']:,}", f"{100 * plain[-1]:+.3f} %",
                         f"{100 * np.abs(plain).max():.3f} %", f"{100 * centred[-1]:+.3f} %",
                         f"{100 * np.abs(centred).max():.3f} %"])
    plt.rcParams.update(RC)
    figure, axes = plt.subplots(1, 2, figsize=(10.6, 3.4), layout="constrained")
    for a, k, title in zip(axes, (1, 2), ("plain sum", "kinetic energy at the end of the step")):
        style(a)
        for s in SHAPES:
            for courant, line in ((0.4, "-"), (0.2, "--")):
                h = histories[s, courant]
                t = h[0] if k == 1 else h[0][1:-1]
                a.plot(t * 1e6, 100 * h[k], line, color=SHAPE_COLOURS[s], linewidth=1.0,
                       label=f"{LABELS[s]}, Courant {courant:g}")
        a.set_ylim(-1.1, 0.2)
        a.set_title(f"Drift of the energy [%], {title}")
        a.set_xlabel("t [us]")
    axes[0].legend(ncols=2, fontsize=7.5, loc="lower left")
    header = ["shape function", "Courant number", "steps", "energy at 6 us", "largest deviation",
              "at 6 us, kinetic energy centred", "largest, centred"]
    return {"cube_table": table(header, rows), **cube_text(histories)}, {"points_cased_cube": figure}


# --- Taylor bar

BAR = {"length": 16.2, "diameter": 13.5, "bulge": 10.1}  # mm, after the test
RADIUS, HEIGHT, MARK = 3.81e-3, 25.4e-3, 5.08e-3


def bar_sizes(result):
    """Length, diameter of the foot where it is widest and diameter 5.08 mm above the struck end [mm]; the half spacing
    between the outermost particles and the surface is extrapolated. The rod may have left the wall."""
    d = result.point_dumps[-1].read()
    x, y = d["position"][:, 0], d["position"][:, 1]
    start = d["position"] - d["displacement"]
    spacing = result.cell_size / result.points["bodies"][0]["points_per_direction"]
    row = np.floor(start[:, 1] / spacing).astype(int)
    if result.log["domain"]["geometry"] != "axisymmetric2d":
        # Particles of cut cells lie anywhere on the side: the diameter is that of the area that a slab of them fills.
        volume = d["mass"] / d["density"]
        y = y - (y.min() - 0.5 * spacing)

        def diameter(low, high):
            return 2e3 * np.sqrt(4.0 / np.pi * volume[(y > low) & (y < high)].sum() / (high - low))
        foot = max(diameter(k * spacing, (k + 1) * spacing) for k in range(4))  # its rim curls up
        return {"length": 1e3 * (y[row == row.max()].max() + 0.5 * spacing), "diameter": foot,
                "bulge": diameter(MARK - 2.0 * spacing, MARK + 2.0 * spacing)}
    column = np.floor(start[:, 0] / spacing).astype(int)
    shape = (row.max() + 1, column.max() + 1)
    grid = np.full((2, *shape), np.nan)
    grid[0, row, column], grid[1, row, column] = x, y
    grid[1] -= (grid[1, 0] - 0.5 * (grid[1, 1] - grid[1, 0])).min()
    side = grid[:, :, -1] + 0.5 * (grid[:, :, -1] - grid[:, :, -2])
    top = grid[1, -1] + 0.5 * (grid[1, -1] - grid[1, -2])
    foot = side[0, 0] - 0.5 * (side[0, 1] - side[0, 0])
    above = int(np.argmax(side[1] >= MARK))
    bulge = np.interp(MARK, side[1, above - 1:above + 1], side[0, above - 1:above + 1])
    return {"length": 1e3 * top.max(), "diameter": 2e3 * max(foot, side[0].max()),
            "bulge": 2e3 * bulge}


def taylor_text(results):
    """Values of the text on the sizes, from those of the runs by their folders."""
    sizes = {folder: bar_sizes(result) for folder, result in results.items()}

    def changes(a, b):
        return {k: sizes[b][k] / sizes[a][k] - 1.0 for k in BAR}

    def against(folder):
        return listed(f"{per_cent(sizes[folder][k] / BAR[k])} ({k})" for k in BAR)
    by_grid = changes("bspline-0.508", "bspline-0.127")
    alike = [abs(d) for folder in (*(f"{s}-0.254" for s in SHAPES[:3]), "quarter") if folder in sizes
             for d in changes("bspline-0.508" if folder == "quarter" else "bspline-0.254", folder).values()]
    locking = [abs(d) for s, other in (("bspline", "bspline-0.254"), ("linear", "linear-0.254"))
               if f"locking-{s}" in sizes and other in sizes for d in changes(other, f"locking-{s}").values()]
    return {"taylor_converged": listed(f"{100 * d:+.1f} % ({k})" for k, d in by_grid.items()),
            "taylor_same": f"{100 * max(alike):.1f} %", "taylor_off": against("bspline-0.127"),
            "taylor_stuck": against("stuck") if "stuck" in sizes else FAILED,
            "taylor_locking": f"{100 * max(locking):.1f} %"}


def taylor(run):
    case = "taylor_bar_2d"
    base = {"output.precision": "double", "point_fields": '=["displacement", "plastic_strain", "temperature"]',
            "locking_control": False, "gauge_interval": "1 us", "field_interval": "=0"}
    stuck = ('\n[[constraint]]\nkind = "fixed"\nheld = ["x"]\n'
             'within = {shape = "box", lower = [0, 0], upper = ["7.62 mm", "0.01 mm"]}\n')
    three = {"point_fields": '=["displacement", "plastic_strain", "temperature", "mass", "density"]',
             "geometry": "cartesian3d", "size": '=["8.128 mm", "27.94 mm", "8.128 mm"]', "cell": "0.508 mm",
             "position": '=[0, "12.7 mm", 0]', "velocity": "=[0, -190, 0]", "body.axis": "y",
             "boundaries.x_low": "symmetry", "boundaries.z_low": "symmetry", "point": '=[0, "5.08 mm", 0]'}
    runs = [(f"axisymmetric, h = {h:g} mm, B-spline", f"bspline-{h}", {"cell": f"{h:g} mm"}, "")
            for h in (0.508, 0.254, 0.127)]
    runs += [(f"axisymmetric, h = 0.254 mm, {LABELS[s]}", f"{s}-0.254", {"shape_function": s}, "") for s in SHAPES[:3]]
    runs += [("axisymmetric, h = 0.254 mm, B-spline, locking control", "locking-bspline",
              {"locking_control": True}, ""),
             ("axisymmetric, h = 0.254 mm, linear, locking control", "locking-linear",
              {"locking_control": True, "shape_function": "linear"}, ""),
             ("axisymmetric, h = 0.254 mm, B-spline, foot sticks to the wall", "stuck", {}, stuck),
             ("quarter in 3D, h = 0.508 mm, B-spline", "quarter", three, "")]
    rows, results = [], {}
    for name, folder, changes, added in runs:
        result = run(case, folder, base | changes, added, may_fail=True)
        if result is None:
            rows.append([name, *[FAILED] * 6])
            continue
        results[folder] = result
        sizes = bar_sizes(result)
        d = result.point_dumps[-1].read()
        _, kinetic, internal = result.total_energies()
        drift = (kinetic[-1] + internal[-1]) / (kinetic[0] + internal[0])
        rows.append([name, *(f"{sizes[k]:.2f} ({per_cent(sizes[k] / BAR[k])})" for k in BAR),
                     f"{d['plastic_strain'].max():.2f}", f"{d['temperature'].max():.0f}", per_cent(drift, 2)])
    rows.insert(0, ["**test**", *(f"**{v:.1f}**" for v in BAR.values()), "", "", ""])
    fine = bar_sizes(results["bspline-0.127"])
    error = np.mean([abs(fine[k] / BAR[k] - 1.0) for k in BAR])

    plt.rcParams.update(RC)
    figure, axes = plt.subplots(1, 2, figsize=(10.6, 4.4), layout="constrained", width_ratios=(1, 1.1))
    rising = LinearSegmentedColormap.from_list("rising", [(0.0, "#dde3ea"), (0.4, "#5b9bc4"), (0.6, "#f3d27a"),
                                                          (0.8, "#e0702f"), (1.0, "#a81e2b")])
    a = axes[0]
    style(a)
    d = results["bspline-0.127"].point_dumps[-1].read()
    for sign in (-1, 1):
        drawn = a.scatter(sign * d["position"][:, 0] * 1e3, d["position"][:, 1] * 1e3, c=d["plastic_strain"], s=0.6,
                          cmap=rising, vmin=0.0, vmax=1.5, linewidths=0)
    figure.colorbar(drawn, ax=a, label="plastic strain", shrink=0.8)
    half, height = 0.5 * BAR["diameter"], BAR["length"]
    for xs, ys in (([-half, half], [0, 0]), ([-5.05, -5.05], [4.3, 5.9]), ([5.05, 5.05], [4.3, 5.9]),
                   ([-3.9, 3.9], [height, height])):
        a.plot(xs, ys, color=INK, linewidth=1.6)
    a.set_aspect("equal")
    a.set_xlabel("mm")
    a.set_title("Rod at 80 us, h = 0.127 mm; lines: measured sizes")
    a = axes[1]
    style(a)
    for folder, colour in zip(("bspline-0.508", "bspline-0.254", "bspline-0.127"), COLOURS[1:]):
        d = results[folder].point_dumps[-1].read()
        start = d["position"] - d["displacement"]
        edge = start[:, 0] > RADIUS - results[folder].cell_size / 2
        order = np.argsort(start[edge, 1])
        a.plot(d["position"][edge][order, 1] * 1e3, d["position"][edge][order, 0] * 1e3, color=colour, linewidth=1.2,
               label=f"h = {results[folder].cell_size * 1e3:g} mm, outermost points")
    a.plot([0.0, 5.08], [half, 5.05], "o", color=INK, markersize=4, label="test")
    a.axvline(height, color=INK, linewidth=0.8, linestyle=":")
    a.text(height - 0.2, 6.5, "length, test", ha="right", color=INK)
    a.set_xlabel("height above the wall [mm]")
    a.set_title("Radius [mm] along the rod")
    a.legend()
    header = ["run", *(f"{k} [mm]" for k in BAR), "largest plastic strain", "highest T [K]", "energy at 80 us"]
    speeds = [float(results[folder].gauge("rod")["velocity_y"][-1])
              for folder in ("bspline-0.508", "bspline-0.254", "bspline-0.127")]
    rebound = ", ".join(f"{v:.2f}" for v in speeds)
    return {"taylor_table": table(header, rows), "taylor_error": f"{100 * error:.1f}",
            "taylor_rebound": rebound, **taylor_text(results)}, {"points_taylor": figure}


# --- Gurney

GURNEY = {"TNT": (2370.0, 2440.0), "Comp-B": (2700.0, 2770.0)}  # sqrt(2E) [m/s]


def gurney(run):
    cases = {"copper cylinder": ("gurney_cylinder_2d", 0.5, "wall"),
             "steel sandwich": ("gurney_sandwich_1d", 1.0 / 3.0, "face")}
    variants = {"gurney_cylinder_2d": [("h = 0.8 mm", {"cell": "0.8 mm"}), ("h = 0.4 mm", {}),
                                       ("h = 0.2 mm", {"cell": "0.2 mm"})],
                "gurney_sandwich_1d": [("h = 0.4 mm", {"cell": "0.4 mm"}), ("h = 0.2 mm", {}),
                                       ("h = 0.1 mm", {"cell": "0.1 mm"})]}
    rows, curves, off, later = [], [], {}, []
    for label, (case, constant, gauge) in cases.items():
        for explosive, range_ in GURNEY.items():
            chosen = variants[case] if explosive == "TNT" else variants[case][1:2]
            for name, changes in chosen + [("instantaneous", {"body.detonation": "instantaneous", "initiation": None})]:
                result = run(case, f"{explosive}-{name.replace(' = ', '').replace(' mm', '')}",
                             {"body.material": explosive, **changes})
                masses = {b["name"]: b["mass"] for b in result.points["bodies"]}
                ratio = masses["metal"] / masses["charge"]
                factor = (ratio + constant) ** -0.5
                columns = result.energies
                speed = np.sqrt(2.0 * columns["metal: kinetic_energy"] / masses["metal"])
                # Volume of the products: inside the metal, whose own volume hardly changes.
                g = result.gauge(gauge)
                outer = np.interp(columns["time"], g["time"], g["x"])
                first = outer[0]
                if label == "copper cylinder":
                    volume = (outer ** 2 - first ** 2) / 12.7e-3 ** 2 + 1.0
                else:
                    volume = (outer - first) / 10e-3 + 1.0
                at = [float(np.interp(v, volume, speed)) if volume[-1] >= v else np.nan for v in (4, 7, 10)]
                expected = [factor * v for v in range_]
                middle = sum(expected) / 2.0
                off.setdefault(label, []).append(at[1] / middle)
                later += [v / middle for v in at]
                _, plain, _ = energy_drift(result)
                start = name if name == "instantaneous" else f"programmed, {name}"
                rows.append([label, explosive, f"{ratio:.3f}", start, *(f"{v:.0f}" for v in at),
                             f"{expected[0]:.0f} to {expected[1]:.0f}", per_cent(at[1] / middle),
                             f"{100 * plain[-1]:+.2f} %"])
                if name == "instantaneous" or name == variants[case][1][0]:
                    curves.append((label, explosive, name, volume, speed, expected))
    plt.rcParams.update(RC)
    figure, axes = plt.subplots(1, 2, figsize=(10.6, 3.8), layout="constrained")
    for a, label in zip(axes, cases):
        style(a)
        for owner, explosive, name, volume, speed, expected in curves:
            if owner != label:
                continue
            colour = {"TNT": COLOURS[3], "Comp-B": ORANGE}[explosive]
            a.plot(volume, speed, "--" if name == "instantaneous" else "-", color=colour, linewidth=1.2,
                   label=f"{explosive}, {'instantaneous' if name == 'instantaneous' else 'programmed'}")
            if name != "instantaneous":
                a.axhspan(*expected, color=colour, alpha=0.18, linewidth=0)
        a.axvline(7.0, color=MUTED, linewidth=0.8, linestyle=":")
        a.set_xlim(1.0, 12.0)
        a.set_ylim(0.0, 2000.0)
        a.set_xlabel("volume of the products / volume of the charge")
        a.set_title(f"Velocity [m/s], {label}; bands: Gurney")
    axes[0].legend(loc="lower right")
    header = ["case", "explosive", "M/C", "detonation", "v [m/s] at V = 4", "at V = 7", "at V = 10",
              "Gurney [m/s]", "V = 7 against the middle", "energy"]
    deviations = listed(f"{span([100 * (r - 1) for r in ratios], '{:+.1f}')} % ({label})"
                        for label, ratios in off.items())
    known = [100 * (r - 1) for r in later if np.isfinite(r)]
    speeds = listed(f"{low / 1e3:.2f} to {high / 1e3:.2f} km/s for {name}" for name, (low, high) in GURNEY.items())
    return {"gurney_table": table(header, rows), "gurney_text": deviations, "gurney_span": span(known, "{:+.1f}"),
            "gurney_speeds": speeds}, {"points_gurney": figure}


PARTS = {"cased_cube": cased_cube, "tnt_slab_points": tnt_slab_points, "taylor": taylor, "gurney": gurney,
         "sod_points": sod}


def split(text):
    """Text before the first part, and the parts by name."""
    pieces = re.split(r"^<!-- part (\w+) -->\n", text, flags=re.MULTILINE)
    return pieces[0], dict(zip(pieces[1::2], pieces[2::2]))


def validate(names, run, target, built_from, title="points", functions=None):
    """Renews parts of a page and leaves the others unchanged."""
    functions = functions or PARTS
    head, template = split((ROOT / "validation" / f"{title}.md.in").read_text())
    page = target / f"{title}.md"
    _, parts = split(page.read_text()) if page.exists() else ("", {})
    for name in names:
        run.seconds = 0.0
        values, figures = functions[name](run)
        for figure_name, figure in figures.items():
            figure.savefig(target / f"{figure_name}.png", dpi=120, facecolor="white")
            plt.close(figure)
        values |= {"commit": built_from or commit(), "seconds": f"{run.seconds:.0f}", "machine": machine(),
                   "threads": f"{run.threads} thread" + ("" if run.threads == 1 else "s")}
        parts[name] = re.sub(r"@(\w+)@", lambda m: values[m.group(1)].rstrip("\n"), template[name])
    text = head + "".join(f"<!-- part {name} -->\n{parts[name]}" for name in template if name in parts)
    page.write_text(text)
    print(f"wrote {page}")
