"""A level of the hierarchy: its matrix, its interpolation, and Gauss-Seidel before and after the correction from below.

Sweeps go forward before and backward after, so that a cycle is symmetric. A correction e is found from zero for the
residual r, whatever came before it: a compiled sweep then needs the triangle of A on one side of the diagonal alone,
and hands down the residual r - A e through the same entries. Without compiled loops the sweeps are those of PyAMG.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from kshell.solvers import kernels
from kshell.solvers.multigrid.galerkin import entries
from kshell.solvers.system import Floats

Patches = tuple[Any, Any]  # smoothers x, b -> x for groups of unknowns, before and after


class Level(ABC):
    """What a cycle needs of a level that has a coarser one below.

    Attributes
    ----------
    size : int
        Unknowns.
    """

    size: int

    @abstractmethod
    def residual(self, x: Floats, rhs: Floats) -> Floats:
        """rhs - A x"""

    @abstractmethod
    def interpolate(self, coarse: Floats) -> Floats:
        """P x_c"""

    @abstractmethod
    def restrict(self, residual: Floats) -> Floats:
        """P^T r"""

    @abstractmethod
    def before(self, rhs: Floats) -> tuple[Floats, Floats]:
        """Forward sweeps from zero: x, and rhs - A x."""

    @abstractmethod
    def after(
        self, rhs: Floats, x: Floats, left: Floats, step: Floats, wanted: bool
    ) -> tuple[Floats, Floats | None]:
        """Backward sweeps from x + step.

        Parameters
        ----------
        rhs, x, left : (n,) float arrays
            As given to and found by `before`; x and left are overwritten.
        step : (n,) float array
            From below.
        wanted : bool
            Whether the residual is.

        Returns
        -------
        x : (n,) float array
        residual : (n,) float array or None
        """


class RelaxedLevel(Level):
    """By scipy and PyAMG.

    Parameters
    ----------
    matrix : (n, n) CSR matrix
    prolongation : (n, m) CSR matrix
    count : int
        Sweeps.
    patches : tuple of two smoothers, optional
        After the forward and before the backward sweeps.
    """

    def __init__(self, matrix: Any, prolongation: Any, count: int, patches: Patches | None = None) -> None:
        self.matrix, self.prolongation, self.restriction = matrix, prolongation, prolongation.T
        self.count, self.patches, self.size = count, patches, matrix.shape[0]

    def residual(self, x: Floats, rhs: Floats) -> Floats:
        return np.asarray(rhs - self.matrix @ x)

    def interpolate(self, coarse: Floats) -> Floats:
        return np.asarray(self.prolongation @ coarse)

    def restrict(self, residual: Floats) -> Floats:
        return np.asarray(self.restriction @ residual)

    def before(self, rhs: Floats) -> tuple[Floats, Floats]:
        x = np.zeros_like(rhs)
        self._sweep(x, rhs, "forward")
        if self.patches is not None:
            self.patches[0](self.matrix, x, rhs)
        return x, self.residual(x, rhs)

    def after(
        self, rhs: Floats, x: Floats, left: Floats, step: Floats, wanted: bool
    ) -> tuple[Floats, Floats | None]:
        x += step
        if self.patches is not None:
            self.patches[1](self.matrix, x, rhs)
        self._sweep(x, rhs, "backward")
        return x, self.residual(x, rhs) if wanted else None

    def _sweep(self, x: Floats, rhs: Floats, direction: str) -> None:
        from pyamg.relaxation.relaxation import gauss_seidel

        gauss_seidel(self.matrix, x, rhs, iterations=self.count, sweep=direction)


class SweptLevel(Level):
    """By compiled loops, matrix and prolongation in blocks.

    Parameters
    ----------
    matrix : (n, n) BSR matrix
        Of 1 x 1 or 3 x 3 blocks, sorted.
    prolongation : (n, m) BSR matrix
        Of as high blocks, three wide.
    count : int
        Sweeps.
    """

    def __init__(self, matrix: Any, prolongation: Any, count: int) -> None:
        self.count, self.size, self._coarse = count, matrix.shape[0], prolongation.shape[1]
        self._matrix = matrix.indptr, matrix.indices, matrix.data
        self._prolongation = prolongation.indptr, prolongation.indices, prolongation.data

    def residual(self, x: Floats, rhs: Floats) -> Floats:
        out = rhs.copy()
        kernels.cycles.subtract(*self._matrix, x, out)
        return out

    def interpolate(self, coarse: Floats) -> Floats:
        out = np.zeros(self.size)
        kernels.cycles.subtract(*self._prolongation, -coarse, out)
        return out

    def restrict(self, residual: Floats) -> Floats:
        out = np.zeros(self._coarse)
        kernels.cycles.gather(*self._prolongation, residual, out)
        return out

    def before(self, rhs: Floats) -> tuple[Floats, Floats]:
        left = rhs.copy()
        x = self._swept(kernels.cycles.forward, left)
        return x, left

    def after(
        self, rhs: Floats, x: Floats, left: Floats, step: Floats, wanted: bool
    ) -> tuple[Floats, Floats | None]:
        kernels.cycles.subtract(*self._matrix, step, left)
        x += step
        x += self._swept(kernels.cycles.backward, left)
        return x, left

    def _swept(self, sweep: Any, left: Floats) -> Floats:
        """A correction, whose share is taken from what is left."""
        out = np.empty(self.size)
        sweep(*self._matrix, left, out)
        for _ in range(self.count - 1):
            more = np.empty(self.size)
            sweep(*self._matrix, left, more)
            out += more
        return out


def level_of(matrix: Any, prolongation: Any, count: int, patches: Patches | None = None) -> Level:
    """The quicker one that there is, from matrices in blocks."""
    if kernels.cycles is None or patches is not None or matrix.indices.dtype != np.int32:
        return RelaxedLevel(entries(matrix), entries(prolongation), count, patches)
    return SweptLevel(matrix, prolongation, count)
