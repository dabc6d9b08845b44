"""Cut cells: a street from a file against its boxes, a cylinder in a shock, what they cost."""
import numpy as np
from common import ROOT, Variants, commit, machine, table

GAMMA, PRESSURE, DENSITY = 1.4, 101325.0, 1.225
MACH, RADIUS = 1.3, 0.1
FRONT = 1.5  # where the undisturbed front is at the end [radii]
CELLS_PER_RADIUS = (20, 40, 80)
STREET_CELLS = (0.5, 0.25, 0.2)  # the faces of the houses lie between cells of the first two


def street(variants, cell, name, obstacles="cut", file=False):
    case = "street_stl_3d" if file else "street_3d"
    text = (ROOT / "cases" / case / "deck.toml").read_text()
    text = text.replace('file = "houses.stl"', f'file = "{ROOT / "cases" / case / "houses.stl"}"')
    text = text.replace('cell = "0.25 m"', f'cell = "{cell} m"').replace('field_interval = "5 ms"\n', "")
    return variants("cut_cells", name, text=text + f'\n[numerics]\nobstacles = "{obstacles}"\n')


def records(result):
    return {g["name"]: (g["peak_overpressure"], g["largest_impulse"]) for g in result.summary["gauges"]}


def largest_difference(one, other):
    pairs = [(a, b) for name in one for a, b in zip(one[name], other[name])]
    return max(abs(a - b) / abs(a) for a, b in pairs)


def street_rows(variants):
    rows, found = [], {}
    for cell in STREET_CELLS:
        for name, options in (("boxes", {}), ("file", {"file": True}), ("stairs", {"obstacles": "stairs"})):
            found[cell, name] = records(street(variants, cell, f"street_{name}_{1000 * cell:.0f}mm", **options))
    for cell in STREET_CELLS:
        lies = all(abs(x / cell - round(x / cell)) < 1e-9 for x in (4.5, 6.0, 8.0, 9.0, 10.5))
        rows.append((f"{cell:g}", "yes" if lies else "no",
                     f"{largest_difference(found[cell, 'boxes'], found[cell, 'file']):.1e}",
                     f"{100 * largest_difference(found[cell, 'boxes'], found[cell, 'stairs']):.2f} %"))
    return rows


def cylinder_deck(cells_per_radius):
    p = PRESSURE * (1 + 2 * GAMMA / (GAMMA + 1) * (MACH**2 - 1))
    rho = DENSITY * (GAMMA + 1) * MACH**2 / ((GAMMA - 1) * MACH**2 + 2)
    speed = MACH * np.sqrt(GAMMA * PRESSURE / DENSITY)
    u = speed * (1 - DENSITY / rho)
    behind = f"density = {rho:.12g}\npressure = {p:.12g}\nvelocity = [{u:.12g}, 0]\n"
    end = (0.15 + FRONT * RADIUS) / speed
    return f"""[domain]
geometry = "planar2d"
lower = [-0.35, 0]
size = [0.6, 0.45]
cell = {RADIUS / cells_per_radius}
[boundaries]
y_low = "symmetry"
x_low = "inflow"
[inflow.x_low]
{behind}
[[initial_state]]
shape = "box"
lower = [-0.35, 0]
upper = [-0.15, 0.45]
{behind}
[[obstacle]]
shape = "cylinder"
radius = {RADIUS}
position = [0, 0]
[output]
fields = ["pressure", "obstacle"]
precision = "double"
[end]
time = {end:.9g}
"""


def crossing(x, p, level, rising):
    """The last place where a profile crosses a level; `rising`: along x."""
    low, high = (p[:-1], p[1:]) if rising else (p[1:], p[:-1])
    places = np.flatnonzero((low < level) & (high >= level))
    n = places[-1] if not rising else places[0]
    return x[n] + (level - p[n]) / (p[n + 1] - p[n]) * (x[n + 1] - x[n])


