"""Gas and points in closed rooms, where waves come back: a held plate of points against a rigid obstacle of the same
shape, and a steel box under the pressure of gas for 50 ms."""
import numpy as np
from common import ROOT, Variants, commit, machine, per_cent, table

TARGETS = 2.0, 3.0  # of the mean pressure and of impulses and the box, per cent
# Where waves go to and fro for long, vortices drift as they like: two runs that differ in nothing that matters part,
# and one run says little. The mass of the charge is varied in steps that matter less than anything that is compared.
STEP = 0.0005
MEMBERS = {"obstacle": 9, "points": 3, "fine": 3}
CHARGE = """[[charge]]
shape = "{shape}"
mass = "{mass} kg"
position = {position}
detonation = "instantaneous"
"""
# name, geometry, size [m], cell [m], charge, plate from and to [m], region from and to [m], further keys of the region,
# end [ms], gauges [m]
ROOMS = (
    ("plane", "planar2d", (1, 1), 0.01, {"shape": "cylinder", "mass": 2, "position": [0.25, 0.5]},
     ((0.7, 0.3), (0.72, 0.7)), ((0.6, 0.2), (0.84, 0.8)), "", 18,
     {"front": (0.65, 0.5), "back": (0.95, 0.5)}),
    ("axisymmetric", "axisymmetric2d", (0.5, 1), 0.01, {"shape": "sphere", "mass": 0.5, "position": [0, 0.25]},
     ((0, 0.7), (0.2, 0.72)), ((0, 0.6), (0.32, 0.84)), "", 18,
     {"front": (0.105, 0.65), "back": (0.105, 0.95), "side": (0.45, 0.705)}),
    ("3D", "cartesian3d", (1, 1, 1), 0.04, {"shape": "sphere", "mass": 2, "position": [0.2, 0.44, 0.5]},
     ((0.68, 0.36, 0.36), (0.72, 0.64, 0.64)), ((0.44, 0.16, 0.16), (1, 0.84, 0.84)), "width = 2\n", 5,
     {"front": (0.58, 0.5, 0.5), "back": (0.94, 0.5, 0.5)}),
)
BOX = """[domain]
geometry = "axisymmetric2d"
size = [0.6, 1.2]
cell = 0.02
[boundaries]
all = "wall"
x_low = "symmetry"
[[initial_state]]
shape = "cylinder"
position = [0, 0.5]
radius = 0.16
length = 0.2
pressure = "100 bar"
density = 12
{walls}[[gauge]]
name = "axis"
point = [0.1, 0.6]
[[gauge]]
name = "wall"
point = [0.33, 0.6]
[output]
peak_fields = false
field_times = ["45 ms", "46 ms", "47 ms", "48 ms", "49 ms"]
[audit]
fail = 0
[end]
time = "50 ms"
"""
WALLS_OF_POINTS = """[[body]]
name = "box"
material = "RHA"
shape = "box"
lower = [0, 0.2]
upper = [0.4, 1.0]
cut = [{shape = "box", lower = [0, 0.24], upper = [0.36, 0.96]}]
[mpm_region]
box = {lower = [0, 0.1], upper = [0.5, 1.1]}
width = 3
"""
RIGID_WALLS = "".join(f'[[obstacle]]\nshape = "box"\nlower = {list(a)}\nupper = {list(b)}\n'
                      for a, b in (((0.36, 0.2), (0.4, 1.0)), ((0, 0.2), (0.4, 0.24)), ((0, 0.96), (0.4, 1.0))))


def room_deck(room, with_points, cell=None, change=0.0):
    """`change`: of the mass of the charge, relative."""
    _, geometry, size, usual, charge, plate, region, keys, end, gauges = room
    text = f'[domain]\ngeometry = "{geometry}"\nsize = {list(size)}\ncell = {cell or usual}\n'
    text += '[boundaries]\nall = "wall"\n'
    if geometry == "axisymmetric2d":
        text += 'x_low = "symmetry"\n'
    text += CHARGE.format(**{**charge, "mass": f"{charge['mass'] * (1.0 + change):.9g}"})
    shape = f'shape = "box"\nlower = {list(plate[0])}\nupper = {list(plate[1])}\n'
    if with_points:
        text += f'[[body]]\nname = "plate"\nmaterial = "RHA"\n{shape}[[constraint]]\nbody = "plate"\nkind = "fixed"\n'
        text += f"[mpm_region]\nbox = {{lower = {list(region[0])}, upper = {list(region[1])}}}\n{keys}"
    else:
        text += f"[[obstacle]]\n{shape}"
    for name, point in gauges.items():
        text += f'[[gauge]]\nname = "{name}"\npoint = {list(point)}\n'
    return text + f'[output]\npeak_fields = false\n[audit]\nfail = 0\n[end]\ntime = "{end} ms"\n'


