"""Example 5.2 of [Cui14]: a disc of TNT beside a slab, gas cells and material points combined."""
import re

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from common import COLOURS, ORANGE, RC, ROOT, listed, nearest, per_cent, style, table

CASE = "slab_2d"
AMBIENT = 101325.0
FREE, FRONT = "free", "front"  # the gauges (-125, 250) mm in the gas and (125, 250) mm in the particles
BEFORE_REFLECTION = 25e-6  # the first peak is over, the wave from the slab has not returned [s]


def arrival_peak_impulse(gauge):
    """Time of half of the first peak [s], the first peak [Pa], the impulse to 30 us [Pa s]."""
    t, p = gauge["time"], gauge["overpressure"]
    first = t < BEFORE_REFLECTION
    peak = p[first].max()
    i = np.argmax(p > 0.5 * peak)
    arrival = t[i - 1] + (0.5 * peak - p[i - 1]) / (p[i] - p[i - 1]) * (t[i] - t[i - 1])
    early = t <= 30e-6
    return arrival, peak, np.trapz(p[early], t[early])


def without_slab():
    """The deck without the slab and its gauges: the wave alone."""
    text = (ROOT / "cases" / CASE / "deck.toml").read_text()
    return re.sub(r"\[solids\..*?(?=\[mpm_region\])", "", text, flags=re.DOTALL).replace(
        text[text.index('[[gauge]]\nname = "face"'):text.index("[output]")], "")


def points_alone():
    """The same problem with material points everywhere: the charge is a body, the region the whole domain. Without gas
    cells there is nothing to subcycle against; gauges then record every step of the particles."""
    text = (ROOT / "cases" / CASE / "deck.toml").read_text()
    charge = ('[[body]]\nname = "charge"\nmaterial = "TNT"\nshape = "cylinder"\nposition = [0, "250 mm"]\n'
              'radius = "50 mm"\npoints_per_cell = 3\ninitiation = [{position = [0, "250 mm"]}]\n\n')
    text = re.sub(r"\[\[charge\]\].*?(?=\[solids)", "", text, flags=re.DOTALL)
    text = re.sub(r"^box = .*$", 'box = {lower = ["-180 mm", 0], upper = ["160 mm", "500 mm"]}', text,
                  flags=re.MULTILINE)
    return text.replace("[mpm_region]", charge + "[mpm_region]\nsubcycling = false")


def front_peaks(fields, angles, behind=12e-3):
    """Highest pressure [Pa] within `behind` [m] of the front, and the radius of the front [m], on rays from the centre
    of the charge at `angles` [rad]. The front is the outermost point above ten times the ambient
    pressure."""
    x, y, p = fields
    h = x[1] - x[0]
    radii = np.arange(0.06, 0.175, 0.25 * h)
    peaks, fronts = [], []
    for a in angles:
        i = np.clip(((radii * np.cos(a) - x[0]) / h).round().astype(int), 0, len(x) - 1)
        j = np.clip(((0.25 + radii * np.sin(a) - y[0]) / h).round().astype(int), 0, len(y) - 1)
        ray = p[j, i]
        front = radii[np.flatnonzero(ray > 10.0 * AMBIENT)[-1]]
        peaks.append(ray[(radii > front - behind) & (radii <= front)].max())
        fronts.append(front)
    return np.array(peaks), np.array(fronts)


def front_noise(fields, angles):
    """Standard deviation of the peak pressure along the front from a smooth curve, of the fourth degree in the angle,
    relative to its mean."""
    peaks, _ = front_peaks(fields, angles)
    smooth = np.polyval(np.polyfit(angles - angles.mean(), peaks, 4), angles - angles.mean())
    return np.std(peaks - smooth) / peaks.mean()


def pressure(result, time):
    """Cell centres along x and y [m] and the pressure [Pa] of the dump nearest to a time."""
    dump = nearest(result.dumps, time)
    return dump.centres(0), dump.centres(1), dump.values("pressure")


