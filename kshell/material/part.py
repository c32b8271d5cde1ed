"""One cross-section: of one material, of layers, or given by its stiffness. Heights count from its middle.

Symbols
-------
t           thickness, an array of any shape; stiffness has that shape in front
A, B, D     stretching, coupling and bending stiffness per length (3, 3)
E, kappa    strain of the middle and change of curvature: the strain at height z is E + z kappa
S           transverse shear stiffness (2, 2)
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.material.given import Section as GivenSection
from kshell.material.laminate import Laminate
from kshell.material.materials import Material, transverse_shear
from kshell.material.thermal import Expansion, Warming, along_axes, of_layers, of_one_material
from kshell.values.varying import is_constant

Floats = NDArray[np.float64]

HOMOGENEOUS_SHEAR = 5.0 / 6.0  # of G t, by the energy of the parabola of shear stresses


class Part(ABC):
    """A cross-section.

    Attributes
    ----------
    what : str
        What its thickness is called in messages.
    thickness : number, expression in x, y, z or callable
    """

    what: str
    thickness: Any

    @property
    def constant(self) -> bool:
        """Whether it is the same everywhere."""
        return is_constant(self.thickness)

    @abstractmethod
    def membrane(self, t: Floats) -> Floats:
        """A."""

    def coupling(self, t: Floats) -> Floats:
        """B."""
        return np.broadcast_to(np.zeros((3, 3)), (*t.shape, 3, 3))

    @abstractmethod
    def bending(self, t: Floats) -> Floats:
        """D."""

    @abstractmethod
    def mass(self, t: Floats) -> Floats:
        """Mass per area."""

    @abstractmethod
    def shear(self, t: Floats) -> Floats | None:
        """S, None where it is not known."""

    @property
    @abstractmethod
    def has_stress(self) -> bool:
        """Whether stresses are known."""

    @abstractmethod
    def stress(self, face: int, t: Floats) -> tuple[Floats, Floats]:
        """(P, R) with the stress P E + R kappa at the bottom (face -1), in the middle (0) and at the top (1)."""

    @property
    @abstractmethod
    def laws(self) -> tuple[Floats, ...]:
        """(3, 3) stiffnesses, the last in proportion to which it bends."""

    @property
    @abstractmethod
    def moduli(self) -> tuple[Floats, ...]:
        """(3, 3) matrices that depend on directions if the section does."""

    @property
    def coupled(self) -> float:
        """Size of B against sqrt(A D)."""
        return 0.0

    def yield_stress(self, face: int) -> float | None:
        """Yield stress at the bottom (face -1), in the middle (0), at the top (1); None where it is not known."""
        return None

    @abstractmethod
    def warming(self, expansion: Expansion | None) -> Warming:
        """What it does when it warms, with its own expansion or with another one along the axes of its material.

        Raises
        ------
        InputError
            If it has none.
        """

    @property
    def materials(self) -> list[Any]:
        """What it is made of, from the bottom up; empty where that is not known."""
        return []


class Homogeneous(Part):
    """One material through the thickness."""

    def __init__(self, what: str, thickness: Any, material: Material) -> None:
        self.what, self.thickness, self.material = what, thickness, material
        self._Q = material.plane_stress()
        self._G = transverse_shear(material)

    def membrane(self, t: Floats) -> Floats:
        return t[..., None, None] * self._Q

    def bending(self, t: Floats) -> Floats:
        return (t**3 / 12.0)[..., None, None] * self._Q

    def mass(self, t: Floats) -> Floats:
        return self.material.density * t

    def shear(self, t: Floats) -> Floats | None:
        return None if self._G is None else HOMOGENEOUS_SHEAR * t[..., None, None] * self._G

    @property
    def has_stress(self) -> bool:
        return True

    def stress(self, face: int, t: Floats) -> tuple[Floats, Floats]:
        return np.broadcast_to(self._Q, (*t.shape, 3, 3)), 0.5 * face * t[..., None, None] * self._Q

    @property
    def laws(self) -> tuple[Floats, ...]:
        return (self._Q,)

    @property
    def moduli(self) -> tuple[Floats, ...]:
        return (self._Q,)

    def yield_stress(self, face: int) -> float | None:
        return getattr(self.material, "yield_stress", None)

    def warming(self, expansion: Expansion | None) -> Warming:
        a = along_axes(self.material, 0.0, expansion)
        if a is None:
            raise InputError("the material has no expansion: give it beside E, or in the load")
        return of_one_material(a)

    @property
    def materials(self) -> list[Any]:
        return [self.material]


class Layered(Part):
    """Layers."""

    def __init__(self, what: str, stack: Laminate) -> None:
        self.what, self.thickness, self.stack = what, stack.thickness, stack

    def membrane(self, t: Floats) -> Floats:
        return np.broadcast_to(self.stack.A, (*t.shape, 3, 3))

    def coupling(self, t: Floats) -> Floats:
        return np.broadcast_to(self.stack.B, (*t.shape, 3, 3))

    def bending(self, t: Floats) -> Floats:
        return np.broadcast_to(self.stack.D, (*t.shape, 3, 3))

    def mass(self, t: Floats) -> Floats:
        return np.full(t.shape, self.stack.mass)

    def shear(self, t: Floats) -> Floats | None:
        return None if self.stack.S is None else np.broadcast_to(self.stack.S, (*t.shape, 2, 2))

    @property
    def has_stress(self) -> bool:
        return True

    def stress(self, face: int, t: Floats) -> tuple[Floats, Floats]:
        Q = (self.stack.bottom, self.stack.middle, self.stack.top)[face + 1]
        return np.broadcast_to(Q, (*t.shape, 3, 3)), 0.5 * face * t[..., None, None] * Q

    @property
    def laws(self) -> tuple[Floats, ...]:
        return self.stack.A, self.stack.D

    @property
    def moduli(self) -> tuple[Floats, ...]:
        return self.stack.bottom, self.stack.middle, self.stack.top

    @property
    def coupled(self) -> float:
        return self.stack.coupling

    def yield_stress(self, face: int) -> float | None:
        layer = self.stack.layers[(0, self.stack.middle_layer, -1)[face + 1]]
        return getattr(layer.material, "yield_stress", None)

    def warming(self, expansion: Expansion | None) -> Warming:
        return of_layers(self.stack, expansion)

    @property
    def materials(self) -> list[Any]:
        return [layer.material for layer in self.stack.layers]


class Given(Part):
    """By its stiffness; stresses are N / t and +- 6 M / t^2, where it has a thickness."""

    def __init__(self, what: str, section: GivenSection) -> None:
        self.what, self.thickness, self.section = what, section.height, section

    def membrane(self, t: Floats) -> Floats:
        return np.broadcast_to(self.section.membrane, (*t.shape, 3, 3))

    def coupling(self, t: Floats) -> Floats:
        return np.broadcast_to(self.section.coupling, (*t.shape, 3, 3))

    def bending(self, t: Floats) -> Floats:
        return np.broadcast_to(self.section.bending, (*t.shape, 3, 3))

    def mass(self, t: Floats) -> Floats:
        return np.full(t.shape, self.section.mass)

    def shear(self, t: Floats) -> Floats | None:
        S = self.section.shear
        return None if S is None else np.broadcast_to(S, (*t.shape, 2, 2))

    @property
    def has_stress(self) -> bool:
        return self.section.thickness is not None

    def stress(self, face: int, t: Floats) -> tuple[Floats, Floats]:
        A, B, D = self.section.membrane, self.section.coupling, self.section.bending
        t = t[..., None, None]
        return A / t + face * 6.0 * B / t**2, B / t + face * 6.0 * D / t**2

    @property
    def laws(self) -> tuple[Floats, ...]:
        return self.section.membrane, self.section.bending

    @property
    def moduli(self) -> tuple[Floats, ...]:
        return self.section.membrane, self.section.bending

    @property
    def coupled(self) -> float:
        size = np.sqrt(np.abs(self.section.membrane).max() * np.abs(self.section.bending).max())
        return float(np.abs(self.section.coupling).max() / size)

    def warming(self, expansion: Expansion | None) -> Warming:
        if expansion is None:
            raise InputError("a section given by its stiffness has no expansion: give it in the load")
        return of_one_material(np.array([*expansion, 0.0]))
