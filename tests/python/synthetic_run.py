"""Makes an output folder as a run leaves it, from a made-up decaying spherical wave: something to draw reports of.

Usage: python3 synthetic_run.py DIR 3d|2d|1d|bare
"""
import json
import sys
from pathlib import Path

import h5py
import numpy as np

AMBIENT = 101325.0
SOUND_SPEED = 340.0
MASS = 8.0
ROOT = MASS ** (1 / 3)


def peak(distance):
    """Sadovsky's formula for the peak overpressure of a spherical charge of TNT."""
    z = np.maximum(distance / ROOT, 0.15)
    return 1e6 * (0.085 / z + 0.3 / z ** 2 + 0.8 / z ** 3)


RADII = np.linspace(0.0, 60.0, 60001)
SPEEDS = SOUND_SPEED * np.sqrt(1 + 6 / 7 * peak(RADII) / AMBIENT)
ARRIVALS = np.concatenate([[0.0], np.cumsum(np.diff(RADII) * 2 / (SPEEDS[1:] + SPEEDS[:-1]))])


def arrival(distance):
    return np.interp(distance, RADII, ARRIVALS)


def duration(distance):
    return 1.35e-3 * np.sqrt(np.maximum(distance, 0.3)) * MASS ** (1 / 6)


def impulse(distance, b=1.5):
    return peak(distance) * duration(distance) * (1 / b - (1 - np.exp(-b)) / b ** 2)


def overpressure(distance, time):
    s = (time - arrival(distance)) / duration(distance)
    return np.where(s < 0, 0.0, peak(distance) * (1 - s) * np.exp(-1.5 * np.clip(s, 0, 50)))


def reference(distance):
    """Stand-in for the empirical values: a little off the wave itself, so that the two can be told apart."""
    return {"peak_overpressure": float(1.06 * peak(distance)), "arrival_time": float(0.97 * arrival(distance)),
            "positive_duration": float(1.1 * duration(distance)), "positive_impulse": float(1.08 * impulse(distance))}


KINDS = {
    "3d": {"geometry": "cartesian3d", "cells": (96, 96, 64), "spacing": 0.125, "obstacle": (5, 7, 3, 5, 0, 3),
           "gauges": [(2.0, 0.06, 0.06), (4.0, 0.06, 0.06), (7.0, 0.06, 0.06), (9.0, 4.0, 1.0), (11.0, 0.06, 0.06)]},
    "2d": {"geometry": "axisymmetric2d", "cells": (160, 80, 1), "spacing": 0.05, "obstacle": None,
           "gauges": [(2.0, 0.5, 0.0), (5.0, 0.5, 0.0)]},
    "1d": {"geometry": "spherical1d", "cells": (1500, 1, 1), "spacing": 0.01, "obstacle": None,
           "gauges": [(1.0 * n, 0.0, 0.0) for n in range(1, 15)]},
    "bare": {"geometry": "planar1d", "cells": (400, 1, 1), "spacing": 0.0025, "obstacle": None, "gauges": []},
}


def fields_on(x, y, z, time, obstacle):
    """Fields at the centres of cells: unit and values, [k, j, i]."""
    zz, yy, xx = np.meshgrid(z, y, x, indexing="ij")
    r = np.sqrt(xx ** 2 + yy ** 2 + zz ** 2)
    p = np.maximum(overpressure(r, time), -0.6 * AMBIENT)
    seen = arrival(r) <= time
    fields = {"pressure": ("Pa", AMBIENT + p), "density": ("kg/m3", 1.225 * (1 + p / (p + 7 * AMBIENT) * 6)),
              "velocity": ("m/s", np.stack([xx, yy, zz], -1) / np.maximum(r, 1e-9)[..., None] * p[..., None] / 415),
              "peak_overpressure": ("Pa", np.where(seen, peak(r), 0.0)),
              "impulse": ("Pa s", np.where(seen, impulse(r), 0.0))}
    if obstacle is not None:
        fields["obstacle"] = ("1", obstacle(xx, yy, zz).astype(float))
    return fields


BLOCK = 16


