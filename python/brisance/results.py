"""Reader of the output folder of a run, for the report, the validation and users, in SI units.

docs/output.md, "Reading results in Python", shows how to use it.
"""
import csv
import functools
import io
import json
import re
from pathlib import Path

import h5py
import numpy as np

DIMENSIONS = {"cartesian3d": 3, "planar2d": 2, "axisymmetric2d": 2, "planar1d": 1, "cylindrical1d": 1,
              "spherical1d": 1}
AXES = {"axisymmetric2d": ("r", "z", ""), "cylindrical1d": ("r", "", ""), "spherical1d": ("r", "", "")}


def text(attribute):
    """A text that HDF5 may store as bytes."""
    return attribute.decode() if isinstance(attribute, bytes) else str(attribute)


def nearest(dumps, time):
    """The dump nearest to a time [s]."""
    if not dumps:
        raise ValueError("there is no dump: the run has not written one yet, or the deck requests none")
    return min(dumps, key=lambda dump: abs(dump.time - time))


class Dump:
    """One field dump. Values are read on demand, and only as far as needed."""

    def __init__(self, path):
        self.path = path
        with h5py.File(path, "r") as file:
            self.time = float(file.attrs["time"])
            self.step = int(file.attrs["step"])
            self.geometry = text(file.attrs["geometry"])
            self.origin = np.array(file.attrs["origin"])
            self.spacing = float(file.attrs["spacing"])
            self.cells = tuple(int(n) for n in file.attrs["cells"])
            self.fields = sorted(file["cells"])

    def values(self, field):
        """All values of a field, [k, j, i] with k along z, without the directions that the run does not resolve; for a
        vector the last index is the component."""
        with h5py.File(self.path, "r") as file:
            values = file["cells"][field][...].astype(float)
        return values.reshape(values.shape[3 - DIMENSIONS[self.geometry]:])

    def plane(self, field, normal, index):
        """Values of a scalar field in the layer `index` of cells across direction `normal` (0: x, 1: y, 2: z).

        The last index of the result belongs to the lower of the two remaining directions.
        """
        where = [slice(None)] * 3
        where[2 - normal] = index
        with h5py.File(self.path, "r") as file:
            return file["cells"][field][tuple(where)].astype(float)

    def centres(self, direction):
        """Positions of the cell centres along a direction [m]."""
        return self.origin[direction] + (np.arange(self.cells[direction]) + 0.5) * self.spacing

    def edges(self, direction):
        """Positions of the cell faces along a direction [m]."""
        return self.origin[direction] + np.arange(self.cells[direction] + 1) * self.spacing

    def layer(self, direction, position):
        """Index of the layer of cells that contains a position, clamped to the domain."""
        index = int(np.floor((position - self.origin[direction]) / self.spacing))
        return min(max(index, 0), self.cells[direction] - 1)


class PointDump:
    """One dump of the material points. Values are read on demand."""

    def __init__(self, path):
        self.path = path
        with h5py.File(path, "r") as file:
            self.time = float(file.attrs["time"])
            self.step = int(file.attrs["step"])
            self.count = int(file.attrs["count"])
            self.fields = sorted(file["points"])

    def values(self, field):
        """All values of a field: (n), (n, 3) or (n, 6)."""
        with h5py.File(self.path, "r") as file:
            return file["points"][field][...].astype(float)

    def read(self):
        """All fields by their names, and the `time`."""
        with h5py.File(self.path, "r") as file:
            return {name: file["points"][name][...].astype(float) for name in self.fields} | {"time": self.time}


class Profile:
    """The state of a burst in one or two dimensions at the start or end of a run: `values` by component, and the
    `ambient` state around it. Components are "pressure" and those listed in `components`."""

    def __init__(self, path):
        self.path = path
        with h5py.File(path, "r") as file:
            self.time = float(file.attrs["time"])
            self.origin = np.array(file.attrs["origin"])
            self.spacing = float(file.attrs["spacing"])
            self.cells = tuple(int(n) for n in file.attrs["cells"])
            self.components = text(file["profile/state"].attrs["names"]).split()
            self._ambient = dict(zip(self.components, file["profile/ambient"][...].astype(float)))
            self._ambient["pressure"] = float(file.attrs["ambient_pressure"])

    def values(self, component):
        """[i] along the radius, or [j, i] where the profile has two dimensions."""
        with h5py.File(self.path, "r") as file:
            data = file["profile"]
            values = data["pressure"][...] if component == "pressure" else data["state"][
                self.components.index(component)]
        return values[0] if values.shape[0] == 1 else values

    def ambient(self, component):
        return self._ambient[component]

    def radii(self):
        """Radii of the cell centres [m]."""
        return (np.arange(self.cells[0]) + 0.5) * self.spacing


FORMAT = 2  # of run.json, see src/output/run_log.cpp


