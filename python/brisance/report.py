"""Writes one self-contained HTML page about a run.

Usage: python3 report.py DIR [--blocks]

DIR is the output folder of a run, and the page DIR/report.html. With --blocks the slices of the gas show the outlines
of the grid's blocks.

Exit status: 0 done, 2 wrong usage, 5 a file or a Python package is missing.
"""
import html
import os
import sys
from pathlib import Path

GEOMETRIES = {"cartesian3d": "3D", "planar2d": "planar 2D", "axisymmetric2d": "axisymmetric 2D",
              "planar1d": "planar 1D", "cylindrical1d": "cylindrical 1D", "spherical1d": "spherical 1D"}
ROUND_OFF = 1e-10
# Energy of material points: the drift that the better shape functions reach, and the one from which a run does not
# balance unless its deck says otherwise.
FINE_DRIFT = 1e-3
CLIPPED = 0.05  # fraction of a peak cut off by the cells from which the report marks it
USUAL_WARN = 5e-3
KB_TITLE = "Kingery-Bulmash"


def text(value):
    return html.escape(str(value))


def number(value, digits=4, padded=False):
    """A number for readers: without exponent where possible, a dash for None.

    `padded` keeps trailing zeros, so that the numbers of a column have equal precision.
    """
    if value is None:
        return "–"
    if value == 0:
        return "0"
    if 1e-3 <= abs(value) < 10.0 ** max(digits, 5):
        plain = f"{value:{'#' if padded else ''}.{digits}g}".rstrip(".")
        return plain if "e" not in plain else f"{value:.0f}"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    if "." in mantissa:
        mantissa = mantissa.rstrip("0").rstrip(".")
    return f"{mantissa}·10<sup>{int(exponent)}</sup>".replace("<sup>-", "<sup>−")


