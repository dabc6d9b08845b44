"""Example 5.3: a charge above a concrete slab on soil. With `quick` the slab is circular and axisymmetric."""
import tomllib

import matplotlib.pyplot as plt
import numpy as np
from common import COLOURS, INK, MUTED, ORANGE, RC, ROOT, Curves, listed, per_cent, span, style

TITLE = "A charge above a concrete slab on soil"
CASE = "paper_slab_3d"
HEIGHT, THICKNESS = 0.5, 0.15  # of the charge's centre above the slab, and the slab's [m]
MASSES = (2.0, 4.0, 10.0, 20.0)
TESTS = {4.0: 0.250, 10.0: 0.300}  # crush diameters [m], [Luccioni06] after [Cui14]
PAPER = {4.0: 0.261}
LIMIT = 0.10
CELLS = {"quick": None, "standard": 25.0, "fine": 12.5}  # of the 3D runs [mm]; none: axisymmetric
FINER = {"quick": (), "standard": (12.5,), "fine": ()}  # cells of further 3D runs of 4 kg [mm]
PLANE_CELL = {"quick": 25.0, "standard": 12.5, "fine": 12.5}  # of the axisymmetric runs of all charges [mm]
PLANE_GRIDS = {"quick": (25.0, 12.5), "standard": (25.0, 12.5, 6.25), "fine": (25.0, 12.5, 6.25, 3.125)}
FLOOR_GRIDS = {"quick": (10.0,), "standard": (10.0, 5.0, 2.5), "fine": (10.0, 5.0, 2.5)}  # the last for all charges
INTERFACES = (("gimp", 500.0), ("linear", 500.0), ("bspline", 500.0), ("gimp", 502.5), ("linear", 502.5))
BROKEN = 0.999  # damage that counts as 1 in files of single precision
MAP = {"cmap": "inferno_r", "vmin": 0.0, "vmax": 1.0}


def empirical(mass):
    """Crush diameter [m], [Cui14] Eq. (67)."""
    return HEIGHT / 3.63 * np.exp(0.1838 * np.cbrt(mass) / HEIGHT)


class Slab:
    """The slab (body 0) in a dump, by the initial positions of its particles."""

    def __init__(self, result, dump):
        dump = dump.read()
        of_slab = dump["body"] == 0
        self.time = dump["time"]
        self.origin = (dump["position"] - dump["displacement"])[of_slab]
        self.values = {k: dump[k][of_slab] for k in ("damage", "compression_damage", "tensile_damage")}
        self.spacing = 0.5 * result.cell_size
        self.plane = result.log["domain"]["geometry"] == "axisymmetric2d"
        self.up = 1 if self.plane else 2  # the vertical direction

    def layer(self, top):
        """The particles of the outermost layer at the front (upper) or back face: a mask."""
        edge = 0.0 if top else -THICKNESS
        return np.abs(self.origin[:, self.up] - edge) < 0.75 * self.spacing

    def lattice(self, top, key="damage"):
        """Damage of a face on its lattice of particles [i] or [i, j], from the centre; -1 where there is none."""
        chosen = self.layer(top)
        across = 1 if self.plane else 2
        index = np.floor(self.origin[chosen][:, :across] / self.spacing).astype(int)
        values = np.full(index.max(axis=0) + 1, -1.0)
        values[tuple(index.T)] = self.values[key][chosen]
        return values

    def central_zone(self, top=True):
        """Particles of a face with damage 1 that are connected with its centre, side by side: a mask on the lattice."""
        broken = self.lattice(top) >= BROKEN
        zone = np.zeros_like(broken)
        zone[(0,) * broken.ndim] = broken[(0,) * broken.ndim]
        while True:
            grown = zone.copy()
            for axis in range(zone.ndim):
                ahead = [slice(None)] * zone.ndim
                behind = [slice(None)] * zone.ndim
                ahead[axis], behind[axis] = slice(1, None), slice(None, -1)
                grown[tuple(ahead)] |= zone[tuple(behind)]
                grown[tuple(behind)] |= zone[tuple(ahead)]
            grown &= broken
            if (grown == zone).all():
                return zone
            zone = grown

    def diameter(self, zone):
        """Diameter of the circle with the area of a zone, images in the symmetry planes included [m]."""
        if self.plane:
            return 2.0 * zone.sum() * self.spacing
        return 2.0 * np.sqrt(4.0 * zone.sum() / np.pi) * self.spacing

    def share(self, top, level=BROKEN):
        """Fraction of the area of a face with at least this damage."""
        damage = self.lattice(top)
        weight = 2.0 * np.arange(len(damage)) + 1.0 if self.plane else np.ones_like(damage)
        there = damage >= 0.0
        return float((weight * (damage >= level)).sum() / (weight * there).sum())