class UnknownFormat(OSError):
    """A run.json of another version of the program."""


class Run:
    """The folder of a run. Files are read on demand."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.log = self._json("run.json")
        if self.log is None:
            raise FileNotFoundError(f'"{folder}" is not the output folder of a run: it does not contain run.json')
        if self.log.get("format") != FORMAT:
            raise UnknownFormat(f'"{folder}/run.json" has format {self.log.get("format", "none")}, but this reader '
                                f'supports {FORMAT}: run the deck again, or read it with the version that wrote it')
        self.points = self.log.get("points")  # of runs of material points

    @functools.cached_property
    def summary(self):
        """The contents of summary.json; no gauges if the run is not done."""
        return self._json("summary.json") or {"gauges": [], "burst": "none"}

    @property
    def gauges(self):
        """Summaries of the gas gauges by name."""
        return {gauge["name"]: gauge for gauge in self.summary["gauges"]}

    @property
    def point_gauges(self):
        return self.summary.get("point_gauges", [])

    @property
    def bodies(self):
        """Summaries of the bodies, including those of gauges that watch a body."""
        return self.summary.get("bodies", [])

    @functools.cached_property
    def histories(self):
        """All histories by gauge name; None where the file is missing."""
        return {name: self._table(file) for name, file in self._gauge_files.items()}

    def gauge(self, name):
        """The history of one gauge: columns by name, without units."""
        # A run that is not done has no summary yet, which names the files.
        file = self._gauge_files.get(name) or f"gauges/{file_name(name)}.csv"
        history = self._table(file)
        if history is None:
            known = ", ".join(self._gauge_files) or "none"
            raise KeyError(f'"{self.folder}" contains no history of a gauge "{name}"; available: {known}')
        return history

    @functools.cached_property
    def dumps(self):
        """Field dumps in order of time."""
        return sorted((Dump(path) for path in self.folder.glob("fields/fields_*.h5")), key=lambda dump: dump.time)

    @functools.cached_property
    def point_dumps(self):
        """Dumps of the material points in order of time."""
        return sorted((PointDump(path) for path in self.folder.glob("points/points_*.h5")), key=lambda dump: dump.time)

    @functools.cached_property
    def profiles(self):
        """Profiles by file name: start_1, start_2, ..., end."""
        return {path.stem: Profile(path) for path in sorted(self.folder.glob("profiles/*.h5"))}

    @functools.cached_property
    def energies(self):
        """Columns of energies.csv, three per body; None without material points."""
        return self._table("energies.csv")

    def total_energies(self):
        """Times, and kinetic and internal energies of all bodies together."""
        kinetic, internal = (sum(values for name, values in self.energies.items() if name.endswith(kind))
                             for kind in ("kinetic_energy", "internal_energy"))
        return self.energies["time"], kinetic, internal

    @property
    def cell_size(self):
        return self.log["domain"]["cell_size"]

    @property
    def geometry(self):
        return self.log["domain"]["geometry"]

    @property
    def dimensions(self):
        return DIMENSIONS[self.geometry]

    @property
    def axes(self):
        """Names of the three directions."""
        return AXES.get(self.geometry, ("x", "y", "z"))

    @property
    def ambient_pressure(self):
        return self.log["ambient"]["pressure"]

    @property
    def curve(self):
        """The Kingery-Bulmash curve as a dictionary of arrays (absent values are NaN), or None."""
        rows = self.summary.get("kingery_bulmash_curve")
        if not rows:
            return None
        return {key: np.array([np.nan if row[key] is None else row[key] for row in rows]) for key in rows[0]}

    def _json(self, name):
        path = self.folder / name
        return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None

    @functools.cached_property
    def _gauge_files(self):
        """Files of the histories by gauge name."""
        entries = [*self.summary["gauges"], *self.point_gauges, *self.bodies]
        return {entry["name"]: entry["file"] for entry in entries if entry["name"] and entry.get("file")}

    def _table(self, name):
        """Columns of a CSV file by name, without units; None if it is missing or has no header yet."""
        path = self.folder / name
        if not path.exists():
            return None
        # A run in progress or killed may leave an incomplete last line, even within its last number.
        whole = path.read_bytes().decode("utf-8").rpartition("\n")[0]
        rows = csv.reader(io.StringIO(whole, newline=""))
        names = [column.split(" [")[0] for column in next(rows, [])]
        if not names:
            return None
        values = [[float(value) for value in row] for row in rows]
        table = np.array(values).reshape(-1, len(names))
        return {column: table[:, i] for i, column in enumerate(names)}


def file_name(gauge):
    """A gauge's name as it appears in its file name (`sanitised` in src/output/gauges.cpp)."""
    name = re.sub(rb"[^A-Za-z0-9_.-]", b"_", gauge.encode()).decode()
    return f"_{name}" if not name or name.startswith(".") else name
