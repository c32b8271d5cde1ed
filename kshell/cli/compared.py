"""What the command line prints of sweeps and differences."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from rich.markup import escape as _escaped

from kshell.cli.tables import console, number, table

if TYPE_CHECKING:
    from kshell.analysis.sweep import Sweep
    from kshell.result.compare import Difference

MOST_DIFFERENCES = 40


def print_sweep(rows: Sweep, written: Iterable[str]) -> None:
    """Parameters and largest values of every point, and the reasons of those without an answer."""
    out = console()
    numbers = ("deflection", "von_mises", "frequency_1", "factor_1")
    shown = [name for name in rows.columns if name in numbers]
    given = rows.parameters + (["case"] if "case" in rows.columns else [])
    body = [
        [
            *(_side(row.get(name, "")) for name in given),
            row["error"],
            *(number(row[name]) if row.get(name) is not None else "" for name in shown),
        ]
        for row in rows
    ]
    out.print(table([*given, "no answer", *shown], body, f"Sweep, {len(rows)} rows", len(shown)))
    for path in written:
        out.print(f"written: {_escaped(path)}")


def print_differences(found: Sequence[Difference], first: str, second: str) -> None:
    """The largest differences of two results."""
    out = console()
    if not found:
        out.print(f"no differences but rounding between {_escaped(first)} and {_escaped(second)}")
        return
    rows = []
    for difference in found[:MOST_DIFFERENCES]:
        share = "-" if difference.relative == float("inf") else f"{difference.relative:.2e}"
        rows.append([difference.what, _side(difference.first), _side(difference.second), share])
    out.print(table(["what", first, second, "relative"], rows, f"{len(found)} differences", 1))
    if len(found) > MOST_DIFFERENCES:
        out.print(f"{len(found) - MOST_DIFFERENCES} smaller ones are not shown")


def _side(value: Any) -> str:
    if value is None:
        return "missing"
    if isinstance(value, list):
        return "\n".join(_side(part) for part in value)
    return number(value) if isinstance(value, int | float) else str(value)
