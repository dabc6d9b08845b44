"""Opens a series of a subset of the fields as ParaView's file dialog would; prints what came in as JSON.

Argument: the list of files.
"""
import json
import sys

from paraview import servermanager, simple


def integrals(source):
    """Of all cell fields, and the measure of the cells."""
    whole = servermanager.Fetch(simple.IntegrateVariables(Input=source)).GetCellData()
    return {whole.GetArrayName(n): whole.GetArray(n).GetTuple(0) for n in range(whole.GetNumberOfArrays())}


def first_values(reader):
    """Of the first cell of an unstructured grid."""
    data = reader.GetClientSideObject().GetOutputDataObject(0)
    if not data.IsA("vtkUnstructuredGrid"):
        return {}
    cells = data.GetCellData()
    return {cells.GetArrayName(n): cells.GetArray(n).GetTuple(0) for n in range(cells.GetNumberOfArrays())}


def main():
    path = sys.argv[1]
    factory = servermanager.vtkSMProxyManager.GetProxyManager().GetReaderFactory()
    factory.UpdateAvailableReaders()
    readers = factory.GetReaders(path, servermanager.ActiveConnection.Session).GetNumberOfStrings() // 3
    reader = simple.OpenDataFile(path)
    times = list(reader.TimestepValues)
    steps = []
    for time in times:
        reader.UpdatePipeline(time)
        information = reader.GetDataInformation()
        steps.append({"class": information.GetCompositeDataClassName() or information.GetDataClassName(),
                      "cells": information.GetNumberOfCells(), "bounds": information.GetBounds(),
                      "whole": integrals(reader), "values": first_values(reader)})
    print(json.dumps({"readers": readers, "times": times, "steps": steps}))


main()
