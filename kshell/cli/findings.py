"""What the command line prints of a check."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape as _escaped

from kshell.cli.tables import console, table
from kshell.cli.terminal import print_warnings
from kshell.mesh.words import place

if TYPE_CHECKING:
    from kshell.analysis.check import Findings
    from kshell.mesh.quality import Quality, Summary


def print_findings(found: Findings) -> None:
    """What a check found, except the problems."""
    out = console()
    _print_summary(out, found.summary)
    _print_quality(out, found.quality)
    if found.model:
        out.print("[bold]What would be solved[/bold]")
        for words in found.model:
            out.print(f"  {_escaped(words)}")
    for words in found.cost:
        out.print(_escaped(words))
    print_warnings(out, found.warnings)
    if not found.problems:
        out.print("[green]nothing found that would stop a solve[/green]")


def _print_summary(out: Console, summary: Summary) -> None:
    out.print(
        f"[bold]{_escaped(summary.source)}[/bold]: order {summary.order}, {summary.vertices} vertices, "
        f"{summary.edges} edges, {summary.triangles} triangles"
    )
    out.print(
        f"from {place(summary.lower)} to {place(summary.upper)}, area {summary.area:.6g}, "
        f"boundary {summary.boundary_length:.6g} long"
    )
    unit = {"point": "", "curve": "length", "surface": "area"}
    rows = [
        [
            g.name,
            g.kind,
            _span(g.lower, g.upper),
            str(g.members),
            f"{unit[g.kind]} {g.measure:.6g}" if unit[g.kind] else "",
        ]
        for g in summary.groups
    ]
    heads = ["group", "kind", "from, to", "members", "size"]
    out.print(table(heads, rows, "Groups", 2) if rows else "no groups")


def _span(lower: tuple[float, ...], upper: tuple[float, ...]) -> str:
    """The box of a group in words."""
    if not lower:
        return ""
    first, last = (f"({', '.join(f'{v + 0.0:.4g}' for v in corner)})" for corner in (lower, upper))
    return first if lower == upper else f"{first}, {last}"


def _print_quality(out: Console, worst: Quality) -> None:
    rows = [
        ["smallest angle", f"{worst.min_angle:.3g} degrees", place(worst.min_angle_at)],
        ["largest aspect ratio", f"{worst.max_aspect:.3g}", place(worst.max_aspect_at)],
        ["shortest edge", f"{worst.shortest_edge:.4g}", place(worst.shortest_edge_at)],
        ["longest edge", f"{worst.longest_edge:.4g}", place(worst.longest_edge_at)],
    ]
    out.print(table(["quality", "worst", "at"], rows, "Triangles"))
