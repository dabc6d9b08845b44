"""The report on the paper's examples: one static HTML page with its figures beside it."""
from html import escape

from common import ROOT

STYLE = """
table.acceptance td, .data td { vertical-align: top; }
table.acceptance th, table.acceptance td { text-align: left; }
table.acceptance td:last-child { width: 80px; text-align: right; }
caption { caption-side: top; text-align: left; color: var(--muted); font-size: 13px; padding: 4px 0; }
footer > div { max-width: 1060px; margin: 0 auto; padding: 0 28px; }
nav { margin-top: 10px; font-size: 14px; } nav a { margin-right: 16px; white-space: nowrap; }
a { color: var(--accent); } p, ul { max-width: 860px; } li { margin: 3px 0; }
.none { border: 1px dashed #9aa5b1; border-radius: 5px; padding: 12px 16px; color: var(--muted); }
td.short { white-space: nowrap; } figure img { max-height: 860px; width: auto; }
@media print {
  nav { display: none; } .scroll { overflow: visible; } body { font-size: 10pt; }
  table { font-size: 8.5pt; break-inside: auto; }
  tr { break-inside: avoid; } caption { break-after: avoid; } th, td { padding: 3px 5px; }
  figure img { max-height: 190mm; }
  section.calculated { break-before: page; }
}
"""
INTRODUCTION = """
<p>Cui, Zhang, Zhou, Liu &amp; Zhang, <i>A Coupled Finite Difference Material Point Method and Its Application in
Explosion Simulation</i>, CMES 98 (2014) 565-599, here [Cui14], conclude with five examples. This page compares
Brisance's result for each of them with those of the paper and of the tests that it cites. No constant was fitted to
these results unless the text of an example says so.</p>
<p>An <i>acceptance line</i> is a requirement set beforehand, with the measured value and whether it is met. A line that
is missed stays in the table; the text of the example states by how much, why (as far as this is known), and what was
tried.</p>
"""


def badge(text, kind):
    return f'<span class="badge {kind}">{text}</span>'


def data_table(header, rows, caption="", kind="data", escaped=False):
    """A table of plain texts, or of HTML where they are `escaped` already."""
    def cell(tag, value):
        short = ' class="short"' if tag == "td" and not escaped and len(str(value)) <= 16 else ""  # not broken: numbers
        return f"<{tag}{short}>{value if escaped else escape(str(value))}</{tag}>"

    def cells(tag, values):
        return "<tr>" + "".join(cell(tag, value) for value in values) + "</tr>"
    title = f"<caption>{escape(caption)}</caption>" if caption else ""
    return (f'<div class="scroll"><table class="{kind}">{title}<thead>{cells("th", header)}</thead>'
            f"<tbody>{''.join(cells('td', row) for row in rows)}</tbody></table></div>")


def acceptance_row(line):
    """Cells of an acceptance line."""
    what, measured, limit, met = line
    return [escape(what), escape(measured), escape(limit), badge("met", "good") if met else badge("missed", "bad")]


def summary(sections, examples):
    """All acceptance lines, and the examples that have not been run."""
    lines = [line for section in sections.values() for line in section["acceptance"]]
    met = sum(bool(line[3]) for line in lines)
    rows = []
    for name, (number, title) in examples.items():
        link = f'<a href="#{name}">{number} {escape(title)}</a>'
        section = sections.get(name)
        if section and section["acceptance"]:
            rows += [[link if k == 0 else "", *acceptance_row(line)] for k, line in enumerate(section["acceptance"])]
        else:
            note = "not run" if section is None else "failed" if "failed" in section else "no acceptance lines"
            rows.append([link, "–", "–", "–", badge(note, "warn")])
    facts = (("acceptance lines met", f"{met} <small>of {len(lines)}</small>"), ("missed", str(len(lines) - met)),
             ("examples run", f"{len(sections)} <small>of {len(examples)}</small>"),
             ("wall time of all runs", duration(sum(row[5] for s in sections.values() for row in s["costs"]))))
    boxes = "".join(f"<div><dt>{name}</dt><dd>{value}</dd></div>" for name, value in facts)
    return f'<dl class="facts">{boxes}</dl>' + data_table(
        ("example", "requirement", "measured", "limit", ""), rows, kind="acceptance", escaped=True)


