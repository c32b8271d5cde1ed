"""One equilibrium under finite deformation: states, external forces, and the factorised tangent."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Protocol, Self

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.energy import Put, StrainEnergy
from kshell.equilibrium.evaluated import Energy
from kshell.equilibrium.factor import Factoriser
from kshell.equilibrium.reduction import Reduction
from kshell.equilibrium.sparsity import Added
from kshell.solvers.repeated import Factor

Floats = NDArray[np.float64]

# part of the largest entry of the tangent of a load that may differ from the entry across the diagonal
SYMMETRIC = 1e-10

# x -> force (unknowns,) and its derivative (unknowns, unknowns), at the full load
Follower = Callable[[Floats], tuple[Floats, sp.csr_matrix]]


class Touching(Protocol):
    """Forces of contact, from a potential that grows without bound where surfaces meet."""

    def gradient(self, x: Floats) -> Floats:
        """(unknowns,) derivative of the potential: minus the forces on the shell."""

    def hessian(self, x: Floats, projected: bool) -> sp.csr_matrix | None:
        """(unknowns, unknowns) second derivative, without negative parts if projected; None where nothing touches."""

    def advance(self, x: Floats) -> bool:
        """Move obstacles toward where they end as far as x lets them; whether they are there."""

    def largest_step(self, x: Floats, change: Floats) -> float:
        """The part of a change of x that may be made before anything touches."""

    def moved(self, change: Floats) -> float:
        """Largest displacement in a change of x, against that within which forces of contact change."""

    def require_free(self, x: Floats) -> None:
        """Raise SolveError if something intersects."""


@dataclass(frozen=True)
class Problem:
    """An energy with its conditions and loads, which all grow with one factor.

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
    scale : float
        Energy beside that of strains and loads, such as the kinetic one of a motion, against which the error counts.
    touching : Touching, optional
        Contact, which does not grow; for `minimise`.
    """

    energy: StrainEnergy
    reduction: Reduction
    load: Floats
    follower: Follower | None = None
    springs: sp.spmatrix | None = None
    constant: Floats | None = None
    initial: Floats | None = None
    scale: float = 0.0
    touching: Touching | None = None

    def evaluate(
        self,
        x: Floats,
        factor: float,
        derivatives: int,
        memory: Any,
        stress: Floats | None = None,
        projected: bool = False,
    ) -> tuple[Energy, Floats, Floats]:
        """Energy with the tangent of all forces, the residual (unknowns,), and d(external force)/d(factor).

        `projected` as for `StrainEnergy.energy`.
        """
        energy = self.energy.energy(x, derivatives, memory, stress, self._initial(factor), projected)
        return self._loaded(energy, x, factor, projected)

    def _initial(self, factor: float) -> Floats | None:
        return None if self.initial is None else factor * self.initial

    def _loaded(
        self, energy: Energy, x: Floats, factor: float, projected: bool = False
    ) -> tuple[Energy, Floats, Floats]:
        """As `evaluate`, from the energy of the strains."""
        growth, tangent = self.load, energy.hessian
        if self.follower is not None:
            force, stiffness = self.follower(x)
            growth = growth + force
            if tangent is not None:
                tangent = self._load_added.to(tangent, stiffness, -factor)
        residual = factor * growth - energy.gradient  # which holds the forces of initial strains already
        if self.initial is not None and energy.linear is not None:
            growth = growth + self.energy.forces(energy.linear, self.energy.stress(self.initial))
        if self.constant is not None:
            residual = residual + self.constant
        if self.springs is not None:
            residual = residual - self.springs @ x
            tangent = None if tangent is None else self._springs_added.to(tangent, self.springs.tocsr())
        if self.touching is not None:
            residual = residual - self.touching.gradient(x)
            bent = None if tangent is None else self.touching.hessian(x, projected)
            tangent = tangent if bent is None else tangent + bent
        return energy._replace(hessian=tangent), residual, growth

    @cached_property
    def _load_added(self) -> Added:
        return Added()

    @cached_property
    def _springs_added(self) -> Added:
        return Added()

    @cached_property
    def _factoriser(self) -> Factoriser:
        return Factoriser(self.reduction, self.energy, symmetric=self._symmetric())

    def _symmetric(self) -> bool:
        """Whether the tangent is symmetric in the free motions: follower loads may not be, at free edges.

        That does not depend on the state, so one at random tells.
        """
        if self.follower is None:
            return True
        basis = self.reduction.basis
        motion = np.random.default_rng(0).standard_normal(basis.shape[1])
        part = self.reduction.reduce(self.follower(basis @ motion)[1])
        return bool(abs(part - part.T).max() <= SYMMETRIC * abs(part).max())

    def factorise(self, tangent: sp.csr_matrix, definite: bool = True) -> Factor:
        """The tangent in the free unknowns, factorised; serves until the next one. See `Factoriser.factorise`."""
        return self._factoriser.factorise(tangent, definite)

    def positive(self, tangent: sp.csr_matrix) -> Factor | None:
        """The same where it is positive definite, else None. See `Factoriser.positive`."""
        return self._factoriser.positive(tangent)

    def near_rest(self, x: Floats, stress: Floats | None = None) -> tuple[Energy, Floats, Factor]:
        """Energy, residual (unknowns,) and the factorised tangent of a state near rest at the full load.

        Quicker than `evaluate` and `factorise` where the tangent is positive definite.

        Parameters
        ----------
        x : (unknowns,)
        stress : (triangle, r), optional
            As for `StrainEnergy.energy`.

        Raises
        ------
        SolveError
            As `factorise`.
        """
        rest = self.energy.rest
        if self.follower is None and self.touching is None:

            def evaluate(put: Put) -> tuple[Energy, Floats, Floats]:
                return self._loaded(self.energy.put_tangent(put, x, rest, stress, self.initial), x, 1.0)

            found = self._factoriser.near_rest(evaluate, self.springs)
            if found is not None:
                (energy, residual, _), factor = found
                return energy, residual, factor
        energy, residual, _ = self.evaluate(x, 1.0, 2, rest, stress)
        return energy, residual, self.factorise(energy.hessian)

    def pulled(self, spring: Floats, to: Floats) -> Problem:
        """The same with springs that pull the unknowns to a place, (unknowns,) each."""
        springs, constant = sp.diags(spring, format="csr"), spring * to
        if self.springs is not None:
            springs = (self.springs + springs).tocsr()
        if self.constant is not None:
            constant = self.constant + constant
        return replace(self, springs=springs, constant=constant).factorising_as(self)

    def factorising_as(self, other: Self) -> Self:
        """This one, with the pattern and order that another one of the same structure has for its tangents.

        A factor of either then serves until the next one of both.
        """
        return self.factorised_by(other._factoriser)

    def factorised_by(self, factoriser: Factoriser) -> Self:
        """This one, with what is known of the matrices of the same structure."""
        self.__dict__["_factoriser"] = factoriser
        return self

    def start(self) -> State:
        """The rest state."""
        return State(0.0, np.zeros(self.energy.unknowns), self.energy.rest)

    def settle(self, state: State) -> State:
        """The same state after its memory took up what it can of the unknowns."""
        x, memory = self.energy.settle(state.x, state.memory, self.reduction, self._initial(state.factor))
        if memory is state.memory:
            return state
        return replace(state, x=x, memory=memory, turned=state.turned + (state.x - x))


@dataclass(frozen=True)
class State:
    """A state in equilibrium.

    Attributes
    ----------
    factor : float
        Load factor.
    x : (unknowns,)
        Rotations count from what the memory took up.
    memory : object
        What the energy keeps of a state besides the unknowns, such as directors.
    iterations : int
        Newton iterations spent on the step to it.
    negative : int
        Negative eigenvalues of the tangent stiffness: 0 where the equilibrium is stable.
    turned : (unknowns,) or 0
        Unknowns that the memory took up, all in all: x + turned is the motion that loads work on.
    forward : bool
        Whether the step to it led where its first iteration pointed.
    """

    factor: float
    x: Floats
    memory: Any
    iterations: int = 0
    negative: int = 0
    turned: Floats | float = 0.0
    forward: bool = True
