"""Flow through openings: panels that give way, gaps between bodies, a plate that tears."""
import numpy as np
from common import ROOT, Variants, commit, listed, machine, per_cent, table

GAMMA, OUTSIDE, DENSITY = 1.4, 101325.0, 1.225
LIQUID = np.pi / (np.pi + 2.0)  # contraction of a jet of liquid out of a slit [Kirchhoff69]
CHOKED = (2.0 / (GAMMA + 1.0)) ** (GAMMA / (GAMMA - 1.0))
# pressure [bar], size of the room [m], cells from the middle of the slit to its edge
ROOMS = ((1.3, 1.0, (8, 16)), (1.3, 3.0, (8, 16)), (1.85, 1.0, (8, 16, 24)), (3.0, 1.0, (8, 16, 24)),
         (5.0, 1.0, (8, 16, 24)), (20.0, 1.0, (8, 16)))
TARGET = 5.0  # of the outflow, per cent
PERIODS = 2  # of the waves in a room
GAPS = (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0)  # cells
SLITS = (4, 8)  # cells from middle to edge
PLATE_CELLS = (5.0, 2.5)  # mm

ROOM = """[domain]
geometry = "planar2d"
size = [{length}, {height!r}]
cell = {h!r}
[boundaries]
x_low = "wall"
y_low = "symmetry"
[[initial_state]]
shape = "box"
lower = [0, 0]
upper = [{room}, {height!r}]
pressure = "{bar} bar"
density = {density!r}
[[obstacle]]
name = "ceiling"
shape = "box"
lower = [0, {room}]
upper = [{room}, {height!r}]
[[obstacle]]
name = "wall"
shape = "box"
lower = [{room}, 0.1]
upper = [{end!r}, {height!r}]
[[obstacle]]
name = "panel"
shape = "box"
lower = [{room}, 0]
upper = [{end!r}, 0.1]
fails_at = "20 kPa"
[output]
peak_fields = false
fields = ["pressure", "density"]
precision = "double"
field_interval = {interval!r}
[end]
time = {time!r}
"""
SMALL_ROOM = """[domain]
geometry = "planar2d"
size = [0.4, 0.05]
cell = {h!r}
[boundaries]
all = "wall"
x_high = "outflow"
[[initial_state]]
shape = "box"
lower = [0, 0]
upper = [{end}, 0.05]
pressure = "{bar} bar"
density = {density!r}
{bodies}
[[gauge]]
line = {{from = [0.005, 0.01], to = [0.145, 0.01], count = 15}}
[output]
peak_fields = false
[audit]
fail = 0
[end]
time = "{time} ms"
"""
PLATE = """[domain]
geometry = "planar2d"
size = [0.6, 0.05]
cell = "{cell} mm"
[boundaries]
all = "wall"
x_high = "outflow"
y_low = "symmetry"
[[initial_state]]
shape = "box"
lower = [0, 0]
upper = [0.2, 0.05]
pressure = "100 bar"
density = 120
[solids.weak]
density = 2700
specific_heat = 880
eos = {{model = "linear", K = "70 GPa"}}
strength = {{model = "johnson_cook", G = "26 GPa", A = "60 MPa", B = "20 MPa", n = 0.3, C = 0, m = 1, T_melt = 900}}
{failure}
[[body]]
name = "plate"
material = "weak"
shape = "box"
lower = [0.2, 0]
upper = [0.21, 0.05]
[[constraint]]
body = "plate"
kind = "fixed"
within = {{shape = "box", lower = [0.19, 0.045], upper = [0.22, 0.05]}}
[mpm_region]
box = {{lower = [0.16, 0], upper = [0.5, 0.05]}}
[[gauge]]
name = "room"
point = [0.1, 0.02]
[output]
peak_fields = false
fields = ["pressure", "density", "solid"]
field_interval = "50 us"
[end]
time = "1.1 ms"
"""
TEARS = 'failure = {model = "johnson_cook", D1 = 0.08, D2 = 0, D3 = 0, D4 = 0, D5 = 0}'


def density_at(bar):
    return DENSITY * 1e5 * bar / OUTSIDE


def jet(p, rho):
    """Isentropic mass flow per area [kg/(m2 s)]."""
    r = np.maximum(OUTSIDE / p, CHOKED)
    return np.sqrt(2.0 * GAMMA / (GAMMA - 1.0) * p * rho * (r ** (2.0 / GAMMA) - r ** (1.0 + 1.0 / GAMMA)))


def contraction(p):
    """Of the jet out of a slit [Jobson55]; differs from the exact one [Chaplygin04] by less than 0.006 up to sonic."""
    f = 1.0 / LIQUID - 0.5 / LIQUID**2
    throat = np.maximum(OUTSIDE / p, CHOKED)
    rho = throat ** (1.0 / GAMMA)
    square = 2.0 * GAMMA / (GAMMA - 1.0) * (1.0 - throat / rho)
    a, b = f * rho**2 * square, rho * square + throat - OUTSIDE / p
    return (b - np.sqrt(b * b - 4.0 * a * (1.0 - OUTSIDE / p))) / (2.0 * a)


