"""Curvature estimates that stay wrong however fine the triangulation is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from verification.failures.failure import Failure, Numbers, columns, lines, panels
from verification.geometry.convergence import FAMILIES, torus_errors

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZES = (12, 24, 48)
SHOWN = {
    "defect": "K, angle defect",
    "cotangent": "H, cotangent formula",
    "midedge_mean": "k, mean directors",
    "principal": "k, fitted polynomial",
    "cycle": "k, normal cycle",
}


def measure(quick: bool) -> Numbers:
    """Largest errors on a torus: regular, crossed and irregular meshes."""
    rows = []
    for n in SIZES[:2] if quick else SIZES:
        row = {"cells": float(n)}
        for family in FAMILIES:
            options: Any = FAMILIES[family]
            errors = torus_errors(n, **options)
            row |= {f"{family}: {label}": errors[name] for name, label in SHOWN.items()}
        rows.append(row)
    return columns(rows)


def draw(numbers: Numbers) -> Figure:
    """One panel per family of meshes."""
    figure, axes = panels(len(FAMILIES))
    for place, family in zip(axes, FAMILIES, strict=True):
        own = {name.removeprefix(f"{family}: "): v for name, v in numbers.items() if name.startswith(family)}
        lines(place, {"cells": numbers["cells"], **own}, "cells", list(own))
        place.set(xlabel="cells around the tube", title=family.capitalize(), ylim=(1e-3, 10))
        place.set_xticks(numbers["cells"], [f"{int(k)}" for k in numbers["cells"]])
        place.minorticks_off()
    axes[0].set_ylabel("largest error")
    return figure


def gains(numbers: Numbers) -> dict[str, float]:
    """Error of the coarsest over that of the finest mesh: 1 where nothing converges."""
    return {
        name: float(np.asarray(e)[0] / np.asarray(e)[-1]) for name, e in numbers.items() if name != "cells"
    }


FAILURE = Failure(
    "discrete_curvature",
    "Discrete curvature on bad triangulations",
    "The angle defect and the cotangent formula are consistent on meshes of valence 6 alone. With valences 4 and 8, or "
    "vertices moved at random, their errors do not become smaller with the triangles, and neither do those of "
    "bending energies built on them.",
    "`kshell.geometry.discrete` has fitted polynomials and the normal cycle, which converge on all of these meshes, "
    "beside the classical formulas; elements of kshell never use curvatures taken from angles.",
    measure,
    draw,
)