def shocks(result):
    """Places of the shocks at the end: the incident front far out and the reflected one on the axis [radii], and the
    foot of the Mach shock on the cylinder [degrees from the rear]."""
    dump = result.dumps[-1]
    p = dump.values("pressure").reshape(len(dump.centres(1)), len(dump.centres(0)))
    x, y = dump.centres(0), dump.centres(1)
    behind = PRESSURE * (1 + 2 * GAMMA / (GAMMA + 1) * (MACH**2 - 1))
    incident = crossing(x, p[-2], 0.5 * (PRESSURE + behind), rising=False)
    row = p[0]
    free = x < -RADIUS
    peak = row[free].max()
    reflected = crossing(x[free], row[free], 0.5 * (behind + peak), rising=True)
    # Along the surface, three cells above it for the gas of whole cells.
    cell = x[1] - x[0]
    angles = np.radians(np.linspace(5.0, 120.0, 2000))
    r = RADIUS + 3.0 * cell
    px, py = r * np.cos(angles), r * np.sin(angles)
    i, j = (px - x[0]) / cell, (py - y[0]) / cell
    i0, j0 = np.floor(i).astype(int), np.clip(np.floor(j).astype(int), 0, None)
    s, t = i - i0, np.clip(j - j0, 0.0, 1.0)
    along = ((1 - s) * (1 - t) * p[j0, i0] + s * (1 - t) * p[j0, i0 + 1] + (1 - s) * t * p[j0 + 1, i0]
             + s * t * p[j0 + 1, i0 + 1])
    first = along[: len(along) // 2].max()
    foot = np.degrees(crossing(angles, along, 0.5 * (PRESSURE + min(first, along.max())), rising=True))
    return incident / RADIUS, reflected / RADIUS, foot


def cylinder_rows(variants):
    found = [shocks(variants("cut_cells", f"cylinder_{n}", text=cylinder_deck(n))) for n in CELLS_PER_RADIUS]
    names = ("incident shock, far out, x/R", "reflected shock on the axis, x/R", "foot of the Mach shock, degrees")
    rows = []
    for k, name in enumerate(names):
        a, b, c = (f[k] for f in found)
        order = np.log2(abs((b - a) / (c - b))) if c != b and b != a else float("nan")
        rows.append((name, *(f"{v:.4f}" for v in (a, b, c)), f"{order:.2f}"))
    return rows


def validate(arguments, work):
    """Writes docs/validation/cut_cells.md."""
    variants = Variants(arguments, work)
    variants.expect(3 * len(STREET_CELLS) + len(CELLS_PER_RADIUS))
    cylinder = cylinder_rows(variants)
    streets = street_rows(variants)
    header = ("quantity", *(f"{n} cells per radius" for n in CELLS_PER_RADIUS), "observed order")
    text = f"""# Cut cells

Produced by `validation/run cut_cells`, commit {arguments.commit or commit()}; machine: {machine()}.

## A cylinder in a shock of Mach {MACH:g}

A plane shock in air runs over a cylinder (planar 2D, half of it, radius R). At the end the undisturbed front is
{FRONT:g} R behind the middle of the cylinder. A shock is where the pressure is halfway between its two sides.

{table(header, cylinder)}
The order is that of the differences between the three grids. Shocks are captured over two to three cells: first order
at most is to be expected of their places.

## A street from a file

`cases/street_3d` and its twin `cases/street_stl_3d`, whose houses come from an STL file; also with stairs instead of
cut cells. Largest relative difference of all peaks and impulses at the gauges to those of the boxes with cut cells.

{table(("cell [m]", "faces between cells", "file", "boxes as stairs"), streets)}
"""
    target = work if arguments.quick else ROOT / "docs" / "validation"
    target.mkdir(parents=True, exist_ok=True)
    (target / "cut_cells.md").write_text(text)
    print(f"wrote {target / 'cut_cells.md'}; results of the runs: {work}")
