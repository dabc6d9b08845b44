"""Dumps of cells of several sizes: what the reader and the report make of them."""
import sys
import tempfile
import unittest
from pathlib import Path

SKIPPED = 77  # exit status that ctest takes as "skipped"

try:
    import h5py
    import numpy as np

    import synthetic_run
    from brisance import figures, report, results
except ImportError as missing:
    print(f"skipped: the Python package {missing.name} is not installed")
    sys.exit(SKIPPED)


def write_linear(path, dims, levels=(0, 1, 2)):
    """Blocks of 4 cells; one corner of the domain one level finer, and a corner of that two. The field is linear in the
    centres of the cells. `levels`: those that are there at all; without level 0 all is finer."""
    block, parts = 4, 3
    found = []
    for place in np.ndindex(*[parts] * dims):
        refine = 0 not in levels or (place == (0,) * dims and 1 in levels)
        if not refine:
            found.append((0, place))
            continue
        for corner in np.ndindex(*[2] * dims):
            finer = tuple(2 * p + c for p, c in zip(place, corner))
            if 2 in levels and finer == (1,) * dims:
                found += [(2, tuple(2 * p + c for p, c in zip(finer, last))) for last in np.ndindex(*[2] * dims)]
            else:
                found.append((1, finer))
    with h5py.File(path, "w") as file:
        file.attrs.update(time=0.1, step=5, geometry="cartesian3d" if dims == 3 else "planar2d",
                          origin=[1.0, 2.0, 3.0], spacing=0.5,
                          cells=[block * parts if d < dims else 1 for d in range(3)])
        present = sorted({level for level, _ in found})
        for n, level in enumerate(present):
            group = file.create_group(f"VTKHDF/Level{n}")
            h = 0.5 / 2 ** level
            group.attrs["Spacing"] = [h if d < dims else 0.5 for d in range(3)]
            boxes, pressure, velocity = [], [], []
            for _, place in (leaf for leaf in found if leaf[0] == level):
                size = [block if d < dims else 1 for d in range(3)]
                low = [place[d] * block if d < dims else 0 for d in range(3)]
                boxes.append([bound for d in range(3) for bound in (low[d], low[d] + size[d] - 1)])
                x = [o + (low[d] + np.arange(size[d]) + 0.5) * (h if d < dims else 0.5)
                     for d, o in enumerate((1.0, 2.0, 3.0))]
                zz, yy, xx = np.meshgrid(x[2], x[1], x[0], indexing="ij")
                pressure.append((xx + 10 * yy + 100 * zz).ravel())
                velocity.append(np.stack([xx, yy, zz], -1).reshape(-1, 3))
            group["AMRBox"] = np.array(boxes, dtype="i4")
            group["CellData/pressure"] = np.concatenate(pressure)
            group["CellData/velocity"] = np.concatenate(velocity)


