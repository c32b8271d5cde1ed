"""What analyses of finite deformation need of a model."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.model import Solved
from kshell.equilibrium.moving_model import MovingModel
from kshell.errors import InputError
from kshell.result.result import Result

if TYPE_CHECKING:  # small deflections need none of it
    from kshell.equilibrium.problem import Problem, State

Floats = NDArray[np.float64]


class FiniteModel(MovingModel):
    """A model with an energy of finite deformation.

    Attributes
    ----------
    frame : str
        The axes of tensors in its results.
    small_only : str
        Why it is for small deflections of this structure only, in words; empty where it is not.
    """

    frame: str
    small_only: str = ""

    @abstractmethod
    def equilibrium(self) -> Problem:
        """Energy, conditions and loads, all growing with one factor.

        Raises
        ------
        InputError
            If something in the structure has small turns only.
        """

    @abstractmethod
    def near_rest(self) -> Problem:
        """The same for a look at what is near a linear solution, whatever turns by small turns only."""

    def alike(self, near: Problem) -> Problem:
        """That of `near_rest`, with what is known of the stiffness and of the tangents of other load cases."""
        return near

    @property
    def yields(self) -> bool:
        """Whether what a load leaves behind depends on the way it grew."""
        return False

    def contact_surface(self) -> tuple[Floats, NDArray[np.integer]]:
        """(node, 3) places at rest, whose displacements are the first unknowns, and triangles through them.

        Raises
        ------
        InputError
            If the element has none.
        """
        raise InputError(f'contact is not for the element {self.element}: take element = "koiter"')

    @abstractmethod
    def linear_probes(self, solved: Solved) -> dict[str, dict[str, Any]]:
        """Values at the probes of a linear solution, as in `Result.probes`."""

    @abstractmethod
    def recover_state(self, state: State, work: float, inertia: Floats | None = None) -> Result:
        """The result of a state of finite deformation, to which the loads did some work.

        Parameters
        ----------
        inertia : (unknowns,), optional
            Of a motion: forces of inertia and damping, which act as loads.
        """

    @abstractmethod
    def state_probes(self, state: State) -> dict[str, dict[str, Any]]:
        """Values at the probes in a state, as in `Result.probes`."""