def slabs(result):
    return [Slab(result, dump) for dump in result.point_dumps]


def nearest(shots, time):
    """The dump nearest to a time [s]."""
    return min(shots, key=lambda shot: abs(shot.time - time))


def rings(shot, top, key, edges):
    """Mean of a quantity on a face in rings between radii around the centre [m]."""
    chosen = shot.layer(top)
    radius = np.sqrt((shot.origin[chosen][:, :1 if shot.plane else 2] ** 2).sum(axis=1))
    values = shot.values[key][chosen]
    return [float(values[(radius >= a) & (radius < b)].mean()) for a, b in zip(edges, edges[1:])]


def profile(shot, top, key, width, reach):
    """Radii [m] and means of a quantity on a face in rings of this width, up to `reach`."""
    edges = width * np.arange(round(reach / width) + 1)
    return edges[:-1] + 0.5 * width, np.array(rings(shot, top, key, edges))


def crushing_profile(shot):
    """Radii [m] and mean compression damage of the front face."""
    return profile(shot, True, "compression_damage", 0.025, 1.0)


def diameter_above(radius, values, level):
    """Twice the largest radius [m] at which a profile is at least `level`."""
    above = np.flatnonzero(values >= level)
    if len(above) == 0:
        return 0.0
    k = above[-1]
    if k + 1 == len(radius):
        return 2.0 * radius[k]
    return 2.0 * (radius[k] + (values[k] - level) / (values[k] - values[k + 1]) * (radius[k + 1] - radius[k]))


def history(shots):
    """Times [s] and diameters of the broken zone around the centre of the front face [m]."""
    return np.array([s.time for s in shots]), np.array([s.diameter(s.central_zone()) for s in shots])


def section_figure(axis, shot, key="damage"):
    """Damage in the section through the centre."""
    o = shot.origin
    chosen = np.ones(len(o), bool) if shot.plane else o[:, 1] < 0.75 * shot.spacing
    size = max(0.4, (1e3 * shot.spacing * 0.21) ** 2)
    axis.scatter(1e3 * o[chosen, 0], 1e3 * o[chosen, shot.up], c=shot.values[key][chosen], s=size, marker="s",
                 linewidths=0, **MAP)
    axis.set(aspect="equal", xlim=(0, 1010), ylim=(-160, 10))


def face_figure(axis, shot, top, key="damage"):
    """Damage on a face; the quarter is mirrored to the whole slab."""
    values = shot.lattice(top, key)
    if shot.plane:
        x = np.linspace(-1.0, 1.0, 401)
        radius = np.hypot(*np.meshgrid(x, x))
        index = np.minimum((radius / shot.spacing).astype(int), len(values) - 1)
        picture = np.where(radius <= 1.0, values[index], np.nan)
    else:
        quarter = np.where(values < 0.0, np.nan, values).T
        half = np.hstack([quarter[:, ::-1], quarter])
        picture = np.vstack([half[::-1], half])
    reach = 1e3 * shot.spacing * len(values)
    image = axis.imshow(picture, extent=(-reach, reach, -reach, reach), origin="lower", interpolation="nearest", **MAP)
    axis.set(aspect="equal")
    return image


def damage_figure(shots, path, times):
    """[Cui14] Fig. 14: the faces at some times, and the section."""
    chosen = [nearest(shots, t) for t in times]
    with plt.rc_context(RC):
        figure, axes = plt.subplots(3, len(chosen), figsize=(3.5 * len(chosen), 7.6), layout="constrained",
                                    height_ratios=(1, 1, 0.3), squeeze=False)
        for column, shot in zip(axes.T, chosen):
            image = face_figure(column[0], shot, True)
            face_figure(column[1], shot, False)
            section_figure(column[2], shot)
            column[0].set_title(f"front, {1e3 * shot.time:.1f} ms")
            column[1].set_title(f"back, {1e3 * shot.time:.1f} ms")
            column[2].set_title("section from the centre")
            column[2].set_xlabel("mm")
            for axis in column:
                axis.tick_params(colors=MUTED)
        figure.colorbar(image, ax=axes, shrink=0.5, label="damage D")
        figure.savefig(path, dpi=110, facecolor="white")
        plt.close(figure)


