"""What no structure does, said of an answer: loads that kept a direction the surface left, absurd motions and strains.

None of it is an error of the computation; it tells of a unit or a load that is not what was meant.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from kshell.result.result import Result
from kshell.scene.loads import Pressure
from kshell.scene.structure import Structure

Floats = NDArray[np.float64]

# turn of the surface, root mean square, from which a pressure that keeps its direction is another load: what it has
# lost across the surface is half the square
TURNED = 0.1
# displacement over the size of the structure that linear theory cannot mean
ABSURD = 1.0
# strain at the faces in the mean that no linear law of a material holds for: of small deflections, and of large ones,
# which the same law is asked for with strains squared
STRETCHED, STRETCHED_LARGE = 0.5, 0.1


def warn_of_the_implausible(
    result: Result, structure: Structure, large: bool, factors: tuple[float, ...] | None
) -> None:
    """Add warnings to a result.

    Parameters
    ----------
    large : bool
        Whether deflections are large.
    factors : (load,), optional
        Of the loads of the structure, in one load case.
    """
    moved = np.zeros((len(structure.space.points), 3))
    moved[result.vertex] = result.fields["displacement"]
    if large:
        result.warnings += _turned_away(moved, structure, factors)
    else:
        result.warnings += _moved_too_far(moved, structure)
    result.warnings += _stretched(result, structure, large)


def _turned_away(moved: Floats, structure: Structure, factors: tuple[float, ...] | None) -> list[str]:
    """Of pressures without follower on a surface that turned."""
    mesh, out = structure.space, []
    for number, placed in enumerate(structure.loads):
        load = placed.item
        if not isinstance(load, Pressure) or load.follower:
            continue
        if load.value == 0.0 or (factors is not None and factors[number] == 0.0):
            continue
        corners = mesh.triangles[placed.members(mesh)]
        before, after = (_normals(x[corners]) for x in (mesh.points, mesh.points + moved))
        area = np.linalg.norm(before, axis=1)
        cosine = (before * after).sum(axis=1) / (area * np.linalg.norm(after, axis=1))
        angle = np.arccos(np.clip(cosine, -1.0, 1.0))
        mean = float(np.sqrt((area @ angle**2) / area.sum()))
        if mean > TURNED:
            out.append(
                f"{load} keeps the direction it had at rest, but the surface turned by {np.degrees(mean):.0f} degrees "
                f"in the mean, {np.degrees(angle.max()):.0f} at most: follower = true turns the pressure with it, as "
                "air and water do; a traction says that its direction is meant to stay"
            )
    return out


def _normals(corners: Floats) -> Floats:
    """(n, 3) normals of triangles (n, 3, 3), twice as long as their areas."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _moved_too_far(moved: Floats, structure: Structure) -> list[str]:
    """Of small deflections larger than the structure."""
    size = structure.space.size
    # no vector less the mean is longer than 2 root 3 times the largest component
    if np.abs(moved).max() <= 0.25 * ABSURD * size:
        return []
    # what the structure moves as a whole is no deflection
    largest = float(np.linalg.norm(moved - moved.mean(axis=0), axis=1).max())
    if not largest > ABSURD * size:
        return []
    return [
        f"displacements of {largest:.3g}, {largest / size:.2g} times the size of the structure, {size:.3g}, are beyond "
        "any linear theory: look at the units of loads, thickness and material"
    ]


def _stretched(result: Result, structure: Structure, large: bool) -> list[str]:
    """Of strains that no linear law holds for, from the energy: 1/2 (E t) e^2 / 3 per area of a bent plate."""
    mesh, section = structure.space, structure.section
    if section.uniform:
        held = float(
            section.membrane(np.zeros(1, dtype=np.int64), mesh.points[None, :1]).max() * mesh.areas.sum()
        )
    else:
        centres = mesh.points[mesh.triangles].mean(axis=1)[:, None]
        stiffness = section.membrane(np.arange(len(mesh.triangles)), centres)[:, 0].max(axis=(1, 2))
        held = float(mesh.areas @ stiffness)
    energy = result.strain_energy - result.energies.get("springs", 0.0)
    strain = math.sqrt(max(6.0 * energy / held, 0.0))
    if not strain > (STRETCHED_LARGE if large else STRETCHED):
        return []
    return [
        f"strains at the faces are about {strain:.2g} in the mean, more than any material bears that is linear: look "
        "at the units of loads, thickness and material"
    ]
