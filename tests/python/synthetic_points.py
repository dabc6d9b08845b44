"""Makes an output folder as a run of material points leaves it, from a made-up motion: something to draw reports of.

Usage: python3 synthetic_points.py DIR 3d|2d|1d|bare
"""
import json
import sys
from pathlib import Path

import h5py
import numpy as np

KINDS = {
    # A bar that shortens and spreads at its foot, a block beside it that stays.
    "3d": {"geometry": "cartesian3d", "cells": (12, 12, 16), "size": (6, 6, 12), "bodies": 2},
    "2d": {"geometry": "axisymmetric2d", "cells": (12, 16, 1), "size": (6, 12, 0), "bodies": 1},
    "1d": {"geometry": "planar1d", "cells": (40, 1, 1), "size": (30, 0, 0), "bodies": 2},
    "bare": {"geometry": "planar2d", "cells": (12, 16, 1), "size": (6, 12, 0), "bodies": 1},
}
SPACING = 1e-3
END = 40e-6
FIELDS = {"velocity": ("m/s", 3), "displacement": ("m", 3), "pressure": ("Pa", 1), "mises": ("Pa", 1),
          "plastic_strain": ("1", 1), "stress": ("Pa", 6), "body": ("1", 1), "material": ("1", 1)}


def start(kind):
    """Positions and bodies at the start; the second body lies beside the first."""
    axes = [(np.arange(2 * n) + 0.5) * 0.5 * SPACING if n else np.array([0.25e-3]) for n in kind["size"]]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    if kind["bodies"] == 1:
        return x, np.zeros(len(x))
    return np.concatenate([x, x + [kind["size"][0] * SPACING, 0.0, 0.0]]), np.repeat([0.0, 1.0], len(x))


def motion(x, body, up, time):
    """Displacement and velocity: the first body shortens along `up` and spreads across it near its foot."""
    s = np.sin(0.5 * np.pi * time / END)
    rate = 0.5 * np.pi / END * np.cos(0.5 * np.pi * time / END)
    shape = np.zeros_like(x)
    shape[:, up] = -0.25 * x[:, up]
    for d in range(3):
        if d != up:
            shape[:, d] = 0.3 * x[:, d] * np.exp(-x[:, up] / 3e-3)
    shape[body == 1.0] = 0.0
    return s * shape, rate * shape


def fields_at(kind, time):
    x, body = start(kind)
    up = max(d for d in range(3) if kind["size"][d])
    u, v = motion(x, body, up, time)
    strain = np.abs(u[:, up]) / 1e-3 * np.exp(-x[:, up] / 3e-3)
    pressure = 3e8 * np.sin(3e2 * x[:, up] + 1e5 * time) * (body == 0.0) * (time > 0.0)
    mises = 4e8 * (1.0 - np.exp(-20.0 * strain))
    stress = np.zeros((len(x), 6))
    stress[:, :3] = -pressure[:, None]
    return {"position": x + u, "displacement": u, "velocity": v, "pressure": pressure, "mises": mises,
            "plastic_strain": strain, "stress": stress, "body": body, "material": body}


def write_dump(path, kind, time, step):
    values = fields_at(kind, time)
    with h5py.File(path, "w") as file:
        file.attrs.update(time=time, step=step, geometry=kind["geometry"], count=len(values["body"]))
        for name, (unit, _) in {"position": ("m", 3), **FIELDS}.items():
            kept = values[name].astype("i4" if name in ("body", "material") else "f4")
            data = file.create_dataset("points/" + name, data=kept)
            data.attrs["unit"] = unit


