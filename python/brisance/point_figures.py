"""Figures of runs of material points (particles). Each function returns images as HTML, or None if there is nothing to
show."""
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from brisance.figures import BLUE, INK, MUTED, ORANGE, TIME_COLOURS, chosen, image, nice_ceiling

GREEN = "#2f8a57"
DIRECTIONS = (BLUE, ORANGE, GREEN)
# Particles at rest and without stress are light grey, not white: they must stand out from the page.
RISING = LinearSegmentedColormap.from_list("rising", [
    (0.0, "#dde3ea"), (0.2, "#a9c6dd"), (0.4, "#5b9bc4"), (0.55, "#f3d27a"), (0.75, "#e0702f"), (0.9, "#a81e2b"),
    (1.0, "#4a0716")])
BALANCED = LinearSegmentedColormap.from_list("balanced", [
    (0.0, "#123a6b"), (0.25, "#3f7fbf"), (0.42, "#b9d6ee"), (0.5, "#e8ebee"), (0.58, "#fbd9a3"), (0.75, "#dd5a2e"),
    (1.0, "#6d0b1d")])
BODIES = ListedColormap(["#4f7fae", "#d08a3f", "#5fa37a", "#9c6ba8", "#b8544f", "#8a8f45", "#4aa3ad", "#7d6b5a"])

# Field, factor, label, whether it has a sign.
QUANTITIES = (("mises", 1e-6, "Mises stress [MPa]", False),
              ("plastic_strain", 1.0, "plastic strain [-]", False),
              ("pressure", 1e-6, "pressure [MPa]", True),
              ("velocity", 1.0, "speed [m/s]", False))
LARGEST_SQUARE_COUNT = 40000   # above it particles are drawn as an image
LARGEST_GAUGE_COUNT = 10
LARGEST_BODY_COUNT = 6
PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))


def scaled(largest, unit):
    """Factor and unit with the SI prefix in which the largest value is between 1 and 1000."""
    for size, prefix in PREFIXES:
        if abs(largest) >= size:
            return 1.0 / size, prefix + unit
    return 1.0, unit


def time_title(run, time):
    factor, unit = scaled(run.log["time"], "s")
    return f"t = {time * factor:.4g} {unit}"


def spacing(run):
    """Smallest initial distance between particles [m]."""
    return run.log["domain"]["cell_size"] / max(body["points_per_direction"] for body in run.points["bodies"])


def available(run):
    """The quantities in the dumps that are not zero everywhere."""
    out = []
    for quantity in QUANTITIES:
        if quantity[0] in run.point_dumps[-1].fields and any(
                np.any(dump.values(quantity[0])) for dump in filled(run)):
            out.append(quantity)
    return out


def filled(run):
    return [dump for dump in run.point_dumps if dump.count > 0]


def scalar(dump, field, factor):
    values = dump.values(field)
    return (np.linalg.norm(values, axis=1) if values.ndim == 2 else values) * factor


def scale(planes, signed):
    """Colour scale for all times. The few highest values do not use up the colours."""
    everything = np.concatenate(planes)
    top = float(np.quantile(np.abs(everything), 0.99 if signed else 0.998))
    if top <= 0.0:
        top = float(np.abs(everything).max()) or 1.0
    top = nice_ceiling(top) if nice_ceiling(top) < 1.3 * top else top
    return Normalize(-top if signed else 0.0, top)


# --- pictures of the points

