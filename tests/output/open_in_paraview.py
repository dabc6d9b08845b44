"""Opens an index of field dumps as ParaView's file dialog would; prints what came in as one line of JSON.

Arguments: the index, the picture to render (a slice of the pressure at the last time; optional).
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
        information = reader.GetDataInformation()
        data = servermanager.Fetch(reader)
        arrays = {}
        for name in reader.CellData.keys():
            values = data.GetCellData().GetArray(name)
            arrays[name] = {"components": values.GetNumberOfComponents(), "first": values.GetTuple(0),
                            "last": values.GetTuple(values.GetNumberOfTuples() - 1)}
        steps.append({"cells": information.GetNumberOfCells(), "bounds": information.GetBounds(), "arrays": arrays})
    if len(sys.argv) > 2:
        render(reader, times[-1], sys.argv[2])
    print(json.dumps({"readers": readers, "times": times, "steps": steps}))


def render(reader, time, picture):
    view = simple.CreateView("RenderView")
    view.ViewSize = [900, 700]
    view.ViewTime = time
    cut = simple.Slice(Input=reader)
    cut.SliceType.Normal = [0.0, 0.0, 1.0]
    display = simple.Show(cut, view)
    simple.ColorBy(display, ("CELLS", "pressure"))
    display.RescaleTransferFunctionToDataRange(False, True)
    display.SetScalarBarVisibility(view, True)
    view.ResetCamera()
    simple.Render(view)
    simple.SaveScreenshot(picture, view)


main()