def leaves(kind, time):
    """Blocks of cells around the front of the wave, up to two levels finer: level and place, counted in blocks."""
    dims = sum(n > 1 for n in kind["cells"])
    found = []

    def visit(level, place):
        edge = BLOCK * kind["spacing"] / 2 ** level
        low = np.array(place[:dims]) * edge
        nearest = np.sqrt(np.sum(low ** 2))
        farthest = np.sqrt(np.sum((low + edge) ** 2))
        front = np.interp(time, ARRIVALS, RADII)
        if level < 2 and nearest <= front <= farthest:
            for corner in range(2 ** dims):
                visit(level + 1, [2 * place[d] + (corner >> d & 1) if d < dims else 0 for d in range(3)])
        else:
            found.append((level, place))

    parts = [max(1, n // BLOCK) for n in kind["cells"]]
    for place in np.ndindex(*parts[::-1]):
        visit(0, list(place[::-1]))
    return found


def write_level_dump(path, kind, time, step, obstacle):
    """A dump of cells of several sizes as src/output/level_fields.cpp lays it out."""
    dims = sum(n > 1 for n in kind["cells"])
    h = kind["spacing"]
    with h5py.File(path, "w") as file:
        file.attrs.update(time=time, step=step, geometry=kind["geometry"], origin=[0.0, 0.0, 0.0], spacing=h,
                          cells=kind["cells"])
        blocks = leaves(kind, time)
        for level in range(max(level for level, _ in blocks) + 1):
            group = file.create_group(f"VTKHDF/Level{level}")
            group.attrs["Spacing"] = [h / 2 ** level if d < dims else h for d in range(3)]
            boxes, arrays = [], {}
            for _, place in (block for block in blocks if block[0] == level):
                n = [BLOCK if d < dims else 1 for d in range(3)]
                low = [place[d] * n[d] for d in range(3)]
                boxes.append([bound for d in range(3) for bound in (low[d], low[d] + n[d] - 1)])
                axes = [(low[d] + np.arange(n[d]) + 0.5) * h / 2 ** level if d < dims else np.zeros(1)
                        for d in range(3)]
                for name, (_, values) in (fields_on(*axes, time, obstacle)
                                          | {"level": ("1", np.full(n[::-1], float(level)))}).items():
                    arrays.setdefault(name, []).append(values.reshape(-1, *values.shape[3:]))
            group["AMRBox"] = np.array(boxes, dtype="i4").reshape(-1, 6)
            for name, parts in arrays.items():
                group.create_dataset("CellData/" + name, data=np.concatenate(parts).astype("f4"), compression=1)


def write_dump(path, kind, time, step, obstacle):
    nx, ny, nz = kind["cells"]
    h = kind["spacing"]
    x, y, z = ((np.arange(n) + 0.5) * h for n in (nx, ny, nz))
    fields = fields_on(x, y if ny > 1 else y * 0, z if nz > 1 else z * 0, time, obstacle)
    with h5py.File(path, "w") as file:
        file.attrs.update(time=time, step=step, geometry=kind["geometry"], origin=[0.0, 0.0, 0.0], spacing=h,
                          cells=[nx, ny, nz], block_size=[BLOCK if n > 1 else 1 for n in (nx, ny, nz)])
        for name, (unit, values) in fields.items():
            data = file.create_dataset("cells/" + name, data=values.astype("f4"), compression=1, shuffle=True)
            data.attrs["unit"] = unit


def write_gauges(folder, kind, end):
    (folder / "gauges").mkdir()
    entries = []
    for n, position in enumerate(kind["gauges"]):
        r = float(np.sqrt(np.dot(position, position)))
        t = np.linspace(0.0, end, 2001)
        p = overpressure(r, t)
        columns = [t, AMBIENT + p, p, 1.2 + 0 * t, p / 400, 0 * t, 0 * t, 0.6 * (p / 400) ** 2,
                   np.concatenate([[0.0], np.cumsum(np.diff(t) * 0.5 * (p[1:] + p[:-1]))])]
        name = f"gauge {n + 1}"
        path = f"gauges/gauge_{n + 1}.csv"
        header = ("time [s],pressure [Pa],overpressure [Pa],density [kg/m3],velocity_x [m/s],velocity_y [m/s],"
                  "velocity_z [m/s],dynamic_pressure [Pa],impulse [Pa s]")
        np.savetxt(folder / path, np.array(columns).T, delimiter=",", header=header, comments="", fmt="%.10g")
        arrived = arrival(r) < end
        complete = bool(arrival(r) + duration(r) < end)
        own = {"peak_overpressure": float(peak(r)), "arrival_time": float(arrival(r)),
               "positive_duration": float(duration(r)) if complete else None, "positive_impulse": float(impulse(r))}
        if not arrived:
            own = {"peak_overpressure": 0.0, "arrival_time": None, "positive_duration": None, "positive_impulse": 0.0}
        other = reference(r)
        ratio = {key: own[key] / other[key] if own[key] else None for key in other}
        if not complete:
            ratio["positive_impulse"] = None
        # The third gauge stands in coarse cells; what it has not seen is null.
        rest = {"largest_impulse": 1.25 * own["positive_impulse"], "time_of_largest_impulse": 0.9 * end,
                "final_overpressure": 321.0, "peak_front_overpressure": 1.2 * own["peak_overpressure"],
                "half_width": 1e-3, "cells_per_half_width": 7.5, "expected_clipping": 0.17 if n == 2 else 0.02,
                "reflected": False,
                "negative_phase": {"peak": -2468.0, "time": end, "impulse": -7.75, "duration": None, "complete": False}}
        if not arrived:
            rest = {**rest, **dict.fromkeys(("peak_front_overpressure", "half_width", "cells_per_half_width",
                                             "expected_clipping", "reflected", "negative_phase"))}
        entries.append({"name": name, "file": path, "position": position, "distance": r, "scaled_distance": r / ROOT,
                        "time_of_peak": own["arrival_time"], "positive_phase_complete": complete, **own, **rest,
                        "kingery_bulmash": other, "ratio": ratio})
    curve = [{"scaled_distance": z, "distance": z * ROOT, **reference(z * ROOT)}
             for z in np.geomspace(0.1, 40.0, 60).tolist()]
    (folder / "summary.json").write_text(json.dumps(
        {"units": "SI", "burst": "hemispherical", "ambient_pressure": AMBIENT, "gauges": entries,
         "kingery_bulmash_curve": curve}))


def write(folder, which, dumps=7, levels=False):
    """Fills `folder`, which must not exist. `levels`: with cells of several sizes."""
    kind = KINDS[which]
    folder = Path(folder)
    folder.mkdir(parents=True)
    bare = which == "bare"
    end = 0.02
    nx, ny, nz = kind["cells"]
    h = kind["spacing"]
    box = kind["obstacle"]
    inside = box and (lambda x, y, z: (x > box[0]) & (x < box[1]) & (y >= box[2] - 3) & (y < box[3]) & (z < box[5]))
    (folder / "deck.toml").write_text(DECK)
    if not bare:
        (folder / "fields").mkdir()
        for n, time in enumerate(np.linspace(0.0, end, dumps)):
            if levels:
                write_level_dump(folder / f"fields/fields_{n:06d}.hdf", kind, time, 100 * n, inside)
            else:
                write_dump(folder / f"fields/fields_{n:06d}.h5", kind, time, 100 * n, inside)
        write_gauges(folder, kind, end)
    totals = {"mass": [1764.0, 8.0], "momentum": [0.0, 0.0, 0.0], "energy": 4.1e8}
    nothing = {"mass": [0.0, 0.0], "momentum": [0.0, 0.0, 0.0], "energy": 0.0}
    charge = {"explosive": "TNT", "specified_mass": MASS, "realised_mass": MASS * (1 + 2e-15),
              "realised_energy": 3.43e7,
              "cells_per_radius": 7.4, "centre": [0.0, 0.0, 0.0], "source": "Dobratz & Crawford 1985 (LLNL UCRL-52997)",
              "density": 1630.0, "detonation": "programmed", "tnt_equivalent_pressure": 1.0,
              "tnt_equivalent_impulse": 1.0}
    log = {"title": "Sod tube" if bare else "8 kg TNT on the ground <made-up wave>", "deck_path": "deck.toml",
           "deck": DECK,
           "status": "running" if bare else "done", "end_reason": "" if bare else "end time reached", "exit_code": 0,
           "started_at": "2026-01-02T03:04:05Z", "time": end, "end_time": end, "step": 1843, "last_dt": 1.1e-5,
           "domain": {"geometry": kind["geometry"], "lower": [0.0, 0.0, 0.0], "upper": [nx * h, ny * h, nz * h],
                      "cell_size": h, "cells": [nx, ny, nz], "cell_count": nx * ny * nz,
                      "boundary": ["symmetry", "outflow", "symmetry", "outflow", "wall", "outflow"]},
           "blocks": 18, "scheme": "muscl-hancock", "courant": 0.8,
           "ambient": {"fluid": "air", "pressure": AMBIENT, "density": 1.225}, "charges": [] if bare else [charge],
           "obstacles": 1 if box else 0, "gauges": len(kind["gauges"]), "dumps": 0 if bare else dumps,
           "wall_seconds": 153.2, "cell_updates_per_second": 1.72e7,
           "timings": {} if bare else {"sweep_x": 41.2, "sweep_y": 43.0, "sweep_z": 44.9, "exchange": 6.1,
                                       "field_output": 9.9, "gauges": 0.3},
           "audit": {"balanced": True, "reasons": [], "drift_judged": True, "for_comparison": False,
                     "findings": {"guard_energy": {"amount": 3.2e-3, "scale": 3.43e7, "share": 9.3e-11, "warn": 1e-4,
                                                   "fail": 1e-2, "reported": False}},
                     "initial": totals, "current": totals, "outflow": nothing, "guarded_cells": 0 if bare else 12,
                     "guard_mass": 1e-12, "guard_energy": 3.2e-3,
                     "relative_error": {"mass": [3e-16, 1.4e-13], "energy": 2.2e-8}},
           "format": 2,
           "versions": {"brisance": "0.1.0", "compiler": "GNU 12.2.0", "compiler_flags": "-O3 -march=native",
                        "hdf5": "1.10.8"},
           "machine": {"processor": "AMD EPYC 7B13", "cores": 2, "threads": 2}}
    if levels:
        last = leaves(kind, 0.3 * end)  # later the front is outside
        log["levels"] = {"changes": 12, "cells": [
            {"level": level, "cell_size": h / 2 ** level, "blocks": sum(leaf[0] == level for leaf in last),
             "cells": sum(leaf[0] == level for leaf in last) * BLOCK ** sum(n > 1 for n in kind["cells"])}
            for level in range(3)]}
    (folder / "run.json").write_text(json.dumps(log))


DECK = """# A made-up deck with <angle brackets> & an ampersand
title = "8 kg TNT on the ground"

[domain]
size = ["12 m", "12 m", "8 m"]
cell_size = "125 mm"

[[charge]]
explosive = "TNT"
mass = "8 kg"
"""

if __name__ == "__main__":
    write(sys.argv[1], sys.argv[2])
