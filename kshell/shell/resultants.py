"""Membrane forces and moments at points of triangles, and the rotations there: what both discretisations recover.

The frame of all tensors: e_1 is the projection of the global x on the tangent plane (of y where x is
normal), e_2 = n x e_1, and tensors are listed 11, 22, 12.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.shell.frames import contravariant_to_frame, tangent_frame
from kshell.shell.section import Section, section_at
from kshell.shell.vectors import cross, dot, norm

Floats = NDArray[np.float64]


class Resultants(NamedTuple):
    """What the cross-section carries at points of triangles; arrays are (triangle, point, ...).

    Attributes
    ----------
    position : (..., 3)
    axes : (..., 3, 3)
        Rows e_1, e_2, n of the frame.
    membrane_force, moment : (..., 3)
        N and M in the frame: force per length, and moment per length, positive with the top in tension.
    strain, curvature : (..., 3)
        Elastic E and kappa in the *material* axes, the shear components doubled.
    to_frame : (..., 3, 3)
        Matrix that takes a tensor 11, 22, 12 from the material axes to the frame.
    """

    position: Floats
    axes: Floats
    membrane_force: Floats
    moment: Floats
    strain: Floats
    curvature: Floats
    to_frame: Floats

    def stress(self, stiffness: ArrayLike, height: ArrayLike) -> Floats:
        """Stress (..., 3) in the frame at a height above the meshed surface.

        Parameters
        ----------
        stiffness : (3, 3) or (triangle, 1, 3, 3)
            Plane-stress stiffness of the material there, in the material axes of the section.
        height : float or (triangle, 1)
        """
        z = np.asarray(height, dtype=float)[..., None]
        stress = np.asarray(stiffness, dtype=float) @ (self.strain + z * self.curvature)[..., None]
        return (self.to_frame @ stress)[..., 0]


def resultants_in_frame(
    section: Section, chosen: NDArray, position: Floats, x: Floats, e: Floats, kappa: Floats, moment: Floats
) -> Resultants:
    """Strains and moments in the material axes, turned into the frame of the results."""
    a, b, _, angle = section_at(section, chosen, lambda: position)
    force = a @ e[..., None] + b @ kappa[..., None]
    e1, e2, _ = tangent_frame(x, section.direction, angle)
    axes = np.stack(tangent_frame(x))
    turn = np.stack([np.stack([dot(axes[i], e1), dot(axes[i], e2)]) for i in range(2)])
    to_frame = np.moveaxis(contravariant_to_frame(turn), (0, 1), (2, 3))
    return Resultants(
        position=position,
        axes=np.moveaxis(axes, (0, 1), (2, 3)),
        membrane_force=(to_frame @ force)[..., 0],
        moment=(to_frame @ moment[..., None])[..., 0],
        strain=e,
        curvature=kappa,
        to_frame=to_frame,
    )


def finite_rotation(before: Floats, after: Floats) -> Floats:
    """Rotation vectors (triangle, point, 3) of the polar decomposition that takes tangents and normal to the new ones.

    Parameters
    ----------
    before, after : (2, 3, triangle, point)
        Tangents at rest and in the state.
    """
    from scipy.spatial.transform import Rotation

    frames = []
    for x in (before, after):
        normal = cross(x[0], x[1])
        frames.append(np.moveaxis(np.stack([x[0], x[1], normal / norm(normal)]), (0, 1), (3, 2)))
    gradient = frames[1] @ np.linalg.inv(frames[0])
    left, _, right = np.linalg.svd(gradient)
    vectors = Rotation.from_matrix((left @ right).reshape(-1, 3, 3)).as_rotvec()
    return np.asarray(vectors).reshape(gradient.shape[:3])