class Flat:
    """Particles drawn in a plane: all of them in 2D, the layer next to a plane in 3D."""

    def __init__(self, run, normal=2):
        self.run = run
        self.normal = normal
        self.horizontal, self.vertical = [d for d in range(3) if d != normal]
        self.mirrored = run.geometry == "axisymmetric2d"
        self.three_dimensional = run.dimensions == 3
        self.size = spacing(run)
        self.dumps = filled(run)
        self.position = None
        if self.three_dimensional:
            self.position = self._plane()
        low, high = np.full(2, np.inf), np.full(2, -np.inf)
        for dump in self.dumps:
            x = self.flat(dump)[self.chosen(dump)]
            if len(x):
                low, high = np.minimum(low, x.min(axis=0)), np.maximum(high, x.max(axis=0))
        if self.mirrored:
            low[0] = -high[0]
        margin = 0.04 * (high - low).max() + self.size
        self.low, self.high = low - margin, high + margin

    def _plane(self):
        """A symmetry plane at the low face if there is one, otherwise the plane that halves the last particles."""
        domain = self.run.log["domain"]
        if domain["boundary"][2 * self.normal] == "symmetry":
            return domain["lower"][self.normal] + 0.5 * self.size
        return float(np.median(self.dumps[-1].values("position")[:, self.normal]))

    @property
    def title(self):
        if not self.three_dimensional:
            return ""
        domain = self.run.log["domain"]
        name = "xyz"[self.normal]
        if domain["boundary"][2 * self.normal] == "symmetry":
            return f"symmetry plane {name} = {domain['lower'][self.normal]:.4g} m"
        return f"plane {name} = {self.position:.4g} m"

    @property
    def aspect(self):
        return (self.high[1] - self.low[1]) / (self.high[0] - self.low[0])

    def flat(self, dump):
        return dump.values("position")[:, [self.horizontal, self.vertical]]

    def chosen(self, dump):
        if not self.three_dimensional:
            return np.arange(dump.count)
        away = np.abs(dump.values("position")[:, self.normal] - self.position)
        inside = np.flatnonzero(away <= 0.8 * self.size)
        return inside[np.argsort(-away[inside], kind="stable")]  # the nearest on top

    def draw(self, panel, dump, values, norm, colours):
        which = self.chosen(dump)
        x, values = self.flat(dump)[which], values[which]
        if self.mirrored:
            x = np.concatenate([x, x * [-1.0, 1.0]])
            values = np.concatenate([values, values])
        factor = self.factor
        if len(x) > LARGEST_SQUARE_COUNT:
            drawn = self._image(panel, x, values, norm, colours)
        else:
            # Larger squares below: where the material has stretched, the page does not show between its particles.
            for half in (1.1, 0.53):
                corners = half * self.size * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
                drawn = PolyCollection((x[:, None, :] + corners[None]) * factor, array=values, norm=norm, cmap=colours,
                                       edgecolors="none", rasterized=True)
                panel.add_collection(drawn)
        panel.set_xlim(self.low[0] * factor, self.high[0] * factor)
        panel.set_ylim(self.low[1] * factor, self.high[1] * factor)
        panel.set_aspect("equal")
        panel.grid(False)
        panel.xaxis.set_major_locator(MaxNLocator(4))
        panel.yaxis.set_major_locator(MaxNLocator(6))
        return drawn

    def _image(self, panel, x, values, norm, colours):
        """Mean of the particles in each pixel; a pixel is at least as wide as the particle spacing."""
        pixel = max(1.02 * self.size, (self.high - self.low).max() / 900)
        counts = np.ceil((self.high - self.low) / pixel).astype(int)
        at = np.clip(((x - self.low) / pixel).astype(int), 0, counts - 1)
        index = at[:, 0] + counts[0] * at[:, 1]
        number = np.bincount(index, minlength=counts.prod())
        total = np.bincount(index, weights=values, minlength=counts.prod())
        number, total = (a.astype(float).reshape(counts[1], counts[0]) for a in (number, total))
        # Where the material has stretched, its neighbours fill the gaps.
        shifts = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]
        around = sum(np.roll(number, shift, (0, 1)) for shift in shifts)
        gap = (number == 0) & (sum(np.roll(number > 0, shift, (0, 1)).astype(int) for shift in shifts) >= 4)
        total = np.where(gap, sum(np.roll(total, shift, (0, 1)) for shift in shifts), total)
        number = np.where(gap, around, number)
        mean = np.ma.masked_where(number == 0, total / np.maximum(number, 1))
        extent = np.array([self.low[0], self.low[0] + counts[0] * pixel, self.low[1], self.low[1] + counts[1] * pixel])
        return panel.imshow(mean, origin="lower", extent=extent * self.factor, norm=norm, cmap=colours,
                            interpolation="nearest")

    @property
    def factor(self):
        return scaled((self.high - self.low).max(), "m")[0]

    def label(self, panel, horizontal, vertical):
        unit = scaled((self.high - self.low).max(), "m")[1]
        if horizontal:
            panel.set_xlabel(f"{self.run.axes[self.horizontal]} [{unit}]")
        if vertical:
            panel.set_ylabel(f"{self.run.axes[self.vertical]} [{unit}]")


