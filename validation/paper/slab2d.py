"""Example 5.2: a disc of TNT beside a slab of concrete, in the plane; gas cells and particles compared with particles
alone."""
import matplotlib.pyplot as plt
import numpy as np
from common import COLOURS, ORANGE, RC, listed, nearest, per_cent, style
from slab import CASE, FREE, FRONT, arrival_peak_impulse, front_noise, front_peaks, points_alone, pressure, without_slab

TITLE = "A charge beside a concrete slab, in the plane"
TIMES = (20e-6, 32.5e-6)
WIDTHS = {"quick": (2, 5), "standard": (2, 5, 8), "fine": (2, 5, 8)}
# Behind a bridge of 8 cells: the paper's gauges, at 125 mm, then lie in it.
DEEP = ("free-132", "front-132")
GAUGES = "".join(f'[[gauge]]\nname = "{name}"\npoint = ["{x} mm", "250 mm"]\n' for name, x in zip(DEEP, (-132, 132)))
OUTPUT = {"output.field_times": '=["20 us", "32.5 us"]', "output.gas_points": True,
          "output.point_fields": '=["pressure"]'}
BASE = {"body.material": "concrete-25MPa"} | OUTPUT
PAPER_SECONDS = 181 * 60 + 9, 50 * 60 + 30  # particles alone, gas and particles, [Cui14] 5.2
LIMITS = (("arrival", 1.0), ("first peak", 3.0), ("impulse to 30 us", 2.0))  # per cent
LEFT, RIGHT = np.radians(np.arange(150.0, 211.0)), np.radians(np.arange(-30.0, 31.0))  # rays from the charge
# The method of the paper as it may have been; from 20 us on its steps become so short that the run ends there.
PAPER_MPM = {"mpm_region.transfer": "flip", "mpm_region.order": "musl", "end.time": "20 us",
             "output.field_times": None}
LINEAR = '\n[points]\nshape_function = "linear"\n'


def points_at(result, time):
    """Positions [m] and pressure [Pa] of the particles in the dump nearest to a time."""
    dump = nearest(result.point_dumps, time)
    return dump.values("position"), dump.values("pressure")


def scatter(axis, result, time, limit):
    position, p = points_at(result, time)
    inside = position[:, 0] > 0.11
    axis.set_facecolor("#f5f7f9")
    shown = axis.scatter(position[inside, 0] * 1e3, position[inside, 1] * 1e3, c=p[inside] / 1e6, s=1.6, linewidths=0,
                         cmap="turbo", vmin=0, vmax=limit)
    axis.set(xlim=(110, 160), ylim=(50, 450), xlabel="x [mm]", aspect="equal", xticks=(110, 140, 160))
    return shown


def histories(results, path):
    """[Cui14] Figs. 10 and 11."""
    with plt.rc_context(RC):
        figure, axes = plt.subplots(2, len(results), figsize=(3.8 * len(results), 6.2), layout="constrained",
                                    sharex=True, sharey="row", squeeze=False)
        for column, (width, result) in zip(axes.T, results.items()):
            for a, names, x in zip(column, ((FREE, FRONT), DEEP), (125, 132)):
                style(a)
                for name, where, colour, line in zip(names, (f"(-{x}, 250) mm, gas", f"({x}, 250) mm, points"),
                                                     (ORANGE, COLOURS[3]), ("-", "--")):
                    g = result.gauge(name)
                    a.plot(g["time"] * 1e6, g["pressure"] / 1e6, line, color=colour, linewidth=1.5, label=where)
                a.set(title=f"w = {width}, {x} mm", xlim=(14, 40), ylim=(0, 60 if x == 125 else 120))
            column[-1].set_xlabel("time [us]")
        for a in axes[:, 0]:
            a.set_ylabel("pressure [MPa]")
            a.legend(loc="upper left")
        figure.savefig(path, dpi=130, facecolor="white")
        plt.close(figure)


def contours(result, path):
    """[Cui14] Fig. 9: gas cells and, beside them, particles."""
    with plt.rc_context(RC):
        figure, axes = plt.subplots(1, 2, figsize=(7.6, 6.0), layout="compressed", width_ratios=(300, 50))
        x, y, p = pressure(result, TIMES[0])
        gas = x < 0.12
        axes[0].pcolormesh(x[gas] * 1e3, y * 1e3, p[:, gas] / 1e6, cmap="turbo", vmin=0, vmax=60)
        axes[0].axvline(110, color="white", linewidth=0.8, linestyle=":")
        axes[0].set(title="Gas cells; dotted: the bridge begins", xlabel="x [mm]", ylabel="y [mm]", aspect="equal",
                    ylim=(50, 450))
        shown = scatter(axes[1], result, TIMES[0], 60)
        axes[1].axvline(120, color="#9aa5b1", linewidth=0.8, linestyle=":")
        axes[1].set_title("Points")
        figure.colorbar(shown, ax=axes, label="pressure at 20 us [MPa]; dark red: above", shrink=0.8)
        figure.savefig(path, dpi=130, facecolor="white")
        plt.close(figure)


