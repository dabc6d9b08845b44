"""Blasts and a wind at nearby outflow boundaries, compared with large domains and with zero_gradient."""
import numpy as np
from common import ROOT, Variants, commit, machine, per_cent, table

AMBIENT_PRESSURE = 101325.0
FACES = ("x_high", "y_high", "z_high")
PLANES = ("x_low", "y_low", "z_low")
# name, geometry, near and far size [m], cell [m], end [ms], gauges [m]
BLASTS = (
    ("sphere, face at 1.5 m", "spherical1d", 1.5, 12.0, 0.01, 20.0, ((1.0,),)),
    ("sphere", "spherical1d", 2.5, 12.0, 0.01, 20.0, ((2.0,),)),
    ("sphere, face at 4.5 m", "spherical1d", 4.5, 12.0, 0.02, 30.0, ((4.0,),)),
    ("cylinder", "cylindrical1d", 2.5, 24.0, 0.02, 30.0, ((2.0,),)),
    ("cylinder, face at 5 m", "cylindrical1d", 5.0, 24.0, 0.04, 60.0, ((4.0,),)),
    ("axisymmetric", "axisymmetric2d", 2.5, 6.0, 0.025, 15.0, ((2.0, 0.01), (0.01, 2.0), (1.45, 1.45), (2.0, 2.0))),
    ("plane 2D", "planar2d", 2.5, 8.0, 0.025, 20.0, ((2.0, 0.01), (1.45, 1.45), (2.0, 2.0))),
    ("3D", "cartesian3d", 2.5, 5.0, 0.05, 12.0, ((2.0, 0.03, 0.03), (2.0, 2.0, 0.03), (2.0, 2.0, 2.0))),
)
WIND_TIMES = (20.0, 50.0, 100.0, 200.0, 300.0, 400.0)  # ms


def deck(blast, size, boundary):
    _, geometry, _, _, cell, end, gauges = blast
    dims = len(gauges[0])
    radial = geometry in ("spherical1d", "cylindrical1d", "axisymmetric2d")
    planes = [p for p in PLANES[:dims] if not (radial and p == "x_low")]
    extent = ", ".join([str(size)] * dims)
    lines = [f'[domain]\ngeometry = "{geometry}"\nsize = [{extent}]\ncell = {cell}\n[boundaries]']
    lines += [f'{plane} = "symmetry"' for plane in planes]
    lines += [f'{face} = "{boundary}"' for face in FACES[:dims]]
    lines += ['[[charge]]\nexplosive = "TNT"\nmass = "1 kg"\nposition = [0, 0, 0]']
    for n, gauge in enumerate(gauges):
        point = list(gauge) + [0] * (3 - dims)
        lines.append(f'[[gauge]]\nname = "g{n}"\npoint = [{", ".join(map(str, point))}]')
    return "\n".join(lines) + f'\n[end]\ntime = "{end} ms"\n'


def impulses(history):
    """Peak [Pa] and impulses [Pa s] of a record: until the pressure returns to the ambient one after its peak, and the
    largest fall of the impulse afterwards."""
    time, over = history["time"], history["overpressure"]
    steps = 0.5 * (over[1:] + over[:-1]) * np.diff(time)
    peak = int(np.argmax(over))
    behind = np.flatnonzero(over[peak:] < 0.0)
    zero = min(peak + int(behind[0]), len(steps)) if len(behind) else len(steps)
    later = np.cumsum(steps[zero:])
    return over[peak], steps[:zero].sum(), min(later.min(), 0.0) if len(later) else 0.0


def blast_rows(variants):
    rows = []
    for blast in BLASTS:
        name, _, near, far, _, end, gauges = blast
        short = name.replace(" ", "_").replace(",", "").replace(".", "_")
        domains = {"far": (far, "outflow"), "near": (near, "outflow"), "crude": (near, "zero_gradient")}
        runs = {key: variants("outflow", f"{short}-{key}", text=deck(blast, *domain))
                for key, domain in domains.items()}
        for n, gauge in enumerate(gauges):
            right, found, crude = (impulses(runs[key].gauge(f"g{n}")) for key in ("far", "near", "crude"))
            rows.append((name, f"{near:g} and {far:g}", f"({', '.join(f'{x:g}' for x in gauge)})", f"{end:g}",
                         f"{right[1]:.1f}", per_cent(found[1] / right[1]), f"{right[2]:.1f}",
                         per_cent(found[2] / right[2]), per_cent(crude[2] / right[2])))
    return rows


def wind_deck(size, boundary):
    middle, half = (0.5 * size[0], 0.5 * size[1]), 0.3
    return f"""[domain]
geometry = "planar2d"
size = [{size[0]}, {size[1]}]
cell = 0.05
[boundaries]
all = "{boundary}"
[ambient]
velocity = [100, 0]
[[obstacle]]
shape = "box"
lower = [{middle[0] - half:g}, {middle[1] - half:g}]
upper = [{middle[0] + half:g}, {middle[1] + half:g}]
[[gauge]]
name = "front"
point = [{middle[0] - half - 0.025:g}, {middle[1]:g}]
[end]
time = "400 ms"
"""


def wind_rows(variants):
    rows = []
    for size in ((3, 3), (6, 6)):
        for boundary in ("outflow", "zero_gradient"):
            result = variants("outflow", f"wind_{size[0]}m-{boundary}", text=wind_deck(size, boundary))
            history = result.gauge("front")
            values = [np.interp(1e-3 * t, history["time"], history["overpressure"]) for t in WIND_TIMES]
            rows.append((f"{size[0]} m, `{boundary}`", *(f"{1e-3 * v:.2f}" for v in values)))
    return rows


def validate(arguments, work):
    """Writes docs/validation/outflow.md."""
    variants = Variants(arguments, work)
    variants.expect(3 * len(BLASTS) + 4)
    blasts, winds = blast_rows(variants), wind_rows(variants)
    mach = 100.0 / np.sqrt(1.4 * AMBIENT_PRESSURE / 1.225)
    stagnation = AMBIENT_PRESSURE * ((1.0 + 0.2 * mach**2) ** 3.5 - 1.0)
    header = ("domain", "faces at [m]", "gauge [m]", "end [ms]", "positive [Pa s]", "outflow", "negative [Pa s]",
              "outflow", "zero_gradient")
    text = f"""# Outflow boundaries

Produced by `validation/run outflow`, commit {arguments.commit or commit()}; machine: {machine()}.

A charge of 1 kg of TNT (1 kg/m in planes and cylinders) in a small domain with `outflow` and with `zero_gradient`
faces, and in a large one. The positive impulse ends at the first zero after the peak; the negative one is the largest
fall of the impulse after that, until the end of the run. Deviations are relative to the large domain. Target: 5 %.

{table(header, blasts)}
A wind of 100 m/s (Mach {mach:.3f}) around a square of 0.6 m in square domains of 5 and 10 of its widths, cells of
50 mm: overpressure [kPa] at the centre of the cells in front of it. Isentropic stagnation: {1e-3 * stagnation:.2f} kPa.

{table(("domain", *(f"{t:g} ms" for t in WIND_TIMES)), winds)}"""
    target = work if arguments.quick else ROOT / "docs" / "validation"
    target.mkdir(parents=True, exist_ok=True)
    (target / "outflow.md").write_text(text)
    print(f"wrote {target / 'outflow.md'}; results of the runs: {work}")