def sheet(run, flat, dumps, planes, norm, colours, label, kinds=None):
    """One quantity at several times."""
    rows = len(dumps) if flat.aspect < 0.28 else 1
    columns = len(dumps) // rows
    room = 9.0 / columns
    height = rows * (min(room * flat.aspect, 4.6) + 0.45) + (0.6 if flat.title else 0.35)
    figure = Figure(figsize=(10.2, max(height, 2.0)), layout="constrained")
    panels = np.atleast_1d(figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)).ravel()
    for n, (panel, dump, values) in enumerate(zip(panels, dumps, planes)):
        drawn = flat.draw(panel, dump, values, norm, colours)
        panel.set_title(time_title(run, dump.time))
        flat.label(panel, horizontal=n + columns >= len(dumps), vertical=n % columns == 0)
        if flat.mirrored:
            panel.axvline(0.0, color=MUTED, linewidth=0.5, linestyle=(0, (6, 4)))
    if flat.title:
        figure.suptitle(flat.title, x=0.008, ha="left", fontsize=8.5, color=MUTED)
    if kinds is None:
        ends = {"extend": "both" if norm.vmin < 0 else "max"}
        bar = figure.colorbar(drawn, ax=panels.tolist(), shrink=0.92, pad=0.015, aspect=28, **ends)
        bar.set_label(label)
    else:
        for n, kind in enumerate(kinds):
            panels[-1].plot([], [], marker="s", linestyle="none", color=BODIES(n % BODIES.N), label=kind)
        panels[-1].legend(loc="center left", bbox_to_anchor=(1.02, 0.5))
    return image(figure, "png", alt=label)


def shown_dumps(run, flat):
    """First, middle and last dump; for slender bodies, which leave room, some more."""
    dumps = filled(run)
    most = 6 if flat.aspect > 1.9 else 4 if flat.aspect > 1.4 else 3
    return [dumps[i] for i in chosen(len(dumps), most)]


def planes_of(run):
    if run.dimensions == 2:
        return [Flat(run)]
    return [Flat(run, 1), Flat(run, 2)]


def pictures(run):
    """The particles of two- and three-dimensional runs, coloured by the main quantities."""
    if run.dimensions == 1 or not filled(run):
        return None
    out = []
    for flat in planes_of(run):
        dumps = shown_dumps(run, flat)
        names = [body["name"] for body in run.points["bodies"]]
        if len(names) > 1:
            planes = [dump.values("body") for dump in dumps]
            kinds = [f"{name} ({body['material']})" for name, body in zip(names, run.points["bodies"])][:BODIES.N]
            out.append(sheet(run, flat, dumps, [p % BODIES.N for p in planes], Normalize(-0.5, BODIES.N - 0.5), BODIES,
                             "bodies", kinds))
        for field, factor, label, signed in available(run):
            planes = [scalar(dump, field, factor) for dump in dumps]
            seen = [plane[flat.chosen(dump)] for plane, dump in zip(planes, dumps)]
            norm = scale(seen, signed)
            out.append(sheet(run, flat, dumps, planes, norm, BALANCED if signed else RISING, label))
    return "\n".join(out)


# --- outer view

def view_axes(run):
    """Unit vectors to the right, up and towards the eye; the eye is on the side away from symmetry planes."""
    boundary = run.log["domain"]["boundary"]
    side = [-1.0 if boundary[2 * d + 1] == "symmetry" else 1.0 for d in range(3)]
    if boundary[2] != "symmetry" and boundary[3] != "symmetry":
        side[1] = -1.0
    eye = np.array([0.55 * side[0], 0.75 * side[1], 0.5 * side[2]])
    eye /= np.linalg.norm(eye)
    right = np.cross([0.0, 0.0, 1.0], eye)
    right /= np.linalg.norm(right)
    return right, np.cross(eye, right), eye


