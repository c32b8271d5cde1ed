"""The strains of the Argyris discretisation, at its quadrature points, in a state that is free of stress."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.shell.chart.energy import ChartKoiter
from kshell.shell.initial import StressFree, curvature_of, strain_of

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


def initial_strain(energy: ChartKoiter, state: StressFree, triangles: Ints | None = None) -> Floats:
    """The strains s of the energy in that state, zero outside `triangles`: (triangle, r)."""
    result = np.zeros((len(energy.triangle_unknowns), energy.strains))
    chosen = np.arange(len(result)) if triangles is None else np.asarray(triangles)
    chart = energy.surface
    first, second = chart.first[:, :, chosen], chart.second[:, :, chosen]
    points = np.moveaxis(chart.positions[:, chosen], 0, 2)
    section = energy.section
    both = [
        strain_of(state, chosen, points, first, section),
        curvature_of(state, chosen, points, first, second, section),
    ]
    result[chosen] = np.concatenate(both, axis=2).reshape(len(chosen), -1)
    return result
