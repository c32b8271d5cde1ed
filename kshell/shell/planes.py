"""Planes that supported edges lie in: of symmetry, of a diaphragm."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError

Floats = NDArray[np.float64]

# how far from its plane, against its size, a symmetric or stiffened edge may lie
PLANAR = 1e-3


def plane_normal(
    x: Floats, what: str, normal: ArrayLike | None, line: Callable[[], Floats] | None = None
) -> Floats:
    """Unit normal of the plane through points (n, 3), which must lie in it.

    Parameters
    ----------
    x : (n, 3)
    what : str
        For messages, "a diaphragm".
    normal : (3,), optional
        Given by the user.
    line : function, optional
        Gives the normal (3,) where the points form a straight line, which lies in many planes.

    Raises
    ------
    InputError
        If the points lie in no plane, or form a straight line and neither `normal` nor `line` is given.
    """
    if normal is not None:
        axis = np.asarray(normal, dtype=float) / np.linalg.norm(normal)
    else:
        _, size, rows = np.linalg.svd(x - x.mean(axis=0), full_matrices=False)
        if len(size) > 2 and size[1] > PLANAR * size[0]:
            axis = rows[2]
        elif line is not None:
            axis = line()
        else:
            raise InputError(f"{what}: the edges form a straight line: give the normal of the plane")
    return axis


def require_plane(x: Floats, axis: Floats, what: str) -> None:
    """Raise InputError where points (n, 3) lie in no plane with the unit normal `axis`."""
    height = (x - x.mean(axis=0)) @ axis
    worst = int(np.argmax(np.abs(height)))
    size = float(np.linalg.norm(np.ptp(x, axis=0)))
    if abs(height[worst]) > PLANAR * size:
        raise InputError(
            f"{what} needs edges in one plane with normal ({axis[0]:.4g}, {axis[1]:.4g}, {axis[2]:.4g}), but "
            f"({x[worst][0]:.6g}, {x[worst][1]:.6g}, {x[worst][2]:.6g}) lies "
            f"{abs(height[worst]):.3g} off the mean: split the group by planes"
        )


def within(axis: Floats) -> Floats:
    """(2, 3) unit vectors in the plane with the unit normal `axis`."""
    directions: Floats = np.linalg.svd(axis[None])[2][1:]
    return directions
