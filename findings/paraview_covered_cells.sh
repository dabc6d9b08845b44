#!/usr/bin/env bash
# ParaView 5.11.0 (Debian 12, paraview 5.11.0+dfsg-1) reads an overlapping AMR set of a VTKHDF file and hides the coarse
# cells below finer blocks, but Slice and Clip bring them back: both count every covered cell besides the finer ones.
# Of a plane set, whose direction z has one cell of one size on all levels, nothing is hidden at all: integrals of the
# whole are wrong too. In 3D 2 of 8 blocks are refined once, in the plane 1 of 4.
#
# Why it matters: AMR codes write coarse cells below finer ones as a matter of course, pictures look right because the
# finer cells lie on top or agree, and an area, a mass or an impulse taken over a slice is a quarter too large without a
# warning. With the leaves alone in the file every number is right; in 3D so it is after a Threshold, which drops what
# is hidden.
#
# Output seen (measure of the whole, of a slice at x = 3 and of a clip at x = 3, which should be 512, 64, 192 in 3D and
# 64, 8, 24 in 2D):
#   3D covered cells too: whole 512, slice 80, clip 240
#   3D leaves only: whole 512, slice 64, clip 192
#   2D covered cells too: whole 80, slice 12, clip 36
#   2D leaves only: whole 64, slice 8, clip 24
#
# Needs paraview and python3-h5py.
set -euo pipefail

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

cat >write.py <<'END'
import itertools

import h5py
import numpy as np


def write(path, dims, covered):
    """Blocks of 4 cells of 1 m, two along each direction; the two with the lowest y and z are refined, in 2D one."""
    refined = [(0, 0, 0), (1, 0, 0)] if dims == 3 else [(0, 0, 0)]
    coarse = [p for p in itertools.product(range(2), range(2), range(2 if dims == 3 else 1))
              if covered or p not in refined]
    fine = [tuple(2 * p + c if d < dims else 0 for d, (p, c) in enumerate(zip(place, corner)))
            for place in refined for corner in itertools.product(range(2), repeat=3) if dims == 3 or corner[2] == 0]
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs.update(Version=[1, 0], Type=np.bytes_("OverlappingAMR"), GridDescription=np.bytes_("XYZ"),
                          Origin=[0.0, 0.0, 0.0])
        for level, places in enumerate((coarse, fine)):
            group = root.create_group(f"Level{level}")
            group.attrs["Spacing"] = [0.5 ** level if d < dims else 1.0 for d in range(3)]
            size = [4 if d < dims else 1 for d in range(3)]
            group["AMRBox"] = np.array([[bound for d in range(3)
                                         for bound in (p[d] * size[d], (p[d] + 1) * size[d] - 1)] for p in places])
            group["CellData/level"] = np.full(len(places) * np.prod(size), float(level))
            group.create_group("PointData")
            group.create_group("FieldData")


for dims in (3, 2):
    for covered in (True, False):
        write(f"{dims}_{'covered' if covered else 'leaves'}.hdf", dims, covered)
END
python3=/usr/bin/python3
"$python3" write.py

cat >measure.py <<'END'
from paraview import servermanager, simple


def measure(source):
    data = servermanager.Fetch(simple.IntegrateVariables(Input=source)).GetCellData()
    return next(data.GetArray(name).GetValue(0) for name in ("Volume", "Area") if data.GetArray(name))


for dims in (3, 2):
    for name, words in (("covered", "covered cells too"), ("leaves", "leaves only")):
        reader = simple.OpenDataFile(f"{dims}_{name}.hdf")
        reader.UpdatePipeline()
        plane = {"Normal": [1.0, 0.0, 0.0], "Origin": [3.0 - 1e-9, 0.0, 0.0]}
        cut, clip = simple.Slice(Input=reader), simple.Clip(Input=reader)
        for kind in (cut.SliceType, clip.ClipType):
            kind.Normal, kind.Origin = plane["Normal"], plane["Origin"]
        print(f"{dims}D {words}: whole {measure(reader):g}, slice {measure(cut):g}, clip {measure(clip):g}")
END
pvpython measure.py 2>/dev/null