def smoothed(depth, inside, times):
    for _ in range(times):
        total, weight = np.zeros_like(depth), np.zeros_like(depth)
        for shift in ((0, 0), (0, 1), (0, -1), (1, 0), (-1, 0)):
            mask = np.roll(inside, shift, (0, 1))
            total += np.where(mask, np.roll(depth, shift, (0, 1)), 0.0)
            weight += mask
        depth = np.where(inside, total / np.maximum(weight, 1), depth)
    return depth


def splat(points, values, size, low, high, axes):
    """Each particle as a ball seen along the third axis: the visible values and the brightness of each pixel."""
    right, up, eye = axes
    radius = 0.95 * size
    pixel = max(size / 2.5, (high - low).max() / 520)
    shape = np.ceil((high - low) / pixel).astype(int) + 1
    u, v, w = points @ right, points @ up, points @ eye
    column, row = ((u - low[0]) / pixel).astype(int), ((v - low[1]) / pixel).astype(int)
    depth = np.full(shape[0] * shape[1], -np.inf)
    owner = np.full(shape[0] * shape[1], -1)
    order = np.argsort(w, kind="stable")
    reach = max(int(radius / pixel), 0)
    for i in range(-reach, reach + 1):
        for j in range(-reach, reach + 1):
            rest = radius ** 2 - (i * i + j * j) * pixel ** 2
            if rest < 0.0:
                continue
            at_column, at_row = column[order] + i, row[order] + j
            inside = (at_column >= 0) & (at_column < shape[0]) & (at_row >= 0) & (at_row < shape[1])
            at = at_row[inside] * shape[0] + at_column[inside]
            mine = w[order][inside] + np.sqrt(rest)
            # The particles are ordered from the farthest to the nearest: in a pixel the last assignment remains.
            top = np.full(depth.size, -np.inf)
            who = np.full(depth.size, -1)
            top[at] = mine
            who[at] = order[inside]
            nearer = top > depth
            depth[nearer], owner[nearer] = top[nearer], who[nearer]
    inside = (owner >= 0).reshape(shape[1], shape[0])
    depth = np.where(inside, depth.reshape(shape[1], shape[0]), 0.0)
    flat = smoothed(depth, inside, 4)
    slope_row, slope_column = np.gradient(flat, pixel)
    light = np.array([-0.35, 0.45, 0.82])
    brightness = (-slope_column * light[0] - slope_row * light[1] + light[2]) / np.sqrt(
        1.0 + slope_column ** 2 + slope_row ** 2)
    brightness = 0.45 + 0.6 * np.clip(brightness, 0.0, 1.0)
    return values[np.maximum(owner, 0)].reshape(shape[1], shape[0]), brightness, inside


def outer_view(run):
    """Three-dimensional runs: the bodies from outside at three times."""
    if run.dimensions != 3 or not filled(run):
        return None
    quantities = available(run)
    order = [q for name in ("plastic_strain", "mises", "velocity", "pressure") for q in quantities if q[0] == name]
    if not order:
        return None
    field, factor, label, signed = order[0]
    axes = view_axes(run)
    dumps = [filled(run)[i] for i in chosen(len(filled(run)), 3)]
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for dump in dumps:
        x = dump.values("position")
        flat = np.stack([x @ axes[0], x @ axes[1]], axis=1)
        low, high = np.minimum(low, flat.min(axis=0)), np.maximum(high, flat.max(axis=0))
    low, high = low - 2.5 * spacing(run), high + 2.5 * spacing(run)
    norm = scale([scalar(dump, field, factor) for dump in dumps], signed)
    colours = BALANCED if signed else RISING
    aspect = (high[1] - low[1]) / (high[0] - low[0])
    figure = Figure(figsize=(10.2, min(3.0 * aspect, 4.8) + 0.4), layout="constrained")
    panels = figure.subplots(1, len(dumps), squeeze=False)[0]
    for panel, dump in zip(panels, dumps):
        values, brightness, inside = splat(dump.values("position"), scalar(dump, field, factor), spacing(run), low,
                                           high, axes)
        picture = colours(norm(values))
        picture[..., :3] = np.clip(picture[..., :3] * brightness[..., None], 0.0, 1.0)
        picture[~inside] = 1.0
        panel.imshow(picture, origin="lower", interpolation="antialiased")
        panel.set_title(time_title(run, dump.time))
        panel.set_axis_off()
        triad(panel, axes)
    bar = figure.colorbar(ScalarMappable(norm, colours), ax=panels.tolist(), shrink=0.9, pad=0.015, aspect=28,
                          extend="both" if signed else "max")
    bar.set_label(label)
    return image(figure, "png", alt="The bodies from outside")


