"""One HTML page of a verification run: summary, machine, charts, table. It needs no other file."""

from __future__ import annotations

import csv
import io
from base64 import b64encode
from collections.abc import Iterable, Mapping
from html import escape

from kshell.verify.cases import all_cases
from kshell.verify.cases.collected import left_out
from kshell.verify.run import Report

HEADS = (
    "case",
    "mesh",
    "unknowns",
    "quantity",
    "value",
    "reference",
    "error",
    "allowed",
    "seconds",
    "verdict",
)
STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 72rem; padding: 0 1rem; color: #1c1917 }
table { border-collapse: collapse; font-size: 12px; font-variant-numeric: tabular-nums }
td, th { padding: 1px 8px; text-align: right; border-bottom: 1px solid #e7e5e4 }
td:nth-child(-n+2), th:nth-child(-n+2), td:nth-child(4), th:nth-child(4) { text-align: left }
thead th { position: sticky; top: 0; background: white }
tr.failed td { background: #fee2e2 }
img { max-width: 100%; display: block; margin: 1rem 0 }
.facts td { text-align: left }
"""


def rows(report: Report) -> list[tuple[str, ...]]:
    """The table as text, `HEADS` above it."""
    out: list[tuple[str, ...]] = []
    for block in report.blocks:
        for number, one in enumerate(block.outcomes):
            seconds = f"{block.seconds:.2f}" if number == 0 else ""
            verdict = "passed" if one.passed else "FAILED"
            out.append(
                (one.case, one.run, str(one.unknowns), one.quantity, f"{one.value:.10g}", f"{one.reference:.10g}",
                 f"{one.error:.1e}", f"{one.allowed:.1e}", seconds, verdict)
            )  # fmt: skip
    return out


def table_csv(report: Report, facts: Mapping[str, str]) -> str:
    """The table as CSV, after lines of facts that start with #."""
    out = io.StringIO()
    for key, value in facts.items():
        out.write(f"# {key}: {value}\n")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(HEADS)
    writer.writerows(rows(report))
    return out.getvalue()


def page(report: Report, facts: Mapping[str, str], pictures: Mapping[str, bytes]) -> str:
    """The page, with the pictures (PNG) inside."""
    title = "kshell: verification on this machine"
    parts = [
        f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>{title}</title>',
        f"<style>{STYLE}</style></head><body><h1>{title}</h1>",
        f"<p><strong>{escape(report.summary())}</strong></p>",
        "<p>Quick: each case once with each element and degree.</p>"
        if report.quick
        else "<p>Full: each case on all its meshes, and the rates of convergence.</p>",
        _table(facts.items(), "facts"),
    ]
    problems = [(b.outcomes[0].case, b.outcomes[0].run, b.problem) for b in report.blocks if b.problem]
    if problems:
        parts.append("<h2>Without an answer</h2>" + _table(problems, "facts"))
    for name, data in pictures.items():
        alt = escape(name.removesuffix(".png"))
        parts.append(f'<img alt="{alt}" src="data:image/png;base64,{b64encode(data).decode()}">')
    parts.append("<h2>All values</h2><table><thead><tr>" + "".join(f"<th>{h}</th>" for h in HEADS))
    parts.append("</tr></thead><tbody>")
    for row in rows(report):
        mark = ' class="failed"' if row[-1] == "FAILED" else ""
        parts.append(f"<tr{mark}>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>")
    parts.append("</tbody></table><h2>Where the references come from</h2>")
    run = {one.case for one in report.outcomes}
    parts.append(_table([(c.id, c.description, c.source) for c in all_cases() if c.id in run], "facts"))
    parts.append("<h2>Collected references that no case runs</h2>")
    parts.append(_table([(c.id, c.what, c.reason) for some in left_out().values() for c in some], "facts"))
    return "\n".join([*parts, "</body></html>\n"])


def _table(lines: Iterable[tuple[str, ...]], kind: str) -> str:
    cells = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in line) + "</tr>" for line in lines)
    return f'<table class="{kind}">{cells}</table>'