def size_figure(diameters, plane, path):
    """[Cui14] Fig. 15: relative diameter of the crushed zone against the inverse of the scaled distance."""
    mass = np.linspace(1.5, 22.0, 100)
    with plt.rc_context(RC):
        figure, axis = plt.subplots(figsize=(6.4, 4.0), layout="constrained")
        style(axis)
        axis.plot(np.cbrt(mass) / HEIGHT, empirical(mass) / HEIGHT, color=INK, linewidth=1.2, label="[Cui14] Eq. (67)")
        for values, marker, label in ((TESTS, "s", "tests"), (PAPER, "^", "CFDMP, [Cui14]")):
            x, y = [np.cbrt(m) / HEIGHT for m in values], [d / HEIGHT for d in values.values()]
            axis.plot(x, y, marker, color=ORANGE, markersize=6 if marker == "s" else 11, label=label, linestyle="",
                      fillstyle="full" if marker == "s" else "none")
        for values, label, colour in ((diameters, "Brisance, 3D", COLOURS[3]),
                                      (plane, "Brisance, axisymmetric", COLOURS[1])):
            if values:
                axis.plot([np.cbrt(m) / HEIGHT for m in values], [d / HEIGHT for d in values.values()], "o-",
                          color=colour, markersize=5, linewidth=1.0, label=label)
        axis.set(xlabel="W$^{1/3}$/h [kg$^{1/3}$/m]", ylabel="D / h", ylim=(0, None),
                 title="Zone with damage 1 around the centre of the front face, at the end")
        axis.legend()
        figure.savefig(path, dpi=120, facecolor="white")
        plt.close(figure)


def history_figure(panels, path):
    """Growth of the broken zone: a panel for each of (title, [(label, times, diameters, colour)])."""
    with plt.rc_context(RC):
        figure, axes = plt.subplots(1, len(panels), figsize=(5.2 * len(panels), 3.4), layout="constrained", sharey=True,
                                    squeeze=False)
        for axis, (title, lines) in zip(axes[0], panels):
            style(axis)
            for label, times, diameters, colour in lines:
                axis.plot(1e3 * times, 1e3 * diameters, "o-", markersize=3, linewidth=1.1, color=colour, label=label)
            axis.axhspan(1e3 * empirical(MASSES[0]), 1e3 * empirical(MASSES[-1]), color=ORANGE, alpha=0.12, linewidth=0)
            axis.set(title=title, xlabel="time [ms]", ylim=(0, 1500))
            axis.legend()
        axes[0][0].set_ylabel("diameter [mm]")
        figure.savefig(path, dpi=120, facecolor="white")
        plt.close(figure)


def interface_rows(variants):
    """Stress in the outermost particles of an elastic solid behind a gas shock, over that four cells deeper: rows of a
    table, and {(shape function, height of the face): (smallest, largest)} of the outermost particle."""
    text = (ROOT / "cases" / CASE / "interface.toml").read_text()
    rows, first = [], {}
    for shape, face in INTERFACES:
        moved = text.replace('"500 mm"', f'"{face:g} mm"').replace('"650 mm"', f'"{face + 150.0:g} mm"')
        result = variants(CASE, f"interface-{shape}-{face:g}", {"points.shape_function": shape}, text=moved)
        ratios = []
        for dump in result.point_dumps[1:]:
            dump = dump.read()
            slab = dump["body"] == 0
            order = np.argsort((dump["position"] - dump["displacement"])[slab][:, 0])
            stress = dump["stress"][slab][order, 0]
            ratios.append(stress[:4] / stress[8:12].mean())
        ratios = np.array(ratios)
        first[shape, face] = ratios[:, 0].min(), ratios[:, 0].max()
        rows.append([shape, "between cells" if face == 500.0 else "in the middle of a cell",
                     *(f"{a:.2f} to {b:.2f}" for a, b in zip(ratios.min(axis=0), ratios.max(axis=0)))])
    return rows, first


class Floor:
    """A charge over a rigid floor, gas cells alone: the load at its gauges."""

    def __init__(self, variants, mass, cell):
        text = (ROOT / "cases" / CASE / "rigid.toml").read_text()
        result = variants(CASE, f"floor-{mass:g}kg-{cell:g}", {"mass": f"{mass:g} kg", "domain.cell": f"{cell:g} mm"},
                          text=text)
        gauges = [result.gauge(f"floor-{n + 1}") for n in range(result.log["gauges"])]
        self.radius = np.linspace(0.0, 0.8, len(gauges))  # as in the deck
        self.peak = np.array([g["overpressure"].max() for g in gauges])
        self.impulse = np.array([g["impulse"].max() for g in gauges])

    def at(self, quantity, radius):
        """Value of a quantity of `LOADS` at a radius [m]."""
        return float(np.interp(radius, self.radius, getattr(self, quantity)))


# Quantities of `Floor`: (unit of the tables, factor to it, digits).
LOADS = {"peak": ("MPa", 1e-6, 1), "impulse": ("kPa s", 1e-3, 2)}


