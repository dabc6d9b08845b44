"""The report's figures. Each function returns an image as HTML, or None if the run has nothing to show."""
import base64
import io

import matplotlib
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, LogNorm, SymLogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

INK = "#1d2733"
MUTED = "#66727f"
GRID = "#e3e8ed"
BLUE = "#1f5f99"
ORANGE = "#c8641b"
REFERENCE = "#2b2b2b"
OBSTACLE = "#5b6570"

matplotlib.rcParams.update({
    "font.family": "DejaVu Sans", "font.size": 8.5, "axes.titlesize": 9, "axes.titleweight": "bold",
    "axes.titlelocation": "left", "axes.edgecolor": "#9aa5b1", "axes.labelcolor": INK, "axes.linewidth": 0.8,
    "axes.grid": True, "grid.color": GRID, "grid.linewidth": 0.7, "axes.axisbelow": True,
    "xtick.color": MUTED, "ytick.color": MUTED, "text.color": INK, "axes.titlecolor": INK,
    "legend.frameon": False, "legend.fontsize": 8, "lines.linewidth": 1.4, "svg.fonttype": "path",
    "svg.hashsalt": "brisance", "path.simplify": True, "path.simplify_threshold": 0.4})

# White is the undisturbed air: red above, blue below.
PRESSURE_COLOURS = LinearSegmentedColormap.from_list("overpressure", [
    (0.0, "#123a6b"), (0.25, "#3f7fbf"), (0.42, "#b9d6ee"), (0.5, "#ffffff"), (0.6, "#fde3a7"), (0.7, "#f7a44c"),
    (0.82, "#d9482b"), (0.93, "#8f1024"), (1.0, "#3d0516")])
PEAK_COLOURS = LinearSegmentedColormap.from_list("peak", [
    (0.0, "#ffffff"), (0.15, "#fdf0c4"), (0.4, "#f7a44c"), (0.65, "#d9482b"), (0.85, "#8f1024"), (1.0, "#3d0516")])
TIME_COLOURS = LinearSegmentedColormap.from_list("time", ["#7a0c1e", "#d9482b", "#f0a23c", "#4b9aa8", "#1f4f88"])

PNG_DPI = 170
LARGEST_PANEL_COUNT = 12
SLICE_COUNT = 6


def image(figure, kind="svg", alt=""):
    """The figure as an <img> element that contains its data."""
    buffer = io.BytesIO()
    metadata = {"Date": None} if kind == "svg" else {}
    figure.savefig(buffer, format=kind, dpi=PNG_DPI, bbox_inches="tight", facecolor="white", metadata=metadata)
    mime = "image/svg+xml" if kind == "svg" else "image/png"
    # A PNG has its width in pixels in bytes 16-19; the page shows it in the size that it was laid out for.
    width = f' width="{int.from_bytes(buffer.getvalue()[16:20], "big") * 96 // PNG_DPI}"' if kind == "png" else ""
    data = base64.b64encode(buffer.getvalue()).decode()
    return f'<img alt="{alt}"{width} src="data:{mime};base64,{data}">'


def plain(value):
    """A number as people write it: 0.5, 20, 3000."""
    return f"{value:.10g}"


def chosen(count, most):
    """At most `most` of `count` indices, evenly spread, including the first and the last."""
    if count <= most:
        return list(range(count))
    return sorted({int(round(i)) for i in np.linspace(0, count - 1, most)})


def later_dumps(run):
    """The dumps to show; the initial state only if there are few others."""
    return run.dumps[1:] if len(run.dumps) > 2 else run.dumps


def pressure_of(dump):
    """Name of the field with the pressures, and what to subtract for the overpressure (as a multiple of the ambient
    pressure)."""
    for name, ambient in (("overpressure", 0.0), ("pressure", 1.0)):
        if name in dump.fields:
            return name, ambient
    return None, 0.0


# --- gauges

