"""An energy that is a quadratic function of strains: value, gradient, Hessian, and its linear limit.

Both discretisations of the Koiter energy have the form  sum over triangles of 1/2 s . K s  with strains s
that are smooth functions of the unknowns. Then, with the stress sigma = K s,

    gradient = s'^T sigma,    Hessian = s'^T K s' + sum_r sigma_r s_r''.

This module knows nothing else about shells; a discretisation supplies s, s' and sum_r sigma_r s_r''.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator
from functools import cached_property, partial
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.evaluated import Asked, Energy, Evaluated, Linear, Response
from kshell.equilibrium.reduction import Reduction
from kshell.equilibrium.sparsity import Sparsity
from kshell.solvers.dissection import dissected

Floats = NDArray[np.float64]

# takes the matrices (triangle, n, n) of some triangles, which it may change
Put = Callable[[slice, Floats], None]

KEPT = 300_000  # unknowns up to which what is quickly made anew is kept while the matrix is factorised


class StrainEnergy(Evaluated):
    """Energy assembled from triangles.

    Attributes
    ----------
    unknowns : int
    triangle_unknowns : (triangle, n) int array
    strains : int
        Strains r of a triangle.
    blocks : list of slice
        Triangles worked on at a time; they bound the memory of intermediate arrays.
    rest : object
        Memory of the rest state: what the discretisation keeps of a state besides the unknowns (directors). None or a
        dataclass of arrays; `settle` makes that of other states. Its `inelastic` (triangle, r), if there, are strains
        without stress that stay.
    kept : int
        Unknowns up to which linear strains are kept from the matrix on; of more they are found again when needed.
    inner : (i,) int array
        Which unknowns of a triangle no other one shares.
    """

    kept = KEPT
    inner: NDArray[np.int64] = np.zeros(0, dtype=np.int64)
    unknowns: int
    triangle_unknowns: NDArray[np.int32]
    strains: int
    blocks: list[slice]
    rest: Any

    @abstractmethod
    def _state(self, x: Floats, memory: Any, triangles: slice) -> Any:
        """Kinematics of a block, with an attribute `strain` (triangle, r)."""

    @abstractmethod
    def _gradient(self, state: Any, triangles: slice) -> Floats:
        """s': (triangle, r, n)."""

    @abstractmethod
    def _geometric(self, state: Any, stress: Floats, triangles: slice) -> Floats:
        """sum_r stress_r s_r'' in the leading unknowns of the triangle, on which s'' depends: (triangle, m, m)."""

    @abstractmethod
    def _apply(self, triangles: slice, columns: Floats) -> Floats:
        """K times columns (triangle, r, k)."""

    def _respond(self, strain: Floats, memory: Any, triangles: slice) -> Response:
        """What triangles answer to strains (triangle, r), less initial and inelastic ones."""
        stress = self._apply(triangles, strain[:, :, None])[:, :, 0]
        return Response(0.5 * float(np.sum(strain * stress)), stress)

    def settle(
        self, x: Floats, memory: Any, reduction: Reduction, initial: Floats | None = None
    ) -> tuple[Floats, Any]:
        """The same state as its memory takes up of it what it can: unknowns (unknowns,) that are left, and memory.

        Nothing where there is no memory. `initial` as for `energy`.
        """
        return x, memory

    def forget(self) -> None:
        """Give up what is quickly made anew, before much memory is needed for something else."""

    def most_moved(self, motion: Floats) -> Floats | None:
        """(3,) the place in space that a motion (unknowns,) moves most, None where that is not told."""
        return None

    @abstractmethod
    def translation_weights(self) -> Floats:
        """(unknowns,) w such that x . (w x) is the mean square translation of the nodes."""

    @property
    @abstractmethod
    def sparsity(self) -> Sparsity:
        """Pattern of all matrices; found once."""

    @property
    @abstractmethod
    def centres(self) -> Floats:
        """(triangle, d) centres of the triangles."""

    @cached_property
    def group_places(self) -> NDArray[np.integer]:
        """(group,) place of each group of unknowns in an order of elimination with little fill."""
        return dissected(self.centres, self.sparsity.groups, len(self.sparsity.sizes))

    @cached_property
    def elimination(self) -> NDArray[np.int64]:
        """(unknowns,) place of each unknown in an order of elimination with little fill; within a group as numbered."""
        sparsity = self.sparsity
        order = np.argsort(np.repeat(self.group_places, sparsity.sizes), kind="stable")
        result = np.empty(self.unknowns, dtype=np.int64)
        result[order] = np.arange(self.unknowns)
        return result

    def strain(self, x: Floats, memory: Any = None) -> Floats:
        """(triangle, r) strains s of a state."""
        memory = self.rest if memory is None else memory
        return np.concatenate([self._state(x, memory, t).strain for t in self.blocks])

    def stress(self, strain: Floats) -> Floats:
        """K s: (triangle, r)."""
        return np.concatenate([self._apply(t, strain[t, :, None])[:, :, 0] for t in self.blocks])

    def put_tangent(
        self, put: Put, x: Floats, memory: Any, stress: Floats | None = None, initial: Floats | None = None
    ) -> Energy:
        """As `energy` with two derivatives, but for the Hessian, whose matrices of triangles are put somewhere."""
        return self._evaluated(Asked(x, 2, memory, stress, initial, False), put)

    def _energy(self, asked: Asked) -> Energy:
        return self._evaluated(asked, None)

    def _evaluated(self, asked: Asked, put: Put | None) -> Energy:
        x, derivatives, memory, stress, initial, projected = asked
        memory = self.rest if memory is None else memory
        value = 0.0
        forces = np.zeros(self.triangle_unknowns.shape)
        room = self.sparsity.empty() if derivatives > 1 and put is None else None
        if room is not None:
            put = partial(self.sparsity.put, room)
        free = inelastic_of(memory)
        if free is not None:
            initial = free if initial is None else initial + free
        answers: list[Response] = []
        linear = Linear(np.empty((len(self.triangle_unknowns), self.strains)), [])
        for triangles in self.blocks:
            state = self._state(x, memory, triangles)
            strain = state.strain if initial is None else state.strain - initial[triangles]
            answer = self._respond(strain, memory, triangles)
            mine = answer.stress
            value += answer.value
            if derivatives == 0:
                continue
            gradient = self._gradient(state, triangles)
            forces[triangles] = np.matmul(mine[:, None, :], gradient)[:, 0]
            if put is not None:
                matrices = self._product(gradient, triangles, answer.tangent)
                curved = self._geometric(state, mine if stress is None else stress[triangles], triangles)
                matrices[:, : curved.shape[1], : curved.shape[1]] += curved
                put(triangles, _positive(matrices) if projected else matrices)
            linear.strain[triangles] = strain
            linear.gradients.append(gradient)
            answers.append(answer)
        if derivatives == 0:
            return Energy(value)
        if answers[0].tangent is not None:
            linear = linear._replace(answers=answers)
        hessian = None if room is None else self.sparsity.matrix(room)
        return Energy(value, self._gather(forces), hessian, linear)

    def extrapolated_stress(self, linear: Linear, step: Floats) -> Floats:
        """K (s + s' step): the stress after a step if the strains were linear. (triangle, r)."""
        if linear.answers is None:
            return self.stress(linear.after(step, self.triangle_unknowns, self.blocks))
        parts = []
        for triangles, gradient, answer in zip(self.blocks, linear.gradients, linear.answers, strict=True):
            change = np.matmul(gradient, step[self.triangle_unknowns[triangles], None])
            assert answer.tangent is not None
            parts.append(answer.stress + np.matmul(answer.tangent, change)[:, :, 0])
        return np.concatenate(parts)

    def forces(self, linear: Linear, stress: Floats) -> Floats:
        """s'^T stress: (unknowns,) forces in equilibrium with a stress (triangle, r)."""
        forces = np.empty(self.triangle_unknowns.shape)
        for triangles, gradient in zip(self.blocks, linear.gradients, strict=True):
            forces[triangles] = np.matmul(stress[triangles, None, :], gradient)[:, 0]
        return self._gather(forces)

    @cached_property
    def at_rest(self) -> Linear:
        """No strain, and its derivative at rest: the linear strains."""
        x = np.zeros(self.unknowns)
        gradients = [self._gradient(self._state(x, self.rest, t), t) for t in self.blocks]
        return Linear(np.zeros((len(self.triangle_unknowns), self.strains)), gradients)

    def linear_stiffness(self) -> sp.csr_matrix:
        """Second derivative of the energy at rest."""
        room = self.sparsity.empty()
        self.put_stiffness(partial(self.sparsity.put, room))
        return self.sparsity.matrix(room)

    def put_stiffness(self, put: Put, keep: bool = False) -> None:
        """The matrices of the triangles for it, one block after the other.

        `keep`: linear strains are not made again afterwards, however many unknowns there are.
        """
        gradients = self.at_rest.gradients if keep else self._gradients_at_rest()
        for triangles, gradient in zip(self.blocks, gradients, strict=True):
            put(triangles, self._product(gradient, triangles))

    def _gradients_at_rest(self) -> Iterator[Floats]:
        """Those of `at_rest`, block by block."""
        if self.unknowns <= self.kept or "at_rest" in self.__dict__:
            yield from self.at_rest.gradients
            return
        x = np.zeros(self.unknowns)
        for triangles in self.blocks:
            yield self._gradient(self._state(x, self.rest, triangles), triangles)

    def linear_strain(self, x: Floats) -> Floats:
        """(triangle, r) strains to first order."""
        return self.at_rest.after(x, self.triangle_unknowns, self.blocks)

    def linear_forces(self, stress: Floats) -> Floats:
        """Forces on the unknowns (unknowns,) in equilibrium with a stress, at rest.

        With the stress of `linear_strain` this is the stiffness times x with far less rounding in thin
        shells: strains are formed before they are multiplied by the large membrane stiffness.
        """
        return self.forces(self.at_rest, stress)

    def geometric_stiffness(self, stress: Floats) -> sp.csr_matrix:
        """sum_r stress_r s_r'' at rest (for buckling)."""
        x = np.zeros(self.unknowns)
        room = self.sparsity.empty()
        count = self.triangle_unknowns.shape[1]
        for triangles in self.blocks:
            curved = self._geometric(self._state(x, self.rest, triangles), stress[triangles], triangles)
            matrices = np.zeros((len(curved), count, count))
            matrices[:, : curved.shape[1], : curved.shape[1]] = curved
            self.sparsity.put(room, triangles, matrices)
        return self.sparsity.matrix(room)

    def _product(self, gradient: Floats, triangles: slice, tangent: Floats | None = None) -> Floats:
        carried = self._apply(triangles, gradient) if tangent is None else np.matmul(tangent, gradient)
        return np.matmul(gradient.swapaxes(1, 2), carried)

    def _gather(self, forces: Floats) -> Floats:
        """Sum of forces (triangle, n) on each unknown."""
        where = self.triangle_unknowns.ravel()
        return np.asarray(np.bincount(where, weights=forces.ravel(), minlength=self.unknowns), dtype=float)


def _positive(matrices: Floats) -> Floats:
    """Symmetric matrices (triangle, n, n) without their negative eigenvalues."""
    values, vectors = np.linalg.eigh(matrices)
    return np.asarray((vectors * np.maximum(values, 0.0)[:, None, :]) @ vectors.swapaxes(1, 2))


def inelastic_of(memory: Any) -> Floats | None:
    """(triangle, r) strains without stress that stay, None where nothing stays."""
    return getattr(memory, "inelastic", None)


def in_blocks(count: int, size: int) -> list[slice]:
    """Slices of at most `size` that cover `count` triangles."""
    return [slice(i, min(i + size, count)) for i in range(0, count, size)]