def interaction(runs, path):
    """[Cui14] Fig. 12: the interaction region at 32.5 us."""
    with plt.rc_context(RC):
        figure, axes = plt.subplots(1, len(runs), figsize=(2.0 * len(runs) + 2.0, 7.4), layout="compressed",
                                    sharey=True, squeeze=False)
        for a, (title, result) in zip(axes[0], runs.items()):
            if result is None:
                a.set_title(f"{title}: fails")
                continue
            shown = scatter(a, result, TIMES[1], 300)
            a.set_title(title)
        axes[0, 0].set_ylabel("y [mm]")
        figure.colorbar(shown, ax=axes, label="pressure at 32.5 us [MPa]; dark red: above", shrink=0.8)
        figure.savefig(path, dpi=130, facecolor="white")
        plt.close(figure)


def fronts(runs, path):
    """Peak pressure and radius of the front at 20 us, on rays to the interaction region."""
    with plt.rc_context(RC):
        figure, axes = plt.subplots(1, 2, figsize=(10.6, 3.9), layout="constrained")
        colours = (COLOURS[3], COLOURS[1], ORANGE, "#7d4fa3", "#2f8a57")
        for (label, (result, angles)), colour in zip(runs.items(), colours):
            peaks, radii = front_peaks(pressure(result, TIMES[0]), angles)
            degrees = np.degrees(angles - angles.mean())
            for a, values in zip(axes, (peaks / 1e6, radii * 1e3)):
                a.plot(degrees, values, color=colour, linewidth=1.3, label=label)
        for a, title in zip(axes, ("Peak pressure along the front, 20 us [MPa]", "Radius of the front, 20 us [mm]")):
            style(a)
            a.set(title=title, xlabel="angle to the axis of symmetry [degrees]")
        axes[0].set_ylim(bottom=0)
        figure.get_layout_engine().set(rect=(0.0, 0.11, 1.0, 0.89))
        figure.legend(*axes[0].get_legend_handles_labels(), loc="lower center", ncols=3, fontsize=7.5)
        figure.savefig(path, dpi=130, facecolor="white")
        plt.close(figure)


def deviations(result):
    """Arrival, first peak and impulse to 30 us of the gauge in the particles over those of its mirror image in the
    gas."""
    gas, points = (arrival_peak_impulse(result.gauge(name)) for name in (FREE, FRONT))
    return [b / a for a, b in zip(gas, points)]


def gauge_row(name, result, names, impulse=True):
    a, b = (arrival_peak_impulse(result.gauge(n)) for n in names)
    row = [name, "{} / {}".format(*names)]
    for k, factor in enumerate((1e6, 1e-6, 1.0)):
        row += [f"{a[k] * factor:.2f}", f"{b[k] * factor:.2f}", per_cent(b[k] / a[k], 2 if k == 0 else 1)]
    return row if impulse else [*row[:-3], "–", "–", "–"]


def clock(seconds):
    return f"{int(seconds) // 60} min {int(seconds) % 60} s" if seconds >= 60 else f"{seconds:.1f} s"