def gauge_histories(run):
    """Overpressure and running impulse at the gauges that a shock reached; of many gauges, a dozen at all distances."""
    gauges = [gauge for gauge in run.summary["gauges"]
              if gauge["arrival_time"] is not None and run.histories[gauge["name"]]]
    if not gauges:
        return None
    gauges.sort(key=lambda gauge: gauge["distance"] if gauge["distance"] is not None else 0.0)
    gauges = [gauges[i] for i in chosen(len(gauges), LARGEST_PANEL_COUNT)]
    columns = 1 if len(gauges) == 1 else 2
    rows = -(-len(gauges) // columns)
    figure = Figure(figsize=(10.2, 2.55 * rows + 0.3), layout="constrained")
    panels = np.atleast_1d(figure.subplots(rows, columns, squeeze=False)).ravel()
    for panel, gauge in zip(panels, gauges):
        history_panel(panel, gauge, run.histories[gauge["name"]])
    for panel in panels[len(gauges):]:
        panel.set_visible(False)
    return image(figure, alt="Overpressure and impulse histories at the gauges")


def history_panel(panel, gauge, history):
    time = history["time"] * 1e3
    panel.plot(time, history["overpressure"] * 1e-3, color=BLUE)
    panel.set_ylabel("overpressure [kPa]", color=BLUE)
    panel.set_xlabel("time [ms]")
    panel.axhline(0.0, color="#9aa5b1", linewidth=0.7)
    panel.set_xlim(time[0], time[-1])
    title = gauge["name"]
    if gauge["distance"] is not None:
        title += f"   R = {gauge['distance']:.4g} m"
    if gauge["scaled_distance"] is not None:
        title += f",  Z = {gauge['scaled_distance']:.3g} m/kg$^{{1/3}}$"
    panel.set_title(title)

    front = gauge.get("peak_front_overpressure")
    if front is not None:
        panel.plot(gauge["time_of_peak"] * 1e3, front * 1e-3, marker="o", markersize=5, color="none",
                   markeredgecolor=BLUE, linestyle="none", zorder=5)

    impulse = panel.twinx()
    impulse.plot(time, history["impulse"], color=ORANGE, linewidth=1.1)
    impulse.set_ylabel("impulse [Pa s]", color=ORANGE)
    impulse.grid(False)

    reference = gauge["kingery_bulmash"]
    peak, arrival = reference["peak_overpressure"], reference["arrival_time"]
    if peak is not None and arrival is not None:
        panel.plot(arrival * 1e3, peak * 1e-3, marker="D", markersize=6, color="white", markeredgecolor=REFERENCE,
                   markeredgewidth=1.3, linestyle="none", zorder=5)
        panel.vlines(arrival * 1e3, 0.0, peak * 1e-3, color=REFERENCE, linewidth=0.9, linestyle=(0, (4, 3)))
        if reference["positive_duration"] is not None:
            end = (arrival + reference["positive_duration"]) * 1e3
            if end <= time[-1]:
                panel.plot(end, 0.0, marker="|", markersize=11, color=REFERENCE, markeredgewidth=1.3,
                           linestyle="none", zorder=5)
    if reference["positive_impulse"] is not None:
        impulse.axhline(reference["positive_impulse"], color=ORANGE, linewidth=0.9, linestyle=(0, (4, 3)))
    align_zeros((panel, 1.1), (impulse, 1.25))


def align_zeros(*panels):
    """Gives all panels (each with the headroom that it needs, as a factor) the same relative height of zero."""
    limits = [panel.get_ylim() for panel, _ in panels]
    below = min(1.0, max(max(-low, 0.0) / max(high, 1e-12) for low, high in limits))
    for (panel, headroom), (_, high) in zip(panels, limits):
        top = headroom * max(high, 1e-12)
        panel.set_ylim(-below * top, top)
        panel.yaxis.set_major_locator(MaxNLocator(5))


def scaled_distance(run):
    """Peak overpressure, impulse and arrival of the gauges against scaled distance, with the Kingery-Bulmash curves."""
    curve = run.curve
    gauges = [g for g in run.summary["gauges"] if g["scaled_distance"] and g["arrival_time"] is not None]
    if not gauges:
        return None
    root = gauges[0]["distance"] / gauges[0]["scaled_distance"]
    same_root = all(abs(g["distance"] / g["scaled_distance"] - root) < 1e-9 * root for g in gauges)
    quantities = [("peak_overpressure", 1e-3, "peak overpressure [kPa]", 1.0)]
    if same_root:
        # If no gauge has a complete positive phase there is no impulse to show.
        complete = any(g["positive_phase_complete"] for g in gauges)
        quantities += [("positive_impulse", 1.0, "scaled impulse [Pa s / kg$^{1/3}$]", 1.0 / root)][:complete]
        quantities += [("arrival_time", 1e3, "scaled arrival [ms / kg$^{1/3}$]", 1.0 / root)]
    figure = Figure(figsize=(10.2 if same_root else 5.5, 3.7), layout="constrained")
    z = np.array([g["scaled_distance"] for g in gauges])
    low, high = z.min() / 1.8, z.max() * 1.8
    for panel, (key, factor, label, scale) in zip(np.atleast_1d(figure.subplots(1, len(quantities))), quantities):
        if curve is not None:
            inside = (curve["scaled_distance"] >= low) & (curve["scaled_distance"] <= high)
            panel.plot(curve["scaled_distance"][inside], curve[key][inside] * factor * scale, color=REFERENCE,
                       linewidth=1.3, label=f"Kingery-Bulmash, {run.summary['burst']}")
        usable = [g for g in gauges if key != "positive_impulse" or g["positive_phase_complete"]]
        panel.plot([g["scaled_distance"] for g in usable], [g[key] * factor * scale for g in usable], marker="o",
                   markersize=5.5, color=BLUE, markeredgecolor="white", markeredgewidth=0.7, linestyle="none",
                   label="gauges")
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_xlim(low, high)
        panel.set_xlabel("scaled distance Z [m/kg$^{1/3}$]")
        panel.set_ylabel(label)
        readable_log_axis(panel.xaxis)
        readable_log_axis(panel.yaxis)
        panel.grid(True, which="minor", linewidth=0.4)
        panel.legend(loc="best")
    return image(figure, alt="Blast parameters versus scaled distance")


def readable_log_axis(axis):
    """Ticks at 1, 2, 5 with plain numbers where the axis covers few decades, at the decades otherwise."""
    low, high = axis.get_view_interval()
    if np.log10(high / low) < 2.2:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: plain(value)))
    axis.set_minor_formatter(NullFormatter())


