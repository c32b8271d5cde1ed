"""How good a result is, for people: values with their intervals, the levels of refinement, and the budget."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from kshell.result.result import Result


def interval_lines(result: Result) -> Iterator[str]:
    """One line each; none where nothing was to be estimated."""
    error = result.error
    if error["kind"] == "none" and error.get("why_not"):
        yield f"no interval: {error['why_not']}"
    for name, found in error.get("probes", {}).items():
        yield f"{name}: {_displacement(result, name, found['u'])}"
    energy = error.get("energy")
    if energy:
        half = 0.5 * (energy["upper"] - energy["lower"])
        lower, upper = (_number(energy[end], half) for end in ("lower", "upper"))
        yield f"strain energy between {lower} and {upper} ({energy['kind']})"
    for number, level in enumerate(error.get("levels") or (), 1):
        if "half_width" in level and "seconds" in level:
            width = level["half_width"]
            known = "not known" if width is None else f"within {width:.1e}"
            yield f"level {number}: {level['unknowns']} unknowns, {known}, {level['seconds']:.2f} s"
    budget = {name: part for name, part in error["budget"].items() if part is not None}
    if budget and error["kind"] != "none":
        parts = ", ".join(f"{name.replace('_', ' ')} {part:.1e}" for name, part in budget.items())
        yield f"error budget, relative: {parts}"


def _displacement(result: Result, name: str, found: dict[str, Any]) -> str:
    u, half, expected = (
        np.asarray(part, dtype=float)
        for part in (result.probes[name]["u"], found["half_width"], found["expected"])
    )
    if result.model["kind"] == "plate":
        return f"w = {_number(u[2], half[2])} +- {half[2]:.1e} ({found['kind']}; expected {expected[2]:.0e})"
    values = ", ".join(_number(value, width) for value, width in zip(u, half, strict=True))
    widths = ", ".join(f"{width:.1e}" for width in half)
    return f"u = ({values}) +- ({widths}) ({found['kind']})"


def _number(value: float, half: float) -> str:
    """With the digits that are known, and one more."""
    if half <= 0.0 or value == 0.0:
        return f"{value:.6g}"
    digits = int(np.clip(np.ceil(np.log10(abs(value) / half)) + 2, 2, 15)) if half < abs(value) else 2
    return f"{value:.{digits}g}"
