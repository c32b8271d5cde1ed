"""Needles and caps: triangles of aspect 1 to 1e4."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

import kshell as ks
from kshell.verify.cases import find, meshes
from verification.failures.failure import (
    Failure,
    Floats,
    Numbers,
    columns,
    deflection,
    lines,
    moment,
    panels,
    solved,
    square,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ASPECTS = (1.0, 10.0, 100.0, 1e3, 1e4)
CELLS = {"argyris": 8, "morley": 24}


def needles(n: int, aspect: float) -> tuple[Floats, NDArray[np.int64]]:
    """A grid with one column of cells so narrow that they are ``aspect`` times as long as wide."""
    points, triangles = meshes.grid(n + 1, n)
    width = 1 / (n * aspect)
    wide = np.full(n, (1 - width) / n)
    x = np.concatenate([[0.0], np.cumsum(np.insert(wide, n // 4, width))])
    points[:, 0] = x[np.rint(points[:, 0] * (n + 1)).astype(int)]
    return points, triangles


def caps(n: int, aspect: float) -> tuple[Floats, NDArray[np.int64]]:
    """A grid with a vertex near the middle of a diagonal in a row of cells: angles close to 180 degrees."""
    points, triangles = meshes.grid(n, n)
    longest = np.linalg.norm(points[triangles[:, 2]] - points[triangles[:, 0]], axis=1) > 1.2 / n
    middle = points[triangles].mean(axis=1)
    chosen = np.flatnonzero(longest & (np.abs(middle[:, 1] - 0.25) < 0.5 / n))
    a, b, c = triangles[chosen].T  # a and c end the diagonal
    direction = points[b] - (points[a] + points[c]) / 2
    extra = (points[a] + points[c]) / 2 + direction / aspect / 2
    number = len(points) + np.arange(len(chosen))
    parts = [np.stack(t, axis=1) for t in ((a, b, number), (b, c, number), (a, number, c))]
    return np.concatenate([points, extra]), np.concatenate([np.delete(triangles, chosen, axis=0), *parts])


FAMILIES = {"needles": needles, "caps": caps}


def measure(quick: bool) -> Numbers:
    """Relative errors of deflection and moment in the middle of the clamped square."""
    exact = find("clamped.uniform.ba1").references
    rows = []
    for aspect in ASPECTS[::2] if quick else ASPECTS:
        row = {"aspect": aspect}
        for family, make in FAMILIES.items():
            for element, n in CELLS.items():
                found = _errors(square(*make(n, aspect)), element, exact["w_c"].value, exact["Mx_c"].value)
                row |= {f"{family} {element} {name}": value for name, value in found.items()}
        rows.append(row)
    return columns(rows)


def _errors(mesh: ks.Mesh, element: str, w: float, m: float) -> dict[str, float]:
    """NaN where kshell refuses to answer."""
    try:
        result = solved(mesh, {"edge": "C"}, element)
    except ks.SolveError:
        return {"w": np.nan, "M": np.nan, "balance": np.nan}
    return {
        "w": abs(deflection(result, 0.5, 0.5) / w - 1),
        "M": abs(moment(result, 0.5, 0.5) / m - 1),
        "balance": result.balance,
    }


def draw(numbers: Numbers) -> Figure:
    """One panel per family."""
    figure, axes = panels(2)
    for place, family in zip(axes, FAMILIES, strict=True):
        names = [name for name in numbers if name.startswith(family) and not name.endswith("balance")]
        short = {name.removeprefix(f"{family} "): numbers[name] for name in names}
        lines(place, {"aspect": numbers["aspect"], **short}, "aspect", list(short))
        place.set(xlabel="longest side / height", title=family.capitalize(), ylim=(1e-8, 1))
    axes[0].set_ylabel("relative error in the middle")
    return figure


FAILURE = Failure(
    "thin_triangles",
    "Needles and caps",
    "Two kinds of thin triangles in otherwise good meshes of a clamped square: needles (one short side) and caps (an "
    "angle near 180 degrees). Conditioning worsens with the fourth power of the shortest height, so that thin "
    "triangles cost digits; multigrid needs more iterations.",
    "Unknowns are scaled by the size of the triangles around them and solutions are refined; `kshell check` names the "
    "worst triangles, multigrid is not chosen on meshes with many of them, and the equilibrium that every result "
    "states shows when digits are gone.",
    measure,
    draw,
)
