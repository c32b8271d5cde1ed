"""The HTML file of a report: its content put into the template beside this module."""

from __future__ import annotations

import platform
import time
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import Any

from kshell.report.asked import case_table, load_table, mesh_tables, model_table, scene_tables, support_table
from kshell.report.found import envelope_tables, error_tables, result_tables
from kshell.report.images import image, images
from kshell.report.table import Table
from kshell.report.view_data import view_data
from kshell.result.result import Result
from kshell.version import __version__

ANALYSES = {
    "static": "static analysis",
    "path": "path of large deflections",
    "modes": "natural frequencies",
    "buckling": "linear buckling",
    "response": "harmonic response",
    "dynamic": "motion in time",
}
SOFTWARE = ("numpy", "scipy", "scikit-fem", "matplotlib")


def write_report(result: Result, path: Path) -> None:
    """Write the report of a result, one HTML file that needs no other."""
    path.write_text(page(result), encoding="utf-8")


def page(result: Result) -> str:
    """The text of the report."""
    from jinja2 import Environment, StrictUndefined

    here = files("kshell.report")
    parts = {name: here.joinpath(name).read_text("utf-8") for name in ("page.html", "page.css", "view.js")}
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    template = environment.from_string(parts["page.html"])
    return template.render(
        content(result), css=parts["page.css"], script=parts["view.js"], view=view_data(result)
    )


def content(result: Result) -> dict[str, Any]:
    """What stands in the report: text, tables and pictures."""
    scene, kind = result.scene, result.model.get("kind", "")
    units = f"; units {result.units}" if result.units else ""
    return {
        "title": result.title or "kshell",
        "subtitle": f"{kind}: {ANALYSES.get(result.analysis, result.analysis)}{units}",
        "warnings": result.warnings,
        "scene": None if scene is None else scene_tables(scene),
        "picture": image(result, "mesh"),
        "mesh": list(mesh_tables(result)),
        "supports": None if scene is None else support_table(scene),
        "loads": None if scene is None else load_table(scene),
        "cases": None if scene is None or not scene.cases else case_table(scene),
        "model": model_table(result),
        "reasons": result.model.get("reasons", []),
        "results": _results(result),
        "error": list(error_tables(result)),
        "why_not": result.error.get("why_not", ""),
        "software": _software(result),
    }


def _results(result: Result) -> list[dict[str, Any]]:
    """Name, tables and pictures of every load case, and the envelope."""
    if not result.cases:
        return [{"name": "Result", "tables": list(result_tables(result)), "images": images(result)}]
    found = [
        {
            "name": f"{'Combination' if name in result.combinations else 'Load case'} {name}",
            "tables": list(result_tables(case)),
            "images": images(case, few=name != result.case),
        }
        for name, case in result.cases.items()
    ]
    return [{"name": "Envelope of all cases", "tables": list(envelope_tables(result)), "images": []}, *found]


def _software(result: Result) -> Table:
    seconds = result.solver.get("seconds", {})
    rows = [
        ["kshell", __version__],
        ["Python", platform.python_version()],
        *([name, version(name)] for name in SOFTWARE),
        ["system", f"{platform.system()} {platform.machine()}"],
        ["solver", str(result.solver.get("name", ""))],
        ["seconds", ", ".join(f"{name} {value:.3g}" for name, value in seconds.items())],
        ["report written", time.strftime("%Y-%m-%d %H:%M")],
    ]
    return Table("", (), rows)
