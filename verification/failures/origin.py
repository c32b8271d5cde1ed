"""Far from the origin, and in other units."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kshell.verify.cases import find, meshes
from verification.failures.failure import (
    Failure,
    Floats,
    Numbers,
    columns,
    deflection,
    lines,
    panels,
    solved,
    square,
)
from verification.peers import scikit_fem

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CELLS = 8
SHIFTS = (0.0, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5)
SCALES = (1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6)


def _errors(shift: float, scale: float) -> dict[str, float]:
    points, triangles = meshes.grid(CELLS, CELLS)
    moved = scale * points + shift
    exact = find("clamped.uniform.ba1").references["w_c"].value * scale**4
    middle = shift + scale / 2
    ours = deflection(solved(square(moved, triangles), {"edge": "C"}, "argyris"), middle, middle)
    return {"scikit-fem alone": _bare(moved, triangles, middle, exact), "kshell": abs(ours / exact - 1)}


def _bare(points: Floats, triangles: NDArray[np.int64], middle: float, exact: float) -> float:
    """Its error; infinite where its matrices are singular."""
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            found = scikit_fem.solve(points, triangles, "argyris", "clamped").deflection(middle, middle)
        except (np.linalg.LinAlgError, ValueError):  # singular local matrices, or a point lost by rounding
            return np.inf
    return abs(found / exact - 1) if np.isfinite(found) else np.inf


def measure(quick: bool) -> Numbers:
    """Relative errors of the deflection in the middle; a shift of a scaled plate is 0, and vice versa."""
    shifts, scales = (SHIFTS[::3], SCALES[::3]) if quick else (SHIFTS, SCALES)
    rows = [{"shift": s, "scale": 1.0, **_errors(s, 1.0)} for s in shifts]
    return columns(rows + [{"shift": 0.0, "scale": s, **_errors(0.0, s)} for s in scales])


def draw(numbers: Numbers) -> Figure:
    """Two panels: shifted, scaled."""
    figure, (left, right) = panels(2)
    moved, scaled = numbers["shift"] > 0, numbers["shift"] == 0
    names = ["scikit-fem alone", "kshell"]
    for axes, x, chosen in ((left, "shift", moved), (right, "scale", scaled)):
        lines(axes, {name: values[chosen] for name, values in numbers.items()}, x, names)
        axes.set_ylim(1e-7, 1e4)
    left.set(
        xlabel="shift of a unit square",
        ylabel="relative error of the deflection",
        title="Far from the origin",
    )
    right.set(xlabel="side of the square", title="Small and large")
    return figure


FAILURE = Failure(
    "origin",
    "Far from the origin, and in other units",
    "Argyris' quintics written as monomials of x and y lose their digits with the distance from the origin: the local "
    "matrix that is inverted mixes 1 with x^5. At a distance of 100 sides nothing is left, then the matrices are "
    "singular. Other units alone do no harm. A clamped square of eight cells per side.",
    "Bases are evaluated on the reference triangle and mapped by a small matrix in which only differences of "
    "coordinates appear, with unknowns scaled by the mesh size: the error is the same everywhere and in all units.",
    measure,
    draw,
)
