"""How alike the modes of two results are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.closest import Locator
from kshell.result.result import Result

Floats = NDArray[np.float64]

# vertices of two meshes that lie closer, against the size, are the same
SAME = 1e-9


def mac(a: Result, b: Result) -> Floats:
    """Modal assurance criterion: (modes of a, modes of b), 1 for equal shapes, 0 for unlike ones.

    |x . y|^2 / (x . x y . y) with the displacements x of a and y of b at the vertices of the mesh of a, each weighed
    by its share of the area; those of b are interpolated where its mesh is another one.

    Source: R. J. Allemang, "The modal assurance criterion", Sound and Vibration 37 (2003) 14-21.

    Parameters
    ----------
    a, b : Result
        Of modes or buckling.

    Raises
    ------
    InputError
        If one has no modes, or the meshes lie apart.
    """
    x, y = _shapes(a, "first"), _shapes(b, "second")
    if len(a.mesh.points) != len(b.mesh.points) or (
        np.abs(a.mesh.points - b.mesh.points).max() > SAME * a.mesh.size
    ):
        y = _at(b, y, a)
    share = np.bincount(a.mesh.triangles.ravel(), np.repeat(a.mesh.areas, 3), len(a.mesh.points))
    heavy = x * share[:, None]
    own_x, own_y = (np.einsum("kvc,v,kvc->k", z, share, z) for z in (x, y))
    both = np.einsum("ivc,jvc->ij", heavy, y)
    return np.asarray(both**2 / np.outer(own_x, own_y))


def _shapes(result: Result, which: str) -> Floats:
    """(mode, vertex, 3)."""
    names = [f"mode_{k}" for k in range(1, len(result.eigen) + 1)]
    if not names or any(name not in result.fields for name in names):
        raise InputError(
            f"mac: the {which} result has no modes: make it with kshell.modes(scene) or kshell.buckling(scene)"
        )
    return np.array([result.fields[name] for name in names])


def _at(b: Result, y: Floats, a: Result) -> Floats:
    """Shapes of b at the vertices of a."""
    mesh = b.mesh
    found = Locator.of(mesh).find(a.mesh.points)
    far = float(found.distance.max())
    if far > 0.05 * a.mesh.size:
        raise InputError(
            f"mac: the meshes of the two results lie apart, by {far:.3g}: they must be of one structure"
        )
    weight = np.column_stack([1 - found.xi.sum(axis=1), found.xi])
    return np.asarray(np.einsum("vk,mvkc->mvc", weight, y[:, mesh.triangles[found.triangles]]))
