"""Curvature estimates that stay wrong however fine the triangulation is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import kshell as ks
from kshell.geometry import discrete
from verification.failures.failure import Failure, Numbers, columns, lines, panels
from verification.geometry.convergence import FAMILIES, torus_errors
from verification.geometry.meshes import lantern

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZES = (12, 24, 48)
LANTERN = "Schwarz's lantern"
SHOWN = {
    "defect": "K, angle defect",
    "cotangent": "H, cotangent formula",
    "midedge_mean": "k, mean directors",
    "principal": "k, fitted polynomial",
    "cycle": "k, normal cycle",
}


def lantern_errors(n: int) -> dict[str, float]:
    """Of a cylinder of radius 1 from n^2 / 8 bands of 2 n triangles: vertices on it, normals not. NaN: refused."""
    mesh = lantern(n, n * n // 8)
    inside = np.abs(mesh.points[:, 2] - 0.5) < 0.2
    try:
        fitted = np.abs(discrete.principal(mesh).principal_curvatures[inside]).max(axis=1)
    except ks.InputError:
        fitted = np.full(1, np.nan)
    return {
        "area": abs(discrete.area(mesh) / (2 * np.pi) - 1),
        SHOWN["cotangent"]: float(np.abs(np.abs(discrete.mean_curvature(mesh)[inside]) - 0.5).max()),
        SHOWN["principal"]: float(np.abs(fitted - 1).max()),
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
        row |= {f"{LANTERN}: {label}": error for label, error in lantern_errors(n).items()}
        rows.append(row)
    return columns(rows)


def draw(numbers: Numbers) -> Figure:
    """One panel per family of meshes."""
    families = [*FAMILIES, LANTERN]
    figure, axes = panels(len(families))
    figure.set_size_inches(15, 4)
    for place, family in zip(axes, families, strict=True):
        own = {name.removeprefix(f"{family}: "): v for name, v in numbers.items() if name.startswith(family)}
        lines(place, {"cells": numbers["cells"], **own}, "cells", list(own))
        place.set(
            xlabel="cells around" if family == LANTERN else "cells around the tube",
            title=family[0].upper() + family[1:],
            ylim=(1e-3, 10),
        )
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
    "The angle defect and the cotangent formula are consistent on meshes of valence 6 alone. With valences 4 and "
    "8, or vertices moved at random, their errors do not become smaller with the triangles, and neither do those "
    "of bending energies built on them. Schwarz's lantern, with more and more bands of ever flatter triangles, "
    "has its vertices on a cylinder, and not even its area converges: normals do not.",
    "`kshell.geometry.discrete` has fitted polynomials and the normal cycle, which converge on all meshes whose "
    "normals do, beside the classical formulas; elements of kshell never use curvatures taken from angles. On "
    "fine lanterns the fit is refused with the place.",
    measure,
    draw,
)
