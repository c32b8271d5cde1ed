"""Shells over a plane of parameters: the true surface of a chart, or triangles of order 1 and 2 on it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kshell as ks
from kshell.verify.cases.case import TRUE_SURFACE, Run
from kshell.verify.cases.plate import LINEAR

Floats = NDArray[np.float64]
Grade = Callable[[Floats], Floats]  # of [0, 1] onto itself
Chart = ks.geometry.Chart


def evenly(s: Floats) -> Floats:
    """Cells of one size."""
    return s


def to_start(power: float) -> Grade:
    """Smaller cells towards the start, as s^power."""
    return lambda s: s**power


def to_end(s: Floats) -> Floats:
    """Smaller cells towards the end."""
    return 1.0 - (1.0 - s) ** 1.5


def to_both_ends(s: Floats) -> Floats:
    """Smaller cells towards both ends."""
    return 0.5 - 0.5 * np.cos(np.pi * s)


@dataclass(frozen=True)
class Parameters:
    """A rectangle of parameters in cells with alternating diagonals.

    Attributes
    ----------
    u, v : pairs of float
    sides : names of u = first, u = last, v = first, v = last
    grade_u, grade_v : functions of [0, 1] onto itself
    """

    u: tuple[float, float]
    v: tuple[float, float]
    sides: tuple[str, str, str, str]
    grade_u: Grade = evenly
    grade_v: Grade = evenly

    def mesh(self, n_u: int, n_v: int) -> ks.Mesh:
        """n_u by n_v cells."""
        unit = ks.geometry.Plane().parameter_mesh(
            n_u, n_v, self.sides, u_range=(0, 1), v_range=(0, 1), pattern="alternate"
        )
        s, t = unit.points[:, 0], unit.points[:, 1]
        u = self.u[0] + (self.u[1] - self.u[0]) * self.grade_u(s)
        v = self.v[0] + (self.v[1] - self.v[0]) * self.grade_v(t)
        return replace(unit, points=np.column_stack([u, v, np.zeros(len(u))]))


def on_surface(chart: Chart, flat: ks.Mesh, order: int) -> dict[str, Any]:
    """What a scene is given: mesh and chart for the true surface, else a mesh of order 1 or 2 in space."""
    if order == TRUE_SURFACE:
        return {"mesh": flat, "chart": chart}
    corners: dict[int, Any] = {0: np.arange(len(flat.points)), 1: flat.edges, 2: flat.triangles}
    groups = {name: corners[group.dimension][group.members] for name, group in flat.groups.items()}
    middles = chart(*flat.points[flat.edges].mean(axis=1)[:, :2].T) if order == 2 else None
    return {"mesh": ks.Mesh.from_arrays(chart(*flat.points[:, :2].T), flat.triangles, groups, middles)}


@dataclass(frozen=True)
class Shell:
    """A shell but for its mesh.

    Attributes
    ----------
    chart : Chart
    flat : function
        From refinement to the mesh in the plane of parameters.
    scene : dict
        thickness or layers, material, supports, loads, options.
    """

    chart: Chart
    flat: Callable[[int], ks.Mesh]
    scene: Mapping[str, Any]

    def __call__(self, refinement: int, order: int) -> ks.Scene:
        """The scene on a mesh."""
        given = {"solve": LINEAR, **self.scene}
        return ks.Scene(**on_surface(self.chart, self.flat(refinement), order), **given)


def runs(
    *refinements: tuple[int, int], argyris: tuple[int, ...] = (), cubics_on_chart: bool = True
) -> tuple[Run, ...]:
    """Koiter of degree 1, 2, 3 on a coarse and a fine mesh, and Argyris on the chart.

    Degree 1 has flat triangles, degrees 2 and 3 triangles of order 2 as from a mesh generator; degree 3 gains from
    the true surface, so that it has this as well.

    Parameters
    ----------
    *refinements : pairs
        Coarse and fine, of each degree.
    argyris : refinements
    """
    surfaces = {1: (1,), 2: (2,), 3: (2, TRUE_SURFACE) if cubics_on_chart else (2,)}
    out = [
        Run("koiter", n, order, degree)
        for degree, both in zip(surfaces, refinements, strict=True)
        for order in surfaces[degree]
        for n in both
    ]
    return (*out, *(Run("argyris", n, TRUE_SURFACE) for n in argyris))
