"""Loads that change faster inside triangles than they are integrated: what their resultants miss, in words.

The elements integrate loads by rules that are exact for polynomials of a degree. Where a load jumps or peaks inside a
triangle, the same rule on the four parts of the triangle gives another value: the difference is about the error.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.elements.quadrature import triangle_rule
from kshell.mesh.mesh import Mesh
from kshell.scene.loads import InitialCurvature, InitialStrain, Load, Temperature
from kshell.scene.normals import beside
from kshell.values.varying import is_constant

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Rule = tuple[Floats, Floats]  # barycentric coordinates (q, 3) and weights (q,)

DEGREE = 6  # of the rules of the elements, at least
ROUGH = 1e-3  # of the load, from which it is said
MOST = 20_000  # triangles that are looked at together

# rules of one point and of three, exact for degrees 1 and 2
CENTRE: Rule = np.full((1, 3), 1 / 3), np.array([1 / 2])
THREE: Rule = np.full((3, 3), 1 / 6) + 0.5 * np.eye(3), np.full(3, 1 / 6)

# corners of the four parts of a triangle, in its barycentric coordinates
PARTS = 0.5 * np.array(
    [
        [[2, 0, 0], [1, 1, 0], [1, 0, 1]],
        [[1, 1, 0], [0, 2, 0], [0, 1, 1]],
        [[1, 0, 1], [0, 1, 1], [0, 0, 2]],
        [[1, 1, 0], [0, 1, 1], [1, 0, 1]],
    ]
)


def rough_words(load: Load, space: Mesh, triangles: Ints) -> str:
    """What the resultant and the moments of a load on triangles miss, in words; nothing where that is little."""
    if isinstance(load, Temperature | InitialCurvature | InitialStrain) or load.dimensions != (2,):
        return ""
    if all(is_constant(getattr(load, key, 0.0)) for key in load.scaling):
        return ""
    if _differ(load, space, triangles, CENTRE, THREE, each=True) < ROUGH:
        return ""  # in every triangle coarse rules agree, as they mostly do on fine meshes: no need of finer ones
    inner, shares = triangle_rule(DEGREE)
    places = np.column_stack([1.0 - inner.sum(axis=1), inner])
    parts = np.einsum("qk,pkb->pqb", places, PARTS).reshape(-1, 3), np.tile(shares, len(PARTS)) / len(PARTS)
    missed = _differ(load, space, triangles, (places, shares), parts)
    if missed < ROUGH:
        return ""
    return (
        f"{load} changes faster inside triangles than it is integrated: about {float(f'{100 * missed:.1g}'):g} % of it "
        "are missed or added; let edges of the mesh follow its jumps, or make triangles smaller there"
    )


def _differ(load: Load, space: Mesh, triangles: Ints, coarse: Rule, fine: Rule, each: bool = False) -> float:
    """What two rules differ by, over the integral of the size of the load.

    Parameters
    ----------
    each : bool
        Whether forces of single triangles are compared, instead of the resultant and the moments of all.
    """
    corners = space.points[space.triangles[triangles]]
    centre, size = corners.mean(axis=(0, 1)), float(np.ptp(corners, axis=(0, 1)).max())
    difference, gross = np.zeros(1), 0.0
    for begin in range(0, len(corners), MOST):
        some = corners[begin : begin + MOST]
        area = np.linalg.norm(np.cross(some[:, 1] - some[:, 0], some[:, 2] - some[:, 0]), axis=1)
        forces = np.zeros((len(some), 1))
        for sign, (places, shares) in ((-1.0, coarse), (1.0, fine)):
            at = np.einsum("qb,nbi->nqi", places, some)
            force = (
                _values(load, space, triangles[begin : begin + MOST], at)
                * (area[:, None] * shares)[..., None]
            )
            gross += float(np.abs(force).sum())
            if each:
                forces = forces + sign * force.sum(axis=1)
                continue
            arm = np.concatenate([np.ones((*at.shape[:2], 1)), (at - centre) / size], axis=2)
            difference = difference + sign * np.einsum("nqc,nqm->cm", force, arm)
        if each:
            difference = difference + np.abs(forces).sum()
    return 2.0 * float(np.abs(difference).max()) / gross if gross > 0.0 else 0.0


def _values(load: Any, space: Mesh, triangles: Ints, points: Floats) -> Floats:
    """(triangle, point, component)."""
    places = points
    if getattr(load, "needs_normal", False):
        flat = beside(space, triangles, points.reshape(-1, 3))
        places = flat.reshape(*points.shape[:2], 6)
    values = load.at(places)
    return values if values.ndim == 3 else values[..., None]
