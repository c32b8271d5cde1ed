"""The deformed shape as it is drawn: its scale, and its nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kshell.result.vtu import at_nodes

if TYPE_CHECKING:
    from kshell.result.result import Result

Floats = NDArray[np.float64]

LARGEST_SHOWN = 0.1  # of the size of the shell: the largest displacement as drawn


def drawn_scale(result: Result) -> float:
    """A round number by which displacements are drawn, so that the largest is seen but small."""
    return round_scale(float(np.linalg.norm(result.fields["displacement"], axis=1).max()), result)


def round_scale(largest: float, result: Result) -> float:
    """The same for the largest of several states."""
    if largest == 0.0:
        return 1.0
    exact = LARGEST_SHOWN * result.mesh.size / largest
    power = 10.0 ** np.floor(np.log10(exact))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step * power <= exact * (1 + 1e-9)))


def deformed_nodes(result: Result, scale: float) -> tuple[Floats, Floats]:
    """Nodes (n, 3) of the rows of the fields, at rest and displaced by `scale` times the displacement."""
    rest = result.rows.nodes
    u = at_nodes(
        result.rows, "displacement", result.fields["displacement"], result.fields, result.edge_fields
    )
    return rest, rest + scale * u