class Levels(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.root = Path(cls.scratch.name)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def dump(self, dims, levels=(0, 1, 2)):
        path = self.root / f"linear_{dims}_{len(levels)}_{levels[0]}.hdf"
        if not path.exists():
            write_linear(path, dims, levels)
        return results.LevelDump(path)

    def exact(self, dump):
        """The linear field at the centres of the cells that are shown."""
        z, y, x = np.meshgrid(dump.centres(2), dump.centres(1), dump.centres(0), indexing="ij")
        return x + 10 * y + 100 * z

    def test_values_on_the_coarsest_cells_are_means(self):
        for dims in (2, 3):
            dump = self.dump(dims)
            self.assertEqual(dump.finest, 2)
            dump.level = 0
            self.assertEqual(dump.cells, (12, 12, 12 if dims == 3 else 1))
            np.testing.assert_allclose(dump.values("pressure"), self.exact(dump).reshape(dump.values("pressure").shape))
            velocity = dump.values("velocity")
            self.assertEqual(velocity.shape, (12,) * dims + (3,))
            np.testing.assert_allclose(velocity[..., 0], np.broadcast_to(dump.centres(0), velocity.shape[:-1]))

    def test_values_on_fine_cells_repeat_coarse_ones(self):
        for dims in (2, 3):
            for level in (1, 2, 3):
                dump = self.dump(dims)
                dump.level = level
                values = dump.values("pressure").reshape(dump.cells[::-1])
                error = np.abs(values - self.exact(dump))
                # Half a coarse cell at most, and nothing where cells are as fine.
                most = 0.25 * (111 if dims == 3 else 11)
                self.assertLess(error.max(), most)
                fine = slice(2 * 2 ** level, 4 * 2 ** level)  # where level 2 lies
                if level <= 2:
                    part = error[(fine if dims == 3 else slice(None), fine, fine)]
                    np.testing.assert_allclose(part, 0.0, atol=1e-9)

    def test_plane_is_a_layer_of_the_values(self):
        dump = self.dump(3)
        for level in (0, 1, 2):
            dump.level = level
            values = dump.values("pressure")
            for index in (0, 3, dump.cells[0] - 1):
                np.testing.assert_array_equal(dump.plane("pressure", 2, index), values[index])
                np.testing.assert_array_equal(dump.plane("pressure", 1, index), values[:, index])
                np.testing.assert_array_equal(dump.plane("pressure", 0, index), values[:, :, index])

    def test_dump_without_cells_of_the_coarsest_level(self):
        dump = self.dump(2, (1, 2))
        self.assertEqual(dump.finest, 2)
        dump.level = 1
        np.testing.assert_allclose(dump.values("pressure"), self.exact(dump)[0])

    def test_leaf_values_tile_the_domain(self):
        dump = self.dump(3)
        volume = 0.0
        for level, first, values in dump.leaf_values("pressure"):
            h = 0.5 / 2 ** level
            x = [dump.origin[d] + (first[d] + np.arange(4) + 0.5) * h for d in range(3)]
            zz, yy, xx = np.meshgrid(x[2], x[1], x[0], indexing="ij")
            np.testing.assert_allclose(values, xx + 10 * yy + 100 * zz)
            volume += values.size * h ** 3
        self.assertAlmostEqual(volume, 6.0 ** 3)

    def test_outlines_are_the_blocks_in_a_plane(self):
        area = sum(np.prod(high - low) for _, low, high in self.dump(3).outlines(2, 3.9))
        self.assertAlmostEqual(area, 36.0)
        levels = [level for level, _, _ in self.dump(2).outlines(2, 3.1)]
        self.assertEqual([levels.count(level) for level in (0, 1, 2)], [8, 3, 4])

    def test_run_shows_all_dumps_on_one_level_with_few_cells(self):
        synthetic_run.write(self.root / "plane", "2d", dumps=3, levels=True)
        run = results.Run(self.root / "plane")
        self.assertEqual({dump.level for dump in run.dumps}, {2})
        self.assertEqual([dump.values("pressure").shape for dump in run.dumps], [(320, 640)] * 3)
        kept, results.PICTURE_CELLS = results.PICTURE_CELLS, 400
        try:
            self.assertEqual({dump.level for dump in results.Run(self.root / "plane").dumps}, {1})
        finally:
            results.PICTURE_CELLS = kept

    def test_report_shows_the_fields(self):
        pages = []
        for options in ([], ["--blocks"]):
            folder = self.root / "report_uniform"
            if not folder.exists():
                synthetic_run.write(folder, "2d", dumps=2)
            self.assertEqual(report.main([str(folder), *options]), 0)
            pages.append((folder / "report.html").read_text(encoding="utf-8"))
        self.assertNotEqual(pages[0], pages[1])
        pages = []
        for which, options in (("2d", []), ("2d", ["--blocks"]), ("3d", ["--blocks"])):
            folder = self.root / f"report_{which}"
            if not folder.exists():
                synthetic_run.write(folder, which, dumps=2, levels=True)
            self.assertEqual(report.main([str(folder), *options]), 0)
            pages.append((folder / "report.html").read_text(encoding="utf-8"))
            for section in ("Overpressure field", "Peak values"):
                self.assertTrue(section in pages[-1], section)
            h = synthetic_run.KINDS[which]["spacing"] * 1e3
            self.assertTrue(f"{h / 4:.4g} to {h:.4g} mm" in pages[-1])
            self.assertTrue("blocks at the end" in pages[-1])
        self.assertNotEqual(pages[0], pages[1])
        cut = figures.cuts(results.Run(folder, show_blocks=True), with_plan=False)[0]
        cut.look_at(results.Run(folder).dumps[1])
        self.assertGreater(len(cut.blocks), 10)
        widths = [figures.block_line(level) for level, _, _ in cut.blocks]
        self.assertLess(min(widths), max(widths))


if __name__ == "__main__":
    unittest.main()