def mean_pressure(result, room):
    """Over all that is not the plate, at the end [Pa]."""
    plate = room[5]
    dump = result.dumps[-1]
    pressure = dump.values("pressure")
    centres = [dump.centres(d) for d in range(pressure.ndim)]
    grids = np.meshgrid(*reversed(centres), indexing="ij")[::-1]  # x, y, z
    solid = np.all([(x > a) & (x < b) for x, a, b in zip(grids, *plate)], axis=0)
    weight = np.where(solid, 0.0, grids[0] if room[1] == "axisymmetric2d" else 1.0)
    return float(np.sum(weight * pressure) / np.sum(weight))


def impulse(result, gauge):
    """Of the overpressure, to the end [Pa s]."""
    history = result.gauge(gauge)
    time, over = history["time"], history["overpressure"]
    return float(np.sum(0.5 * (over[1:] + over[:-1]) * np.diff(time)))


def audit_of(result):
    energy = result.log["mpm_region"]["energy"]
    ledger = result.log["audit"]["findings"]["ledger"]
    return f"{100.0 * energy['drift']:+.2f} %", f"{100.0 * ledger['share']:.2f} %"


def members_of(room, kind):
    """How many runs a room has of a kind. In 3D one each: they are long, and end before vortices part."""
    return 1 if room[1] == "cartesian3d" else MEMBERS[kind]


class Sample:
    """A quantity in the members of one kind of run."""

    def __init__(self, values):
        self.mean = float(np.mean(values))
        self.count = len(values)
        self.deviation = float(np.std(values, ddof=1)) if len(values) > 1 else None

    def beside(self, reference):
        """The deviation of the mean from another's, with its standard error."""
        text = per_cent(self.mean / reference.mean)
        if self.deviation is None or reference.deviation is None:
            return text
        error = np.hypot(self.deviation / np.sqrt(self.count), reference.deviation / np.sqrt(reference.count))
        return f"{text[:-2]} ± {100.0 * error / reference.mean:.1f} %"


