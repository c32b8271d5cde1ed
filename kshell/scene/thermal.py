"""What temperatures do to the sections of a structure: free strains, and the stresses left in layers.

A load has T = m + g z with z counted from the meshed surface, a section counts from its own middle, `offset` above it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.material.part import Part
from kshell.material.section import Section
from kshell.scene.loads import Temperature

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


def free_strain(
    load: Temperature, section: Section, triangles: Ints, points: Floats, offset: Floats | float = 0.0
) -> Floats:
    """(n, q, 6) strain and curvature, shears doubled, that leave no forces and moments: of the meshed surface.

    Parameters
    ----------
    triangles : (n,) int array
    points : (n, q, 3)
    offset : float or (n,)
        Of the middle of the material above the mesh.

    Raises
    ------
    InputError
        If a material has no expansion.
    """
    out = np.zeros((*points.shape[:2], 6))
    height = np.reshape(offset, (-1, 1, 1))
    for factor, free, _ in _parts(load, section, triangles, points, height[..., 0]):
        out += np.einsum("nij,nqj->nqi", free, factor)
    out[..., :3] -= height * out[..., 3:]
    return out


def left_stress(
    load: Temperature,
    section: Section,
    face: int,
    triangles: Ints,
    points: Floats,
    offset: Floats | float = 0.0,
) -> Floats:
    """(n, q, 3) stress without resultant at the bottom (face -1), in the middle (0), at the top (1)."""
    out = np.zeros((*points.shape[:2], 3))
    for factor, _, left in _parts(load, section, triangles, points, np.reshape(offset, (-1, 1))):
        out += np.einsum("nij,nqj->nqi", left[:, face + 1], factor)
    return out


def layers_left(load: Temperature, part: Part, points: Floats, offset: Floats) -> Floats:
    """(n, layer, 2, 3) the same at the bottom and the top of every layer of a section, at points (n, 3).

    Parameters
    ----------
    offset : (n,)
        Of the middle of the material above the mesh there.
    """
    temperature = _temperature(load, points, offset)
    parts = [
        np.einsum(
            "ksij,nj->nksi", part.warming(expansion).layers, np.asarray(factor)[..., None] * temperature
        )
        for factor, expansion in load.expansions(points)
    ]
    return np.asarray(sum(parts[1:], parts[0]))


def require_expansions(load: Temperature, section: Section, triangles: Ints) -> None:
    """Raise InputError, with the load, if what it warms has no expansion, or relaxes where layers keep stresses."""
    _warming(load, section, triangles, None if load.expansion is None else (1.0, 1.0))
    relaxing = any(getattr(m, "relaxation", None) for part in section.parts for m in part.materials)
    if relaxing and keeps_stress(load, section, triangles):
        raise InputError(
            f"{load}: its layers expand differently and relax: how the stresses that they keep against each other fade "
            "is not followed; give all layers one expansion, or leave relaxation out"
        )


def couples(load: Temperature, section: Section) -> bool:
    """Whether a uniform temperature bends a section, or a gradient stretches one."""
    given = [expansion for _, expansion in load.expansions(np.zeros((1, 3)))]
    try:
        return any(part.warming(expansion).couples for part in section.parts for expansion in given)
    except InputError:  # of a part that the load is not on
        return False


def keeps_stress(load: Temperature, section: Section, triangles: Ints) -> bool:
    """Whether layers keep stresses against each other."""
    given = [expansion for _, expansion in load.expansions(np.zeros((1, 3)))]
    return any(_warming(load, section, triangles, expansion)[1].any() for expansion in given)


def _parts(
    load: Temperature, section: Section, triangles: Ints, points: Floats, height: Floats
) -> list[tuple[Floats, Floats, Floats]]:
    """Temperatures (n, q, 2) times a part of the expansion, with what one unit of it does (`Section.warming`)."""
    temperature = _temperature(load, points, height)
    return [
        (np.asarray(factor)[..., None] * temperature, *_warming(load, section, triangles, expansion))
        for factor, expansion in load.expansions(points)
    ]


def _temperature(load: Temperature, points: Floats, height: Floats) -> Floats:
    """(..., 2) temperature in the middle of the material, and its growth per height."""
    gradient = load.values("gradient", points)
    return np.stack([load.values("mean", points) + gradient * height, gradient], axis=-1)


def _warming(
    load: Temperature, section: Section, triangles: Ints, expansion: tuple[float, float] | None
) -> tuple[Floats, Floats]:
    try:
        return section.warming(triangles, expansion)
    except InputError as error:
        raise InputError(f"{load}: {error}") from None
