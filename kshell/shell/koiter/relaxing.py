"""A Koiter shell whose stress relaxes: as an elastic one, but that its states remember."""

from __future__ import annotations

from kshell.material.inelastic import Terms
from kshell.shell.koiter.energy import Koiter
from kshell.shell.koiter.remembered import remembering
from kshell.shell.koiter.surface import Surface
from kshell.shell.section import Section


class RelaxingKoiter(Koiter):
    """The energy of a surface with a section that relaxes. Time steps tell how far (`equilibrium/motion/energies.py`).

    Parameters
    ----------
    surface : Surface
    section : Section
    relaxation : tuple of (g, tau)
    """

    def __init__(self, surface: Surface, section: Section, relaxation: Terms) -> None:
        super().__init__(surface, section)
        self.relaxation = relaxation
        self.rest = remembering(self.rest, len(self.triangle_unknowns), self.strains, len(relaxation) + 1)