# --- fields

def main_position(run):
    """The point through which the slices pass: the first charge's centre, or the middle of the domain."""
    charges = run.log["charges"]
    if charges and "centre" in charges[0]:
        return charges[0]["centre"]
    domain = run.log["domain"]
    return [0.5 * (low + high) for low, high in zip(domain["lower"], domain["upper"])]


class Cut:
    """A plane of cells: what to read and how to draw it."""

    def __init__(self, run, normal):
        dump = run.dumps[0]
        self.normal = normal
        self.horizontal, self.vertical = [d for d in range(3) if d != normal]
        self.index = dump.layer(normal, main_position(run)[normal])
        self.position = dump.centres(normal)[self.index]
        self.axes = run.axes
        self.three_dimensional = run.dimensions == 3
        self.edges = dump.edges(self.horizontal), dump.edges(self.vertical)
        self.centres = dump.centres(self.horizontal), dump.centres(self.vertical)
        self.filled = dump.plane("obstacle", normal, self.index) if "obstacle" in dump.fields else None
        self.fixed = self.filled > 0.999 if self.filled is not None else None
        self.blocked = self.fixed
        self.region = dump.plane("region", normal, self.index) if "region" in dump.fields else None
        self.show_blocks = run.show_blocks
        self.blocks = []

    @property
    def title(self):
        if not self.three_dimensional:
            return ""
        return f"plane {self.axes[self.normal]} = {self.position:.4g} m"

    def look_at(self, dump):
        """Sets the solid cells and the blocks to those of one dump, since bodies move and blocks change."""
        if self.show_blocks:
            self.blocks = dump.outlines(self.normal, self.position)
        if "solid" in dump.fields:
            solid = dump.plane("solid", self.normal, self.index) > 0.5
            self.blocked = solid if self.fixed is None else solid | self.fixed

    def values(self, dump, field):
        self.look_at(dump)
        values = dump.plane(field, self.normal, self.index)
        return values if self.blocked is None else np.where(self.blocked, np.nan, values)

    def draw(self, panel, values, norm, colours):
        mesh = panel.pcolormesh(*self.edges, np.ma.masked_invalid(values), norm=norm, cmap=colours, rasterized=True)
        if self.blocked is not None and self.blocked.any():
            colours = LinearSegmentedColormap.from_list("obstacle", [OBSTACLE, OBSTACLE])
            panel.pcolormesh(*self.edges, np.ma.masked_where(~self.blocked, np.ones_like(values)), cmap=colours,
                             rasterized=True)
        if self.filled is not None and ((self.filled > 0) & (self.filled < 1)).any():
            panel.contourf(*self.centres, self.filled, levels=[0.5, 2.0], colors=[OBSTACLE])
        if self.region is not None and (self.region > 0).any() and (self.region == 0).any():
            panel.contour(*self.centres, (self.region > 0).astype(float), levels=[0.5], colors=[MUTED], linewidths=0.7,
                          linestyles=[(0, (4, 3))])
        if self.blocks:
            corners = [[low, (high[0], low[1]), high, (low[0], high[1])] for _, low, high in self.blocks]
            widths = [block_line(level) for level, _, _ in self.blocks]
            panel.add_collection(PolyCollection(corners, facecolors="none", edgecolors=MUTED, linewidths=widths))
        panel.set_aspect("equal")
        panel.grid(False)
        panel.xaxis.set_major_locator(MaxNLocator(5))
        panel.yaxis.set_major_locator(MaxNLocator(5))
        return mesh

    def label(self, panel, horizontal=True, vertical=True):
        if horizontal:
            panel.set_xlabel(f"{self.axes[self.horizontal]} [m]")
        if vertical:
            panel.set_ylabel(f"{self.axes[self.vertical]} [m]")

    def mark_gauges(self, panel, run, names=False):
        """Gauges that lie in the plane (within a cell)."""
        for gauge in run.summary["gauges"]:
            position = gauge["position"]
            spacing = run.dumps[0].spacing
            if self.three_dimensional and abs(position[self.normal] - self.position) > 1.01 * spacing:
                continue
            panel.plot(position[self.horizontal], position[self.vertical], marker="o", markersize=3.2,
                       markerfacecolor="white", markeredgecolor=INK, markeredgewidth=0.8, clip_on=False, zorder=6)
            if names:
                panel.annotate(gauge["name"], (position[self.horizontal], position[self.vertical]), fontsize=6.5,
                               xytext=(3, 3), textcoords="offset points", zorder=7)

    @property
    def aspect(self):
        """Height over width."""
        return (self.edges[1][-1] - self.edges[1][0]) / (self.edges[0][-1] - self.edges[0][0])


