"""What an energy of finite deformation is asked for, and what it answers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Linear(NamedTuple):
    """Strains of a state and their first derivative."""

    strain: Floats  # (triangle, r), less initial and inelastic ones
    gradients: list[Floats]  # s' of each block: (triangle, r, n)
    answers: list[Response] | None = None  # of each block, where the stress is not K s

    def after(self, step: Floats, unknowns: NDArray[np.int32], blocks: list[slice]) -> Floats:
        """s + s' step: (triangle, r)."""
        result = self.strain.copy()
        for triangles, gradient in zip(blocks, self.gradients, strict=True):
            result[triangles] += np.matmul(gradient, step[unknowns[triangles], None])[:, :, 0]
        return result


class Response(NamedTuple):
    """What triangles answer to strains."""

    value: float  # their energy
    stress: Floats  # (triangle, r)
    tangent: Floats | None = None  # (triangle, r, r) derivative of the stress; None: K


class Energy(NamedTuple):
    """Energy of a state, with as many derivatives as were asked for."""

    value: float
    gradient: Any = None  # (unknowns,), None if not asked for
    hessian: Any = None  # sparse, None if not asked for
    linear: Any = None  # Linear, comes with the gradient


class Asked(NamedTuple):
    """What an energy is asked for; see `Evaluated.energy`."""

    x: Floats
    derivatives: int
    memory: Any
    stress: Floats | None
    initial: Floats | None
    projected: bool


class Evaluated(ABC):
    """What has an energy of states of finite deformation."""

    def energy(
        self,
        x: Floats,
        derivatives: int = 0,
        memory: Any = None,
        stress: Floats | None = None,
        initial: Floats | None = None,
        projected: bool = False,
    ) -> Energy:
        """Energy of a state of finite deformation.

        Parameters
        ----------
        x : (unknowns,)
        derivatives : 0, 1 or 2
        memory : object, optional
            Of the state; that of the rest state if absent.
        stress : (triangle, r), optional
            Stress of the second derivative instead of that of the state: the mixed iteration of Magisano,
            Leonetti and Garcea (2017), with the stress of `extrapolated_stress`.
        initial : (triangle, r), optional
            Strains at which the triangles are free of stress, such as those of temperature.
        projected : bool
            Whether the matrices of the triangles lose their negative eigenvalues.
        """
        return self._energy(Asked(x, derivatives, memory, stress, initial, projected))

    @abstractmethod
    def _energy(self, asked: Asked) -> Energy:
        """As `energy`."""
