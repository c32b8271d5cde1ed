"""Where Argyris functions on a chart are not to be taken, and what to take."""

import numpy as np

from kshell.mesh.words import place
from kshell.scene.lines import shell_lines
from kshell.scene.structure import Structure

# charts that are thinner, against their size, lock
THINNEST = 2e-3
USE_KOITER = 'take element = "koiter", which works on charts too'


def what_they_smooth(structure: Structure) -> str:
    """What smooth functions cannot follow, in words; empty where there is nothing."""
    lines = shell_lines(structure)
    if not lines.any():
        return ""
    space = structure.space
    at = space.points[space.edges[np.argmax(lines)]].mean(axis=0)
    return (
        "derivatives of the displacement jump across lines inside the shell (steps of the section, lines held or "
        f"loaded, borders of free strains), for example at {place(at)}"
    )
