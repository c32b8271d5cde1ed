"""The shell with Argyris functions on a chart as analyses need it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kshell.scene.lines import held_lines, shell_lines
from kshell.scene.structure import Structure
from kshell.shell.chart.discretisation import ArgyrisDiscretisation
from kshell.shell.chart.lines import large_across_lines
from kshell.shell.model import ShellModel
from kshell.shell.problem import ShellProblem
from kshell.shell.supports import hinge_edges


class ChartModel(ShellModel):
    """A Koiter shell with Argyris functions on a chart.

    Parameters
    ----------
    structure : Structure
        With a chart.
    reasons : sequence of str
        Why this model.

    Raises
    ------
    InputError
        If a support, load, material or thickness does not fit, or the shell is not held.
    """

    def __init__(self, structure: Structure, reasons: Sequence[str] = ()) -> None:
        hinged = np.zeros(len(structure.space.edges), dtype=bool)
        hinged[hinge_edges(structure.supports, structure.space)] = True
        discretisation = ArgyrisDiscretisation(
            structure.parameters, structure.chart, shell_lines(structure), held_lines(structure), hinged
        )
        super().__init__(ShellProblem(structure, discretisation), reasons)
        self.small_only = large_across_lines(structure)
