"""Stresses in the layers of a laminate, from the forces in its cross-section.

Classical lamination theory (Reddy 2004, section 3.3): E and kappa from N and M, then the plane stress of each layer;
transverse shear stresses from equilibrium (`kshell.material.transverse`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.material.laminate import Laminate
from kshell.material.materials import strain_rotation
from kshell.material.tensors import von_mises

Floats = NDArray[np.float64]


def ply_stresses(
    stack: Laminate,
    N: Floats,
    M: Floats,
    shear: Floats | None = None,
    offset: float = 0.0,
    left: Floats | None = None,
) -> list[dict[str, Any]]:
    """Stresses at the bottom and the top of every layer, from the bottom up.

    Parameters
    ----------
    stack : Laminate
    N, M : (3,)
        Forces and moments per length, xx, yy, xy, about a surface `offset` below the middle of the stack.
    shear : (2,), optional
        Shear forces Q_x, Q_y per length.
    left : (layer, 2, 3), optional
        Stresses besides at the bottom and the top of every layer, without resultant.

    Returns
    -------
    list of dict
        z (2,) heights of bottom and top above the middle; stress_bottom, stress_top (3,) xx, yy, xy; the same along the
        axes of the material as material_bottom, material_top (11, 22, 12); with shear forces shear_bottom, shear_top
        (2,) xz, yz; utilisation where the material has a yield stress.
    """
    stresses = stresses_of_layers(stack, N[None], M[None], offset)[0]
    if left is not None:
        stresses = stresses + left
    out = []
    for k, layer in enumerate(stack.layers):
        found: dict[str, Any] = {"z": stack.z[k : k + 2].copy()}
        turn = np.linalg.inv(strain_rotation(layer.angle + getattr(layer.material, "angle", 0.0))).T
        worst = 0.0
        for side, (face, z) in enumerate(zip(("bottom", "top"), stack.z[k : k + 2], strict=True)):
            stress = stresses[k, side]
            found[f"stress_{face}"] = stress
            found[f"material_{face}"] = turn @ stress
            if shear is not None:
                found[f"shear_{face}"] = stack.shear.profile(k, float(z)) @ shear
            worst = max(worst, float(von_mises(stress)))
        limit = getattr(layer.material, "yield_stress", None)
        if limit is not None:
            found["utilisation"] = worst / float(limit)
        out.append(found)
    return out


def stresses_of_layers(stack: Laminate, N: Floats, M: Floats, offset: float = 0.0) -> Floats:
    """(n, layer, 2, 3) stresses at the bottom and the top of every layer, from N and M (n, 3)."""
    B = stack.B + offset * stack.A
    D = stack.D + 2.0 * offset * stack.B + offset**2 * stack.A
    whole = np.block([[stack.A, B], [B, D]])
    both = np.linalg.solve(whole, np.concatenate([N, M], axis=1).T).T
    strain, curvature = both[:, None, None, :3], both[:, None, None, 3:]
    z = offset + np.stack([stack.z[:-1], stack.z[1:]], axis=1)  # (layer, 2)
    return np.einsum("kij,nksj->nksi", stack.Q, strain + z[..., None] * curvature)
