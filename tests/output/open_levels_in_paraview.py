"""Opens a series of field dumps of several levels as ParaView's file dialog would; prints what came in as JSON.

Arguments: the list of files; an index of dumps of material points to be opened beside it (optional).
"""
import json
import sys

from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy


def blocks_of(reader):
    """Level, origin, spacing, cells and values of every block, as ParaView has read them."""
    data = reader.GetClientSideObject().GetOutputDataObject(0)
    blocks = []
    for level in range(data.GetNumberOfLevels()):
        for n in range(data.GetNumberOfDataSets(level)):
            block = data.GetDataSet(level, n)
            cells = block.GetCellData()
            names = [cells.GetArrayName(i) for i in range(cells.GetNumberOfArrays())]
            blocks.append({"level": level, "origin": block.GetOrigin(), "spacing": block.GetSpacing(),
                           "cells": [max(1, nodes - 1) for nodes in block.GetDimensions()],
                           "values": {name: vtk_to_numpy(cells.GetArray(name)).tolist() for name in names
                                      if name != "vtkGhostType"}})
    return blocks


def integrals(source):
    """Of all cell fields, and the measure of the cells."""
    whole = servermanager.Fetch(simple.IntegrateVariables(Input=source)).GetCellData()
    return {whole.GetArrayName(n): whole.GetArray(n).GetTuple(0) for n in range(whole.GetNumberOfArrays())}


def main():
    path = sys.argv[1]
    factory = servermanager.vtkSMProxyManager.GetProxyManager().GetReaderFactory()
    factory.UpdateAvailableReaders()
    readers = factory.GetReaders(path, servermanager.ActiveConnection.Session).GetNumberOfStrings() // 3
    reader = simple.OpenDataFile(path)
    points = simple.OpenDataFile(sys.argv[2]) if len(sys.argv) > 2 else None
    times = list(reader.TimestepValues)
    steps = []
    for time in times:
        reader.UpdatePipeline(time)
        information = reader.GetDataInformation()
        bounds = information.GetBounds()
        middle = [0.5 * (bounds[2 * d] + bounds[2 * d + 1]) for d in range(3)]
        cut = simple.Slice(Input=reader)
        cut.SliceType.Normal = [1.0, 0.0, 0.0]
        cut.SliceType.Origin = [middle[0] + 0.01, middle[1], middle[2]]
        clip = simple.Clip(Input=reader)
        clip.ClipType.Normal = [1.0, 0.0, 0.0]
        clip.ClipType.Origin = cut.SliceType.Origin
        step = {"class": information.GetCompositeDataClassName(), "cells": information.GetNumberOfCells(),
                "bounds": bounds, "blocks": blocks_of(reader), "whole": integrals(reader), "slice": integrals(cut),
                "clip": integrals(clip)}
        if points is not None:
            points.UpdatePipeline(time)
            step["points"] = points.GetDataInformation().GetNumberOfPoints()
        steps.append(step)
    print(json.dumps({"readers": readers, "times": times, "steps": steps}))


main()
