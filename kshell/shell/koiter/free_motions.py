"""The motions of a surface that conditions on its nodes and edges leave free: x = T q + x0.

Conditions are directions in which the translation of a node is given, so inclined planes, corners and changes of
the support need no special case.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.reduction import Reduction
from kshell.errors import InputError
from kshell.mesh.words import place
from kshell.shell.koiter.rigid_motion import follow_rigid
from kshell.shell.koiter.surface import Surface

Floats = NDArray[np.float64]

# a direction that lies this close to the span of the others on a node says nothing new
DEPENDENT = 1e-6
ROUNDING = 1e-14


@dataclass
class Conditions:
    """What is prescribed, one array after the other.

    Attributes
    ----------
    nodes, directions, values : lists of (n,), (n, 3) and (n,)
        Displacement of nodes along unit directions.
    groups : list of (n,)
        Nodes held in all directions, support by support.
    rotations, rotation_values : lists of (n,) and (n,)
        Unknowns of rotations, and their values in radians.
    """

    nodes: list[NDArray] = field(default_factory=list)
    directions: list[Floats] = field(default_factory=list)
    values: list[Floats] = field(default_factory=list)
    groups: list[NDArray] = field(default_factory=list)
    rotations: list[NDArray] = field(default_factory=list)
    rotation_values: list[Floats] = field(default_factory=list)


def free_motions(surface: Surface, conditions: Conditions) -> Reduction:
    """The motions left.

    Raises
    ------
    InputError
        If two conditions prescribe different displacements of the same node.
    """
    given = np.zeros(surface.unknowns)
    fixed = np.zeros(surface.unknowns, dtype=bool)
    rows, columns, entries, count = [], [], [], 0
    if conditions.nodes:
        nodes, basis, rank, motion = _by_node(surface, conditions)
        triple = 3 * nodes[:, None] + np.arange(3)
        fixed[triple] = True
        given[triple] = motion
        for kept in (1, 2):  # directions left free
            some = np.flatnonzero(rank == 3 - kept)
            for k in range(kept):
                rows.append(triple[some].ravel())
                columns.append(np.repeat(count + np.arange(len(some)), 3))
                entries.append(basis[some, 2 - k].ravel())
                count += len(some)
    rotations = np.zeros(0, dtype=np.int32)
    if conditions.rotations:
        rotations = np.unique(np.concatenate(conditions.rotations)).astype(np.int32)
        fixed[rotations] = True
        for unknowns, values in zip(conditions.rotations, conditions.rotation_values, strict=True):
            given[unknowns] = values
        _require_one_rotation(surface, conditions, given)
    following = None
    if conditions.groups:
        given, following = follow_rigid(surface, conditions.groups, nodes[rank == 3], rotations, given)
    free = np.flatnonzero(~fixed)
    # unconstrained unknowns first, in their order, then what is left of constrained nodes
    rows = [free, *rows]
    columns = [np.arange(len(free)), *(c + len(free) for c in columns)]
    entries = [np.ones(len(free)), *entries]
    basis_matrix = sp.csc_matrix(
        (np.concatenate(entries), (np.concatenate(rows), np.concatenate(columns))),
        shape=(surface.unknowns, len(free) + count),
    )
    basis_matrix.data[np.abs(basis_matrix.data) < ROUNDING] = 0.0
    basis_matrix.eliminate_zeros()
    staying = rotations if following is None else np.setdiff1d(rotations, following.rotations)
    return Reduction(basis_matrix, given, staying, following)


def _require_one_rotation(surface: Surface, conditions: Conditions, given: Floats) -> None:
    """Raise InputError where conditions prescribe different rotations of the same edge."""
    unknowns, values = np.concatenate(conditions.rotations), np.concatenate(conditions.rotation_values)
    miss = np.abs(given[unknowns] - values)
    if miss.max() > 1e-6 * np.abs(values).max(initial=0.0):
        number = int(unknowns[int(miss.argmax())]) - surface.rotation_start
        ends = surface.mesh.edges[surface.rotation_owner[number // surface.order]]
        where = place(surface.nodes[ends].mean(axis=0))
        raise InputError(
            f"supports prescribe different rotations of the edge at {where}: hold the rotation once there"
        )


def _by_node(surface: Surface, conditions: Conditions) -> tuple[NDArray, Floats, NDArray, Floats]:
    """Per constrained node: number, orthonormal frame (fixed directions first), rank, prescribed motion."""
    nodes = np.concatenate(conditions.nodes)
    order = np.argsort(nodes, kind="stable")
    nodes = nodes[order]
    directions, values = (
        np.concatenate(conditions.directions)[order],
        np.concatenate(conditions.values)[order],
    )
    unique, first, counts = np.unique(nodes, return_index=True, return_counts=True)
    matrix = np.zeros((len(unique), max(int(counts.max()), 3), 3))
    right = np.zeros(matrix.shape[:2])
    row = np.arange(len(nodes)) - np.repeat(first, counts)
    node = np.repeat(np.arange(len(unique)), counts)
    matrix[node, row], right[node, row] = directions, values

    u, s, v = np.linalg.svd(matrix, full_matrices=False)
    independent = s > DEPENDENT
    scaled = np.where(independent, np.einsum("nri,nr->ni", u, right) / np.where(independent, s, 1.0), 0.0)
    motion = np.einsum("ni,nix->nx", scaled, v)
    miss = np.abs(np.einsum("nrx,nx->nr", matrix, motion) - right).max(axis=1)
    worst = int(np.argmax(miss))
    if miss[worst] > 1e-6 * np.abs(right).max(initial=0.0):
        x, y, z = surface.nodes[unique[worst]]
        raise InputError(
            f"supports prescribe different displacements at ({x:.6g}, {y:.6g}, {z:.6g}): "
            "they differ by "
            f"{miss[worst]:.3g}; remove one of the conditions there"
        )
    return unique, v, independent.sum(axis=1), motion
