"""What a motion in time needs of a model: all unknowns, those that supports hold too, and what stands for inertia."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import ClassVar, Self

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.model import Model
from kshell.equilibrium.oscillator import Oscillator
from kshell.errors import InputError
from kshell.result.result import Result
from kshell.scene.structure import Structure

Floats = NDArray[np.float64]


class MovingModel(Model):
    """A model of which small motions in time are computed.

    Attributes
    ----------
    nodal : bool
        Whether its unknowns are displacements of nodes, and rotations without mass.
    """

    nodal: ClassVar[bool] = False

    @abstractmethod
    def oscillator(self) -> Oscillator:
        """Matrices of all unknowns x, with loads and prescribed motion; matrices are shared with `loaded` copies.

        Raises
        ------
        InputError
            If something in the structure does not move in time.
        """

    @abstractmethod
    def loaded(self, structure: Structure, factor: float = 1.0) -> Self:
        """The same under the loads and prescribed motions of a structure that differs in nothing else, times a factor.

        Matrices, factorisations and tables that do not depend on loads are shared.
        """

    @abstractmethod
    def full_mass(self) -> sp.csr_matrix:
        """Consistent mass matrix of all unknowns x; zero without density."""

    @property
    @abstractmethod
    def thickness(self) -> float:
        """A typical thickness."""

    @abstractmethod
    def probe_row(self, name: str, component: str) -> Floats:
        """(unknowns,) whose product with x is the displacement of a probe along "x", "y" or "z".

        Raises
        ------
        InputError
            If there is no such probe.
        """

    def displaced(self, displacement: Callable[[Floats], Floats]) -> Floats:
        """(unknowns,) of a displacement (n, 3) given at places (n, 3), where unknowns are those of nodes.

        Rotations are left at zero.

        Raises
        ------
        InputError
            If the element takes none.
        """
        raise InputError(
            f"initial displacements with large deflections are not for the element {self.element}: take "
            'element = "koiter"'
        )

    @abstractmethod
    def rigid_motions(self, x: Floats) -> Floats:
        """(unknowns, 6): unit translations, and turns about axes through the origin of the structure moved by x."""

    @abstractmethod
    def recover_motion(self, x: Floats, work: float, inertia: Floats) -> Result:
        """The result of small deflections x in motion, to which the loads did some work.

        Parameters
        ----------
        inertia : (unknowns,)
            Forces of inertia and damping, which act as loads.
        """

    @abstractmethod
    def fingerprint(self) -> str:
        """Tells models apart: mesh, supports, loads and stiffness."""