def load_figure(floors, path):
    """The load over the radius, with the edges of the zones from Eq. (67), and its value at that of 4 kg."""
    with plt.rc_context(RC):
        figure, axes = plt.subplots(1, 2, figsize=(10.0, 3.6), layout="constrained")
        for axis, quantity, label in zip(axes, LOADS, ("peak pressure [Pa]", "impulse [Pa s]")):
            style(axis)
            for (mass, floor), colour in zip(floors.items(), COLOURS):
                axis.semilogy(1e3 * floor.radius, getattr(floor, quantity), color=colour, linewidth=1.4,
                              label=f"{mass:g} kg")
                edge = 0.5 * empirical(mass)
                axis.plot(1e3 * edge, floor.at(quantity, edge), "s", color=ORANGE, markersize=6,
                          label="edge of Eq. (67)" if mass == MASSES[-1] else None)
            axis.axhline(floors[4.0].at(quantity, 0.5 * TESTS[4.0]), color=ORANGE, linewidth=0.9, linestyle="--",
                         label="value at the test of 4 kg")
            axis.set(xlabel="radius [mm]", ylabel=label, xlim=(0, 800))
        axes[0].legend(fontsize=7.5)
        figure.savefig(path, dpi=120, facecolor="white")
        plt.close(figure)


def load_block(floors):
    """The load at the edge of the zone from Eq. (67)."""
    header = ["charge kg", "Eq. (67) mm"]
    for quantity, (unit, _, _) in LOADS.items():
        header += [f"{quantity}, centre {unit}", f"{quantity}, edge {unit}", "edge / centre"]
    rows = []
    for mass, floor in floors.items():
        row = [f"{mass:g}", f"{1e3 * empirical(mass):.0f}"]
        for quantity, (_, scale, digits) in LOADS.items():
            centre, edge = (floor.at(quantity, r) for r in (0.0, 0.5 * empirical(mass)))
            row += [f"{scale * centre:.{digits}f}", f"{scale * edge:.{digits}f}", f"{edge / centre:.2f}"]
        rows.append(row)
    caption = "The load on a rigid floor, at the centre and at the edge of the zone from Eq. (67)"
    return "table", caption, header, rows


def plane_run(variants, mass, cell, **changes):
    text = (ROOT / "cases" / CASE / "axisymmetric.toml").read_text()
    name = f"plane-{mass:g}kg-{cell:g}" + "".join(f"-{v}" for v in changes.values())
    return variants(CASE, name, {"mass": f"{mass:g} kg", "domain.cell": f"{cell:g} mm"} | changes, text=text)


# Other laws of the concrete: (name for files, name, changes of the strength, failure model or None for the library's).
OTHER_LAWS = (("residual", "broken concrete retains its friction (residual = 1)", {"residual": 1.0}, None),
              ("hjc", "[HJC93] alone, no tensile damage", {}, {"model": "none"}))


def other_law(strength, failure):
    """The library's concrete with some keys changed, as a table of the deck."""
    file = tomllib.loads((ROOT / "materials" / "concrete_25mpa.toml").read_text())

    def inline(values):
        return ", ".join(f"{k} = " + (f'"{v}"' if isinstance(v, str) else repr(v)) for k, v in values.items())
    return (f'\n[solids.own]\ndensity = {file["density"]}\n'
            f'eos = {{{inline({"model": "compaction"} | file["eos"])}}}\n'
            f'strength = {{{inline(file["strength"] | strength)}}}\n'
            f'failure = {{{inline(file["failure"] if failure is None else failure)}}}\n')


def other_rows(variants, plane):
    """Results of other laws of the concrete for 4 and 10 kg, axisymmetric."""
    text = (ROOT / "cases" / CASE / "axisymmetric.toml").read_text().replace('"concrete-25MPa"', '"own"')
    rows = []
    for mass in (4.0, 10.0):
        runs = [("the library's", plane[mass][0])]
        for short, name, strength, failure in OTHER_LAWS:
            result = variants(CASE, f"tried-{short}-{mass:g}", {"mass": f"{mass:g} kg"},
                              text=text + other_law(strength, failure))
            runs.append((name, slabs(result)))
        for name, shots in runs:
            last = shots[-1]
            crushing = last.lattice(True, "compression_damage")
            half = 2.0 * (crushing >= 0.5).sum() * last.spacing
            rows.append([f"{mass:g}", name, f"{1e3 * last.diameter(last.central_zone()):.0f}",
                         f"{100 * last.share(True):.0f} %", f"{100 * last.share(False):.0f} %", f"{crushing.max():.2f}",
                         f"{1e3 * half:.0f}"])
    return rows


def solid_run(variants, mass, cell):
    return variants(CASE, f"{mass:g}kg-{cell:g}", {"mass": f"{mass:g} kg", "domain.cell": f"{cell:g} mm"})


def drift(result):
    return f"{100.0 * result.log['points']['audit']['energy']['drift']:+.1f} %"