def duration(seconds):
    if seconds < 90:
        return f"{seconds:.3g} s"
    minutes, rest = divmod(int(round(seconds)), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {rest:02d} s"


def badge(kind, words):
    return f'<span class="badge {kind}">{text(words)}</span>'


def table(head, rows, groups=None):
    """A table from cells that are HTML already; a cell may be (class, content)."""
    def cell(tag, content):
        kind, content = content if isinstance(content, tuple) else ("", content)
        if content == "–":
            kind += " absent"
        return f'<{tag} class="{kind.strip()}">{content}</{tag}>' if kind.strip() else f"<{tag}>{content}</{tag}>"

    top = ""
    if groups:
        top = "<tr class='groups'>" + "".join(f'<th colspan="{span}">{words}</th>' for words, span in groups) + "</tr>"
    body = "".join("<tr>" + "".join(cell("td", c) for c in row) + "</tr>\n" for row in rows)
    return (f'<div class="scroll"><table><thead>{top}<tr>{"".join(cell("th", h) for h in head)}</tr></thead>'
            f"<tbody>{body}</tbody></table></div>")


def pairs(rows):
    """A table of names and plain-text values."""
    body = "".join(f'<tr><td>{text(name)}</td><td class="text">{text(value)}</td></tr>' for name, value in rows)
    return f'<table class="pairs"><tbody>{body}</tbody></table>'


def figure(image, caption):
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>" if image else ""


def status_badge(log):
    if log["status"] == "done":
        return badge("good", "completed")
    if log["status"] == "running":
        return badge("warn", "not finished")
    return badge("bad" if log["exit_code"] not in (0, 3) else "warn", "stopped")


def is_unbalanced(log):
    """Whether the audit found the run unbalanced; results of older versions do not say."""
    return log["audit"].get("balanced") is False


def balance_words(log):
    """The verdict of the audit with its reasons."""
    audit = log["audit"]
    if "balanced" not in audit:
        return ""
    if is_unbalanced(log):
        reasons = "".join(f"<li>{text(reason)}</li>" for reason in audit["reasons"])
        runs_on = ("<p>The scheme is meant for comparison, so the run is not stopped.</p>"
                   if audit["for_comparison"] else "")
        return f"<p>{badge('bad', 'NOT BALANCED')}</p><ul>{reasons}</ul>{runs_on}"
    if not audit["drift_judged"]:
        return f"<p>{badge('warn', 'energy drift not checked')} The deck sets <code>warn = 0</code>.</p>"
    return f"<p>{badge('good', 'balanced')}</p>"


def is_told(log, finding):
    return log["audit"].get("findings", {}).get(finding, {}).get("reported", False)


def bodies_in_words(points):
    count = len(points["bodies"])
    return f"{count} bod{'y' if count == 1 else 'ies'}"


def regions_of(log):
    """The MPM regions of a run, in the order of its deck."""
    return log.get("mpm_regions") or ([log["mpm_region"]] if log.get("mpm_region") else [])


def facts(log):
    domain = log["domain"]
    resolved = [n for n in domain["cells"] if n > 1] or [1]
    size = [high - low for low, high, n in zip(domain["lower"], domain["upper"], domain["cells"]) if n > 1]
    points = log.get("points")
    regions = regions_of(log)
    sub_steps = sum(region["point_steps"] for region in regions)
    steps = f"{regions[0]['gas_steps']:,} gas, {sub_steps:,} MPM sub-steps" if regions else ""
    size_of_cells = f"{number(domain['cell_size'] * 1e3)} mm"
    gas = ("cells", f"{domain['cell_count']:,}", f"in {log['blocks']} blocks")
    if "levels" in log:
        levels = [level for level in log["levels"]["cells"] if level["cells"] > 0]
        gas = ("cells", f"{sum(level['cells'] for level in levels):,}",
               f"in {sum(level['blocks'] for level in levels)} blocks at the end")
        size_of_cells = " to ".join(number(level["cell_size"] * 1e3) for level in (levels[-1], levels[0])) + " mm"
    material = ("material points", f"{points['count']:,}", f"in {bodies_in_words(points)}") if points else None
    entries = [
        ("simulated time", f"{number(log['time'] * 1e3)} ms", f"of {number(log['end_time'] * 1e3)} ms"),
        ("steps", f"{log['step']:,}", steps),
        ("grid", " × ".join(str(n) for n in resolved), GEOMETRIES[domain["geometry"]]),
        *([gas, material] if regions else [material or gas]),
        ("cell size", size_of_cells, ""),
        ("domain", " × ".join(number(s) for s in size) + " m", ""),
        ("wall-clock time", duration(log["wall_seconds"]), f"on {log['machine']['threads']} threads"),
        ("speed", f"{points['point_updates_per_second'] / 1e6:.3g} million", "particles/s")
        if points and not regions else
        ("speed", f"{log['cell_updates_per_second'] / 1e6:.3g} million", "cells/s"),
    ]
    cells = "".join(f"<div><dt>{name}</dt><dd>{value} <small>{small}</small></dd></div>"
                    for name, value, small in entries)
    return f'<dl class="facts">{cells}</dl>'


def setup_table(log):
    boundary = log["domain"]["boundary"]
    directions = {"axisymmetric2d": "rz"}.get(log["domain"]["geometry"], "xyz")
    names = [f"{d} {side}" for d in directions for side in ("low", "high")]
    resolved = sum(n > 1 for n in log["domain"]["cells"])
    if log["domain"]["geometry"] in ("spherical1d", "cylindrical1d"):
        names = ["r low", "r high"]
    faces = ", ".join(f"{name}: {kind}" for name, kind in zip(names, boundary[:2 * resolved]))
    if log.get("points") and not regions_of(log):
        return pairs(point_setup(log, faces))
    ambient = log["ambient"]
    rows = [
        ("gas scheme", f"{log['scheme']}, Courant number {log['courant']:g}"),
        ("ambient", f"{ambient['fluid']}, {ambient['pressure'] * 1e-3:.6g} kPa, {ambient['density']:.4g} kg/m³"),
        ("boundaries", faces),
        ("obstacles, gauges, field dumps", f"{log['obstacles']}, {log['gauges']}, {log['dumps']}"),
        ("end", log["end_reason"] or "the run has not finished"),
    ]
    if regions_of(log):
        rows = rows[:-1] + region_setup(log) + [row for row in point_setup(log, faces)
                                                if row[0] not in ("boundaries", "gauges, dumps")]
    return pairs(rows)


def region_setup(log):
    regions = regions_of(log)
    return [(region_name(regions, n), f"{region['cells']:,} cells, bridge {region['width']} cells wide, "
             f"{region['points_per_direction']} gas particles per cell and direction, "
             f"{region['transfer'].upper()}, {region['order'].upper()}"
             + ("" if region["transport"] == "ledger" else ", transport as printed in [Cui14]"))
            for n, region in enumerate(regions)]


def region_name(regions, number):
    return "MPM region" if len(regions) == 1 else f"MPM region {number + 1}"


SHAPES = {"linear": "linear", "gimp": "GIMP (uGIMP)", "cpgimp": "GIMP (cpGIMP)", "bspline": "quadratic B-spline"}


def point_setup(log, faces):
    points = log["points"]
    transfer = {"flip": "FLIP" + (f", {points['pic_fraction']:g} of PIC" if points["pic_fraction"] else ""),
                "apic": "APIC", "xpic": f"XPIC({points['xpic_order']})"}[points["transfer"]]
    force = points["body_force"]
    acting = [f"{points['constraints']} constraints", f"{points['contacts']} contacts",
              f"{points['surface_pressures']} surface pressures"]
    if any(force):
        acting.append("body force (" + ", ".join(f"{a:g}" for a in force) + ") m/s²")
    if points.get("wall_friction"):
        acting.append(f"wall friction {points['wall_friction']:g}")
    return [
        ("method", f"material points, {SHAPES[points['shape_function']]}, {points['order'].upper()}, {transfer}"
                   + (", locking control" if points["locking_control"] else "")
                   + f", Courant number {log['courant']:g}"),
        ("bulk viscosity", f"linear {points['linear_viscosity']:g}, quadratic {points['quadratic_viscosity']:g}"),
        ("boundaries", faces),
        ("constraints and loads", ", ".join(acting)),
        ("gauges, dumps", f"{points['gauges']}, {log['dumps']}"),
        ("end", log["end_reason"] or "the run has not finished"),
    ]


def body_section(run):
    points = run.points
    rows = []
    for body in points["bodies"]:
        mass, shape = body["mass"], body["geometric_mass"]
        speed = sum(v * v for v in body["velocity"]) ** 0.5
        rows.append([text(body["name"]), ("text", text(body["material"]) + (", rigid" if body["rigid"] else "")),
                     f"{body['points']:,}", number(mass, 6), number(shape, 6),
                     number(abs(mass - shape) / shape if shape else None, 2), number(speed)])
    out = table(["body", ("text", "material"), "particles", "mass of the particles [kg]", "mass of the shape [kg]",
                 "relative error", "initial speed [m/s]"], rows)
    sources = "; ".join(sorted({f"{b['material']}: {b['source']}" for b in points["bodies"] if b["source"]}))
    per = {"planar2d": "Masses and energies are per metre of depth.",
           "planar1d": "Masses and energies are per square metre.",
           "cylindrical1d": "Masses and energies are per metre of length."}.get(run.geometry, "")
    if sources or per:
        out += f'<p class="note">{f"Constants: {text(sources)}. " if sources else ""}{per}</p>'
    if run.bodies:
        out += body_results(run)
    return out + broken_zones(points.get("broken_zones", []))


def broken_zones(zones):
    """Zones of broken concrete, as seen from the faces of its bodies; empty where nothing is broken."""
    rows = []
    for zone in zones:
        faces = [f for f in zone["faces"] if f["crushed_depth"] or f["cracked_depth"] or f["spall_depth"] is not None]
        whole = [number(zone[part]["mass"]) for part in ("crushed", "cracked", "damaged")]
        for face in faces or [None]:
            seen = ["-"] * 6 if face is None else [("text", face["face"])] + [
                number(face[key] * 1e3 if face[key] is not None else None) for key in (
                    "crushed_diameter", "crushed_depth", "cracked_diameter", "cracked_depth", "spall_depth")]
            rows.append([text(zone["body"]), *whole, *seen])
    if not rows:
        return ""
    return table(["body", "crushed", "cracked", "more than half damaged", ("text", "from"), "diameter", "depth",
                  "diameter", "depth", "at depth"], rows,
                 [("", 1), ("mass [kg]", 3), ("face", 1), ("crushed [mm]", 2), ("cracked [mm]", 2), ("spall [mm]", 1)])


def body_results(run):
    rows, seen = [], set()
    for body in run.bodies:
        if body["body"] in seen:
            continue
        seen.add(body["body"])
        start, end = body["start"], body["end"]
        rows.append([text(body["body"])]
                    + [number(s[key]) for key in ("kinetic_energy", "internal_energy") for s in (start, end)]
                    + [number(end["plastic_work"]), number(body["peak_displacement"]["value"] * 1e3),
                       "(" + ", ".join(number(v, 3) for v in end["velocity"][:run.dimensions]) + ")"])
    return table(["body", "start", "end", "start", "end", "plastic work [J]", "maximum displacement [mm]",
                  "final mean velocity [m/s]"], rows,
                 [("", 1), ("kinetic energy [J]", 2), ("internal energy [J]", 2), ("", 3)])


def point_gauge_table(run):
    rows = []
    for gauge in run.point_gauges:
        component = gauge["component_displacement"]
        name = run.axes["xyz".index(gauge["component"])]
        final = ", ".join(number(u * 1e3, 3) for u in gauge["final_displacement"][:run.dimensions])
        rows.append([text(gauge["name"]) + ("*" if gauge["left_the_domain"] else ""), ("text", text(gauge["body"])),
                     number(gauge["peak_displacement"]["value"] * 1e3, 4, True),
                     number(gauge["peak_displacement"]["time"] * 1e3, 4, True),
                     f"{name}: {number(component['value'] * 1e3, 4, True)}", f"({final})",
                     number(gauge["peak_velocity"]["value"], 4, True),
                     number(gauge["peak_mises"]["value"] * 1e-6, 4, True), number(gauge["plastic_strain"], 3)])
    out = table(["gauge", ("text", "on"), "peak [mm]", "at [ms]", "largest component [mm]", "final [mm]",
                 "peak speed [m/s]", "peak Mises [MPa]", "plastic strain"], rows,
                [("", 2), ("displacement", 4), ("", 3)])
    if any(gauge["left_the_domain"] for gauge in run.point_gauges):
        out += '<p class="note">* The particle left the domain; its record ends there.</p>'
    return out


def drift_verdict(energy, log=None):
    """By the largest drift of the run and the deck's limit, where they are known."""
    drift = energy.get("largest_drift", energy["drift"])
    if drift is None:
        return badge("bad", "not a number")
    finding = log["audit"].get("findings", {}).get("drift") if log else None
    warn = finding["warn"] if finding else USUAL_WARN
    if not warn:
        return badge("warn", "not checked")
    if not (finding["reported"] if finding else abs(drift) > warn):
        limit = FINE_DRIFT if abs(drift) <= FINE_DRIFT < warn else warn
        within = f"within {100 * limit:g} %" if abs(drift) <= limit else "within the most recent work of the loads"
        return badge("good", within)
    return badge("bad", f"more than {100 * warn:g} %")


def dissipation_words(energy):
    """Kinetic energy that the particles lost and that is counted."""
    held, filtered = energy.get("lost_at_constrained_nodes") or 0.0, energy.get("filtered") or 0.0
    friction, apic = energy.get("friction") or 0.0, energy.get("apic") or 0.0
    lifted, damping = energy.get("lifted") or 0.0, energy.get("damping") or 0.0
    if not any((held, filtered, apic, friction, damping, lifted)):
        return ""
    return ("Kinetic energy dissipated by the particles: "
            f"{number(held, 3)} J at constrained nodes (a plastic impact), {number(filtered, 3)} J by PIC and XPIC, "
            f"{number(apic, 3)} J by APIC, {number(friction, 3)} J by contact friction and {number(damping, 3)} J by "
            "damping. It is accounted for and not part of the drift. "
            + (f"Guards added {number(lifted, 3)} J to gas particles, which is part of the drift. " if lifted else ""))


def point_audit_section(log):
    audit = log["points"]["audit"]
    mass, energy, momentum = audit["mass"], audit["energy"], audit["momentum"]
    drift = energy["drift"]
    rows = [["mass [kg]", number(mass["initial"], 6), number(mass["lost"], 6), number(mass["current"], 6),
             number(mass["relative_error"], 2), ("text", verdict(mass["relative_error"]))],
            ["energy [J]", number(energy["initial"], 6), number(energy["lost"], 6), number(energy["current"], 6),
             "–" if drift is None else f"{100 * drift:+.3g} %", ("text", drift_verdict(energy, log))]]
    for d, name in enumerate("xyz"):
        if any(momentum[key][d] for key in ("initial", "lost", "current")):
            rows.append([f"momentum {name} [kg m/s]"] + [number(momentum[key][d], 6) for key in
                                                         ("initial", "lost", "current")] + ["–", ("text", "")])
    work = energy["work"]
    driven = f"Loads, constraints and body forces did {number(work, 4)} J of work. " if work else ""
    lost = f"{audit['lost_points']:,} particles left the domain. " if audit["lost_points"] else ""
    return (balance_words(log)
            + table(["account", "initial", "left the domain", "now", "change", ("text", "verdict")], rows)
            + f'<p class="note">{lost}{driven}{dissipation_words(energy)}'
            "Particles carry their mass, so mass is conserved exactly. The method does not conserve energy (kinetic "
            "and internal) exactly. Its drift relative to the reference energy (the largest value of kinetic energy, "
            "work, and energy above the ambient state) shows how well the motion is resolved. "
            "Momentum changes where symmetry planes, walls, loads or constraints act.</p>")


def charge_section(log):
    if not log["charges"]:
        return "<p>No charge.</p>"
    rows = []
    for charge in log["charges"]:
        specified, realised = charge["specified_mass"], charge["realised_mass"]
        error = abs(realised - specified) / specified if specified else None
        centre = ", ".join(number(x) for x in charge["centre"]) if "centre" in charge else "–"
        rows.append([text(charge["explosive"]), f"({centre})", text(charge.get("detonation", "–")),
                     number(specified, 7), number(realised, 7), number(error, 2),
                     number(charge["realised_energy"] * 1e-6),
                     number(charge["cells_per_radius"], 3)])
    sources = "; ".join(sorted({f"{c['explosive']}: {c['source']}" for c in log["charges"] if c.get("source")}))
    note = f'<p class="note">Constants: {text(sources)}.</p>' if sources else ""
    return table(["explosive", "centre [m]", "detonation", "specified mass [kg]", "realised mass [kg]",
                  "relative error", "energy [MJ]", "cells per radius"], rows) + note + start_table(log)


def start_table(log):
    """What the remaps of the charges' bursts conserved."""
    if not log.get("starts"):
        return ""
    rows = []
    for start in log["starts"]:
        before, after = start["before"], start["after"]
        rows.append([("text", text(start["start"])), number(start["time"] * 1e3, 4), number(start["radius"], 4),
                     number(start["cells_per_radius"], 3), number(before["mass"][1], 9), number(after["mass"][1], 9),
                     number(before["mass"][0], 9), number(after["mass"][0], 9), number(before["energy"] * 1e-6, 9),
                     number(after["energy"] * 1e-6, 9), number(start["relative_error"], 2)])
    note = ('<p class="note">The charge detonated in the simulation given in the first column. The table compares the '
            "part of the blast wave inside the domain before and after it was mapped onto the grid.</p>")
    return table([("text", "start"), "time [ms]", "radius [m]", "cells per radius", "products before [kg]",
                  "after", "air before [kg]", "after", "energy before [MJ]", "after", "largest relative error"],
                 rows) + note


def gauge_table(run):
    gauges = run.summary["gauges"]
    with_reference = any(v is not None for g in gauges for v in g["kingery_bulmash"].values())
    quantities = [("peak_overpressure", 1e-3, "peak overpressure [kPa]"),
                  ("front_overpressure", 1e-3, "at the front [kPa]"), ("arrival_time", 1e3, "arrival [ms]"),
                  ("positive_duration", 1e3, "positive duration [ms]"),
                  ("positive_impulse", 1.0, "positive impulse [Pa s]")]
    # Results of older versions do not have it.
    if all(g.get("front_overpressure") is None for g in gauges):
        quantities = [q for q in quantities if q[0] != "front_overpressure"]
    head = ["gauge", "R [m]", "Z [m/kg<sup>1/3</sup>]"]
    groups = [("", 3)]
    for _, _, name in quantities:
        head += ["run", "KB", "ratio"] if with_reference else [name]
        groups.append((name, 3))
    rows = []
    for gauge in gauges:
        arrived = gauge["arrival_time"] is not None
        row = [text(gauge["name"]), number(gauge["distance"], 4, True), number(gauge["scaled_distance"], 3, True)]
        for key, factor, _ in quantities:
            value = gauge[key] * factor if arrived and gauge[key] is not None else None
            mark = "*" if key == "positive_impulse" and value and not gauge["positive_phase_complete"] else ""
            if key == "peak_overpressure" and value and clipped(gauge):
                row.append(("clipped", number(value, 4, True) + "†"))
            else:
                row.append(number(value, 4, True) + mark)
            if with_reference:
                # The peak of the curves is that at the front: it was read from records in the same way.
                known = key if key != "front_overpressure" else "peak_overpressure"
                reference, ratio = gauge["kingery_bulmash"][known], gauge["ratio"][key]
                row.append(number(None if reference is None else reference * factor, 4, True))
                row.append(("ratio", "–" if ratio is None else f"{ratio:.3f}"))
        rows.append(row)
    out = table(head, rows, groups if with_reference else None)
    if any(g["positive_impulse"] and not g["positive_phase_complete"] for g in gauges):
        out += ('<p class="note">* The record ends within the positive phase; the impulse is that up to the end of the '
                "record.</p>")
    if any(clipped(g) for g in gauges):
        out += ('<p class="note">† The cell size is expected to clip this peak by 5 % or more, see the next table. '
                "The peak at the front is corrected for most of the clipping.</p>")
    return out + record_table(gauges), with_reference


def clipped(gauge):
    return (gauge.get("expected_clipping") or 0.0) >= CLIPPED


def record_table(gauges):
    """Values of the whole record, beyond the first positive phase; empty for results of older versions."""
    if not any("largest_impulse" in g for g in gauges):
        return ""
    rows = []
    for gauge in gauges:
        negative = gauge.get("negative_phase")
        arrived = gauge["arrival_time"] is not None
        reached = arrived or negative is not None

        def value(source, key, factor, known, digits=4):
            return number(source[key] * factor if known and source.get(key) is not None else None, digits, True)

        part = gauge.get("expected_clipping")
        percent = "–" if part is None else f"{100 * part:.0f} %"
        rows.append([text(gauge["name"]), value(gauge, "largest_impulse", 1.0, arrived),
                     value(gauge, "time_of_largest_impulse", 1e3, arrived),
                     value(gauge, "final_overpressure", 1e-3, reached),
                     value(negative, "peak", 1e-3, negative), value(negative, "impulse", 1.0, negative),
                     value(negative, "duration", 1e3, negative),
                     value(gauge, "peak_front_overpressure", 1e-3, arrived),
                     value(gauge, "cells_per_half_width", 1.0, arrived, 3),
                     ("clipped", percent + "†") if clipped(gauge) else percent])
    note = ('<p class="note">Maximum impulse: maximum of the running integral of the overpressure over the whole '
            "record. Mean at the end: mean over the last tenth of the record. Negative phase: the phase with the "
            "lowest overpressure. Peak at the front: the peak of the record, extrapolated from the decay behind it. "
            "Cells in the half width: number of cells that the incident shock passes until the pressure has fallen to "
            "half of the peak. Clipped by: clipping expected with this number of cells.</p>")
    head = ["gauge", "[Pa s]", "at [ms]", "mean at the end [kPa]", "peak [kPa]", "impulse [Pa s]", "duration [ms]",
            "at the front [kPa]", "cells in the half width", "clipped by"]
    groups = [("", 1), ("maximum impulse", 2), ("", 1), ("negative phase", 3), ("peak", 3)]
    return table(head, rows, groups) + note


def verdict(error):
    if error is None:
        return badge("bad", "not a number")
    if error <= ROUND_OFF:
        return badge("good", "conserved to round-off")
    return badge("bad", "not conserved")


def audit_section(log):
    audit = log["audit"]
    rows = []

    def account(name, unit, initial, outflow, guards, current, error):
        added = guards is not None and is_told(log, "guard_energy" if unit == "J" else "guard_mass")
        judged = badge("bad", "too much added by guards") if added else verdict(error)
        rows.append([f"{name} [{unit}]", number(initial, 6), number(outflow, 6), number(guards, 3), number(current, 6),
                     number(error, 2), ("text", judged)])

    masses = zip(audit["initial"]["mass"], audit["outflow"]["mass"], audit["current"]["mass"],
                 audit["relative_error"]["mass"])
    names = ("mass of the ambient fluid", "mass of the second fluid")
    for (initial, outflow, current, error), name in zip(masses, names):
        if initial or outflow or current:
            # The guards' mass is one figure for both fluids; it is shown with the first.
            guards = audit["guard_mass"] if name.endswith("ambient fluid") else None
            account(name, "kg", initial, outflow, guards, current, error)
    if not regions_of(log):
        account("energy", "J", audit["initial"]["energy"], audit["outflow"]["energy"], audit["guard_energy"],
                audit["current"]["energy"], audit["relative_error"]["energy"])
    lifted = audit["guarded_cells"]
    too_much = is_told(log, "guard_energy") or is_told(log, "guard_mass")
    guards = badge("good", "no guards active") if lifted == 0 else badge("bad" if too_much else "warn", "guards active")
    words = ("Density and internal energy stayed positive everywhere without correction." if lifted == 0 else
             f"In {lifted:,} cell updates density or internal energy had to be raised to its floor; the added amounts "
             "are listed above.")
    per_metre = {"planar2d": "Sums are per metre of depth.", "planar1d": "Sums are per square metre.",
                 "cylindrical1d": "Sums are per metre of length."}.get(log["domain"]["geometry"], "")
    burnt = log.get("afterburn")
    released = audit.get("afterburn_energy")
    afterburn = "" if not burnt else (
        f"<p>The products released {number(released, 6)} J after the detonation (afterburn "
        f"<code>{burnt['model']}</code>, {number(burnt['energy'], 4)} J/kg in total). The energy balance "
        "includes it.</p>")
    panels = log.get("panels")
    terms = "guards" + (" plus afterburn" if burnt else "") + (" plus panels" if panels else "")
    return (balance_words(log)
            + table(["account", "initial", "flowed out", "added by guards", "now", "relative error",
                     ("text", "verdict")], rows)
            + f'<p class="note">Initial content minus outflow plus {terms} must equal the current content. '
            f"{per_metre}</p>"
            + afterburn
            + panel_words(panels, audit)
            + f"<p>{guards} {words}</p>")


def panel_words(panels, audit):
    """When the panels opened, and the mass and energy of the cells that they freed."""
    if not panels:
        return ""
    rows = [[("text", html.escape(p["name"])), number(1e-3 * p["fails_at"], 4),
             ("text", "intact" if p["failed_at"] is None else f'{1e3 * p["failed_at"]:.4g}'),
             number(1e-3 * (p["largest_difference"] if p["difference"] is None else p["difference"]), 4),
             ("text", "-" if p["open_at"] is None else f'{1e3 * p["open_at"]:.4g}'), number(p["area"], 4),
             number(p["open_area"], 4), number(p["speed"], 3)] for p in panels]
    came = audit["panels"]
    return (table([("text", "panel"), "fails at [kPa]", ("text", "failed at [ms]"), "difference [kPa]",
                   ("text", "open at [ms]"), "area [m2]", "open [m2]", "speed [m/s]"], rows)
            + f'<p class="note">The cells of panels that opened added {number(sum(came["mass"]), 3)} kg and '
            f'{number(came["energy"], 3)} J relative to ambient gas.</p>')


def region_words(regions):
    return "MPM region" if len(regions) == 1 else "MPM regions"


def energy_of_all(log):
    """The accounts of the energy of gas and particles together."""
    if log.get("mpm_region"):
        return log["mpm_region"]["energy"]
    energy = log["points"]["audit"]["energy"]
    return energy | {"outflow": energy["lost"]}


def traffic_words(regions, n):
    region = regions[n]
    if region["awake_since"] is None:
        return f"No wave reached {region_name(regions, n)}."
    return (f"The {region_name(regions, n)} became active at {number(region['awake_since'] * 1e3)} ms. "
            f"{region['points_injected']:,} gas particles were injected through its faces and "
            f"{region['points_absorbed']:,} absorbed; {number(sum(region['ledger']['mass']), 3)} kg are in the ledger "
            "between gas and particles.")


def region_section(run):
    """What crossed the bridge, and the energy of gas and particles together."""
    regions = regions_of(run.log)
    if all(region["awake_since"] is None for region in regions):
        return f"<p>No wave reached the {region_words(regions)}; the particles stayed asleep.</p>"
    energy = energy_of_all(run.log)
    drift = energy["drift"]
    bridge = run.log["timings"].get("bridge", 0.0)
    rows = [["energy of gas and particles [J]", number(energy["initial"], 6), number(energy["outflow"], 6),
             number(energy["work"], 3), number(energy["current"], 6),
             "–" if drift is None else f"{100 * drift:+.3g} %", ("text", drift_verdict(energy, run.log))]]
    return (table(["account", "initial", "flowed out", "work of loads", "now", "drift", ("text", "verdict")], rows)
            + f"<p class=\"note\">{' '.join(traffic_words(regions, n) for n in range(len(regions)))} "
            f"The bridge took {100 * bridge / max(run.log['wall_seconds'], 1e-9):.0f} % of the time. "
            f"{dissipation_words(energy)}The method does not conserve the energy of "
            "particles exactly; the drift shows how well the flow around the bodies is resolved.</p>")


def deck_section(deck):
    lines = []
    for line in deck.splitlines():
        escaped = text(line)
        stripped = line.strip()
        if stripped.startswith("#"):
            escaped = f'<span class="comment">{escaped}</span>'
        elif stripped.startswith("["):
            escaped = f'<span class="table">{escaped}</span>'
        lines.append(escaped)
    return f"<pre>{chr(10).join(lines)}</pre>"


def gas_sections(run, figures):
    """Sections of a run of the gas."""
    log = run.log
    if log["charges"]:
        yield "Charge", charge_section(log)
    if run.summary["gauges"]:
        results, with_reference = gauge_table(run)
        burst = run.summary["burst"]
        note = (f'<p class="note">KB: {KB_TITLE} values for a {text(burst)} burst of the TNT-equivalent mass of the '
                "charge, incident wave. They describe an undisturbed wave in free air or over open, rigid ground; in "
                "front of or behind obstacles the ratio does not indicate accuracy.</p>" if with_reference else "")
        yield "Gauges", results + note + figure(
            figures.gauge_histories(run),
            "Overpressure (blue, left axis; ring: peak extrapolated from the decay behind it) and running impulse "
            "(orange, right axis) at the gauges"
            + (f". {KB_TITLE}: diamond for arrival and peak, tick for the end of the positive "
               "phase, dashed line for the impulse." if with_reference else "."))
    yield "Scaled distance", figure(figures.scaled_distance(run), "Gauge results versus scaled distance"
                                    + (f" with the {KB_TITLE} curves." if run.curve is not None else "."))
    yield "Overpressure field", figure(
        figures.pressure_slices(run),
        "Overpressure at several times; logarithmic colour scale on both sides of the ambient state (white); "
        "obstacles grey.")
    yield "Profiles", figure(figures.profiles(run), "Profiles at several times.")
    peaks = figures.peak_map(run) or figures.peak_profile(run)
    yield "Peak values", figure(peaks, "Maximum overpressure at each location"
                                + ("; contours in kPa, circles: gauges." if run.dimensions > 1
                                   else ", and maximum running impulse."))
    yield "Conservation", audit_section(log)


def point_sections(run, figures):
    """Sections of a run of material points."""
    yield "Bodies", body_section(run)
    pictures = figures.pictures(run)
    mirrored = " Mirrored at the axis." if run.geometry == "axisymmetric2d" else ""
    yield "Pictures", (
        figure(figures.outer_view(run), "The bodies from outside.")
        + figure(pictures, "The material points at several times" + (
            "; the layer of particles next to each plane." if run.dimensions == 3 else ".") + mirrored)
        + figure(figures.profiles(run), "Profiles at several times."))
    if run.point_gauges:
        yield "Gauges on bodies" if regions_of(run.log) else "Gauges", point_gauge_table(run) + figure(
            figures.gauge_histories(run), "Displacement, velocity and stress of the particles that the gauges follow.")
    together = (" The sums include all particles; gas particles are injected and absorbed."
                if regions_of(run.log) else "")
    yield "Energies", figure(figures.energies(run), "Energies over time." + together)
    if not regions_of(run.log):
        yield "Conservation", point_audit_section(run.log)


def sections(run, figures, point_figures):
    """Titles and contents of the page, in order; those with nothing to show are left out."""
    log = run.log
    yield "Simulation", facts(log) + setup_table(log)
    coupled = regions_of(log)
    if coupled or not run.points:
        yield from gas_sections(run, figures)
    if coupled:
        yield region_words(coupled), region_section(run)
    if run.points:
        yield from point_sections(run, point_figures)
    versions, machine = log["versions"], log["machine"]
    yield "Cost and versions", figure(figures.timings(run), "Wall-clock time by phase.") + pairs([
        ("Brisance", versions["brisance"]), ("compiler", versions["compiler"]),
        ("compiler options", versions["compiler_flags"]), ("HDF5", versions["hdf5"]),
        ("processor", f"{machine['processor']}, {machine['cores']} cores, {machine['threads']} threads used"),
        ("started (UTC)", log["started_at"].replace("T", " ").rstrip("Z"))])
    yield "Deck", deck_section(log["deck"])


def page(run, figures, point_figures):
    log = run.log
    title = log["title"] or log["deck_path"] or "Brisance run"
    kind = "Material point" if run.points and not regions_of(log) else "Blast"
    style = (Path(__file__).parent / "report.css").read_text(encoding="utf-8")
    shown = [(name, content) for name, content in sections(run, figures, point_figures) if content]
    body = "\n".join(f'<section><h2><span class="number">{n}</span>{name}</h2>\n{content}</section>'
                     for n, (name, content) in enumerate(shown, 1))
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{text(title)}</title>
<style>
{style}</style>
</head>
<body>
<header><div>
<h1>{text(title)}</h1>
<p>{kind} simulation with Brisance {text(log['versions']['brisance'])} &nbsp;·&nbsp; {text(log['started_at'][:10])}
&nbsp;
{status_badge(log)}{' ' + badge('bad', 'NOT BALANCED') if is_unbalanced(log) else ''}</p>
</div></header>
<main>
{body}
<footer>Written by <code>brisance report</code>. All numbers come from run.json, summary.json, the gauges' CSV files and
the field dumps in the run's output folder.</footer>
</main>
</body>
</html>
"""


def main(arguments):
    show_blocks = "--blocks" in arguments
    arguments = [argument for argument in arguments if argument != "--blocks"]
    if len(arguments) != 1 or arguments[0] in ("-h", "--help"):
        print(__doc__, file=sys.stderr)
        return 2
    # Run by its path, the script must still find the package that it belongs to.
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
    try:
        from brisance import figures, point_figures, results
    except ImportError as missing:
        print(f"the Python package {missing.name} is missing; on Debian run "
              "apt install python3-numpy python3-h5py python3-matplotlib", file=sys.stderr)
        return 5
    folder = Path(arguments[0])
    try:
        content = page(results.Run(folder, show_blocks), figures, point_figures)
        temporary = folder / "report.html.part"
        temporary.unlink(missing_ok=True)
        with open(temporary, "x", encoding="utf-8") as file:  # a new file: not through an existing link
            file.write(content)
        os.replace(temporary, folder / "report.html")
    except OSError as problem:
        print(problem, file=sys.stderr)
        return 5
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
