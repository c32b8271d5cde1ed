"""What the time steps of small and of finite deformation have in common: mass, conditions, schemes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.contact.barrier import Barrier
from kshell.equilibrium.motion.schemes import SCHEMES, Scheme
from kshell.equilibrium.motion.state import Motion
from kshell.errors import InputError

Floats = NDArray[np.float64]

# part of an initial displacement that supports may hold, which is rounding
HELD = 1e-9
ENERGY_MOMENTUM = "em"
# iterations with contact after which two steps of half the size cost less: they take 7 to 25
MOST_TOUCHING = 40
# error of a step of `em`, as `Scheme.error`
MIDDLE_ERROR = 1.0 / 12.0


class Integrator(ABC):
    """Time steps of a structure.

    Parameters
    ----------
    mass : (unknowns, unknowns) CSR matrix
    basis : (unknowns, free) sparse
        Of the motions that supports leave.
    scheme : "alpha", "em", "bdf2" or "euler"
    viscosity : float
        Time tau of a material of Kelvin and Voigt: its stress is that of the strain plus tau times the strain rate.
    drag : float
        Force on mass and velocity, per time.

    Attributes
    ----------
    barrier : Barrier or None
        Of contact.
    few_sizes : bool
        Whether steps of another size cost more than others.
    massive : (unknowns,) bool
        Unknowns with mass; others follow at once.
    """

    barrier: Barrier | None = None
    few_sizes: ClassVar[bool] = False

    def __init__(
        self, mass: sp.csr_matrix, basis: sp.csc_matrix, scheme: str, viscosity: float, drag: float
    ) -> None:
        self.viscosity, self.drag, self._basis = viscosity, drag, basis
        self.mass = mass.tocsr()
        self.mass.sum_duplicates()
        self.scheme: Scheme | None = None if scheme == ENERGY_MOMENTUM else SCHEMES[scheme]()
        self.massive = self.mass.diagonal() > 0.0
        reduced = (basis.T @ self.mass @ basis).tocsc()
        self._moving = np.flatnonzero(reduced.diagonal() > 0.0)
        self._solve: Callable[[Floats], Any] | None = None
        if len(self._moving):
            from scipy.sparse.linalg import splu

            self._solve = splu(reduced[self._moving][:, self._moving]).solve

    @property
    def error(self) -> float:
        """The error of a step is about this times step^2 times the change of the acceleration."""
        return MIDDLE_ERROR if self.scheme is None else self.scheme.error

    @property
    def end_share(self) -> float:
        """Share of the force at the end of a step in its impulse."""
        return 0.5 if self.scheme is None else self.scheme.end_share

    def by_mass(self, force: Floats) -> Floats:
        """(unknowns,) the motion that the mass turns into a force on what is free: velocity of a momentum."""
        out = np.zeros(self._basis.shape[1])
        if self._solve is not None:
            out[self._moving] = self._solve((self._basis.T @ force)[self._moving])
        return np.where(self.massive, self._basis @ out, 0.0)

    def accelerated(self, motion: Motion) -> Floats:
        """(unknowns,) acceleration by what loads, strains and damping exert; of supports that move as the scheme's."""
        given = self._unreached(motion.acceleration)
        if not np.any(given):
            return self.by_mass(motion.force)
        return given + self.by_mass(motion.force - self.mass @ given)

    def _unreached(self, x: Floats) -> Floats:
        """(unknowns,) what the free motions leave of x, zero where it is rounding."""
        rest = np.where(self.massive, x - self._moves @ self._nearest(self._moves.T @ x), 0.0)
        rounding = HELD * np.abs(x).max(initial=0.0)
        return np.where(np.abs(rest) > rounding, rest, 0.0)

    @cached_property
    def _moves(self) -> sp.csc_matrix:
        """Columns of the basis that have mass."""
        return self._basis.tocsc()[:, self._moving]

    @cached_property
    def _nearest(self) -> Callable[[Floats], Floats]:
        """The solution with the Gram matrix of these columns."""
        gram = (self._moves.T @ self._moves).tocsc()
        if not gram.shape[0]:
            return np.zeros_like
        if gram.nnz == gram.shape[0]:
            return lambda rhs: np.asarray(rhs / gram.diagonal())
        from scipy.sparse.linalg import splu

        solve: Callable[[Floats], Floats] = splu(gram).solve
        return solve

    def reached(self, x: Floats) -> Floats:
        """(unknowns,) the free motion that is x where there is mass.

        Raises
        ------
        InputError
            If x moves what supports hold.
        """
        found: Floats = self._moves @ self._nearest(self._moves.T @ x)
        off = np.abs(np.where(self.massive, found - x, 0.0)).max()
        if off > HELD * np.abs(x).max():
            raise InputError(
                f"initial displacement: it moves what supports hold, by up to {off:.3g}: make it zero there"
            )
        return found

    @abstractmethod
    def start(self, momentum: Floats | None = None, x: Floats | None = None, size: float = 0.0) -> Motion:
        """The motion at the time 0, at rest or with a momentum (unknowns,), and where it is if not as meshed.

        What is bent by hand has accelerations without bound as the mesh gets finer: of vibrations that a step does not
        resolve, `size` long, they are those that the step makes of them.

        Raises
        ------
        InputError
            If x moves what supports hold.
        SolveError
            If rotations do not find their places.
        """

    @abstractmethod
    def step(self, motion: Motion, size: float, patient: bool = False) -> Motion:
        """The motion a step later.

        Parameters
        ----------
        patient : bool
            Whether it may cost more than two of half the size usually do, as where it is shorter already.

        Raises
        ------
        SolveError
            If the step has no answer; a shorter one may.
        """