def block_line(level):
    """Width of the outline of a block: finer levels thinner, so that they do not hide their cells."""
    return max(0.1, 0.5 * 0.7 ** level)


def cuts(run, with_plan):
    """The planes to show: the vertical one, in 3D with `with_plan` the horizontal one too."""
    if run.dimensions == 2:
        return [Cut(run, 2)]
    return [Cut(run, 1)] + ([Cut(run, 2)] if with_plan else [])


def nice_ceiling(value):
    """The next of 1, 2, 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(m for m in (1.0, 2.0, 5.0, 10.0) if m * power >= value * (1 - 1e-12)) * power)


def pressure_slices(run):
    """Overpressure in a plane at several times, one colour scale for all."""
    if run.dimensions == 1 or not run.dumps or pressure_of(run.dumps[0])[0] is None:
        return None
    shown = later_dumps(run)
    shown = [shown[i] for i in chosen(len(shown), SLICE_COUNT)]
    field, ambient = pressure_of(shown[0])
    pictures = []
    for cut in cuts(run, with_plan=run.log["obstacles"] > 0):
        planes = [(cut.values(dump, field) - ambient * run.ambient_pressure) * 1e-3 for dump in shown]
        pictures.append(slice_sheet(run, cut, shown, planes))
    return "\n".join(pictures)


def slice_sheet(run, cut, shown, planes):
    columns = min(len(shown), 3 if cut.aspect > 0.35 else 2)
    rows = -(-len(shown) // columns)
    width = 10.2
    height = min(rows * ((width - 1.5) / columns * cut.aspect + 0.35) + 0.35, 11.0)
    figure = Figure(figsize=(width, max(height, 1.8)), layout="constrained")
    panels = np.atleast_1d(figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)).ravel()
    norm = overpressure_norm(planes, run.ambient_pressure * 1e-3)
    for n, (panel, dump, values) in enumerate(zip(panels, shown, planes)):
        cut.look_at(dump)
        mesh = cut.draw(panel, values, norm, PRESSURE_COLOURS)
        panel.set_title(f"t = {dump.time * 1e3:.4g} ms")
        cut.label(panel, horizontal=n + columns >= len(shown), vertical=n % columns == 0)
    for panel in panels[len(shown):]:
        panel.set_visible(False)
    bar = figure.colorbar(mesh, ax=panels.tolist(), shrink=0.9, pad=0.015, aspect=32, extend="both")
    decades = 10.0 ** np.arange(np.ceil(np.log10(norm.linthresh)), np.floor(np.log10(norm.vmax)) + 0.5)
    ticks = [-d for d in decades[::-1] if d <= -norm.vmin] + [0.0] + list(decades)
    bar.set_ticks(ticks, labels=[plain(t) for t in ticks])
    bar.minorticks_off()
    bar.set_label("overpressure [kPa]" + (f", {cut.title}" if cut.title else ""))
    return image(figure, "png", alt="Overpressure at several times")


def overpressure_norm(planes, ambient):
    """Logarithmic on both sides of zero, the ambient state in the middle of the colours.

    The upper end follows the field without its highest 0.1 %, so that the fireball's core does not take all colours.
    """
    finite = np.concatenate([values[np.isfinite(values)].ravel() for values in planes])
    threshold = 0.01 * ambient
    top = nice_ceiling(max(np.quantile(finite, 0.999), 10.0 * threshold))
    return SymLogNorm(linthresh=threshold, linscale=0.3, vmin=-top, vmax=top)


def peak_map(run):
    """The largest overpressure at each place during the run, with labelled contours."""
    if run.dimensions == 1 or not run.dumps or "peak_overpressure" not in run.dumps[-1].fields:
        return None
    dump = run.dumps[-1]
    planes = cuts(run, with_plan=True)
    values = [cut.values(dump, "peak_overpressure") * 1e-3 for cut in planes]
    finite = np.concatenate([v[np.isfinite(v)].ravel() for v in values])
    positive = finite[finite > 0.0]
    if not positive.size:
        return None
    top = nice_ceiling(np.quantile(positive, 0.98))
    bottom = max(positive.min(), 1e-3 * top, 0.1)
    levels = [m * 10.0 ** e for e in range(-1, 8) for m in (1.0, 2.0, 5.0) if bottom < m * 10.0 ** e < top]
    width = 10.2 if len(planes) == 2 else 6.5
    panel_width = width / len(planes) - 0.6
    height = min(panel_width * max(cut.aspect for cut in planes) + 0.8, 8.0)
    figure = Figure(figsize=(width, max(height, 2.4)), layout="constrained")
    panels = np.atleast_1d(figure.subplots(1, len(planes)))
    for panel, cut, field in zip(panels, planes, values):
        mesh = cut.draw(panel, np.maximum(field, bottom), LogNorm(bottom, top), PEAK_COLOURS)
        lines = panel.contour(*cut.centres, np.ma.masked_invalid(field), levels=levels, colors=INK, linewidths=0.6)
        panel.clabel(lines, fmt=plain, fontsize=6.5)
        cut.label(panel)
        cut.mark_gauges(panel, run)
        panel.set_title(cut.title)
    bar = figure.colorbar(mesh, ax=panels.tolist(), shrink=0.9, pad=0.015, aspect=28, extend="both")
    bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: plain(value)))
    bar.ax.yaxis.set_minor_formatter(NullFormatter())
    bar.set_label("peak overpressure [kPa]")
    return image(figure, "png", alt="Map of the peak overpressure")


def profiles(run):
    """One-dimensional runs: profiles of the main quantities at several times."""
    if run.dimensions != 1 or not run.dumps:
        return None
    dumps = [run.dumps[i] for i in chosen(len(run.dumps), 8)]
    quantities = [(name, factor, label) for name, factor, label in (
        ("pressure", 1e-6, "pressure [MPa]"), ("overpressure", 1e-6, "overpressure [MPa]"),
        ("density", 1.0, "density [kg/m³]"), ("velocity", 1.0, "velocity [m/s]"),
        ("products", 1.0, "mass fraction of products [-]")) if name in dumps[0].fields]
    if not quantities:
        return None
    columns = min(2, len(quantities))
    rows = -(-len(quantities) // columns)
    figure = Figure(figsize=(10.2, 2.9 * rows), layout="constrained")
    panels = np.atleast_1d(figure.subplots(rows, columns, squeeze=False)).ravel()
    for panel, (name, factor, label) in zip(panels, quantities):
        largest = smallest = None
        for n, dump in enumerate(dumps):
            values = dump.values(name)
            values = (values[:, 0] if values.ndim == 2 else values) * factor
            colour = TIME_COLOURS(n / max(len(dumps) - 1, 1))
            panel.plot(dump.centres(0), values, color=colour, linewidth=1.2, label=f"{dump.time * 1e3:.4g} ms")
            largest = values.max() if largest is None else max(largest, values.max())
            smallest = values.min() if smallest is None else min(smallest, values.min())
        if name in ("pressure", "density") and smallest > 0.0 and largest > 30.0 * smallest:
            panel.set_yscale("log")
            panel.yaxis.set_major_formatter(FuncFormatter(lambda value, _: plain(value)))
            panel.yaxis.set_minor_formatter(NullFormatter())
        panel.set_xlabel(f"{run.axes[0]} [m]")
        panel.set_ylabel(label)
        panel.set_xlim(dumps[0].edges(0)[0], dumps[0].edges(0)[-1])
    for panel in panels[len(quantities):]:
        panel.set_visible(False)
    panels[0].legend(loc="best", fontsize=7, labelspacing=0.25, title="time", title_fontsize=7)
    return image(figure, alt="Profiles at several times")


def peak_profile(run):
    """One-dimensional runs: peak overpressure over the distance, with the Kingery-Bulmash curve."""
    if run.dimensions != 1 or not run.dumps or "peak_overpressure" not in run.dumps[-1].fields:
        return None
    dump = run.dumps[-1]
    distance = np.abs(dump.centres(0) - main_position(run)[0])
    quantities = [(n, f, u, k) for n, f, u, k in (
        ("peak_overpressure", 1e-3, "peak overpressure [kPa]", "peak_overpressure"),
        ("impulse", 1.0, "impulse [Pa s]", "positive_impulse")) if n in dump.fields]
    figure = Figure(figsize=(10.2, 3.5), layout="constrained")
    # Places that no wave has reached are left out, and so is the charge, whose pressures would dominate the scale.
    nearest = 0.0 if run.curve is None else run.curve["distance"].min()
    seen = (dump.values("peak_overpressure") > 1e-5 * run.ambient_pressure) & (distance > nearest)
    for panel, (name, factor, label, key) in zip(np.atleast_1d(figure.subplots(1, len(quantities))), quantities):
        values = dump.values(name) * factor
        panel.plot(distance[seen], values[seen], color=BLUE, label="this simulation")
        if run.curve is not None and seen.any():
            inside = (run.curve["distance"] >= distance[seen].min()) & (run.curve["distance"] <= distance[seen].max())
            panel.plot(run.curve["distance"][inside], run.curve[key][inside] * factor, color=REFERENCE,
                       linestyle=(0, (4, 3)), linewidth=1.2, label=f"Kingery-Bulmash, {run.summary['burst']}")
        panel.set_xscale("log")
        panel.set_yscale("log")
        readable_log_axis(panel.xaxis)
        panel.yaxis.set_major_formatter(FuncFormatter(lambda value, _: plain(value)))
        panel.grid(True, which="minor", linewidth=0.4)
        panel.set_xlabel("distance [m]")
        panel.set_ylabel(label)
        panel.legend(loc="best")
    return image(figure, alt="Peak overpressure and impulse versus distance")


def timings(run):
    """Wall-clock time by phase."""
    phases = sorted(((s or 0.0, name) for name, s in run.log["timings"].items()), reverse=True)
    if not phases or phases[0][0] <= 0.0:
        return None
    total = sum(seconds for seconds, _ in phases)
    figure = Figure(figsize=(7.2, 0.3 * len(phases) + 0.55), layout="constrained")
    panel = figure.subplots()
    names = [name.replace("_", " ") for _, name in phases][::-1]
    seconds = [s for s, _ in phases][::-1]
    panel.barh(names, seconds, color=BLUE, height=0.62)
    for y, s in enumerate(seconds):
        panel.annotate(f"{s:.3g} s   {100 * s / total:.1f} %", (s, y), xytext=(4, 0), textcoords="offset points",
                       va="center", fontsize=7.5, color=MUTED)
    panel.set_xlim(0.0, max(seconds) * 1.25)
    panel.set_xlabel("wall-clock time [s]")
    panel.grid(False, axis="y")
    panel.tick_params(axis="y", colors=INK, length=0)
    for side in ("top", "right", "left"):
        panel.spines[side].set_visible(False)
    return image(figure, alt="Wall-clock time by phase")