def room_rows(variants):
    """Rows of a table; (pressure, room, cells, error of the outflow) of all; and the largest fraction of an
    overpressure that is lost, with its pressure and size."""
    rows, errors, lost = [], [], []
    for bar, room, resolutions in ROOMS:
        period = 2.0 * room / np.sqrt(GAMMA * OUTSIDE / DENSITY)  # of the waves; the gas has the ambient temperature
        for cells in resolutions:
            h = 0.1 / cells
            deck = ROOM.format(room=room, length=room + 0.6, height=room + h, h=h, bar=bar,
                               density=density_at(bar), end=room + h, interval=period / 40.0,
                               time=(1.0 + PERIODS) * period)
            result = variants("room", f"{room:g}m-{bar}bar-{cells}", text=deck)
            states = []
            n = round(room / h)
            for dump in result.dumps:
                states.append((dump.time, *(dump.values(key)[:n, :n].mean() for key in ("pressure", "density"))))
            time, p, rho = np.array([s for s in states if s[0] >= period * (1.0 - 1e-9)]).T
            flow = 0.1 * contraction(p) * jet(p, rho)
            formula = np.sum(0.5 * (flow[1:] + flow[:-1]) * np.diff(time)) / room**2
            audit = result.log["audit"]
            errors.append((bar, room, cells, (rho[0] - rho[-1]) / formula - 1.0))
            lost.append((1.0 - (p[-1] - OUTSIDE) / (p[0] - OUTSIDE), bar, room))
            error = max(*audit["relative_error"]["mass"], audit["relative_error"]["energy"])
            rows.append((f"{bar:g}", f"{room:g}", f"{OUTSIDE / p[0]:.2f} to {OUTSIDE / p[-1]:.2f}",
                         f"{contraction(p[0]):.3f}", str(cells), per_cent((rho[0] - rho[-1]) / formula),
                         f"{error:.0e}"))
    return rows, errors, max(lost)


def told(errors):
    """Which rooms of `room_rows` meet the target, by cells."""
    lines = []
    for cells in sorted({e[2] for e in errors}):
        here = [(f"{bar:g} bar ({room:g} m)", abs(error) <= TARGET / 100.0)
                for bar, room, n, error in errors if n == cells]
        met, missed = (listed(name for name, good in here if good == kind) for kind in (True, False))
        lines.append(f"with {cells} cells met: {met}; missed: {missed}")
    return ". ".join(line[0].upper() + line[1:] for line in lines)


def bodies(parts, region):
    text = ""
    for n, (lower, upper) in enumerate(parts):
        text += f'[[body]]\nname = "part{n}"\nmaterial = "RHA"\nrigid = true\nshape = "box"\n'
        text += f"lower = {list(lower)}\nupper = {list(upper)}\n"
    return text + f"[mpm_region]\nbox = {{lower = [{region[0]}, 0], upper = [{region[1]}, 0.05]}}\n"


def mean_history(result):
    """Mean pressure along the room."""
    columns = [result.gauge(f"g1-{n}") for n in range(1, 16)]
    return columns[0]["time"], np.mean([c["pressure"] for c in columns], axis=0)


def width(time, p, bar, volume):
    """Contraction times opening that empties an isentropic room at the same rate while the flow is choked [m]: the
    pressure in the room to the power -(gamma - 1) / (2 gamma) then rises linearly."""
    power = 0.5 * (GAMMA - 1.0) / GAMMA
    speed = np.sqrt(GAMMA * OUTSIDE / DENSITY)  # at the start
    slope = np.polyfit(time, (1e5 * bar / p) ** power, 1)[0]
    choked = (2.0 / (GAMMA + 1.0)) ** (0.5 * (GAMMA + 1.0) / (GAMMA - 1.0))
    return 2.0 / (GAMMA - 1.0) * slope * volume / (speed * choked)


def gap_rows(variants):
    h, rows = 0.0025, []
    for gap in GAPS:
        widths = []
        for offset in (0.0, 0.25):
            low = 0.025 + offset * h
            high = low + gap * h
            plates = (((0.2, 0), (0.21, low)), ((0.2, high), (0.21, 0.05)))
            plates = plates if gap > 0.0 else (((0.2, 0), (0.21, 0.05)),)
            deck = SMALL_ROOM.format(h=h, end=0.2, bar=3, density=density_at(3), time=1.5,
                                     bodies=bodies(plates, (0.15, 0.27)))
            result = variants("gap", f"{gap}-{offset}", text=deck)
            time, p = mean_history(result)
            late = (time > 0.4e-3) & (p > OUTSIDE / CHOKED)
            widths.append(width(time[late], p[late], 3, 0.01) / h)
        rows.append((f"{gap:g}", *(f"{w:.2f}" for w in widths)))
    return rows