def run(variants, resolution, target):
    widths = WIDTHS[resolution]
    variants.expect(2 * len(widths) + 2 + {"quick": 0, "standard": 2, "fine": 3}[resolution])
    coupled = {5: variants(CASE, "w5", BASE, GAUGES)}
    alone = variants(CASE, "points-alone", BASE, GAUGES, may_fail=True, text=points_alone())
    linear = variants(CASE, "points-alone-linear", BASE | PAPER_MPM, GAUGES + LINEAR, may_fail=True,
                      text=points_alone())
    dense = None
    if resolution != "quick":
        dense = variants(CASE, "points-alone-dense", BASE, GAUGES, may_fail=True,
                         text=points_alone().replace("points_per_cell = 3", "points_per_cell = 6"))
    coupled |= {w: variants(CASE, f"w{w}", BASE | {"mpm_region.width": w}, GAUGES) for w in widths if w != 5}
    free = {w: variants(CASE, f"no-slab-w{w}", OUTPUT | {"mpm_region.width": w}, GAUGES, text=without_slab())
            for w in widths}
    finer = {}
    if resolution != "quick":
        finer["w = 5, no slab, cells of 1 mm"] = variants(CASE, "no-slab-1mm", OUTPUT | {"cell": "1 mm"}, GAUGES,
                                                          text=without_slab())
    if resolution == "fine":
        finer["w = 5, cells of 1 mm"] = variants(CASE, "w5-1mm", BASE | {"cell": "1 mm"}, GAUGES)

    histories({w: coupled[w] for w in widths}, target / "histories.png")
    contours(coupled[5], target / "contours.png")
    others = {"particles alone": alone, "particles alone, 6 per cell in the charge": dense,
              "particles alone, linear, FLIP, to 20 us": linear}
    others = {label: result for label, result in others.items() if result is not None}
    interaction({"Particles alone": alone, "Gas and particles": coupled[5]}, target / "interaction.png")
    rays = {"gas cells (left half)": (free[5], LEFT), "particles behind the bridge, no slab": (free[5], RIGHT)}
    rays |= {f"{label} (left half)": (result, LEFT) for label, result in others.items()}
    fronts(rays, target / "front.png")

    acceptance = []
    for (what, limit), ratio in zip(LIMITS, deviations(coupled[5])):
        acceptance.append((f"w = 5, gauge in the particles against that in the gas: {what}", per_cent(ratio, 2),
                           f"within {limit:g} %", bool(abs(ratio - 1.0) <= limit / 100.0)))
    noise = {label: front_noise(pressure(result, TIMES[0]), angles) for label, (result, angles) in rays.items()}
    behind = noise["particles behind the bridge, no slab"]
    seconds = coupled[5].seconds
    if alone is not None:
        ratio = alone.seconds / seconds
        acceptance += [("Cost: particles alone over gas and particles",
                        f"{clock(alone.seconds)} / {clock(seconds)} = {ratio:.1f}",
                        "above 1 (paper {} / {} = {:.1f})".format(*map(clock, PAPER_SECONDS),
                                                                  PAPER_SECONDS[0] / PAPER_SECONDS[1]),
                        bool(ratio > 1.0)),
                       ("Noise of the peak along the front at 20 us: behind the bridge against particles alone",
                        f"{100 * behind:.2f} % against {100 * noise['particles alone (left half)']:.2f} %", "below",
                        bool(behind < noise["particles alone (left half)"]))]
    else:
        acceptance.append(("Cost: particles alone over gas and particles", "particles alone fail", "above 1", False))

    gauges = [gauge_row(f"w = {w}", r, (FREE, FRONT)) for w, r in sorted(coupled.items())]
    gauges += [gauge_row(f"w = {w}, no slab", r, (FREE, FRONT)) for w, r in free.items()]
    gauges += [gauge_row(f"w = {w}, no slab", r, DEEP) for w, r in free.items()]
    gauges += [gauge_row(name, r, (FREE, FRONT)) for name, r in finer.items()]
    # Gauges read the gas: with particles alone not the products, which are a body.
    gauges += [gauge_row(label, r, (FREE, FRONT), False) for label, r in others.items() if r is not linear]
    cost = []
    for label, result in ({"gas and particles": coupled[5]} | others).items():
        region = result.log["mpm_region"]
        cost.append([label, f"{result.log['points']['count']:,}", f"{region['gas_steps']:,}",
                     f"{region['point_steps']:,}", f"{result.seconds:.1f}", f"{result.seconds / seconds:.1f}"])
    header = ["run", "gauges"]
    for what, unit in (("arrival", "us"), ("first peak", "MPa"), ("impulse to 30 us", "Pa s")):
        header += [f"{what}, gas [{unit}]", f"particles [{unit}]", "deviation"]
    blocks = [
        ("text", SETUP),
        ("figure", "contours.png", "Pressure at 20 us in the gas cells and in the particles, w = 5 ([Cui14] Fig. 9)"),
        ("figure", "histories.png", "Pressure at two gauges at the same distance from the charge ([Cui14] Figs. 10 and "
                                    "11), and at two more behind the widest bridge"),
        ("table", "The first wave at gauges at the same distance; arrival: half of the first peak, which is taken "
                  "before 25 us", header, gauges),
        ("figure", "interaction.png", "Pressure of the particles of the interaction region at 32.5 us ([Cui14] Fig. "
                                      "12)"),
        ("figure", "front.png", "Peak pressure along the front, and its radius, at 20 us"),
        ("table", "Noise: standard deviation of the peak pressure along the front at 20 us from a smooth curve of "
                  "the angle", ["front in", "noise"], [[k, f"{100 * v:.2f} %"] for k, v in noise.items()]),
        ("table", "Cost, one thread, processor time",
         ["method", "particles at the end", "gas steps", "particle steps", "time [s]", "ratio"], cost),
        ("text", discussion(coupled, free, others, noise, linear)),
    ]
    return {"acceptance": acceptance, "blocks": blocks, "costs": variants.costs}