def slab(run):
    """Values and figures of the page."""
    times = '=["20 us", "32.5 us"]'
    base = {"output.field_times": times}
    widths = {w: run(CASE, f"w{w}", base | {"mpm_region.width": w}) for w in (2, 5, 8)}
    free = run(CASE, "no-slab", base, text=without_slab())
    fine = run(CASE, "no-slab-1mm", base | {"cell": "1 mm"}, text=without_slab())
    alone = run(CASE, "points-alone", base, text=points_alone(), may_fail=True)

    rows = []
    for name, result in [("no slab", free), ("no slab, 1 mm", fine)] + [(f"w = {w}", r) for w, r in widths.items()]:
        a, b = (arrival_peak_impulse(result.gauge(g)) for g in (FREE, FRONT))
        rows.append([name, f"{a[0] * 1e6:.2f}", f"{b[0] * 1e6:.2f}", per_cent(b[0] / a[0], 2), f"{a[1] / 1e6:.2f}",
                     f"{b[1] / 1e6:.2f}", per_cent(b[1] / a[1]), f"{a[2]:.1f}", f"{b[2]:.1f}", per_cent(b[2] / a[2])])
    gauges = table(["run", "arrival, gas [us]", "particles [us]", "deviation", "first peak, gas [MPa]",
                    "particles [MPa]", "deviation", "impulse to 30 us, gas [Pa s]",
                    "particles [Pa s]", "deviation"], rows)

    matplotlib.rcParams.update(RC)
    figure, axes = plt.subplots(1, 3, figsize=(10.6, 3.4), layout="constrained", sharey=True)
    for panel, (w, result) in zip(axes, widths.items()):
        style(panel)
        for gauge, label, colour, line in ((FREE, "(-125, 250) mm, gas", ORANGE, "-"),
                                           (FRONT, "(125, 250) mm, points", COLOURS[-1], "--")):
            g = result.gauge(gauge)
            panel.plot(g["time"] * 1e6, g["pressure"] / 1e6, line, color=colour, linewidth=1.5, label=label)
        panel.set_title(f"w = {w}")
        panel.set_xlabel("time [us]")
        panel.set_xlim(14, 40)
        panel.set_ylim(0, 60)
    axes[0].set_ylabel("pressure [MPa]")
    axes[0].legend(loc="upper right")

    contours, axes = plt.subplots(1, 2, figsize=(9.4, 6.0), layout="constrained")
    for panel, time in zip(axes, (20e-6, 32.5e-6)):
        x, y, p = pressure(widths[5], time)
        shown = panel.pcolormesh(x * 1e3, y * 1e3, np.log10(np.maximum(p, 1e4)), cmap="viridis", vmin=5, vmax=8.5)
        for line in (110, 120):
            panel.axvline(line, color="white", linewidth=0.7, linestyle=":")
        panel.set_aspect("equal")
        panel.set_title(f"{time * 1e6:g} us")
        panel.set_xlabel("x [mm]")
    axes[0].set_ylabel("y [mm]")
    contours.colorbar(shown, ax=axes, label="log10 of the pressure [Pa]; dotted: the bridge", shrink=0.8)

    coupled = widths[5].seconds
    left = np.radians(np.arange(120.0, 241.0))  # the half that the slab does not disturb
    noise = 100.0 * front_noise(pressure(widths[5], 20e-6), left)
    cost = [["gas and particles", f"{widths[5].log['step']}", f"{coupled:.1f}", f"{noise:.1f} %"]]
    ratio = "did not finish"
    if alone:
        noise = 100.0 * front_noise(pressure(alone, 20e-6), left)
        cost.append(["particles alone", f"{alone.log['step']}", f"{alone.seconds:.1f}", f"{noise:.1f} %"])
        ratio = f"{alone.seconds / coupled:.1f}"
    energy = table(["run", "energy drift"], [[f"w = {w}", f"{100.0 * r.log['mpm_region']['energy']['drift']:.3f} %"]
                                             for w, r in widths.items()])
    widest = max(widths)
    gas, points = (arrival_peak_impulse(widths[widest].gauge(g)) for g in (FREE, FRONT))
    within = listed(f"{per_cent(b / a, 2)} ({name})" for name, a, b in zip(("arrival", "peak", "impulse"), gas, points))
    values = {"widest": f"{widest}", "in_the_bridge": within, "gauges": gauges, "ratio": ratio, "energy": energy,
              "cost": table(["method", "common steps", "processor time [s]", "unevenness of the front at 20 us"], cost)}
    return values, {"slab_histories": figure, "slab_contours": contours}


PARTS = {"slab": slab}