def duration(seconds):
    """Seconds as a text."""
    if seconds < 60:
        return f"{seconds:.3g} s"
    return f"{seconds / 60:.0f} min" if seconds < 3600 else f"{seconds / 3600:.1f} h"


def block(name, item):
    """HTML of a block of the example `name`. Raises ValueError for a block of an unknown kind."""
    kind = item[0]
    if kind == "text":
        return item[1] if item[1].lstrip().startswith("<") else f"<p>{item[1]}</p>"
    if kind == "table":
        return data_table(item[2], item[3], item[1])
    if kind == "figure":
        return (f'<figure><img src="{escape(name)}/{escape(item[1])}" alt="{escape(item[2])}">'
                f"<figcaption>{escape(item[2])}</figcaption></figure>")
    raise ValueError(f"{name}: a block of the unknown kind {kind!r}")


def costs(rows):
    def number(value):
        return f"{value:,}" if value else "–"
    body = [(run, number(cells), number(points), number(steps), threads, f"{wall:.3g}" if wall < 100 else f"{wall:.0f}")
            for run, cells, points, steps, threads, wall in rows]
    return data_table(("run", "cells", "particles at the end", "steps", "threads", "wall time [s]"), body)


def part(name, number, title, section):
    """The section of one example."""
    title = section["title"] if section else title
    calculated = "" if section is None else ' class="calculated"'
    text = f'<section id="{name}"{calculated}><h2><span class="number">{number}</span>{escape(title)}</h2>'
    if section is None:
        return (f'{text}<p class="none">Not run at this resolution. Command: <code>validation/run paper --example '
                f"{name}</code></p></section>")
    if "failed" in section:
        text += f'<p class="none">Failed: {escape(section["failed"])}</p>'
    blocks = list(section["blocks"])
    if blocks and blocks[0][0] == "text":  # the set-up
        text += block(name, blocks.pop(0))
    if section["acceptance"]:
        text += data_table(("requirement", "measured", "limit", ""),
                           [acceptance_row(line) for line in section["acceptance"]], kind="acceptance", escaped=True)
    text += "".join(block(name, item) for item in blocks)
    if section["costs"]:
        text += f"<h3>Cost</h3>{costs(section['costs'])}"
    made = {key: escape(value) for key, value in section["made"].items()}
    return text + (f'<p class="note">Command: <code>{made["command"]}</code>. Commit {made["commit"]}, build '
                   f'{made["build"]}, {made["date"]}. {made["machine"]}.</p></section>')


def page(sections, examples, resolution):
    """The whole page. `sections`: by name, those that exist; `examples`: name: (number, title)."""
    style = (ROOT / "python" / "brisance" / "report.css").read_text(encoding="utf-8") + STYLE
    parts = "".join(part(name, *titles, sections.get(name)) for name, titles in examples.items())
    links = " ".join(f'<a href="#{name}">{number} {escape(title)}</a>' for name, (number, title) in examples.items())
    builds = {section["made"]["build"] for section in sections.values()}
    notes = "" if len(builds) < 2 else ('<p class="note">The examples were run with different builds of the program; '
                                        "each section names its own.</p>")
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>The examples of Cui et al. 2014</title><style>{style}</style></head>
<body><header><div><h1>The examples of Cui et al. 2014</h1><p>Brisance, resolution “{escape(resolution)}”</p>
<nav>{links}</nav></div></header>
<main>{INTRODUCTION}{notes}{summary(sections, examples)}
{parts}</main>
<footer><div>Produced by <code>validation/run paper</code>, which runs what is missing and continues where it was
stopped; <code>--example NAME</code> renews one example, <code>--resolution quick|fine</code> uses coarser or finer
grids, <code>--compose</code> rewrites this page. The figures and the numbers (<code>section.json</code>) are in the
folders beside it. It prints well.</div></footer> </body></html>
"""
