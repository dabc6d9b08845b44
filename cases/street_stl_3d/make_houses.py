#!/usr/bin/env python3
"""Writes houses.stl: the four houses of cases/street_3d as one file of triangles, in metres."""
import pathlib

HOUSES = (((-15, -15, 0), (-4.5, -4.5, 8)), ((4.5, -15, 0), (15, -4.5, 6)),
          ((-15, 4.5, 0), (-4.5, 15, 6)), ((4.5, 4.5, 0), (15, 15, 9)))
# The corners of each side of a box, counter-clockwise from outside; bit d of a corner says low or high along d.
SIDES = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))


def facets():
    for box in HOUSES:
        corners = [[box[n >> d & 1][d] for d in range(3)] for n in range(8)]
        for a, b, c, d in SIDES:
            yield corners[a], corners[b], corners[c]
            yield corners[a], corners[c], corners[d]


def main():
    lines = ["solid houses"]
    for triangle in facets():
        lines += ["facet normal 0 0 0", " outer loop"]
        lines += [f"  vertex {x:g} {y:g} {z:g}" for x, y, z in triangle]
        lines += [" endloop", "endfacet"]
    lines.append("endsolid houses")
    pathlib.Path(__file__).with_name("houses.stl").write_text("\n".join(lines) + "\n", encoding="ascii")


if __name__ == "__main__":
    main()
