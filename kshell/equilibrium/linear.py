"""Small deflections: one factorisation, refined with forces computed from strains.

In a thin shell the stiffness matrix holds membrane entries (R / t)^2 times larger than the bending that
resists inextensional motion, and rounding of the matrix alone costs that many digits. Forces computed
triangle by triangle from strains do not suffer from it, so refinement with them recovers the digits.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.energy import StrainEnergy
from kshell.equilibrium.factor import Factoriser
from kshell.equilibrium.reduction import Reduction
from kshell.errors import InputError, SolveError

Floats = NDArray[np.float64]

MOST_REFINEMENTS = 12
# relative energy of the last correction; the error of the solution is about its square root smaller
FINISHED = 1e-22
HOPELESS = 1e-4
# energy of a motion formed from strains, against that of its unknowns one by one: what is rounding squared, and from
# where on it may be, since a factor leaves up to 3e-22 of a mechanism (6e-33 to 4e-30 once refined)
MECHANISM, SUSPECT = 1e-25, 1e-14
HOLD = "add supports there (a strip with a hinge between simply supported ends is such a mechanism)"


class LinearSolution(NamedTuple):
    """Answer of a linear solve.

    Attributes
    ----------
    x : (unknowns,)
    forces : (unknowns,)
        Internal forces and moments less the loads: what the supports exert.
    stress : (triangle, 2 r)
    corrections : tuple of float
        Relative energy norm of each correction, the first that of the solution itself, 1.
    """

    x: Floats
    forces: Floats
    stress: Floats
    corrections: tuple[float, ...]


class LinearSolver:
    """One structure for any number of loads: its stiffness is factorised once.

    Parameters
    ----------
    elastic : StrainEnergy
    reduction : Reduction
        What the conditions leave of the motions.
    springs : (unknowns, unknowns) sparse, optional
        Stiffness of elastic supports.

    Raises
    ------
    InputError
        If the structure can move freely.
    """

    def __init__(
        self, elastic: StrainEnergy, reduction: Reduction, springs: sp.spmatrix | None = None
    ) -> None:
        self.elastic, self.reduction, self.springs = elastic, reduction, springs
        # rounding can spoil the sign of a pivot in very thin shells and very small triangles; refinement mends it
        self.factoriser = Factoriser(reduction, elastic)  # knows the pattern for tangents
        factor, self._diagonal = self.factoriser.factorise_at_rest(springs)
        self._solve = factor.solve
        self._require_held()

    def _require_held(self) -> None:
        if self.reduction.basis.shape[1]:
            self._require_stiff(_softest(self._diagonal, self.reduction.basis, self._solve))

    def solve(
        self, load: Floats, given: Floats | None = None, initial: Floats | None = None
    ) -> LinearSolution:
        """Displacements under a load.

        Parameters
        ----------
        load : (unknowns,)
        given : (unknowns,), optional
            Prescribed motion, that of the reduction if absent.
        initial : (triangle, r), optional
            Strains without stress.

        Raises
        ------
        InputError
            If the structure can move freely.
        SolveError
            If rounding leaves no digit.
        """
        elastic, basis, springs = self.elastic, self.reduction.basis, self.springs
        x = (self.reduction.given if given is None else given).copy()
        # against what initial strains would store in a blocked shell, too: it may not move at all
        energy = 0.0 if initial is None else float(np.sum(initial * elastic.stress(initial)))
        corrections: list[float] = []
        at_rest = initial is None and not x.any()  # where most solutions begin, and nothing is strained
        for _ in range(MOST_REFINEMENTS):
            if at_rest:
                stress, forces = np.zeros((len(elastic.triangle_unknowns), elastic.strains)), 0.0 - load
                at_rest = False
            else:
                strain = elastic.linear_strain(x)
                stress = elastic.stress(strain if initial is None else strain - initial)
                forces = elastic.linear_forces(stress) - load
                if springs is not None:
                    forces += springs @ x
            residual = -(basis.T @ forces)
            step = self._solve(residual)
            gain = abs(float(residual @ step))
            if not np.isfinite(gain):
                raise SolveError(
                    "the solution is not finite: the shell can move freely, or loads and stiffness are of magnitudes "
                    "that double precision does not hold together"
                )
            energy = max(energy, gain)
            if energy == 0.0 or gain <= FINISHED * energy:
                break
            if len(corrections) > 1 and np.sqrt(gain / energy) > 0.5 * corrections[-1]:
                break  # rounding: no further digit
            corrections.append(float(np.sqrt(gain / energy)))
            x = x + basis @ step
        if len(corrections) > 1 and corrections[-1] > HOPELESS:
            self._require_stiff(basis @ step)
            raise SolveError(
                f"rounding leaves a relative error of {corrections[-1]:.1e} in the energy norm: the shell is too thin "
                "for the mesh, the smallest triangles are too small, or it hangs on too little",
                state=x,
            )
        return LinearSolution(x, forces, stress, tuple(corrections))

    def respond(self, load: Floats) -> Floats:
        """(free,) unknowns under a load on them alone, not refined."""
        return np.asarray(self._solve(load))

    def _require_stiff(self, motion: Floats) -> None:
        """Refuse a mechanism, whether the load drives it or not.

        The energy of the motion is formed from its strains: that of a mechanism is rounding squared, that of the
        thinnest shell is not.
        """
        if not np.isfinite(motion).all():
            raise InputError(f"the shell can move freely: its stiffness is singular; {HOLD}")
        motion = motion / np.abs(motion).max()
        softness, forces = self._resisted(motion)
        if MECHANISM < softness <= SUSPECT:
            motion = motion - self.reduction.basis @ self._solve(self.reduction.basis.T @ forces)
            softness, _ = self._resisted(motion)
        if softness <= MECHANISM:
            raise InputError(f"the shell can move freely{_where(self.elastic, motion)}: {HOLD}")

    def _resisted(self, motion: Floats) -> tuple[float, Floats]:
        """The energy of a motion against that of its unknowns one by one, and the (unknowns,) forces against it."""
        strain = self.elastic.linear_strain(motion)
        stress = self.elastic.stress(strain)
        energy, forces = float(np.sum(strain * stress)), self.elastic.linear_forces(stress)
        if self.springs is not None:
            pulled = self.springs @ motion
            energy, forces = energy + float(motion @ pulled), forces + pulled
        alone = float(motion @ (self._diagonal * motion))
        return (energy / alone if alone > 0.0 else 0.0), forces


def solve_roughly(
    elastic: StrainEnergy,
    load: Floats,
    reduction: Reduction,
    springs: sp.spmatrix | None = None,
    initial: Floats | None = None,
) -> Floats:
    """(unknowns,) displacements under one load as the factor gives them, without refinement; else as `solve_linear`.

    Rounding leaves 1e-10 to 1e-5 of them, in the thinnest shells 1e-3; whether the structure is held is not asked.

    Raises
    ------
    SolveError
        If the matrix is singular.
    """
    factor, _ = Factoriser(reduction, elastic).factorise_at_rest(springs)
    x, forces = reduction.given, -load
    if np.any(x) or initial is not None:
        strain = elastic.linear_strain(x)
        forces += elastic.linear_forces(elastic.stress(strain if initial is None else strain - initial))
        if springs is not None:
            forces += springs @ x
    return np.asarray(x - reduction.basis @ factor.solve(reduction.basis.T @ forces))


def solve_linear(
    elastic: StrainEnergy,
    load: Floats,
    reduction: Reduction,
    springs: sp.spmatrix | None = None,
    initial: Floats | None = None,
) -> LinearSolution:
    """Displacements under one load, see `LinearSolver`."""
    return LinearSolver(elastic, reduction, springs).solve(load, None, initial)


def _softest(diagonal: Floats, basis: sp.spmatrix, solve: Callable[[Floats], Floats]) -> Floats:
    """(unknowns,) the softest motion, by one step of inverse iteration from the diagonal of the stiffness."""
    start = np.random.default_rng(1).standard_normal(len(diagonal)) * np.sqrt(np.abs(diagonal))
    motion: Floats = basis @ solve(basis.T @ start)
    return motion


def _where(energy: StrainEnergy, motion: Floats) -> str:
    """Place that moves most, in words, where the discretisation tells it."""
    place = energy.most_moved(motion)
    if place is None:
        return ""
    x, y, z = place
    return f" (it moves most near ({x:.6g}, {y:.6g}, {z:.6g}))"