def back_face(shots):
    """Times and diameters of the broken zone around the centre of the back face, until a quarter of the face is broken
    (a larger disc approaches the edges of the slab, which is square: it is 1.19 at a third); and its roundness at the
    last of them: its reach along the diagonal over that along the edge."""
    early = [s for s in shots if 0.0 < s.share(False) < 0.25]
    zones = [s.central_zone(top=False) for s in early]
    if not zones:
        return [], [], np.nan
    last = zones[-1]
    if early[-1].plane:
        round_by = 1.0
    else:
        diagonal = np.sqrt(2.0) * np.diagonal(last).sum()
        round_by = diagonal / (0.5 * (last[0].sum() + last[:, 0].sum())) if last.any() else np.nan
    return [s.time for s in early], [s.diameter(z) for s, z in zip(early, zones)], round_by


def sizes_block(solid, plane):
    """Table of the diameters of all charges."""
    header = ["charge kg", "Eq. (67) mm", "test mm", "CFDMP, paper mm", "Brisance 3D mm", "deviation from Eq. (67)",
              "Brisance axisymmetric mm", "largest D_c on the front, 3D", "energy drift, 3D"]
    rows = []
    for mass in MASSES:
        row = [f"{mass:g}", f"{1e3 * empirical(mass):.0f}", f"{1e3 * TESTS[mass]:.0f}" if mass in TESTS else "–",
               f"{1e3 * PAPER[mass]:.0f}" if mass in PAPER else "–"]
        shots, result = solid.get(mass, (None, None))
        if shots:
            diameter = history(shots)[1][-1]
            row += [f"{1e3 * diameter:.0f}", per_cent(diameter / empirical(mass), 0)]
        else:
            row += ["–", "–"]
        row.append(f"{1e3 * history(plane[mass][0])[1][-1]:.0f}")
        row += ([f"{shots[-1].lattice(True, 'compression_damage').max():.2f}", drift(result)] if shots
                else ["–", "–"])
        rows.append(row)
    return "table", "Zone with damage 1 around the centre of the front face at the end of the runs, 1 ms", header, rows


