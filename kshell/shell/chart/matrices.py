"""Mass and elastic supports of the Argyris discretisation: matrices that multiply displacements, not strains."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike, NDArray

from kshell.shell.chart.surface import ChartSurface
from kshell.shell.evaluate import Value, evaluate
from kshell.shell.reference import weighted_products
from kshell.shell.scatter import scattered

Floats = NDArray[np.float64]


def chart_foundation(
    surface: ChartSurface, stiffness: Value, directions: ArrayLike, triangles: NDArray | None = None
) -> sp.csr_matrix:
    """Springs spread over triangles of the Argyris discretisation; with unit directions, its mass matrix.

    Parameters as in `kshell.shell.koiter.matrices.foundation`.
    """
    chosen = np.arange(len(surface.scalar)) if triangles is None else triangles
    points = np.moveaxis(surface.positions[:, chosen], 0, 2)
    if callable(stiffness):
        factor = evaluate(stiffness, points, 1)
    else:
        factor = np.broadcast_to(np.asarray(stiffness, dtype=float), points.shape[:-1])
    reference = weighted_products(surface.tables[0], factor * surface.area_elements[chosen] * surface.weights)
    m = surface.transformation[chosen]
    blocks = m.swapaxes(1, 2) @ reference @ m
    scalar = scattered(surface.scalar[chosen], blocks, surface.scalars)
    return sp.kron(scalar, np.asarray(directions, dtype=float), format="csr")