SETUP = """
<p>A disc of TNT of 50 mm radius at (0, 250) mm in air, in the plane; cells of 2 mm, outflow everywhere. Gas cells cover
x = -180 to 120 mm, material points (particles) 110 to 160 mm; the bridge between them is w = 5 cells wide. The region
of particles contains a slab from 140 to 160 mm, of the library's concrete of 25 MPa; the paper gives neither its
thickness nor its constants. Gauges at (-125, 250) and (125, 250) mm, mirror images of each other, must see the same
first wave. "Particles alone" is the same problem with particles in the whole domain, the charge as a body of particles.
Deck: <code>cases/slab_2d</code>.</p>
"""


def behind_gas(result, gas):
    """How a burst of particles alone differs from that of gas cells on the left, which the slab does not disturb."""
    (late, high), (right, peak) = (arrival_peak_impulse(r.gauge(FREE))[:2] for r in (result, gas))
    lags = np.subtract(*(front_peaks(pressure(r, TIMES[0]), LEFT)[1] for r in (gas, result)))
    middle = len(LEFT) // 2
    aside = np.degrees(LEFT[-1] - LEFT[middle])
    return (f"on the axis of symmetry the wave arrives {1e6 * (late - right):+.1f} us after that of the gas cells with "
            f"{per_cent(high / peak)} in the peak, and at {1e6 * TIMES[0]:g} us the foot of the front lies "
            f"{1e3 * lags[middle]:+.1f} mm behind it on the axis and {1e3 * lags[-1]:+.1f} mm at {aside:.0f} degrees")


def discussion(coupled, free, others, noise, linear):
    """What the runs show, from their values. `others`: {label: particles alone}, without those that failed."""
    deviation = {w: deviations(r) for w, r in coupled.items()}
    agree = listed(f"{what} {per_cent(ratio, 2)}" for (what, _), ratio in zip(LIMITS, deviation[5]))
    spread = listed(f"{what} {100 * (max(r) - min(r)):.2f} %"
                    for (what, _), r in zip(LIMITS, zip(*deviation.values())))
    behind, steps = noise["particles behind the bridge, no slab"], coupled[5].log["mpm_region"]["point_steps"]
    dear = "; ".join(f"{label}: {r.seconds / coupled[5].seconds:.1f} times the time, "
                     f"{r.log['mpm_region']['point_steps'] / steps:.1f} times the steps, noise of the front "
                     f"{noise[f'{label} (left half)'] / behind:.1f} times that behind the bridge"
                     for label, r in others.items())
    wrong = "".join(f" {label[0].upper() + label[1:]}: {behind_gas(r, free[5])}." for label, r in others.items()
                    if r is not linear)
    return f"""
<h3>What it shows</h3>
<ul>
<li><b>The two gauges</b> before the wave reflected by the slab reaches the second, w = 5, particles against gas:
{agree}. The particles smear the first front, so that the rise begins earlier there; the front reflected by the slab,
which runs against a supersonic stream of products, is smeared more.</li>
<li><b>The width of the bridge</b>: over w = {listed(str(w) for w in sorted(coupled))} these deviations differ by at
most: {spread}. In the paper the widest bridge smooths the shock too much. Its bridge interpolates the fluxes and the
state of the interface nodes; this one keeps a ledger and lets whole gas cells act as particles. With the widest bridge
the paper's second gauge lies within it, where this program's gauge reads the gas cells.</li>
<li><b>Particles alone</b> fill the whole domain, and their steps are short because of fast particles beside the
contact. Compared with gas and particles with w = 5: {dear}. The gas cells have
{noise["gas cells (left half)"] / behind:.2f} times the noise of the particles behind the bridge. From
{1e6 * TIMES[0]:g} us on the steps with linear functions become so short that the run ends there.</li>
<li><b>The errors of particles alone</b> are more than noise.{wrong} The particles of the products belong to a body and
are not split like those of the gas: as they expand they drift apart until they are several cells apart (the white
between them in the figure) and push unevenly.</li>
<li><b>The concrete</b> is that of the library with 25 MPa, its tensile damage included; the page
<code>docs/validation/slab.md</code> has an elastic slab.</li>
</ul>
"""