def growth_block(runs):
    """Table of the diameters over time. `runs`: {mass: (shots, result)}."""
    times = [0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
    rows = []
    for mass, (shots, _) in runs.items():
        row = [f"{mass:g}"]
        for t in times:
            shot = nearest(shots, 1e-3 * t)
            row.append(f"{1e3 * shot.diameter(shot.central_zone()):.0f}")
        rows.append(row)
    return "table", "The same zone over time [mm]", ["charge kg", *(f"{t:g} ms" for t in times)], rows


def crushing_block(runs):
    """Compression damage alone, after the first wave has passed."""
    rows = []
    for mass, shot in after_the_wave(runs).items():
        damage = crushing_profile(shot)
        rows.append([f"{mass:g}", *(f"{np.interp(r, *damage):.3f}" for r in (0.0, 0.125, 0.25, 0.5))])
    return ("table", "Mean compression damage D_c of the front face at 0.3 ms, when the first wave has passed",
            ["charge kg", "centre", "at 125 mm", "at 250 mm", "at 500 mm"], rows)


def after_the_wave(runs):
    return {m: nearest(shots, 0.3e-3) for m, (shots, _) in runs.items()}


def fitted_block(runs, floors):
    """Zones from a threshold of each local measure of the load, fitted to the test of 4 kg."""
    measures = (("peak pressure on a rigid floor", "{:.3g} MPa",
                 {m: (f.radius, 1e-6 * f.peak) for m, f in floors.items()}),
                ("impulse on a rigid floor", "{:.3g} kPa s",
                 {m: (f.radius, 1e-3 * f.impulse) for m, f in floors.items()}),
                ("mean D_c of the front face at 0.3 ms", "{:.3f}",
                 {m: crushing_profile(shot) for m, shot in after_the_wave(runs).items()}))
    rows = []
    for name, value, profiles in measures:
        level = np.interp(0.5 * TESTS[4.0], *profiles[4.0])
        rows.append([name, value.format(level),
                     *(f"{1e3 * diameter_above(*profiles[m], level):.0f}" for m in MASSES)])
    rows.append(["Eq. (67)", "–", *(f"{1e3 * empirical(m):.0f}" for m in MASSES)])
    return ("table", "Diameter [mm] within which a measure of the load exceeds that at the edge of the test of 4 kg",
            ["measure", "value", *(f"{m:g} kg" for m in MASSES)], rows)


def acceptance_of(runs, what):
    lines = []
    for mass in MASSES:
        target = empirical(mass)
        last = runs[mass][0][-1]
        diameter = last.diameter(last.central_zone())
        whole = ", the whole face" if last.share(True) > 0.99 else ""
        test = f", test {1e3 * TESTS[mass]:.0f} mm" if mass in TESTS else ""
        lines.append((f"diameter of the crushed zone on the front face, {mass:g} kg, {what}",
                      f"{1e3 * diameter:.0f} mm ({per_cent(diameter / target, 0)}){whole}",
                      f"{1e3 * target:.0f} mm{test}, within {100 * LIMIT:g} %",
                      bool(abs(diameter / target - 1.0) <= LIMIT)))
    return lines


DEFINITION = """<p><b>What is measured.</b> The paper calls a material point (particle) failed when its damage reaches 1
and shows the failed area of the front face. So does this page: it counts the particles of the outermost layer whose
damage D = 1 - (1 - D_c)(1 - D_t) is 1 and which are connected with the centre, at the end of the run (1 ms); the
diameter is that of a circle with their area. The definition follows the paper's words, and no constant was fitted: the
concrete is <code>concrete-25MPa</code> of the library, whose tensile damage is calibrated on strength against
rate.</p>"""


def kingery_bulmash(variants, mass, key):
    """Value for the charge at its height over the slab."""
    return Curves(variants.program, mass)("spherical", HEIGHT, key)


def on_the_load(variants, under_four):
    """The load of 4 kg on a rigid floor. `under_four`: {cell [mm]: Floor}."""
    impulse = kingery_bulmash(variants, 4.0, "reflected_impulse")
    off = [100.0 * (floor.impulse[0] / impulse - 1.0) for floor in under_four.values()]
    return f"""<p><b>The load.</b> On the grids of the table, gas cells over a rigid floor give an impulse below the
charge that deviates by {span(off, "{:+.0f}")} % from Kingery and Bulmash; the peak is spread over the cells and depends
on the grid.</p>"""


def on_thresholds(variants, floors):
    """Whether a law that breaks a particle by its own load history can give the zones of Eq. (67)."""
    small, large = floors[MASSES[0]], floors[MASSES[-1]]
    edge = {m: 0.5 * empirical(m) for m in MASSES}
    growth = [large.at(q, 0.0) / small.at(q, 0.0) for q in LOADS]
    edges = [large.at(q, edge[MASSES[-1]]) / small.at(q, edge[MASSES[0]]) for q in LOADS]
    fall = [100.0 * (1.0 - floor.at(q, edge[m]) / floor.at(q, 0.0)) for m, floor in floors.items() for q in LOADS]
    by_curves = [kingery_bulmash(variants, m, "reflected_impulse") for m in MASSES]
    # No threshold lies below the load at the edge of the largest zone and above all loads of the smallest charge.
    impossible = all(large.at(q, edge[MASSES[-1]]) > small.at(q, 0.0) for q in LOADS)
    far = large.impulse[-1], small.impulse[0]
    head = ("No damage that grows with the load at its place can give the diameters of Eq. (67)." if impossible else
            "Damage that grows with the load at its place, and the diameters of Eq. (67).")
    end = (f"""A law by which a particle breaks because of its own load history, with one set of constants for all
charges, breaks nothing at {MASSES[0]:g} kg or more than the zone of Eq. (67) at {MASSES[-1]:g} kg. """
           if impossible else "")
    return f"""<p><b>{head}</b> From {MASSES[0]:g} to {MASSES[-1]:g} kg its zone grows by a factor of
{edge[MASSES[-1]] / edge[MASSES[0]]:.1f}, the load on the slab by factors of {span(growth, "{:.1f}")}. At the edge of
the zone the load is {span(edges, "{:.1f}")} times as large for {MASSES[-1]:g} kg as for {MASSES[0]:g} kg, but below one
charge it falls only by {span(fall, "{:.0f}")} % from the centre to that edge; Kingery and Bulmash's reflected impulse
at {HEIGHT:g} m grows {by_curves[-1] / by_curves[0]:.1f}-fold. {large.radius[-1]:g} m from the axis {MASSES[-1]:g} kg
produces an impulse of {1e-3 * far[0]:.1f} kPa s, {MASSES[0]:g} kg at the centre {1e-3 * far[1]:.1f}. {end}The second
table below shows the zones from thresholds of the load and of D_c that are fitted to 4 kg. Why the zones were so small
is not known; of the tests to which Eq. (67) was fitted, [Cui14] names two.</p>"""


def on_the_interface(first):
    """The stress of the outermost particle over that four cells deeper. `first`: {(shape, height of the face):
    (smallest, largest)}."""
    def told(face):
        return listed(f"{low:.2f} to {high:.2f} ({shape})" for (shape, at), (low, high) in first.items() if at == face)
    between, within = INTERFACES[0][1], INTERFACES[-1][1]
    return f"""<p><b>Which shape function.</b> The gas slips along the solids and presses on the area that they present
to the nodes. The table gives the stress of the four outermost particles of an elastic solid behind a shock, over the
mean four cells deeper (1 is correct, somewhat more while the wave enters). Where the face lies between cells the
outermost particles bear {told(between)} of it, in the middle of a cell {told(within)}: gas cannot be compressed in a
cell whose nodes are constrained by the solid. These decks have <code>shape_function = "gimp"</code> and their upper
face between cells.</p>"""


def discussion(what, main, floors, sizes):
    """`main`: {mass: (shots, result)}; `sizes`: diameters of the zone of 4 kg on all grids [m]."""
    shots = main[4.0][0]
    file = tomllib.loads((ROOT / "materials" / "concrete_25mpa.toml").read_text())
    opening = file["failure"]["fracture_energy"] / file["failure"]["sigma0"]
    speed = floors[4.0].impulse[0] / (file["density"] * THICKNESS)
    crushing = max(s[-1].lattice(True, "compression_damage").max() for s, _ in main.values())
    before, last = nearest(shots, 0.8e-3), shots[-1]
    drifts = [100.0 * r.log["points"]["audit"]["energy"]["drift"] for _, r in main.values()]
    cell = 1e3 * main[4.0][1].cell_size
    return f"""<p><b>Where we differ, and why.</b></p><ul>
<li>Compression damage: at most {crushing:.2f} at single particles of the front face, whatever the charge. [HJC93]
requires a plastic strain of {file["strength"]["D1"]:g} (p + T)/fc. Other constants would increase it everywhere, but
not give it an edge: see above.</li>
<li>The concrete breaks in tension, after the pressure has vanished: the back spalls, the slab bends. Cracks in plain
concrete count as broken when they have opened by {1e6 * opening:.0f} um (G_f / sigma_0), and an impulse of
{1e-3 * floors[4.0].impulse[0]:.1f} kPa s gives this slab {speed:.0f} m/s at its centre: at {1e3 * last.time:.1f} ms
{100 * last.share(True):.0f} % of the front and {100 * last.share(False):.0f} % of the back face are broken (4 kg,
{what}). A crack that leaves two sound halves and concrete that is ground to powder both have D = 1.</li>
<li>The disc over time: at 4 kg it changes from {1e3 * before.diameter(before.central_zone()):.0f} mm at
{1e3 * before.time:.1f} ms to {1e3 * last.diameter(last.central_zone()):.0f} mm at {1e3 * last.time:.1f} ms, when the
run ends. Where the disc and the ring outside it meet, the number shows how much of the slab is cracked, not how much is
crushed.</li>
<li>The grid: at 4 kg the zone is {span([d / TESTS[4.0] for d in sizes], "{:.1f}")} times the measured one on the grids
of the table. It depends on cracks of the bending face that are only just broken or not: agreement on one grid proves
nothing. Separate radial cracks would need cells of some mm in 3D.</li>
<li>Other laws, without any fit ("Other laws", standard and fine): the result depends on how tensile damage is counted,
which the paper does not state.</li>
<li>Energy: the drift of the {what} runs on cells of {cell:g} mm is {span(drifts, "{:+.1f}")} %.</li>
</ul>"""


def run(variants, resolution, target):
    cell, plane_cell = CELLS[resolution], PLANE_CELL[resolution]
    order = (4.0, 10.0, 2.0, 20.0)
    grids = PLANE_GRIDS[resolution]
    regularised = [("crack_band", g) for g in grids] + [("none", plane_cell)]
    variants.expect((4 if cell else 0) + len(FINER[resolution]) + len(MASSES) + len(regularised) - 1
                    + (2 * len(OTHER_LAWS) if cell else 0) + len(INTERFACES) + len(FLOOR_GRIDS[resolution])
                    + len(MASSES) - 1)
    solid = {}
    if cell:
        results = {m: solid_run(variants, m, cell) for m in order}
        solid = {m: (slabs(results[m]), results[m]) for m in MASSES}
    results = {m: plane_run(variants, m, plane_cell) for m in order}
    plane = {m: (slabs(results[m]), results[m]) for m in MASSES}
    meshes = {}
    for law, g in regularised:
        result = plane[4.0][1] if (law, g) == ("crack_band", plane_cell) else plane_run(
            variants, 4.0, g, **({"points.regularisation": law} if law != "crack_band" else {}))
        meshes[law, g] = (slabs(result), result)
    others = other_rows(variants, plane) if cell else []
    interface, first = interface_rows(variants)
    *coarser, finest = FLOOR_GRIDS[resolution]
    floors = {m: Floor(variants, m, finest) for m in MASSES}
    under_four = {g: Floor(variants, 4.0, g) for g in coarser} | {finest: floors[4.0]}
    floor = [[f"{g:g}", f"{1e-6 * f.peak[0]:.1f}", f"{1e-3 * f.impulse[0]:.2f}"] for g, f in under_four.items()]

    main = solid or plane
    what = "3D" if solid else "axisymmetric"
    shots = main[4.0][0]
    damage_figure(shots, target / "slab3d_damage.png", (0.3e-3, 0.5e-3, 1.0e-3))
    final, final_plane = ({m: history(s)[1][-1] for m, (s, _) in runs.items()} for runs in (solid, plane))
    size_figure(final, final_plane, target / "slab3d_size.png")
    charges = [(f"{m:g} kg", *history(s), c) for (m, (s, _)), c in zip(main.items(), COLOURS)]
    compared = [(f"{g:g} mm" + ("" if law == "crack_band" else ", no crack band"), *history(s), c)
                for ((law, g), (s, _)), c in zip(meshes.items(), (*COLOURS[-len(grids):], ORANGE))]
    panels = [(f"{what}, all charges", charges), ("4 kg, axisymmetric", compared)]
    history_figure(panels, target / "slab3d_history.png")
    load_figure(floors, target / "slab3d_load.png")

    times, diameters, round_by = back_face(shots)
    spreading = (len(diameters) >= 2 and diameters[0] < diameters[-1]
                 and all(a <= b for a, b in zip(diameters, diameters[1:])))
    spread = ", ".join(f"{1e3 * d:.0f} mm at {1e3 * t:.2f} ms" for t, d in zip(times[-3:], diameters[-3:]))
    acceptance = acceptance_of(main, what)
    acceptance.append((f"back face, 4 kg, {what}: the damage spreads from the centre in all directions alike",
                       f"disc of {spread}; reach along the diagonal / along the edge {round_by:.2f}",
                       "a growing disc around the centre, round to 10 %, until a quarter of the face is broken",
                       bool(spreading and abs(round_by - 1.0) <= 0.1)))
    mesh_rows = []
    finer = [(g, solid_run(variants, 4.0, g)) for g in FINER[resolution]]
    in_space = [(f"3D, {g:g}", slabs(r), r) for g, r in ([(cell, solid[4.0][1])] if cell else []) + finer]
    in_plane = [(f"{law}, {g:g}", s, r) for (law, g), (s, r) in meshes.items()]
    for name, s, result in in_space + in_plane:
        last = s[-1]
        mesh_rows.append([name, f"{1e3 * last.diameter(last.central_zone()):.0f}",
                          f"{100 * last.share(True):.0f} %", f"{100 * last.share(False):.0f} %",
                          f"{last.lattice(True, 'compression_damage').max():.2f}", drift(result)])
    sizes = [s[-1].diameter(s[-1].central_zone())
             for _, s, _ in in_space + [shown for shown in in_plane if shown[0].startswith("crack_band")]]
    kb = [kingery_bulmash(variants, 4.0, f"reflected_{key}") for key in ("overpressure", "impulse")]
    of_laws = [("table", f"Other laws of the concrete, axisymmetric, {plane_cell:g} mm, at 1 ms",
                ["charge kg", "law", "zone mm", "front face broken", "back face broken", "largest D_c, front",
                 "twice the radial extent with D_c of 1/2, front, mm"], others)] if others else []
    blocks = [("text", DEFINITION),
              sizes_block(solid, plane),
              ("figure", "slab3d_size.png", "Diameter of the zone over the height of the charge, as [Cui14] Fig. 15"),
              ("figure", "slab3d_damage.png",
               f"4 kg, {what}: damage of the front and the back face and in a section, as [Cui14] Fig. 14"
               + (" (axisymmetric: rotated around the axis)" if not solid else "")),
              growth_block(main),
              ("figure", "slab3d_history.png", "Zone with damage 1 around the centre of the front face; the band spans "
               f"the diameters of Eq. (67) from {MASSES[0]:g} to {MASSES[-1]:g} kg"),
              crushing_block(main),
              ("text", on_thresholds(variants, floors)),
              ("figure", "slab3d_load.png", "The load of the four charges on a rigid floor. A law with a threshold of "
               "the load, a horizontal line, cannot have its edges at the squares"),
              load_block(floors),
              fitted_block(main, floors),
              ("table", "4 kg: the grid and, axisymmetric, the crack band, at 1 ms",
               ["run, cell mm", "zone mm", "front face broken", "back face broken", "largest D_c, front",
                "energy drift"], mesh_rows),
              *of_laws,
              ("text", on_the_load(variants, under_four)),
              ("table", f"4 kg over a rigid floor, below the charge; Kingery and Bulmash: {1e-6 * kb[0]:.1f} MPa, "
               f"{1e-3 * kb[1]:.2f} kPa s",
               ["cell mm", "peak MPa", "impulse kPa s"], floor),
              ("text", on_the_interface(first)),
              ("table", "Stress of the outermost particles of an elastic solid over that four cells deeper, at five "
               "times behind a gas shock",
               ["shape function", "position of the face", "first", "second", "third", "fourth"], interface),
              ("text", discussion(what, main, floors, sizes))]
    return {"acceptance": acceptance, "blocks": blocks}
