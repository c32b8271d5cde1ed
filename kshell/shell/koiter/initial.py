"""The strains of a Koiter triangle in a state that is free of stress.

The membrane part goes through the same interpolation as the strain of the displacement, so a shell that may expand
freely stays free of stress.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.shell.initial import StressFree, curvature_of, strain_of
from kshell.shell.koiter.energy import Koiter
from kshell.shell.reference import TWICE, first_derivatives, lagrange

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


def initial_strain(energy: Koiter, state: StressFree, triangles: Ints | None = None) -> Floats:
    """The strains s of the energy in that state, zero outside `triangles`: (triangle, r)."""
    result = np.zeros((len(energy.triangle_unknowns), energy.strains))
    chosen = np.arange(len(result)) if triangles is None else np.asarray(triangles)
    surface, ref = energy.surface, energy.surface.reference
    nodes = surface.nodes[surface.triangle_nodes[chosen]]
    points = np.einsum("sn,tnx->tsx", lagrange(surface.order, ref.regge_points), nodes)
    first = surface.tangents(first_derivatives(surface.order, ref.regge_points), chosen)
    strain = strain_of(state, chosen, points, first, energy.section)
    result[chosen, : ref.strains] = np.einsum("rsv,tsv->tr", ref.regge_weights, strain)

    points = np.einsum("qn,tnx->tqx", ref.values, nodes)
    second = surface.jets(surface.nodes, ref.second, chosen)
    tangents = surface.tangents(ref.first, chosen)
    curvature = curvature_of(state, chosen, points, tangents, second, energy.section)
    result[chosen, ref.strains :] = _measured(energy, curvature, chosen)
    return result


def _measured(koiter: Koiter, curvature: Floats, triangles: Ints) -> Floats:
    """l_r = int kappa : tau_r of covariant components (triangle, q, v)."""
    surface, ref = koiter.surface, koiter.surface.reference
    weighted = curvature * TWICE * (ref.weights / surface.area_elements[triangles])[..., None]
    return np.einsum("qk,tqv->tkv", ref.psi, weighted).reshape(len(triangles), -1)