def slit_rows(variants):
    rows = []
    for cells in SLITS:
        h = 0.01 / cells
        found = []
        for kind in ("cells", "points"):
            part = ((0.2, 0.01), (0.2 + h, 0.05))
            jaw = (f'[[obstacle]]\nshape = "box"\nlower = {list(part[0])}\nupper = {list(part[1])}\n'
                   if kind == "cells" else bodies((part,), (0.2 - 16 * h, 0.2 + 20 * h)))
            deck = SMALL_ROOM.format(h=h, end=0.2, bar=5, density=density_at(5), time=2.1, bodies=jaw).replace(
                'x_high = "outflow"', 'x_high = "outflow"\ny_low = "symmetry"')
            result = variants("slit", f"{cells}-{kind}", text=deck)
            time, p = mean_history(result)
            late = time > 1.05e-3  # a period of the waves in the room
            found.append(width(time[late], p[late], 5, 0.01) / 0.01)
            balance = result.log.get("mpm_region", {}).get("energy", {}).get("drift", 0.0)
        rows.append((str(cells), f"{found[0]:.3f}", f"{found[1]:.3f}", per_cent(found[1] / found[0]),
                     f"{100.0 * balance:+.2f} %"))
    return rows


def plate_rows(variants):
    rows = []
    for cell in PLATE_CELLS:
        for failure, name in ((TEARS, "tears"), ("", "whole")):
            result = variants("plate", f"{cell:g}mm-{name}", text=PLATE.format(cell=cell, failure=failure))
            times, mass = [], []
            i = round(0.26 / result.cell_size)
            for dump in result.dumps:
                gas = dump.values("density") * (1.0 - dump.values("solid"))
                times.append(dump.time)
                mass.append(gas[:, i:].sum() * dump.spacing ** 2)
            most = mass[0] + DENSITY * 0.05 * 0.05  # what the plate pushes ahead of itself
            through = next((f"{1e3 * t:.2f}" for t, m in zip(times, mass) if m > most), "-")
            audit, energy = result.log["audit"], result.log["mpm_region"]["energy"]
            rows.append((f"{cell:g}", name, through, f"{mass[0]:.4f}", f"{mass[-1]:.4f}",
                         f"{max(audit['relative_error']['mass']):.0e}", f"{100.0 * energy['drift']:+.3f} %"))
    return rows


def validate(arguments, work):
    """Writes docs/validation/rupture.md."""
    variants = Variants(arguments, work)
    variants.expect(sum(len(r) for *_, r in ROOMS) + 2 * len(GAPS) + 2 * len(SLITS) + 2 * len(PLATE_CELLS))
    rooms, errors, (lost, bar, size) = room_rows(variants)
    gaps, slits, plates = (rows(variants) for rows in (gap_rows, slit_rows, plate_rows))
    text = f"""# Rupture: panels, gaps and tears

Produced by `validation/run rupture`, commit {arguments.commit or commit()}; machine: {machine()}.

## A room that empties through a panel

A planar room twice as high as long, half of it simulated, with a slit of 0.2 m in the middle of a wall one cell thick.
A massless panel closes the slit and gives way at 20 kPa, instantly. From the return of the first wave on, over
{PERIODS} periods of the waves in the room, the mass that leaves is compared with that of a quasi-steady orifice of the
slit's area: contraction C [Jobson55, Chaplygin04] times isentropic mass flow between the room's mean state and 1 atm.
Target: {TARGET:g} %.

{table(("pressure [bar]", "room [m]", "outside / room", "initial C", "cells from middle to edge", "outflow",
        "error of the audit"), rooms)}
{told(errors)}.

At each sharp edge the scheme carries along the flow of an extra fraction of a cell; this error falls with the cell
size. The error that remains as the cell size goes to zero is not due to the scheme: the more of its overpressure a room
loses during the periods, the less quasi-steady it is. This applies most of all to the room of {size:g} m at {bar:g}
bar, which loses {100 * lost:.0f} %.

## Gaps between bodies in an MPM region

Rigid plates four cells thick in a channel of 20 cells, room at 3 bar. The table gives the gap in cells and the width of
an opening without contraction that passes the same flow, in cells, for a gap whose edges lie between cells and for one
that lies a quarter of a cell off. At this pressure the jet of an orifice contracts to {contraction(3e5):.2f} of its
width.

{table(("gap", "between cells", "a quarter of a cell off"), gaps)}
A slit in a plate one cell thick, room at 5 bar, from the return of the first wave on; contraction as above.

{table(("cells from middle to edge", "obstacles", "bodies", "bodies / obstacles", "drift of energy"), slits)}
## A plate that tears

A clamped plate of 10 mm under 100 bar. The table gives the time [ms] from which there is more gas farther than 50 mm
behind the plate than the plate can have pushed there, the gas there at the start and at 1.1 ms [kg/m], and the
balance.

{table(("cell [mm]", "plate", "gas passes at", "at the start", "at the end", "error of mass", "drift of energy"),
       plates)}"""
    target = work if arguments.quick else ROOT / "docs" / "validation"
    target.mkdir(parents=True, exist_ok=True)
    (target / "rupture.md").write_text(text)
    print(f"wrote {target / 'rupture.md'}; results of the runs: {work}")
