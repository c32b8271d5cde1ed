"""A Koiter shell whose stress relaxes: as an elastic one, but that its states remember."""

from __future__ import annotations

import copy

import numpy as np
from numpy.typing import NDArray

from kshell.material.inelastic import Relaxing
from kshell.shell.koiter.energy import Koiter
from kshell.shell.koiter.remembered import remembering
from kshell.shell.koiter.surface import Surface
from kshell.shell.section import Section

Floats = NDArray[np.float64]


class RelaxingKoiter(Koiter):
    """The energy of a surface with a section that relaxes. Time steps tell how far (`equilibrium/motion/energies.py`).

    Parameters
    ----------
    surface : Surface
    section : Section
    relaxation : tuple of ((triangle,) g, tau)
    """

    def __init__(self, surface: Surface, section: Section, relaxation: Relaxing) -> None:
        super().__init__(surface, section)
        self.relaxation = relaxation
        self._factor: Floats | None = None
        self.rest = remembering(self.rest, len(self.triangle_unknowns), self.strains, len(relaxation) + 1)

    def scaled(self, factor: Floats) -> RelaxingKoiter:
        """The same with the stiffness of each triangle times a factor (triangle,)."""
        out = copy.copy(self)
        out._factor = factor
        return out

    def _apply(self, triangles: slice, columns: Floats) -> Floats:
        found = super()._apply(triangles, columns)
        return found if self._factor is None else self._factor[triangles, None, None] * found
