"""What Argyris functions on a chart make of lines inside a shell across which derivatives of the displacement jump."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.mesh.words import place
from kshell.scene.lines import shell_lines
from kshell.scene.structure import Structure
from kshell.shell.chart.nodes import Nodes

_WHAT = "steps of the section, hinges, lines held or loaded, borders of free strains"


def large_across_lines(structure: Structure) -> str:
    """Why large deflections are not for these elements, in words; empty where they are."""
    lines = shell_lines(structure)
    if not lines.any():
        return ""
    at = structure.space.points[structure.space.edges[np.argmax(lines)]].mean(axis=0)
    return (
        f"derivatives of the displacement jump across lines inside the shell ({_WHAT}), for example at {place(at)}, "
        "and Argyris functions on a chart follow that for small deflections only"
    )


def has_curved_edges(mesh: Mesh) -> bool:
    """Whether edges of a parameter mesh are curved, which Argyris functions are not made for."""
    if mesh.midpoints is None:
        return False
    straight = mesh.points[mesh.edges].mean(axis=1)
    return bool(np.abs(mesh.midpoints - straight).max() > 1e-9 * mesh.size)


def doubtful(nodes: Nodes, points: NDArray[np.float64]) -> str:
    """What is less accurate near lines, in words; empty where nothing is. `points` (vertex, 3) in space."""
    if len(nodes.ends):
        return (
            f"lines inside the shell ({_WHAT}) end, turn or branch, for example at {place(points[nodes.ends[0]])}, "
            "where strains grow without bound"
        )
    if len(nodes.curved):
        return (
            f"a line inside the shell ({_WHAT}) is curved in the plane of the parameters, for example at "
            f"{place(points[nodes.curved[0]])}, where its edges are chords"
        )
    return ""
