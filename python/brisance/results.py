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


PICTURE_CELLS = 1200  # along a direction: more than the pixels that a picture of the report has for them


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
            # Dumps of earlier versions do not tell.
            self._block_size = tuple(int(n) for n in file.attrs.get("block_size", ()))
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

    def outlines(self, normal, position):
        """The level, which is 0, and lower and upper corners [m], in the two other directions, of the blocks of cells
        that a plane meets."""
        if not self._block_size:
            return []
        # The last blocks end with the domain.
        edges = [self.edges(d)[[*range(0, self.cells[d], self._block_size[d]), -1]] for d in range(3) if d != normal]
        return [(0, np.array([edges[0][i], edges[1][j]]), np.array([edges[0][i + 1], edges[1][j + 1]]))
                for j in range(len(edges[1]) - 1) for i in range(len(edges[0]) - 1)]


class LevelDump:
    """One field dump of a run with cells of several sizes. It shows itself as if all cells were of one size, that of
    `level`: what finer cells hold is averaged, coarser ones are repeated. Values are read on demand, and only as far as
    needed."""

    def __init__(self, path):
        self.path = path
        with h5py.File(path, "r") as file:
            self.time = float(file.attrs["time"])
            self.step = int(file.attrs["step"])
            self.geometry = text(file.attrs["geometry"])
            self.origin = np.array(file.attrs["origin"])
            self._spacing = float(file.attrs["spacing"])  # of level 0
            self._cells = tuple(int(n) for n in file.attrs["cells"])
            self._levels = []  # group in the file, level, first and last cells of the blocks
            for group in sorted((name for name in file["VTKHDF"] if name.startswith("Level")),
                                key=lambda name: int(name[5:])):
                level = round(np.log2(self._spacing / float(file["VTKHDF"][group].attrs["Spacing"][0])))
                self._levels.append((group, level, file["VTKHDF"][group]["AMRBox"][...].astype(int).reshape(-1, 3, 2)))
            self.fields = sorted(file["VTKHDF"][self._levels[0][0]]["CellData"])
        self.dimensions = DIMENSIONS[self.geometry]
        self.finest = max(level for _, level, _ in self._levels)
        self.level = self.finest

    def _scales(self, level):
        """How many cells of a level go into one of level 0, along each direction."""
        return [2 ** level if d < self.dimensions else 1 for d in range(3)]

    @property
    def spacing(self):
        """Size of the cells that are shown [m]."""
        return self._spacing / 2 ** self.level

    @property
    def cells(self):
        return self.cells_of(self.level)

    def cells_of(self, level):
        """Cells of a level along each direction of the domain."""
        return tuple(n * scale for n, scale in zip(self._cells, self._scales(level)))

    def _size(self, direction):
        return self._spacing / self._scales(self.level)[direction]

    def centres(self, direction):
        """Positions of the centres of the cells that are shown along a direction [m]."""
        return self.origin[direction] + (np.arange(self.cells[direction]) + 0.5) * self._size(direction)

    def edges(self, direction):
        """Positions of their faces along a direction [m]."""
        return self.origin[direction] + np.arange(self.cells[direction] + 1) * self._size(direction)

    def layer(self, direction, position):
        """Index of the layer of such cells that contains a position, clamped to the domain."""
        index = int(np.floor((position - self.origin[direction]) / self._size(direction)))
        return min(max(index, 0), self.cells[direction] - 1)

    def values(self, field):
        """All values of a field on cells of one size, [k, j, i] with k along z, without the directions that the run
        does not resolve; for a vector the last index is the component."""
        values = self._sampled(field, [(0, n) for n in self.cells])
        return values.reshape(values.shape[3 - self.dimensions:])

    def plane(self, field, normal, index):
        """Values of a scalar field in the layer `index` of such cells across direction `normal` (0: x, 1: y, 2: z).

        The last index of the result belongs to the lower of the two remaining directions.
        """
        window = [(0, n) for n in self.cells]
        window[normal] = (index, index + 1)
        return self._sampled(field, window).squeeze(2 - normal)

    def leaf_values(self, field):
        """For each block of cells its level, the index of its first cell in the domain, counted in cells of that level,
        and the values in it, [k, j, i]."""
        with h5py.File(self.path, "r") as file:
            for group, level, boxes in self._levels:
                data = file["VTKHDF"][group]["CellData"][field]
                at = 0
                for box in boxes:
                    n = box[:, 1] - box[:, 0] + 1
                    values = data[at:at + n.prod()].astype(float)
                    yield level, box[:, 0], values.reshape(n[2], n[1], n[0], *values.shape[1:])
                    at += n.prod()

    def outlines(self, normal, position):
        """The level, and lower and upper corners [m], in the two other directions, of the blocks of cells that a plane
        meets."""
        across = [d for d in range(3) if d != normal]
        found = []
        for _, level, boxes in self._levels:
            size = self._spacing / np.array(self._scales(level), dtype=float)
            lower = self.origin + boxes[:, :, 0] * size
            upper = self.origin + (boxes[:, :, 1] + 1) * size
            met = (lower[:, normal] <= position) & (position < upper[:, normal])
            found += [(level, *corners) for corners in zip(lower[met][:, across], upper[met][:, across])]
        return found

    def _sampled(self, field, window):
        """Values in the cells of a window, [k, j, i]; `window`: first and last but one index along x, y and z."""
        with h5py.File(self.path, "r") as file:
            shape = file["VTKHDF"][self._levels[0][0]]["CellData"][field].shape[1:]
            out = np.zeros([end - start for start, end in reversed(window)] + list(shape))
            for group, level, boxes in self._levels:
                data = file["VTKHDF"][group]["CellData"][field]
                ends = np.cumsum((boxes[:, :, 1] - boxes[:, :, 0] + 1).prod(axis=1))
                for box, end in zip(boxes, ends):
                    self._add(out, window, level, box, data, end)
        return out

    def _add(self, out, window, level, box, data, end):
        """Adds what a block holds to the cells of the window; `end`: of its values in those of the level."""
        parts = [self._overlap(window[d], level if d < self.dimensions else self.level, box[d]) for d in (2, 1, 0)]
        if any(part is None for part in parts):
            return
        n = box[:, 1] - box[:, 0] + 1
        values = data[end - n.prod():end].astype(float)
        values = values.reshape(n[2], n[1], n[0], *values.shape[1:])[tuple(part[0] for part in parts)]
        for axis, (_, _, shown) in enumerate(parts):
            values = shown(values, axis)
        out[tuple(part[1] for part in parts)] += values

    def _overlap(self, window, level, box):
        """Of a block along one direction: which of its cells the window meets, where they lie in it, and what turns
        their values into those of the cells that are shown; None if it meets none."""
        start, stop = int(box[0]), int(box[1]) + 1
        if level <= self.level:
            repeat = 2 ** (self.level - level)
            low, high = max(start * repeat, window[0]), min(stop * repeat, window[1])
            first, last = low // repeat, -(-high // repeat)

            def shown(values, axis):
                return values.take(np.arange(low, high) // repeat - first, axis=axis)
        else:
            count = 2 ** (level - self.level)
            first, last = max(start, window[0] * count), min(stop, window[1] * count)
            low, high = first // count, -(-last // count)

            def shown(values, axis):
                begins = np.maximum(np.arange(low, high) * count, first) - first
                return np.add.reduceat(values, begins, axis=axis) / count
        if low >= high:
            return None
        return slice(first - start, last - start), slice(low - window[0], high - window[0]), shown


def on_one_level(dumps):
    """Makes dumps of cells of several sizes show themselves on cells of one, the same for all: the finest that there
    are, but no more than `PICTURE_CELLS` along a direction."""
    if dumps:
        level = max(dump.finest for dump in dumps)
        while level > 0 and max(dumps[0].cells_of(level)) > PICTURE_CELLS:
            level -= 1
        for dump in dumps:
            dump.level = level
    return dumps


class PlaneDump:
    """One dump of a plane: what it cuts out of cells, squares or in 2D lines, from the largest on. Values are read on
    demand."""

    def __init__(self, path):
        self.path = path
        with h5py.File(path, "r") as file:
            self.time = float(file.attrs["time"])
            self.step = int(file.attrs["step"])
            self.geometry = text(file.attrs["geometry"])
            self.normal = int(file.attrs["normal"])
            self.position = float(file.attrs["position"])
            self.count = int(file["VTKHDF/NumberOfCells"][0])
            self.fields = sorted(file["VTKHDF/CellData"])

    def values(self, field):
        """All values of a field: (n) or (n, 3)."""
        with h5py.File(self.path, "r") as file:
            return file["VTKHDF/CellData"][field][...].astype(float)

    def corners(self):
        """Corners of the squares going round each, or ends of the lines [m]: (n, 4, 3) or (n, 2, 3)."""
        with h5py.File(self.path, "r") as file:
            return file["VTKHDF/Points"][...][file["VTKHDF/Connectivity"][...].reshape(self.count, -1)]

    def centres(self):
        """Their centres [m]: (n, 3)."""
        return self.corners().mean(axis=1)

    def sizes(self):
        """Lengths of their sides, the sizes of the cells [m]: (n)."""
        corners = self.corners()
        return np.abs(corners[:, 1] - corners[:, 0]).max(axis=1)


def subset_dump(path):
    """A dump of a subset of the fields: of a plane, or of a box, which shows itself as if it were a domain."""
    with h5py.File(path, "r") as file:
        plane = text(file["VTKHDF"].attrs["Type"]) == "UnstructuredGrid"
    return PlaneDump(path) if plane else LevelDump(path)


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

    def __init__(self, folder, show_blocks=False):
        self.folder = Path(folder)
        self.show_blocks = show_blocks  # outlines of blocks in pictures of cells
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
        """Field dumps in order of time. Those of a run with cells of several sizes show themselves on cells of one, the
        same for all: the finest that there are, but no more than `PICTURE_CELLS` along a direction."""
        dumps = [Dump(path) for path in self.folder.glob("fields/fields_*.h5")]
        of_levels = on_one_level([LevelDump(path) for path in self.folder.glob("fields/fields_*.hdf")])
        return sorted(dumps + of_levels, key=lambda dump: dump.time)

    @functools.cached_property
    def subsets(self):
        """Dumps of each subset of the fields in order of time, by the subset's name; of boxes see `dumps`."""
        found = {}
        for index in sorted(self.folder.glob("subsets/*.hdf.series")):
            files = json.loads(index.read_text(encoding="utf-8"))["files"]
            dumps = [subset_dump(index.parent / file["name"]) for file in files]
            boxes = on_one_level([dump for dump in dumps if isinstance(dump, LevelDump)])
            planes = [dump for dump in dumps if isinstance(dump, PlaneDump)]
            found[index.name.removesuffix(".hdf.series")] = sorted(boxes + planes, key=lambda dump: dump.time)
        return found

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
