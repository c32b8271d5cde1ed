"""Strains at which a shell is free of stress: initial strain and curvature, and temperature, which is both.

A `StressFree` state has the strain E and the change of curvature kappa in the frame of recovery.py. A strain
also changes the curvature of a curved surface: where a uniform strain e only makes the shell larger, b - B = e B,
and no moment may be left. So kappa here counts beyond - (E B + B E) / 2, B the second fundamental form.

What that is in the strains of each discretisation stands in koiter/initial.py and chart/initial.py.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.shell.evaluate import Value, evaluate
from kshell.shell.frames import components, contravariant_to_frame, tangent_frame
from kshell.shell.section import Section
from kshell.shell.vectors import cross, dot, norm

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


@dataclass(frozen=True)
class StressFree:
    """What a shell takes up without stress.

    Attributes
    ----------
    strain : value
        Tensor E_11, E_22, E_12 of the midsurface, a constant or a function of points.
    curvature : value
        Tensor kappa_11, kappa_22, kappa_12; > 0 makes the top longer than the bottom.
    of_section : function, optional
        Instead: both, (triangle, point, 6) with the shears doubled, at points (triangle, point, 3) of triangles, along
        the axes from which the angles of the material count.
    """

    strain: Value = (0.0, 0.0, 0.0)
    curvature: Value = (0.0, 0.0, 0.0)
    of_section: Callable[[Ints, Floats], Floats] | None = None

    def at(self, triangles: Ints, points: Floats) -> tuple[Floats, Floats]:
        """Strain and curvature as tensors (triangle, point, 3) at points of triangles."""
        if self.of_section is None:
            return evaluate(self.strain, points, 3), evaluate(self.curvature, points, 3)
        both = self.of_section(triangles, points) * np.array([1.0, 1.0, 0.5, 1.0, 1.0, 0.5])
        return both[..., :3], both[..., 3:]

    def axes(self, triangles: Ints, first: Floats, section: Section) -> Floats:
        """f of `components` in the frame of strain and curvature, from tangents (2, 3, triangle, point)."""
        direction = None if self.of_section is None else section.direction_of(triangles)
        return components(first, *tangent_frame(first, direction)[:2])


def temperature(mean: Value, gradient: Value, expansion: float = 1.0) -> StressFree:
    """Of a rise of temperature: `mean` at the midsurface, `gradient` per length towards the normal."""

    def isotropic(value: Value) -> Value:
        def at(points: Floats) -> Floats:
            e = expansion * evaluate(value, points, 1)
            return np.stack([e, e, np.zeros_like(e)], axis=-1)

        return at

    return StressFree(isotropic(mean), isotropic(gradient))


def strain_of(state: StressFree, triangles: Ints, points: Floats, first: Floats, section: Section) -> Floats:
    """Covariant E_11, E_22, E_12 at points (triangle, point, 3) with tangents (2, 3, triangle, point)."""
    return _covariant(state.axes(triangles, first, section), state.at(triangles, points)[0])


def curvature_of(
    state: StressFree, triangles: Ints, points: Floats, first: Floats, second: Floats, section: Section
) -> Floats:
    """Covariant kappa of the state: kappa - (E B + B E) / 2, all in the frame."""
    f = state.axes(triangles, first, section)
    strain, bent = state.at(triangles, points)
    normal = cross(first[0], first[1])
    normal = normal / norm(normal)
    form = np.stack([dot(normal, b) for b in second])  # B_11, B_22, B_12
    (a, b), (c, d) = f
    inverse = np.stack([np.stack([d, -c]), np.stack([-b, a])]) / (a * d - b * c)
    b11, b22, b12 = np.einsum("vwtq,wtq->vtq", contravariant_to_frame(inverse), form)
    e11, e22, e12 = np.moveaxis(strain, -1, 0)
    product = [e11 * b11 + e12 * b12, e22 * b22 + e12 * b12, 0.5 * (e12 * (b11 + b22) + b12 * (e11 + e22))]
    return _covariant(f, bent - np.stack(product, axis=-1))


def _covariant(f: Floats, tensor: Floats) -> Floats:
    """T_ab = f_ia f_jb T_ij, listed 11, 22, 12: (triangle, point, 3) from the same in the frame."""
    return np.einsum("vwtq,tqw->tqv", contravariant_to_frame(np.swapaxes(f, 0, 1)), tensor)
