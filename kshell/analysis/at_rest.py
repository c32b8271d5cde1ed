"""A structure under loads at rest, about whose state others shake it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.analysis.prestress import Prestress, prestressed
from kshell.analysis.run import Run
from kshell.equilibrium.model import Model
from kshell.errors import InputError
from kshell.solvers.backends import Singular
from kshell.solvers.refine import refine
from kshell.solvers.symmetric import SymmetricFactor, factorise_symmetric

Floats = NDArray[np.float64]


@dataclass
class AtRest:
    """The state under loads at rest that a structure vibrates about.

    Attributes
    ----------
    state : Prestress
    geometric : (free, free) matrix
        G.
    """

    state: Prestress
    geometric: sp.csr_matrix

    @classmethod
    def of(cls, model: Model, run: Run) -> AtRest:
        """Under the loads with fixed = true.

        Raises
        ------
        InputError
            If there are none, or they buckle the structure.
        """
        state = prestressed(model, run)
        found = cls(state, (state.stiffness - model.stiffness()).tocsr())
        try:
            negative = found.factor.count_negative()
        except Singular:
            negative = 1
        if negative:
            raise InputError(
                "the loads at rest, those with fixed = true, are beyond buckling: the structure does not vibrate about "
                "that state; reduce them"
            )
        return found

    @cached_property
    def factor(self) -> SymmetricFactor:
        """Of K + G."""
        return factorise_symmetric(self.state.stiffness, True)

    def solve(self, load: Floats) -> Floats:
        """(free,) under a load (free,) that grows slowly."""
        k = self.state.stiffness
        x, *_ = refine(lambda x: np.asarray(k @ x), load[:, None], self.factor.solve)
        return np.asarray(x[:, 0], dtype=float)
