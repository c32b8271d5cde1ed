"""A motion at one time, and what its next step needs of the one before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.problem import State

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Before:
    """The motion one step earlier.

    Attributes
    ----------
    x, velocity : (unknowns,)
    step : float
        Time between the two.
    """

    x: Floats
    velocity: Floats
    step: float


@dataclass(frozen=True)
class Motion:
    """A structure in motion at one time.

    Attributes
    ----------
    time : float
    state : State
    velocity, acceleration : (unknowns,)
        Zero where there is no mass; the acceleration is that of the scheme.
    force : (unknowns,)
        Loads and contact less internal forces and damping; zero where there is no mass.
    load : (unknowns,)
    damping : (unknowns,)
        Forces of drag and of a viscous material, against the motion.
    contact : (unknowns,)
        Forces of what the shell touches.
    strain_energy : float
        That of springs with it.
    strain : (triangle, r)
        Less initial ones.
    before : Before, optional
    """

    time: float
    state: State
    velocity: Floats
    acceleration: Floats
    force: Floats
    load: Floats
    damping: Floats
    contact: Floats
    strain_energy: float
    strain: Floats
    before: Before | None = None

    @property
    def x(self) -> Floats:
        """(unknowns,)."""
        return self.state.x
