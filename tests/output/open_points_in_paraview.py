"""Opens an index of dumps of material points as ParaView's file dialog would; prints what came in as one line of JSON.

Argument: the index.
"""
import json
import sys

from paraview import servermanager, simple


def main():
    path = sys.argv[1]
    factory = servermanager.vtkSMProxyManager.GetProxyManager().GetReaderFactory()
    factory.UpdateAvailableReaders()
    # Strings come in threes: group, name, label. More than one reader means a dialog that asks the user.
    readers = factory.GetReaders(path, servermanager.ActiveConnection.Session).GetNumberOfStrings() // 3
    reader = simple.OpenDataFile(path)
    times = list(reader.TimestepValues)
    steps = []
    for time in times:
        reader.UpdatePipeline(time)
        data = servermanager.Fetch(reader)
        arrays = {}
        for name in reader.PointData.keys():
            values = data.GetPointData().GetArray(name)
            arrays[name] = {"components": values.GetNumberOfComponents(), "first": values.GetTuple(0),
                            "last": values.GetTuple(values.GetNumberOfTuples() - 1)}
        steps.append({"points": data.GetNumberOfPoints(), "cells": data.GetNumberOfCells(), "arrays": arrays})
    print(json.dumps({"readers": readers, "times": times, "steps": steps}))


main()
