"""Membrane forces and moments at points of triangles, and the rotations there: what both discretisations recover.

The frame of all tensors: e_1 is the projection of the global x on the tangent plane (of y where x is
normal), e_2 = n x e_1, and tensors are listed 11, 22, 12.

The force in a cut is not what the strain works against. With N_K conjugate to the membrane strain, M to kappa =
-(b - B), the force per length of rest through a cut with the unit conormal nu in the surface is

    nu_i (N_ij e_j + Q_i n),   N_ij = N_K,ij - M_ik b_kj,   Q_i = M_ij|j

(virtual work of kappa, by parts: P. M. Naghdi, Handbuch der Physik VIa/2 (1972) 425-640, section 15), b > 0 where the
surface bends towards its normal; N_12 and N_21 differ, so that with the moments the balance about the normal holds.
Under large deflections b is that of the deformed surface, its second index raised by the deformed metric.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.shell.frames import components, contravariant_to_frame, covariant_to_frame, tangent_frame
from kshell.shell.section import Section, section_at
from kshell.shell.vectors import cross, dot, norm

Floats = NDArray[np.float64]


_FULL = np.array([[0, 2], [2, 1]])  # places of 11, 22, 12 in the full tensor


class Resultants(NamedTuple):
    """What the cross-section carries at points of triangles; arrays are (triangle, point, ...).

    Attributes
    ----------
    position : (..., 3)
    axes : (..., 3, 3)
        Rows e_1, e_2, n of the frame.
    membrane_stress_resultant, moment : (..., 3)
        N_K and M in the frame: force per length, and moment per length, positive with the top in tension.
    bend : (..., 2, 2)
        b_kj in the frame.
    strain, curvature : (..., 3)
        Elastic E and kappa in the *material* axes, the shear components doubled.
    to_frame : (..., 3, 3)
        Matrix that takes a tensor 11, 22, 12 from the material axes to the frame.
    """

    position: Floats
    axes: Floats
    membrane_stress_resultant: Floats
    moment: Floats
    bend: Floats
    strain: Floats
    curvature: Floats
    to_frame: Floats

    @property
    def section_force(self) -> Floats:
        """(..., 2, 2) N_ij, the force along e_j in a cut with the conormal e_i; not symmetric."""
        n, m = (tensor[..., _FULL] for tensor in (self.membrane_stress_resultant, self.moment))
        return np.asarray(n - m @ self.bend)

    @property
    def membrane_force(self) -> Floats:
        """(..., 3) the symmetric part of N_ij."""
        n = self.section_force
        return np.stack([n[..., 0, 0], n[..., 1, 1], 0.5 * (n[..., 0, 1] + n[..., 1, 0])], axis=-1)

    def stress(
        self, strained: Floats, curved: Floats, middle: ArrayLike, left: Floats | None = None
    ) -> Floats:
        """Stress (..., 3) in the frame.

        Parameters
        ----------
        strained, curved : (..., 3, 3)
            Stress of a strain of the middle of the material, and of a change of curvature, in the material axes.
        middle : float or (triangle, 1)
            Height of the middle of the material above the meshed surface.
        left : (..., 3), optional
            Stress besides, in the material axes.
        """
        z = np.asarray(middle, dtype=float)[..., None]
        stress = strained @ (self.strain + z * self.curvature)[..., None] + curved @ self.curvature[..., None]
        if left is not None:
            stress = stress + left[..., None]
        return (self.to_frame @ stress)[..., 0]


def resultants_in_frame(
    section: Section,
    chosen: NDArray,
    position: Floats,
    x: Floats,
    e: Floats,
    kappa: Floats,
    moment: Floats,
    second_form: Floats,
    stretched: Floats | None = None,
) -> Resultants:
    """Strains and moments in the material axes, turned into the frame of the results.

    Parameters
    ----------
    x : (2, 3, triangle, point)
        Tangents at rest.
    e, kappa, moment : (triangle, point, 3)
    second_form : (3, triangle, point)
        b_11, b_22, b_12 along the element coordinates.
    stretched : (3, triangle, point), optional
        All of the membrane strain along the element coordinates, where deflections are large.
    """
    a, b, _, angle = section_at(section, chosen, lambda: position)
    force = a @ e[..., None] + b @ kappa[..., None]
    e1, e2, _ = tangent_frame(x, section.direction_of(chosen), angle)
    axes = np.stack(tangent_frame(x))
    turn = np.stack([np.stack([dot(axes[i], e1), dot(axes[i], e2)]) for i in range(2)])
    to_frame = np.moveaxis(contravariant_to_frame(turn), (0, 1), (2, 3))
    return Resultants(
        position=position,
        axes=np.moveaxis(axes, (0, 1), (2, 3)),
        membrane_stress_resultant=(to_frame @ force)[..., 0],
        moment=(to_frame @ moment[..., None])[..., 0],
        bend=_bend(x, axes, second_form, stretched),
        strain=e,
        curvature=kappa,
        to_frame=to_frame,
    )


def _bend(x: Floats, axes: Floats, second_form: Floats, stretched: Floats | None) -> Floats:
    """(triangle, point, 2, 2) b in the frame, its second index raised by the deformed metric."""
    to_frame = covariant_to_frame(components(x, axes[0], axes[1]))

    def full(tensor: Floats) -> Floats:
        t11, t22, twice = np.einsum("vwtp,wtp->vtp", to_frame, tensor)
        return np.moveaxis(
            np.stack([np.stack([t11, 0.5 * twice]), np.stack([0.5 * twice, t22])]), (0, 1), (2, 3)
        )

    b = full(second_form)
    return b if stretched is None else b @ np.linalg.inv(np.eye(2) + 2 * full(stretched))


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