def triad(panel, axes):
    """The directions, drawn small in the lower left corner."""
    for d, name in enumerate("xyz"):
        along = np.array([axes[0][d], axes[1][d]]) * 22
        panel.annotate("", xy=(16 + along[0], 16 + along[1]), xytext=(16, 16), xycoords="axes points",
                       textcoords="axes points", arrowprops={"arrowstyle": "-|>", "color": MUTED, "linewidth": 0.8,
                                                             "shrinkA": 0, "shrinkB": 0, "mutation_scale": 6})
        panel.annotate(name, xy=(16 + 1.3 * along[0], 16 + 1.3 * along[1]), xycoords="axes points", fontsize=7,
                       color=MUTED, ha="center", va="center")


# --- lines

def profiles(run):
    """One-dimensional runs: the particles' values over their positions, at several times."""
    if run.dimensions != 1 or not filled(run):
        return None
    dumps = [filled(run)[i] for i in chosen(len(filled(run)), 8)]
    quantities = [("velocity", 1.0, "velocity [m/s]"), ("pressure", 1e-6, "pressure [MPa]"),
                  ("mises", 1e-6, "equivalent stress (Mises) [MPa]"), ("density", 1.0, "density [kg/m³]"),
                  ("plastic_strain", 1.0, "equivalent plastic strain [-]")]
    quantities = [q for q in quantities if q[0] in dumps[0].fields and any(np.any(d.values(q[0])) for d in dumps)][:4]
    if not quantities:
        return None
    columns = min(2, len(quantities))
    rows = -(-len(quantities) // columns)
    figure = Figure(figsize=(10.2, 2.9 * rows), layout="constrained")
    panels = np.atleast_1d(figure.subplots(rows, columns, squeeze=False)).ravel()
    for panel, (name, factor, label) in zip(panels, quantities):
        for n, dump in enumerate(dumps):
            x = dump.values("position")[:, 0]
            order = np.argsort(x, kind="stable")
            values = dump.values(name)
            values = (values[:, 0] if values.ndim == 2 else values) * factor
            panel.plot(x[order], values[order], color=TIME_COLOURS(n / max(len(dumps) - 1, 1)), linewidth=1.1,
                       label=time_title(run, dump.time)[4:])
        panel.set_xlabel(f"{run.axes[0]} [m]")
        panel.set_ylabel(label)
    for panel in panels[len(quantities):]:
        panel.set_visible(False)
    panels[0].legend(loc="best", fontsize=7, labelspacing=0.25, title="time", title_fontsize=7)
    return image(figure, alt="Profiles at several times")


def components(panel, run, history, name, unit):
    """The components of a vector that are not zero throughout, and its magnitude where there are several."""
    values = [history[f"{name}_{d}"] for d in "xyz"]
    factor, unit = scaled(max(np.abs(v).max() for v in values), unit)
    time_factor, time_unit = scaled(run.log["time"], "s")
    time = history["time"] * time_factor
    largest = max(np.abs(v).max() for v in values)
    moving = [d for d in range(3) if np.abs(values[d]).max() > 5e-3 * largest]
    if len(moving) > 1:
        panel.plot(time, np.sqrt(sum(v ** 2 for v in values)) * factor, color="#b9c2cb", linewidth=2.4,
                   label="magnitude")
    for d in moving:
        panel.plot(time, values[d] * factor, color=DIRECTIONS[d], label=run.axes[d])
    panel.axhline(0.0, color="#9aa5b1", linewidth=0.7)
    panel.set_xlabel(f"time [{time_unit}]")
    panel.set_ylabel(f"{name} [{unit}]")
    panel.set_xlim(time[0], time[-1] if time[-1] > time[0] else None)
    if moving:
        panel.legend(loc="best", fontsize=7, labelspacing=0.2, handlelength=1.4)


def gauge_histories(run):
    """Displacement, velocity and equivalent stress of the particles that gauges follow, one row each."""
    gauges = [g for g in run.point_gauges if run.histories.get(g["name"]) is not None
              and len(run.histories[g["name"]]["time"]) > 1]
    if not gauges:
        return None
    gauges = [gauges[i] for i in chosen(len(gauges), LARGEST_GAUGE_COUNT)]
    stressed = any(np.any(run.histories[g["name"]]["mises"]) for g in gauges)
    third = ("mises", "equivalent stress") if stressed else ("pressure", "pressure")
    figure = Figure(figsize=(10.2, 2.35 * len(gauges) + 0.2), layout="constrained")
    rows = figure.subplots(len(gauges), 3, squeeze=False)
    time_factor, time_unit = scaled(run.log["time"], "s")
    for panels, gauge in zip(rows, gauges):
        history = run.histories[gauge["name"]]
        components(panels[0], run, history, "displacement", "m")
        components(panels[1], run, history, "velocity", "m/s")
        panels[0].set_title(f"{gauge['name']}   on {gauge['body']}")
        panels[2].plot(history["time"] * time_factor, history[third[0]] * 1e-6, color=INK, linewidth=1.1)
        panels[2].set_ylabel(f"{third[1]} [MPa]")
        panels[2].set_xlabel(f"time [{time_unit}]")
        panels[2].set_xlim(panels[0].get_xlim())
    return image(figure, alt="Displacement, velocity and stress at the gauges")


def energies(run):
    """Energies over time: of all bodies together, and of each where there are several."""
    if run.energies is None or len(run.energies["time"]) < 2:
        return None
    names = [body["name"] for body in run.points["bodies"]]
    columns = list(run.energies)[1:]
    tables = [[run.energies[columns[3 * b + k]] for k in range(3)] for b in range(len(names))]
    total = [sum(table[k] for table in tables) for k in range(3)]
    time_factor, time_unit = scaled(run.log["time"], "s")
    time = run.energies["time"] * time_factor
    largest = max(np.abs(total[0] + total[1]).max(), 1e-300)
    shown = [("all bodies" if len(names) > 1 else names[0], total, True)]
    if len(names) > 1:
        shown += [(name, table, False) for name, table in list(zip(names, tables))[:LARGEST_BODY_COUNT]]
    count = len(shown) + 1
    width = 2 if count in (2, 4) else 3
    rows = -(-count // width)
    figure = Figure(figsize=(10.2, 2.9 * rows), layout="constrained")
    panels = np.atleast_1d(figure.subplots(rows, width, squeeze=False)).ravel()
    for panel, (name, table, with_sum) in zip(panels, shown):
        factor, unit = scaled(max(np.abs(values).max() for values in table), "J")
        if with_sum:
            panel.plot(time, (table[0] + table[1]) * factor, color="#b9c2cb", linewidth=3.0, label="sum")
        panel.plot(time, table[0] * factor, color=BLUE, label="kinetic")
        panel.plot(time, table[1] * factor, color=ORANGE, label="internal")
        if np.any(table[2]):
            panel.plot(time, table[2] * factor, color=GREEN, linestyle=(0, (4, 2)), label="plastic work")
        panel.set_title(name)
        panel.set_ylabel(f"energy [{unit}]")
        panel.legend(loc="best", fontsize=7, labelspacing=0.2)
    drift = panels[len(shown)]
    drift.plot(time, (total[0] + total[1] - total[0][0] - total[1][0]) / largest * 100.0, color=INK)
    drift.axhline(0.0, color="#9aa5b1", linewidth=0.7)
    drift.set_ylabel("change of the sum [%]")
    drift.set_title("change of the energy in the domain")
    for panel in panels[:count]:
        panel.set_xlabel(f"time [{time_unit}]")
        panel.set_xlim(time[0], time[-1])
    for panel in panels[count:]:
        panel.set_visible(False)
    return image(figure, alt="Energies over time")
