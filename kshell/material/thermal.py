"""What a cross-section does when it warms: by how much it would stretch and bend, and the stresses left in its layers.

A rise of temperature T(z) = m + g z, z the height above the middle of the section, strains a layer alone by a_k T(z).
All layers together, free of forces and moments, take the strain E + z kappa with

    (A E + B kappa, B E + D kappa) = sum over layers of int Q_k a_k T(z) (1, z) dz,

and layer k keeps the stress Q_k (E + z kappa - a_k T(z)), which has no resultant (Reddy 2004, section 3.3).

Symbols
-------
a           expansion (xx, yy, 2 xy), strain per temperature, in the axes of the section
Q, A, B, D  as in `kshell.material.laminate`
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.material.laminate import Laminate
from kshell.material.materials import strain_rotation

Floats = NDArray[np.float64]

NOTHING = 1e-13  # stress left in a layer, against that of a layer held back, that is rounding
COUPLED = (
    1e-9  # strain by bending, against that by stretching, and the other way round, that is more than rounding
)

Expansion = tuple[float, float]


@dataclass(frozen=True)
class Warming:
    """Per unit of m and of g, which are the last axis of all arrays.

    Attributes
    ----------
    strain, curvature : (3, 2)
        E and kappa, shears doubled.
    faces : (3, 3, 2)
        Stress left at the bottom, in the middle and at the top.
    layers : (layer, 2, 3, 2)
        Stress left at the bottom and the top of every layer.
    couples : bool
        Whether a uniform temperature bends it, or a gradient stretches it.
    """

    strain: Floats
    curvature: Floats
    faces: Floats = field(default_factory=lambda: np.zeros((3, 3, 2)))
    layers: Floats = field(default_factory=lambda: np.zeros((0, 2, 3, 2)))
    couples: bool = False


def along_axes(material: Any, angle: float, expansion: Expansion | None) -> Floats | None:
    """a of a material turned by an angle in degrees, or of another expansion along its axes; None where it has none."""
    own = getattr(material, "expansion", None) if expansion is None else expansion
    if own is None:
        return None
    first, second = own if isinstance(own, tuple) else (own, own)
    turned = angle + getattr(material, "angle", 0.0)
    a = np.linalg.solve(strain_rotation(turned), np.array([first, second, 0.0]))
    return a if first != second else np.array([first, first, 0.0])


def of_one_material(a: Floats) -> Warming:
    """Of a section that strains alike at all heights."""
    none = np.zeros(3)
    return Warming(np.stack([a, none], axis=1), np.stack([none, a], axis=1))


def of_layers(stack: Laminate, expansion: Expansion | None) -> Warming:
    """Of a laminate.

    Raises
    ------
    InputError
        If a layer has no expansion.
    """
    found = [along_axes(layer.material, layer.angle, expansion) for layer in stack.layers]
    missing = [k for k, a in enumerate(found) if a is None]
    if missing:
        raise InputError(
            f"layer {missing[0] + 1} of {len(found)} (from the bottom) has no expansion: give it beside E, or one for "
            "all in the load"
        )
    a = np.array(found)
    push = np.einsum("kij,kj->ki", stack.Q, a)
    # sums of Q a times the integrals of 1, z, z^2
    s0, s1, s2 = (np.diff(stack.z**n) / n @ push for n in (1, 2, 3))
    whole = np.block([[stack.A, stack.B], [stack.B, stack.D]])
    both = np.linalg.solve(whole, np.stack([np.append(s0, s1), np.append(s1, s2)], axis=1))
    strain, curvature = both[:3], both[3:]
    if np.all(a == a[0]):  # free of rounding
        return replace(of_one_material(a[0]), layers=np.zeros((len(a), 2, 3, 2)))

    def left(k: int, z: float) -> Floats:
        """(3, 2)"""
        stress = stack.Q[k] @ (strain + z * curvature - np.outer(a[k], [1.0, z]))
        size = np.abs(push).max() * np.array([1.0, stack.thickness])
        stress[np.abs(stress) < NOTHING * size] = 0.0
        return np.asarray(stress)

    count = len(a)
    layers = np.array([[left(k, stack.z[k]), left(k, stack.z[k + 1])] for k in range(count)])
    faces = np.array([layers[0, 0], left(stack.middle_layer, 0.0), layers[-1, 1]])
    stretched, bent = (
        np.abs(part).max(axis=0) * scale for part, scale in ((strain, 1.0), (curvature, stack.thickness))
    )
    couples = bool(bent[0] > COUPLED * stretched[0] or stretched[1] > COUPLED * bent[1])
    return Warming(strain, curvature, faces, layers, couples)
