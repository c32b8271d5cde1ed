"""One equilibrium of a shell under large deflections: states, external forces, and the factorised tangent."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.shell.edges import Directors, turn_directors
from kshell.shell.energy import Energy, StrainEnergy
from kshell.shell.factor import Factor, factorise
from kshell.shell.koiter import Koiter
from kshell.shell.supports import Reduction

Floats = NDArray[np.float64]

# x -> force (unknowns,) and its derivative (unknowns, unknowns), at the full load
Follower = Callable[[Floats], tuple[Floats, sp.spmatrix]]


@dataclass(frozen=True)
class Problem:
    """A shell with its supports and loads, which all grow with one factor.

    Attributes
    ----------
    energy : StrainEnergy
    reduction : Reduction
        Its prescribed motion is that at the factor 1.
    load : (unknowns,)
        Dead load at the factor 1.
    follower : callable, optional
        Load that turns with the surface.
    springs : sparse, optional
        Stiffness of elastic supports.
    constant : (unknowns,), optional
        Dead load that does not grow.
    initial : (triangle, r), optional
        Strains without stress at the factor 1.
    """

    energy: StrainEnergy
    reduction: Reduction
    load: Floats
    follower: Follower | None = None
    springs: sp.spmatrix | None = None
    constant: Floats | None = None
    initial: Floats | None = None

    def evaluate(
        self, x: Floats, factor: float, derivatives: int, memory: Any, stress: Floats | None = None
    ) -> tuple[Energy, Floats, Floats]:
        """Energy with the tangent of all forces, the residual (unknowns,), and d(external force)/d(factor)."""
        growth, of_initial = self.load, None
        if self.initial is not None:
            of_initial = self._growth_of_initial(self.initial, x, memory)
            self.energy.initial = factor * self.initial
        energy = self.energy.energy(x, derivatives, memory, stress)
        tangent = energy.hessian
        if self.follower is not None:
            force, stiffness = self.follower(x)
            growth = growth + force
            if tangent is not None:
                tangent = tangent - factor * stiffness
        residual = factor * growth - energy.gradient  # which holds the forces of initial strains already
        if of_initial is not None:
            growth = growth + of_initial
        if self.constant is not None:
            residual = residual + self.constant
        if self.springs is not None:
            residual = residual - self.springs @ x
            tangent = None if tangent is None else tangent + self.springs
        return Energy(energy.value, energy.gradient, tangent), residual, growth

    def _growth_of_initial(self, initial: Floats, x: Floats, memory: Any) -> Floats:
        """Forces are linear in the initial strains: those without less those with them."""
        forces = []
        for share in (0.0, 1.0):
            self.energy.initial = share * initial
            forces.append(self.energy.energy(x, 1, memory).gradient)
        return forces[0] - forces[1]

    def factorise(self, tangent: sp.spmatrix) -> Factor:
        """The tangent in the free unknowns, factorised."""
        return factorise(self.reduction.reduce(tangent), symmetric=self.follower is None)

    def start(self) -> State:
        """The rest state."""
        return State(0.0, np.zeros(self.energy.unknowns), self.energy.rest)

    def settle(self, state: State) -> State:
        """The same state with directors turned."""
        if not isinstance(self.energy, Koiter):
            return state
        x, memory = turn_directors(self.energy.surface, state.memory, state.x, self.reduction.rotations)
        return State(state.factor, x, memory, state.iterations, state.negative)


@dataclass(frozen=True)
class State:
    """A state in equilibrium.

    Attributes
    ----------
    factor : float
        Load factor.
    x : (unknowns,)
        Rotations count from the last turn of the directors.
    memory : Directors or ()
    iterations : int
        Newton iterations spent on the step to it.
    negative : int
        Negative eigenvalues of the tangent stiffness: 0 where the equilibrium is stable.
    """

    factor: float
    x: Floats
    memory: Directors | Any
    iterations: int = 0
    negative: int = 0
