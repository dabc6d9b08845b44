"""The output folder of a run, read for plotting. Everything is in SI units."""
import csv
import json
from pathlib import Path

import h5py
import numpy as np

DIMENSIONS = {"cartesian3d": 3, "planar2d": 2, "axisymmetric2d": 2, "planar1d": 1, "cylindrical1d": 1,
              "spherical1d": 1}
AXES = {"axisymmetric2d": ("r", "z", ""), "cylindrical1d": ("r", "", ""), "spherical1d": ("r", "", "")}


class Dump:
    """One field dump. Values are read when they are asked for, and only the part that is needed."""

    def __init__(self, path):
        self.path = path
        with h5py.File(path, "r") as file:
            self.time = float(file.attrs["time"])
            self.step = int(file.attrs["step"])
            self.origin = np.array(file.attrs["origin"])
            self.spacing = float(file.attrs["spacing"])
            self.cells = tuple(int(n) for n in file.attrs["cells"])
            self.fields = sorted(file["cells"])

    def plane(self, field, normal, index):
        """Values of a scalar field in the layer `index` of cells across direction `normal` (0: x, 1: y, 2: z).

        The result's last direction is the lower of the two that remain.
        """
        where = [slice(None)] * 3
        where[2 - normal] = index
        with h5py.File(self.path, "r") as file:
            return file["cells"][field][tuple(where)].astype(float)

    def line(self, field):
        """Values along x in a one-dimensional run."""
        with h5py.File(self.path, "r") as file:
            return file["cells"][field][0, 0].astype(float)

    def centres(self, direction):
        """Positions of the cell centres along a direction [m]."""
        return self.origin[direction] + (np.arange(self.cells[direction]) + 0.5) * self.spacing

    def edges(self, direction):
        """Positions of the cell faces along a direction [m]."""
        return self.origin[direction] + np.arange(self.cells[direction] + 1) * self.spacing

    def layer(self, direction, position):
        """Index of the layer of cells that holds a position, clamped to the domain."""
        index = int(np.floor((position - self.origin[direction]) / self.spacing))
        return min(max(index, 0), self.cells[direction] - 1)


class PointDump:
    """One dump of the material points. Values are read when they are asked for."""

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


class Run:
    """A run's folder: log, gauges with their histories and summaries, dumps in order of time."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.log = self._json("run.json")
        if self.log is None:
            raise FileNotFoundError(f'"{folder}" is not the output folder of a run: it holds no run.json')
        self.summary = self._json("summary.json") or {"gauges": [], "burst": "none"}
        self.histories = {gauge["name"]: self._history(gauge["file"]) for gauge in self.summary["gauges"]}
        self.dumps = sorted((Dump(path) for path in self.folder.glob("fields/fields_*.h5")),
                            key=lambda dump: dump.time)
        # Runs of material points only.
        self.points = self.log.get("points")
        self.point_gauges = self.summary.get("point_gauges", [])
        self.bodies = self.summary.get("bodies", [])
        self.point_dumps = sorted((PointDump(path) for path in self.folder.glob("points/points_*.h5")),
                                  key=lambda dump: dump.time)
        for gauge in self.point_gauges:
            self.histories[gauge["name"]] = self._history(gauge["file"])
        self.energies = self._history("energies.csv")

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

    def _history(self, name):
        """Columns of a gauge's file by their names without units."""
        path = self.folder / name
        if not name or not path.exists():
            return None
        with open(path, newline="", encoding="utf-8") as file:
            rows = csv.reader(file)
            names = [column.split(" [")[0] for column in next(rows)]
            # A run that was killed may leave a last line that is cut off.
            values = [[float(value) for value in row] for row in rows if len(row) == len(names) and row[-1]]
        table = np.array(values).reshape(-1, len(names))
        return {column: table[:, i] for i, column in enumerate(names)}
