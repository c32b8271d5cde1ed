"""What springs by area, and curvature, hide from averages: layers of bending that large triangles do not see.

Where springs are stiff, the shell follows its load but in layers along supports and jumps of loads. Functions that are
smooth over triangles much larger than these oscillate about that, which costs much energy of springs and hardly any of
bending. As |w| <= c h^2 |w''| for oscillations w, what moments differ by is multiplied by

    1 + C k_n L^4 / (4 D) + C' k_t L^2 / (2 A),       C = 0.12 p^-5.3, C' = 0.5 p^-2.

Symbols
-------
k_n, k_t   stiffness of springs along the normal and in the plane, per area
L          longest edge of a triangle
D, A       smallest bending and membrane stiffness
p          order
R          smallest radius of curvature

A curved shell is to its bending a foundation of stiffness A / R^2. Where it carries by membrane forces, a support bends
it in a layer of l = (D R^2 / A)^(1/4), which takes 1.4 l / h of the energy of a triangle of size h beside a clamped
edge of a tube (3 l / h is relied on), and no more than what k_n = A / R^2 would add by the differences of moments.

C by clamped, supported and half free plates with k_n h^4 / D from 6 to 6e6, C' by strips that are pulled.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.scene.structure import Structure
from kshell.scene.supports import Elastic

Floats = NDArray[np.float64]

BENDING, BENDING_POWER = 0.12, -5.3
MEMBRANE, MEMBRANE_POWER = 0.5, -2.0
LAYER = 3.0  # l / h
SEEN = 0.1  # times moments, that layers may add at most, below which they are seen


def hidden_by_foundations(
    structure: Structure, order: int, normal: Floats, bending: Floats, membrane: Floats | None = None
) -> Floats:
    """(triangle,) by what energies of differences of forces and moments are multiplied.

    Parameters
    ----------
    structure : Structure
    order : int
    normal : (1 or triangle, 3) array
        Of length one.
    bending, membrane : (1 or triangle, 3, 3) arrays
        Stiffness of the section; plates do not stretch.
    """
    mesh = structure.space
    out = np.ones(len(mesh.triangles))
    normal = np.broadcast_to(normal, (len(out), 3))
    across, along = np.zeros_like(out), np.zeros_like(out)
    centres = mesh.points[mesh.triangles].mean(axis=1)
    for placed in structure.supports:
        item = placed.item
        if not isinstance(item, Elastic) or (placed.place is not None and placed.place.dimension != 2):
            continue
        members = placed.members(mesh)
        stiffness = item.stiffness_at(centres[members])
        for direction in item.directions():
            if isinstance(direction, str):
                share: Floats | float = 1.0 if direction == "n" else 0.0
                sideways: Floats | float = 0.0
            else:
                share = (normal[members] @ direction) ** 2
                sideways = 1.0 - share
            np.add.at(across, members, stiffness * share)
            np.add.at(along, members, stiffness * sideways)
    if not across.any() and not along.any():
        return out
    length = mesh.edge_lengths[mesh.triangle_edges].max(axis=1)
    bends = np.minimum(bending[:, 0, 0], bending[:, 1, 1])
    out += BENDING * order**BENDING_POWER * across * length**4 / (4.0 * bends)
    if membrane is not None:
        stretches = np.minimum(membrane[:, 0, 0], membrane[:, 1, 1])
        out += MEMBRANE * order**MEMBRANE_POWER * along * length**2 / (2.0 * stretches)
    return out


class HiddenLayers:
    """Layers of bending in a curved shell.

    Parameters
    ----------
    mesh : Mesh
        In space.
    order : int
    curvature : (triangle,) array
        1 / R.
    membrane, bending : (1 or triangle, 3, 3) arrays
        Stiffness of the section.
    """

    def __init__(self, mesh: Mesh, order: int, curvature: Floats, membrane: Floats, bending: Floats) -> None:
        length = mesh.edge_lengths[mesh.triangle_edges].max(axis=1)
        bends = np.minimum(bending[:, 0, 0], bending[:, 1, 1])
        stretches = np.maximum(membrane[:, 0, 0], membrane[:, 1, 1])
        stiff = stretches * curvature**2 / bends  # l^-4
        self._most = BENDING * order**BENDING_POWER * stiff * length**4 / 4.0
        self._share = LAYER * np.minimum(stiff**-0.25 / np.sqrt(2.0 * mesh.areas), 1.0)
        self.any = bool((self._most > SEEN).any())

    def energy(self, stretched: Floats, off: Floats) -> Floats:
        """(triangle,) hidden, of energies of stretching and of differences of moments."""
        return np.minimum(self._share * stretched, self._most * off)
