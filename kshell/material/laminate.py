"""Laminates: layers of material stacked from bottom to top.

Symbols (Reddy 2004, section 3.3)
-------
z           height above the middle of the stack; layer k lies between z_k and z_k+1
Q_k         plane-stress stiffness of layer k in global axes
A, B, D     sums over layers of Q_k times the integrals of 1, z, z^2
N, M        forces and moments per length: N = A e - B w'', M = B e - D w'', w'' = (w_xx, w_yy, 2 w_xy)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.material.materials import rotated, transverse_shear
from kshell.material.transverse import TransverseShear
from kshell.mesh.words import shown
from kshell.values.validation import Number, described

Floats = NDArray[np.float64]

# |B| / sqrt(|A| |D|) that rounding of layer thicknesses may leave in a symmetric stack
NEGLIGIBLE_COUPLING = 1e-9


@described("layer")
class Layer:
    """One layer of a laminate.

    Attributes
    ----------
    material : Isotropic, Orthotropic or Anisotropic
    thickness : float [length]
        Of the layer, > 0.
    angle : float [degrees]
        Degrees by which the material is turned about z, counter-clockwise, on top of its own angle.

    Examples
    --------
    ```toml
    [[layer]]
    E1 = 140e9
    E2 = 10e9
    nu12 = 0.3
    G12 = 5e9
    thickness = 0.00125
    angle = 45
    ```
    """

    material: Any
    thickness: Number
    angle: Number = 0.0

    def __post_init__(self) -> None:
        if not hasattr(self.material, "plane_stress"):
            raise InputError(
                f"layer: material = {shown(self.material)} is not a material: give ks.Isotropic(...) or alike"
            )
        if not self.thickness > 0.0:
            raise InputError(f"layer: thickness = {self.thickness:g} must be > 0")

    def plane_stress(self) -> Floats:
        """(3, 3) stiffness in global axes."""
        return rotated(self.material.plane_stress(), self.angle)

    def transverse_shear(self) -> Floats | None:
        """(2, 2) transverse shear stiffness in global axes, None where it is not known."""
        G = transverse_shear(self.material)
        if G is None:
            return None
        c, s = np.cos(np.deg2rad(self.angle)), np.sin(np.deg2rad(self.angle))
        turn = np.array([[c, -s], [s, c]])
        return turn @ G @ turn.T


@dataclass(frozen=True)
class Laminate:
    """Stiffness of a stack.

    Attributes
    ----------
    A, B, D : (3, 3) array
        Stretching, coupling and bending stiffness per length.
    thickness : float
    mass : float
        Mass per area.
    bottom, middle, top : (3, 3) array
        Plane-stress stiffness of the outermost layers, and of the layer at the middle of the stack (the upper
        one where two layers meet there).
    z : (layer + 1,) array
        Heights of the interfaces above the middle.
    Q : (layer, 3, 3) array
        Plane-stress stiffness of the layers.
    G : list of (2, 2) arrays or None
        Transverse shear stiffness of the layers; None where that of one is not known.
    layers : tuple of Layer
        As given.
    middle_layer : int
        The number of that at the middle.
    """

    A: Floats
    B: Floats
    D: Floats
    thickness: float
    mass: float
    bottom: Floats
    middle: Floats
    top: Floats
    z: Floats
    Q: Floats
    G: list[Floats] | None
    layers: tuple[Layer, ...]
    middle_layer: int

    @cached_property
    def shear(self) -> TransverseShear:
        """Shear stresses between the layers."""
        return TransverseShear(self.z, self.Q)

    @cached_property
    def S(self) -> Floats | None:
        """(2, 2) transverse shear stiffness; None where that of a layer is not known."""
        return None if self.G is None else self.shear.stiffness(self.G)

    @property
    def coupling(self) -> float:
        """Size of B against sqrt(A D): 0 for a stack that is symmetric about its middle."""
        size = np.sqrt(np.abs(self.A).max() * np.abs(self.D).max())
        return float(np.abs(self.B).max() / size)


def laminate(layers: Sequence[Layer]) -> Laminate:
    """Stiffness of layers stacked bottom to top, about the middle of the stack."""
    if not layers:
        raise InputError("layers: the list is empty: give at least one layer")
    thicknesses = np.array([layer.thickness for layer in layers])
    total = thicknesses.sum()
    z = np.concatenate([[0.0], np.cumsum(thicknesses)]) - 0.5 * total
    Q = np.stack([layer.plane_stress() for layer in layers])  # (layer, 3, 3)
    A, B, D = (np.tensordot(np.diff(z**k) / k, Q, axes=1) for k in (1, 2, 3))
    mass = sum(layer.material.density * layer.thickness for layer in layers)
    middle = min(int(np.searchsorted(z, 1e-9 * total, side="right")) - 1, len(Q) - 1)
    shears = [layer.transverse_shear() for layer in layers]
    known = [G for G in shears if G is not None]
    G = known if len(known) == len(layers) else None
    return Laminate(
        A, B, D, float(total), float(mass), Q[0], Q[middle], Q[-1], z, Q, G, tuple(layers), middle
    )


def require_symmetric(coupling: float) -> None:
    """Raise InputError if bending stretches a section: a plate model has no stretching.

    Parameters
    ----------
    coupling : float
        Size of B against sqrt(A D).

    Raises
    ------
    InputError
        If B is not zero.
    """
    if coupling > NEGLIGIBLE_COUPLING:
        raise InputError(
            f"layers: the laminate is not symmetric about its middle, so bending stretches it "
            f"(|B| / sqrt(|A| |D|) = {coupling:.2g}, must be 0); plates in pure bending need "
            "a symmetric one: mirror the layers about the middle, e.g. 0 / 90 / 90 / 0"
        )