def write_gauge(path, kind):
    """The far end of the first body."""
    x, _ = start(kind)
    up = max(d for d in range(3) if kind["size"][d])
    x = x[[np.argmax(x[:len(x) // kind["bodies"], up])]]
    rows = []
    for time in np.linspace(0.0, END, 401):
        u, v = motion(x, np.zeros(1), up, time)
        rows.append([time, *(x + u)[0], *u[0], *v[0], 1e8, 4e8 * time / END, 8930.0, 0.1 * time / END, 293.0, 0.0])
    header = ("time [s],x [m],y [m],z [m],displacement_x [m],displacement_y [m],displacement_z [m],velocity_x [m/s],"
              "velocity_y [m/s],velocity_z [m/s],pressure [Pa],mises [Pa],density [kg/m3],plastic_strain [1],"
              "temperature [K],damage [1]")
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.10g")
    return rows, up


def write(folder, which, dumps=5, drift=-2e-3):
    """Fills `folder`, which must not exist."""
    kind = KINDS[which]
    folder = Path(folder)
    folder.mkdir(parents=True)
    bare = which == "bare"
    names = ["bar", "block <beside>"][:kind["bodies"]]
    log_bodies = [{"name": name, "material": "copper", "source": "a handbook", "points": 1000,
                   "points_per_direction": 2, "mass": 0.0103, "geometric_mass": 0.0103 * (1 + 1e-15),
                   "velocity": [0.0, -190.0, 0.0], "rigid": False} for name in names]
    summary = {"units": "SI", "gauges": [], "burst": "none", "point_gauges": [], "bodies": []}
    if not bare:
        (folder / "points").mkdir()
        (folder / "gauges").mkdir()
        for n, time in enumerate(np.linspace(0.0, END, dumps)):
            write_dump(folder / f"points/points_{n:06d}.h5", kind, time, 100 * n)
        rows, up = write_gauge(folder / "gauges/tail.csv", kind)
        final = rows[-1][4:7]
        summary["point_gauges"] = [{
            "name": "tail", "body": "bar", "file": "gauges/tail.csv", "position": rows[0][1:4],
            "peak_displacement": {"value": float(np.linalg.norm(final)), "time": END}, "component": "xyz"[up],
            "component_displacement": {"value": final[up], "time": END}, "final_displacement": final,
            "peak_velocity": {"value": 123.4, "time": 0.0}, "peak_mises": {"value": 4e8, "time": END},
            "plastic_strain": 0.1, "damage": 0.0, "left_the_domain": which == "1d"}]
        sums = {"points": 1000, "mass": 0.0103, "momentum": [0.0, -2.0, 0.0], "centre": [0.0, 0.0, 0.0],
                "velocity": [0.0, -190.0, 0.0], "kinetic_energy": 186.0, "internal_energy": 0.0, "plastic_work": 0.0,
                "largest_displacement": 0.0, "damaged_mass": 0.0}
        summary["bodies"] = [{"name": "", "body": name, "material": "copper", "start": sums,
                              "end": {**sums, "kinetic_energy": 1.25, "internal_energy": 184.0, "plastic_work": 180.0},
                              "peak_displacement": {"value": 3.25e-3, "time": END},
                              "peak_velocity": {"value": 190.0, "time": 0.0}} for name in names]
        t = np.linspace(0.0, END, 301)
        columns = [t]
        for n in range(len(names)):
            kinetic = 186.0 / (n + 1) * np.cos(0.5 * np.pi * t / END) ** 2
            lost = 186.0 / (n + 1) - kinetic
            columns += [kinetic, lost + drift * 186.0 * t / END, 0.95 * lost]
        header = "time [s]" + "".join(f",{n}: kinetic_energy [J],{n}: internal_energy [J],{n}: plastic_work [J]"
                                      for n in names)
        np.savetxt(folder / "energies.csv", np.array(columns).T, delimiter=",", header=header, comments="",
                   fmt="%.10g")
    (folder / "summary.json").write_text(json.dumps(summary))
    nx, ny, nz = kind["cells"]
    totals = {"mass": [0.0206, 0.0], "momentum": [0.0, -2.0, 0.0], "energy": 186.0}
    log = {"title": "Made-up <points>", "deck_path": "deck.toml", "deck": "[domain]\ncell = \"1 mm\"\n",
           "status": "running" if bare else "done", "end_reason": "" if bare else "reached the end time 40 us",
           "exit_code": 0, "started_at": "2026-01-02T03:04:05Z", "time": END, "end_time": END, "step": 1436,
           "last_dt": 4e-8,
           "domain": {"geometry": kind["geometry"], "lower": [0.0, 0.0, 0.0],
                      "upper": [nx * SPACING, ny * SPACING, nz * SPACING], "cell_size": SPACING, "cells": [nx, ny, nz],
                      "cell_count": nx * ny * nz,
                      "boundary": ["symmetry", "outflow", "symmetry", "outflow", "symmetry", "outflow"]},
           "blocks": 4, "scheme": "material points", "courant": 0.4,
           "ambient": {"fluid": "", "pressure": 101325.0, "density": 1.225}, "charges": [], "obstacles": 0, "gauges": 0,
           "dumps": 0 if bare else dumps, "wall_seconds": 12.0, "cell_updates_per_second": 0.0,
           "timings": {} if bare else {"points to grid": 3.0, "strain and stress": 4.0},
           "audit": {"balanced": True, "reasons": [], "drift_judged": True, "for_comparison": False,
                     "findings": {"drift": {"amount": 186.0 * drift, "scale": 186.0, "share": drift, "warn": 5e-3,
                                            "fail": 5e-2, "reported": abs(drift) > 5e-3}},
                     "initial": totals, "current": totals, "outflow": totals, "guarded_cells": 0, "guard_mass": 0.0,
                     "guard_energy": 0.0, "relative_error": {"mass": [1e-16, 0.0], "energy": abs(drift)}},
           "format": 2,
           "versions": {"brisance": "0.1.0", "compiler": "GNU 12.2.0", "compiler_flags": "-O3", "hdf5": "1.10.8"},
           "machine": {"processor": "AMD EPYC 7B13", "cores": 2, "threads": 2},
           "points": {"count": 2000, "bytes": 600000, "shape_function": "bspline", "order": "musl", "transfer": "xpic",
                      "pic_fraction": 0.0, "xpic_order": 2, "locking_control": True, "linear_viscosity": 0.06,
                      "quadratic_viscosity": 1.5, "body_force": [0.0, -9.81, 0.0], "constraints": 1, "contacts": 0,
                      "surface_pressures": 0, "gauges": 0 if bare else 1, "bodies": log_bodies,
                      "point_updates_per_second": 2.4e6,
                      "audit": {"mass": {"initial": 0.0206, "current": 0.0206, "lost": 0.0, "relative_error": 1e-16},
                                "momentum": {"initial": [0.0, -2.0, 0.0], "current": [0.0, 0.1, 0.0],
                                             "lost": [0.0, 0.0, 0.0], "constraint_impulse": [0.0, 0.0, 0.0]},
                                "energy": {"initial": 186.0, "current": 186.0 * (1 + drift), "lost": 0.0,
                                           "scale": 186.0, "drift": drift, "largest_drift": drift,
                                           "work": 0.0, "lost_at_constrained_nodes": 0.25, "filtered": 0.0, "apic": 0.0,
                                           "friction": 0.125},
                                "lost_points": 17 if which == "1d" else 0}}}
    (folder / "run.json").write_text(json.dumps(log))


if __name__ == "__main__":
    write(sys.argv[1], sys.argv[2])