def room_rows(variants):
    """Rows of a table, and by how much one run of an obstacle differs from the next, the largest as a ratio."""
    rows, scatter = [], 0.0
    for room in ROOMS:
        name, cell = room[0], room[3]
        runs = {}
        for kind, with_points, size in (("obstacle", False, None), ("points", True, None), ("fine", False, cell / 2)):
            count = members_of(room, kind)
            runs[kind] = [variants("room", f"{name}-{kind}-{n}",
                                   text=room_deck(room, with_points, size, STEP * (n - (count - 1) // 2)))
                          for n in range(count)]
        audits = [audit_of(result) for result in runs["points"]]
        drift, surplus = (max((a[k] for a in audits), key=lambda text: abs(float(text.split()[0]))) for k in (0, 1))

        def row(first, what, unit, scale, measure):
            obstacle, points, fine = (Sample([measure(r) for r in runs[kind]]) for kind in runs)
            spread = "" if obstacle.deviation is None else f"{100.0 * obstacle.deviation / obstacle.mean:.1f} %"
            rows.append((*first, what, f"{scale * obstacle.mean:.4g} {unit}", spread, points.beside(obstacle),
                         fine.beside(obstacle), *((drift, surplus) if first[0] else ("", ""))))
            return 0.0 if obstacle.deviation is None else obstacle.deviation / obstacle.mean

        row((name, f"{1e3 * cell:g}"), "mean pressure", "MPa", 1e-6, lambda result: mean_pressure(result, room))
        for gauge in room[9]:
            scatter = max(scatter, row(("", ""), f'impulse, gauge "{gauge}"', "kPa s", 1e-3,
                                       lambda result: impulse(result, gauge)))
    return rows, scatter


def mean_in_box(result):
    """Of the overpressure over the inside of the box, in the dumps from 45 ms on [Pa]."""
    means = []
    for dump in result.dumps[1:]:
        pressure = dump.values("pressure")
        y, x = np.meshgrid(dump.centres(1), dump.centres(0), indexing="ij")
        weight = np.where((x < 0.36) & (abs(y - 0.6) < 0.36), x, 0.0)
        means.append(np.sum(weight * (pressure - 101325.0)) / np.sum(weight))
    return float(np.mean(means))


def box_rows(variants):
    """Rows of a table, and the scatter of the gauges in points, relative to their means."""
    rigid = variants("steel_box", "rigid", text=BOX.format(walls=RIGID_WALLS))
    points = variants("steel_box", "points", text=BOX.format(walls=WALLS_OF_POINTS))
    over = [mean_in_box(result) for result in (rigid, points)]
    rows = [("mean inside", f"{1e-3 * over[0]:.1f} kPa", per_cent(over[1] / over[0]), *audit_of(points))]
    scatter = []
    for gauge in ("axis", "wall"):
        late = [h["overpressure"][h["time"] >= 0.045] for h in (r.gauge(gauge) for r in (rigid, points))]
        over = [float(np.mean(values)) for values in late]
        scatter.append(float(np.std(late[1])) / over[1])
        rows.append((f"gauge \"{gauge}\"", f"{1e-3 * over[0]:.1f} kPa", per_cent(over[1] / over[0]), "", ""))
    return rows, max(scatter)


def validate(arguments, work):
    """Writes docs/validation/confined.md."""
    variants = Variants(arguments, work)
    variants.expect(sum(members_of(room, kind) for room in ROOMS for kind in MEMBERS) + 2)
    (rooms, spread), (boxes, scatter) = room_rows(variants), box_rows(variants)
    header = ("room", "cell [mm]", "", "obstacle", "spread of one run", "points", "obstacle, half the cell",
              "drift of energy", "surplus in the ledger")
    text = f"""# Closed rooms

Made by `validation/run confined`, commit {arguments.commit or commit()}; machine: {machine()}.

TNT detonates in a closed room of 1 m beside a plate. The plate is either a clamped body of material points in an MPM
region or a rigid obstacle of the same shape. Both runs contain the same gas; waves cross the faces of the region many
times. The table gives the mean pressure at the end and impulses up to the end. Targets: {TARGETS[0]:g} % for the mean
pressure, {TARGETS[1]:g} % for the impulses at the gauges before and behind the plate, "front" and "back".

Vortices shed by the edges of the plate drift through the room, and their paths are chaotic: runs that differ by a small
change of the charge end with different impulses where a vortex passes. The plane and the axisymmetric room are
therefore run several times with charges that differ in mass by {100 * STEP:g} % from one to the next:
{MEMBERS["obstacle"]} runs with the obstacle, {MEMBERS["points"]} with points and {MEMBERS["fine"]} with the obstacle on
cells of half the size. The table gives means. "Spread of one run" is the standard deviation among the runs with the
obstacle, {100 * spread:.1f} % at most; a deviation from the obstacle has its standard error beside it.

{table(header, rooms)}
A closed box of steel, walls of 40 mm, under gas that bursts in it, for 50 ms: overpressure over the last 5 ms, the mean
over the inside of the box and at two places. The box of points is free and elastic; the other is of rigid obstacles.
Target for the mean, the quasi-static pressure: {TARGETS[1]:g} %. A gauge in points reads the few that are in its cell,
here with a scatter (standard deviation in time) of up to {100 * scatter:.1f} %.

{table(("", "rigid", "points", "drift of energy", "surplus in the ledger"), boxes)}
Closed tubes at 2 to 50 bar and the balance of momentum are tests: `tests/bridge/test_bridge_confined.cpp`.
"""
    target = work if arguments.quick else ROOT / "docs" / "validation"
    target.mkdir(parents=True, exist_ok=True)
    (target / "confined.md").write_text(text)
    print(f"wrote {target / 'confined.md'}; results of the runs: {work}")
