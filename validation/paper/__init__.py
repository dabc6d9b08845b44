"""The five examples of [Cui14], each a module here, and the report that compares them with the paper and the tests.

A module has
    TITLE: str
    run(variants, resolution, target) -> dict   `variants`: common.Variants; `resolution`: one of RESOLUTIONS; `target`:
                                                folder for its PNG files
whose result is a section:
    "acceptance"  [(what, measured, limit, met)], three texts and a bool each
    "blocks"      [("text", html) | ("table", caption, header, rows of texts) | ("figure", name of a PNG file, caption)]
    "costs"       [(run, cells, points, steps, threads, seconds on the wall)]; where absent, all runs of `variants`
Texts of tables, captions and acceptance lines are plain and are escaped by the report; only "text" is HTML.

The result of an example is kept in WORK/sections/NAME (section.json and the figures), so that the report can be
composed of examples run at different times; the results of the runs are in WORK/runs.
"""
import datetime
import importlib
import importlib.util
import json
import shutil
from pathlib import Path

from common import ROOT, Stopped, Variants, commit, machine

from . import report

# name: number of the section in the paper and title, for an example that has not been run
EXAMPLES = {"sod": ("5.1", "Sod's shock tube"), "slab2d": ("5.2", "A charge beside a concrete slab, in the plane"),
            "slab3d": ("5.3", "A charge above a concrete slab on soil"),
            "plates": ("5.4", "Clamped circular plates under charges"),
            "defect": ("5.5", "A charge above a concrete slab with a defect")}
RESOLUTIONS = ("quick", "standard", "fine")


def present(name):
    return importlib.util.find_spec(f"{__name__}.{name}") is not None


def calculate(name, arguments, work):
    """Runs an example and keeps its section. If a run fails, its message becomes the section's `failed`."""
    module = importlib.import_module(f"{__name__}.{name}")
    folder = work / "sections" / name
    fresh = folder.with_suffix(".new")
    shutil.rmtree(fresh, ignore_errors=True)
    fresh.mkdir(parents=True)
    (work / "runs").mkdir(exist_ok=True)
    variants = Variants(arguments, work / "runs")
    try:
        section = module.run(variants, arguments.resolution, fresh)
    except Stopped:
        raise
    except SystemExit as end:
        section = {"failed": str(end)}
    section = {"title": module.TITLE, "acceptance": [], "blocks": [], "costs": variants.costs} | section
    section["made"] = {"resolution": arguments.resolution, "commit": arguments.commit or commit(),
                       "machine": machine(), "build": variants.build[:12], "date": datetime.date.today().isoformat(),
                       "command": command(name, arguments)}
    text = json.dumps(section, indent=1, default=lambda v: v.item())  # numbers of NumPy as plain ones
    (fresh / "section.json").write_text(text + "\n")
    shutil.rmtree(folder, ignore_errors=True)
    fresh.rename(folder)
    return "failed" not in section


def command(name, arguments):
    return f"validation/run paper --example {name} --resolution {arguments.resolution}" + (
        f" --threads {arguments.threads}" if arguments.threads != 1 else "") + (" --reuse" if arguments.reuse else "")


def compose(work, target, resolution):
    """Writes the report to `target` from the sections in `work` and, of the same resolution, those in `target`."""
    target.mkdir(parents=True, exist_ok=True)
    sections = {}
    for name in EXAMPLES:
        source, kept = work / "sections" / name, target / name
        if (source / "section.json").exists():
            shutil.rmtree(kept, ignore_errors=True)
            shutil.copytree(source, kept)
        if (kept / "section.json").exists():
            section = json.loads((kept / "section.json").read_text())
            if section["made"]["resolution"] == resolution:
                sections[name] = section
    page = target / "index.html"
    page.write_text(report.page(sections, EXAMPLES, resolution), encoding="utf-8")
    return page


def validate(arguments, work):
    """Runs the selected examples and composes the report. Returns 1 if one of them failed, else 0."""
    target = Path(arguments.target) if arguments.target else (
        ROOT / "docs" / "validation" / "paper" if arguments.resolution == "standard" else work / "report")
    names = [] if arguments.compose else [n for n in EXAMPLES if n in (arguments.example or EXAMPLES)]
    good = True
    for k, name in enumerate(names):
        number, title = EXAMPLES[name]
        print(f"example {k + 1} of {len(names)}: {name}, [Cui14] {number}, {title}", flush=True)
        if not present(name):
            print("  there is no module for it yet")
            continue
        good &= calculate(name, arguments, work)
        compose(work, target, arguments.resolution)
    print(f"wrote {compose(work, target, arguments.resolution)}; results of the runs: {work / 'runs'}")
    return 0 if good else 1
