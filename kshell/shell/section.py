"""The cross-section of a shell: membrane, coupling and bending stiffness, one set or one per triangle.

Symbols
-------
E, kappa   membrane strain and change of curvature in an orthonormal frame, as (11, 22, 2 12); the strain at
           the height z towards the normal is E + z kappa, so kappa is minus the change of b = n . x,ab
N, M       membrane forces and moments, N = A E + B kappa, M = B E + D kappa; M > 0 puts the top in tension
A, B, D    integrals of the plane-stress stiffness Q over the thickness, with weights 1, z, z^2
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError

Floats = NDArray[np.float64]
Varying = Callable[[NDArray[np.integer], Floats], tuple[Floats, Floats, Floats]]


@dataclass(frozen=True)
class Section:
    """Stiffness of the cross-section in its material axes.

    Attributes
    ----------
    membrane, coupling, bending : (1 or triangle, 3, 3)
        A, B, D: force per length, force, force times length.
    angle : (1 or triangle,)
        From the reference direction to the first material axis, in radians, positive about the normal.
    direction : (3,), (triangle, 3) or None
        Reference direction in space, projected onto the surface. None, or NaN: the global x, or y where x is normal.
    varying : function, optional
        A, B, D (triangle, point, 3, 3) at points (triangle, point, 3) of triangles, where they vary inside triangles;
        the arrays above are means then.
    """

    membrane: Floats
    coupling: Floats
    bending: Floats
    angle: Floats
    direction: Floats | None = None
    varying: Varying | None = None

    def direction_of(self, triangles: slice | NDArray) -> Floats | None:
        """The reference direction of triangles: one for all (3,), or one each (n, 3)."""
        several = self.direction is not None and self.direction.ndim == 2
        return self.direction[triangles] if several and self.direction is not None else self.direction

    @classmethod
    def from_stiffness(
        cls,
        membrane: ArrayLike,
        bending: ArrayLike,
        coupling: ArrayLike | None = None,
        angle: ArrayLike = 0.0,
        direction: ArrayLike | None = None,
    ) -> Section:
        """From A, D and B (zero if absent), each (3, 3) or (triangle, 3, 3).

        Raises
        ------
        InputError
            If the energy of the section is not positive for every strain.
        """
        a, d = (np.asarray(m, dtype=float).reshape(-1, 3, 3) for m in (membrane, bending))
        b = np.zeros((1, 3, 3)) if coupling is None else np.asarray(coupling, dtype=float).reshape(-1, 3, 3)
        count = max(len(a), len(b), len(d))
        a, b, d = (np.broadcast_to(m, (count, 3, 3)) for m in (a, b, d))
        # scaled to the same units: the thickness is of the order sqrt(12 D / A)
        height = np.sqrt(np.trace(d, axis1=1, axis2=2) / np.trace(a, axis1=1, axis2=2))[:, None, None]
        whole = np.concatenate(
            [np.concatenate([a, b / height], axis=2), np.concatenate([b / height, d / height**2], axis=2)],
            axis=1,
        )
        least = np.linalg.eigvalsh(0.5 * (whole + whole.swapaxes(1, 2)))[:, 0]
        if not np.all(least > 0):
            raise InputError(
                "the section has no positive stiffness: check the elastic constants, the thickness and the layers"
            )
        return cls(
            a,
            b,
            d,
            np.atleast_1d(np.asarray(angle, float)),
            None if direction is None else np.asarray(direction, float),
        )

    @classmethod
    def from_plane_stress(
        cls,
        stiffness: ArrayLike,
        thickness: ArrayLike,
        offset: ArrayLike = 0.0,
        angle: ArrayLike = 0.0,
        direction: ArrayLike | None = None,
    ) -> Section:
        """One material through the thickness.

        Parameters
        ----------
        stiffness : (3, 3)
            Plane-stress stiffness Q: stress = Q (e11, e22, 2 e12).
        thickness : float or (triangle,)
        offset : float or (triangle,)
            Height of the middle of the material above the meshed surface, towards the normal.
        """
        q = np.asarray(stiffness, dtype=float)
        t = np.atleast_1d(np.asarray(thickness, dtype=float))
        if not np.all(t > 0):
            raise InputError(f"the thickness must be positive, not {t.min():g}")
        t = t[:, None, None]
        z = np.atleast_1d(np.asarray(offset, dtype=float))[:, None, None]
        return cls.from_stiffness(t * q, (t**3 / 12 + t * z**2) * q, t * z * q, angle, direction)

    @classmethod
    def isotropic(
        cls, young: float, poisson: float, thickness: ArrayLike, offset: ArrayLike = 0.0
    ) -> Section:
        """Isotropic material; `young` in force per area."""
        shear = 0.5 * (1 - poisson)
        q = young / (1 - poisson**2) * np.array([[1, poisson, 0], [poisson, 1, 0], [0, 0, shear]])
        return cls.from_plane_stress(q, thickness, offset)


def section_at(
    section: Section, triangles: slice | NDArray, points: Callable[[], Floats]
) -> tuple[Floats, Floats, Floats, Floats]:
    """A, B, D (triangle or 1, point or 1, 3, 3) and angle (triangle or 1, 1) of triangles.

    Parameters
    ----------
    points : function
        Gives the places (triangle, point, 3) in space; asked where the section varies inside triangles.
    """
    angle = section.angle[triangles] if len(section.angle) > 1 else section.angle
    if section.varying is not None:
        number = np.arange(triangles.stop)[triangles] if isinstance(triangles, slice) else triangles
        return *section.varying(number, points()), angle[:, None]
    a, b, d = (
        m[triangles] if len(m) > 1 else m for m in (section.membrane, section.coupling, section.bending)
    )
    return a[:, None], b[:, None], d[:, None], angle[:, None]
