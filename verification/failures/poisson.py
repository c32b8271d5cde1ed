"""Poisson's ratio near 1/2 and near -1."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

import kshell as ks
from kshell.verify.cases import meshes
from verification.failures.failure import Failure, Floats, Numbers, columns, deflection, lines, panels, solved

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DISTANCES = tuple(10.0**-k for k in range(1, 13))


def condensed(E: float, nu: float) -> Floats:
    """Plane-stress stiffness by eliminating the stress across the thickness from the 3D law: the textbook way."""
    lame = E * nu / ((1 + nu) * (1 - 2 * nu))
    mu = E / (2 * (1 + nu))
    law = lame * np.ones((3, 3)) + 2 * mu * np.eye(3)
    plane = law[:2, :2] - np.outer(law[:2, 2], law[2, :2]) / law[2, 2]
    return np.block([[plane, np.zeros((2, 1))], [np.zeros((1, 2)), np.array([[mu]])]])


def exact(E: float, nu: float) -> Floats:
    """The closed form."""
    return E / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])


def _of_disk(nu: float) -> float:
    """Relative error of the deflection of a simply supported disk of E = 1, by kshell; NaN where it refuses."""
    try:
        result = solved(meshes.ellipse(4), {"edge": "S"}, "argyris", material=ks.Isotropic(E=1.0, nu=nu))
    except ks.SolveError:
        return np.nan
    stiffness = 1 / (12 * (1 - nu) * (1 + nu))
    return abs(deflection(result, 0.0, 0.0) / ((5 + nu) / (1 + nu) / 64 / stiffness) - 1)


def measure(quick: bool) -> Numbers:
    """Errors against the distance from the limit."""
    rows = []
    for d in DISTANCES[::4] if quick else DISTANCES:
        row = {"distance": d}
        for name, nu in (("1/2", 0.5 - d), ("-1", -1 + d)):
            true = exact(1.0, nu)
            ours = ks.Isotropic(E=1.0, nu=nu).plane_stress()
            row[f"{name} textbook stiffness"] = float(
                np.abs(condensed(1.0, nu) / true[0, 0] - true / true[0, 0]).max()
            )
            row[f"{name} kshell stiffness"] = float(np.abs(ours - true).max() / true[0, 0])
            row[f"{name} kshell disk"] = _of_disk(nu)
        rows.append(row)
    return columns(rows)


def draw(numbers: Numbers) -> Figure:
    """One panel per limit."""
    figure, axes = panels(2)
    for place, limit in zip(axes, ("1/2", "-1"), strict=True):
        names = {
            name.removeprefix(f"{limit} "): numbers[name] for name in numbers if name.startswith(f"{limit} ")
        }
        lines(place, {"distance": numbers["distance"], **names}, "distance", list(names), floor=1e-17)
        place.set(xlabel=f"|nu - ({limit})|", title=f"nu near {limit}", ylim=(3e-18, 10))
        place.invert_xaxis()
    axes[0].set_ylabel("relative error")
    return figure


FAILURE = Failure(
    "poisson",
    "Poisson's ratio near 1/2 and near -1",
    "The three-dimensional law is singular at nu = 1/2. Eliminating the stress across the thickness from it "
    "subtracts large, nearly equal numbers, and loses a digit with every digit that nu comes closer. Near -1 "
    "the stiffness against w_xx + w_yy vanishes beside that against the rest: the problem itself is nearly singular.",
    "The plane-stress law is taken in closed form and is harmless at 1/2. Near -1 "
    "the error is about 6e-12 / (1 + nu); from 1 + nu = 6e-5 on a warning says what error that may mean, "
    "before the system is refused as nearly singular. "
    "nu = 1/2 and nu = -1 themselves, and what lies beyond, are bad input.",
    measure,
    draw,
)
