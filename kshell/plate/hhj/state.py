"""What acts on a plate of order p, and its answer, on the local unknowns of triangles."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Spring:
    """Springs in triangles: energy |rows u|^2 / 2 of local unknowns u.

    Attributes
    ----------
    triangles : (n,) int array
        A triangle may occur more than once.
    rows : (n, r, m) array
        Roots of stiffness times weight are part of them.
    label : str
        Of the support; several may have the same.
    """

    triangles: Ints
    rows: Floats
    label: str = ""

    def forces(self, u: Floats) -> Floats:
        """(n, m) what the springs resist local unknowns (T, m) with."""
        stretch = (self.rows @ u[self.triangles][..., None])[..., 0]
        return (stretch[:, None] @ self.rows)[:, 0]


@dataclass
class Load:
    """A load on local unknowns.

    Attributes
    ----------
    local : (T, m) array
    vertices : (vertex,) array
        Point forces.
    initial : (T, 3, k) array or None
        Scaled strains that the plate takes up without moments (initial curvature).
    """

    local: Floats
    vertices: Floats
    initial: Floats | None = None


@dataclass(frozen=True)
class HHJSolution:
    """A solution of order p.

    Attributes
    ----------
    unknowns : (count,) array
        Of the vertices and edges, see `Numbering`.
    local : (T, m) array
    strains : (T, 3, k) array
        l, less the initial ones.
    moments : (T, k, 3) array
        Coefficients of m = C kappa (xx, yy, xy) in psi; bending moments are M = -m.
    load : Load
    work : float
        Of the load on the whole deflection: twice the strain energy where nothing else acts.
    corrections : tuple of float
        Energy norm of the steps of refinement, relative to the first one, the solution itself.
    """

    unknowns: Floats
    local: Floats
    strains: Floats
    moments: Floats
    load: Load
    work: float
    corrections: tuple[float, ...] = field(default=())
